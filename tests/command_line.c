/* The program as a user meets it: what is wrong is said in one line, with the right exit code. */
#include "base/hash.h"
#include "build_info.h"
#include "command/commands.h"
#include "integrators/stepper.h"
#include "support.h"

#include <criterion/criterion.h>
#include <jansson.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { WORDS_MAX = 12 };

/* Wrong commands: exit code 1, nothing on standard output, nothing written, and the words that the
 * user needs in one line. */
static const struct {
    const char *words[WORDS_MAX];
    const char *says[3];
} wrong[] = {
    {{"fly"}, {"fly", "--help"}},
    {{"run"}, {"missing", "usage"}},
    {{"run", "circle", "circle"}, {"one word too many"}},
    {{"run", "circle", "--steper", "rk4"}, {"--steper", "did you mean --stepper"}},
    {{"run", "circle", "--xyzzy"}, {"no option --xyzzy"}},
    {{"run", "circle", "--step"}, {"--step needs a value"}},
    {{"run", "circle", "--no-progress=1"}, {"takes no value"}},
    {{"run", "circle", "--step", "1", "--step", "2"}, {"too often"}},
    {{"run", "circle", "--stepper", "rk5"}, {"rk5", "list steppers"}},
    {{"run", "circle", "--treatment", "loose"}, {"loose", "free, projection, generalised"}},
    {{"run", "circle", "--stepper", "implicit-euler", "--linear", "lapack"}, {"lapack", "linear"}},
    {{"run", "circle", "--option", "speed=1"}, {"speed", "rk4"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "speed=1"}, {"speed", "cvode", "direct"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "method=bfd"}, {"bfd", "bdf, adams"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "max_order"}, {"no value", "max_order"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "max_order=1.5"}, {"whole number"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "max_order=13"}, {"0 to 12"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "max_order=9"}, {"bdf", "9"}},
    {{"run", "circle", "--step", "0"}, {"--step", "positive"}},
    {{"run", "circle", "--step", "-1"}, {"--step", "positive"}},
    {{"run", "circle", "--step", "nan"}, {"--step", "positive"}},
    {{"run", "circle", "--step", "inf"}, {"--step", "positive"}},
    {{"run", "circle", "--step", "1e999"}, {"--step", "positive"}},
    {{"run", "circle", "--step", "1e-300"}, {"--step 1e-300", "steps"}},
    {{"run", "circle", "--step", "1e-9"}, {"1e+08", "frame_rate", "--states none"}},
    {{"run", "circle", "--step", "big"}, {"--step big", "positive"}},
    {{"run", "circle", "--step", "1s"}, {"--step 1s", "positive"}},
    {{"run", "circle", "--step", ""}, {"--step needs a value"}},
    {{"run", "circle", "--save="}, {"--save needs a value: --save FILE"}},
    {{"run", "circle", "--rate", "0"}, {"--rate", "positive"}},
    {{"run", "circle", "--step", "1", "--rate", "1"}, {"--step", "--rate"}},
    {{"run", "circle", "--stepper", "cvode", "--step", "1"}, {"--step", "--rtol"}},
    {{"run", "circle", "--stepper", "cvode", "--rate", "9"}, {"--rtol"}},
    {{"run", "circle", "--rtol", "1e-3"}, {"--rtol", "fixed steps", "--step"}},
    {{"run", "circle", "--atol", "1e-3"}, {"--atol", "fixed steps"}},
    {{"run", "circle", "--stepper", "reference", "--rtol", "-1"}, {"--rtol", "positive"}},
    {{"run", "circle", "--linear", "klu"}, {"rk4", "leave out --linear"}},
    {{"run", "circle", "--stepper", "implicit-euler", "--linear", "cg"},
     {"cg", "symmetric", "df/dv"}},
    {{"run", "circle", "--stepper", "cvode", "--linear", "cholmod"},
     {"cholmod", "symmetric", "df/dv"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "jacobian=spd"}, {"no spd Jacobian"}},
    {{"run", "circle", "--stepper", "cvode", "--option", "method=adams", "--treatment",
      "projection"},
     {"adams", "constraint"}},
    {{"report", "--jobs", "1.5"}, {"--jobs", "whole number"}},
    {{"report", "circle"}, {"one word too many", "usage"}},
    {{"run", "circle", "--duration", "0"}, {"--duration", "positive"}},
    {{"run", "circle", "--duration", "long"}, {"--duration long", "positive"}},
    {{"run", "circle", "--time-limit", "0"}, {"--time-limit", "positive"}},
    {{"run", "circle", "--memory-limit", "-3"}, {"--memory-limit", "positive"}},
    {{"run", "circle", "--threads", "1.5"}, {"--threads", "whole"}},
    {{"run", "circle", "--draw", "2"}, {"--draw 2", "--perturb", "not given"}},
    {{"run", "swing", "--set", "wisps.[9].nodes=3"},
     {"the last entry of wisps is [0]; write wisps.[0].nodes=3"}},
    {{"run", "swing", "--set", "wisps[0].nodes=3"}, {"write wisps.[0].nodes=3"}},
    {{"run", "swing", "--set", "wisps.0.nodes=3"}, {"write wisps.[0].nodes=3"}},
    {{"run", "swing", "--set", "wisps.nodes=3"}, {"wisps.[0].nodes=5"}},
    {{"run", "swing", "--set", "wisps.[0].walk.step=3"}, {"no group wisps.[0].walk"}},
    {{"run", "square"}, {"square.cfg", "no such scene"}},
    {{"run", "/nowhere/at/all.cfg"}, {"/nowhere/at/all.cfg", "no such scene"}},
    {{"experiment", "square"}, {"square", "list experiments"}},
    {{"experiment"}, {"missing"}},
    {{"experiment", "circle", "--shard", "1/2"}, {"no option --shard"}},
    {{"experiment", "circle", "--stepper", "rk5"}, {"rk5", "list steppers"}},
    {{"experiment", "circle", "--stepper", "rk4", "--stepper", "rk4"},
     {"--stepper rk4 is given twice"}},
    {{"experiment", "needs", "--scene", "swing", "--scene", "swing"},
     {"--scene swing is given twice"}},
    {{"experiment", "circle", "--scene", "circle"}, {"--scene"}},
    {{"plot", "square"}, {"square"}},
    {{"list", "colours"}, {"colours", "steppers"}},
};

