#include "body.h"

#include "base/vector.h"
#include "ellipsoid.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { PASSES = 4 };

/* A fraction of R: no sample comes nearer to its node. */
static const double least_distance = 1e-3;

/* --- small vectors --- */

static void subtract(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++)
        c[k] = a[k] - b[k];
}

/* a + s b */
static void combine(const double a[3], double s, const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++)
        c[k] = a[k] + s * b[k];
}

/* --- where a body is --- */

/* Rest coordinates turn with the head: p = P + Q x gives v = P' + Q' x + Q x', and Q' Q^T is the
 * cross product with the spin. */
struct body_motion body_motion(const struct body *body, const struct placement *head, double t) {
    struct body_motion motion;
    double centre[3], own[3], turning[3][3];
    combine(body->centre, t, body->velocity, centre);
    placed_point(head, 0, centre, motion.centre);
    placed_point(head, 1, centre, motion.velocity);
    placed_direction(head, body->velocity, own);
    combine(motion.velocity, 1, own, motion.velocity);
    memcpy(motion.axes, head->turn[0], sizeof motion.axes);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            turning[i][j] = vector_dot(head->turn[1][i], head->turn[0][j]);
    motion.spin[0] = turning[2][1];
    motion.spin[1] = turning[0][2];
    motion.spin[2] = turning[1][0];
    return motion;
}

struct obstacle body_obstacle(const struct body *body, const struct body_motion *motion) {
    struct obstacle obstacle = {.inverse_least = 0};
    for (int k = 0; k < 3; k++) {
        const double inverse = 1 / body->radii[k];
        obstacle.centre[k] = motion->centre[k];
        obstacle.radii[k] = body->radii[k];
        obstacle.inverse[k] = inverse;
        obstacle.velocity[k] = motion->velocity[k];
        obstacle.spin[k] = motion->spin[k];
        for (int i = 0; i < 3; i++) {
            obstacle.axes[k][i] = motion->axes[i][k];
            obstacle.turned |= motion->axes[i][k] != (i == k);
        }
        if (inverse > obstacle.inverse_least)
            obstacle.inverse_least = inverse;
    }
    return obstacle;
}

void body_to_axes(const struct body_motion *motion, const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++)
        y[k] = motion->axes[0][k] * x[0] + motion->axes[1][k] * x[1] + motion->axes[2][k] * x[2];
}

static void from_axes(const struct body_motion *motion, const double y[3], double x[3]) {
    for (int k = 0; k < 3; k++)
        x[k] = vector_dot(motion->axes[k], y);
}

/* The ellipsoid reaches |(R_1 a_1, R_2 a_2, R_3 a_3)| along an axis of the world whose components
 * along its own are a. A little more, so that a point that counts as inside by rounding is in it.
 */
void body_box(const struct body *body, const struct body_motion *motion, double box[6]) {
    const double *radii = body->radii;
    for (int k = 0; k < 3; k++) {
        const double *a = motion->axes[k], *centre = motion->centre;
        const double reach = hypot(hypot(radii[0] * a[0], radii[1] * a[1]), radii[2] * a[2]);
        const double half =
            reach * (1 + 1e-9) +
            1e-14 * (vector_largest(centre) + vector_largest(radii)); /* of p - c, turned */
        box[k] = centre[k] - half;
        box[3 + k] = centre[k] + half;
    }
}

/* --- nodes --- */

/* A tick's bodies, and where they are. */
struct tick {
    const struct body *bodies;
    const struct body_motion *motion;
    int count;
    const double *gravity;
    double dt;
};

/* Whether a body holds a point; x: from its centre along its axes. */
static int holds(const struct body *body, const struct body_motion *motion, const double p[3],
                 double x[3]) {
    double from[3];
    subtract(p, motion->centre, from);
    body_to_axes(motion, from, x);
    return ellipsoid_contains(body->radii, x);
}

double body_depth(const struct body *body, const struct body_motion *motion, const double p[3]) {
    double x[3], normal[3];
    if (!holds(body, motion, p, x))
        return -1;
    ellipsoid_normal(body->radii, x, normal);
    return ellipsoid_exit(body->radii, x, normal);
}

/* From x by the normal; but out of a body that does not move the way the node came in, if it came
 * in since the last tick. A moving body must not drag nodes along a spring (section 5.4 of the
 * thesis). */
static void exit_point(const struct body *body, const double x[3], const double u[3], double dt,
                       double out[3]) {
    double g[3], back[3] = {-u[0], -u[1], -u[2]};
    ellipsoid_normal(body->radii, x, g);
    if (!body->moves && vector_dot(u, g) < 0) {
        const double s = ellipsoid_exit(body->radii, x, back); /* in units of ||u||: seconds */
        if (s <= dt) {
            combine(x, s, back, out);
            return;
        }
    }
    combine(x, ellipsoid_exit(body->radii, x, g), g, out);
}

/* The change of u by friction and elasticity, none where the node leaves already. `lift`, m^2/s^2,
 * is what gravity does by mass on the way from where the node is to the surface: it comes back with
 * a share of the speed that it had there. (With a share of the speed at the tick, which is larger,
 * a ball of elasticity 1 dropped from 0.1 m reaches 0.25 m within 27 bounces, and one of 0.9 never
 * comes to rest.) */
