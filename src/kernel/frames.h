/* Frames along a wisp by least rotation (Plante 1999, section 4.1.2 and appendix B): the normal u
 * is carried from node to node with the least turn that keeps it in the plane of the envelope. */
#ifndef WISPLAB_KERNEL_FRAMES_H
#define WISPLAB_KERNEL_FRAMES_H

#include "part.h"

/* Plane normal between two segments: the unit bisector of their tangents, or the last one where
 * the wisp is folded back on itself. */
static inline struct vec bisector(struct vec before, struct vec after, struct vec last) {
    const struct vec sum = add(before, after);
    const lane length = lane_sqrt(dot(sum, sum));
    return vec_select(length > 1e-9, scale(1 / length, sum), last);
}

/* The least rotation that takes w_before to w takes u_before to this. */
static inline struct vec transport(struct vec u_before, struct vec w_before, struct vec w) {
    const struct vec sum = add(w_before, w);
    const lane denominator = 1 + dot(w_before, w);
    const lane factor = -dot(u_before, w) / denominator;
    return vec_select(denominator > 1e-9, add_scaled(u_before, factor, sum), u_before);
}

/* The frame of free node i from that of node i - 1 and the tangents. */
static inline struct frame next_frame(const struct kernel_part *part, int i,
                                      const struct frame *before) {
    struct frame frame;
    frame.w =
        i == part->nodes - 1 ? part->t[i - 1] : bisector(part->t[i - 1], part->t[i], before->w);
    frame.u = transport(before->u, before->w, frame.w);
    frame.v = cross(frame.w, frame.u);
    return frame;
}

/* The frame of nodes 0 and 1. */
static inline struct frame first_frame(const struct kernel_part *part) {
    return (struct frame){part->normal, cross(part->tangent, part->normal), part->tangent};
}

#endif
