/* Drift, kick, drift: half a step of the positions, a step of the velocities by the forces there,
 * the other half. Without forces that depend on the velocity it is the leapfrog, which is
 * symplectic, reversible and of order 2. Damping wants the velocity half way, which the last step's
 * acceleration extrapolates: that keeps order 2 and one evaluation a step, and makes a history. */
#include "stepper.h"

#include <stdlib.h>
#include <string.h>

struct drift_kick {
    struct stepper base;
    unsigned begin; /* lanes that have no last acceleration: one of 0 costs them order 1 once */
    double *q, *v;  /* half way */
    double *a;      /* there */
    double *last;   /* the last step's */
    double memory[];
};

static struct stepper *drift_kick_create(const struct stepper_settings *settings,
                                         struct system *system) {
    (void)settings;
    const size_t n = (size_t)system->size;
    struct drift_kick *self = calloc(1, sizeof *self + 4 * n * sizeof(double));
    if (!self)
        return NULL;
    self->q = self->memory;
    self->v = self->q + n;
    self->a = self->v + n;
    self->last = self->a + n;
    return &self->base;
}

static int drift_kick_reset(struct stepper *stepper, unsigned lanes) {
    ((struct drift_kick *)stepper)->begin |= lanes;
    return 0;
}

static void begin_anew(struct drift_kick *self) {
    struct system *system = self->base.system;
    for (int k = 0; k < system->lanes; k++) {
        if (!(self->begin >> k & 1))
            continue;
        system->counters.restarts += k < system->wisps;
        for (int i = k; i < system->size; i += system->lanes)
            self->last[i] = 0;
    }
    self->begin = 0;
}

static int drift_kick_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct drift_kick *self = (struct drift_kick *)stepper;
    struct system *system = stepper->system;
    if (self->begin)
        begin_anew(self);
    for (int i = 0; i < system->size; i++) {
        self->q[i] = q[i] + h / 2 * v[i];
        self->v[i] = v[i] + h / 2 * self->last[i];
    }
    const int code = system_acceleration(system, t + h / 2, self->q, self->v, self->a);
    if (code)
        return code;
    for (int i = 0; i < system->size; i++) {
        v[i] += h * self->a[i];
        q[i] = self->q[i] + h / 2 * v[i];
    }
    double *const kept = self->last;
    self->last = self->a;
    self->a = kept;
    return 0;
}

static void drift_kick_free(struct stepper *stepper) {
    free(stepper);
}

const struct stepper_method drift_kick = {
    .name = "drift-kick",
    .summary = "drift-kick-drift, the leapfrog, with the velocity of damping extrapolated",
    .reference = "Hairer, Lubich & Wanner 2003, doi:10.1017/S0962492902000144",
    .order = 2,
    .usual_rate = 10000,
    .create = drift_kick_create,
    .step = drift_kick_step,
    .reset = drift_kick_reset,
    .free = drift_kick_free,
};
