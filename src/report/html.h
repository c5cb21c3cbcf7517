/* Writing a page that is well-formed XML and HTML at once. */
#ifndef WISPLAB_HTML_H
#define WISPLAB_HTML_H

#include "base/text_table.h"

enum {
    HTML_ROWS_MAX = 24,  /* of a table that is on the page as a whole */
    HTML_ROWS_HEAD = 12, /* that are shown of a longer one; its file has them all */
};

/* Text as it is: no character in it is markup. */
void html_text(FILE *stream, const char *text);

/* Writes a text that printf makes, escaped. */
void html_print(FILE *stream, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A text in an element, whose `tag` may have attributes behind its name, and what follows it. */
void html_element(FILE *stream, const char *tag, const char *text, const char *after);

/* A cell of a table; a short name with hyphens, as `viscosity-50`, is not broken there. */
void html_cell(FILE *stream, const char *text);

/* A column of a table as it is shown: its heading, and what its numbers are multiplied with. */
struct html_column {
    const char *name, *heading;
    double factor; /* 0: 1 */
};

/* A table with its numbers to four digits. Of more than HTML_ROWS_MAX rows only the first, and how
 * many there are. `columns` are those to be shown, in their order, up to one without a name; NULL:
 * all, as they are called. */
void html_table(FILE *stream, const struct text_table *table, const struct html_column *columns);

/* Rows of an experiment's statements. Whether a row is a claim of the thesis: */
int html_is_claim(const struct text_table *rows, int row);

/* A row in one sentence: of a claim with its verdict, of what we found with what came of it where
 * nothing could be found; and the same as an item of a list. */
void html_sentence(FILE *stream, const struct text_table *rows, int row);
void html_statement(FILE *stream, const struct text_table *rows, int row);

/* What a row shows, as a title: of a claim that does not hold also what was found. */
void html_title(FILE *stream, const struct text_table *rows, int row);

/* A table of claims: what the thesis says, what was found, the verdict. `part` (NULL: none) is the
 * experiment to which a row leads. */
void html_claims_begin(FILE *stream);
void html_claim(FILE *stream, const struct text_table *rows, int row, const char *part);
void html_claims_end(FILE *stream);

/* The picture of an .svg file, part of the page: made fit by svg_write; `label` is what it shows,
 * for who cannot see it. Returns 0, or -1 with one line in `reason`. */
int html_svg(FILE *stream, const char *path, const char *prefix, const char *label, char *reason);

/* Puts a .png file into the page, as WebP. */
int html_png(FILE *stream, const char *path, const char *label, char *reason);

/* Puts a film into the page: a .png file in which so many frames of one height are below each
 * other, 30 for a second, shown at half their speed again and again. It needs no script; who wants
 * no motion, or prints, sees the last frame. */
int html_film(FILE *stream, const char *path, int frames, const char *label, char *reason);

#endif
