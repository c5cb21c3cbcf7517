/* wisplab compare: what is joined, what counts as worse, and who is told. */
#include "report/compare.h"

#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static char *root;
static const char *older, *newer;

static void set_up(void) {
    char reason[REASON_SIZE];
    root = folder_make();
    older = printed("%s/old", root);
    newer = printed("%s/new", root);
    cr_assert(make_folder(older, reason) == 0 && make_folder(newer, reason) == 0, "%s", reason);
}

static void put(const char *side, const char *experiment, const char *name, const char *text) {
    char reason[REASON_SIZE];
    const char *const folder = printed("%s/%s", side, experiment);
    cr_assert_eq(make_folder(folder, reason), 0, "%s", reason);
    file_write(folder, name, text);
}

#define POINTS                                                                            \
    "# "                                                                                  \
    "points\nmethod\tsetting\tstatus\terror\tcpu_median\tcpu_least\tcpu_greatest\tforce_" \
    "evaluations\n"

/* Five rows, of which one has each kind of change. */
static void put_points(void) {
    put(older, "race", "swing.tsv",
        POINTS "rk4\t0.1\tfinished\t1e-3\t2\t1.9\t2.1\t100\n"
               "rk4\t0.2\tfinished\t2e-3\t1\t0.9\t1.1\t50\n"
               "euler\t0.1\tfinished\t1e-1\t1\t0.9\t1.1\t10\n"
               "euler\t0.2\tdiverged\tnan\t1\t0.9\t1.1\t5\n"
               "gone\t1\tfinished\t1\t1\t1\t1\t1\n");
    put(newer, "race", "swing.tsv",
        POINTS "new\t1\tfinished\t1\t1\t1\t1\t1\n"
               "rk4\t0.2\tfinished\t2.1e-3\t1.3\t1.0\t1.5\t50\n" /* within tolerance and spread */
               "rk4\t0.1\tfinished\t2e-3\t3\t2.4\t3.1\t90\n"     /* error and time */
               "euler\t0.1\tsolver stalled\tnan\t1\t0.9\t1.1\t10\n"
               "euler\t0.2\tfinished\t1\t0.5\t0.4\t0.6\t5\n");
}

static int has(const struct comparison *c, enum change change, const char *row, const char *what) {
    for (int i = 0; i < c->count; i++)
        if (c->differences[i].change == change && strcmp(c->differences[i].row, row) == 0 &&
            strstr(c->differences[i].what, what))
            return 1;
    return 0;
}

static void compare(struct comparison *c, double tolerance, int with_times) {
    char reason[REASON_SIZE];
    const struct compare_request request = {
        .older = older, .newer = newer, .tolerance = tolerance, .with_times = with_times};
    cr_assert_eq(compare_results(&request, c, reason), 0, "%s", reason);
}

Test(compare, rows_are_joined_by_what_they_are_about, .init = set_up) {
    struct comparison c;
    put_points();
    compare(&c, 0.1, 1);
    cr_expect(has(&c, CHANGE_WORSE, "rk4, setting 0.1", "error 0.002 m, was 0.001"));
    cr_expect(has(&c, CHANGE_WORSE, "rk4, setting 0.1", "cpu_median 3"));
    cr_expect(!has(&c, CHANGE_WORSE, "rk4, setting 0.1", "force"));
    cr_expect(
        has(&c, CHANGE_WORSE, "euler, setting 0.1", "status 'solver stalled', was 'finished'"));
    cr_expect(has(&c, CHANGE_WORSE, "euler, setting 0.1", "error"));
    cr_expect(has(&c, CHANGE_BETTER, "euler, setting 0.2", "status 'finished'"));
    cr_expect(has(&c, CHANGE_BETTER, "euler, setting 0.2", "cpu_median"));
    cr_expect(has(&c, CHANGE_VANISHED, "gone, setting 1", ""));
    cr_expect(has(&c, CHANGE_APPEARED, "new, setting 1", ""));
    cr_expect_eq(c.changes[CHANGE_NONE], 1);
    cr_expect_eq(c.changes[CHANGE_WORSE], 4);
    compare_free(&c);
    compare(&c, 0.01, 0);
    cr_expect(has(&c, CHANGE_WORSE, "rk4, setting 0.2", "error 0.0021"));
    cr_expect(has(&c, CHANGE_BETTER, "rk4, setting 0.1", "force_evaluations 90"));
    cr_expect(!has(&c, CHANGE_WORSE, "rk4, setting 0.1", "cpu"));
    compare_free(&c);
}

