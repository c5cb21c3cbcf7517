/* Stiffness and damping of the skeleton, block by block: derivatives of the forces by positions and
 * velocities with the frames held still. */
#include "matrix.h"
#include "parting.h"
#include "room.h"
#include "springs.h"

struct kernel_matrix *LANED(kernel_matrix_create)(const struct kernel_part *part) {
    const size_t f = (size_t)free_nodes(part), block = sizeof(struct block) / sizeof(lane);
    const size_t frames = (f + 2) * sizeof(struct frame) / sizeof(lane), parting = f + 3;
    const size_t penetrations = part->push ? LANED(kernel_penetrations_size)(part) : 0;
    const size_t jacobians = f * block * 8 + frames + parting + penetrations;
    lane *room;
    struct kernel_matrix *matrix =
        room_of(sizeof *matrix, jacobians + (f + 2) * (3 * PANEL_ROWS + 3), &room);
    if (!matrix)
        return NULL;
    matrix->stiffness = room_take(&room, 3 * f * block);
    matrix->damping = room_take(&room, 3 * f * block);
    matrix->stiffness_above = room_take(&room, 2 * f * block);
    matrix->frames = room_take(&room, frames);
    matrix->steep = room_take(&room, f);
    matrix->parting = room_take(&room, 3);
    if (part->push)
        matrix->penetrations = LANED(kernel_penetrations_in)(part, room_take(&room, penetrations));
    matrix->panel = room_take(&room, (f + 2) * 3 * PANEL_ROWS);
    matrix->x = room;
    matrix->jacobian_numbers = jacobians;
    return matrix;
}

void LANED(kernel_matrix_free)(struct kernel_matrix *matrix) {
    if (matrix)
        free(matrix->kept);
    free(matrix);
}

/* Lanes that wait. */
static unsigned waiting(const struct kernel_part *part) {
    return part->system->waiting & ((1u << LANES) - 1);
}

/* What lanes that wait have of the Jacobians is kept while those of others are written, */
static int keep(struct kernel_part *part) {
    struct kernel_matrix *m = part->matrix;
    if (!waiting(part))
        return 0;
    if (!m->kept && !room_of(0, m->jacobian_numbers, &m->kept))
        return system_fail(part->system, -OUT_OF_MEMORY, "no memory for the Jacobians");
    memcpy(m->kept, m->stiffness, m->jacobian_numbers * sizeof(lane));
    return 0;
}

/* and put back. */
static void put_back(struct kernel_part *part) {
    const mask wait = mask_of_bits(waiting(part));
    struct kernel_matrix *m = part->matrix;
    lane *numbers = (lane *)m->stiffness;
    for (size_t i = 0; i < m->jacobian_numbers && !mask_none(wait); i++)
        numbers[i] = lane_select(wait, m->kept[i], numbers[i]);
}

/* --- blocks in their places --- */

/* Adds s B to row `row`, column `column` (nodes); what concerns nodes 0 and 1 falls away. */
static inline void gather(struct block (*lower)[3], struct block (*above)[2], int row, int column,
                          lane s, const struct block *b) {
    if (row < 2 || column < 2)
        return;
    if (column <= row)
        block_add_scaled(&lower[row - 2][row - column], s, b);
    else if (above)
        block_add_scaled(&above[column - 2][column - row - 1], s, b);
}

/* --- springs between two nodes --- */

/* The pair's own two blocks are written, for springs come first; the diagonal's are added to. */
SPECIALISED void gather_spring(struct block (*lower)[3], struct block (*above)[2], int a, int b,
                               const struct block *block) {
    block_add(&lower[b - 2][0], block);
    if (a < 2)
        return;
    block_add(&lower[a - 2][0], block);
    EACH (i, 0, 3)
        EACH (j, 0, 3) {
            lower[b - 2][b - a].m[i][j] = -block->m[i][j];
            if (above)
                above[b - 2][b - a - 1].m[i][j] = -block->m[i][j];
        }
}

/* d f_a / d p_b = k [nn' + (1 - L0/L) P] + c/L [(dv.n) P + n (P dv)'], d f_a / d v_b = c nn';
 * `spd`: 1 - L0/L not below 0, without the terms in c/L. */
