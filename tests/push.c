/* Bodies that push by penalty: against the scalar twin, the oscillator that a sphere makes, and
 * what the law says of itself; and through runs of every kind. */
#include "base/vector.h"
#include "model/problems.h"
#include "run/warnings.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp/body.h"
#include "wisp/ellipsoid.h"
#include "wisp_support.h"

#include <complex.h>
#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An ellipsoid around a place, as large as half a wisp or so, that moves at up to 0.5 m/s. */
static struct body lab_body(const double around[3], unsigned *seed) {
    struct body body = {.name = "body",
                        .response = RESPONSE_PENALTY,
                        .friction = lab_between(seed, 0, 60),
                        .frequency = lab_between(seed, 5, 200),
                        .damping_ratio = lab_between(seed, 0, 1.5)};
    for (int k = 0; k < 3; k++) {
        body.centre[k] = around[k] + lab_between(seed, -0.05, 0.05);
        body.radii[k] = lab_between(seed, 0.04, 0.2);
        body.velocity[k] = lab_between(seed, -0.5, 0.5);
    }
    return body;
}

/* --- accelerations --- */

struct crowd {
    struct wisp wisps[LAB_LANES];
    struct surroundings around;
    struct body bodies[3];
    struct lab_part part;
    double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE];
    double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE];
};

/* Wisps with their roots at 0, and bodies about their middles. */
static void make_crowd(struct crowd *crowd, int lanes, int nodes, int samples, enum bending law,
                       enum stretch stretch, enum wisp_treatment treatment, unsigned *seed) {
    crowd->around = lab_surroundings(WIND_STEADY, seed);
    crowd->around.pushing = crowd->bodies;
    crowd->around.pushing_count = 3;
    for (int k = 0; k < LAB_LANES; k++) {
        struct wisp *wisp = &crowd->wisps[k];
        *wisp = lab_wisp(nodes, samples, law, seed);
        wisp->stretch = stretch;
        if (stretch == STRETCH_RIGID)
            wisp->stretch_stiffness = wisp->stretch_time = 0;
        memset(wisp->root, 0, sizeof wisp->root);
    }
    for (int b = 0; b < 3; b++) {
        double middle[3];
        for (int k = 0; k < 3; k++)
            middle[k] = 0.5 * crowd->wisps[b].length * crowd->wisps[b].direction[k];
        crowd->bodies[b] = lab_body(middle, seed);
    }
    lab_part_make(&crowd->part, lanes, crowd->wisps, lanes, &crowd->around, treatment);
    for (int k = 0; k < lanes; k++) {
        lab_state(&crowd->wisps[k], treatment, STATE_RANDOM, 0, seed, crowd->q[k], crowd->v[k]);
        lab_place(&crowd->part, k, crowd->q[k], crowd->Q);
        lab_scatter(&crowd->part, k, crowd->v[k], crowd->V);
    }
}

static struct crowd crowd;

/* How many unknowns of the last crowd are accelerated otherwise than without bodies. */
static int count_pushed(int lane, enum wisp_treatment treatment, const double *a) {
    static struct wisp_twin twin;
    static double alone[LAB_SIZE];
    struct surroundings around = crowd.around;
    int pushed = 0;
    around.pushing_count = 0;
    wisp_twin_init(&twin, &crowd.wisps[lane], &around, treatment);
    wisp_twin_acceleration(&twin, 0.3, crowd.q[lane], crowd.v[lane], alone);
    for (int i = 0; i < crowd.part.size; i++)
        pushed += fabs(alone[i] - a[i]) > 1e-6 * fabs(a[i]);
    return pushed;
}

static void check_crowd(int lanes, enum wisp_treatment treatment, double *worst, int *pushed) {
    static double A[LAB_LANES * LAB_SIZE], a[LAB_SIZE];
    struct system *system = &crowd.part.system;
    cr_assert_eq(system_acceleration(system, 0.3, crowd.Q, crowd.V, A), 0, "%s", system->reason);
    for (int k = 0; k < lanes; k++) {
        lab_gather(&crowd.part, k, A, a);
        *pushed += count_pushed(k, treatment, a);
        lab_check_with_twin(&crowd.wisps[k], &crowd.around, treatment, 0.3, crowd.q[k], crowd.v[k],
                            a, worst);
    }
}

Test(push, accelerations_are_the_twins) {
    static const int samples[] = {0, 3, 4, 5, 8, 16};
    unsigned seed = 101;
    double worst = 0;
    int pushed = 0;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int s = 0; s < 6; s++)
                for (int nodes = 3; nodes <= 15; nodes += 2)
                    for (int lanes = 1; lanes <= 4; lanes += 3) {
                        make_crowd(&crowd, lanes, nodes, samples[s], (enum bending)law,
                                   STRETCH_SPRING, (enum wisp_treatment)treatment, &seed);
                        check_crowd(lanes, (enum wisp_treatment)treatment, &worst, &pushed);
                    }
    cr_assert_gt(pushed, 10000, "only %d unknowns were pushed", pushed);
    cr_log_info("largest difference: %.2g of the tolerance, of %d pushed", worst, pushed);
}

