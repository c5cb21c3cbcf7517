/* What does adaptive subdivision add to the motion, and what does it cost? Two wisps that
 * swing into each other, with and without it (section 5.5 of the thesis). */
#include "hair_study.h"

#include <math.h>

enum { WISPS, APART, STRAIN };

/* The variants. */
enum { WHOLE, SPLIT };

/* The largest distance of a node from the same one of the wisp that it was split off from, m. */
static double twins_apart(const struct hair *hair, int frame) {
    double largest = 0;
    for (int w = hair->scene->wisp_count; w < hair->frames[frame].wisps; w++) {
        const int twin = hair->states->parent[w];
        for (int i = 2; i < hair_nodes(hair, frame, w); i++)
            largest = fmax(largest, square_distance(hair_node(hair, frame, w, i),
                                                    hair_node(hair, frame, twin, i)));
    }
    return sqrt(largest);
}

static int measure(const struct hair_study *study, struct hair_run *run) {
    (void)study;
    for (int f = 0; f < run->hair.frame_count; f++) {
        run->series[WISPS][f] = run->hair.frames[f].wisps;
        run->series[APART][f] = 1e3 * twins_apart(&run->hair, f);
        run->series[STRAIN][f] = 100 * hair_strain(&run->hair, f);
    }
    return 0;
}

/* The first frame with more wisps, or the number of frames. */
static int first_split(const struct hair_run *run) {
    int frame = 0;
    while (frame < run->hair.frame_count && run->series[WISPS][frame] == run->series[WISPS][0])
        frame++;
    return frame;
}

static int has_split(const struct hair_run *run) {
    return first_split(run) < run->hair.frame_count;
}

static void state_count(struct hair_study *study, const struct hair_run *whole,
                        const struct hair_run *split) {
    const double first = split->series[WISPS][0],
                 end = split->series[WISPS][split->hair.frame_count - 1],
                 without = whole->series[WISPS][whole->hair.frame_count - 1];
    hair_state(
        study,
        thesis_row(NULL, NULL, holds_if(without == whole->series[WISPS][0]), without, "1",
                   "wisps, without"),
        "Without subdivision wisps stay whole: there are %.0f at the start and %.0f at the end.",
        whole->series[WISPS][0], without);
    hair_claim(
        study, thesis_row(NULL, NULL, holds_if(end == 2 * first), end, "1", "wisps"),
        "With subdivision the wisps double: there are %.0f at the start and %.0f at the end.",
        first, end);
}

/* Before the first split both runs are the same. */
static void state_split(struct hair_study *study, const struct hair_run *whole,
                        const struct hair_run *split) {
    const int divided = first_split(split);
    int same = 0;
    while (same < divided && hair_same(&whole->hair, &split->hair, same))
        same++;
    hair_claim(study,
               our_row(NULL, NULL, has_split(split) ? holds_if(same == divided) : NOT_REACHED, same,
                       "frame", "the same until"),
               "Of the %d frames before the first split %d are the same in both runs, bit for bit.",
               divided, same);
    if (has_split(split)) {
        const double number = split->hair.frames[divided].t * 30 + 1;
        hair_state(study, (struct statement){.key = "split", .value = number, .unit = "frame"},
                   "The first split shows at frame %.0f, and at frame 8 in the thesis.", number);
    } else {
        hair_state(study, (struct statement){.key = "split", .verdict = NOT_REACHED},
                   "No wisp splits.");
    }
}

/* The thesis: "l'animation gagne alors en complexité visuelle". Twins that stay within a wisp's
 * radius of each other show nothing new. */
static void state_complexity(struct hair_study *study, const struct hair_run *split) {
    const int frame = hair_largest(split, APART);
    const double most = split->series[APART][frame],
                 radius = 1e3 * split->hair.scene->wisps[0].radius;
    const struct statement row =
        thesis_row(NULL, NULL, has_split(split) ? holds_if(most > radius) : NOT_REACHED, most, "mm",
                   "complexity");
    if (has_split(split))
        hair_claim(study, row,
                   "The animation gains in visual complexity: twins are up to %.1f mm apart, at "
                   "%.2f s, and a wisp's radius is %.0f mm.",
                   most, split->hair.frames[frame].t, radius);
    else
        hair_claim(study, row, "The animation gains in visual complexity: no wisp splits.");
}

static double evaluations(const struct hair_run *run) {
    return run_number(&run->files, "counters.force_evaluations");
}

/* The thesis puts its 1.66 s against 0.88 down to the number of wisps. */
static void state_cost(struct hair_study *study, const struct hair_run *whole,
                       const struct hair_run *split) {
    const double theirs = split->variant->thesis / whole->variant->thesis,
                 ours = evaluations(split) / evaluations(whole);
    hair_claim(
        study,
        thesis_row("cost", "table",
                   has_split(split) ? holds_if(fabs(ours / theirs - 1) < 0.1) : NOT_REACHED, ours,
                   "1", "evaluations"),
        "From the split on wisps cost as much more as they are more: the forces of a wisp are "
        "evaluated %.2f times as often, and in the thesis the time was %.2f times as long.",
        ours, theirs);
}

static void state(struct hair_study *study) {
    const struct hair_run *whole = &study->runs[WHOLE], *split = &study->runs[SPLIT];
    state_count(study, whole, split);
    state_split(study, whole, split);
    state_complexity(study, split);
    state_cost(study, whole, split);
}

static const struct hair_question question = {
    .scene = "subdivision",
    .needs = {"subdivision"},
    .variants = {[WHOLE] = {.label = "without",
                            .sets = {"subdivision.ratio=1e-6"}, /* the test is made in vain */
                            .thesis = 0.88},
                 [SPLIT] = {.label = "with", .thesis = 1.66}},
    .main = SPLIT,
    .control = WHOLE,
    .without = "without subdivision",
    /* 20, when twins are farthest apart, is ours; the others are the thesis's. */
    .pictures = {1, 6, 8, 10, 20},
    .large = 14,
    .columns = 5,
    .width = 300,
    .height = 330,
    .series = {{"wisps", "1", "number of wisps"},
               {"twins_apart", "mm",
                "largest distance of a node from that of the wisp it split off from"},
               {"strain", "%", "largest |L/l - 1| of a stretch segment"}},
    .measure = measure,
    .state = state,
};

const struct experiment subdivision_experiment = {
    .name = "subdivision",
    .question = "what does adaptive subdivision add, and what does it cost?",
    .thesis = "section 5.5",
    .place = 11,
    .headline = "choice",
    .quick_seconds = 2,
    .full_seconds = 5,
    HAIR_EXPERIMENT(&question),
};
