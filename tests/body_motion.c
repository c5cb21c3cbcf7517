/* Bodies that move and turn with the head: against the same contact seen from the head, a closed
 * form, and the principles of Galilei and of equivalence. */
#include "scene/scene_load.h"
#include "wisp/body.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double dt = 1. / 300;

static void random_vector(unsigned *seed, double size, double x[3]) {
    for (int k = 0; k < 3; k++)
        x[k] = lab_between(seed, -size, size);
}

/* Knots around 0, so that the head is somewhere and on its way. */
static struct head_motion random_motion(unsigned *seed) {
    struct head_motion motion = {.knots = 4, .time = {-0.2, -0.1, 0.1, 0.2}};
    for (int k = 0; k < motion.knots; k++) {
        random_vector(seed, 0.3, motion.position[k]);
        random_vector(seed, 1.5, motion.rotation[k]);
    }
    return motion;
}

static struct body random_body(unsigned *seed) {
    struct body body = {.friction = lab_between(seed, 0, 100),
                        .elasticity = lab_between(seed, 0, 1),
                        .offset = lab_between(seed, 0, 1e-3)};
    for (int k = 0; k < 3; k++)
        body.radii[k] = lab_between(seed, 0.03, 0.2);
    random_vector(seed, 0.1, body.centre);
    random_vector(seed, 0.5, body.velocity);
    body.moves = 1;
    return body;
}

/* A wisp around the origin, as the head rests. */
static struct strand *strand_near(const struct wisp *wisp, unsigned *seed) {
    struct strand *s = lab_strand(wisp, WISP_GENERALISED);
    for (int i = 0; i < wisp->nodes; i++) {
        random_vector(seed, 0.15, s->p[i]);
        random_vector(seed, 1, s->v[i]);
        for (int j = 0; j < wisp->samples; j++) {
            s->r[i * wisp->samples + j] = wisp->radius * lab_between(seed, 0.2, 2);
            s->rate[i * wisp->samples + j] = lab_between(seed, -1, 1);
        }
    }
    strand_refresh(s);
    return s;
}

/* What moves with the head by v there moves by P' + Q' x + Q v in the world. */
static struct strand *carried(const struct strand *rest, const struct placement *head) {
    struct strand *s = lab_strand(rest->wisp, rest->treatment);
    const size_t samples = (size_t)(rest->wisp->nodes * rest->wisp->samples);
    for (int i = 0; i < rest->wisp->nodes; i++) {
        double own[3];
        placed_point(head, 0, rest->p[i], s->p[i]);
        placed_point(head, 1, rest->p[i], s->v[i]);
        placed_direction(head, rest->v[i], own);
        for (int k = 0; k < 3; k++)
            s->v[i][k] += own[k];
    }
    memcpy(s->r, rest->r, samples * sizeof *s->r);
    memcpy(s->rate, rest->rate, samples * sizeof *s->rate);
    strand_turn(s, head);
    strand_refresh(s);
    return s;
}

static double difference(const double a[3], const double b[3], const double c[3]) {
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs(a[k] - b[k] - c[k]));
    return most;
}

/* Contact sees positions and velocities with respect to the body only: pushes and changes of
 * velocity turn with the head, and samples of nodes that stay are the same numbers. */
