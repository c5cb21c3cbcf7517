/* When a finite run counts as diverged: a segment too long or too short after any step, or energy
 * that nothing has put in; and when it does not. */
#include "model/problems.h"
#include "model/wisp_model.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The largest strain in the frames of a run. */
static double frames_strain(const struct scene *scene, const struct lab_run *run) {
    double most = 0;
    for (int i = 0; i < run->frames * run->rows; i++) {
        const double *row = run->row + i * run->columns;
        if (row[1] < 2)
            continue;
        const double *p = row + 2, *q = p - run->columns;
        const double length = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
        most = fmax(most, fabs(length / wisp_spacing(&scene->wisps[(int)row[0]]) - 1));
    }
    return most;
}

static struct run_result run_of(const struct scene *scene, const struct run_request *request,
                                double *strain) {
    struct lab_run run;
    lab_run(scene, request, &run);
    *strain = frames_strain(scene, &run);
    const struct run_result result = run.result;
    return result;
}

/* Runge-Kutta 4 just past its limit: quiet at every frame, and a tenth too long between two. */
Test(diverged, what_is_wrong_between_quiet_frames) {
    struct scene *scene = lab_load("swing", NULL, 0);
    const struct run_request past = {.stepper = "rk4", .step = 1 / 3150.},
                             within = {.stepper = "rk4", .step = 1 / 4000.};
    double strain;
    struct run_result result = run_of(scene, &within, &strain);
    cr_assert_eq(result.outcome, FINISHED, "%s", result.reason);
    cr_assert(result.largest_strain < 0.004 && result.largest_strain >= strain, "%g",
              result.largest_strain);
    result = run_of(scene, &past, &strain);
    cr_assert_eq(result.outcome, DIVERGED, "%s", result.reason);
    cr_assert(strain < 0.05 && result.largest_strain > 0.05, "%g in the frames, %g", strain,
              result.largest_strain);
    cr_assert_gt(fabs(result.time * 30 - round(result.time * 30)), 0.01, "at a frame, %g s",
                 result.time);
    cr_assert(strstr(result.reason, "wisp 0") && strstr(result.reason, "more than 0.05"), "%s",
              result.reason);
}

/* Hair of 0.1 N hangs 12 % longer by its weight alone, and is right; the softest wisp says how far
 * a scene's may stretch, and the scene may say otherwise. */
Test(diverged, soft_hair_may_hang_longer) {
    const double weight = 9.81 * 5.7e-3 * 0.03 * (9 - 0.5); /* of nodes 2 to 10 */
    struct scene *soft = LAB_LOAD("swing", "material.stretch_stiffness=0.1", "duration=0.3"),
                 *stiff = LAB_LOAD("swing", "material.stretch_stiffness=90.0"),
                 *told = LAB_LOAD("swing", "material.stretch_stiffness=0.1", "duration=0.3",
                                  "run.strain_limit=0.05");
    const struct run_request request = {.stepper = "rk4"};
    double strain;
    cr_assert_float_eq(scene_strain_limit(soft), 2 * weight / 0.1, 1e-12);
    cr_assert_eq(scene_strain_limit(stiff), 0.05);
    cr_assert_eq(scene_strain_limit(told), 0.05);
    const struct run_result right = run_of(soft, &request, &strain);
    cr_assert_eq(right.outcome, FINISHED, "%s", right.reason);
    cr_assert_gt(right.largest_strain, 0.1);
    cr_assert_eq(run_of(told, &request, &strain).outcome, DIVERGED);
}

/* A thin body hooks a wisp and stretches it by half: so does it in the solution. */
#define HOOK                                                                                 \
    "name = \"hook\"; duration = 0.2; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"     \
    "material = { }; wisps = ( { root = [0.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0];\n"    \
    "length = 0.3; nodes = 11; } );\n"                                                       \
    "body = ( { name = \"s\"; center = [-0.1137, -0.15, 0.0]; radii = [0.02, 0.02, 0.02];\n" \
    "friction = 50.0; elasticity = 0.1; offset = 1.0e-4; velocity = [1.0, 0.0, 0.0]; } );\n" \
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n"

Test(diverged, the_reference_never_is) {
    struct scene *scene = lab_read(HOOK);
    const struct run_request tight = {.stepper = "reference", .rtol = 1e-8, .atol = 1e-10},
                             plain = {.stepper = "rk4"},
                             let = {.stepper = "rk4", .strain_limit = 1};
    double strain;
    const struct run_result solution = run_of(scene, &tight, &strain);
    cr_assert_eq(solution.outcome, FINISHED, "%s", solution.reason);
    cr_assert_gt(solution.largest_strain, 0.4);
    cr_assert_eq(run_of(scene, &plain, &strain).outcome, DIVERGED);
    cr_assert_eq(run_of(scene, &let, &strain).outcome, FINISHED);
}

/* A wisp that a moving head stretches is measured with the head where it is after the step, and
 * the wisp of a part that did it is named. */
