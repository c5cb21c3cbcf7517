#include "html.h"

#include "base/files.h"
#include "base/markup.h"
#include "base/visible.h"
#include "experiments/common/statements.h"
#include "svg.h"
#include "webp.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void html_text(FILE *stream, const char *text) {
    markup_text(stream, text);
}

void html_print(FILE *stream, const char *format, ...) {
    char text[4096];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    html_text(stream, text);
}

void html_element(FILE *stream, const char *tag, const char *text, const char *after) {
    fprintf(stream, "<%s>", tag);
    html_text(stream, text);
    fprintf(stream, "</%.*s>%s", (int)strcspn(tag, " "), tag, after);
}

/* --- tables --- */

void html_cell(FILE *stream, const char *text) {
    const int is_name = strchr(text, '-') && !strchr(text, ' ') && strlen(text) <= 20;
    html_element(stream, is_name ? "td class=\"name\"" : "td", text, "");
}

static void write_cell(FILE *stream, const char *cell, double factor) {
    char *end;
    const double number = strtod(cell, &end);
    if (text_cell_is_empty(cell))
        fputs("<td class=\"none\">–</td>", stream); /* the row says why */
    else if (end != cell && !*end)
        fprintf(stream, "<td class=\"number\">%.4g</td>", number * factor);
    else
        html_cell(stream, cell);
}

static void write_heading(FILE *stream, const char *name) {
    fputs("<th>", stream);
    for (const char *c = name; *c; c++) { /* may break at its underscores */
        char one[8];
        const int length = utf8_length(c) > 0 ? utf8_length(c) : 1;
        snprintf(one, sizeof one, "%.*s", length, c);
        *c == '_' ? (void)fputs("_<wbr/>", stream) : html_text(stream, one);
        c += length - 1;
    }
    fputs("</th>", stream);
}

/* The k-th column to be shown, with its index in the table, -1 where it is not there. Returns
 * whether there is a k-th. */
static int shown_column(const struct text_table *table, const struct html_column *columns, int k,
                        struct html_column *column, int *index) {
    if (columns) {
        *column = columns[k];
        *index = columns[k].name ? text_table_column(table, columns[k].name) : -1;
        return columns[k].name != NULL;
    }
    *index = k;
    if (k < table->column_count)
        *column = (struct html_column){table->name[k], table->name[k], 1};
    return k < table->column_count;
}

