/* Bodies as parts see them: which wisps may touch one, and samples pulled out of those. */
#include "frames.h"
#include "part.h"
#include "span.h"
#include "wisp/body.h"

/* --- near a body? --- */

/* Masks of comparisons, an instruction each; minima and maxima cost three where the compiler may
 * not forget about NaN (boxes of 4 wisps made so: 60 ns, and the clamp's own look at the samples
 * came on top). */
struct look {
    mask inside;  /* some sample is as near to its node as the clamp looks for */
    mask outside; /* some sample is further from its node than a margin */
};

SPECIALISED void look_at_distances(const struct kernel_part *part, const double *q, lane margin,
                                   int samples, struct look *look) {
    const lane least = AT_LEAST_DISTANCE * part->radius;
    for (int at = 0; at < (part->nodes - 2) * (3 + samples); at += 3 + samples) {
        mask inside = lane_all(0) != 0, outside = inside; /* short chains run side by side */
        for (int j = at + 3; j < at + 3 + samples; j++) {
            const lane r = load(q, j);
            inside |= r <= least;
            outside |= r > margin;
        }
        look->inside |= inside;
        look->outside |= outside;
    }
}

static void look_at_particles(struct kernel_part *part, const double *q, lane margin,
                              struct look *look) {
    const lane least = AT_LEAST_DISTANCE * part->radius;
    LANED(kernel_frames)(part, q, part->frames);
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns;
        const struct vec p = vec_load(q, at);
        for (int j = 0; j < part->samples; j++) {
            const struct vec line = half_line(part, &part->frames[i], j, part->samples);
            const lane r = dot(sub(vec_load(q, at + 3 + 3 * j), p), line);
            look->inside |= r <= least;
            look->outside |= r > margin;
        }
    }
}

static struct look look_at_samples(struct kernel_part *part, const double *q, lane margin) {
    struct look look = {lane_all(0) != 0, lane_all(0) != 0};
    if (part->treatment == WISP_PENALTY && part->samples > 0)
        look_at_particles(part, q, margin, &look);
    else if (part->samples == 4)
        look_at_distances(part, q, margin, 4, &look);
    else
        look_at_distances(part, q, margin, part->samples, &look);
    return look;
}

/* Where all free nodes are beyond a side (0 to 5) of a box (least x y z, most x y z), moved out. */
static inline mask beyond(const struct kernel_part *part, const double *q, const double *box,
                          int side, lane margin) {
    const int end = (part->nodes - 2) * part->node_unknowns, next = part->node_unknowns;
    const lane origin[3] = {part->origin.x, part->origin.y, part->origin.z};
    const lane from = origin[side % 3], least = box[side] - margin, most = box[side] + margin;
    mask all = lane_all(0) == 0;
    if (side < 3)
        for (int at = side; at < end; at += next)
            all &= from + load(q, at) < least;
    else
        for (int at = side - 3; at < end; at += next)
            all &= from + load(q, at) > most;
    return all;
}

/* Where some side of a box (least x y z, most x y z), moved out, has all of the wisp beyond it. */
static inline mask apart(const struct span *span, const double *box, lane margin) {
    return (span->high.x < box[0] - margin) | (span->high.y < box[1] - margin) |
           (span->high.z < box[2] - margin) | (span->low.x > box[3] + margin) |
           (span->low.y > box[4] + margin) | (span->low.z > box[5] + margin);
}

/* A side of the bodies' box that has all wisps beyond it, for the next time; else the last one. */
static void choose_side(struct kernel_part *part, const double *q, const double *hull,
                        lane margin) {
    for (int side = 0; side < 6; side++)
        if (mask_all(beyond(part, q, hull, side, margin)))
            part->far_side = side;
}

/* A sample rests at R and contact shortens it: few are ever beyond 2 R, and their wisps count as
 * near. A part in a million more, so that rounding loses nobody. */
