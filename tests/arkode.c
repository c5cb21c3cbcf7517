/* ARKODE's pairs: each of the order that its number says, the additive ones whatever is solved for.
 * (What ERKStep makes of a table of ours is in erkstep.c.) */
#include "fixture.h"
#include "order.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The error of the made-up oscillator at 5 s, and the number of steps. */
static double error_at(const struct stepper_method *method, const char *option, double rtol,
                       double *steps) {
    static struct fixture fixture;
    const struct stepper_settings settings = {
        .linear = linear_find("direct"), .rtol = rtol, .atol = rtol, .options = {&option, 1}};
    double t = 0, q = 0, v = 1;
    fixture_manufactured(&fixture);
    struct stepper *stepper = stepper_create(method, &settings, &fixture.system);
    cr_assert(stepper, "no memory");
    for (*steps = 0; t < 5; ++*steps)
        cr_assert_eq(method->advance(stepper, &t, 5, &q, &v), 0, "%s", fixture.system.reason);
    method->free(stepper);
    return hypot(q - sin(5), v - cos(5));
}

/* Steps follow the tolerance everywhere alike, so the error falls with a power of their number. */
static void check_pair(const char *name, int order) {
    double error[2], steps[2];
    const char *const option = printed("order=%d", order);
    for (int k = 0; k < 2; k++)
        error[k] = error_at(stepper_find(name), option, pow(10, -order - 2 - 3 * k), &steps[k]);
    const double seen = log(error[0] / error[1]) / log(steps[1] / steps[0]);
    cr_expect(seen >= order - 0.5 && seen <= order + 1,
              "%s %s: %.0f and %.0f steps, errors %.2e and %.2e: order %.2f", name, option,
              steps[0], steps[1], error[0], error[1], seen);
}

Test(arkode, pairs_have_their_orders) {
    for (int order = 2; order <= 6; order++)
        check_pair("arkode-erk", order);
    for (int order = 2; order <= 5; order++)
        check_pair("arkode-dirk", order);
    for (int order = 3; order <= 5; order++)
        check_pair("arkode-imex", order);
}
