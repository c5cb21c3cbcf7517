/* Newton's loop by itself: that it solves its equation, with the matrix it says, and how it fails.
 * That its lanes do not feel each other is shown in whole runs (tests/company.c). */
#include "integrators/newton.h"

#include "fixture.h"
#include "support.h"

#include <criterion/criterion.h>
#include <float.h>
#include <math.h>
#include <stdio.h>

enum { N = 7 };

/* The loop for a system, with at most so many iterations and else as usual. */
static struct newton *loop_for(struct system *system, int iterations) {
    static const struct option_spec options[] = {NEWTON_OPTION_SPECS(1), {0}};
    char text[40];
    const char *const given[] = {text};
    snprintf(text, sizeof text, "newton.iterations=%d", iterations);
    const struct stepper_settings settings = {.linear = linear_find("direct"),
                                              .options = {given, 1}};
    struct newton *newton = newton_create(&settings, options, system);
    cr_assert(newton, "no memory");
    return newton;
}

/* On a linear system the first change is the whole way, also from a first iterate that is not
 * q0 + beta v, and the second is rounding; a wrong matrix or right side takes more. gamma is as
 * much as 3 s and beta another number, as in methods that are not Euler's. */
Test(newton, solves_a_linear_equation_at_once) {
    static struct fixture fixture;
    static const double gammas[] = {1e-3, 0.1, 3, 0.1, 0}, betas[] = {2e-3, 0, 0.5, -0.05, 0.2};
    for (int symmetric = 0; symmetric <= 1; symmetric++)
        for (int c = 0; c < 5; c++) {
            double q0[N], v0[N], q[N], v[N], a[N];
            unsigned seed = 21;
            const struct newton_equation equation = {0.3, gammas[c], betas[c], q0, v0};
            fixture_chain(&fixture, N, 5, symmetric);
            struct newton *newton = loop_for(&fixture.system, 2);
            for (int i = 0; i < N; i++) {
                q0[i] = 2 * random_number(&seed) - 1;
                v0[i] = 2 * random_number(&seed) - 1;
                q[i] = 2 * random_number(&seed) - 1;
                v[i] = 2 * random_number(&seed) - 1;
            }
            cr_assert_eq(newton_solve(newton, &equation, q, v), 0, "gamma %g, beta %g: %s",
                         gammas[c], betas[c], fixture.system.reason);
            fixture.system.ops->acceleration(&fixture, equation.t, q, v, a);
            for (int i = 0; i < N; i++) {
                cr_assert_eq(q[i], q0[i] + betas[c] * v[i], "q is not q0 + beta v");
                /* a backward stable solve of 7 equations with entries of order 10 */
                const double scale = 1 + gammas[c] * 40 * N * (1 + fabs(betas[c]));
                cr_assert(fabs(v[i] - v0[i] - gammas[c] * a[i]) <= 1e-13 * scale,
                          "gamma %g, beta %g: v - v0 - gamma a is %.1e", gammas[c], betas[c],
                          v[i] - v0[i] - gammas[c] * a[i]);
            }
            newton_free(newton);
        }
}

/* Convergence is of second order on a nonlinear equation: five iterations from an error of order 1
 * to rounding. */
Test(newton, converges_quadratically) {
    static struct fixture fixture;
    const double q0 = 0.2, v0 = 1, gamma = 0.8, beta = 0.3;
    const struct newton_equation equation = {0.3, gamma, beta, &q0, &v0};
    double q = q0, v = v0, a;
    fixture_manufactured(&fixture);
    struct newton *newton = loop_for(&fixture.system, 6);
    cr_assert_eq(newton_solve(newton, &equation, &q, &v), 0, "%s", fixture.system.reason);
    fixture.system.ops->acceleration(&fixture, equation.t, &q, &v, &a);
    cr_assert(fabs(v - v0 - gamma * a) <= 8 * DBL_EPSILON, "v - v0 - gamma a is %.1e",
              v - v0 - gamma * a);
    newton_free(newton);
}

/* Too few iterations, and an iterate that is lost, are failures with a name; a single iteration is
 * the linearised step, which nobody checks. */
Test(newton, says_that_it_has_no_solution) {
    static struct fixture fixture;
    const double q0 = 0.2, v0 = 1;
    const struct newton_equation equation = {0.3, 0.8, 0.3, &q0, &v0};
    for (int iterations = 1; iterations <= 2; iterations++) {
        double q = q0, v = v0;
        fixture_manufactured(&fixture);
        struct newton *newton = loop_for(&fixture.system, iterations);
        cr_assert_eq(newton_solve(newton, &equation, &q, &v), iterations == 1 ? 0 : SOLVER_STALLED,
                     "%d iterations", iterations);
        newton_free(newton);
    }
    double q = q0, v = v0;
    fixture_manufactured(&fixture);
    fixture.fail_call = CALL_ACCELERATION;
    fixture.fail_at = 2;
    fixture.nan = 1;
    struct newton *newton = loop_for(&fixture.system, 20);
    cr_assert_eq(newton_solve(newton, &equation, &q, &v), NOT_FINITE, "a NaN is a solution");
    newton_free(newton);
}
