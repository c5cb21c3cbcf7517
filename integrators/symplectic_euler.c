/* Euler with the new velocity in the position. Without damping it is symplectic: energies do not
 * drift, and steps of up to twice those of midpoint are stable. */
#include "stepper.h"

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    return stepper_of_vectors(system, 3);
}

/* The state of the end is apart until it is projected. */
static int step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct system *system = stepper->system;
    const int n = system->size, projects = system_has_projection(system);
    double *a = stepper_vectors(stepper);
    double *new_q = projects ? a + n : q, *new_v = projects ? a + 2 * n : v;
    const int code = system_acceleration(system, t, q, v, a);
    for (int i = 0; i < n && !code; i++) {
        new_v[i] = v[i] + h * a[i];
        new_q[i] = q[i] + h * new_v[i];
    }
    return code ? code : stepper_arrive(stepper, t + h, new_q, new_v, q, v);
}

/* (q, h v) is multiplied by ( 1 + k h^2, 1 + d h; k h^2, 1 + d h ): its determinant is 1 + d h. */
static double complex amplification(double complex z, double complex partner) {
    const double complex d = z + partner, k = -z * partner;
    const double complex half = 1 + (k + d) / 2, root = csqrt(half * half - 1 - d);
    return cabs(half + root) > cabs(half - root) ? half + root : half - root;
}

const struct stepper_method symplectic_euler = {
    .name = "symplectic-euler",
    .summary = "Euler with the new velocity in the position",
    .reference = "Hairer, Lubich & Wanner, Geometric Numerical Integration, section VI.3",
    .order = 1,
    .capabilities = STEPPER_PROJECTS,
    .usual_rate = 9000,
    .amplification = amplification,
    .create = create,
    .step = step,
    .free = stepper_free,
};
