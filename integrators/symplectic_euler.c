/* Euler with the new velocity in the position. Without damping it is symplectic: energies do not
 * drift, and steps of up to twice those of midpoint are stable. */
#include "stepper.h"

#include <stdlib.h>

struct symplectic_euler {
    struct stepper base;
    double a[];
};

static struct stepper *symplectic_euler_create(const struct stepper_settings *settings,
                                               struct system *system) {
    (void)settings;
    struct symplectic_euler *self = malloc(sizeof *self + (size_t)system->size * sizeof(double));
    return self ? &self->base : NULL;
}

static int symplectic_euler_step(struct stepper *stepper, double t, double h, double *q,
                                 double *v) {
    struct symplectic_euler *self = (struct symplectic_euler *)stepper;
    struct system *system = stepper->system;
    const int code = system_acceleration(system, t, q, v, self->a);
    for (int i = 0; i < system->size && !code; i++) {
        v[i] += h * self->a[i];
        q[i] += h * v[i];
    }
    return code;
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
    .usual_rate = 9000,
    .amplification = amplification,
    .create = symplectic_euler_create,
    .step = symplectic_euler_step,
    .free = symplectic_euler_free,
};
