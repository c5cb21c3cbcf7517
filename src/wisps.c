/* The problem of wisps: a scene's wisps, gathered into parts for the kernel. */
#include "clock.h"
#include "interaction.h"
#include "kernel/kernel.h"
#include "kernel/sparse.h"
#include "model.h"
#include "scene.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES_MAX = 4 };

static const struct treatment treatments[] = {
    [WISP_PROJECTION] = {"projection", "the sample's line counts as fixed in space (the thesis)"},
    [WISP_PENALTY] = {"penalty", "samples are free particles held to their lines by springs"},
    [WISP_GENERALISED] = {"generalised", "the distance along the line is the sample's coordinate"},
    {0},
};

/* The kernel for a number of lanes. */
static const struct kernel {
    int lanes;
    void *(*create)(const struct wisp *const *, const struct surroundings *, enum wisp_treatment,
                    struct system *);
    void (*free)(void *);
    void (*rest)(void *, double *, double *);
    void (*prescribe)(void *, double);
    void (*sample)(void *, int, const double *, const double *, double *, int);
    void (*sample_accelerations)(void *, int, const double *, double *, int);
    void (*restore)(void *, int, const double *, int, double *, double *);
    int (*clamp)(void *, double *, double *);
    unsigned (*near)(void *, const double *, const double *, const double *, int, int *);
    double (*strain)(void *, int, const double *);
    const struct system_ops *ops;
} kernels[] = {
    {1, kernel_create_1, kernel_free_1, kernel_rest_1, kernel_prescribe_1, kernel_sample_1,
     kernel_sample_accelerations_1, kernel_restore_1, kernel_clamp_1, kernel_near_1,
     kernel_strain_1, &kernel_ops_1},
    {4, kernel_create_4, kernel_free_4, kernel_rest_4, kernel_prescribe_4, kernel_sample_4,
     kernel_sample_accelerations_4, kernel_restore_4, kernel_clamp_4, kernel_near_4,
     kernel_strain_4, &kernel_ops_4},
};

/* Which wisps of the scene a part holds, by lane; padding lanes repeat the first. */
struct batch {
    int wisp[LANES_MAX];
    int count;
    struct sparse_matrix *pattern; /* owned; of parts of one wisp */
};

struct wisp_model {
    struct model model;
    const struct scene *scene;
    const struct kernel *kernel;
    enum wisp_treatment treatment;
    struct batch *batches;   /* one for each part */
    int *first_row;          /* by wisp: its first row of a frame */
    struct strand **strands; /* by wisp, where the scene has contacts; NULL-terminated */
    double *strand_rows;     /* of the wisp with most nodes, without the columns wisp and node */
    struct touch *touch;     /* NULL where wisps do not interact */
    char **columns, **rate_columns;
    char name[64];
    double kinks[1 + 2 * KNOTS_MAX];
};

/* --- parts --- */

/* Fills batches with wisps of equal node counts, in the order of the scene. */
static int gather_batches(struct wisp_model *m) {
    const struct scene *scene = m->scene;
    int parts = 0;
    for (int i = 0; i < scene->wisp_count; i++) {
        int b = parts - 1;
        while (b >= 0 && (m->batches[b].count == m->kernel->lanes ||
                          scene->wisps[m->batches[b].wisp[0]].nodes != scene->wisps[i].nodes))
            b--;
        struct batch *batch = &m->batches[b >= 0 ? b : parts++];
        batch->wisp[batch->count++] = i;
        for (int k = batch->count; k < LANES_MAX; k++)
            batch->wisp[k] = batch->wisp[0];
    }
    return parts;
}

/* What the matrices are, see kernel/matrix.h. */
static void declare_matrix(struct system *system, const struct wisp *wisp,
                           enum wisp_treatment treatment) {
    const int one_sided = treatment == WISP_PROJECTION && wisp->samples > 0;
    system->matrix[JACOBIAN_EXACT] = MATRIX_AVAILABLE;
    system->matrix[JACOBIAN_SPD] =
        MATRIX_AVAILABLE | MATRIX_FACTORABLE | (one_sided ? 0 : MATRIX_SYMMETRIC | MATRIX_DEFINITE);
    if (one_sided)
        system->matrix_note = "the air on a sample does not act back on its node; with the samples "
                              "eliminated (--linear direct) it is, as it is in penalty";
}

