/* Linear Euler: implicit Euler with its equations linearised once, in a part of the forces,
 *
 *     (M - h D - h^2 K) dv = h (f(t + h, q, v) + h K v),   v1 = v + dv,   q1 = q + h v1.
 *
 * The pull h K v is what the forces change by while the nodes go on as they do; without it stiff
 * springs let go at long steps. */
#include "semi_implicit.h"

static const struct option_spec options[] = {MATRIX_OPTION_SPEC, {0}};

struct linear_euler {
    struct semi_implicit_stepper semi;
    IN_LINES double end[]; /* q and v, where they are to be projected */
};

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    const size_t bytes = 2 * (size_t)system->size * sizeof(double);
    return semi_implicit_stepper(settings, system, sizeof(struct linear_euler) + bytes);
}

static int step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct linear_euler *self = (struct linear_euler *)stepper;
    const int projects = system_has_projection(stepper->system);
    double *q1 = projects ? self->end : q, *v1 = projects ? self->end + stepper->system->size : v;
    const int code = semi_implicit_euler(self->semi.matrix, t, h, q, v, q1, v1);
    return code ? code : stepper_arrive(stepper, t + h, q1, v1, q, v);
}

/* Implicit Euler's, of what is in the matrix: with `auto` that is all that bounds explicit steps.
 */
static double complex amplification(double complex z, double complex partner) {
    const double complex one = 1 / (1 - z), other = 1 / (1 - partner);
    return cabs(other) > cabs(one) ? other : one;
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
    .create = create,
    .step = step,
    .caution = semi_implicit_stepper_caution,
    .free = semi_implicit_stepper_free,
};
