/* Body contact at one tick: the ellipsoid, and the response of one wisp against closed forms and
 * against the page's own words written down a second time. */
#include "wisp/body.h"

#include "base/vector.h"
#include "body_oracle.h"
#include "wisp/ellipsoid.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

static void random_vector(unsigned *seed, double size, double x[3]) {
    for (int k = 0; k < 3; k++)
        x[k] = lab_between(seed, -size, size);
}

static void near_vector(const double a[3], double x, double y, double z, double limit,
                        const char *what) {
    const double b[3] = {x, y, z};
    for (int k = 0; k < 3; k++)
        cr_assert(fabs(a[k] - b[k]) <= limit,
                  "%s: (%.17g, %.17g, %.17g), not (%.17g, %.17g, %.17g)", what, a[0], a[1], a[2], x,
                  y, z);
}

/* --- the ellipsoid --- */

Test(body, rays_leave_and_enter_where_the_level_is_zero) {
    unsigned seed = 1;
    int entered = 0, missed = 0;
    for (int i = 0; i < 20000; i++) {
        double radii[3], x[3], d[3];
        for (int k = 0; k < 3; k++) {
            radii[k] = exp(lab_between(&seed, -3, 3));
            x[k] = radii[k] * lab_between(&seed, -1.5, 1.5);
        }
        random_vector(&seed, 1, d);
        cr_assert_eq(ellipsoid_contains(radii, x), twin_level(radii, x, NULL, 0) < 0);
        if (ellipsoid_contains(radii, x)) {
            const double s = ellipsoid_exit(radii, x, d), exact = twin_exit(radii, x, d);
            cr_assert(fabs(s - exact) <= 1e-12 * exact + 1e-15, "exit at %.17g, not %.17g", s,
                      exact);
            continue;
        }
        const double s = ellipsoid_entry(radii, x, d);
        if (s == INFINITY) {
            missed++;
            for (double t = 0; t < 100; t += 0.1)
                cr_assert(twin_level(radii, x, d, t) > -1e-12L, "a crossing is missed");
            continue;
        }
        entered++;
        cr_assert(fabsl(twin_level(radii, x, d, s)) <= 1e-11L, "level %Lg where it enters",
                  twin_level(radii, x, d, s));
        cr_assert(twin_level(radii, x, d, 0.999L * s) > 0, "not the first crossing");
    }
    cr_assert(entered > 1000 && missed > 1000, "%d entered, %d missed", entered, missed);
}

/* Sizes from 1e-150 to 1e150 m: powers of two change nothing but the size, not a bit. */
Test(body, size_does_not_matter) {
    unsigned seed = 2;
    for (int i = 0; i < 1000; i++) {
        double radii[3], x[3], d[3], n[3];
        for (int k = 0; k < 3; k++) {
            radii[k] = exp(lab_between(&seed, -3, 3));
            x[k] = radii[k] * lab_between(&seed, -0.5, 0.5);
        }
        random_vector(&seed, 1, d);
        ellipsoid_normal(radii, x, n);
        const double s = ellipsoid_exit(radii, x, d);
        const double out[3] = {3 * radii[0] * d[0], 3 * radii[1], 3 * radii[2] * d[2]};
        const double in[3] = {-out[0], -out[1], -out[2]};
        const double entry = ellipsoid_entry(radii, out, in);
        for (int power = -500; power <= 500; power += 100) {
            const double f = ldexp(1, power);
            const double r[3] = {f * radii[0], f * radii[1], f * radii[2]};
            const double y[3] = {f * x[0], f * x[1], f * x[2]};
            const double far[3] = {f * out[0], f * out[1], f * out[2]};
            double m[3];
            ellipsoid_normal(r, y, m);
            cr_assert(memcmp(m, n, sizeof m) == 0, "another normal at 2^%d", power);
            cr_assert(ellipsoid_exit(r, y, d) == f * s, "another exit at 2^%d", power);
            cr_assert(ellipsoid_entry(r, far, in) == f * entry, "another entry at 2^%d", power);
        }
    }
}

/* Needles and discs with radii apart by 1e12, points next to the centre: finite, unit, outward. */
Test(body, normals_of_extreme_shapes) {
    unsigned seed = 3;
    for (int i = 0; i < 20000; i++) {
        double radii[3], x[3], n[3];
        for (int k = 0; k < 3; k++) {
            radii[k] = pow(10, lab_between(&seed, -6, 6));
            x[k] =
                radii[k] * lab_between(&seed, -1, 1) * pow(10, -floor(lab_between(&seed, 0, 300)));
        }
        ellipsoid_normal(radii, x, n);
        cr_assert(fabs(vector_length(n) - 1) <= 4e-16, "a normal of length %.17g",
                  vector_length(n));
        for (int k = 0; k < 3; k++)
            cr_assert(n[k] * x[k] >= 0, "an inward normal");
    }
    static const struct {
        double radii[3], n[3];
    } centre[] = {
        {{1, 1, 1}, {1, 0, 0}}, {{2, 1, 1}, {0, 1, 0}}, {{2, 2, 1}, {0, 0, 1}},
        {{1, 2, 1}, {1, 0, 0}}, {{3, 2, 1}, {0, 0, 1}}, {{1, 1, 2}, {1, 0, 0}},
    };
    for (size_t i = 0; i < sizeof centre / sizeof *centre; i++) {
        double n[3];
        ellipsoid_normal(centre[i].radii, (const double[3]){0, -0., 0}, n);
        near_vector(n, centre[i].n[0], centre[i].n[1], centre[i].n[2], 0, "normal at the centre");
    }
}

