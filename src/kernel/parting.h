/* The parting of a style field, B(t) tanh(d / width) by the distance d from a plane: what of the
 * accelerations and of their derivatives depends on where a node is. A sample has its node's. */
#ifndef WISPLAB_KERNEL_PARTING_H
#define WISPLAB_KERNEL_PARTING_H

#include "part.h"

static inline int has_parting(const struct kernel_part *part) {
    return part->surroundings->style.parting.width > 0;
}

static inline struct vec parting_normal(const struct kernel_part *part) {
    return vec_all(part->surroundings->style.parting.normal);
}

/* B, in each lane at its own time. */
static inline struct vec parting_strength(const struct kernel_part *part, double t) {
    const double *times = part->system->times;
    struct vec strength = {lane_all(0), lane_all(0), lane_all(0)};
    for (int k = 0; k < LANES; k++) {
        double b[3];
        style_parting(&part->surroundings->style, times ? times[k] : t, b);
        vec_set(&strength, k, b);
    }
    return strength;
}

/* tanh(d / width) at a place from the origin of the unknowns. The library has it for one number: so
 * the bits do not depend on the packing. */
static inline lane parting_side(const struct kernel_part *part, struct vec place) {
    const struct parting *parting = &part->surroundings->style.parting;
    const struct vec from = sub(in_space(part, place), vec_all(parting->origin));
    lane side = dot(from, parting_normal(part)) / parting->width;
    for (int k = 0; k < LANES; k++)
        lane_set(&side, k, tanh(lane_get(side, k)));
    return side;
}

#endif