/* Tensions take what bodies do into account: the twin's come from one dense system, good to its
 * condition. */
Test(push, rigid_segments_are_the_twins) {
    static struct wisp_twin twin;
    static double a[LAB_SIZE];
    unsigned seed = 102;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int nodes = 3; nodes <= 11; nodes += 2) {
            const int samples = nodes % 4 == 1 ? 4 : 0;
            make_crowd(&crowd, 1, nodes, samples, BENDING_SKIP, STRETCH_RIGID,
                       (enum wisp_treatment)treatment, &seed);
            struct system *system = &crowd.part.system;
            static double A[LAB_SIZE];
            double most = 0;
            cr_assert_eq(system_acceleration(system, 0.3, crowd.Q, crowd.V, A), 0);
            wisp_twin_init(&twin, &crowd.wisps[0], &crowd.around, (enum wisp_treatment)treatment);
            cr_assert_eq(wisp_twin_acceleration(&twin, 0.3, crowd.q[0], crowd.v[0], a), 0);
            for (int i = 0; i < crowd.part.size; i++)
                most = fmax(most, fabs(a[i]));
            for (int i = 0; i < crowd.part.size; i++)
                cr_assert(fabs(A[i] - a[i]) <= 1e-10 * most, "%s, %d nodes: %.17g, twin %.17g",
                          treatment_names[treatment], nodes, A[i], a[i]);
        }
}

/* A wisp's bits are the same alone and beside others, which touch other bodies. */
Test(push, bits_do_not_depend_on_the_lane) {
    static double A[LAB_LANES * LAB_SIZE], a[LAB_SIZE], alone[LAB_SIZE], Q[LAB_SIZE];
    unsigned seed = 103;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int samples = 0; samples <= 5; samples += 1 + 3 * (samples == 0))
            for (int nodes = 4; nodes <= 12; nodes += 4) {
                make_crowd(&crowd, 4, nodes, samples, BENDING_HINGE, STRETCH_SPRING,
                           (enum wisp_treatment)treatment, &seed);
                system_acceleration(&crowd.part.system, 0.3, crowd.Q, crowd.V, A);
                for (int k = 0; k < 4; k++) {
                    struct lab_part part;
                    lab_part_make(&part, 1, &crowd.wisps[k], 1, &crowd.around,
                                  (enum wisp_treatment)treatment);
                    lab_place(&part, 0, crowd.q[k], Q);
                    system_acceleration(&part.system, 0.3, Q, crowd.v[k], alone);
                    lab_gather(&crowd.part, k, A, a);
                    cr_assert_eq(memcmp(a, alone, (size_t)part.size * sizeof *a), 0,
                                 "%s, %d nodes, %d samples: lane %d has other bits",
                                 treatment_names[treatment], nodes, samples, k);
                }
            }
}

/* What bodies add changes with time as they move, with the head that turns frames as well: the rate
 * against central differences; what the last acceleration left stays. */
Test(push, accelerations_change_with_moving_bodies) {
    static double A[2][LAB_SIZE], rate[LAB_SIZE], again[LAB_SIZE], first[LAB_SIZE];
    unsigned seed = 108;
    const double h = 1e-6;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int i = 0; i < 40; i++) {
            make_crowd(&crowd, 1, 5, i % 2 ? 4 : 0, BENDING_SKIP, STRETCH_SPRING,
                       (enum wisp_treatment)treatment, &seed);
            struct system *system = &crowd.part.system;
            struct head_motion *head = &crowd.around.head;
            double most = 0;
            if (i % 4 > 1) { /* it begins where it is */
                head->knots = 2;
                head->time[1] = 1;
                for (int k = 0; k < 3; k++)
                    head->rotation[1][k] = lab_between(&seed, -1, 1);
                lab_part_make(&crowd.part, 1, crowd.wisps, 1, &crowd.around,
                              (enum wisp_treatment)treatment);
            }
            system_acceleration(system, 0.3 - h, crowd.Q, crowd.V, A[0]);
            system_acceleration(system, 0.3 + h, crowd.Q, crowd.V, A[1]);
            system_acceleration(system, 0.3, crowd.Q, crowd.V, first);
            system_time_rate(system, 0.3, crowd.Q, crowd.V, rate);
            for (int u = 0; u < crowd.part.size; u++)
                most = fmax(most, fabs(first[u]));
            for (int u = 0; u < crowd.part.size; u++) {
                const double difference = (A[1][u] - A[0][u]) / (2 * h);
                cr_assert(fabs(rate[u] - difference) <= 1e-4 * fabs(difference) + 1e-8 * most / h,
                          "%s: %g, by differences %g, of %g", treatment_names[treatment], rate[u],
                          difference, most);
            }
            system_acceleration(system, 0.3, crowd.Q, crowd.V, again);
            cr_assert_eq(memcmp(first, again, (size_t)crowd.part.size * sizeof *first), 0);
        }
}

