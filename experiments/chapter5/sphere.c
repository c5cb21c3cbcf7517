/* Does a body keep hair outside, and does its push stretch springs? A sphere that moves through 36
 * wisps (section 5.4 of the thesis). */
#include "experiments/captions.h"
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

static void state(struct hair_study *study) {
    const struct hair_run *run = &study->runs[0];
    const int points = hair_largest(run, POINTS), segments = hair_largest(run, SEGMENTS),
              strain = hair_largest(run, STRAIN);
    const double inside = run_number(&run->files, "counters.nodes_left_inside"),
                 contacts = run_number(&run->files, "counters.body_contacts"),
                 hanging = run->series[STRAIN][0], most = run->series[STRAIN][strain],
                 margin = sample_margin(run->hair.scene);
    hair_state(study, "touched", contacts, "contacts", contacts > 0 ? HOLDS : HOLDS_NOT,
               "the hair meets the body: %.0f times a node or sample was put outside", contacts);
    hair_state(study, "nodes left inside", inside, "nodes", inside == 0 ? HOLDS : HOLDS_NOT,
               "after a tick %.0f nodes were still inside", inside);
    hair_state(study, "deepest point", run->series[POINTS][points], "mm",
               run->series[POINTS][points] <= margin ? HOLDS : HOLDS_NOT,
               "at the frames no node or sample is inside: %.2g mm at most (a sample may be, by "
               "%.2g mm, where its node is at the surface)",
               run->series[POINTS][points], margin);
    hair_state(study, "deepest segment", run->series[SEGMENTS][segments], "mm", NO_CLAIM,
               "the straight lines between nodes cut into it by %.2g mm at most, at %.2f s",
               run->series[SEGMENTS][segments], run->hair.frames[segments].t);
    hair_state(study, "strain", most, "%", most < 1 ? HOLDS : HOLDS_NOT,
               "no spring is stretched by the push: %.2f %% at most, at %.2f s (%.2f %% at the "
               "start; stable runs without bodies stay below 1 %%)",
               most, run->hair.frames[strain].t, hanging);
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
    .question = "thesis 5.4: does a moving body keep hair outside without stretching it?",
    .plan = sphere_plan,
    .tabulate = sphere_tabulate,
    .caption = caption_hair,
};
