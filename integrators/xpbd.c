/* Extended position based dynamics: a step of all forces but the springs and hinges of hair, by
 * symplectic Euler; then these, as constraints that give way by their compliance, are satisfied one
 * after the other in a number of sweeps, and velocities are what the positions have become by.
 *
 * With so many sweeps that nothing changes any more it is implicit Euler in the springs, but for
 * the directions in which they pull, which are those that each sweep found. With fewer hair is
 * softer than it says, the more the stiffer it is and the more nodes it has: a sweep takes what
 * pulls at one node to its neighbours only. On a system without springs it is symplectic Euler, and
 * so it is where segments are rigid. */
#include "stepper.h"

#include <stdlib.h>
#include <string.h>

enum { SWEEPS };
static const struct option_spec options[] = {
    [SWEEPS] = {"sweeps", "Gauss-Seidel sweeps over the springs in a step; few make hair soft",
                OPTION_COUNT, .initial = 10, .least = 1, .most = 100000},
    {.name = NULL},
};

struct xpbd {
    struct stepper base;
    int sweeps;
    double *a, *x, *v, *multipliers; /* x and v are of the end */
    double memory[];
};

static struct stepper *xpbd_create(const struct stepper_settings *settings, struct system *system) {
    const size_t n = (size_t)system->size, springs = (size_t)system->springs;
    struct xpbd *self = malloc(sizeof *self + (3 * n + springs) * sizeof(double));
    if (!self)
        return NULL;
    self->sweeps = (int)option_value(&settings->options, &options[SWEEPS]);
    self->a = self->memory;
    self->x = self->a + n;
    self->v = self->x + n;
    self->multipliers = self->v + n;
    return &self->base;
}

static int xpbd_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct xpbd *self = (struct xpbd *)stepper;
    struct system *system = stepper->system;
    const int n = system->size, springs = system->springs;
    const int code = springs ? system_without_springs(system, t, q, v, self->a)
                             : system_acceleration(system, t, q, v, self->a);
    if (code)
        return code;
    for (int i = 0; i < n; i++)
        self->x[i] = q[i] + h * (v[i] + h * self->a[i]);
    memset(self->multipliers, 0, (size_t)springs * sizeof(double));
    for (int k = 0; k < self->sweeps && springs; k++)
        system_sweep_springs(system, t + h, h, q, self->x, self->multipliers);
    for (int i = 0; i < n; i++)
        self->v[i] = (self->x[i] - q[i]) / h;
    return stepper_arrive(stepper, t + h, self->x, self->v, q, v);
}

const struct stepper_method xpbd = {
    .name = "xpbd",
    .summary = "extended position based dynamics: springs as compliant constraints, by sweeps",
    .reference = "Macklin, Mueller & Chentanez 2016, doi:10.1145/2994258.2994272",
    .order = 1,
    .capabilities = STEPPER_PROJECTS,
    .options = options,
    .usual_rate = 1000,
    .create = xpbd_create,
    .step = xpbd_step,
    .free = stepper_free,
};
