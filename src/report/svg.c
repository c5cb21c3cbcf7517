#include "svg.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int begins(const char *at, const char *with) {
    return strncmp(at, with, strlen(with)) == 0;
}

/* --- what a page does without --- */

/* The end of an element, where one that begins so is at `at`, or NULL. */
static const char *skip(const char *at, const char *opens, const char *closes) {
    const char *end = begins(at, opens) ? strstr(at, closes) : NULL;
    return end ? end + strlen(closes) : NULL;
}

/* The same of the drawing program's own name for a part of the picture, which would show as a tip.
 */
static const char *skip_names(const char *at) {
    const char *end = skip(at, "<title>", "</title>");
    return end ? end : skip(at, "<desc>", "</desc>");
}

/* Every picture has two filters, and hardly one uses them. */
static const char *skip_filter(const char *at) {
    return skip(at, "<filter ", "</filter>");
}

/* The end of a group without content, or NULL. */
static const char *skip_empty_group(const char *at) {
    if (!begins(at, "<g "))
        return NULL;
    at = strchr(at, '>');
    if (!at)
        return NULL;
    for (at++; isspace((unsigned char)*at);)
        at++;
    return begins(at, "</g>") ? at + strlen("</g>") : NULL;
}

/* What an attribute says that holds without it: an initial value, or the page's own letters. */
static const char *const needless[][2] = {
    {"stroke-linecap", "butt"}, {"stroke-linejoin", "miter"}, {"font-family", "sans-serif"}};
enum { NEEDLESS = sizeof needless / sizeof *needless };

/* --- lines --- */

/* A number of tenths as short as it goes: 0.5 is .5. */
static void write_tenths(FILE *stream, long tenths) {
    const long size = labs(tenths);
    fputs(tenths < 0 ? "-" : "", stream);
    if (size >= 10 || size == 0)
        fprintf(stream, "%ld", size / 10);
    if (size % 10)
        fprintf(stream, ".%ld", size % 10);
}

static void write_pair(FILE *stream, long x, long y) {
    write_tenths(stream, x);
    fputs(y < 0 ? "" : ",", stream);
    write_tenths(stream, y);
}

/* Reads "M12.5,-3" or "L...", with a blank before; returns what follows, or NULL where it is
 * something else. */
static const char *read_point(const char *at, char *command, long *x, long *y) {
    char *end;
    while (isspace((unsigned char)*at))
        at++;
    *command = *at;
    if (*at != 'M' && *at != 'L')
        return NULL;
    *x = lround(10 * strtod(at + 1, &end));
    if (end == at + 1 || *end != ',')
        return NULL;
    at = end + 1;
    *y = lround(10 * strtod(at, &end));
    return end > at ? end : NULL;
}

/* Whether the data up to the quote are straight lines between points, and nothing else. */
static int is_polyline(const char *at, char quote) {
    char command;
    long x, y;
    for (const char *next; (next = read_point(at, &command, &x, &y)) != NULL;)
        at = next;
    at += strspn(at, " \t\r\nzZ");
    return *at == quote;
}

/* Writes the points up to the quote, each from the one before; returns where the quote is. */
static const char *write_polyline(FILE *stream, const char *at, char quote) {
    long x = 0, y = 0, to_x, to_y;
    char command, last = 0;
    for (const char *next; (next = read_point(at, &command, &to_x, &to_y)) != NULL; at = next) {
        const long dx = to_x - x, dy = to_y - y;
        if (last && command == 'L' && dx == 0 && dy == 0 && last == 'L')
            continue;                          /* seen from here the pen has not moved */
        if (command == 'M' || command != last) /* pairs after a move would be lines */
            fputc(!last ? 'M' : command == 'M' ? 'm' : 'l', stream);
        else if (dx >= 0)
            fputc(' ', stream);
        write_pair(stream, dx, dy);
        last = command;
        x = to_x, y = to_y;
    }
    for (; *at != quote; at++)
        if (*at == 'z' || *at == 'Z')
            fputc('z', stream);
    return at;
}

/* --- tags --- */

/* An attribute's name and value in the text. */
struct attribute {
    const char *name, *value;
    int name_length, value_length;
    char quote;
};

