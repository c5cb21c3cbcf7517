/* Every table says what its columns are, also to other people's readers. */
#include "base/columns.h"

#include "base/text_table.h"
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static char *folder;

static void set_up(void) {
    folder = folder_make();
}

#define COLUMNS_OF_TWO(X)                                  \
    X("method", "-", "who, of " METHODS, "%s", names[i])   \
    X("cost", "s", "what it took", "%.17g", (double)i / 3) \
    X("share", "%", "of 100 %, by a function of two", "%d", sum(i, 1))
#define METHODS "two"

static int sum(int a, int b) {
    return a + b;
}

/* A row has the cells that its list names, and a meaning may be made of several texts. */
Test(columns, one_list_makes_comments_names_and_rows) {
    static const char *const names[] = {"one", "other"};
    char *text;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    columns_write(stream, COLUMNS(COLUMNS_OF_TWO));
    for (int i = 0; i < 2; i++)
        WRITE_ROW(stream, COLUMNS_OF_TWO);
    fclose(stream);
    cr_assert_str_eq(text, "# method, -: who, of two\n"
                           "# cost, s: what it took\n"
                           "# share, %: of 100 %, by a function of two\n"
                           "method\tcost\tshare\n"
                           "one\t0\t1\n"
                           "other\t0.33333333333333331\t2\n");
    free(text);
}

/* Every problem in every treatment, so that no column of a state is unknown. */
Test(columns, tables_of_a_run_say_what_they_hold, .init = set_up) {
    static const char *const runs[][2] = {
        {"circle", "free"},
        {"swing-envelope", "projection"},
        {"swing-envelope", "penalty"},
        {"swing-envelope", "generalised"},
        {"anjyo", "free"},
        {"rosenblum", "free"},
    };
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        const int has_energies = i != 0 && i < 4;
        const char *const saved = printed("%s/saved-%zu.tsv", folder, i);
        WORKS("run", runs[i][0], "--stepper", "rk4", "--treatment", runs[i][1], "--duration",
              i ? "0.04" : "40", "--out", folder, "--save", saved, "--no-progress",
              has_energies ? "--diagnostics" : "--threads=1");
        columns_must_be_described(saved);
        const char *path = printed("%s/states.tsv", folder);
        columns_must_be_described(path);
        path = printed("%s/diagnostics.tsv", folder);
        if (has_energies)
            columns_must_be_described(path);
        struct finished *f = WORKS("eval", runs[i][0], "--treatment", runs[i][1]);
        path = file_write(folder, "accelerations.tsv", f->out);
        columns_must_be_described(path);
    }
}