SPECIALISED void linearise_spring(struct kernel_matrix *m, int a, int b, const struct reach *r,
                                  lane rest, lane k, lane c) {
    const int exact = m->kind == JACOBIAN_EXACT;
    lane geometric = 1 - rest * r->inverse;
    if (!exact)
        geometric = lane_select(geometric > 0, geometric, lane_all(0));
    lane sideways = k * geometric;
    struct block block = block_outer(k, r->n, r->n);
    if (exact) {
        const lane rate = dot(r->velocity, r->n), over_length = c * r->inverse;
        const struct vec slip = add_scaled(r->velocity, -rate, r->n);
        const struct block turning = block_outer(over_length, r->n, slip);
        sideways += over_length * rate;
        block_add(&block, &turning);
    }
    const struct block stiff = block_across(sideways, r->n), damp = block_outer(c, r->n, r->n);
    block_add(&block, &stiff);
    gather_spring(m->stiffness, exact ? m->stiffness_above : NULL, a, b, &block);
    gather_spring(m->damping, NULL, a, b, &damp);
}

/* --- hinges --- */

/* Derivatives by the two edges a and b: blocks aa, ab, ba, bb. */
struct edge_blocks {
    struct block m[2][2];
};

/* The square of the derivative of t_b - t_a: positive semidefinite, and at the straight shape what
 * the second derivative of angle^2 / 2 becomes. This is the `spd` form of the elastic hinge
 * (Gauss-Newton on the tangents' difference, whose length is 2 sin(angle / 2)). */
static struct edge_blocks tangent_difference(const struct reach *a, const struct reach *b) {
    const struct block pa = block_across(a->inverse, a->n), pb = block_across(b->inverse, b->n);
    struct edge_blocks e = {{{block_product(&pa, &pa), block_product(&pa, &pb)},
                             {block_product(&pb, &pa), block_product(&pb, &pb)}}};
    for (int k = 0; k < 2; k++)
        EACH (i, 0, 3)
            EACH (j, 0, 3)
                e.m[k][1 - k].m[i][j] = -e.m[k][1 - k].m[i][j];
    return e;
}

/* Second derivative of the angle. In the plane of the edges the direction of e_a turns with e_a,
 * out of it the angle shortens like that of a leaning triangle: with A = (b - cos a) / sin and
 * B = (a - cos b) / sin, the unit vectors across a and b, and n out of the plane,
 *   H_aa = [a A' + A a' + cot nn'] / L_a^2,  H_bb likewise,  H_ab = - nn' / (sin L_a L_b). */
static struct edge_blocks angle_hessian(const struct reach *a, const struct reach *b,
                                        const struct turn *turn) {
    const struct vec axis = cross(a->n, b->n), n = scale(1 / turn->sine, axis);
    const lane cotangent = dot(a->n, b->n) / turn->sine;
    const struct reach *const edge[2] = {a, b};
    const struct vec gradient[2] = {turn->along_a, turn->along_b};
    struct edge_blocks h;
    for (int k = 0; k < 2; k++) {
        const lane over_length = edge[k]->inverse;
        const struct block plane = block_outer(-over_length, edge[k]->n, gradient[k]);
        const struct block turned = block_transpose(&plane);
        h.m[k][k] = block_outer(cotangent * over_length * over_length, n, n);
        block_add(&h.m[k][k], &plane);
        block_add(&h.m[k][k], &turned);
    }
    h.m[0][1] = h.m[1][0] = block_outer(-a->inverse * b->inverse / turn->sine, n, n);
    return h;
}

static struct block block_select(mask m, const struct block *yes, const struct block *no) {
    struct block b;
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            b.m[i][j] = lane_select(m, yes->m[i][j], no->m[i][j]);
    return b;
}

/* -d(edge forces)/d(edges): forces are -(k angle + c rate) g with g the angle's gradient, so this
 * is g (k g + c d rate)' + (k angle + c rate) H, with d rate = H (edges' velocities). */
