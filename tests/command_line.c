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

static void one_line(const struct finished *f, const char *what) {
    cr_assert_eq(count_lines(f->err), 1, "%s: %d lines on standard error:\n%s", what,
                 count_lines(f->err), f->err);
    cr_assert(strncmp(f->err, "wisplab: ", 9) == 0, "%s: '%s'", what, f->err);
}

static void run_words(const char *const *words, struct finished *f, char *what, size_t size) {
    const struct process process = program_start(NULL, words);
    size_t used = 0;
    what[0] = '\0';
    for (int i = 0; words[i] && used < size; i++)
        used += (size_t)snprintf(what + used, size - used, " %s", words[i]);
    program_wait(&process, f);
}

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
    char folder[PATH_SIZE], out[PATH_SIZE], what[400];
    folder_make(folder);
    path_format(out, "--out=%s", folder);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct finished f;
        const char *words[WORDS_MAX + 2] = {wrong[i].words[0], out};
        int count = wrong[i].words[1] && strcmp(words[0], "list") != 0 ? 2 : 1;
        for (int k = 1; wrong[i].words[k]; k++)
            words[count++] = wrong[i].words[k];
        words[count] = NULL;
        run_words(words, &f, what, sizeof what);
        cr_assert_eq(f.code, 1, "%s: exit code %d, %s", what, f.code, f.err);
        one_line(&f, what);
        cr_assert_eq(f.out[0], '\0', "%s: prints %s", what, f.out);
        for (int k = 0; k < 3 && wrong[i].says[k]; k++)
            cr_assert(strstr(f.err, wrong[i].says[k]), "%s: does not say '%s' but %s", what,
                      wrong[i].says[k], f.err);
        cr_assert_eq(count_files(folder, ""), 0, "%s: wrote something", what);
    }
    folder_remove(folder);
}

/* An empty folder's name would be the root of the file system. */
Test(command_line, an_empty_folder_is_none) {
    static const char *const words[][2] = {{"run", "circle"},     {"experiment", "circle"},
                                           {"report", "--quick"}, {"plot", "all"},
                                           {"render", "swing"},   {"export", "states.tsv"}};
    char folder[PATH_SIZE];
    folder_make(folder);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct finished f;
        const char *option = strcmp(words[i][0], "export") == 0 ? "--vtk" : "--out";
        PROGRAM(&f, &(struct launch){.folder = folder}, words[i][0], words[i][1], option, "");
        cr_assert_eq(f.code, 1, "%s: exit code %d, %s", words[i][0], f.code, f.err);
        one_line(&f, words[i][0]);
        cr_assert(strstr(f.err, option) && strstr(f.err, "needs a value"), "%s", f.err);
        cr_assert_eq(count_files(folder, ""), 0, "%s: wrote something", words[i][0]);
    }
    folder_remove(folder);
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
    char folder[PATH_SIZE], path[PATH_SIZE], out[PATH_SIZE];
    folder_make(folder);
    path_format(out, "%s/out", folder);
    for (size_t i = 0; i < sizeof bad_scenes / sizeof *bad_scenes; i++) {
        struct finished f;
        file_write(folder, "bad.cfg", bad_scenes[i].text, path);
        PROGRAM(&f, NULL, "run", path, "--out", out);
        cr_assert_eq(f.code, 1, "exit code %d for\n%s", f.code, bad_scenes[i].text);
        one_line(&f, bad_scenes[i].text);
        cr_assert(strstr(f.err, path), "no file in '%s'", f.err);
        for (int k = 0; k < 4 && bad_scenes[i].says[k]; k++)
            cr_assert(strstr(f.err, bad_scenes[i].says[k]), "'%s' does not say '%s' of\n%s", f.err,
                      bad_scenes[i].says[k], bad_scenes[i].text);
        cr_assert_not(file_exists(out), "wrote something for\n%s", bad_scenes[i].text);
    }
    folder_remove(folder);
}

