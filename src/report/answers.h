/* What a report answers: its questions, answered by the statements of its experiments. */
#ifndef WISPLAB_ANSWERS_H
#define WISPLAB_ANSWERS_H

#include "base/files.h"
#include "report.h"

/* Writes the questions of a mask, bit k for question k: under each the rows that answer it, first
 * those that sum up, of no single figure, and the others in a fold. A question whose experiments
 * are not in the report is answered by that, with the reason. Returns 0, or -1 with one line in
 * `reason`. */
int answers_write(FILE *stream, const struct report *report, unsigned questions, char *reason);

#endif
