/* Extremes of a frame of wisps: strain, depth in bodies, radii, speed. */
#include "base/vector.h"
#include "wisp/body.h"
#include "wisp_model.h"

#include <math.h>

static void look_at_node(const struct scene *scene, const struct body_motion *motion,
                         const struct strand *strand, int i, struct extremes *extremes) {
    const struct wisp *wisp = strand->wisp;
    int inside = 0;
    for (int b = 0; b < scene->body_count; b++) {
        const double deep = body_depth(&scene->bodies[b], &motion[b], strand->p[i]);
        inside |= deep >= 0;
        extremes->penetration = fmax(extremes->penetration, deep);
    }
    extremes->nodes_inside += inside;
    extremes->speed = fmax(extremes->speed, vector_length(strand->v[i]));
    for (int k = i * wisp->samples; k < (i + 1) * wisp->samples; k++) {
        const double radius = strand->r[k] / wisp->radius;
        extremes->least_radius = fmin(extremes->least_radius, radius);
        extremes->largest_radius = fmax(extremes->largest_radius, radius);
        extremes->speed = fmax(extremes->speed, vector_length(strand->ev[k]));
    }
}

static int look_at_wisp(const struct wisp_model *m, int w, const double *rows,
                        const struct placement *head, const struct body_motion *motion,
                        struct extremes *extremes) {
    const struct wisp *wisp = &m->wisps[w];
    const int stride = m->model.column_count;
    struct strand *strand = strand_create(wisp, m->treatment);
    if (!strand)
        return OUT_OF_MEMORY;
    strand_turn(strand, head);
    strand_load(strand, rows + m->first_row[w] * stride + 2, stride);
    for (int i = 2; i < wisp->nodes; i++)
        look_at_node(m->scene, motion, strand, i, extremes);
    strand_free(strand);
    return 0;
}

int wisps_extremes(const struct model *model, const double *rows, struct extremes *extremes) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    struct body_motion motion[BODIES_MAX];
    struct placement head;
    int code = 0;
    /* fmin and fmax prefer a number to NaN */
    *extremes = (struct extremes){.least_radius = NAN, .largest_radius = NAN};
    head_placement(&m->scene->around.head, model->t, &head);
    for (int b = 0; b < m->scene->body_count; b++)
        motion[b] = body_motion(&m->scene->bodies[b], &head, model->t);
    for (int w = 0; w < m->wisp_count && !code; w++)
        code = look_at_wisp(m, w, rows, &head, motion, extremes);
    for (int i = 0; i < model->part_count; i++) {
        m->kernel->prescribe(model->parts[i].system.ctx, model->t);
        for (int k = 0; k < m->batches[i].count; k++)
            extremes->strain = fmax(extremes->strain, m->kernel->strain(model->parts[i].system.ctx,
                                                                        k, model->parts[i].q));
    }
    return code;
}
