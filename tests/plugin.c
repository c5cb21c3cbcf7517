/* Steppers from outside: README's plug-in, built against what is installed; two builds of one; and
 * those in which something is wrong. */
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PLUGINS WISPLAB_BUILD_DIR "/plugins/"

static char *folder;

static void set_up(void) {
    folder = folder_make();
    gnuplot_stub_quiet();
}

#define IN_FOLDER .init = set_up

/* A file of the folder without its # lines, for free. */
static char *numbers_of(const char *name) {
    char *text = file_read(printed("%s/%s", folder, name)), *to = text;
    cr_assert(text, "no %s", name);
    for (const char *line = text; *line;) {
        const size_t length = strcspn(line, "\n") + 1;
        if (*line != '#') {
            memmove(to, line, length);
            to += length;
        }
        line += length;
    }
    *to = '\0';
    return text;
}

/* --- README's --- */

/* The part of README between a line and the end of its block of code, for free. */
static char *block_of_readme(const char *first) {
    char *readme = file_read(WISPLAB_TESTS_DIR "/../README.md");
    char *from = strstr(readme, first);
    cr_assert(from, "README has no block that begins with %s", first);
    char *end = strstr(from, "\n```");
    cr_assert(end);
    return printed("%.*s", (int)(end - from) + 1, from);
}

/* The walk's file with the line more, and its CMakeLists.txt: both as README has them. */
static void write_walk(void) {
    char *method = block_of_readme("/* integrators/rosenbrock_euler.c */"),
         *cmake = block_of_readme("cmake_minimum_required("), *path = printed("%s/walk", folder);
    static const char last[] = "STEPPER_PLUGIN(rosenbrock_euler);\n";
    block_of_readme(last); /* it says so */
    mkdir(path, 0755);
    file_write(path, "rosenbrock_euler.c", printed("%s\n%s", method, last));
    file_write(path, "CMakeLists.txt", cmake);
}

/* Built against an installation, the stepper that another program has built in: the same bits. */
Test(plugin, slow_readmes_has_the_bits_that_it_has_built_in, IN_FOLDER, .timeout = 300) {
    const struct launch walk = {.program = WISPLAB_WALK};
    write_walk();
    SHELL("cd %s && " WISPLAB_CMAKE " --install " WISPLAB_BUILD_DIR " --prefix p && "
          "CC=" WISPLAB_CC " CFLAGS=-Werror " WISPLAB_CMAKE
          " -S walk -B b -D CMAKE_PREFIX_PATH=$PWD/p && " WISPLAB_CMAKE " --build b",
          folder);
    SHELL("cd %s && p/bin/wisplab run swing-envelope --plugin b/rosenbrock-euler.so "
          "--stepper rosenbrock-euler --rate 8000 --duration 0.1 --out from-outside --no-progress",
          folder);
    program_must(&walk, 0, NULL,
                 WORDS("run", "swing-envelope", "--stepper", "rosenbrock-euler", "--rate", "8000",
                       "--duration", "0.1", "--out", printed("%s/inside", folder),
                       "--no-progress"));
    char *one = numbers_of("from-outside/states.tsv"), *other = numbers_of("inside/states.tsv");
    cr_expect(strlen(one) > 1000 && strcmp(one, other) == 0, "other bits");
    /* where it is built in, it cannot come from outside too */
    program_must(
        &walk, 1, "another name",
        WORDS("list", "steppers", "--plugin", printed("%s/b/rosenbrock-euler.so", folder)));
}

/* --- what a run and an experiment make of one --- */

/* The text of `"key": "..."` in the folder's run.json. */
static void text_in_json(const char *run, const char *key, char *text, size_t size) {
    char *json = file_read(printed("%s/%s/run.json", folder, run));
    cr_assert(json, "no run.json of %s", run);
    const char *const wanted = printed("\"%s\": \"", key);
    const char *at = strstr(json, wanted);
    cr_assert(at, "%s: no %s", run, key);
    at += strlen(wanted);
    snprintf(text, size, "%.*s", (int)strcspn(at, "\""), at);
}

static void run_with(const char *plugin, const char *stepper, const char *name) {
    WORKS("run", "swing", "--plugin", plugin, "--stepper", stepper, "--rate", "9000", "--duration",
          "0.1", "--out", printed("%s/%s", folder, name), "--no-progress");
}

