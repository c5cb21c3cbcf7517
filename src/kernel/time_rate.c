/* How accelerations change with time while the free nodes and samples stay as they are: by the two
 * nodes that the head moves, by its turning, which turns the frames, and by wind and style. Each
 * quantity that forces.c makes on its way is followed here by its rate, x_t. */
#include "frames.h"
#include "matrix.h"
#include "part.h"
#include "parting.h"
#include "push.h"
#include "springs.h"

/* --- springs --- */

/* What the head does: velocities and accelerations of nodes 0 and 1. */
struct carriers {
    struct vec v[2], a[2];
};

/* The rate of x / |x|, with n that direction: P x_t / |x|. */
static struct vec direction_rate(struct vec n, lane inverse, struct vec x_t) {
    return scale(inverse, add_scaled(x_t, -dot(n, x_t), n));
}

/* The rate of what a spring puts on its first node, which goes with velocity v and acceleration a
 * while the last one stays. */
static struct vec spring_rate(const struct reach *r, lane rest, lane k, lane c, struct vec v,
                              struct vec a) {
    const struct vec n_t = scale(lane_all(-1), direction_rate(r->n, r->inverse, v));
    const lane tension = k * (r->length - rest) + c * dot(r->velocity, r->n);
    const lane tension_t = c * (dot(r->velocity, n_t) - dot(a, r->n)) - k * dot(v, r->n);
    return add(scale(tension_t, r->n), scale(tension, n_t));
}

/* The rates of the springs' forces on nodes 2 and 3, which alone have springs to the head's. */
static void spring_rates(const struct kernel_part *part, const struct carriers *head,
                         const double *q, const double *v, struct vec on[2]) {
    const int last = part->nodes - 1, stride = part->node_unknowns;
    const struct vec p2 = vec_load(q, 0), v2 = vec_load(v, 0);
    const struct vec p3 = last > 2 ? vec_load(q, stride) : p2,
                     v3 = last > 2 ? vec_load(v, stride) : v2;
    mask sound = lane_all(0) == 0;
    const struct reach segment = reach(part->p[1], p2, part->v[1], v2, &sound);
    const struct vec zero = {lane_all(0), lane_all(0), lane_all(0)};
    on[0] = scale(lane_all(-1), spring_rate(&segment, part->spacing, part->stretch_k,
                                            part->stretch_c, head->v[1], head->a[1]));
    on[1] = zero;
    if (part->bending == BENDING_SKIP)
        for (int i = 0; i < 2 && i + 2 <= last; i++) {
            const struct reach skip =
                reach(part->p[i], i ? p3 : p2, part->v[i], i ? v3 : v2, &sound);
            on[i] = sub(on[i], spring_rate(&skip, part->skip_length, part->bend_k, part->bend_c,
                                           head->v[i], head->a[i]));
        }
    if (part->bending != BENDING_HINGE)
        return;
    /* edges: from node 0 to 1, which only turns; from node 1 to 2; from node 2 to 3, which stays */
    const struct reach first = first_segment(part), after = reach(p2, p3, v2, v3, &sound);
    const struct edge_rate rates[3] = {
        {sub(head->v[1], head->v[0]), sub(head->a[1], head->a[0])},
        {scale(lane_all(-1), head->v[1]), scale(lane_all(-1), head->a[1])},
        {zero, zero}};
    const struct hinge at_1 = LANED(kernel_hinge_rate)(part, &first, &segment, &rates[0]);
    on[0] = add(on[0], at_1.on_b);
    if (last > 2) {
        const struct hinge at_2 = LANED(kernel_hinge_rate)(part, &segment, &after, &rates[1]);
        on[0] = add(on[0], sub(at_2.on_a, at_2.on_b));
        on[1] = add(on[1], at_2.on_b);
    }
}

/* --- frames --- */

/* w_t of a node between two segments, of which the one before turns. */
static struct vec bisector_rate(struct vec before, struct vec after, struct vec w,
                                struct vec before_t, struct vec last_t) {
    const struct vec sum = add(before, after);
    const lane length = lane_sqrt(dot(sum, sum));
    return vec_select(length > 1e-9, direction_rate(w, 1 / length, before_t), last_t);
}

