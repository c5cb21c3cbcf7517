#include "wisp_support.h"

#include "base/vector.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp/strand.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const treatment_names[TREATMENTS] = {"projection", "penalty", "generalised"};
const char *const law_names[LAWS] = {"none", "skip", "hinge"};

/* --- random numbers --- */

double lab_between(unsigned *seed, double least, double most) {
    *seed = *seed * 1664525u + 1013904223u; /* Numerical Recipes' quick one */
    return least + (most - least) * (*seed >> 8) / 16777216.;
}

static void normalise(double d[3]) {
    const double length = vector_length(d);
    for (int k = 0; k < 3; k++)
        d[k] /= length;
}

/* A random direction: not evenly spread, but never short. */
static void direction(unsigned *seed, double d[3]) {
    do
        for (int k = 0; k < 3; k++)
            d[k] = lab_between(seed, -1, 1);
    while (vector_dot(d, d) < 0.1);
    normalise(d);
}

void lab_turn(double along[3], double turn, unsigned *seed) {
    for (int k = 0; k < 3; k++)
        along[k] += turn * lab_between(seed, -1, 1);
    normalise(along);
}

struct wisp lab_wisp(int nodes, int samples, enum bending law, unsigned *seed) {
    struct wisp wisp = {
        .nodes = nodes,
        .samples = samples,
        .length = lab_between(seed, 0.1, 0.5),
        .hair_count = lab_between(seed, 500, 2000),
        .hair_density = 5.7e-6,
        .stretch_stiffness = lab_between(seed, 40, 200),
        .stretch_time = lab_between(seed, 1e-4, 1e-3),
        .bending = law,
        .bending_stiffness = lab_between(seed, 5e-6, 2e-5),
        .bending_angle = lab_between(seed, 0.2, 0.5),
        .bending_time = lab_between(seed, 5e-4, 2e-3),
        .drag_rate = lab_between(seed, 2, 8),
        .radius = lab_between(seed, 0.01, 0.03),
        .mass_fraction = lab_between(seed, 0.1, 0.4),
        .frequency = lab_between(seed, 5, 20),
        .damping_ratio = lab_between(seed, 0.5, 1.5),
        .penalty_ratio = lab_between(seed, 50, 200),
    };
    for (int k = 0; k < 3; k++)
        wisp.root[k] = lab_between(seed, -0.3, 0.3);
    direction(seed, wisp.direction);
    return wisp;
}

struct surroundings lab_surroundings(enum wind_kind kind, unsigned *seed) {
    struct surroundings around = {.wind = {.kind = kind}};
    struct wind *wind = &around.wind;
    direction(seed, around.gravity);
    for (int k = 0; k < 3; k++) {
        around.gravity[k] *= 9.81;
        if (kind != WIND_NONE)
            wind->velocity[k] = lab_between(seed, -5, 5);
    }
    wind->hold = 0.5;
    wind->decay = lab_between(seed, 0.05, 0.1);
    wind->terms = 3;
    for (int k = 0; k < wind->terms; k++) {
        wind->amplitude[k] = lab_between(seed, 0.1, 0.5);
        wind->frequency[k] = lab_between(seed, 0.5, 5);
    }
    return around;
}

/* The node after `p` in a state, `along` being the last segment's direction. */
static void next_node(const struct wisp *wisp, enum lab_state kind, unsigned *seed, double along[3],
                      double p[3]) {
    const double l = wisp_spacing(wisp);
    const double turn = kind == STATE_REST ? 0 : kind == STATE_FOLDED ? 2.5 : 0.7;
    const double length = kind == STATE_REST         ? l
                          : kind == STATE_COMPRESSED ? l * lab_between(seed, 0.4, 0.9)
                                                     : l * lab_between(seed, 0.7, 1.4);
    double d[3];
    direction(seed, d);
    vector_add(along, turn, d);
    normalise(along);
    vector_add(p, length, along);
}

