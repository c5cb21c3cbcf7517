/* The longest stable step on wisps, by rounds of runs: along stiffness, damping, nodes and penalty
 * ratio with the prediction of linear theory, and on whole scenes. A run is stable that is right:
 * finite is not enough.
 *
 * Each method first runs at an anchor, half of the predicted step; from its error there its order
 * says what longer steps may err. Then between the anchor and a step that is a quarter longer than
 * predicted, by halves. */
#include "model.h"
#include "stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double duration = 0.5;     /* s of a scene, at most */
static const double beyond_order = 10;  /* an error is wrong beyond this times what order says */
static const double never_wrong = 1e-4; /* m: an error below it is not */
static const double longest_run = 6;    /* CPU s, roughly */
static const double adaptive_tolerance = 1e-3;

enum { STRIDE = 24, STEPPERS_MAX = 32, VALUES_MAX = 6, AXES = 4 };

/* What is varied, on which scene, and by which setting. */
static const struct axis {
    const char *name, *scene, *setting;
    enum wisp_treatment treatment;
    int values;
    double value[VALUES_MAX];
} axes[AXES] = {
    {"EA",
     "swing",
     "material.stretch_stiffness=%.17e",
     WISP_GENERALISED,
     5,
     {15, 90, 500, 3000, 16800}},
    {"zeta",
     "swing",
     "material.stretch_time=%.17e",
     WISP_GENERALISED,
     6,
     {0.02, 0.1, 0.25, 0.5, 1, 2}},
    {"nodes", "swing", "wisps.[0].nodes=%.0f", WISP_GENERALISED, 6, {8, 11, 16, 22, 30, 40}},
    {"penalty_ratio",
     "swing-envelope",
     "envelope.penalty_ratio=%.17e",
     WISP_PENALTY,
     6,
     {10, 100, 1000, 3000, 10000, 30000}},
};
enum { EA, ZETA, NODES, PENALTY_RATIO };

enum phase { ANCHORING, SEARCHING, TIMING, DONE };

/* One method in one cell. */
struct trial {
    const struct contestant *contestant;
    double predicted; /* step, s; NaN: no prediction */
    enum phase phase;
    struct bracket place;
    int run; /* its last case in the plan */
    double anchor_step, anchor_error;
    struct verdict missed; /* of the finest place that misses */
    double error;          /* of the coarsest that reaches, m */
    struct cost cost;      /* of the timed run */
    char note[REASON_SIZE];
};

/* A scene with a treatment, and the methods on it. */
struct cell {
    const struct scene *scene;
    enum wisp_treatment treatment;
    const struct axis *axis; /* NULL: a whole scene */
    double value;
    const char *subject; /* its name; of a whole scene */
    char name[96];       /* of its runs */
    int tight;           /* its case in the plan */
    struct trial trials[STEPPERS_MAX];
    int trial_count;
};

/* The plan's memo. */
struct limits {
    struct contestant contestants[STEPPERS_MAX];
    int contestant_count;
    int cell_count;
    struct cell cells[];
};

/* --- settings --- */

/* Every method of the registry as it is, implicit ones with the direct solver. */
static void find_contestants(const struct plan *plan, struct limits *limits) {
    for (int i = 0; stepper_methods[i] && limits->contestant_count < STEPPERS_MAX; i++) {
        const struct stepper_method *method = stepper_methods[i];
        if (plan_wants(plan, method->name))
            limits->contestants[limits->contestant_count++] = (struct contestant){
                .name = method->name,
                .stepper = method->name,
                .linear = method->capabilities & STEPPER_IMPLICIT ? "direct" : NULL,
                .cost = method->capabilities & STEPPER_IMPLICIT ? 100e-9
                        : method->table                         ? 11e-9 * method->table->stages
                                                                : 40e-9,
            };
    }
}

static double step_at(const struct cell *cell, int place) {
    return place < 0 ? NAN : place_step(1 / stop_rate(cell->scene), STRIDE, place);
}

static int place_of(const struct cell *cell, double step) {
    return step_place(1 / stop_rate(cell->scene), STRIDE, step);
}

static int resolution(const struct plan *plan) {
    return plan->quick ? 4 : 1; /* 12 %, 3 % */
}

