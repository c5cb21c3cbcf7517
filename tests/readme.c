/* README's walk: a stepper of one file and one line in the registry, in lists, runs and charts. The
 * program here is built of what README shows; its loops of tests are walk/... in ctest. */
#include "base/text_table.h"
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static const char name[] = "rosenbrock-euler";
static const struct launch walk = {.program = WISPLAB_WALK};
static char *folder;

static void set_up(void) {
    folder = folder_make();
}

/* Whether a table has a row in which all these are, as cells. */
static int has_row(const char *table, const char *const *cells) {
    struct text_table text;
    int found = 0;
    table_must_be_read(&text, folder, table);
    for (int i = 0; i < text.row_count && !found; i++) {
        found = 1;
        for (const char *const *wanted = cells; *wanted && found; wanted++) {
            found = 0;
            for (int k = 0; k < text.column_count; k++)
                found |= strcmp(text.cell[i * text.column_count + k], *wanted) == 0;
        }
    }
    return found;
}
#define HAS_ROW(table, ...) has_row(table, (const char *const[]){name, __VA_ARGS__, NULL})

/* Whether a chart names it in its legend, or says that it has more curves than it names. */
static int is_drawn(const char *figure) {
    char *text = file_read(printed("%s/%s.svg", folder, figure));
    cr_assert(text, "no figure %s", figure);
    return strstr(text, name) != NULL || strstr(text, "more, see the table") != NULL;
}

/* The files that README tells to read first, in a list "1. `path`: ...", are there and not long. */
Test(readme, the_ten_files_to_read_first_are_short) {
    enum { LINES_MOST = 300 };
    char listed[200];
    int number, count = 0, at_list = 0;
    const char *path = printed("%s/../README.md", WISPLAB_TESTS_DIR);
    char *readme = file_read(path), *left = readme;
    cr_assert(readme);
    for (char *line; (line = strsep(&left, "\n")) != NULL && count < 10;) {
        at_list |= strncmp(line, "Ten files to read first", 23) == 0;
        if (!at_list || sscanf(line, "%d. `%199[^`]`", &number, listed) != 2)
            continue;
        cr_assert_eq(number, ++count, "%s", line);
        path = printed("%s/../%s", WISPLAB_TESTS_DIR, listed);
        char *text = file_read(path);
        cr_assert(text, "%s is not there", listed);
        cr_expect_lt(count_lines(text), LINES_MOST, "%s", listed);
    }
    cr_assert_eq(count, 10);
}

Test(readme, the_stepper_is_in_the_list_and_runs, .init = set_up) {
    struct finished *f = program_must(&walk, 0, NULL, WORDS("list", "steppers"));
    cr_assert(strstr(f->out, name), "%s%s", f->out, f->err);
    const char *after = strstr(f->out, name);
    cr_assert(strstr(f->out, "rk4\t") < after && after < strstr(f->out, "implicit-euler\t"),
              "it is not where README puts it: %s", f->out);
    program_must(&walk, 0, NULL,
                 WORDS("run", "swing", "--stepper", name, "--rate", "8000", "--duration", "0.1",
                       "--out", folder));
}

/* It does not say STEPPER_PROJECTS, and so must not run where a projection belongs to every step.
 */
Test(readme, it_is_refused_where_a_constraint_is_projected, .init = set_up) {
    const struct finished *f = program_must(
        &walk, 1, name,
        WORDS("run", "circle", "--treatment", "projection", "--stepper", name, "--out", folder));
    cr_assert(strstr(f->err, "constraint"), "%s", f->err);
}

/* --- the experiments: what is asked for is nothing, and it is there --- */

static void experiment(const char *which, const char *scene) {
    program_must(&walk, 0, NULL,
                 WORDS("experiment", which, "--quick", "--out", folder, "--no-progress",
                       scene ? "--scene" : NULL, scene));
}

#define IN_FOLDER .init = set_up

Test(readme, slow_it_is_in_the_chart_of_accuracy_and_cost, IN_FOLDER, .timeout = 300) {
    experiment("work-precision", "swing");
    cr_assert(HAS_ROW("work-precision/swing", "generalised", "finished"));
    cr_assert(HAS_ROW("work-precision/swing-slopes", "generalised"), "too few points for a slope");
    cr_assert(is_drawn("work-precision/swing"));
}

Test(readme, slow_it_is_in_the_ladder, IN_FOLDER, .timeout = 300) {
    experiment("ladder", NULL);
    cr_assert(HAS_ROW("ladder/ladder", "90", "reached"));
    cr_assert(is_drawn("ladder/ladder"));
}

Test(readme, slow_it_is_in_the_circle, IN_FOLDER, .timeout = 300) {
    experiment("circle", NULL);
    cr_assert(HAS_ROW("circle/work-precision", "finished"));
    cr_assert(is_drawn("circle/work-precision"));
    cr_assert_not(HAS_ROW("circle/radius-predicted", name), "there is no table to predict it");
}

Test(readme, slow_its_news_is_counted, IN_FOLDER, .timeout = 300) {
    experiment("history", NULL);
    cr_assert(HAS_ROW("history/news", "skip springs", "solves", "same"));
    cr_assert_not(HAS_ROW("history/rates", "11"), "it is stable at all steps");
}

Test(readme, slow_it_is_in_stability_without_a_prediction, IN_FOLDER, .timeout = 300) {
    experiment("stability", "swing");
    cr_assert(HAS_ROW("stability/largest-step", "swing", "no prediction"));
    cr_assert(is_drawn("stability/regions") && is_drawn("stability/oscillator") &&
              is_drawn("stability/damping"));
}

Test(readme, slow_it_is_in_the_costs_of_chapter_5, IN_FOLDER, .timeout = 300) {
    experiment("viscosity", NULL);
    cr_assert(HAS_ROW("viscosity/steppers", "finished"));
    cr_assert(is_drawn("viscosity/cost"));
}
