/* CVODE: variable-order, variable-step multistep methods, of SUNDIALS. */
#include "sundials_stepper.h"

#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <cvode/cvode_proj.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

enum {
    METHOD,
    MAX_ORDER,
    NONLINEAR,
    ITERATIONS,
    JACOBIAN,
    SETUP_FREQUENCY,
    JACOBIAN_FREQUENCY,
    LANES
};
enum { BDF, ADAMS };
enum { NEWTON, FIXED_POINT, AUTO };

static const char *const methods[] = {[BDF] = "bdf", [ADAMS] = "adams", NULL};
static const char *const nonlinear_solvers[] = {
    [NEWTON] = "newton", [FIXED_POINT] = "fixed-point", [AUTO] = "auto", NULL};
static const char *const sharing[] = {"1", "4", NULL};

/* Order 5, with the damping of the scenes that are here: at rtol 1e-3, 1e-5 and 1e-7 it takes 0.85,
 * 0.4 and 0.2 times the steps of order 2 on `swing`, with a half to a twentieth of the error, and
 * likewise on `swing-envelope` and `wind`. Beyond order 2 formulas are unstable near the imaginary
 * axis, where the modes of lightly damped hair are: with a thirtieth of the damping (stretch_time
 * 4e-6 s) it takes 9 to 2.5 times as many, and at real hair's stiffness without damping 38.
 *
 * CVODE by itself keeps a factorised system for 20 steps and a Jacobian for 51, as suits costlier
 * ones than ours. With 5 the circle at rtol 1e-12 took 3269 steps instead of 3609. */
static const struct option_spec options[] = {
    [METHOD] = {"method", "family of multistep formulas", OPTION_CHOICE, .initial = BDF,
                .choices = methods},
    [MAX_ORDER] =
        {"max_order",
         "highest order; 0: the most there is: bdf 5, adams 12; 2 pays where damping is light",
         OPTION_COUNT, .initial = 0, .least = 0, .most = 12},
    [NONLINEAR] = {"nonlinear",
                   "iteration of the implicit step; auto: newton where there are Jacobians",
                   OPTION_CHOICE, .initial = AUTO, .choices = nonlinear_solvers},
    [ITERATIONS] = {"newton.iterations",
                    "iterations of either kind at most, then the step is halved twice",
                    OPTION_COUNT, .initial = 3, .least = 1, .most = 100},
    [JACOBIAN] = {"jacobian", "Jacobian of Newton's method", OPTION_CHOICE,
                  .initial = JACOBIAN_AUTO, .choices = jacobian_choices},
    [SETUP_FREQUENCY] = {"setup_frequency", "steps for which a factorised system is kept at most",
                         OPTION_COUNT, .initial = 5, .least = 1, .most = 1000},
    [JACOBIAN_FREQUENCY] = {"jacobian_frequency", "steps for which a Jacobian is kept at most",
                            OPTION_COUNT, .initial = 5, .least = 1, .most = 1000},
    [LANES] = {"lanes",
               "wisps that share an integrator: with 4 they share its steps and errors, "
               "and a wisp's bits depend on the three beside it",
               OPTION_CHOICE, .initial = 0, .choices = sharing},
    {.name = NULL},
};

static double value(const struct stepper_settings *settings, int option) {
    return option_value(&settings->options, &options[option]);
}

/* Whether the implicit step is Newton's. */
static int is_newton(const struct stepper_settings *settings, const struct system *system) {
    const double choice = value(settings, NONLINEAR);
    return choice == NEWTON || (choice == AUTO && !system->no_jacobians);
}

struct multistep {
    struct sundials_stepper base;
    void *cvode;
    SUNNonlinearSolver fixed_point; /* NULL: Newton's method */
};

static int prepare(sunrealtype t, N_Vector y, N_Vector y_rate, SUNMatrix no_matrix,
                   sunbooleantype jacobian_holds, sunbooleantype *jacobian_is_new,
                   sunrealtype gamma, void *s, N_Vector work_1, N_Vector work_2, N_Vector work_3) {
    (void)y_rate, (void)no_matrix, (void)work_1, (void)work_2, (void)work_3;
    return sundials_prepare_newton(s, t, y, jacobian_holds, jacobian_is_new, gamma);
}