static int create_part(struct wisp_model *m, int i) {
    struct part *part = &m->model.parts[i];
    struct batch *batch = &m->batches[i];
    const struct wisp *wisps[LANES_MAX];
    for (int k = 0; k < LANES_MAX; k++)
        wisps[k] = &m->scene->wisps[batch->wisp[k]];

    const int lanes = m->kernel->lanes;
    const int size = (wisps[0]->nodes - 2) * wisp_node_unknowns(wisps[0], m->treatment) * lanes;
    part->system = (struct system){.ops = m->kernel->ops,
                                   .name = m->name,
                                   .size = size,
                                   .lanes = lanes,
                                   .wisps = batch->count,
                                   .bdf_order = 2};
    declare_matrix(&part->system, wisps[0], m->treatment);
    part->system.ctx = m->kernel->create(wisps, &m->scene->around, m->treatment, &part->system);
    part->q = aligned_alloc(64, ((size_t)size * sizeof(double) + 63) / 64 * 64);
    part->v = aligned_alloc(64, ((size_t)size * sizeof(double) + 63) / 64 * 64);
    if (!part->system.ctx || !part->q || !part->v)
        return -1;
    if (lanes == 1) {
        batch->pattern = kernel_pattern_1(part->system.ctx);
        part->system.pattern = batch->pattern;
        if (!batch->pattern)
            return -1;
    }
    m->kernel->rest(part->system.ctx, part->q, part->v);
    return 0;
}

/* --- frames --- */

static char *text(const char *format, ...) __attribute__((format(printf, 1, 2)));
static char *text(const char *format, ...) {
    char *made = NULL;
    va_list arguments;
    va_start(arguments, format);
    const int length = vasprintf(&made, format, arguments);
    va_end(arguments);
    return length < 0 ? NULL : made;
}

/* wisp node x y z vx vy vz, then r0 rd0 ... or e0x e0y e0z e0vx e0vy e0vz ... */
static int name_columns(struct wisp_model *m) {
    static const char *const fixed[] = {"wisp", "node", "x", "y", "z", "vx", "vy", "vz"};
    static const char *const particle[] = {"x", "y", "z", "vx", "vy", "vz"};
    const int samples = m->scene->wisps[0].samples, penalty = m->treatment == WISP_PENALTY;
    const int count = 8 + samples * (penalty ? 6 : 2);
    m->columns = calloc((size_t)count + 1, sizeof *m->columns);
    if (!m->columns)
        return -1;
    for (int i = 0; i < count; i++) {
        const int k = i - 8;
        m->columns[i] = i < 8     ? text("%s", fixed[i])
                        : penalty ? text("e%d%s", k / 6, particle[k % 6])
                                  : text("r%s%d", k % 2 ? "d" : "", k / 2);
        if (!m->columns[i])
            return -1;
    }
    m->model.columns = (const char *const *)m->columns;
    m->model.column_count = count;
    return 0;
}

/* wisp node ax ay az, then rdd0 ... or e0ax e0ay e0az ... */
static int name_rate_columns(struct wisp_model *m) {
    static const char *const fixed[] = {"wisp", "node", "ax", "ay", "az"};
    const int samples = m->scene->wisps[0].samples, penalty = m->treatment == WISP_PENALTY;
    const int count = 5 + samples * (penalty ? 3 : 1);
    m->rate_columns = calloc((size_t)count + 1, sizeof *m->rate_columns);
    if (!m->rate_columns)
        return -1;
    for (int i = 0; i < count; i++) {
        const int k = i - 5;
        m->rate_columns[i] = i < 5     ? text("%s", fixed[i])
                             : penalty ? text("e%d%s", k / 3, fixed[2 + k % 3])
                                       : text("rdd%d", k);
        if (!m->rate_columns[i])
            return -1;
    }
    m->model.rate_columns = (const char *const *)m->rate_columns;
    m->model.rate_column_count = count;
    return 0;
}

