/* How methods fail at steps that are too long: the runs that show it, and their table. */
#include "stability_limits.h"

#include <math.h>
#include <string.h>

/* --- the runs --- */

/* A run that the table of failures is to have. */
static int add_failure(struct plan *plan, const struct cell *cell,
                       const struct configuration *configuration, double step) {
    const struct run_request request = limits_request(cell, configuration, step);
    char group[128];
    snprintf(group, sizeof group, "failures, %s", cell->name);
    return plan_add(plan, cell->scene, &request, group, "%s", configuration->name);
}

/* The step above the limit, and longer ones as far as the clock lets them be. */
int limits_plan_failures(struct plan *plan, const struct cell *cell, const struct trial *trial) {
    static const double beyond[] = {1, 4. / 3, 2, 4};
    double last = 0;
    for (size_t k = 0; k < sizeof beyond / sizeof *beyond; k++) {
        const double missed = limits_step(cell, trial->place.missed);
        const double step = limits_step(cell, limits_place(cell, beyond[k] * missed));
        if (step > last && add_failure(plan, cell, trial->configuration, step))
            return -1;
        last = fmax(last, step);
    }
    return 0;
}

int limits_plan_known(struct plan *plan, const struct cell *cell) {
    static const struct {
        const char *stepper;
        double rate;
    } known[] = {{"euler", 9000}, {"euler", 8000}, {"euler", 7000}, {"rk4", 4000}, {"rk4", 3000}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        for (int i = 0; i < plan->configuration_count; i++)
            if (plan->configurations[i].method == stepper_find(known[k].stepper) &&
                add_failure(plan, cell, &plan->configurations[i], 1 / known[k].rate))
                return -1;
    return 0;
}

/* --- the table --- */

static const struct trial *trial_of(const struct cell *cell, const char *stepper) {
    for (int i = 0; i < cell->trial_count; i++)
        if (strcmp(cell->trials[i].configuration->name, stepper) == 0)
            return &cell->trials[i];
    return NULL;
}

#define FAILURE_COLUMNS(X)                                                                         \
    SCENE_COLUMN(X, cell->subject)                                                                 \
    TREATED_COLUMN(X, limits_treatment(cell))                                                      \
    CONFIGURATION_COLUMN(X, "stepper", one->label)                                                 \
    X("step", "s", "length of a step", "%.9g", step)                                               \
    X("rate", "Hz", "rate of the steps, 1 / step", "%.9g", 1 / step)                               \
    X("kind", "-", "how the run ended", "%s", stable ? "stable" : outcome_name(run.outcome))       \
    X("time", "s", "simulated time at which it failed", "%.9g",                                    \
      stable ? (double)NAN : run_number(&run, "failure_time"))                                     \
    X("finite", "-", "whether the state stays finite", "%s",                                       \
      run.outcome == NOT_FINITE ? "no" : "yes")                                                    \
    X("error", "m", "error of the frames before that, rms over free nodes", "%.9g", deviation.rms) \
    X("largest_error", "m", "largest error of a node in the frames before that", "%.9g",           \
      deviation.largest)                                                                           \
    X("order", "-", "kept or lost: whether the error is what shorter steps predict", "%s",         \
      !stable                     ? "-"                                                            \
      : deviation.rms <= in_order ? "kept"                                                         \
                                  : "lost")

static int write_failure(struct plan *plan, FILE *stream, const struct cell *cell,
                         const struct labelled_case *one, const struct run_files *reference) {
    const double step = one->run.settings.step;
    struct run_files run;
    struct deviation deviation;
    if (plan_read(plan, one, &run))
        return -1;
    const int code =
        measure_deviation(cell->scene, run.states, reference->states, 1, &deviation, plan->reason);
    const int stable = run.outcome == FINISHED;
    const double in_order = limits_allowed(cell, trial_of(cell, one->label), IN_ORDER, step);
    if (!code)
        WRITE_ROW(stream, FAILURE_COLUMNS);
    run_free(&run);
    return code;
}

static int write_cell_failures(struct plan *plan, FILE *stream, const struct cell *cell) {
    struct run_files reference;
    char group[128];
    int code = 0;
    snprintf(group, sizeof group, "failures, %s", cell->name);
    if (plan_read(plan, &plan->cases[cell->reference], &reference))
        return -1;
    for (int i = 0; i < plan->case_count && reference.outcome == FINISHED && !code; i++)
        if (strcmp(plan->cases[i].group, group) == 0)
            code = write_failure(plan, stream, cell, &plan->cases[i], &reference);
    run_free(&reference);
    return code;
}

int limits_write_failures(struct plan *plan) {
    const struct limits *limits = plan->memo;
    FILE *stream = output_table(
        &plan->output, "failures",
        "how methods fail at steps that are too long: kind, when it first shows, whether the state "
        "stays finite, and the error of the frames before, m (rms, largest); order: lost with more "
        "than ten times the error that it predicts from shorter steps, and more than 0.1 mm; nan: "
        "of time, it does not fail; of errors, there is no frame to compare",
        plan->subjects[0].scene, COLUMNS(FAILURE_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < limits->cell_count; i++)
        if (!limits->cells[i].axis && write_cell_failures(plan, stream, &limits->cells[i]))
            return -1;
    return 0;
}
