/* Two folders of results held against each other, row by row. */
#ifndef WISPLAB_COMPARE_H
#define WISPLAB_COMPARE_H

/* What became of a row, or of one of its numbers. */
enum change { CHANGE_NONE, CHANGE_WORSE, CHANGE_BETTER, CHANGE_APPEARED, CHANGE_VANISHED, CHANGES };

struct compare_request {
    const char *older, *newer; /* folders of results */
    double tolerance;          /* relative: what differs by less is as it was */
    int with_times;            /* CPU times too, beyond both spreads */
};

/* One difference: `table` is "work-precision/swing", `row` its keys, `what` a sentence's rest:
 * "error 0.001, was 0.0001". */
struct difference {
    enum change change;
    char table[160], row[240], what[160];
};

/* All of them, in the tables' order. Owned; compare_free it. */
struct comparison {
    struct difference *differences;
    int count, capacity;
    int changes[CHANGES]; /* how many of each kind; CHANGE_NONE: rows that are as they were */
    char (*tables)[160];  /* that both folders have and whose rows have keys, in order */
    int table_count;
    int keyless; /* tables whose rows have none, as lines of a figure: not compared */
};

/* Compares the tables of every experiment that both folders have. A row is known by what it is
 * about (method, treatment, setting, ...); its error, force evaluations, CPU time, status and
 * verdict are looked at. Returns 0, or -1 with one line in `reason` (REASON_SIZE): a table is none,
 * or there is none in both. */
int compare_results(const struct compare_request *request, struct comparison *comparison,
                    char *reason);
void compare_free(struct comparison *comparison);

/* Writes the comparison for programs that run tests: a case for each table, failed where something
 * is worse. Returns 0, or -1 with one line in `reason`. */
int compare_write_junit(const struct comparison *comparison, const char *path, char *reason);

#endif
