/* What contact costs, per point and tick, in evaluations of the forces on a node; whether it grows
 * in proportion with the wisps; and what a second thread gains. */
#include "base/files.h"
#include "base/vector.h"
#include "measure.h"
#include "model/clock.h"
#include "model/problems.h"
#include "run/settings.h"
#include "run/simulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- mats of hanging wisps --- */

const struct mat mats[MATS] = {{"hardly touching", 0.15}, {"touching", 0.038}};
const int mat_sizes[MAT_SIZES] = {100, 1000, 10000};

void mat_subject(const struct mat *mat, int wisps, char subject[SUBJECT_SIZE]) {
    snprintf(subject, SUBJECT_SIZE, "%s %d", mat->name, wisps);
}

/* Between -1 and 1, by a linear congruential generator (Knuth's). */
static double random_number(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / (1 << 23) - 1;
}

/* Roots in a square some `spacing` apart, whatever their number; directions down and aslant. */
static struct scene *scene_of(const struct scene *scene, double spacing, int wisps) {
    struct scene *mat = zeros(sizeof *mat);
    const int side = (int)ceil(sqrt(wisps));
    unsigned seed = 5;
    *mat = *scene;
    mat->interaction = (struct interaction_settings){90, 0.9, 5, 1, 1, 1};
    mat->wisps = zeros((size_t)wisps * sizeof *mat->wisps);
    mat->wisp_count = wisps;
    for (int k = 0; k < wisps; k++) {
        struct wisp *wisp = &mat->wisps[k];
        *wisp = scene->wisps[0];
        wisp->nodes = KERNEL_NODES;
        wisp->root[0] = spacing * (k % side + 0.2 * random_number(&seed));
        wisp->root[1] = 0;
        wisp->root[2] = spacing * (k / side + 0.2 * random_number(&seed));
        wisp->direction[0] = 0.35 * random_number(&seed);
        wisp->direction[1] = -1;
        wisp->direction[2] = 0.35 * random_number(&seed);
        vector_normalise(wisp->direction);
    }
    return mat;
}

/* Bends a wisp's rows of a frame by some 0.1 rad at each node and sets nodes and samples in motion.
 */
static void bend(const struct wisp *wisp, double *rows, int stride, unsigned *seed) {
    double t[3], p[3];
    for (int k = 0; k < 3; k++) {
        t[k] = wisp->direction[k];
        p[k] = wisp->root[k] + wisp_spacing(wisp) * t[k];
    }
    for (int i = 2; i < wisp->nodes; i++) {
        double *row = rows + i * stride;
        for (int k = 0; k < 3; k++)
            t[k] += 0.15 * random_number(seed);
        vector_normalise(t);
        for (int k = 0; k < 3; k++) {
            row[2 + k] = p[k] += wisp_spacing(wisp) * t[k];
            row[5 + k] = 0.3 * random_number(seed);
        }
        for (int j = 0; j < wisp->samples; j++) {
            row[8 + 2 * j] *= 1 + 0.3 * random_number(seed);
            row[9 + 2 * j] = 0.1 * random_number(seed);
        }
    }
}

/* --- ticks and evaluations --- */

struct contact_wisp {
    struct model *model;
    double **v, **a; /* velocities before the tick; room for accelerations */
    int *changed;
};

static struct contact_wisp *touching_of(const struct scene *scene, double spacing, int wisps) {
    struct contact_wisp *t = zeros(sizeof *t);
    const struct scene *mat = scene_of(scene, spacing, wisps);
    unsigned seed = 7;
    t->model = wisp_problem.create(mat, WISP_GENERALISED, 4);
    if (!t->model)
        out_of_memory();
    const int stride = t->model->column_count;
    double *rows = zeros((size_t)(t->model->row_count * stride) * sizeof *rows);
    wisp_problem.sample(t->model, rows);
    for (int k = 0; k < wisps; k++)
        bend(&mat->wisps[k], rows + k * KERNEL_NODES * stride, stride, &seed);
    wisp_problem.restore(t->model, rows);
    free(rows);
    const size_t parts = (size_t)t->model->part_count;
    t->v = zeros(parts * sizeof *t->v);
    t->a = zeros(parts * sizeof *t->a);
    t->changed = zeros(parts * sizeof *t->changed);
    for (size_t i = 0; i < parts; i++) {
        const size_t bytes = (size_t)t->model->parts[i].system.size * sizeof(double);
        t->v[i] = memcpy(zeros(bytes), t->model->parts[i].v, bytes);
        t->a[i] = zeros(bytes);
    }
    return t;
}

static void evaluate(void *ctx) {
    const struct contact_wisp *t = ctx;
    for (int i = 0; i < t->model->part_count; i++) {
        struct part *part = &t->model->parts[i];
        if (system_acceleration(&part->system, 0, part->q, t->v[i], t->a[i]))
            give_up("%s", part->system.reason);
    }
}

/* All of it: wisps are laid open, contacts found, velocities changed and put back. Positions stay,
 * velocities are set anew: every tick is the same. */
