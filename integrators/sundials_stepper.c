#include "sundials_stepper.h"

#include "first_order.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- making one --- */

void *sundials_create(struct system *system, size_t bytes) {
    struct sundials_stepper *s = calloc(1, bytes);
    if (!s || sundials_open(&s->sundials)) {
        free(s);
        return NULL;
    }
    s->system = system;
    s->restart = 1;
    s->y = sundials_vector(&s->sundials, 2 * system->size);
    if (s->y)
        return s;
    sundials_free(s);
    return NULL;
}

void sundials_free(struct sundials_stepper *s) {
    if (s->solver)
        SUNLinSolFreeEmpty(s->solver);
    if (s->no_matrix)
        SUNMatFreeEmpty(s->no_matrix);
    if (s->newton.linear)
        s->newton.linear->method->free(s->newton.linear);
    free(s->newton.work);
    if (s->y)
        N_VDestroy(s->y);
    sundials_close(&s->sundials);
    free(s);
}

int sundials_reset(struct stepper *stepper, unsigned lanes) {
    (void)lanes;
    ((struct sundials_stepper *)stepper)->restart = 1;
    return 0;
}

/* --- callbacks --- */

int verdict_take(struct verdict *verdict, int code) {
    verdict->cause = code;
    if (code < 0 && !verdict->fatal)
        verdict->fatal = code;
    return (code > 0) - (code < 0);
}

int verdict_of_solve(int sign) {
    return sign > 0 ? SUNLS_PACKAGE_FAIL_REC : sign < 0 ? SUN_ERR_EXT_FAIL : 0;
}

int sundials_rate(sunrealtype t, N_Vector y, N_Vector y_rate, void *stepper) {
    struct sundials_stepper *s = stepper;
    return verdict_take(&s->verdict, first_order_rate(s->system, t, N_VGetArrayPointer(y),
                                                      N_VGetArrayPointer(y_rate)));
}

static SUNLinearSolver_Type type(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_DIRECT; /* to them: conjugate gradients have a tolerance of their own */
}

int sundials_make_solver(struct sundials_stepper *s, int (*setup)(SUNLinearSolver, SUNMatrix),
                         int (*solve)(SUNLinearSolver, SUNMatrix, N_Vector, N_Vector,
                                      sunrealtype)) {
    s->solver = SUNLinSolNewEmpty(s->sundials.context);
    s->no_matrix = SUNMatNewEmpty(s->sundials.context);
    if (!s->solver || !s->no_matrix)
        return -1;
    s->solver->content = s;
    s->solver->ops->gettype = type;
    s->solver->ops->setup = setup;
    s->solver->ops->solve = solve;
    return 0;
}

/* --- Newton's method --- */

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
int sundials_prepare_newton(struct sundials_stepper *s, double t, N_Vector y,
                            sunbooleantype jacobian_holds, sunbooleantype *jacobian_is_new,
                            double gamma) {
    const double *q = N_VGetArrayPointer(y);
    s->newton.gamma = gamma;
    *jacobian_is_new = !jacobian_holds;
    if (jacobian_holds)
        return 0;
    return verdict_take(&s->verdict,
                        system_linearise(s->system, s->newton.kind, t, q, q + s->system->size));
}

static int setup(SUNLinearSolver solver, SUNMatrix no_matrix) {
    (void)no_matrix;
    struct sundials_stepper *s = solver->content;
    const double gamma = s->newton.gamma;
    return verdict_take(&s->verdict, linear_factor(s->newton.linear, gamma, gamma * gamma));
}

static int solve(SUNLinearSolver solver, SUNMatrix no_matrix, N_Vector x, N_Vector b,
                 sunrealtype tolerance) {
    (void)no_matrix, (void)tolerance;
    struct sundials_stepper *s = solver->content;
    const int n = s->system->size;
    const double gamma = s->newton.gamma, *rq = N_VGetArrayPointer(b), *rv = rq + n;
    double *dq = N_VGetArrayPointer(x), *dv = dq + n;
    double *right = s->newton.work, *stiffness_part = right + n;

    system_product(s->system, 1, 0, 0, rv, right);
    system_product(s->system, 0, 0, gamma, rq, stiffness_part);
    for (int i = 0; i < n; i++)
        right[i] += stiffness_part[i];
    const int sign = verdict_take(&s->verdict, linear_solve(s->newton.linear, right, dv));
    if (sign)
        return verdict_of_solve(sign);
    for (int i = 0; i < n; i++)
        dq[i] = rq[i] + gamma * dv[i];
    return 0;
}

int sundials_use_newton(struct sundials_stepper *s, const struct stepper_settings *settings,
                        int jacobian) {
    struct sundials_newton *newton = &s->newton;
    if (linear_choose(settings->linear, s->system, jacobian, &newton->kind))
        return -1;
    newton->work = malloc(2 * (size_t)s->system->size * sizeof(double));
    newton->linear = linear_create(settings->linear, s->system, &settings->options);
    return newton->work && newton->linear ? sundials_make_solver(s, setup, solve) : -1;
}

/* --- a step --- */

/* All lanes do. */
static void reach(const struct sundials_stepper *s, double *t, double reached) {
    for (int k = 0; k < s->system->lanes; k++)
        t[k] = reached;
}

int sundials_skip(const struct sundials_stepper *s, double *t, double stop) {
    if (!s->restart || !(stop - *t <= 10 * DBL_EPSILON * fmax(fabs(*t), fabs(stop))))
        return 0;
    reach(s, t, stop);
    return 1;
}

void sundials_begin(struct sundials_stepper *s, const double *q, const double *v) {
    const size_t n = (size_t)s->system->size;
    double *y = N_VGetArrayPointer(s->y);
    memcpy(y, q, n * sizeof(double));
    memcpy(y + n, v, n * sizeof(double));
    s->system->counters.restarts += s->started * s->system->wisps;
    s->started = 1;
    s->restart = 0;
}

void sundials_count(struct sundials_stepper *s, struct sundials_counts now) {
    struct counters *counters = &s->system->counters;
    counters->rejected_steps += (long long)(now.rejected - s->counted.rejected) * s->system->wisps;
    counters->newton_iterations +=
        (long long)(now.iterations - s->counted.iterations) * s->system->wisps;
    s->counted = now;
}

enum outcome verdict_outcome(const struct verdict *verdict, enum outcome otherwise) {
    return verdict->cause ? (enum outcome)abs(verdict->cause) : otherwise;
}

static int fail(const struct sundials_stepper *s, enum outcome outcome, const char *message) {
    struct system *system = s->system;
    const char *name = s->base.method->name;
    if (!s->verdict.cause)
        return system_fail(system, -(int)outcome, "%s: %s", name, message);
    char cause[sizeof system->reason];
    memcpy(cause, system->reason, sizeof cause);
    return system_fail(system, -(int)outcome, "%s: %s Cause: %s", name, message, cause);
}

int sundials_arrive(struct sundials_stepper *s, int flag, enum outcome outcome, double reached,
                    double *t, double stop, double *q, double *v) {
    const size_t n = (size_t)s->system->size;
    const double *y = N_VGetArrayPointer(s->y);
    if (s->verdict.fatal)
        return s->verdict.fatal;
    if (flag < 0)
        return fail(s, outcome, s->sundials.message);
    if (reached < stop && step_is_lost(*t, reached - *t))
        return fail(s, STEP_TOO_SMALL, "the step is lost in the rounding of the time.");
    memcpy(q, y, n * sizeof(double));
    memcpy(v, y + n, n * sizeof(double));
    reach(s, t, reached);
    return 0;
}
