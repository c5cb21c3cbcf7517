#include "push.h"

#include "frames.h"
#include "matrix.h"
#include "room.h"
#include "span.h"
#include "tension.h"
#include "wisp/body.h"

/* --- room --- */

size_t LANED(kernel_penetrations_size)(const struct kernel_part *part) {
    const size_t f = (size_t)free_nodes(part), points = f * (size_t)(1 + part->samples);
    return f + points * sizeof(struct penetration) / sizeof(lane);
}

struct penetrations LANED(kernel_penetrations_in)(const struct kernel_part *part, lane *room) {
    return (struct penetrations){room, (struct penetration *)(room + free_nodes(part))};
}

/* What of a body does not depend on where it is. */
static struct pusher pusher_of(const struct body *body) {
    struct pusher pusher = {.inverse_least = 0};
    const double omega = 2 * M_PI * body->frequency;
    for (int k = 0; k < 3; k++) {
        pusher.inverse[k] = 1 / body->radii[k];
        pusher.inverse_least = fmax(pusher.inverse_least, pusher.inverse[k]);
    }
    pusher.stiffness = omega * omega / (pusher.inverse_least * pusher.inverse_least);
    pusher.damping = 2 * body->damping_ratio * omega;
    pusher.friction = body->friction;
    return pusher;
}

struct kernel_push *LANED(kernel_push_create)(const struct kernel_part *part) {
    const struct surroundings *around = part->surroundings;
    const size_t count = (size_t)around->pushing_count, points = 1 + (size_t)part->samples;
    const size_t unknowns = (size_t)(free_nodes(part) * part->node_unknowns);
    const size_t lanes = 3 * points + 2 * unknowns + LANED(kernel_penetrations_size)(part);
    lane *room;
    struct kernel_push *push = room_of(sizeof *push + count * sizeof(struct pusher), lanes, &room);
    if (!push)
        return NULL;
    push->on = room_take(&room, 3 * points);
    push->v = room_take(&room, unknowns);
    push->spare = room_take(&room, unknowns);
    push->penetrations = LANED(kernel_penetrations_in)(part, room);
    push->count = around->pushing_count;
    push->rest = around->head.knots <= 1;
    push->time = NAN;
    for (int b = 0; b < push->count; b++) {
        push->pusher[b] = pusher_of(&around->pushing[b]);
        for (int k = 0; k < 3; k++)
            push->rest &= around->pushing[b].velocity[k] == 0;
    }
    return push;
}

/* --- where bodies are --- */

/* Places the bodies of one lane. */
static void place(const struct kernel_part *part, int k, double t, const struct placement *head) {
    const struct surroundings *around = part->surroundings;
    double origin[3];
    vec_get(origin, part->origin, k);
    for (int b = 0; b < part->push->count; b++) {
        struct pusher *pusher = &part->push->pusher[b];
        const struct body *body = &around->pushing[b];
        const struct body_motion motion = body_motion(body, head, t);
        double box[6], centre[3], half[3];
        body_box(body, &motion, box);
        pusher->turned = 0;
        for (int c = 0; c < 3; c++) {
            centre[c] = motion.centre[c] - origin[c];
            half[c] = (box[3 + c] - box[c]) / 2;
        }
        vec_set(&pusher->centre, k, centre);
        vec_set(&pusher->half, k, half);
        vec_set(&pusher->velocity, k, motion.velocity);
        vec_set(&pusher->spin, k, motion.spin);
        for (int r = 0; r < 3; r++) {
            const double axis[3] = {motion.axes[0][r], motion.axes[1][r], motion.axes[2][r]};
            vec_set(&pusher->axes[r], k, axis);
        }
        pusher->turned = around->head.knots > 0;
    }
}

static void place_all(struct kernel_part *part, double t) {
    struct kernel_push *push = part->push;
    const double *times = part->system->times;
    const int moving = !push->rest;
    if (!isnan(push->time) && (!moving || (!times && push->time == t)))
        return;
    for (int k = 0; k < LANES; k++) {
        struct placement head;
        head_placement(&part->surroundings->head, times ? times[k] : t, &head);
        place(part, k, times ? times[k] : t, &head);
    }
    push->time = times && moving ? NAN : t;
}

/* --- a point in a body --- */

/* All of it is used in lanes only that are inside. */
struct contact {
    mask inside, pushes;     /* sigma < 1; and the normal part is not negative */
    lane depth, slope;       /* 1 - sigma, |grad sigma| in 1/m */
    lane share;              /* s */
    lane elastic, normal;    /* omega^2 R_m^2 (1 - sigma) |grad sigma|, and less the damping */
    lane away;               /* u.n */
    struct vec n, u, across; /* u_t */
    lane sigma;
};

