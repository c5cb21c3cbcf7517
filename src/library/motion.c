/* How a handle's state goes on: by its clock and ticks, and by the program's own steppers. */
#include "base/files.h"
#include "library.h"
#include "run/simulation.h"

#include <math.h>
#include <string.h>

/* --- the clock --- */

static void find_next(wisplab *w) {
    if (!clock_next(&w->clock, &w->next) || w->next.events & STOP_END)
        w->next = (struct stop){.t = INFINITY};
}

void library_start_clock(wisplab *w) {
    w->last = w->model->t;
    w->clock = clock_until(w->last, INFINITY);
    clock_add(&w->clock, STOP_COLLISION, w->model->collision_rate, 0);
    clock_add(&w->clock, STOP_INTERACTION, w->model->interaction_rate, 0);
    w->clock.kink = w->model->kinks;
    w->clock.kink_count = w->model->kink_count;
    find_next(w);
}

void wisplab_next_stop(const wisplab *w, double *t, unsigned *events) {
    *t = w->next.t;
    if (events)
        *events = w->next.events;
}

int wisplab_tick(wisplab *w, int *changed) {
    struct model *model = w->model;
    const int parts = model->part_count;
    if (!clock_same(model->t, w->next.t))
        return library_fail(w, WISPLAB_REFUSED,
                            "the state is at %.17g s, and the next stop is at %.17g s", model->t,
                            w->next.t);
    memset(w->changed, 0, w->part_room * sizeof *w->changed);
    model->t = w->next.t;
    const enum outcome outcome = model->problem->tick
                                     ? model->problem->tick(model, NULL, w->next.events, w->changed)
                                     : FINISHED;
    w->prepared = NOTHING;
    w->last = w->next.t;
    find_next(w);
    if (changed)
        *changed = model->part_count > parts;
    for (int i = 0; i < parts && changed; i++)
        *changed |= w->changed[i] != 0;
    return library_outcome(w, (int)outcome,
                           outcome == OUT_OF_MEMORY ? "no memory for a tick" : model->trouble);
}

/* --- runs --- */

/* The caller's function as an observer of a run. */
static int show(void *ctx, const struct model *model, double t, const double *rows) {
    const struct wisplab_method *method = ctx;
    return method->frame(method->context, t, rows, model->row_count) ? INTERRUPTED : FINISHED;
}

static int resolve(wisplab *w, const struct wisplab_method *method, struct settings *settings) {
    const struct run_request request = {
        .stepper = method->stepper,
        .treatment = wisplab_treatment(w),
        .linear = method->linear,
        .step = method->step,
        .rtol = method->rtol,
        .atol = method->atol,
        .options = method->options,
        .option_count = library_count(method->options),
        .strain_limit = method->strain_limit,
        .threads = method->threads,
        .states = STATES_NONE,
    };
    char reason[REASON_SIZE];
    const int refused = settings_resolve(w->scene, &request, settings, reason);
    if (refused)
        return library_outcome(w, refused, reason);
    if (stepper_shares_steps(settings->method, &settings->stepper.options) &&
        stepper_lanes(settings->method, settings->stepper.linear, &settings->stepper.options) > 1)
        return library_fail(w, WISPLAB_REFUSED, "wisps share no steps here: lanes must be 1");
    return WISPLAB_OK;
}

static int check_end(wisplab *w, const struct settings *settings, double to) {
    if (!(isfinite(to) && to > w->model->t))
        return library_fail(w, WISPLAB_REFUSED, "a run must go on, beyond %.17g s", w->model->t);
    if (settings->step > 0 && to / settings->step > 1e15)
        return library_fail(w, WISPLAB_REFUSED, "more than 1e15 steps to the end");
    return WISPLAB_OK;
}

int wisplab_run(wisplab *w, const struct wisplab_method *method, double to) {
    struct settings settings;
    struct run_result result;
    const struct observer observer = {show, (void *)method};
    int code = resolve(w, method, &settings);
    code = code ? code : check_end(w, &settings, to);
    if (!code && clock_same(w->model->t, w->next.t))
        code = wisplab_tick(w, NULL);
    if (code)
        return code;
    simulate_model(w->model, w->scene, &settings, to, method->frame ? &observer : NULL, NULL,
                   &result);
    w->prepared = NOTHING;
    library_start_clock(w);
    return library_outcome(w, (int)result.outcome, result.reason);
}
