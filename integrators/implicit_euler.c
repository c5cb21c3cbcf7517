/* Implicit Euler, by default linearised once per step as in Baraff & Witkin 1998 and the thesis's
 * equation 2.4; more Newton iterations as an option. */
#include "newton.h"

#include <stdlib.h>
#include <string.h>

static const struct option_spec options[] = {NEWTON_OPTION_SPECS(1), {0}};

/* Implicit Euler as a Runge-Kutta method; the linearised step has the same stability function. */
static const struct butcher_table table = {
    .stages = 1, .a = (const double[]){1}, .b = (const double[]){1}, .c = (const double[]){1}};

struct implicit_euler {
    struct stepper base;
    struct newton *newton;
    double *q, *v; /* the iterate */
    IN_LINES double memory[];
};

static struct stepper *implicit_euler_create(const struct stepper_settings *settings,
                                             struct system *system) {
    const size_t n = (size_t)system->size;
    struct implicit_euler *self = stepper_memory(sizeof *self + 2 * n * sizeof(double));
    if (!self)
        return NULL;
    self->q = self->memory;
    self->v = self->memory + n;
    self->newton = newton_create(settings, options, system);
    if (!self->newton) {
        free(self);
        return NULL;
    }
    return &self->base;
}

/* Lanes whose state is not the one that the last step left: something outside has moved them. */
static unsigned moved(const struct implicit_euler *self, const double *q, const double *v) {
    const struct system *system = self->base.system;
    unsigned lanes = 0;
    for (int i = 0; i < system->size; i += system->lanes)
        for (int k = 0; k < system->lanes; k++)
            lanes |= (unsigned)(q[i + k] != self->q[i + k] || v[i + k] != self->v[i + k]) << k;
    return lanes;
}

/* v1 = v0 + h a(t1, q1, v1), q1 = q0 + h v1. The first iterate is the state before the step, which
 * makes the first linear system that of equation 2.4. */
static int implicit_euler_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct implicit_euler *self = (struct implicit_euler *)stepper;
    const size_t bytes = (size_t)stepper->system->size * sizeof(double);
    const struct newton_equation equation = {.t = t + h, .gamma = h, .beta = h, .q0 = q, .v0 = v};

    if (newton_reuses(self->newton))
        newton_forget(self->newton, moved(self, q, v));
    memcpy(self->q, q, bytes);
    memcpy(self->v, v, bytes);
    const int code = newton_solve(self->newton, &equation, self->q, self->v);
    return code ? code : stepper_arrive(stepper, t + h, self->q, self->v, q, v);
}

static void implicit_euler_free(struct stepper *stepper) {
    struct implicit_euler *self = (struct implicit_euler *)stepper;
    if (self)
        newton_free(self->newton);
    free(self);
}

const struct stepper_method implicit_euler = {
    .name = "implicit-euler",
    .summary = "implicit Euler, linearised once per step or iterated",
    .reference = "Baraff & Witkin 1998, doi:10.1145/280814.280821; Plante 1999, eq. 2.4",
    .order = 1,
    .capabilities = STEPPER_IMPLICIT | STEPPER_SOLVES | STEPPER_PROJECTS,
    .options = options,
    .table = &table,
    .on_wisps = {.treatment = "penalty", .linear = "cg"}, /* as in Baraff & Witkin */
    .usual_rate = 300,
    .refuse = newton_refuse,
    .create = implicit_euler_create,
    .step = implicit_euler_step,
    .free = implicit_euler_free,
};
