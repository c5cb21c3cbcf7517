/* The linear solvers: that they solve, agree, and refuse what they cannot do. */
#include "fixture.h"
#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A matrix M - alpha D - beta K of a chain, out of the model's own products. */
static void matrix_of(struct fixture *f, double alpha, double beta, double *a) {
    for (int i = 0; i < f->n * f->n; i++)
        a[i] = f->m[i] - alpha * f->d[i] - beta * f->k[i];
}

/* The largest |b - A x|_i and what it is measured against: |A| |x| + |b|, largest too. */
static double residual(int n, const double *a, const double *b, const double *x, double *scale) {
    double most = 0;
    *scale = 0;
    for (int i = 0; i < n; i++) {
        double r = b[i], sum = fabs(b[i]);
        for (int j = 0; j < n; j++) {
            r -= a[i * n + j] * x[j];
            sum += fabs(a[i * n + j] * x[j]);
        }
        most = fmax(most, fabs(r));
        *scale = fmax(*scale, sum);
    }
    return most;
}

/* The largest sum of absolute values in a row of A^-1. */
static double inverse_norm(int n, const double *a) {
    double sum[FIXTURE_SIZE_MAX] = {0}, most = 0;
    for (int j = 0; j < n; j++) {
        double unit[FIXTURE_SIZE_MAX] = {0}, column[FIXTURE_SIZE_MAX];
        unit[j] = 1;
        dense_solve(n, a, unit, column);
        for (int i = 0; i < n; i++)
            sum[i] += fabs(column[i]);
    }
    for (int i = 0; i < n; i++)
        most = fmax(most, sum[i]);
    return most;
}

static const char *const tight_list[] = {"cg.tolerance=1e-14", "cg.iterations=3"};
static const struct options tight = {tight_list, 1}, tight_and_short = {tight_list, 2};

static const double alphas[] = {0, 0.01, 1, 5}, betas[] = {0, 1e-4, 1, 25};

/* Elimination with pivots or on a definite matrix is backward stable: n = 30 unknowns, each with
 * n roundings, stay below 1e-13 of |A| |x| + |b|; conjugate gradients stop at 1e-14 of |b| by their
 * own reckoning, which drifts by a rounding of |A| |x| per iteration. 1e-12 holds for all. */
static void check_solver(const struct linear_method *method, int symmetric) {
    static struct fixture fixture;
    for (int n = 1; n <= FIXTURE_SIZE_MAX; n++) {
        double a[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX], b[FIXTURE_SIZE_MAX], x[FIXTURE_SIZE_MAX],
            expected[FIXTURE_SIZE_MAX];
        enum jacobian kind;
        unsigned seed = (unsigned)(100 * n);
        fixture_chain(&fixture, n, (unsigned)n, symmetric);
        cr_assert_eq(linear_choose(method, &fixture.system, JACOBIAN_AUTO, &kind), 0, "%s",
                     fixture.system.reason);
        cr_assert_eq(kind, JACOBIAN_EXACT, "auto takes a Jacobian that is not there");
        struct linear_solver *solver = linear_create(method, &fixture.system, &tight);
        cr_assert(solver, "%s: no memory", method->name);
        cr_assert_eq(system_linearise(&fixture.system, kind, 0, b, b), 0, "linearise");
        for (int k = 0; k < 4; k++) {
            matrix_of(&fixture, alphas[k], betas[k], a);
            const double inverse = inverse_norm(n, a);
            cr_assert_eq(linear_factor(solver, alphas[k], betas[k]), 0, "%s: %s", method->name,
                         fixture.system.reason);
            for (int repeat = 0; repeat < 2; repeat++) {
                double scale, difference = 0;
                for (int i = 0; i < n; i++)
                    b[i] = 2 * random_number(&seed) - 1;
                cr_assert_eq(linear_solve(solver, b, x), 0, "%s: %s", method->name,
                             fixture.system.reason);
                const double r = residual(n, a, b, x, &scale);
                cr_assert(r <= 1e-12 * scale, "%s: n = %d, alpha %g: |b - A x| = %.1e of %.1e",
                          method->name, n, alphas[k], r, scale);
                dense_solve(n, a, b, expected);
                for (int i = 0; i < n; i++)
                    difference = fmax(difference, fabs(x[i] - expected[i]));
                /* two residuals of 1e-12 at most, his and that of dense elimination */
                cr_assert(difference <= inverse * 2e-12 * scale,
                          "%s: n = %d: differs from dense elimination by %.1e", method->name, n,
                          difference);
            }
        }
        cr_assert_eq(fixture.system.counters.linear_solves, 8, "%s: %lld solves counted",
                     method->name, fixture.system.counters.linear_solves);
        method->free(solver);
    }
}