/* correction <- what takes y onto the constraint. The model's projection is exact, so the
 * tolerance does not matter. The error estimate stays that of the step without projection, for
 * the model does not tell which part of an error the projection removes: steps are a little
 * shorter than they need be. */
static int project(sunrealtype t, N_Vector y, N_Vector correction, sunrealtype tolerance,
                   N_Vector error, void *s_) {
    (void)tolerance, (void)error;
    struct sundials_stepper *s = s_;
    double *q = N_VGetArrayPointer(correction);
    N_VScale(1, y, correction);
    const int sign =
        verdict_take(&s->verdict, system_project(s->system, t, q, q + s->system->size));
    N_VLinearSum(1, correction, -1, y, correction);
    return sign;
}

static void cvode_free(struct stepper *stepper) {
    struct multistep *s = (struct multistep *)stepper;
    CVodeFree(&s->cvode);
    if (s->fixed_point)
        SUNNonlinSolFree(s->fixed_point);
    sundials_free(&s->base);
}

static int use_fixed_point(struct multistep *s) {
    s->fixed_point = SUNNonlinSol_FixedPoint(s->base.y, 0, s->base.sundials.context);
    return s->fixed_point ? CVodeSetNonlinearSolver(s->cvode, s->fixed_point) : -1;
}

/* CVODE begins with Newton's method, and lacks its linear system. */
static int use_newton(struct multistep *s, const struct stepper_settings *settings) {
    if (sundials_use_newton(&s->base, settings, (int)value(settings, JACOBIAN)) ||
        CVodeSetLinearSolver(s->cvode, s->base.solver, s->base.no_matrix) < 0 ||
        CVodeSetLinSysFn(s->cvode, prepare) < 0 ||
        CVodeSetLSetupFrequency(s->cvode, (long)value(settings, SETUP_FREQUENCY)) < 0 ||
        CVodeSetJacEvalFrequency(s->cvode, (long)value(settings, JACOBIAN_FREQUENCY)) < 0)
        return -1;
    return 0;
}

static int set_up(struct multistep *s, const struct stepper_settings *settings) {
    const struct system *system = s->base.system;
    s->cvode =
        CVodeCreate(value(settings, METHOD) == ADAMS ? CV_ADAMS : CV_BDF, s->base.sundials.context);
    if (!s->cvode)
        return -1;
#if SUNDIALS_VERSION_MAJOR < 7
    CVodeSetErrHandlerFn(s->cvode, sundials_keep_message, &s->base.sundials);
#endif
    if (CVodeInit(s->cvode, sundials_rate, 0, s->base.y) < 0 ||
        CVodeSStolerances(s->cvode, settings->rtol, settings->atol) < 0 ||
        CVodeSetUserData(s->cvode, s) < 0)
        return -1;
    const double max_order = value(settings, MAX_ORDER);
    if (max_order > 0 && CVodeSetMaxOrd(s->cvode, (int)max_order) < 0)
        return -1;
    const int nonlinear =
        is_newton(settings, system) ? use_newton(s, settings) : use_fixed_point(s);
    if (nonlinear < 0 || CVodeSetMaxNonlinIters(s->cvode, (int)value(settings, ITERATIONS)) < 0)
        return -1;
    if (system_has_projection(system) &&
        (CVodeSetProjFn(s->cvode, project) < 0 || CVodeSetProjErrEst(s->cvode, SUNFALSE) < 0))
        return -1;
    return 0;
}

static struct stepper *cvode_create(const struct stepper_settings *settings,
                                    struct system *system) {
    struct multistep *s = sundials_create(system, sizeof *s);
    if (!s || set_up(s, settings) == 0)
        return (struct stepper *)s;
    cvode_free(&s->base.base);
    return NULL;
}

