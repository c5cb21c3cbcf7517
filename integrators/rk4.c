#include "explicit_rk.h"

/* The thesis prints it with velocities missing from the stages' forces; this is the classical
 * method. */
static const struct butcher_table table = {
    .stages = 4,
    .a = {{0}, {1. / 2}, {0, 1. / 2}, {0, 0, 1}},
    .b = {1. / 6, 1. / 3, 1. / 3, 1. / 6},
    .c = {0, 1. / 2, 1. / 2, 1},
};

const struct stepper_method rk4 = {
    .name = "rk4",
    .summary = "classical Runge-Kutta method of order 4",
    .reference = "Kutta 1901; Hairer, Norsett & Wanner, Solving ODEs I, table II.1.2",
    .order = 4,
    .capabilities = STEPPER_PROJECTS,
    .table = &table,
    .create = explicit_rk_create,
    .step = explicit_rk_step,
    .free = explicit_rk_free,
};
