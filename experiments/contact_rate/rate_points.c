/* What the runs of contact-rate have shown. */
#include "contact_rate.h"
#include "experiments/common/limit.h"
#include "model/clock.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct series *own_series(const struct study *study, enum tick_kind ticks) {
    for (int i = 0; i < study->series_count; i++) {
        const struct series *series = &study->series[i];
        if (series->ticks == ticks && series->again >= 0 && series->contact == study->own_contact &&
            series->reciprocal == study->subject->scene->interaction.reciprocal)
            return series;
    }
    return NULL;
}

const struct series *series_of(const struct study *study, int contact, int reciprocal) {
    for (int i = 0; i < study->series_count; i++) {
        const struct series *series = &study->series[i];
        if (series->ticks == WISP_TICKS && series->contact == contact &&
            series->reciprocal == reciprocal)
            return series;
    }
    return NULL;
}

const struct rate_point *point_at(const struct series *series, double rate) {
    for (int i = 0; series && i < series->rate_count; i++)
        if (series->point[i].rate == rate)
            return &series->point[i];
    return NULL;
}

/* --- distances --- */

struct trajectory frames_between(const struct trajectory *states, double from, double to) {
    struct trajectory part = *states;
    const double begin = part.frame_count > 0 ? part.frames[0].t : 0;
    while (part.frame_count > 0 && part.frames[0].t - begin <= from + 1e-9) {
        part.frames++;
        part.frame_count--;
    }
    while (part.frame_count > 0 && part.frames[part.frame_count - 1].t - begin > to + 1e-9) {
        part.frame_count--;
        part.table.row_count = part.frames[part.frame_count].row;
    }
    return part;
}

/* Distance of two runs over the frames after `from` up to `to`. */
static int compare(struct plan *plan, const struct study *study, const struct trajectory *run,
                   const struct trajectory *other, double from, double to, struct deviation *d) {
    const struct trajectory a = frames_between(run, from, to), b = frames_between(other, from, to);
    return measure_deviation(study->subject->scene, &a, &b, 1, d, plan->reason);
}

static int read_run(struct plan *plan, int at, struct run_files *run) {
    return plan_read(plan, &plan->cases[at], run);
}

/* --- the horizon --- */

int read_horizon(struct plan *plan, struct series *series) {
    const struct rate_point *yardstick = &series->point[series->rate_count - 1];
    return measure_horizon(plan->trajectories, plan->cases[yardstick->at].run.folder,
                           plan->cases[series->again].run.folder, &series->horizon, plan->reason);
}

/* --- counts --- */

/* Times at which every wisp's advance ends: ticks that can act, frames, and the end. */
static double count_stops(const struct scene *scene) {
    const int touch = scene->interaction.interpenetration || scene->interaction.collision;
    struct clock clock = clock_start(scene->begin, scene->duration);
    struct stop stop;
    double count = 0;
    clock_add(&clock, STOP_FRAME, scene->frame_rate, 0);
    if (scene->wisps[0].samples > 0 || scene_tick_bodies(scene) > 0)
        clock_add(&clock, STOP_COLLISION, scene->collision_rate, 0);
    if (touch || scene->subdivision.limit > scene->wisp_count)
        clock_add(&clock, STOP_INTERACTION, scene->interaction.rate, 0);
    while (clock_next(&clock, &stop))
        count++;
    return count;
}

static void read_counts(const struct scene *scene, const struct run_files *run,
                        const struct series *series, struct rate_point *point) {
    point->outcome = run->outcome;
    point->failure_time = run_number(run, "failure_time");
    point->contacts = run_number(run, series->ticks == WISP_TICKS ? "counters.wisp_contacts"
                                                                  : "counters.body_contacts");
    point->sections = run_number(run, "counters.sections_tested");
    point->evaluations = run_number(run, "counters.force_evaluations");
    point->cpu = run_number(run, "cpu_seconds");
    point->stops = count_stops(scene);
}

/* --- after the horizon --- */

static void free_runs(struct run_files *runs, int count) {
    for (int i = 0; i < count; i++)
        run_free(&runs[i]);
}