Test(command_line, a_folder_or_an_empty_file_is_no_scene) {
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "run", folder);
    cr_assert_eq(f.code, 1, "exit code %d for a folder: %s", f.code, f.err);
    one_line(&f, "a folder as a scene");
    file_write(folder, "empty.cfg", "", path);
    PROGRAM(&f, NULL, "run", path);
    cr_assert_eq(f.code, 1, "exit code %d for an empty file: %s", f.code, f.err);
    one_line(&f, "an empty scene");
    folder_remove(folder);
}

static json_t *run_json(const char *folder) {
    char path[PATH_SIZE];
    json_error_t error;
    path_format(path, "%s/run.json", folder);
    json_t *json = json_load_file(path, 0, &error);
    cr_assert(json, "%s:%d: %s", path, error.line, error.text);
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
        const char *set;
        int code;
        const char *says;
    } sets[] = {
        {"duration=3.2", 0, NULL},
        {"duration=2", 0, NULL},
        {"run.step=0.5", 0, NULL},
        {"frame_rate=2", 0, NULL},
        {"duration", 1, "path.to.setting=value"},
        {"=3", 1, "path.to.setting=value"},
        {"walk.step=1", 1, "no group walk"},
        {"duration.more=1", 1, "no group duration"},
        {"speed=1", 1, "speed: unknown"},
        {"run.speed=1", 1, "speed: unknown"},
        {"duration=-1", 1, "duration"},
        {"duration=abc", 1, "duration"},
        {"duration=", 1, "duration"},
        {"du ration=1", 1, "not a setting's name"},
        {"duration=a\"b", 1, "closing quote"},
        {"duration=[1", 1, "cannot be read"},
    };
    char folder[PATH_SIZE];
    folder_make(folder);
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
        struct finished f;
        PROGRAM(&f, NULL, "run", "circle", "--set", sets[i].set, "--out", folder);
        cr_assert_eq(f.code, sets[i].code, "--set %s: exit code %d, %s", sets[i].set, f.code,
                     f.err);
        if (!sets[i].says)
            continue;
        one_line(&f, sets[i].set);
        cr_assert(strstr(f.err, sets[i].says), "--set %s: %s", sets[i].set, f.err);
    }
    struct finished f;
    PROGRAM(&f, NULL, "run", "circle", "--set", "run.step=2", "--set", "run.step=0.5", "--set",
            "duration=9", "--duration", "4", "--out", folder);
    json_t *json = run_json(folder);
    cr_assert_eq(number_of(json_object_get(json, "settings"), "step"), 0.5, "the last one counts");
    cr_assert_eq(number_of(json, "simulated_time"), 4, "--duration comes last");
    cr_assert_eq(number_of(json_object_get(json, "scene"), "duration"), 4, "scene not as it ran");
    json_decref(json);
    folder_remove(folder);
}

/* --- what a run leaves --- */

/* The steps that were taken, not those that were asked for: 53 to a frame of 1/60 s; of an adaptive
 * method those whose sum is the duration; of a run that ended before its first step none. */
Test(command_line, run_json_says_which_steps_were_taken) {
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "run", "swing", "--rate", "3160", "--duration", "0.5", "--out", folder);
    json_t *json = run_json(folder);
    cr_assert_float_eq(number_of(json, "step_least"), 1 / 3180., 1e-15);
    cr_assert_float_eq(number_of(json, "step_largest"), 1 / 3180., 1e-15);
    json_decref(json);
    PROGRAM(&f, NULL, "run", "swing", "--stepper", "reference", "--duration", "0.5", "--out",
            folder);
    json = run_json(folder);
    const double steps = number_of(json_object_get(json, "counters"), "steps");
    const double least = number_of(json, "step_least"), largest = number_of(json, "step_largest");
    cr_assert(0 < least && least < 0.5 / steps && 0.5 / steps < largest && largest <= 1 / 60.,
              "steps of %g to %g s, %g s in the mean", least, largest, 0.5 / steps);
    json_decref(json);
    PROGRAM(&f, NULL, "run", "swing", "--stepper", "implicit-euler", "--treatment", "penalty",
            "--step", "0.0166", "--option", "newton.iterations=2", "--out", folder);
    json = run_json(folder);
    cr_assert_eq(number_of(json_object_get(json, "counters"), "steps"), 0, "%s", f.err);
    cr_assert(f.code == 3 && json_is_null(json_object_get(json, "step_least")) &&
                  json_is_null(json_object_get(json, "step_largest")),
              "a step that was not taken");
    json_decref(json);
    folder_remove(folder);
}