void lab_state(const struct wisp *wisp, enum wisp_treatment treatment, enum lab_state kind,
               int still, unsigned *seed, double *q, double *v) {
    const double l = wisp_spacing(wisp);
    const int unknowns = wisp_node_unknowns(wisp, treatment);
    double along[3], p[3];
    for (int k = 0; k < 3; k++) {
        along[k] = wisp->direction[k];
        p[k] = wisp->root[k] + l * along[k];
    }
    for (int i = 2; i < wisp->nodes; i++, q += unknowns, v += unknowns) {
        next_node(wisp, kind, seed, along, p);
        memcpy(q, p, sizeof p);
        for (int j = 0; j < wisp->samples; j++) {
            const double r = wisp->radius * lab_between(seed, 0.2, 2);
            double d[3];
            direction(seed, d);
            if (treatment != WISP_PENALTY)
                q[3 + j] = r;
            else
                for (int k = 0; k < 3; k++)
                    q[3 + 3 * j + k] = p[k] + r * d[k];
        }
        for (int u = 0; u < unknowns; u++)
            v[u] = still ? 0 : lab_between(seed, -1, 1);
    }
}

/* --- a part of the kernel --- */

int lab_wider(int lanes) {
    return lanes < 4 ? 4 : 2 * lanes;
}

void lab_take_lanes(int lanes) {
    const char *const text = lanes == 1 ? "1" : lanes == 4 ? "4" : "8";
    cr_assert_eq(setenv("WISPLAB_LANES", text, 1), 0);
}

static void give_part_back(void *given) {
    struct lab_part *part = given;
    kernel_of(part->lanes)->free(part->system.ctx);
    free(part->pattern);
    free(part);
}

void lab_part_make(struct lab_part *part, int lanes, const struct wisp *wisps, int count,
                   const struct surroundings *around, enum wisp_treatment treatment) {
    const struct wisp *lane[LAB_LANES];
    for (int k = 0; k < LAB_LANES; k++)
        lane[k] = &wisps[k < count ? k : 0];
    const int unknowns = wisp_node_unknowns(wisps, treatment), size = (wisps->nodes - 2) * unknowns;
    struct placement head;
    *part = (struct lab_part){.lanes = lanes,
                              .size = size,
                              .node_unknowns = unknowns,
                              .places = treatment == WISP_PENALTY ? unknowns : 3};
    head_placement(&around->head, 0, &head);
    for (int k = 0; k < LAB_LANES; k++)
        placed_point(&head, 0, lane[k]->root, part->origin[k]);
    const int rigid = wisps->stretch == STRETCH_RIGID;
    part->system =
        (struct system){.ops = rigid ? kernel_of(lanes)->rigid_ops : kernel_of(lanes)->ops,
                        .name = "the laboratory's wisps",
                        .size = size * lanes,
                        .lanes = lanes,
                        .wisps = count};
    part->system.ctx = kernel_of(lanes)->create(lane, around, treatment, &part->system);
    cr_assert(part->system.ctx, "no memory for a part");
    part->pattern = kernel_of(lanes)->pattern(part->system.ctx);
    cr_assert(part->pattern, "no memory for a pattern");
    part->system.pattern = lanes == 1 ? part->pattern : NULL;
    struct lab_part *own = malloc(sizeof *own);
    cr_assert(own, "no memory for a part");
    *own = *part;
    test_owns(own, give_part_back);
}

void lab_scatter(const struct lab_part *part, int lane, const double *x, double *to) {
    for (int i = 0; i < part->size; i++)
        to[i * part->lanes + lane] = x[i];
}

void lab_place(const struct lab_part *part, int lane, const double *q, double *to) {
    lab_scatter(part, lane, q, to);
    for (int i = 0; i < part->size; i++)
        if (i % part->node_unknowns < part->places)
            to[i * part->lanes + lane] -= part->origin[lane][i % part->node_unknowns % 3];
}

void lab_gather(const struct lab_part *part, int lane, const double *from, double *x) {
    for (int i = 0; i < part->size; i++)
        x[i] = from[i * part->lanes + lane];
}

/* Kernel and twin do the same sums in different orders: each differs from the exact value by some
 * roundings (1.1e-16) of the sum of absolute terms, at most about 10 for a spring, and two or three
 * more with each node that a frame has come along; at a sharp fold (here up to |t + t'| = 0.1) the
 * bisector divides them by that. 3e-13 is three times what the worst of these wisps needs, and a
 * wrong coefficient in the sixth digit is far above it.
 *
 * The tensions of a rigid chain wander through all of it: a rounding anywhere shows everywhere, and
 * more so the longer the chain is. So its errors are measured by the largest acceleration, with or
 * without tensions, of the wisp. */