Test(command_line, what_is_wrong_is_said_in_one_line) {
    const char *const folder = folder_make();
    const char *const out = printed("--out=%s", folder);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *words[WORDS_MAX + 2] = {wrong[i].words[0], out};
        int count = wrong[i].words[1] && strcmp(words[0], "list") != 0 ? 2 : 1;
        for (int k = 1; wrong[i].words[k]; k++)
            words[count++] = wrong[i].words[k];
        words[count] = NULL;
        const struct finished *f = program_must(NULL, 1, wrong[i].says[0], words);
        must_contain(f->err, wrong[i].says, 3);
        cr_assert_eq(f->out[0], '\0', "%s: prints %s", f->err, f->out);
        cr_assert_eq(count_files(folder, ""), 0, "%s: wrote something", f->err);
    }
}

/* An empty folder's name would be the root of the file system. */
Test(command_line, an_empty_folder_is_none) {
    static const char *const words[][2] = {{"run", "circle"},     {"experiment", "circle"},
                                           {"report", "--quick"}, {"plot", "all"},
                                           {"render", "swing"},   {"export", "states.tsv"}};
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const char *option = strcmp(words[i][0], "export") == 0 ? "--vtk" : "--out";
        const struct finished *f =
            program_must(&(struct launch){.folder = folder}, 1, "needs a value",
                         WORDS(words[i][0], words[i][1], option, ""));
        cr_assert(strstr(f->err, option), "%s", f->err);
        cr_assert_eq(count_files(folder, ""), 0, "%s: wrote something", words[i][0]);
    }
}

/* --- scene files --- */

