/* What is known in closed form: the discrete solution of every Runge-Kutta method on the circle,
 * and the position errors that follow from it. */
#include "closed_forms.h"
#include "model/circle.h"
#include "scene/scene_load.h"
#include "support.h"

#include <complex.h>
#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

static const struct oracle {
    const char *stepper, *option;
    double longest_step; /* s, for which its iteration converges */
} oracles[] = {
    {"euler", NULL, 4},
    {"midpoint", NULL, 4},
    {"rk4", NULL, 4},
    {"implicit-euler", NULL, 4},
    {"implicit-euler", "newton.iterations=30", 1},
};
enum { ORACLES = sizeof oracles / sizeof *oracles };

/* With z = x + iy a full step multiplies position and velocity by R(-i omega h). A step commits a
 * few dozen roundings of 1.1e-16, and 200 steps add up to less than 1e-12 of the radius; the
 * oracle's own power, as a polar form, is good to n |arg R| roundings. Up to 40 rad, a little more
 * than the thesis's 160 s: a rounding that turns the velocity outwards is carried on by the motion
 * itself (with w = log z, w'' = -(w'^2 + |w'|^2)) and moves the phase by its own size times
 * (omega t)^2, which soon is more than all the others. Implicit Euler carries it on by a factor
 * 1 + O((omega h)^2) a step, hence its own limit. */
Test(oracle, steps_multiply_by_the_stability_function) {
    static const double steps[] = {0.1, 0.4, 0.8, 1.6, 3.2};
    static const int counts[] = {1, 7, 50, 200};

    for (int i = 0; i < ORACLES; i++)
        for (int k = 0; k < 5 && steps[k] <= oracles[i].longest_step; k++)
            for (int c = 0; c < 4; c++) {
                const int n = counts[c];
                const double h = steps[k];
                const int implicit = strncmp(oracles[i].stepper, "implicit", 8) == 0;
                if (CIRCLE_RATE * n * h > 40 || (implicit && n * pow(CIRCLE_RATE * h, 2) > 2))
                    continue;
                const double complex power =
                    cexp(n * clog(closed_form(oracles[i].stepper, -I * CIRCLE_RATE * h)));
                const double complex position = CIRCLE_RADIUS * power;
                const double complex velocity = -I * CIRCLE_SPEED * power;
                struct scene *scene = circle_scene(n * h, 0);
                struct orbit orbit;
                run_circle(scene,
                           &(struct run_request){.stepper = oracles[i].stepper,
                                                 .step = h,
                                                 .options = &oracles[i].option,
                                                 .option_count = oracles[i].option != NULL},
                           &orbit);
                cr_assert_eq(orbit.result.counters.steps, n, "%s: %lld steps for %d of %g s",
                             oracles[i].stepper, orbit.result.counters.steps, n, h);
                const double off = cabs(orbit.x + I * orbit.y - position) / cabs(position);
                cr_assert(off <= 1e-12, "%s: %d steps of %g s are %.2e of the radius off R^n",
                          oracles[i].stepper, n, h, off);
                const double speed_off = cabs(orbit.vx + I * orbit.vy - velocity) / cabs(velocity);
                cr_assert(speed_off <= 1e-12, "%s: %d steps of %g s: the velocity is %.2e off",
                          oracles[i].stepper, n, h, speed_off);
            }
}

/* A registered Runge-Kutta method without a line above would escape the test. */
Test(oracle, every_fixed_step_method_has_an_oracle) {
    for (int m = 0; stepper_methods[m]; m++) {
        int known = 0;
        for (int i = 0; i < ORACLES; i++)
            known += strcmp(oracles[i].stepper, stepper_methods[m]->name) == 0;
        cr_assert(
            known || !stepper_methods[m]->table,
            "%s has a table: write its stability function into tests/closed_forms.c, and it here",
            stepper_methods[m]->name);
    }
}

/* Projection keeps the argument of R and replaces its modulus by 1. A velocity that is not quite
 * across the radius stays so, and in implicit Euler's steps its angle grows by 1 + O((omega h)^2) =
 * 1.05 each: 50 steps make ten roundings of one. */
