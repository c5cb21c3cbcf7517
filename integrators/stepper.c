#include "stepper.h"

#include <stdlib.h>
#include <string.h>

int stepper_steps_by_lane(const struct stepper_method *method) {
    return method->capabilities & STEPPER_ADAPTIVE && method->lanes > 1;
}

int stepper_shares_steps(const struct stepper_method *method, const struct options *options) {
    return method->shared_steps && option_value(options, method->shared_steps) > 0;
}

int stepper_lanes(const struct stepper_method *method, const struct linear_method *linear,
                  const struct options *options) {
    const int most = stepper_shares_steps(method, options)     ? STEPPER_SHARING
                     : method->lanes > 0                       ? method->lanes
                     : method->capabilities & STEPPER_ADAPTIVE ? 1
                                                               : LANES_MOST;
    return linear && linear->max_lanes < most ? linear->max_lanes : most;
}

double stepper_usual_rate(const struct stepper_method *method) {
    return method->usual_rate > 0                    ? method->usual_rate
           : method->capabilities & STEPPER_IMPLICIT ? 300
                                                     : 9000;
}

int stepper_is_predictable(const struct stepper_method *method) {
    return method->amplification || method->table;
}

double complex stepper_amplification(const struct stepper_method *method, double complex z,
                                     double complex partner) {
    if (method->amplification)
        return method->amplification(z, partner);
    const double complex one = butcher_stability(method->table, z);
    if (partner == conj(z))
        return one;
    const double complex other = butcher_stability(method->table, partner);
    return cabs(other) > cabs(one) ? other : one;
}

int stepper_refuse(const struct stepper_method *method, const struct stepper_settings *settings,
                   struct system *system) {
    if (system->no_jacobians && method->capabilities & STEPPER_IMPLICIT &&
        !(method->capabilities & STEPPER_JACOBIAN_FREE))
        return system_fail(system, REFUSED, "%s needs Jacobians, and %s", method->name,
                           system->no_jacobians);
    if (system_has_projection(system) && !(method->capabilities & STEPPER_PROJECTS))
        return system_fail(system, REFUSED, "%s does not keep the constraint of %s", method->name,
                           system->name);
    return method->refuse ? method->refuse(settings, system) : 0;
}

void *stepper_memory(size_t bytes) {
    const size_t lines = (bytes + 63) / 64 * 64;
    void *memory = aligned_alloc(64, lines);
    return memory ? memset(memory, 0, lines) : NULL;
}

struct stepper_of_vectors {
    struct stepper base;
    IN_LINES double memory[];
};

struct stepper *stepper_of_vectors(struct system *system, size_t count) {
    const size_t numbers = count * (size_t)system->size;
    return stepper_memory(sizeof(struct stepper_of_vectors) + numbers * sizeof(double));
}

double *stepper_vectors(struct stepper *stepper) {
    return ((struct stepper_of_vectors *)stepper)->memory;
}

void stepper_free(struct stepper *stepper) {
    free(stepper);
}

int stepper_arrive(struct stepper *stepper, double t1, double *q1, double *v1, double *q,
                   double *v) {
    struct system *system = stepper->system;
    const size_t bytes = (size_t)system->size * sizeof(double);
    const int code = system_has_projection(system) ? system_project(system, t1, q1, v1) : 0;
    if (code || q1 == q)
        return code;
    memcpy(q, q1, bytes);
    memcpy(v, v1, bytes);
    return 0;
}

struct stepper *stepper_create(const struct stepper_method *method,
                               const struct stepper_settings *settings, struct system *system) {
    struct stepper *stepper = method->create(settings, system);
    if (stepper) {
        stepper->method = method;
        stepper->system = system;
    }
    return stepper;
}