Test(body_motion, contact_is_what_the_head_sees) {
    static const struct head_motion still;
    struct placement rest, head;
    unsigned seed = 5;
    int pushed = 0, pulled = 0;
    head_placement(&still, 0, &rest);
    for (int i = 0; i < 3000; i++) {
        const double t = lab_between(&seed, -0.09, 0.09);
        const struct head_motion motion = random_motion(&seed);
        const struct wisp wisp = lab_wisp(7, 4, BENDING_SKIP, &seed);
        const struct body body = random_body(&seed);
        struct strand *here = strand_near(&wisp, &seed), *before[2];
        head_placement(&motion, t, &head);
        struct strand *there = carried(here, &head);
        double gravity[3], turned[3];
        random_vector(&seed, 10, gravity);
        placed_direction(&head, gravity, turned);
        before[0] = carried(here, &rest);
        before[1] = carried(here, &head);
        const struct body_motion at[2] = {body_motion(&body, &rest, t),
                                          body_motion(&body, &head, t)};
        struct body_report report[2] = {{0, 0, 0}, {0, 0, 0}};
        body_contact(here, &body, &at[0], 1, gravity, dt, &report[0]);
        body_contact(there, &body, &at[1], 1, turned, dt, &report[1]);
        cr_assert(report[0].nodes == report[1].nodes && report[0].samples == report[1].samples &&
                      report[0].inside == report[1].inside,
                  "case %d: other contacts", i);
        for (int n = 2; n < wisp.nodes; n++) {
            double dp[3], dv[3], p[3], v[3];
            for (int k = 0; k < 3; k++) {
                dp[k] = here->p[n][k] - before[0]->p[n][k];
                dv[k] = here->v[n][k] - before[0]->v[n][k];
            }
            placed_direction(&head, dp, p);
            placed_direction(&head, dv, v);
            cr_assert(difference(there->p[n], before[1]->p[n], p) <= 1e-11 &&
                          difference(there->v[n], before[1]->v[n], v) <= 1e-9,
                      "case %d: node %d is pushed by another vector", i, n);
            const int moved = dp[0] != 0 || dp[1] != 0 || dp[2] != 0;
            pushed += moved;
            for (int at_sample = 4 * n; at_sample < 4 * n + 4; at_sample++) {
                pulled += here->r[at_sample] != before[0]->r[at_sample];
                /* where a node was moved, its velocity belongs to where it was */
                cr_assert(
                    fabs(here->r[at_sample] - there->r[at_sample]) <= 1e-10 &&
                        (moved || fabs(here->rate[at_sample] - there->rate[at_sample]) <= 1e-10),
                    "case %d: sample %d differs", i, at_sample);
            }
        }
    }
    cr_assert(pushed > 1000 && pulled > 1000, "%d pushed, %d pulled", pushed, pulled);
}

/* A ball of radius 0.1 at (d, 0, 0) on a head that turns about y with w: at p = (d, 0, -0.09) it
 * moves with w x p = (-0.09 w, 0, -w d), so towards a node that rests there. */
Test(body_motion, a_ball_on_a_turning_head) {
    const double d = 0.5, w = 0.8, kept = exp(-20 * dt);
    const struct head_motion motion = {
        .knots = 3, .time = {-1, 0, 1}, .rotation = {{0, -0.8, 0}, {0, 0, 0}, {0, 0.8, 0}}};
    const struct body ball = {.centre = {0.5, 0, 0},
                              .radii = {0.1, 0.1, 0.1},
                              .moves = 1,
                              .friction = 20,
                              .elasticity = 0.25,
                              .offset = 1e-3};
    const double p[3] = {d, 0, -0.101}, none[3] = {0};
    const double v[3] = {-0.09 * w * (1 - kept), 0, -w * d * 1.25};
    unsigned seed = 3;
    struct wisp wisp = lab_wisp(5, 0, BENDING_SKIP, &seed);
    struct strand *s = lab_strand(&wisp, WISP_GENERALISED);
    struct placement head;
    struct body_report report = {0, 0, 0};
    for (int i = 0; i < 5; i++)
        s->p[i][1] = 10 + i;
    memcpy(s->p[3], (const double[3]){d, 0, -0.09}, sizeof s->p[3]);
    head_placement(&motion, 0, &head);
    const struct body_motion at = body_motion(&ball, &head, 0);
    body_contact(s, &ball, &at, 1, none, dt, &report);
    cr_assert_eq(report.nodes, 1);
    for (int k = 0; k < 3; k++)
        cr_assert(fabs(s->p[3][k] - p[k]) <= 1e-15 && fabs(s->v[3][k] - v[k]) <= 1e-15,
                  "component %d: %.17g, %.17g", k, s->p[3][k], s->v[3][k]);
}

