#include "measure.h"

#include "base/files.h"
#include "curve.h"

#include <complex.h>
#include <gsl/gsl_fit.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- configurations --- */

int configuration_is_adaptive(const struct configuration *configuration) {
    return (configuration->method->capabilities & STEPPER_ADAPTIVE) != 0;
}

struct run_request configuration_request(const struct configuration *configuration, double setting,
                                         double atol_ratio) {
    const int adaptive = configuration_is_adaptive(configuration);
    int options = 0;
    while (configuration->options && configuration->options[options])
        options++;
    return (struct run_request){.stepper = configuration->stepper,
                                .linear = configuration->linear,
                                .options = configuration->options,
                                .option_count = options,
                                .step = adaptive ? 0 : setting,
                                .rtol = adaptive ? setting : 0,
                                .atol = adaptive ? setting * atol_ratio : 0};
}

/* The cost of a step, per unknown, s: with tensions an evaluation takes 1.2 to 1.9 times as long as
 * with springs, and the projection after each step of a one-step method as three explicit Euler
 * steps. A body that pushes by penalty takes a tenth of an evaluation (`wind`, whose ten have hair
 * all over them: 2.05 of one without). */
static double step_cost(const struct scene *scene, const struct configuration *configuration) {
    const int projects = !(configuration->method->capabilities & STEPPER_MULTISTEP);
    const double cost = configuration->cost * (1 + 0.1 * scene->around.pushing_count);
    if (scene->wisp_count == 0 || scene->wisps[0].stretch != STRETCH_RIGID)
        return cost;
    return 1.6 * cost + (projects ? 15e-9 : 0);
}

/* The cost of all wisps at ticks, s. */
static double tick_cost(const struct scene *scene) {
    const double point = 100e-9; /* s, in the experiments' usual scenes */
    const int touch = scene->interaction.interpenetration || scene->interaction.collision;
    const double rate = (scene_tick_bodies(scene) > 0 ? scene->collision_rate : 0) +
                        (touch ? scene->interaction.rate : 0);
    double points = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        points += (scene->wisps[i].nodes - 2) * (1 + scene->wisps[i].samples);
    return point * points * rate * scene->duration;
}

double scene_unknowns(const struct scene *scene, enum wisp_treatment treatment) {
    double unknowns = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        unknowns += (scene->wisps[i].nodes - 2) * wisp_node_unknowns(&scene->wisps[i], treatment);
    return unknowns;
}

double estimated_cost(const struct scene *scene, enum wisp_treatment treatment,
                      const struct configuration *configuration, double step) {
    const struct linear_method *linear =
        configuration->linear ? linear_find(configuration->linear) : NULL;
    const struct run_request request = configuration_request(configuration, 1, 1);
    const struct options options = {request.options, request.option_count};
    const int most = stepper_lanes(configuration->method, linear, &options);
    const int lanes = most < 4 ? most : 4; /* as on any machine */
    const double parts = ceil((double)scene->wisp_count / lanes);
    const double unknowns = scene_unknowns(scene, treatment) / scene->wisp_count;
    return tick_cost(scene) +
           step_cost(scene, configuration) * unknowns * parts * scene->duration / step;
}

void cost_count(struct cost *cost, const struct scene *scene, enum wisp_treatment treatment,
                const struct configuration *configuration) {
    cost->counted = estimated_cost(scene, treatment, configuration,
                                   scene->duration * scene->wisp_count / cost->steps);
}

int cost_is_less(const struct cost *one, const struct cost *other) {
    const double clearly = 1.4;
    return clearly * one->counted < other->counted && one->cpu.greatest < other->cpu.least;
}

const struct cost no_cost = {REFUSED, NAN, NAN, NAN, {NAN, NAN, NAN}, NAN};

