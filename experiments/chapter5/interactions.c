/* What do wisps do to each other when they meet? Two wisps that gravity swings into each other
 * (section 5.2 of the thesis), with each response alone, both and none. */
#include "crossing.h"
#include "hair_study.h"
#include "misses.h"

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
    char sentence[160];
    const enum claim_verdict verdict =
        !wisps_meet(run) ? NOT_REACHED : holds_if(is_free ? count > 0 : count == 0);
    struct statement row =
        our_row(NULL, NULL, verdict, count, "1", "crossings, %.50s", run->variant->label);
    row.by = is_free ? THESIS : OURS;
    if (!wisps_meet(run))
        snprintf(sentence, sizeof sentence, "%s",
                 is_free ? "the wisps pass through each other: they never meet"
                         : "the wisps never meet");
    else if (count > 0)
        snprintf(
            sentence, sizeof sentence,
            "the wisps pass through each other: they cross %.0f time%s (net %.0f), first at %.2f s",
            count, count > 1 ? "s" : "", net, run->hair.frames[first].t);
    else if (is_free)
        snprintf(sentence, sizeof sentence,
                 "the wisps pass through each other: none crosses another");
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
        for (int i = 2; i < hair_nodes(hair, frame, w); i++)
            largest = fmax(largest, square_distance(hair_node(hair, frame, w, i),
                                                    hair_node(other, frame, w, i)));
    return sqrt(largest);
}

/* How far a response takes the wisps from where they would be without any: by more than their
 * radius, and the pictures are others. */
static void state_influence(struct hair_study *study, int variant) {
    const struct hair_run *run = &study->runs[variant];
    const double radius = 1e3 * run->hair.scene->wisps[0].radius;
    double most = 0, t = 0;
    for (int f = 0; f < run->hair.frame_count; f++) {
        const double here = 1e3 * farthest(&run->hair, &study->runs[NONE].hair, f);
        t = here > most ? run->hair.frames[f].t : t;
        most = here > most ? here : most;
    }
    hair_claim(study,
               thesis_row(NULL, NULL, wisps_meet(run) ? holds_if(most > radius) : NOT_REACHED, most,
                          "mm", "influence, %.50s", run->variant->label),
               "%s the wisps move otherwise than alone: nodes are up to %.1f mm from where they "
               "are without interaction, at %.2f s, and a wisp's radius is %.0f mm.",
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
               thesis_row("cost", "table", met ? holds_if(ordered) : NOT_REACHED, contacts[ALL],
                          "1", "contacts"),
               "There are the more contacts the more a frame took in the thesis (without "
               "interaction, with collision, with interpenetration, with both): there are %.1f, "
               "%.1f, %.1f and %.1f a frame.",
               contacts[NONE], contacts[COLLIDING], contacts[RUBBING], contacts[ALL]);
}

static void state(struct hair_study *study) {
    for (int i = 0; i < study->count; i++)
        state_crossings(study, i);
    for (int i = 1; i < study->count; i++)
        state_influence(study, i);
    state_cost(study);
}

/* --- figure 4.13: crossings that no point shows --- */

/* Sections at rest that lie any way, of so many diameters, and so many crossings of each. */
static const double slenderness[] = {0.5, 1, 2, 4, 8};
enum { SLENDERNESSES = sizeof slenderness / sizeof *slenderness, CROSSINGS_EACH = 3000 };

struct all_misses {
    struct misses random[SLENDERNESSES], sections, wisps; /* the last two at frames of a run */
    double own;                                           /* the scene's sections, diameters */
};

static double percent(const struct misses *misses) {
    return misses->crossings > 0 ? 100. * misses->missed / misses->crossings : 0;
}

/* Fewer frames where wisps are many. */
static int find_misses(struct hair *hair, struct all_misses *all) {
    const int wisps = hair->frames[0].wisps, most = 10 + 4000 / (wisps * wisps);
    const int step = (hair->frame_count + most - 1) / most;
    struct brute *brute = brute_create();
    int code = brute ? 0 : -1;
    for (int i = 0; i < SLENDERNESSES && !code; i++)
        code = random_misses(brute, slenderness[i], CROSSINGS_EACH, &all->random[i]);
    all->own = wisp_spacing(&hair->scene->wisps[0]) / (2 * hair->scene->wisps[0].radius);
    for (int f = 0; f < hair->frame_count && !code; f += step)
        hair_misses(brute, hair, f, &all->sections, &all->wisps);
    brute_free(brute);
    return code;
}

#define MISSED_COLUMNS(X)                                                                \
    X("of", "-", "what crosses", "%s", of)                                               \
    X("slenderness", "1", "length of a section over its diameter", "%.17g", diameters)   \
    X("crossings", "1", "crossings of volumes, by brute force", "%d", misses->crossings) \
    X("missed", "1", "crossings that no point shows", "%d", misses->missed)

