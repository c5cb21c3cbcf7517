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

/* The frame of nodes 0 and 1. */
static inline struct frame first_frame(const struct kernel_part *part) {
    return (struct frame){part->normal, cross(part->tangent, part->normal), part->tangent};
}

/* The plane normals w of all nodes from the tangents, into `frames`; and for each free node what
 * the least rotation from w_(i-1) to w_i adds to a normal u for each unit of u.w_i:
 * -(w_(i-1) + w_i) over 1 + w_(i-1).w_i, nothing where that vanishes. This much does not wait for
 * the last node's u, so that square roots and divisions of all nodes overlap. */
static inline void plane_normals(struct kernel_part *part, struct frame *frames) {
    frames[0] = frames[1] = first_frame(part);
    struct vec last = part->tangent;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec w =
            i == part->nodes - 1 ? part->t[i - 1] : bisector(part->t[i - 1], part->t[i], last);
        const lane denominator = 1 + dot(last, w);
        const lane factor = lane_select(denominator > 1e-9, -1 / denominator, lane_all(0));
        part->swing[i] = scale(factor, add(last, w));
        frames[i].w = last = w;
    }
}

/* u and v of node i from u of node i - 1, after plane_normals. */
static inline void carry_frame(const struct kernel_part *part, struct frame *frames, int i) {
    struct frame *frame = &frames[i];
    const struct vec u = frames[i - 1].u;
    frame->u = add_scaled(u, dot(u, frame->w), part->swing[i]);
    frame->v = cross(frame->w, frame->u);
}

/* Sample j of `samples` lies along cos u + sin v; with four of them that is u, v, -u, -v, which
 * needs no multiplication where `samples` is known to the compiler. */

/* Component along the half-line of a vector whose components along u and v are given. */
SPECIALISED lane along(const struct kernel_part *part, int j, int samples, lane on_u, lane on_v) {
    if (samples == 4)
        return j == 0 ? on_u : j == 1 ? on_v : j == 2 ? -on_u : -on_v;
    return part->cosine[j] * on_u + part->sine[j] * on_v;
}

SPECIALISED struct vec half_line(const struct kernel_part *part, const struct frame *f, int j,
                                 int samples) {
    return (struct vec){along(part, j, samples, f->u.x, f->v.x),
                        along(part, j, samples, f->u.y, f->v.y),
                        along(part, j, samples, f->u.z, f->v.z)};
}

#endif
