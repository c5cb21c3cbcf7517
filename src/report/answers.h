/* The first page of a report: its questions, answered by the statements of its experiments. */
#ifndef WISPLAB_ANSWERS_H
#define WISPLAB_ANSWERS_H

#include "base/files.h"
#include "report.h"

/* Writes the section: under each question the rows that answer it, first those that sum up, of no
 * single figure. A question whose experiments are not in the report is answered by that, with the
 * reason. Returns 0, or -1 with one line in `reason`. */
int answers_write(FILE *stream, const struct report *report, char *reason);

#endif
