/* The search for the coarsest setting that is still good, by rounds of runs: where on the scale it
 * is, and what the runs of a place have shown. */
#ifndef WISPLAB_SEARCH_H
#define WISPLAB_SEARCH_H

#include "measure.h"

/* Settings are places on a geometric scale, 0 the coarsest. */
struct bracket {
    int at;              /* the place that is tried */
    int coarsest;        /* there is none before */
    int missed, reached; /* the finest known to miss, the coarsest known to reach; or -1 */
};
struct bracket bracket_begin(int at, int coarsest);

/* What the place `at` has shown. Moves `at` to the next place: by `stride` while one side of the
 * bracket is unknown, then by halves. Returns 0 where there is none: the sides are no farther apart
 * than `resolution`, or the coarsest place reaches. */
int bracket_take(struct bracket *bracket, int reached, int stride, int resolution);

/* The step of a place, s, with `stride` places to the octave: it divides `interval`. */
double place_step(double interval, int stride, int place);

/* The coarsest place of which the step is at most `step`. */
int step_place(double interval, int stride, double step);

/* What runs have shown. */
struct verdict {
    double error; /* the worst, rms over free nodes and all frames, m; NaN: one did not finish */
    enum outcome outcome;
    double failure_time; /* s */
};

/* Judges the `count` cases of the plan from `first` on, runs of `scene`, up to the first that did
 * not finish. Returns 0, or -1 with plan->reason. */
int judge_runs(struct plan *plan, int first, int count, const struct scene *scene,
               const struct run_files *reference, struct verdict *verdict);

/* The searches of a cell, whose runs are judged by one reference solution. */
struct searches {
    int reference; /* its case in the plan */
    int count;
    void *ctx;
    int (*is_done)(const void *ctx, int i);
    /* Takes what the runs of search i have shown, and plans its next ones. Returns 0, or -1 with
     * plan->reason. */
    int (*go_on)(struct plan *plan, void *ctx, int i, const struct run_files *reference);
};

/* A round of those that are not done. Returns 0, or -1 with plan->reason. */
int searches_go_on(struct plan *plan, const struct searches *searches);

/* What the run of a case cost. Returns 0, or -1 with plan->reason. */
int read_cost(struct plan *plan, int at, struct cost *cost);

#endif