static int order_of(const struct contestant *contestant) {
    return stepper_find(contestant->stepper)->order;
}

/* --- the plan --- */

static struct run_request request_of(const struct cell *cell, const struct contestant *contestant,
                                     double step) {
    struct run_request request =
        contestant_request(contestant, step, cell->scene->run.atol / cell->scene->run.rtol);
    request.treatment = wisp_problem.treatments[cell->treatment].name;
    return request;
}

static int add_run(struct plan *plan, const struct cell *cell, struct trial *trial, double step,
                   int timings) {
    struct run_request request = request_of(cell, trial->contestant, step);
    request.timings = timings;
    trial->run = plan->case_count;
    return plan_add(plan, cell->scene, &request, cell->name, "%s, %s %.4g", trial->contestant->name,
                    contestant_is_adaptive(trial->contestant) ? "rtol" : "step", step);
}

/* A run that the table of failures is to have. */
static int add_failure(struct plan *plan, const struct cell *cell,
                       const struct contestant *contestant, double step) {
    const struct run_request request = request_of(cell, contestant, step);
    char group[128];
    snprintf(group, sizeof group, "failures, %s", cell->name);
    return plan_add(plan, cell->scene, &request, group, "%s", contestant->name);
}

static int is_beyond(const struct cell *cell, struct trial *trial) {
    const double step = step_at(cell, trial->place.at);
    if (estimated_cost(cell->scene, cell->treatment, trial->contestant->cost, step) <= longest_run)
        return 0;
    snprintf(trial->note, sizeof trial->note, "a run of shorter steps would take more than %g s",
             longest_run);
    trial->phase = DONE;
    return 1;
}

static int try_place(struct plan *plan, const struct cell *cell, struct trial *trial) {
    return is_beyond(cell, trial) ? 0
                                  : add_run(plan, cell, trial, step_at(cell, trial->place.at), 0);
}

static int begin_trial(struct plan *plan, struct cell *cell, const struct contestant *contestant,
                       const double complex *modes, int mode_count) {
    const struct stepper_method *method = stepper_find(contestant->stepper);
    struct trial *trial = &cell->trials[cell->trial_count++];
    const struct run_request request = request_of(cell, contestant, 1e-3);
    struct settings settings;
    *trial = (struct trial){
        .contestant = contestant,
        .predicted = modes && method->table ? stable_step(method->table, modes, mode_count) : NAN,
        .phase = DONE,
        .place = bracket_begin(-1, 0),
        .missed = {NAN, FINISHED, NAN},
        .error = NAN,
        .cost = no_cost};
    if (settings_resolve(cell->scene, &request, &settings, trial->note))
        return 0;
    trial->note[0] = 0;
    if (contestant_is_adaptive(contestant)) {
        trial->phase = TIMING;
        return add_run(plan, cell, trial, adaptive_tolerance, 3);
    }
    const double likely = isfinite(trial->predicted) && trial->predicted > 0
                              ? trial->predicted / 2
                              : usual_step(cell->scene, method);
    trial->phase = ANCHORING;
    trial->place = bracket_begin(place_of(cell, likely), 0);
    return try_place(plan, cell, trial);
}

static int begin_cell(struct plan *plan, struct cell *cell) {
    struct limits *limits = plan->memo;
    const struct run_request tight = {.stepper = "reference",
                                      .treatment = wisp_problem.treatments[cell->treatment].name};
    int mode_count = 0, code = 0;
    cell->tight = plan->case_count;
    if (plan_add(plan, cell->scene, &tight, cell->name, "tight"))
        return -1;
    double complex *modes = scene_modes(cell->scene, cell->treatment, &mode_count);
    for (int i = 0; i < limits->contestant_count && !code; i++)
        if (!cell->axis || !contestant_is_adaptive(&limits->contestants[i]))
            code = begin_trial(plan, cell, &limits->contestants[i], modes, mode_count);
    free(modes);
    return code;
}

/* zeta is of the highest stretch mode: a damper of tau times the spring is tau w / 2 of critical.
 */
static double setting_of(const struct axis *axis, double value, const struct scene *scene) {
    return axis == &axes[ZETA] ? 2 * value / stiffest_mode(scene).frequency : value;
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
    return plan_scene(plan, axis->scene, sets, axis == &axes[PENALTY_RATIO] ? 3 : 2);
}

