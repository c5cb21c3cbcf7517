/* Does a body keep hair outside, and does its push stretch springs? A sphere that moves through 36
 * wisps (section 5.4 of the thesis). */
#include "hair_study.h"

#include <math.h>

enum { POINTS, SEGMENTS, STRAIN };

static int measure(struct hair *hair, double *const *series) {
    for (int f = 0; f < hair->frame_count; f++) {
        const struct depth depth = hair_depth(hair, f);
        series[POINTS][f] = 1e3 * depth.points;
        series[SEGMENTS][f] = 1e3 * depth.segments;
        series[STRAIN][f] = 100 * hair_strain(hair, f);
    }
    return 0;
}

/* No sample comes nearer to its node than a thousandth of its rest length (src/body.c), and a
 * node lies just above the surface: so deep a sample may be, mm. */
static double sample_margin(const struct scene *scene) {
    double radius = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        radius = fmax(radius, scene->wisps[i].radius);
    return 1e3 * 1e-3 * radius;
}

static void state_depths(struct hair_study *study, const struct hair_run *run) {
    const int segments = hair_largest(run, SEGMENTS);
    const double inside = run_number(&run->files, "counters.nodes_left_inside"),
                 points = run->series[POINTS][hair_largest(run, POINTS)],
                 deepest = run->series[SEGMENTS][segments], margin = sample_margin(run->hair.scene);
    hair_state(study,
               (struct statement){.key = "nodes left inside",
                                  .verdict = holds_if(inside == 0),
                                  .value = inside,
                                  .unit = "1"},
               "After a tick %.0f nodes are still inside%s.", inside, study->span);
    hair_state(study,
               (struct statement){.key = "deepest point",
                                  .verdict = holds_if(points <= margin),
                                  .value = points,
                                  .unit = "mm"},
               "At the frames nodes and samples are at most %.2g mm inside (%.2g mm are allowed: a "
               "sample whose node is at the surface).",
               points, margin);
    hair_state(study, (struct statement){.key = "deepest segment", .value = deepest, .unit = "mm"},
               "The straight lines between nodes cut into it by at most %.2g mm, at %.2f s.",
               deepest, run->hair.frames[segments].t);
}

static void state(struct hair_study *study) {
    const struct hair_run *run = &study->runs[0];
    const int strain = hair_largest(run, STRAIN);
    const double contacts = run_number(&run->files, "counters.body_contacts"),
                 most = run->series[STRAIN][strain];
    const struct statement touched = {.key = "touched",
                                      .verdict = hair_seen(study, contacts > 0),
                                      .value = contacts,
                                      .unit = "1"};
    if (contacts == 0) {
        hair_state(study, touched, "The hair does not meet the body%s, which shows nothing.",
                   study->span);
        return;
    }
    hair_state(study, touched,
               "The hair meets the body%s: %.0f times a node or sample is put outside.",
               study->span, contacts);
    state_depths(study, run);
    hair_state(study,
               (struct statement){.key = "strain",
                                  .by = THESIS,
                                  .verdict = holds_if(most < 1),
                                  .value = most,
                                  .unit = "%"},
               "The push lengthens no spring: at most %.2f %%, at %.2f s (at the start %.2f %%; "
               "stable runs without bodies stay below 1 %%).",
               most, run->hair.frames[strain].t, run->series[STRAIN][0]);
}

static const struct hair_question question = {
    .scene = "sphere",
    .variants = {{.label = "sphere", .thesis = 21.6, .pictures = {50, 75, 100, 125, 150, 200}}},
    .columns = 3,
    .azimuth = 15,
    .elevation = 12,
    .series = {"deepest_point", "deepest_segment", "strain"},
    .measure = measure,
    .state = state,
};

static int sphere_plan(struct plan *plan) {
    return hair_plan(plan, &question);
}

static int sphere_tabulate(struct plan *plan, const char *folder) {
    return hair_tabulate(plan, folder, &question);
}

const struct experiment sphere_experiment = {
    .name = "sphere",
    .question = "does a moving body keep hair outside without stretching it?",
    .thesis = "section 5.4",
    .place = 10,
    .quick_seconds = 3,
    .full_seconds = 30,
    .answers = 1u << ANSWERS_CHOICE,
    .plan = sphere_plan,
    .tabulate = sphere_tabulate,
};