Test(compare, claims_that_no_longer_hold_are_worse, .init = set_up) {
    static const char head[] = "# found\nkey\tfigure\tstatement\tverdict\tvalue\n";
    char text[2][512];
    struct comparison c;
    snprintf(text[0], 512, "%sa\tx\tIt is 1.\tholds\t1\nb\tx\tIt is so.\tdoes not hold\t2\n", head);
    snprintf(text[1], 512, "%sb\tx\tIt is so.\tholds\t3\na\ty\tIt is 2.\ttells nothing\t1\n", head);
    put(older, "one", "statements.tsv", text[0]);
    put(newer, "one", "statements.tsv", text[1]);
    put(older, "one", "lines.tsv", "# x\nx\ty\n1\t2\n");
    put(newer, "one", "lines.tsv", "# x\nx\ty\n1\t3\n");
    compare(&c, 0.1, 1);
    cr_expect(has(&c, CHANGE_WORSE, "a", "verdict 'tells nothing', was 'holds'"));
    cr_expect(has(&c, CHANGE_BETTER, "b", "verdict 'holds'"));
    cr_expect(c.count == 2 && c.table_count == 2 && c.left_out == 1);
    compare_free(&c);
}

/* Of rows about the same the first is joined with the first; which one it is stands in its name. */
Test(compare, rows_about_the_same_are_joined_in_their_order, .init = set_up) {
    static const char head[] = "# front\nmethod\tt\terror\n";
    struct comparison c;
    char text[2][512];
    snprintf(text[0], 512, "%srk4\t0\t1\neuler\t0\t1\nrk4\t0\t2\nrk4\t0\t3\nrk4\t1\t3\n", head);
    snprintf(text[1], 512, "%srk4\t1\t3\nrk4\t0\t1\nrk4\t0\t9\neuler\t0\t1\neuler\t0\t1\n", head);
    put(older, "race", "lines.tsv", text[0]);
    put(newer, "race", "lines.tsv", text[1]);
    compare(&c, 0.1, 1);
    cr_expect(has(&c, CHANGE_WORSE, "rk4, t 0, no. 2", "error 9 m, was 2"));
    cr_expect(has(&c, CHANGE_VANISHED, "rk4, t 0, no. 3", ""));
    cr_expect(has(&c, CHANGE_APPEARED, "euler, t 0, no. 2", ""));
    cr_expect(c.count == 3 && c.changes[CHANGE_NONE] == 3, "%d, %d", c.count,
              c.changes[CHANGE_NONE]);
    compare_free(&c);
    put(older, "race", "lines.tsv",
        "# no keys\nx\terror\n0\t1\n1\t1\n"); /* nor an order but theirs */
    put(newer, "race", "lines.tsv", "# no keys\nx\terror\n0\t1\n1\t2\n");
    compare(&c, 0.1, 1);
    cr_expect(c.count == 1 && has(&c, CHANGE_WORSE, "row 2", "error 2 m, was 1"));
    compare_free(&c);
}

/* A hundred thousand rows, in another order, of which each is there four times. */
Test(compare, many_rows_take_no_longer_than_reading_them, .init = set_up, .timeout = 20) {
    enum { ROWS = 100000 };
    char *text[2];
    size_t used[2] = {0, 0};
    struct comparison c;
    for (int side = 0; side < 2; side++) {
        text[side] = test_room(40 * (ROWS + 1));
        used[side] = (size_t)sprintf(text[side], "method\tsetting\terror\n");
        for (int i = 0; i < ROWS; i++)
            used[side] += (size_t)sprintf(text[side] + used[side], "rk4\t%d\t%d\n",
                                          (side ? ROWS - 1 - i : i) % (ROWS / 4), side && i == 7);
    }
    put(older, "race", "lines.tsv", text[0]);
    put(newer, "race", "lines.tsv", text[1]);
    compare(&c, 0.1, 1);
    cr_expect(c.count == 1 &&
                  has(&c, CHANGE_WORSE, "rk4, setting 24992, no. 1", "error 1 m, was 0"),
              "%d: %s", c.count, c.count ? c.differences[0].row : "");
    compare_free(&c);
}