static int count_rows(struct wisp_model *m) {
    m->first_row = calloc((size_t)m->scene->wisp_count, sizeof(int));
    for (int i = 0; m->first_row && i < m->scene->wisp_count; i++) {
        m->first_row[i] = m->model.row_count;
        m->model.row_count += m->scene->wisps[i].nodes;
    }
    return m->first_row ? 0 : -1;
}

static int interacts(const struct scene *scene) {
    return scene->interaction.interpenetration || scene->interaction.collision;
}

/* Contacts see wisps one by one. */
static int create_strands(struct wisp_model *m) {
    const struct scene *scene = m->scene;
    int most = 0;
    if (scene->body_count == 0 && !interacts(scene))
        return 0;
    m->strands = calloc((size_t)scene->wisp_count + 1, sizeof(struct strand *));
    for (int i = 0; m->strands && i < scene->wisp_count; i++) {
        most = scene->wisps[i].nodes > most ? scene->wisps[i].nodes : most;
        m->strands[i] = strand_create(&scene->wisps[i], m->treatment);
        if (!m->strands[i])
            return -1;
    }
    m->strand_rows = calloc((size_t)(most * m->model.column_count), sizeof(double));
    return m->strands && m->strand_rows ? 0 : -1;
}

static void wisps_sample(const struct model *model, double *rows) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    const int stride = model->column_count;
    for (int i = 0; i < model->part_count; i++) {
        const struct part *part = &model->parts[i];
        m->kernel->prescribe(part->system.ctx, model->t);
        for (int k = 0; k < m->batches[i].count; k++) {
            const int wisp = m->batches[i].wisp[k];
            double *first = rows + m->first_row[wisp] * stride;
            for (int node = 0; node < m->scene->wisps[wisp].nodes; node++) {
                first[node * stride] = wisp;
                first[node * stride + 1] = node;
            }
            m->kernel->sample(part->system.ctx, k, part->q, part->v, first + 2, stride);
        }
    }
}

static void wisps_restore(struct model *model, const double *rows) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    for (int i = 0; i < model->part_count; i++) {
        struct part *part = &model->parts[i];
        for (int k = 0; k < m->kernel->lanes; k++) {
            const int wisp = m->batches[i].wisp[k];
            m->kernel->restore(part->system.ctx, k,
                               rows + m->first_row[wisp] * model->column_count + 2,
                               model->column_count, part->q, part->v);
        }
    }
}

static void wisps_sample_accelerations(const struct model *model, double *const *a, double *rows) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    const int stride = model->rate_column_count;
    for (int i = 0; i < model->part_count; i++) {
        m->kernel->prescribe(model->parts[i].system.ctx, model->t);
        for (int k = 0; k < m->batches[i].count; k++) {
            const int wisp = m->batches[i].wisp[k];
            double *first = rows + m->first_row[wisp] * stride;
            for (int node = 0; node < m->scene->wisps[wisp].nodes; node++) {
                first[node * stride] = wisp;
                first[node * stride + 1] = node;
            }
            m->kernel->sample_accelerations(model->parts[i].system.ctx, k, a[i], first + 2, stride);
        }
    }
}

static int wisps_terms(const struct scene *scene, const char **names, int most) {
    static const char *const bending[] = {NULL, "bending (skip springs)", "bending (hinges)"};
    static const char *const wind[] = {NULL, "steady wind", "gust", "irregular wind"};
    const struct wisp *wisp = &scene->wisps[0];
    const double *g = scene->around.gravity;
    const int windy = wisp->drag_rate > 0 ? (int)scene->around.wind.kind : 0;
    const char *const all[] = {
        g[0] != 0 || g[1] != 0 || g[2] != 0 ? "gravity" : NULL,
        wisp->drag_rate > 0 ? "air" : NULL,
        wind[windy],
        wisp->stretch_stiffness > 0 ? "stretch" : NULL,
        wisp->bending_stiffness > 0 ? bending[wisp->bending] : NULL,
        wisp->samples > 0 ? "envelope" : NULL,
        scene->around.style.knots > 0 ? "style" : NULL,
    };
    int count = 0;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i] && count < most)
            names[count++] = all[i];
    return count;
}

