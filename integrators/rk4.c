#include "explicit_rk.h"

/* The thesis prints it with velocities missing from the stages' forces; this is the classical
 * method. */
static const struct butcher_table table = {
    .stages = 4,
    /* clang-format off */
    .a = (const double[]){0,      0,      0, 0,
                          1. / 2, 0,      0, 0,
                          0,      1. / 2, 0, 0,
                          0,      0,      1, 0},
    /* clang-format on */
    .b = (const double[]){1. / 6, 1. / 3, 1. / 3, 1. / 6},
    .c = (const double[]){0, 1. / 2, 1. / 2, 1},
};

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    return explicit_rk_create(&table, system);
}

const struct stepper_method rk4 = {
    .name = "rk4",
    .summary = "classical Runge-Kutta method of order 4",
    .reference = "Kutta 1901; Hairer, Norsett & Wanner, Solving ODEs I, table II.1.2",
    .order = 4,
    .capabilities = STEPPER_PROJECTS,
    .table = &table,
    .usual_rate = 4000,
    .create = create,
    .step = explicit_rk_step,
    .free = explicit_rk_free,
};
