/* wisplab experiment: plan -> runs -> tables -> figures. */
#include "base/complain.h"
#include "cli.h"
#include "experiments/common/carry_out.h"
#include "experiments/registry.h"

#include <math.h>
#include <unistd.h>

static const struct cli_option options[] = {
    {"scene", "SCENE", "scenes instead of the experiment's own", 1},
    {"stepper", "NAME", "only these steppers", 1},
    {"quick", NULL, "a small, stated subset", 0},
    {"fresh", NULL, "run again what is there already", 0},
    {"jobs", "N", "runs at a time; timed runs are always alone (default: processors)", 0},
    {"shard", "I/N", "do only the I-th of N shares of the runs (1 to N), for job arrays", 0},
    {"out", "DIR", "root folder of results (default results)", 0},
    CLI_LIMIT_OPTIONS,
    {0},
};

/* "2/8" -> 2, 8. Numbers of ten digits, which an int may not hold, leave a rest. */
static int read_shard(const char *text, int *shard, int *shards) {
    char rest;
    *shard = *shards = 1;
    if (!text ||
        (sscanf(text, "%9d/%9d%c", shard, shards, &rest) == 2 && *shard >= 1 && *shards >= *shard))
        return 0;
    return complain(-1, "--shard %s: must be I/N with 1 <= I <= N", text);
}

/* Returns 0, or -1 having said why. */
static int read_manner(const struct arguments *arguments, struct manner *manner) {
    double jobs;
    manner->fresh = argument_given(arguments, "fresh");
    manner->show_progress = !argument_given(arguments, "no-progress");
    if (read_shard(argument_text(arguments, "shard"), &manner->shard, &manner->shards) ||
        argument_limits(arguments, 0, 4096, &manner->limits) ||
        argument_positive(arguments, "jobs", (double)sysconf(_SC_NPROCESSORS_ONLN), &jobs))
        return -1;
    if (jobs != floor(jobs) || jobs > 1024)
        return complain(-1, "--jobs %g: must be a whole number up to 1024", jobs);
    manner->jobs = (int)jobs;
    return 0;
}

static int experiment(const struct arguments *arguments) {
    struct plan plan = {.experiment = experiment_find(arguments->words[0]),
                        .quick = argument_given(arguments, "quick"),
                        .fresh = argument_given(arguments, "fresh"),
                        .out = argument_text(arguments, "out")};
    if (!plan.experiment)
        return complain(1, "no experiment '%s'; `wisplab list experiments` names them",
                        arguments->words[0]);
    if (!plan.out)
        plan.out = "results";
    plan.scenes = argument_list(arguments, "scene", &plan.scene_count);
    plan.steppers = argument_list(arguments, "stepper", &plan.stepper_count);
    for (int i = 0; i < plan.stepper_count; i++)
        if (!stepper_find(plan.steppers[i]))
            return complain(1, "no stepper '%s'; `wisplab list steppers` names them",
                            plan.steppers[i]);
    struct manner manner = {.runs = 0};
    plan.trajectories = trajectories_create();
    const int code = read_manner(arguments, &manner) ? 1 : carry_out(&plan, &manner);
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
        "it was. Tables and figures appear in DIR/NAME, runs in DIR/runs.\n"
        "\n"
        "  wisplab experiment circle\n"
        "  wisplab experiment circle --quick --out /tmp/quick\n"
        "  wisplab experiment circle --stepper rk4 --stepper euler\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "experiments",
    .run = experiment,
};