Test(command_line, run_json_says_everything) {
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "run", "circle", "--stepper", "implicit-euler", "--option",
            "newton.iterations=7", "--step", "0.8", "--linear", "klu", "--out", folder);
    cr_assert_eq(f.code, 0, "%s", f.err);
    cr_assert_eq(f.err[0], '\0', "a good run says %s", f.err);
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
    json_decref(json);

    path_format(path, "%s/states.tsv", folder);
    char *states = file_read(path);
    cr_assert(states &&
                  strstr(states, "\nt\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\tparent\n0\t0\t0\t0.9"),
              "states.tsv does not begin as promised");
    cr_assert_eq(count_lines(strstr(states, "\nt\twisp") + 1), 202, "%d rows and names",
                 count_lines(strstr(states, "\nt\twisp") + 1));
    free(states);
    cr_assert_eq(count_files(folder, ""), 2, "more than two files are left");
    folder_remove(folder);
}

/* A failure of the integration: exit code 3, run.json says how and when, and the frames are kept.
 */
Test(command_line, a_failed_integration_is_a_result) {
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "run", "circle", "--stepper", "implicit-euler", "--option",
            "newton.iterations=30", "--step", "5", "--out", folder);
    cr_assert_eq(f.code, 3, "exit code %d", f.code);
    one_line(&f, "a stalled run");
    json_t *json = run_json(folder);
    cr_assert_str_eq(text_of(json, "status"), "solver stalled");
    cr_assert(strstr(text_of(json, "reason"), "30 iterations"), "%s", text_of(json, "reason"));
    const double when = number_of(json, "failure_time");
    cr_assert(when > 0 && when < 160, "failed at %g s", when);
    path_format(path, "%s/states.tsv", folder);
    char *states = file_read(path);
    cr_assert(states, "the frames are lost");
    cr_assert_eq(count_lines(strstr(states, "\nt\twisp") + 1), (int)number_of(json, "frames") + 1,
                 "frames counted and kept differ");
    free(states);
    json_decref(json);
    folder_remove(folder);
}

/* A limit that a timer rounds to 0 would be none, and only a kill would end the run. */
Test(command_line, the_shortest_time_limit_is_one) {
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "run", "circle", "--duration", "5e6", "--step", "1e-3", "--set",
            "frame_rate=1", "--time-limit", "1e-9", "--out", folder);
    cr_assert_eq(f.code, 3, "exit code %d: %s", f.code, f.err);
    one_line(&f, "a run out of time");
    cr_assert(strstr(f.err, "out of time") && strstr(f.err, "limit of CPU time"), "%s", f.err);
    PROGRAM(&f, NULL, "run", "circle", "--time-limit", "1e300", "--memory-limit", "1e300", "--out",
            folder);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    folder_remove(folder);
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
    char folder[PATH_SIZE], part[PATH_SIZE], odd[PATH_SIZE];
    folder_make(folder);
    path_format(part, "%s/circle", folder);
    path_format(odd, "%s/[a*]\\", folder); /* no pattern, but a name */
    cr_assert(mkdir(part, 0777) == 0 && mkdir(odd, 0777) == 0);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        struct finished f;
        file_write(part, "table.tsv", tables[i].text, NULL);
        file_write(odd, "diagnostics.tsv", tables[i].text, NULL);
        for (int k = 0; k < 2; k++) {
            PROGRAM(&f, NULL, "plot", k ? odd : "circle", "--out", folder);
            cr_assert_eq(f.code, 1, "exit code %d: %s", f.code, f.err);
            one_line(&f, tables[i].text);
            cr_assert(strstr(f.err, tables[i].says), "'%s' of\n%s", f.err, tables[i].text);
        }
    }
    cr_assert_eq(count_files(folder, ""), 2, "something was written");
    folder_remove(folder);
}