/* u_t of a node from that of the one before, along the least rotation that carry_frame does. */
static struct vec carried_rate(const struct frame *before, const struct frame *before_t,
                               const struct frame *f, const struct frame *f_t) {
    const struct vec s = add(before->w, f->w), s_t = add(before_t->w, f_t->w);
    const lane d = 1 + dot(before->w, f->w);
    const lane d_t = dot(before_t->w, f->w) + dot(before->w, f_t->w);
    const lane on = dot(before->u, f->w);
    const lane on_t = dot(before_t->u, f->w) + dot(before->u, f_t->w);
    const struct vec change = add_scaled(scale((on_t - on * d_t / d) / d, s), on / d, s_t);
    return vec_select(d > 1e-9, sub(before_t->u, change), before_t->u);
}

/* --- nodes --- */

/* What does not come from springs: the outer acceleration of a node, and its rate. */
struct outer {
    struct vec G, G_t;
};

SPECIALISED void projection_rate(const struct kernel_part *part, int i, const struct frame *f,
                                 const struct frame *f_t, const struct outer *out, const double *q,
                                 const double *v, struct vec *a, struct vec *a_t, double *to) {
    const lane ratio = part->sample_mass[i] * part->inverse_mass[i];
    const lane along_u = dot(out->G_t, f->u) + dot(out->G, f_t->u);
    const lane along_v = dot(out->G_t, f->v) + dot(out->G, f_t->v);
    for (int j = 0; j < part->samples; j++) {
        const lane s =
            part->spring_k * (part->radius - load(q, 3 + j)) - part->spring_c * load(v, 3 + j);
        *a = add_scaled(*a, -ratio * s, half_line(part, f, j, part->samples));
        *a_t = add_scaled(*a_t, -ratio * s, half_line(part, f_t, j, part->samples));
        store(to, 3 + j, along(part, j, part->samples, along_u, along_v));
    }
}

SPECIALISED void generalised_rate(const struct kernel_part *part, int i, const struct frame *f,
                                  const struct frame *f_t, const struct outer *out, const double *q,
                                  const double *v, struct vec *a, struct vec *a_t, double *to) {
    const lane half = 0.5 * part->samples * part->sample_mass[i] * part->inverse_mass[i];
    const struct vec w = f->w, w_t = f_t->w, G = out->G, G_t = out->G_t;
    projection_rate(part, i, f, f_t, out, q, v, a, a_t, to);
    const lane wG = dot(w, G), wG_t = dot(w_t, G) + dot(w, G_t);
    const struct vec right = add_scaled(add_scaled(*a, half, G), half * wG, w);
    const struct vec right_t =
        add_scaled(add_scaled(add_scaled(*a_t, half, G_t), half * wG_t, w), half * wG, w_t);
    const lane across = 1 / (1 + half), more = 1 / (1 + 2 * half) - across;
    const lane on = dot(w, right), on_t = dot(w_t, right) + dot(w, right_t);
    *a = add_scaled(scale(across, right), more * on, w);
    *a_t = add_scaled(add_scaled(scale(across, right_t), more * on_t, w), more * on, w_t);
    const lane au = dot(*a_t, f->u) + dot(*a, f_t->u), av = dot(*a_t, f->v) + dot(*a, f_t->v);
    for (int j = 0; j < part->samples; j++)
        store(to, 3 + j, load(to, 3 + j) - along(part, j, part->samples, au, av));
}

SPECIALISED void penalty_rate(const struct kernel_part *part, int i, const struct frame *f,
                              const struct frame *f_t, const struct outer *out, const double *q,
                              const double *v, struct vec *a_t, double *to) {
    const lane ratio = part->sample_mass[i] * part->inverse_mass[i];
    const lane k = part->penalty_k - part->spring_k, c = part->penalty_c - part->spring_c;
    for (int j = 0; j < part->samples; j++) {
        const struct vec line = half_line(part, f, j, part->samples);
        const struct vec line_t = half_line(part, f_t, j, part->samples);
        const struct vec d = sub(vec_load(q, 3 + 3 * j), vec_load(q, 0));
        const struct vec d_v = sub(vec_load(v, 3 + 3 * j), vec_load(v, 0));
        const lane on = part->spring_k * part->radius + k * dot(d, line) + c * dot(d_v, line);
        const lane on_t = k * dot(d, line_t) + c * dot(d_v, line_t);
        const struct vec spring_t = add_scaled(scale(on_t, line), on, line_t);
        vec_store(to, 3 + 3 * j, add(out->G_t, spring_t));
        *a_t = add_scaled(*a_t, -ratio, spring_t);
    }
}

