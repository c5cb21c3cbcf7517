/* The experiment that searches: its brackets, its costs' crossings, and that a search over rounds
 * of runs goes on where it was, whoever did the runs. */
#include "base/text_table.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A shorter swing of fewer nodes. Spacing 0.075 m, node mass 1000 * 5.7e-6 * 0.075 kg. */
#define SCENE(duration, run)                                                                       \
    "name = \"short\"; duration = " duration "; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n" \
    "material = { hair_count = 1000.0; hair_density = 5.7e-6; bending = \"skip\";\n"               \
    "             bending_stiffness = 1.0e-5; bending_angle = 0.3; bending_time = 1.0e-3;\n"       \
    "             drag_rate = 4.0; };\n"                                                           \
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.30;\n"            \
    "            nodes = 5; } );\n"                                                                \
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; " run "};\n"
static const char scene_text[] = SCENE("0.2", ""),
                  one_frame[] = SCENE("0.03333333333333333", "strain_limit = 1.0e9; ");
static const double spacing = 0.075, node_mass = 1000 * 5.7e-6 * 0.075;

/* --- the tables --- */

struct ladder_row {
    double stiffness, zeta, setting, missed_setting, error, missed_error, cpu[3], counted,
        evaluations;
    char method[64], status[32], limit[32], missed_outcome[32], hair[64];
};

enum { ROWS_MAX = 64 };
struct ladder_table {
    int count;
    struct ladder_row row[ROWS_MAX];
};

static void read_ladder(const char *folder, struct ladder_table *table) {
    struct text_table text;
    table_must_be_read(&text, folder, "ladder/ladder");
    table->count = text.row_count;
    cr_assert_leq(text.row_count, ROWS_MAX);
    for (int i = 0; i < text.row_count; i++) {
        struct ladder_row *r = &table->row[i];
        *r = (struct ladder_row){
            .stiffness = text_table_number(&text, i, "stretch_stiffness"),
            .zeta = text_table_number(&text, i, "zeta"),
            .setting = text_table_number(&text, i, "setting"),
            .missed_setting = text_table_number(&text, i, "missed_setting"),
            .error = text_table_number(&text, i, "error"),
            .missed_error = text_table_number(&text, i, "missed_error"),
            .cpu = {text_table_number(&text, i, "cpu_median"),
                    text_table_number(&text, i, "cpu_least"),
                    text_table_number(&text, i, "cpu_greatest")},
            .counted = text_table_number(&text, i, "counted"),
            .evaluations = text_table_number(&text, i, "force_evaluations"),
        };
        snprintf(r->method, sizeof r->method, "%s", text_table_cell(&text, i, "method"));
        snprintf(r->status, sizeof r->status, "%s", text_table_cell(&text, i, "status"));
        snprintf(r->limit, sizeof r->limit, "%s", text_table_cell(&text, i, "limit"));
        snprintf(r->missed_outcome, sizeof r->missed_outcome, "%s",
                 text_table_cell(&text, i, "missed_outcome"));
        snprintf(r->hair, sizeof r->hair, "%s", text_table_cell(&text, i, "hair"));
    }
}

/* --- the program --- */

static char *folder;
static const char *scene_path;

static void set_up(void) {
    folder = folder_make();
    scene_path = file_write(folder, "short.cfg", scene_text);
}

#define LADDER(out)                                                                            \
    "experiment", "ladder", "--quick", "--scene", scene_path, "--stepper", "rk4", "--stepper", \
        "implicit-euler", "--stepper", "cvode", "--out", out

/* --- what the table says, done again in this process --- */

/* Of a long chain the highest stretch mode is 2 sqrt(k/m), k = EA/spacing; a damper of tau k makes
 * it tau w / 2 of critical. */
static double highest_mode(double stiffness) {
    return 2 * sqrt(stiffness / spacing / node_mass);
}

