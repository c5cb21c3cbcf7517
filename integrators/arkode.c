/* ARKODE: Runge-Kutta methods with an embedded one for the error, of SUNDIALS: explicit, diagonally
 * implicit, and additive ones that are explicit in most of the forces and implicit in the rest.
 *
 * An additive method wants y' = F + G with G to be solved for. Here, in a step from y_0,
 *
 *     G(y) = L (y - y_0),   F(t, y) = f(t, y) - G(y),   L = ( 0         1        )
 *                                                           ( M^-1 K_s  M^-1 D_s )
 *
 * with K_s and D_s, at y_0, of the springs that the option `matrix` names (see semi_implicit.h).
 * That is a splitting whatever L is, so the order does not depend on it, and no product with L is
 * needed: ARKODE solves w - gamma L w = r for a stage y_0 + w, at which therefore G = L w is
 * (w - r) / gamma. */
#include "first_order.h"
#include "semi_implicit.h"
#include "sundials_stepper.h"

#include <arkode/arkode_arkstep.h>
#include <string.h>

#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define ARKStepEvolve                ARKodeEvolve
#define ARKStepFree                  ARKodeFree
#define ARKStepGetCurrentGamma       ARKodeGetCurrentGamma
#define ARKStepGetCurrentStep        ARKodeGetCurrentStep
#define ARKStepGetNumNonlinSolvIters ARKodeGetNumNonlinSolvIters
#define ARKStepGetNumStepAttempts    ARKodeGetNumStepAttempts
#define ARKStepGetNumSteps           ARKodeGetNumSteps
#define ARKStepSetDeduceImplicitRhs  ARKodeSetDeduceImplicitRhs
#define ARKStepSetInitStep           ARKodeSetInitStep
#define ARKStepSetInterpolantDegree  ARKodeSetInterpolantDegree
#define ARKStepSetInterpolantType    ARKodeSetInterpolantType
#define ARKStepReset                 ARKodeReset
#define ARKStepSetJacEvalFrequency   ARKodeSetJacEvalFrequency
#define ARKStepSetLSetupFrequency    ARKodeSetLSetupFrequency
#define ARKStepSetLinear             ARKodeSetLinear
#define ARKStepSetLinearSolver       ARKodeSetLinearSolver
#define ARKStepSetLinSysFn           ARKodeSetLinSysFn
#define ARKStepSetMaxNonlinIters     ARKodeSetMaxNonlinIters
#define ARKStepSetNonlinConvCoef     ARKodeSetNonlinConvCoef
#define ARKStepSetPostprocessStepFn  ARKodeSetPostprocessStepFn
#define ARKStepSetOrder              ARKodeSetOrder
#define ARKStepSetStopTime           ARKodeSetStopTime
#define ARKStepSetUserData           ARKodeSetUserData
#define ARKStepSStolerances          ARKodeSStolerances
#endif

/* ORDER is of all, MATRIX of additive methods, the others are of implicit ones. */
enum { ORDER, MATRIX, ITERATIONS = 1, JACOBIAN };

#define ORDER_SPEC(lowest, highest)                            \
    [ORDER] = {"order",      "of ARKODE's pair", OPTION_COUNT, \
               .initial = 4, .least = (lowest),  .most = (highest)}

static const struct option_spec explicit_options[] = {ORDER_SPEC(2, 6), {0}};
static const struct option_spec additive_options[] = {
    ORDER_SPEC(3, 5), [MATRIX] = MATRIX_OPTION_SPEC, {0}};
static const struct option_spec implicit_options[] = {
    ORDER_SPEC(2, 5),
    [ITERATIONS] = {"newton.iterations",
                    "iterations of a stage at most, then the step is quartered; the "
                    "first one cannot tell how well they converge",
                    OPTION_COUNT, .initial = 3, .least = 2, .most = 100},
    [JACOBIAN] = {"jacobian", "Jacobian of Newton's method", OPTION_CHOICE,
                  .initial = JACOBIAN_AUTO, .choices = jacobian_choices},
    {.name = NULL},
};