Test(diverged, the_wisp_that_stretches_is_named) {
    struct scene *scene =
        LAB_LOAD("swing",
                 "wisps=({ root = [0.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.3; "
                 "nodes = 4; }, { root = [0.0, 0.0, 1.0]; direction = [0.0, -1.0, 0.0]; length = "
                 "0.3; nodes = 4; }, { root = [0.0, 0.0, 2.0]; direction = [0.0, -1.0, 0.0]; "
                 "length = 0.03; nodes = 4; })",
                 "head={ times = [0.0, 0.02]; positions = ([0.0, 0.0, 0.0], [0.0, 0.02, 0.0]); "
                 "rotations = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]); }",
                 "material.stretch_stiffness=0.001", "material.bending_stiffness=0",
                 "run.strain_limit=0.4", "duration=0.1");
    for (int i = 0; i < 2; i++) {
        const struct run_request request = {.stepper = i ? "cvode" : "rk4"};
        double strain;
        const struct run_result result = run_of(scene, &request, &strain);
        cr_assert_eq(result.outcome, DIVERGED, "%s", result.reason);
        cr_assert(strstr(result.reason, "wisp 2:"), "%s", result.reason);
        cr_assert(result.largest_strain > 0.4 && result.largest_strain < 0.6, "%g",
                  result.largest_strain);
    }
}

/* --- as a user meets it --- */

static char *folder;
static const char *path;

static void open_folder(void) {
    folder = folder_make();
    gnuplot_stub_quiet();
}

/* Where any strain is let pass, the books show what is wrong: exit 3, and only with them. */
Test(diverged, energy_out_of_nothing, .init = open_folder) {
    for (int books = 0; books < 2; books++)
        for (int good = 0; good < 2; good++) {
            path = printed("%s/run", folder);
            const struct finished *f =
                PROGRAM(NULL, "run", "swing", "--set", "run.strain_limit=1e6", "--rate",
                        good ? "4000" : "3000", "--out", path, "--no-progress",
                        books ? "--diagnostics" : NULL);
            cr_assert_eq(f->code, books && !good ? 3 : 0, "exit code %d: %s", f->code, f->err);
            cr_assert_eq(strstr(f->err, "accounted for by no work") != NULL, books && !good, "%s",
                         f->err);
        }
}

/* The circle's states mean what they are: there is no such setting. */
Test(diverged, the_circle_has_no_lengths, .init = open_folder) {
    path = printed("%s/run", folder);
    WORKS("run", "circle", "--stepper", "euler", "--step", "3", "--out", path, "--no-progress");
    FAILS(1, "strain_limit", "run", "circle", "--set", "run.strain_limit=1", "--out", path,
          "--no-progress");
}

static struct { int runs, let, finished; } seen;

static void look_at_run(const char *file, void *ctx) {
    (void)ctx;
    if (!strstr(file, "/run.json"))
        return;
    char *text = file_read(file);
    const char *limit = strstr(text, "\"strain_limit\": ");
    const int reference = strstr(text, "\"stepper\": \"reference\"") != NULL;
    seen.runs += !reference;
    seen.let += !reference && limit && atof(limit + 16) > 0.8;
    seen.finished += !reference && strstr(text, "\"status\": \"finished\"");
    cr_assert(!reference || !limit, "a limit for the reference");
}

/* Where an experiment has a reference, its configurations may stretch twice as far. */
Test(diverged, configurations_may_stretch_as_the_reference_does, .init = open_folder) {
    const char *const scene = file_write(folder, "hook.cfg", HOOK);
    WORKS("experiment", "work-precision", "--quick", "--scene", scene, "--stepper", "rk4", "--out",
          folder, "--no-progress");
    each_file(folder, look_at_run, NULL);
    cr_assert(seen.runs >= 4 && seen.let == seen.runs, "%d of %d runs may", seen.let, seen.runs);
    cr_assert_geq(seen.finished, 2, "%d of %d finished", seen.finished, seen.runs);
    cr_assert_eq(new_runs(WORKS("experiment", "work-precision", "--quick", "--scene", scene,
                                "--stepper", "rk4", "--out", folder, "--no-progress"),
                          NULL),
                 0);
}

/* The quick look after every step, which takes no root and looks at four wisps at once, finds the
 * lanes whose strain is above the limit, be it of a segment too long or too short. */
Test(diverged, the_quick_look_finds_what_the_slow_one_does) {
    struct scene *scene = LAB_LOAD(
        "swing-envelope", "wisps=({ root=[0.0, 0.0, 0.0]; direction=[1.0, 0.1, 0.0]; length=0.3; "
                          "nodes=7; grid=[2, 2]; spacing=0.05; "
                          "across=([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); })");
    unsigned state = 1;
    int found = 0, tried = 0;
    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
        struct model *model = lab_model(scene, WISP_GENERALISED, lanes);
        const struct kernel *kernel = ((struct wisp_model *)model)->kernel;
        struct part *part = &model->parts[0];
        const int size = part->system.size;
        double *rest = test_room((size_t)size * sizeof *rest);
        memcpy(rest, part->q, (size_t)size * sizeof *rest);
        for (int i = 0; i < 2000; i++) {
            const double limit = 1e-3 * (i % 50 + 1);
            for (int j = 0; j < size; j++) {
                state = 1664525 * state + 1013904223;
                part->q[j] = rest[j] + 3e-4 * (state / 4294967296. - 0.5) * (i % 7);
            }
            unsigned slow = 0;
            for (int k = 0; k < lanes; k++)
                slow |= (unsigned)(kernel->strain(part->system.ctx, k, part->q) > limit) << k;
            cr_assert_eq(kernel->strained(part->system.ctx, 0, part->q, limit), slow,
                         "%d lanes, limit %g", lanes, limit);
            found += __builtin_popcount(slow);
            tried += lanes;
        }
    }
    cr_assert(found > tried / 10 && found < tried - tried / 10, "%d of %d", found, tried);
}
