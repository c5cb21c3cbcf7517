/* Springs of the skeleton: their forces on all nodes, in one walk from the root to the tip. */
#ifndef WISPLAB_KERNEL_SPRINGS_H
#define WISPLAB_KERNEL_SPRINGS_H

#include "part.h"

/* Two nodes as a spring sees them. */
struct reach {
    struct vec n; /* unit vector from a to b */
    lane length;
    struct vec velocity; /* of b relative to a */
};

/* `*sound` loses the lanes in which the nodes coincide, or are no numbers. */
static inline struct reach reach(struct vec pa, struct vec pb, struct vec va, struct vec vb,
                                 mask *sound) {
    const struct vec d = sub(pb, pa);
    const lane square = dot(d, d), length = lane_sqrt(square);
    *sound &= square > 0;
    return (struct reach){scale(1 / length, d), length, sub(vb, va)};
}

/* What a spring-damper puts on a; b has the opposite. */
static inline struct vec spring(const struct reach *r, lane rest, lane k, lane c) {
    return scale(k * (r->length - rest) + c * dot(r->velocity, r->n), r->n);
}

/* The turning angle at a node between segments a and b, and what the hinge there needs of it. */
struct turn {
    lane angle, sine;
    struct vec along_a,
        along_b; /* d angle / d p: -along_a of the first node, along_b of the last */
};

/* cos = a.b, sin = |a x b|; the gradients: Bridson et al. 2003, doi:10.2312/SCA03/028-036 */
static inline struct turn turn_between(const struct reach *a, const struct reach *b) {
    struct turn turn;
    const struct vec axis = cross(a->n, b->n);
    const lane cosine = dot(a->n, b->n);
    turn.sine = lane_sqrt(dot(axis, axis));
    for (int k = 0; k < LANES; k++)
        lane_set(&turn.angle, k, atan2(lane_get(turn.sine, k), lane_get(cosine, k)));
    /* d cos = (b - cos a).d e_a / L_a + (a - cos b).d e_b / L_b for edges e, and d angle is
     * -d cos / sin. */
    turn.along_a = scale(-1 / (turn.sine * a->length), add_scaled(b->n, -cosine, a->n));
    turn.along_b = scale(-1 / (turn.sine * b->length), add_scaled(a->n, -cosine, b->n));
    return turn;
}

/* Rate of a unit tangent: the part of the relative velocity across it, over the length. */
static inline struct vec tangent_rate(const struct reach *r) {
    return scale(1 / r->length, add_scaled(r->velocity, -dot(r->velocity, r->n), r->n));
}

/* A hinge's forces along its two edges: the first node has -on_a, the last +on_b, the middle one
 * the rest. */
struct hinge {
    struct vec on_a, on_b;
};

/* Elastic moment kappa angle and damping, along the angle's gradient; where the wisp is straight
 * (or folded) the gradient has no direction, and the damping is that of the tangents' difference,
 * which the angle's rate becomes there. */
static inline struct hinge hinge(const struct reach *a, const struct reach *b, lane k, lane c) {
    const struct turn turn = turn_between(a, b);
    const lane rate = dot(turn.along_a, a->velocity) + dot(turn.along_b, b->velocity);
    const lane moment = -(k * turn.angle + c * rate);

    const struct vec difference = sub(tangent_rate(b), tangent_rate(a));
    const struct vec straight_a =
        scale(c / a->length, add_scaled(difference, -dot(difference, a->n), a->n));
    const struct vec straight_b =
        scale(-c / b->length, add_scaled(difference, -dot(difference, b->n), b->n));

    const mask turned = turn.sine > 1e-12;
    return (struct hinge){vec_select(turned, scale(moment, turn.along_a), straight_a),
                          vec_select(turned, scale(moment, turn.along_b), straight_b)};
}

#endif