/* --- a machine that fails --- */

Test(command_line, a_folder_that_cannot_be_made_exits_2) {
    char folder[PATH_SIZE], path[PATH_SIZE], below[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    file_write(folder, "file", "", path);
    path_format(below, "%s/below", path);
    PROGRAM(&f, NULL, "run", "circle", "--out", below);
    cr_assert_eq(f.code, 2, "exit code %d", f.code);
    one_line(&f, "a folder below a file");
    cr_assert(strstr(f.err, path), "which folder? %s", f.err);
    PROGRAM(&f, NULL, "run", "circle", "--out", path);
    cr_assert_eq(f.code, 2, "exit code %d", f.code);
    one_line(&f, "a file as folder");
    PROGRAM(&f, NULL, "experiment", "circle", "--quick", "--out", below);
    cr_assert_eq(f.code, 2, "exit code %d", f.code);
    one_line(&f, "an experiment below a file");
    folder_remove(folder);
}

/* A device or a pipe would be gone, with a file in its place. */
Test(command_line, what_is_no_file_is_not_replaced) {
    char folder[PATH_SIZE], pipe[PATH_SIZE];
    struct finished f;
    struct stat status;
    folder_make(folder);
    path_format(pipe, "%s/pipe", folder);
    cr_assert_eq(mkfifo(pipe, 0666), 0);
    PROGRAM(&f, NULL, "run", "circle", "--out", folder, "--save", pipe);
    cr_assert_eq(f.code, 2, "exit code %d", f.code);
    one_line(&f, "a pipe as file");
    cr_assert(strstr(f.err, pipe) && strstr(f.err, "cannot write"), "%s", f.err);
    cr_assert(stat(pipe, &status) == 0 && S_ISFIFO(status.st_mode), "it is gone");
    cr_assert_eq(count_files(folder, ".part"), 0, "half a file is left");
    folder_remove(folder);
}

/* A limit on file sizes is a full disk that a test can have. At each size the disk is full in
 * another place: in the head of states.tsv, in its rows, in run.json. */
Test(command_line, a_full_disk_exits_2_and_leaves_no_half_file) {
    static const long sizes[] = {1, 100, 1000, 5000, 20000};
    for (int i = 0; i < 5; i++) {
        char folder[PATH_SIZE];
        struct finished f;
        folder_make(folder);
        PROGRAM(&f, &(struct launch){.file_limit = sizes[i]}, "run", "circle", "--step", "0.1",
                "--out", folder);
        cr_assert_eq(f.code, 2, "%ld bytes: exit code %d, %s", sizes[i], f.code, f.err);
        if (sizes[i] > 500) { /* else the message does not fit on the disk either */
            one_line(&f, "a full disk");
            cr_assert(strstr(f.err, "cannot write") && strstr(f.err, folder), "%s", f.err);
        }
        cr_assert_eq(count_files(folder, ""), 0, "%ld bytes: half a file is left", sizes[i]);
        folder_remove(folder);
    }
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder); /* states.tsv fits, and run.json does not */
    PROGRAM(&f, &(struct launch){.file_limit = 1000}, "run", "circle", "--step", "160", "--out",
            folder);
    cr_assert_eq(f.code, 2, "exit code %d, %s", f.code, f.err);
    one_line(&f, "no room for run.json");
    cr_assert_eq(count_files(folder, "run.json") + count_files(folder, ".part"), 0,
                 "half a run.json is left");
    folder_remove(folder);
}

Test(command_line, standard_output_that_is_full_exits_2) {
    struct finished f;
    PROGRAM(&f, &(struct launch){.to_dev_full = 1}, "list");
    cr_assert_eq(f.code, 2, "exit code %d", f.code);
    one_line(&f, "list > /dev/full");
}

/* --- interruption --- */