/* A line at distance 1 - epsilon from the centre of the unit sphere is in it for 2 sqrt(2 epsilon);
 * rounding of the distance is what is left. */
Test(body, grazing_rays) {
    const double radii[3] = {1, 1, 1}, d[3] = {1, 0, 0};
    for (double epsilon = 1e-2; epsilon > 1e-15; epsilon /= 10) {
        const double x[3] = {-500, 1 - epsilon, 0}, past[3] = {-500, 1 + epsilon, 0};
        const double rest = 1 - x[1], half = sqrt(rest * (2 - rest)); /* exact: 1 - x is */
        const double s = ellipsoid_entry(radii, x, d);
        cr_assert(fabs(s - (500 - half)) <= 1e-15 / half + 1e-13, "1 - %g: %.17g, not %.17g",
                  epsilon, s, 500 - half);
        cr_assert_eq(ellipsoid_entry(radii, past, d), INFINITY, "1 + %g: a crossing", epsilon);
    }
    const double behind[3] = {5, 0, 0};
    cr_assert_eq(ellipsoid_entry(radii, behind, d), INFINITY, "a crossing behind");
}

/* --- one node: closed forms --- */

static const double dt = 1. / 300;

static struct body ball(double radius) {
    return (struct body){.name = "ball", .radii = {radius, radius, radius}};
}

/* A wisp far away, with its node 3 at p with velocity v. */
static struct wisp far_wisp(int samples) {
    unsigned seed = 7;
    struct wisp wisp = lab_wisp(5, samples, BENDING_SKIP, &seed);
    const struct wisp plain = {.root = {-10, 0, 0}, .direction = {1, 0, 0}};
    memcpy(wisp.root, plain.root, sizeof wisp.root);
    memcpy(wisp.direction, plain.direction, sizeof wisp.direction);
    wisp.length = 0.4;
    wisp.radius = 0.02;
    return wisp;
}

static struct strand *far_strand(const struct wisp *wisp, enum wisp_treatment treatment) {
    struct strand *s = lab_strand(wisp, treatment);
    for (int i = 0; i < wisp->nodes; i++)
        for (int k = 0; k < 3; k++)
            s->p[i][k] = wisp->root[k] + 0.1 * i * wisp->direction[k];
    for (int at = 0; at < wisp->nodes * wisp->samples; at++)
        s->r[at] = wisp->radius;
    strand_refresh(s);
    for (int at = 0; at < wisp->nodes * wisp->samples && treatment == WISP_PENALTY; at++) {
        double a[3];
        strand_half_line(s, at / wisp->samples, at % wisp->samples, a);
        for (int k = 0; k < 3; k++)
            s->e[at][k] = s->p[at / wisp->samples][k] + wisp->radius * a[k];
    }
    strand_refresh(s);
    return s;
}

/* One tick at time t, of a head at rest. */
static const struct head_motion no_motion;

static void contact_under(const double gravity[3], struct strand *s, const struct body *bodies,
                          int count, double t, struct body_report *report) {
    struct placement head;
    struct body_motion at[BODIES_MAX];
    head_placement(&no_motion, t, &head);
    for (int i = 0; i < count; i++)
        at[i] = body_motion(&bodies[i], &head, t);
    body_contact(s, bodies, at, count, gravity, dt, report);
}

static void contact(struct strand *s, const struct body *bodies, int count, double t,
                    struct body_report *report) {
    static const double none[3];
    contact_under(none, s, bodies, count, t, report);
}

/* What happens to a node at p with velocity v in one tick at time t, under gravity. */
static struct body_report hit_under(const double gravity[3], const struct body *bodies, int count,
                                    double t, double p[3], double v[3]) {
    struct wisp wisp = far_wisp(0);
    wisp.root[0] = -1e6; /* whatever the body's size, it has this one node only */
    struct strand *s = far_strand(&wisp, WISP_GENERALISED);
    struct body_report report = {0, 0, 0};
    memcpy(s->p[3], p, sizeof s->p[3]);
    memcpy(s->v[3], v, sizeof s->v[3]);
    contact_under(gravity, s, bodies, count, t, &report);
    cr_assert_eq(s->changed, report.nodes > 0);
    memcpy(p, s->p[3], sizeof s->p[3]);
    memcpy(v, s->v[3], sizeof s->v[3]);
    return report;
}

static struct body_report hit(const struct body *bodies, int count, double t, double p[3],
                              double v[3]) {
    static const double none[3];
    return hit_under(none, bodies, count, t, p, v);
}

Test(body, head_on) {
    for (int elastic = 0; elastic <= 4; elastic++) {
        struct body b = ball(0.1);
        b.elasticity = elastic / 4.;
        b.offset = 1e-3;
        double p[3] = {-0.099, 0, 0}, v[3] = {0.6, 0, 0};
        cr_assert_eq(hit(&b, 1, 0, p, v).nodes, 1);
        near_vector(p, -0.101, 0, 0, 1e-16, "put on the surface");
        near_vector(v, -0.6 * b.elasticity, 0, 0, 3e-16, "bounces");
    }
}

