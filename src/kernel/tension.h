/* Tensions along the segments of a wisp: what they do to its nodes, and the tridiagonal systems
 * that they come from. Row i is of the segment (i - 1, i), i >= 2: it shares a node with those of
 * the segments before and after it.
 *
 * M^-1 takes a force on a node to its acceleration: 1/m. In `generalised` the samples' equation
 * mu (a.x_node + x_sample) = mu (a.r_node + r_sample) says that a sample's rate changes by -a.
 * times what its node's does, and with that put into the node's equation its mass is that of
 * (m + mu M) 1 - mu sum aa' = m + mu M/2 across w, m + mu M along it. In the other treatments M
 * does not couple them, and the samples keep r. */
#ifndef WISPLAB_KERNEL_TENSION_H
#define WISPLAB_KERNEL_TENSION_H

#include "frames.h"
#include "part.h"

/* Whether M couples the nodes with their samples. */
static inline int is_coupled(const struct kernel_part *part) {
    return part->samples > 0 && part->treatment == WISP_GENERALISED;
}

/* The acceleration of node i by a force. */
SPECIALISED struct vec moved(const struct kernel_part *part, int i, int coupled, struct vec force) {
    if (!coupled)
        return scale(part->inverse_mass[i], force);
    const lane across = part->inverse_across[i], along = part->inverse_along[i];
    const struct vec w = part->frames[i].w;
    return add_scaled(scale(across, force), (along - across) * dot(w, force), w);
}

/* The vector of a free node; 0 of the others, which the head moves. */
SPECIALISED struct vec free_node(const struct kernel_part *part, const double *x, int i) {
    if (i < 2)
        return (struct vec){lane_all(0), lane_all(0), lane_all(0)};
    return vec_load(x, (i - 2) * part->node_unknowns);
}

/* x of a node from r, and of its samples, by the force on it; x may be r. */
SPECIALISED void move(const struct kernel_part *part, int i, int coupled, struct vec force,
                      const double *r, double *x) {
    const int at = (i - 2) * part->node_unknowns;
    const struct vec change = moved(part, i, coupled, force);
    vec_store(x, at, add(vec_load(r, at), change));
    if (!coupled) {
        for (int u = 3; u < part->node_unknowns && x != r; u++)
            store(x, at + u, load(r, at + u));
        return;
    }
    const lane on_u = dot(change, part->frames[i].u), on_v = dot(change, part->frames[i].v);
    for (int j = 0; j < part->samples; j++)
        store(x, at + 3 + j, load(r, at + 3 + j) - along(part, j, part->samples, on_u, on_v));
}

/* Elimination of a tridiagonal system from the root to the tip: of the row before. */
struct sweep {
    lane right, pivot; /* right side and 1 / D */
};

/* The next row: what it has on its diagonal, what it has of the unknown before (`below`), what the
 * row before has of it (`above`); those are equal in a symmetric system. Leaves what
 * sweep_back needs. */
SPECIALISED void sweep_row(struct sweep *s, lane diagonal, lane below, lane above, lane right,
                           lane *upper, lane *solution) {
    const lane lower = below * s->pivot;
    *upper = above * s->pivot;
    right -= lower * s->right;
    s->pivot = 1 / (diagonal - below * *upper);
    s->right = right;
    *solution = right * s->pivot;
}

/* The rows of N M^-1 N' + softness, where row i of N takes the nodes' velocities to the rate of
 * the segment's length, from the root to the tip. */
struct rows {
    struct sweep sweep;
    struct vec by_last; /* acceleration of node i - 1 by a unit tension in the segment before */
};

SPECIALISED struct rows first_row(void) {
    const lane zero = lane_all(0);
    return (struct rows){{zero, zero}, {zero, zero, zero}};
}

SPECIALISED void next_row(const struct kernel_part *part, struct rows *rows, int i, int coupled,
                          lane softness, lane right, lane *upper, lane *solution) {
    const struct vec n = part->t[i - 1], by = moved(part, i, coupled, n);
    lane diagonal = softness + dot(n, by);
    if (i > 2)
        diagonal += dot(n, moved(part, i - 1, coupled, n));
    const lane beside = -dot(n, rows->by_last);
    sweep_row(&rows->sweep, diagonal, beside, beside, right, upper, solution);
    rows->by_last = by;
}

#endif
