/* Does a body keep hair outside, and does its push stretch springs? A sphere that moves through 36
 * wisps (section 5.4 of the thesis). */
#include "hair_study.h"

#include <math.h>

enum { POINTS, SEGMENTS, STRAIN };

/* The variants: the sphere that pushes, and one that nothing feels. */
enum { PUSHING, PASSING };

static int measure(const struct hair_study *study, struct hair_run *run) {
    (void)study;
    for (int f = 0; f < run->hair.frame_count; f++) {
        const struct depth depth = hair_depth(&run->hair, f);
        run->series[POINTS][f] = 1e3 * depth.points;
        run->series[SEGMENTS][f] = 1e3 * depth.segments;
        run->series[STRAIN][f] = 100 * hair_strain(&run->hair, f);
    }
    return 0;
}

/* No sample comes nearer to its node than a thousandth of its rest length (src/wisp/body.c), and a
 * node lies just above the surface: so deep a sample may be, mm. */
static double sample_margin(const struct scene *scene) {
    double radius = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        radius = fmax(radius, scene->wisps[i].radius);
    return 1e3 * 1e-3 * radius;
}

static double body_contacts(const struct hair_run *run) {
    return run_number(&run->files, "counters.body_contacts");
}

static double largest(const struct hair_run *run, int series) {
    return run->series[series][hair_largest(run, series)];
}

static void state_touch(struct hair_study *study, const struct hair_run *run) {
    const double contacts = body_contacts(run);
    const struct statement row =
        our_row(NULL, NULL, contacts > 0 ? HOLDS : NOT_REACHED, contacts, "1", "touched");
    if (contacts > 0)
        hair_claim(study, row, "The body puts a node or a sample outside %.0f times.", contacts);
    else
        hair_claim(study, row, "The body never pushes hair, which shows nothing.");
}

static void state_depths(struct hair_study *study, const struct hair_run *run) {
    const int segments = hair_largest(run, SEGMENTS), pushed = body_contacts(run) > 0;
    const double inside = run_number(&run->files, "counters.nodes_left_inside"),
                 points = largest(run, POINTS), margin = sample_margin(run->hair.scene);
    hair_claim(study,
               our_row(NULL, NULL, pushed ? holds_if(inside == 0) : NOT_REACHED, inside, "1",
                       "nodes left inside"),
               "After the ticks %.0f nodes are still inside.", inside);
    hair_claim(study,
               our_row(NULL, NULL,
                       pushed || points > margin ? holds_if(points <= margin) : NOT_REACHED, points,
                       "mm", "deepest point"),
               "At the frames nodes and samples are at most %.2g mm inside; a sample whose node is "
               "at the surface may be %.2g mm inside.",
               points, margin);
    hair_state(
        study,
        (struct statement){.key = "deepest segment", .value = largest(run, SEGMENTS), .unit = "mm"},
        "The straight lines between nodes cut into the body by at most %.2g mm, at %.2f s.",
        largest(run, SEGMENTS), run->hair.frames[segments].t);
}

/* A claim that a push does no harm: the control is what it is compared with. */
static void state_strain(struct hair_study *study, const struct hair_run *run,
                         const struct hair_run *control) {
    const int frame = hair_largest(run, STRAIN);
    const double most = largest(run, STRAIN), without = largest(control, STRAIN);
    hair_state(study,
               thesis_row(NULL, NULL,
                          body_contacts(run) > 0 ? holds_if(most - without < 1) : NOT_REACHED,
                          most - without, "%", "strain"),
               "The push lengthens no spring: the largest strain is %.2f %%, at %.2f s, against "
               "%.2f %% where nothing feels the body, and less than 1 %% more does not count.",
               most, run->hair.frames[frame].t, without);
}

static void state(struct hair_study *study) {
    const struct hair_run *run = &study->runs[PUSHING];
    state_touch(study, run);
    state_depths(study, run);
    state_strain(study, run, &study->runs[PASSING]);
}

static const struct hair_question question = {
    .scene = "sphere",
    .needs = {"body", "contacts"},
    .variants = {[PUSHING] = {.label = "sphere", .thesis = 21.6},
                 [PASSING] = {.label = "no collision", .sets = {"contacts.collision_rate=0"}}},
    .main = PUSHING,
    .control = PASSING,
    .without = "where nothing feels the body",
    .quick = 2, /* it reaches the hair at 1.2 s */
    .pictures = {50, 75, 100, 125, 150, 200},
    .large = 112,
    .columns = 3,
    .series = {{"deepest_point", "mm", "largest depth of a node or sample in the body"},
               {"deepest_segment", "mm", "largest depth of a point of a segment in it"},
               {"strain", "%", "largest |L/l - 1| of a stretch segment"}},
    .measure = measure,
    .state = state,
};

const struct experiment sphere_experiment = {
    .name = "sphere",
    .question = "does a moving body keep hair outside without stretching it?",
    .thesis = "section 5.4",
    .place = 10,
    .headline = "choice",
    .quick_seconds = 3,
    .full_seconds = 10,
    HAIR_EXPERIMENT(&question),
};
