#include "explicit_rk.h"

static const struct butcher_table table = {
    .stages = 1,
    .a = (const double[]){0},
    .b = (const double[]){1},
    .c = (const double[]){0},
};

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    return explicit_rk_create(&table, system);
}

const struct stepper_method euler = {
    .name = "euler",
    .summary = "explicit Euler, with the constraint projection of the treatment",
    .reference = "Plante 1999, eq. 2.1; Hairer, Norsett & Wanner, Solving ODEs I, section I.7",
    .order = 1,
    .capabilities = STEPPER_PROJECTS,
    .table = &table,
    .on_wisps = {.treatment = "projection"}, /* the thesis's */
    .usual_rate = 9000,
    .create = create,
    .step = explicit_rk_step,
    .free = explicit_rk_free,
};
