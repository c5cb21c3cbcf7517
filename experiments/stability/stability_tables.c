/* The tables and the answer of the searches for the longest stable step. */
#include "base/files.h"
#include "stability_limits.h"

#include <math.h>

/* --- the tables --- */

static const char *kind_of(const struct trial *trial) {
    return trial->place.missed < 0             ? "none"
           : trial->missed.outcome != FINISHED ? outcome_name(trial->missed.outcome)
                                               : "wrong";
}

/* The longest stable step, s; of adaptive methods the mean one. */
static double largest_step(const struct cell *cell, const struct trial *trial) {
    if (contestant_is_adaptive(trial->contestant))
        return trial->cost.outcome == FINISHED
                   ? cell->scene->duration * cell->scene->wisp_count / trial->cost.steps
                   : NAN;
    return limits_step(cell, trial->place.reached);
}

/* A predicted step, s, in a table or to be read. */
struct prediction {
    char text[32];
};

static struct prediction prediction_of(const struct trial *trial, int digits) {
    struct prediction said = {"no prediction"};
    if (!isnan(trial->predicted))
        snprintf(said.text, sizeof said.text, "%.*g", digits, trial->predicted);
    return said;
}

/* Rows of a method along an axis; blocks are parted by two blank lines. */
static void write_along(FILE *stream, const struct limits *limits, const struct axis *axis,
                        const struct configuration *contestant) {
    for (int i = 0; i < limits->cell_count; i++) {
        const struct cell *cell = &limits->cells[i];
        for (int k = 0; cell->axis == axis && k < cell->trial_count; k++) {
            const struct trial *t = &cell->trials[k];
            if (t->contestant == contestant)
                fprintf(stream, "%s\t%g\t%s\t%.9g\t%.9g\t%s\t%s\n", axis->name, cell->value,
                        contestant->name, largest_step(cell, t), limits_step(cell, t->place.missed),
                        prediction_of(t, 9).text, kind_of(t));
        }
    }
    fprintf(stream, "\n\n");
}

static int write_limits(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    struct atomic_file file;
    if (open_table(
            &file, folder, "limits",
            "longest stable step, s, over 0.5 s of swing (penalty_ratio: of swing-envelope "
            "with penalty), the next that is not, and the prediction of linear theory "
            "at the eigenvalues of the wisp linearised at its start (inf: any step; no prediction: "
            "there is no theory of the method); nan: of step, none that was tried is stable; of "
            "unstable_step, all are",
            plan->loaded[0], "axis\tvalue\tstepper\tstep\tunstable_step\tpredicted\tkind",
            plan->reason))
        return -1;
    for (int a = 0; a < AXES; a++)
        for (int c = 0; c < plan->configuration_count; c++)
            write_along(file.stream, limits, &limits_axes[a], &plan->configurations[c]);
    return atomic_commit(&file, plan->reason);
}

static void write_largest(FILE *stream, const struct cell *cell, const struct trial *t) {
    const double step = largest_step(cell, t);
    const int adaptive = contestant_is_adaptive(t->contestant);
    fprintf(stream, "%s\t%s\t%s\t%.17g\t%.9g\t%s\t%.17g\t%s\t%.9g\t%.9g\t%.9g\t%s\n", cell->subject,
            limits_treatment(cell), t->contestant->name, step, 1 / step, prediction_of(t, 9).text,
            limits_step(cell, t->place.missed), adaptive ? "chooses its steps" : kind_of(t),
            t->missed.failure_time, t->error, t->cost.cpu.median / cell->scene->duration,
            adaptive ? "mean step at rtol 1e-3" : t->note);
}

static int write_scenes(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    struct atomic_file file;
    if (open_table(
            &file, folder, "largest-step",
            "the longest stable step of each stepper, s, on the first half second of scenes: what "
            "it is, its rate in Hz, the predicted one, the next that is not stable with how and "
            "when that fails, the error of the stable one, m, and its CPU time per simulated s; "
            "steps divide the time between stops of the clock; predicted is inf where there is no "
            "bound, and no prediction where there is no theory of the method, or too many unknowns "
            "for eigenvalues; nan: of step, none that was tried is stable; of what fails, none "
            "does",
            plan->subjects[0].scene,
            "scene\ttreatment\tstepper\tstep\trate\tpredicted\tunstable_step\tkind\ttime\terror\t"
            "cpu_per_second\tnote",
            plan->reason))
        return -1;
    for (int i = 0; i < limits->cell_count; i++)
        for (int k = 0; !limits->cells[i].axis && k < limits->cells[i].trial_count; k++)
            write_largest(file.stream, &limits->cells[i], &limits->cells[i].trials[k]);
    return atomic_commit(&file, plan->reason);
}

/* --- the answer --- */

static void print_trial(const struct cell *cell, const struct trial *t) {
    const double step = largest_step(cell, t);
    printf("  %-28s %-16s %9.3g %9.0f %13s  ", cell->name, t->contestant->name, step, 1 / step,
           prediction_of(t, 3).text);
    if (contestant_is_adaptive(t->contestant))
        printf("chooses its steps: the mean at rtol %g", LIMITS_TOLERANCE);
    else if (t->place.missed >= 0 && t->missed.outcome == FINISHED)
        printf("finite and wrong by %.2g mm at the next", 1e3 * t->missed.error);
    else if (t->place.missed >= 0)
        printf("%s at %.3g s at the next", kind_of(t), t->missed.failure_time);
    else
        printf("%s", t->note);
    printf("\n");
}

/* How far the measured limits of the axes are from the predicted ones. */
static void print_agreement(const struct limits *limits) {
    double least = INFINITY, greatest = 0;
    for (int i = 0; i < limits->cell_count; i++)
        for (int k = 0; limits->cells[i].axis && k < limits->cells[i].trial_count; k++) {
            const struct trial *t = &limits->cells[i].trials[k];
            const double ratio = largest_step(&limits->cells[i], t) / t->predicted;
            if (t->place.missed >= 0 && ratio > 0 && isfinite(ratio)) {
                least = fmin(least, ratio);
                greatest = fmax(greatest, ratio);
            }
        }
    if (greatest > 0)
        printf("  along EA, damping, nodes and penalty ratio: %.2f to %.2f of the predicted step\n",
               least, greatest);
}

int limits_tabulate(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    if (write_limits(plan, folder) || write_scenes(plan, folder) ||
        limits_write_failures(plan, folder))
        return -1;
    printf("  %-28s %-16s %9s %9s %13s  %s\n", "scene, treatment", "stepper", "step, s", "Hz",
           "predicted", "a step longer");
    for (int i = 0; i < limits->cell_count; i++)
        for (int k = 0; !limits->cells[i].axis && k < limits->cells[i].trial_count; k++)
            print_trial(&limits->cells[i], &limits->cells[i].trials[k]);
    print_agreement(limits);
    if (plan->scene_count)
        printf(
            "  the axes EA, damping, nodes, penalty ratio are those of swing: not with --scene\n");
    else if (plan->quick)
        printf("  --quick: two values of EA and of nodes only, no envelope, brackets of 12 %%\n");
    return 0;
}