void lab_check_with_twin(const struct wisp *wisp, const struct surroundings *around,
                         enum wisp_treatment treatment, double t, const double *q, const double *v,
                         const double *a, double *worst) {
    static struct wisp_twin twin;
    static double expected[LAB_SIZE], scale[LAB_SIZE];
    const int rigid = wisp->stretch == STRETCH_RIGID;
    double most = 0;
    cr_assert_eq(wisp_twin_init(&twin, wisp, around, treatment), 0, "no twin");
    cr_assert_eq(wisp_twin_acceleration(&twin, t, q, v, expected), 0, "the twin fails");
    wisp_twin_scale(&twin, t, q, v, scale);
    for (int i = 0; i < wisp_twin_size(&twin); i++)
        most = fmax(most, fmax(fabs(expected[i]), scale[i]));
    for (int i = 0; i < wisp_twin_size(&twin); i++) {
        const double limit = rigid ? 3e-14 * wisp->nodes * most : 3e-13 * scale[i];
        cr_assert(lab_close(a[i], expected[i], limit, worst),
                  "%s, bending %s, %d nodes, %d samples: unknown %d: %.17g, twin %.17g, "
                  "difference %.1e of %.1e",
                  treatment_names[treatment], law_names[wisp->bending], wisp->nodes, wisp->samples,
                  i, a[i], expected[i], fabs(a[i] - expected[i]), rigid ? most : scale[i]);
    }
}

void lab_check_with_twins(int lanes, struct wisp *wisps, const struct surroundings *around,
                          enum wisp_treatment treatment, double t, unsigned *seed, double *worst) {
    static double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE], a[LAB_SIZE];
    static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], A[LAB_LANES * LAB_SIZE];
    const void *const mark = test_mark();
    struct lab_part part;
    lab_part_make(&part, lanes, wisps, lanes, around, treatment);
    for (int k = 0; k < lanes; k++) {
        lab_state(&wisps[k], treatment, (enum lab_state)((k + wisps[k].nodes) % STATES), 0, seed,
                  q[k], v[k]);
        lab_place(&part, k, q[k], Q);
        lab_gather(&part, k, Q, q[k]); /* from the root, and so is the twin's below */
        memset(wisps[k].root, 0, sizeof wisps[k].root);
        lab_scatter(&part, k, v[k], V);
    }
    cr_assert_eq(system_acceleration(&part.system, t, Q, V, A), 0, "%s", part.system.reason);
    for (int k = 0; k < lanes; k++) {
        lab_gather(&part, k, A, a);
        lab_check_with_twin(&wisps[k], around, treatment, t, q[k], v[k], a, worst);
    }
    test_gives_back(mark);
}

struct lab_company lab_company(int lanes, enum bending law, enum wisp_treatment treatment,
                               const struct surroundings *around, unsigned *seed,
                               void (*step)(struct lab_part *part, int place, double *q, double *v,
                                            void *ctx),
                               void *ctx) {
    static double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE], alone[2][LAB_SIZE];
    static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], got[2][LAB_SIZE];
    struct lab_part part, one;
    struct wisp wisps[LAB_LANES] = {0};
    struct lab_company company = {0};
    for (int k = 0; k < lanes; k++) {
        wisps[k] = lab_wisp(6, 4, law, seed);
        lab_state(&wisps[k], treatment, STATE_REST, 0, seed, q[k], v[k]);
    }
    lab_part_make(&part, lanes, wisps, lanes, around, treatment);
    for (int k = 0; k < lanes; k++) {
        lab_place(&part, k, q[k], Q);
        lab_scatter(&part, k, v[k], V);
    }
    step(&part, -1, Q, V, ctx);
    company.together = part.system.counters;
    for (int k = 0; k < lanes; k++) {
        lab_part_make(&one, 1, &wisps[k], 1, around, treatment);
        lab_place(&one, 0, q[k], alone[0]);
        lab_scatter(&one, 0, v[k], alone[1]);
        step(&one, k, alone[0], alone[1], ctx);
        lab_gather(&part, k, Q, got[0]);
        lab_gather(&part, k, V, got[1]);
        for (int i = 0; i < 2; i++)
            cr_assert_eq(memcmp(got[i], alone[i], (size_t)one.size * sizeof **got), 0,
                         "%s, bending %s: place %d has other bits in company",
                         treatment_names[treatment], law_names[law], k);
#define X(field, definition) company.alone.field += one.system.counters.field;
        COUNTERS(X)
#undef X
    }
    return company;
}

