/* Writing a page that is well-formed XML and HTML at once. */
#ifndef WISPLAB_HTML_H
#define WISPLAB_HTML_H

#include "base/text_table.h"

enum {
    HTML_ROWS_MAX = 150, /* of a table that is on the page as a whole */
    HTML_ROWS_HEAD = 8,  /* that are shown of a longer one; its file has them all */
};

/* Text as it is: no character in it is markup. */
void html_text(FILE *stream, const char *text);

/* The same of a text that printf makes. */
void html_print(FILE *stream, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A table with its numbers to four digits. Of more than HTML_ROWS_MAX rows only the first, and how
 * many there are. `columns` are those to be shown, in their order, NULL-terminated; NULL: all. */
void html_table(FILE *stream, const struct text_table *table, const char *const *columns);

/* A row of an experiment's statements as an item of a list: verdict, whose it is, sentence. */
void html_statement(FILE *stream, const struct text_table *rows, int row);

/* The picture of an .svg file, part of the page: its ids, and what refers to them, begin with
 * `prefix`, so that no two pictures share one; `label` is what it shows, for who cannot see it.
 * Returns 0, or -1 with one line in `reason`. */
int html_svg(FILE *stream, const char *path, const char *prefix, const char *label, char *reason);

/* Likewise of a .png file, which is put into the page as it is. */
int html_png(FILE *stream, const char *path, const char *label, char *reason);

#endif