static struct edge_blocks hinge_stiffness(const struct reach *a, const struct reach *b,
                                          const struct turn *turn, lane k, lane c) {
    const struct edge_blocks h = angle_hessian(a, b, turn);
    const struct vec g[2] = {turn->along_a, turn->along_b};
    const lane rate = dot(g[0], a->velocity) + dot(g[1], b->velocity);
    struct edge_blocks s;
    for (int j = 0; j < 2; j++) {
        const struct vec turning =
            add(block_times(&h.m[j][0], a->velocity), block_times(&h.m[j][1], b->velocity));
        const struct vec right = add_scaled(scale(k, g[j]), c, turning);
        for (int i = 0; i < 2; i++) {
            s.m[i][j] = block_outer(lane_all(1), g[i], right);
            block_add_scaled(&s.m[i][j], k * turn->angle + c * rate, &h.m[i][j]);
        }
    }
    return s;
}

/* From edges to the three nodes: edge a is node 1 - node 0, edge b node 2 - node 1. */
static void gather_hinge(struct block (*lower)[3], struct block (*above)[2], int first,
                         const struct edge_blocks *e) {
    static const int sign[2][3] = {{-1, 1, 0}, {0, -1, 1}};
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            for (int x = 0; x < 2; x++)
                for (int y = 0; y < 2; y++)
                    if (sign[x][i] && sign[y][j])
                        gather(lower, above, first + i, first + j,
                               lane_all(sign[x][i] * sign[y][j]), &e->m[x][y]);
}

static void linearise_hinge(struct kernel_matrix *m, int first, const struct reach *a,
                            const struct reach *b, lane k, lane c) {
    const int exact = m->kind == JACOBIAN_EXACT;
    const struct turn turn = turn_between(a, b);
    const mask turned = turn.sine > 1e-12;
    const struct vec g[2] = {turn.along_a, turn.along_b};
    const struct edge_blocks straight = tangent_difference(a, b);
    const struct edge_blocks bent = hinge_stiffness(a, b, &turn, k, c);
    struct edge_blocks stiff, damp;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            struct block scaled = {0}, damped = {0};
            const struct block turning = block_outer(c, g[i], g[j]);
            block_add_scaled(&scaled, k, &straight.m[i][j]);
            block_add_scaled(&damped, c, &straight.m[i][j]);
            stiff.m[i][j] = exact ? block_select(turned, &bent.m[i][j], &scaled) : scaled;
            damp.m[i][j] = block_select(turned, &turning, &damped);
        }
    gather_hinge(m->stiffness, exact ? m->stiffness_above : NULL, first, &stiff);
    gather_hinge(m->damping, NULL, first, &damp);
}

/* In edge forces and their derivatives by places and velocities, as above. */
struct hinge LANED(kernel_hinge_rate)(const struct kernel_part *part, const struct reach *a,
                                      const struct reach *b, const struct edge_rate rates[2]) {
    const lane k = part->bend_k, c = part->bend_c;
    const struct turn turn = turn_between(a, b);
    const mask turned = turn.sine > 1e-12;
    const struct vec g[2] = {turn.along_a, turn.along_b};
    const struct edge_blocks straight = tangent_difference(a, b);
    const struct edge_blocks bent = hinge_stiffness(a, b, &turn, k, c);
    const lane faster = dot(g[0], rates[0].velocity) + dot(g[1], rates[1].velocity);
    struct vec on[2];
    for (int i = 0; i < 2; i++) {
        struct vec if_bent = scale(-c * faster, g[i]);
        struct vec if_straight = {lane_all(0), lane_all(0), lane_all(0)};
        for (int j = 0; j < 2; j++) {
            const struct vec both = add_scaled(scale(k, rates[j].place), c, rates[j].velocity);
            if_bent = sub(if_bent, block_times(&bent.m[i][j], rates[j].place));
            if_straight = sub(if_straight, block_times(&straight.m[i][j], both));
        }
        on[i] = vec_select(turned, if_bent, if_straight);
    }
    return (struct hinge){on[0], on[1]};
}

/* --- the walk --- */

static void clear_all(struct kernel_matrix *m, int nodes) {
    const size_t f = (size_t)nodes;
    memset(m->stiffness, 0, f * sizeof *m->stiffness);
    memset(m->damping, 0, f * sizeof *m->damping);
    memset(m->stiffness_above, 0, f * sizeof *m->stiffness_above);
}

