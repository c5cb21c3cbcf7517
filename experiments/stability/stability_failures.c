/* How methods fail at steps that are too long: the runs that show it, and their table. */
#include "base/files.h"
#include "stability_limits.h"

#include <math.h>
#include <string.h>

/* --- the runs --- */

/* A run that the table of failures is to have. */
static int add_failure(struct plan *plan, const struct cell *cell,
                       const struct configuration *contestant, double step) {
    const struct run_request request = limits_request(cell, contestant, step);
    char group[128];
    snprintf(group, sizeof group, "failures, %s", cell->name);
    return plan_add(plan, cell->scene, &request, group, "%s", contestant->name);
}

/* The step above the limit, and longer ones as far as the clock lets them be. */
int limits_plan_failures(struct plan *plan, const struct cell *cell, const struct trial *trial) {
    static const double beyond[] = {1, 4. / 3, 2, 4};
    double last = 0;
    for (size_t k = 0; k < sizeof beyond / sizeof *beyond; k++) {
        const double missed = limits_step(cell, trial->place.missed);
        const double step = limits_step(cell, limits_place(cell, beyond[k] * missed));
        if (step > last && add_failure(plan, cell, trial->contestant, step))
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
        if (strcmp(cell->trials[i].contestant->name, stepper) == 0)
            return &cell->trials[i];
    return NULL;
}

static int write_failure(struct plan *plan, FILE *stream, const struct cell *cell,
                         const struct labelled_case *one, const struct run_files *tight) {
    const double step = one->run.settings.step;
    struct run_files run;
    struct deviation deviation;
    if (run_read_states(&run, one->run.folder, plan->trajectories, plan->reason))
        return -1;
    const int code =
        measure_deviation(cell->scene, run.states, tight->states, 1, &deviation, plan->reason);
    const int stable = run.outcome == FINISHED;
    const double in_order = limits_allowed(cell, trial_of(cell, one->label), IN_ORDER, step);
    if (!code)
        fprintf(stream, "%s\t%s\t%s\t%.9g\t%.9g\t%s\t%.9g\t%s\t%.9g\t%.9g\t%s\n", cell->subject,
                limits_treatment(cell), one->label, step, 1 / step,
                stable ? "stable" : outcome_name(run.outcome),
                stable ? NAN : run_number(&run, "failure_time"),
                run.outcome == NOT_FINITE ? "no" : "yes", deviation.rms, deviation.largest,
                !stable                     ? "-"
                : deviation.rms <= in_order ? "kept"
                                            : "lost");
    run_free(&run);
    return code;
}

static int write_cell_failures(struct plan *plan, FILE *stream, const struct cell *cell) {
    struct run_files tight;
    char group[128];
    int code = 0;
    snprintf(group, sizeof group, "failures, %s", cell->name);
    if (run_read_states(&tight, plan->cases[cell->tight].run.folder, plan->trajectories,
                        plan->reason))
        return -1;
    for (int i = 0; i < plan->case_count && tight.outcome == FINISHED && !code; i++)
        if (strcmp(plan->cases[i].group, group) == 0)
            code = write_failure(plan, stream, cell, &plan->cases[i], &tight);
    run_free(&tight);
    return code;
}

int limits_write_failures(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    struct atomic_file file;
    if (open_table(
            &file, folder, "failures",
            "how methods fail at steps that are too long: kind, when it first shows, "
            "whether the state stays finite, and the error of the frames before, m (rms, "
            "largest); order: lost with more than ten times the error that it foretells from "
            "shorter "
            "steps, and more than 0.1 mm; nan: of time, it does not fail; of errors, there is no "
            "frame to compare",
            plan->subjects[0].scene,
            "scene\ttreatment\tstepper\tstep\trate\tkind\ttime\tfinite\terror\tlargest_error"
            "\torder",
            plan->reason))
        return -1;
    for (int i = 0; i < limits->cell_count; i++)
        if (!limits->cells[i].axis && write_cell_failures(plan, file.stream, &limits->cells[i])) {
            atomic_discard(&file);
            return -1;
        }
    return atomic_commit(&file, plan->reason);
}
