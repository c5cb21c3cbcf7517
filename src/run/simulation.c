#include "simulation.h"

#include "base/files.h"
#include "base/progress.h"
#include "base/vector.h"
#include "base/workers.h"
#include "model/clock.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a thread says of a part it has advanced. */
struct progress_of_part {
    double reached;     /* s */
    int code;           /* of the step that failed, or 0 */
    int finite;         /* whether the state is */
    double evaluations; /* up to the last stop */
    struct step_range steps;
    double strain; /* the largest after any step */
    struct profile profile;
    struct account account; /* where diagnoses are asked for */
};

struct simulation {
    const struct scene *scene;
    const struct settings *settings;
    const struct observer *observer;
    const struct watch *watch;
    struct run_result *result;
    struct model *model;
    struct stepper **steppers; /* one for each part */
    int stepper_count;
    double *rows; /* a frame */
    int *changed; /* by part: lanes whose state a tick changed, bit k for lane k */
    struct progress_of_part *progress;
    struct workers *workers;
    struct clock clock;
    double t;
    double evaluations_left; /* at the last stop, of what the watch allows; infinite without */

    /* where diagnoses are asked for */
    struct diagnosis diagnosis;          /* of the last frame */
    double first_energy;                 /* J */
    double most_energy;                  /* the largest that was stored at a frame, J */
    double other_jumps;                  /* at ticks, of no kind that parts have accounts of, J */
    double body_contacts, wisp_contacts; /* up to the last frame */
};

static void end_with(struct simulation *sim, enum outcome outcome, const char *reason) {
    sim->result->outcome = outcome;
    snprintf(sim->result->reason, REASON_SIZE, "%s", reason);
}

/* Adds to the reason of a run that the method has failed what its settings may have to do with it.
 */
static void add_caution(struct simulation *sim) {
    const struct stepper_method *method = sim->settings->method;
    const enum outcome outcome = sim->result->outcome;
    if (!method->caution || sim->stepper_count == 0 || !sim->steppers[0] ||
        (outcome != NOT_FINITE && outcome != DIVERGED && outcome != MODEL_FAILED))
        return;
    const char *caution = method->caution(sim->steppers[0]);
    const size_t used = strlen(sim->result->reason);
    if (caution)
        snprintf(sim->result->reason + used, REASON_SIZE - used, "; %s", caution);
}

static int going(const struct simulation *sim) {
    return sim->result->outcome == FINISHED;
}

static void start_clock(struct simulation *sim) {
    const double rate = sim->scene->frame_rate;
    sim->clock = clock_start(sim->scene->begin, sim->scene->duration);
    clock_add(&sim->clock, STOP_FRAME, rate, rate > 0 ? 0 : sim->settings->frame_interval);
    clock_add(&sim->clock, STOP_COLLISION, sim->model->collision_rate, 0);
    clock_add(&sim->clock, STOP_INTERACTION, sim->model->interaction_rate, 0);
    sim->clock.kink = sim->model->kinks;
    sim->clock.kink_count = sim->model->kink_count;
}

/* Displaces every node's start at random, by settings->perturbation in the rms: two such runs tell
 * how long the scene lets trajectories be compared. What a problem prescribes it does not take
 * back from rows. */
static void perturb_start(struct simulation *sim) {
    const struct problem *problem = sim->scene->problem;
    const int columns = sim->model->column_count;
    const double each = sim->settings->perturbation / sqrt(3);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!random) {
        end_with(sim, OUT_OF_MEMORY, "no memory for random numbers");
        return;
    }
    gsl_rng_set(random, (unsigned long)sim->settings->draw);
    problem->sample(sim->model, sim->rows);
    for (int i = 0; i < sim->model->row_count; i++)
        for (int k = 2; k < 5; k++) /* x y z, after wisp and node */
            sim->rows[i * columns + k] += gsl_ran_gaussian(random, each);
    problem->restore(sim->model, sim->rows);
    if (problem->project)
        problem->project(sim->model);
    gsl_rng_free(random);
}

/* A stepper for each part that has none: the parts at the start, and those a tick has added. */
static void create_steppers(struct simulation *sim) {
    for (; sim->stepper_count < sim->model->part_count && going(sim); sim->stepper_count++) {
        const int i = sim->stepper_count;
        struct system *system = &sim->model->parts[i].system;
        system->unprojected = sim->settings->unprojected;
        if (sim->settings->profile)
            system->profile = &sim->progress[i].profile;
        if (sim->settings->diagnostics)
            sim->model->parts[i].account = &sim->progress[i].account;
        sim->steppers[i] = stepper_create(sim->settings->method, &sim->settings->stepper, system);
        if (!sim->steppers[i])
            end_with(sim, OUT_OF_MEMORY, "no memory for a stepper");
    }
}

