/* Reading back what runs have written. */
#ifndef WISPLAB_RESULTS_H
#define WISPLAB_RESULTS_H

#include "base/files.h"
#include "base/outcome.h"

#include <jansson.h>

enum { TABLE_COLUMNS_MAX = 128 };

/* A table of numbers: `#` lines skipped, one line of column names, rows of equal length. */
struct table {
    int column_count, row_count;
    char *name[TABLE_COLUMNS_MAX];
    double *value; /* row by row */
};

/* Returns 0, or -1 with one line in `reason`: file, line, what is wrong. */
int table_read(struct table *table, const char *path, char *reason);
void table_free(struct table *table);

/* Index of a column, or -1; and a number of a row. */
int table_column(const struct table *table, const char *name);
double table_value(const struct table *table, int row, int column);

/* A run's folder read back. */
struct run_files {
    json_t *json; /* run.json */
    struct table states;
    enum outcome outcome;
};

int run_read(struct run_files *run, const char *folder, char *reason);
void run_free(struct run_files *run);

/* A number of run.json by its path, "counters.steps"; NaN where there is none. */
double run_number(const struct run_files *run, const char *path);

/* Median, least and greatest of the repeated CPU times, s; NaN where there are none. */
struct spread {
    double median, least, greatest;
};
struct spread run_cpu_time(const struct run_files *run);

#endif
