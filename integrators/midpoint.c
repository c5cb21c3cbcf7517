#include "explicit_rk.h"

static const struct butcher_table table = {
    .stages = 2,
    .a = {{0}, {0.5}},
    .b = {0, 1},
    .c = {0, 0.5},
};

const struct stepper_method midpoint = {
    .name = "midpoint",
    .summary = "explicit midpoint rule of order 2",
    .reference = "Runge 1895, doi:10.1007/BF01446807",
    .order = 2,
    .capabilities = STEPPER_PROJECTS,
    .table = &table,
    .create = explicit_rk_create,
    .step = explicit_rk_step,
    .free = explicit_rk_free,
};
