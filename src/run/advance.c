/* Every part of a model from stop to stop, by the method's steps, on threads. */
#include "base/vector.h"
#include "base/workers.h"
#include "simulation_parts.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

void add_steps(struct step_range *all, const struct step_range *part) {
    if (part->largest == 0)
        return;
    all->least = all->largest > 0 ? fmin(all->least, part->least) : part->least;
    all->largest = fmax(all->largest, part->largest);
}

static double evaluations_of(const struct simulation *sim, int i) {
    return (double)sim->model->parts[i].system.counters.force_evaluations;
}

/* Before each step of part i: tells how far the run is, and asks whether it may go on. The first
 * part speaks for all: threads that write to one place wait for each other. For the same reason a
 * part looks at its own evaluations only. */
static int interrupted(struct simulation *sim, int i, double t) {
    if (i == 0 && sim->watch && sim->watch->reached)
        atomic_store_explicit(sim->watch->reached, t, memory_order_relaxed);
    return (sim->watch && sim->watch->stop && *sim->watch->stop) ||
           evaluations_of(sim, i) - sim->progress[i].evaluations > sim->evaluations_left;
}

/* What is left of the evaluations that all parts share. */
void count_evaluations(struct simulation *sim) {
    double left =
        sim->watch && sim->watch->evaluations > 0 ? sim->watch->evaluations : (double)INFINITY;
    for (int i = 0; i < sim->model->part_count && left < (double)INFINITY; i++) {
        sim->progress[i].evaluations = evaluations_of(sim, i);
        left -= sim->progress[i].evaluations;
    }
    sim->evaluations_left = left;
}

/* So many wisps of part i have taken a step of h. */
static void note_step(struct simulation *sim, int i, int wisps, double h) {
    struct step_range *steps = &sim->progress[i].steps;
    sim->model->parts[i].system.counters.steps += wisps;
    if (steps->largest == 0 || h < steps->least || h > steps->largest)
        add_steps(steps, &(struct step_range){h, h});
}

/* After a step of part i to time t: whether its state is one that the model can mean. Most steps
 * have no new largest strain, and that is quickly seen. */
static int check_strain(struct simulation *sim, int i, double t) {
    const struct problem *problem = sim->scene->problem;
    struct progress_of_part *part = &sim->progress[i];
    int wisp = 0;
    if (!problem->strain)
        return 0;
    const double strain = problem->strain(sim->model, i, t, part->strain, &wisp);
    if (strain > part->strain)
        part->strain = strain;
    if (strain <= sim->settings->strain_limit)
        return 0;
    return system_fail(&sim->model->parts[i].system, -DIVERGED,
                       "wisp %d: a segment is %.3g of its length away from it, more than %.3g",
                       wisp, strain, sim->settings->strain_limit);
}

/* Equal steps over the interval, the last of them ending at `to`. */
static int advance_fixed(struct simulation *sim, int i, double *t, double to) {
    struct part *part = &sim->model->parts[i];
    const double from = *t;
    const long long steps = clock_steps(to - from, sim->settings->step);
    const double h = (to - from) / (double)steps;

    int code = 0;
    for (long long k = 0; k < steps && !code && !interrupted(sim, i, *t); k++) {
        code = sim->settings->method->step(sim->steppers[i], *t, h, part->q, part->v);
        if (code)
            return code;
        note_step(sim, i, part->system.wisps, h);
        *t = k + 1 == steps ? to : from + (double)(k + 1) * h;
        if (part->account)
            account_step(part, *t);
        code = check_strain(sim, i, *t);
    }
    return code;
}

/* Lanes have come from some times to others; returns the earliest of these. */
static double note_lanes(struct simulation *sim, int i, const double *from, const double *t) {
    const struct system *system = &sim->model->parts[i].system;
    double least = t[0];
    for (int k = 0; k < system->lanes; k++) {
        if (t[k] > from[k] && k < system->wisps)
            note_step(sim, i, 1, t[k] - from[k]);
        least = fmin(least, t[k]);
    }
    return least;
}

