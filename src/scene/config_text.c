#include "config_text.h"

#include "base/visible.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { DEEPEST_INCLUDE = 10 }; /* libconfig's */

/* A text that is gone through. */
struct scan {
    const char *at;
    const char *file; /* NULL: none */
    const char *folder;
    int line, depth;
    char *reason;
};

__attribute__((format(printf, 2, 3))) static int refuse(const struct scan *scan, const char *format,
                                                        ...) {
    int used = 0;
    if (scan->file)
        used = snprintf(scan->reason, REASON_SIZE, "%.120s:%d: ", scan->file, scan->line);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(scan->reason + used, (size_t)(REASON_SIZE - used), format, arguments);
    va_end(arguments);
    return 1;
}

static void next(struct scan *scan) {
    scan->line += *scan->at == '\n';
    scan->at += *scan->at != '\0';
}

static int check_line_comment(struct scan *scan) {
    scan->at += strcspn(scan->at, "\n");
    return *scan->at ? 0 : refuse(scan, "a comment in the last line must end in a newline");
}

/* libconfig would take the rest of the scene for a comment. */
static int check_comment(struct scan *scan) {
    const int line = scan->line;
    for (scan->at += 2; *scan->at && strncmp(scan->at, "*/", 2) != 0;)
        next(scan);
    if (*scan->at) {
        scan->at += 2;
        return 0;
    }
    scan->line = line;
    return refuse(scan, "the comment that begins here has no end");
}

/* --- texts in quotes --- */

/* run.json is UTF-8, and would lose any other text. */
static int check_quoted(struct scan *scan) {
    const int line = scan->line;
    for (next(scan); *scan->at && *scan->at != '"';) {
        const int length = utf8_length(scan->at);
        if (length == 0)
            return refuse(scan, "a text in quotes is not UTF-8 (byte 0x%02x)",
                          (unsigned)(unsigned char)*scan->at);
        if (*scan->at == '\\')
            next(scan);
        for (int i = 0; i < length; i++)
            next(scan);
    }
    if (*scan->at) {
        next(scan);
        return 0;
    }
    scan->line = line;
    return refuse(scan, "the text that begins here has no closing quote");
}

/* --- numbers --- */

/* libconfig takes whole numbers, unless they end in L, for 32 bits, and wraps longer ones. */
static int check_number(struct scan *scan) {
    const char *start = scan->at;
    const int hexadecimal = start[0] == '0' && tolower((unsigned char)start[1]) == 'x';
    char *end;
    errno = 0;
    const unsigned long long value = strtoull(start, &end, hexadecimal ? 16 : 10);
    const int length = (int)(end - start), is_long = *end == 'L';
    while (isalnum((unsigned char)*scan->at) || *scan->at == '.' ||
           (!hexadecimal && strchr("+-", *scan->at) && *scan->at &&
            tolower((unsigned char)scan->at[-1]) == 'e'))
        scan->at++;
    if (!is_long && end != scan->at) /* it has a fraction or an exponent, or is none */
        return 0;
    if (errno != ERANGE && value <= (is_long ? (unsigned long long)LLONG_MAX : INT_MAX))
        return 0;
    return refuse(scan, "%.*s: too long for a whole number; write %s", length < 60 ? length : 60,
                  start, hexadecimal ? "it in decimals, with a point" : "a point after it, as 1.0");
}

/* --- what is included --- */

static int check_file(const char *path, const char *folder, int depth, int *lines, char *reason);

