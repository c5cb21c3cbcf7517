/* Trajectories of other programs beside our own runs: their error is what it is by construction,
 * our own run given as somebody's has our own row's numbers, and what is wrong with a file is one
 * line. */
#include "base/table.h"
#include "base/text_table.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char small_scene[] =
    "name = \"small\"; duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.1; nodes = 4; } "
    ");\n"
    "run = { step = 2.5e-4; rtol = 1e-4; atol = 1e-6; };\n";

static char *folder;
static const char *scene, *reference;

/* The reference solution as a run writes it, beside the scene. */
static void set_up(void) {
    folder = folder_make();
    gnuplot_stub_quiet();
    scene = file_write(folder, "small.cfg", small_scene);
    WORKS("run", scene, "--stepper", "reference", "--out", printed("%s/tight", folder),
          "--no-progress");
    reference = printed("%s/tight/states.tsv", folder);
}

#define IN_FOLDER .init = set_up

/* A small race with one method and such trajectories; they end with NULL. */
static struct finished *race(const char *const *states) {
    const char *arguments[32] = {"experiment", "work-precision", "--quick", "--scene",
                                 scene,        "--stepper",      "rk4",     "--out",
                                 folder,       "--no-progress"};
    int count = 10;
    for (; *states; states++) {
        arguments[count++] = "--states";
        arguments[count++] = *states;
    }
    return program_done(NULL, arguments);
}
#define RACE(...) race(WORDS(__VA_ARGS__))

static void rows(struct text_table *table) {
    char reason[REASON_SIZE];
    table_must_be_read(table, folder, "work-precision/small");
    cr_assert_eq(text_table_check(table, "small", reason), 0, "%s", reason);
}

/* Writes the reference's frames, in metres `moved` in y at node 3 and all frames but the first: in
 * the columns t to z only, or those of velocities too; behind `head`. "name=path" into `given`. */
static void write_states(const char *name, const char *head, double moved, int velocities,
                         char given[2 * PATH_SIZE]) {
    struct table table;
    char reason[REASON_SIZE];
    cr_assert_eq(table_read(&table, reference, reason), 0, "%s", reason);
    const char *const path = printed("%s/%s.tsv", folder, name);
    FILE *file = fopen(path, "w");
    fprintf(file, "%st\twisp\tnode\tx\ty\tz%s\n", head, velocities ? "\tvx\tvy\tvz" : "");
    for (int row = 0; row < table.row_count; row++)
        for (int k = 0; k < (velocities ? 9 : 6); k++) {
            const int is_moved = k == 4 && table_value(&table, row, 2) == 3 && row >= 4;
            fprintf(file, "%.17g%c", table_value(&table, row, k) + is_moved * moved,
                    k + 1 < (velocities ? 9 : 6) ? '\t' : '\n');
        }
    fclose(file);
    table_free(&table);
    snprintf(given, 2 * PATH_SIZE, "%s=%s", name, path);
}

static double cell(const struct text_table *table, const char *name, int k, const char *column) {
    for (int row = 0; row < table->row_count; row++)
        if (strcmp(text_table_cell(table, row, "method"), name) == 0 && k-- == 0)
            return text_table_number(table, row, column);
    cr_assert_fail("no row of %s", name);
    return NAN;
}

/* One of two free nodes is off by d at three of four frames: the mean square is 3/8 d^2. The file
 * has no velocities, so that error is not known; costs are those that it says. */
Test(foreign_states, the_error_is_the_distance_from_the_reference, IN_FOLDER) {
    char one[2 * PATH_SIZE], two[2 * PATH_SIZE], again[2 * PATH_SIZE];
    struct text_table table;
    write_states("other", "# of mine\n# evaluations: 521\n# cpu_seconds: 1.25\n# setting: 1e-6\n",
                 8e-4, 0, one);
    write_states("silent", "", 0, 1, two);
    write_states("more", "# evaluations: 99\n", 2e-3, 0, again);
    snprintf(again, sizeof again, "other=%s/more.tsv", folder);
    const struct finished *f = RACE(one, two, again);
    cr_assert_eq(f->code, 0, "%s", f->err);
    rows(&table);
    /* of a curve's points the one that took less comes first */
    cr_expect_float_eq(cell(&table, "other", 1, "error"), 8e-4 * sqrt(3. / 8), 1e-15);
    cr_expect_float_eq(cell(&table, "other", 0, "error"), 2e-3 * sqrt(3. / 8), 1e-15);
    cr_expect_float_eq(cell(&table, "other", 1, "largest"), 8e-4, 1e-15);
    cr_expect_float_eq(cell(&table, "other", 1, "end"), 8e-4 * sqrt(0.5), 1e-15);
    cr_expect(cell(&table, "other", 1, "force_evaluations") == 521);
    cr_expect(cell(&table, "other", 1, "cpu_median") == 1.25);
    cr_expect(cell(&table, "other", 1, "setting") == 1e-6);
    cr_expect(isnan(cell(&table, "other", 1, "velocity")), "nobody knows it");
    cr_expect(cell(&table, "silent", 0, "error") == 0 &&
              cell(&table, "silent", 0, "velocity") == 0);
    cr_expect(isnan(cell(&table, "silent", 0, "cpu_median")) &&
              isnan(cell(&table, "silent", 0, "force_evaluations")));
    cr_expect(cell(&table, "other", 0, "front_cpu") == 0 &&
                  cell(&table, "silent", 0, "front_evaluations") == 0,
              "no front is of other programs");
    cr_expect(strstr(f->out,
                     "trajectory other of another program errs 0.49 mm with 521 evaluations "
                     "in 1.25 s; rk4 errs no more with "),
              "%s", f->out);
}

