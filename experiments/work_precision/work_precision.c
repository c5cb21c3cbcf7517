/* What does accuracy cost? Every stepper on scenes of wisps, from steps that are too long for it to
 * steps that are shorter than anyone needs: integration error, against the reference solution of
 * the same treatment, over CPU time and force evaluations. */
#include "race.h"

/* One wisp and 64 of them: what a wisp costs alone is not what it costs among others. That takes as
 * long as all others together, and so is left out of --quick. */
static const char *const scenes[] = {"swing", "swing-64", "swing-envelope", "radii", "interactions",
                                     "wind",  NULL};
static const char *const quick_scenes[] = {"swing", "swing-envelope", NULL};

static const struct race race = {
    .scenes = scenes,
    .quick_scenes = quick_scenes,
    .kinds = CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_SOLVER |
             CONFIGURATION_ORDER | CONFIGURATION_LANES | CONFIGURATION_COSTLY,
    .seconds = 260,
    .quick_seconds = 60,
};

const struct experiment work_precision_experiment = {
    .name = "work-precision",
    .question = "what does accuracy cost, by stepper, treatment and scene?",
    .chapter = CHAPTER_ACCURACY,
    .place = 1,
    .headline = "1 mm",
    .quick_seconds = 20,
    .full_seconds = 370,
    .answers = 1u << ANSWERS_CHOICE | 1u << ANSWERS_TARGETS | 1u << ANSWERS_FAILURES,
    .takes_states = 1,
    .study = &race,
    .plan = race_plan,
    .refine = race_refine,
    .tabulate = race_tabulate,
};
