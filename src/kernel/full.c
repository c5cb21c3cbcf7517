/* Solves with all forces, made of what the last acceleration has found: the matrix of JACOBIAN_SPD,
 * written into panels, factorised and solved in one go. It may leave out the springs' transverse
 * stiffness k (1 - L0/L) P, with which BDF2 is stable to shorter steps than without. */
#include "panel.h"
#include "room.h"
#include "springs.h"
#include "tension.h"

struct kernel_panels {
    struct panel *panel; /* by free node; two of zeros behind the last */
    struct vec *force;   /* gamma K g of springs, by node */
    lane *x;             /* right side and solution of the nodes, and two nodes of zeros */
    double *right;       /* right side of all unknowns */
};

static struct kernel_panels *create(const struct kernel_part *part) {
    const size_t f = (size_t)free_nodes(part) + 2, panels = f * 3 * PANEL_ROWS;
    lane *room;
    struct kernel_panels *made =
        room_of(sizeof *made, panels + 3 * f + 3 * f + (size_t)part->node_unknowns * f, &room);
    if (!made)
        return NULL;
    made->panel = room_take(&room, panels);
    made->force = room_take(&room, 3 * f);
    made->x = room_take(&room, 3 * f);
    made->right = (double *)room;
    return made;
}

/* alpha, beta and gamma, in lanes. */
struct coefficients {
    lane alpha, beta, gamma;
    int pulls; /* gamma is not 0 in all lanes: where it is, nothing is added to forces of 0 */
};

/* The penetrations of the last acceleration, after kernel_push_penetrations; NULL: no body pushes.
 */
static const struct penetrations *penetrations_of(const struct kernel_part *part) {
    return part->push ? &part->push->penetrations : NULL;
}

/* --- the matrix, and gamma K g --- */

/* Adds s B, symmetric, to the block of nodes row and column, row >= column: of a node's own what is
 * not above its diagonal. */
SPECIALISED void add_to(struct panel *panels, int row, int column, lane s, const struct block *b) {
    if (column < 2)
        return;
    struct panel *panel = &panels[column - 2];
    EACH (c, 0, 3)
        EACH (r, row == column ? c : 0, 3)
            panel->m[c][3 * (row - column) + r] += s * b->m[r][c];
}

/* A spring from node a to node b > a: (c alpha + k beta) nn' + s P, and its part of gamma K g. */
SPECIALISED void add_spring(struct kernel_part *part, const struct part_equation *e,
                            const struct coefficients *by, int transverse, int pulls, int a, int b,
                            struct vec n, lane rest, lane k, lane c) {
    struct kernel_panels *to = part->panels;
    lane sideways = lane_all(0);
    if (transverse) {
        const struct vec between = sub(place_of(part, e->q, b), place_of(part, e->q, a));
        const lane longer = k * (1 - rest / lane_sqrt(dot(between, between)));
        sideways = lane_select(longer > 0, longer, sideways);
    }
    const lane across = by->beta * sideways, along = by->alpha * c + by->beta * k - across;
    struct block B = block_outer(along, n, n);
    if (transverse)
        block_add_diagonal(&B, across);
    add_to(to->panel, b, b, lane_all(1), &B);
    add_to(to->panel, a, a, lane_all(1), &B);
    add_to(to->panel, b, a, lane_all(-1), &B);
    if (!pulls)
        return;
    const struct vec d = sub(free_node(part, e->g, b), free_node(part, e->g, a));
    const struct vec pull =
        scale(by->gamma, add_scaled(scale(sideways, d), (k - sideways) * dot(n, d), n));
    to->force[a] = add(to->force[a], pull);
    to->force[b] = sub(to->force[b], pull);
}

/* A direction's part across n, over a length: P x / L. */
SPECIALISED struct vec turned_by(const struct reach *r, struct vec x) {
    return scale(r->inverse, add_scaled(x, -dot(r->n, x), r->n));
}

/* A hinge at the middle one of three nodes. With edges a and b its stiffness is k G'G, where
 * G = (-P_a / L_a, P_b / L_b) takes the edges' velocities to the rate of the tangents' difference;
 * its damping is c gg' with g the angle's gradient, or where there is no angle c G'G. */
