/* The reference: the Runge-Kutta method of GSL that is best at tight tolerances. */
#include "first_order.h"
#include "stepper.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct reference {
    struct stepper base;
    gsl_odeiv2_system equations;
    gsl_odeiv2_step *step;
    gsl_odeiv2_control *control;
    gsl_odeiv2_evolve *evolve;
    double rtol, atol;
    double h;               /* proposed for the next step; 0 before the first */
    int cause;              /* the last failure of the model in this step, or 0 */
    unsigned long rejected; /* GSL's count, as counted already */
    double y[];             /* (q, v), then a rate */
};

static int rate(double t, const double y[], double y_rate[], void *reference) {
    struct reference *r = reference;
    const int code = first_order_rate(r->base.system, t, y, y_rate);
    if (code)
        r->cause = code;
    return code == 0 ? GSL_SUCCESS : code > 0 ? GSL_ERANGE : GSL_EBADFUNC; /* halves; gives up */
}

static void reference_free(struct stepper *stepper) {
    struct reference *r = (struct reference *)stepper;
    gsl_odeiv2_evolve_free(r->evolve);
    gsl_odeiv2_control_free(r->control);
    gsl_odeiv2_step_free(r->step);
    free(r);
}

static struct stepper *reference_create(const struct stepper_settings *settings,
                                        struct system *system) {
    gsl_set_error_handler_off(); /* it would abort; for the whole program, which tests all codes */
    const size_t unknowns = 2 * (size_t)system->size;
    struct reference *r = calloc(1, sizeof *r + 2 * unknowns * sizeof(double));
    if (!r)
        return NULL;
    r->equations = (gsl_odeiv2_system){.function = rate, .dimension = unknowns, .params = r};
    r->rtol = settings->rtol;
    r->atol = settings->atol;
    r->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, unknowns);
    r->evolve = gsl_odeiv2_evolve_alloc(unknowns);
    if (r->step && r->evolve) /* GSL does not look whether it has memory for a control */
        r->control = gsl_odeiv2_control_y_new(settings->atol, settings->rtol);
    if (!r->control) {
        reference_free(&r->base);
        return NULL;
    }
    return &r->base;
}

/* A step in which an explicit Euler step would change y by a hundredth of itself, both in the
 * norm of the error test (Hairer, Norsett & Wanner, Solving ODEs I, section II.4). */
static int propose_first_step(struct reference *r, double t) {
    const size_t unknowns = r->equations.dimension;
    double *y_rate = r->y + unknowns;
    const int code = first_order_rate(r->base.system, t, r->y, y_rate);
    if (code)
        return code;
    double state = 0, change = 0;
    for (size_t i = 0; i < unknowns; i++) {
        const double scale = r->atol + r->rtol * fabs(r->y[i]);
        state = fmax(state, fabs(r->y[i]) / scale);
        change = fmax(change, fabs(y_rate[i]) / scale);
    }
    r->h = state < 1e-5 || change < 1e-5 ? 1e-6 : 0.01 * state / change;
    return 0;
}

/* One step of r->y from t, as long as the error test lets it be. */
static int take_step(struct reference *r, double *t, double stop) {
    struct system *system = r->base.system;
    /* GSL lands on the stop, to the bit, with a step that was longer, and proposes nothing then:
     * what was proposed before holds. */
    const int lands = r->h >= (1 - 1e-10) * (stop - *t);
    const double start = *t;
    double h = lands ? 2 * (stop - start) : r->h;

    const int status =
        gsl_odeiv2_evolve_apply(r->evolve, r->control, r->step, &r->equations, t, stop, &h, r->y);
    const unsigned long rejected = r->evolve->failed_steps - r->rejected;
    system->counters.rejected_steps += (long long)rejected * system->wisps;
    r->rejected = r->evolve->failed_steps;
    if (status && status != GSL_FAILURE)
        return r->cause
                   ? -abs(r->cause) /* the rate failed at every step */
                   : system_fail(system, -SOLVER_STALLED, "reference: %s", gsl_strerror(status));
    if (status || (*t < stop && step_is_lost(start, *t - start)))
        return system_fail(system, -STEP_TOO_SMALL,
                           "reference: no step from t = %.9g s meets the tolerances", start);
    if (!lands || *t < stop)
        r->h = h;
    return 0;
}

/* GSL keeps the last rate as the first of the next step: it is another one where something else
 * than a step has changed the state. The proposed step stays. */
static void forget_rate(struct reference *r) {
    gsl_odeiv2_evolve_reset(r->evolve);
    gsl_odeiv2_step_reset(r->step);
    r->rejected = 0;
}

static int reference_advance(struct stepper *stepper, double *t, double stop, double *q,
                             double *v) {
    struct reference *r = (struct reference *)stepper;
    struct system *system = stepper->system;
    const size_t n = (size_t)system->size;
    double *new_q = r->y, *new_v = r->y + n, reached;
    int code, again;

    r->cause = 0;
    do {
        reached = *t;
        memcpy(new_q, q, n * sizeof(double));
        memcpy(new_v, v, n * sizeof(double));
        code = r->h == 0 ? propose_first_step(r, reached) : 0;
        if (!code)
            code = take_step(r, &reached, stop);
        again = 0;
        if (!code && system_has_projection(system)) {
            code = system_project(system, reached, new_q, new_v);
            forget_rate(r);
            r->h = code ? (reached - *t) / 2 : r->h;
            again = code > 0 && !step_is_lost(fmax(fabs(*t), stop - *t), r->h);
            system->counters.rejected_steps += again * system->wisps;
        }
    } while (again);
    if (code)
        return -abs(code); /* smaller steps were tried */

    memcpy(q, new_q, n * sizeof(double));
    memcpy(v, new_v, n * sizeof(double));
    *t = reached;
    return 0;
}

static const char *const check_options[] = {"method=bdf", "max_order=5", NULL};

/* At equal tolerances BDF is about a thousand times less accurate on the circle and on chains. At
 * a thousandth its errors are 2 to 5 times those of the reference, which is then the bound; the
 * least it can do is rtol 1e-15, so the reference may have 1e-12. */
static const struct cross_check check = {
    .method = "cvode",
    .rtol_ratio = 1e-2, /* BDF is less accurate at equal tolerances; below 1e-13 it can be lost in
                           rounding when it begins anew after a tick */
    .options = check_options,
};

static int reference_reset(struct stepper *stepper, unsigned lanes) {
    (void)lanes;
    stepper->system->counters.restarts += stepper->system->wisps;
    forget_rate((struct reference *)stepper);
    return 0;
}

const struct stepper_method reference = {
    .name = "reference",
    .summary = "explicit Runge-Kutta of order 8 with error control (GSL rk8pd)",
    .reference = "Prince & Dormand 1981, J. Comp. Appl. Math. 7, 67",
    .order = 8,
    .capabilities = STEPPER_ADAPTIVE | STEPPER_PROJECTS,
    .checked_by = &check,
    .rtol = 1e-11,
    .atol = 1e-11,
    .create = reference_create,
    .advance = reference_advance,
    .reset = reference_reset,
    .free = reference_free,
};
