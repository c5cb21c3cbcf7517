/* The energies of a part, and the powers that change them.
 *
 * A sample is at e = p + r a with velocity e' = v + r' a, or in `penalty` where it is: the energy
 * is that of these positions and velocities. The line's own turning a' is known to no treatment.
 * Along the model's accelerations the energy changes by the works of the forces, and by what
 * follows from a' and from what the treatment neglects, its power:
 *
 *   penalty      Its springs are the gradients of their energy with a held. With d = e - p and
 *                o = d - r a, r = d.a and |o|^2 change by d.a' = o.a' and -2 r o.a' besides:
 *                    sum mu (k (r - R) - k_p r) o.a'.
 *   generalised  With a held the equations are Lagrange's, and conserve. The kinetic energy has
 *                mu e'.(r' a') = mu r' v.a' besides, gravity's -mu g.(r a'):
 *                    sum mu (r' v.a' - r g.a').
 *   projection   That, and: the node's equation knows nothing of the sample's mass, and what
 *                pushes the sample across its line, P F with P = 1 - a a', pushes nobody. Into
 *                mu e'.(v' + r'' a), with mu (r'' + a.v') = s + F.a + mu a.v':
 *                    sum mu e'.v' - v.P F.
 *
 * A body that pushes by penalty has of a point the energy e of a spring, by mass, and the point has
 * the acceleration f; as the body sees it, it moves with u. Where -grad e is what is elastic of f,
 * e changes by (grad e).u, and f.x' + grad e.u = (f + grad e).u + f.(x' - u): what damping takes,
 * and what the body puts in. A sample that is r a from its node moves by r a' besides, as in
 * gravity's field.
 *
 * Measuring leaves no trace in what steppers use: it works on a copy of the part with work space
 * of its own. */
#include "system/energy.h"

#include "frames.h"
#include "part.h"
#include "parting.h"
#include "push.h"
#include "room.h"
#include "springs.h"

static lane square(struct vec a) {
    return dot(a, a);
}

/* --- a copy to work on --- */

struct copy {
    struct kernel_part part;
    struct system system; /* for the reason of a failure, which is not the run's */
    double *acceleration; /* room for one */
};

/* 0, or OUT_OF_MEMORY: only a part's first one takes memory. */
static int make_copy(struct kernel_part *part, struct copy *copy) {
    const size_t n = (size_t)part->nodes;
    if (!part->spare &&
        !room_of(0, n * (3 + 3 + 3 + 9 + (size_t)part->node_unknowns), &part->spare))
        return OUT_OF_MEMORY;
    lane *room = part->spare;
    copy->part = *part;
    copy->system = *part->system;
    copy->part.system = &copy->system;
    copy->part.t = room_take(&room, 3 * n);
    copy->part.force = room_take(&room, 3 * n);
    copy->part.swing = room_take(&room, 3 * n);
    copy->part.frames = room_take(&room, 9 * n);
    copy->acceleration = (double *)room;
    return 0;
}

static double sum_of_wisps(const struct kernel_part *part, lane x) {
    double sum = 0;
    for (int k = 0; k < part->system->wisps; k++)
        sum += lane_get(x, k);
    return sum;
}

/* --- walking along the springs --- */

static struct vec node(const struct kernel_part *part, const struct vec *head, const double *x,
                       int i) {
    return i < 2 ? head[i] : vec_load(x, (i - 2) * part->node_unknowns);
}

/* From node a to node b. */
static struct reach reach_of(const struct kernel_part *part, const double *q, const double *v,
                             int a, int b) {
    mask sound = lane_all(0) == 0;
    if (b == 1)
        return first_segment(part);
    return reach(node(part, part->p, q, a), node(part, part->p, q, b), node(part, part->v, v, a),
                 node(part, part->v, v, b), &sound);
}

/* A sum over lanes for each member of struct energies, of struct powers. */
struct lane_energies {
#define X(name, meaning) lane name;
    ENERGIES(X)
#undef X
};

struct lane_powers {
#define X(name, meaning) lane name;
    POWERS(X)
#undef X
};