/* What is solved for of an additive method. */
struct additive {
    struct semi_implicit *matrix;
    double t;      /* of y_0 */
    double *from;  /* y_0 */
    double *stage; /* where the last solve has led to, */
    double *rate;  /* and G there */
    double *a;     /* an acceleration that nobody wants */
};

struct arkode {
    struct sundials_stepper base;
    void *arkode;
    struct additive additive;
    int failed; /* the last step */
    ARKRhsFn explicit_part, implicit_part;
    double memory[];
};

/* Projects a step that is accepted: its error was estimated before. */
static int project(sunrealtype t, N_Vector y, void *self) {
    struct sundials_stepper *s = self;
    double *q = N_VGetArrayPointer(y);
    return verdict_take(&s->verdict, system_project(s->system, t, q, q + s->system->size));
}

/* --- Newton's method --- */

static int prepare(sunrealtype t, N_Vector y, N_Vector y_rate, SUNMatrix no_matrix, SUNMatrix mass,
                   sunbooleantype jacobian_holds, sunbooleantype *jacobian_is_new,
                   sunrealtype gamma, void *self, N_Vector work_1, N_Vector work_2,
                   N_Vector work_3) {
    (void)y_rate, (void)no_matrix, (void)mass, (void)work_1, (void)work_2, (void)work_3;
    return sundials_prepare_newton(self, t, y, jacobian_holds, jacobian_is_new, gamma);
}

/* ARKODE by itself iterates to a tenth of the tolerance, with a system of 20 steps ago and a
 * Jacobian of 50. That error hides the order of its pair of order 5, and damps an oscillator by
 * 2.6e-6 of critical at rtol 1e-8; as it is here it is 1.2e-9, for 0.03 more iterations. */
static int use_newton(struct arkode *self, const struct stepper_settings *settings) {
    const struct options *options = &settings->options;
    const int jacobian = (int)option_value(options, &implicit_options[JACOBIAN]);
    const int iterations = (int)option_value(options, &implicit_options[ITERATIONS]);
    if (sundials_use_newton(&self->base, settings, jacobian) ||
        ARKStepSetLinearSolver(self->arkode, self->base.solver, self->base.no_matrix) < 0 ||
        ARKStepSetLinSysFn(self->arkode, prepare) < 0 ||
        ARKStepSetNonlinConvCoef(self->arkode, 0.01) < 0 ||
        ARKStepSetLSetupFrequency(self->arkode, 5) < 0 ||
        ARKStepSetJacEvalFrequency(self->arkode, 5) < 0 ||
        ARKStepSetMaxNonlinIters(self->arkode, iterations) < 0)
        return -1;
    return 0;
}

/* --- additive methods --- */

/* F: G is known at the last stage, and is 0 at y_0. (It is also asked for where ARKODE looks for a
 * first step, in sums with G, and there it may be all of f.) */
static int explicit_rate(sunrealtype t, N_Vector y, N_Vector y_rate, void *self_) {
    struct arkode *self = self_;
    const int sign = sundials_rate(t, y, y_rate, self);
    const size_t n = 2 * (size_t)self->base.system->size;
    double *rates = N_VGetArrayPointer(y_rate);
    if (!sign && memcmp(N_VGetArrayPointer(y), self->additive.stage, n * sizeof(double)) == 0)
        for (size_t i = 0; i < n; i++)
            rates[i] -= self->additive.rate[i];
    return sign;
}

/* G is asked for only where ARKODE begins to solve: at y_0. */
static int implicit_rate(sunrealtype t, N_Vector y, N_Vector y_rate, void *self) {
    (void)t, (void)y, (void)self;
    N_VConst(0, y_rate);
    return 0;
}

static int nothing_to_prepare(sunrealtype t, N_Vector y, N_Vector y_rate, SUNMatrix no_matrix,
                              SUNMatrix mass, sunbooleantype jacobian_holds,
                              sunbooleantype *jacobian_is_new, sunrealtype gamma, void *self,
                              N_Vector work_1, N_Vector work_2, N_Vector work_3) {
    (void)t, (void)y, (void)y_rate, (void)no_matrix, (void)mass, (void)jacobian_holds, (void)gamma;
    (void)self, (void)work_1, (void)work_2, (void)work_3;
    *jacobian_is_new = 1;
    return 0;
}