/* Velocity and spin are derivatives of where the centre is and of where a point of the body is. */
Test(body_motion, velocity_and_spin_are_derivatives) {
    const double h = 1e-5;
    unsigned seed = 9;
    for (int i = 0; i < 200; i++) {
        const struct head_motion motion = random_motion(&seed);
        const struct body body = random_body(&seed);
        const double t = lab_between(&seed, -0.09, 0.09);
        struct placement head[3];
        struct body_motion at[3];
        for (int j = 0; j < 3; j++) {
            head_placement(&motion, t + (j - 1) * h, &head[j]);
            at[j] = body_motion(&body, &head[j], t + (j - 1) * h);
        }
        const double *w = at[1].spin;
        for (int k = 0; k < 3; k++) {
            const double by = (at[2].centre[k] - at[0].centre[k]) / (2 * h);
            cr_assert(fabs(by - at[1].velocity[k]) <= 1e-5 * (1 + fabs(by)), "velocity %g, not %g",
                      at[1].velocity[k], by);
            for (int axis = 0; axis < 3; axis++) {
                const int y = (k + 1) % 3, z = (k + 2) % 3;
                const double turn = (at[2].axes[k][axis] - at[0].axes[k][axis]) / (2 * h);
                const double spin = w[y] * at[1].axes[z][axis] - w[z] * at[1].axes[y][axis];
                cr_assert(fabs(turn - spin) <= 1e-4, "axis %d turns by %g, not %g", axis, spin,
                          turn);
            }
        }
    }
}

/* The box of a turned ellipsoid holds its surface and is reached by it. */
Test(body_motion, boxes_fit) {
    unsigned seed = 13;
    for (int i = 0; i < 100; i++) {
        const struct head_motion motion = random_motion(&seed);
        const struct body body = random_body(&seed);
        struct placement head;
        double box[6], reached[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
        head_placement(&motion, 0.03, &head);
        const struct body_motion at = body_motion(&body, &head, 0.03);
        body_box(&body, &at, box);
        for (int j = 0; j < 4000; j++) {
            const double z = lab_between(&seed, -1, 1), angle = lab_between(&seed, 0, 7);
            const double y[3] = {sqrt(1 - z * z) * cos(angle), sqrt(1 - z * z) * sin(angle), z};
            for (int k = 0; k < 3; k++) {
                double x = at.centre[k];
                for (int axis = 0; axis < 3; axis++)
                    x += at.axes[k][axis] * body.radii[axis] * y[axis];
                cr_assert(x >= box[k] && x <= box[3 + k], "a point is beyond the box");
                reached[k] = fmin(reached[k], x);
                reached[3 + k] = fmax(reached[3 + k], x);
            }
        }
        for (int k = 0; k < 6; k++)
            cr_assert(fabs(reached[k] - box[k]) <= 0.01 * (box[3 + k % 3] - box[k % 3]),
                      "side %d of the box is too far out", k);
    }
}

/* --- whole runs: a wisp falls onto an ellipsoid --- */

/* with a velocity, also of 0, it says that it moves: out of it nodes leave by the normal */
#define EGG_OF(velocity, elasticity)                                                       \
    "body=({ name=\"egg\"; center=[0.15, -0.2, 0.02]; radii=[0.06, 0.09, 0.07]; velocity=" \
    "[" velocity "]; friction=20.0; elasticity=" elasticity "; offset=1e-4; })"
#define EGG(velocity) EGG_OF(velocity, "0.3")
#define STILL         "0.0, 0.0, 0.0"

static void run_scene(struct scene *scene, int treatment, struct lab_run *run) {
    const struct run_request request = {.stepper = "rk4", .treatment = treatment_names[treatment]};
    lab_finish(scene, &request, run);
    cr_assert_gt(run->result.counters.body_contacts, 5, "no contact");
}

/* That the second run is the first one, its head being where `motion` says. */
static void compare(struct lab_run *still, struct lab_run *moving, const struct head_motion *motion,
                    double limit, const char *what) {
    double worst = 0;
    cr_assert(still->frames == moving->frames && still->rows == moving->rows);
    for (int f = 0; f < still->frames; f++) {
        struct placement head;
        head_placement(motion, still->t[f], &head);
        for (int i = 0; i < still->rows; i++) {
            const int row = (f * still->rows + i) * still->columns + 2;
            double expected[3];
            placed_point(&head, 0, still->row + row, expected);
            for (int k = 0; k < 3; k++)
                worst = fmax(worst, fabs(expected[k] - moving->row[row + k]));
        }
    }
    cr_log_info("%s: %g m apart", what, worst);
    cr_assert(worst <= limit, "%s: %g m apart", what, worst);
    cr_assert_eq(still->result.counters.body_contacts, moving->result.counters.body_contacts);
}

/* Knots at -0.1, 0, ..., 0.5, where frames and ticks are too, by a polynomial of degree 2: the
 * slopes of the chords are exact there. */
static struct head_motion smooth_motion(const double velocity[3], const double acceleration[3],
                                        char *set, size_t size) {
    struct head_motion motion = {.knots = 7};
    char positions[1000] = "", rotations[400] = "", times[200] = "";
    const char *one;
    for (int k = 0; k < motion.knots; k++) {
        const double t = (k - 1) / 10.;
        motion.time[k] = t;
        for (int c = 0; c < 3; c++)
            motion.position[k][c] = t * velocity[c] + t * t / 2 * acceleration[c];
        one = printed("%s[%.17e, %.17e, %.17e]", k ? ", " : "", motion.position[k][0],
                      motion.position[k][1], motion.position[k][2]);
        strcat(positions, one);
        strcat(rotations, k ? ", [0.0, 0.0, 0.0]" : "[0.0, 0.0, 0.0]");
        one = printed("%s%.17e", k ? ", " : "", t);
        strcat(times, one);
    }
    snprintf(set, size, "head={ times=[%s]; positions=(%s); rotations=(%s); }", times, positions,
             rotations);
    return motion;
}

/* A train at constant speed, with its wind: nothing in it tells. */
Test(body_motion, a_head_at_constant_velocity_is_a_head_at_rest) {
    const double velocity[3] = {0.3, 0.125, -0.2}, none[3] = {0, 0, 0};
    const char *wind = "wind={ kind=\"steady\"; velocity=[0.3, 0.125, -0.2]; }";
    char head[2000];
    const struct head_motion motion = smooth_motion(velocity, none, head, sizeof head);
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct lab_run still, moving;
        run_scene(LAB_LOAD("swing-envelope", "duration=0.4", EGG(STILL)), treatment, &still);
        run_scene(LAB_LOAD("swing-envelope", "duration=0.4", EGG(STILL), wind, head), treatment,
                  &moving);
        compare(&still, &moving, &motion, 1e-9, treatment_names[treatment]);
    }
}