/* Enough where every pair of nodes within reach has its spring. */
static void clear_diagonals(struct kernel_matrix *m, int nodes) {
    for (int i = 0; i < nodes; i++) {
        memset(&m->stiffness[i][0], 0, sizeof(struct block));
        memset(&m->damping[i][0], 0, sizeof(struct block));
    }
}

static mask walk(struct kernel_part *part, const double *q, const double *v) {
    struct kernel_matrix *m = part->matrix;
    struct vec pa = part->p[0], va = part->v[0], pb = part->p[1], vb = part->v[1];
    struct reach before = first_segment(part);
    mask sound = lane_all(0) == 0;
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns;
        const struct vec p = vec_load(q, at), pv = vec_load(v, at);
        const struct reach segment = reach(pb, p, vb, pv, &sound);
        linearise_spring(m, i - 1, i, &segment, part->spacing, part->stretch_k, part->stretch_c);
        if (part->bending == BENDING_SKIP) {
            const struct reach skip = reach(pa, p, va, pv, &sound);
            linearise_spring(m, i - 2, i, &skip, part->skip_length, part->bend_k, part->bend_c);
        }
        if (part->bending == BENDING_HINGE)
            linearise_hinge(m, i - 2, &before, &segment, part->bend_k, part->bend_c);
        before = segment;
        pa = pb, va = vb;
        pb = p, vb = pv;
    }
    return sound;
}

/* What bodies do to samples stays apart; what they do to nodes is theirs as springs are. */
static void linearise_pushes(struct kernel_part *part, double t, const double *q, const double *v) {
    struct kernel_matrix *m = part->matrix;
    LANED(kernel_push_linearise)(part, m->kind, t, q, v, m->frames, &m->penetrations);
    for (int i = 0; i < free_nodes(part); i++) {
        const struct penetration *own = penetrating_node(part, &m->penetrations, i);
        if (!own)
            continue;
        const mask inside = own->inside != 0;
        struct block damping = m->damping[i][0], stiffness = m->stiffness[i][0];
        block_add_scaled(&damping, part->mass[i + 2], &own->damping);
        block_add_scaled(&stiffness, part->mass[i + 2], &own->stiffness);
        m->damping[i][0] = block_select(inside, &damping, &m->damping[i][0]);
        m->stiffness[i][0] = block_select(inside, &stiffness, &m->stiffness[i][0]);
    }
}

/* d tanh(d / width) = (1 - tanh^2) / width. */
static void linearise_parting(struct kernel_part *part, double t, const double *q) {
    struct kernel_matrix *m = part->matrix;
    *m->parting = parting_strength(part, t);
    for (int i = 0; i < free_nodes(part); i++) {
        const lane side = parting_side(part, vec_load(q, i * part->node_unknowns));
        m->steep[i] = (1 - side * side) / part->surroundings->style.parting.width;
    }
}

int LANED(kernel_linearise)(void *ctx, enum jacobian kind, double t, const double *q,
                            const double *v) {
    struct kernel_part *part = ctx;
    LANED(kernel_prescribe)(part, t);
    if (!part->matrix)
        part->matrix = LANED(kernel_matrix_create)(part);
    if (!part->matrix)
        return system_fail(part->system, -OUT_OF_MEMORY, "no memory for the Jacobians");
    struct kernel_matrix *m = part->matrix;
    if (keep(part))
        return -OUT_OF_MEMORY;
    m->kind = kind;
    if (part->bending == BENDING_SKIP)
        clear_diagonals(m, free_nodes(part));
    else
        clear_all(m, free_nodes(part));
    mask sound = walk(part, q, v);
    if (kind == JACOBIAN_EXACT && has_parting(part))
        linearise_parting(part, t, q);
    if (part->samples > 0)
        sound &= LANED(kernel_frames)(part, q, m->frames);
    if (part->push)
        linearise_pushes(part, t, q, v);
    put_back(part);
    if (!mask_all(sound))
        return LANED(kernel_refuse_state)(part, q, v);
    return 0;
}