/* The way it came in: a node that crossed at (-0.06, 0.08, 0) with (3, 0, 0) m/s. */
Test(body, a_body_at_rest_is_left_the_way_the_node_came_in) {
    struct body b = ball(0.1);
    b.friction = 50;
    b.elasticity = 0.5;
    const double kept = exp(-50. / 300), n[3] = {-0.6, 0.8, 0}, along[3] = {0.8, 0.6, 0};
    double p[3] = {-0.055, 0.08, 0}, v[3] = {3, 0, 0};
    hit(&b, 1, 0, p, v);
    near_vector(p, -0.06, 0.08, 0, 3e-16, "where it came in");
    near_vector(v, kept * 2.4 * along[0] + 0.5 * 1.8 * n[0], kept * 2.4 * along[1] + 0.9 * n[1], 0,
                1e-15, "3 m/s are 2.4 along and 1.8 inwards");
    /* not further back than it can have come since the last tick: 10 mm here */
    for (int i = 0; i < 2; i++) {
        double deep[3] = {-0.06 + (i ? 0.0101 : 0.0099), 0.08, 0}, u[3] = {3, 0, 0};
        const double size = vector_length(deep);
        const double x = i ? deep[0] * 0.1 / size : -0.06, y = i ? deep[1] * 0.1 / size : 0.08;
        hit(&b, 1, 0, deep, u);
        near_vector(deep, x, y, 0, 1e-15, i ? "by the normal" : "the way it came in");
    }
    /* on its way out it leaves by the normal, and keeps every bit of its velocity */
    double out[3] = {-0.055, 0.08, 0}, u[3] = {-3, 0.1, 0.2};
    const double size = vector_length(out);
    hit(&b, 1, 0, out, u);
    near_vector(out, -0.0055 / size, 0.008 / size, 0, 1e-16, "by the normal");
    near_vector(u, -3, 0.1, 0.2, 0, "velocity of a node that leaves");
}

/* A node that fell on the top of a ball comes back with a share of the speed that it had there:
 * v^2 - 2 g d at a depth d. One that was stopped below, or that gravity has taken in, has none. */
Test(body, it_comes_back_with_the_speed_at_the_surface) {
    static const double gravity[3] = {0, -9.81, 0};
    for (int moves = 0; moves < 2; moves++)
        for (int i = 0; i <= 4; i++) {
            struct body b = ball(0.1);
            b.elasticity = i / 4.;
            b.moves = moves;
            double p[3] = {0, 0.099, 0}, v[3] = {0, -1, 0}, q[3] = {0, 0.099, 0}, w[3] = {0, -1, 0};
            hit_under(gravity, &b, 1, 0, p, v);
            near_vector(p, 0, 0.1, 0, 1e-16, "put on the surface");
            near_vector(v, 0, i / 4. * sqrt(1 - 2 * 9.81 * 0.001), 0, 1e-15, "the top");
            const double up[3] = {0, 9.81, 0};
            hit_under(up, &b, 1, 0, q, w); /* on its way to the top it was slowed down */
            near_vector(w, 0, i / 4. * sqrt(1 + 2 * 9.81 * 0.001), 0, 1e-15, "against gravity");
            double r[3] = {0, 0.099, 0}, slow[3] = {0, -0.1, 0};
            hit_under(gravity, &b, 1, 0, r, slow);
            near_vector(slow, 0, 0, 0, 0, "it had no speed at the surface");
        }
}

/* The same in the body's frame, but by the normal; and where the body is at time t. */
Test(body, a_moving_body_is_left_by_its_normal) {
    struct body b = ball(0.1);
    b.moves = 1;
    b.velocity[0] = -3;
    b.centre[0] = 6;
    b.friction = 20;
    b.elasticity = 0.25;
    b.offset = 1e-4;
    const double kept = exp(-20. / 300);
    double p[3] = {-0.06, 0.0792, 0}, v[3] = {0, 0, 1}; /* of length 0.09936 */
    const double size = vector_length(p), n[3] = {p[0] / size, p[1] / size, 0}, into = 3 * n[0];
    hit(&b, 1, 2, p, v);
    near_vector(p, 0.1001 * n[0], 0.1001 * n[1], 0, 1e-15, "by the normal");
    /* u = (3, 0, 1); across it is (3 n_x) n */
    near_vector(v, -3 + kept * (3 - into * n[0]) - 0.25 * into * n[0],
                kept * (0 - into * n[1]) - 0.25 * into * n[1], kept, 1e-15, "velocity");
    double still[3] = {-0.06, 0.0792, 0}, w[3] = {0, 0, 1};
    cr_assert_eq(hit(&b, 1, 1.9, still, w).nodes, 0, "the body is elsewhere at 1.9 s");
    near_vector(still, -0.06, 0.0792, 0, 0, "a node outside");
}

Test(body, friction_is_per_time_and_along_the_surface) {
    for (int i = 0; i <= 4; i++) {
        struct body b = ball(0.1);
        b.friction = 100. * i;
        double p[3] = {0, 0.09999, 0}, v[3] = {0.3, -0.4, 0.1};
        b.moves = 1; /* by the normal */
        hit(&b, 1, 0, p, v);
        near_vector(v, 0.3 * exp(-i / 3.), 0, 0.1 * exp(-i / 3.), 1e-16, "friction");
    }
}

