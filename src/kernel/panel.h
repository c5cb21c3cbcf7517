/* The matrix of a wisp's nodes, its samples eliminated, by the columns of one node after the other:
 * what its direct solvers are made of. */
#ifndef WISPLAB_KERNEL_PANEL_H
#define WISPLAB_KERNEL_PANEL_H

#include "frames.h"
#include "matrix.h"
#include "penetrating.h"

/* --- samples --- */

/* See the table in matrix.h for M, C and S, from which A = M + alpha C + beta S. For evenly spread
 * half-lines sum aa' = M/2 (1 - ww'), which gives the node's gain. */
static inline struct elimination eliminate(const struct kernel_part *part, lane alpha, lane beta) {
    const lane half = lane_all(0.5 * part->samples), zero = lane_all(0);
    const lane h = alpha * part->spring_c + beta * part->spring_k;
    const lane air = alpha * part->drag, g = 1 + air;
    const lane inverse = 1 / (g + h);
    struct elimination e = {
        .inverse_along = inverse, .inverse_across = zero, .alpha = alpha, .beta = beta};
    lane gain; /* along each half-line, times aa' */
    switch (part->treatment) {
    case WISP_PROJECTION:
        gain = h * air * inverse;
        e.to_node_along = h * inverse;
        e.from_node_along = -air * inverse;
        e.to_node_across = e.from_node_across = zero;
        e.diagonal = half * gain;
        e.diagonal_ww = -half * gain;
        break;
    case WISP_GENERALISED:
        gain = -g * g * inverse;
        e.to_node_along = e.from_node_along = -g * inverse;
        e.to_node_across = e.from_node_across = zero;
        e.diagonal = 2 * half * g + half * gain;
        e.diagonal_ww = -half * gain;
        break;
    default: {
        const lane h_across = alpha * part->penalty_c + beta * part->penalty_k;
        const lane gain_across = h_across * g / (g + h_across);
        gain = h * g * inverse;
        e.inverse_across = 1 / (g + h_across);
        e.to_node_along = e.from_node_along = h * inverse;
        e.to_node_across = e.from_node_across = h_across / (g + h_across);
        e.diagonal = 2 * half * gain_across + half * (gain - gain_across);
        e.diagonal_ww = -half * (gain - gain_across);
    }
    }
    return e;
}

static inline void put_node(lane *y, int node, struct vec a) {
    y[3 * node] = a.x;
    y[3 * node + 1] = a.y;
    y[3 * node + 2] = a.z;
}

static inline void add_node(lane *y, int node, struct vec a) {
    y[3 * node] += a.x;
    y[3 * node + 1] += a.y;
    y[3 * node + 2] += a.z;
}

/* The rows of a node's samples, and what they add to the node's: y = (m M + d C + k S) x, but for
 * what bodies do. */
static inline struct vec samples_times(const struct kernel_part *part, const struct frame *frame,
                                       int i, lane m, lane d, lane k, const double *x, double *y) {
    const lane mu = part->sample_mass[i], h = d * part->spring_c + k * part->spring_k;
    const lane g = m + d * part->drag;
    const struct vec node = vec_load(x, 0);
    struct vec sum = {lane_all(0), lane_all(0), lane_all(0)};
    for (int j = 0; j < part->samples; j++) {
        const struct vec a = half_line(part, frame, j, part->samples);
        if (part->treatment == WISP_PENALTY) {
            const struct vec e = vec_load(x, 3 + 3 * j);
            const lane across = d * part->penalty_c + k * part->penalty_k;
            const struct vec pull = split(h, across, a, sub(e, node));
            vec_store(y, 3 + 3 * j, scale(mu, add_scaled(pull, g, e)));
            sum = sub(sum, scale(mu, pull));
            continue;
        }
        const lane r = load(x, 3 + j);
        const int coupled = part->treatment == WISP_GENERALISED;
        const lane to_sample = coupled ? g : d * part->drag, to_node = coupled ? g : -h;
        store(y, 3 + j, mu * (to_sample * dot(a, node) + (g + h) * r));
        sum = add_scaled(sum, mu * to_node * r, a);
        if (coupled)
            sum = add_scaled(sum, mu * g, node);
    }
    return sum;
}

/* --- factorisation --- */

