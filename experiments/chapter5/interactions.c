/* What do wisps do to each other when they meet? Two wisps that gravity swings into each other
 * (section 5.2 of the thesis), with each response alone, both and none. */
#include "base/vector.h"
#include "crossing.h"
#include "hair_study.h"

#include <math.h>

enum { CROSSINGS, CONTACTS, NET };

static int measure(const struct hair_study *study, struct hair_run *run) {
    (void)study;
    for (int f = 0; f < run->hair.frame_count; f++) {
        run->series[CONTACTS][f] = hair_overlap(&run->hair, f);
        if (run->series[CONTACTS][f] < 0)
            return -1;
    }
    return hair_crossings(&run->hair, run->series[CROSSINGS], run->series[NET]);
}

/* The variants. */
enum { NONE, RUBBING, COLLIDING, ALL };

/* The variants in words, in their order. */
static const char *const with[] = {"Without interaction", "With interpenetration alone",
                                   "With collision alone", "With both responses"};

static int wisps_meet(const struct hair_run *run) {
    return run->series[CONTACTS][hair_largest(run, CONTACTS)] > 0;
}

/* Net crossings tell wisps that have passed each other from those that hang where they came from:
 * what crosses and comes back the same way counts twice in all, and net not at all. */
static void state_crossings(struct hair_study *study, int variant) {
    const struct hair_run *run = &study->runs[variant];
    const int frames = run->hair.frame_count, is_free = variant == NONE;
    int first = 0;
    while (first < frames - 1 && run->series[CROSSINGS][first] == 0)
        first++;
    const double count = run->series[CROSSINGS][frames - 1], net = run->series[NET][frames - 1];
    char key[64], sentence[160];
    snprintf(key, sizeof key, "crossings, %.50s", run->variant->label);
    const struct statement row = {
        .key = key,
        .by = is_free ? THESIS : OURS,
        .verdict = !wisps_meet(run) ? NOT_REACHED : holds_if(is_free ? count > 0 : count == 0),
        .value = count,
        .unit = "1"};
    if (!wisps_meet(run))
        snprintf(sentence, sizeof sentence, "the wisps do not meet");
    else if (count > 0)
        snprintf(
            sentence, sizeof sentence,
            "the wisps pass through each other: %.0f crossing%s, net %.0f, the first at %.2f s",
            count, count > 1 ? "s" : "", net, run->hair.frames[first].t);
    else
        snprintf(sentence, sizeof sentence, "the wisps do not pass through each other");
    if (is_free) /* the control's own */
        hair_state(study, row, "%s %s.", with[variant], sentence);
    else
        hair_claim(study, row, "%s %s.", with[variant], sentence);
}

/* The largest distance of a node from where it is in another run, m. */
static double farthest(const struct hair *hair, const struct hair *other, int frame) {
    double largest = 0;
    for (int w = 0; w < hair->frames[frame].wisps; w++)
        for (int i = 2; i < hair_nodes(hair, frame, w); i++) {
            double apart[3] = {0, 0, 0};
            vector_add(apart, 1, hair_node(hair, frame, w, i));
            vector_add(apart, -1, hair_node(other, frame, w, i));
            largest = fmax(largest, vector_length(apart));
        }
    return largest;
}

/* How far a response takes the wisps from where they would be without any: by more than their
 * radius, and the pictures are others. */
static void state_influence(struct hair_study *study, int variant) {
    const struct hair_run *run = &study->runs[variant];
    const double radius = 1e3 * run->hair.scene->wisps[0].radius;
    double most = 0, t = 0;
    char key[64];
    snprintf(key, sizeof key, "influence, %.50s", run->variant->label);
    for (int f = 0; f < run->hair.frame_count; f++) {
        const double here = 1e3 * farthest(&run->hair, &study->runs[NONE].hair, f);
        t = here > most ? run->hair.frames[f].t : t;
        most = here > most ? here : most;
    }
    hair_claim(
        study,
        (struct statement){.key = key,
                           .by = THESIS,
                           .verdict = wisps_meet(run) ? holds_if(most > radius) : NOT_REACHED,
                           .value = most,
                           .unit = "mm"},
        "%s nodes are up to %.1f mm from where they are without interaction, at %.2f s (a "
        "wisp's radius is %.0f mm).",
        with[variant], most, t, radius);
}

/* The thesis puts the differences of its times down to how long wisps were in contact. */
static void state_cost(struct hair_study *study) {
    double contacts[ALL + 1];
    int met = 1;
    for (int i = NONE; i <= ALL; i++) {
        contacts[i] = hair_contacts_per_frame(&study->runs[i]);
        met &= i == NONE || contacts[i] > 0;
    }
    const int ordered = contacts[NONE] < contacts[COLLIDING] &&
                        contacts[COLLIDING] < contacts[RUBBING] &&
                        contacts[RUBBING] < contacts[ALL];
    hair_claim(study,
               (struct statement){.key = "contacts",
                                  .figure = "cost",
                                  .tables = "table",
                                  .by = THESIS,
                                  .verdict = met ? holds_if(ordered) : NOT_REACHED,
                                  .value = contacts[ALL],
                                  .unit = "1"},
               "Contacts are in the order of the thesis's times, none, collision, interpenetration "
               "and all: %.1f, %.1f, %.1f and %.1f a frame.",
               contacts[NONE], contacts[COLLIDING], contacts[RUBBING], contacts[ALL]);
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
/* 16, when the wisps have met, is ours; the others are the thesis's. */
#define PICTURES \
    { 1, 12, 16, 24, 64 }

static const struct hair_question question = {
    .scene = "interactions",
    .needs = {"contacts"},
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
    .main = ALL,
    .control = NONE,
    .without = "without interaction",
    .columns = 5,
    .quick = 0.8, /* they meet at 0.4 s */
    .azimuth = 35,
    .elevation = 20,
    .width = 300,
    .height = 330,
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