/* --- one node and one body --- */

/* A wisp of three nodes that feels nothing but bodies, node 2 being free. */
static const struct wisp bare = {.nodes = 3,
                                 .direction = {1, 0, 0},
                                 .length = 2,
                                 .hair_count = 1000,
                                 .hair_density = 5.7e-6,
                                 .bending = BENDING_NONE};

struct single {
    struct surroundings around;
    struct body body;
    struct lab_part part;
};

static void make_single(struct single *single, const struct body *body) {
    single->body = *body;
    single->around = (struct surroundings){.pushing = &single->body, .pushing_count = 1};
    lab_part_make(&single->part, 1, &bare, 1, &single->around, WISP_GENERALISED);
}

static void acceleration_at(struct single *single, double t, const double p[3], const double v[3],
                            double a[3]) {
    struct system *system = &single->part.system;
    cr_assert_eq(system_acceleration(system, t, p, v, a), 0, "%s", system->reason);
}

/* A place in the body at depth 1 - sigma, and any velocity. */
static void place_in(const struct body *body, double depth, unsigned *seed, double p[3],
                     double v[3]) {
    double d[3] = {1, 0, 0};
    lab_turn(d, 5, seed);
    for (int k = 0; k < 3; k++) {
        p[k] = body->centre[k] + (1 - depth) * body->radii[k] * d[k];
        v[k] = lab_between(seed, -3, 3);
    }
}

/* Against the surface a body pushes, along it it slows down: it never pulls in, and never along the
 * motion. */
Test(push, never_attracts) {
    static const double centre[3] = {3, 0.2, -0.1};
    unsigned seed = 104;
    int held = 0, free = 0;
    for (int i = 0; i < 20000; i++) {
        struct body body = lab_body(centre, &seed);
        struct single single;
        double p[3], v[3], a[3], n[3], x[3];
        memset(body.velocity, 0, sizeof body.velocity);
        make_single(&single, &body);
        place_in(&body, i % 2 ? lab_between(&seed, 0, 1) : lab_between(&seed, 0, 0.05), &seed, p,
                 v);
        acceleration_at(&single, 0, p, v, a);
        for (int k = 0; k < 3; k++)
            x[k] = p[k] - body.centre[k];
        ellipsoid_normal(body.radii, x, n);
        const double away = vector_dot(a, n);
        cr_assert_geq(away, -1e-12 * vector_length(a), "it pulls by %g m/s^2", -away);
        vector_add(a, -away, n);
        vector_add(v, -vector_dot(v, n), n);
        cr_assert_leq(vector_dot(a, v), 1e-12 * vector_length(a) * vector_length(v),
                      "it drives what slides");
        held += away > 0;
        free += !(away > 0);
    }
    cr_assert(held > 10000 && free > 500, "%d pushed, %d not", held, free);
}

/* Nothing outside; at the surface it begins from nothing, however fast the point comes: at a depth
 * of e it is of the size of e. At the centre there is no direction, and nothing. */
Test(push, begins_continuously_at_the_surface) {
    static const double centre[3] = {3, 0.2, -0.1};
    unsigned seed = 105;
    for (int i = 0; i < 1000; i++) {
        const struct body body = lab_body(centre, &seed);
        const double omega = 2 * acos(-1) * body.frequency;
        const double bound = omega * omega * 0.2 * 0.2 / 0.04 +
                             20 * (2 * body.damping_ratio * omega + body.friction) * 10;
        struct single single;
        double p[3], v[3], a[3];
        make_single(&single, &body);
        for (double depth = 1e-2; depth > 1e-9; depth /= 10) {
            place_in(&body, depth, &seed, p, v);
            acceleration_at(&single, 0, p, v, a);
            cr_assert_leq(vector_length(a), bound * depth, "%g m/s^2 at depth %g", vector_length(a),
                          depth);
        }
        place_in(&body, -1e-12, &seed, p, v);
        acceleration_at(&single, 0, p, v, a);
        cr_assert_eq(vector_length(a), 0, "%g m/s^2 outside", vector_length(a));
        acceleration_at(&single, 0, body.centre, v, a);
        cr_assert_eq(vector_length(a), 0, "%g m/s^2 at the centre", vector_length(a));
    }
}

