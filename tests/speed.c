/* The experiment `speed`: what it chooses is exact enough, and the measurement says what it
 * measured. No time is judged here. */
#include "base/text_table.h"
#include "experiments/common/measure.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

/* Two wisps that fall for a fifth of a second; one of them has an envelope's mass, so that
 * treatments differ. */
static const char scene_text[] =
    "name = \"short\"; duration = 0.2; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { }; envelope = { };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.3; nodes = 6; },\n"
    "          { root = [0.0, 0.1, 0.0]; direction = [1.0, 0.0, 0.2]; length = 0.3; nodes = 6; } "
    ");\n"
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n";

static char *folder;
static const char *scene_path;

static void set_up(void) {
    folder = folder_make();
    scene_path = file_write(folder, "short.cfg", scene_text);
}

/* rms over free nodes and all frames of a run against the reference, done again. */
static double error_of(const char *stepper, const char *treatment, double setting) {
    struct scene *scene = LAB_LOAD(scene_path, "frame_rate=30.0");
    struct lab_run run, tight;
    lab_run(scene, &(struct run_request){.stepper = "reference", .treatment = treatment}, &tight);
    const struct configuration method = configuration_of(stepper_find(stepper));
    struct run_request request =
        configuration_request(&method, setting, scene->run.atol / scene->run.rtol);
    request.treatment = treatment;
    lab_run(scene, &request, &run);
    const double error =
        run.result.outcome == FINISHED ? lab_distance(&run, &tight, 0, 2).rms : INFINITY;
    return error;
}

/* Of each target both are within it, and no attempt that is as exact is cheaper than the best. */
static void check_choices(void) {
    struct text_table choices, attempts;
    table_must_be_read(&choices, folder, "speed/choices");
    table_must_be_read(&attempts, folder, "speed/attempts");
    cr_assert_eq(choices.row_count, 4, "%d rows", choices.row_count);
    for (int row = 0; row < choices.row_count; row++) {
        const double target = text_table_number(&choices, row, "target"),
                     error = text_table_number(&choices, row, "error"),
                     setting = text_table_number(&choices, row, "setting");
        const char *method = text_table_cell(&choices, row, "method"),
                   *treatment = text_table_cell(&choices, row, "treatment");
        const int recipe = strcmp(text_table_cell(&choices, row, "who"), "recipe") == 0;
        const double again = error_of(method, treatment, setting);
        cr_assert(again <= target && fabs(again - error) <= 1e-9 * error,
                  "%s: %g, and %g in the "
                  "table",
                  method, again, error);
        cr_assert(recipe == (strcmp(treatment, "projection") == 0), "%s in %s", method, treatment);
        double cost = NAN, least = INFINITY;
        for (int i = 0; i < attempts.row_count; i++) {
            const double counted = text_table_number(&attempts, i, "counted");
            if (text_table_number(&attempts, i, "recipe") != recipe)
                continue;
            if (text_table_number(&attempts, i, "error") <= target)
                least = fmin(least, counted);
            if (strcmp(text_table_cell(&attempts, i, "method"), method) == 0 &&
                text_table_number(&attempts, i, "setting") == setting)
                cost = counted;
        }
        cr_assert(cost == least, "%s costs %g, another one %g", method, cost, least);
    }
}

/* Whoever is within the target is there with its error; and the program's own cheapest has 1. */
static void check_peers(void) {
    struct text_table peers;
    int ones = 0;
    table_must_be_read(&peers, folder, "speed/peers");
    for (int row = 0; row < peers.row_count; row++) {
        const char *question = text_table_cell(&peers, row, "question");
        const double target = strstr(question, "1e-9") ? 1e-9 : 1e-4;
        const double error = text_table_number(&peers, row, "error");
        cr_assert(error > 0 && error <= target, "%s: %g", text_table_cell(&peers, row, "who"),
                  error);
        ones += text_table_number(&peers, row, "over_own") == 1;
    }
    cr_assert(peers.row_count > 10 && ones >= 2, "%d rows, %d of them 1", peers.row_count, ones);
}

Test(speed, slow_choices_are_exact_enough_and_all_is_measured, .init = set_up, .timeout = 400) {
    struct finished *f =
        WORKS("experiment", "speed", "--quick", "--scene", scene_path, "--out", folder);
    check_choices();
    check_peers();
    const char *const path = printed("%s/speed", folder);
    statements_must_be_whole(path);
    cr_assert_eq(count_files(path, "speed.svg"), 1, "no figure");
    cr_assert(strstr(f->out, "times as fast as real time on one thread"), "%s", f->out);
    f = WORKS("experiment", "speed", "--quick", "--scene", scene_path, "--out", folder);
    cr_assert(strstr(f->out, "are there already"), "%s%s", f->out, f->err);
}