/* --quick: two values of EA and of nodes. */
static int is_in(const struct plan *plan, int axis, int value) {
    return !plan->quick || ((axis == EA || axis == NODES) && (value == 1 || value == 3));
}

static int plan_axes(struct plan *plan, struct limits *limits) {
    for (int a = 0; a < AXES; a++)
        for (int k = 0; k < axes[a].values; k++) {
            struct cell *cell = &limits->cells[limits->cell_count];
            if (!is_in(plan, a, k))
                continue;
            *cell = (struct cell){.axis = &axes[a],
                                  .value = axes[a].value[k],
                                  .treatment = axes[a].treatment,
                                  .scene = plan_axis_scene(plan, &axes[a], axes[a].value[k])};
            snprintf(cell->name, sizeof cell->name, "%s %g", axes[a].name, cell->value);
            limits->cell_count++;
            if (!cell->scene || begin_cell(plan, cell))
                return -1;
        }
    return 0;
}

/* Steps on either side of the limits of `swing`, at round rates. */
static int plan_known(struct plan *plan, const struct limits *limits, const struct cell *cell) {
    static const struct {
        const char *stepper;
        double rate;
    } known[] = {{"euler", 9000}, {"euler", 8000}, {"euler", 7000}, {"rk4", 4000}, {"rk4", 3000}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        for (int i = 0; i < limits->contestant_count; i++)
            if (strcmp(limits->contestants[i].stepper, known[k].stepper) == 0 &&
                add_failure(plan, cell, &limits->contestants[i], 1 / known[k].rate))
                return -1;
    return 0;
}

/* References are what costs: a fifth of the time that the experiment may take goes to them. */
static double affordable(const struct plan *plan, const struct scene *scene) {
    const double seconds = (plan->quick ? 4 : 60) * 2. / plan->subject_count;
    const int treatments = scene->wisps[0].samples > 0 ? 3 : 1;
    return fmin(duration, seconds / (reference_cost(scene) * treatments));
}

static int plan_scenes(struct plan *plan, struct limits *limits) {
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        const double length = affordable(plan, subject->scene);
        const struct scene *scene =
            plan_cut_scene(plan, subject, subject->scene->frame_rate, length, NULL);
        if (!scene)
            return -1;
        if (length < duration)
            printf("  %s: only its first %.3g s, for the budget\n", subject->name, scene->duration);
        for (int t = 0; wisp_problem.treatments[t].name; t++) {
            struct cell *cell = &limits->cells[limits->cell_count];
            if (scene->wisps[0].samples == 0 && t != WISP_GENERALISED)
                continue; /* the same equations */
            *cell = (struct cell){
                .scene = scene, .treatment = (enum wisp_treatment)t, .subject = subject->name};
            snprintf(cell->name, sizeof cell->name, "%s %s", subject->name,
                     wisp_problem.treatments[t].name);
            limits->cell_count++;
            if (begin_cell(plan, cell) ||
                (strcmp(subject->source, "swing") == 0 && plan_known(plan, limits, cell)))
                return -1;
        }
    }
    return 0;
}

int limits_plan(struct plan *plan) {
    static const char *const own[] = {"swing", "swing-envelope"};
    plan->run_seconds = 60;
    if (plan_subjects(plan, own, plan->quick ? 1 : 2))
        return -1;
    const size_t cells = AXES * VALUES_MAX + 3 * (size_t)plan->subject_count;
    struct limits *limits = plan->memo = calloc(1, sizeof *limits + cells * sizeof *limits->cells);
    if (!limits) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        return -1;
    }
    find_contestants(plan, limits);
    if (plan_scenes(plan, limits))
        return -1;
    return plan->scene_count ? 0 : plan_axes(plan, limits);
}

/* --- from round to round --- */

/* What the order of the method lets the error be at a step, m. */
static double tolerated(const struct trial *trial, double step) {
    const double by_order =
        trial->anchor_error * pow(step / trial->anchor_step, order_of(trial->contestant));
    return fmax(never_wrong, beyond_order * by_order);
}

