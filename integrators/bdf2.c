#include "bdf.h"

static const struct option_spec options[] = {MATRIX_OPTION_SPEC, {0}};

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    return bdf_create(2, settings, system);
}

const struct stepper_method bdf2 = {
    .name = "bdf2",
    .summary = "semi-implicit BDF of order 2: one evaluation and one solve a step",
    .reference =
        "Choi & Ko 2002, doi:10.1145/566654.566624; Hairer, Norsett & Wanner, Solving ODEs "
        "I, section III.5",
    .order = 2,
    .capabilities = STEPPER_IMPLICIT | STEPPER_MULTISTEP,
    .options = options,
    .usual_rate = 180, /* 1 mm on `swing` */
    .refuse = semi_implicit_refuse,
    .create = create,
    .step = bdf_step,
    .reset = bdf_reset,
    .caution = bdf_caution,
    .free = bdf_free,
};