/* Rows are known by all that was varied, whatever their numbers are. */
Test(compare, sweeps_are_compared, .init = set_up) {
    static const char head[] = "# sweep of swing\nrun\tstepper\tmaterial.drag_rate\trate\tstatus\t"
                               "error_rms\tforce_evaluations\tcpu_seconds\treason\n";
    struct comparison c;
    char text[2][1024];
    snprintf(text[0], 1024,
             "%s1\trk4\t2\t900\tfinished\t1e-3\t10\t1\t\n2\trk4\t3\t900\tfinished\t1e-3\t10\t1\t\n"
             "3\tbdf2\t3\t900\tfinished\t1e-3\t10\t1\t\n",
             head);
    snprintf(text[1], 1024,
             "%s1\trk4\t3\t900\tdiverged\tnan\t10\t9\tx\n2\trk4\t2\t900\tfinished\t1e-3\t12\t9\t\n",
             head);
    put(older, ".", "table.tsv", text[0]);
    put(newer, ".", "table.tsv", text[1]);
    put(older, "runs", "packed-0.tsv", "no table\n");
    put(newer, "runs", "packed-0.tsv", "no table either");
    compare(&c, 0.1, 1);
    cr_expect(has(&c, CHANGE_WORSE, "rk4, material.drag_rate 3, rate 900", "status 'diverged'"));
    cr_expect(has(&c, CHANGE_WORSE, "rk4, material.drag_rate 3, rate 900", "error_rms nan"));
    cr_expect(has(&c, CHANGE_WORSE, "rk4, material.drag_rate 2, rate 900",
                  "force_evaluations 12 evaluations, was 10"));
    cr_expect(has(&c, CHANGE_VANISHED, "bdf2, material.drag_rate 3, rate 900", ""));
    cr_expect(c.count == 4 && c.table_count == 1, "%d, %d", c.count, c.table_count);
    compare_free(&c);
}

/* What cannot be compared is told by name, with why, and is neither well nor ill for a program. */
Test(compare, tables_in_which_nothing_is_looked_at_are_told, .init = set_up) {
    for (int side = 0; side < 2; side++) {
        const char *of = side ? newer : older;
        put(of, "race", "slopes.tsv", side ? "method\tslope\nrk4\t4\n" : "method\tslope\nrk4\t3\n");
        put(of, "race", "times.tsv", "method\tcpu_median\nrk4\t1\n");
        put(of, "race", "none.tsv", "method\terror\n");
        put(of, "race", "good.tsv", "method\terror\nrk4\t1\n");
    }
    const char *const path = printed("%s/compare.xml", root);
    const struct finished *f = WORKS("compare", older, newer, "--no-times", "--junit", path);
    must_contain(f->out,
                 WORDS("left out: race/slopes: has no column that is looked at\n",
                       "left out: race/times: of what is looked at it has only CPU times",
                       "left out: race/none: has no rows\n", "1 tables: 1 rows are as they were",
                       "tables left out: 3\n"),
                 9);
    must_contain(file_read(path),
                 WORDS("tests=\"4\" failures=\"0\" skipped=\"3\"",
                       "name=\"race/slopes\"><skipped message=\"has no column"),
                 9);
}

/* A row, a column that is looked at, one that rows are known by, a table: told, and worse for who
 * asks for it. */