Test(body, from_the_centre_by_the_axis_of_smallest_radius) {
    static const double radii[][3] = {{0.1, 0.1, 0.1}, {0.3, 0.2, 0.2}, {0.3, 0.3, 0.2}};
    for (int axis = 0; axis < 3; axis++) {
        struct body b = {.centre = {1, 2, 3}, .offset = 1e-3};
        double p[3] = {1, 2, 3}, v[3] = {0, 0, 0}, q[3] = {1, 2, 3};
        memcpy(b.radii, radii[axis], sizeof b.radii);
        hit(&b, 1, 0, p, v);
        q[axis] += b.radii[axis] + 1e-3;
        near_vector(p, q[0], q[1], q[2], 1e-15, "from the centre");
        near_vector(v, 0, 0, 0, 0, "a node at rest");
    }
}

/* Each of two balls pushes into the other for ever. */
Test(body, between_two_bodies_the_order_of_the_list_decides) {
    struct body b[2] = {ball(1), ball(1)};
    for (int swapped = 0; swapped < 2; swapped++) {
        b[swapped].centre[0] = -0.6;
        b[!swapped].centre[0] = 0.6;
        double p[3] = {0, 0, 0}, v[3] = {0, 0, 0};
        const struct body_report report = hit(b, 2, 0, p, v);
        cr_assert(report.nodes == 8 && report.inside == 1, "%lld pushes, %lld inside", report.nodes,
                  report.inside);
        near_vector(p, swapped ? 0.4 : -0.4, 0, 0, 1e-15, "where the last pass leaves it");
    }
    /* out of one into the other, and from there out: two passes, no node left */
    struct body chain[2] = {ball(0.1), ball(0.1)};
    chain[1].centre[0] = 0.15;
    chain[0].offset = chain[1].offset = 1e-3;
    double p[3] = {0.01, 0, 0}, v[3] = {0, 0, 0};
    struct body_report report = hit(chain, 2, 0, p, v);
    cr_assert(report.nodes >= 2 && report.inside <= 1);
    double side[3] = {0.07, 0.06, 0};
    report = hit(chain, 2, 0, side, v);
    cr_assert_eq(report.inside, 0, "a node in the notch stays");
    for (int i = 0; i < 2; i++)
        cr_assert(hypot(side[0] - chain[i].centre[0], side[1]) >= 0.1, "in ball %d", i);
}

/* With no offset, rounding must not leave a node a hair inside: friction would act twice. */
Test(body, once_is_enough) {
    unsigned seed = 11;
    for (int i = 0; i < 20000; i++) {
        struct body b = {.friction = 50, .elasticity = i % 2 ? 0.3 : 0};
        double p[3], v[3];
        for (int k = 0; k < 3; k++) {
            b.radii[k] = pow(10, lab_between(&seed, -4, 2));
            b.centre[k] = lab_between(&seed, -1, 1) * pow(10, lab_between(&seed, -3, 2));
            p[k] = b.centre[k] + b.radii[k] * lab_between(&seed, -0.9, 0.9);
            b.velocity[k] = i % 3 ? lab_between(&seed, -1, 1) : 0;
            b.moves = i % 3 > 0;
        }
        random_vector(&seed, 1, v);
        const struct body_report report = hit(&b, 1, 0, p, v);
        if (report.nodes == 0)
            continue;
        cr_assert(report.nodes == 1 && report.inside == 0, "%lld pushes, %lld inside", report.nodes,
                  report.inside);
        const double x[3] = {p[0] - b.centre[0], p[1] - b.centre[1], p[2] - b.centre[2]};
        cr_assert(!ellipsoid_contains(b.radii, x) && isfinite(vector_dot(v, v)));
    }
}

/* --- one sample: closed forms --- */

/* Node 3 above a ball, samples a_0, ... around it; those that reach into it end on it. */
Test(body, samples_end_on_the_surface) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const struct wisp wisp = far_wisp(4);
        struct strand *s = far_strand(&wisp, (enum wisp_treatment)treatment);
        struct body_report report = {0, 0, 0};
        struct body b = ball(0.05);
        double a[3], before[4][3], velocity[4][3];
        strand_half_line(s, 3, 1, a); /* the ball is ahead of sample 1, 8 mm from the node */
        for (int k = 0; k < 3; k++) {
            b.centre[k] = s->p[3][k] + 0.058 * a[k];
            b.velocity[k] = -0.3 * a[k];
            s->v[3][k] = 0.2 * a[k];
        }
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                s->ev[12 + j][k] = s->v[3][k] + 0.1 * (k + j);
        for (int j = 0; j < 4 && treatment != WISP_PENALTY; j++)
            s->rate[12 + j] = 0.4;
        strand_refresh(s);
        memcpy(before, s->e + 12, sizeof before);
        memcpy(velocity, s->ev + 12, sizeof velocity);
        const double r0 = s->r[13], rate0 = s->rate[13];
        contact(s, &b, 1, 0, &report);
        cr_assert(report.samples == 1 && report.nodes == 0 && report.inside == 0 && s->changed);
        cr_assert(fabs(s->r[13] - 0.008) <= 1e-14, "r = %.17g", s->r[13]);
        cr_assert(fabs(s->rate[13] - fmin(rate0, -0.5)) <= 1e-14, "rate %.17g", s->rate[13]);
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++) {
                const double by = j == 1 ? (s->r[13] - r0) * a[k] : 0;
                const double dv = j == 1 ? (s->rate[13] - rate0) * a[k] : 0;
                cr_assert(fabs(s->e[12 + j][k] - before[j][k] - by) <= 1e-14 &&
                              fabs(s->ev[12 + j][k] - velocity[j][k] - dv) <= 1e-14,
                          "%s: sample %d moves otherwise than along its line",
                          treatment_names[treatment], j);
            }
    }
}

