/* Euler with the new velocity in the position. Without damping it is symplectic: energies do not
 * drift, and steps of up to twice those of midpoint are stable. */
#include "stepper.h"

#include <stdlib.h>
#include <string.h>

struct symplectic_euler {
    struct stepper base;
    double *a, *q, *v; /* the state of the end before it is projected */
    IN_LINES double memory[];
};

static struct stepper *symplectic_euler_create(const struct stepper_settings *settings,
                                               struct system *system) {
    (void)settings;
    const size_t n = (size_t)system->size;
    struct symplectic_euler *self = stepper_memory(sizeof *self + 3 * n * sizeof(double));
    if (!self)
        return NULL;
    self->a = self->memory;
    self->q = self->a + n;
    self->v = self->q + n;
    return &self->base;
}

static int symplectic_euler_step(struct stepper *stepper, double t, double h, double *q,
                                 double *v) {
    struct symplectic_euler *self = (struct symplectic_euler *)stepper;
    struct system *system = stepper->system;
    const size_t bytes = (size_t)system->size * sizeof(double);
    const int projects = system_has_projection(system);
    double *new_q = projects ? self->q : q, *new_v = projects ? self->v : v;
    int code = system_acceleration(system, t, q, v, self->a);
    for (int i = 0; i < system->size && !code; i++) {
        new_v[i] = v[i] + h * self->a[i];
        new_q[i] = q[i] + h * new_v[i];
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

/* (q, h v) is multiplied by ( 1 + k h^2, 1 + d h; k h^2, 1 + d h ): its determinant is 1 + d h. */
static double complex amplification(double complex z, double complex partner) {
    const double complex d = z + partner, k = -z * partner;
    const double complex half = 1 + (k + d) / 2, root = csqrt(half * half - 1 - d);
    return cabs(half + root) > cabs(half - root) ? half + root : half - root;
}

static void symplectic_euler_free(struct stepper *stepper) {
    free(stepper);
}

const struct stepper_method symplectic_euler = {
    .name = "symplectic-euler",
    .summary = "Euler with the new velocity in the position",
    .reference = "Hairer, Lubich & Wanner, Geometric Numerical Integration, section VI.3",
    .order = 1,
    .capabilities = STEPPER_PROJECTS,
    .usual_rate = 9000,
    .amplification = amplification,
    .create = symplectic_euler_create,
    .step = symplectic_euler_step,
    .free = symplectic_euler_free,
};
