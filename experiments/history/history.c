/* What could one do before the thesis, and what did it change? Hair as its chapter 3 tells of it,
 * run as its authors ran it, beside the thesis's own recipe and today's. */
#include "history.h"

static int history_plan(struct plan *plan) {
    if (plan_has_no_scenes(plan) || plan_has_no_steppers(plan, "the recipes of their times") ||
        recipes_plan(plan))
        return -1;
    return stiffness_map_plan(plan);
}

static int history_tabulate(struct plan *plan) {
    int code = plan_open_statements(
        plan, NULL,
        plan->quick
            ? "--quick: every other rate, and none above 1 MHz; the map every other stiffness"
            : NULL);
    code = code ? code : recipes_tabulate(plan);
    code = code ? code : stiffness_map_tabulate(plan);
    return code ? code : news_tabulate(plan);
}

const struct experiment history_experiment = {
    .name = "history",
    .question = "what could one do before the thesis, and how far does a step carry news?",
    .thesis = "chapter 3",
    .chapter = CHAPTER_THESIS,
    .place = 20,
    .headline = "film",
    .quick_seconds = 5,
    .full_seconds = 35,
    .plan = history_plan,
    .tabulate = history_tabulate,
};
