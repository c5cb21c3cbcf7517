/* What do an implicit method's settings cost, and what do they buy? The same chart as in
 * work-precision, of solvers, Jacobians, orders and iterations. */
#include "race.h"

static const char *const scenes[] = {"swing", "swing-envelope", "interactions", NULL};
static const char *const quick_scenes[] = {"swing-envelope", NULL};
static const char *const treatments[] = {"generalised", "penalty", NULL};

static const struct race race = {
    .scenes = scenes,
    .quick_scenes = quick_scenes,
    .kinds = CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_SOLVER |
             CONFIGURATION_ORDER | CONFIGURATION_SOLVER_DETAILS,
    .capabilities = STEPPER_SOLVES,
    .treatments = treatments,
    .seconds = 70,
    .quick_seconds = 60,
};

const struct experiment solvers_experiment = {
    .name = "solvers",
    .question = "what do an implicit method's solver, Jacobian, order and iterations cost and buy?",
    .chapter = CHAPTER_ACCURACY,
    .place = 16,
    .headline = "1 mm",
    .full_seconds = 190,
    .takes_states = 1,
    .study = &race,
    .plan = race_plan,
    .refine = race_refine,
    .tabulate = race_tabulate,
};
