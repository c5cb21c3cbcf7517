/* Tables with words in them: what an experiment leaves, read back for a report. */
#ifndef WISPLAB_TEXT_TABLE_H
#define WISPLAB_TEXT_TABLE_H

#include "files.h"

/* `#` lines, one line of column names, rows; blank lines between blocks do not count. A row's last
 * cell is all that is left of its line. */
struct text_table {
    int column_count, row_count;
    char **name;   /* of columns */
    char **cell;   /* row by row */
    char *about;   /* the first `#` line, without it; empty where there is none */
    char *content; /* owned; all others point into it */
};

/* Returns 0, or -1 with one line in `reason`: file, line, what is wrong. */
int text_table_read(struct text_table *table, const char *path, char *reason);
void text_table_free(struct text_table *table);

/* Index of a column, or -1. */
int text_table_column(const struct text_table *table, const char *name);

/* A cell by its column's name: its text, empty where there is no such column; as a number, NaN
 * where it is none. */
const char *text_table_cell(const struct text_table *table, int row, const char *name);
double text_table_number(const struct text_table *table, int row, const char *name);

/* Whether nothing stands in a cell: no letter, or nan. */
int text_cell_is_empty(const char *cell);

/* Whether every empty cell has a reason in its row: a status other than `finished`, or words in a
 * column that is there for words (note, reason, limit, comparison); the time of a failure needs
 * none where the run finished. A table that has no such column says in its first line what
 * `nan: ` means. Returns 0, or -1 with one line in `reason`: file, row, column. */
int text_table_check(const struct text_table *table, const char *path, char *reason);

#endif