static int nothing_to_set_up(SUNLinearSolver solver, SUNMatrix no_matrix) {
    (void)solver, (void)no_matrix;
    return 0;
}

/* w = (dq, dv) of (1 - gamma L) w = r, as in sundials_stepper.c. A part of the forces is that of
 * the last acceleration, which stages have had elsewhere. */
static int solve_stage(SUNLinearSolver solver, SUNMatrix no_matrix, N_Vector x, N_Vector b,
                       sunrealtype tolerance) {
    (void)no_matrix, (void)tolerance;
    struct arkode *self = solver->content;
    struct additive *additive = &self->additive;
    struct system *system = self->base.system;
    const int n = system->size;
    const double *r = N_VGetArrayPointer(b), *q = additive->from, *v = q + n;
    double *w = N_VGetArrayPointer(x), gamma, square;
    ARKStepGetCurrentGamma(self->arkode, &gamma);
    square = gamma * gamma;
    struct part_equation equation = {
        .alpha = &gamma, .beta = &square, .gamma = &gamma, .q = q, .r = r + n, .g = r};
    int code = 0;
    if (system->force_parts)
        code = system_acceleration(system, additive->t, q, v, additive->a);
    if (!code)
        code = semi_implicit_solve(additive->matrix, additive->t, v, &equation, w + n);
    const int sign = verdict_take(&self->base.verdict, code);
    if (sign)
        return verdict_of_solve(sign);
    for (int i = 0; i < n; i++)
        w[i] = r[i] + gamma * w[n + i];
    for (int i = 0; i < 2 * n; i++) {
        additive->stage[i] = w[i] + q[i];
        additive->rate[i] = (w[i] - r[i]) / gamma;
    }
    return 0;
}

static int use_part(struct arkode *self, const struct stepper_settings *settings) {
    struct additive *additive = &self->additive;
    const size_t n = (size_t)self->base.system->size;
    additive->from = self->memory;
    additive->stage = self->memory + 2 * n;
    additive->rate = self->memory + 4 * n;
    additive->a = self->memory + 6 * n;
    additive->matrix = semi_implicit_create(settings, self->base.system);
    if (!additive->matrix || sundials_make_solver(&self->base, nothing_to_set_up, solve_stage) ||
        ARKStepSetLinearSolver(self->arkode, self->base.solver, self->base.no_matrix) < 0 ||
        ARKStepSetLinSysFn(self->arkode, nothing_to_prepare) < 0 ||
        ARKStepSetLinear(self->arkode, 0) < 0 ||
        ARKStepSetDeduceImplicitRhs(self->arkode, SUNTRUE) < 0)
        return -1;
    return 0;
}

/* --- the integrator --- */

static void arkode_free(struct stepper *stepper) {
    struct arkode *self = (struct arkode *)stepper;
    ARKStepFree(&self->arkode);
    semi_implicit_free(self->additive.matrix);
    sundials_free(&self->base);
}

/* Which of the three it is follows from the rates that are given. */
static int set_up(struct arkode *self, const struct stepper_settings *settings,
                  const struct option_spec *order, ARKRhsFn explicit_part, ARKRhsFn implicit_part) {
    struct sundials_stepper *base = &self->base;
    self->explicit_part = explicit_part;
    self->implicit_part = implicit_part;
    self->arkode = ARKStepCreate(explicit_part, implicit_part, 0, base->y, base->sundials.context);
    if (!self->arkode)
        return -1;
#if SUNDIALS_VERSION_MAJOR < 7
    ARKStepSetErrHandlerFn(self->arkode, sundials_keep_message, &base->sundials);
#endif
    /* At a stop ARKODE interpolates, a rounding from a step's end: that needs no rates of its own.
     */
    if (ARKStepSStolerances(self->arkode, settings->rtol, settings->atol) < 0 ||
        ARKStepSetUserData(self->arkode, self) < 0 ||
        ARKStepSetOrder(self->arkode, (int)option_value(&settings->options, order)) < 0 ||
        ARKStepSetInterpolantType(self->arkode, ARK_INTERP_LAGRANGE) < 0 ||
        ARKStepSetInterpolantDegree(self->arkode, 0) < 0)
        return -1;
    if (system_has_projection(base->system) &&
        ARKStepSetPostprocessStepFn(self->arkode, project) < 0)
        return -1;
    return !implicit_part  ? 0
           : explicit_part ? use_part(self, settings)
                           : use_newton(self, settings);
}