/* Adds mass, drag and the samples of node i + 2: mu (diagonal + ww w w') + m (1 + alpha gamma), and
 * what bodies make of the samples. */
SPECIALISED void add_samples(const struct kernel_part *part, const struct frame *frames,
                             const struct elimination *e, const struct penetrations *penetrations,
                             int i, struct panel *panel) {
    lane diagonal = part->mass[i + 2] * (1 + e->alpha * part->drag);
    if (part->samples > 0) {
        const struct vec w = frames[i + 2].w;
        const lane mu = part->sample_mass[i + 2], ww[3] = {w.x, w.y, w.z};
        const lane factor = mu * e->diagonal_ww;
        diagonal += mu * e->diagonal;
        EACH (c, 0, 3)
            EACH (r, c, 3)
                panel->m[c][r] += factor * ww[r] * ww[c];
    }
    EACH (c, 0, 3)
        panel->m[c][c] += diagonal;
    add_penetrating(part, &frames[i + 2], e, penetrating_node(part, penetrations, i), i + 2, panel);
}

/* What factorised columns take off those of the two nodes after them. It stays in registers from
 * node to node: columns in memory would wait for their own last change. */
struct pending_update {
    lane next[3][6];  /* column c, row r >= c of the next node's panel */
    lane after[3][3]; /* the same of the one after it */
};

SPECIALISED struct pending_update no_pending_update(void) {
    struct pending_update pending;
    EACH (c, 0, 3) {
        EACH (r, 0, 6)
            pending.next[c][r] = lane_all(0);
        EACH (r, 0, 3)
            pending.after[c][r] = lane_all(0);
    }
    return pending;
}

SPECIALISED void apply_pending(struct panel *panel, struct pending_update *pending) {
    EACH (c, 0, 3)
        EACH (r, c, 6)
            panel->m[c][r] -= pending->next[c][r];
    EACH (c, 0, 3) {
        EACH (r, c, 3) {
            pending->next[c][r] = pending->after[c][r];
            pending->after[c][r] = lane_all(0);
        }
        EACH (r, 3, 6)
            pending->next[c][r] = lane_all(0);
    }
}

/* (L D)_rc L_sc, summed over the columns c of a panel, for a later node's rows r >= s from `from`.
 */
SPECIALISED void defer_update(const struct panel *l, const struct panel *ld,
                              struct pending_update *pending) {
    EACH (c, 0, 3)
        EACH (d, 0, 3) {
            EACH (r, d, 6)
                pending->next[d][r] += l->m[c][3 + d] * ld->m[c][3 + r];
            EACH (r, d, 3)
                pending->after[d][r] += l->m[c][6 + d] * ld->m[c][6 + r];
        }
}

/* Factorises a node's columns: from `ld`, of which nothing is taken off yet, into `to`, with 1 / D
 * on its diagonal. Returns the lanes in which D is positive. */
SPECIALISED mask factor_panel(struct panel *ld, struct pending_update *pending, struct panel *to) {
    struct panel l;
    mask positive = lane_all(0) == 0;
    apply_pending(ld, pending);
    EACH (c, 0, 3) {
        positive &= ld->m[c][c] > 0;
        const lane inverse = 1 / ld->m[c][c];
        EACH (r, c + 1, PANEL_ROWS)
            l.m[c][r] = ld->m[c][r] * inverse;
        EACH (d, c + 1, 3)
            EACH (r, d, PANEL_ROWS)
                ld->m[d][r] -= l.m[c][d] * ld->m[c][r];
        l.m[c][c] = inverse;
    }
    defer_update(&l, ld, pending);
    EACH (c, 0, 3)
        EACH (r, c, PANEL_ROWS)
            to->m[c][r] = l.m[c][r];
    return positive;
}

static inline int refuse_matrix(const struct kernel_part *part) {
    return system_fail(part->system, SOLVER_STALLED,
                       "the matrix of the implicit step is not positive definite");
}

/* --- solution --- */

