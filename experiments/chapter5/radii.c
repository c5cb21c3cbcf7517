/* What does the radius of wisps do to their motion and to its cost? Nine wisps in irregular wind
 * (section 5.1 of the thesis): wider ones hold each other back. */
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

static const char *const inclinations[] = {[LARGEST] = "largest", [MEAN] = "mean"};

static void state_radius(struct hair_study *study, int series, const struct hair_run *run) {
    const int frame = hair_largest(run, series);
    const double most = run->series[series][frame];
    char key[64];
    snprintf(key, sizeof key, "%s, %.40s", inclinations[series], run->variant->label);
    hair_state(study, (struct statement){.key = key, .value = most, .unit = "deg"},
               "With %s the %s inclination is at most %.1f degrees%s, at %.2f s.",
               run->variant->label, inclinations[series], most, study->span,
               run->hair.frames[frame].t);
}

/* The thesis: "bien inférieure à celle des deux autres". */
static void state_inclination(struct hair_study *study, int series) {
    const char *name = inclinations[series];
    double least = INFINITY, widest = INFINITY;
    int falls = 1;
    for (int i = 0; i < study->count; i++) {
        const struct hair_run *run = &study->runs[i];
        state_radius(study, series, run);
        least = fmin(least, widest);
        falls &= run->series[series][hair_largest(run, series)] < widest;
        widest = run->series[series][hair_largest(run, series)];
    }
    char key[64];
    snprintf(key, sizeof key, "%s falls", name);
    hair_state(study, (struct statement){.key = key, .verdict = holds_if(falls)},
               "The %s inclination %s from each radius to the next.", name,
               falls ? "falls" : "does not fall");
    hair_state(study,
               (struct statement){.key = name,
                                  .by = THESIS,
                                  .verdict = holds_if(least - widest > visible),
                                  .value = least - widest,
                                  .unit = "deg"},
               "The widest wisps have far the least %s inclination: %.1f degrees, %.1f less than "
               "the others (%.0f would be seen).",
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
    struct statement row = {.figure = "cost", .tables = "table", .by = THESIS, .unit = "1"};
    row.key = "contacts";
    row.verdict = holds_if(contacts);
    row.value = many - few;
    hair_state(study, row, "Wider wisps have more contacts: from %.1f to %.1f a frame.", few, many);
    row.key = "cost";
    row.verdict = holds_if(costs);
    row.value = ratio;
    hair_state(study, row,
               "Each radius costs more than the one before, beyond the spreads: the widest %.2f "
               "times the thinnest.",
               ratio);
}

static void state(struct hair_study *study) {
    state_inclination(study, LARGEST);
    state_inclination(study, MEAN);
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
    .question = "what does the radius of wisps do to motion and cost?",
    .thesis = "section 5.1",
    .place = 7,
    .quick_seconds = 8,
    .full_seconds = 30,
    .answers = 1u << ANSWERS_CHOICE,
    .plan = radii_plan,
    .tabulate = radii_tabulate,
};