/* A surface nearer to the node than 1e-3 R, and a rate that is lower already. */
Test(body, samples_keep_their_least_distance) {
    const struct wisp wisp = far_wisp(4);
    for (int slow = 0; slow < 2; slow++) {
        struct strand *s = far_strand(&wisp, WISP_GENERALISED);
        struct body_report report = {0, 0, 0};
        struct body b = ball(0.05);
        double a[3];
        strand_half_line(s, 3, 2, a);
        for (int k = 0; k < 3; k++)
            b.centre[k] = s->p[3][k] + (0.05 + 1e-6) * a[k];
        s->rate[14] = slow ? -7 : 7;
        contact(s, &b, 1, 0, &report);
        cr_assert_eq(report.samples, 1);
        cr_assert(s->r[14] == 1e-3 * 0.02 && s->rate[14] == (slow ? -7 : 0), "r = %g, rate %g",
                  s->r[14], s->rate[14]);
    }
}

/* Behind its node there is no crossing ahead: the clamp's business. And the samples of a node that
 * is still inside are left alone. */
Test(body, samples_that_are_left_alone) {
    const struct wisp wisp = far_wisp(4);
    struct strand *s = far_strand(&wisp, WISP_PROJECTION);
    struct body_report report = {0, 0, 0};
    struct body b[2] = {ball(0.05), ball(1)};
    double a[3];
    strand_half_line(s, 3, 0, a);
    for (int k = 0; k < 3; k++)
        b[0].centre[k] = s->p[3][k] - 0.058 * a[k];
    s->r[12] = -0.02;
    s->r[14] = 1e-5; /* the opposite one would be in the way */
    contact(s, b, 1, 0, &report);
    cr_assert(report.samples == 0 && s->r[12] == -0.02 && !s->changed);
    b[0] = ball(1);
    memcpy(b[0].centre, s->p[3], sizeof b[0].centre);
    memcpy(b[1].centre, s->p[3], sizeof b[1].centre);
    b[0].centre[1] -= 0.6;
    b[1].centre[1] += 0.6;
    s->r[12] = 0.02;
    contact(s, b, 2, 0, &report);
    cr_assert(report.inside >= 1, "%lld inside", report.inside);
    cr_assert(s->r[12] == 0.02 && s->r[13] == 0.02 && s->r[14] == 1e-5, "a sample was moved");
}

/* --- the page's words, a second time --- */

/* A random wisp among random bodies. */
static struct strand *random_strand(const struct wisp *wisp, enum wisp_treatment treatment,
                                    unsigned *seed) {
    static double q[LAB_SIZE], v[LAB_SIZE];
    struct strand *s = far_strand(wisp, treatment);
    const int unknowns = wisp_node_unknowns(wisp, treatment),
              per = treatment == WISP_PENALTY ? 3 : 1;
    lab_state(wisp, treatment, STATE_RANDOM, 0, seed, q, v);
    for (int i = 0; i < wisp->nodes; i++) {
        for (int k = 0; k < 3; k++)
            s->p[i][k] = i < 2 ? wisp->root[k] + i * wisp_spacing(wisp) * wisp->direction[k]
                               : q[(i - 2) * unknowns + k];
        for (int k = 0; k < 3 && i >= 2; k++)
            s->v[i][k] = v[(i - 2) * unknowns + k];
        for (int j = 0; j < wisp->samples && i >= 2; j++) {
            const int at = i * wisp->samples + j, u = (i - 2) * unknowns + 3 + per * j;
            memcpy(per == 3 ? s->e[at] : &s->r[at], q + u, (size_t)per * sizeof *q);
            memcpy(per == 3 ? s->ev[at] : &s->rate[at], v + u, (size_t)per * sizeof *v);
        }
    }
    strand_refresh(s);
    s->changed = 0;
    return s;
}

static void random_bodies(const struct strand *s, int count, unsigned *seed, struct body *bodies) {
    for (int i = 0; i < count; i++) {
        struct body *b = &bodies[i];
        const int node = (int)lab_between(seed, 0, s->wisp->nodes - 1e-9);
        *b = (struct body){.friction = lab_between(seed, 0, 100),
                           .elasticity = lab_between(seed, 0, 1),
                           .offset = lab_between(seed, 0, 1e-3)};
        for (int k = 0; k < 3; k++) {
            b->radii[k] = lab_between(seed, 0.01, 0.1);
            b->centre[k] = s->p[node][k] + lab_between(seed, -0.08, 0.08);
        }
        b->moves = lab_between(seed, 0, 1) < 0.6;
        if (b->moves && i % 3 < 2)
            random_vector(seed, 1, b->velocity);
    }
}