Test(linear, solvers_solve_symmetric_definite_chains) {
    for (int i = 0; linear_methods[i]; i++)
        check_solver(linear_methods[i], 1);
}

Test(linear, solvers_that_may_solve_chains_that_are_not_symmetric) {
    int solved = 0;
    for (int i = 0; linear_methods[i]; i++)
        if (!(linear_methods[i]->needs & MATRIX_SYMMETRIC)) {
            check_solver(linear_methods[i], 0);
            solved++;
        }
    cr_assert(solved >= 2, "no solver for a matrix that is not symmetric");
}

/* --- refusals --- */

/* The circle's df/dv is not symmetric: conjugate gradients would run, and end at radius 10.4. */
Test(linear, what_needs_symmetry_refuses_the_circle_and_says_why) {
    struct scene *scene = circle_scene(1, 0);
    struct model *model = scene->problem->create(scene, 0, 1);
    struct system *system = &model->parts[0].system;
    int refused = 0;
    for (int i = 0; linear_methods[i]; i++) {
        enum jacobian kind;
        const struct linear_method *method = linear_methods[i];
        const int code = linear_choose(method, system, JACOBIAN_AUTO, &kind);
        if (!(method->needs & MATRIX_SYMMETRIC)) {
            cr_assert_eq(code, 0, "%s refuses the circle: %s", method->name, system->reason);
            continue;
        }
        refused++;
        cr_assert_eq(code, REFUSED, "%s takes the circle's matrix", method->name);
        cr_assert(strstr(system->reason, method->name) && strstr(system->reason, "symmetric") &&
                      strstr(system->reason, "df/dv") && strstr(system->reason, "circle (free)"),
                  "%s: the reason does not name the matrix: %s", method->name, system->reason);
    }
    cr_assert(refused >= 2, "cg and cholmod must refuse");
    scene->problem->free(model);
}

Test(linear, a_jacobian_that_is_not_there_is_refused) {
    static struct fixture fixture;
    fixture_chain(&fixture, 3, 1, 1);
    for (int i = 0; linear_methods[i]; i++) {
        enum jacobian kind;
        cr_assert_eq(linear_choose(linear_methods[i], &fixture.system, JACOBIAN_SPD, &kind),
                     REFUSED, "%s takes an spd Jacobian that is not there",
                     linear_methods[i]->name);
        cr_assert(strstr(fixture.system.reason, "no spd Jacobian"), "%s: %s",
                  linear_methods[i]->name, fixture.system.reason);
    }
}

/* auto prefers the spd Jacobian where the system has one. */
Test(linear, auto_prefers_the_definite_jacobian) {
    static struct fixture fixture;
    enum jacobian kind;
    fixture_chain(&fixture, 3, 1, 1);
    fixture.system.matrix[JACOBIAN_EXACT] = MATRIX_AVAILABLE | MATRIX_SYMMETRIC;
    cr_assert_eq(linear_choose(linear_find("cg"), &fixture.system, JACOBIAN_EXACT, &kind), REFUSED,
                 "cg takes a matrix that is not definite");
    cr_assert(strstr(fixture.system.reason, "positive definite"), "%s", fixture.system.reason);
    fixture.system.matrix[JACOBIAN_SPD] = MATRIX_AVAILABLE | MATRIX_SYMMETRIC | MATRIX_DEFINITE;
    cr_assert_eq(linear_choose(linear_find("cg"), &fixture.system, JACOBIAN_AUTO, &kind), 0, "%s",
                 fixture.system.reason);
    cr_assert_eq(kind, JACOBIAN_SPD, "cg got the exact Jacobian");
}