struct cost run_cost(const struct run_files *run) {
    struct cost cost = {.outcome = run->outcome,
                        .evaluations = run_number(run, "counters.force_evaluations"),
                        .steps = run_number(run, "counters.steps"),
                        .failure_time = run_number(run, "failure_time"),
                        .cpu = run_cpu_time(run),
                        .counted = NAN};
    if (run->outcome != FINISHED || isnan(cost.cpu.median)) /* is not repeated */
        cost.cpu.median = cost.cpu.least = cost.cpu.greatest = run_number(run, "cpu_seconds");
    return cost;
}

/* --- distance of a run from another --- */

double mixed_error(const double *a, const double *b, int n, double floor) {
    double worst = 0;
    for (int i = 0; i < n; i++) {
        const double error = fabs(a[i] - b[i]) / (floor + fabs(b[i]));
        worst = error <= worst ? worst : error;
    }
    return worst;
}

static double distance(const double *a, const double *b) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Whether samples are distances from their node, and no particles. */
static int has_distances(const struct trajectory *run) {
    return strcmp(run->table.name[STATE_SAMPLES], "r0") == 0;
}

/* Distance of sample j from its node: r itself, or in `penalty` that of the particle, which is r
 * but for the square of how far the particle is off its line. */
static double sample_radius(const struct trajectory *run, const double *row, int j) {
    if (has_distances(run))
        return row[STATE_SAMPLES + 2 * j];
    return distance(row + STATE_SAMPLES + 6 * j, row + STATE_X);
}

static int sample_count(const struct trajectory *run) {
    const int columns = run->table.column_count - STATE_SAMPLES;
    return columns > 0 ? columns / (has_distances(run) ? 2 : 6) : 0;
}

static int same_samples(const struct trajectory *a, const struct trajectory *b) {
    const int columns = a->table.column_count;
    return columns == b->table.column_count && columns > STATE_SAMPLES &&
           has_distances(a) == has_distances(b);
}

/* Whether two frames are at the same time. */
static int same_time(const struct trajectory *run, const struct trajectory *reference, int frame) {
    const double t = reference->frames[frame].t;
    return fabs(run->frames[frame].t - t) <= 1e-12 * fmax(1, t);
}

/* Whether a frame has the same nodes in two runs. That the numbers of wisps agree does not say so:
 * they come in the order of their subdivisions. But roots tell them apart, and the nodes of the
 * head are the same in all runs, to rounding. */
static int same_wisps(const struct trajectory *run, const struct trajectory *reference, int frame) {
    const int a = run->frames[frame].row, b = reference->frames[frame].row;
    const int count = trajectory_end(reference, frame) - b;
    if (trajectory_end(run, frame) - a != count)
        return 0;
    for (int i = 0; i < count; i++) {
        const double *x = trajectory_row(run, a + i), *y = trajectory_row(reference, b + i);
        if (x[STATE_WISP] != y[STATE_WISP] || x[STATE_NODE] != y[STATE_NODE] ||
            (x[STATE_NODE] < 2 && distance(x + STATE_X, y + STATE_X) > 1e-9))
            return 0;
    }
    return 1;
}

/* Sums of squares, to become means. */
struct sums {
    double free, relative, end_all, end, velocity, radius, worst_component;
    double free_rows, end_rows, free_end_rows, samples;
};

static void add_row(struct sums *sums, struct deviation *d, const double *a, const double *b,
                    double length, int at_end) {
    const int is_free = b[STATE_NODE] >= 2;
    const double error = distance(a + STATE_X, b + STATE_X), square = error * error;
    sums->end_all += at_end * square;
    sums->end_rows += at_end;
    if (!is_free)
        return;
    const double slip = distance(a + STATE_VX, b + STATE_VX);
    sums->free += square;
    sums->relative += square / (length * length);
    sums->velocity += slip * slip;
    sums->free_rows++;
    sums->end += at_end * square;
    sums->free_end_rows += at_end;
    d->largest = fmax(d->largest, error);
    d->end_largest = fmax(d->end_largest, at_end * error);
}

