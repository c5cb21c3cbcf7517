/* What experiments found: the one table of it, and that terminal, captions and report say the same.
 */
#include "experiments/common/statements.h"

#include "experiments/common/output.h"
#include "experiments/registry.h"
#include "report/report.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *folder;

static void set_up(void) {
    folder = folder_make();
}

/* Writes one row and reads it back. */
static void write_and_read(struct statement row, const char *sentence, struct text_table *rows) {
    struct statements statements;
    char reason[REASON_SIZE];
    cr_assert_eq(statements_open(&statements, folder, NULL, NULL, reason), 0, "%s", reason);
    statements_add(&statements, row, "%s", sentence);
    cr_assert_eq(statements_close(&statements, 0, reason), 0, "%s", reason);
    statements_must_be_read(rows, folder);
    cr_assert_eq(rows->row_count, 1);
}

static void cell_is(const struct text_table *rows, const char *column, const char *text) {
    cr_assert_str_eq(text_table_cell(rows, 0, column), text, "%s", column);
}

Test(statements, a_row_is_read_as_it_was_written, .init = set_up) {
    struct text_table rows;
    write_and_read((struct statement){.key = "far",
                                      .figure = "orbits",
                                      .tables = "table orbits",
                                      .answers = ANSWERS_CHOICE,
                                      .verdict = HOLDS_NOT,
                                      .by = THESIS,
                                      .value = 0.1,
                                      .unit = "mm"},
                   "Euler is far: it is 0.1 mm away.", &rows);
    cell_is(&rows, "key", "far");
    cell_is(&rows, "figure", "orbits");
    cell_is(&rows, "question", "choice");
    cell_is(&rows, "statement", "Euler is far: it is 0.1 mm away.");
    cell_is(&rows, "verdict", "does not hold");
    cr_assert_eq(text_table_number(&rows, 0, "value"), 0.1);
    cell_is(&rows, "unit", "mm");
    cell_is(&rows, "by", "thesis");
    cell_is(&rows, "tables", "table orbits");
}

/* What a user's names and libraries' messages may hold; and what a row leaves out. */
Test(statements, no_text_breaks_a_row_and_no_cell_is_empty, .init = set_up) {
    struct text_table rows;
    write_and_read((struct statement){.key = "a\tkey", .value = NAN, .unit = "mm"},
                   "Two\nlines\tand a tab.", &rows);
    cell_is(&rows, "key", "a key");
    cell_is(&rows, "statement", "Two lines and a tab.");
    cell_is(&rows, "verdict", "holds");
    cell_is(&rows, "by", "ours");
    static const char *const nothing[] = {"figure", "question", "value", "unit", "tables"};
    for (int i = 0; i < 5; i++)
        cell_is(&rows, nothing[i], "-");
}

#define HEAD "key\tfigure\tquestion\tstatement\tverdict\tvalue\tunit\tby\ttables\n"