/* What is elastic is minus the gradient of the energy, from differences of that. */
Test(push, elastic_part_is_the_energys_gradient) {
    static const double centre[3] = {3, 0.2, -0.1}, still[3] = {0};
    unsigned seed = 106;
    for (int i = 0; i < 300; i++) {
        struct body body = lab_body(centre, &seed);
        struct single single;
        double p[3], v[3], a[3];
        const double h = 1e-5, mass = wisp_node_mass(&bare, 2);
        memset(body.velocity, 0, sizeof body.velocity);
        make_single(&single, &body);
        place_in(&body, lab_between(&seed, 0.01, 0.9), &seed, p, v);
        acceleration_at(&single, 0, p, still, a);
        for (int k = 0; k < 3; k++) {
            struct energies side[2];
            for (int s = 0; s < 2; s++) {
                double x[3] = {p[0], p[1], p[2]};
                x[k] += s ? h : -h;
                const struct system *system = &single.part.system;
                cr_assert_eq(system->ops->energies(system->ctx, 0, x, still, &side[s]), 0);
            }
            const double force = -(side[1].bodies - side[0].bodies) / (2 * h);
            cr_assert(fabs(force - mass * a[k]) <= 1e-5 * mass * vector_length(a),
                      "%g N, the energy falls by %g J/m", mass * a[k], force);
        }
    }
}

/* With a head that is turned and turns, the body is turned with it, and what touches it is dragged
 * along: against the law in the body's own axes, from where the head is. And its exact Jacobians
 * are that law's derivatives. */
Test(push, bodies_turn_with_the_head) {
    static const double centre[3] = {3, 0.2, -0.1};
    unsigned seed = 107;
    for (int i = 0; i < 300; i++) {
        struct body body = lab_body(centre, &seed);
        struct single single = {.body = body};
        single.around = (struct surroundings){.pushing = &single.body, .pushing_count = 1};
        struct head_motion *head = &single.around.head;
        head->knots = 2;
        for (int k = 0; k < 2; k++) {
            head->time[k] = k;
            for (int c = 0; c < 3; c++) {
                head->position[k][c] = lab_between(&seed, -0.1, 0.1);
                head->rotation[k][c] = lab_between(&seed, -1, 1);
            }
        }
        lab_part_make(&single.part, 1, &bare, 1, &single.around, WISP_GENERALISED);
        const double t = lab_between(&seed, 0.1, 0.9), omega = 2 * acos(-1) * body.frequency;
        struct placement at;
        head_placement(head, t, &at);
        const struct body_motion motion = body_motion(&body, &at, t);
        double own[3], v_own[3], p[3], v[3], a[3], expected[3], local[3], n[3], u[3];
        place_in(&(struct body){.radii = {body.radii[0], body.radii[1], body.radii[2]}},
                 lab_between(&seed, 0, 1), &seed, own, v_own);
        for (int k = 0; k < 3; k++)
            p[k] = motion.centre[k] + vector_dot(motion.axes[k], own);
        for (int k = 0; k < 3; k++) {
            const int r = (k + 1) % 3, s = (k + 2) % 3;
            v[k] = motion.velocity[k] + vector_dot(motion.axes[k], v_own) +
                   motion.spin[r] * (p[s] - motion.centre[s]) -
                   motion.spin[s] * (p[r] - motion.centre[r]);
        }
        double square = 0, slope[3];
        for (int k = 0; k < 3; k++)
            square += own[k] * own[k] / (body.radii[k] * body.radii[k]);
        const double sigma = sqrt(square), share = fmin(1, (1 - sigma) / 0.05);
        const double least = fmin(body.radii[0], fmin(body.radii[1], body.radii[2]));
        for (int k = 0; k < 3; k++)
            slope[k] = own[k] / (body.radii[k] * body.radii[k]) / sigma;
        const double steep = vector_length(slope);
        for (int k = 0; k < 3; k++)
            n[k] = slope[k] / steep;
        const double away = vector_dot(v_own, n);
        const double push = fmax(0, omega * omega * least * least * (1 - sigma) * steep -
                                        2 * body.damping_ratio * omega * share * away);
        for (int k = 0; k < 3; k++) {
            u[k] = v_own[k] - away * n[k];
            local[k] = push * n[k] - share * body.friction * u[k];
        }
        for (int k = 0; k < 3; k++)
            expected[k] = vector_dot(motion.axes[k], local);
        double q[3];
        for (int k = 0; k < 3; k++)
            q[k] = p[k] - single.part.origin[0][k];
        acceleration_at(&single, t, q, v, a);
        const double size = omega * omega * least + 40 * omega * vector_length(v_own) +
                            body.friction * vector_length(v_own);
        for (int k = 0; k < 3; k++)
            cr_assert(fabs(a[k] - expected[k]) <= 1e-12 * size, "%.17g m/s^2, not %.17g", a[k],
                      expected[k]);

        /* where neither a kink of s nor of max(0, .) is near */
        const double damper = 2 * body.damping_ratio * omega * share;
        if ((fabs(share - 1) < 1e-3 && 1 - sigma < 0.06) || (fabs(push) < 1 && push > 0)) {
            continue;
        }
        const double mass = wisp_node_mass(&bare, 2), h = 1e-7;
        struct system *system = &single.part.system;
        cr_assert_eq(system_linearise(system, JACOBIAN_EXACT, t, q, v), 0);
        for (int k = 0; k < 6; k++) {
            double x[2][3], y[2][3], side[2][3], e[3] = {0}, column[3];
            const double step = k < 3 ? h : 1e-4;
            for (int s = 0; s < 2; s++) {
                memcpy(x[s], q, sizeof q);
                memcpy(y[s], v, sizeof v);
                (k < 3 ? x[s] : y[s])[k % 3] += s ? step : -step;
                acceleration_at(&single, t, x[s], y[s], side[s]);
            }
            e[k % 3] = 1;
            system_product(system, 0, k >= 3, k < 3, e, column);
            for (int c = 0; c < 3; c++) {
                const double difference = (side[1][c] - side[0][c]) / (2 * step);
                const double of = k < 3 ? size / (least * fmax(sigma, 0.01)) * 20 : damper + 100;
                cr_assert(fabs(column[c] / mass - difference) <= 1e-6 * of + 1e-7 * size,
                          "sigma %g: derivative %g, differences %g, of %g", sigma, column[c] / mass,
                          difference, of);
            }
        }
    }
}

