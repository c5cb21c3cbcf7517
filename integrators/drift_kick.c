/* Drift, kick, drift: half a step of the positions, a step of the velocities by the forces there,
 * the other half. Without forces that depend on the velocity it is the leapfrog: symplectic,
 * reversible, of order 2. The velocity of those that do is the one before the kick, which is half a
 * step behind: of order 1, with a small error where damping is light. (Tried: the velocity half way
 * by the last step's acceleration is of order 2 with damping too, and stable to two thirds of the
 * step on `swing`, less than explicit Euler.) */
#include "stepper.h"

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    return stepper_of_vectors(system, 3);
}

/* The state of the end is apart until it is projected, its q in the place of that half way. */
static int step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct system *system = stepper->system;
    const int n = system->size, projects = system_has_projection(system);
    double *middle = stepper_vectors(stepper), *a = middle + n;
    double *new_q = projects ? middle : q, *new_v = projects ? a + n : v;
    for (int i = 0; i < n; i++)
        middle[i] = q[i] + h / 2 * v[i];
    const int code = system_acceleration(system, t + h / 2, middle, v, a);
    for (int i = 0; i < n && !code; i++) {
        new_v[i] = v[i] + h * a[i];
        new_q[i] = middle[i] + h / 2 * new_v[i];
    }
    return code ? code : stepper_arrive(stepper, t + h, new_q, new_v, q, v);
}

const struct stepper_method drift_kick = {
    .name = "drift-kick",
    .summary = "drift-kick-drift: the leapfrog, of order 1 with damping and 2 without",
    .reference = "Hairer, Lubich & Wanner 2003, doi:10.1017/S0962492902000144",
    .order = 1,
    .undamped_order = 2,
    .capabilities = STEPPER_PROJECTS,
    .usual_rate = 9000,
    .create = create,
    .step = step,
    .free = stepper_free,
};