static void bounce(const struct body *body, const double u[3], const double n[3], double lift,
                   double dt, double dv[3]) {
    const double across = vector_dot(u, n), kept = exp(-body->friction * dt);
    const double back = body->elasticity * sqrt(fmax(0, across * across + 2 * lift));
    for (int k = 0; k < 3; k++) {
        const double along = u[k] - across * n[k];
        dv[k] = across < 0 ? kept * along + back * n[k] - u[k] : 0;
    }
}

/* With a small offset rounding could leave a node a hair inside, and friction would act twice. */
static void leave(const struct body *body, const struct body_motion *motion, const double p[3],
                  const double n[3], double dp[3]) {
    double step =
        DBL_EPSILON * (vector_largest(motion->centre) + vector_largest(p) + vector_largest(dp));
    for (int i = 0; i < 64; i++, step *= 2) {
        double there[3], x[3];
        combine(p, 1, dp, there);
        if (!holds(body, motion, there, x))
            return;
        combine(dp, step, n, dp);
    }
}

/* The velocity of a point at p with velocity v as the surface has it, in the world. */
static void relative_velocity(const struct body_motion *motion, const double p[3],
                              const double v[3], double u[3]) {
    double from[3], turning[3], surface[3];
    subtract(p, motion->centre, from);
    vector_cross(motion->spin, from, turning);
    combine(motion->velocity, 1, turning, surface); /* v_c + omega x (p - c) */
    subtract(v, surface, u);
}

/* Returns whether the node was inside. All but the ends is along the body's axes. */
static int push_node(struct strand *strand, int node, const struct body *body,
                     const struct body_motion *motion, const struct tick *tick) {
    double x[3], relative[3], u[3], g[3], out[3], n[3], by[3], change[3], normal[3], dp[3], dv[3];
    if (!holds(body, motion, strand->p[node], x))
        return 0;
    relative_velocity(motion, strand->p[node], strand->v[node], relative);
    body_to_axes(motion, relative, u);
    body_to_axes(motion, tick->gravity, g);
    exit_point(body, x, u, tick->dt, out);
    ellipsoid_normal(body->radii, out, n);
    subtract(out, x, by);
    bounce(body, u, n, vector_dot(g, by), tick->dt, change);
    combine(out, body->offset, n, out);
    subtract(out, x, by);
    from_axes(motion, by, dp);
    from_axes(motion, change, dv);
    from_axes(motion, n, normal);
    leave(body, motion, strand->p[node], normal, dp);
    strand_move_node(strand, node, dp, dv);
    return 1;
}

/* One pass over the bodies in the order of the list. */
static int push_from_all(struct strand *strand, int node, const struct tick *tick) {
    int pushed = 0;
    for (int i = 0; i < tick->count; i++)
        pushed += push_node(strand, node, &tick->bodies[i], &tick->motion[i], tick);
    return pushed;
}

/* Out of one body can be into the next: passes until none holds the node. */
static int push_nodes(struct strand *strand, const struct tick *tick) {
    int pushed = 0;
    for (int node = 2; node < strand->wisp->nodes; node++) {
        int last = 1;
        for (int pass = 0; pass < PASSES && last; pass++) {
            last = push_from_all(strand, node, tick);
            pushed += last;
        }
    }
    return pushed;
}

static int is_inside(const struct strand *strand, int node, const struct tick *tick) {
    for (int i = 0; i < tick->count; i++) {
        double x[3];
        if (holds(&tick->bodies[i], &tick->motion[i], strand->p[node], x))
            return 1;
    }
    return 0;
}

/* --- samples --- */

/* Returns whether the sample was inside. One behind its node (r <= 0) has no crossing ahead of the
 * node and is left to the clamp that follows. */
static int pull_sample(struct strand *strand, int node, int sample, const struct body *body,
                       const struct body_motion *motion) {
    const int at = node * strand->wisp->samples + sample;
    const double r = strand->r[at];
    double line[3], a[3], from[3], x[3], end[3], u[3];
    strand_half_line(strand, node, sample, line);
    holds(body, motion, strand->p[node], from);
    body_to_axes(motion, line, a);
    combine(from, r, a, x);
    if (r <= 0 || !ellipsoid_contains(body->radii, x))
        return 0;
    combine(strand->p[node], r, line, end);
    relative_velocity(motion, end, strand->v[node], u);
    /* a crossing beyond r, or none, is rounding where the line grazes */
    const double r1 = fmin(ellipsoid_entry(body->radii, from, a), r);
    strand_set_sample(strand, node, sample, fmax(r1, least_distance * strand->wisp->radius),
                      fmin(strand->rate[at], -vector_dot(u, line)));
    return 1;
}

static int pull_samples(struct strand *strand, int node, const struct tick *tick) {
    int pulled = 0;
    for (int i = 0; i < tick->count; i++)
        for (int j = 0; j < strand->wisp->samples; j++)
            pulled += pull_sample(strand, node, j, &tick->bodies[i], &tick->motion[i]);
    return pulled;
}

/* --- a tick --- */

void body_contact(struct strand *strand, const struct body *bodies,
                  const struct body_motion *motion, int count, const double gravity[3], double dt,
                  struct body_report *report) {
    const struct tick tick = {bodies, motion, count, gravity, dt};
    const int pushed = push_nodes(strand, &tick);
    if (pushed)
        strand_refresh(strand);
    report->nodes += pushed;
    for (int node = 2; node < strand->wisp->nodes; node++) {
        if (is_inside(strand, node, &tick))
            report->inside++;
        else
            report->samples += pull_samples(strand, node, &tick);
    }
}
