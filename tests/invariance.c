/* What changes the numbers of a scene and not what happens in it: runs of a scene and of the same
 * scene moved, turned, mirrored, scaled, seen at another rate, or taken for another frame. */
#include "base/vector.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- where a scene stands --- */

/* One wisp let go from the horizontal, which stands or whose head stands at (by, -by, by). */
static struct scene *moved_swing(double by, int head, int samples) {
    struct surroundings around = {.gravity = {0, -9.81, 0}};
    struct scene *scene = lab_load("swing-envelope", NULL, 0);
    struct wisp wisp = scene->wisps[0];
    const double place[3] = {by, -by, by};
    wisp.samples = samples;
    around.head.knots = head;
    memcpy(head ? around.head.position[0] : wisp.root, place, sizeof place);
    scene = lab_scene(&wisp, 1, &around);
    scene->duration = 0.1;
    scene->frame_rate = 30;
    return scene;
}

/* The largest distance of a run's nodes from those of a run of the scene at 0. */
static double moved_by(const struct lab_run *run, const struct lab_run *still, double by) {
    double most = 0;
    cr_assert(run->result.outcome == FINISHED && run->frames == still->frames, "%s, %d frames: %s",
              outcome_name(run->result.outcome), run->frames, run->result.reason);
    for (int i = 0; i < run->frames * run->rows; i++)
        for (int k = 0; k < 3; k++)
            most = fmax(most, fabs(run->row[i * run->columns + 2 + k] - (k == 1 ? -by : by) -
                                   still->row[i * still->columns + 2 + k]));
    return most;
}

static const double places[] = {0, 0.37, 100, 1e5}; /* m */
enum { PLACES = sizeof places / sizeof *places };

/* Its steps, and those of every method with error control, come from the error of the unknowns: a
 * relative tolerance must not be that of the distance from an origin, nor a rounding that of a
 * hundred kilometres. */
Test(invariance, the_reference_takes_as_many_steps_anywhere) {
    for (int head = 0; head < 2; head++) {
        struct lab_run runs[PLACES];
        const struct run_request request = {.stepper = "reference"};
        for (int i = 0; i < PLACES; i++) {
            struct scene *scene = moved_swing(places[i], head, 0);
            lab_run(scene, &request, &runs[i]);
            const double apart = moved_by(&runs[i], &runs[0], places[i]);
            cr_log_info("at %g m: %lld steps, %g m apart", places[i], runs[i].result.counters.steps,
                        apart);
            cr_assert_eq(runs[i].result.counters.steps, runs[0].result.counters.steps,
                         "%lld steps at %g m, and %lld at 0", runs[i].result.counters.steps,
                         places[i], runs[0].result.counters.steps);
            cr_assert_leq(apart, 1e-9, "%g m apart at %g m", apart, places[i]);
        }
    }
}

Test(invariance, no_method_knows_where_a_scene_stands) {
    for (int m = 0; stepper_methods[m]; m++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            struct lab_run still, run;
            struct run_request request = lab_request(stepper_methods[m], treatment);
            for (int i = 0; i < PLACES; i++) {
                struct scene *scene = moved_swing(places[i], 0, 4);
                lab_run(scene, &request, i ? &run : &still);
                const double apart = i ? moved_by(&run, &still, places[i]) : 0;
                cr_assert_leq(apart, 1e-9, "%s, %s: %g m apart at %g m", request.stepper,
                              request.treatment, apart, places[i]);
            }
        }
}

/* Bodies are met in space: at 100 m to 1e-14 m, and at 100 km rounding decides what touches. */
Test(invariance, bodies_are_met_as_well_far_away) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const struct run_request request = {.stepper = "rk4",
                                            .treatment = treatment_names[treatment]};
        struct lab_run still, run;
        for (int i = 0; places[i] < 1e5; i++) {
            struct scene *scene = moved_swing(places[i], 0, 4);
            struct body body = {
                .radii = {0.08, 0.09, 0.08}, .friction = 50, .elasticity = 0.1, .offset = 1e-4};
            const double centre[3] = {0.15, -0.1, 0.02};
            for (int k = 0; k < 3; k++)
                body.centre[k] = centre[k] + (k == 1 ? -places[i] : places[i]);
            scene->duration = 0.2;
            scene->bodies = malloc(sizeof body);
            cr_assert(scene->bodies, "no memory");
            scene->bodies[0] = body;
            scene->body_count = 1;
            lab_run(scene, &request, i ? &run : &still);
            cr_assert_gt((i ? &run : &still)->result.counters.body_contacts, 20,
                         "hardly anything touches");
            const double apart = i ? moved_by(&run, &still, places[i]) : 0;
            cr_assert_leq(apart, 1e-9, "%s: %g m apart at %g m", request.treatment, apart,
                          places[i]);
        }
    }
}

/* --- planes --- */

/* Two wisps swing in planes of their own, which symmetry keeps to the last bit; turned out of it by
 * a millionth they do nearly the same. (Explicit Euler lets what swings across a plane without
 * damping grow; with twice the nodes wisps that are planar end, and others overflow at 1.5 s.) */
Test(invariance, what_is_planar_by_luck_holds_without_it) {
    const struct run_request request = {.stepper = "euler", .step = 1 / 9000.};
    struct scene *planar = lab_load("viscosity", NULL, 0),
                 *turned = LAB_LOAD("viscosity", "wisps.[0].direction=[0.24, -1.0, 1.0e-6]");
    struct lab_run still, run;
    lab_run(planar, &request, &still);
    lab_run(turned, &request, &run);
    cr_assert_eq(still.result.outcome, FINISHED, "%s", still.result.reason);
    cr_assert_eq(run.result.outcome, FINISHED, "%s", run.result.reason);
    const double apart = lab_distance(&run, &still, 0, 0).largest;
    cr_log_info("%g m apart", apart);
    cr_assert_leq(apart, 2e-6, "%g m apart", apart);
}