unsigned LANED(kernel_near)(void *ctx, const double *q, const double *hull, const double *boxes,
                            int count, int *clamp) {
    struct kernel_part *part = ctx;
    const lane margin = part->samples > 0 ? (2 + 2e-6) * part->radius : lane_all(0);
    const struct look look = look_at_samples(part, q, margin);
    mask near = look.outside | (beyond(part, q, hull, part->far_side, margin) == 0);
    *clamp = !mask_none(look.inside);
    if (mask_none(near))
        return 0;
    const struct span span = span_of(part, q);
    near = look.outside;
    for (int i = 0; i < count; i++)
        near |= apart(&span, boxes + 6 * i, margin) == 0;
    if (mask_none(near))
        choose_side(part, q, hull, margin);
    return mask_bits(near);
}

/* --- samples inside a body (section 4.2.2 of the thesis, as in body.c) --- */

static inline struct vec times(struct vec a, struct vec b) {
    return (struct vec){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline struct vec over(struct vec a, struct vec b) {
    return (struct vec){a.x / b.x, a.y / b.y, a.z / b.z};
}

/* A vector of the world along the body's axes. */
static inline struct vec along_axes(const struct obstacle *body, struct vec x) {
    if (!body->turned)
        return x;
    return (struct vec){dot(vec_all(body->axes[0]), x), dot(vec_all(body->axes[1]), x),
                        dot(vec_all(body->axes[2]), x)};
}

/* ||y||^2 where the body is the unit sphere, to rounding: a multiplication takes an eighth of the
 * time of a division. */
static inline lane depth(const struct obstacle *body, struct vec x) {
    const struct vec y = times(x, vec_all(body->inverse));
    return dot(y, y);
}

/* Whether x is inside, by the same bits as in body.c. */
static inline mask contains(const struct obstacle *body, struct vec x) {
    const mask maybe = depth(body, x) < 1 + 1e-9;
    if (mask_none(maybe))
        return maybe;
    const struct vec y = over(x, vec_all(body->radii));
    return dot(y, y) < 1;
}

/* A point of the world from the body's centre, along its axes. */
static inline struct vec seen_from(const struct obstacle *body, struct vec p) {
    return along_axes(body, sub(p, vec_all(body->centre)));
}

/* Lanes in which some free node is inside a body of the list. */
static mask nodes_inside(const struct kernel_part *part, const double *q,
                         const struct obstacle *const *near, int count) {
    mask inside = lane_all(0) != 0;
    for (int b = 0; b < count; b++)
        for (int i = 2; i < part->nodes; i++) {
            const struct vec p = in_space(part, vec_load(q, (i - 2) * part->node_unknowns));
            inside |= contains(near[b], seen_from(near[b], p));
        }
    return inside;
}

/* The first crossing of the half-line from a point outside, in units of d, where y + s e meets the
 * unit sphere: a s^2 + 2 b s + c = 0; b^2 - a c = a - ||y x e||^2, for where the line grazes the
 * first cancels. `none` where it misses, by rounding. */
static inline lane entry(const struct obstacle *body, struct vec from, struct vec d, lane none) {
    const struct vec radii = vec_all(body->radii), y = over(from, radii), e = over(d, radii);
    const struct vec n = cross(y, e);
    const lane b = dot(y, e), discriminant = dot(e, e) - dot(n, n), c = dot(y, y) - 1;
    const mask meets = (b < 0) & (discriminant >= 0);
    const lane s = lane_select(c > 0, c, lane_all(0)) / (lane_sqrt(discriminant) - b);
    return lane_select(meets, s, none);
}

/* Shortens the r of node i's sample j to the first crossing; inwards it then moves no faster than
 * the body. `from`: the
 * node along the body's axes. Returns the lanes in which it was inside. */
static inline mask pull_sample(const struct kernel_part *part, int i, int j, struct vec from,
                               struct vec surface, const struct obstacle *body, mask among,
                               double *qi, double *vi) {
    const struct vec line = half_line(part, &part->frames[i], j, part->samples);
    const struct vec a = along_axes(body, line);
    const lane r = load(qi, 3 + j), rate = load(vi, 3 + j), limit = LEAST_DISTANCE * part->radius;
    const mask inside = among & (r > 0) & contains(body, add_scaled(from, r, a));
    if (mask_none(inside))
        return inside;
    lane r1 = entry(body, from, a, r);
    r1 = lane_select(r1 < r, r1, r);
    r1 = lane_select(r1 > limit, r1, limit);
    const lane away = dot(surface, line);
    store(qi, 3 + j, lane_select(inside, r1, r));
    store(vi, 3 + j, lane_select(inside & (away < rate), away, rate));
    return inside;
}

/* The largest r of a node's samples. A body that holds one of them would hold the node if it were
 * larger by r in every direction; so it would if it were scaled by 1 + r / its least radius. */
static inline lane largest_distance(const struct kernel_part *part, const double *qi) {
    lane largest = lane_all(0);
    for (int j = 0; j < part->samples; j++) {
        const lane r = load(qi, 3 + j);
        largest = lane_select(r > largest, r, largest);
    }
    return largest;
}

/* v_c + omega x (p - c), less the node's. */
static inline struct vec surface_velocity(const struct obstacle *body, struct vec p, struct vec v) {
    const struct vec from = sub(p, vec_all(body->centre));
    return sub(add(vec_all(body->velocity), cross(vec_all(body->spin), from)), v);
}

/* Samples of one node against a body; returns how many were inside, of the lanes that count,
 * and adds those lanes to `lanes`. */
static int pull_samples(const struct kernel_part *part, int i, const struct obstacle *body,
                        lane reach, mask among, double *qi, double *vi, unsigned counted,
                        unsigned *lanes) {
    const struct vec p = in_space(part, vec_load(qi, 0)), from = seen_from(body, p);
    const lane scaled = 1 + 1e-9 + reach * body->inverse_least;
    int pulled = 0;
    if (mask_none(among & (depth(body, from) < scaled * scaled)))
        return 0;
    const struct vec surface = surface_velocity(body, p, vec_load(vi, 0));
    for (int j = 0; j < part->samples; j++) {
        const unsigned inside =
            counted & mask_bits(pull_sample(part, i, j, from, surface, body, among, qi, vi));
        pulled += __builtin_popcount(inside);
        *lanes |= inside;
    }
    return pulled;
}

unsigned LANED(kernel_pull)(void *ctx, double *q, double *v, const struct obstacle *bodies,
                            const double *boxes, int count, unsigned counted, int *pulled,
                            unsigned *pulled_lanes) {
    struct kernel_part *part = ctx;
    const struct obstacle *near[BODIES_MAX];
    int near_count = 0;
    lane reach = lane_all(0);
    *pulled = 0;
    *pulled_lanes = 0;
    if (part->treatment == WISP_PENALTY) /* frames turn under its particles: not this way */
        return ~0u;
    for (int i = 2; i < part->nodes && part->samples > 0; i++) {
        const lane r = largest_distance(part, q + (i - 2) * part->node_unknowns * LANES);
        reach = lane_select(r > reach, r, reach);
    }
    const struct span span = span_of(part, q);
    for (int b = 0; b < count; b++)
        if (!mask_all(apart(&span, boxes + 6 * b, (1 + 1e-6) * reach)))
            near[near_count++] = &bodies[b];
    const mask inside = nodes_inside(part, q, near, near_count), among = inside == 0;
    if (part->samples == 0 || mask_none(among) || near_count == 0)
        return mask_bits(inside);
    LANED(kernel_frames)(part, q, part->frames);
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        reach = largest_distance(part, q + at);
        for (int b = 0; b < near_count; b++)
            *pulled +=
                pull_samples(part, i, near[b], reach, among, q + at, v + at, counted, pulled_lanes);
    }
    return mask_bits(inside);
}