static void write_missed(FILE *stream, const char *of, double diameters,
                         const struct misses *misses) {
    WRITE_ROW(stream, MISSED_COLUMNS);
}

static int write_misses(struct plan *plan, const struct all_misses *all) {
    FILE *stream = output_table(&plan->output, "misses",
                                "sections whose volumes cross, by brute force, and how many of "
                                "these no point shows (the thesis, figure 4.13)",
                                plan->subjects[0].scene, COLUMNS(MISSED_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < SLENDERNESSES; i++)
        write_missed(stream, "sections that lie any way", slenderness[i], &all->random[i]);
    write_missed(stream, "sections of the scene", all->own, &all->sections);
    write_missed(stream, "wisps of the scene", all->own, &all->wisps);
    return 0;
}

/* Sections that are shorter than thick are the control. */
static void state_slenderness(struct hair_study *study, const struct all_misses *all) {
    int grows = all->random[0].missed > all->random[1].missed;
    for (int i = 2; i < SLENDERNESSES; i++)
        grows &= all->random[i].missed > all->random[i - 1].missed;
    hair_state(study,
               thesis_row("series", "misses", holds_if(grows),
                          percent(&all->random[SLENDERNESSES - 1]), "%", "missed crossings"),
               "The longer sections are over their thickness, the more of their crossings no point "
               "shows (figure 4.13): of %d crossings of sections that lie any way none shows %.1f "
               "%% at a length of 1 diameter, %.1f %% at 2, %.1f %% at 4 and %.1f %% at 8; a "
               "length near 1 is best, for at %g it is %.1f %%.",
               CROSSINGS_EACH, percent(&all->random[1]), percent(&all->random[2]),
               percent(&all->random[3]), percent(&all->random[4]), slenderness[0],
               percent(&all->random[0]));
}

/* Sections that are missed have neighbours, which may be seen. */
static void state_own(struct hair_study *study, const struct all_misses *all) {
    struct statement row =
        thesis_row("series", "misses", HOLDS, percent(&all->wisps), "%", "missed here");
    row.verdict = all->wisps.crossings > 0 ? holds_if(percent(&all->wisps) <= 10) : NOT_REACHED;
    hair_state(study, row,
               "Sections about as long as thick are enough: where they are %.2g diameters long, no "
               "point shows %d of %d crossings of sections, and of %d times that two wisps cross "
               "at a frame none shows %d; less than a tenth is enough.",
               all->own, all->sections.missed, all->sections.crossings, all->wisps.crossings,
               all->wisps.missed);
}

static int tables(struct plan *plan, struct hair_study *study) {
    struct all_misses all = {.own = 0};
    if (find_misses(&study->runs[NONE].hair, &all))
        return fail_with(plan->reason, "out of memory");
    state_slenderness(study, &all);
    state_own(study, &all);
    return write_misses(plan, &all);
}

/* The thesis tells the two kinds of meeting apart from its third animation on; in the second all
 * wisps that meet rub against each other: the threshold is 1. */
#define NO_INTERPENETRATION "contacts.interpenetration=false"
#define NO_COLLISION        "contacts.collision=false"
static const struct hair_question question = {
    .scene = "interactions",
    .needs = {"contacts"},
    .variants = {{.label = "none", .sets = {NO_INTERPENETRATION, NO_COLLISION}, .thesis = 0.76},
                 {.label = "interpenetration",
                  .sets = {NO_COLLISION, "contacts.threshold=1.0"},
                  .thesis = 0.86},
                 {.label = "collision", .sets = {NO_INTERPENETRATION}, .thesis = 0.84},
                 {.label = "all", .thesis = 0.91}},
    .main = ALL,
    .control = NONE,
    .without = "without interaction",
    /* 16, when the wisps have met, is ours; the others are the thesis's. */
    .pictures = {1, 12, 16, 24, 64},
    .large = 20,
    .columns = 5,
    .quick = 0.8, /* they meet at 0.4 s */
    .width = 300,
    .height = 330,
    .watch_rate = 300,
    .series = {{"crossings", "1",
                "how often segments of two wisps have passed through each other so far"},
               {"overlap", "1",
                "how often a node or sample of a wisp is in a section of another one"},
               {"net_crossings", "1",
                "such passages in one direction less those in the other, by pairs"}},
    .measure = measure,
    .state = state,
    .tables = tables,
};

const struct experiment interactions_experiment = {
    .name = "interactions",
    .question = "what do wisps do to each other when they meet?",
    .thesis = "section 5.2",
    .place = 8,
    .headline = "choice",
    .quick_seconds = 3,
    .full_seconds = 6,
    HAIR_EXPERIMENT(&question),
};
