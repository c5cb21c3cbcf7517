/* Boxes around the wisps of a part. */
#ifndef WISPLAB_KERNEL_SPAN_H
#define WISPLAB_KERNEL_SPAN_H

#include "part.h"

/* The box around the free nodes of each wisp. */
struct span {
    struct vec low, high;
};

static inline struct vec least(struct vec a, struct vec b) {
    return (struct vec){lane_min(a.x, b.x), lane_min(a.y, b.y), lane_min(a.z, b.z)};
}

static inline struct vec most(struct vec a, struct vec b) {
    return (struct vec){lane_max(a.x, b.x), lane_max(a.y, b.y), lane_max(a.z, b.z)};
}

static inline struct span span_from_origin(const struct kernel_part *part, const double *q) {
    struct span span = {vec_load(q, 0), vec_load(q, 0)};
    for (int i = 3; i < part->nodes; i++) {
        const struct vec p = vec_load(q, (i - 2) * part->node_unknowns);
        span = (struct span){least(p, span.low), most(p, span.high)};
    }
    return span;
}

/* In space. */
static inline struct span span_of(const struct kernel_part *part, const double *q) {
    const struct span span = span_from_origin(part, q);
    return (struct span){in_space(part, span.low), in_space(part, span.high)};
}

#endif
