/* The accelerations of a part: springs from the root to the tip, then frames and samples. */
#include "base/vector.h"
#include "frames.h"
#include "part.h"
#include "parting.h"
#include "push.h"
#include "rigid.h"
#include "springs.h"

/* Position or velocity of node i >= 2. */
static inline struct vec node(const struct kernel_part *part, const double *x, int i) {
    return vec_load(x, (i - 2) * part->node_unknowns);
}

/* What keeps a segment that turns at its length: |P (v_b - v_a)|^2 / |d|. */
SPECIALISED lane centripetal(const struct reach *r) {
    const struct vec across = add_scaled(r->velocity, -dot(r->velocity, r->n), r->n);
    return dot(across, across) * r->inverse;
}

/* Three nodes take turns: with three turns in one each keeps its registers. Between the scalar ones
 * a move is an instruction, between vectors only a name. */
#if LANES == 1
#define WITHOUT_MOVES _Pragma("GCC unroll 3")
#else
#define WITHOUT_MOVES
#endif

/* Tangents and spring forces on all nodes. `stretch` and `bending` are constants where this is
 * inlined. Returns the lanes in which no segment and no spring has lost its direction. */
SPECIALISED mask walk_springs(struct kernel_part *part, const double *q, const double *v,
                              enum stretch stretch, enum bending bending) {
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    struct vec pa = part->p[0], va = part->v[0], pb = part->p[1], vb = part->v[1];
    struct vec fa = none, fb = none; /* on nodes i - 2 and i - 1 so far */
    mask sound = lane_all(0) == 0;
    struct reach before = first_segment(part);

    part->t[0] = part->tangent;
    WITHOUT_MOVES
    for (int i = 2; i < part->nodes; i++) {
        const struct vec p = node(part, q, i), pv = node(part, v, i);
        const struct reach segment = reach(pb, p, vb, pv, &sound);
        struct vec f = none;
        if (stretch == STRETCH_RIGID) {
            part->rigid->turning[i] = centripetal(&segment);
        } else {
            const struct vec pull =
                spring(&segment, part->spacing, part->stretch_k, part->stretch_c);
            f = scale(lane_all(-1), pull);
            fb = add(fb, pull);
        }

        if (bending == BENDING_SKIP) {
            const struct reach skip = reach(pa, p, va, pv, &sound);
            part->chord[i] = skip.n;
            const struct vec bend = spring(&skip, part->skip_length, part->bend_k, part->bend_c);
            fa = add(fa, bend);
            f = sub(f, bend);
        }
        if (bending == BENDING_HINGE) {
            const struct hinge bend = hinge(&before, &segment, part->bend_k, part->bend_c);
            fa = sub(fa, bend.on_a);
            fb = add(fb, sub(bend.on_a, bend.on_b));
            f = add(f, bend.on_b);
            part->inverse_length[i] = segment.inverse;
            before = segment;
        }
        part->t[i - 1] = segment.n;
        part->force[i - 2] = fa;
        pa = pb, va = vb, fa = fb;
        pb = p, vb = pv, fb = f;
    }
    part->force[part->nodes - 2] = fa;
    part->force[part->nodes - 1] = fb;
    return sound;
}

/* A vector in the plane of the envelope. */
struct ring {
    lane u, v;
};

SPECIALISED void ring_add(struct ring *sum, const struct kernel_part *part, int j, int samples,
                          lane s) {
    if (samples == 4) {
        *(j % 2 ? &sum->v : &sum->u) += j < 2 ? s : -s;
        return;
    }
    sum->u += part->cosine[j] * s;
    sum->v += part->sine[j] * s;
}

/* The accelerations of a node and of its samples. `G` is gravity, air and style at the node's
 * velocity: the outer acceleration. `ratio` is a sample's mass over the node's own. */

/* 4.2.1 of the thesis: the line counts as fixed in space. Over its mass a sample feels the spring
 * s and the outer force along its line, F.a = G.a - gamma rdot; the node feels -s. */
SPECIALISED struct vec move_projection(const struct kernel_part *part, const struct frame *frame,
                                       int samples, lane ratio, struct vec a, struct vec G,
                                       const double *q, const double *v, double *to) {
    const lane gu = dot(G, frame->u), gv = dot(G, frame->v);
    struct ring sum = {lane_all(0), lane_all(0)};
    for (int j = 0; j < samples; j++) {
        const lane rate = load(v, 3 + j);
        const lane s = part->spring_k * (part->radius - load(q, 3 + j)) - part->spring_c * rate;
        ring_add(&sum, part, j, samples, s);
        store(to, 3 + j, s + along(part, j, samples, gu, gv) - part->drag * rate);
    }
    return sub(a, scale(ratio, add(scale(sum.u, frame->u), scale(sum.v, frame->v))));
}