/* The scene of a row, whose damping the table may have told the scene, or the scene the table. */
static struct scene *scene_of(const struct ladder_row *row) {
    if (isinf(row->stiffness)) {
        cr_assert_str_eq(row->hair, "rigid segments");
        return LAB_LOAD(scene_path, "material.stretch=rigid");
    }
    const double w = highest_mode(row->stiffness);
    const char *const stiffness = printed("material.stretch_stiffness=%.17e", row->stiffness);
    if (strcmp(row->hair, "default") == 0) {
        struct scene *scene = LAB_LOAD(scene_path, stiffness);
        cr_assert_float_eq(row->zeta, scene->wisps[0].stretch_time * w / 2, 1e-12 * row->zeta);
        return scene;
    }
    const char *const time = printed("material.stretch_time=%.17e", 2 * row->zeta / w);
    return LAB_LOAD(scene_path, stiffness, time);
}

/* rms over free nodes and all frames; infinite where the run did not finish. */
static double error_of(const struct scene *scene, const struct ladder_row *row, double setting,
                       const struct lab_run *tight, double *evaluations) {
    const int adaptive = strncmp(row->method, "cvode", 5) == 0;
    const char *option = strstr(row->method, "newton")    ? "newton.iterations=30"
                         : strstr(row->method, "order 2") ? "max_order=2"
                                                          : NULL;
    const char *linear = strstr(row->method, "cg")       ? "cg"
                         : strstr(row->method, "direct") ? "direct"
                                                         : NULL;
    const char *const stepper = printed("%.*s", (int)strcspn(row->method, " "), row->method);
    const struct run_request request = {.stepper = stepper,
                                        .treatment = "generalised",
                                        .linear = linear,
                                        .step = adaptive ? 0 : setting,
                                        .rtol = adaptive ? setting : 0,
                                        .atol = adaptive ? setting * 1e-3 : 0,
                                        .options = &option,
                                        .option_count = option != NULL};
    struct lab_run run;
    lab_run(scene, &request, &run);
    const double error =
        run.result.outcome == FINISHED ? lab_distance(&run, tight, 0, 2).rms : INFINITY;
    *evaluations = (double)run.result.counters.force_evaluations;
    return error;
}

/* Apart by a quarter of an octave of steps or of a decade of tolerances at most. What reached a
 * millimetre does so again, and what missed it misses: of tolerances, the worst of three. */
static void check_row(const struct ladder_row *row) {
    const int adaptive = strncmp(row->method, "cvode", 5) == 0;
    struct scene *scene = scene_of(row);
    struct lab_run tight;
    double worst = 0, evaluations, first_evaluations = NAN, missed = 0;
    if (isinf(row->stiffness) && strcmp(row->status, "refused") == 0) { /* it has no Jacobians */
        cr_assert(strncmp(row->method, "implicit-euler", 14) == 0, "%s", row->method);
        return;
    }
    cr_assert_str_eq(row->status, "reached", "%s at %g N", row->method, row->stiffness);
    const int coarsest = isnan(row->missed_setting); /* none was longer */
    if (coarsest)
        cr_assert_float_eq(row->setting, adaptive ? 0.1 : 1 / 30., 1e-12, "%s: %g", row->method,
                           row->setting);
    else if (adaptive)
        cr_assert(row->missed_setting <= 1.0001 * pow(10, 0.25) * row->setting, "%s: %g and %g",
                  row->method, row->setting, row->missed_setting);
    else /* whole steps between frames, to the nearest on either side */
        cr_assert(1 / (30 * row->missed_setting) >= pow(2, -0.25) / (30 * row->setting) - 1,
                  "%s: %g and %g", row->method, row->setting, row->missed_setting);
    cr_assert(coarsest || row->missed_setting > row->setting, "%s at %g N", row->method,
              row->stiffness);
    lab_run(scene, &(struct run_request){.stepper = "reference"}, &tight);
    for (int j = 0; j < (adaptive ? 3 : 1); j++) {
        const double jitter = 1 + 1e-12 * j;
        worst = fmax(worst, error_of(scene, row, row->setting * jitter, &tight, &evaluations));
        first_evaluations = j == 0 ? evaluations : first_evaluations;
        if (!coarsest)
            missed = fmax(missed,
                          error_of(scene, row, row->missed_setting * jitter, &tight, &evaluations));
    }
    cr_assert(fabs(worst - row->error) <= 1e-9 * worst && worst <= 1e-3,
              "%s at %g N: error %.17g, and the table has %.17g", row->method, row->stiffness,
              worst, row->error);
    cr_assert(coarsest || missed > 1e-3, "%s at %g N: %g reaches it too", row->method,
              row->stiffness, row->missed_setting);
    cr_assert_eq(first_evaluations, row->evaluations, "%s: %g evaluations, not %g", row->method,
                 first_evaluations, row->evaluations);
    const int fails = !isfinite(missed) || missed > 100 * worst;
    cr_assert_str_eq(row->limit,
                     coarsest ? "none"
                     : fails  ? "failure"
                              : "accuracy",
                     "%s at %g N", row->method, row->stiffness);
}

