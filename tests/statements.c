/* What experiments found: the one table of it, and that terminal, captions and report say the same.
 */
#include "experiments/common/statements.h"

#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

static char folder[PATH_SIZE];

static void set_up(void) {
    folder_make(folder);
}

static void clean_up(void) {
    folder_remove(folder);
}

/* Writes one row and reads it back. */
static void write_and_read(struct statement row, const char *sentence, struct text_table *rows) {
    struct statements statements;
    char reason[REASON_SIZE];
    cr_assert_eq(statements_open(&statements, folder, NULL, NULL, reason), 0, "%s", reason);
    statements_add(&statements, row, "%s", sentence);
    cr_assert_eq(statements_close(&statements, 0, reason), 0, "%s", reason);
    cr_assert_eq(statements_read(rows, folder, reason), 0, "%s", reason);
    cr_assert_eq(rows->row_count, 1);
}

static void cell_is(const struct text_table *rows, const char *column, const char *text) {
    cr_assert_str_eq(text_table_cell(rows, 0, column), text, "%s", column);
}

Test(statements, a_row_is_read_as_it_was_written, .init = set_up, .fini = clean_up) {
    struct text_table rows;
    write_and_read((struct statement){.key = "far",
                                      .figure = "orbits",
                                      .tables = "table orbits",
                                      .answers = ANSWERS_CHOICE,
                                      .verdict = HOLDS_NOT,
                                      .by = THESIS,
                                      .value = 0.1,
                                      .unit = "mm"},
                   "Euler is 0.1 mm away.", &rows);
    cell_is(&rows, "key", "far");
    cell_is(&rows, "figure", "orbits");
    cell_is(&rows, "question", "choice");
    cell_is(&rows, "statement", "Euler is 0.1 mm away.");
    cell_is(&rows, "verdict", "does not hold");
    cr_assert_eq(text_table_number(&rows, 0, "value"), 0.1);
    cell_is(&rows, "unit", "mm");
    cell_is(&rows, "by", "thesis");
    cell_is(&rows, "tables", "table orbits");
    text_table_free(&rows);
}

/* What a user's names and libraries' messages may hold; and what a row leaves out. */
Test(statements, no_text_breaks_a_row_and_no_cell_is_empty, .init = set_up, .fini = clean_up) {
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
    text_table_free(&rows);
}

#define HEAD "key\tfigure\tquestion\tstatement\tverdict\tvalue\tunit\tby\ttables\n"

Test(statements, what_is_no_row_is_refused_in_one_line, .init = set_up, .fini = clean_up) {
    static const struct {
        const char *text, *says;
    } wrong[] = {
        {HEAD "a\t-\t-\tIt is so.\tperhaps\t-\t-\tours\t-\n", "verdict"},
        {HEAD "a\t-\t-\t\tholds\t-\t-\tours\t-\n", "statement"},
        {HEAD "a\t-\t-\tIt is so.\tholds\tnan\t-\tours\t-\n", "value"},
        {"key\tstatement\tverdict\na\tIt is so.\tholds\n", "figure"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct text_table rows;
        char reason[REASON_SIZE];
        file_write(folder, "statements.tsv", wrong[i].text, NULL);
        cr_assert_eq(statements_read(&rows, folder, reason), -1, "text %zu", i);
        cr_assert(strstr(reason, "statements.tsv: row 1") && strstr(reason, wrong[i].says), "%s",
                  reason);
    }
}

Test(statements, what_failed_leaves_no_table, .init = set_up, .fini = clean_up) {
    struct statements statements;
    char reason[REASON_SIZE];
    cr_assert_eq(statements_open(&statements, folder, NULL, NULL, reason), 0, "%s", reason);
    cr_assert_eq(statements_close(&statements, 1, reason), 1);
    cr_assert_eq(count_files(folder, ""), 0);
}