SPECIALISED void add_hinge(struct kernel_part *part, const struct part_equation *e,
                           const struct coefficients *by, int first, const struct reach *a,
                           const struct reach *b) {
    struct kernel_panels *to = part->panels;
    const struct turn turn = turn_between(a, b);
    const mask turned = turn.sine > 1e-12;
    const lane stiff = by->beta * part->bend_k, damp = by->alpha * part->bend_c;
    const lane turning = lane_select(turned, damp, lane_all(0)); /* of gg' */
    const lane bending = stiff + lane_select(turned, lane_all(0), damp);
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    const struct vec g[2] = {vec_select(turned, turn.along_a, none),
                             vec_select(turned, turn.along_b, none)};
    const struct reach *const edge[2] = {a, b};
    const lane gg[2][3] = {{g[0].x, g[0].y, g[0].z}, {g[1].x, g[1].y, g[1].z}};
    struct block E[2][2]; /* by edges */
    EACH (j, 0, 3) {
        const struct vec unit = {lane_all(j == 0), lane_all(j == 1), lane_all(j == 2)};
        EACH (y, 0, 2) {
            const struct vec rate = turned_by(edge[y], unit);
            EACH (x, 0, 2) {
                const struct vec column =
                    scale(x == y ? bending : -bending, turned_by(edge[x], rate));
                const lane c[3] = {column.x, column.y, column.z};
                EACH (i, 0, 3)
                    E[x][y].m[i][j] = c[i] + turning * gg[x][i] * gg[y][j];
            }
        }
    }
    /* edge a is node 1 - node 0, edge b node 2 - node 1 */
    const int p = first, q = first + 1, r = first + 2;
    const struct block transposed = block_transpose(&E[0][1]);
    add_to(to->panel, p, p, lane_all(1), &E[0][0]);
    add_to(to->panel, q, p, lane_all(-1), &E[0][0]);
    add_to(to->panel, q, p, lane_all(1), &transposed);
    add_to(to->panel, r, p, lane_all(-1), &transposed);
    add_to(to->panel, q, q, lane_all(1), &E[0][0]);
    add_to(to->panel, q, q, lane_all(1), &E[1][1]);
    add_to(to->panel, q, q, lane_all(-1), &E[0][1]);
    add_to(to->panel, q, q, lane_all(-1), &transposed);
    add_to(to->panel, r, q, lane_all(1), &transposed);
    add_to(to->panel, r, q, lane_all(-1), &E[1][1]);
    add_to(to->panel, r, r, lane_all(1), &E[1][1]);

    if (!by->pulls)
        return;
    const struct vec dp = free_node(part, e->g, p), dq = free_node(part, e->g, q),
                     dr = free_node(part, e->g, r);
    const struct vec difference =
        scale(by->gamma * part->bend_k, sub(turned_by(b, sub(dr, dq)), turned_by(a, sub(dq, dp))));
    const struct vec on_a = turned_by(a, difference), on_b = turned_by(b, difference);
    to->force[p] = sub(to->force[p], on_a);
    to->force[q] = add(to->force[q], add(on_a, on_b));
    to->force[r] = sub(to->force[r], on_b);
}

/* `transverse` and `pulls` are constants where this is inlined. */
SPECIALISED void walk(struct kernel_part *part, const struct part_equation *e,
                      const struct coefficients *by, int transverse, int pulls) {
    struct kernel_panels *to = part->panels;
    const size_t f = (size_t)free_nodes(part);
    memset(to->panel, 0, f * sizeof *to->panel);
    memset(to->force, 0, (f + 2) * sizeof *to->force);
    struct reach before = {part->tangent, part->spacing, 1 / part->spacing, part->v[0]};
    for (int i = 2; i < part->nodes; i++) {
        const struct reach segment = {part->t[i - 1], part->spacing, part->inverse_length[i],
                                      part->v[0]};
        add_spring(part, e, by, transverse, pulls, i - 1, i, segment.n, part->spacing,
                   part->stretch_k, part->stretch_c);
        if (part->bending == BENDING_SKIP)
            add_spring(part, e, by, transverse, pulls, i - 2, i, part->chord[i], part->skip_length,
                       part->bend_k, part->bend_c);
        if (part->bending == BENDING_HINGE)
            add_hinge(part, e, by, i - 2, &before, &segment);
        before = segment;
    }
}

