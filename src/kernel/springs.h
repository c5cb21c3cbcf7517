/* Springs of the skeleton: their forces on all nodes, in one walk from the root to the tip. */
#ifndef WISPLAB_KERNEL_SPRINGS_H
#define WISPLAB_KERNEL_SPRINGS_H

#include "arc.h"
#include "part.h"

/* Two nodes as a spring sees them. */
struct reach {
    struct vec n;         /* unit vector from a to b */
    lane length, inverse; /* m, 1/m */
    struct vec velocity;  /* of b relative to a */
};

/* The segment between the two nodes that follow the head. */
static inline struct reach first_segment(const struct kernel_part *part) {
    return (struct reach){part->tangent, part->spacing, 1 / part->spacing,
                          sub(part->v[1], part->v[0])};
}

/* `*sound` loses the lanes in which the nodes coincide, or are no numbers. */
SPECIALISED struct reach reach(struct vec pa, struct vec pb, struct vec va, struct vec vb,
                               mask *sound) {
    const struct vec d = sub(pb, pa);
    const lane square = dot(d, d), length = lane_sqrt(square);
    *sound &= square > 0;
    const lane inverse = 1 / length;
    return (struct reach){scale(inverse, d), length, inverse, sub(vb, va)};
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
    turn.angle = arc(turn.sine, cosine);
    /* d cos = (b - cos a).d e_a / L_a + (a - cos b).d e_b / L_b for edges e, and d angle is
     * -d cos / sin. */
    const lane factor = -1 / turn.sine;
    turn.along_a = scale(factor * a->inverse, add_scaled(b->n, -cosine, a->n));
    turn.along_b = scale(factor * b->inverse, add_scaled(a->n, -cosine, b->n));
    return turn;
}

/* Rate of a unit tangent: the part of the relative velocity across it, over the length. */
static inline struct vec tangent_rate(const struct reach *r) {
    return scale(r->inverse, add_scaled(r->velocity, -dot(r->velocity, r->n), r->n));
}

/* A hinge's forces along its two edges: the first node has -on_a, the last +on_b, the middle one
 * the rest. */
struct hinge {
    struct vec on_a, on_b;
};

/* Damping where the wisp is straight (or folded) and the angle's gradient has no direction: that of
 * the tangents' difference, which the angle's rate becomes there. */
SPECIALISED struct hinge straight_hinge(const struct reach *a, const struct reach *b, lane c) {
    const struct vec difference = sub(tangent_rate(b), tangent_rate(a));
    return (struct hinge){
        scale(c * a->inverse, add_scaled(difference, -dot(difference, a->n), a->n)),
        scale(-c * b->inverse, add_scaled(difference, -dot(difference, b->n), b->n))};
}

/* Elastic moment kappa angle and damping, along the angle's gradient. */
SPECIALISED struct hinge hinge(const struct reach *a, const struct reach *b, lane k, lane c) {
    const struct turn turn = turn_between(a, b);
    const lane rate = dot(turn.along_a, a->velocity) + dot(turn.along_b, b->velocity);
    const lane moment = -(k * turn.angle + c * rate);
    const struct hinge bent = {scale(moment, turn.along_a), scale(moment, turn.along_b)};
    const mask turned = turn.sine > 1e-12;
    if (mask_all(turned))
        return bent;
    const struct hinge straight = straight_hinge(a, b, c);
    return (struct hinge){vec_select(turned, bent.on_a, straight.on_a),
                          vec_select(turned, bent.on_b, straight.on_b)};
}

/* How an edge changes, and how its velocity does. */
struct edge_rate {
    struct vec place, velocity;
};

/* How a hinge's forces change with its two edges. */
struct hinge LANED(kernel_hinge_rate)(const struct kernel_part *part, const struct reach *a,
                                      const struct reach *b, const struct edge_rate rates[2]);

#endif