static const struct {
    const char *text;
    const char *says[4];
} bad_scenes[] = {
    {"problem = \"circle\";\nduration = 1.0;\nspeed = 2.0;\n", {":3:", "speed", "unknown"}},
    {"problem = \"circle\";\nduration = 1.0;\nrun = { stp = 2.0; };\n", {":3:", "stp", "unknown"}},
    {"problem = \"circle\";\n", {"bad.cfg:", "duration", "missing"}},
    {"problem = \"circle\";\nduration = -1.0;\n", {":2:", "duration", "-1", "positive"}},
    {"problem = \"circle\";\nduration = 0;\n", {":2:", "duration", "positive"}},
    {"problem = \"circle\";\nduration = 1e999;\n", {":2:", "duration", "positive"}},
    {"problem = \"circle\";\nduration = \"long\";\n", {":2:", "duration", "positive number"}},
    {"problem = \"circle\";\nduration = true;\n", {":2:", "duration", "positive number"}},
    {"problem = \"circle\";\nduration = [1.0, 2.0];\n", {":2:", "duration", "positive number"}},
    {"problem = \"circle\";\nduration = 1.0;\nrun = 3;\n", {":3:", "run", "group"}},
    {"problem = \"circle\";\nduration = 1.0;\nrun = {\n step = 0.0;\n};\n", {":4:", "step"}},
    {"problem = \"circle\";\nduration = 1.0;\nframe_rate = -30.0;\n", {":3:", "frame_rate"}},
    {"problem = \"circle\";\nduration = 1.0;\nframe_rate = 1e16;\n", {":3:", "frame_rate", "1e15"}},
    {"problem = \"circle\";\nduration = 3.0;\nframe_rate = 1e9;\n",
     {":3:", "frame_rate", "3e+09 rows", "at most 3.3e+07 Hz would do"}},
    {"problem = \"circle\";\nduration = 1.0;\nseed = 1.5;\n", {":3:", "seed", "whole"}},
    {"problem = \"circle\";\nduration = 1.0;\nname = \"\";\n", {":3:", "name", "empty"}},
    {"problem = \"square\";\nduration = 1.0;\n", {":1:", "problem", "square"}},
    {"problem = 3;\nduration = 1.0;\n", {":1:", "problem", "text"}},
    {"problem = \"circle\";\nduration = 1.0\n = 3;\n", {":3:", "syntax error"}},
    {"problem = \"circle\";\nduration = ;\n", {":2:", "syntax error"}},
    {"problem = \"circle\";\nduration = 1.0;\nduration = 2.0;\n", {":3:", "duplicate"}},
};

/* file:line: name: reason, in one line; exit code 1; and nothing is written. */
Test(command_line, errors_in_scenes_say_where) {
    const char *const folder = folder_make();
    const char *const out = printed("%s/out", folder);
    for (size_t i = 0; i < sizeof bad_scenes / sizeof *bad_scenes; i++) {
        const char *const path = file_write(folder, "bad.cfg", bad_scenes[i].text);
        must_contain(FAILS(1, path, "run", path, "--out", out)->err, bad_scenes[i].says, 4);
        cr_assert_not(file_exists(out), "wrote something for\n%s", bad_scenes[i].text);
    }
}

Test(command_line, a_folder_or_an_empty_file_is_no_scene) {
    const char *const folder = folder_make();
    FAILS(1, "", "run", folder);
    FAILS(1, "", "run", file_write(folder, "empty.cfg", ""));
}

static void give_json_back(void *json) {
    json_decref(json);
}

static json_t *run_json(const char *folder) {
    json_error_t error;
    const char *const path = printed("%s/run.json", folder);
    json_t *json = json_load_file(path, 0, &error);
    cr_assert(json, "%s:%d: %s", path, error.line, error.text);
    test_owns(json, give_json_back);
    return json;
}

static const char *text_of(const json_t *json, const char *name) {
    const char *text = json_string_value(json_object_get(json, name));
    return text ? text : "(none)";
}

static double number_of(const json_t *json, const char *name) {
    const json_t *value = json_object_get(json, name);
    cr_assert(json_is_number(value), "%s is no number", name);
    return json_number_value(value);
}

Test(command_line, set_overrides_what_the_scene_says) {
    static const struct {
        const char *set, *says; /* says: NULL: taken */
    } sets[] = {
        {"duration=3.2", NULL},
        {"duration=2", NULL},
        {"run.step=0.5", NULL},
        {"frame_rate=2", NULL},
        {"duration", "path.to.setting=value"},
        {"=3", "path.to.setting=value"},
        {"walk.step=1", "no group walk"},
        {"duration.more=1", "no group duration"},
        {"speed=1", "speed: unknown"},
        {"run.speed=1", "speed: unknown"},
        {"duration=-1", "duration"},
        {"duration=abc", "duration"},
        {"duration=", "duration"},
        {"du ration=1", "not a setting's name"},
        {"duration=a\"b", "closing quote"},
        {"duration=[1", "cannot be read"},
    };
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        if (sets[i].says)
            FAILS(1, sets[i].says, "run", "circle", "--set", sets[i].set, "--out", folder);
        else
            WORKS("run", "circle", "--set", sets[i].set, "--out", folder);
    }
    WORKS("run", "circle", "--set", "run.step=2", "--set", "run.step=0.5", "--set", "duration=9",
          "--duration", "4", "--out", folder);
    json_t *json = run_json(folder);
    cr_assert_eq(number_of(json_object_get(json, "settings"), "step"), 0.5, "the last one counts");
    cr_assert_eq(number_of(json, "simulated_time"), 4, "--duration comes last");
    cr_assert_eq(number_of(json_object_get(json, "scene"), "duration"), 4, "scene not as it ran");
}

