/* Races: from perturbed starts to the horizon, and a small one from plan to table. */
#include "base/table.h"
#include "experiments/common/measure.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- perturbed starts --- */

static void states_at_start(const char *perturb, const char *draw, struct table *states) {
    char folder[PATH_SIZE], path[PATH_SIZE], reason[REASON_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "run", "swing-envelope", "--duration", "0.001", "--perturb", perturb,
            "--draw", draw, "--out", folder, "--no-progress");
    cr_assert(f.code == 0, "%s", f.err);
    path_format(path, "%s/states.tsv", folder);
    cr_assert(table_read(states, path, reason) == 0, "%s", reason);
    folder_remove(folder);
}

Test(race, a_perturbed_start_is_that_far_away_and_its_own) {
    struct table start, other, again;
    states_at_start("1e-6", "1", &start);
    states_at_start("1e-6", "2", &other);
    states_at_start("1e-6", "1", &again);
    double square = 0, apart = 0;
    for (int i = 0; i < 11; i++) {
        for (int k = 3; k < 6; k++) {
            const double at_rest = k == 3 ? 0.03 * i : 0;
            const double moved = table_value(&start, i, k) - at_rest;
            cr_assert(i >= 2 || moved == 0, "node %d belongs to the head", i);
            square += moved * moved;
            apart += fabs(moved - table_value(&other, i, k) + at_rest);
            cr_assert(table_value(&start, i, k) == table_value(&again, i, k), "node %d", i);
        }
        cr_assert(table_value(&start, i, 6) == 0, "velocities are not perturbed");
    }
    const double rms = sqrt(square / 9); /* of 27 Gaussian numbers: sd of the rms is 14 % */
    cr_assert(rms > 0.5e-6 && rms < 1.6e-6, "%g", rms);
    cr_assert(apart > 1e-6, "the draws are the same");
    table_free(&start);
    table_free(&other);
    table_free(&again);
}

/* --- the horizon --- */

/* A run's folder with one node at 0, `apart` times 1, 2, 3, ... in x at frames 0.1 s apart. */
static void write_run(const char *folder, const char *status, const double *x, int frames) {
    char text[4096] = "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\n", json[64];
    for (int i = 0; i < frames; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "%.17g\t0\t2\t%.17g\t0\t0\t0\t0\t0\n", 0.1 * i, x[i]);
    snprintf(json, sizeof json, "{\"status\": \"%s\", \"frames\": %d}", status, frames);
    file_write(folder, "states.tsv", text, NULL);
    file_write(folder, "run.json", json, NULL);
}

static double horizon(const char *status, const double *x, int frames) {
    static const double still[8];
    char one[PATH_SIZE], other[PATH_SIZE], reason[REASON_SIZE];
    double found = -1;
    folder_make(one);
    folder_make(other);
    write_run(one, "finished", still, frames);
    write_run(other, status, x, frames);
    cr_assert(measure_horizon(one, other, &found, reason) == 0, "%s", reason);
    folder_remove(one);
    folder_remove(other);
    return found;
}

Test(race, the_horizon_is_the_last_frame_within_a_millimetre) {
    const double never[] = {1e-10, 1e-8, 1e-6, 0.99e-3};
    const double late[] = {1e-10, 1e-8, 1e-6, 1.01e-3, 1e-10};
    const double back[] = {1e-10, 1e-8, 2e-3, 1e-10, 1e-10};
    const double at_once[] = {1e-10, 2e-3, 2e-3};
    cr_expect_float_eq(horizon("finished", never, 4), 0.3, 1e-12);
    cr_expect_float_eq(horizon("finished", late, 5), 0.2, 1e-12);
    cr_expect_float_eq(horizon("finished", back, 5), 0.1, 1e-12);
    cr_expect_float_eq(horizon("finished", at_once, 3), 0.1, 1e-12, "two frames are left");
    cr_expect(isnan(horizon("diverged", never, 4)));
}

/* --- a small race --- */

static const char small_scene[] =
    "name = \"small\"; duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.1; nodes = 4; } "
    ");\n"
    "run = { step = 2.5e-4; rtol = 1e-4; atol = 1e-6; };\n";

/* Rows of a table that begin with this. */
static int rows_of(const char *table, const char *beginning) {
    int count = 0;
    for (const char *line = table; line && *line; line = strchr(line, '\n'), line += line != NULL)
        count += strncmp(line, beginning, strlen(beginning)) == 0;
    return count;
}

Test(race, a_small_one_has_every_point_and_runs_nothing_twice, .timeout = 120) {
    char folder[PATH_SIZE], scene[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    file_write(folder, "small.cfg", small_scene, scene);
    PROGRAM(&f, NULL, "experiment", "work-precision", "--scene", scene, "--quick", "--stepper",
            "cvode", "--stepper", "rk4", "--out", folder, "--no-progress");
    cr_assert(f.code == 0, "%s", f.err);
    path_format(path, "%s/work-precision/small.tsv", folder);
    char *table = file_read(path);
    cr_assert(table, "no %s", path);
    cr_expect(rows_of(table, "cvode\tgeneralised\t") == 4, "every third of 11 tolerances");
    cr_expect(rows_of(table, "cvode order 5\tgeneralised\t") == 4);
    cr_expect(rows_of(table, "rk4\tgeneralised\t") >= 4);
    cr_expect(strstr(table, "\tstrain\tpenetration\tdrift\tnote\n"), "measures of the state");
    cr_expect(strstr(table, "diverged") || strstr(table, "not finite"), "a long step of rk4 fails");
    free(table);
    PROGRAM(&f, NULL, "experiment", "work-precision", "--scene", scene, "--quick", "--stepper",
            "cvode", "--stepper", "rk4", "--out", folder, "--no-progress");
    cr_expect(f.code == 0 && strstr(f.out, " 0 of them new"), "%s", f.out);
    folder_remove(folder);
}
