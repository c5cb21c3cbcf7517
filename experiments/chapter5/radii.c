/* What does the radius of wisps do to their motion and to its cost? Nine wisps in irregular wind
 * (section 5.1 of the thesis): wider ones hold each other back. */
#include "experiments/captions.h"
#include "hair_study.h"

#include <math.h>

enum { LARGEST, MEAN };

static int measure(struct hair *hair, double *const *series) {
    for (int f = 0; f < hair->frame_count; f++) {
        const struct inclination inclination = hair_inclination(hair, f);
        series[LARGEST][f] = inclination.largest * 180 / M_PI;
        series[MEAN][f] = inclination.mean * 180 / M_PI;
    }
    return 0;
}

/* A tip then moves by a twentieth of a wisp: less is hardly seen. */
static const double visible = 3; /* degrees */

/* The thesis: "bien inférieure à celle des deux autres". */
static void state_inclination(struct hair_study *study, int series, const char *name) {
    double least = INFINITY, widest = INFINITY;
    int falls = 1;
    for (int i = 0; i < study->count; i++) {
        const struct hair_run *run = &study->runs[i];
        const int frame = hair_largest(run, series);
        least = fmin(least, widest);
        falls &= run->series[series][frame] < widest;
        widest = run->series[series][frame];
        char label[64];
        snprintf(label, sizeof label, "%s, %.40s", name, run->variant->label);
        hair_state(study, label, widest, "deg", NO_CLAIM,
                   "%s inclination %.1f degrees at most, at %.2f s", label, widest,
                   run->hair.frames[frame].t);
    }
    char label[64];
    snprintf(label, sizeof label, "%s falls", name);
    hair_state(study, label, falls, "", falls ? HOLDS : HOLDS_NOT,
               "the %s inclination %s from each radius to the next", name,
               falls ? "falls" : "does not fall");
    hair_state(study, name, least - widest, "deg", least - widest > visible ? HOLDS : HOLDS_NOT,
               "the widest wisps have the least of the %s inclinations: %.1f degrees, by %.1f less "
               "than the others (%.0f would be seen)",
               name, widest, least - widest, visible);
}

/* Both rise from each radius to the next; of costs, further than their spreads reach. */
static void state_cost(struct hair_study *study) {
    int contacts = 1, costs = 1;
    for (int i = 1; i < study->count; i++) {
        const struct spread before = hair_cpu_per_frame(&study->runs[i - 1]),
                            here = hair_cpu_per_frame(&study->runs[i]);
        contacts &=
            hair_contacts_per_frame(&study->runs[i]) > hair_contacts_per_frame(&study->runs[i - 1]);
        costs &= here.least > before.greatest;
    }
    const struct hair_run *first = &study->runs[0], *last = &study->runs[study->count - 1];
    const double ratio = hair_cpu_per_frame(last).median / hair_cpu_per_frame(first).median;
    const double few = hair_contacts_per_frame(first), many = hair_contacts_per_frame(last);
    hair_state(study, "contacts", many - few, "per frame", contacts ? HOLDS : HOLDS_NOT,
               "wider wisps have more contacts: from %.1f to %.1f a frame", few, many);
    hair_state(study, "cost", ratio, "", costs ? HOLDS : HOLDS_NOT,
               "each radius costs more than the one before, beyond the spreads; the widest %.2f "
               "times the thinnest",
               ratio);
}

static void state(struct hair_study *study) {
    state_inclination(study, LARGEST, "largest");
    state_inclination(study, MEAN, "mean");
    state_cost(study);
}

/* As in the thesis, those where the wisps are most strongly inclined. */
#define PICTURES \
    { 1, 38, 95 }

static const struct hair_question question = {
    .scene = "radii",
    .needs = "envelope",
    .variants = {{.label = "radius 1 cm",
                  .sets = {"envelope.radius=0.01"},
                  .thesis = 3.92,
                  .pictures = PICTURES},
                 {.label = "radius 2 cm",
                  .sets = {"envelope.radius=0.02"},
                  .thesis = 4.71,
                  .pictures = PICTURES},
                 {.label = "radius 3 cm",
                  .sets = {"envelope.radius=0.03"},
                  .thesis = 5.14,
                  .pictures = PICTURES}},
    .main = 2,
    .columns = 3,
    .azimuth = 20,
    .elevation = 10,
    .quick = 2.4,
    .series = {"largest_inclination", "mean_inclination"},
    .measure = measure,
    .state = state,
};

static int radii_plan(struct plan *plan) {
    return hair_plan(plan, &question);
}

static int radii_tabulate(struct plan *plan, const char *folder) {
    return hair_tabulate(plan, folder, &question);
}

const struct experiment radii_experiment = {
    .name = "radii",
    .question = "thesis 5.1: what does the radius of wisps do to motion and cost?",
    .plan = radii_plan,
    .tabulate = radii_tabulate,
    .caption = caption_hair,
};
