/* The first page of a report: its questions, answered from the tables of its experiments. */
#ifndef WISPLAB_ANSWERS_H
#define WISPLAB_ANSWERS_H

#include "report.h"

/* Writes the section. A question whose experiments are not in the report is answered by that, with
 * the reason. Returns 0, or -1 with one line in `reason`, or 1 as report_write does. */
int answers_write(FILE *stream, const struct report *report, char *reason);

#endif
