/* Tables of numbers, read back. */
#ifndef WISPLAB_TABLE_H
#define WISPLAB_TABLE_H

enum { TABLE_COLUMNS_MAX = 128 };

/* A table of numbers: `#` lines skipped, one line of column names, rows of equal length; or a
 * numpy array with named columns (npy.h). */
struct table {
    int column_count, row_count;
    char *name[TABLE_COLUMNS_MAX]; /* owned */
    double *value;                 /* row by row; owned */
};

/* Returns 0, or -1 with one line in `reason` (REASON_SIZE): file, line, what is wrong. */
int table_read(struct table *table, const char *path, char *reason);
void table_free(struct table *table);

/* Index of a column, or -1; and a number of a row. */
int table_column(const struct table *table, const char *name);
double table_value(const struct table *table, int row, int column);

#endif
