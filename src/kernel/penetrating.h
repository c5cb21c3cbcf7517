/* Samples inside bodies: what is different with them in products, and when they are eliminated.
 *
 * With T = alpha D + beta E of the bodies over the sample's mass, D and E of struct penetration,
 * and g, h of the table in matrix.h, the blocks of a node and one of its samples are
 *
 *                   node-node   node-sample   sample-node         sample-sample
 *   projection      -           -h a          alpha gamma a' + a'T   g + h + a'Ta
 *   generalised     g + T       (g + T) a     a'(g + T)           a'(g + T) a + h
 *   penalty         H           -H            -H                  g + H + T,     H = h aa' + h_p P
 *
 * In `projection`, to be factorised, T is of the part along the line: T = aa'T aa'. */
#ifndef WISPLAB_KERNEL_PENETRATING_H
#define WISPLAB_KERNEL_PENETRATING_H

#include "matrix.h"

/* s_along times the part of x along a, s_across times the rest. */
static inline struct vec split(lane s_along, lane s_across, struct vec a, struct vec x) {
    return add_scaled(scale(s_across, x), (s_along - s_across) * dot(a, x), a);
}

/* Whether some lane's sample j is inside a body; `penetrations` are the node's, or NULL. */
static inline int is_penetrating(const struct penetration *penetrations, int j) {
    return penetrations && !mask_none(penetrations[1 + j].inside != 0);
}

/* --- one sample eliminated --- */

struct eliminated {
    struct block gain;   /* of the node's matrix, over mu */
    struct vec to, from; /* of a distance: adds to b to the node; = b inverse / mu + from.x */
    lane inverse;
    struct block solution; /* of a particle: = solution b / mu + to_node' x, */
    struct block to_node;  /* which adds to_node b to the node */
};

/* The inverse of a symmetric block, by its adjugate. */
static inline struct block symmetric_inverse(const struct block *a) {
    struct block c;
    EACH (i, 0, 3)
        EACH (j, i, 3) {
            const int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
            c.m[i][j] = c.m[j][i] = a->m[r][p] * a->m[s][q] - a->m[r][q] * a->m[s][p];
        }
    const lane determinant =
        a->m[0][0] * c.m[0][0] + a->m[0][1] * c.m[1][0] + a->m[0][2] * c.m[2][0];
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            c.m[i][j] = c.m[i][j] / determinant;
    return c;
}

static inline struct eliminated eliminate_sample(const struct kernel_part *part,
                                                 const struct elimination *e, const struct block *T,
                                                 struct vec a) {
    struct eliminated s = {0};
    const lane air = e->alpha * part->drag, g = 1 + air;
    const lane h = e->alpha * part->spring_c + e->beta * part->spring_k;
    const struct vec Ta = block_times(T, a);
    if (part->treatment == WISP_PROJECTION) {
        const lane along = air + dot(a, Ta);
        s.inverse = 1 / (1 + h + along);
        s.to = scale(h * s.inverse, a);
        s.from = scale(-along * s.inverse, a);
        s.gain = block_outer(h * along * s.inverse, a, a);
    } else if (part->treatment == WISP_GENERALISED) {
        const struct vec c = add_scaled(Ta, g, a);
        s.inverse = 1 / (g + h + dot(a, Ta));
        s.to = s.from = scale(-s.inverse, c);
        s.gain = block_outer(-s.inverse, c, c);
        block_add(&s.gain, T);
        block_add_diagonal(&s.gain, g);
    } else { /* H - H A^-1 H = H A^-1 (g + T), where nothing cancels */
        const lane across = e->alpha * part->penalty_c + e->beta * part->penalty_k;
        struct block H = block_outer(h - across, a, a), own = *T;
        block_add_diagonal(&H, across);
        block_add_diagonal(&own, g);
        struct block A = H;
        block_add(&A, &own);
        s.solution = symmetric_inverse(&A);
        s.to_node = block_product(&H, &s.solution);
        s.gain = block_product(&s.to_node, &own);
    }
    return s;
}

static inline struct eliminated eliminate_penetrating(const struct kernel_part *part,
                                                      const struct elimination *e,
                                                      const struct penetration *penetration,
                                                      struct vec a) {
    const struct block T = penetration_matrix(penetration, e->alpha, e->beta);
    return eliminate_sample(part, e, &T, a);
}

/* --- for panel.h --- */

/* What penetrating samples make of their node's own block: the difference of what they are with
 * bodies and without, which in lanes without is nothing to the bit. */
