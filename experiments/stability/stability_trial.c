/* The search for one method's longest stable step in one cell. A run is stable that comes to its
 * end and has not diverged, by its strain or by its energy; how far it is from the truth is another
 * question, and has columns of its own.
 *
 * Each method first runs at an anchor, half of the predicted step; from its error there its order
 * says what longer steps may err. Then between the anchor and a step that is a quarter longer than
 * predicted, by halves. From the longest stable step on, the aims are looked for among shorter
 * ones, one after the other. */
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
    struct run_request request = limits_request(cell, trial->configuration, step);
    request.timings = timings;
    request.diagnostics = !timings;
    trial->run = plan->case_count;
    return plan_add(plan, cell->scene, &request, cell->name, "%s, %s %.4g",
                    trial->configuration->name,
                    configuration_is_adaptive(trial->configuration) ? "rtol" : "step", step);
}

static int is_too_expensive(const struct cell *cell, const struct trial *trial, int place) {
    return estimated_cost(cell->scene, cell->treatment, trial->configuration,
                          limits_step(cell, place)) > longest_run;
}

/* Runs of shorter steps that nobody waits for end the search. */
static int try_place(struct plan *plan, const struct cell *cell, struct trial *trial) {
    if (!is_too_expensive(cell, trial, trial->place.at))
        return add_run(plan, cell, trial, limits_step(cell, trial->place.at), 0);
    snprintf(trial->note, sizeof trial->note, "a run of shorter steps would take more than %g s",
             longest_run);
    trial->phase = DONE;
    plan_refuse(plan, trial->configuration->method, trial->note);
    return 0;
}

int limits_begin(struct plan *plan, struct cell *cell, const struct configuration *configuration,
                 const struct mode_rate *modes, int mode_count) {
    const struct stepper_method *method = configuration->method;
    struct trial *trial = &cell->trials[cell->trial_count++];
    const struct run_request request = limits_request(cell, configuration, 1e-3);
    *trial = (struct trial){.configuration = configuration,
                            .predicted = modes && stepper_is_predictable(method)
                                             ? stable_step(method, modes, mode_count)
                                             : NAN,
                            .phase = DONE,
                            .place = bracket_begin(-1, 0),
                            .missed = {NAN, FINISHED, NAN},
                            .error = NAN,
                            .cost = no_cost};
    for (int i = 0; i < AIMS; i++)
        trial->aims[i] =
            (struct aim){.place = bracket_begin(-1, 0), .error = NAN, .timed = -1, .cost = no_cost};
    if (!plan_takes(plan, cell->scene, &request, trial->note))
        return 0;
    if (configuration_is_adaptive(configuration)) {
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

/* The timed runs of the longest stable step and of the two that are near the truth. */
static int begin_timing(struct plan *plan, const struct cell *cell, struct trial *trial) {
    trial->phase = DONE;
    if (cell->axis)
        return 0;
    if (trial->place.missed >= 0 && limits_plan_failures(plan, cell, trial))
        return -1;
    trial->phase = TIMING;
    for (int i = NEAR; i <= MILLIMETRE; i++) {
        struct aim *aim = &trial->aims[i];
        if (aim->place.reached < 0)
            continue;
        aim->timed = plan->case_count;
        if (add_run(plan, cell, trial, limits_step(cell, aim->place.reached), 3))
            return -1;
    }
    return add_run(plan, cell, trial, limits_step(cell, trial->place.reached), 3);
}

static int read_timing(struct plan *plan, struct trial *trial) {
    trial->phase = DONE;
    for (int i = 0; i < AIMS; i++)
        if (trial->aims[i].timed >= 0 &&
            read_cost(plan, trial->aims[i].timed, &trial->aims[i].cost))
            return -1;
    return read_cost(plan, trial->run, &trial->cost);
}

/* --- the aims --- */

/* Takes the error at an aim's place, m, NaN of a run that failed. Returns whether there is another
 * place to try. */
static int take_error(const struct plan *plan, const struct cell *cell, struct trial *trial,
                      double error) {
    struct aim *aim = &trial->aims[trial->aiming];
    const double step = limits_step(cell, aim->place.at);
    const int reached = error <= limits_allowed(cell, trial, trial->aiming, step);
    if (reached)
        aim->error = error;
    return bracket_take(&aim->place, reached, LIMITS_STRIDE, resolution(plan)) &&
           !is_too_expensive(cell, trial, aim->place.at);
}

/* Goes to the first aim that the longest stable step does not reach, and to shorter ones. */
static int next_aim(struct plan *plan, const struct cell *cell, struct trial *trial) {
    for (; trial->aiming < AIMS; trial->aiming++) {
        struct aim *aim = &trial->aims[trial->aiming];
        aim->place = bracket_begin(trial->place.reached, trial->place.reached);
        const int asked = !cell->axis || trial->aiming == IN_ORDER; /* along an axis that alone */
        if (asked && take_error(plan, cell, trial, trial->error))
            return add_run(plan, cell, trial, limits_step(cell, aim->place.at), 0);
    }
    return begin_timing(plan, cell, trial);
}

static int begin_aiming(struct plan *plan, const struct cell *cell, struct trial *trial) {
    if (trial->place.missed < 0)
        snprintf(trial->note, sizeof trial->note, "stable at one step between stops of the clock");
    else if (limits_step(cell, trial->place.reached) > 1.2 * trial->predicted)
        snprintf(trial->note, sizeof trial->note,
                 "above the prediction it grows too slowly to show in this time");
    trial->phase = AIMING;
    trial->aiming = NEAR;
    return next_aim(plan, cell, trial);
}

static int take_aim(struct plan *plan, const struct cell *cell, struct trial *trial,
                    const struct verdict *verdict) {
    if (take_error(plan, cell, trial, verdict->error))
        return add_run(plan, cell, trial, limits_step(cell, trial->aims[trial->aiming].place.at),
                       0);
    trial->aiming++;
    return next_aim(plan, cell, trial);
}

/* --- the longest stable step --- */

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
        return begin_aiming(plan, cell, trial);
    if (trial->place.missed < 0)
        trial->place.at = first_try(cell, trial) < anchor ? first_try(cell, trial) : anchor - 1;
    return try_place(plan, cell, trial);
}

static int take_place(struct plan *plan, const struct cell *cell, struct trial *trial,
                      const struct verdict *verdict) {
    const int stable = verdict->outcome == FINISHED;
    if (stable)
        trial->error = verdict->error;
    else
        trial->missed = *verdict;
    return bracket_take(&trial->place, stable, LIMITS_STRIDE, resolution(plan))
               ? try_place(plan, cell, trial)
               : begin_aiming(plan, cell, trial);
}

int limits_go_on(struct plan *plan, const struct cell *cell, struct trial *trial,
                 const struct run_files *reference) {
    struct verdict verdict;
    if (trial->phase == TIMING)
        return read_timing(plan, trial);
    if (judge_runs(plan, trial->run, 1, cell->scene, reference, &verdict))
        return -1;
    return trial->phase == ANCHORING   ? take_anchor(plan, cell, trial, &verdict)
           : trial->phase == SEARCHING ? take_place(plan, cell, trial, &verdict)
                                       : take_aim(plan, cell, trial, &verdict);
}