/* Reads one; returns what follows, or NULL where there is none. */
static const char *read_attribute(const char *at, struct attribute *a) {
    a->name = at;
    a->name_length = (int)strcspn(at, "= \t\r\n/>");
    at += a->name_length;
    at += strspn(at, " \t\r\n");
    if (a->name_length == 0 || *at != '=')
        return NULL;
    at += 1 + strspn(at + 1, " \t\r\n");
    const char *end = *at == '"' || *at == '\'' ? strchr(at + 1, *at) : NULL;
    if (!end)
        return NULL;
    a->quote = *at;
    a->value = at + 1;
    a->value_length = (int)(end - a->value);
    return end + 1;
}

static int is_called(const struct attribute *a, const char *name) {
    return (int)strlen(name) == a->name_length && begins(a->name, name);
}

/* A value with runs of blanks as one, and the prefix before every id: after "url(#", which may be
 * quoted, and where all of it is a reference after its #. */
static void write_value(FILE *stream, const struct attribute *a, const char *prefix) {
    const char *end = a->value + a->value_length, *at = a->value;
    const int refers = is_called(a, "href") || is_called(a, "xlink:href");
    if (refers && begins(at, "../"))
        at += strlen("../"); /* the page is one folder up */
    while (at < end) {
        const size_t blanks = strspn(at, " \t\r\n");
        if (blanks > 0) {
            fputc(' ', stream);
            at += at + blanks < end ? blanks : (size_t)(end - at);
        } else {
            const long before = at - a->value;
            const int of_url = (before >= 4 && begins(at - 4, "url(")) ||
                               (before >= 5 && begins(at - 5, "url(") && strchr("\"'", at[-1]));
            fputc(*at, stream);
            if (*at == '#' && (refers ? at == a->value : of_url))
                fputs(prefix, stream);
            at++;
        }
    }
}

static int is_needless(const struct attribute *a) {
    for (int i = 0; i < NEEDLESS; i++)
        if (is_called(a, needless[i][0]) && a->value_length == (int)strlen(needless[i][1]) &&
            begins(a->value, needless[i][1]))
            return 1;
    return 0;
}

static void write_attribute(FILE *stream, const struct attribute *a, const char *prefix,
                            int in_defs) {
    if (is_needless(a))
        return;
    fprintf(stream, " %.*s=%c", a->name_length, a->name, a->quote);
    if (is_called(a, "d") && !in_defs && is_polyline(a->value, a->quote)) {
        write_polyline(stream, a->value, a->quote);
    } else {
        fputs(is_called(a, "id") ? prefix : "", stream);
        write_value(stream, a, prefix);
    }
    fputc(a->quote, stream);
}

/* Writes what a tag has after its name, and its end; returns what follows. In `defs` are shapes of
 * marks. */
static const char *write_attributes(FILE *stream, const char *at, const char *prefix, int in_defs) {
    struct attribute attribute;
    for (const char *next; (next = read_attribute(at + strspn(at, " \t\r\n"), &attribute));
         at = next)
        write_attribute(stream, &attribute, prefix, in_defs);
    at += strspn(at, " \t\r\n");
    while (*at && *at != '>')
        fputc(*at++, stream);
    if (*at)
        fputc(*at++, stream);
    return at;
}

static const char *write_tag(FILE *stream, const char *at, const char *prefix, int in_defs) {
    const size_t name = strcspn(at, " \t\r\n>");
    fwrite(at, 1, name, stream);
    return write_attributes(stream, at + name, prefix, in_defs);
}

/* --- the picture --- */

void svg_write(FILE *stream, const char *attributes, const char *prefix) {
    const char *at = write_attributes(stream, attributes, prefix, 0);
    const int uses_filters = strstr(attributes, "filter=") != NULL;
    int in_defs = 0, in_tip = 0; /* just behind the tag of a point that says what it is */
    while (*at) {
        const size_t blanks = strspn(at, " \t\r\n");
        const char *after;
        if (blanks > 0 && at[blanks] == '<') {
            if (memchr(at, '\n', blanks))
                fputc('\n', stream);
            else
                fwrite(at, 1, blanks, stream);
            at += blanks;
        } else if ((after = in_tip ? NULL : skip_names(at)) || (after = skip_empty_group(at)) ||
                   (after = uses_filters ? NULL : skip_filter(at))) {
            at = after;
        } else if (*at == '<') {
            in_defs = begins(at, "<defs") ? 1 : begins(at, "</defs") ? 0 : in_defs;
            in_tip = begins(at, "<a ") || begins(at, "<g class=\"tip\"");
            at = write_tag(stream, at, prefix, in_defs);
        } else {
            fputc(*at++, stream);
        }
    }
}