/* --- wisps with each other --- */

/* What wisps need to touch. Their order is one of what they are, not of where they stand in the
 * file: nothing that happens between them, down to the order of sums, depends on the file. */
struct touch {
    struct interaction *interaction;
    struct strand *in_order[]; /* the model's */
};

/* By root, direction, length and nodes; the rest is the same in all wisps of a scene. Wisps of
 * which all that is equal move alike, and may change places. */
static int compare_strands(const void *one, const void *other) {
    const struct wisp *a = (*(struct strand *const *)one)->wisp,
                      *b = (*(struct strand *const *)other)->wisp;
    const double of_a[] = {a->root[0],      a->root[1],      a->root[2], a->direction[0],
                           a->direction[1], a->direction[2], a->length,  a->nodes};
    const double of_b[] = {b->root[0],      b->root[1],      b->root[2], b->direction[0],
                           b->direction[1], b->direction[2], b->length,  b->nodes};
    for (size_t k = 0; k < sizeof of_a / sizeof *of_a; k++)
        if (of_a[k] != of_b[k])
            return of_a[k] < of_b[k] ? -1 : 1;
    return 0;
}

static void free_touch(struct touch *touch) {
    if (touch)
        interaction_free(touch->interaction);
    free(touch);
}

static int create_touch(struct wisp_model *m) {
    const size_t wisps = (size_t)m->scene->wisp_count;
    struct touch *touch = calloc(1, sizeof *touch + wisps * sizeof *touch->in_order);
    m->touch = touch;
    if (!touch)
        return -1;
    touch->interaction = interaction_create(&m->scene->interaction);
    if (!touch->interaction)
        return -1;
    memcpy(touch->in_order, m->strands, wisps * sizeof *touch->in_order);
    qsort(touch->in_order, wisps, sizeof(struct strand *), compare_strands);
    m->model.interaction_rate = m->scene->interaction.rate;
    return 0;
}

/* Lays a wisp of a part open, and takes it back into its lane and the padding that repeats it. */
static struct strand *open_strand(const struct wisp_model *m, int i, int lane) {
    const struct part *part = &m->model.parts[i];
    struct strand *strand = m->strands[m->batches[i].wisp[lane]];
    const int stride = m->model.column_count - 2;
    struct placement head;
    head_placement(&m->scene->around.head, m->model.t, &head);
    m->kernel->prescribe(part->system.ctx, m->model.t);
    m->kernel->sample(part->system.ctx, lane, part->q, part->v, m->strand_rows, stride);
    strand_turn(strand, &head);
    strand_load(strand, m->strand_rows, stride);
    return strand;
}

static void close_strand(const struct wisp_model *m, int i, int lane) {
    const struct part *part = &m->model.parts[i];
    const struct batch *batch = &m->batches[i];
    const int stride = m->model.column_count - 2;
    strand_store(m->strands[batch->wisp[lane]], m->strand_rows, stride);
    for (int k = 0; k < m->kernel->lanes; k++)
        if (batch->wisp[k] == batch->wisp[lane])
            m->kernel->restore(part->system.ctx, k, m->strand_rows, stride, part->q, part->v);
}

static enum outcome interact(struct wisp_model *m, int *changed) {
    for (int i = 0; i < m->model.part_count; i++)
        for (int k = 0; k < m->batches[i].count; k++)
            open_strand(m, i, k);
    if (interaction_tick(m->touch->interaction, m->touch->in_order, m->scene->wisp_count) < 0)
        return OUT_OF_MEMORY;
    for (int i = 0; i < m->model.part_count; i++)
        for (int k = 0; k < m->batches[i].count; k++)
            if (m->strands[m->batches[i].wisp[k]]->changed) {
                close_strand(m, i, k);
                changed[i] = 1;
            }
    return FINISHED;
}