static void add_samples(struct sums *sums, const struct trajectory *run, const double *a,
                        const struct trajectory *reference, const double *b) {
    for (int j = 0; j < sample_count(run) && b[STATE_NODE] >= 2; j++) {
        const double error = sample_radius(run, a, j) - sample_radius(reference, b, j);
        sums->radius += error * error;
        sums->samples++;
    }
}

static void finish(const struct sums *sums, struct deviation *d) {
    d->rms = sqrt(sums->free / sums->free_rows);
    d->relative = sqrt(sums->relative / sums->free_rows);
    d->end = sqrt(sums->end / sums->free_end_rows);
    d->end_all = sqrt(sums->end_all / sums->end_rows);
    d->velocity = sqrt(sums->velocity / sums->free_rows);
    d->radius = sums->samples > 0 ? sqrt(sums->radius / sums->samples) : 0;
    d->mescd = -log10(sums->worst_component);
    if (!isnan(d->history_diverged))
        d->end = d->end_all = d->end_largest = d->mescd = NAN;
}

/* One node; `samples`: both have the same ones. */
static void add_node(struct sums *sums, struct deviation *d, const struct trajectory *run,
                     const double *a, const struct trajectory *reference, const double *b,
                     double length, int samples, int at_end, double floor) {
    add_row(sums, d, a, b, length, at_end);
    if (samples)
        add_samples(sums, run, a, reference, b);
    if (at_end && b[STATE_NODE] >= 2) {
        const int columns = samples ? run->table.column_count : STATE_SAMPLES;
        sums->worst_component = fmax(
            sums->worst_component, mixed_error(a + STATE_X, b + STATE_X, columns - STATE_X, floor));
    }
}

/* A frame that has the same wisps in both; a wisp's first two nodes tell its length. */
static void add_frame(struct sums *sums, struct deviation *d, const struct trajectory *run,
                      const struct trajectory *reference, int frame, double floor) {
    const int samples = same_samples(run, reference), at_end = frame + 1 == run->frame_count;
    for (int wisp = 0; wisp < reference->frames[frame].wisps; wisp++) {
        const int nodes = trajectory_nodes(reference, frame, wisp);
        const int a = trajectory_wisp(run, frame, wisp);
        const int b = trajectory_wisp(reference, frame, wisp);
        const double length = distance(trajectory_row(reference, b) + STATE_X,
                                       trajectory_row(reference, b + 1) + STATE_X) *
                              (nodes - 1);
        for (int i = 0; i < nodes; i++)
            add_node(sums, d, run, trajectory_row(run, a + i), reference,
                     trajectory_row(reference, b + i), length, samples, at_end, floor);
    }
}

int measure_deviation(const struct scene *scene, const struct trajectory *run,
                      const struct trajectory *reference, double floor, struct deviation *deviation,
                      char *reason) {
    struct sums sums = {0};
    int frame = 0;
    *deviation = (struct deviation){.history_diverged = NAN};
    for (; frame < run->frame_count && frame < reference->frame_count; frame++) {
        if (!same_time(run, reference, frame))
            break;
        if (!same_wisps(run, reference, frame)) {
            deviation->history_diverged = reference->frames[frame].t;
            break;
        }
        add_frame(&sums, deviation, run, reference, frame, floor);
    }
    if (isnan(deviation->history_diverged) && frame < run->frame_count)
        return fail_with(reason, "scene %s: two runs have not the same frames", scene->name);
    finish(&sums, deviation);
    return 0;
}

double measure_largest(const struct table *table, const char *name) {
    const int column = table_column(table, name);
    double largest = NAN;
    for (int i = 0; i < table->row_count && column >= 0; i++)
        largest = fmax(largest, fabs(table_value(table, i, column)));
    return largest;
}

/* --- distance of curves --- */

enum { CURVE_POINTS = 32 };

static void points_of(const struct trajectory *run, int frame, int wisp,
                      double points[CURVE_POINTS][3]) {
    const int first = trajectory_wisp(run, frame, wisp);
    curve_points(trajectory_row(run, first + 1) + STATE_X, run->table.column_count,
                 trajectory_nodes(run, frame, wisp) - 1, CURVE_POINTS, points);
}