/* The step above the limit, and longer ones as far as the clock lets them be. */
static int add_failures(struct plan *plan, const struct cell *cell, const struct trial *trial) {
    static const double beyond[] = {1, 4. / 3, 2, 4};
    double last = 0;
    for (size_t k = 0; k < sizeof beyond / sizeof *beyond; k++) {
        const double missed = step_at(cell, trial->place.missed);
        const double step = step_at(cell, place_of(cell, beyond[k] * missed));
        if (step > last && add_failure(plan, cell, trial->contestant, step))
            return -1;
        last = fmax(last, step);
    }
    return 0;
}

static int end_trial(struct plan *plan, const struct cell *cell, struct trial *trial) {
    trial->phase = DONE;
    if (trial->place.missed < 0)
        snprintf(trial->note, sizeof trial->note, "stable at one step between stops of the clock");
    else if (step_at(cell, trial->place.reached) > 1.2 * trial->predicted)
        snprintf(trial->note, sizeof trial->note,
                 "above the prediction it grows too slowly to show in this time");
    if (cell->axis)
        return 0;
    if (trial->place.missed >= 0 && add_failures(plan, cell, trial))
        return -1;
    trial->phase = TIMING;
    return add_run(plan, cell, trial, step_at(cell, trial->place.reached), 3);
}

/* The first place after the anchor: a quarter beyond the prediction, or the longest there is. */
static int first_try(const struct cell *cell, const struct trial *trial) {
    return isfinite(trial->predicted) && trial->predicted > 0
               ? place_of(cell, 1.25 * trial->predicted)
               : 0;
}

static int take_anchor(struct plan *plan, const struct cell *cell, struct trial *trial,
                       const struct verdict *verdict) {
    if (verdict->outcome != FINISHED) {
        trial->missed = *verdict;
        bracket_take(&trial->place, 0, STRIDE, 1);
        return try_place(plan, cell, trial);
    }
    const int anchor = trial->place.at;
    trial->anchor_step = step_at(cell, anchor);
    trial->anchor_error = trial->error = verdict->error;
    trial->phase = SEARCHING;
    if (!bracket_take(&trial->place, 1, STRIDE, resolution(plan)))
        return end_trial(plan, cell, trial);
    if (trial->place.missed < 0)
        trial->place.at = first_try(cell, trial) < anchor ? first_try(cell, trial) : anchor - 1;
    return try_place(plan, cell, trial);
}

/* The time of the first frame of which a node is more than `bound` off, s. */
static double first_wrong(const struct table *run, const struct table *tight, double bound) {
    enum { X = 3 };
    for (int i = 0; i < run->row_count && i < tight->row_count; i++) {
        double square = 0;
        for (int k = X; k < X + 3; k++)
            square += pow(table_value(run, i, k) - table_value(tight, i, k), 2);
        if (!(sqrt(square) <= bound))
            return table_value(run, i, 0);
    }
    return NAN;
}

/* When a run that finished is first wrong. 0, or -1 with plan->reason. */
static int time_wrong(struct plan *plan, struct trial *trial, double step,
                      const struct run_files *tight) {
    struct run_files run;
    if (run_read(&run, plan->cases[trial->run].run.folder, plan->reason))
        return -1;
    trial->missed.failure_time = first_wrong(&run.states, &tight->states, tolerated(trial, step));
    run_free(&run);
    return 0;
}

static int take_place(struct plan *plan, const struct cell *cell, struct trial *trial,
                      const struct verdict *verdict, const struct run_files *tight) {
    const double step = step_at(cell, trial->place.at);
    const int stable = verdict->outcome == FINISHED && verdict->error <= tolerated(trial, step);
    if (stable)
        trial->error = verdict->error;
    else
        trial->missed = *verdict;
    if (!stable && verdict->outcome == FINISHED && time_wrong(plan, trial, step, tight))
        return -1;
    return bracket_take(&trial->place, stable, STRIDE, resolution(plan))
               ? try_place(plan, cell, trial)
               : end_trial(plan, cell, trial);
}

static int read_timing(struct plan *plan, struct trial *trial) {
    struct run_files run;
    if (run_read(&run, plan->cases[trial->run].run.folder, plan->reason))
        return -1;
    trial->cost = run_cost(&run);
    trial->phase = DONE;
    run_free(&run);
    return 0;
}