double lab_root_potential(const struct wisp *wisp, const struct surroundings *around) {
    double mass = 0;
    for (int i = 2; i < wisp->nodes; i++)
        mass += wisp_node_mass(wisp, i) + wisp->samples * wisp_sample_mass(wisp, i);
    return mass * vector_dot(around->gravity, wisp->root);
}

/* --- scenes --- */

struct scene *lab_scene(const struct wisp *wisps, int count, const struct surroundings *around) {
    struct scene *scene = calloc(1, sizeof *scene);
    cr_assert(scene, "no memory for a scene");
    scene->problem = &wisp_problem;
    scene->around = *around;
    scene->run = (struct run_defaults){1e-4, 1e-6, 1e-9, 0, -1};
    scene->wisp_count = count;
    scene->collision_rate = 300;
    scene->source = json_object();
    scene->wisps = malloc((size_t)count * sizeof *wisps);
    cr_assert(scene->wisps && scene->source, "no memory for wisps");
    memcpy(scene->wisps, wisps, (size_t)count * sizeof *wisps);
    snprintf(scene->name, sizeof scene->name, "lab");
    return test_owns_scene(scene);
}

static void give_model_back(void *what) {
    struct model *model = what;
    model->problem->free(model);
}

struct model *lab_model(const struct scene *scene, int treatment, int lanes) {
    struct model *model = scene->problem->create(scene, treatment, lanes);
    cr_assert(model, "no memory for a model");
    test_owns(model, give_model_back);
    return model;
}

static void give_strand_back(void *strand) {
    strand_free(strand);
}

struct strand *lab_strand(const struct wisp *wisp, enum wisp_treatment treatment) {
    struct strand *strand = strand_create(wisp, treatment);
    cr_assert(strand, "no memory for a strand");
    test_owns(strand, give_strand_back);
    return strand;
}

struct scene *lab_read(const char *text) {
    return lab_load(file_write(folder_make(), "scene.cfg", text), NULL, 0);
}

/* --- runs --- */

static int keep(void *ctx, const struct model *model, double t, const double *rows) {
    struct lab_run *run = ctx;
    const size_t size = (size_t)(model->row_count * model->column_count), n = (size_t)run->frames;
    cr_assert(n == 0 || run->rows == model->row_count, "wisps split: this run cannot be kept");
    run->rows = model->row_count;
    run->columns = model->column_count;
    run->t = realloc(run->t, (n + 1) * sizeof *run->t);
    run->row = realloc(run->row, (n + 1) * size * sizeof *run->row);
    cr_assert(run->t && run->row, "no memory for frames");
    run->t[n] = t;
    memcpy(run->row + n * size, rows, size * sizeof *rows);
    run->frames++;
    return 0;
}

struct run_request lab_request(const struct stepper_method *method, int treatment) {
    const int implicit = (method->capabilities & STEPPER_SOLVES) != 0;
    return (struct run_request){.stepper = method->name,
                                .treatment = treatment_names[treatment],
                                .linear = implicit ? "direct" : NULL};
}

void lab_run(const struct scene *scene, const struct run_request *request, struct lab_run *run) {
    const struct settings settings = settings_of(scene, request);
    *run = (struct lab_run){.frames = 0};
    simulate(scene, &settings, &(struct observer){keep, run}, NULL, &run->result);
    test_owns(run->t, free);
    test_owns(run->row, free);
}

void lab_finish(const struct scene *scene, const struct run_request *request, struct lab_run *run) {
    lab_run(scene, request, run);
    cr_assert_eq(run->result.outcome, FINISHED, "%s, %s, %s: %s", scene->name,
                 request->stepper ? request->stepper : "its own stepper",
                 request->treatment ? request->treatment : "its own treatment", run->result.reason);
}

static int add_bits(void *ctx, const struct model *model, double t, const double *rows) {
    struct lab_sum *sum = ctx;
    (void)t;
    for (int i = 0; i < model->row_count * model->column_count; i++) {
        unsigned long long bits;
        memcpy(&bits, &rows[i], sizeof bits);
        sum->bits = 1099511628211u * (sum->bits ^ bits);
    }
    return 0;
}

