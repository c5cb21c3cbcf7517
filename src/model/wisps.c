/* The problem of wisps: a scene's wisps, gathered into parts for the kernel. */
#include "kernel/kernel.h"
#include "problems.h"
#include "wisp_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct treatment treatments[] = {
    [WISP_PROJECTION] = {"projection", "the sample's line counts as fixed in space (the thesis)"},
    [WISP_PENALTY] = {"penalty", "samples are free particles held to their lines by springs"},
    [WISP_GENERALISED] = {"generalised", "the distance along the line is the sample's coordinate"},
    {0},
};

/* --- frames --- */

/* The names `fixed`, then for each sample those of `sample` with its number put in at %d: one
 * block, to be freed. NULL where memory cannot be had. */
static const char **name_columns(const struct wisp_model *m, const char *const *fixed,
                                 int fixed_count, const char *const *sample, int *count) {
    enum { NAME_SIZE = 16 };
    int each = 0;
    while (sample[each])
        each++;
    *count = fixed_count + each * m->scene->wisps[0].samples;
    const char **names =
        calloc(1, ((size_t)*count + 1) * sizeof *names + (size_t)*count * NAME_SIZE);
    char *text = names ? (char *)(names + *count + 1) : NULL;
    for (int i = 0; names && i < *count; i++, text += NAME_SIZE) {
        const int k = i - fixed_count;
        if (k >= 0)
            snprintf(text, NAME_SIZE, sample[k % each], k / each);
        names[i] = k < 0 ? fixed[i] : text;
    }
    return names;
}

static int name_all_columns(struct wisp_model *m) {
    static const char *const distance[] = {"r%d", "rd%d", NULL}, *const distance_rate[] = {"rdd%d",
                                                                                           NULL};
    static const char *const particle[] = {"e%dx", "e%dy", "e%dz", "e%dvx", "e%dvy", "e%dvz", NULL};
    static const char *const particle_rate[] = {"e%dax", "e%day", "e%daz", NULL};
    const int penalty = m->treatment == WISP_PENALTY;
    m->columns = name_columns(m, node_columns, NODE_COLUMNS, penalty ? particle : distance,
                              &m->model.column_count);
    m->rate_columns =
        name_columns(m, node_rate_columns, NODE_RATE_COLUMNS,
                     penalty ? particle_rate : distance_rate, &m->model.rate_column_count);
    m->model.columns = m->columns;
    m->model.rate_columns = m->rate_columns;
    return m->columns && m->rate_columns ? 0 : -1;
}

/* Writes wisp and node into a wisp's rows of a frame; returns the first of these rows. */
static double *number_rows(const struct wisp_model *m, int wisp, double *rows, int stride) {
    double *first = rows + m->first_row[wisp] * stride;
    for (int node = 0; node < m->wisps[wisp].nodes; node++) {
        first[node * stride] = wisp;
        first[node * stride + 1] = node;
    }
    return first;
}

static void wisps_sample(const struct model *model, double *rows) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    const int stride = model->column_count;
    for (int i = 0; i < model->part_count; i++) {
        const struct part *part = &model->parts[i];
        m->kernel->prescribe(part->system.ctx, model->t);
        for (int k = 0; k < m->batches[i].count; k++) {
            const int wisp = m->batches[i].wisp[k];
            double *first = number_rows(m, wisp, rows, stride);
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

static void wisps_project(struct model *model) {
    for (int i = 0; i < model->part_count; i++)
        wisp_part_project((struct wisp_model *)model, i, ~0u);
}

static void wisps_sample_accelerations(const struct model *model, double *const *a, double *rows) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    const int stride = model->rate_column_count;
    for (int i = 0; i < model->part_count; i++) {
        m->kernel->prescribe(model->parts[i].system.ctx, model->t);
        for (int k = 0; k < m->batches[i].count; k++) {
            const int wisp = m->batches[i].wisp[k];
            double *first = number_rows(m, wisp, rows, stride);
            m->kernel->sample_accelerations(model->parts[i].system.ctx, k, a[i], first + 2, stride);
        }
    }
}

static struct unknown wisps_unknown(const struct model *model, int i, int k) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    const int wisp = m->batches[i].wisp[k % m->kernel->lanes];
    const int each = wisp_node_unknowns(&m->wisps[wisp], m->treatment), at = k / m->kernel->lanes;
    const int u = at % each, sample = u - 3, first = 8; /* behind x y z vx vy vz */
    const int column = sample < 0                     ? 2 + u
                       : m->treatment == WISP_PENALTY ? first + 6 * (sample / 3) + sample % 3
                                                      : first + 2 * sample;
    return (struct unknown){wisp, 2 + at / each, model->columns[column], "m"};
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
        wisp->stretch == STRETCH_RIGID ? "rigid segments"
        : wisp->stretch_stiffness > 0  ? "stretch"
                                       : NULL,
        wisp->bending_stiffness > 0 ? bending[wisp->bending] : NULL,
        wisp->samples > 0 ? "envelope" : NULL,
        scene->around.style.knots > 0 ? "style" : NULL,
        scene->around.pushing_count > 0 ? "bodies by penalty" : NULL,
    };
    int count = 0;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i] && count < most)
            names[count++] = all[i];
    return count;
}