/* Scene -> model -> parts, each with its stepper; and the clock that will stop them. */
static void open_simulation(struct simulation *sim) {
    const struct problem *problem = sim->scene->problem;
    sim->model =
        problem->create(sim->scene, sim->settings->treatment, settings_lanes(sim->settings));
    if (!sim->model) {
        end_with(sim, OUT_OF_MEMORY, "no memory for the model");
        return;
    }
    start_clock(sim);
    const size_t parts = (size_t)sim->model->part_count + (size_t)sim->model->parts_to_come;
    const size_t rows = (size_t)sim->model->row_count + (size_t)sim->model->rows_to_come;
    sim->steppers = calloc(parts, sizeof(struct stepper *));
    sim->rows = calloc(rows, (size_t)sim->model->column_count * sizeof(double));
    sim->changed = calloc(parts, sizeof(int));
    sim->progress = calloc(parts, sizeof *sim->progress);
    sim->workers = workers_create(sim->settings->threads);
    sim->model->workers = sim->workers;
    if (!sim->steppers || !sim->rows || !sim->changed || !sim->progress || !sim->workers)
        end_with(sim, OUT_OF_MEMORY, "no memory for the steppers");
    create_steppers(sim);
    if (going(sim) && sim->settings->perturbation > 0)
        perturb_start(sim);
}

static void add_counters(struct counters *sum, const struct counters *part) {
#define X(field, definition) sum->field += part->field;
    COUNTERS(X)
#undef X
}

static void add_steps(struct step_range *all, const struct step_range *part) {
    if (part->largest == 0)
        return;
    all->least = all->largest > 0 ? fmin(all->least, part->least) : part->least;
    all->largest = fmax(all->largest, part->largest);
}

static void add_profile(struct profile *sum, const struct profile *part) {
#define X(call) sum->call += part->call;
    SYSTEM_CALLS(X)
#undef X
}

