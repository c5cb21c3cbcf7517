/* The exact constrained motion, as the limit of treatment `penalty` for stiff springs. */
#ifndef WISPLAB_LIMIT_H
#define WISPLAB_LIMIT_H

#include "base/table.h"

/* Takes states of `penalty` at `count` penalty ratios to their limit: tables of the same frames and
 * rows become one; time, wisp and node are the first one's, and so are the names, which it lends.
 * Free limit->value. Returns 0, or -1 where memory cannot be had or the tables differ; limit->value
 * is NULL then. */
int penalty_limit(const struct table *const *tables, const double *ratio, int count,
                  struct table *limit);

#endif