static double wisps_strain(const struct model *model, int i, double t, double limit, int *wisp) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    const struct part *part = &model->parts[i];
    const unsigned strained = m->kernel->strained(part->system.ctx, t, part->q, limit);
    double most = 0;
    for (int k = 0; k < m->batches[i].count && strained; k++) {
        const double strain = m->kernel->strain(part->system.ctx, k, part->q);
        if (strain > most) {
            most = strain;
            *wisp = m->batches[i].wisp[k];
        }
    }
    return most > limit ? most : 0;
}

/* Stable runs without bodies stay below 0.003 at the default material, `shake` reaches 0.037, and
 * Runge-Kutta 4 just past its limit of stability is at 0.08 and stays there with quiet frames. Soft
 * hair hangs longer by the weight of its free part over EA alone. */
static double wisps_strain_limit(const struct scene *scene) {
    const double *g = scene->around.gravity;
    double stretch = 0;
    for (int w = 0; w < scene->wisp_count; w++) {
        const struct wisp *wisp = &scene->wisps[w];
        double mass = 0;
        for (int i = 2; i < wisp->nodes; i++)
            mass += wisp_node_mass(wisp, i) + wisp->samples * wisp_sample_mass(wisp, i);
        const double weight = mass * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
        if (weight > 0 && wisp->stretch == STRETCH_SPRING)
            stretch = fmax(stretch, weight / wisp->stretch_stiffness);
    }
    return fmax(0.05, 2 * stretch);
}

/* --- the problem --- */

static int wisps_default_treatment(const struct stepper_method *method) {
    const char *treatment = method->on_wisps.treatment;
    return treatment ? treatment_find(&wisp_problem, treatment) : WISP_GENERALISED;
}

static const char *wisps_default_linear(const struct stepper_method *method) {
    return method->on_wisps.linear ? method->on_wisps.linear : "direct";
}

static void wisps_free(struct model *model) {
    struct wisp_model *m = (struct wisp_model *)model;
    for (int i = 0; i < model->part_count; i++) {
        m->kernel->free(model->parts[i].system.ctx);
        free(m->batches[i].pattern);
        free(model->parts[i].q);
        free(model->parts[i].v);
    }
    wisp_ticks_free(m);
    free(m->columns);
    free(m->rate_columns);
    free(m->first_row);
    free(m->parent);
    free(m->batches);
    free(model->parts);
    free(m->wisps);
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
}

/* Room for the scene's wisps and all that may come of them, and the parts and rows of the first. */
static int take_wisps(struct wisp_model *m) {
    const struct scene *scene = m->scene;
    m->wisp_count = scene->wisp_count;
    m->wisp_room = wisps_split(scene) ? scene->subdivision.limit : scene->wisp_count;
    const size_t room = (size_t)m->wisp_room;
    m->wisps = calloc(room, sizeof *m->wisps);
    m->first_row = calloc(room, sizeof *m->first_row);
    m->parent = calloc(room, sizeof *m->parent);
    m->batches = calloc(room, sizeof *m->batches);
    m->model.parts = calloc(room, sizeof *m->model.parts);
    if (!m->wisps || !m->first_row || !m->parent || !m->batches || !m->model.parts)
        return -1;
    m->model.parent = m->parent;
    memcpy(m->wisps, scene->wisps, (size_t)m->wisp_count * sizeof *m->wisps);
    for (int i = 0; i < m->wisp_count; i++) {
        m->parent[i] = i;
        wisp_take_lane(m, i);
        wisp_take_rows(m, i);
    }
    return 0;
}

static struct model *wisps_create(const struct scene *scene, int treatment, int lanes) {
    struct wisp_model *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->scene = scene;
    m->kernel = kernel_of(lanes);
    m->treatment = (enum wisp_treatment)treatment;
    snprintf(m->name, sizeof m->name, "the wisps (%s)", treatments[treatment].name);
    m->model.problem = &wisp_problem;
    m->model.t = scene->begin;
    int code = take_wisps(m);
    for (int i = 0; i < m->model.part_count && !code; i++)
        code = wisp_part_create(m, i);
    code = code || name_all_columns(m) || wisp_ticks_create(m) || wisps_start(m);
    if (code) {
        wisps_free(&m->model);
        return NULL;
    }
    gather_kinks(m);
    return &m->model;
}

const struct problem wisp_problem = {
    .name = "wisps",
    .treatments = treatments,
    .default_treatment = wisps_default_treatment,
    .default_linear = wisps_default_linear,
    .create = wisps_create,
    .lanes = wisps_lanes,
    .free = wisps_free,
    .sample = wisps_sample,
    .restore = wisps_restore,
    .project = wisps_project,
    .sample_accelerations = wisps_sample_accelerations,
    .unknown = wisps_unknown,
    .terms = wisps_terms,
    .tick = wisps_tick,
    .tick_part = wisps_tick_part,
    .strain = wisps_strain,
    .strain_limit = wisps_strain_limit,
    .extremes = wisps_extremes,
};
