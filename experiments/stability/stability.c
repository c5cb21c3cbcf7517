/* Where is each stepper stable, and what is it there? Regions and maps of the real code on the
 * smallest systems beside the analytic ones; the longest stable step on wisps beside the prediction
 * of linear theory; how each fails beyond it; and what damping and frequency shift it has of its
 * own, since stable is not accurate. */
#include "stability.h"

static int stability_tabulate(struct plan *plan) {
    if (plan_open_statements(plan, NULL,
                             plan->quick ? "--quick: coarser maps, brackets of 12 %" : NULL) ||
        stability_maps(plan))
        return -1;
    return limits_tabulate(plan);
}

const struct experiment stability_experiment = {
    .name = "stability",
    .question = "what is the longest stable step of each stepper, and how does it fail beyond?",
    .chapter = CHAPTER_STABILITY,
    .place = 2,
    .headline = "longest steps",
    .quick_seconds = 6,
    .full_seconds = 25,
    .answers = 1u << ANSWERS_FAILURES,
    .plan = limits_plan,
    .refine = limits_refine,
    .tabulate = stability_tabulate,
};
