/* Parts of the problem of wisps: who sits in which, and what a part is told of its matrices. */
#include "wisp_model.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* --- how wide --- */

/* What a part costs, over one of 4 lanes: 0.8 to 0.97 with 1 lane, and with 8 lanes 1.25 to 1.5 in
 * registers of 8 doubles; in two of 4 each, 2. */
static const double narrow_cost = 0.9, wide_cost = 1.5, double_cost = 2;

/* Whether the processor has such registers; the compiler's function asks the system too. */
static int has_registers(int doubles) {
#ifdef WISPLAB_WIDE_KERNELS
    return doubles == 4
               ? __builtin_cpu_supports("avx2")
               : __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                     __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#elif defined(__AVX512F__)
    return doubles <= 8;
#else
    (void)doubles; /* the kernels of 1 and 4 do not ask */
    return 0;
#endif
}

const struct kernel *kernel_of(int lanes) {
#ifdef WISPLAB_WIDE_KERNELS
    if (lanes >= 8 && has_registers(8))
        return &kernel_wide_8;
    if (lanes >= 4 && lanes < 8 && has_registers(4))
        return &kernel_wide_4;
#endif
    return lanes >= 8 ? &kernel_8 : lanes >= 4 ? &kernel_4 : &kernel_1;
}

/* The least number of nodes that wisps have above `nodes`, and how many have it; or 0 of none. */
static int count_next(const struct scene *scene, int *nodes) {
    int next = INT_MAX, count = 0;
    for (int i = 0; i < scene->wisp_count; i++) {
        const int n = scene->wisps[i].nodes;
        if (n > *nodes && n < next)
            next = n, count = 0;
        count += n == next;
    }
    *nodes = next;
    return count;
}

/* Parts of so many lanes. */
static int count_parts(const struct scene *scene, int lanes) {
    int parts = 0, nodes = 0, count;
    while ((count = count_next(scene, &nodes)) > 0)
        parts += (count + lanes - 1) / lanes;
    return parts;
}

/* It must not depend on the number of threads: where a run fails, what has been counted of the
 * wisps beside the one that fails depends on who they are. One part alone would leave a second
 * thread without work. */
int wisps_lanes(const struct scene *scene) {
    const char *told = getenv("WISPLAB_LANES"); /* by tests */
    if (told)
        return atoi(told);
    const int one = count_parts(scene, 1), four = count_parts(scene, 4);
    const int eight = count_parts(scene, 8);
    if (eight > 1 && (has_registers(8) ? wide_cost : double_cost) * eight < four)
        return 8;
    return !wisps_split(scene) && narrow_cost * one < four ? 1 : 4;
}

/* --- who sits where --- */

int wisp_take_lane(struct wisp_model *m, int wisp) {
    int i = m->model.part_count - 1;
    while (i >= 0 && (m->batches[i].count == m->kernel->lanes ||
                      m->wisps[m->batches[i].wisp[0]].nodes != m->wisps[wisp].nodes))
        i--;
    if (i < 0)
        i = m->model.part_count++;
    struct batch *batch = &m->batches[i];
    batch->wisp[batch->count++] = wisp;
    for (int k = batch->count; k < LANES_MOST; k++)
        batch->wisp[k] = batch->wisp[0];
    return i;
}

/* What the matrices are, see kernel/matrix.h. */
static void declare_matrix(struct system *system, const struct wisp *wisp,
                           enum wisp_treatment treatment, int pushed) {
    const int one_sided = treatment == WISP_PROJECTION && wisp->samples > 0;
    system->matrix[JACOBIAN_EXACT] = MATRIX_AVAILABLE;
    system->matrix[JACOBIAN_SPD] =
        MATRIX_AVAILABLE | MATRIX_FACTORABLE | (one_sided ? 0 : MATRIX_SYMMETRIC | MATRIX_DEFINITE);
    system->force_parts = (1u << FORCE_PARTS) - 1;
    system->stiff_part = pushed                          ? FORCES_FULL
                         : wisp->bending == BENDING_NONE ? FORCES_STRETCH
                         : wisp->bending == BENDING_SKIP ? FORCES_AXIAL
                                                         : FORCES_FULL;
    system->springs = 2 * wisp->nodes * system->lanes;
    if (one_sided)
        system->matrix_note = "the air on a sample does not act back on its node; with the samples "
                              "eliminated (--linear direct) it is, as it is in penalty";
}

int wisp_part_create(struct wisp_model *m, int i) {
    struct part *part = &m->model.parts[i];
    struct batch *batch = &m->batches[i];
    const struct wisp *wisps[LANES_MOST];
    for (int k = 0; k < LANES_MOST; k++)
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
        declare_matrix(&part->system, wisps[0], m->treatment, m->scene->around.pushing_count > 0);
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
