/* An experiment on the page: folded under one sentence, its figures with what is stated of them,
 * its tables by their files. */
#ifndef WISPLAB_REPORT_PART_H
#define WISPLAB_REPORT_PART_H

#include "report.h"

/* All of these return 0 or more, or with one line in `reason` (REASON_SIZE) -1 where a file cannot
 * be read, a picture is not whole or nothing is stated of it. */

/* The whole part, in a fold; of a figure called `elsewhere` (NULL: none) only where it is. Returns
 * 0, -1, or 1 where a cell of a table is empty and nothing says why. */
int part_write(FILE *stream, const struct report *report, const struct report_part *part,
               const char *elsewhere, char *reason);

/* One figure, by its name without .svg or .png; returns whether it is there. */
int part_write_lead(FILE *stream, const struct report *report, const struct report_part *part,
                    const char *figure, char *reason);

/* A row of a table of claims with the thesis's that stands for the part, if it makes one; the
 * table begins before the `first`. Returns whether it makes one. */
int part_write_claim(FILE *stream, const struct report *report, const struct report_part *part,
                     int first, char *reason);

/* Its most telling sentence as an item of a list, with a link to the part. */
int part_write_headline(FILE *stream, const struct report *report, const struct report_part *part,
                        char *reason);

#endif
