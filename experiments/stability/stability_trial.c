/* The search for one method's longest stable step in one cell. A run is stable that is right:
 * finite is not enough.
 *
 * Each method first runs at an anchor, half of the predicted step; from its error there its order
 * says what longer steps may err. Then between the anchor and a step that is a quarter longer than
 * predicted, by halves. */
#include "base/table.h"
#include "model/model.h"
#include "model/problems.h"
#include "stability_limits.h"

#include <math.h>

static const double longest_run = 3; /* CPU s, roughly */

static int resolution(const struct plan *plan) {
    return plan->quick ? 4 : 1; /* 12 %, 3 % */
}

/* --- its runs --- */

static int add_run(struct plan *plan, const struct cell *cell, struct trial *trial, double step,
                   int timings) {
    struct run_request request = limits_request(cell, trial->contestant, step);
    request.timings = timings;
    trial->run = plan->case_count;
    return plan_add(plan, cell->scene, &request, cell->name, "%s, %s %.4g", trial->contestant->name,
                    contestant_is_adaptive(trial->contestant) ? "rtol" : "step", step);
}

static int is_beyond(struct plan *plan, const struct cell *cell, struct trial *trial) {
    const double step = limits_step(cell, trial->place.at);
    if (estimated_cost(cell->scene, cell->treatment, trial->contestant, step) <= longest_run)
        return 0;
    snprintf(trial->note, sizeof trial->note, "a run of shorter steps would take more than %g s",
             longest_run);
    trial->phase = DONE;
    plan_refuse(plan, trial->contestant->method, trial->note);
    return 1;
}

static int try_place(struct plan *plan, const struct cell *cell, struct trial *trial) {
    return is_beyond(plan, cell, trial)
               ? 0
               : add_run(plan, cell, trial, limits_step(cell, trial->place.at), 0);
}

int limits_begin(struct plan *plan, struct cell *cell, const struct configuration *contestant,
                 const struct mode_rate *modes, int mode_count) {
    const struct stepper_method *method = contestant->method;
    struct trial *trial = &cell->trials[cell->trial_count++];
    const struct run_request request = limits_request(cell, contestant, 1e-3);
    *trial = (struct trial){.contestant = contestant,
                            .predicted = modes && stepper_is_predictable(method)
                                             ? stable_step(method, modes, mode_count)
                                             : NAN,
                            .phase = DONE,
                            .place = bracket_begin(-1, 0),
                            .missed = {NAN, FINISHED, NAN},
                            .error = NAN,
                            .cost = no_cost};
    if (!plan_takes(plan, cell->scene, &request, trial->note))
        return 0;
    if (contestant_is_adaptive(contestant)) {
        trial->phase = TIMING;
        return add_run(plan, cell, trial, LIMITS_TOLERANCE, 3);
    }
    const double likely = isfinite(trial->predicted) && trial->predicted > 0
                              ? trial->predicted / 2
                              : usual_step(cell->scene, method);
    trial->phase = ANCHORING;
    trial->place = bracket_begin(limits_place(cell, likely), 0);
    return try_place(plan, cell, trial);
}

/* --- from round to round --- */

static int end_trial(struct plan *plan, const struct cell *cell, struct trial *trial) {
    trial->phase = DONE;
    if (trial->place.missed < 0)
        snprintf(trial->note, sizeof trial->note, "stable at one step between stops of the clock");
    else if (limits_step(cell, trial->place.reached) > 1.2 * trial->predicted)
        snprintf(trial->note, sizeof trial->note,
                 "above the prediction it grows too slowly to show in this time");
    if (cell->axis)
        return 0;
    if (trial->place.missed >= 0 && limits_plan_failures(plan, cell, trial))
        return -1;
    trial->phase = TIMING;
    return add_run(plan, cell, trial, limits_step(cell, trial->place.reached), 3);
}

/* The first place after the anchor: a quarter beyond the prediction, or the longest there is. */
static int first_try(const struct cell *cell, const struct trial *trial) {
    return isfinite(trial->predicted) && trial->predicted > 0
               ? limits_place(cell, 1.25 * trial->predicted)
               : 0;
}

static int take_anchor(struct plan *plan, const struct cell *cell, struct trial *trial,
                       const struct verdict *verdict) {
    if (verdict->outcome != FINISHED) {
        trial->missed = *verdict;
        bracket_take(&trial->place, 0, LIMITS_STRIDE, 1);
        return try_place(plan, cell, trial);
    }
    const int anchor = trial->place.at;
    trial->anchor_step = limits_step(cell, anchor);
    trial->anchor_error = trial->error = verdict->error;
    trial->phase = SEARCHING;
    if (!bracket_take(&trial->place, 1, LIMITS_STRIDE, resolution(plan)))
        return end_trial(plan, cell, trial);
    if (trial->place.missed < 0)
        trial->place.at = first_try(cell, trial) < anchor ? first_try(cell, trial) : anchor - 1;
    return try_place(plan, cell, trial);
}

/* When a run that finished is first wrong. 0, or -1 with plan->reason. */
static int time_wrong(struct plan *plan, struct trial *trial, double step,
                      const struct run_files *tight) {
    struct run_files run;
    if (run_read(&run, plan->cases[trial->run].run.folder, plan->reason))
        return -1;
    trial->missed.failure_time =
        limits_first_wrong(&run.states, &tight->states, limits_tolerated(trial, step));
    run_free(&run);
    return 0;
}

static int take_place(struct plan *plan, const struct cell *cell, struct trial *trial,
                      const struct verdict *verdict, const struct run_files *tight) {
    const double step = limits_step(cell, trial->place.at);
    const int stable =
        verdict->outcome == FINISHED && verdict->error <= limits_tolerated(trial, step);
    if (stable)
        trial->error = verdict->error;
    else
        trial->missed = *verdict;
    if (!stable && verdict->outcome == FINISHED && time_wrong(plan, trial, step, tight))
        return -1;
    return bracket_take(&trial->place, stable, LIMITS_STRIDE, resolution(plan))
               ? try_place(plan, cell, trial)
               : end_trial(plan, cell, trial);
}

int limits_go_on(struct plan *plan, const struct cell *cell, struct trial *trial,
                 const struct run_files *tight) {
    struct verdict verdict;
    if (trial->phase == TIMING) {
        trial->phase = DONE;
        return read_cost(plan, trial->run, &trial->cost);
    }
    if (judge_runs(plan, trial->run, 1, cell->scene, tight, &verdict))
        return -1;
    return trial->phase == ANCHORING ? take_anchor(plan, cell, trial, &verdict)
                                     : take_place(plan, cell, trial, &verdict, tight);
}