static void wait_a_little(double seconds) {
    nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * seconds)}, NULL);
}

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
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    const struct process process = program_start(
        NULL, (const char *const[]){"run", "circle", "--duration", "5e6", "--step", "1e-3", "--set",
                                    "frame_rate=1", "--out", folder, NULL});
    for (int i = 0; i < 2000 && bytes_below(folder) < 5000; i++) /* until it is at work */
        wait_a_little(0.005);
    cr_assert_eq(count_files(folder, "") - count_files(folder, ".part"),
                 count_files(folder, ".lock"), "a file has its name before it is complete");
    kill(process.pid, signal);
    program_wait(&process, &f);
    cr_assert_eq(f.code, 3, "exit code %d: %s", f.code, f.err);
    one_line(&f, "an interrupted run");
    json_t *json = run_json(folder);
    cr_assert_str_eq(text_of(json, "status"), "interrupted");
    const double reached = number_of(json, "simulated_time");
    cr_assert(reached > 0 && reached < 5e6, "it reached %g s", reached);
    json_decref(json);
    path_format(path, "%s/states.tsv", folder);
    char *states = file_read(path);
    cr_assert(states && states[strlen(states) - 1] == '\n', "the last row is not complete");
    free(states);
    cr_assert_eq(count_files(folder, ".part"), 0, "a half file is left");
    folder_remove(folder);
}

Test(command_line, sigint_leaves_complete_files) {
    interrupt(SIGINT);
}

Test(command_line, sigterm_leaves_complete_files) {
    interrupt(SIGTERM);
}

/* --- help and lists --- */

Test(command_line, help_is_there_for_every_command) {
    struct finished f;
    for (int i = 0; commands[i]; i++) {
        const char *name = commands[i]->name;
        PROGRAM(&f, NULL, name, "--help");
        cr_assert_eq(f.code, 0, "%s --help: exit code %d", name, f.code);
        cr_assert(strstr(f.out, name) && strstr(f.out, "wisplab"), "%s --help says %s", name,
                  f.out);
        cr_assert_eq(f.err[0], '\0', "%s --help complains: %s", name, f.err);
    }
    PROGRAM(&f, NULL, "--help");
    cr_assert_eq(f.code, 0, "exit code %d", f.code);
    for (int i = 0; commands[i]; i++) {
        char line[32];
        snprintf(line, sizeof line, "\n  %s ", commands[i]->name);
        cr_assert_eq(strstr(f.out, line) != NULL, !commands[i]->hidden, "--help and %s",
                     commands[i]->name);
    }
    PROGRAM(&f, NULL, "--version");
    cr_assert(f.code == 0 && strncmp(f.out, "wisplab ", 8) == 0, "--version says %s", f.out);
    const struct process process = program_start(NULL, (const char *const[]){NULL});
    program_wait(&process, &f);
    cr_assert(f.code == 0 && strstr(f.out, "usage"), "no words: %d, %s", f.code, f.out);
}

Test(command_line, lists_are_one_line_each) {
    static const char *const kinds[] = {"scenes", "steppers",    "treatments",
                                        "linear", "experiments", "settings"};
    struct finished f;
    for (int i = 0; i < 6; i++) {
        PROGRAM(&f, NULL, "list", kinds[i]);
        cr_assert_eq(f.code, 0, "list %s: exit code %d", kinds[i], f.code);
        int lines = 0;
        for (char *line = strtok(f.out, "\n"); line; line = strtok(NULL, "\n")) {
            const char *tab = strchr(line, '\t');
            cr_assert(tab && tab > line && tab[1] && !strchr(tab + 1, '\t'),
                      "list %s: '%s' is not name, tab, description", kinds[i], line);
            cr_assert(strcmp(kinds[i], "scenes") != 0 || line[strlen(line) - 1] == '.',
                      "list scenes: '%s' is no whole sentence", line);
            lines++;
        }
        cr_assert(lines > 0, "list %s is empty", kinds[i]);
    }
    PROGRAM(&f, NULL, "list", "steppers");
    for (int i = 0; stepper_methods[i]; i++)
        cr_assert(strstr(f.out, stepper_methods[i]->name), "list lacks %s",
                  stepper_methods[i]->name);
    PROGRAM(&f, NULL, "list", "linear");
    for (int i = 0; linear_methods[i]; i++)
        cr_assert(strstr(f.out, linear_methods[i]->name), "list lacks %s", linear_methods[i]->name);
    PROGRAM(&f, NULL, "list", "steppers", "-v");
    for (int i = 0; stepper_methods[i]; i++)
        for (const struct option_spec *o = stepper_methods[i]->options; o && o->name; o++)
            cr_assert(strstr(f.out, o->name), "list steppers -v lacks %s", o->name);
    PROGRAM(&f, NULL, "list");
    for (int i = 0; i < 6; i++)
        cr_assert(strstr(f.out, kinds[i]), "list lacks %s", kinds[i]);
}

