/* How accelerations change with time alone: against differences, and for the order of a method that
 * needs it. */
#include "model/problems.h"
#include "order.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- against differences --- */

/* A head that goes and turns between all its knots, and a style that grows and parts; times are in
 * the middle of all of them. */
static void set_in_motion(struct surroundings *around, unsigned *seed) {
    around->head.knots = 4;
    around->style.knots = 4;
    around->style.parting.width = 0.05;
    around->style.parting.normal[2] = 1;
    for (int k = 0; k < 4; k++) {
        around->head.time[k] = around->style.time[k] = 0.4 * k;
        for (int c = 0; c < 3; c++) {
            around->head.position[k][c] = lab_between(seed, -0.1, 0.1);
            around->head.rotation[k][c] = lab_between(seed, -0.5, 0.5);
            around->style.acceleration[k][c] = lab_between(seed, -5, 5);
            around->style.parting.acceleration[k][c] = lab_between(seed, -5, 5);
        }
    }
}

/* A sixth-order difference of accelerations, good where something happens in a millisecond; and
 * its rounding, of what springs make. */
static void check_rate(int lanes, int nodes, int samples, enum bending law,
                       enum wisp_treatment treatment, enum lab_state state, enum wind_kind kind,
                       unsigned *seed) {
    enum { SIZE = LAB_LANES * LAB_SIZE };
    static double q[SIZE], v[SIZE], a[6][SIZE], rate[SIZE], one_q[LAB_SIZE], one_v[LAB_SIZE];
    static const double weights[] = {-1. / 60, 3. / 20, -3. / 4, 3. / 4, -3. / 20, 1. / 60};
    const double t = 0.6, h = 1e-4;
    struct surroundings around = lab_surroundings(kind, seed);
    struct wisp wisps[LAB_LANES];
    struct lab_part part;
    set_in_motion(&around, seed);
    for (int k = 0; k < lanes; k++)
        wisps[k] = lab_wisp(nodes, samples, law, seed);
    lab_part_make(&part, lanes, wisps, lanes, &around, treatment);
    struct system *system = &part.system;
    for (int k = 0; k < lanes; k++) {
        lab_state(&wisps[k], treatment, state, 0, seed, one_q, one_v);
        lab_place(&part, k, one_q, q);
        lab_scatter(&part, k, one_v, v);
    }
    double most = 1;
    for (int k = 0; k < 6; k++) {
        cr_assert_eq(system_acceleration(system, t + h * (k < 3 ? k - 3 : k - 2), q, v, a[k]), 0);
        for (int i = 0; i < system->size; i++)
            most = fmax(most, fabs(a[k][i]));
    }
    cr_assert_eq(system_acceleration(system, t, q, v, rate), 0);
    system_time_rate(system, t, q, v, rate);
    for (int i = 0; i < system->size; i++) {
        double difference = 0;
        for (int k = 0; k < 6; k++)
            difference += weights[k] * a[k][i] / h;
        cr_assert(fabs(rate[i] - difference) <= 1e-8 * fabs(rate[i]) + 1e-11 / h * most,
                  "%d lanes, %d nodes, %s, %s, %d samples, state %d, wind %d: unknown %d: %.12g, "
                  "and by differences %.12g",
                  lanes, nodes, law_names[law], treatment_names[treatment], samples, state, kind, i,
                  rate[i], difference);
    }
}

Test(time_rate, is_that_of_differences) {
    static const int shapes[][2] = {{3, 0}, {4, 4}, {8, 0}, {7, 4}, {6, 5}, {3, 3}};
    unsigned seed = 31;
    for (int lanes = 1; lanes <= 4; lanes += 3)
        for (enum bending law = BENDING_NONE; law <= BENDING_HINGE; law++)
            for (int treatment = 0; treatment < TREATMENTS; treatment++)
                for (size_t shape = 0; shape < sizeof shapes / sizeof *shapes; shape++)
                    for (int turn = 0; turn < 8; turn++)
                        check_rate(lanes, shapes[shape][0], shapes[shape][1], law,
                                   (enum wisp_treatment)treatment,
                                   turn < 4 ? STATE_RANDOM : STATE_COMPRESSED,
                                   (enum wind_kind)(turn % WINDS), &seed);
}

/* --- the order of a Rosenbrock method --- */

/* The error of `exponential` on the shaken swing after so many steps, with the rate or without. */
static double error_of(const struct variant *variant, int steps, int with_rate, const double *exact,
                       double *q) {
    const double to = 0.1;
    const struct stepper_settings settings = variant_settings(variant, 1e-12, 1e-13);
    struct scene *scene = LAB_LOAD("swing-shaken", "seed=1");
    struct model *model = lab_model(scene, WISP_GENERALISED, 1);
    struct system *system = &model->parts->system;
    struct system_ops ops = *system->ops;
    double error = 0;
    if (!with_rate)
        ops.time_rate = NULL;
    system->ops = &ops;
    struct stepper *stepper = stepper_create(variant->method, &settings, system);
    cr_assert(stepper, "no memory for a stepper");
    cr_assert_eq(integrate(stepper, 0, to, steps, model->parts->q, model->parts->v), 0, "%s",
                 system->reason);
    memcpy(q, model->parts->q, (size_t)system->size * sizeof *q);
    for (int i = 0; i < system->size && exact; i++)
        error += (q[i] - exact[i]) * (q[i] - exact[i]);
    variant->method->free(stepper);
    return sqrt(error);
}

/* Where the head moves, a method that takes the forces to be linear in the state alone is of order
 * 1. The control is the same method without the rate. */
Test(time_rate, gives_exponential_its_order_under_a_moving_head) {
    static double exact[LAB_SIZE], q[LAB_SIZE];
    const struct variant variant = {.method = stepper_find("exponential"), .name = "exponential"};
    const struct variant reference = {.method = stepper_find("reference"), .name = "reference"};
    error_of(&reference, 0, 1, NULL, exact);
    for (int with_rate = 0; with_rate <= 1; with_rate++) {
        double error[3];
        for (int k = 0; k < 3; k++)
            error[k] = error_of(&variant, 1600 << k, with_rate, exact, q);
        for (int k = 0; k < 2; k++) {
            const double order = log2(error[k] / error[k + 1]);
            cr_expect(fabs(order - (with_rate ? 2 : 1)) <= 0.1,
                      "%s the rate: errors %.2e, %.2e: order %.3f", with_rate ? "with" : "without",
                      error[k], error[k + 1], order);
        }
    }
}
