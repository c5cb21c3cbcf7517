/* One page of everything: the answers, each experiment's figures and tables, methods, machine. */
#ifndef WISPLAB_REPORT_H
#define WISPLAB_REPORT_H

#include "base/files.h"
#include "experiments/common/plan.h"

enum { REPORT_PARTS_MAX = 64 };

/* An experiment's place in a report. */
struct report_part {
    const struct experiment *experiment;
    int included;           /* its tables and figures are in root/NAME */
    double since;           /* files there that are older, s since 1970, belong to another report */
    char note[REASON_SIZE]; /* what was cut, or why it is not included; may be empty if it is */
};

struct report {
    const char *root; /* folder of results; the page is root/report.html */
    int quick;
    const char *command; /* that made it, as it was typed; NULL: nobody knows */
    struct report_part parts[REPORT_PARTS_MAX];
    int part_count;
};

/* Writes root/report.html from the tables and figures that are there; no run is read, none made.
 * Returns 0, or -1 with one line in `reason`, and no page: a file cannot be read or written, or 1
 * with one where a cell of a table is empty and nothing says why. */
int report_write(const struct report *report, char *reason);

#endif
