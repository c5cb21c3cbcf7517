/* Whole runs of wisps that touch bodies. */
#include "base/vector.h"
#include "body_oracle.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Nothing inside, no segment far from its length, in any frame. */
static void check_frames(const struct scene *scene, const struct lab_run *run,
                         const char *stepper) {
    double strain = 0, least = INFINITY;
    for (int f = 0; f < run->frames; f++)
        for (int i = 0; i < run->rows; i++) {
            const double *row = run->row + (f * run->rows + i) * run->columns, *p = row + 2;
            const struct wisp *wisp = &scene->wisps[(int)row[0]];
            for (int b = 0; b < scene->body_count && row[1] >= 2; b++) {
                double x[3];
                cr_assert(!twin_inside(&scene->bodies[b], run->t[f], p, x),
                          "%s: node %g of wisp %g is inside at %g s", stepper, row[1], row[0],
                          run->t[f]);
                least = fmin(least, vector_length(x) - scene->bodies[b].radii[0]);
            }
            if (row[1] > 0) {
                const double *q = p - run->columns;
                const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
                strain = fmax(strain, fabs(vector_length(d) / wisp_spacing(wisp) - 1));
            }
        }
    cr_log_info("%s: strain %g, %g m from the sphere, %lld contacts", stepper, strain, least,
                run->result.counters.body_contacts);
    cr_assert_lt(strain, 0.1, "%s: a strain of %g", stepper, strain);
    cr_assert(least < 0.01 && run->result.counters.body_contacts > 1000, "%s: no contact", stepper);
    cr_assert_eq(run->result.counters.nodes_left_inside, 0);
}

Test(body_runs, the_sphere_passes) {
    struct scene *scene = lab_load("sphere", NULL, 0);
    for (int i = 0; i < 2; i++) {
        const struct run_request request = {.stepper = i ? "euler" : "rk4"};
        struct lab_run run;
        lab_finish(scene, &request, &run);
        cr_assert_eq(run.frames, 219);
        check_frames(scene, &run, request.stepper);
    }
}

#define NEAR "body.[0].center=[-0.17, -0.24, 0.0]"
#define FOUR                                                                                    \
    "wisps=({ root=[-0.0625, 0.0, -0.0125]; direction=[0.0, -1.0, 0.0]; length=0.3; nodes=11; " \
    "         grid=[2, 2]; spacing=0.025; across=([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]); })"

Test(body_runs, the_sphere_passes_for_every_stepper_and_treatment) {
    struct scene *scene = LAB_LOAD("sphere", "duration=1.3", NEAR, FOUR);
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int m = 0; stepper_methods[m]; m++) {
            const struct run_request request = lab_request(stepper_methods[m], treatment);
            struct lab_run run;
            if (stepper_methods[m]->checked_by || is_tried_elsewhere(stepper_methods[m]) ||
                !is_taken(scene, &request))
                continue;
            lab_finish(scene, &request, &run);
            check_frames(scene, &run, request.stepper);
        }
}

static void check_same(const struct lab_run *a, const struct lab_run *b, int wisps, int reversed) {
    const int nodes = a->rows / wisps;
    cr_assert(a->frames == b->frames && a->rows == b->rows);
    for (int f = 0; f < a->frames; f++)
        for (int i = 0; i < a->rows; i++) {
            const int wisp = reversed ? wisps - 1 - i / nodes : i / nodes,
                      j = wisp * nodes + i % nodes;
            cr_assert_eq(memcmp(a->row + (f * a->rows + i) * a->columns + 1,
                                b->row + (f * b->rows + j) * b->columns + 1,
                                (size_t)(a->columns - 1) * sizeof(double)),
                         0, "frame %d, row %d differs", f, i);
        }
}

/* Same bits for any number of threads and any order of wisps; 3 x 3 wisps leave padding. */
Test(body_runs, threads_and_order_change_nothing) {
    static const char *const steppers[] = {"rk4", "cvode"};
    for (int m = 0; m < 2; m++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            struct scene *scene = LAB_LOAD("sphere", "duration=0.9", NEAR, "wisps.[0].grid=[3, 3]");
            struct run_request request = {.stepper = steppers[m],
                                          .treatment = treatment_names[treatment]};
            struct lab_run run[4];
            for (int threads = 1; threads <= 3; threads++) {
                request.threads = threads;
                lab_finish(scene, &request, &run[threads - 1]);
            }
            for (int i = 0; i < 4; i++) {
                const struct wisp wisp = scene->wisps[i];
                scene->wisps[i] = scene->wisps[8 - i];
                scene->wisps[8 - i] = wisp;
            }
            lab_finish(scene, &request, &run[3]);
            cr_assert_gt(run[0].result.counters.body_contacts, 50);
            for (int i = 1; i < 4; i++)
                check_same(&run[0], &run[i], 9, i == 3);
        }
}

