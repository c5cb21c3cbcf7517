/* wisplab experiment: plan -> runs -> tables -> figures. */
#include "base/complain.h"
#include "cli.h"
#include "experiments/registry.h"

static const struct cli_option options[] = {
    {"scene", "SCENE", "scenes instead of the experiment's own", CLI_DISTINCT},
    {"set", "PATH=VALUE", "change a setting of all its scenes: --set material.drag_rate=2",
     CLI_REPEATS},
    {"stepper", "NAME", "only these steppers", CLI_DISTINCT},
    {"states", "NAME=FILE", "a trajectory of another program, charted as NAME (see below)",
     CLI_DISTINCT},
    {"quick", NULL, "a small, stated subset", 0},
    {"fresh", NULL, "run again what is there already", 0},
    {"jobs", "N", "runs at a time; timed runs are always alone (default: processors)", 0},
    {"out", "DIR", "root folder of results (default results)", 0},
    CLI_PLUGIN_OPTION,
    CLI_LIMIT_OPTIONS,
    {0},
};

static int experiment(const struct arguments *arguments) {
    struct plan plan = {.experiment = experiment_find(arguments->words[0]),
                        .quick = argument_given(arguments, "quick"),
                        .fresh = argument_given(arguments, "fresh"),
                        .out = argument_or(arguments, "out", "results")};
    struct manner manner;
    if (!plan.experiment)
        return complain(1, "no experiment '%s'; `wisplab list experiments` names them",
                        arguments->words[0]);
    plan.scenes = argument_list(arguments, "scene", &plan.scene_count);
    plan.sets = argument_list(arguments, "set", &plan.set_count);
    plan.states = argument_list(arguments, "states", &plan.states_count);
    if (plan.states_count > 0 && !plan.experiment->takes_states)
        return complain(1, "experiment %s has no place for --states; work-precision and solvers do",
                        plan.experiment->name);
    if (argument_steppers(arguments, &plan.steppers, &plan.stepper_count) ||
        argument_manner(arguments, &manner))
        return 1;
    plan.trajectories = trajectories_create();
    const int code = run_experiment(&plan, &manner);
    plan_free(&plan);
    trajectories_free(plan.trajectories);
    return code;
}

const struct command experiment_command = {
    .name = "experiment",
    .usage = "NAME [--quick] [--fresh] [--jobs N] [--out DIR] ...",
    .summary = "run an experiment: its runs, its tables, its figures",
    .details =
        "Runs that are there already are not run again: an interrupted experiment goes on where\n"
        "it was. Tables and figures appear in DIR/NAME, runs in DIR/runs. A table's # lines say\n"
        "where it comes from, and of each column its name, unit and meaning.\n"
        "\n"
        "--set changes the experiment's own scenes, or those of --scene, before it varies what it\n"
        "asks about. Tables, figures and statements then name the scene by the change; what is\n"
        "known of the experiment's own scenes alone is left out, as with --scene. What it sets in\n"
        "all its runs cannot be changed, nor scenes that nobody can choose (circle, history,\n"
        "chapter5).\n"
        "\n"
        "  wisplab experiment circle\n"
        "  wisplab experiment circle --quick --out /tmp/quick\n"
        "  wisplab experiment circle --stepper rk4 --stepper euler\n"
        "  wisplab experiment needs --scene swing --set material.drag_rate=2\n"
        "  wisplab experiment work-precision --plugin ./my-stepper.so --stepper my-stepper\n"
        "  wisplab experiment work-precision --scene swing --states scipy-bdf=bdf.tsv\n"
        "\n"
        "A file of --states is a table as states.tsv, with the columns t, wisp, node, x, y, z "
        "and,\n"
        "if it has them, vx, vy, vz and those of the samples, for every frame that is compared (a\n"
        "file may have more). Files with one NAME are points of one curve. Lines before its "
        "column\n"
        "names may say what it took, and of what it is:\n"
        "\n"
        "  # evaluations: 5210            force evaluations of all wisps\n"
        "  # cpu_seconds: 1.3             on one thread\n"
        "  # setting: 1e-6                tolerance, or step in s\n"
        "  # treatment: generalised       which is meant where nothing is said\n"
        "  # scene swing, hash 0123...    as `wisplab run` writes it: checked\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "experiments",
    .run = experiment,
};