static inline void add_penetrating(const struct kernel_part *part, const struct frame *frame,
                                   const struct elimination *e,
                                   const struct penetration *penetrations, int i,
                                   struct panel *panel) {
    const struct block none = {0};
    for (int j = 0; j < part->samples; j++) {
        if (!is_penetrating(penetrations, j))
            continue;
        const mask inside = penetrations[1 + j].inside != 0;
        const struct vec a = half_line(part, frame, j, part->samples);
        const struct eliminated with = eliminate_penetrating(part, e, &penetrations[1 + j], a);
        const struct eliminated without = eliminate_sample(part, e, &none, a);
        EACH (c, 0, 3)
            EACH (r, c, 3) {
                const lane more = with.gain.m[r][c] - without.gain.m[r][c];
                panel->m[c][r] = lane_select(inside, panel->m[c][r] + part->sample_mass[i] * more,
                                             panel->m[c][r]);
            }
    }
}

/* What the right side of sample j adds to its node's. */
static inline struct vec penetrating_to_node(const struct kernel_part *part,
                                             const struct elimination *e,
                                             const struct penetration *penetration, int j,
                                             struct vec a, const double *b) {
    const struct eliminated s = eliminate_penetrating(part, e, penetration, a);
    return part->treatment == WISP_PENALTY ? block_times(&s.to_node, vec_load(b, 3 + 3 * j))
                                           : scale(load(b, 3 + j), s.to);
}

/* The solution of sample j, in the lanes in which it is inside. */
static inline void penetrating_solution(const struct kernel_part *part, const struct elimination *e,
                                        const struct penetration *penetration, int j, struct vec a,
                                        lane inverse_mass, const double *b, struct vec node,
                                        double *x) {
    const mask inside = penetration->inside != 0;
    const struct eliminated s = eliminate_penetrating(part, e, penetration, a);
    if (part->treatment == WISP_PENALTY) {
        const struct vec own =
            scale(inverse_mass, block_times(&s.solution, vec_load(b, 3 + 3 * j)));
        const struct vec all = add(own, transposed_times(&s.to_node, node));
        vec_store(x, 3 + 3 * j, vec_select(inside, all, vec_load(x, 3 + 3 * j)));
        return;
    }
    const lane all = s.inverse * inverse_mass * load(b, 3 + j) + dot(s.from, node);
    store(x, 3 + j, lane_select(inside, all, load(x, 3 + j)));
}

/* --- products --- */

/* Adds what bodies do to a node's samples to the samples' rows, and to the node's: d C + k S, times
 * x. Returns the node's. */
static inline struct vec penetrating_times(const struct kernel_part *part,
                                           const struct frame *frame,
                                           const struct penetration *penetrations, int i, lane d,
                                           lane k, const double *x, double *y, struct vec on_node) {
    for (int j = 0; j < part->samples; j++) {
        if (!is_penetrating(penetrations, j))
            continue;
        const mask inside = penetrations[1 + j].inside != 0;
        const struct block T = penetration_matrix(&penetrations[1 + j], d, k);
        const lane mu = part->sample_mass[i];
        if (part->treatment == WISP_PENALTY) {
            const struct vec own = vec_load(y, 3 + 3 * j);
            const struct vec more = scale(mu, block_times(&T, vec_load(x, 3 + 3 * j)));
            vec_store(y, 3 + 3 * j, vec_select(inside, add(own, more), own));
            continue;
        }
        const struct vec a = half_line(part, frame, j, part->samples);
        const struct vec moved = add_scaled(vec_load(x, 0), load(x, 3 + j), a);
        const struct vec more = scale(mu, block_times(&T, moved));
        store(y, 3 + j, lane_select(inside, load(y, 3 + j) + dot(a, more), load(y, 3 + j)));
        if (part->treatment == WISP_GENERALISED)
            on_node = vec_select(inside, add(on_node, more), on_node);
    }
    return on_node;
}

/* Adds what bodies do to the node itself. */
static inline struct vec penetrating_node_times(const struct kernel_part *part,
                                                const struct penetration *penetrations, int i,
                                                lane d, lane k, struct vec x, struct vec on_node) {
    const struct block T = penetration_matrix(&penetrations[0], d, k);
    const struct vec more = scale(part->mass[i], block_times(&T, x));
    return vec_select(penetrations[0].inside != 0, add(on_node, more), on_node);
}

#endif