Test(oracle, projection_leaves_the_phase) {
    for (int i = 0; i < ORACLES; i++) {
        const double h = 0.8;
        const int n = 50;
        const double phase = n * carg(closed_form(oracles[i].stepper, -I * CIRCLE_RATE * h));
        struct scene *scene = circle_scene(n * h, 0);
        struct orbit orbit;
        run_circle(scene,
                   &(struct run_request){.stepper = oracles[i].stepper,
                                         .treatment = "projection",
                                         .step = h,
                                         .options = &oracles[i].option,
                                         .option_count = oracles[i].option != NULL},
                   &orbit);
        const double off =
            cabs(orbit.x + I * orbit.y - CIRCLE_RADIUS * cexp(I * phase)) / CIRCLE_RADIUS;
        cr_assert(off <= 1e-12, "%s, projected: %.2e of the radius off e^(i n arg R)",
                  oracles[i].stepper, off);
    }
}

/* The tables against the written-out functions; elimination of at most 4 unknowns with entries of
 * order one loses a few roundings. */
Test(oracle, tables_have_the_written_out_stability_functions) {
    for (int i = 0; i < ORACLES; i++) {
        const struct butcher_table *table = stepper_find(oracles[i].stepper)->table;
        for (double re = -3; re <= 1; re += 0.37)
            for (double im = -3; im <= 3; im += 0.41) {
                const double complex z = re + I * im;
                const double complex expected = closed_form(oracles[i].stepper, z);
                const double off = cabs(butcher_stability(table, z) - expected);
                cr_assert(off <= 1e-13 * (1 + cabs(expected)), "%s: R(%g + %gi) is %.2e off",
                          oracles[i].stepper, re, im, off);
            }
    }
}

/* Worked out by hand from the discrete solutions; half a unit of the last printed digit. */
static const struct row {
    const char *stepper, *treatment;
    double step, error_30, error_160, radius_160;
    double half_error_160, half_radius; /* of the last digit, where it is not the fifth */
} rows[] = {
    {"euler", "free", 0.8, 0.71150, 19.374, 20.211, 0.5e-3, 0.5e-3},
    {"midpoint", "free", 1.6, 0.12598, 0.72774, 1.09858, 0.5e-5, 0.5e-5},
    {"rk4", "free", 3.2, 0.01218, 0.06646, 0.86290, 0.5e-5, 0.5e-5},
    {"implicit-euler", "free", 0.8, 0.39854, 0.86272, 0.04008, 0.5e-5, 0.5e-5},
    {"euler", "projection", 0.8, 0.06141, 0.32901, 0.9, 0.5e-5, 1e-13},
    {"euler", "generalised", 0.8, 0, 0, 0.9, 1e-12, 1e-13},
    {"euler", "free", 0.0125, 0.00837, 0.04556, 0.94556, 0.5e-5, 0.5e-5},
};

Test(oracle, the_table_of_the_circle_test) {
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const struct row *row = &rows[i];
        const struct run_request request = {
            .stepper = row->stepper, .treatment = row->treatment, .step = row->step};
        for (int late = 0; late <= 1; late++) {
            struct scene *scene = circle_scene(late ? 160 : 30, 0);
            struct orbit orbit;
            run_circle(scene, &request, &orbit);
            cr_assert_eq(orbit.t, late ? 160 : 30, "%s ends at %.17g s", row->stepper, orbit.t);
            const double expected = late ? row->error_160 : row->error_30;
            const double half = late ? row->half_error_160 : expected == 0 ? 1e-12 : 0.5e-5;
            cr_assert(fabs(orbit.error - expected) <= half, "%s, %s, %g s: error %.6f, not %.5f",
                      row->stepper, row->treatment, row->step, orbit.error, expected);
            const double radius = hypot(orbit.x, orbit.y);
            cr_assert(!late || fabs(radius - row->radius_160) <= row->half_radius,
                      "%s, %s, %g s: radius %.6f, not %.5f", row->stepper, row->treatment,
                      row->step, radius, row->radius_160);
        }
    }
}