/* A wisp swings down onto a ball at rest and bounces: a tick is the same map for all. */
#define BALL                                                                                     \
    "body=({ name=\"ball\"; center=[0.15, -0.2, 0.02]; radii=[0.06, 0.08, 0.07]; friction=20.0;" \
    "        elasticity=0.5; offset=1e-4; })"

Test(body_runs, steppers_agree_on_a_bounce) {
    static const char *const scenes[] = {"swing", "swing-envelope"};
    for (int i = 0; i < 2; i++)
        for (int treatment = 0; treatment < (i ? TREATMENTS : 1); treatment++) {
            struct scene *scene = LAB_LOAD(scenes[i], "duration=0.3", "run.strain_limit=0.5", BALL);
            const struct run_request fixed = {
                .stepper = "rk4", .treatment = treatment_names[treatment], .step = 1 / 24000.};
            const struct run_request tight = {.stepper = "cvode",
                                              .treatment = treatment_names[treatment],
                                              .rtol = 1e-11,
                                              .atol = 1e-13};
            struct lab_run a, b;
            lab_finish(scene, &fixed, &a);
            lab_finish(scene, &tight, &b);
            const struct lab_distance d = lab_distance(&a, &b, 1, 2);
            cr_log_info("%s, %s: %lld and %lld contacts, %g m apart", scenes[i], fixed.treatment,
                        a.result.counters.body_contacts, b.result.counters.body_contacts,
                        d.largest);
            cr_assert_gt(a.result.counters.body_contacts, 5);
            cr_assert_gt(b.result.counters.restarts, 1);
            cr_assert_eq(a.result.counters.body_contacts, b.result.counters.body_contacts);
            cr_assert_lt(d.largest, 1e-7, "%s, %s: %g m apart", scenes[i], fixed.treatment,
                         d.largest);
        }
}

/* How high above the floor a free node gets in each of some seconds, that falls 0.1 m onto it. Its
 * springs have next to no stiffness, and the floor is a ball of 1 km. */
static void bounce(const char *elasticity, int seconds, double *height) {
    const char *const body =
        printed("body=({ name=\"floor\"; center=[10.0, -1000.1, 0.0]; radii=[1e3, 1e3, 1e3];"
                "        friction=0.0; elasticity=%s; offset=0.0; })",
                elasticity);
    struct scene *scene =
        LAB_LOAD("swing", "frame_rate=300.0", "material.stretch_stiffness=1e-9",
                 "material.stretch_time=0.0", "material.bending=\"none\"", "material.drag_rate=0.0",
                 "wisps=({ root=[-10, 0, 0]; direction=[1, 0, 0]; length=20.0; nodes=3; })",
                 "run.step=1e-3", body);
    const struct run_request request = {.stepper = "rk4"};
    struct lab_run run;
    scene->duration = seconds;
    lab_finish(scene, &request, &run);
    for (int i = 0; i < seconds; i++)
        height[i] = 0;
    for (int f = 0; f < run.frames; f++) {
        const double y = run.row[(f * run.rows + 2) * run.columns + 3] + 0.1;
        const int second = (int)fmin(run.t[f], seconds - 1);
        height[second] = fmax(height[second], y);
        cr_assert_geq(y, -1e-12, "in the floor at %g s", run.t[f]);
    }
    cr_assert_gt(run.result.counters.body_contacts, seconds, "hardly a bounce");
}

/* Gravity's work inside the floor is none of the bounce's: energy never grows, and what loses some
 * at each bounce comes to rest. */
Test(body_runs, a_ball_that_bounces_never_gets_higher) {
    double height[10];
    bounce("1.0", 10, height);
    for (int i = 1; i < 10; i++)
        cr_assert(height[i] <= 0.1 + 1e-9 && height[i] > 0.05, "%g m in second %d", height[i], i);
    bounce("0.9", 10, height);
    for (int i = 1; i < 10; i++)
        cr_assert(height[i] < height[i - 1] + 1e-12, "%g m in second %d", height[i], i);
    cr_assert_lt(height[9], 1e-3, "it never comes to rest: %g m", height[9]);
}

/* Whether a body moves is said by the scene, not by its speed: one at 0 is one at next to 0. */
Test(body_runs, a_body_moves_where_its_entry_has_a_velocity) {
    static const char *const bodies[] = {"", "velocity=[0.0, 0.0, 0.0];",
                                         "velocity=[1e-12, 0.0, 0.0];"};
    struct lab_run run[3];
    const struct run_request request = {.stepper = "reference", .rtol = 1e-9, .atol = 1e-11};
    for (int i = 0; i < 3; i++) {
        const char *const body =
            printed("body=({ name=\"b\"; center=[0.05, -0.12, 0.02]; radii=[0.08, 0.09, 0.08];"
                    "        friction=50.0; elasticity=0.1; offset=1e-4; %s })",
                    bodies[i]);
        struct scene *scene =
            LAB_LOAD("swing", "duration=0.5", body, "wisps.[0].direction=[1.0, 0.0, 0.2]");
        cr_assert_eq(scene->bodies[0].moves, i > 0);
        lab_finish(scene, &request, &run[i]);
    }
    const double same = lab_distance(&run[1], &run[2], 1, 2).largest,
                 other = lab_distance(&run[0], &run[1], 1, 2).largest;
    cr_assert_lt(same, 1e-9, "at 0 and at 1e-12 m/s: %g m apart", same);
    cr_assert_gt(other, 1e-3, "the two rules are one: %g m apart", other);
    struct scene *scene = LAB_LOAD("swing", BALL,
                                   "head={ times=[0.0]; positions=([0, 0, 0]);"
                                   "       rotations=([0, 0, 0]); }");
    cr_assert(scene->bodies[0].moves, "a head that may move takes its bodies along");
}

