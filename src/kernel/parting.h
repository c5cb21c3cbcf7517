/* The parting of a style field, B(t) tanh(d / width) by the distance d from a plane: what of the
 * accelerations and of their derivatives depends on where a node is. A sample has its node's. */
#ifndef WISPLAB_KERNEL_PARTING_H
#define WISPLAB_KERNEL_PARTING_H

#include "part.h"

static inline int has_parting(const struct kernel_part *part) {
    return part->surroundings->style.parting.width > 0;
}

static inline struct vec parting_normal(const struct kernel_part *part) {
    const double *n = part->surroundings->style.parting.normal;
    return (struct vec){lane_all(n[0]), lane_all(n[1]), lane_all(n[2])};
}

/* B, in each lane at its own time. */
static inline struct vec parting_strength(const struct kernel_part *part, double t) {
    const double *times = part->system->times;
    struct vec strength = {lane_all(0), lane_all(0), lane_all(0)};
    for (int k = 0; k < LANES; k++) {
        double b[3];
        style_parting(&part->surroundings->style, times ? times[k] : t, b);
        lane_set(&strength.x, k, b[0]);
        lane_set(&strength.y, k, b[1]);
        lane_set(&strength.z, k, b[2]);
    }
    return strength;
}

/* tanh(d / width) at a place from the origin of the unknowns. The library has it for one number: so
 * the bits do not depend on the packing. */
static inline lane parting_side(const struct kernel_part *part, struct vec place) {
    const struct parting *parting = &part->surroundings->style.parting;
    const double *o = parting->origin;
    const struct vec origin = {lane_all(o[0]), lane_all(o[1]), lane_all(o[2])};
    lane side = dot(sub(in_space(part, place), origin), parting_normal(part)) / parting->width;
    for (int k = 0; k < LANES; k++)
        lane_set(&side, k, tanh(lane_get(side, k)));
    return side;
}

#endif
