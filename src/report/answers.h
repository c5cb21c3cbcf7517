/* What a report answers: its questions, answered by the statements of its experiments. */
#ifndef WISPLAB_ANSWERS_H
#define WISPLAB_ANSWERS_H

#include "page.h"

/* Writes a question and the rows that answer it: first those that sum up, of no single figure, and
 * where there are many the others in a fold. A question whose experiments are not in the report is
 * answered by that. */
void answers_write(const struct page *page, enum question question);

#endif