static double largest_difference(const struct strand *a, const struct strand *b) {
    double most = 0;
    for (int i = 0; i < a->wisp->nodes; i++)
        for (int k = 0; k < 3; k++)
            most = fmax(most, fmax(fabs(a->p[i][k] - b->p[i][k]), fabs(a->v[i][k] - b->v[i][k])));
    for (int at = 0; at < a->wisp->nodes * a->wisp->samples; at++) {
        most = fmax(most, fmax(fabs(a->r[at] - b->r[at]), fabs(a->rate[at] - b->rate[at])));
        for (int k = 0; k < 3; k++)
            most = fmax(most,
                        fmax(fabs(a->e[at][k] - b->e[at][k]), fabs(a->ev[at][k] - b->ev[at][k])));
    }
    return most;
}

Test(body, agrees_with_the_page_written_down_twice) {
    unsigned seed = 21;
    struct body_report all = {0, 0, 0};
    double worst = 0;
    for (int i = 0; i < 3000; i++) {
        const enum wisp_treatment treatment = (enum wisp_treatment)(i % TREATMENTS);
        const struct wisp wisp = lab_wisp(7, i % 4 ? 2 + i % 4 : 0, BENDING_SKIP, &seed);
        const double t = lab_between(&seed, 0, 0.01);
        const int count = 1 + i % 5;
        struct body bodies[5];
        unsigned again = seed;
        struct strand *s = random_strand(&wisp, treatment, &seed);
        struct strand *twin = random_strand(&wisp, treatment, &again);
        random_bodies(s, count, &seed, bodies);
        struct body_report report = {0, 0, 0};
        double gravity[3];
        random_vector(&seed, 10, gravity);
        contact_under(gravity, s, bodies, count, t, &report);
        const int left = twin_contact(twin, bodies, count, gravity, t, dt);
        const double difference = largest_difference(s, twin);
        cr_assert(report.inside == left, "%lld left inside, not %d", report.inside, left);
        cr_assert(difference <= 1e-10, "case %d, %s: a difference of %g", i,
                  treatment_names[treatment], difference);
        worst = fmax(worst, difference);
        all.nodes += report.nodes;
        all.samples += report.samples;
        all.inside += report.inside;
    }
    cr_log_info("%lld nodes, %lld samples, %lld left inside, at most %g apart", all.nodes,
                all.samples, all.inside, worst);
    cr_assert(all.nodes > 3000 && all.samples > 3000 && all.inside > 10);
}

/* --- invariances --- */

/* Lengths and velocities by a power of two: not a bit but the size. Along the axes, moved: to
 * rounding. */
Test(body, scaled_and_moved_it_is_the_same) {
    unsigned seed = 31;
    for (int i = 0; i < 600; i++) {
        const struct wisp wisp = lab_wisp(7, 4, BENDING_SKIP, &seed);
        struct wisp large = wisp;
        struct body bodies[3], other[3];
        struct strand *s[3];
        unsigned start = seed;
        for (int k = 0; k < 3; k++) {
            seed = start;
            s[k] = random_strand(&wisp, WISP_GENERALISED, &seed);
        }
        random_bodies(s[0], 3, &seed, bodies);
        struct body_report report = {0, 0, 0};
        const double by[3] = {0.3, -0.2, 0.1}, down[3] = {1, -9, 2}, more[3] = {4, -36, 8};
        contact_under(down, s[0], bodies, 3, 0, &report);
        memcpy(other, bodies, sizeof other); /* moved */
        for (int b = 0; b < 3; b++)
            for (int k = 0; k < 3; k++)
                other[b].centre[k] += by[k];
        for (int n = 0; n < 7; n++)
            for (int k = 0; k < 3; k++)
                s[1]->p[n][k] += by[k];
        strand_refresh(s[1]);
        contact_under(down, s[1], other, 3, 0, &report);
        large.radius *= 4; /* scaled */
        s[2]->wisp = &large;
        memcpy(other, bodies, sizeof other);
        for (int b = 0; b < 3; b++) {
            other[b].offset *= 4;
            for (int k = 0; k < 3; k++) {
                other[b].centre[k] *= 4;
                other[b].radii[k] *= 4;
                other[b].velocity[k] *= 4;
            }
        }
        for (int n = 0; n < 7; n++)
            for (int k = 0; k < 3; k++) {
                s[2]->p[n][k] *= 4;
                s[2]->v[n][k] *= 4;
            }
        for (int at = 0; at < 28; at++) {
            s[2]->r[at] *= 4;
            s[2]->rate[at] *= 4;
        }
        strand_refresh(s[2]);
        contact_under(more, s[2], other, 3, 0, &report);
        for (int n = 0; n < 7; n++)
            for (int k = 0; k < 3; k++) {
                cr_assert(fabs(s[1]->p[n][k] - by[k] - s[0]->p[n][k]) <= 1e-11 &&
                              fabs(s[1]->v[n][k] - s[0]->v[n][k]) <= 1e-11,
                          "case %d: moved, node %d differs by %g", i, n,
                          s[1]->p[n][k] - by[k] - s[0]->p[n][k]);
                cr_assert(s[2]->p[n][k] == 4 * s[0]->p[n][k] && s[2]->v[n][k] == 4 * s[0]->v[n][k],
                          "case %d: scaled, node %d differs", i, n);
            }
        for (int at = 0; at < 28; at++)
            cr_assert(s[2]->r[at] == 4 * s[0]->r[at] && s[2]->rate[at] == 4 * s[0]->rate[at] &&
                          fabs(s[1]->r[at] - s[0]->r[at]) <= 1e-11,
                      "case %d: sample %d differs", i, at);
    }
}

