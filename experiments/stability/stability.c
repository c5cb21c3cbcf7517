/* Where is each stepper stable, and what is it there? Regions and maps of the real code on the
 * smallest systems beside the analytic ones; the longest stable step on wisps beside the prediction
 * of linear theory; how each fails beyond it; and what damping and frequency shift it has of its
 * own, since stable is not accurate. */
#include "stability.h"

static int stability_tabulate(struct plan *plan, const char *folder) {
    struct statements statements;
    if (plan_open_statements(plan, &statements, folder, NULL,
                             plan->quick ? "--quick: coarser maps, brackets of 12 %" : NULL,
                             plan->reason))
        return -1;
    const int code =
        stability_maps(plan, folder, &statements) || limits_tabulate(plan, folder, &statements) ? -1
                                                                                                : 0;
    return statements_close(&statements, code, plan->reason);
}

const struct experiment stability_experiment = {
    .name = "stability",
    .question = "what is the longest stable step of each stepper, and how does it fail beyond?",
    .chapter = CHAPTER_STABILITY,
    .place = 2,
    .headline = "longest steps",
    .quick_seconds = 6,
    .full_seconds = 120,
    .answers = 1u << ANSWERS_FAILURES,
    .plan = limits_plan,
    .refine = limits_refine,
    .tabulate = stability_tabulate,
};