/* --- the sphere's oscillator --- */

/* A weight that is pressed into a sphere: depth'' + 2 zeta omega depth' + omega^2 (depth - rest) =
 * 0 for as long as it is deeper than a twentieth of the radius. */
struct pressed {
    double radius, omega, zeta, rest, start; /* m, rad/s, 1, m, m */
};

static double depth_at(const struct pressed *p, double t) {
    const double complex root = csqrt(p->zeta * p->zeta - 1);
    const double complex a = p->omega * (-p->zeta + root), b = p->omega * (-p->zeta - root);
    return p->rest + (p->start - p->rest) * creal((b * cexp(a * t) - a * cexp(b * t)) / (b - a));
}

/* The node is at x = 2 m, and gravity pulls it along -x to the centre. */
static struct scene *pressed_scene(const struct pressed *p, struct body *body) {
    *body = (struct body){.name = "sphere",
                          .response = RESPONSE_PENALTY,
                          .centre = {bare.length - (p->radius - p->start), 0, 0},
                          .radii = {p->radius, p->radius, p->radius},
                          .friction = 30,
                          .frequency = p->omega / (2 * acos(-1)),
                          .damping_ratio = p->zeta};
    struct surroundings around = {.gravity = {-p->omega * p->omega * p->rest, 0, 0}};
    struct scene *scene = lab_scene(&bare, 1, &around);
    scene->bodies = malloc(sizeof *body);
    cr_assert(scene->bodies, "no memory");
    scene->bodies[0] = *body;
    scene->body_count = 1;
    scene->around.pushing = scene->bodies;
    scene->around.pushing_count = 1;
    scene->run.strain_limit = 10; /* no spring holds it */
    return scene;
}

static const struct pressed pressed_cases[] = {
    {0.3, 20, 0.1, 0.1, 0.16}, {0.3, 20, 1.5, 0.1, 0.02}, {0.5, 7, 0, 0.2, 0.3}};

/* Every method of the registry, to its order: with steps of 1/2000 of a second the phase is off by
 * less than (omega h)^p t omega, first-order methods by 2e-2 at most. */