Test(statements, what_is_no_row_is_refused_in_one_line, .init = set_up) {
    static const struct {
        const char *text, *says;
    } wrong[] = {
        {HEAD "a\t-\t-\tIt is so.\tperhaps\t-\t-\tours\t-\n", "verdict"},
        {HEAD "a\t-\t-\t\tholds\t-\t-\tours\t-\n", "statement"},
        {HEAD "a\t-\t-\tIt is so.\tholds\tnan\t-\tours\t-\n", "value"},
        {HEAD "a\t-\t-\tIt is so.\tholds\t-\t-\tthesis\t-\n", "statement"},
        {"key\tstatement\tverdict\na\tIt is so.\tholds\n", "figure"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct text_table rows;
        char reason[REASON_SIZE];
        file_write(folder, "statements.tsv", wrong[i].text);
        cr_assert_eq(statements_read(&rows, folder, reason), -1, "text %zu", i);
        cr_assert(strstr(reason, "statements.tsv: row 1") && strstr(reason, wrong[i].says), "%s",
                  reason);
    }
}

Test(statements, what_failed_leaves_no_table, .init = set_up) {
    struct statements statements;
    char reason[REASON_SIZE];
    cr_assert_eq(statements_open(&statements, folder, NULL, NULL, reason), 0, "%s", reason);
    cr_assert_eq(statements_close(&statements, 1, reason), 1);
    cr_assert_eq(count_files(folder, ""), 0);
}

/* --- one answer in one place --- */

/* A text as a page has it. */
static void escape(const char *text, char escaped[2048]) {
    static const char *const letters[][2] = {
        {"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}};
    for (*escaped = '\0'; *text; text++) {
        const char letter[2] = {*text, '\0'};
        const char *as = letter;
        for (int i = 0; i < 4; i++)
            if (strcmp(letters[i][0], letter) == 0)
                as = letters[i][1];
        strcat(escaped, as);
    }
}

/* The page of one experiment's folder. */
static char *page_of(const char *name) {
    struct report report = {.root = folder, .quick = 1, .part_count = 1};
    char reason[REASON_SIZE];
    report.parts[0] = (struct report_part){.experiment = experiment_find(name), .included = 1};
    cr_assert_eq(report_write(&report, reason), 0, "%s", reason);
    return file_read(printed("%s/report.html", folder));
}

/* Whether a row's figure is a link on the page, with its sentences beside it. */
static int is_linked(const struct text_table *rows, int row) {
    const char *figure = text_table_cell(rows, row, "figure");
    return strncmp(figure, "diagnostics", strlen("diagnostics")) == 0;
}

/* A row as the page has it: of the thesis's claims a row of a table, with what was found and the
 * verdict, which are those of the row; else an item of a list. */
static const char *item_of(const struct text_table *rows, int row) {
    const char *sentence = text_table_cell(rows, row, "statement"),
               *verdict = text_table_cell(rows, row, "verdict"),
               *finding = statement_finding(sentence);
    char claim[2048], text[2048];
    if (strcmp(text_table_cell(rows, row, "by"), "thesis") == 0) {
        escape(sentence, claim);
        *strstr(claim, ": ") = '\0';
        escape(finding, text);
        return printed(
            "<tr><td>%s</td><td>%s</td><td><span class=\"verdict%s\">%s</span></td></tr>", claim,
            text, strcmp(verdict, "does not hold") == 0 ? " fails" : "", verdict);
    }
    escape(sentence, text);
    if (strcmp(verdict, "holds") == 0 || strcmp(verdict, "does not hold") == 0)
        return printed("<li>%s</li>", text);
    return printed("<li><span class=\"verdict\">%s</span> %s</li>", verdict, text);
}

/* How often a row is the title of a figure. */
static int titles_of(const char *page, const struct text_table *rows, int row) {
    char text[2048];
    escape(text_table_cell(rows, row, "statement"), text);
    const char *const title = printed("<p class=\"claim\">%.*s <a", (int)strlen(text) - 1, text);
    return count_of(page, title);
}

/* The lines of an experiment on the terminal are the rows of its table, one by one, and so are the
 * titles of figures, items and claims of its part of the report, and those of the answers. */
Test(statements, slow_terminal_captions_and_report_say_the_same, .init = set_up) {
    struct text_table rows;
    struct finished *f =
        WORKS("experiment", "viscosity", "--quick", "--no-progress", "--out", folder);
    statements_must_be_read(&rows, printed("%s/viscosity", folder));
    char *page = page_of("viscosity");
    int asked = 0;
    for (int row = 0; row < rows.row_count; row++) {
        const char *sentence = text_table_cell(&rows, row, "statement"),
                   *verdict = text_table_cell(&rows, row, "verdict"),
                   *by = text_table_cell(&rows, row, "by");
        const int answer = strcmp(text_table_cell(&rows, row, "question"), "-") != 0;
        asked += answer;
        const char *item = printed("  %-13s  %-6s  %s\n", verdict, by, sentence);
        cr_assert_eq(count_of(f->out, item), 1, "the terminal has not once: %s", item);
        item = item_of(&rows, row);
        cr_assert_eq(count_of(page, item) + titles_of(page, &rows, row),
                     is_linked(&rows, row) ? 0 : 1 + answer, "the page has not: %s", item);
    }
    cr_assert_gt(asked, 0, "nothing answers a question of the report");
    cr_assert_eq(count_of(f->out, "\n  "), rows.row_count, "the terminal says more: %s", f->out);
}

/* --- the circle's claims --- */

static void circle_says(const char *key, const char *verdict, double value) {
    struct text_table rows;
    statements_must_be_read(&rows, printed("%s/circle", folder));
    must_state(&rows, key, verdict, NULL);
    const double is = text_table_number(&rows, the_row(&rows, key), "value");
    cr_assert(isnan(value) ? isnan(is) : fabs(is / value - 1) < 1e-3, "%s: %g, not %g", key, is,
              value);
}

/* What was not asked for and what no run reached are no verdicts on the thesis; what there is has
 * the numbers that were worked out by hand. */
Test(statements, claims_on_the_circle_follow_its_runs, .init = set_up) {
    gnuplot_stub_quiet();
    WORKS("experiment", "circle", "--quick", "--stepper", "rk4", "--stepper", "euler", "--out",
          folder, "--no-progress");
    circle_says("explicit Euler", "holds", 20.211);
    circle_says("Runge-Kutta 4", "holds", 0.03710);
    circle_says("Runge-Kutta 4, not at all", "does not hold", 0.06646);
    circle_says("Runge-Kutta 4, speed", "holds", 0.06257);
    circle_says("explicit Euler, shorter steps", "holds", 0.04556);
    circle_says("explicit Euler, projected", "holds", 0.9);
    circle_says("explicit Euler, projected, gap", "holds", 0.32901);
    circle_says("explicit Euler, fine", "holds", 0.04556);
    circle_says("midpoint", "not asked", NAN);
    WORKS("experiment", "circle", "--quick", "--fresh", "--stepper", "rk4", "--out", folder,
          "--no-progress", "--time-limit", "0.0001");
    circle_says("Runge-Kutta 4", "not reached", NAN);
    circle_says("explicit Euler", "not asked", NAN);
}

/* --- what is written --- */

static int is_there(const char *name) {
    return file_exists(printed("%s/%s.tsv", folder, name));
}

/* Tables and statements get their names together: none where something failed, and the tables alone
 * where there is nothing to state. */
Test(statements, what_is_written_appears_together) {
    static const struct column columns[] = {{"x", "1", "a number"}, {0}};
    static const struct {
        int code, tables, statements;
    } ends[] = {{-1, 0, 0}, {1, 1, 0}, {0, 1, 1}};
    char reason[REASON_SIZE];
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        folder = folder_make();
        struct output output = {.folder = folder, .reason = reason};
        cr_assert(output_table(&output, "one", "numbers", NULL, columns), "%s", reason);
        cr_assert(output_table(&output, "other", "numbers", NULL, columns), "%s", reason);
        cr_assert_eq(output_statements(&output, NULL, NULL), 0, "%s", reason);
        cr_assert(!is_there("one"), "it is not complete yet");
        cr_expect_eq(output_close(&output, ends[i].code), ends[i].code);
        cr_expect_eq(is_there("one"), ends[i].tables, "%d", ends[i].code);
        cr_expect_eq(is_there("other"), ends[i].tables, "%d", ends[i].code);
        cr_expect_eq(is_there("statements"), ends[i].statements, "%d", ends[i].code);
    }
}
