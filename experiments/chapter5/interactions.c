/* What do wisps do to each other when they meet? Two wisps that gravity swings into each other
 * (section 5.2 of the thesis), with each response alone, both and none. */
#include "crossing.h"
#include "hair_study.h"

#include <string.h>

enum { CROSSINGS, CONTACTS, NET };

static int measure(struct hair *hair, double *const *series) {
    for (int f = 0; f < hair->frame_count; f++) {
        series[CONTACTS][f] = hair_overlap(hair, f);
        if (series[CONTACTS][f] < 0)
            return -1;
    }
    return hair_crossings(hair, series[CROSSINGS], series[NET]);
}

/* The variants in words, in their order. */
static const char *const with[] = {"Without interaction", "With interpenetration alone",
                                   "With collision alone", "With both responses"};

/* Net crossings tell wisps that have passed each other from those that hang where they came from:
 * what crosses and comes back the same way counts twice in all, and net not at all. */
static void state_crossings(struct hair_study *study, int variant) {
    const struct hair_run *run = &study->runs[variant];
    const int frames = run->hair.frame_count, is_free = variant == 0;
    int first = 0;
    while (first < frames - 1 && run->series[CROSSINGS][first] == 0)
        first++;
    const double count = run->series[CROSSINGS][frames - 1], net = run->series[NET][frames - 1];
    char key[64];
    snprintf(key, sizeof key, "crossings, %.50s", run->variant->label);
    const struct statement row = {.key = key,
                                  .by = is_free ? THESIS : OURS,
                                  .verdict =
                                      is_free ? hair_seen(study, count > 0) : holds_if(count == 0),
                                  .value = count,
                                  .unit = "1"};
    if (count > 0)
        hair_state(study, row,
                   "%s the wisps pass through each other: %.0f crossings, net %.0f, the first at "
                   "%.2f s.",
                   with[variant], count, net, run->hair.frames[first].t);
    else
        hair_state(study, row, "%s the wisps do not pass through each other%s.", with[variant],
                   study->span);
}

/* How far a response takes the wisps from where they would be without any. */
static void state_influence(struct hair_study *study, int variant) {
    const struct hair_run *run = &study->runs[variant];
    const struct hair *free = &study->runs[0].hair;
    double most = 0, t = 0;
    char key[64];
    snprintf(key, sizeof key, "influence, %.50s", run->variant->label);
    for (int f = 0; f < run->hair.frame_count; f++) {
        const double here = 1e3 * hair_distance(&run->hair, free, f);
        t = here > most ? run->hair.frames[f].t : t;
        most = here > most ? here : most;
    }
    hair_state(
        study,
        (struct statement){
            .key = key, .by = THESIS, .verdict = holds_if(most > 0), .value = most, .unit = "mm"},
        "%s nodes are up to %.1f mm (rms) from where they are without interaction%s, at %.2f s.",
        with[variant], most, study->span, t);
}

static void state_cost(struct hair_study *study) {
    const struct spread first = hair_cpu_per_frame(&study->runs[0]);
    int dearer = 1;
    double most = 0;
    for (int i = 1; i < study->count; i++) {
        const struct spread here = hair_cpu_per_frame(&study->runs[i]);
        dearer &= here.least > first.greatest;
        most = here.median > most ? here.median : most;
    }
    hair_state(
        study,
        (struct statement){.key = "cost",
                           .figure = "cost",
                           .tables = "table",
                           .by = THESIS,
                           .verdict = holds_if(dearer),
                           .value = most / first.median,
                           .unit = "1"},
        "Every interaction costs time, beyond the spreads: the dearest takes %.2f times what "
        "none does.",
        most / first.median);
}

static void state(struct hair_study *study) {
    for (int i = 0; i < study->count; i++)
        state_crossings(study, i);
    for (int i = 1; i < study->count; i++)
        state_influence(study, i);
    state_cost(study);
}

/* The thesis tells the two kinds of meeting apart from its third animation on; in the second all
 * wisps that meet rub against each other: the threshold is 1. */
#define NO_INTERPENETRATION "contacts.interpenetration=false"
#define NO_COLLISION        "contacts.collision=false"
/* 18, when the rows differ most, is ours; the others are the thesis's. */
#define PICTURES \
    { 1, 12, 18, 24, 64 }

static const struct hair_question question = {
    .scene = "interactions",
    .needs = "contacts",
    .variants = {{.label = "none",
                  .sets = {NO_INTERPENETRATION, NO_COLLISION},
                  .thesis = 0.76,
                  .pictures = PICTURES},
                 {.label = "interpenetration",
                  .sets = {NO_COLLISION, "contacts.threshold=1.0"},
                  .thesis = 0.86,
                  .pictures = PICTURES},
                 {.label = "collision",
                  .sets = {NO_INTERPENETRATION},
                  .thesis = 0.84,
                  .pictures = PICTURES},
                 {.label = "all", .thesis = 0.91, .pictures = PICTURES}},
    .main = 3,
    .columns = 5,
    .azimuth = 35,
    .elevation = 20,
    .quick = 0.8,
    .watch_rate = 300,
    .series = {"crossings", "overlap", "net_crossings"},
    .measure = measure,
    .state = state,
};

static int interactions_plan(struct plan *plan) {
    return hair_plan(plan, &question);
}

static int interactions_tabulate(struct plan *plan, const char *folder) {
    return hair_tabulate(plan, folder, &question);
}

const struct experiment interactions_experiment = {
    .name = "interactions",
    .question = "what do wisps do to each other when they meet?",
    .thesis = "section 5.2",
    .place = 8,
    .quick_seconds = 3,
    .full_seconds = 15,
    .answers = 1u << ANSWERS_CHOICE,
    .plan = interactions_plan,
    .tabulate = interactions_tabulate,
};
