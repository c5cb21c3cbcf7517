#include "explicit_rk.h"

static const struct butcher_table table = {
    .stages = 2,
    .a = (const double[]){0, 0, 0.5, 0},
    .b = (const double[]){0, 1},
    .c = (const double[]){0, 0.5},
};

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    return explicit_rk_create(&table, system);
}

const struct stepper_method midpoint = {
    .name = "midpoint",
    .summary = "explicit midpoint rule of order 2",
    .reference = "Runge 1895, doi:10.1007/BF01446807",
    .order = 2,
    .capabilities = STEPPER_PROJECTS,
    .table = &table,
    .usual_rate = 6000,
    .create = create,
    .step = explicit_rk_step,
    .free = explicit_rk_free,
};
