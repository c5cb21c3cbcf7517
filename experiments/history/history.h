/* What came before the thesis, and what came after: its chapter 3 and section 2.3 as runs. */
#ifndef WISPLAB_HISTORY_H
#define WISPLAB_HISTORY_H

#include "experiments/common/measure.h"
#include "experiments/common/statements.h"

/* --- eras.c --- */

/* A way to animate hair, as its authors ran it: a problem with a stepper. */
struct era {
    const char *name; /* in tables: who and when */
    const char *scene, *stepper;
    const char *treatment, *linear; /* NULL: as usual */
    double coarsest;                /* Hz: the first of a ladder of rates, each twice the last */
    int levels;
    int own;            /* which level is its authors' choice; -1: the cheapest within 1 mm */
    double longest_run; /* Hz: rates above it are left out with --quick; 0: none */
};
enum { ERAS = 5 };
extern const struct era eras[ERAS];

/* The scene whose exact motion all are compared with. */
extern const char yardstick_scene[];

/* A run's states, and how far it is from another, both of 30 frames a second. The states are to be
 * freed with run_free. `error` is rms over free nodes and frames, m, NaN where the run did not
 * finish. Returns 0, or -1 with plan->reason. */
int read_compared(struct plan *plan, const struct labelled_case *one,
                  const struct run_files *reference, struct run_files *run, double *error);

/* Reads a reference run, which must have finished. Returns 0, or -1 or 1 with plan->reason. */
int read_reference(struct plan *plan, const struct labelled_case *one, struct run_files *run);

/* --- recipes.c: error against cost, and the films --- */

int recipes_plan(struct plan *plan);
int recipes_tabulate(struct plan *plan);

/* --- stiffness_map.c: Rosenblum's hair by stiffness and rate --- */

int stiffness_map_plan(struct plan *plan);
int stiffness_map_tabulate(struct plan *plan);

/* --- news.c: how fast a step carries news --- */

int news_tabulate(struct plan *plan);

#endif
