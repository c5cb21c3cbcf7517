/* What does adaptive subdivision add to the motion, and what does it cost? Two wisps that
 * swing into each other, with and without it (section 5.5 of the thesis). */
#include "hair_study.h"

enum { WISPS, STRAIN };

static int measure(struct hair *hair, double *const *series) {
    for (int f = 0; f < hair->frame_count; f++) {
        series[WISPS][f] = hair->frames[f].wisps;
        series[STRAIN][f] = 100 * hair_strain(hair, f);
    }
    return 0;
}

static void state_count(struct hair_study *study, const struct hair_run *whole,
                        const struct hair_run *split) {
    const int last = split->hair.frame_count - 1;
    const double first = split->series[WISPS][0], end = split->series[WISPS][last];
    const double without = whole->series[WISPS][whole->hair.frame_count - 1];
    hair_state(study,
               (struct statement){.key = "wisps, without",
                                  .by = THESIS,
                                  .verdict = holds_if(without == whole->series[WISPS][0]),
                                  .value = without,
                                  .unit = "1"},
               "Without subdivision there are %.0f wisps at the start and %.0f at the end.",
               whole->series[WISPS][0], without);
    hair_state(study,
               (struct statement){.key = "wisps",
                                  .by = THESIS,
                                  .verdict = hair_seen(study, end == 2 * first),
                                  .value = end,
                                  .unit = "1"},
               "With subdivision the wisps double%s: from %.0f to %.0f.", study->span, first, end);
}

/* In how many numbers the free nodes of a frame differ, of the wisps that both runs have. */
static double numbers_apart(const struct hair *whole, const struct hair *split, int frame) {
    double apart = 0;
    for (int w = 0; w < whole->frames[frame].wisps; w++)
        for (int i = 2; i < hair_nodes(split, frame, w); i++)
            for (int k = 0; k < 6; k++)
                apart += hair_node(split, frame, w, i)[k] != hair_node(whole, frame, w, i)[k];
    return apart;
}

/* Before the first split both runs are the same; from it on the motions differ. */
static void state_motion(struct hair_study *study, const struct hair_run *whole,
                         const struct hair_run *split) {
    const struct hair *hair = &split->hair;
    int divided = 0, same = 0;
    while (divided < hair->frame_count && split->series[WISPS][divided] == split->series[WISPS][0])
        divided++;
    while (same < divided && hair_same(&whole->hair, hair, same))
        same++;
    hair_state(study,
               (struct statement){.key = "the same until",
                                  .verdict = holds_if(same == divided),
                                  .value = same,
                                  .unit = "frame"},
               "Of the %d frames before the first split %d are the same in both runs, bit for bit.",
               divided, same);
    if (divided == hair->frame_count) {
        hair_state(study,
                   (struct statement){.key = "split", .by = THESIS, .verdict = hair_seen(study, 0)},
                   "No wisp splits%s.", study->span);
        return;
    }
    const double number = hair->frames[divided].t * 30 + 1,
                 apart = numbers_apart(&whole->hair, hair, divided);
    hair_state(study, (struct statement){.key = "split", .value = number, .unit = "frame"},
               "The first split shows at frame %.0f (thesis: 8).", number);
    hair_state(study,
               (struct statement){.key = "differs after",
                                  .by = THESIS,
                                  .verdict = holds_if(apart > 0),
                                  .value = apart,
                                  .unit = "1"},
               "From the split on the motion differs: in %.0f numbers of its first frame.", apart);
}

static void state_cost(struct hair_study *study, const struct hair_run *whole,
                       const struct hair_run *split) {
    const struct spread without = hair_cpu_per_frame(whole), with = hair_cpu_per_frame(split);
    const double ratio = with.median / without.median;
    hair_state(study,
               (struct statement){.key = "cost",
                                  .figure = "cost",
                                  .tables = "table",
                                  .by = THESIS,
                                  .verdict = holds_if(with.least > without.greatest),
                                  .value = ratio,
                                  .unit = "1"},
               "More wisps cost more, beyond the spreads: %.2f times as much (up to four are "
               "computed side by side, for the price of one).",
               ratio);
}

static void state(struct hair_study *study) {
    const struct hair_run *whole = &study->runs[0], *split = &study->runs[1];
    state_count(study, whole, split);
    state_motion(study, whole, split);
    state_cost(study, whole, split);
}

static const struct hair_question question = {
    .scene = "subdivision",
    .needs = "subdivision",
    .variants = {{.label = "without",
                  .sets = {"subdivision.ratio=1e-6"}, /* the test is made, and nothing follows */
                  .thesis = 0.88,
                  .pictures = {1, 6, 8, 10}},
                 {.label = "with", .thesis = 1.66, .pictures = {1, 6, 8, 10}}},
    .main = 1,
    .columns = 4,
    .azimuth = 35,
    .elevation = 20,
    .series = {"wisps", "strain"},
    .measure = measure,
    .state = state,
};

static int subdivision_plan(struct plan *plan) {
    return hair_plan(plan, &question);
}

static int subdivision_tabulate(struct plan *plan, const char *folder) {
    return hair_tabulate(plan, folder, &question);
}

const struct experiment subdivision_experiment = {
    .name = "subdivision",
    .question = "what does adaptive subdivision add, and what does it cost?",
    .thesis = "section 5.5",
    .place = 11,
    .quick_seconds = 2,
    .full_seconds = 15,
    .answers = 1u << ANSWERS_CHOICE,
    .plan = subdivision_plan,
    .tabulate = subdivision_tabulate,
};
