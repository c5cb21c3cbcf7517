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
    const struct compare_request request = {older, newer, tolerance, with_times};
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
    cr_expect(c.count == 2 && c.table_count == 1 && c.keyless == 1);
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
                             "vanished 1"),
              "%s", f->out);
    char *xml = file_read(path);
    cr_assert(strstr(xml, "tests=\"2\" failures=\"1\"") && strstr(xml, "name=\"race/good\"/>") &&
                  strstr(xml, "<failure message=\"4 worse\">"),
              "%s", xml);
    WORKS("compare", older, older);
    WORKS("compare", newer, newer);
}

Test(compare, folders_without_a_common_table_are_refused, .init = set_up) {
    put(older, "race", "swing.tsv", POINTS);
    FAILS(1, "have no table in common", "compare", older, newer);
    put(newer, "race", "swing.tsv", "# only a comment\n");
    FAILS(1, "swing.tsv", "compare", older, newer);
}