static struct vec rotated(const struct pusher *body, struct vec x) {
    if (!body->turned)
        return x;
    return (struct vec){dot(body->axes[0], x), dot(body->axes[1], x), dot(body->axes[2], x)};
}

static struct vec rotated_back(const struct pusher *body, struct vec x) {
    if (!body->turned)
        return x;
    return add_scaled(add_scaled(scale(x.x, body->axes[0]), x.y, body->axes[1]), x.z,
                      body->axes[2]);
}

/* From the centre, where the body is the unit sphere. */
static struct vec on_sphere(const struct pusher *body, struct vec p) {
    const struct vec x = rotated(body, sub(p, body->centre));
    return (struct vec){body->inverse[0] * x.x, body->inverse[1] * x.y, body->inverse[2] * x.z};
}

/* Whether the unit sphere holds y, but for its centre. */
static mask holds(struct vec y) {
    const lane square = dot(y, y);
    return (square < 1) & (square >= 1e-12);
}

static struct contact contact_of(const struct pusher *body, struct vec y, struct vec p,
                                 struct vec v) {
    struct contact c;
    const struct vec gradient = {body->inverse[0] * y.x, body->inverse[1] * y.y,
                                 body->inverse[2] * y.z}; /* of sigma^2 / 2 */
    const lane length = lane_sqrt(dot(gradient, gradient));
    c.sigma = lane_sqrt(dot(y, y));
    c.inside = (c.sigma < 1) & (c.sigma >= 1e-6);
    c.depth = 1 - c.sigma;
    c.slope = length / c.sigma;
    c.share = lane_min(c.depth / 0.05, lane_all(1));
    c.n = rotated_back(body, scale(1 / length, gradient));
    const struct vec from = sub(p, body->centre);
    c.u = sub(v, add(body->velocity, cross(body->spin, from)));
    c.away = dot(c.u, c.n);
    c.across = add_scaled(c.u, -c.away, c.n);
    c.elastic = body->stiffness * c.depth * c.slope;
    c.normal = c.elastic - body->damping * c.share * c.away;
    c.pushes = c.normal > 0;
    c.normal = lane_select(c.pushes, c.normal, lane_all(0));
    return c;
}

static struct vec acceleration_of(const struct pusher *body, const struct contact *c) {
    return add_scaled(scale(c->normal, c->n), -c->share * body->friction, c->across);
}

/* --- its derivatives --- */

/* Second derivative of sigma: (A - grad sigma grad sigma') / sigma, where A has 1 / R_k^2 in the
 * body's axes. */
static struct block curvature(const struct pusher *body, const struct contact *c) {
    const struct vec g = scale(c->slope, c->n);
    struct block h = {0};
    EACH (k, 0, 3) {
        const struct vec unit = {lane_all(k == 0), lane_all(k == 1), lane_all(k == 2)};
        const struct vec axis = body->turned ? body->axes[k] : unit;
        const struct block outer = block_outer(lane_all(1), axis, axis);
        block_add_scaled(&h, lane_all(body->inverse[k] * body->inverse[k]), &outer);
    }
    const struct block along = block_outer(lane_all(1), g, g);
    block_add_scaled(&h, lane_all(-1), &along);
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            h.m[i][j] = h.m[i][j] / c->sigma;
    return h;
}

/* The derivative by the position of  max(0, N) n - s f u_t.  With g = |grad sigma|, H its second
 * derivative and P = 1 - nn', n changes by Q = P H / g, u by -W, where W x = spin x x, and
 *   N   by  omega^2 R_m^2 (-g g' + (1 - sigma) n'H) - 2 zeta omega ((u.n) s' + s (u'Q - n'W)),
 *   s   by  -20 grad sigma where it is below 1,
 *   u_t by  -W - n (u'Q - n'W) - (u.n) Q. */