/* One wisp of one frame: the mean square of the distances. */
static double compare_curves(const struct trajectory *run, const struct trajectory *reference,
                             int frame, int wisp, double *largest) {
    double x[CURVE_POINTS][3], y[CURVE_POINTS][3], square = 0;
    points_of(run, frame, wisp, x);
    points_of(reference, frame, wisp, y);
    for (int i = 0; i < CURVE_POINTS; i++) {
        const double apart = distance(x[i], y[i]);
        square += apart * apart / CURVE_POINTS;
        *largest = fmax(*largest, apart);
    }
    return square;
}

int measure_curves(const struct scene *scene, const struct trajectory *run,
                   const struct trajectory *reference, struct curve_deviation *deviation,
                   char *reason) {
    double sum = 0, last_frame = 0;
    const int frames = run->frame_count;
    int frame = 0;
    *deviation = (struct curve_deviation){.largest = 0};
    for (; frame < frames && frame < reference->frame_count; frame++) {
        if (!same_time(run, reference, frame))
            break;
        last_frame = 0;
        for (int w = 0; w < scene->wisp_count && w < run->frames[frame].wisps &&
                        w < reference->frames[frame].wisps;
             w++)
            last_frame += compare_curves(run, reference, frame, w, &deviation->largest);
        sum += last_frame;
    }
    if (frame == 0 || frame < frames || frame < reference->frame_count)
        return fail_with(reason, "scene %s: two runs have not the same frames", scene->name);
    deviation->rms = sqrt(sum / frames / scene->wisp_count);
    deviation->end = sqrt(last_frame / scene->wisp_count);
    return 0;
}

/* --- the horizon --- */

int scene_has_contacts(const struct scene *scene) {
    return scene_tick_bodies(scene) > 0 || scene->interaction.interpenetration ||
           scene->interaction.collision;
}

double reference_cost(const struct scene *scene) {
    const double node_seconds =
        0.04; /* measured on `interactions`; the tightest third is CVODE's */
    return node_seconds * free_nodes(scene);
}

/* How far two runs are from each other at a frame that both have. */
struct separation {
    double t, apart; /* s; the largest distance of a node, m */
};

/* The frames of both, for free; and whether both runs finished. Returns 0, or -1 with a reason. */
static int read_separations(struct trajectories *owner, const char *folder,
                            const char *other_folder, struct separation **frames, int *count,
                            int *both_finished, char *reason) {
    struct run_files one, other;
    if (run_read_states(&one, folder, owner, reason))
        return -1;
    if (run_read_states(&other, other_folder, owner, reason)) {
        run_free(&one);
        return -1;
    }
    const struct trajectory *a = one.states, *b = other.states;
    *count = 0;
    *frames = calloc((size_t)a->frame_count + 1, sizeof **frames);
    for (int i = 0; *frames && i < a->table.row_count && i < b->table.row_count; i++) {
        const double *x = trajectory_row(a, i), *y = trajectory_row(b, i);
        struct separation *frame = &(*frames)[*count];
        frame->t = x[STATE_T];
        frame->apart = fmax(frame->apart, distance(x + STATE_X, y + STATE_X));
        *count += i + 1 == a->table.row_count || trajectory_row(a, i + 1)[STATE_T] != frame->t;
    }
    *both_finished = one.outcome == FINISHED && other.outcome == FINISHED;
    run_free(&one);
    run_free(&other);
    return *frames ? 0 : fail_with(reason, "out of memory");
}

/* A frame that is too far apart ends it; the second one never does, for it would leave nothing to
 * compare. */
int measure_horizon(struct trajectories *owner, const char *folder, const char *other_folder,
                    double *horizon, char *reason) {
    struct separation *frames;
    int count, finished, last = 0;
    if (read_separations(owner, folder, other_folder, &frames, &count, &finished, reason))
        return -1;
    while (last + 1 < count && (last == 0 || frames[last + 1].apart <= HORIZON_DISTANCE))
        last++;
    *horizon = finished ? frames[last].t - frames[0].t : NAN;
    free(frames);
    return 0;
}