/* Of pairs that change places from one stiffness to the next, the lines through both meet where
 * the table says. */
static int count_crossings(const struct ladder_table *t, const char *text) {
    int count = 0;
    for (int i = 0; i + 1 < t->count; i++)
        for (int k = i + 1; k + 1 < t->count; k++) {
            const struct ladder_row *a = &t->row[i], *b = &t->row[k];
            if (a->stiffness != b->stiffness || a[1].stiffness <= a->stiffness ||
                strcmp(a->hair, a[1].hair) != 0 || strcmp(b->hair, b[1].hair) != 0 ||
                (a->counted < b->counted) == (a[1].counted < b[1].counted))
                continue;
            const double first = log(a->counted / b->counted),
                         last = log(a[1].counted / b[1].counted);
            const double slope = (last - first) / log(a[1].stiffness / a->stiffness);
            const double at = a->stiffness * exp(-first / slope);
            const int below = a->counted < b->counted;
            const char *const line = printed("\ndefault\t%s\t%s\t%g\t%g\t", (below ? a : b)->method,
                                             (below ? b : a)->method, a->stiffness, a[1].stiffness);
            const char *found = strstr(text, line);
            cr_assert(found, "no crossing of %s and %s", a->method, b->method);
            cr_assert_float_eq(strtod(found + strlen(line), NULL), at, 1e-6 * at);
            count++;
        }
    return count;
}

Test(ladder, slow_brackets_hold_and_crossings_follow, .init = set_up) {
    static struct ladder_table table;
    const struct finished *f = WORKS(LADDER(folder));
    statements_must_be_whole(printed("%s/ladder", folder));
    read_ladder(folder, &table);
    cr_assert_eq(table.count, (3 + 1) * 4, "%d rows", table.count);
    for (int i = 0; i < table.count; i++)
        check_row(&table.row[i]);
    char *text = file_read(printed("%s/ladder/crossings.tsv", folder));
    const int lines = count_lines(strstr(text, "\nhair") + 1) - 1;
    const int crossings = count_crossings(&table, text);
    cr_assert_eq(lines, crossings, "%d crossings, and %d in the table", crossings, lines);
    cr_assert(strstr(f->out, "Hair of rigid segments stays within 0.0"),
              "how far they are from springs is not said: %s", f->out);
    cr_assert(strstr(f->out, "(16800 N)"), "--quick does not say what it leaves out");
}