static struct stepper *create(const struct stepper_settings *settings, struct system *system,
                              const struct option_spec *order, ARKRhsFn explicit_part,
                              ARKRhsFn implicit_part) {
    struct arkode *self =
        sundials_create(system, sizeof *self + 7 * (size_t)system->size * sizeof(double));
    if (!self || set_up(self, settings, order, explicit_part, implicit_part) == 0)
        return (struct stepper *)self;
    arkode_free(&self->base.base);
    return NULL;
}

static struct stepper *explicit_create(const struct stepper_settings *settings,
                                       struct system *system) {
    return create(settings, system, &explicit_options[ORDER], sundials_rate, NULL);
}

static struct stepper *implicit_create(const struct stepper_settings *settings,
                                       struct system *system) {
    return create(settings, system, &implicit_options[ORDER], NULL, sundials_rate);
}

static struct stepper *additive_create(const struct stepper_settings *settings,
                                       struct system *system) {
    return create(settings, system, &additive_options[ORDER], explicit_rate, implicit_rate);
}

static int implicit_refuse(const struct stepper_settings *settings, struct system *system) {
    enum jacobian kind;
    return linear_choose(settings->linear, system,
                         (int)option_value(&settings->options, &implicit_options[JACOBIAN]), &kind);
}

/* With a first step of h, or with h = 0 of ARKODE's choice. */
static int begin_anew(struct arkode *self, double t, double h) {
    self->base.counted = (struct sundials_counts){0};
    if (ARKStepReInit(self->arkode, self->explicit_part, self->implicit_part, t, self->base.y) < 0)
        return ARK_MEM_FAIL;
    return ARKStepSetInitStep(self->arkode, h);
}

/* ARKStepReset keeps the length of the next step, which the forces decide more than the state; but
 * a failure may have left one of no use. */
static int begin(struct arkode *self, double t, const double *q, const double *v) {
    sundials_begin(&self->base, q, v);
    return self->failed ? begin_anew(self, t, 0) : ARKStepReset(self->arkode, t, self->base.y);
}

/* Adds what ARKODE counted in the last step. */
static void count(struct arkode *self) {
    long attempts, steps, iterations = 0;
    ARKStepGetNumStepAttempts(self->arkode, &attempts);
    ARKStepGetNumSteps(self->arkode, &steps);
    if (self->base.newton.linear)
        ARKStepGetNumNonlinSolvIters(self->arkode, &iterations);
    sundials_count(&self->base, (struct sundials_counts){attempts - steps, iterations});
}

/* What a failure means, by the last callback where that did. */
static enum outcome outcome_of(int flag, const struct verdict *verdict) {
    switch (flag) {
    case ARK_CONV_FAILURE:
    case ARK_LSETUP_FAIL:
    case ARK_LSOLVE_FAIL:
        return verdict_outcome(verdict, SOLVER_STALLED);
    case ARK_RHSFUNC_FAIL:
    case ARK_FIRST_RHSFUNC_ERR:
    case ARK_REPTD_RHSFUNC_ERR:
    case ARK_UNREC_RHSFUNC_ERR:
    case ARK_POSTPROCESS_STEP_FAIL:
        return verdict_outcome(verdict, MODEL_FAILED);
    case ARK_MEM_FAIL:
        return OUT_OF_MEMORY;
    default: /* ARK_ERR_FAILURE, ARK_TOO_MUCH_ACC, and what should not happen */
        return STEP_TOO_SMALL;
    }
}