int measure_separation(struct trajectories *owner, const char *folder, const char *other_folder,
                       const char *name, FILE *stream, char *reason) {
    struct separation *frames;
    int count, finished;
    if (read_separations(owner, folder, other_folder, &frames, &count, &finished, reason))
        return -1;
    for (int i = 0; i < count; i++)
        WRITE_ROW(stream, SEPARATION_COLUMNS);
    free(frames);
    return 0;
}

/* --- slopes --- */

void slope_add(struct slope *slope, double cost, double error) {
    if (slope->count == SLOPE_POINTS)
        return;
    slope->x[slope->count] = log10(cost);
    slope->y[slope->count] = log10(error);
    slope->count++;
}

struct fit slope_fit(const struct slope *slope, const struct configuration *configuration) {
    const int count = slope->count;
    const int used =
        configuration_is_adaptive(configuration) || count < SLOPE_FINEST ? count : SLOPE_FINEST;
    const double *x = slope->x + count - used, *y = slope->y + count - used;
    double least = INFINITY, most = -INFINITY, c0, c1, cov00, cov01, cov11, sum;
    if (count < SLOPE_FINEST)
        return (struct fit){NAN, NAN, 0};
    for (int i = 1; i < used; i++) {
        if (x[i] == x[i - 1])
            continue;
        const double local = (y[i] - y[i - 1]) / (x[i] - x[i - 1]);
        least = fmin(least, local);
        most = fmax(most, local);
    }
    gsl_fit_linear(x, 1, y, 1, (size_t)used, &c0, &c1, &cov00, &cov01, &cov11, &sum);
    return (struct fit){c1, most - least, used};
}

/* --- what linear theory says of a scene --- */

struct mode stiffest_mode(const struct scene *scene) {
    struct mode mode = {0, 0};
    for (int i = 0; i < scene->wisp_count; i++) {
        const struct wisp *wisp = &scene->wisps[i];
        const double mass = wisp_node_mass(wisp, 2);
        const double frequency = 2 * sqrt(wisp_stretch_constant(wisp) / mass);
        if (frequency > mode.frequency)
            mode = (struct mode){frequency, wisp->stretch_time};
    }
    return mode;
}

int is_stable(const struct stepper_method *method, const struct mode *mode, double h) {
    const double w = mode->frequency, half_rate = mode->damping_time * w * w / 2;
    const double complex root = csqrt(half_rate * half_rate - w * w);
    return cabs(stepper_amplification(method, h * (-half_rate + root), h * (-half_rate - root))) <=
           1;
}

int seems_stable(const struct stepper_method *method, const struct scene *scene, double h) {
    const struct mode mode = stiffest_mode(scene);
    return stepper_is_predictable(method) ? is_stable(method, &mode, h)
                                          : h <= usual_step(scene, method);
}

double usual_step(const struct scene *scene, const struct stepper_method *method) {
    const double rate_of_rk4 = 4000; /* Hz */
    return method->capabilities & STEPPER_ADAPTIVE
               ? 0
               : scene->run.step * (rate_of_rk4 / stepper_usual_rate(method));
}

double longest_wisp(const struct scene *scene) {
    double length = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        length = fmax(length, scene->wisps[i].length);
    return length;
}

double stop_rate(const struct scene *scene) {
    return scene->wisps[0].samples > 0 ? fmax(scene->collision_rate, scene->frame_rate)
                                       : scene->frame_rate;
}

double sequence_step(const struct scene *scene, int per_octave, int k) {
    const double rate = stop_rate(scene);
    const double coarsest = 1 / rate / ceil(60 / rate - 1e-9);
    const int p = per_octave, q = k - (p - 1);
    return coarsest / (q < 0 ? k + 1 : ldexp(p + q % p, q / p));
}
