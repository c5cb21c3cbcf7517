/* Wisps of a part for contacts: boxes around them, and wisps laid open. */
#include "frames.h"
#include "padded.h"
#include "part.h"
#include "span.h"
#include "wisp/strand.h"

/* --- boxes --- */

static inline lane largest(lane a, lane b) {
    return lane_select(b > a, b, a);
}

/* The largest distance of a sample from its node, the head's rings included. */
static lane farthest_sample(const struct kernel_part *part, const double *q) {
    lane most = part->samples > 0 ? part->radius : lane_all(0);
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns;
        for (int j = 0; j < part->samples; j++) {
            if (part->treatment == WISP_PENALTY) {
                const struct vec d = sub(vec_load(q, at + 3 + 3 * j), vec_load(q, at));
                most = largest(most, lane_sqrt(dot(d, d)));
            } else { /* between two clamps it may be behind its node */
                const lane r = load(q, at + 3 + j);
                most = largest(most, lane_select(r < 0, -r, r));
            }
        }
    }
    return most;
}

/* Lanes in which no section can reach a point two segments off. Along the line from node 1 to the
 * last every segment advances by a or more, and every tangent, and so every plane's normal, has a
 * cosine of c or more with it: what is in a plane, `margin` or less from its node, is
 * margin sqrt(1 - c^2) or less before or behind it; a particle may have left its plane. Between
 * such a point and the nearest end of a section that counts there are two segments, 2 a. */
static mask cannot_touch_itself(const struct kernel_part *part, const double *q, lane margin) {
    const struct vec last = vec_load(q, (part->nodes - 3) * part->node_unknowns);
    const struct vec chord = sub(last, part->p[1]);
    const struct vec along = scale(1 / lane_sqrt(dot(chord, chord)), chord);
    lane advance = lane_all(INFINITY), cosine = dot(part->tangent, along);
    struct vec before = part->p[1];
    for (int i = 2; i < part->nodes; i++) {
        const struct vec p = vec_load(q, (i - 2) * part->node_unknowns), d = sub(p, before);
        const lane a = dot(d, along), c = a / lane_sqrt(dot(d, d));
        advance = lane_select(a < advance, a, advance);
        cosine = lane_select(c < cosine, c, cosine);
        before = p;
    }
    const lane square = 1 - cosine * cosine;
    const lane off = part->treatment == WISP_PENALTY
                         ? lane_all(1)
                         : lane_sqrt(lane_select(square > 0, square, lane_all(0)));
    return (cosine > 0) & (advance > margin * off); /* neither is where there is no direction */
}

/* Sections reach from node 1 to the last; points are free nodes and their samples. None of that is
 * further from a node than its farthest sample. A part in a million more, for rounding. */
unsigned LANED(kernel_boxes)(void *ctx, const double *q, double (*boxes)[6]) {
    const struct kernel_part *part = ctx;
    const lane margin = (1 + 1e-6) * farthest_sample(part, q);
    const struct span free = span_of(part, q);
    const struct vec first = in_space(part, part->p[1]);
    const struct vec low = least(free.low, first), high = most(free.high, first);
    const struct vec away = {margin, margin, margin};
    for (int k = 0; k < LANES; k++) {
        vec_get(boxes[k], sub(low, away), k);
        vec_get(boxes[k] + 3, add(high, away), k);
    }
    return ~mask_bits(cannot_touch_itself(part, q, margin));
}

/* --- laid open --- */

/* A node and its samples. */
struct ring {
    struct vec p, v;
    struct {
        struct vec e, ev;
        lane r, rate;
    } sample[SAMPLES_MAX];
};

/* Samples of a free node from its unknowns: distances, or particles. */
SPECIALISED void free_samples(const struct kernel_part *part, int i, const double *qi,
                              const double *vi, int samples, struct ring *ring) {
    for (int j = 0; j < samples; j++) {
        const struct vec line = half_line(part, &part->frames[i], j, samples);
        if (part->treatment == WISP_PENALTY) {
            ring->sample[j].e = in_space(part, vec_load(qi, 3 + 3 * j));
            ring->sample[j].ev = vec_load(vi, 3 + 3 * j);
            ring->sample[j].r = dot(sub(vec_load(qi, 3 + 3 * j), vec_load(qi, 0)), line);
            ring->sample[j].rate = dot(sub(ring->sample[j].ev, ring->v), line);
        } else {
            ring->sample[j].r = load(qi, 3 + j);
            ring->sample[j].rate = load(vi, 3 + j);
            ring->sample[j].e = add_scaled(ring->p, ring->sample[j].r, line);
            ring->sample[j].ev = add_scaled(ring->v, ring->sample[j].rate, line);
        }
    }
}

/* The samples of a node that follows the head are at rest on their half-lines. */
static void fixed_samples(const struct kernel_part *part, int i, struct ring *ring) {
    for (int j = 0; j < part->samples; j++) {
        const struct vec line = half_line(part, &part->frames[i], j, part->samples);
        ring->sample[j].r = part->radius;
        ring->sample[j].rate = lane_all(0);
        ring->sample[j].e = add_scaled(ring->p, part->radius, line);
        ring->sample[j].ev = ring->v;
    }
}

static void put_rings(const struct kernel_part *part, int i, const struct ring *ring,
                      struct strand *const *strands) {
    const struct frame *frame = &part->frames[i];
    const struct padded p = pad(ring->p), v = pad(ring->v), axis_u = pad(frame->u),
                        axis_v = pad(frame->v), axis_w = pad(frame->w);
    for (int k = 0; k < LANES; k++) {
        if (!strands[k])
            continue;
        put(strands[k]->p[i], &p, k);
        put(strands[k]->v[i], &v, k);
        put(strands[k]->axis_u[i], &axis_u, k);
        put(strands[k]->axis_v[i], &axis_v, k);
        put(strands[k]->axis_w[i], &axis_w, k);
    }
    for (int j = 0; j < part->samples; j++) {
        const int at = i * part->samples + j;
        const struct padded e = pad(ring->sample[j].e), ev = pad(ring->sample[j].ev);
        for (int k = 0; k < LANES; k++) {
            if (!strands[k])
                continue;
            put(strands[k]->e[at], &e, k);
            put(strands[k]->ev[at], &ev, k);
            strands[k]->r[at] = lane_get(ring->sample[j].r, k);
            strands[k]->rate[at] = lane_get(ring->sample[j].rate, k);
        }
    }
}

void LANED(kernel_open)(void *ctx, const double *q, const double *v,
                        struct strand *const *strands) {
    struct kernel_part *part = ctx;
    struct ring ring;
    LANED(kernel_frames)(part, q, part->frames);
    for (int i = 0; i < 2; i++) {
        ring.p = in_space(part, part->p[i]);
        ring.v = part->v[i];
        fixed_samples(part, i, &ring);
        put_rings(part, i, &ring, strands);
    }
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        ring.p = in_space(part, vec_load(q + at, 0));
        ring.v = vec_load(v + at, 0);
        if (part->samples == 4)
            free_samples(part, i, q + at, v + at, 4, &ring);
        else
            free_samples(part, i, q + at, v + at, part->samples, &ring);
        put_rings(part, i, &ring, strands);
    }
    for (int k = 0; k < LANES; k++)
        if (strands[k])
            strands[k]->changed = 0;
}