/* One accepted step. Where something fails that a shorter step might not meet, ARKODE gives up, but
 * in the solves of implicit stages: then it is begun anew with a quarter of the step, as it does by
 * itself in those. */
static int step(struct arkode *self, double t, double stop, double *reached) {
    struct verdict *verdict = &self->base.verdict;
    double h = 0;
    ARKStepGetCurrentStep(self->arkode, &h);
    if (!(h > 0 && h < stop - t))
        h = stop - t;
    for (;;) {
        *verdict = (struct verdict){0};
        int flag = ARKStepSetStopTime(self->arkode, stop);
        if (flag >= 0)
            flag = ARKStepEvolve(self->arkode, stop, self->base.y, reached, ARK_ONE_STEP);
        count(self);
        h /= 4;
        if (flag >= 0 || verdict->fatal || verdict->cause == 0 || step_is_lost(stop, h))
            return flag;
        if (begin_anew(self, t, h) < 0)
            return ARK_MEM_FAIL;
    }
}

static int arkode_advance(struct stepper *stepper, double *t, double stop, double *q, double *v) {
    struct arkode *self = (struct arkode *)stepper;
    struct sundials_stepper *base = &self->base;
    double reached = *t;
    if (sundials_skip(base, t, stop))
        return 0;
    int flag = base->restart ? begin(self, *t, q, v) : 0;
    if (self->additive.matrix) {
        self->additive.t = *t;
        memcpy(self->additive.from, N_VGetArrayPointer(base->y),
               2 * (size_t)base->system->size * sizeof(double));
    }
    if (flag >= 0)
        flag = step(self, *t, stop, &reached);
    base->restart = self->failed = flag < 0;
    return sundials_arrive(base, flag, outcome_of(flag, &base->verdict), reached, t, stop, q, v);
}

static const char *additive_caution(const struct stepper *stepper) {
    return semi_implicit_caution(((const struct arkode *)stepper)->additive.matrix);
}

const struct stepper_method arkode_erk = {
    .name = "arkode-erk",
    .summary = "explicit Runge-Kutta pairs of orders 2 to 6 (SUNDIALS ARKODE)",
    .reference = "Reynolds et al. 2023, doi:10.1145/3594632; Zonneveld 1963",
    .order = 6,
    .capabilities = STEPPER_ADAPTIVE | STEPPER_PROJECTS,
    .options = explicit_options,
    .create = explicit_create,
    .advance = arkode_advance,
    .reset = sundials_reset,
    .free = arkode_free,
};

const struct stepper_method arkode_dirk = {
    .name = "arkode-dirk",
    .summary = "diagonally implicit Runge-Kutta pairs of orders 2 to 5 (SUNDIALS ARKODE)",
    .reference = "Reynolds et al. 2023, doi:10.1145/3594632; Hairer & Wanner, Solving Ordinary "
                 "Differential Equations II, section IV.6",
    .order = 5,
    .capabilities = STEPPER_IMPLICIT | STEPPER_ADAPTIVE | STEPPER_SOLVES | STEPPER_PROJECTS,
    .options = implicit_options,
    .refuse = implicit_refuse,
    .create = implicit_create,
    .advance = arkode_advance,
    .reset = sundials_reset,
    .free = arkode_free,
};

const struct stepper_method arkode_imex = {
    .name = "arkode-imex",
    .summary = "additive Runge-Kutta pairs, implicit in the stiff springs (SUNDIALS ARKODE)",
    .reference = "Reynolds et al. 2023, doi:10.1145/3594632; Kennedy & Carpenter 2003, "
                 "doi:10.1016/S0168-9274(02)00138-1",
    .order = 5,
    .capabilities = STEPPER_IMPLICIT | STEPPER_ADAPTIVE | STEPPER_PROJECTS,
    .options = additive_options,
    .refuse = semi_implicit_refuse,
    .create = additive_create,
    .advance = arkode_advance,
    .reset = sundials_reset,
    .caution = additive_caution,
    .free = arkode_free,
};