/* At an '@' that begins a line. */
static int check_include(struct scan *scan) {
    static const char directive[] = "@include";
    char name[PATH_SIZE], path[PATH_SIZE];
    struct stat status;
    if (strncmp(scan->at, directive, sizeof directive - 1) != 0) {
        next(scan);
        return 0; /* a syntax error */
    }
    scan->at += sizeof directive - 1;
    scan->at += strspn(scan->at, " \t");
    const size_t length = *scan->at == '"' ? strcspn(scan->at + 1, "\"\n") : 0;
    if (*scan->at != '"')
        return 0;
    if (path_format(name, "%.*s", (int)(length < PATH_SIZE ? length : PATH_SIZE), scan->at + 1) ||
        path_format(path, "%s%s%s", scan->folder, *scan->folder ? "/" : "", name))
        return refuse(scan, "@include: the path is too long");
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
        return refuse(scan, "@include \"%.100s\": is a folder, not a file", name);
    if (!file_exists(path))
        return refuse(scan, "@include \"%.100s\": no such file beside the scene, or not readable",
                      name);
    if (scan->depth >= DEEPEST_INCLUDE)
        return refuse(scan, "@include \"%.100s\": goes in a circle, or through more than %d files",
                      name, DEEPEST_INCLUDE);
    scan->at += length + 1;
    scan->at += *scan->at == '"';
    int lines;
    return check_file(path, scan->folder, scan->depth + 1, &lines, scan->reason);
}

/* --- the whole --- */

static int begins_line(const struct scan *scan, const char *text) {
    const char *c = scan->at;
    while (c > text && (c[-1] == ' ' || c[-1] == '\t'))
        c--;
    return c == text || c[-1] == '\n';
}

static int check(struct scan *scan) {
    const char *text = scan->at;
    int code = 0;
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0)
        return refuse(scan, "begins with a byte-order mark; save it as UTF-8 without one");
    while (!code && *scan->at) {
        if (*scan->at == '#' || strncmp(scan->at, "//", 2) == 0)
            code = check_line_comment(scan);
        else if (strncmp(scan->at, "/*", 2) == 0)
            code = check_comment(scan);
        else if (*scan->at == '"')
            code = check_quoted(scan);
        else if (isdigit((unsigned char)*scan->at) || *scan->at == '.')
            code = check_number(scan);
        else if (isalpha((unsigned char)*scan->at) || *scan->at == '*')
            while (isalnum((unsigned char)*scan->at) || (*scan->at && strchr("-_*", *scan->at)))
                scan->at++; /* a name, with digits of its own */
        else if (*scan->at == '@' && begins_line(scan, text))
            code = check_include(scan);
        else
            next(scan);
    }
    return code;
}

/* And the number of the last line that holds something. */
static int check_lines(struct scan *scan, int *lines) {
    const char *text = scan->at;
    const int code = check(scan);
    *lines = scan->line - (scan->at > text && scan->at[-1] == '\n');
    return code;
}

static int check_file(const char *path, const char *folder, int depth, int *lines, char *reason) {
    struct stat status;
    struct scan scan = {
        .file = path, .folder = folder, .line = 1, .depth = depth, .reason = reason};
    if (stat(path, &status) || S_ISDIR(status.st_mode)) {
        snprintf(reason, REASON_SIZE, "%.120s: is a folder, and a scene is a file", path);
        return 1;
    }
    if (!S_ISREG(status.st_mode) && depth == 0)
        return 0; /* a scene may come through a pipe, which can be read but once */
    if (!S_ISREG(status.st_mode)) {
        snprintf(reason, REASON_SIZE, "%.120s: is no regular file, and what is included is one",
                 path);
        return 1;
    }
    char *text = file_text(path);
    if (!text) {
        snprintf(reason, REASON_SIZE, "%.120s: cannot be read: %s", path, strerror(errno));
        return errno == ENOMEM ? -1 : 1;
    }
    scan.at = text;
    const int code = check_lines(&scan, lines);
    free(text);
    return code;
}

int config_check_file(const char *path, const char *folder, int *lines, char *reason) {
    *lines = 0;
    return check_file(path, folder, 0, lines, reason);
}

int config_check_scene(const char *text, const char *path, const char *folder, int *lines,
                       char *reason) {
    struct scan scan = {.at = text, .file = path, .folder = folder, .line = 1, .reason = reason};
    return check_lines(&scan, lines);
}

int config_check_text(const char *text, char *reason) {
    struct scan scan = {.at = text, .folder = "", .line = 1, .reason = reason};
    return check(&scan);
}
