/* What is written into a folder: tables, each of which says where it comes from and what its
 * columns are, and statements. */
#ifndef WISPLAB_OUTPUT_H
#define WISPLAB_OUTPUT_H

#include "base/columns.h"
#include "base/files.h"
#include "statements.h"

/* A table's name, without .tsv, what it has, and its columns. */
struct table_form {
    const char *name, *what;
    const struct column *columns;
};

/* Opens folder/name.tsv and writes where it comes from, what its columns are, and their names.
 * Returns 0, or -1 with a reason. */
int open_table(struct atomic_file *file, const char *folder, const struct table_form *form,
               const struct scene *scene, char *reason);

/* Tables while they are written, and the statements of what they show. They get their names when
 * all are complete. */
struct output {
    const char *folder;
    char *reason; /* why something could not be written (REASON_SIZE) */
    int table_count;
    struct atomic_file *tables; /* owned */
    struct statements statements;
    int is_stated; /* whether these are open */
};

/* Opens a table; its stream, or NULL with output->reason. */
FILE *output_table(struct output *output, const char *name, const char *what,
                   const struct scene *scene, const struct column *columns);

/* Opens several; `prefix` stands before their names. Returns 0, or -1 with output->reason. */
int output_tables(struct output *output, FILE **streams, const struct table_form *forms, int count,
                  const char *prefix, const struct scene *scene);

/* Opens the statements: see statements_open. Returns 0, or -1 with output->reason. */
int output_statements(struct output *output, const struct scene *scene, const char *cut);

/* Ends what is open: gives all of it its name, or none where `code` is negative, or the tables
 * alone where it is positive, for then there is nothing to state. Returns the code, or -1 with
 * output->reason. */
int output_close(struct output *output, int code);

#endif
