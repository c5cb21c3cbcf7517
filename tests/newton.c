/* Newton's loop by itself: that it solves its equation, with the matrix it says, and how it fails.
 * That its lanes do not feel each other is shown in whole runs (tests/company.c). */
#include "integrators/newton.h"

#include "fixture.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

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

/* --- a matrix that is kept --- */

/* Implicit Euler with an option, on a fixture. */
static struct stepper *euler_with(struct system *system, const char *const *options, int count) {
    const struct stepper_settings settings = {.linear = linear_find("direct"),
                                              .options = {options, count}};
    struct stepper *stepper = stepper_create(stepper_find("implicit-euler"), &settings, system);
    cr_assert(stepper, "no memory");
    return stepper;
}

/* On a linear system the matrix is always the same: it is made once, and again only for another
 * step, and all steps are those that they are without. */
Test(newton, a_matrix_is_kept_as_long_as_it_is_right) {
    static const char *const keeps[] = {"newton.reuse=1000"};
    static const double steps[] = {0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0.1};
    static struct fixture kept, fresh;
    double q[N], v[N], Q[N], V[N], t = 0;
    unsigned seed = 21;
    fixture_chain(&kept, N, 5, 1);
    fixture_chain(&fresh, N, 5, 1);
    struct stepper *one = euler_with(&kept.system, keeps, 1);
    struct stepper *other = euler_with(&fresh.system, NULL, 0);
    for (int i = 0; i < N; i++) {
        q[i] = Q[i] = 2 * random_number(&seed) - 1;
        v[i] = V[i] = 2 * random_number(&seed) - 1;
    }
    for (size_t k = 0; k < sizeof steps / sizeof *steps; t += steps[k++]) {
        cr_assert_eq(one->method->step(one, t, steps[k], q, v), 0);
        cr_assert_eq(other->method->step(other, t, steps[k], Q, V), 0);
        for (int i = 0; i < N; i++)
            cr_assert(q[i] == Q[i] && v[i] == V[i], "step %zu: %g is not %g", k, v[i], V[i]);
    }
    cr_assert_eq(kept.system.counters.factorisations, 3, "%lld times",
                 kept.system.counters.factorisations);
    q[0] += 1; /* something outside moves it */
    cr_assert_eq(one->method->step(one, t, 0.1, q, v), 0);
    cr_assert_eq(kept.system.counters.factorisations, 4, "an event is not seen");
    one->method->free(one);
    other->method->free(other);
}

/* The made-up oscillator from 0 to 1.7 s: its error, and how often the matrix was made. */
static double oscillator_with(const char *const *options, int count, int steps, long long *made) {
    static struct fixture fixture;
    double q = 0, v = 1;
    fixture_manufactured(&fixture);
    struct stepper *stepper = euler_with(&fixture.system, options, count);
    cr_assert_eq(integrate(stepper, 0, 1.7, steps, &q, &v), 0, "%s", fixture.system.reason);
    stepper->method->free(stepper);
    *made = fixture.system.counters.factorisations;
    return q - sin(1.7);
}

/* With a single iteration the order stays 1, and a matrix serves for five steps. Iterated to the
 * end, the solution is that of the equations, whatever matrix led there: it stays the same. */
Test(newton, a_matrix_that_is_old_costs_no_order) {
    static const char *const once[] = {"newton.reuse=5"}, *const iterated[] = {
                                                              "newton.iterations=100",
                                                              "newton.reuse=50"};
    for (int steps = 500; steps <= 2000; steps *= 2) {
        long long made, anew;
        const double error = oscillator_with(once, 1, steps, &made),
                     finer = oscillator_with(once, 1, 2 * steps, &anew);
        const double order = log2(fabs(error / finer));
        cr_assert(fabs(order - 1) < 0.05, "%d steps: order %.3f", steps, order);
        cr_assert_eq(made, steps / 5);
        const double kept = oscillator_with(iterated, 2, steps, &made),
                     fresh = oscillator_with(iterated, 1, steps, &anew);
        cr_assert(fabs(kept - fresh) < 1e-9, "%d steps: %.3e and %.3e", steps, kept, fresh);
        cr_assert(made < steps / 10 && anew > steps, "%lld and %lld matrices", made, anew);
    }
}

/* A force whose slope grows a hundredfold in ten steps. */
static void stiffening(const struct fixture *f, double t, const double *q, const double *v,
                       double *a) {
    (void)f, (void)v;
    a[0] = -exp(5 * t) * q[0];
}

static void stiffening_slope(struct fixture *f, double t, const double *q, const double *v) {
    (void)q, (void)v;
    f->k[0] = -exp(5 * t);
}

