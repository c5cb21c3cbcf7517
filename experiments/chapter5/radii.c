/* What does the radius of wisps do to their motion and to its cost? Nine wisps in irregular wind
 * (section 5.1 of the thesis): wider ones hold each other back. */
#include "hair_study.h"

#include <math.h>

enum { LARGEST, MEAN };

static int measure(const struct hair_study *study, struct hair_run *run) {
    (void)study;
    for (int f = 0; f < run->hair.frame_count; f++) {
        const struct inclination inclination = hair_inclination(&run->hair, f);
        run->series[LARGEST][f] = inclination.largest * 180 / M_PI;
        run->series[MEAN][f] = inclination.mean * 180 / M_PI;
    }
    return 0;
}

/* The variants: three radii, and the largest without contact. A radius alone changes nothing: the
 * envelope's springs feel by how much a sample is off it, whatever it is. */
enum { RADII = 3, FREE = RADII };

/* A tip then moves by a twentieth of a wisp: less is hardly seen. */
static const double visible = 3; /* degrees */

static const char *const inclinations[] = {[LARGEST] = "largest", [MEAN] = "mean"};

static double most_inclined(const struct hair_study *study, int series, int variant) {
    const struct hair_run *run = &study->runs[variant];
    return run->series[series][hair_largest(run, series)];
}

static void state_radius(struct hair_study *study, int series, const struct hair_run *run) {
    const int frame = hair_largest(run, series);
    const double most = run->series[series][frame];
    hair_state(study,
               our_row(NULL, NULL, HOLDS, most, "deg", "%s, %.40s", inclinations[series],
                       run->variant->label),
               "The %s inclination of the run '%s' is at most %.1f degrees, at %.2f s.",
               inclinations[series], run->variant->label, most, run->hair.frames[frame].t);
}

/* Whether wisps of some radius touch at all. */
static int wisps_meet(const struct hair_study *study) {
    double contacts = 0;
    for (int i = 0; i < RADII; i++)
        contacts += hair_contacts(&study->runs[i]);
    return contacts > 0;
}

/* The thesis: "l'inclinaison maximale à la dernière rangée est bien inférieure à celle des deux
 * autres". Of the mean it says nothing. */
static void state_inclination(struct hair_study *study, int series) {
    const char *name = inclinations[series];
    double least = INFINITY, widest = INFINITY;
    int falls = 1;
    for (int i = 0; i < RADII; i++) {
        least = fmin(least, widest);
        falls &= most_inclined(study, series, i) < widest;
        widest = most_inclined(study, series, i);
    }
    for (int i = 0; i < study->count; i++)
        state_radius(study, series, &study->runs[i]);
    const int met = wisps_meet(study);
    hair_claim(
        study,
        our_row(NULL, NULL, met ? holds_if(falls) : NOT_REACHED, NAN, NULL, "%s falls", name),
        met ? "The %s inclination %s from each radius to the next."
            : "Nothing holds the wisps back, for none touches another: the %s inclination %s from "
              "each radius to the next.",
        name, falls ? "falls" : "does not fall");
    const int far = least - widest > visible;
    struct statement row =
        our_row(NULL, NULL, met ? holds_if(far) : NOT_REACHED, least - widest, "deg", "%s", name);
    row.by = series == LARGEST ? THESIS : OURS;
    hair_claim(
        study, row,
        series == LARGEST
            ? "The widest wisps lean far less than the others: their %s inclination is at most "
              "%.1f degrees, %.1f degrees less than that of the others, and %.0f would be seen."
            : "The greatest %s inclination of the widest wisps is %.1f degrees, %.1f degrees less "
              "than that of the others, and %.0f would be seen.",
        name, widest, least - widest, visible);
}

static void state_cost(struct hair_study *study) {
    int rises = 1;
    for (int i = 1; i < RADII; i++)
        rises &=
            hair_contacts_per_frame(&study->runs[i]) > hair_contacts_per_frame(&study->runs[i - 1]);
    const double few = hair_contacts_per_frame(&study->runs[0]),
                 many = hair_contacts_per_frame(&study->runs[RADII - 1]);
    hair_claim(study,
               thesis_row("cost", "table", wisps_meet(study) ? holds_if(rises) : NOT_REACHED,
                          many - few, "1", "contacts"),
               "Wider wisps cost more because they have more contacts: these rise from %.1f to "
               "%.1f a frame.",
               few, many);
}

static void state(struct hair_study *study) {
    state_inclination(study, LARGEST);
    state_inclination(study, MEAN);
    state_cost(study);
}

static const struct hair_question question = {
    .scene = "radii",
    .needs = {"envelope", "contacts"},
    .variants = {{.label = "radius 1 cm", .sets = {"envelope.radius=0.01"}, .thesis = 3.92},
                 {.label = "radius 2 cm", .sets = {"envelope.radius=0.02"}, .thesis = 4.71},
                 {.label = "radius 3 cm", .sets = {"envelope.radius=0.03"}, .thesis = 5.14},
                 [FREE] = {.label = "3 cm, no contact",
                           .sets = {"envelope.radius=0.03", "contacts.interpenetration=false",
                                    "contacts.collision=false"}}},
    .main = RADII - 1,
    .control = FREE,
    .without = "without contact",
    /* As in the thesis, those where the wisps are most strongly inclined. */
    .pictures = {1, 45, 95},
    .large = 70,
    .columns = 3,
    .width = 420,
    .height = 320,
    .series = {{"largest_inclination", "deg", "largest inclination of a wisp against the vertical"},
               {"mean_inclination", "deg", "mean inclination of the wisps against the vertical"}},
    .measure = measure,
    .state = state,
};

const struct experiment radii_experiment = {
    .name = "radii",
    .question = "what does the radius of wisps do to motion and cost?",
    .thesis = "section 5.1",
    .place = 7,
    .headline = "largest",
    .quick_seconds = 8,
    .full_seconds = 12,
    HAIR_EXPERIMENT(&question),
};