static int step_trial(struct plan *plan, const struct cell *cell, struct trial *trial,
                      const struct run_files *tight) {
    struct verdict verdict;
    if (trial->phase == TIMING)
        return read_timing(plan, trial);
    if (judge_runs(plan, trial->run, 1, cell->scene, tight, &verdict))
        return -1;
    return trial->phase == ANCHORING ? take_anchor(plan, cell, trial, &verdict)
                                     : take_place(plan, cell, trial, &verdict, tight);
}

static int refine_cell(struct plan *plan, struct cell *cell, const struct run_files *tight) {
    for (int i = 0; i < cell->trial_count; i++) {
        struct trial *trial = &cell->trials[i];
        if (trial->phase == DONE)
            continue;
        if (tight->outcome != FINISHED && trial->phase != TIMING) {
            trial->phase = DONE;
            snprintf(trial->note, sizeof trial->note, "no tight solution: %s",
                     outcome_name(tight->outcome));
        } else if (step_trial(plan, cell, trial, tight)) {
            return -1;
        }
    }
    return 0;
}

static int is_done(const struct cell *cell) {
    for (int i = 0; i < cell->trial_count; i++)
        if (cell->trials[i].phase != DONE)
            return 0;
    return 1;
}

int limits_refine(struct plan *plan) {
    struct limits *limits = plan->memo;
    for (int i = 0; i < limits->cell_count; i++) {
        struct run_files tight;
        if (is_done(&limits->cells[i]))
            continue;
        if (run_read(&tight, plan->cases[limits->cells[i].tight].run.folder, plan->reason))
            return -1;
        const int code = refine_cell(plan, &limits->cells[i], &tight);
        run_free(&tight);
        if (code)
            return -1;
    }
    return 0;
}

/* --- the tables --- */

static const char *treatment_of(const struct cell *cell) {
    return wisp_problem.treatments[cell->treatment].name;
}

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
    return step_at(cell, trial->place.reached);
}

static int write_limits(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    struct atomic_file file;
    if (open_table(
            &file, folder, "limits",
            "longest stable step, s, over 0.5 s of swing (penalty_ratio: of swing-envelope "
            "with penalty), the next that is not, and the prediction by the stability "
            "function at the eigenvalues of the wisp linearised at its start; nan: of step, none "
            "that was tried is stable; of unstable_step, all are; of predicted, there is no "
            "stability function or no bound",
            plan->loaded[0], "axis\tvalue\tstepper\tstep\tunstable_step\tpredicted\tkind",
            plan->reason))
        return -1;
    for (int a = 0; a < AXES; a++)
        for (int c = 0; c < limits->contestant_count; c++) {
            for (int i = 0; i < limits->cell_count; i++) {
                const struct cell *cell = &limits->cells[i];
                for (int k = 0; cell->axis == &axes[a] && k < cell->trial_count; k++) {
                    const struct trial *t = &cell->trials[k];
                    if (t->contestant == &limits->contestants[c])
                        fprintf(file.stream, "%s\t%g\t%s\t%.9g\t%.9g\t%.9g\t%s\n", axes[a].name,
                                cell->value, t->contestant->name, largest_step(cell, t),
                                step_at(cell, t->place.missed), t->predicted, kind_of(t));
                }
            }
            fprintf(file.stream, "\n\n");
        }
    return atomic_commit(&file, plan->reason);
}

static void write_largest(FILE *stream, const struct cell *cell, const struct trial *t) {
    const double step = largest_step(cell, t);
    const int adaptive = contestant_is_adaptive(t->contestant);
    fprintf(stream, "%s\t%s\t%s\t%.17g\t%.9g\t%.9g\t%.17g\t%s\t%.9g\t%.9g\t%.9g\t%s\n",
            cell->subject, treatment_of(cell), t->contestant->name, step, 1 / step, t->predicted,
            step_at(cell, t->place.missed), adaptive ? "chooses its steps" : kind_of(t),
            t->missed.failure_time, t->error, t->cost.cpu.median / cell->scene->duration,
            adaptive ? "mean step at rtol 1e-3" : t->note);
}

