/* The runs of a sweep, shared by any number of processes on any number of machines. */
#ifndef WISPLAB_SHARE_H
#define WISPLAB_SHARE_H

#include "sweep.h"

/* Does what is to be done of a plan, `jobs` runs at a time; what others do is waited for. `sink` is
 * what does a run: sweep_sink. Returns 0, or the outcome with one line in `reason` where results
 * cannot be written or the user ended it. A run that was killed from outside twice is left out: its
 * cells are NULL then. *ran is the number of runs that this process did. */
enum outcome sweep_share(struct sweep *sweep, const struct run_sink *sink,
                         const struct run_limits *limits, int jobs, int show_progress, int *ran,
                         char *reason);

#endif