/* A body that nobody touches changes no bit; without envelope and body there are no ticks. */
Test(body_runs, a_distant_body_changes_nothing) {
    static const char *const distant =
        "body=({ name=\"far\"; center=[5, 5, 5]; radii=[1, 1, 1]; friction=20; elasticity=0;"
        "        offset=1e-4; })";
    struct scene *without = LAB_LOAD("swing-envelope", "duration=0.2"),
                 *with = LAB_LOAD("swing-envelope", "duration=0.2", distant);
    const struct run_request request = {.stepper = "cvode"};
    struct lab_run a, b;
    lab_finish(without, &request, &a);
    lab_finish(with, &request, &b);
    check_same(&a, &b, 1, 0);
    cr_assert(b.result.counters.body_contacts == 0 &&
              a.result.counters.restarts == b.result.counters.restarts);
    without = lab_load("swing", NULL, 0);
    with = LAB_LOAD("swing", distant);
    struct model *plain = lab_model(without, WISP_GENERALISED, 1),
                 *ticking = lab_model(with, WISP_GENERALISED, 1);
    cr_assert(plain && ticking && plain->collision_rate == 0 && ticking->collision_rate == 300);
}

/* --- warnings --- */

/* One hair, and a body of this radius that moves like that. */
#define HAIR_AND_BODY                                                                       \
    "name = \"hair\"; duration = 0.5; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"    \
    "material = { }; wisps = ( { root = [0.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0];\n"   \
    "length = 0.3; nodes = 11; } );\n%s\n"                                                  \
    "body = ( { name = \"ball\"; center = [-1.0, -0.15, 0.0]; radii = [0.03, %s, 0.02];\n"  \
    "friction = 50.0; elasticity = 0.1; offset = 1.0e-4; velocity = [%s, 0.0, 0.0]; } );\n" \
    "run = { strain_limit = 9.0; };\n"

/* What passes between two ticks or between two nodes is said once, with the body's name, and is in
 * run.json; 12 m/s are 4 cm from tick to tick at 300 Hz, and half a segment is 15 mm. */
Test(body_runs, bodies_that_can_pass_unseen_are_warned_of) {
    static const char turning[] = "head = { times = [0.0, 0.1]; positions = ([0.0, 0.0, 0.0], [0.0,"
                                  "0.0, 0.0]); rotations = ([0.0, 0.0, 0.0], [0.0, 0.82, 0.0]); };";
    static const struct {
        const char *head, *radius, *velocity;
        const char *said; /* NULL: nothing */
    } cases[] = {
        {"", "0.02", "11.99", NULL},
        {"", "0.02", "12.01", "tick to tick (300 Hz), and its least diameter is 0.04 m"},
        {"contacts = { collision_rate = 600.0; interpenetration = false; collision = false; };",
         "0.02", "12.01", NULL},
        {"", "0.0151", "0.0", NULL},
        {"", "0.0149", "0.0", "its least radius is 0.0149 m, below half a segment of 0.03 m"},
        {turning, "0.02", "0.0", "tick to tick"}, /* by 1.5 * 8.2 rad/s at 1 m */
        {"", "0.0149", "-30.0", "tick to tick"},
    };
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *const text =
            printed(HAIR_AND_BODY, cases[i].head, cases[i].radius, cases[i].velocity);
        struct finished *f =
            WORKS("run", file_write(folder, "hair.cfg", text), "--out", printed("%s/run", folder),
                  "--duration", "0.11", "--no-progress");
        char *json = file_read(printed("%s/run/run.json", folder));
        const int count = i == 6 ? 2 : cases[i].said != NULL;
        cr_assert_eq(count_of(f->err, "warning: body 'ball' can pass"), count, "case %zu: %s", i,
                     f->err);
        cr_assert_eq(count_of(json, "\"body 'ball' can pass"), count, "case %zu", i);
        cr_assert(!cases[i].said || (strstr(f->err, cases[i].said) && strstr(json, cases[i].said)),
                  "case %zu: %s", i, f->err);
        cr_assert(strstr(json, "\"warnings\": ["), "case %zu: no list in run.json", i);
    }
}
