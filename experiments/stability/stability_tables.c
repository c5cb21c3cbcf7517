/* The tables and the answer of the searches for the longest stable step. */
#include "stability_limits.h"

#include <math.h>
#include <string.h>

/* --- the tables --- */

static const char *kind_of(const struct trial *trial) {
    return trial->place.missed < 0 ? "none" : outcome_name(trial->missed.outcome);
}

/* The longest stable step, s; of adaptive methods the mean one. */
static double largest_step(const struct cell *cell, const struct trial *trial) {
    if (configuration_is_adaptive(trial->configuration))
        return trial->cost.outcome == FINISHED
                   ? cell->scene->duration * cell->scene->wisp_count / trial->cost.steps
                   : NAN;
    return limits_step(cell, trial->place.reached);
}

/* The longest step for an aim, s; NaN: there is none, or it was not asked for. */
static double aim_step(const struct cell *cell, const struct trial *trial, enum aim_kind aim) {
    return limits_step(cell, trial->aims[aim].place.reached);
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

#define PREDICTED_COLUMN(X, trial) \
    X("predicted", "s", "longest stable step by linear theory", "%s", prediction_of(trial, 9).text)
#define ALONG_COLUMNS(X)                                                                 \
    X("axis", "-", "the setting that is varied", "%s", axis->name)                       \
    X("value", "see axis", "value of that setting", "%g", cell->value)                   \
    CONFIGURATION_COLUMN(X, "stepper", configuration->name)                              \
    X("step", "s", "longest stable step", "%.9g", largest_step(cell, t))                 \
    X("unstable_step", "s", "the next longer step, which is not stable", "%.9g",         \
      limits_step(cell, t->place.missed))                                                \
    PREDICTED_COLUMN(X, t)                                                               \
    X("kind", "-", "how the run at unstable_step ended", "%s", kind_of(t))               \
    X("order_step", "s",                                                                 \
      "longest step whose error is what the order predicts, to a factor of ten", "%.9g", \
      aim_step(cell, t, IN_ORDER))

/* Rows of a method along an axis; blocks are separated by two blank lines. */
static void write_along(FILE *stream, const struct limits *limits, const struct axis *axis,
                        const struct configuration *configuration) {
    for (int i = 0; i < limits->cell_count; i++) {
        const struct cell *cell = &limits->cells[i];
        for (int k = 0; cell->axis == axis && k < cell->trial_count; k++) {
            const struct trial *t = &cell->trials[k];
            if (t->configuration == configuration)
                WRITE_ROW(stream, ALONG_COLUMNS);
        }
    }
    fprintf(stream, "\n\n");
}

static int write_limits(struct plan *plan) {
    const struct limits *limits = plan->memo;
    FILE *stream = output_table(
        &plan->output, "limits",
        "longest stable step, s, over 0.5 s of swing (penalty_ratio: of swing-envelope with "
        "penalty), the next that is not, and the prediction of linear theory at the eigenvalues of "
        "the wisp linearised at its start (inf: any step; no prediction: there is no theory of the "
        "method); order_step: the longest of these whose error is what the method's order makes of "
        "that at shorter ones, to a factor of ten; nan: of step, none that was tried is stable; of "
        "unstable_step, all are",
        plan->loaded[0], COLUMNS(ALONG_COLUMNS));
    for (int a = 0; a < AXES && stream; a++)
        for (int c = 0; c < plan->configuration_count; c++)
            write_along(stream, limits, &limits_axes[a], &plan->configurations[c]);
    return stream ? 0 : -1;
}

#define AIM_COLUMNS(X, name, aim, meaning)                                                         \
    X(name "_step", "s", "longest step with an error of " meaning, "%.9g", aim_step(cell, t, aim)) \
    X(name "_error", "m", "error at " name "_step", "%.9g", t->aims[aim].error)                    \
    X(name "_cpu", "s", "CPU time at " name "_step, for a simulated second", "%.9g",               \
      t->aims[aim].cost.cpu.median / cell->scene->duration)
#define LARGEST_COLUMNS(X)                                                                 \
    SCENE_COLUMN(X, cell->subject)                                                         \
    TREATED_COLUMN(X, limits_treatment(cell))                                              \
    CONFIGURATION_COLUMN(X, "stepper", t->configuration->name)                             \
    X("step", "s", "longest stable step; of adaptive methods the mean one", "%.17g", step) \
    X("rate", "Hz", "rate of the steps, 1 / step", "%.9g", 1 / step)                       \
    PREDICTED_COLUMN(X, t)                                                                 \
    X("unstable_step", "s", "the next longer step, which is not stable", "%.17g",          \
      limits_step(cell, t->place.missed))                                                  \
    X("kind", "-", "how the run at unstable_step ended", "%s",                             \
      adaptive ? "chooses its steps" : kind_of(t))                                         \
    X("time", "s", "simulated time at which that failed", "%.9g", t->missed.failure_time)  \
    X("error", "m", "error at step, rms over free nodes and frames", "%.9g", t->error)     \
    X("cpu_per_second", "s", "CPU time at step, for a simulated second", "%.9g",           \
      t->cost.cpu.median / cell->scene->duration)                                          \
    AIM_COLUMNS(X, "near", NEAR, "a twentieth of the wisp's length")                       \
    AIM_COLUMNS(X, "mm", MILLIMETRE, "1 mm")                                               \
    X("order_step", "s",                                                                   \
      "longest step whose error is what the order predicts, to a factor of ten", "%.9g",   \
      aim_step(cell, t, IN_ORDER))                                                         \
    NOTE_COLUMN(X, adaptive ? "mean step at rtol 1e-3" : t->note)

static int write_scenes(struct plan *plan) {
    const struct limits *limits = plan->memo;
    FILE *stream = output_table(
        &plan->output, "largest-step",
        "the longest stable step of each stepper, s, on the first half second of scenes: what it "
        "is, its rate in Hz, the predicted one, the next that is not stable with how and when that "
        "fails, the error of the stable one, m, and its CPU time per simulated s; the same of the "
        "longest step within a twentieth of the wisp's length (near) and of that within 1 mm (mm), "
        "rms over free nodes and frames; order_step: the longest whose error is what the method's "
        "order makes of that at shorter steps, to a factor of ten; steps divide the time between "
        "stops of the clock; predicted is inf where there is no bound, and no prediction where "
        "there is no theory of the method, or too many unknowns for eigenvalues; nan: of step, "
        "none that was tried is stable; of near, mm and order, none is, or the method chooses its "
        "steps; of what fails, none does",
        plan->subjects[0].scene, COLUMNS(LARGEST_COLUMNS));
    for (int i = 0; i < limits->cell_count && stream; i++) {
        const struct cell *cell = &limits->cells[i];
        for (int k = 0; !cell->axis && k < cell->trial_count; k++) {
            const struct trial *t = &cell->trials[k];
            const double step = largest_step(cell, t);
            const int adaptive = configuration_is_adaptive(t->configuration);
            WRITE_ROW(stream, LARGEST_COLUMNS);
        }
    }
    return stream ? 0 : -1;
}

/* --- statements --- */

/* "; with all of them it is within 5 % of the wisp's length, and within 1 mm up to 0.1 ms": how
 * good a stable step is. Who is within a millimetre is within the other. */
static void describe_aims(const struct cell *cell, const struct trial *t, char text[128]) {
    const double near = aim_step(cell, t, NEAR), mm = aim_step(cell, t, MILLIMETRE);
    const double longest = largest_step(cell, t);
    size_t used = 0;
    text[0] = '\0';
    if (mm == longest) {
        snprintf(text, 128, "; with all of them it is within 1 mm");
        return;
    }
    if (near == longest)
        used = (size_t)snprintf(text, 128,
                                "; with all of them it is within 5 %% of the wisp's length");
    else if (!isnan(near) && near != mm)
        used = (size_t)snprintf(text, 128, "; it is within 5 %% of the wisp's length up to %.3g ms",
                                1e3 * near);
    if (!isnan(mm))
        snprintf(text + used, 128 - used, "%s within 1 mm up to %.3g ms",
                 used ? ", and" : "; it is", 1e3 * mm);
    else
        snprintf(text + used, 128 - used, "%s within 1 mm at none that was tried",
                 used ? ", and" : "; it is");
}

static void state_fixed(struct statements *statements, struct statement row,
                        const struct cell *cell, const struct trial *t, const char *where) {
    const char *name = t->configuration->name;
    char aims[128];
    describe_aims(cell, t, aims);
    if (t->place.reached < 0 && t->place.missed < 0)
        statements_add(statements, row, "No step of %s was tried on %s: %s.", name, where, t->note);
    else if (t->place.reached < 0)
        statements_add(statements, row, "No step of %s that was tried on %s is stable: %s.", name,
                       where, t->note);
    else if (t->place.missed < 0)
        statements_add(statements, row, "%s is stable on %s at every step tried, up to %.3g ms%s.",
                       name, where, row.value, aims);
    else
        statements_add(statements, row,
                       "%s is stable on %s with steps up to %.3g ms (%.0f Hz); the next longer one "
                       "tried ends '%s' at %.3g s%s.",
                       name, where, row.value, 1e3 / row.value, outcome_name(t->missed.outcome),
                       t->missed.failure_time, aims);
}

/* A method that chooses its steps has no longest one. */
static void state_adaptive(struct statements *statements, struct statement row,
                           const struct trial *t, const char *where) {
    const char *name = t->configuration->name;
    if (row.verdict == HOLDS)
        statements_add(
            statements, row,
            "%s chooses its steps on %s, %.3g ms in the mean at rtol %g, and has no longest one.",
            name, where, row.value, LIMITS_TOLERANCE);
    else
        statements_add(statements, row,
                       "%s chooses its steps, and its run on %s did not reach its end: %s.", name,
                       where, t->note[0] ? t->note : outcome_name(t->cost.outcome));
}

void limits_state_trial(struct statements *statements, const struct cell *cell,
                        const struct trial *trial, enum question answers) {
    char where[128];
    snprintf(where, sizeof where, "%s (%s)", cell->subject, limits_treatment(cell));
    const double step = 1e3 * largest_step(cell, trial);
    struct statement row =
        our_row("limits", "largest-step failures", isnan(step) ? NOT_REACHED : HOLDS, step, "ms",
                "%.90s, %.60s", cell->name, trial->configuration->name);
    row.answers = answers;
    if (configuration_is_adaptive(trial->configuration))
        state_adaptive(statements, row, trial, where);
    else
        state_fixed(statements, row, cell, trial, where);
}

static int is_explicit(const struct trial *t) {
    return !(t->configuration->method->capabilities & (STEPPER_ADAPTIVE | STEPPER_IMPLICIT));
}

/* How far explicit methods get on a cell, and whoever gets farthest within a millimetre. */
static void state_extremes(struct statements *statements, const struct cell *cell) {
    const struct trial *least = NULL, *greatest = NULL, *farthest = NULL;
    for (int k = 0; k < cell->trial_count; k++) {
        const struct trial *t = &cell->trials[k];
        const double step = limits_step(cell, t->place.reached);
        if (configuration_is_adaptive(t->configuration) || isnan(step))
            continue;
        if (is_explicit(t) && (!least || step < largest_step(cell, least)))
            least = t;
        if (is_explicit(t) && (!greatest || step > largest_step(cell, greatest)))
            greatest = t;
        if (aim_step(cell, t, MILLIMETRE) > (farthest ? aim_step(cell, farthest, MILLIMETRE) : 0))
            farthest = t;
    }
    if (!least || !farthest)
        return; /* the user asked for others, or nobody got there */
    struct statement row = our_row(NULL, "largest-step", HOLDS, 1e3 * largest_step(cell, least),
                                   "ms", "%.90s, longest steps", cell->subject);
    row.answers = ANSWERS_FAILURES;
    statements_add(statements, row,
                   "On %s explicit methods fail beyond steps of %.3g ms (%s) to %.3g ms (%s), and "
                   "%s stays within a millimetre with steps of %.3g ms.",
                   cell->subject, row.value, least->configuration->name,
                   1e3 * largest_step(cell, greatest), greatest->configuration->name,
                   farthest->configuration->name, 1e3 * aim_step(cell, farthest, MILLIMETRE));
}

/* How far the measured limits of the axes are from the predicted ones. */
static void state_prediction(struct statements *statements, const struct plan *plan) {
    const struct limits *limits = plan->memo;
    double least = INFINITY, greatest = 0;
    struct statement row = {.key = "prediction", .figure = "limits", .tables = "limits"};
    for (int i = 0; i < limits->cell_count; i++)
        for (int k = 0; limits->cells[i].axis && k < limits->cells[i].trial_count; k++) {
            const struct trial *t = &limits->cells[i].trials[k];
            const double ratio = largest_step(&limits->cells[i], t) / t->predicted;
            if (t->place.missed >= 0 && ratio > 0 && isfinite(ratio)) {
                least = fmin(least, ratio);
                greatest = fmax(greatest, ratio);
            }
        }
    if (greatest > 0) {
        row.value = fmax(greatest, 1 / least);
        row.unit = "1";
        row.verdict = holds_if(row.value < 1.25);
        statements_add(statements, row,
                       "Along EA, damping, nodes and penalty ratio the longest steps are %.2f to "
                       "%.2f times those that linear theory predicts.",
                       least, greatest);
        return;
    }
    row.verdict = plan_is_own(plan) ? NOT_REACHED : NOT_ASKED;
    statements_add(statements, row, "The axes EA, damping, nodes and penalty ratio %s.",
                   plan_is_own(plan)
                       ? "have no longest step beside a prediction"
                       : "are those of swing, and are left out with --scene and --set");
}

static void state_cuts(struct statements *statements, const struct plan *plan) {
    const struct limits *limits = plan->memo;
    const char *before = "";
    for (int i = 0; i < limits->cell_count; i++) {
        const struct cell *cell = &limits->cells[i];
        if (cell->axis || strcmp(cell->subject, before) == 0 || !limits_is_cut(plan, cell))
            continue;
        before = cell->subject;
        statements_add(statements,
                       our_row("limits", NULL, NOT_REACHED, cell->scene->duration, "s",
                               "%.90s, cut", cell->subject),
                       "The budget allows %s its first %.3g s.", cell->subject,
                       cell->scene->duration);
    }
    if (plan->quick && plan->scene_count == 0)
        statements_add(statements, our_row("limits", NULL, NOT_REACHED, NAN, NULL, "left out"),
                       "All but two values of EA and of nodes, the other axes and swing-envelope "
                       "are left out of --quick.");
}

/* The first treatment of a scene answers where a method fails on it. */
static void state_trials(struct statements *statements, const struct limits *limits) {
    const char *scene = "";
    for (int i = 0; i < limits->cell_count; i++) {
        const struct cell *cell = &limits->cells[i];
        if (cell->axis)
            continue;
        const int first = strcmp(cell->subject, scene) != 0;
        scene = cell->subject;
        if (first)
            state_extremes(statements, cell);
        for (int k = 0; k < cell->trial_count; k++)
            limits_state_trial(statements, cell, &cell->trials[k],
                               first ? ANSWERS_FAILURES : ANSWERS_NONE);
    }
}

int limits_tabulate(struct plan *plan) {
    struct statements *statements = &plan->output.statements;
    if (write_limits(plan) || write_scenes(plan) || limits_write_failures(plan))
        return -1;
    state_trials(statements, plan->memo);
    state_prediction(statements, plan);
    state_cuts(statements, plan);
    return 0;
}