static struct block slope_of(const struct pusher *body, const struct contact *c) {
    const lane x[3] = {body->spin.x, body->spin.y, body->spin.z}, zero = lane_all(0);
    const struct block H = curvature(body, c);
    const struct block W = {{{zero, -x[2], x[1]}, {x[2], zero, -x[0]}, {-x[1], x[0], zero}}};
    const struct vec nH = transposed_times(&H, c->n), nW = transposed_times(&W, c->n);
    const struct vec gradient = scale(c->slope, c->n);
    const struct vec s = scale(lane_select(c->share < 1, lane_all(-20), zero), gradient);
    struct block Q = H;
    const struct block along = block_outer(lane_all(1), c->n, nH);
    block_add_scaled(&Q, lane_all(-1), &along);
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            Q.m[i][j] = Q.m[i][j] / c->slope;
    const struct vec away = sub(transposed_times(&Q, c->u), nW); /* of u.n */
    const struct vec pull =
        scale(lane_all(body->stiffness), add_scaled(scale(-c->slope, gradient), c->depth, nH));
    const struct vec loss = add_scaled(scale(c->away, s), c->share, away);
    const struct vec N = add_scaled(pull, lane_all(-body->damping), loss);
    const lane pushes = lane_select(c->pushes, lane_all(1), zero);
    const lane rubbing = c->share * body->friction;

    struct block d = block_outer(lane_all(1), scale(pushes, c->n), N);
    const struct block slipping = block_outer(lane_all(1), c->across, s),
                       turning = block_outer(lane_all(1), c->n, away);
    block_add_scaled(&d, c->normal, &Q);
    block_add_scaled(&d, lane_all(-body->friction), &slipping);
    block_add_scaled(&d, rubbing, &W);
    block_add_scaled(&d, rubbing, &turning);
    block_add_scaled(&d, rubbing * c->away, &Q);
    return d;
}

/* Adds to the penetration of a point; a: the line of a sample of which only that counts, or NULL.
 */
static void add_penetration(struct penetration *to, const struct pusher *body,
                            const struct contact *c, enum jacobian kind, const struct vec *a) {
    const lane zero = lane_all(0), one = lane_all(1);
    const lane rubbing = c->share * body->friction;
    const lane damping = lane_select(c->pushes, body->damping * c->share, zero);
    struct block nn = block_outer(lane_all(1), c->n, c->n), D = {0}, E = {0};
    block_add_scaled(&D, damping - rubbing, &nn);
    block_add_diagonal(&D, rubbing);
    if (kind == JACOBIAN_EXACT) {
        const struct block slope = slope_of(body, c);
        block_add_scaled(&E, -one, &slope);
    } else {
        const lane k = body->stiffness * c->slope * c->slope;
        block_add_scaled(&E, lane_select(c->pushes, k, zero), &nn);
    }
    if (a) {
        const struct block line = block_outer(lane_all(1), *a, *a);
        const lane d = dot(*a, block_times(&D, *a)), e = dot(*a, block_times(&E, *a));
        D = E = (struct block){0};
        block_add_scaled(&D, d, &line);
        block_add_scaled(&E, e, &line);
    }
    to->inside = lane_select(c->inside, one, to->inside);
    EACH (i, 0, 3)
        EACH (j, 0, 3) {
            to->damping.m[i][j] += lane_select(c->inside, D.m[i][j], zero);
            to->stiffness.m[i][j] += lane_select(c->inside, E.m[i][j], zero);
        }
}

/* --- along the wisp --- */

/* A node's points, in the order of their penetrations: where they are, and how they move. */
struct points {
    struct vec p[1 + SAMPLES_MAX], v[1 + SAMPLES_MAX], line[SAMPLES_MAX];
};

static void find_points(const struct kernel_part *part, const struct frame *frame, const double *q,
                        const double *v, struct points *points) {
    points->p[0] = vec_load(q, 0);
    points->v[0] = vec_load(v, 0);
    for (int j = 0; j < part->samples; j++) {
        const struct vec line = half_line(part, frame, j, part->samples);
        points->line[j] = line;
        if (part->treatment == WISP_PENALTY) {
            points->p[1 + j] = vec_load(q, 3 + 3 * j);
            points->v[1 + j] = vec_load(v, 3 + 3 * j);
        } else {
            points->p[1 + j] = add_scaled(points->p[0], load(q, 3 + j), line);
            points->v[1 + j] = add_scaled(points->v[0], load(v, 3 + j), line);
        }
    }
}

/* No sample of any node is further from its node. */
static lane farthest(const struct kernel_part *part, const double *q) {
    lane most = lane_all(0);
    for (int at = 0; at < free_nodes(part) * part->node_unknowns; at += part->node_unknowns)
        for (int j = 0; j < part->samples; j++) {
            lane square;
            if (part->treatment == WISP_PENALTY) {
                const struct vec d = sub(vec_load(q, at + 3 + 3 * j), vec_load(q, at));
                square = dot(d, d);
            } else {
                square = load(q, at + 3 + j) * load(q, at + 3 + j);
            }
            most = lane_max(square, most);
        }
    return lane_sqrt(most);
}