static void close_simulation(struct simulation *sim) {
    if (sim->model) {
        for (int i = 0; i < sim->model->part_count; i++) {
            sim->result->wisps += sim->model->parts[i].system.wisps;
            add_counters(&sim->result->counters, &sim->model->parts[i].system.counters);
            if (sim->progress) {
                add_steps(&sim->result->steps, &sim->progress[i].steps);
                add_profile(&sim->result->profile, &sim->progress[i].profile);
                sim->result->largest_strain =
                    fmax(sim->result->largest_strain, sim->progress[i].strain);
            }
            if (sim->steppers && sim->steppers[i])
                sim->settings->method->free(sim->steppers[i]);
        }
        sim->scene->problem->free(sim->model);
    }
    free(sim->steppers);
    free(sim->rows);
    free(sim->changed);
    free(sim->progress);
    workers_free(sim->workers);
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
static void count_evaluations(struct simulation *sim) {
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
static int parts_tick_alone(const struct simulation *sim, unsigned events) {
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
        end_with(sim, OUT_OF_TIME, "its limit of force evaluations was reached");
    else if (stop)
        end_with(sim, (enum outcome)stop,
                 stop == OUT_OF_TIME ? "its limit of CPU time was reached"
                                     : "stopped from outside");
}

/* The smooth advance of every part to the stop at `to`, or by one step of the only part where
 * every accepted step is a frame. Parts do not see each other: threads share them out. */
static void advance_parts(struct simulation *sim, double to, int alone) {
    struct interval interval = {sim, to, sim->settings->every_step, alone};
    double reached = to;

    workers_run(sim->workers, advance_part, &interval, sim->model->part_count);
    for (int i = 0; i < sim->model->part_count; i++) {
        const struct progress_of_part *part = &sim->progress[i];
        if (part->code && going(sim))
            end_with(sim, (enum outcome)abs(part->code), sim->model->parts[i].system.reason);
        reached = fmin(reached, part->reached);
    }
    sim->t = sim->model->t = reached;
    sim->result->time = reached;
    count_evaluations(sim);
    if (going(sim))
        check_limits(sim);
}

static void check_finite(struct simulation *sim) {
    for (int i = 0; i < sim->model->part_count && going(sim); i++)
        if (!sim->progress[i].finite)
            end_with(sim, NOT_FINITE, "the state overflowed or became NaN");
}

/* What an event of a tick changes where no part has an account of it. */
static double unbooked_energy(const struct simulation *sim) {
    return model_energy(sim->model) - model_jumps(sim->model);
}

/* What happens at a stop; steppers with a history begin anew where it changed their part, all of
 * them where the forces have a kink, and new parts get theirs. */
static void tick(struct simulation *sim, unsigned events) {
    const struct problem *problem = sim->scene->problem;
    if (!problem->tick)
        return;
    memset(sim->changed, 0, (size_t)sim->model->part_count * sizeof(int));
    const double booked = sim->settings->diagnostics ? unbooked_energy(sim) : 0;
    const enum outcome outcome = problem->tick(sim->model, sim->workers, events, sim->changed);
    if (sim->settings->diagnostics)
        sim->other_jumps += unbooked_energy(sim) - booked;
    if (outcome != FINISHED)
        end_with(sim, outcome,
                 outcome == OUT_OF_MEMORY ? "no memory for what happens at a tick"
                                          : sim->model->trouble);
    for (int i = 0; i < sim->stepper_count; i++)
        if ((sim->changed[i] || events & STOP_KINK) && sim->settings->method->reset)
            sim->settings->method->reset(sim->steppers[i],
                                         events & STOP_KINK ? ~0u : (unsigned)sim->changed[i]);
    create_steppers(sim);
}

/* The frame's diagnosis: the model's, with what only the run knows: its start, the frame before,
 * the ticks. */
static void make_diagnosis(struct simulation *sim) {
    struct diagnosis *d = &sim->diagnosis;
    const double body_contacts = sim->body_contacts, wisp_contacts = sim->wisp_contacts;
    if (diagnose(sim->model, sim->rows, d)) {
        end_with(sim, OUT_OF_MEMORY, "no memory for a diagnosis");
        return;
    }
    if (sim->result->frames == 1)
        sim->first_energy = d->residual;
    d->other = sim->other_jumps;
    d->residual -= sim->first_energy + d->other;
    sim->body_contacts = d->body_contacts;
    sim->wisp_contacts = d->wisp_contacts;
    d->body_contacts -= body_contacts;
    d->wisp_contacts -= wisp_contacts;
    sim->model->diagnosis = d;
}

/* What all hair has at a speed at which it is at rest, J: less is rounding. */
static double energy_at_rest(const struct scene *scene) {
    const double at_rest = 1e-9; /* m/s, as in contacts */
    double mass = 0;
    for (int w = 0; w < scene->wisp_count; w++)
        for (int i = 2; i < scene->wisps[w].nodes; i++)
            mass += wisp_node_mass(&scene->wisps[w], i);
    return mass * at_rest * at_rest / 2;
}

/* No step's error is worth ten times what the scene ever held: such a run is wrong whatever its
 * lengths. The energies are taken absolutely, since gravity's has its zero somewhere. */
static void check_energy(struct simulation *sim) {
    const struct diagnosis *d = &sim->diagnosis;
    double stored = energy_at_rest(sim->scene);
#define X(name, meaning) stored += fabs(d->energy.name);
    ENERGIES(X)
#undef X
    sim->most_energy = fmax(sim->most_energy, stored);
    if (sim->settings->method->checked_by || !(fabs(d->residual) > 10 * sim->most_energy))
        return;
    char reason[REASON_SIZE];
    snprintf(reason, sizeof reason,
             "%.3g J of energy are accounted for by no work, and it never held more than %.3g J",
             d->residual, sim->most_energy);
    end_with(sim, DIVERGED, reason);
}

static void show_frame(struct simulation *sim) {
    sim->result->frames++;
    if (!sim->observer)
        return;
    sim->scene->problem->sample(sim->model, sim->rows);
    if (sim->settings->diagnostics)
        make_diagnosis(sim);
    if (!going(sim))
        return;
    const int code = sim->observer->frame(sim->observer->ctx, sim->model, sim->t, sim->rows);
    if (code)
        end_with(sim, (enum outcome)code, "a frame could not be kept");
    else if (sim->settings->diagnostics)
        check_energy(sim);
}

void simulate(const struct scene *scene, const struct settings *settings,
              const struct observer *observer, const struct watch *watch,
              struct run_result *result) {
    struct simulation sim = {.scene = scene,
                             .settings = settings,
                             .observer = observer,
                             .watch = watch,
                             .result = result,
                             .t = scene->begin};
    const int every_step = scene->frame_rate == 0; /* every step is a frame, stops being steps */
    struct stop stop = {.t = scene->begin};

    *result = (struct run_result){.outcome = FINISHED, .time = scene->begin};
    open_simulation(&sim);
    if (going(&sim))
        count_evaluations(&sim);
    if (going(&sim))
        show_frame(&sim);
    const double start = cpu_seconds();
    double begin = monotonic_seconds();
    while (going(&sim) && (sim.t < stop.t || clock_next(&sim.clock, &stop))) {
        const int frame = every_step || stop.events & STOP_FRAME;
        const int alone = parts_tick_alone(&sim, stop.events);
        advance_parts(&sim, stop.t, alone);
        if (going(&sim))
            check_finite(&sim);
        if (alone && !frame)
            continue; /* reading the clock would take as long as such a stop */
        const double advanced = monotonic_seconds();
        if (going(&sim) && sim.t == stop.t && !alone)
            tick(&sim, stop.events);
        const double ticked = monotonic_seconds();
        if (going(&sim) && frame)
            show_frame(&sim);
        const double shown = monotonic_seconds();
        result->advance_seconds += advanced - begin;
        result->tick_seconds += ticked - advanced;
        result->frame_seconds += shown - ticked;
        begin = shown;
    }
    result->advance_seconds += monotonic_seconds() - begin;
    result->cpu_seconds = cpu_seconds() - start;
    if (going(&sim) && watch && watch->cpu_seconds > 0 && cpu_seconds() > watch->cpu_seconds)
        end_with(&sim, OUT_OF_TIME, "its limit of CPU time was reached");
    add_caution(&sim);
    close_simulation(&sim);
}
