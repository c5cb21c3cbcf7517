/* An experiment carried out: plan -> runs -> tables -> figures. */
#ifndef WISPLAB_CARRY_OUT_H
#define WISPLAB_CARRY_OUT_H

#include "plan.h"

/* How the runs are to be done. */
struct manner {
    int jobs; /* at a time */
    int fresh, show_progress;
    struct run_limits limits;
    int runs, new_runs; /* so far */
    int nothing_left;   /* all runs are there, but left nothing to tabulate: plan->reason */
};

/* Carries out plan->experiment and prints what came of it. Returns 0 or an exit code, having said
 * why on standard error. */
int run_experiment(struct plan *plan, struct manner *manner);

#endif
