/* Experiments that measure here and now, by a program of its own: wisplab-bench. */
#ifndef WISPLAB_BENCH_H
#define WISPLAB_BENCH_H

#include "plan.h"

/* Lets it take a measurement, "kernel" or "speed", on a scene with the user's changes, and write
 * tables and statements into the folder of plan->output. As an experiment's tabulate. */
int bench_run(struct plan *plan, const char *measurement, const char *scene);

#endif
