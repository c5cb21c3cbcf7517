/* wisplab run: one scene, one stepper, into one folder. */
#include "base/complain.h"
#include "base/memory.h"
#include "cli.h"
#include "integrators/configurations.h"
#include "model/problems.h"
#include "model/state.h"
#include "run/results.h"
#include "run/runs.h"
#include "run/warnings.h"
#include "scene/scene_load.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SETS_MAX = CLI_REPEATS_MAX + 1 };

static const struct cli_option options[] = {
    {"stepper", "NAME", "time integrator (default rk4; `wisplab list steppers`)", 0},
    {"treatment", "NAME", "how constraints are kept (default by stepper and scene)", 0},
    {"linear", "NAME", "linear solver of an implicit stepper (`wisplab list linear`)", 0},
    {"step", "H", "step of a fixed-step method, s", 0},
    {"rate", "HZ", "the same as a frequency: --step 1/HZ", 0},
    {"rtol", "R", "relative tolerance of an adaptive method", 0},
    {"atol", "A", "absolute tolerance of an adaptive method, m and m/s", 0},
    {"option", "KEY=VALUE", "an option of the stepper or solver (`wisplab list steppers -v`)",
     CLI_REPEATS},
    {"duration", "T", "simulated time, s, instead of the scene's", 0},
    {"set", "PATH=VALUE", "override a setting of the scene: --set run.step=0.1", CLI_REPEATS},
    {"perturb", "D", "displace the nodes' start at random, by D in the rms, m", 0},
    {"draw", "N", "which random displacement (default 1)", 0},
    {"threads", "N", "threads that share a scene's wisps (results do not depend on it)", 0},
    {"out", "DIR", "folder for states.tsv and run.json (default results)", 0},
    {"states", "FORMAT", "text: states.tsv (default), binary: states.npy, none: no states", 0},
    {"save", "FILE", "write the last frame there, for a scene's start or eval --state", 0},
    {"profile", NULL, "time every call to the model; printed, and in run.json", 0},
    {"diagnostics", NULL, "write diagnostics.tsv: energies, works, strain, contacts by frame", 0},
    CLI_PLUGIN_OPTION,
    CLI_LIMIT_OPTIONS,
    {0},
};

/* The request of the command line. Returns 0, or -1 having said why. */
static int read_request(const struct arguments *arguments, struct run_request *request) {
    double rate, draw;
    *request = (struct run_request){
        .stepper = argument_text(arguments, "stepper"),
        .treatment = argument_text(arguments, "treatment"),
        .linear = argument_text(arguments, "linear"),
        .profile = argument_given(arguments, "profile"),
        .diagnostics = argument_given(arguments, "diagnostics"),
    };
    request->options = argument_list(arguments, "option", &request->option_count);
    if (argument_positive(arguments, "step", 0, &request->step) ||
        argument_positive(arguments, "rate", 0, &rate) ||
        argument_positive(arguments, "rtol", 0, &request->rtol) ||
        argument_positive(arguments, "atol", 0, &request->atol) ||
        argument_positive(arguments, "perturb", 0, &request->perturbation) ||
        argument_positive(arguments, "draw", 1, &draw) ||
        argument_whole(arguments, "threads", 1, 1024, &request->threads) ||
        argument_states(arguments, STATES_TEXT, &request->states))
        return -1;
    if (draw != floor(draw) || draw > 1e9)
        return complain(-1, "--draw %g: must be a whole number up to 1e9", draw);
    if (argument_given(arguments, "draw") && request->perturbation == 0)
        return complain(-1, "--draw %g: says which of --perturb, which is not given", draw);
    request->draw = (int)draw;
    if (rate > 0 && request->step > 0)
        return complain(-1, "--step and --rate say the same thing; give one of them");
    if (rate > 0 && !isfinite(1 / rate))
        return complain(-1, "--rate %g: is too small", rate);
    if (rate > 0)
        request->step = 1 / rate;
    if (request->states != STATES_TEXT && argument_given(arguments, "save"))
        return complain(-1, "--save takes its frame from states.tsv; leave out --states");
    return 0;
}

static struct scene *load(const struct arguments *arguments, char *reason) {
    const char *sets[SETS_MAX];
    char duration[80];
    int count;
    const char *const *given = argument_list(arguments, "set", &count);
    const char *duration_text = argument_text(arguments, "duration");
    double value;

    for (int i = 0; i < count; i++)
        sets[i] = given[i];
    if (duration_text) {
        if (parse_real(duration_text, &value) || value <= 0) {
            fail_with(reason, "--duration %.60s: must be a positive number", duration_text);
            return NULL;
        }
        snprintf(duration, sizeof duration, "duration=%.17e", value);
        sets[count++] = duration;
    }
    return scene_load(arguments->words[0], sets, count, reason);
}

/* What is about to be computed: the size of the problem and its forces, and what the scene makes it
 * likely to miss. */
static void announce(const struct run_case *run) {
    const char *names[16];
    const int count = problem_terms(run->scene, names, 16);
    char terms[256] = "";
    for (int i = 0; i < count; i++) {
        strncat(terms, i ? ", " : " ", sizeof terms - strlen(terms) - 1);
        strncat(terms, names[i], sizeof terms - strlen(terms) - 1);
    }
    say("%s with %s (%s): %d unknowns;%s", run->scene->name, run->settings.method->name,
        run->scene->problem->treatments[run->settings.treatment].name, run->settings.unknowns,
        terms);
    json_t *warnings = scene_warnings(run->scene, &run->settings), *one;
    size_t i;
    json_array_foreach(warnings, i, one) complain(0, "warning: %s", json_string_value(one));
    json_decref(warnings);
}