/* --- the clock --- */

/* A tick's bodies. */
struct bodies {
    const struct body *body;
    int count;
    double t, interval;                    /* s */
    double boxes[6 * BODIES_MAX], hull[6]; /* around each, around all */
};

static void place_bodies(const struct scene *scene, double t, struct bodies *bodies) {
    bodies->body = scene->bodies;
    bodies->count = scene->body_count;
    bodies->t = t;
    bodies->interval = 1 / scene->collision_rate;
    for (int i = 0; i < bodies->count; i++) {
        double *box = bodies->boxes + 6 * i, *hull = bodies->hull;
        body_box(&bodies->body[i], t, box);
        for (int k = 0; k < 3; k++) {
            hull[k] = i == 0 || box[k] < hull[k] ? box[k] : hull[k];
            hull[3 + k] = i == 0 || box[3 + k] > hull[3 + k] ? box[3 + k] : hull[3 + k];
        }
    }
}

/* Body contact (section 4.2.2 of the thesis) for the wisps of a part that are near a body. Returns
 * whether any changed. */
static int push_out(const struct wisp_model *m, int i, const struct bodies *bodies, unsigned near) {
    struct counters *counters = &m->model.parts[i].system.counters;
    struct body_report report = {0, 0, 0};
    int changed = 0;
    for (int k = 0; k < m->batches[i].count; k++) {
        if (!(near >> k & 1))
            continue;
        struct strand *strand = open_strand(m, i, k);
        body_contact(strand, bodies->body, bodies->count, bodies->t, bodies->interval, &report);
        if (strand->changed)
            close_strand(m, i, k);
        changed |= strand->changed;
    }
    counters->body_contacts += report.nodes + report.samples;
    counters->nodes_left_inside += report.inside;
    return changed;
}

/* Part by part: body contact, then the clamp. Most parts are far from every body and have nothing
 * to clamp: one look says so. */
static void collide(struct wisp_model *m, int *changed) {
    const int envelope = m->scene->wisps[0].samples > 0;
    struct bodies bodies;
    place_bodies(m->scene, m->model.t, &bodies);
    for (int i = 0; i < m->model.part_count; i++) {
        const struct part *part = &m->model.parts[i];
        void *ctx = part->system.ctx;
        unsigned near = 0;
        int clamp = envelope;
        m->kernel->prescribe(ctx, m->model.t);
        if (bodies.count > 0)
            near = m->kernel->near(ctx, part->q, bodies.hull, bodies.boxes, bodies.count, &clamp);
        if (near)
            changed[i] |= push_out(m, i, &bodies, near);
        if (clamp || (near && envelope))
            changed[i] |= m->kernel->clamp(ctx, part->q, part->v);
    }
}

/* At one time wisps touch first, then bodies push them out and samples are kept off their nodes. */
static enum outcome wisps_tick(struct model *model, unsigned events, int *changed) {
    struct wisp_model *m = (struct wisp_model *)model;
    enum outcome outcome = FINISHED;
    if (events & STOP_INTERACTION && m->touch)
        outcome = interact(m, changed);
    if (events & STOP_COLLISION && outcome == FINISHED)
        collide(m, changed);
    return outcome;
}

/* Stable runs stay below 0.01 at the default material, and Runge-Kutta 4 just past its limit of
 * stability is at 0.2 and stays there. */
static const double largest_strain = 0.1;

static enum outcome wisps_check(const struct model *model, char *reason, int reason_size) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    for (int i = 0; i < model->part_count; i++) {
        m->kernel->prescribe(model->parts[i].system.ctx, model->t);
        for (int k = 0; k < m->batches[i].count; k++) {
            const double strain =
                m->kernel->strain(model->parts[i].system.ctx, k, model->parts[i].q);
            if (strain <= largest_strain)
                continue;
            snprintf(reason, (size_t)reason_size,
                     "wisp %d: a segment is %.3g of its length away from it, more than %g",
                     m->batches[i].wisp[k], strain, largest_strain);
            return DIVERGED;
        }
    }
    return FINISHED;
}

