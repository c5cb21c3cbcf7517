/* Tables that say what their columns are: one list makes the `#` lines, the names and the rows. */
#ifndef WISPLAB_COLUMNS_H
#define WISPLAB_COLUMNS_H

#include <stdio.h>

/* What a column is: its name, its unit ("1" for a number without one, "-" for words), and what
 * stands in it, as a phrase in one line. */
struct column {
    const char *name, *unit, *meaning;
};

/* A table's columns are a macro LIST(X) of rows X(name, unit, meaning, format, value), of which
 * `format` is printf's and `value` an expression in the names that are known where rows are
 * written. So a table cannot have a column that nothing describes, nor a row with other cells than
 * the columns that it names. */
/* clang-format off */
#define COLUMNS(LIST) ((const struct column[]){LIST(COLUMN_AS_STRUCT){0}})
/* clang-format on */
#define WRITE_ROW(stream, LIST) \
    ((void)fprintf(stream, &(LIST(COLUMN_AS_FORMAT) "\n")[1] LIST(COLUMN_AS_VALUE)))

#define COLUMN_AS_STRUCT(name, unit, meaning, format, value) {name, unit, meaning},
#define COLUMN_AS_FORMAT(name, unit, meaning, format, value) "\t" format
#define COLUMN_AS_VALUE(name, unit, meaning, format, value)  , value

/* Writes a line "# name, unit: meaning" for each column up to one without a name, and the line of
 * their names. */
void columns_write(FILE *stream, const struct column *columns);

#endif