static void spring_energies(const struct kernel_part *part, const double *q, const double *v,
                            struct lane_energies *sum) {
    for (int i = 2; i < part->nodes; i++) {
        const struct reach segment = reach_of(part, q, v, i - 1, i);
        const lane stretch = segment.length - part->spacing;
        lane bend = lane_all(0);
        if (part->bending == BENDING_SKIP)
            bend = reach_of(part, q, v, i - 2, i).length - part->skip_length;
        if (part->bending == BENDING_HINGE) {
            const struct reach before = reach_of(part, q, v, i - 2, i - 1);
            bend = turn_between(&before, &segment).angle;
        }
        sum->stretch += 0.5 * part->stretch_k * stretch * stretch;
        sum->bending += 0.5 * part->bend_k * bend * bend;
    }
}

/* The square of the rate that a hinge's damping acts on: the angle's, or where that has no gradient
 * the tangents' difference. */
static lane hinge_rate_square(const struct reach *a, const struct reach *b) {
    const struct turn turn = turn_between(a, b);
    const lane rate = dot(turn.along_a, a->velocity) + dot(turn.along_b, b->velocity);
    const lane straight = square(sub(tangent_rate(b), tangent_rate(a)));
    return lane_select(turn.sine > 1e-12, rate * rate, straight);
}

/* A damper takes c times the square of its rate; and of the springs' forces f_i on the nodes that
 * follow the head, the head puts in -f_i.v_i: all forces of a spring together have minus the
 * derivative of its energy and what its damper takes. */
static void spring_powers(const struct kernel_part *part, const double *q, const double *v,
                          struct lane_powers *sum) {
    for (int i = 2; i < part->nodes; i++) {
        const struct reach segment = reach_of(part, q, v, i - 1, i);
        const lane stretching = dot(segment.velocity, segment.n);
        sum->stretch_damping -= part->stretch_c * stretching * stretching;
        if (part->bending == BENDING_SKIP) {
            const struct reach skip = reach_of(part, q, v, i - 2, i);
            const lane bending = dot(skip.velocity, skip.n);
            sum->bending_damping -= part->bend_c * bending * bending;
        }
        if (part->bending == BENDING_HINGE) {
            const struct reach before = reach_of(part, q, v, i - 2, i - 1);
            sum->bending_damping -= part->bend_c * hinge_rate_square(&before, &segment);
        }
    }
    sum->head -= dot(part->force[0], part->v[0]) + dot(part->force[1], part->v[1]);
}

/* --- how fast frames turn --- */

static struct vec tangent_rate_of(const struct kernel_part *part, const double *q, const double *v,
                                  int segment) {
    const struct reach r = reach_of(part, q, v, segment, segment + 1);
    return tangent_rate(&r);
}

/* The rate of the frame of nodes 0 and 1, which turns with the head. */
static struct frame first_frame_rate(const struct kernel_part *part) {
    const struct vec w = LANED(kernel_turning)(part, part->rest_tangent);
    const struct vec u = LANED(kernel_turning)(part, part->rest_normal);
    return (struct frame){u, add(cross(w, part->normal), cross(part->tangent, u)), w};
}

/* The rate of w at node i, as bisector() has w. */
static struct vec plane_rate(const struct kernel_part *part, int i, const double *q,
                             const double *v, struct vec last) {
    const struct vec before = tangent_rate_of(part, q, v, i - 1);
    if (i == part->nodes - 1)
        return before;
    const struct vec tangents = add(part->t[i - 1], part->t[i]), w = part->frames[i].w;
    const struct vec rate = add(before, tangent_rate_of(part, q, v, i));
    const lane length = lane_sqrt(square(tangents));
    return vec_select(length > 1e-9, scale(1 / length, add_scaled(rate, -dot(rate, w), w)), last);
}

/* The rate of the frame at node i from that at node i - 1, as plane_normals() and carry_frame()
 * have it: u_i = u - s (w + w_i) with s = u.w_i / (1 + w.w_i). */