/* --- the problem --- */

/* The thesis's pairs: its explicit Euler with projection, and Baraff & Witkin's implicit Euler with
 * penalty springs and conjugate gradients. */
static int wisps_default_treatment(const struct stepper_method *method) {
    return strcmp(method->name, "euler") == 0            ? WISP_PROJECTION
           : strcmp(method->name, "implicit-euler") == 0 ? WISP_PENALTY
                                                         : WISP_GENERALISED;
}

static const char *wisps_default_linear(const struct stepper_method *method) {
    return strcmp(method->name, "implicit-euler") == 0 ? "cg" : "direct";
}

static void free_names(char **names) {
    for (int i = 0; names && names[i]; i++)
        free(names[i]);
    free(names);
}

static void wisps_free(struct model *model) {
    struct wisp_model *m = (struct wisp_model *)model;
    for (int i = 0; i < model->part_count; i++) {
        m->kernel->free(model->parts[i].system.ctx);
        free(m->batches[i].pattern);
        free(model->parts[i].q);
        free(model->parts[i].v);
    }
    free_touch(m->touch);
    for (int i = 0; m->strands && m->strands[i]; i++)
        strand_free(m->strands[i]);
    free(m->strands);
    free(m->strand_rows);
    free_names(m->columns);
    free_names(m->rate_columns);
    free(m->first_row);
    free(m->batches);
    free(model->parts);
    free(m);
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where a prescribed function of time has a kink: the end of a gust's hold, knots of style and of
 * the head's motion. */
static void gather_kinks(struct wisp_model *m) {
    const struct surroundings *around = &m->scene->around;
    int count = 0;
    if (around->wind.kind == WIND_GUST)
        m->kinks[count++] = around->wind.hold;
    for (int k = 0; k < around->style.knots; k++)
        m->kinks[count++] = around->style.time[k];
    for (int k = 0; k < around->head.knots; k++)
        m->kinks[count++] = around->head.time[k];
    qsort(m->kinks, (size_t)count, sizeof *m->kinks, ascending);
    m->model.kinks = m->kinks;
    m->model.kink_count = count;
    while (m->model.kink_count > 0 && m->model.kinks[0] <= 0) { /* before the start: no stop */
        m->model.kinks++;
        m->model.kink_count--;
    }
}

static struct model *wisps_create(const struct scene *scene, int treatment, int lanes) {
    struct wisp_model *m = calloc(1, sizeof *m);
    const size_t wisps = (size_t)scene->wisp_count;
    if (!m)
        return NULL;
    m->scene = scene;
    m->kernel = &kernels[lanes >= 4];
    m->treatment = (enum wisp_treatment)treatment;
    snprintf(m->name, sizeof m->name, "the wisps (%s)", treatments[treatment].name);
    m->model.problem = &wisp_problem;
    m->batches = calloc(wisps, sizeof *m->batches);
    m->model.parts = calloc(wisps, sizeof *m->model.parts);
    int code = m->batches && m->model.parts ? 0 : -1;
    if (!code)
        m->model.part_count = gather_batches(m);
    for (int i = 0; i < m->model.part_count && !code; i++)
        code = create_part(m, i);
    code = code || name_columns(m) || name_rate_columns(m) || count_rows(m) || create_strands(m);
    if (!code && interacts(scene))
        code = create_touch(m);
    if (code) {
        wisps_free(&m->model);
        return NULL;
    }
    if (scene->wisps[0].samples > 0 || scene->body_count > 0)
        m->model.collision_rate = scene->collision_rate;
    gather_kinks(m);
    return &m->model;
}

const struct problem wisp_problem = {
    .name = "wisps",
    .treatments = treatments,
    .default_treatment = wisps_default_treatment,
    .default_linear = wisps_default_linear,
    .create = wisps_create,
    .free = wisps_free,
    .sample = wisps_sample,
    .restore = wisps_restore,
    .sample_accelerations = wisps_sample_accelerations,
    .terms = wisps_terms,
    .tick = wisps_tick,
    .check = wisps_check,
};
