/* Where the longest stable steps are looked for: along stiffness, damping, nodes and penalty ratio
 * with the prediction of linear theory, and on whole scenes. */
#include "stability_limits.h"

#include "base/files.h"
#include "model/model.h"
#include "model/problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double duration = 0.5; /* s of a scene, at most */

/* In the order of the table. */
enum { EA, ZETA, NODES, PENALTY_RATIO };
const struct axis limits_axes[AXES] = {
    [EA] = {"EA",
            "swing",
            "material.stretch_stiffness=%.17e",
            WISP_GENERALISED,
            5,
            {15, 90, 500, 3000, 16800}},
    [ZETA] = {"zeta",
              "swing",
              "material.stretch_time=%.17e",
              WISP_GENERALISED,
              6,
              {0.02, 0.1, 0.25, 0.5, 1, 2}},
    [NODES] =
        {"nodes", "swing", "wisps.[0].nodes=%.0f", WISP_GENERALISED, 6, {8, 11, 16, 22, 30, 40}},
    [PENALTY_RATIO] = {"penalty_ratio",
                       "swing-envelope",
                       "envelope.penalty_ratio=%.17e",
                       WISP_PENALTY,
                       6,
                       {10, 100, 1000, 3000, 10000, 30000}},
};

/* --- the plan --- */

static int begin_cell(struct plan *plan, struct cell *cell) {
    const struct run_request reference = {.stepper = "reference",
                                          .treatment = limits_treatment(cell)};
    int mode_count = 0, code = 0;
    cell->reference = plan->case_count;
    if (plan_add(plan, cell->scene, &reference, cell->name, "reference"))
        return -1;
    struct mode_rate *modes = scene_modes(cell->scene, cell->treatment, &mode_count);
    for (int i = 0; i < plan->configuration_count && !code; i++)
        if (!cell->axis || !configuration_is_adaptive(&plan->configurations[i]))
            code = limits_begin(plan, cell, &plan->configurations[i], modes, mode_count);
    free(modes);
    return code;
}

/* zeta is of the highest stretch mode: a damper of tau times the spring is tau w / 2 of critical.
 */
static double setting_of(const struct axis *axis, double value, const struct scene *scene) {
    return axis == &limits_axes[ZETA] ? 2 * value / stiffest_mode(scene).frequency : value;
}

/* The scene of an axis at a value. The clock gets no stops but frames, so that steps of any length
 * can be tried. */
static const struct scene *plan_axis_scene(struct plan *plan, const struct axis *axis,
                                           double value) {
    char setting[96], length[64];
    const char *const sets[] = {
        length, setting,
        "contacts={ collision_rate = 30.0; interpenetration = false; collision = false; }"};
    const struct scene *plain = plan_scene(plan, axis->scene, NULL, 0);
    if (!plain)
        return NULL;
    snprintf(length, sizeof length, "duration=%.17e", duration);
    snprintf(setting, sizeof setting, axis->setting, setting_of(axis, value, plain));
    return plan_scene(plan, axis->scene, sets, axis == &limits_axes[PENALTY_RATIO] ? 3 : 2);
}

/* --quick: two values of EA and of nodes. */
static int is_in(const struct plan *plan, int axis, int value) {
    return !plan->quick || ((axis == EA || axis == NODES) && (value == 1 || value == 3));
}

static int plan_axes(struct plan *plan, struct limits *limits) {
    for (int a = 0; a < AXES; a++)
        for (int k = 0; k < limits_axes[a].values; k++) {
            const struct axis *axis = &limits_axes[a];
            struct cell *cell = &limits->cells[limits->cell_count];
            if (!is_in(plan, a, k))
                continue;
            *cell = (struct cell){.trials = cell->trials,
                                  .axis = axis,
                                  .value = axis->value[k],
                                  .treatment = axis->treatment,
                                  .scene = plan_axis_scene(plan, axis, axis->value[k])};
            snprintf(cell->name, sizeof cell->name, "%s %g", axis->name, cell->value);
            limits->cell_count++;
            if (!cell->scene || begin_cell(plan, cell))
                return -1;
        }
    return 0;
}

/* References are what costs: a fifth of the time that the experiment may take goes to them. */
static double affordable(const struct plan *plan, const struct scene *scene) {
    const double seconds = (plan->quick ? 4 : 60) * 2. / plan->subject_count;
    const int treatments = scene->wisps[0].samples > 0 ? 3 : 1;
    return fmin(duration, seconds / (reference_cost(scene) * treatments));
}

int limits_is_cut(const struct plan *plan, const struct cell *cell) {
    return affordable(plan, cell->scene) < duration;
}

static int plan_scenes(struct plan *plan, struct limits *limits) {
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        const double length = affordable(plan, subject->scene);
        const struct scene *scene =
            plan_cut_scene(plan, subject, subject->scene->frame_rate, length, NULL);
        if (!scene)
            return -1;
        for (int t = 0; wisp_problem.treatments[t].name; t++) {
            struct cell *cell = &limits->cells[limits->cell_count];
            if (scene->wisps[0].samples == 0 && t != WISP_GENERALISED)
                continue; /* the same equations */
            *cell = (struct cell){.trials = cell->trials,
                                  .scene = scene,
                                  .treatment = (enum wisp_treatment)t,
                                  .subject = subject->name};
            snprintf(cell->name, sizeof cell->name, "%s %s", subject->name, limits_treatment(cell));
            limits->cell_count++;
            if (begin_cell(plan, cell) ||
                (plan->set_count == 0 && strcmp(subject->source, "swing") == 0 &&
                 limits_plan_known(plan, cell)))
                return -1;
        }
    }
    return 0;
}

int limits_plan(struct plan *plan) {
    static const char *const own[] = {"swing", "swing-envelope"};
    plan->run_seconds = 60;
    if (plan_configurations(plan, CONFIGURATION_PLAIN, 0) ||
        plan_subjects(plan, own, plan->quick ? 1 : 2))
        return -1;
    const size_t cells = AXES * VALUES_MAX + 3 * (size_t)plan->subject_count,
                 trials = (size_t)plan->configuration_count;
    struct limits *limits = plan->memo = calloc(1, sizeof *limits + cells * sizeof *limits->cells +
                                                       cells * trials * sizeof(struct trial));
    if (!limits)
        return fail_with(plan->reason, "out of memory");
    for (size_t i = 0; i < cells; i++) /* behind the cells */
        limits->cells[i].trials = (struct trial *)(limits->cells + cells) + i * trials;
    if (plan_scenes(plan, limits))
        return -1;
    return plan_is_own(plan) ? plan_axes(plan, limits) : 0;
}

/* --- from round to round --- */

static int is_done(const void *ctx, int i) {
    return ((const struct cell *)ctx)->trials[i].phase == DONE;
}

static int go_on(struct plan *plan, void *ctx, int i, const struct run_files *reference) {
    struct cell *cell = ctx;
    struct trial *trial = &cell->trials[i];
    if (reference->outcome == FINISHED || trial->phase == TIMING)
        return limits_go_on(plan, cell, trial, reference);
    trial->phase = DONE;
    snprintf(trial->note, sizeof trial->note, "no reference solution: %s",
             outcome_name(reference->outcome));
    return 0;
}

int limits_refine(struct plan *plan) {
    struct limits *limits = plan->memo;
    for (int i = 0; i < limits->cell_count; i++) {
        struct cell *cell = &limits->cells[i];
        const struct searches trials = {cell->reference, cell->trial_count, cell, is_done, go_on};
        if (searches_go_on(plan, &trials))
            return -1;
    }
    return 0;
}
