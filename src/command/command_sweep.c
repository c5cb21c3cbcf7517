/* wisplab sweep: one scene over the product of settings and steppers, into one table. */
#include "base/complain.h"
#include "base/memory.h"
#include "cli.h"
#include "experiments/sweep/sweep.h"

#include <stdlib.h>
#include <string.h>

static const struct cli_option options[] = {
    {"vary", "NAME=VALUES",
     "what varies: rate=300,900 or rate=300..3000:10, or :log:10 (see below)", CLI_REPEATS},
    {"stepper", "NAME", "time integrators (default rk4)", CLI_DISTINCT},
    {"set", "PATH=VALUE", "override a setting of the scene in all runs", CLI_REPEATS},
    {"option", "KEY=VALUE", "an option of the steppers or solvers in all runs", CLI_REPEATS},
    {"treatment", "NAME", "how constraints are kept", 0},
    {"linear", "NAME", "linear solver of implicit steppers", 0},
    {"step", "H", "step of fixed-step methods, s", 0},
    {"rate", "HZ", "the same as a frequency", 0},
    {"rtol", "R", "relative tolerance of adaptive methods", 0},
    {"atol", "A", "absolute tolerance of adaptive methods, m and m/s", 0},
    {"duration", "T", "simulated time, s, instead of the scene's", 0},
    {"reference", NULL, "run the reference of each scene too, and measure errors", 0},
    {"states", "FORMAT", "text or binary: a folder for each run, with its states (default none)",
     0},
    {"jobs", "N", "runs at a time (default: processors)", 0},
    {"out", "DIR", "folder of table.tsv (default results/sweep)", 0},
    CLI_PLUGIN_OPTION,
    CLI_LIMIT_OPTIONS,
    {0},
};

/* Adds NAME=VALUE as what all runs have. */
static int fix(struct sweep *sweep, const char *name, const char *value, char *reason) {
    sweep->fixed++;
    return vary_fix(&sweep->vary[sweep->vary_count++], name, value, reason);
}

static int fix_pair(struct sweep *sweep, const char *before, const char *pair, const char *option,
                    char *reason) {
    char name[256];
    const char *equals = strchr(pair, '=');
    if (!equals || equals == pair || (size_t)(equals - pair) >= sizeof name - strlen(before))
        return fail_with(reason, "--%s %.100s: write --%s NAME=VALUE", option, pair, option);
    snprintf(name, sizeof name, "%s%.*s", before, (int)(equals - pair), pair);
    return fix(sweep, name, equals + 1, reason);
}

/* What all runs have, and then what varies. Returns 0, or -1 with a reason. */
static int read_settings(const struct arguments *arguments, struct sweep *sweep, char *reason) {
    static const char *const same[] = {"treatment", "linear", "step",    "rate",
                                       "rtol",      "atol",   "duration"};
    int sets, given, varied;
    const char *const *set = argument_list(arguments, "set", &sets);
    const char *const *option = argument_list(arguments, "option", &given);
    const char *const *vary = argument_list(arguments, "vary", &varied);
    const size_t most = sizeof same / sizeof *same + (size_t)(sets + given + varied);
    sweep->vary = memory_needed(calloc(most, sizeof *sweep->vary));
    for (int i = 0; i < sets; i++)
        if (fix_pair(sweep, "", set[i], "set", reason))
            return -1;
    for (int i = 0; i < given; i++)
        if (fix_pair(sweep, "option.", option[i], "option", reason))
            return -1;
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        const char *value = argument_text(arguments, same[i]);
        if (value && fix(sweep, same[i], value, reason))
            return -1;
    }
    for (int i = 0; i < varied; i++)
        if (vary_read(&sweep->vary[sweep->vary_count++], vary[i], reason))
            return -1;
    return 0;
}

static int read_steppers(const struct arguments *arguments, struct sweep *sweep) {
    static const char *const usual[] = {"rk4"};
    if (argument_steppers(arguments, &sweep->steppers, &sweep->stepper_count))
        return -1;
    if (sweep->stepper_count == 0) {
        sweep->steppers = usual;
        sweep->stepper_count = 1;
    }
    return 0;
}

static int sweep_scene(const struct arguments *arguments) {
    char reason[REASON_SIZE];
    struct manner manner;
    struct sweep sweep = {.scene = arguments->words[0],
                          .out = argument_or(arguments, "out", "results/sweep"),
                          .reference = argument_given(arguments, "reference")};
    if (argument_manner(arguments, &manner) ||
        argument_states(arguments, STATES_NONE, &sweep.states) || read_steppers(arguments, &sweep))
        return 1;
    const int code = read_settings(arguments, &sweep, reason)
                         ? complain(1, "%s", reason)
                         : run_sweep(&sweep, &manner.limits, manner.jobs, manner.show_progress);
    sweep_free(&sweep);
    return code;
}

const struct command sweep_command = {
    .name = "sweep",
    .usage = "SCENE --vary NAME=VALUES ... [--stepper S]... [--out DIR]",
    .summary = "run a scene over ranges of settings, into one table",
    .details =
        "Every stepper with every combination of the values, a row each in DIR/table.tsv.\n"
        "\n"
        "  --vary rate=300,900,2700          a list: these values\n"
        "  --vary rate=300..3000:10          a range: 10 values at equal distances, 300, 600, ...\n"
        "  --vary rate=300..3000:log:3       equal ratios: 300, 948.683298051, 3000\n"
        "  --vary material.bending=skip,hinge    words; of texts with blanks, quote the whole\n"
        "\n"
        "NAME is a setting of the scene by its path, an option of `wisplab run` (step, rate,\n"
        "rtol, atol, treatment, linear, perturb, draw), or one of steppers and solvers,\n"
        "option.KEY.\n"
        "\n"
        "  wisplab sweep swing --vary rate=300..3000:10\n"
        "  wisplab sweep swing --vary material.stretch_stiffness=10..1000:log:7 --rate 9000\n"
        "  wisplab sweep swing --stepper rk4 --stepper bdf2 --vary wisps.[0].nodes=6,11,21 \\\n"
        "          --vary step=1e-5..1e-3:log:9 --reference\n"
        "  wisplab sweep swing --vary 'gravity=[0.0, -9.81, 0.0],[0.0, -1.62, 0.0]'\n"
        "  wisplab sweep swing --stepper cvode --vary option.method=bdf,adams --vary "
        "rtol=1e-3,1e-6\n"
        "\n"
        "Both ends of a range are among its N values; commas in brackets part no values. No\n"
        "value, and no stepper, may be given twice, and no setting by two options. The\n"
        "same command goes on where it was interrupted or killed, and any number of them in\n"
        "one DIR, on any number of machines, share the runs, wait for each other and write\n"
        "the same table. Results are in few files in DIR/runs. With --reference there is a\n"
        "folder there for each scene that is different, with --states one for each run. A run\n"
        "that fails, crashes or meets a limit is a row that says so.\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "scenes",
    .run = sweep_scene,
};