Test(linear, a_system_without_the_operations_is_refused) {
    static struct fixture fixture;
    static struct system_ops only;
    fixture_chain(&fixture, 3, 1, 1);
    only.acceleration = fixture.system.ops->acceleration;
    only.linearise = fixture.system.ops->linearise;
    fixture.system.ops = &only;
    for (int i = 0; linear_methods[i]; i++) {
        enum jacobian kind;
        cr_assert_eq(linear_choose(linear_methods[i], &fixture.system, JACOBIAN_AUTO, &kind),
                     REFUSED, "%s works on nothing", linear_methods[i]->name);
        cr_assert(strstr(fixture.system.reason, linear_methods[i]->name), "%s",
                  fixture.system.reason);
    }
}

/* --- matrices that cannot be solved --- */

/* M - alpha D - beta K = 0 or indefinite: a failure with a name, not a number. */
Test(linear, singular_and_indefinite_matrices_fail_and_the_next_one_is_solved) {
    static struct fixture fixture;
    for (int i = 0; linear_methods[i]; i++) {
        const struct linear_method *method = linear_methods[i];
        double b[4] = {1, 2, 3, 4}, x[4], a[16], scale;
        fixture_chain(&fixture, 4, 1, 1);
        struct linear_solver *solver = linear_create(method, &fixture.system, &tight);
        cr_assert(solver, "no memory");
        memcpy(fixture.k, fixture.m, sizeof fixture.k); /* then M - K = 0, */
        fixture.k[0] -= 2;                              /* but for one entry */
        int code = linear_factor(solver, 0, 1);         /* of rank 1 */
        code = code ? code : linear_solve(solver, b, x);
        cr_assert_eq(abs(code), SOLVER_STALLED, "%s: a singular matrix gives %d", method->name,
                     code);
        cr_assert(fixture.system.reason[0], "%s says nothing of it", method->name);
        cr_assert_eq(linear_factor(solver, 0, 0), 0, "%s: %s", method->name, fixture.system.reason);
        cr_assert_eq(linear_solve(solver, b, x), 0, "%s: %s", method->name, fixture.system.reason);
        matrix_of(&fixture, 0, 0, a);
        cr_assert(residual(4, a, b, x, &scale) <= 1e-12 * scale,
                  "%s does not recover from a singular matrix", method->name);
        method->free(solver);
    }
}

/* cg says how far it came; it never gives an answer it does not have. */
Test(linear, cg_stops_at_its_iterations) {
    static struct fixture fixture;
    const struct linear_method *cg = linear_find("cg");
    double b[FIXTURE_SIZE_MAX], x[FIXTURE_SIZE_MAX];
    fixture_chain(&fixture, FIXTURE_SIZE_MAX, 1, 1);
    for (int i = 0; i < FIXTURE_SIZE_MAX; i++)
        b[i] = i == 0;
    struct linear_solver *solver = linear_create(cg, &fixture.system, &tight_and_short);
    cr_assert(solver, "no memory");
    cr_assert_eq(linear_factor(solver, 1, 1), 0, "factor");
    cr_assert_eq(linear_solve(solver, b, x), SOLVER_STALLED, "3 iterations do for 30 unknowns");
    cr_assert(strstr(fixture.system.reason, "3 iterations"), "%s", fixture.system.reason);
    cr_assert_eq(fixture.system.counters.linear_iterations, 3, "%lld iterations counted",
                 fixture.system.counters.linear_iterations);
    b[3] = NAN;
    cr_assert_eq(linear_solve(solver, b, x), SOLVER_STALLED, "a NaN is solved");
    cg->free(solver);
}