/* A run of ours that comes as somebody's has the numbers of our own row. */
Test(foreign_states, our_own_run_has_its_own_error, IN_FOLDER) {
    static const char *const columns[] = {"error", "largest",  "relative",
                                          "end",   "velocity", "mescd"};
    char given[2 * PATH_SIZE] = "", run[128] = "";
    struct text_table table;
    RACE(NULL);
    rows(&table);
    int own = 0;
    while (strcmp(text_table_cell(&table, own, "status"), "finished") != 0)
        own++;
    snprintf(run, sizeof run, "%s", text_table_cell(&table, own, "run"));
    snprintf(given, sizeof given, "mine=%s/runs/%s/states.tsv", folder, run);
    cr_assert_eq(RACE(given)->code, 0);
    rows(&table);
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
        cr_expect(cell(&table, "mine", 0, columns[i]) == text_table_number(&table, own, columns[i]),
                  "%s: %.17g", columns[i], cell(&table, "mine", 0, columns[i]));
    cr_expect_gt(cell(&table, "mine", 0, "error"), 0);
}

/* --- what is wrong with a file --- */

/* A line of a good file, which becomes `text`; NULL: the file ends before it. */
static const struct {
    int line;
    const char *text, *says;
} wrong[] = {
    {1, "# evaluations: many", ":1: '# evaluations: many' must end in a positive number"},
    {1, "# cpu_seconds: -1", ":1: '# cpu_seconds: -1' must end in a positive number"},
    {1, "# treatment: magic", ":1: is of treatment 'magic', with which nothing is run on small"},
    {1, "# scene small, hash 0123456789abcdef",
     ":1: is of a scene with hash 0123456789abcdef, which small has not; compute it"},
    {2, "t\twisp\tnode\tx\tz\ty2", ":2: has no column y; it must have t, wisp, node, x, y, z"},
    {2, "time\twisp\tnode\tx\ty\tz", "has not the columns of states: t, wisp, node"},
    {2, "t wisp node x y z", ":2: columns must be separated by tabs, not by blanks"},
    {2, "t,wisp,node,x,y,z", ":2: columns must be separated by tabs"},
    {5, "0 0 2 0.06 0 0", ":5: columns must be separated by tabs"},
    {5, "0\t0\t2\tzero\t0\t0", ":5: column 4: 'zero' is not a number"},
    {5, "0\t0\t3\t0.05\t0\t0", ":5: is of wisp 0, node 3, not of wisp 0, node 2: a frame of small"},
    {5, "0\t0\t2\t0.07\t0\t0",
     ":5: begins with node 2 of wisp 0 0.00333 m from where small has it"},
    {12, "0.066666666666666666\t0\t1\tnan\t0\t0", ":12: has no finite position"},
    {15, NULL, "has no frame at t = 0.1"},
    {15, "", ":15: "},
};

Test(foreign_states, what_is_wrong_is_said_in_a_line_before_anything_is_run, IN_FOLDER) {
    char given[2 * PATH_SIZE];
    write_states("good", "# mine\n", 0, 0, given);
    const char *good = file_of(folder, "good.tsv");
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char *bad = test_room(strlen(good) + 200), *to = bad;
        int line = 1;
        for (const char *at = good; *at; at += strcspn(at, "\n") + 1, line++) {
            if (line == wrong[i].line && !wrong[i].text)
                break;
            to += line == wrong[i].line ? sprintf(to, "%s\n", wrong[i].text)
                                        : sprintf(to, "%.*s\n", (int)strcspn(at, "\n"), at);
        }
        snprintf(given, sizeof given, "bad=%s", file_write(folder, "bad.tsv", bad));
        const struct finished *f = RACE(given);
        must_have_failed(f, 1, "bad.tsv");
        must_have_failed(f, 1, wrong[i].says);
    }
    cr_expect_not(file_exists(printed("%s/runs", folder)), "something was run");
}

Test(foreign_states, what_is_wrong_on_the_command_line_is_said_in_a_line, IN_FOLDER) {
    static const char *const names[][2] = {{"rk4=small.tsv", "a method of wisplab has that name"},
                                           {"=small.tsv", "must be NAME=FILE"},
                                           {"small.tsv", "must be NAME=FILE"},
                                           {"one=", "must be NAME=FILE"},
                                           {"\"one\"=a", "must be NAME=FILE"},
                                           {"one=none.tsv", "none.tsv: No such file"}};
    char given[2 * PATH_SIZE], other[2 * PATH_SIZE];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        must_have_failed(RACE(names[i][0]), 1, names[i][1]);
    write_states("good", "", 0, 0, given);
    must_have_failed(RACE(given, given), 1, "is given twice");
    write_states("other", "", 0, 0, other);
    must_have_failed(RACE(given, printed("good%s", strchr(other, '='))), 1,
                     "told apart by '# setting");
    FAILS(1, "which of 2 scenes it is", "experiment", "work-precision", "--quick", "--scene", scene,
          "--scene", "swing", "--states", given, "--out", folder);
    FAILS(1, "no place for --states", "experiment", "circle", "--states", given, "--out", folder);
}