/* What is the same everywhere: accelerations and the air's velocity, and the rates of both
 * together; of a parting its strength and that's rate. */
struct everywhere {
    struct vec g, wind, rate, parting, parting_t;
};

/* From the root to the tip; springs' forces are in part->force. */
static void node_rates(struct kernel_part *part, const struct vec on[2], struct frame before_t,
                       struct vec t_t, const struct everywhere *all, const double *q,
                       const double *v, double *rate) {
    const struct vec zero = {lane_all(0), lane_all(0), lane_all(0)};
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        const struct frame *f = &part->frames[i];
        const lane side = has_parting(part) ? parting_side(part, vec_load(q + at, 0)) : lane_all(0);
        const struct vec air = sub(all->wind, vec_load(v + at, 0));
        const struct outer out = {
            add_scaled(add_scaled(all->g, side, all->parting), part->drag, air),
            add_scaled(all->rate, side, all->parting_t)};
        struct vec a = add_scaled(out.G, part->inverse_mass[i], part->force[i]);
        struct vec a_t = out.G_t;
        if (i < 4)
            a_t = add_scaled(a_t, part->inverse_mass[i], on[i - 2]);
        if (part->samples > 0) {
            struct frame f_t;
            f_t.w = i == part->nodes - 1
                        ? t_t
                        : bisector_rate(part->t[i - 1], part->t[i], f->w, t_t, before_t.w);
            f_t.u = carried_rate(&part->frames[i - 1], &before_t, f, &f_t);
            f_t.v = add(cross(f_t.w, f->u), cross(f->w, f_t.u));
            if (part->treatment == WISP_PROJECTION)
                projection_rate(part, i, f, &f_t, &out, q + at, v + at, &a, &a_t, rate + at);
            else if (part->treatment == WISP_GENERALISED)
                generalised_rate(part, i, f, &f_t, &out, q + at, v + at, &a, &a_t, rate + at);
            else
                penalty_rate(part, i, f, &f_t, &out, q + at, v + at, &a_t, rate + at);
            before_t = f_t;
            t_t = zero; /* of later segments */
        }
        vec_store(rate + at, 0, a_t);
    }
}

void LANED(kernel_time_rate)(void *ctx, double t, const double *q, const double *v, double *rate) {
    struct kernel_part *part = ctx;
    const struct surroundings *around = part->surroundings;
    const struct system *system = part->system;
    const double inside = system->until > 0 ? (system->from + system->until) / 2 : t;
    const struct carriers head = {{part->v[0], part->v[1]},
                                  {LANED(kernel_carried_acceleration)(part, t, 0),
                                   LANED(kernel_carried_acceleration)(part, t, 1)}};
    double wind[3] = {0}, wind_t[3] = {0}, style[3], style_t[3], parting[3], parting_t[3];
    struct vec on[2];
    struct frame turn = {LANED(kernel_turning)(part, part->rest_normal),
                         {lane_all(0), lane_all(0), lane_all(0)},
                         LANED(kernel_turning)(part, part->rest_tangent)};
    if (around->wind.kind != WIND_NONE) {
        wind_velocity(&around->wind, t, wind);
        wind_rate(&around->wind, inside, t, wind_t);
    }
    style_acceleration(&around->style, t, style);
    style_rate(&around->style, inside, style_t);
    style_parting(&around->style, t, parting);
    style_parting_rate(&around->style, inside, parting_t);
    const struct everywhere all = {.g = add(vec_all(around->gravity), vec_all(style)),
                                   .wind = vec_all(wind),
                                   .rate =
                                       add_scaled(vec_all(style_t), part->drag, vec_all(wind_t)),
                                   .parting = vec_all(parting),
                                   .parting_t = vec_all(parting_t)};
    spring_rates(part, &head, q, v, on);
    const struct vec p2 = vec_load(q, 0), d = sub(p2, part->p[1]);
    const struct vec t_t =
        scale(lane_all(-1), direction_rate(part->t[1], 1 / lane_sqrt(dot(d, d)), head.v[1]));
    node_rates(part, on, turn, t_t, &all, q, v, rate);
    if (part->push && !part->push->rest)
        LANED(kernel_push_rate)(part, t, inside < t ? -1 : 1, q, v, rate);
}