/* Without --quick there is hair of given dampings too, whatever its stiffness. */
Test(ladder, slow_dampings_are_those_of_the_highest_stretch_mode, .init = set_up) {
    static struct ladder_table table;
    int checked = 0;
    WORKS("experiment", "ladder", "--scene", scene_path, "--stepper", "rk4", "--out", folder);
    read_ladder(folder, &table);
    for (int i = 0; i < table.count; i++) {
        const struct ladder_row *row = &table.row[i];
        double damping;
        if (sscanf(row->hair, "damping %lf", &damping) != 1)
            continue;
        cr_assert_float_eq(row->zeta, damping, 1e-12, "%s: %g", row->hair, row->zeta);
        if (row->stiffness > 15)
            continue;
        check_row(row);
        checked++;
    }
    cr_assert_eq(table.count, 4 * 4 + 1, "%d rows", table.count);
    cr_assert_eq(checked, 3, "%d rows", checked);
}

/* In a single frame an instability has no time to overflow: what is finite then, where any strain
 * is let pass, is a failure by being wrong. */
Test(ladder, what_is_finite_and_wrong_is_a_failure_too, .init = set_up) {
    static struct ladder_table table;
    int finite = 0;
    scene_path = file_write(folder, "frame.cfg", one_frame);
    WORKS("experiment", "ladder", "--quick", "--scene", scene_path, "--stepper", "midpoint",
          "--out", folder);
    read_ladder(folder, &table);
    for (int i = 0; i < table.count; i++) {
        if (isinf(table.row[i].stiffness))
            continue; /* in one frame rigid segments bear any step */
        check_row(&table.row[i]);
        finite += strcmp(table.row[i].missed_outcome, "finished") == 0 &&
                  strcmp(table.row[i].limit, "failure") == 0;
    }
    cr_assert(finite > 0, "no such failure among %d rows", table.count);
}

/* Two processes, each of which can only go on when the other has done its part of a round, come to
 * the same search as one; and then nothing is left to do. */
Test(ladder, slow_processes_share_rounds, .init = set_up) {
    static struct ladder_table whole, shared;
    struct finished *f;
    WORKS(LADDER(folder));
    read_ladder(folder, &whole);
    cr_assert_eq(new_runs(WORKS(LADDER(folder)), NULL), 0, "a complete search does more");
    const char *const other = printed("%s/other", folder);
    struct process processes[2];
    for (int i = 0; i < 2; i++)
        processes[i] = program_start(NULL, (const char *const[]){LADDER(other), NULL});
    for (int i = 0; i < 2; i++) {
        f = program_wait(&processes[i]);
        cr_assert_eq(f->code, 0, "exit code %d: %s", f->code, f->err);
        cr_assert(strstr(f->out, "tables and figures in"), "process %d: '%s'", i + 1, f->out);
    }
    read_ladder(other, &shared);
    cr_assert_eq(shared.count, whole.count);
    for (int i = 0; i < whole.count; i++)
        cr_assert((isnan(whole.row[i].setting) && isnan(shared.row[i].setting)) ||
                      (shared.row[i].setting == whole.row[i].setting &&
                       shared.row[i].error == whole.row[i].error),
                  "%s: %g, and by two %g", whole.row[i].method, whole.row[i].setting,
                  shared.row[i].setting);
}

/* Failure is a result: without truths there is a table that says so. */
Test(ladder, without_reference_solutions_every_row_says_why, .init = set_up) {
    WORKS("experiment", "ladder", "--quick", "--scene", scene_path, "--stepper", "euler", "--out",
          folder, "--time-limit", "0.0001");
    statements_must_be_whole(printed("%s/ladder", folder));
    char *text = file_read(printed("%s/ladder/ladder.tsv", folder));
    int rows = 0;
    for (const char *at = text; (at = strstr(at, "no reference solution: out of time")); at++)
        rows++;
    cr_assert_eq(rows, 3 + 1, "%d rows", rows);
    cr_assert_eq(count_files(folder, "ladder.svg"), 1, "no figure");
}

Test(ladder, is_of_one_scene, .init = set_up) {
    FAILS(1, "one scene", "experiment", "ladder", "--scene", scene_path, "--scene", "swing",
          "--out", folder);
}
