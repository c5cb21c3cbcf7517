/* The exact constrained motion, as the limit of treatment `penalty` for stiff springs. */
#ifndef WISPLAB_LIMIT_H
#define WISPLAB_LIMIT_H

#include "model/trajectory.h"

/* Takes runs of `penalty` at `count` penalty ratios to their limit: those of the same frames become
 * one. Time, wisp and node are the first one's, which lends all but the numbers: free
 * limit->table.value. Returns 0, or -1 where memory cannot be had or they differ; that is NULL
 * then. */
int penalty_limit(const struct trajectory *const *runs, const double *ratio, int count,
                  struct trajectory *limit);

#endif