static int write_scenes(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    struct atomic_file file;
    if (open_table(
            &file, folder, "largest-step",
            "the longest stable step of each stepper, s, on the first half second of scenes: what "
            "it is, its "
            "rate in Hz, the predicted one, the next that is not stable with how and when "
            "that fails, the error of the stable one, m, and its CPU time per simulated s; "
            "steps divide the time between stops of the clock; nan: of step, none that was tried "
            "is "
            "stable; of what fails, none does; of predicted, there is no stability function, no "
            "bound, or there are too many unknowns for eigenvalues",
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

/* --- failures --- */

static const struct trial *trial_of(const struct cell *cell, const char *stepper) {
    for (int i = 0; i < cell->trial_count; i++)
        if (strcmp(cell->trials[i].contestant->name, stepper) == 0)
            return &cell->trials[i];
    return NULL;
}

static int write_failure(struct plan *plan, FILE *stream, const struct cell *cell,
                         const struct labelled_case *one, const struct run_files *tight) {
    const double step = one->run.settings.step;
    const double bound = tolerated(trial_of(cell, one->label), step);
    struct run_files run;
    struct deviation deviation;
    if (run_read(&run, one->run.folder, plan->reason))
        return -1;
    const int code =
        measure_deviation(cell->scene, &run.states, &tight->states, 1, &deviation, plan->reason);
    const int wrong = run.outcome == FINISHED && deviation.rms > bound;
    if (!code)
        fprintf(stream, "%s\t%s\t%s\t%.9g\t%.9g\t%s\t%.9g\t%s\t%.9g\t%.9g\n", cell->subject,
                treatment_of(cell), one->label, step, 1 / step,
                wrong                     ? "wrong"
                : run.outcome == FINISHED ? "stable"
                                          : outcome_name(run.outcome),
                wrong                     ? first_wrong(&run.states, &tight->states, bound)
                : run.outcome == FINISHED ? NAN
                                          : run_number(&run, "failure_time"),
                run.outcome == NOT_FINITE ? "no" : "yes", deviation.rms, deviation.largest);
    run_free(&run);
    return code;
}

static int write_cell_failures(struct plan *plan, FILE *stream, const struct cell *cell) {
    struct run_files tight;
    char group[128];
    int code = 0;
    snprintf(group, sizeof group, "failures, %s", cell->name);
    if (run_read(&tight, plan->cases[cell->tight].run.folder, plan->reason))
        return -1;
    for (int i = 0; i < plan->case_count && tight.outcome == FINISHED && !code; i++)
        if (strcmp(plan->cases[i].group, group) == 0)
            code = write_failure(plan, stream, cell, &plan->cases[i], &tight);
    run_free(&tight);
    return code;
}

static int write_failures(struct plan *plan, const char *folder) {
    const struct limits *limits = plan->memo;
    struct atomic_file file;
    if (open_table(
            &file, folder, "failures",
            "how methods fail at steps that are too long: kind, when it first shows, "
            "whether the state stays finite, and the error of the frames before, m (rms, "
            "largest); wrong: finished, with more than ten times the error that its order "
            "lets it have, and more than 0.1 mm; nan: of time, it does not fail; of errors, there "
            "is no frame to compare",
            plan->subjects[0].scene,
            "scene\ttreatment\tstepper\tstep\trate\tkind\ttime\tfinite\terror\tlargest_error",
            plan->reason))
        return -1;
    for (int i = 0; i < limits->cell_count; i++)
        if (!limits->cells[i].axis && write_cell_failures(plan, file.stream, &limits->cells[i])) {
            atomic_discard(&file);
            return -1;
        }
    return atomic_commit(&file, plan->reason);
}

/* --- the answer --- */

static void print_trial(const struct cell *cell, const struct trial *t) {
    const double step = largest_step(cell, t);
    printf("  %-28s %-15s %9.3g %9.0f %9.3g  ", cell->name, t->contestant->name, step, 1 / step,
           t->predicted);
    if (contestant_is_adaptive(t->contestant))
        printf("chooses its steps: the mean at rtol %g", adaptive_tolerance);
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
    if (write_limits(plan, folder) || write_scenes(plan, folder) || write_failures(plan, folder))
        return -1;
    printf("  %-28s %-15s %9s %9s %9s  %s\n", "scene, treatment", "stepper", "step, s", "Hz",
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