Test(push, a_sphere_is_an_oscillator_for_every_stepper) {
    int looked = 0;
    for (int m = 0; stepper_methods[m]; m++)
        for (int c = 0; c < 3; c++) {
            const struct stepper_method *method = stepper_methods[m];
            const struct pressed *p = &pressed_cases[c];
            struct body body;
            struct scene *scene = pressed_scene(p, &body);
            struct run_request request = lab_request(method, WISP_GENERALISED);
            struct lab_run run;
            double worst = 0;
            request.step = 5e-4;
            request.rtol = 1e-8;
            request.atol = 1e-10;
            if (method->capabilities & STEPPER_ADAPTIVE)
                request.step = 0;
            else
                request.rtol = request.atol = 0;
            scene->duration = 0.5;
            scene->frame_rate = 100;
            lab_finish(scene, &request, &run);
            for (int f = 0; f < run.frames; f++) {
                const double x = run.row[(f * run.rows + 2) * run.columns + 2];
                const double depth = p->radius - (x - body.centre[0]);
                if (p->start < 0.05 * p->radius || depth_at(p, run.t[f]) < 0.05 * p->radius)
                    cr_assert_fail("case %d leaves what is known", c);
                worst = fmax(worst, fabs(depth - depth_at(p, run.t[f])));
            }
            const double limit =
                method->order == 1 && !(method->capabilities & STEPPER_ADAPTIVE) ? 3e-2 : 1e-3;
            cr_assert_lt(worst, limit * fabs(p->start - p->rest), "%s, case %d: off by %g m of %g",
                         method->name, c, worst, fabs(p->start - p->rest));
            looked++;
        }
    cr_assert_gt(looked, 30);
}

Test(push, a_sphere_is_an_oscillator_to_the_last_digits) {
    for (int c = 0; c < 3; c++) {
        struct body body;
        struct scene *scene = pressed_scene(&pressed_cases[c], &body);
        const struct run_request request = {
            .stepper = "reference", .treatment = "generalised", .rtol = 1e-12, .atol = 1e-14};
        struct lab_run run;
        scene->duration = 1;
        scene->frame_rate = 10;
        lab_finish(scene, &request, &run);
        for (int f = 0; f < run.frames; f++) {
            const double x = run.row[(f * run.rows + 2) * run.columns + 2];
            const double depth = pressed_cases[c].radius - (x - body.centre[0]);
            cr_assert(fabs(depth - depth_at(&pressed_cases[c], run.t[f])) < 1e-10,
                      "case %d at %g s: %.15g m, not %.15g", c, run.t[f], depth,
                      depth_at(&pressed_cases[c], run.t[f]));
        }
    }
}

/* --- scene files --- */

#define PUSHER                                                                         \
    "{ name=\"ball\"; center=[0.1, -0.1, 0.0]; radii=[0.05, 0.06, 0.07]; friction=20;" \
    "  response=\"penalty\"; frequency=40; "

/* Bodies of ticks come first, however the file has them; both keep their order. */
Test(push, bodies_are_read) {
    struct scene *scene = LAB_LOAD(
        "swing-envelope",
        "body=(" PUSHER "}, { name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; "
        "elasticity=0; offset=0; response=\"tick\"; }, { name=\"second\"; center=[3, 0, 0]; "
        "radii=[1, 1, 1]; friction=0; response=\"penalty\"; frequency=2; damping_ratio=0; "
        "velocity=[1, 0, 0]; }, { name=\"b\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; "
        "elasticity=0; offset=0; })");
    static const char *const order[] = {"a", "b", "ball", "second"};
    cr_assert_eq(scene->body_count, 4);
    for (int i = 0; i < 4; i++)
        cr_assert_str_eq(scene->bodies[i].name, order[i]);
    cr_assert_eq(scene_tick_bodies(scene), 2);
    cr_assert_eq(scene->around.pushing, scene->bodies + 2);
    cr_assert(scene->bodies[2].frequency == 40 && scene->bodies[2].damping_ratio == 1 &&
              scene->bodies[2].friction == 20);
    cr_assert(scene->bodies[3].frequency == 2 && scene->bodies[3].damping_ratio == 0 &&
              scene->bodies[3].velocity[0] == 1);
}

