/* Each allocation of the program, its libraries' included, fails once: exit code 2, one line, and
 * no file that lacks anything. Under sanitizers, which have their own allocator, there are no
 * tests. */
#include "support.h"

#include <criterion/criterion.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef SANITIZED

static char *folder;
static const char *good, *tried, *states;

/* The program with its allocations at WISPLAB_FAIL_ALLOCATION's mercy; what tests start besides is
 * not called wisplab. */
static void open_folder(void) {
    folder = folder_make();
    good = printed("%s/good", folder);
    tried = printed("%s/tried", folder);
    states = printed("%s/states", folder);
    gnuplot_stub_quiet();
    setenv("LD_PRELOAD", WISPLAB_FAIL_ALLOCATION, 1);
}

static void empty(const char *path) {
    char reason[REASON_SIZE];
    if (access(path, F_OK) == 0)
        folder_remove(path);
    cr_assert_eq(make_folder(path, reason), 0, "%s", reason);
}

/* Of run.json without its times and its hash of itself, which are others in each run. */
static char *lasting(char *text) {
    static const char *const passing[] = {"cpu_seconds", "seconds", "seal"};
    json_t *json = json_loads(text, 0, NULL);
    for (size_t i = 0; i < sizeof passing / sizeof *passing; i++)
        cr_assert_eq(json_object_del(json, passing[i]), 0, "no %s in %s", passing[i], text);
    char *all = json_dumps(json, JSON_SORT_KEYS);
    test_owns(all, free);
    json_decref(json);
    return all;
}

/* A file of a trial is as the good one, or has not its name yet. */
static void check_file(const char *path, void *ctx) {
    const char *name = path + strlen(tried), *what = ctx;
    if (strstr(name, ".part") || strstr(name, ".lock"))
        return;
    char *text = file_read(path), *other = file_read(printed("%s%s", good, name));
    cr_assert(text && other, "%s: there is a %s", what, name);
    if (strstr(name, "run.json")) {
        text = lasting(text);
        other = lasting(other);
    }
    cr_assert_str_eq(text, other, "%s: %s lacks something", what, name);
}

/* Lets the first allocation fail, then the second, until none is left; beyond 500, most of which
 * are of libraries that draw, some between. Without --out, words end with the option that takes a
 * folder.
 */
static void try_all(const char *const *words, int words_count) {
    const char *all[16];
    long n = 0;
    memcpy(all, words, (size_t)words_count * sizeof *words);
    for (int failing = 0; n == 0 || failing; n += n < 500 ? 1 : n / 50) {
        const char *const what = printed("%s, allocation %ld", words[0], n);
        setenv("WISPLAB_FAIL_ALLOCATION", printed("%ld", n), 1);
        const char *out = n == 0 ? good : tried;
        empty(out);
        all[words_count] = strcmp(words[words_count - 1], "swing") == 0 ? NULL : out;
        all[words_count + 1] = NULL;
        struct finished *f = program_done(NULL, all);
        failing = n == 0 || f->code != 0;
        cr_assert(n > 0 || f->code == 0, "%s: %s", what, f->err);
        if (n == 0)
            continue;
        cr_assert(f->code == (failing ? 2 : 0), "%s: exit code %d: %s", what, f->code, f->err);
        cr_assert_str_eq(f->err, failing ? "wisplab: out of memory\n" : "", "%s: '%s'", what,
                         f->err);
        each_file(tried, check_file, (char *)what);
    }
    cr_assert(n > 100, "only %ld allocations", n - 1);
    unsetenv("WISPLAB_FAIL_ALLOCATION");
}

#define TRY_ALL(...)                                            \
    do {                                                        \
        static const char *const words_[] = {__VA_ARGS__};      \
        try_all(words_, (int)(sizeof words_ / sizeof *words_)); \
    } while (0)

Test(exhausted, slow_runs, .init = open_folder, .timeout = 300) {
    TRY_ALL("run", "swing", "--duration", "0.01", "--no-progress", "--out");
}