/* What bodies do to the nodes that they hold. */
static void add_pushes(struct kernel_part *part, const struct part_equation *e,
                       const struct coefficients *by) {
    struct kernel_panels *to = part->panels;
    const lane zero = lane_all(0);
    for (int i = 0; i < free_nodes(part) && part->push; i++) {
        const struct penetration *penetrations = penetrating_node(part, penetrations_of(part), i);
        if (!penetrations)
            continue;
        const mask inside = penetrations->inside != 0;
        const struct block T = penetration_matrix(penetrations, by->alpha, by->beta);
        lane(*own)[PANEL_ROWS] = to->panel[i].m;
        EACH (c, 0, 3)
            EACH (r, c, 3)
                own[c][r] =
                    lane_select(inside, own[c][r] + part->mass[i + 2] * T.m[r][c], own[c][r]);
        if (by->pulls)
            to->force[i + 2] =
                penetrating_node_times(part, penetrations, i + 2, zero, -by->gamma,
                                       free_node(part, e->g, i + 2), to->force[i + 2]);
    }
}

static void add_springs(struct kernel_part *part, const struct part_equation *e,
                        const struct coefficients *by) {
    const int transverse = e->part == FORCES_SPD;
    if (transverse && by->pulls)
        walk(part, e, by, 1, 1);
    else if (transverse)
        walk(part, e, by, 1, 0);
    else if (by->pulls)
        walk(part, e, by, 0, 1);
    else
        walk(part, e, by, 0, 0);
}

/* M r + gamma K g, into `right` for the samples and `x` for the nodes. */
static void right_side(struct kernel_part *part, const struct part_equation *e,
                       const struct coefficients *by) {
    struct kernel_panels *to = part->panels;
    const int stride = part->node_unknowns * LANES, samples = part->node_unknowns - 3;
    const lane zero = lane_all(0), one = lane_all(1);
    double pull[(3 + 3 * SAMPLES_MAX) * LANES];
    for (int i = 0; i < free_nodes(part); i++) {
        const double *r = e->r + i * stride, *g = e->g + i * stride;
        double *b = to->right + i * stride;
        struct vec on = add_scaled(to->force[i + 2], part->mass[i + 2], vec_load(r, 0));
        if (part->samples > 0) {
            const struct frame *frame = &part->frames[i + 2];
            on = add(on, samples_times(part, frame, i + 2, one, zero, zero, r, b));
            if (by->pulls) { /* and in lanes without, to the bit as if there were none */
                const mask pulled = by->gamma != 0;
                const struct penetration *penetrations =
                    penetrating_node(part, penetrations_of(part), i);
                struct vec more =
                    samples_times(part, frame, i + 2, zero, zero, -by->gamma, g, pull);
                if (penetrations)
                    more = penetrating_times(part, frame, penetrations, i + 2, zero, -by->gamma, g,
                                             pull, more);
                on = vec_select(pulled, add(on, more), on);
                for (int s = 3; s < 3 + samples; s++)
                    store(b, s, lane_select(pulled, load(b, s) + load(pull, s), load(b, s)));
            }
        }
        put_node(to->x, i, on);
    }
}

/* --- elimination --- */

static mask factor(struct kernel_part *part, const struct elimination *samples) {
    struct panel *panels = part->panels->panel;
    mask positive = lane_all(0) == 0;
    struct pending_update pending = no_pending_update();
    for (int i = 0; i < free_nodes(part); i++) {
        struct panel ld = panels[i];
        add_samples(part, part->frames, samples, penetrations_of(part), i, &ld);
        positive &= factor_panel(&ld, &pending, &panels[i]);
    }
    return positive;
}

int LANED(kernel_solve_full)(struct kernel_part *part, const struct part_equation *e, double *x) {
    const lane gamma = load(e->gamma, 0);
    const struct coefficients by = {load(e->alpha, 0), load(e->beta, 0), gamma,
                                    !mask_none(gamma != 0)};
    const struct elimination samples = eliminate(part, by.alpha, by.beta);
    if (!part->panels)
        part->panels = create(part);
    if (!part->panels)
        return system_fail(part->system, -OUT_OF_MEMORY, "no memory for the matrix");
    struct kernel_panels *panels = part->panels;
    if (part->push)
        LANED(kernel_push_penetrations)(part, e->q);
    add_springs(part, e, &by);
    add_pushes(part, e, &by);
    if (!mask_all(factor(part, &samples)))
        return refuse_matrix(part);
    right_side(part, e, &by);
    solve_all(part, part->frames, &samples, penetrations_of(part), panels->panel, panels->right,
              panels->x, x);
    return 0;
}
