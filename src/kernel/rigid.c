/* Rigid segments: tensions that keep the distance of neighbours, in accelerations; and states put
 * back onto those distances.
 *
 * With N as in tension.h, B the masses and f all other forces, B a = f - N' y and lengths that
 * stay, N a = -c, where c_j = |P_j (v_(j+1) - v_j)|^2 / |d_j| is what a segment that turns asks
 * for. So the tensions are those of N B^-1 N' y = N B^-1 f + c, and B^-1 f are the accelerations
 * without them. B_1^-1 = 0: of the node that the head moves a is known. */
#include "rigid.h"

#include "base/vector.h"
#include "room.h"
#include "tension.h"

struct kernel_rigid *LANED(kernel_rigid_create)(int nodes, int unknowns) {
    const size_t n = (size_t)nodes, size = (size_t)unknowns;
    lane *room;
    struct kernel_rigid *rigid =
        room_of(sizeof *rigid, n * (1 + 1 + 1 + 1 + 3 + 3 + 3) + size, &room);
    if (!rigid)
        return NULL;
    rigid->turning = room_take(&room, n);
    rigid->upper = room_take(&room, n);
    rigid->tension = room_take(&room, n);
    rigid->gap = room_take(&room, n);
    rigid->p = room_take(&room, 3 * n);
    rigid->from = room_take(&room, 3 * n);
    rigid->t = room_take(&room, 3 * n);
    rigid->v = room_take(&room, size);
    return rigid;
}

/* --- tensions --- */

/* From the tip to the root: the tensions pull at x, accelerations or velocities. */
SPECIALISED void pull(struct kernel_part *part, int coupled, double *x) {
    struct kernel_rigid *rigid = part->rigid;
    lane above = lane_all(0), upper = above;  /* of segment i + 1 */
    struct vec force = {above, above, above}; /* that it has on node i */
    for (int i = part->nodes - 1; i >= 2; i--) {
        const lane y = rigid->tension[i] - upper * above;
        move(part, i, coupled, add_scaled(force, -y, part->t[i - 1]), x, x);
        rigid->tension[i] = y;
        force = scale(y, part->t[i - 1]);
        above = y;
        upper = rigid->upper[i];
    }
}

/* Changes x by B^-1 N' y such that N x becomes -turning, or where that is not asked for 0. Node 1
 * has `first`. */
SPECIALISED void tighten(struct kernel_part *part, int coupled, int turning, struct vec first,
                         double *x) {
    struct kernel_rigid *rigid = part->rigid;
    struct rows rows = first_row();
    struct vec before = first;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec here = free_node(part, x, i);
        lane right = dot(part->t[i - 1], sub(here, before));
        if (turning)
            right += rigid->turning[i];
        next_row(part, &rows, i, coupled, lane_all(0), right, &rigid->upper[i], &rigid->tension[i]);
        before = here;
    }
    pull(part, coupled, x);
}

void LANED(kernel_tighten)(struct kernel_part *part, double t, double *a) {
    const struct vec first = LANED(kernel_carried_acceleration)(part, t, 1);
    if (is_coupled(part))
        tighten(part, 1, 1, first, a);
    else
        tighten(part, 0, 1, first, a);
    part->force[1] = add_scaled(part->force[1], part->rigid->tension[2], part->t[1]);
}

/* --- positions --- */

/* Directions of the segments between the nodes `p`, into part->t, and by how much they are too
 * long; the lanes in which all lengths are as near as rounding lets them be. */
static mask measure(struct kernel_part *part, const struct vec *p, lane tolerance) {
    struct kernel_rigid *rigid = part->rigid;
    mask kept = lane_all(0) == 0;
    part->t[0] = part->tangent;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec d = sub(p[i], p[i - 1]);
        const lane length = lane_sqrt(dot(d, d)), gap = length - part->spacing;
        part->t[i - 1] = scale(1 / length, d);
        rigid->gap[i] = gap;
        kept &= (gap <= tolerance) & (-gap <= tolerance);
    }
    return kept;
}

/* Solves N(p) B^-1 G' y = gap, G' having the directions `from`, into rigid->tension: a tridiagonal
 * system, symmetric where `from` are those of p. */
SPECIALISED void solve_gaps(struct kernel_part *part, int coupled, const struct vec *from) {
    struct kernel_rigid *rigid = part->rigid;
    struct sweep sweep = first_row().sweep;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec n = part->t[i - 1];
        lane diagonal = dot(n, moved(part, i, coupled, from[i - 1])), below = lane_all(0),
             above = below;
        if (i > 2) {
            const struct vec back = moved(part, i - 1, coupled, from[i - 1]);
            diagonal += dot(n, back);
            below = -dot(n, moved(part, i - 1, coupled, from[i - 2]));
            above = -dot(part->t[i - 2], back);
        }
        sweep_row(&sweep, diagonal, below, above, rigid->gap[i], &rigid->upper[i],
                  &rigid->tension[i]);
    }
    for (int i = part->nodes - 2; i >= 2; i--)
        rigid->tension[i] -= rigid->upper[i + 1] * rigid->tension[i + 1];
}

enum { ITERATIONS = 20 };

/* Moves the nodes rigid->p, which have been measured, by B^-1 G' until all segments have their
 * length in the lanes `open`: returns those in which they have not after 20 iterations. B is that
 * of the frames in part->frames. G is that of rigid->t, where they came from, or that of the last
 * iterate.
 */
