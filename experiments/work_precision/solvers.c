/* What do an implicit method's settings cost, and what do they buy? The same chart as in
 * work-precision, of solvers, Jacobians, orders and iterations. */
#include "race.h"

static const char *const scenes[] = {"swing", "swing-envelope", "interactions", NULL};
static const char *const quick_scenes[] = {"swing-envelope", NULL};
static const char *const treatments[] = {"generalised", "penalty", NULL};

static const struct contestant contestants[] = {
    {.name = "implicit-euler", .stepper = "implicit-euler", .linear = "direct"},
    {.name = "implicit-euler newton",
     .stepper = "implicit-euler",
     .linear = "direct",
     .options = {"newton.iterations=30"}},
    {.name = "implicit-euler klu",
     .stepper = "implicit-euler",
     .linear = "klu",
     .options = {"jacobian=exact"}},
    {.name = "implicit-euler klu newton",
     .stepper = "implicit-euler",
     .linear = "klu",
     .options = {"jacobian=exact", "newton.iterations=30"}},
    {.name = "implicit-euler cg 1e-2",
     .stepper = "implicit-euler",
     .linear = "cg",
     .options = {"cg.tolerance=1e-2"}},
    {.name = "implicit-euler cg 1e-4",
     .stepper = "implicit-euler",
     .linear = "cg",
     .options = {"cg.tolerance=1e-4"}},
    {.name = "implicit-euler cg 1e-8", .stepper = "implicit-euler", .linear = "cg"},
    {.name = "cvode", .stepper = "cvode", .finest = 1e-8, .order = 2},
    {.name = "cvode order 5",
     .stepper = "cvode",
     .options = {"max_order=5"},
     .finest = 1e-10,
     .order = 5},
    {.name = "cvode klu spd",
     .stepper = "cvode",
     .linear = "klu",
     .options = {"jacobian=spd"},
     .finest = 1e-8,
     .order = 2},
    {.name = "cvode klu exact",
     .stepper = "cvode",
     .linear = "klu",
     .options = {"jacobian=exact"},
     .finest = 1e-8,
     .order = 2},
    {.name = "cvode cg 1e-2",
     .stepper = "cvode",
     .linear = "cg",
     .options = {"cg.tolerance=1e-2"},
     .finest = 1e-8,
     .order = 2},
    {.name = "cvode cg 1e-8", .stepper = "cvode", .linear = "cg", .finest = 1e-8, .order = 2},
    {0},
};

static const struct race race = {
    .scenes = scenes,
    .quick_scenes = quick_scenes,
    .contestants = contestants,
    .treatments = treatments,
    .seconds = 600,
    .quick_seconds = 30,
};

static int plan(struct plan *plan) {
    return race_plan(plan, &race);
}

const struct experiment solvers_experiment = {
    .name = "solvers",
    .question = "what do an implicit method's solver, Jacobian, order and iterations cost and buy?",
    .place = 15,
    .full = {150, 0.25},
    .plan = plan,
    .refine = race_refine,
    .tabulate = race_tabulate,
};
