#include "html.h"

#include "base/files.h"
#include "base/visible.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* One character: what is none of a page's is shown by its number. */
static void write_visible(FILE *stream, const char **text) {
    const int length = utf8_length(*text), bytes = length > 0 ? length : 1;
    char one[8], shown[16];
    snprintf(one, sizeof one, "%.*s", bytes, *text);
    if (**text == '\n' || **text == '\t')
        fputc(**text, stream);
    else
        fputs((visible_text(one, shown, sizeof shown), shown), stream);
    *text += bytes - 1;
}

void html_text(FILE *stream, const char *text) {
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", stream);
            break;
        case '<':
            fputs("&lt;", stream);
            break;
        case '>':
            fputs("&gt;", stream);
            break;
        case '"':
            fputs("&quot;", stream);
            break;
        default:
            write_visible(stream, &text);
        }
    }
}

void html_print(FILE *stream, const char *format, ...) {
    char text[4096];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    html_text(stream, text);
}

/* --- tables --- */

static void write_cell(FILE *stream, const char *cell) {
    char *end;
    const double number = strtod(cell, &end);
    if (text_cell_is_empty(cell)) {
        fputs("<td class=\"none\">–</td>", stream); /* the row says why */
    } else if (end != cell && !*end) {
        fprintf(stream, "<td class=\"number\">%.4g</td>", number);
    } else {
        fputs("<td>", stream);
        html_text(stream, cell);
        fputs("</td>", stream);
    }
}

/* The index of the k-th column to be shown; -1 where it is not there, -2 after the last. */
static int shown_column(const struct text_table *table, const char *const *columns, int k) {
    if (columns)
        return columns[k] ? text_table_column(table, columns[k]) : -2;
    return k < table->column_count ? k : -2;
}

void html_table(FILE *stream, const struct text_table *table, const char *const *columns) {
    const int rows = table->row_count <= HTML_ROWS_MAX ? table->row_count : HTML_ROWS_HEAD;
    fputs("<div class=\"wide\"><table><thead><tr>", stream);
    for (int k = 0, i; (i = shown_column(table, columns, k)) > -2; k++) {
        if (i < 0)
            continue;
        fputs("<th>", stream);
        for (const char *c = table->name[i]; *c; c++) /* may break at its underscores */
            *c == '_' ? (void)fputs("_<wbr/>", stream) : html_text(stream, (char[]){*c, '\0'});
        fputs("</th>", stream);
    }
    fputs("</tr></thead><tbody>\n", stream);
    for (int row = 0; row < rows; row++) {
        fputs("<tr>", stream);
        for (int k = 0, i; (i = shown_column(table, columns, k)) > -2; k++)
            if (i >= 0)
                write_cell(stream, table->cell[row * table->column_count + i]);
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
    if (rows < table->row_count)
        fprintf(stream, "<p class=\"small\">The first %d of %d rows; the file has them all.</p>\n",
                rows, table->row_count);
}

/* --- statements --- */

void html_statement(FILE *stream, const struct text_table *rows, int row) {
    const char *verdict = text_table_cell(rows, row, "verdict");
    const int fails = strcmp(verdict, "does not hold") == 0,
              thesis = strcmp(text_table_cell(rows, row, "by"), "thesis") == 0;
    fprintf(stream, "<li><span class=\"verdict%s\">%s%s</span> ", fails ? " fails" : "",
            thesis ? "thesis: " : "", verdict);
    html_text(stream, text_table_cell(rows, row, "statement"));
    fputs("</li>\n", stream);
}

/* --- pictures --- */

/* After any of these comes an id. */
static const char *const before_id[] = {" id=\"",   " id='",   "url(#",   "url('#",
                                        "href=\"#", "href='#", "url(\"#", NULL};

static const char *id_mark(const char *at) {
    for (int i = 0; before_id[i]; i++)
        if (strncmp(at, before_id[i], strlen(before_id[i])) == 0)
            return before_id[i];
    return NULL;
}

/* The end of an element that begins at `at`, where it is one that a page does without: the
 * drawing program's own name for the picture, which would show as a tip. */
static const char *skip_element(const char *at) {
    static const char *const names[] = {"title", "desc"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char open[16], close[16];
        snprintf(open, sizeof open, "<%s>", names[i]);
        snprintf(close, sizeof close, "</%s>", names[i]);
        const char *end = strncmp(at, open, strlen(open)) == 0 ? strstr(at, close) : NULL;
        if (end)
            return end + strlen(close);
    }
    return NULL;
}

static void write_svg(FILE *stream, const char *at, const char *prefix) {
    while (*at) {
        const char *after = *at == '<' ? skip_element(at) : NULL;
        const char *mark = after ? NULL : id_mark(at);
        if (after) {
            at = after;
        } else if (mark) {
            fprintf(stream, "%s%s", mark, prefix);
            at += strlen(mark);
        } else {
            fputc(*at++, stream);
        }
    }
}

int html_svg(FILE *stream, const char *path, const char *prefix, const char *label, char *reason) {
    FILE *file = fopen(path, "r");
    char *text = NULL;
    size_t size = 0;
    const ssize_t length = file ? getdelim(&text, &size, '\0', file) : -1;
    if (file)
        fclose(file);
    const char *start = length > 0 ? strstr(text, "<svg") : NULL;
    if (!start || !strstr(start, "</svg>")) {
        snprintf(reason, REASON_SIZE, "%.150s: is not a whole picture", path);
        free(text);
        return -1;
    }
    fputs("<div class=\"wide\"><svg role=\"img\" aria-label=\"", stream);
    html_text(stream, label);
    fputs("\"", stream);
    write_svg(stream, start + strlen("<svg"), prefix);
    fputs("</div>\n", stream);
    free(text);
    return 0;
}

/* Three bytes become four letters (RFC 4648, section 4). */
static void write_base64(FILE *stream, FILE *from) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned char bytes[3] = {0};
    for (size_t n; (n = fread(bytes, 1, 3, from)) > 0; memset(bytes, 0, 3)) {
        const unsigned all = (unsigned)bytes[0] << 16 | (unsigned)bytes[1] << 8 | bytes[2];
        for (size_t k = 0; k < 4; k++)
            fputc(k <= n ? letters[all >> (18 - 6 * k) & 63] : '=', stream);
    }
}

int html_png(FILE *stream, const char *path, const char *label, char *reason) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        snprintf(reason, REASON_SIZE, "%.150s: cannot be read", path);
        return -1;
    }
    fputs("<div class=\"wide\"><img alt=\"", stream);
    html_text(stream, label);
    fputs("\" src=\"data:image/png;base64,", stream);
    write_base64(stream, file);
    fputs("\"/></div>\n", stream);
    fclose(file);
    return 0;
}