Test(push, what_is_wrong_is_refused) {
    static const struct {
        const char *set, *says[2];
    } bad[] = {
        {"body=(" PUSHER " elasticity=0.1; })", {"elasticity", "penalty"}},
        {"body=(" PUSHER " offset=0.1; })", {"offset", "penalty"}},
        {"body=(" PUSHER " damping_ratio=-1; })", {"damping_ratio", "from 0 on"}},
        {"body=({ name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; elasticity=0; "
         "offset=0; frequency=3; })",
         {"frequency", "tick"}},
        {"body=({ name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; elasticity=0; "
         "offset=0; damping_ratio=3; })",
         {"damping_ratio", "tick"}},
        {"body=({ name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; "
         "response=\"penalty\"; })",
         {"frequency", "missing"}},
        {"body=({ name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; "
         "response=\"penalty\"; frequency=0; })",
         {"frequency", "positive"}},
        {"body=({ name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; response=\"penalty\"; "
         "frequency=3; })",
         {"friction", "missing"}},
        {"body=({ name=\"a\"; center=[1, 2, 3]; radii=[1, 1, 1]; friction=1; "
         "response=\"soft\"; })",
         {"response", "penalty"}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        lab_refuse("swing-envelope", &bad[i].set, 1, bad[i].says, 2);
}

/* --- runs --- */

/* A ball in the way of a wisp that swings, moving towards it; without an envelope there are no
 * ticks at all. */
#define BALL_AHEAD                                                                  \
    "body=({ name=\"ball\"; center=[0.15, -0.13, 0.01]; radii=[0.06, 0.05, 0.07]; " \
    "velocity=[0.1, 0.1, 0.0]; friction=20; response=\"penalty\"; frequency=30; })"

static int has_warning(const struct scene *scene, const char *stepper, double step,
                       const char *part) {
    const struct run_request request = {.stepper = stepper, .step = step};
    int found = 0;
    const struct settings settings = settings_of(scene, &request);
    json_t *warnings = scene_warnings(scene, &settings), *one;
    size_t i;
    json_array_foreach(warnings, i, one) found |= strstr(json_string_value(one), part) != NULL;
    json_decref(warnings);
    return found;
}

/* omega = 2 pi 30 Hz: explicit Euler follows the aperiodic case up to 2 / omega = 10.6 ms. */
Test(push, steps_that_are_too_long_are_warned_of) {
    struct scene *scene = LAB_LOAD("swing", BALL_AHEAD);
    cr_assert(has_warning(scene, "euler", 1.2e-2, "euler follows that with steps of up to 0.01"));
    cr_assert(!has_warning(scene, "euler", 1e-2, "follows"));
    cr_assert(!has_warning(scene, "implicit-euler", 1e-1, "follows"));
    cr_assert(!has_warning(scene, "cvode", 0, "follows"));
    scene = LAB_LOAD("swing", "body=(" PUSHER " damping_ratio=0; })");
    cr_assert(has_warning(scene, "euler", 1e-4, "no step of euler follows"));
    cr_assert(!has_warning(scene, "rk4", 1e-4, "follows"));
    /* one that is small and fast, as MODEL's other warning is of */
    scene = LAB_LOAD("swing",
                     "body=({ name=\"pea\"; center=[0.0, -1.0, 0.0]; radii=[1e-3, 1e-3, 1e-3]; "
                     "velocity=[9, 0, 0]; friction=1; response=\"penalty\"; "
                     "frequency=30; })");
    cr_assert(!has_warning(scene, "rk4", 1e-4, "unseen"));
}

/* Bodies by penalty make no ticks and no stops, and count nothing. */
Test(push, there_are_no_ticks) {
    struct scene *scene = LAB_LOAD("swing", BALL_AHEAD);
    struct model *model = lab_model(scene, WISP_GENERALISED, 4);
    cr_assert(model->collision_rate == 0 && model->interaction_rate == 0);
    scene = LAB_LOAD("swing-envelope", BALL_AHEAD);
    model = lab_model(scene, WISP_GENERALISED, 4);
    cr_assert(model->collision_rate == 300 && model->ticks_alone);
}

/* Does it in every treatment, by every method of the registry that takes the scene, with springs
 * and with rigid segments: all come to where `reference` does. */
static void check_all_methods(const char *scene_name, const char *material, int least) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct scene *scene =
            LAB_LOAD(scene_name, BALL_AHEAD, "duration=0.25", "frame_rate=40", material);
        struct scene *free = LAB_LOAD(scene_name, "duration=0.25", "frame_rate=40", material);
        const struct run_request exact = {.stepper = "reference",
                                          .treatment = treatment_names[treatment]};
        struct lab_run tight, alone;
        int looked = 0;
        lab_run(scene, &exact, &tight);
        lab_run(free, &exact, &alone);
        cr_assert_eq(tight.result.outcome, FINISHED, "%s", tight.result.reason);
        cr_assert_eq(tight.result.counters.body_contacts, 0);
        cr_assert_gt(lab_distance(&tight, &alone, 0, 2).rms, 3e-3, "the body does nothing");
        for (int m = 0; stepper_methods[m]; m++) {
            const struct stepper_method *method = stepper_methods[m];
            struct run_request request = lab_request(method, treatment);
            struct settings settings;
            char reason[REASON_SIZE];
            struct lab_run run;
            if (method->capabilities & STEPPER_ADAPTIVE)
                request.rtol = 1e-6, request.atol = 1e-8;
            else
                request.step = 1e-4;
            if (settings_resolve(scene, &request, &settings, reason))
                continue;
            lab_finish(scene, &request, &run);
            const double off = lab_distance(&run, &tight, 0, 2).rms;
            cr_assert_lt(off, 2e-3, "%s, %s, %s: %g m off", scene_name, method->name,
                         treatment_names[treatment], off);
            looked++;
        }
        cr_assert_geq(looked, least, "only %d methods", looked);
    }
}

Test(push, all_methods_go_where_the_reference_does) {
    check_all_methods("swing", "material={}", 12);
    check_all_methods("swing-envelope", "material={}", 12);
}