void html_table(FILE *stream, const struct text_table *table, const struct html_column *columns) {
    const int rows = table->row_count <= HTML_ROWS_MAX ? table->row_count : HTML_ROWS_HEAD;
    struct html_column column;
    int i;
    fputs("<div class=\"wide\"><table><thead><tr>", stream);
    for (int k = 0; shown_column(table, columns, k, &column, &i); k++)
        if (i >= 0)
            write_heading(stream, column.heading);
    fputs("</tr></thead><tbody>\n", stream);
    for (int row = 0; row < rows; row++) {
        fputs("<tr>", stream);
        for (int k = 0; shown_column(table, columns, k, &column, &i); k++)
            if (i >= 0)
                write_cell(stream, table->cell[row * table->column_count + i],
                           column.factor > 0 ? column.factor : 1);
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
    if (rows < table->row_count)
        fprintf(stream, "<p class=\"small\">The first %d of %d rows; the file has them all.</p>\n",
                rows, table->row_count);
}

/* --- statements --- */

int html_is_claim(const struct text_table *rows, int row) {
    return strcmp(text_table_cell(rows, row, "by"), "thesis") == 0;
}

static int has_verdict(const struct text_table *rows, int row, const char *word) {
    return strcmp(text_table_cell(rows, row, "verdict"), word) == 0;
}

static void write_verdict(FILE *stream, const struct text_table *rows, int row) {
    fprintf(stream, "<span class=\"verdict%s\">%s</span>",
            has_verdict(rows, row, "does not hold") ? " fails" : "",
            text_table_cell(rows, row, "verdict"));
}

/* The claim of a row, without what was found and without the colon. */
static void write_claim(FILE *stream, const struct text_table *rows, int row) {
    const char *sentence = text_table_cell(rows, row, "statement");
    const char *finding = statement_finding(sentence);
    html_print(stream, "%.*s", finding ? (int)(finding - sentence) - 2 : 4000, sentence);
}

void html_sentence(FILE *stream, const struct text_table *rows, int row) {
    const char *sentence = text_table_cell(rows, row, "statement");
    const char *finding = statement_finding(sentence);
    if (html_is_claim(rows, row) && finding) {
        fputs("The thesis: ", stream);
        write_claim(stream, rows, row);
        fputs(". ", stream);
        write_verdict(stream, rows, row);
        fputs(" ", stream);
        html_text(stream, finding);
        return;
    }
    if (!has_verdict(rows, row, "holds") && !has_verdict(rows, row, "does not hold")) {
        write_verdict(stream, rows, row);
        fputs(" ", stream);
    }
    html_text(stream, sentence);
}

void html_statement(FILE *stream, const struct text_table *rows, int row) {
    fputs("<li>", stream);
    html_sentence(stream, rows, row);
    fputs("</li>\n", stream);
}

static void write_without_stop(FILE *stream, const char *sentence) {
    const size_t length = strlen(sentence);
    html_print(stream, "%.*s",
               (int)(length > 0 && sentence[length - 1] == '.' ? length - 1 : length), sentence);
}

void html_title(FILE *stream, const struct text_table *rows, int row) {
    const char *sentence = text_table_cell(rows, row, "statement");
    const char *finding = statement_finding(sentence);
    if (!html_is_claim(rows, row) || !finding) {
        write_without_stop(stream, sentence);
        return;
    }
    write_claim(stream, rows, row);
    if (has_verdict(rows, row, "holds"))
        return;
    fputs("? ", stream);
    write_verdict(stream, rows, row);
    fputs(" ", stream);
    write_without_stop(stream, finding);
}

void html_claims_begin(FILE *stream) {
    fputs("<div class=\"wide\"><table class=\"claims\"><thead><tr><th>the thesis says</th>"
          "<th>found here</th><th>verdict</th></tr></thead><tbody>\n",
          stream);
}

void html_claim(FILE *stream, const struct text_table *rows, int row, const char *part) {
    const char *finding = statement_finding(text_table_cell(rows, row, "statement"));
    fputs("<tr><td>", stream);
    write_claim(stream, rows, row);
    if (part)
        fprintf(stream, " <a href=\"#%s\">%s</a>", part, part);
    fputs("</td>", stream);
    html_element(stream, "td", finding ? finding : "", "");
    fputs("<td>", stream);
    write_verdict(stream, rows, row);
    fputs("</td></tr>\n", stream);
}

void html_claims_end(FILE *stream) {
    fputs("</tbody></table></div>\n", stream);
}

/* --- pictures --- */

int html_svg(FILE *stream, const char *path, const char *prefix, const char *label, char *reason) {
    char *text = file_text(path);
    const char *start = text ? strstr(text, "<svg") : NULL;
    if (!start || !strstr(start, "</svg>")) {
        free(text);
        return fail_with(reason, "%.150s: is not a whole picture", path);
    }
    /* Below this width its letters of 12 points are smaller than 10. */
    const char *width = strstr(start, "width=\"");
    fprintf(stream,
            "<div class=\"wide\"><svg style=\"--legible:%.0fpx\" role=\"img\" aria-label=\"",
            width ? 10. / 12 * strtod(width + strlen("width=\""), NULL) : 0);
    html_text(stream, label);
    fputs("\"", stream);
    svg_write(stream, start + strlen("<svg"), prefix);
    fputs("</div>\n", stream);
    free(text);
    return 0;
}

/* How well pictures are coded; nobody looks at one frame of a film for long. */
static const double picture_quality = 80, film_quality = 60;

/* On a phone letters of 13 pixels are not shown smaller than 10. */
static int write_image(FILE *stream, const struct webp *webp, const char *label, char *reason) {
    FILE *bytes = fmemopen(webp->bytes, webp->count, "rb");
    if (!bytes)
        return fail_with(reason, "out of memory");
    fprintf(stream, "<img style=\"--legible:%.0fpx\" alt=\"", 10. / 13 * webp->width);
    html_text(stream, label);
    fputs("\" src=\"data:image/webp;base64,", stream);
    markup_base64(stream, bytes);
    fputs("\"/>", stream);
    fclose(bytes);
    return 0;
}

int html_png(FILE *stream, const char *path, const char *label, char *reason) {
    struct webp webp;
    if (webp_of_png(&webp, path, 1, picture_quality, reason))
        return -1;
    fputs("<div class=\"wide\">", stream);
    const int code = write_image(stream, &webp, label, reason);
    fputs("</div>\n", stream);
    webp_free(&webp);
    return code;
}

/* Behind a window of one frame's height the sheet moves up by steps; it rests with the last frame
 * in the window. Printed is that frame alone, without the sheet, which a file for a printer would
 * have as a whole. */
static void write_film_style(FILE *stream, int frames) {
    const double play = (frames - 1) / 15., rest = 0.7; /* s */
    const double last = 100. * (frames - 1) / frames;
    fprintf(stream,
            "<style>\n"
            ".film>div{overflow:hidden}.film>.printed{display:none}\n"
            ".film img{display:block;width:100%%;height:auto}\n"
            ".film .sheet img{transform:translateY(-%.6g%%)}\n"
            ".film label{color:#666;font-size:.85em}\n"
            "@media print{.film label,.film>.sheet{display:none}.film>.printed{display:block}}\n"
            "@keyframes film{0%%{transform:none;animation-timing-function:steps(%d,jump-none)}\n"
            "%.6g%%,100%%{transform:translateY(-%.6g%%)}}\n"
            "@media screen and (prefers-reduced-motion:no-preference){\n"
            ".film .sheet img{animation:film %.6gs infinite}\n"
            ".film:has(:checked) .sheet img{animation-play-state:paused}}\n"
            "</style>\n",
            last, frames, 100 * play / (play + rest), last, play + rest);
}

int html_film(FILE *stream, const char *path, int frames, const char *label, char *reason) {
    struct webp sheet, last = {.bytes = NULL};
    if (webp_of_png(&sheet, path, 1, film_quality, reason))
        return -1;
    int code = webp_of_png(&last, path, frames, picture_quality, reason);
    write_film_style(stream, frames);
    fprintf(stream,
            "<div class=\"film\"><div class=\"sheet\" "
            "style=\"aspect-ratio:%d/%d;max-width:%dpx\">",
            sheet.width, sheet.height / frames, sheet.width);
    if (!code)
        code = write_image(stream, &sheet, label, reason);
    fputs("</div>\n<div class=\"printed\">", stream);
    if (!code)
        code = write_image(stream, &last, label, reason);
    fputs("</div>\n<label><input type=\"checkbox\"/> hold</label></div>\n", stream);
    webp_free(&sheet);
    webp_free(&last);
    return code;
}