/* A lift that accelerates upwards without gravity. Not with `projection`, which leaves out that a
 * sample's half-line accelerates; and of a body without elasticity: the speed at its surface is by
 * gravity, wherever the head goes. */
Test(body_motion, an_accelerated_head_is_gravity) {
    const double none[3] = {0, 0, 0}, up[3] = {0, 9.81, 0};
    const char *airless = "material.drag_rate=0.0";
    char head[2000];
    const struct head_motion motion = smooth_motion(none, up, head, sizeof head);
    for (int treatment = WISP_PENALTY; treatment <= WISP_GENERALISED; treatment++) {
        struct lab_run still, moving;
        run_scene(LAB_LOAD("swing-envelope", "duration=0.4", EGG_OF(STILL, "0.0"), airless),
                  treatment, &still);
        run_scene(LAB_LOAD("swing-envelope", "duration=0.4", EGG_OF(STILL, "0.0"), airless,
                           "gravity=[0.0, 0.0, 0.0]", head),
                  treatment, &moving);
        compare(&still, &moving, &motion, 1e-9, treatment_names[treatment]);
    }
}

/* Turned for ever, and gravity with it: ellipsoids have their axes along the head's, at rest and
 * where they have a velocity of their own. */
Test(body_motion, turned_with_the_head_it_is_the_same) {
    const struct head_motion motion = {
        .knots = 1, .position = {{0.1, -0.2, 0.3}}, .rotation = {{0.4, -0.9, 0.7}}};
    struct placement head;
    double down[3];
    head_placement(&motion, 0, &head);
    placed_direction(&head, (const double[3]){0, -9.81, 0}, down);
    const char *const gravity = printed("gravity=[%.17e, %.17e, %.17e]", down[0], down[1], down[2]);
    const char *turn = "head={ times=[0.0]; positions=([0.1, -0.2, 0.3]);"
                       "rotations=([0.4, -0.9, 0.7]); }";
    const char *eggs[] = {EGG(STILL), EGG("0.1, 0.2, -0.05")};
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int i = 0; i < 2; i++) {
            struct lab_run still, moving;
            run_scene(LAB_LOAD("swing-envelope", "duration=0.4", eggs[i]), treatment, &still);
            run_scene(LAB_LOAD("swing-envelope", "duration=0.4", eggs[i], gravity, turn), treatment,
                      &moving);
            compare(&still, &moving, &motion, 1e-9, treatment_names[treatment]);
        }
}