/* Steps of the method's own choice, or just one of them. Lanes may be at times of their own. */
static int advance_adaptive(struct simulation *sim, int i, double *t, double to, int once) {
    struct part *part = &sim->model->parts[i];
    double times[LANES_MOST] = {0}, from[LANES_MOST];
    int code;
    for (int k = 0; k < part->system.lanes; k++)
        times[k] = *t;
    do {
        memcpy(from, times, sizeof from);
        code = sim->settings->method->advance(sim->steppers[i], times, to, part->q, part->v);
        *t = note_lanes(sim, i, from, times);
        if (code)
            return code;
        if (part->account)
            account_step(part, *t);
        part->system.times = times;
        code = check_strain(sim, i, *t);
        part->system.times = NULL;
    } while (*t < to && !code && !once && !interrupted(sim, i, *t));
    return code;
}

/* An interval to be advanced over, and how far each part has come. */
struct interval {
    struct simulation *sim;
    double to;
    int once;  /* every accepted step is a frame */
    int alone; /* parts do by themselves what is to be done at its end */
};

/* Whether parts do so at a stop: no kind of event at which they meet, and nobody books energies. */
int parts_tick_alone(const struct simulation *sim, unsigned events) {
    return sim->model->ticks_alone && events & STOP_COLLISION &&
           !(events & (STOP_INTERACTION | STOP_KINK)) && !sim->settings->diagnostics;
}

/* The state is in the cache, and nobody else need be waited for. */
static void tick_part(struct simulation *sim, int i, double t) {
    const unsigned changed = sim->scene->problem->tick_part(sim->model, i, t);
    if (changed && sim->settings->method->reset)
        sim->settings->method->reset(sim->steppers[i], changed);
}

static void advance_part(void *ctx, int i) {
    const struct interval *interval = ctx;
    struct simulation *sim = interval->sim;
    struct progress_of_part *part = &sim->progress[i];
    const struct part *state = &sim->model->parts[i];
    part->reached = sim->t;
    sim->model->parts[i].system.from = sim->t;
    sim->model->parts[i].system.until = interval->to;
    if (sim->settings->diagnostics)
        account_begin(&sim->model->parts[i], sim->t);
    part->code = sim->settings->method->advance
                     ? advance_adaptive(sim, i, &part->reached, interval->to, interval->once)
                     : advance_fixed(sim, i, &part->reached, interval->to);
    part->finite = all_finite(state->q, state->system.size) &&
                   all_finite(state->v, state->system.size); /* while they are in the cache */
    if (interval->alone && !part->code && part->finite && part->reached == interval->to)
        tick_part(sim, i, interval->to);
}

/* Whether the run may go on from where all parts have arrived. */
static void check_limits(struct simulation *sim) {
    const struct watch *watch = sim->watch;
    const int stop = watch && watch->stop ? *watch->stop : 0;
    if (sim->evaluations_left < 0)
        end_run(sim, OUT_OF_TIME, "its limit of force evaluations was reached");
    else if (stop)
        end_run(sim, (enum outcome)stop,
                stop == OUT_OF_TIME ? "its limit of CPU time was reached" : "stopped from outside");
}

static void check_finite(struct simulation *sim) {
    for (int i = 0; i < sim->model->part_count && is_running(sim); i++)
        if (!sim->progress[i].finite)
            end_run(sim, NOT_FINITE, "the state overflowed or became NaN");
}

/* The smooth advance of every part to the stop at `to`, or by one step of the only part where
 * every accepted step is a frame. Parts do not see each other: threads share them out. */
void advance_parts(struct simulation *sim, double to, int alone) {
    struct interval interval = {sim, to, sim->settings->every_step, alone};
    double reached = to;

    workers_run(sim->workers, advance_part, &interval, sim->model->part_count);
    for (int i = 0; i < sim->model->part_count; i++) {
        const struct progress_of_part *part = &sim->progress[i];
        if (part->code && is_running(sim))
            end_run(sim, (enum outcome)abs(part->code), sim->model->parts[i].system.reason);
        reached = fmin(reached, part->reached);
    }
    sim->t = sim->model->t = reached;
    sim->result->time = reached;
    count_evaluations(sim);
    if (is_running(sim))
        check_limits(sim);
    check_finite(sim);
}