Test(exhausted, slow_accelerations, .init = open_folder, .timeout = 300) {
    TRY_ALL("eval", "swing");
}

static void make_states(void) {
    WORKS("run", "swing-envelope", "--duration", "0.05", "--out", states);
}

Test(exhausted, slow_exports, .init = open_folder, .timeout = 300) {
    make_states();
    cr_assert_eq(chdir(folder), 0);
    TRY_ALL("export", "states", "--vtk");
}

Test(exhausted, slow_pictures, .init = open_folder, .timeout = 300) {
    make_states();
    cr_assert_eq(chdir(folder), 0);
    TRY_ALL("render", "states", "--frames", "1", "--size", "64x64", "--threads", "1",
            "--no-progress", "--out");
}

/* --- an experiment --- */

static int compare(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* An experiment that has its own runs, others' and tables: one allocation of each stack of calls.
 * Those that are there when all runs are, are tried so: that is quick. WISPLAB_ALL_STACKS is for
 * all steppers, for which there are twice as many, in many minutes. */
static struct finished *do_experiment(const char *out, const char *list, const char *fail) {
    const char *words[] = {"experiment", "circle",        "--quick",   "--jobs", "1", "--out",
                           out,          "--no-progress", "--stepper", "euler",  NULL};
    if (getenv("WISPLAB_ALL_STACKS"))
        words[8] = NULL;
    if (list)
        setenv("WISPLAB_LIST_STACKS", list, 1);
    if (fail)
        setenv("WISPLAB_FAIL_STACK", fail, 1);
    struct finished *f = program_done(NULL, words);
    unsetenv("WISPLAB_LIST_STACKS");
    unsetenv("WISPLAB_FAIL_STACK");
    return f;
}

/* The lines of a file, sorted, each once. Returns their number. */
static int read_stacks(const char *path, char ***stacks) {
    char *text = file_read(path);
    int count = 0, lines = count_lines(text);
    *stacks = test_room(((size_t)lines + 1) * sizeof **stacks);
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
        (*stacks)[count++] = line;
    qsort(*stacks, (size_t)count, sizeof **stacks, compare);
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (i == 0 || strcmp((*stacks)[i], (*stacks)[i - 1]) != 0)
            (*stacks)[kept++] = (*stacks)[i];
    return kept;
}

Test(exhausted, slow_experiments, .init = open_folder, .timeout = 3000) {
    char **stacks, **later;
    int unmet = 0;
    const char *const first = file_write(folder, "first", ""), *const again =
                                                                   file_write(folder, "again", "");
    cr_assert_eq(do_experiment(good, first, NULL)->code, 0);
    cr_assert_eq(do_experiment(good, again, NULL)->code, 0);
    const int count = read_stacks(first, &stacks), others = read_stacks(again, &later);
    cr_assert(count > 500 && others > 200, "only %d stacks and %d", count, others);
    for (int i = 0; i < count + others; i++) {
        char *stack = i < others ? later[i] : stacks[i - others];
        const int is_later = bsearch(&stack, later, (size_t)others, sizeof *later, compare) != NULL;
        if (i >= others && is_later)
            continue; /* has been tried */
        if (!is_later)
            empty(tried);
        const char *const failed = file_write(folder, "failed", "");
        const struct finished *f = do_experiment(is_later ? good : tried, failed, stack);
        char *met = file_read(failed);
        const int fails = *met != '\0'; /* some depend on who else is at work on the host */
        unmet += !fails;
        cr_assert_eq(f->code, fails ? 2 : 0, "stack %s: exit code %d: %s", stack, f->code, f->err);
        cr_assert(!fails || strcmp(f->err, "wisplab: out of memory\n") == 0, "stack %s: '%s'",
                  stack, f->err);
    }
    cr_assert_lt(unmet, count / 20, "%d of %d stacks were not there again", unmet, count);
    cr_assert_eq(new_runs(do_experiment(good, NULL, NULL), NULL), 0, "a run was lost");
}

#endif