/* The bodies that a part may touch, and how far a sample is from its node at most. */
struct nearby {
    const struct pusher *body[BODIES_MAX];
    int count;
    lane reach;
};

/* A part in a million more, so that rounding loses nobody. */
static void find_near(const struct kernel_part *part, const double *q, struct nearby *near) {
    const struct kernel_push *push = part->push;
    const struct span span = span_from_origin(part, q);
    near->count = 0;
    near->reach = (1 + 1e-6) * farthest(part, q);
    for (int b = 0; b < push->count; b++) {
        const struct pusher *body = &push->pusher[b];
        const struct vec margin = {near->reach, near->reach, near->reach};
        const struct vec low = sub(sub(body->centre, body->half), margin);
        const struct vec high = add(add(body->centre, body->half), margin);
        const mask apart = (span.high.x < low.x) | (span.high.y < low.y) | (span.high.z < low.z) |
                           (span.low.x > high.x) | (span.low.y > high.y) | (span.low.z > high.z);
        if (!mask_all(apart))
            near->body[near->count++] = body;
    }
}

/* Whether a node and all its samples are outside: a body that holds one of these would hold the
 * node if it were scaled by 1 + reach / its least radius. */
static mask out_of_reach(const struct pusher *body, struct vec y, lane reach) {
    const lane scaled = 1 + 1e-9 + reach * body->inverse_least;
    return dot(y, y) >= scaled * scaled;
}

/* Forgets the last state's. */
static void clear_penetrations(const struct kernel_part *part, struct penetrations *to) {
    const size_t points = 1 + (size_t)part->samples;
    for (int i = 0; i < free_nodes(part); i++) {
        if (mask_none(to->any[i] != 0))
            continue;
        to->any[i] = lane_all(0);
        memset(to->point + (size_t)i * points, 0, points * sizeof *to->point);
    }
}

/* All points of a node against a body; adds their accelerations to `on`, or where that is NULL
 * their Jacobians to `to`. Returns the lanes in which it holds one. */
static mask add_penetrations(const struct kernel_part *part, const struct pusher *body,
                             const struct points *points, enum jacobian kind,
                             struct penetration *to, struct vec *on) {
    const int line_only = part->treatment == WISP_PROJECTION && kind == JACOBIAN_SPD;
    mask inside = lane_all(0) != 0;
    for (int j = 0; j <= part->samples; j++) {
        const struct vec y = on_sphere(body, points->p[j]);
        if (mask_none(holds(y)))
            continue;
        const struct contact c = contact_of(body, y, points->p[j], points->v[j]);
        inside |= c.inside;
        if (on)
            on[j] = vec_select(c.inside, add(on[j], acceleration_of(body, &c)), on[j]);
        else
            add_penetration(&to[j], body, &c, kind,
                            line_only && j > 0 ? &points->line[j - 1] : NULL);
    }
    return inside;
}

/* The accelerations of a node's unknowns by those of its points: what a force on the samples does
 * to the node is in forces.c, treatment by treatment. */
static void move_node(const struct kernel_part *part, int i, mask inside, const struct vec *on,
                      const struct points *points, double *a) {
    const int coupled = is_coupled(part);
    struct vec change = on[0];
    if (coupled) {
        struct vec force = scale(part->mass[i], on[0]);
        for (int j = 0; j < part->samples; j++)
            force = add_scaled(
                force, part->sample_mass[i],
                add_scaled(on[1 + j], -dot(on[1 + j], points->line[j]), points->line[j]));
        change = moved(part, i, 1, force);
    }
    const struct vec own = vec_load(a, 0);
    vec_store(a, 0, vec_select(inside, add(own, change), own));
    for (int j = 0; j < part->samples; j++) {
        if (part->treatment == WISP_PENALTY) {
            const struct vec e = vec_load(a, 3 + 3 * j);
            vec_store(a, 3 + 3 * j, vec_select(inside, add(e, on[1 + j]), e));
            continue;
        }
        const lane rate = load(a, 3 + j), more = dot(on[1 + j], points->line[j]);
        const lane lost = coupled ? dot(change, points->line[j]) : lane_all(0);
        store(a, 3 + j, lane_select(inside, rate + (more - lost), rate));
    }
}

/* Bodies being placed and `near` found: adds accelerations to `a`, or where that is NULL Jacobians
 * to `to`, which are cleared. */