/* Returns how many there are, or -1 with plan->reason. */
static int read_members(struct plan *plan, const struct rate_point *point,
                        struct run_files runs[MEMBERS]) {
    for (int i = 0; i < point->count; i++)
        if (read_run(plan, point->first + i, &runs[i])) {
            free_runs(runs, i);
            return -1;
        }
    return point->count;
}

/* The spread of all pairs of one of `runs` with one of `others`, or of each two of them. */
static int spread_pairs(struct plan *plan, const struct study *study, double from,
                        const struct run_files *runs, int count, const struct run_files *others,
                        struct spread_of_pairs *spread) {
    double distance[MEMBERS * MEMBERS];
    int pairs = 0;
    for (int i = 0; i < count; i++)
        for (int k = runs == others ? i + 1 : 0; k < count; k++) {
            struct deviation d;
            if (runs[i].outcome != FINISHED || others[k].outcome != FINISHED)
                continue;
            if (compare(plan, study, runs[i].states, others[k].states, from, INFINITY, &d))
                return -1;
            if (isfinite(d.rms))
                distance[pairs++] = d.rms;
        }
    *spread = (struct spread_of_pairs){.pairs = pairs, NAN, NAN, NAN};
    if (pairs == 0)
        return 0;
    gsl_sort(distance, 1, (size_t)pairs);
    spread->lower = gsl_stats_quantile_from_sorted_data(distance, 1, (size_t)pairs, 0.25);
    spread->median = gsl_stats_quantile_from_sorted_data(distance, 1, (size_t)pairs, 0.5);
    spread->upper = gsl_stats_quantile_from_sorted_data(distance, 1, (size_t)pairs, 0.75);
    return 0;
}

static int read_after(struct plan *plan, const struct study *study, struct series *series) {
    struct rate_point *yardstick = &series->point[series->rate_count - 1];
    struct run_files theirs[MEMBERS], runs[MEMBERS];
    const int members = read_members(plan, yardstick, theirs);
    int code = members < 0 ? -1 : 0;
    if (members <= 0)
        return code;
    for (int i = 0; i < series->rate_count && !code; i++) {
        struct rate_point *point = &series->point[i];
        const int count = point == yardstick ? 0 : read_members(plan, point, runs);
        if (point == yardstick)
            code =
                spread_pairs(plan, study, series->horizon, theirs, members, theirs, &point->after);
        else if (count > 0)
            code = spread_pairs(plan, study, series->horizon, runs, count, theirs, &point->after);
        if (count > 0)
            free_runs(runs, count);
        code = code || count < 0 ? -1 : 0;
    }
    free_runs(theirs, members);
    return code;
}

/* --- a series --- */

static int read_point(struct plan *plan, const struct study *study, const struct series *series,
                      const struct run_files *yardstick, struct rate_point *point) {
    struct deviation near = {.rms = NAN, .largest = NAN, .history_diverged = NAN}, whole = near;
    struct run_files run;
    if (read_run(plan, point->at, &run))
        return -1;
    int code = 0;
    read_counts(plan->cases[point->at].run.scene, &run, series, point);
    if (run.outcome == FINISHED && !isnan(series->horizon))
        code = compare(plan, study, run.states, yardstick->states, -1, series->horizon, &near) ||
               compare(plan, study, run.states, yardstick->states, -1, INFINITY, &whole);
    run_free(&run);
    point->error = near.rms;
    point->largest = near.largest;
    point->whole = whole.rms;
    point->history_diverged = whole.history_diverged;
    return code ? -1 : 0;
}

/* Distance of a run of the plan from a table of states up to the horizon; NaN where it failed. */
static int distance_of(struct plan *plan, const struct study *study, int at,
                       const struct trajectory *states, double to, double *distance) {
    struct deviation d = {.rms = NAN};
    struct run_files run;
    if (read_run(plan, at, &run))
        return -1;
    const int code = run.outcome == FINISHED && !isnan(to)
                         ? compare(plan, study, run.states, states, -1, to, &d)
                         : 0;
    run_free(&run);
    *distance = d.rms;
    return code;
}

/* Errors that are more than twice what the yardstick itself is sure of, over the interval between
 * ticks less the yardstick's: an error that is proportional to the interval has slope 1. */
