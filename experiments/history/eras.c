/* The recipes, and how a run of one is compared with the exact motion. */
#include "history.h"

#include <math.h>

const char yardstick_scene[] = "swing";

/* Rosenblum et al. say 1/60 s, the thesis 9000 Hz; Anjyo et al. step with the frames, and Baraff
 * and Witkin nearly so. */
const struct era eras[ERAS] = {
    {.name = "Rosenblum 1991",
     .scene = "rosenblum",
     .stepper = "euler",
     .coarsest = 60,
     .levels = 19,
     .longest_run = 1e6},
    {.name = "Anjyo 1992",
     .scene = "anjyo",
     .stepper = "symplectic-euler",
     .coarsest = 30,
     .levels = 8},
    {.name = "Baraff-Witkin 1998",
     .scene = "swing",
     .stepper = "implicit-euler",
     .treatment = "generalised",
     .linear = "direct",
     .coarsest = 60,
     .levels = 11},
    {.name = "Plante 1999",
     .scene = "swing",
     .stepper = "euler",
     .treatment = "projection",
     .coarsest = 2250,
     .levels = 7,
     .own = 2},
    {.name = "today",
     .scene = "swing",
     .stepper = "bdf2",
     .treatment = "generalised",
     .coarsest = 60,
     .levels = 9,
     .own = -1},
};

int read_reference(struct plan *plan, const struct labelled_case *one, struct run_files *run) {
    if (plan_read(plan, one, run))
        return -1;
    if (run->outcome == FINISHED)
        return 0;
    snprintf(plan->reason, REASON_SIZE,
             "scene %s: no reference solution to compare with: %s; try --fresh and --time-limit",
             one->run.scene->name, outcome_name(run->outcome));
    run_free(run);
    return 1;
}

int read_compared(struct plan *plan, const struct labelled_case *one,
                  const struct run_files *reference, struct run_files *run, double *error) {
    struct deviation deviation;
    *error = NAN;
    if (plan_read(plan, one, run))
        return -1;
    if (run->outcome != FINISHED)
        return 0;
    const int code = measure_deviation(one->run.scene, run->states, reference->states, 1,
                                       &deviation, plan->reason);
    *error = deviation.rms;
    if (code)
        run_free(run);
    return code;
}
