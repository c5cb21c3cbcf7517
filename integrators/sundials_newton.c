#include "sundials_newton.h"

#include "first_order.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int verdict_take(struct verdict *verdict, int code) {
    verdict->cause = code;
    if (code < 0 && !verdict->fatal)
        verdict->fatal = code;
    return (code > 0) - (code < 0);
}

int verdict_of_solve(int sign) {
    return sign > 0 ? SUNLS_PACKAGE_FAIL_REC : sign < 0 ? SUN_ERR_EXT_FAIL : 0;
}

int sundials_rate(struct system *system, struct verdict *verdict, double t, N_Vector y,
                  N_Vector y_rate) {
    return verdict_take(
        verdict, first_order_rate(system, t, N_VGetArrayPointer(y), N_VGetArrayPointer(y_rate)));
}

/* The Newton system of an implicit step is (I - gamma J) (dq, dv) = (r, s), where
 * y' = (v, M^-1 f) has, at M, K = df/dq and D = df/dv held, the Jacobian
 *
 *     J = ( 0       I      )        hence   dq - gamma dv                       = r,
 *         ( M^-1 K  M^-1 D )                -gamma K dq + (M - gamma D) dv      = M s.
 *
 * The first row in the second leaves half of the unknowns, and a matrix every solver here knows:
 *
 *     (M - gamma D - gamma^2 K) dv = M s + gamma K r,      dq = r + gamma dv.
 *
 * Integrators keep a factorised system while gamma drifts by up to 30 %, and multiply the whole of
 * (dq, dv) by 2 / (1 + gamma / gamma of the set-up). That presumes the exact solution at the gamma
 * of the set-up, so the right side and dq take that one too, not the current one. */
int sundials_newton_prepare(struct sundials_newton *newton, double t, N_Vector y,
                            sunbooleantype jacobian_holds, sunbooleantype *jacobian_is_new,
                            double gamma) {
    const double *q = N_VGetArrayPointer(y);
    newton->gamma = gamma;
    *jacobian_is_new = !jacobian_holds;
    if (jacobian_holds)
        return 0;
    return verdict_take(newton->verdict, system_linearise(newton->system, newton->kind, t, q,
                                                          q + newton->system->size));
}

static SUNLinearSolver_Type type(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_DIRECT; /* to them: conjugate gradients have a tolerance of their own */
}

static int setup(SUNLinearSolver solver, SUNMatrix no_matrix) {
    (void)no_matrix;
    struct sundials_newton *s = solver->content;
    return verdict_take(s->verdict, linear_factor(s->linear, s->gamma, s->gamma * s->gamma));
}

static int solve(SUNLinearSolver solver, SUNMatrix no_matrix, N_Vector x, N_Vector b,
                 sunrealtype tolerance) {
    (void)no_matrix, (void)tolerance;
    struct sundials_newton *s = solver->content;
    struct system *system = s->system;
    const int n = system->size;
    const double *rq = N_VGetArrayPointer(b), *rv = rq + n;
    double *dq = N_VGetArrayPointer(x), *dv = dq + n;
    double *right = s->work, *stiffness_part = s->work + n;

    system_product(system, 1, 0, 0, rv, right);
    system_product(system, 0, 0, s->gamma, rq, stiffness_part);
    for (int i = 0; i < n; i++)
        right[i] += stiffness_part[i];
    const int sign = verdict_take(s->verdict, linear_solve(s->linear, right, dv));
    if (sign)
        return verdict_of_solve(sign);
    for (int i = 0; i < n; i++)
        dq[i] = rq[i] + s->gamma * dv[i];
    return 0;
}

int sundials_newton_open(struct sundials_newton *s, const struct stepper_settings *settings,
                         int jacobian, struct system *system, struct sundials *sundials,
                         struct verdict *verdict) {
    s->system = system;
    s->verdict = verdict;
    if (linear_choose(settings->linear, system, jacobian, &s->kind))
        return -1;
    s->work = malloc(2 * (size_t)system->size * sizeof(double));
    s->linear = linear_create(settings->linear, system, &settings->options);
    s->solver = SUNLinSolNewEmpty(sundials->context);
    s->no_matrix = SUNMatNewEmpty(sundials->context);
    if (!s->work || !s->linear || !s->solver || !s->no_matrix)
        return -1;
    s->solver->content = s;
    s->solver->ops->gettype = type;
    s->solver->ops->setup = setup;
    s->solver->ops->solve = solve;
    return 0;
}

void sundials_newton_close(struct sundials_newton *s) {
    if (s->solver)
        SUNLinSolFreeEmpty(s->solver);
    if (s->no_matrix)
        SUNMatFreeEmpty(s->no_matrix);
    if (s->linear)
        s->linear->method->free(s->linear);
    free(s->work);
}

void sundials_count(struct system *system, struct sundials_counts *counted,
                    struct sundials_counts now) {
    system->counters.rejected_steps +=
        (long long)(now.rejected - counted->rejected) * system->wisps;
    system->counters.newton_iterations +=
        (long long)(now.iterations - counted->iterations) * system->wisps;
    *counted = now;
}

enum outcome verdict_outcome(const struct verdict *verdict, enum outcome otherwise) {
    return verdict->cause ? (enum outcome)abs(verdict->cause) : otherwise;
}

int sundials_failed(struct system *system, const struct verdict *verdict, enum outcome outcome,
                    const char *name, const char *message) {
    if (!verdict->cause)
        return system_fail(system, -(int)outcome, "%s: %s", name, message);
    char cause[sizeof system->reason];
    memcpy(cause, system->reason, sizeof cause);
    return system_fail(system, -(int)outcome, "%s: %s Cause: %s", name, message, cause);
}

int sundials_too_close(double t, double stop) {
    return stop - t <= 10 * DBL_EPSILON * fmax(fabs(t), fabs(stop));
}