static void fit_order(struct series *series) {
    const struct configuration rk4 = {.method = stepper_find("rk4")};
    struct slope slope = {.count = 0};
    for (int i = 0; i + 1 < series->rate_count; i++) {
        const struct rate_point *point = &series->point[i];
        if (point->error > 2 * series->doubt)
            slope_add(&slope, 1 / point->rate - 1 / YARDSTICK_RATE, point->error);
    }
    series->order = slope_fit(&slope, &rk4);
    series->has_order = series->order.points > 0;
}

static int read_points(struct plan *plan, const struct study *study, struct series *series,
                       const struct run_files *yardstick) {
    for (int i = 0; i < series->rate_count; i++)
        if (read_point(plan, study, series, yardstick, &series->point[i]))
            return -1;
    return 0;
}

/* The first time at which a rate's wisps are others than the yardstick's; NaN: there is none. */
static double first_divergence(const struct series *series) {
    double first = NAN;
    for (int i = 0; i < series->rate_count; i++)
        first = fmin(first, series->point[i].history_diverged); /* which passes NaN over */
    return first;
}

/* All rates are compared over the same frames: where wisps split at ticks that depend on the rate,
 * up to the frame before the first that differs. */
static int compare_points(struct plan *plan, const struct study *study, struct series *series,
                          const struct run_files *yardstick) {
    if (read_points(plan, study, series, yardstick))
        return -1;
    const double diverged = first_divergence(series) - study->subject->scene->begin;
    const double frame = 1 / study->frame_rate;
    if (!(diverged <= series->horizon + 1e-9))
        return 0;
    series->horizon = fmax(0, diverged - frame);
    return read_points(plan, study, series, yardstick);
}

static int read_series(struct plan *plan, struct study *study, struct series *series) {
    const struct series *control = series_of(study, 0, 1);
    struct run_files yardstick;
    series->doubt = series->effect = 0;
    series->horizon = study->duration;
    if (series->again >= 0 && read_horizon(plan, series))
        return -1;
    if (read_run(plan, series->point[series->rate_count - 1].at, &yardstick))
        return -1;
    if (yardstick.outcome != FINISHED)
        series->horizon = NAN;
    int code = compare_points(plan, study, series, &yardstick);
    if (!code && series->again >= 0)
        code = distance_of(plan, study, series->again, yardstick.states, series->horizon,
                           &series->doubt);
    if (!code && series->ticks == WISP_TICKS)
        code = distance_of(plan, study, control->point[control->rate_count - 1].at,
                           yardstick.states, series->horizon, &series->effect);
    run_free(&yardstick);
    fit_order(series);
    return code || read_after(plan, study, series) ? -1 : 0;
}

/* --- who errs --- */

/* The least of the yardsticks' horizons: one span for all. */
static int find_span(struct plan *plan, struct study *study) {
    double span;
    if (measure_horizon(plan->trajectories, plan->cases[study->reference].run.folder,
                        plan->cases[study->reference_again].run.folder, &span, plan->reason))
        return -1;
    for (int ticks = 0; ticks < TICK_KINDS; ticks++) {
        const struct series *series = own_series(study, (enum tick_kind)ticks);
        if (series)
            span = isnan(series->horizon) || isnan(span) ? NAN : fmin(span, series->horizon);
    }
    study->span = span;
    return 0;
}

/* Distances of a run from states: up to the span, over all frames. */
static int read_both(struct plan *plan, const struct study *study, int at,
                     const struct trajectory *states, double *near, double *whole) {
    return distance_of(plan, study, at, states, study->span, near)
               ? -1
               : distance_of(plan, study, at, states, INFINITY, whole);
}

/* The error of run `at` by the states of another, which are in doubt by run `again`. */
static int read_error(struct plan *plan, const struct study *study, int at, int yardstick,
                      int again, struct source_error *error) {
    struct run_files run;
    if (read_run(plan, yardstick, &run))
        return -1;
    int code = 0;
    if (run.outcome == FINISHED)
        code = read_both(plan, study, at, run.states, &error->error, &error->whole) ||
               read_both(plan, study, again, run.states, &error->doubt, &error->whole_doubt);
    run_free(&run);
    return code ? -1 : 0;
}

