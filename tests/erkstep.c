/* The gate of order at work on a method that is not ours. Before 6.7.0 ERKStep of SUNDIALS took
 * the last stage of any table with c_s = 1 for the first one of the next step, whether or not they
 * are the same. In the classical method of order 4 they are not, and it silently converges at
 * order 3. A testbed must be able to tell. */
#include "integrators/linear/sundials_support.h"
#include "order.h"

#include <arkode/arkode_erkstep.h>
#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if SUNDIALS_VERSION_MAJOR > 7 || (SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR >= 1)
#define ERKStepEvolve       ARKodeEvolve
#define ERKStepFree         ARKodeFree
#define ERKStepSetFixedStep ARKodeSetFixedStep
#define ERKStepSetUserData  ARKodeSetUserData
#endif
enum {
    HAS_DEFECT =
        SUNDIALS_VERSION_MAJOR < 6 || (SUNDIALS_VERSION_MAJOR == 6 && SUNDIALS_VERSION_MINOR < 7)
};

struct erkstep {
    struct stepper base;
    struct sundials sundials;
    void *arkode;
    N_Vector y; /* (q, v) */
};

static int rate(sunrealtype t, N_Vector y, N_Vector y_rate, void *stepper) {
    struct system *system = ((struct stepper *)stepper)->system;
    const double *q = N_VGetArrayPointer(y);
    double *q_rate = N_VGetArrayPointer(y_rate);
    memcpy(q_rate, q + system->size, (size_t)system->size * sizeof *q);
    return system_acceleration(system, t, q, q + system->size, q_rate + system->size);
}

static struct stepper *erkstep_create(const struct stepper_settings *settings,
                                      struct system *system) {
    (void)settings;
    struct erkstep *self = calloc(1, sizeof *self);
    cr_assert(self && sundials_open(&self->sundials) == 0, "no memory");
    self->y = sundials_vector(&self->sundials, 2 * system->size);
    return &self->base;
}

static void erkstep_free(struct stepper *stepper) {
    struct erkstep *self = (struct erkstep *)stepper;
    ERKStepFree(&self->arkode);
    N_VDestroy(self->y);
    sundials_close(&self->sundials);
    free(self);
}

/* ERKStep at t, with our table of the classical method. */
static void begin(struct erkstep *self, double t, double h) {
    const struct butcher_table *rk4 = stepper_find("rk4")->table;
    ARKodeButcherTable table = ARKodeButcherTable_Create(rk4->stages, 4, 0, (double *)rk4->c,
                                                         (double *)rk4->a, (double *)rk4->b, NULL);
    self->arkode = ERKStepCreate(rate, t, self->y, self->sundials.context);
    cr_assert(table && self->arkode, "no memory");
    cr_assert(ERKStepSetTable(self->arkode, table) >= 0 &&
                  ERKStepSetUserData(self->arkode, self) >= 0 &&
                  ERKStepSetFixedStep(self->arkode, h) >= 0,
              "ERKStep refuses the method");
    ARKodeButcherTable_Free(table);
}

/* Steps must follow each other: ERKStep keeps its own time and state, as in any use of it. */
static int erkstep_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct erkstep *self = (struct erkstep *)stepper;
    const size_t n = (size_t)stepper->system->size;
    double *y = N_VGetArrayPointer(self->y), reached;
    if (!self->arkode) {
        memcpy(y, q, n * sizeof *q);
        memcpy(y + n, v, n * sizeof *v);
        begin(self, t, h);
    }
    if (ERKStepEvolve(self->arkode, t + h, self->y, &reached, ARK_ONE_STEP) < 0 ||
        fabs(reached - (t + h)) > 1e-9 * h)
        return system_fail(stepper->system, SOLVER_STALLED, "ERKStep: no step to %g", t + h);
    memcpy(q, y, n * sizeof *q);
    memcpy(v, y + n, n * sizeof *v);
    return 0;
}

static const struct stepper_method erkstep = {.name = "erkstep",
                                              .order = 4,
                                              .create = erkstep_create,
                                              .step = erkstep_step,
                                              .free = erkstep_free};

Test(order, the_gate_finds_the_order_that_erkstep_loses) {
    const struct variant theirs = {.method = &erkstep, .name = "erkstep"},
                         ours = {.method = stepper_find("rk4"), .name = "rk4"};
    for (int y = 0; y < SMALL_YARDSTICKS; y++) {
        const struct yardstick *yardstick = &small_yardsticks[y];
        const struct order_seen seen = see_order(&theirs, yardstick, 64);
        const int expected = HAS_DEFECT ? 3 : 4;
        cr_assert_str_empty(see_order(&ours, yardstick, 64).fault);
        cr_assert(fabs(seen.order[0] - expected) <= 0.05 && fabs(seen.order[1] - expected) <= 0.05,
                  "erkstep of SUNDIALS %s on %s: observed orders %.3f and %.3f, not %d",
                  SUNDIALS_VERSION, yardstick->name, seen.order[0], seen.order[1], expected);
        cr_assert((seen.fault[0] == '\0') == (expected == 4), "erkstep on %s: the gate says '%s'",
                  yardstick->name, seen.fault);
    }
}