void lab_sum_run(const struct scene *scene, const struct run_request *request, int lanes,
                 struct lab_sum *sum) {
    const struct settings settings = settings_of(scene, request);
    *sum = (struct lab_sum){.bits = 1};
    cr_assert(lanes == 0 || settings_lanes(&settings) == lanes, "%d lanes",
              settings_lanes(&settings));
    simulate(scene, &settings, &(struct observer){add_bits, sum}, NULL, &sum->result);
    cr_assert_eq(sum->result.outcome, FINISHED, "%s: %s", scene->name, sum->result.reason);
}

void lab_same_sum(const struct lab_sum *a, const struct lab_sum *b, const char *what) {
    cr_assert_eq(a->bits, b->bits, "%s: other bits", what);
#define X(field, definition)                                                                      \
    cr_assert_eq(a->result.counters.field, b->result.counters.field, "%s: %lld and %lld " #field, \
                 what, a->result.counters.field, b->result.counters.field);
    COUNTERS(X)
#undef X
}

void lab_trajectory(struct trajectory *trajectory, double *value, int rows, int columns) {
    static const char *const names[] = {"t", "wisp", "node", "x", "y", "z", "vx", "vy", "vz"};
    struct table table = {.column_count = columns, .row_count = rows, .value = value};
    char reason[REASON_SIZE];
    for (int c = 0; c < columns; c++) {
        const int length = c < STATE_SAMPLES
                               ? asprintf(&table.name[c], "%s", names[c])
                               : asprintf(&table.name[c], (c - STATE_SAMPLES) % 2 ? "rd%d" : "r%d",
                                          (c - STATE_SAMPLES) / 2);
        cr_assert(length > 0, "no memory");
    }
    cr_assert_eq(trajectory_of_table(trajectory, &table, "numbers", reason), 0, "%s", reason);
}

struct lab_distance lab_distance(const struct lab_run *a, const struct lab_run *b, int from,
                                 int first) {
    struct lab_distance d = {0, 0};
    long count = 0;
    cr_assert(a->frames == b->frames && a->rows == b->rows, "runs of %d and %d frames", a->frames,
              b->frames);
    for (int f = from; f < a->frames; f++) {
        cr_assert(fabs(a->t[f] - b->t[f]) <= 1e-12, "frame %d at %.17g and %.17g", f, a->t[f],
                  b->t[f]);
        for (int i = 0; i < a->rows; i++) {
            const double *x = a->row + (f * a->rows + i) * a->columns,
                         *y = b->row + (f * b->rows + i) * b->columns;
            if (x[1] < first)
                continue;
            double square = 0;
            for (int k = 2; k < 5; k++)
                square += (x[k] - y[k]) * (x[k] - y[k]);
            d.rms += square;
            d.largest = fmax(d.largest, sqrt(square));
            count++;
        }
    }
    d.rms = sqrt(d.rms / (double)count);
    return d;
}

double lab_error(const struct scene *scene, const struct run_request *request,
                 const struct lab_run *exact) {
    struct lab_run run;
    lab_finish(scene, request, &run);
    return lab_distance(&run, exact, 1, 2).rms;
}

double lab_cross_check(const struct scene *scene, int treatment, const struct lab_run *reference) {
    const struct settings settings =
        settings_of(scene, &(struct run_request){.stepper = "reference",
                                                 .treatment = treatment_names[treatment]});
    struct settings second;
    struct lab_run run;
    char reason[REASON_SIZE];
    cr_assert_eq(settings_cross_check(scene, &settings, &second, reason), 0, "%s", reason);
    const struct run_request request = {.stepper = second.method->name,
                                        .treatment = treatment_names[treatment],
                                        .rtol = second.stepper.rtol,
                                        .atol = second.stepper.atol,
                                        .options = settings.method->checked_by->options,
                                        .option_count = 2};
    lab_finish(scene, &request, &run);
    return lab_distance(reference, &run, 1, 2).largest;
}

void lab_check_order(const char *what, const double error[3], double order, double less,
                     double more) {
    for (int k = 0; k < 2; k++) {
        const double found = log2(error[k] / error[k + 1]);
        cr_assert(found >= order - less && found <= order + more,
                  "%s: errors %.2e, %.2e: order %.3f, not %g", what, error[k], error[k + 1], found,
                  order);
    }
}

int lab_close(double a, double b, double limit, double *worst) {
    const double error = fabs(a - b);
    if (worst && limit > 0)
        *worst = fmax(*worst, error / limit);
    return error <= limit;
}