/* Exact constraint: r and the node's coordinates are all the unknowns. With the samples' reaction
 * across their lines, (m + mu sum P_j) a = f - sum s_j a_j + sum P_j F_j, and for M >= 3 evenly
 * spread half-lines sum P_j = M/2 (1 + w w'). */
SPECIALISED struct vec move_generalised(const struct kernel_part *part, const struct frame *frame,
                                        int samples, lane ratio, struct vec a, struct vec G,
                                        const double *q, const double *v, double *to) {
    const lane half = 0.5 * samples * ratio;
    const struct vec b = move_projection(part, frame, samples, ratio, a, G, q, v, to);
    /* b / (1 + half) across w and b / (1 + 2 half) along it, where b has half (G + w w.G) more;
     * `a` has G once already. */
    const struct vec rhs = add_scaled(add_scaled(b, half, G), half * dot(frame->w, G), frame->w);
    const lane across_w = 1 / (1 + half), along_w = 1 / (1 + 2 * half);
    const struct vec result =
        add_scaled(scale(across_w, rhs), (along_w - across_w) * dot(frame->w, rhs), frame->w);
    const lane au = dot(result, frame->u), av = dot(result, frame->v);
    for (int j = 0; j < samples; j++) /* mu (rddot + a.a_j) = s + F.a_j */
        store(to, 3 + j, load(to, 3 + j) - along(part, j, samples, au, av));
    return result;
}

/* Samples as free particles: a spring s along the half-line, a stiff one across it,
 *   s a - k_p (d - r a) - c_p (d' - r' a) = (k R + (k_p - k) r + (c_p - c) r') a - k_p d - c_p d'
 * with d and d' the sample's position and velocity from its node's; gravity and air at its own
 * velocity are G - gamma d'. The node has the sum of the springs with the other sign, which is what
 * the samples' accelerations have besides the outer ones. */
SPECIALISED struct vec move_penalty(const struct kernel_part *part, const struct frame *frame,
                                    int samples, lane ratio, struct vec a, struct vec G,
                                    const double *q, const double *v, double *to) {
    const struct vec p = vec_load(q, 0), pv = vec_load(v, 0);
    const lane push = part->spring_k * part->radius, k = part->penalty_k - part->spring_k;
    const lane c = part->penalty_c - part->spring_c, damping = part->penalty_c + part->drag;
    struct vec sum = {lane_all(0), lane_all(0), lane_all(0)}, drift = sum;
    for (int j = 0; j < samples; j++) {
        const struct vec line = half_line(part, frame, j, samples);
        const struct vec d = sub(vec_load(q, 3 + 3 * j), p), dv = sub(vec_load(v, 3 + 3 * j), pv);
        struct vec rate = add_scaled(G, push + k * dot(d, line) + c * dot(dv, line), line);
        rate = add_scaled(rate, -part->penalty_k, d);
        rate = add_scaled(rate, -damping, dv);
        vec_store(to, 3 + 3 * j, rate);
        sum = add(sum, rate);
        drift = add(drift, dv);
    }
    const struct vec springs =
        add_scaled(add_scaled(sum, lane_all(-samples), G), part->drag, drift);
    return add_scaled(a, -ratio, springs);
}

/* What acts on all nodes alike: the wind, and gravity with style. */
struct outside {
    struct vec wind, g;
};

SPECIALISED void outside_at(const struct surroundings *around, double t, double wind[3],
                            double g[3]) {
    double style[3];
    for (int c = 0; c < 3; c++) {
        wind[c] = 0;
        g[c] = around->gravity[c];
    }
    if (around->wind.kind != WIND_NONE)
        wind_velocity(&around->wind, t, wind);
    if (around->style.knots == 0)
        return;
    style_acceleration(&around->style, t, style);
    for (int c = 0; c < 3; c++)
        g[c] += style[c];
}

/* In each lane at its own time. */
static struct outside outside_by_lane(const struct kernel_part *part) {
    double wind[3], g[3];
    struct outside out;
    for (int k = 0; k < LANES; k++) {
        outside_at(part->surroundings, part->system->times[k], wind, g);
        vec_set(&out.wind, k, wind);
        vec_set(&out.g, k, g);
    }
    return out;
}

SPECIALISED struct outside outside(const struct kernel_part *part, double t) {
    double wind[3], g[3];
    if (part->system->times)
        return outside_by_lane(part);
    outside_at(part->surroundings, t, wind, g);
    return (struct outside){vec_all(wind), vec_all(g)};
}