/* --- what a run leaves --- */

/* The steps that were taken, not those that were asked for: 53 to a frame of 1/60 s; of an adaptive
 * method those whose sum is the duration; of a run that ended before its first step none. */
Test(command_line, run_json_says_which_steps_were_taken) {
    const char *const folder = folder_make();
    PROGRAM(NULL, "run", "swing", "--rate", "3160", "--duration", "0.5", "--out", folder);
    json_t *json = run_json(folder);
    cr_assert_float_eq(number_of(json, "step_least"), 1 / 3180., 1e-15);
    cr_assert_float_eq(number_of(json, "step_largest"), 1 / 3180., 1e-15);
    PROGRAM(NULL, "run", "swing", "--stepper", "reference", "--duration", "0.5", "--out", folder);
    json = run_json(folder);
    const double steps = number_of(json_object_get(json, "counters"), "steps");
    const double least = number_of(json, "step_least"), largest = number_of(json, "step_largest");
    cr_assert(0 < least && least < 0.5 / steps && 0.5 / steps < largest && largest <= 1 / 60.,
              "steps of %g to %g s, %g s in the mean", least, largest, 0.5 / steps);
    struct finished *f =
        PROGRAM(NULL, "run", "swing", "--stepper", "implicit-euler", "--treatment", "penalty",
                "--step", "0.0166", "--option", "newton.iterations=2", "--out", folder);
    json = run_json(folder);
    cr_assert_eq(number_of(json_object_get(json, "counters"), "steps"), 0, "%s", f->err);
    cr_assert(f->code == 3 && json_is_null(json_object_get(json, "step_least")) &&
                  json_is_null(json_object_get(json, "step_largest")),
              "a step that was not taken");
}

Test(command_line, run_json_says_everything) {
    const char *const folder = folder_make();
    struct finished *f =
        WORKS("run", "circle", "--stepper", "implicit-euler", "--option", "newton.iterations=7",
              "--step", "0.8", "--linear", "klu", "--out", folder);
    cr_assert_eq(f->err[0], '\0', "a good run says %s", f->err);
    json_t *json = run_json(folder);
    cr_assert_str_eq(text_of(json, "status"), "finished");
    cr_assert_str_eq(text_of(json, "reason"), "");
    cr_assert(json_is_null(json_object_get(json, "failure_time")), "a failure time");
    cr_assert_eq(number_of(json, "simulated_time"), 160, "simulated time");
    cr_assert_eq(number_of(json, "frames"), 201, "frames");
    cr_assert_eq(number_of(json, "unknowns"), 2, "unknowns");
    cr_assert(number_of(json, "cpu_seconds") >= 0, "CPU time");
    cr_assert_eq(strlen(text_of(json, "scene_hash")), 16, "scene hash");
    cr_assert_eq(strlen(text_of(json, "run_hash")), 16, "run hash");
    const json_t *counters = json_object_get(json, "counters");
#define X(field, definition) number_of(counters, #field);
    COUNTERS(X)
#undef X
    cr_assert_eq(number_of(counters, "steps"), 200, "steps");
    const json_t *settings = json_object_get(json, "settings");
    cr_assert_str_eq(text_of(settings, "stepper"), "implicit-euler");
    cr_assert_str_eq(text_of(settings, "treatment"), "free");
    cr_assert_str_eq(text_of(settings, "linear"), "klu");
    cr_assert_eq(number_of(settings, "step"), 0.8, "step");
    const json_t *options = json_object_get(settings, "options");
    cr_assert_eq(number_of(options, "newton.iterations"), 7, "the option");
    cr_assert_str_eq(text_of(options, "jacobian"), "auto");
    const json_t *build = json_object_get(json, "build");
    static const char *const facts[] = {"version", "commit",    "compiler",
                                        "flags",   "libraries", "program_hash"};
    for (int i = 0; i < 6; i++)
        cr_assert(text_of(build, facts[i])[0] != '(', "build has no %s", facts[i]);
    cr_assert(number_of(json_object_get(json, "machine"), "cores") >= 1, "machine");

    const char *states = file_of(folder, "states.tsv");
    cr_assert(strstr(states, "\nt\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\tparent\n0\t0\t0\t0.9"),
              "states.tsv does not begin as promised");
    cr_assert_eq(count_lines(strstr(states, "\nt\twisp") + 1), 202, "%d rows and names",
                 count_lines(strstr(states, "\nt\twisp") + 1));
    cr_assert_eq(count_files(folder, ""), 2, "more than two files are left");
}