static void tick(void *ctx) {
    const struct contact_wisp *t = ctx;
    for (int i = 0; i < t->model->part_count; i++) {
        const struct part *part = &t->model->parts[i];
        memcpy(part->v, t->v[i], (size_t)part->system.size * sizeof(double));
    }
    if (wisp_problem.tick(t->model, NULL, STOP_INTERACTION, t->changed) != FINISHED)
        out_of_memory();
}

static double contacts_per_point(const struct contact_wisp *t, const struct scene *mat) {
    struct interaction *interaction = interaction_create(&mat->interaction);
    const int stride = t->model->column_count, count = mat->wisp_count;
    struct strand **strands = zeros((size_t)count * sizeof(struct strand *));
    double *rows = zeros((size_t)(t->model->row_count * stride) * sizeof *rows);
    wisp_problem.sample(t->model, rows);
    for (int k = 0; k < count; k++) {
        strands[k] = strand_create(&mat->wisps[k], WISP_GENERALISED);
        if (!strands[k])
            out_of_memory();
        strand_load(strands[k], rows + k * KERNEL_NODES * stride + 2, stride);
    }
    const int contacts = interaction ? interaction_find(interaction, strands, count) : -1;
    if (contacts < 0)
        out_of_memory();
    for (int k = 0; k < count; k++)
        strand_free(strands[k]);
    interaction_free(interaction);
    free(rows);
    return contacts / ((KERNEL_NODES - 2.) * (1 + mat->wisps[0].samples) * count);
}

static void enter_mat(struct contest *contest, const struct scene *scene, const struct mat *mat,
                      int wisps) {
    struct contact_wisp *t = touching_of(scene, mat->spacing, wisps);
    const double nodes = (KERNEL_NODES - 2.) * wisps;
    char subject[SUBJECT_SIZE];
    mat_subject(mat, wisps, subject);
    contest_note(contest, "contacts", subject, "per point",
                 contacts_per_point(t, scene_of(scene, mat->spacing, wisps)));
    contest_add(contest, "contact", subject, "evaluation", nodes, evaluate, t);
    contest_add(contest, "contact", subject, "tick", nodes * (1 + scene->wisps[0].samples), tick,
                t);
}

/* --- threads --- */

enum { HALVES = 2, TURNS = 2000000 };

/* Arithmetic in registers alone: what the machine's second processor can gain at this moment. */
struct arithmetic {
    struct workers *workers;
    double result[HALVES][8]; /* apart from each other in memory */
};

static void do_arithmetic(void *ctx, int half) {
    struct arithmetic *a = ctx;
    double x[4] = {1, 2, 3, 4};
    for (int i = 0; i < TURNS; i++)
        for (int k = 0; k < 4; k++)
            x[k] = x[k] * 0.999 + 1e-3;
    a->result[half][0] = x[0] + x[1] + x[2] + x[3];
}

static void run_arithmetic(void *ctx) {
    struct arithmetic *a = ctx;
    workers_run(a->workers, do_arithmetic, a, HALVES);
}

struct simulated {
    const struct scene *scene;
    struct settings settings;
};

static void run_simulated(void *ctx) {
    const struct simulated *s = ctx;
    struct run_result result;
    simulate(s->scene, &s->settings, NULL, NULL, &result);
    if (result.outcome != FINISHED)
        give_up("%s at %g Hz: %s", s->settings.method->name, 1 / s->settings.step, result.reason);
}

static struct simulated *simulated_of(const struct scene *scene, const char *stepper, double rate,
                                      int threads) {
    struct simulated *s = zeros(sizeof *s);
    struct scene *mat = scene_of(scene, mats[1].spacing, mat_sizes[0]);
    const struct run_request request = {.stepper = stepper, .step = 1 / rate, .threads = threads};
    char reason[REASON_SIZE];
    mat->duration = 0.1;
    s->scene = mat;
    if (settings_resolve(mat, &request, &s->settings, reason))
        give_up("%s", reason);
    return s;
}

static void enter_threads(struct contest *contest, const struct scene *scene) {
    static const char *const names[] = {"1 thread", "2 threads"};
    for (int threads = 1; threads <= 2; threads++) {
        struct arithmetic *a = zeros(sizeof *a);
        a->workers = workers_create(threads);
        if (!a->workers)
            give_up("no threads");
        contest_add_wall(contest, "threads", "registers", names[threads - 1], 1, run_arithmetic, a);
        contest_add_wall(contest, "threads", "euler 9000 Hz", names[threads - 1], 1, run_simulated,
                         simulated_of(scene, "euler", 9000, threads));
        contest_add_wall(contest, "threads", "rk4 4000 Hz", names[threads - 1], 1, run_simulated,
                         simulated_of(scene, "rk4", 4000, threads));
    }
}

void enter_contacts(struct contest *contest, const struct scene *scene) {
    for (int m = 0; m < MATS; m++)
        for (int i = 0; i < MAT_SIZES; i++)
            enter_mat(contest, scene, &mats[m], mat_sizes[i]);
    enter_threads(contest, scene);
}
