/* Parts of the problem of wisps: who sits in which, and what a part is told of its matrices. */
#include "wisp_model.h"

#include <stdlib.h>
#include <string.h>

int wisp_take_lane(struct wisp_model *m, int wisp) {
    int i = m->model.part_count - 1;
    while (i >= 0 && (m->batches[i].count == m->kernel->lanes ||
                      m->wisps[m->batches[i].wisp[0]].nodes != m->wisps[wisp].nodes))
        i--;
    if (i < 0)
        i = m->model.part_count++;
    struct batch *batch = &m->batches[i];
    batch->wisp[batch->count++] = wisp;
    for (int k = batch->count; k < LANES_MAX; k++)
        batch->wisp[k] = batch->wisp[0];
    return i;
}

/* What the matrices are, see kernel/matrix.h. */
static void declare_matrix(struct system *system, const struct wisp *wisp,
                           enum wisp_treatment treatment) {
    const int one_sided = treatment == WISP_PROJECTION && wisp->samples > 0;
    system->matrix[JACOBIAN_EXACT] = MATRIX_AVAILABLE;
    system->matrix[JACOBIAN_SPD] =
        MATRIX_AVAILABLE | MATRIX_FACTORABLE | (one_sided ? 0 : MATRIX_SYMMETRIC | MATRIX_DEFINITE);
    system->force_parts = (1u << FORCE_PARTS) - 1;
    system->stiff_part = wisp->bending == BENDING_NONE   ? FORCES_STRETCH
                         : wisp->bending == BENDING_SKIP ? FORCES_AXIAL
                                                         : FORCES_FULL;
    if (one_sided)
        system->matrix_note = "the air on a sample does not act back on its node; with the samples "
                              "eliminated (--linear direct) it is, as it is in penalty";
}

int wisp_part_create(struct wisp_model *m, int i) {
    struct part *part = &m->model.parts[i];
    struct batch *batch = &m->batches[i];
    const struct wisp *wisps[LANES_MAX];
    for (int k = 0; k < LANES_MAX; k++)
        wisps[k] = &m->wisps[batch->wisp[k]];

    const int lanes = m->kernel->lanes, rigid = wisps[0]->stretch == STRETCH_RIGID;
    const int size = (wisps[0]->nodes - 2) * wisp_node_unknowns(wisps[0], m->treatment) * lanes;
    part->system = (struct system){.ops = rigid ? m->kernel->rigid_ops : m->kernel->ops,
                                   .name = m->name,
                                   .size = size,
                                   .lanes = lanes,
                                   .wisps = batch->count,
                                   .numbers = batch->wisp};
    if (rigid)
        part->system.no_jacobians = "rigid segments have none: take an explicit method or cvode, "
                                    "or set material.stretch to \"spring\"";
    else
        declare_matrix(&part->system, wisps[0], m->treatment);
    part->system.ctx = m->kernel->create(wisps, &m->scene->around, m->treatment, &part->system);
    part->q = aligned_alloc(64, ((size_t)size * sizeof(double) + 63) / 64 * 64);
    part->v = aligned_alloc(64, ((size_t)size * sizeof(double) + 63) / 64 * 64);
    if (!part->system.ctx || !part->q || !part->v)
        return -1;
    if (lanes == 1 && !rigid) {
        batch->pattern = kernel_1.pattern(part->system.ctx);
        part->system.pattern = batch->pattern;
        if (!batch->pattern)
            return -1;
    }
    m->kernel->rest(part->system.ctx, m->model.t, part->q, part->v);
    return 0;
}

int wisp_part_project(struct wisp_model *m, int i, unsigned lanes) {
    struct part *part = &m->model.parts[i];
    const struct batch *batch = &m->batches[i];
    if (m->wisps[0].stretch != STRETCH_RIGID || !lanes)
        return 0;
    for (int k = batch->count; k < m->kernel->lanes && lanes & 1; k++)
        lanes |= 1u << k;
    for (int k = 0; k < batch->count; k++)
        part->system.counters.projections += lanes >> k & 1;
    return m->kernel->project_lanes(part->system.ctx, m->model.t, part->q, part->v, lanes);
}

void wisp_take_rows(struct wisp_model *m, int wisp) {
    m->first_row[wisp] = m->model.row_count;
    m->model.row_count += m->wisps[wisp].nodes;
}

void wisp_close(const struct wisp_model *m, int i, int lane, double *rows) {
    const struct part *part = &m->model.parts[i];
    const struct batch *batch = &m->batches[i];
    const int stride = m->model.column_count - 2;
    strand_store(m->strands[batch->wisp[lane]], rows, stride);
    for (int k = 0; k < m->kernel->lanes; k++)
        if (batch->wisp[k] == batch->wisp[lane])
            m->kernel->restore(part->system.ctx, k, rows, stride, part->q, part->v);
}

int wisps_split(const struct scene *scene) {
    return scene->subdivision.limit > scene->wisp_count;
}