/* Two builds of a plug-in are two methods; what does not use it is what it was without. */
Test(plugin, two_builds_never_share_a_run, IN_FOLDER) {
    char one[64], again[64], other[64], built_in[64], without[64];
    run_with(PLUGINS "nothing.so", "own", "one");
    run_with(PLUGINS "nothing.so", "own", "again");
    run_with(PLUGINS "build.so", "own", "other");
    run_with(PLUGINS "build.so", "symplectic-euler", "built-in");
    text_in_json("one", "run_hash", one, sizeof one);
    text_in_json("again", "run_hash", again, sizeof again);
    text_in_json("other", "run_hash", other, sizeof other);
    cr_expect_str_eq(one, again);
    cr_expect_str_neq(one, other, "another build");
    text_in_json("one", "plugin", one, sizeof one);
    text_in_json("other", "plugin", other, sizeof other);
    cr_expect_str_neq(one, other, "the record does not say which build");
    PROGRAM(NULL, "run", "swing", "--stepper", "symplectic-euler", "--rate", "9000", "--duration",
            "0.1", "--out", printed("%s/without", folder), "--no-progress");
    text_in_json("built-in", "run_hash", built_in, sizeof built_in);
    text_in_json("without", "run_hash", without, sizeof without);
    cr_expect_str_eq(built_in, without, "a plug-in that a run does not use is no part of it");
    char *mine = numbers_of("one/states.tsv"), *own = numbers_of("without/states.tsv");
    cr_expect_str_eq(mine, own, "it is symplectic Euler");
}

static const char small_scene[] =
    "name = \"small\"; duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { };\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.1; nodes = 4; } "
    ");\n"
    "run = { step = 2.5e-4; rtol = 1e-4; atol = 1e-6; };\n";

/* How many runs an experiment with that plug-in did, of which new. */
static void race_with(const char *plugin, const char *stepper, int *runs, int *new_runs) {
    struct finished *f = WORKS("experiment", "work-precision", "--quick", "--scene",
                               file_write(folder, "small.cfg", small_scene), "--plugin", plugin,
                               "--stepper", stepper, "--out", folder, "--no-progress");
    const char *said = strstr(f->out, "work-precision: ");
    cr_assert(said && sscanf(said, "work-precision: %d runs, %d", runs, new_runs) == 2, "%s",
              f->out);
}

Test(plugin, is_in_an_experiments_rows_as_any_method, IN_FOLDER) {
    char hash[64] = "";
    int runs, fresh, finished = 0;
    race_with(PLUGINS "nothing.so", "own", &runs, &fresh);
    cr_expect(runs > 5 && fresh == runs, "%d of %d", fresh, runs);
    const char *const path = printed("%s/work-precision/small.tsv", folder);
    char *table = file_read(path);
    cr_assert(table);
    for (const char *line = table; (line = strstr(line, "\nown\tgeneralised\town\t")) != NULL;
         line++)
        finished += strstr(line, "\tfinished\t") < strchr(line + 1, '\n');
    cr_expect_gt(finished, 2, "%s", table);
    const char *said = strstr(table, "# plug-in with stepper own, hash ");
    cr_assert(said, "the table does not say where it comes from");
    sscanf(said, "# plug-in with stepper own, hash %60s", hash);
    race_with(PLUGINS "nothing.so", "own", &runs, &fresh);
    cr_expect(fresh == 0, "%d of %d are run again", fresh, runs);
    race_with(PLUGINS "build.so", "own", &runs, &fresh);
    table = file_read(path);
    cr_expect(fresh > 0 && !strstr(table, hash), "another build has the old one's runs: %d", fresh);
}

Test(plugin, is_listed_and_cited) {
    struct finished *f = WORKS("list", "steppers", "-v", "--plugin", PLUGINS "nothing.so");
    cr_assert(strstr(f->out, "\nown\tsymplectic Euler, from outside\n"), "%s%s", f->out, f->err);
    f = WORKS("cite", "own", "--plugin", PLUGINS "nothing.so");
    cr_assert(strstr(f->out, "own: Hairer, Lubich & Wanner"), "%s%s", f->out, f->err);
    FAILS(1, "no stepper 'own'", "run", "swing", "--stepper", "own");
}