/* Nodes only: half-lines follow the world's y axis. Ellipsoids turned onto other axes, balls by any
 * angle. */
Test(body, turned_it_is_the_same) {
    unsigned seed = 41;
    for (int i = 0; i < 2000; i++) {
        struct body b = {.friction = 30, .elasticity = 0.4, .offset = 1e-4}, turned = b;
        double p[3], v[3], q[3], w[3];
        for (int k = 0; k < 3; k++) {
            b.radii[k] = lab_between(&seed, 0.05, 0.2);
            b.velocity[k] = i % 2 ? lab_between(&seed, -1, 1) : 0;
            b.moves = turned.moves = i % 2;
            b.centre[k] = lab_between(&seed, -1, 1);
            p[k] = b.centre[k] + b.radii[k] * lab_between(&seed, -0.6, 0.6);
        }
        random_vector(&seed, 20, v);
        for (int k = 0; k < 3; k++) {
            turned.radii[k] = b.radii[(k + 1) % 3];
            turned.centre[k] = b.centre[(k + 1) % 3];
            turned.velocity[k] = b.velocity[(k + 1) % 3];
            q[k] = p[(k + 1) % 3];
            w[k] = v[(k + 1) % 3];
        }
        hit(&b, 1, 0, p, v);
        hit(&turned, 1, 0, q, w);
        near_vector(q, p[1], p[2], p[0], 1e-14, "turned onto other axes");
        near_vector(w, v[1], v[2], v[0], 1e-13, "turned onto other axes");
    }
    for (int i = 0; i < 2000; i++) {
        struct body b = ball(0.1);
        b.friction = 30;
        b.elasticity = 0.4;
        double p[3], v[3], q[3], w[3];
        const double angle = lab_between(&seed, 0, 7), c = cos(angle), d = sin(angle);
        random_vector(&seed, 0.05, p);
        random_vector(&seed, 20, v);
        q[0] = c * p[0] - d * p[1];
        q[1] = d * p[0] + c * p[1];
        w[0] = c * v[0] - d * v[1];
        w[1] = d * v[0] + c * v[1];
        q[2] = p[2];
        w[2] = v[2];
        hit(&b, 1, 0, p, v);
        hit(&b, 1, 0, q, w);
        near_vector(q, c * p[0] - d * p[1], d * p[0] + c * p[1], p[2], 1e-15, "turned");
        near_vector(w, c * v[0] - d * v[1], d * v[0] + c * v[1], v[2], 1e-13, "turned");
    }
}

/* --- the box test --- */

/* Samples further out than the box test takes for granted. */
static void stretch_samples(const struct wisp *wisp, enum wisp_treatment treatment, double factor,
                            double *q) {
    const int unknowns = wisp_node_unknowns(wisp, treatment);
    for (int i = 0; i < wisp->nodes - 2; i++, q += unknowns)
        for (int u = 3; u < unknowns; u++)
            q[u] =
                treatment == WISP_PENALTY ? q[u % 3] + factor * (q[u] - q[u % 3]) : factor * q[u];
}

/* Samples pulled out by the kernel: the state, and who was left for body_contact. */
struct pulled {
    double q[LAB_LANES * LAB_SIZE], v[LAB_LANES * LAB_SIZE];
    unsigned left, pulled;
    int samples;
};

static void pull(struct pulled *to, const struct lab_part *part, const double *q, const double *v,
                 const struct body *bodies, const struct body_motion *motion, const double *boxes,
                 int count) {
    struct obstacle obstacle[BODIES_MAX];
    for (int i = 0; i < count; i++)
        obstacle[i] = body_obstacle(&bodies[i], &motion[i]);
    memcpy(to->q, q, (size_t)(part->lanes * part->size) * sizeof *q);
    memcpy(to->v, v, (size_t)(part->lanes * part->size) * sizeof *v);
    to->left = kernel_of(part->lanes)
                   ->pull(part->system.ctx, to->q, to->v, obstacle, boxes, count, ~0u, &to->samples,
                          &to->pulled);
}

/* Only wisps with a node inside are left, or free particles, as they are; of the others the kernel
 * makes what body_contact made of a strand. */
static void check_pulled(struct pulled *pulled, const struct lab_part *part, int k,
                         const struct strand *s, const struct body_report *report,
                         const double *rows, int stride) {
    double is[LAB_NODES * (6 + 6 * SAMPLES_MAX)], should[LAB_NODES * (6 + 6 * SAMPLES_MAX)];
    const int left = pulled->left >> k & 1;
    cr_assert_eq(left, s->treatment == WISP_PENALTY || report->nodes > 0, "lane %d is%s left", k,
                 left ? "" : " not");
    kernel_of(part->lanes)->sample(part->system.ctx, k, pulled->q, pulled->v, is, stride);
    if (left) {
        cr_assert_eq(memcmp(is, rows, (size_t)(s->wisp->nodes * stride) * sizeof *is), 0,
                     "lane %d is left, but changed", k);
        return;
    }
    pulled->samples -= (int)report->samples;
    cr_assert_eq(pulled->pulled >> k & 1, report->samples > 0, "lane %d: the bit of pulled lanes",
                 k);
    strand_store(s, should, stride);
    for (int i = 0; i < s->wisp->nodes * stride; i++)
        cr_assert(fabs(is[i] - should[i]) < 1e-12, "lane %d: %.17g, not %.17g", k, is[i],
                  should[i]);
}