/* Frames along the wisp, and with them the accelerations of all unknowns. */
SPECIALISED void walk_nodes(struct kernel_part *part, double t, const double *q, const double *v,
                            double *acceleration, enum wisp_treatment treatment, int samples) {
    const struct outside out = outside(part, t);
    const struct vec wind = out.wind;
    const int parted = has_parting(part);
    struct vec g = out.g, parting = out.g;
    if (parted)
        parting = parting_strength(part, t);
    if (samples > 0)
        plane_normals(part, part->frames);

    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        const struct vec pv = vec_load(v + at, 0);
        if (parted)
            g = add_scaled(out.g, parting_side(part, vec_load(q + at, 0)), parting);
        const struct vec G = add_scaled(g, part->drag, sub(wind, pv));
        struct vec a = add_scaled(G, part->inverse_mass[i], part->force[i]);
        if (samples > 0) {
            const lane ratio = part->sample_mass[i] * part->inverse_mass[i];
            const double *qi = q + at, *vi = v + at;
            const struct frame *frame = &part->frames[i];
            carry_frame(part, part->frames, i);
            a = treatment == WISP_PROJECTION
                    ? move_projection(part, frame, samples, ratio, a, G, qi, vi, acceleration + at)
                : treatment == WISP_PENALTY
                    ? move_penalty(part, frame, samples, ratio, a, G, qi, vi, acceleration + at)
                    : move_generalised(part, frame, samples, ratio, a, G, qi, vi,
                                       acceleration + at);
        }
        vec_store(acceleration + at, 0, a);
    }
}

/* The first two nodes of a lane that a spring joins and that have no direction from one to the
 * other; `*from` is -1 where there are none. */
static void find_coinciding(const struct kernel_part *part, const double *q, int k, int *from,
                            int *to) {
    const int farthest = part->bending == BENDING_SKIP ? 2 : 1;
    for (*from = 0; *from < part->nodes - 1; ++*from)
        for (*to = *from + 1; *to <= *from + farthest && *to < part->nodes; ++*to) {
            const struct vec d = sub(place_of(part, q, *from), place_of(part, q, *to));
            if (!(lane_get(dot(d, d), k) > 0))
                return;
        }
    *from = -1;
}

/* A segment or a spring without direction: coinciding nodes, or a state that overflowed. */
int LANED(kernel_refuse_state)(const struct kernel_part *part, const double *q, const double *v) {
    struct system *system = part->system;
    if (!all_finite(q, system->size) || !all_finite(v, system->size))
        return system_fail(system, NOT_FINITE, "the state overflowed or became NaN");
    for (int k = 0; k < LANES; k++) {
        int from, to;
        find_coinciding(part, q, k, &from, &to);
        if (from >= 0)
            return system_fail(system, MODEL_FAILED,
                               "wisp %d: nodes %d and %d coincide: the spring that joins them has "
                               "no direction",
                               system->numbers ? system->numbers[k] : k, from, to);
    }
    return system_fail(system, NOT_FINITE, "the state overflowed");
}

SPECIALISED mask walk(struct kernel_part *part, const double *q, const double *v,
                      enum stretch stretch) {
    return part->bending == BENDING_NONE   ? walk_springs(part, q, v, stretch, BENDING_NONE)
           : part->bending == BENDING_SKIP ? walk_springs(part, q, v, stretch, BENDING_SKIP)
                                           : walk_springs(part, q, v, stretch, BENDING_HINGE);
}

int LANED(kernel_acceleration)(void *ctx, double t, const double *q, const double *v, double *a) {
    struct kernel_part *part = ctx;
    if (part->surroundings->head.knots > 0)
        LANED(kernel_prescribe)(part, t);
    if (!mask_all(part->rigid ? walk(part, q, v, STRETCH_RIGID) : walk(part, q, v, STRETCH_SPRING)))
        return LANED(kernel_refuse_state)(part, q, v);
    if (part->samples == 0)
        walk_nodes(part, t, q, v, a, WISP_PROJECTION, 0);
    else if (part->treatment == WISP_PROJECTION && part->samples == 4)
        walk_nodes(part, t, q, v, a, WISP_PROJECTION, 4);
    else if (part->treatment == WISP_GENERALISED && part->samples == 4)
        walk_nodes(part, t, q, v, a, WISP_GENERALISED, 4);
    else if (part->treatment == WISP_PENALTY && part->samples == 4)
        walk_nodes(part, t, q, v, a, WISP_PENALTY, 4);
    else
        walk_nodes(part, t, q, v, a, part->treatment, part->samples);
    if (part->push)
        LANED(kernel_push_accelerate)(part, t, q, v, a);
    if (part->rigid)
        LANED(kernel_tighten)(part, t, a);
    return 0;
}

/* Springs and hinges that are as soft as nothing. */
int LANED(kernel_without_springs)(void *ctx, double t, const double *q, const double *v,
                                  double *a) {
    struct kernel_part *part = ctx;
    lane *const constants[] = {&part->stretch_k, &part->stretch_c, &part->bend_k, &part->bend_c};
    lane kept[4];
    for (int i = 0; i < 4; i++) {
        kept[i] = *constants[i];
        *constants[i] = lane_all(0);
    }
    const int code = LANED(kernel_acceleration)(part, t, q, v, a);
    for (int i = 0; i < 4; i++)
        *constants[i] = kept[i];
    return code;
}