/* A failure of the integration: exit code 3, run.json says how and when, and the frames are kept.
 */
Test(command_line, a_failed_integration_is_a_result) {
    const char *const folder = folder_make();
    FAILS(3, "", "run", "circle", "--stepper", "implicit-euler", "--option", "newton.iterations=30",
          "--step", "5", "--out", folder);
    json_t *json = run_json(folder);
    cr_assert_str_eq(text_of(json, "status"), "solver stalled");
    cr_assert(strstr(text_of(json, "reason"), "30 iterations"), "%s", text_of(json, "reason"));
    const double when = number_of(json, "failure_time");
    cr_assert(when > 0 && when < 160, "failed at %g s", when);
    char *states = file_read(printed("%s/states.tsv", folder));
    cr_assert(states, "the frames are lost");
    cr_assert_eq(count_lines(strstr(states, "\nt\twisp") + 1), (int)number_of(json, "frames") + 1,
                 "frames counted and kept differ");
}

/* A limit that a timer rounds to 0 would be none, and only a kill would end the run. */
Test(command_line, the_shortest_time_limit_is_one) {
    const char *const folder = folder_make();
    struct finished *f =
        FAILS(3, "out of time", "run", "circle", "--duration", "5e6", "--step", "1e-3", "--set",
              "frame_rate=1", "--time-limit", "1e-9", "--out", folder);
    cr_assert(strstr(f->err, "limit of CPU time"), "%s", f->err);
    WORKS("run", "circle", "--time-limit", "1e300", "--memory-limit", "1e300", "--out", folder);
}

/* What is drawn is what a table says; half a table says something else. */
Test(command_line, tables_that_are_not_whole_are_not_drawn) {
    static const struct {
        const char *text, *says;
    } tables[] = {
        {"a\tb\n1\t2", "tsv:2: the last line is not complete"},
        {"a\tb\n1\t2\n3\n", "tsv:3: fewer cells than columns"},
        {"# nothing\n", "no column names"},
        {"", "no column names"},
    };
    const char *const folder = folder_make();
    const char *const part = printed("%s/circle", folder);
    const char *const odd = printed("%s/[a*]\\", folder); /* no pattern, but a name */
    cr_assert(mkdir(part, 0777) == 0 && mkdir(odd, 0777) == 0);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        file_write(part, "table.tsv", tables[i].text);
        file_write(odd, "diagnostics.tsv", tables[i].text);
        for (int k = 0; k < 2; k++)
            FAILS(1, tables[i].says, "plot", k ? odd : "circle", "--out", folder);
    }
    cr_assert_eq(count_files(folder, ""), 2, "something was written");
}

/* --- a machine that fails --- */

Test(command_line, a_folder_that_cannot_be_made_exits_2) {
    const char *const folder = folder_make();
    const char *const path = file_write(folder, "file", "");
    const char *const below = printed("%s/below", path);
    FAILS(2, path, "run", "circle", "--out", below);
    FAILS(2, "", "run", "circle", "--out", path);
    FAILS(2, "", "experiment", "circle", "--quick", "--out", below);
}

/* A device or a pipe would be gone, with a file in its place. */
Test(command_line, what_is_no_file_is_not_replaced) {
    struct stat status;
    const char *const folder = folder_make();
    const char *const pipe = printed("%s/pipe", folder);
    cr_assert_eq(mkfifo(pipe, 0666), 0);
    struct finished *f = FAILS(2, pipe, "run", "circle", "--out", folder, "--save", pipe);
    cr_assert(strstr(f->err, "cannot write"), "%s", f->err);
    cr_assert(stat(pipe, &status) == 0 && S_ISFIFO(status.st_mode), "it is gone");
    cr_assert_eq(count_files(folder, ".part"), 0, "half a file is left");
}