Test(push, rigid_segments_and_bodies) {
    check_all_methods("swing", "material={ stretch=\"rigid\"; }", 6);
    check_all_methods("swing-envelope", "material={ stretch=\"rigid\"; }", 6);
}

/* A semi-implicit method has a stiff body in its matrix, by itself; where it is told to leave it
 * out, steps that are too long for it explicitly fail, and the run says why. */
Test(push, stiff_bodies_belong_in_the_matrix) {
    static const char *const choices[] = {"matrix=auto", "matrix=full", "matrix=spd",
                                          "matrix=axial", "matrix=stretch"};
    struct scene *scene =
        LAB_LOAD("swing", "duration=0.4",
                 "body=({ name=\"ball\"; center=[0.15, -0.13, 0.01]; radii=[0.06, 0.06, 0.06]; "
                 "friction=50.0; response=\"penalty\"; frequency=1000.0; })");
    for (int i = 0; i < 5; i++) {
        struct lab_run run;
        const struct run_request request = {.stepper = "bdf2",
                                            .treatment = "generalised",
                                            .step = 1. / 500,
                                            .options = &choices[i],
                                            .option_count = 1};
        lab_run(scene, &request, &run);
        if (i < 3)
            cr_assert_eq(run.result.outcome, FINISHED, "%s: %s", choices[i], run.result.reason);
        else
            cr_assert(run.result.outcome != FINISHED &&
                          strstr(run.result.reason, "bodies that push by penalty"),
                      "%s: %s", choices[i], run.result.reason);
    }
}

/* What a moving body puts in, and what it takes, is in the books: of rk4 they close to the works'
 * own error, which falls with the step (of second order but where a point comes into the body). */
struct residue {
    double most, work;
};
static int keep_residue(void *ctx, const struct model *model, double t, const double *rows) {
    struct residue *residue = ctx;
    (void)t, (void)rows;
    residue->most = fmax(residue->most, fabs(model->diagnosis->residual));
    residue->work = fmax(residue->work, fabs(model->diagnosis->work.bodies));
    return 0;
}

Test(push, the_books_close) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        double most[2];
        for (int k = 0; k < 2; k++) {
            struct scene *scene = LAB_LOAD("swing-envelope", BALL_AHEAD, "duration=0.25");
            const struct run_request request = {.stepper = "rk4",
                                                .treatment = treatment_names[treatment],
                                                .step = k ? 1. / 30000 : 1. / 15000,
                                                .diagnostics = 1};
            struct residue residue = {0, 0};
            run_finished(scene, &request, keep_residue, &residue);
            cr_assert_gt(residue.work, 1e-6);
            cr_assert_lt(residue.most, 1e-4 * residue.work, "%s: residual %g J of %g",
                         treatment_names[treatment], residue.most, residue.work);
            most[k] = residue.most;
        }
        cr_assert_lt(most[1], 0.9 * most[0], "%s: residuals %g, %g J", treatment_names[treatment],
                     most[0], most[1]);
    }
}

/* A run that begins later has its body where the clock says. */
Test(push, a_body_is_where_the_clock_says) {
    struct scene *scene = LAB_LOAD("swing", BALL_AHEAD, "begin=0.5", "duration=0.2");
    struct scene *shifted =
        LAB_LOAD("swing", BALL_AHEAD, "duration=0.2", "body.[0].center=[0.2, -0.08, 0.01]");
    const struct run_request request = {.stepper = "reference", .treatment = "generalised"};
    struct lab_run run, other;
    lab_run(scene, &request, &run);
    lab_run(shifted, &request, &other);
    cr_assert_eq(run.frames, other.frames);
    for (int f = 0; f < run.frames; f++)
        run.t[f] = other.t[f];
    cr_assert_lt(lab_distance(&run, &other, 0, 0).largest, 1e-9);
}

/* Wisps that split go on being pushed, in parts that are new and in lanes that are filled: bits do
 * not depend on threads. */
Test(push, wisps_that_split_are_pushed) {
    struct scene *scene = LAB_LOAD(
        "subdivision", "duration=1.2",
        "body=({ name=\"ball\"; center=[0.0, -0.1, 0.0]; radii=[0.05, 0.05, 0.05]; friction=20; "
        "response=\"penalty\"; frequency=20; })");
    struct run_request request = {.stepper = "rk4", .treatment = "generalised", .step = 2e-4};
    const struct run_result one = run_finished(scene, &request, NULL, NULL);
    request.threads = 2;
    const struct run_result other = run_finished(scene, &request, NULL, NULL);
    cr_assert_gt(one.counters.splits, 0);
    cr_assert_eq(memcmp(&one.counters, &other.counters, sizeof one.counters), 0);
}