static struct frame frame_rate(const struct kernel_part *part, int i, const double *q,
                               const double *v, struct frame last) {
    const struct frame *from = &part->frames[i - 1], *to = &part->frames[i];
    const struct vec w = plane_rate(part, i, q, v, last.w);
    const struct vec both = add(from->w, to->w), both_rate = add(last.w, w);
    const lane below = 1 + dot(from->w, to->w), s = dot(from->u, to->w) / below;
    const lane s_rate =
        (dot(last.u, to->w) + dot(from->u, w) - s * (dot(last.w, to->w) + dot(from->w, w))) / below;
    const struct vec carried = add_scaled(add_scaled(last.u, -s_rate, both), -s, both_rate);
    const struct vec u = vec_select(below > 1e-9, carried, last.u);
    return (struct frame){u, add(cross(w, to->u), cross(to->w, u)), w};
}

/* --- samples --- */

/* Sample j of a node: where it is, from its node and along its line. */
struct sample {
    struct vec line, d, velocity; /* a; e - p, m; e', m/s */
    struct vec off, off_rate;     /* across the line: of d, of e' - v; 0 but in penalty */
    lane r, rate;                 /* along it */
};

static struct sample sample_of(const struct kernel_part *part, const struct frame *frame, int j,
                               const double *q, const double *v) {
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)}, pv = vec_load(v, 0);
    struct sample s = {.line = half_line(part, frame, j, part->samples)};
    if (part->treatment != WISP_PENALTY) {
        s.r = load(q, 3 + j);
        s.rate = load(v, 3 + j);
        s.d = scale(s.r, s.line);
        s.velocity = add_scaled(pv, s.rate, s.line);
        s.off = s.off_rate = none;
        return s;
    }
    s.d = sub(vec_load(q, 3 + 3 * j), vec_load(q, 0));
    s.velocity = vec_load(v, 3 + 3 * j);
    const struct vec relative = sub(s.velocity, pv);
    s.r = dot(s.d, s.line);
    s.rate = dot(relative, s.line);
    s.off = add_scaled(s.d, -s.r, s.line);
    s.off_rate = add_scaled(relative, -s.rate, s.line);
    return s;
}

/* --- bodies --- */

static struct pushed pushed_by_bodies(struct kernel_part *part, double t, struct vec p,
                                      struct vec v) {
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    if (!part->push)
        return (struct pushed){lane_all(0), none, none, lane_all(0), lane_all(0)};
    return LANED(kernel_pushed)(part, t, p, v);
}

/* --- energies --- */

static void node_energies(struct kernel_part *part, int i, double t, const double *q,
                          const double *v, struct vec gravity, struct lane_energies *sum) {
    const struct vec p = vec_load(q, 0);
    const lane mu = part->sample_mass[i];
    sum->bodies += part->mass[i] * pushed_by_bodies(part, t, p, vec_load(v, 0)).energy;
    sum->kinetic += 0.5 * part->mass[i] * square(vec_load(v, 0));
    sum->gravity -= part->mass[i] * dot(gravity, p);
    for (int j = 0; j < part->samples; j++) {
        const struct sample s = sample_of(part, &part->frames[i], j, q, v);
        const lane gap = s.r - part->radius;
        sum->kinetic += 0.5 * mu * square(s.velocity);
        sum->gravity -= mu * dot(gravity, add(p, s.d));
        sum->envelope += 0.5 * mu * (part->spring_k * gap * gap + part->penalty_k * square(s.off));
        sum->bodies += mu * pushed_by_bodies(part, t, add(p, s.d), s.velocity).energy;
    }
}

int LANED(kernel_energies)(void *ctx, double t, const double *q, const double *v,
                           struct energies *energies) {
    struct copy copy;
    struct lane_energies sum;
    const int code = make_copy(ctx, &copy);
    if (code)
        return code;
    struct kernel_part *part = &copy.part;
    memset(&sum, 0, sizeof sum);
    LANED(kernel_prescribe)(part, t);
    LANED(kernel_frames)(part, q, part->frames);
    spring_energies(part, q, v, &sum);
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        node_energies(part, i, t, q + at, v + at, vec_all(part->surroundings->gravity), &sum);
    }
#define X(name, meaning) energies->name = sum_of_wisps(part, sum.name);
    ENERGIES(X)
#undef X
    return 0;
}

/* --- powers --- */

/* What acts from outside, by mass. */
struct outside {
    struct vec gravity, style; /* m/s^2 */
    struct vec wind;           /* m/s */
};