/* An old matrix of such converges badly: it is made anew before its time, but not in every step. */
Test(newton, a_matrix_that_converges_badly_is_made_anew) {
    static const char *const options[] = {"newton.iterations=100", "newton.reuse=1000"};
    static struct fixture fixture;
    double q = 1, v = 0;
    fixture_begin(&fixture, "a spring that stiffens", 1, 0, MATRIX_AVAILABLE);
    fixture.rate = stiffening;
    fixture.jacobians = stiffening_slope;
    struct stepper *stepper = euler_with(&fixture.system, options, 2);
    cr_assert_eq(integrate(stepper, 0, 1, 10, &q, &v), 0, "%s", fixture.system.reason);
    const long long made = fixture.system.counters.factorisations;
    cr_assert(made > 1 && made < 10, "%lld times in 10 steps", made);
    stepper->method->free(stepper);
}

enum { KEPT_STEPS = 20 };

/* Some lanes are pushed before some steps. */
static void step_kept(struct lab_part *part, int place, double *q, double *v, void *ctx) {
    part->system.matrix[JACOBIAN_SPD] =
        MATRIX_AVAILABLE | MATRIX_SYMMETRIC | MATRIX_DEFINITE | MATRIX_FACTORABLE;
    struct stepper *stepper = euler_with(&part->system, ctx, 2);
    for (int k = 0; k < KEPT_STEPS; k++) {
        const unsigned pushed = k == 7 ? 0x44 : k == 8 ? 0x83 : k == 13 ? 0x28 : 0;
        for (int l = 0; l < part->lanes; l++)
            if (pushed >> (place < 0 ? l : place) & 1)
                v[5 * part->lanes + l] += 0.3;
        cr_assert_eq(stepper->method->step(stepper, k * 2e-4, 2e-4, q, v), 0, "%s",
                     part->system.reason);
    }
    stepper->method->free(stepper);
}

/* Whoever beside it needs another matrix, a wisp keeps its own; what is counted is what it asks
 * for.
 */
static void check_kept(int lanes, const char **options, enum bending law,
                       enum wisp_treatment treatment) {
    unsigned seed = 41;
    const struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
    const struct lab_company company =
        lab_company(lanes, law, treatment, &around, &seed, step_kept, options);
    const long long made = company.alone.factorisations;
    cr_assert_eq(company.together.factorisations, made, "%s, %s: %lld factorisations, alone %lld",
                 options[0], options[1], company.together.factorisations, made);
    cr_assert(made > 4 && made < lanes * KEPT_STEPS * 2, "%lld", made);
}

Test(newton, lanes_keep_their_own_matrices) {
    static const char *options[][2] = {
        {"newton.reuse=6", "newton.iterations=1"},
        {"newton.reuse=50", "newton.iterations=60"},
    };
    for (int i = 0; i < 2; i++)
        for (int lanes = 4; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
            check_kept(lanes, options[i], BENDING_SKIP, WISP_GENERALISED);
            check_kept(lanes, options[i], BENDING_HINGE, WISP_PENALTY);
        }
}

/* The model's own solver makes and solves the equation at once; others have it as a sparse matrix,
 * made of the same Jacobians: they agree to the rounding of a few hundred solves. */
Test(newton, solving_at_once_is_solving_step_by_step) {
    static const char *const scenes[] = {"swing-envelope", "swing-shaken"};
    static const char *const iterations[] = {"newton.iterations=1", "newton.iterations=30"};
    for (int s = 0; s < 2; s++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++)
            for (int i = 0; i < 2; i++) {
                struct scene *scene = LAB_LOAD(scenes[s], "duration=0.1");
                struct run_request request = {.stepper = "implicit-euler",
                                              .treatment = treatment_names[treatment],
                                              .linear = "direct",
                                              .step = 5e-4,
                                              .options = &iterations[i],
                                              .option_count = 1};
                struct lab_run once, apart;
                lab_run(scene, &request, &once);
                request.linear = "klu";
                if (treatment != WISP_PROJECTION) { /* there that matrix is not symmetric */
                    const char *options[] = {iterations[i], "jacobian=spd"};
                    request.options = options;
                    request.option_count = 2;
                    lab_run(scene, &request, &apart);
                    const double off = lab_distance(&once, &apart, 1, 2).largest;
                    cr_assert(once.frames == apart.frames && off < 1e-11, "%s, %s, %s: %.1e m",
                              scenes[s], treatment_names[treatment], iterations[i], off);
                }
                cr_assert_eq(once.result.counters.linearisations, 0);
            }
}