static int read_integrator(struct plan *plan, struct study *study) {
    struct source_error *error = &study->error[INTEGRATOR];
    snprintf(error->against, sizeof error->against,
             "euler at 9000 Hz, from rk4 at %g Hz, both with projection", 2 / study->step);
    return read_error(plan, study, study->euler, study->reference, study->reference_again, error);
}

/* Projection's distance from the limit of penalty; in doubt by twice what one ratio and one degree
 * more make of that (see experiment treatments). */
static int compare_treatments(struct plan *plan, const struct study *study,
                              const struct run_files runs[PENALTIES], struct source_error *error) {
    const struct trajectory *states[PENALTIES];
    struct trajectory limit, more = {.table.value = NULL};
    struct deviation near = {.rms = NAN}, whole = near;
    for (int i = 0; i < PENALTIES; i++)
        states[i] = runs[i].states;
    int code = penalty_limit(states + 1, penalty_ratios + 1, PENALTIES - 1, &limit) ||
               penalty_limit(states, penalty_ratios, PENALTIES, &more);
    if (code)
        snprintf(plan->reason, REASON_SIZE, "scene %s: no limit of penalty could be taken",
                 study->subject->name);
    code = code || read_both(plan, study, study->reference, &limit, &error->error, &error->whole) ||
           compare(plan, study, &more, &limit, -1, study->span, &near) ||
           compare(plan, study, &more, &limit, -1, INFINITY, &whole);
    error->doubt = 2 * near.rms;
    error->whole_doubt = 2 * whole.rms;
    free(limit.table.value);
    free(more.table.value);
    return code ? -1 : 0;
}

static int read_treatment(struct plan *plan, struct study *study) {
    struct source_error *error = &study->error[TREATMENT];
    struct run_files runs[PENALTIES];
    int count = 0, finished = 1, same = 1;
    snprintf(error->against, sizeof error->against,
             "projection, from penalty's limit at ratios %g to %g, both rk4", penalty_ratios[1],
             penalty_ratios[PENALTIES - 1]);
    for (; count < PENALTIES && read_run(plan, study->penalty[count], &runs[count]) == 0; count++) {
        finished &= runs[count].outcome == FINISHED;
        same &= runs[count].states->table.row_count == runs[0].states->table.row_count;
    }
    int code = count < PENALTIES ? -1 : 0;
    if (!code && finished && same && !isnan(study->span))
        code = compare_treatments(plan, study, runs, error);
    free_runs(runs, count);
    return code;
}

/* The scene's own rate. The series' errors are up to its own horizon; here the span is that of
 * all. */
static int read_ticks(struct plan *plan, struct study *study, enum tick_kind ticks) {
    struct source_error *error = &study->error[OF_WISP_TICKS + (int)ticks];
    const struct scene *scene = study->subject->scene;
    const double rate = ticks == WISP_TICKS ? scene->interaction.rate : scene->collision_rate;
    const struct series *series = own_series(study, ticks);
    const struct rate_point *point = point_at(series, rate);
    snprintf(error->against, sizeof error->against, "%s at %g Hz, from %g Hz, both rk4",
             ticks == WISP_TICKS ? "wisps" : "bodies", rate, YARDSTICK_RATE);
    if (!point || isnan(study->span))
        return 0;
    return read_error(plan, study, point->at, series->point[series->rate_count - 1].at,
                      series->again, error);
}

static int read_sources(struct plan *plan, struct study *study) {
    for (int i = 0; i < SOURCES; i++)
        study->error[i] = (struct source_error){NAN, NAN, NAN, NAN, ""};
    study->span = NAN;
    if (find_span(plan, study) || read_integrator(plan, study) || read_treatment(plan, study) ||
        read_ticks(plan, study, WISP_TICKS))
        return -1;
    return read_ticks(plan, study, BODY_TICKS);
}

int read_study(struct plan *plan, struct study *study) {
    for (int i = 0; i < study->series_count; i++)
        if (read_series(plan, study, &study->series[i]))
            return -1;
    return study->has_sources ? read_sources(plan, study) : 0;
}