static struct outside outside_of(const struct surroundings *around, double t) {
    double wind[3], style[3];
    wind_velocity(&around->wind, t, wind);
    style_acceleration(&around->style, t, style);
    return (struct outside){vec_all(around->gravity), vec_all(style), vec_all(wind)};
}

/* The treatment's power on a sample by its mass; `turning` is a', `a` the node's acceleration,
 * `bodies` what they do to the sample. See above. */
static lane treatment_power(const struct kernel_part *part, const struct sample *s,
                            struct vec turning, struct vec velocity, struct vec a,
                            const struct outside *outside, const struct pushed *bodies) {
    if (part->treatment == WISP_PENALTY)
        return (part->spring_k * (s->r - part->radius) - part->penalty_k * s->r) *
               dot(s->off, turning);
    const struct vec fields = add(outside->gravity, bodies->elastic);
    const lane turned = s->rate * dot(velocity, turning) - s->r * dot(fields, turning);
    if (part->treatment == WISP_GENERALISED)
        return turned;
    const struct vec air = scale(part->drag, sub(outside->wind, s->velocity));
    const struct vec push =
        add(add(add(outside->gravity, outside->style), air), bodies->acceleration);
    const struct vec lost = add_scaled(push, -dot(push, s->line), s->line);
    return turned + dot(s->velocity, a) - dot(velocity, lost);
}

static void add_pushed(const struct pushed *bodies, lane mass, struct lane_powers *sum) {
    sum->body_damping += mass * bodies->loss;
    sum->bodies += mass * bodies->work;
}

static void node_powers(struct kernel_part *part, int i, double t, const double *q, const double *v,
                        const double *a, const struct outside *outside, const struct frame *turning,
                        struct lane_powers *sum) {
    const struct vec p = vec_load(q, 0), velocity = vec_load(v, 0);
    const lane mass = part->mass[i], mu = part->sample_mass[i];
    const struct pushed own = pushed_by_bodies(part, t, p, velocity);
    add_pushed(&own, mass, sum);
    sum->drag += mass * part->drag * dot(sub(outside->wind, velocity), velocity);
    sum->style += mass * dot(outside->style, velocity);
    for (int j = 0; j < part->samples; j++) {
        const struct sample s = sample_of(part, &part->frames[i], j, q, v);
        const struct vec turn = half_line(part, turning, j, part->samples);
        const struct pushed bodies = pushed_by_bodies(part, t, add(p, s.d), s.velocity);
        add_pushed(&bodies, mu, sum);
        sum->drag += mu * part->drag * dot(sub(outside->wind, s.velocity), s.velocity);
        sum->style += mu * dot(outside->style, s.velocity);
        sum->envelope_damping -=
            mu * (part->spring_c * s.rate * s.rate + part->penalty_c * square(s.off_rate));
        sum->treatment +=
            mu * treatment_power(part, &s, turn, velocity, vec_load(a, 0), outside, &bodies);
    }
}

int LANED(kernel_powers)(void *ctx, double t, const double *q, const double *v,
                         struct powers *powers) {
    struct copy copy;
    struct lane_powers sum;
    int code = make_copy(ctx, &copy);
    if (code)
        return code;
    struct kernel_part *part = &copy.part;
    /* leaves the head, the springs' forces, tangents and frames of this state too */
    code = LANED(kernel_acceleration)(part, t, q, v, copy.acceleration);
    if (code)
        return code;
    const struct outside everywhere = outside_of(part->surroundings, t);
    struct frame turning = first_frame_rate(part);
    memset(&sum, 0, sizeof sum);
    spring_powers(part, q, v, &sum);
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        struct outside outside = everywhere;
        if (has_parting(part))
            outside.style = add_scaled(outside.style, parting_side(part, vec_load(q + at, 0)),
                                       parting_strength(part, t));
        if (part->samples > 0)
            turning = frame_rate(part, i, q, v, turning);
        node_powers(part, i, t, q + at, v + at, copy.acceleration + at, &outside, &turning, &sum);
    }
#define X(name, meaning) powers->name = sum_of_wisps(part, sum.name);
    POWERS(X)
#undef X
    return 0;
}