/* The times that the run has written, a line each. */
static void print_profile(const char *folder) {
    struct run_files run;
    char reason[REASON_SIZE];
    const char *name;
    json_t *seconds;
    if (run_read(&run, folder, reason))
        return;
    printf("wall time, s\n");
    json_object_foreach(json_object_get(run.json, "seconds"), name, seconds)
        printf("  %-14s %10.6f\n", name, json_number_value(seconds));
    run_free(&run);
}

/* How and when a run failed, as it has written itself. */
static void say_failure(const struct run_case *run, enum outcome outcome) {
    struct run_files files;
    char reason[REASON_SIZE];
    if (run_read(&files, run->folder, reason)) {
        complain(0, "%s with %s: %s", run->scene->name, run->settings.method->name,
                 outcome_name(outcome));
        return;
    }
    complain(0, "%s with %s: %s at t = %g s: %s", run->scene->name, run->settings.method->name,
             outcome_name(outcome), run_number(&files, "failure_time"),
             json_string_value(json_object_get(files.json, "reason")));
    run_free(&files);
}

/* The configuration of the run's method as it is, but with that solver, or NULL. */
static const struct configuration *with_solver(const struct configuration *all,
                                               const struct run_case *run, const char *linear) {
    for (; all->name; all++)
        if (all->method == run->settings.method && !all->options && all->linear &&
            strcmp(all->linear, linear) == 0)
            return all;
    return NULL;
}

/* Where the model's own solver would do the same for much less, by the table of costs. */
static void suggest_solver(const struct run_case *run, const struct run_request *request) {
    static const char own[] = "direct";
    const struct linear_method *used = run->settings.stepper.linear;
    struct run_request other = *request;
    struct settings settings;
    char reason[REASON_SIZE];
    other.linear = own;
    if (!used || settings_resolve(run->scene, &other, &settings, reason))
        return;
    struct configuration *all =
        memory_needed(configurations_choose(CONFIGURATION_ANY, STEPPER_SOLVES));
    const struct configuration *expensive = with_solver(all, run, used->name),
                               *cheap = with_solver(all, run, own);
    if (expensive && cheap && expensive->cost > 2 * cheap->cost)
        say("%s: a step with --linear %s takes about 1/%.0f of the time of one with %s",
            run->scene->name, own, expensive->cost / cheap->cost, used->name);
    free(all);
}

static int report(const struct run_case *run, enum outcome outcome, const char *reason) {
    if (outcome == OUTPUT_FAILED)
        return complain(2, "%s", reason);
    if (outcome == FINISHED && run->settings.states == STATES_NONE)
        say("%s: finished; results in %s/run.json", run->scene->name, run->folder);
    else if (outcome == FINISHED)
        say("%s: finished; results in %s/states.%s and %s/run.json", run->scene->name, run->folder,
            run->settings.states == STATES_TEXT ? "tsv" : "npy", run->folder);
    else
        say_failure(run, outcome);
    return outcome_exit_code(outcome);
}

/* Saves the last state of a run that reached its end. */
static int save(const struct run_case *run, const char *file) {
    char states[PATH_SIZE], reason[REASON_SIZE];
    path_format(states, "%s/states.tsv", run->folder);
    return state_save(states, file, reason) ? complain(2, "%s", reason) : 0;
}

static int run_scene(const struct arguments *arguments) {
    char reason[REASON_SIZE];
    struct run_request request;
    struct run_limits limits;
    struct run_case run = {.sink = NULL};
    const char *file = argument_text(arguments, "save");
    int code = 1;

    if (read_request(arguments, &request) || argument_limits(arguments, 0, &limits))
        return 1;
    struct scene *scene = load(arguments, reason);
    if (!scene)
        return complain(errno == ENOMEM ? 2 : 1, "%s", reason);
    run.scene = scene;
    const int refused = settings_resolve(scene, &request, &run.settings, reason);
    if (refused) {
        code = complain(outcome_exit_code((enum outcome)refused), "%s", reason);
    } else if (path_format(run.folder, "%s", argument_or(arguments, "out", "results"))) {
        code = complain(1, "--out: the path of a folder is too long");
    } else if (file && strlen(file) >= PATH_SIZE) {
        code = complain(1, "--save: the path of a file is too long");
    } else {
        announce(&run);
        suggest_solver(&run, &request);
        const enum outcome outcome =
            runs_do_one(&run, &limits, !argument_given(arguments, "no-progress"), reason);
        code = report(&run, outcome, reason);
        if (file && outcome == FINISHED)
            code = save(&run, file);
        if (run.settings.profile)
            print_profile(run.folder);
    }
    scene_free(scene);
    return code;
}

const struct command run_command = {
    .name = "run",
    .usage = "SCENE [--stepper S] [--step H | --rate HZ | --rtol R] [--out DIR] ...",
    .summary = "advance a scene with one stepper",
    .details =
        "SCENE is the name of a shipped scene (`wisplab list scenes`) or a path to a .cfg file.\n"
        "\n"
        "  wisplab run circle --stepper rk4 --step 3.2 --out rk4\n"
        "  wisplab run circle --stepper euler --treatment projection --step 0.8\n"
        "  wisplab run circle --stepper implicit-euler --option newton.iterations=20\n"
        "  wisplab run circle --stepper cvode --option method=adams --rtol 1e-8\n"
        "  wisplab run circle --stepper reference\n"
        "  wisplab run swing --diagnostics\n"
        "\n"
        "Of several --set for one setting, and --option for one key, the last one counts.\n"
        "\n"
        "states.npy has the columns and rows of states.tsv as doubles: numpy.load reads it, and "
        "so\n"
        "do render, export, eval --state and a scene's start. The # lines of states.tsv say what\n"
        "each column is: name, unit, meaning.\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "scenes",
    .run = run_scene,
};