/* L D L' x = b in place, a window of three nodes at a time. */
static inline void solve_nodes(const struct panel *panels, int nodes, lane *x) {
    lane window[PANEL_ROWS];
    EACH (r, 0, 6)
        window[r] = x[r];
    for (int i = 0; i < nodes; i++) {
        const struct panel *p = &panels[i];
        EACH (r, 6, PANEL_ROWS)
            window[r] = x[3 * i + r];
        EACH (c, 0, 3)
            EACH (r, c + 1, PANEL_ROWS)
                window[r] -= p->m[c][r] * window[c];
        EACH (c, 0, 3)
            x[3 * i + c] = window[c] * p->m[c][c];
        EACH (r, 0, 6)
            window[r] = window[r + 3];
    }
    EACH (r, 3, PANEL_ROWS)
        window[r] = lane_all(0);
    for (int i = nodes - 1; i >= 0; i--) {
        const struct panel *p = &panels[i];
        EACH_DOWN (c, 2, 0) {
            lane sum = x[3 * i + c];
            EACH_DOWN (r, PANEL_ROWS - 1, c + 1)
                sum -= p->m[c][r] * window[r];
            x[3 * i + c] = window[c] = sum;
        }
        EACH_DOWN (r, PANEL_ROWS - 1, 3)
            window[r] = window[r - 3];
    }
}

/* What the samples' right sides add to their node's; `penetrations` are the node's, or NULL. */
static inline struct vec gather_samples(const struct kernel_part *part, const struct elimination *e,
                                        const struct frame *frame,
                                        const struct penetration *penetrations, const double *b) {
    struct vec sum = {lane_all(0), lane_all(0), lane_all(0)};
    for (int j = 0; j < part->samples; j++) {
        const struct vec a = half_line(part, frame, j, part->samples), before = sum;
        sum = part->treatment == WISP_PENALTY
                  ? add(sum, split(e->to_node_along, e->to_node_across, a, vec_load(b, 3 + 3 * j)))
                  : add_scaled(sum, e->to_node_along * load(b, 3 + j), a);
        if (is_penetrating(penetrations, j))
            sum = vec_select(
                penetrations[1 + j].inside != 0,
                add(before, penetrating_to_node(part, e, &penetrations[1 + j], j, a, b)), sum);
    }
    return sum;
}

/* The samples' solutions from their right sides and their node's solution. */
static inline void scatter_samples(const struct kernel_part *part, const struct elimination *e,
                                   const struct frame *frame,
                                   const struct penetration *penetrations, int i, const double *b,
                                   struct vec node, double *x) {
    const lane inverse_mass = 1 / part->sample_mass[i];
    for (int j = 0; j < part->samples; j++) {
        const struct vec a = half_line(part, frame, j, part->samples);
        if (part->treatment == WISP_PENALTY) {
            const struct vec own =
                split(e->inverse_along * inverse_mass, e->inverse_across * inverse_mass, a,
                      vec_load(b, 3 + 3 * j));
            vec_store(x, 3 + 3 * j,
                      add(own, split(e->from_node_along, e->from_node_across, a, node)));
        } else {
            store(x, 3 + j,
                  e->inverse_along * inverse_mass * load(b, 3 + j) +
                      e->from_node_along * dot(a, node));
        }
        if (is_penetrating(penetrations, j))
            penetrating_solution(part, e, &penetrations[1 + j], j, a, inverse_mass, b, node, x);
    }
}

/* All unknowns, from the right side b of all; `nodes` is that of the nodes, whose part in b does
 * not count, and has two more. */
static inline void solve_all(const struct kernel_part *part, const struct frame *frames,
                             const struct elimination *e, const struct penetrations *penetrations,
                             const struct panel *panels, const double *b, lane *nodes, double *x) {
    const int f = free_nodes(part), stride = part->node_unknowns * LANES;
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    for (int i = 0; i < f && part->samples > 0; i++)
        add_node(nodes, i,
                 gather_samples(part, e, &frames[i + 2], penetrating_node(part, penetrations, i),
                                b + i * stride));
    for (int i = f; i < f + 2; i++) /* the window reaches two nodes beyond the tip */
        put_node(nodes, i, none);
    solve_nodes(panels, f, nodes);
    for (int i = 0; i < f; i++) {
        const struct vec node = {nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]};
        vec_store(x + i * stride, 0, node);
        if (part->samples > 0)
            scatter_samples(part, e, &frames[i + 2], penetrating_node(part, penetrations, i), i + 2,
                            b + i * stride, node, x + i * stride);
    }
}

#endif
