/* Extended position based dynamics: what its sweeps converge to, and its order. */
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Acceleration less that without springs: what springs do, where M is one number a node. */
static void of_springs(struct system *system, double t, const double *q, const double *v,
                       double *a) {
    static double others[LAB_LANES * LAB_SIZE];
    cr_assert_eq(system_without_springs(system, t, q, v, others), 0, "%s", system->reason);
    cr_assert_eq(system_acceleration(system, t, q, v, a), 0, "%s", system->reason);
    for (int i = 0; i < system->size; i++)
        a[i] -= others[i];
}

/* A straight wisp whose nodes move along it, at random places and velocities. */
static void straighten(const struct wisp *wisp, unsigned *seed, double *q, double *v) {
    const double l = wisp_spacing(wisp);
    double along = l;
    for (int i = 2; i < wisp->nodes; i++) {
        const double rate = lab_between(seed, -1, 1);
        along += l * lab_between(seed, 0.7, 1.4);
        for (int c = 0; c < 3; c++) {
            q[3 * (i - 2) + c] = wisp->root[c] + along * wisp->direction[c];
            v[3 * (i - 2) + c] = rate * wisp->direction[c];
        }
    }
}

/* With as many sweeps as it takes, a step is implicit Euler in the springs at the end of it and
 * explicit in what else there is at its start: v1 - v0 = h (a_others(t0, q0, v0) +
 * a_springs(t1, q1, v1)), q1 = q0 + h v1, also under a head that moves. In a line, for where
 * springs turn in a step a sweep pulls in the direction that it finds. */
static void check_limit(int lanes, enum bending law, unsigned *seed) {
    static double q[LAB_LANES * LAB_SIZE], v[LAB_LANES * LAB_SIZE], q0[LAB_LANES * LAB_SIZE],
        v0[LAB_LANES * LAB_SIZE], others[LAB_LANES * LAB_SIZE], springs[LAB_LANES * LAB_SIZE],
        one_q[LAB_SIZE], one_v[LAB_SIZE];
    const struct stepper_method *method = stepper_find("xpbd");
    const char *const sweeps = "sweeps=4000";
    const struct stepper_settings settings = {.options = {&sweeps, 1}};
    const double t = 0.1, h = 1e-3;
    struct surroundings around = {.head = {.knots = 2, .time = {0, 1}}};
    struct wisp wisps[LAB_LANES];
    struct lab_part part;
    for (int k = 0; k < lanes; k++) {
        wisps[k] = lab_wisp(6, 0, law, seed);
        memcpy(wisps[k].direction, wisps[0].direction, sizeof wisps[k].direction);
    }
    for (int c = 0; c < 3; c++) {
        around.head.position[1][c] = 0.3 * wisps->direction[c];
        around.gravity[c] = 9.81 * wisps->direction[c];
    }
    lab_part_make(&part, lanes, wisps, lanes, &around, WISP_GENERALISED);
    struct system *system = &part.system;
    system->springs = 2 * wisps->nodes * lanes;
    for (int k = 0; k < lanes; k++) {
        straighten(&wisps[k], seed, one_q, one_v);
        lab_place(&part, k, one_q, q);
        lab_scatter(&part, k, one_v, v);
    }
    memcpy(q0, q, sizeof q);
    memcpy(v0, v, sizeof v);
    struct stepper *stepper = stepper_create(method, &settings, system);
    cr_assert(stepper, "no memory");
    cr_assert_eq(system_acceleration(system, t, q, v, others), 0); /* leaves no trace */
    cr_assert_eq(method->step(stepper, t, h, q, v), 0, "%s", system->reason);
    cr_assert_eq(system_without_springs(system, t, q0, v0, others), 0, "%s", system->reason);
    of_springs(system, t + h, q, v, springs);
    for (int i = 0; i < system->size; i++) {
        const double a = (v[i] - v0[i]) / h;
        cr_assert(fabs(a - others[i] - springs[i]) <= 1e-8 * (1 + fabs(springs[i])),
                  "%d lanes, %s: unknown %d has %g, not %g + %g", lanes, law_names[law], i, a,
                  others[i], springs[i]);
        cr_assert(fabs(q[i] - q0[i] - h * v[i]) <= 1e-15);
    }
    cr_assert_eq(system->counters.sweeps, 4000 * lanes);
    method->free(stepper);
}

Test(xpbd, sweeps_converge_to_implicit_euler_in_the_springs) {
    unsigned seed = 5;
    for (int lanes = 1; lanes <= 4; lanes += 3)
        for (enum bending law = BENDING_NONE; law <= BENDING_SKIP; law++)
            for (int turn = 0; turn < 5; turn++)
                check_limit(lanes, law, &seed);
}

/* The error of the last of its frames. */
static double error_at(const struct scene *scene, const char *treatment, const char *sweeps,
                       double rate, const struct lab_run *exact) {
    const struct run_request request = {.stepper = "xpbd",
                                        .treatment = treatment,
                                        .step = 1 / rate,
                                        .options = &sweeps,
                                        .option_count = 1};
    return lab_error(scene, &request, exact);
}

/* Where sweeps suffice. */
static void check_order(const char *name, int treatment) {
    struct scene *scene = LAB_LOAD(name, "duration=0.1", "frame_rate=20.0");
    const struct run_request tight = {.stepper = "reference",
                                      .treatment = treatment_names[treatment],
                                      .rtol = 1e-13,
                                      .atol = 1e-14};
    struct lab_run exact;
    double error[3];
    lab_run(scene, &tight, &exact);
    for (int k = 0; k < 3; k++)
        error[k] = error_at(scene, tight.treatment, "sweeps=60", 7680 << k, &exact);
    lab_check_order(printed("%s, %s", name, tight.treatment), error, 1, 0.1, 0.1);
}

Test(xpbd, is_of_order_1) {
    check_order("swing", WISP_GENERALISED);
    check_order("swing-shaken", WISP_GENERALISED); /* hinges, out of the plane */
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        check_order("swing-envelope", treatment);
}

/* Few sweeps at long steps leave hair softer than it is. */
Test(xpbd, few_sweeps_stretch_hair) {
    struct scene *scene = LAB_LOAD("swing", "duration=0.5");
    static const char *const sweeps[] = {"sweeps=6", "sweeps=100"};
    double strain[2];
    for (int k = 0; k < 2; k++) {
        const struct run_request request = {
            .stepper = "xpbd", .step = 1 / 300., .options = &sweeps[k], .option_count = 1};
        struct lab_run run;
        lab_finish(scene, &request, &run);
        strain[k] = run.result.largest_strain;
    }
    cr_expect(strain[0] > 1.5 * strain[1], "%g and %g", strain[0], strain[1]);
}