static void walk(struct kernel_part *part, const struct nearby *near, enum jacobian kind,
                 const double *q, const double *v, const struct frame *frames,
                 struct penetrations *to, double *a) {
    struct vec *on = a ? part->push->on : NULL;
    struct points points;
    for (int i = 0; i < free_nodes(part) && near->count > 0; i++) {
        const int at = i * part->node_unknowns * LANES;
        const struct vec p = vec_load(q + at, 0);
        struct penetration *own = a ? NULL : to->point + (size_t)i * (size_t)(1 + part->samples);
        mask inside = lane_all(0) != 0;
        int found = 0;
        for (int b = 0; b < near->count; b++) {
            const struct pusher *body = near->body[b];
            if (mask_all(out_of_reach(body, on_sphere(body, p), near->reach)))
                continue;
            if (!found++)
                find_points(part, &frames[i + 2], q + at, v + at, &points);
            if (found == 1 && a)
                memset(on, 0, (size_t)(1 + part->samples) * sizeof *on);
            inside |= add_penetrations(part, body, &points, kind, own, on);
        }
        if (mask_none(inside))
            continue;
        if (a)
            move_node(part, i + 2, inside, on, &points, a + at);
        else
            to->any[i] = lane_select(inside, lane_all(1), to->any[i]);
    }
}

void LANED(kernel_push_accelerate)(struct kernel_part *part, double t, const double *q,
                                   const double *v, double *a) {
    struct kernel_push *push = part->push;
    struct nearby near;
    place_all(part, t);
    find_near(part, q, &near);
    push->near = near.count > 0;
    if (!push->near)
        return;
    memcpy(push->v, v, (size_t)part->system->size * sizeof *v);
    walk(part, &near, JACOBIAN_SPD, q, v, part->frames, NULL, a);
}

/* One-sided and of second order, from the farthest time to t itself, where all is left. */
void LANED(kernel_push_rate)(struct kernel_part *part, double t, int side, const double *q,
                             const double *v, double *rate) {
    static const double weight[] = {-1.5, 2, -0.5}, step = 1e-6; /* s */
    const int size = part->system->size, carried = part->surroundings->head.knots > 1;
    double *a = part->push->spare;
    for (int k = 2; k >= 0; k--) {
        const double at = t + side * k * step;
        LANED(kernel_prescribe)(part, at);
        if (carried && part->samples > 0)
            LANED(kernel_frames)(part, q, part->frames);
        memset(a, 0, (size_t)size * sizeof *a);
        LANED(kernel_push_accelerate)(part, at, q, v, a);
        for (int i = 0; i < size; i++)
            rate[i] += side * weight[k] / step * a[i];
    }
}

void LANED(kernel_push_penetrations)(struct kernel_part *part, const double *q) {
    struct kernel_push *push = part->push;
    struct nearby near;
    clear_penetrations(part, &push->penetrations);
    if (!push->near)
        return;
    find_near(part, q, &near);
    walk(part, &near, JACOBIAN_SPD, q, push->v, part->frames, &push->penetrations, NULL);
}

void LANED(kernel_push_linearise)(struct kernel_part *part, enum jacobian kind, double t,
                                  const double *q, const double *v, const struct frame *frames,
                                  struct penetrations *to) {
    struct nearby near;
    place_all(part, t);
    clear_penetrations(part, to);
    find_near(part, q, &near);
    walk(part, &near, kind, q, v, frames, to, NULL);
}

/* --- energy --- */

struct pushed LANED(kernel_pushed)(struct kernel_part *part, double t, struct vec p, struct vec v) {
    const lane zero = lane_all(0);
    const struct vec none = {zero, zero, zero};
    struct pushed sum = {zero, none, none, zero, zero};
    place_all(part, t);
    for (int b = 0; b < part->push->count; b++) {
        const struct pusher *body = &part->push->pusher[b];
        const struct contact c = contact_of(body, on_sphere(body, p), p, v);
        const struct vec a = acceleration_of(body, &c), elastic = scale(c.elastic, c.n);
        sum.energy += lane_select(c.inside, 0.5 * body->stiffness * c.depth * c.depth, zero);
        sum.acceleration = vec_select(c.inside, add(sum.acceleration, a), sum.acceleration);
        sum.elastic = vec_select(c.inside, add(sum.elastic, elastic), sum.elastic);
        sum.loss += lane_select(c.inside, dot(sub(a, elastic), c.u), zero);
        sum.work += lane_select(c.inside, dot(a, sub(v, c.u)), zero);
    }
    return sum;
}
