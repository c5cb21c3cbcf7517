#include "base/files.h"
#include "base/progress.h"
#include "base/workers.h"
#include "simulation_parts.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void end_run(struct simulation *sim, enum outcome outcome, const char *reason) {
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

static void start_clock(struct simulation *sim, double to) {
    const double rate = sim->scene->frame_rate;
    sim->clock = clock_until(sim->t, to);
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
        end_run(sim, OUT_OF_MEMORY, "no memory for random numbers");
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
    for (; sim->stepper_count < sim->model->part_count && is_running(sim); sim->stepper_count++) {
        const int i = sim->stepper_count;
        struct system *system = &sim->model->parts[i].system;
        system->unprojected = sim->settings->unprojected;
        if (sim->settings->profile)
            system->profile = &sim->progress[i].profile;
        if (sim->settings->diagnostics)
            sim->model->parts[i].account = &sim->progress[i].account;
        sim->steppers[i] = stepper_create(sim->settings->method, &sim->settings->stepper, system);
        if (!sim->steppers[i])
            end_run(sim, OUT_OF_MEMORY, "no memory for a stepper");
    }
}

/* A stepper for each of the model's parts, and the clock that will stop them. */
static void open_simulation(struct simulation *sim, double to) {
    start_clock(sim, to);
    const size_t parts = (size_t)sim->model->part_count + (size_t)sim->model->parts_to_come;
    const size_t rows = (size_t)sim->model->row_count + (size_t)sim->model->rows_to_come;
    sim->steppers = calloc(parts, sizeof(struct stepper *));
    sim->rows = calloc(rows, (size_t)sim->model->column_count * sizeof(double));
    sim->changed = calloc(parts, sizeof(int));
    sim->progress = calloc(parts, sizeof *sim->progress);
    sim->workers = workers_create(sim->settings->threads);
    sim->model->workers = sim->workers;
    if (!sim->steppers || !sim->rows || !sim->changed || !sim->progress || !sim->workers)
        end_run(sim, OUT_OF_MEMORY, "no memory for the steppers");
    create_steppers(sim);
    if (is_running(sim) && sim->settings->perturbation > 0)
        perturb_start(sim);
}

static void add_counters(struct counters *sum, const struct counters *part) {
#define X(field, definition) sum->field += part->field;
    COUNTERS(X)
#undef X
}

static void add_profile(struct profile *sum, const struct profile *part) {
#define X(call) sum->call += part->call;
    SYSTEM_CALLS(X)
#undef X
}

/* What a part was lent goes with the run. */
static void take_back(struct part *part) {
    part->account = NULL;
    part->system.profile = NULL;
    part->system.from = part->system.until = 0;
}

static void close_simulation(struct simulation *sim) {
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
        take_back(&sim->model->parts[i]);
    }
    sim->model->diagnosis = NULL;
    sim->model->workers = NULL;
    free(sim->steppers);
    free(sim->rows);
    free(sim->changed);
    free(sim->progress);
    workers_free(sim->workers);
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
        end_run(sim, outcome,
                outcome == OUT_OF_MEMORY ? "no memory for what happens at a tick"
                                         : sim->model->trouble);
    for (int i = 0; i < sim->stepper_count; i++)
        if ((sim->changed[i] || events & STOP_KINK) && sim->settings->method->reset)
            sim->settings->method->reset(sim->steppers[i],
                                         events & STOP_KINK ? ~0u : (unsigned)sim->changed[i]);
    create_steppers(sim);
}

static void show_frame(struct simulation *sim) {
    sim->result->frames++;
    if (!sim->observer)
        return;
    sim->scene->problem->sample(sim->model, sim->rows);
    if (sim->settings->diagnostics)
        make_diagnosis(sim);
    if (!is_running(sim))
        return;
    const int code = sim->observer->frame(sim->observer->ctx, sim->model, sim->t, sim->rows);
    if (code)
        end_run(sim, (enum outcome)code, "a frame could not be kept");
    else if (sim->settings->diagnostics)
        check_energy(sim);
}

/* A frame after the first, whose CPU time is part of the run's. */
static void show_later_frame(struct simulation *sim) {
    const double begin = sim->observer ? cpu_seconds() : 0;
    show_frame(sim);
    if (sim->observer)
        sim->result->frame_cpu_seconds += cpu_seconds() - begin;
}

void simulate_model(struct model *model, const struct scene *scene, const struct settings *settings,
                    double to, const struct observer *observer, const struct watch *watch,
                    struct run_result *result) {
    struct simulation sim = {.scene = scene,
                             .settings = settings,
                             .observer = observer,
                             .watch = watch,
                             .result = result,
                             .model = model,
                             .t = model->t};
    const int every_step = scene->frame_rate == 0; /* every step is a frame, stops being steps */
    struct stop stop = {.t = model->t};

    *result = (struct run_result){.outcome = FINISHED, .time = model->t};
    open_simulation(&sim, to);
    if (is_running(&sim))
        count_evaluations(&sim);
    if (is_running(&sim))
        show_frame(&sim);
    const double start = cpu_seconds();
    double begin = monotonic_seconds();
    while (is_running(&sim) && (sim.t < stop.t || clock_next(&sim.clock, &stop))) {
        const int frame = every_step || stop.events & STOP_FRAME;
        const int alone = parts_tick_alone(&sim, stop.events);
        advance_parts(&sim, stop.t, alone);
        if (alone && !frame)
            continue; /* reading the clock would take as long as such a stop */
        const double advanced = monotonic_seconds();
        if (is_running(&sim) && sim.t == stop.t && !alone)
            tick(&sim, stop.events);
        const double ticked = monotonic_seconds();
        if (is_running(&sim) && frame)
            show_later_frame(&sim);
        const double shown = monotonic_seconds();
        result->advance_seconds += advanced - begin;
        result->tick_seconds += ticked - advanced;
        result->frame_seconds += shown - ticked;
        begin = shown;
    }
    result->advance_seconds += monotonic_seconds() - begin;
    result->cpu_seconds = cpu_seconds() - start;
    if (is_running(&sim) && watch && watch->cpu_seconds > 0 && cpu_seconds() > watch->cpu_seconds)
        end_run(&sim, OUT_OF_TIME, "its limit of CPU time was reached");
    add_caution(&sim);
    close_simulation(&sim);
}

void simulate(const struct scene *scene, const struct settings *settings,
              const struct observer *observer, const struct watch *watch,
              struct run_result *result) {
    struct model *model =
        scene->problem->create(scene, settings->treatment, settings_lanes(settings));
    if (model) {
        const double to = scene->begin + scene->duration;
        simulate_model(model, scene, settings, to, observer, watch, result);
        scene->problem->free(model);
        return;
    }
    *result = (struct run_result){.outcome = OUT_OF_MEMORY, .time = scene->begin};
    snprintf(result->reason, REASON_SIZE, "no memory for the model");
}
