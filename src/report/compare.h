/* Two folders of results held against each other, row by row. */
#ifndef WISPLAB_COMPARE_H
#define WISPLAB_COMPARE_H

/* What became of a row, or of one of its numbers. */
enum change { CHANGE_NONE, CHANGE_WORSE, CHANGE_BETTER, CHANGE_APPEARED, CHANGE_VANISHED, CHANGES };

struct compare_request {
    const char *older, *newer; /* folders of results */
    double tolerance;          /* relative: what differs by less is as it was */
    int with_times;            /* CPU times too, beyond both spreads */
    int complete;              /* what vanished is a failure, as what got worse is */
};

/* One difference: `table` is "work-precision/swing", `row` its keys ("column error" and "the whole
 * table" are such as vanish too), `what` a sentence's rest: "error 0.001, was 0.0001". */
struct difference {
    enum change change;
    char table[160], row[240], what[160];
};

/* A table of either folder. */
struct compared_table {
    char name[160];
    const char *left_out; /* why nothing in it was compared; NULL: something was */
    int alone;            /* one of the folders has none of that name, and that is a difference */
    int failures;         /* differences for which compare ends with an error */
};

/* All of them, in the tables' order. Owned; compare_free it. */
struct comparison {
    struct difference *differences;
    int count, capacity;
    int changes[CHANGES]; /* how many of each kind; CHANGE_NONE: rows that are as they were */
    struct compared_table *tables;
    int table_count, left_out; /* left_out: how many of them that both have */
    int complete;              /* as it was asked for */
};

/* Compares the tables of every experiment and sweep that both folders have. A row is known by what
 * it is about (method, treatment, setting, ...; row_join.h); its errors, force evaluations, CPU
 * time, status and verdict are looked at. Returns 0, or -1 with one line in `reason` (REASON_SIZE):
 * a table is none, or in none that both have there is anything to be looked at. */
int compare_results(const struct compare_request *request, struct comparison *comparison,
                    char *reason);
void compare_free(struct comparison *comparison);

/* Whether a difference is one for which compare ends with an error. */
int compare_is_failure(const struct comparison *comparison, const struct difference *difference);

/* Writes the comparison for programs that run tests: a case for each table, failed where something
 * is a failure, skipped where nothing was looked at. Returns 0, or -1 with one line in `reason`. */
int compare_write_junit(const struct comparison *comparison, const char *path, char *reason);

#endif
