/* Linear Euler: implicit Euler with its equations linearised once, in a part of the forces,
 *
 *     (M - h D - h^2 K) dv = h (f(t + h, q, v) + h K v),   v1 = v + dv,   q1 = q + h v1.
 *
 * The pull h K v is what the forces change by while the nodes go on as they do; without it stiff
 * springs let go at long steps. */
#include "semi_implicit.h"

#include <stdlib.h>
#include <string.h>

static const struct option_spec options[] = {MATRIX_OPTION_SPEC, {0}};

struct linear_euler {
    struct stepper base;
    struct semi_implicit *matrix;
    double *q, *v; /* of the end, where it is to be projected */
    IN_LINES double memory[];
};

static struct stepper *linear_euler_create(const struct stepper_settings *settings,
                                           struct system *system) {
    const size_t n = (size_t)system->size;
    struct linear_euler *self = stepper_memory(sizeof *self + 2 * n * sizeof(double));
    if (!self)
        return NULL;
    self->q = self->memory;
    self->v = self->memory + n;
    self->matrix = semi_implicit_create(settings, system);
    if (!self->matrix) {
        free(self);
        return NULL;
    }
    return &self->base;
}

static int linear_euler_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct linear_euler *self = (struct linear_euler *)stepper;
    struct system *system = stepper->system;
    const size_t bytes = (size_t)system->size * sizeof(double);
    if (!system_has_projection(system))
        return semi_implicit_euler(self->matrix, t, h, q, v, q, v);
    int code = semi_implicit_euler(self->matrix, t, h, q, v, self->q, self->v);
    if (!code)
        code = system_project(system, t + h, self->q, self->v);
    if (code)
        return code;
    memcpy(q, self->q, bytes);
    memcpy(v, self->v, bytes);
    return 0;
}

static const char *linear_euler_caution(const struct stepper *stepper) {
    return semi_implicit_caution(((const struct linear_euler *)stepper)->matrix);
}

/* Implicit Euler's, of what is in the matrix: with `auto` that is all that bounds explicit steps.
 */
static double complex amplification(double complex z, double complex partner) {
    const double complex one = 1 / (1 - z), other = 1 / (1 - partner);
    return cabs(other) > cabs(one) ? other : one;
}

static void linear_euler_free(struct stepper *stepper) {
    struct linear_euler *self = (struct linear_euler *)stepper;
    if (self)
        semi_implicit_free(self->matrix);
    free(self);
}

const struct stepper_method linear_euler = {
    .name = "linear-euler",
    .summary = "implicit Euler, linearised in the stiff part of the forces",
    .reference = "Baraff & Witkin 1998, doi:10.1145/280814.280821; Han & Harada 2013, "
                 "doi:10.2312/PE.vriphys.vriphys13.097-105",
    .order = 1,
    .capabilities = STEPPER_IMPLICIT | STEPPER_PROJECTS,
    .options = options,
    .usual_rate = 390, /* 1 mm on `swing` */
    .amplification = amplification,
    .refuse = semi_implicit_refuse,
    .create = linear_euler_create,
    .step = linear_euler_step,
    .caution = linear_euler_caution,
    .free = linear_euler_free,
};