/* A limit on file sizes is a full disk that a test can have. At each size the disk is full in
 * another place: in the head of states.tsv, in its rows, in run.json. */
Test(command_line, a_full_disk_exits_2_and_leaves_no_half_file) {
    static const long sizes[] = {1, 100, 1000, 5000, 20000};
    for (int i = 0; i < 5; i++) {
        const char *const folder = folder_make();
        const struct finished *f = PROGRAM(&(struct launch){.file_limit = sizes[i]}, "run",
                                           "circle", "--step", "0.1", "--out", folder);
        cr_assert_eq(f->code, 2, "%ld bytes: exit code %d, %s", sizes[i], f->code, f->err);
        if (sizes[i] > 500) { /* else the message does not fit on the disk either */
            must_have_failed(f, 2, "cannot write");
            must_have_failed(f, 2, folder);
        }
        cr_assert_eq(count_files(folder, ""), 0, "%ld bytes: half a file is left", sizes[i]);
    }
    const char *const folder = folder_make(); /* states.tsv fits, and run.json does not */
    program_must(&(struct launch){.file_limit = 1000}, 2, "",
                 WORDS("run", "circle", "--step", "160", "--out", folder));
    cr_assert_eq(count_files(folder, "run.json") + count_files(folder, ".part"), 0,
                 "half a run.json is left");
}

Test(command_line, standard_output_that_is_full_exits_2) {
    program_must(&(struct launch){.to_dev_full = 1}, 2, "", WORDS("list"));
}

/* --- interruption --- */

static void add_bytes(const char *path, void *ctx) {
    struct stat status;
    *(long *)ctx += stat(path, &status) == 0 ? (long)status.st_size : 0;
}

static long bytes_below(const char *folder) {
    long bytes = 0;
    each_file(folder, add_bytes, &bytes);
    return bytes;
}

/* SIGINT while it runs: exit code 3, run.json complete and saying so, all rows complete. */
static void interrupt(int signal) {
    const char *const folder = folder_make();
    const struct process process =
        program_start(NULL, WORDS("run", "circle", "--duration", "5e6", "--step", "1e-3", "--set",
                                  "frame_rate=1", "--out", folder));
    for (int i = 0; i < 2000 && bytes_below(folder) < 5000; i++) /* until it is at work */
        wait_for(0.005);
    cr_assert_eq(count_files(folder, "") - count_files(folder, ".part"),
                 count_files(folder, ".lock"), "a file has its name before it is complete");
    kill(process.pid, signal);
    must_have_failed(program_wait(&process), 3, "");
    json_t *json = run_json(folder);
    cr_assert_str_eq(text_of(json, "status"), "interrupted");
    const double reached = number_of(json, "simulated_time");
    cr_assert(reached > 0 && reached < 5e6, "it reached %g s", reached);
    const char *states = file_of(folder, "states.tsv");
    cr_assert_eq(states[strlen(states) - 1], '\n', "the last row is not complete");
    cr_assert_eq(count_files(folder, ".part"), 0, "a half file is left");
}

Test(command_line, sigint_leaves_complete_files) {
    interrupt(SIGINT);
}

Test(command_line, sigterm_leaves_complete_files) {
    interrupt(SIGTERM);
}

/* --- help and lists --- */

Test(command_line, help_is_there_for_every_command) {
    struct finished *f;
    for (int i = 0; commands[i]; i++) {
        const char *name = commands[i]->name;
        f = WORKS(name, "--help");
        cr_assert(strstr(f->out, name) && strstr(f->out, "wisplab"), "%s --help says %s", name,
                  f->out);
        cr_assert_eq(f->err[0], '\0', "%s --help complains: %s", name, f->err);
    }
    f = WORKS("--help");
    for (int i = 0; commands[i]; i++) {
        cr_assert_eq(strstr(f->out, printed("\n  %s ", commands[i]->name)) != NULL,
                     !commands[i]->hidden, "--help and %s", commands[i]->name);
    }
    f = WORKS("--version");
    cr_assert(strncmp(f->out, "wisplab ", 8) == 0, "%s%s", f->out, f->err);
    f = program_done(NULL, WORDS(NULL));
    cr_assert(f->code == 0 && strstr(f->out, "usage"), "no words: %d, %s", f->code, f->out);
}