/* One part of random wisps: whoever body contact changes is near, and the clamp's flag is right. */
static void check_near(int lanes, enum wisp_treatment treatment, int samples, unsigned *seed,
                       int *touched, int *far, int *flags, int *clamped) {
    static double q[LAB_LANES][LAB_SIZE], v[LAB_SIZE], Q[LAB_LANES * LAB_SIZE],
        V[LAB_LANES * LAB_SIZE], rows[LAB_NODES * (6 + 6 * SAMPLES_MAX)];
    enum { NODES = 6, BODIES = 3 };
    const void *const mark = test_mark();
    const int count = (int)lab_between(seed, 1, BODIES + 0.99);
    struct surroundings around = lab_surroundings(WIND_NONE, seed);
    struct wisp wisps[LAB_LANES];
    struct body bodies[BODIES];
    struct body_motion motion[BODIES];
    struct lab_part part;
    const double spread = lab_between(seed, 0, 1) < 0.5 ? 0.15 : 1;
    double boxes[6 * BODIES],
        hull[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    int clamp;
    struct placement head;
    static const double down[3] = {0, -9.81, 0};
    around.head.knots = 1; /* turned for ever, or not */
    if (lab_between(seed, 0, 1) < 0.7)
        random_vector(seed, 2, around.head.rotation[0]);
    head_placement(&around.head, 0.1, &head);
    for (int k = 0; k < lanes; k++)
        wisps[k] = lab_wisp(NODES, samples, BENDING_SKIP, seed);
    lab_part_make(&part, lanes, wisps, lanes, &around, treatment);
    for (int k = 0; k < lanes; k++) {
        lab_state(&wisps[k], treatment, STATE_RANDOM, 0, seed, q[k], v);
        const double most = lab_between(seed, 0, 1) < 0.25 ? 10 : 1;
        stretch_samples(&wisps[k], treatment, lab_between(seed, 0.1, most), q[k]);
        lab_place(&part, k, q[k], Q);
        lab_scatter(&part, k, v, V);
    }
    for (int b = 0; b < count; b++) {
        double centre[3];
        bodies[b] = (struct body){.offset = 1e-4};
        for (int k = 0; k < 3; k++) {
            bodies[b].radii[k] = lab_between(seed, 0.005, 0.1);
            centre[k] = wisps[0].root[k] + lab_between(seed, -spread, spread);
        }
        for (int k = 0; k < 3; k++) /* so that it is there as the head is turned */
            for (int j = 0; j < 3; j++)
                bodies[b].centre[k] += head.turn[0][j][k] * centre[j];
        random_vector(seed, 1, bodies[b].velocity);
        motion[b] = body_motion(&bodies[b], &head, 0.1);
        body_box(&bodies[b], &motion[b], boxes + 6 * b);
        for (int k = 0; k < 3; k++) {
            hull[k] = fmin(hull[k], boxes[6 * b + k]);
            hull[3 + k] = fmax(hull[3 + k], boxes[6 * b + 3 + k]);
        }
    }
    void *ctx = part.system.ctx;
    const unsigned near = kernel_of(lanes)->near(ctx, Q, hull, boxes, count, &clamp);
    static struct pulled pulled;
    pull(&pulled, &part, Q, V, bodies, motion, boxes, count);
    for (int k = 0; k < lanes; k++) {
        struct strand *s = lab_strand(&wisps[k], treatment);
        struct body_report report = {0, 0, 0};
        const int stride = 6 + samples * (treatment == WISP_PENALTY ? 6 : 2);
        kernel_of(lanes)->sample(ctx, k, Q, V, rows, stride);
        strand_turn(s, &head);
        strand_load(s, rows, stride);
        body_contact(s, bodies, motion, count, down, dt, &report);
        check_pulled(&pulled, &part, k, s, &report, rows, stride);
        const int found = s->changed || report.inside;
        cr_assert(!found || (near >> k & 1), "lane %d of %d: a contact is missed", k, lanes);
        *touched += found;
        *far += !(near >> k & 1);
    }
    cr_assert_eq(pulled.samples, 0, "%d samples too many are pulled", pulled.samples);
    const int changed = kernel_of(lanes)->clamp(ctx, Q, V);
    cr_assert(clamp || !changed, "%s: the clamp's flag", treatment_names[treatment]);
    *flags += clamp != 0;
    *clamped += changed != 0;
    test_gives_back(mark);
}

Test(body, the_box_test_misses_nobody) {
    unsigned seed = 51;
    static const int samples[] = {0, 3, 4, 7};
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int m = 0; m < 4; m++)
            for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                int touched = 0, far = 0, flags = 0, clamped = 0;
                for (int i = 0; i < 1000; i++)
                    check_near(lanes, (enum wisp_treatment)treatment, samples[m], &seed, &touched,
                               &far, &flags, &clamped);
                cr_log_info("%s, %d samples: %d touched, %d far of %d", treatment_names[treatment],
                            samples[m], touched, far, 1000 * lanes);
                cr_assert(touched > 10 && far > 100, "%d touched, %d far", touched, far);
                cr_assert_leq(flags - clamped, 3, "%d clamps for nothing", flags - clamped);
            }
}
