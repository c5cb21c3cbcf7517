/* Every table says what its columns are, also to other people's readers. */
#include "base/columns.h"

#include "base/text_table.h"
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static char folder[PATH_SIZE];

static void set_up(void) {
    folder_make(folder);
}

static void clean_up(void) {
    folder_remove(folder);
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
Test(columns, tables_of_a_run_say_what_they_hold, .init = set_up, .fini = clean_up) {
    static const char *const runs[][2] = {
        {"circle", "free"},
        {"swing-envelope", "projection"},
        {"swing-envelope", "penalty"},
        {"swing-envelope", "generalised"},
        {"anjyo", "free"},
        {"rosenblum", "free"},
    };
    static struct finished f;
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        char path[PATH_SIZE], saved[PATH_SIZE];
        const int has_energies = i != 0 && i < 4;
        path_format(saved, "%s/saved-%zu.tsv", folder, i);
        PROGRAM(&f, NULL, "run", runs[i][0], "--stepper", "rk4", "--treatment", runs[i][1],
                "--duration", i ? "0.04" : "40", "--out", folder, "--save", saved, "--no-progress",
                has_energies ? "--diagnostics" : "--threads=1");
        cr_assert_eq(f.code, 0, "%s: %s", runs[i][0], f.err);
        columns_must_be_described(saved);
        path_format(path, "%s/states.tsv", folder);
        columns_must_be_described(path);
        path_format(path, "%s/diagnostics.tsv", folder);
        if (has_energies)
            columns_must_be_described(path);
        PROGRAM(&f, NULL, "eval", runs[i][0], "--treatment", runs[i][1]);
        cr_assert_eq(f.code, 0, "%s: %s", runs[i][0], f.err);
        file_write(folder, "accelerations.tsv", f.out, path);
        columns_must_be_described(path);
    }
}
