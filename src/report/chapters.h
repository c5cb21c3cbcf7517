/* The chapters of the page, one for each thing that its reader wants to know. */
#ifndef WISPLAB_REPORT_CHAPTERS_H
#define WISPLAB_REPORT_CHAPTERS_H

#include "page.h"

/* Links to the chapters, for a list of contents. */
void chapters_write_links(FILE *stream);

/* The figures that the page begins with, where their experiments are in it. Returns as
 * report_write. */
int chapters_write_front(const struct page *page);

/* All chapters, each with what answers its question, its figure, a table of few rows, and its
 * experiments in folds. Returns as report_write. */
int chapters_write(const struct page *page);

#endif