static int cvode_refuse(const struct stepper_settings *settings, struct system *system) {
    if (value(settings, METHOD) == BDF && value(settings, MAX_ORDER) > 5)
        return system_fail(system, REFUSED, "cvode: bdf has orders up to 5, and max_order is %g",
                           value(settings, MAX_ORDER));
    if (value(settings, METHOD) == ADAMS && system_has_projection(system))
        return system_fail(system, REFUSED,
                           "cvode: method adams cannot keep the constraint of %s: SUNDIALS "
                           "projects steps of bdf only",
                           system->name);
    if (!is_newton(settings, system))
        return 0;
    if (value(settings, LANES) > 0 && settings->linear->max_lanes < STEPPER_SHARING)
        return system_fail(system, REFUSED, "cvode: lanes=4: linear solver %s takes one wisp only",
                           settings->linear->name);
    enum jacobian kind;
    return linear_choose(settings->linear, system, (int)value(settings, JACOBIAN), &kind);
}

/* Adds what CVODE counted in the last step. */
static void count(struct multistep *s) {
    long error_tests, solves, projections = 0, iterations;
    CVodeGetNumErrTestFails(s->cvode, &error_tests);
    CVodeGetNumStepSolveFails(s->cvode, &solves);
    if (system_has_projection(s->base.system))
        CVodeGetNumProjFails(s->cvode, &projections);
    CVodeGetNumNonlinSolvIters(s->cvode, &iterations);
    sundials_count(&s->base,
                   (struct sundials_counts){error_tests + solves + projections, iterations});
}

/* What a failure of CVODE means, by the last callback where that did. */
static enum outcome outcome_of(int flag, const struct verdict *verdict) {
    switch (flag) {
    case CV_CONV_FAILURE:
    case CV_LSETUP_FAIL:
    case CV_LSOLVE_FAIL:
        return verdict_outcome(verdict, SOLVER_STALLED);
    case CV_RHSFUNC_FAIL:
    case CV_FIRST_RHSFUNC_ERR:
    case CV_REPTD_RHSFUNC_ERR:
    case CV_UNREC_RHSFUNC_ERR:
    case CV_PROJFUNC_FAIL:
    case CV_REPTD_PROJFUNC_ERR:
        return verdict_outcome(verdict, MODEL_FAILED);
    case CV_MEM_FAIL:
        return OUT_OF_MEMORY;
    default: /* CV_ERR_FAILURE, CV_TOO_MUCH_ACC, and what should not happen */
        return STEP_TOO_SMALL;
    }
}

static int cvode_advance(struct stepper *stepper, double *t, double stop, double *q, double *v) {
    struct multistep *s = (struct multistep *)stepper;
    if (sundials_skip(&s->base, t, stop))
        return 0;
    if (s->base.restart) {
        sundials_begin(&s->base, q, v);
        CVodeReInit(s->cvode, *t, s->base.y);
        s->base.counted = (struct sundials_counts){0};
    }
    s->base.verdict = (struct verdict){0};
    double reached = *t;
    int flag = CVodeSetStopTime(s->cvode, stop);
    if (flag >= 0)
        flag = CVode(s->cvode, stop, s->base.y, &reached, CV_ONE_STEP);
    count(s);
    if (s->base.verdict.fatal) /* the fixed-point solver of SUNDIALS 6 would try a smaller step */
        s->base.restart = 1;
    return sundials_arrive(&s->base, flag, outcome_of(flag, &s->base.verdict), reached, t, stop, q,
                           v);
}

const struct stepper_method cvode = {
    .name = "cvode",
    .summary = "BDF or Adams of variable order and step (SUNDIALS CVODE)",
    .reference = "Hindmarsh et al. 2005, ACM Trans. Math. Softw. 31, 363",
    .order = 12,
    .capabilities = STEPPER_IMPLICIT | STEPPER_ADAPTIVE | STEPPER_SOLVES | STEPPER_PROJECTS |
                    STEPPER_MULTISTEP | STEPPER_JACOBIAN_FREE,
    .options = options,
    .shared_steps = &options[LANES],
    .refuse = cvode_refuse,
    .create = cvode_create,
    .advance = cvode_advance,
    .reset = sundials_reset,
    .free = cvode_free,
};