SPECIALISED mask put_back(struct kernel_part *part, int coupled, int from_start, lane tolerance,
                          mask open) {
    struct kernel_rigid *rigid = part->rigid;
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    for (int k = 0; k < ITERATIONS && !mask_none(open); k++) {
        const struct vec *from = from_start ? rigid->t : part->t;
        solve_gaps(part, coupled, from);
        struct vec beyond = none;
        for (int i = part->nodes - 1; i >= 2; i--) {
            const struct vec force = scale(rigid->tension[i], from[i - 1]);
            const struct vec step = moved(part, i, coupled, sub(beyond, force));
            rigid->p[i] = vec_select(open, add(rigid->p[i], step), rigid->p[i]);
            beyond = force;
        }
        open &= measure(part, rigid->p, tolerance) == 0;
    }
    return open;
}

/* As near as lengths can be told: 1e-13 of them and the rounding of the places. */
static lane tolerance_of(const struct kernel_part *part, const struct vec *p) {
    lane most = lane_all(0);
    for (int i = 0; i < part->nodes; i++) {
        const lane square = dot(p[i], p[i]);
        most = lane_select(square > most, square, most);
    }
    return 1e-13 * part->spacing + 4 * 2.2e-16 * lane_sqrt(most);
}

/* Puts nodes into rigid->p whose segments have their lengths; the lanes in which that failed. The
 * directions there are left in part->t. */
SPECIALISED mask find_places(struct kernel_part *part, int coupled, const double *q) {
    struct kernel_rigid *rigid = part->rigid;
    for (int i = 0; i < part->nodes; i++)
        rigid->from[i] = rigid->p[i] = place_of(part, q, i);
    const lane tolerance = tolerance_of(part, rigid->from);
    const mask kept = measure(part, rigid->from, tolerance);
    memcpy(rigid->t, part->t, (size_t)(part->nodes - 1) * sizeof *part->t);
    if (coupled)
        plane_normals(part, part->frames);
    mask open = put_back(part, coupled, 1, tolerance, kept == 0);
    if (mask_none(open))
        return open;
    for (int i = 2; i < part->nodes; i++)
        rigid->p[i] = vec_select(open, rigid->from[i], rigid->p[i]);
    measure(part, rigid->p, tolerance);
    return put_back(part, coupled, 0, tolerance, open);
}

/* --- states --- */

/* Why lanes could not be put back. */
static int refuse(const struct kernel_part *part, const double *q, const double *v,
                  unsigned lanes) {
    struct system *system = part->system;
    int k = 0;
    if (!all_finite(q, system->size) || !all_finite(v, system->size))
        return system_fail(system, NOT_FINITE, "the state overflowed or became NaN");
    while (!(lanes >> k & 1))
        k++;
    return system_fail(system, SOLVER_STALLED,
                       "wisp %d: the segments could not be given their length back: they are too "
                       "far from it",
                       system->numbers ? system->numbers[k] : k);
}

/* The nodes' new places, and those of samples that are given in space. */
static void store_places(const struct kernel_part *part, mask chosen, double *q) {
    const struct kernel_rigid *rigid = part->rigid;
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns;
        const struct vec shift = sub(rigid->p[i], rigid->from[i]);
        vec_store(q, at, vec_select(chosen, rigid->p[i], vec_load(q, at)));
        for (int j = 0; j < part->samples && part->treatment == WISP_PENALTY; j++) {
            const struct vec e = vec_load(q, at + 3 + 3 * j);
            vec_store(q, at + 3 + 3 * j, vec_select(chosen, add(e, shift), e));
        }
    }
}

/* The velocities without what stretches segments; r' of a sample of `generalised` loses what its
 * node gains along its line: its own velocity there stays, so that no energy is gained. */
SPECIALISED void project_velocities(struct kernel_part *part, int coupled, mask chosen, double *v) {
    double *changed = part->rigid->v;
    memcpy(changed, v, (size_t)part->system->size * sizeof *v);
    if (coupled) {
        plane_normals(part, part->frames);
        for (int i = 2; i < part->nodes; i++)
            carry_frame(part, part->frames, i);
    }
    tighten(part, coupled, 0, part->v[1], changed);
    for (int u = 0; u < (part->nodes - 2) * part->node_unknowns; u++)
        store(v, u, lane_select(chosen, load(changed, u), load(v, u)));
}

int LANED(kernel_project_lanes)(void *ctx, double t, double *q, double *v, unsigned lanes) {
    struct kernel_part *part = ctx;
    const int coupled = is_coupled(part);
    lanes &= (1u << LANES) - 1;
    const mask chosen = mask_of_bits(lanes);
    LANED(kernel_prescribe)(part, t);
    const unsigned open =
        lanes & mask_bits(coupled ? find_places(part, 1, q) : find_places(part, 0, q));
    if (open)
        return refuse(part, q, v, open);
    store_places(part, chosen, q);
    if (coupled)
        project_velocities(part, 1, chosen, v);
    else
        project_velocities(part, 0, chosen, v);
    return 0;
}

int LANED(kernel_project)(void *ctx, double t, double *q, double *v) {
    return LANED(kernel_project_lanes)(ctx, t, q, v, (1u << LANES) - 1);
}
