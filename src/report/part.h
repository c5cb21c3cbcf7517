/* An experiment on the page: folded under one sentence, its figures with what is stated of them,
 * its tables by their files. */
#ifndef WISPLAB_REPORT_PART_H
#define WISPLAB_REPORT_PART_H

#include "page.h"

/* The whole part, in a fold; of a figure called `elsewhere` (NULL: none) only where it is. Returns
 * 0; or with a reason -1 where a file cannot be read, a picture is not whole or nothing is stated
 * of it, or 1 where a cell of a table is empty and nothing says why. */
int part_write(const struct page_part *part, const char *elsewhere);

/* One figure, if it is there, by its name without .svg or .png. Returns 0, or -1 as above. */
int part_write_lead(const struct page_part *part, const char *figure);

/* A row of a table of claims with the thesis's that stands for the part, if it makes one; the
 * table begins before the `first`. Returns whether it makes one. */
int part_write_claim(const struct page_part *part, int first);

/* Its most telling sentence as an item of a list, with a link to the part. */
void part_write_headline(const struct page_part *part);

#endif
