/* Drift, kick, drift: half a step of the positions, a step of the velocities by the forces there,
 * the other half. Without forces that depend on the velocity it is the leapfrog: symplectic,
 * reversible, of order 2. The velocity of those that do is the one before the kick, which is half a
 * step behind: of order 1, with a small error where damping is light. (Tried: the velocity half way
 * by the last step's acceleration is of order 2 with damping too, and stable to two thirds of the
 * step on `swing`, less than explicit Euler.) */
#include "stepper.h"

#include <stdlib.h>
#include <string.h>

struct drift_kick {
    struct stepper base;
    double *q, *a; /* half way; then q is the end's */
    double *v;     /* of the end, before it is projected */
    IN_LINES double memory[];
};

static struct stepper *drift_kick_create(const struct stepper_settings *settings,
                                         struct system *system) {
    (void)settings;
    const size_t n = (size_t)system->size;
    struct drift_kick *self = stepper_memory(sizeof *self + 3 * n * sizeof(double));
    if (!self)
        return NULL;
    self->q = self->memory;
    self->a = self->q + n;
    self->v = self->a + n;
    return &self->base;
}

static int drift_kick_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct drift_kick *self = (struct drift_kick *)stepper;
    struct system *system = stepper->system;
    for (int i = 0; i < system->size; i++)
        self->q[i] = q[i] + h / 2 * v[i];
    const size_t bytes = (size_t)system->size * sizeof(double);
    const int projects = system_has_projection(system);
    double *new_q = projects ? self->q : q, *new_v = projects ? self->v : v;
    int code = system_acceleration(system, t + h / 2, self->q, v, self->a);
    for (int i = 0; i < system->size && !code; i++) {
        new_v[i] = v[i] + h * self->a[i];
        new_q[i] = self->q[i] + h / 2 * new_v[i];
    }
    if (code || !projects)
        return code;
    code = system_project(system, t + h, new_q, new_v);
    if (code)
        return code;
    memcpy(q, new_q, bytes);
    memcpy(v, new_v, bytes);
    return 0;
}

static void drift_kick_free(struct stepper *stepper) {
    free(stepper);
}

const struct stepper_method drift_kick = {
    .name = "drift-kick",
    .summary = "drift-kick-drift: the leapfrog, of order 1 with damping and 2 without",
    .reference = "Hairer, Lubich & Wanner 2003, doi:10.1017/S0962492902000144",
    .order = 1,
    .undamped_order = 2,
    .capabilities = STEPPER_PROJECTS,
    .usual_rate = 9000,
    .create = drift_kick_create,
    .step = drift_kick_step,
    .free = drift_kick_free,
};