Test(command_line, lists_are_one_line_each) {
    static const char *const kinds[] = {"scenes", "steppers",    "treatments",
                                        "linear", "experiments", "settings"};
    struct finished *f;
    for (int i = 0; i < 6; i++) {
        f = WORKS("list", kinds[i]);
        int lines = 0;
        for (char *line = strtok(f->out, "\n"); line; line = strtok(NULL, "\n")) {
            const char *tab = strchr(line, '\t');
            cr_assert(tab && tab > line && tab[1] && !strchr(tab + 1, '\t'),
                      "list %s: '%s' is not name, tab, description", kinds[i], line);
            cr_assert(strcmp(kinds[i], "scenes") != 0 || line[strlen(line) - 1] == '.',
                      "list scenes: '%s' is no whole sentence", line);
            lines++;
        }
        cr_assert(lines > 0, "list %s is empty", kinds[i]);
    }
    f = PROGRAM(NULL, "list", "steppers");
    for (int i = 0; stepper_methods[i]; i++)
        cr_assert(strstr(f->out, stepper_methods[i]->name), "list lacks %s",
                  stepper_methods[i]->name);
    f = PROGRAM(NULL, "list", "linear");
    for (int i = 0; linear_methods[i]; i++)
        cr_assert(strstr(f->out, linear_methods[i]->name), "list lacks %s",
                  linear_methods[i]->name);
    f = PROGRAM(NULL, "list", "steppers", "-v");
    for (int i = 0; stepper_methods[i]; i++)
        for (const struct option_spec *o = stepper_methods[i]->options; o && o->name; o++)
            cr_assert(strstr(f->out, o->name), "list steppers -v lacks %s", o->name);
    f = PROGRAM(NULL, "list");
    for (int i = 0; i < 6; i++)
        cr_assert(strstr(f->out, kinds[i]), "list lacks %s", kinds[i]);
}

/* Conjugate gradients are the default that hair is known with, and expensive. */
Test(command_line, a_run_with_an_expensive_solver_names_the_cheap_one) {
    static const char *const says =
        "a step with --linear direct takes about 1/6 of the time of one";
    const char *const folder = folder_make();
    struct finished *f = WORKS("run", "swing-envelope", "--stepper", "implicit-euler", "--duration",
                               "0.01", "--out", folder);
    cr_assert(strstr(f->out, says), "%s%s", f->out, f->err);
    f = WORKS("run", "swing-envelope", "--stepper", "implicit-euler", "--linear", "direct",
              "--duration", "0.01", "--out", folder);
    cr_assert(!strstr(f->out, "--linear"), "%s%s", f->out, f->err);
    f = WORKS("run", "swing", "--duration", "0.01", "--out", folder);
    cr_assert(!strstr(f->out, "--linear"), "%s%s", f->out, f->err);
}

/* Who cites the program names the version that computed, and where each stepper comes from. */
Test(command_line, cite_names_version_and_sources) {
    struct finished *f = PROGRAM(NULL, "cite", "bdf2", "rk4");
    const char *version = printed("version = {%s}", WISPLAB_VERSION);
    cr_assert(f->code == 0 && strstr(f->out, version) &&
                  strstr(f->out, "@mastersthesis{plante1999,") &&
                  strstr(f->out, stepper_find("bdf2")->reference) &&
                  strstr(f->out, stepper_find("rk4")->reference),
              "%d: %s", f->code, f->out);
    char *citation = file_read(WISPLAB_TESTS_DIR "/../CITATION.cff"), title[200];
    const char *entry = strstr(f->out, "title   = {");
    cr_assert(citation && entry);
    version = printed("\nversion: %s\n", WISPLAB_VERSION);
    snprintf(title, sizeof title, "\ntitle: \"%.*s\"\n",
             (int)strcspn(entry + strlen("title   = {"), "}"), entry + strlen("title   = {"));
    cr_expect(strstr(citation, version) && strstr(citation, title), "CITATION.cff has not %s%s",
              version, title);
    const char *all[64] = {"cite"};
    for (int i = 0; stepper_methods[i]; i++)
        all[1 + i] = stepper_methods[i]->name;
    program_must(NULL, 0, NULL, all);
    const char *twice = WORKS("cite", "bdf2", "rk4", "bdf2")->out;
    cr_assert_eq(count_of(twice, "% bdf2: "), 1, "%s", twice);
    FAILS(1, "no stepper 'leapfrog'", "cite", "leapfrog");
}