/* --- what is wrong --- */

static const struct {
    const char *plugin, *says;
} faults[] = {
    {PLUGINS "version.so", "has version 2 of the stepper interface, not 1"},
    {PLUGINS "symbol.so", "exports no wisplab_plugin"},
    {PLUGINS "name.so", "its stepper is called 'rk4', as one of wisplab's own is"},
    {PLUGINS "table.so", "its stepper has no function step"},
    {PLUGINS "unknown.so", "undefined symbol: simulate"},
    {PLUGINS "load.so", "crashed, having loaded " PLUGINS "load.so"},
    {PLUGINS "refuse.so", "crashed, having loaded " PLUGINS "refuse.so"},
    {PLUGINS "exit.so", "exit.so: ends the program while it is loaded"},
    {PLUGINS "leave.so", "a plug-in has called exit; loaded are " PLUGINS "leave.so"},
    {PLUGINS "none.so", "No such file or directory"},
    {WISPLAB_TESTS_DIR "/../README.md", "invalid ELF header"},
    {"/dev/zero", "is no file"},
    {WISPLAB_TESTS_DIR, "is no file"},
};

Test(plugin, what_is_wrong_with_one_is_a_line, IN_FOLDER) {
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        struct finished *f =
            FAILS(1, faults[i].plugin, "run", "swing", "--plugin", faults[i].plugin, "--stepper",
                  "own", "--duration", "0.1", "--out", folder, "--no-progress");
        cr_assert(strstr(f->err, faults[i].says), "%s", f->err);
    }
    FAILS(1, "as another plug-in's is", "list", "--plugin", PLUGINS "nothing.so", "--plugin",
          PLUGINS "nothing.so");
}

/* What measures is a program of its own, which gets wisplab's plug-ins with their whole paths. */
Test(plugin, the_bench_takes_them_too, IN_FOLDER) {
    const struct launch bench = {.program = WISPLAB_BUILD_DIR "/wisplab-bench"};
    program_must(&bench, 1, "has version 2",
                 WORDS("kernel", "swing", folder, "--plugin", PLUGINS "version.so"));
    program_must(&bench, 1, "needs wisps with an envelope",
                 WORDS("kernel", "swing", folder, "--plugin", PLUGINS "nothing.so"));
}

/* A crash while it integrates is the run's result, and keeps what was there. */
Test(plugin, a_crash_in_a_step_is_a_result, IN_FOLDER) {
    char status[64];
    FAILS(3, "swing with own: crashed at t = ", "run", "swing", "--plugin", PLUGINS "step.so",
          "--stepper", "own", "--duration", "0.1", "--out", folder, "--no-progress");
    text_in_json(".", "status", status, sizeof status);
    cr_expect_str_eq(status, "crashed");
}

/* --- what is promised --- */

/* The program exports of its own what the installed headers declare, and nothing else: what the
 * linker says, in order. (The libraries' hooks, as malloc, are not the library's own.) */
Test(plugin, what_the_headers_declare_is_exported_and_nothing_else, IN_FOLDER) {
    const char *const exported =
        shell("nm -D --defined-only " WISPLAB_BUILD_DIR "/wisplab | sed 's/.* //' | sort -u "
              "> %s/exported; nm -g --defined-only " WISPLAB_BUILD_DIR
              "/libwisplab-core.a | sed -n 's/.* [TDRB] //p' | sort -u | comm -12 - %s/exported",
              folder, folder)
            ->out;
    const char *const declared =
        shell("tr -d ' {};' < " WISPLAB_BUILD_DIR "/plugin.exports | grep . | sort -u")->out;
    cr_assert(*exported && *declared);
#ifndef SANITIZED /* whose library is told more */
    cr_expect_str_eq(exported, declared);
#endif
    static const char *const promised[] = {"system_acceleration", "linear_solve",  "stepper_memory",
                                           "explicit_rk_step",    "newton_solve",  "option_value",
                                           "jacobian_choices",    "matrix_choices"};
    for (size_t i = 0; i < sizeof promised / sizeof *promised; i++)
        cr_expect(strstr(exported, promised[i]), "%s", promised[i]);
}