/* Conjugate gradients are the default that hair is known with, and expensive. */
Test(command_line, a_run_with_an_expensive_solver_names_the_cheap_one) {
    static const char *const says =
        "a step with --linear direct takes about 1/6 of the time of one";
    struct finished f;
    char folder[PATH_SIZE];
    folder_make(folder);
    PROGRAM(&f, NULL, "run", "swing-envelope", "--stepper", "implicit-euler", "--duration", "0.01",
            "--out", folder);
    cr_expect(f.code == 0 && strstr(f.out, says), "%d: '%s'", f.code, f.out);
    PROGRAM(&f, NULL, "run", "swing-envelope", "--stepper", "implicit-euler", "--linear", "direct",
            "--duration", "0.01", "--out", folder);
    cr_expect(f.code == 0 && !strstr(f.out, "--linear"), "%d: '%s'", f.code, f.out);
    PROGRAM(&f, NULL, "run", "swing", "--duration", "0.01", "--out", folder);
    cr_expect(f.code == 0 && !strstr(f.out, "--linear"), "%d: '%s'", f.code, f.out);
    folder_remove(folder);
}

/* Who cites the program names the version that computed, and where each stepper comes from. */
Test(command_line, cite_names_version_and_sources) {
    struct finished f;
    char version[128];
    PROGRAM(&f, NULL, "cite", "bdf2", "rk4");
    snprintf(version, sizeof version, "version = {%s}", WISPLAB_VERSION);
    cr_assert(f.code == 0 && strstr(f.out, version) &&
                  strstr(f.out, "@mastersthesis{plante1999,") &&
                  strstr(f.out, stepper_find("bdf2")->reference) &&
                  strstr(f.out, stepper_find("rk4")->reference),
              "%d: %s", f.code, f.out);
    char *citation = file_read(WISPLAB_TESTS_DIR "/../CITATION.cff"), title[200];
    const char *entry = strstr(f.out, "title   = {");
    cr_assert(citation && entry);
    snprintf(version, sizeof version, "\nversion: %s\n", WISPLAB_VERSION);
    snprintf(title, sizeof title, "\ntitle: \"%.*s\"\n",
             (int)strcspn(entry + strlen("title   = {"), "}"), entry + strlen("title   = {"));
    cr_expect(strstr(citation, version) && strstr(citation, title), "CITATION.cff has not %s%s",
              version, title);
    free(citation);
    const char *all[64] = {"cite"};
    for (int i = 0; stepper_methods[i]; i++)
        all[1 + i] = stepper_methods[i]->name;
    const struct process process = program_start(NULL, all);
    program_wait(&process, &f);
    cr_assert_eq(f.code, 0, "all of them: %s", f.err);
    PROGRAM(&f, NULL, "cite", "bdf2", "rk4", "bdf2");
    const char *first = strstr(f.out, "% bdf2: ");
    cr_assert(f.code == 0 && first && !strstr(first + 1, "% bdf2: "), "twice: %s", f.out);
    PROGRAM(&f, NULL, "cite", "leapfrog");
    cr_assert(f.code == 1 && strstr(f.err, "no stepper 'leapfrog'") && count_lines(f.err) == 1,
              "%d: %s", f.code, f.err);
}
