/* What does accuracy cost? Every stepper on scenes of wisps, from steps that are too long for it to
 * steps that are shorter than anyone needs: integration error, against the tight solution of the
 * same treatment, over CPU time and force evaluations. */
#include "race.h"

static const char *const scenes[] = {"swing",        "swing-envelope", "radii",
                                     "interactions", "wind",           NULL};
static const char *const quick_scenes[] = {"swing", "swing-envelope", NULL};

static const struct contestant contestants[] = {
    {.name = "euler", .stepper = "euler"},
    {.name = "midpoint", .stepper = "midpoint"},
    {.name = "rk4", .stepper = "rk4"},
    {.name = "implicit-euler", .stepper = "implicit-euler", .linear = "direct"},
    {.name = "implicit-euler newton",
     .stepper = "implicit-euler",
     .linear = "direct",
     .options = {"newton.iterations=30"}},
    {.name = "implicit-euler cg", .stepper = "implicit-euler", .linear = "cg"},
    {.name = "cvode", .stepper = "cvode", .finest = 1e-8, .order = 2},
    {.name = "cvode order 5",
     .stepper = "cvode",
     .options = {"max_order=5"},
     .finest = 1e-11,
     .order = 5},
    {.name = "reference", .stepper = "reference", .finest = 1e-10, .order = 8},
    {0},
};

static const struct race race = {
    .scenes = scenes,
    .quick_scenes = quick_scenes,
    .contestants = contestants,
    .seconds = 600,
    .quick_seconds = 30,
};

static int plan(struct plan *plan) {
    return race_plan(plan, &race);
}

const struct experiment work_precision_experiment = {
    .name = "work-precision",
    .question = "what does accuracy cost, by stepper, treatment and scene?",
    .place = 1,
    .quick = {20, 0.6},
    .full = {300, 0.5},
    .answers = 1u << ANSWERS_CHOICE | 1u << ANSWERS_TARGETS | 1u << ANSWERS_FAILURES,
    .plan = plan,
    .refine = race_refine,
    .tabulate = race_tabulate,
};