Test(compare, what_vanished_is_told, .init = set_up) {
    put(older, "race", "swing.tsv",
        "method\tsetting\terror\tforce_evaluations\trk\nrk4\t1\t1\t1\t1\neuler\t1\t1\t1\t1\n");
    put(newer, "race", "swing.tsv", "method\terror\nrk4\t1\n");
    put(older, "race", "wind.tsv", POINTS);
    put(newer, "race", "shake.tsv", POINTS);
    const char *const path = printed("%s/compare.xml", root);
    for (int complete = 0; complete < 2; complete++) {
        const struct finished *f =
            PROGRAM(NULL, "compare", older, newer, "--junit", path, complete ? "--complete" : NULL);
        cr_assert_eq(f->code, complete ? 4 : 0, "exit code %d: %s", f->code, f->err);
        must_contain(f->out,
                     WORDS("vanished  race/swing: column setting\n",
                           "vanished  race/swing: column force_evaluations\n",
                           "vanished  race/swing: euler\n",
                           "vanished  race/wind: the whole table\n",
                           "appeared  race/shake: the whole table\n",
                           "appeared 1, vanished 4; tables left out: 0\n"),
                     9);
        must_contain(
            file_read(path),
            WORDS(complete ? "failures=\"2\" skipped=\"1\"" : "failures=\"0\" skipped=\"2\""), 1);
    }
}

/* A longest stable step is found, not asked for, and the longer the better. */
Test(compare, a_shorter_stable_step_is_worse, .init = set_up) {
    static const char columns[] = "scene\tstepper\tstep\trate\tunstable_step\tmm_step\n";
    struct comparison c;
    put(older, "stability", "largest-step.tsv",
        printed("%sswing\trk4\t4e-4\t2500\t5e-4\t2e-4\n", columns));
    put(newer, "stability", "largest-step.tsv",
        printed("%sswing\trk4\t2e-4\t5000\t3e-4\t3e-4\n", columns));
    compare(&c, 0.05, 1);
    cr_expect(has(&c, CHANGE_WORSE, "swing, rk4", "step 0.0002 s, was 0.0004"));
    cr_expect(has(&c, CHANGE_BETTER, "swing, rk4", "mm_step 0.0003 s, was 0.0002"));
    cr_expect_eq(c.count, 2);
    compare_free(&c);
}

/* Exit code 4 where something is worse and only there; the other program's file is well-formed and
 * counts the tables. */
Test(compare, exit_code_and_junit_say_it, .init = set_up) {
    put_points();
    put(older, "race", "good.tsv", POINTS "a<b\t1\tfinished\t1\t1\t1\t1\t1\n");
    put(newer, "race", "good.tsv", POINTS "a<b\t1\tfinished\t1\t1\t1\t1\t1\n");
    const char *const path = printed("%s/compare.xml", root);
    const struct finished *f = PROGRAM(NULL, "compare", older, newer, "--junit", path);
    cr_assert_eq(f->code, 4, "exit code %d: %s", f->code, f->err);
    cr_assert(strstr(f->out, "worse     race/swing: rk4, setting 0.1: error 0.002 m, was 0.001"),
              "%s", f->out);
    cr_assert(strstr(f->out, "2 tables: 2 rows are as they were; worse 4, better 4, appeared 1, "
                             "vanished 1; tables left out: 0\n"),
              "%s", f->out);
    char *xml = file_read(path);
    cr_assert(strstr(xml, "tests=\"2\" failures=\"1\"") && strstr(xml, "name=\"race/good\"/>") &&
                  strstr(xml, "<failure message=\"4 worse\">"),
              "%s", xml);
    WORKS("compare", older, older);
    WORKS("compare", newer, newer);
}

Test(compare, folders_without_a_common_table_are_refused, .init = set_up) {
    FAILS(1, "/nowhere/at/all: No such file", "compare", older, "/nowhere/at/all");
    put(older, "race", "swing.tsv", POINTS);
    FAILS(1, "have no table in common", "compare", older, newer);
    put(older, "race", "slopes.tsv", "method\tslope\nrk4\t4\n");
    put(newer, "race", "slopes.tsv", "method\tslope\nrk4\t4\n");
    FAILS(1, "no table in common in which anything is looked at", "compare", older, newer);
    put(newer, "race", "swing.tsv", "# only a comment\n");
    FAILS(1, "swing.tsv", "compare", older, newer);
}
