/* The stepper that README makes, as it stands there. */
#include "fixture.h"
#include "integrators/stepper.h"

#include <criterion/criterion.h>
#include <math.h>

extern const struct stepper_method symplectic_euler;

/* Largest distance from (sin, cos) of the manufactured oscillator after 1.7 s in so many steps. */
static double error_after(int steps) {
    static struct fixture fixture;
    const struct stepper_settings settings = {0};
    const double to = 1.7, h = to / steps;
    double q = 0, v = 1;
    fixture_manufactured(&fixture);
    struct stepper *stepper = stepper_create(&symplectic_euler, &settings, &fixture.system);
    cr_assert(stepper);
    for (int k = 0; k < steps; k++)
        cr_assert_eq(symplectic_euler.step(stepper, k * h, h, &q, &v), 0);
    symplectic_euler.free(stepper);
    return fmax(fabs(q - sin(to)), fabs(v - cos(to)));
}

Test(readme, the_stepper_of_the_walk_has_the_order_it_states) {
    const double order = log2(error_after(4000) / error_after(8000));
    cr_assert_float_eq(order, symplectic_euler.order, 0.05, "order %g", order);
}

/* It does not say STEPPER_PROJECTS, and so must not run where a projection belongs to every step.
 */
Test(readme, it_is_refused_where_a_constraint_is_projected) {
    static struct fixture fixture;
    const struct stepper_settings settings = {0};
    fixture_manufactured(&fixture);
    cr_assert_eq(stepper_refuse(&symplectic_euler, &settings, &fixture.system), 0);
    fixture_add_projection(&fixture);
    cr_assert_eq(stepper_refuse(&symplectic_euler, &settings, &fixture.system), REFUSED);
}
