/* wisplab eval: the accelerations at one state, to be compared with another program's. */
#include "base/complain.h"
#include "base/digits.h"
#include "base/memory.h"
#include "base/vector.h"
#include "cli.h"
#include "model/state.h"
#include "run/record.h"
#include "scene/scene_load.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const struct cli_option options[] = {
    {"treatment", "NAME",
     "how constraints are kept (default generalised; circle, rosenblum, anjyo: free)", 0},
    {"time", "T", "time, s (default: that of the state; at the start the scene's begin)", 0},
    {"state", "FILE",
     "a states.tsv or states.npy, of which the last frame is taken (default: the start)", 0},
    {"set", "PATH=VALUE", "override a setting of the scene", CLI_REPEATS},
    {0},
};

static int load_state(struct model *model, const char *file, double *t, char *reason) {
    struct trajectory states;
    if (trajectory_read(&states, file, reason))
        return -1;
    double *rows =
        memory_needed(malloc((size_t)(model->row_count * model->column_count) * sizeof *rows));
    const int code = state_of(model, &states, file, rows, t, reason);
    if (!code)
        model->problem->restore(model, rows);
    free(rows);
    trajectory_free(&states);
    return code;
}

static void print_rows(const struct scene *scene, const struct model *model, const double *rows) {
    char what[80];
    snprintf(what, sizeof what, "accelerations at t = %s s: m/s^2", DIGITS(model->t));
    write_provenance(stdout, what, scene);
    state_write_rate_columns(stdout, model);
    for (int i = 0; i < model->row_count; i++)
        for (int j = 0; j < model->rate_column_count; j++)
            printf("%s%c", DIGITS(rows[i * model->rate_column_count + j]),
                   j + 1 == model->rate_column_count ? '\n' : '\t');
}

/* Evaluates every part and prints. Returns the exit code. */
static int print_accelerations(const struct scene *scene, struct model *model) {
    const size_t parts = (size_t)model->part_count;
    const int numbers = model->row_count * model->rate_column_count;
    double **a = memory_needed(calloc(parts, sizeof *a));
    double *rows = memory_needed(calloc((size_t)numbers, sizeof *rows));
    int code = 0;
    for (size_t i = 0; i < parts && !code; i++) {
        struct part *part = &model->parts[i];
        a[i] = memory_needed(calloc((size_t)part->system.size, sizeof(double)));
        if (system_acceleration(&part->system, model->t, part->q, part->v, a[i]))
            code = complain(3, "%s: %s", scene->name, part->system.reason);
    }
    if (!code) {
        model->problem->sample_accelerations(model, a, rows);
        if (all_finite(rows, numbers))
            print_rows(scene, model, rows);
        else
            code = complain(
                3, "%s: accelerations at this state are not finite: its numbers are too large",
                scene->name);
    }
    for (size_t i = 0; i < parts; i++)
        free(a[i]);
    free(a);
    free(rows);
    return code;
}

static int evaluate(const struct arguments *arguments, const struct scene *scene) {
    char reason[REASON_SIZE];
    struct settings settings;
    const struct run_request request = {.treatment = argument_text(arguments, "treatment")};
    const char *time = argument_text(arguments, "time"), *state = argument_text(arguments, "state");
    double t = scene->begin, given = 0;

    if (time && parse_real(time, &given))
        return complain(1, "--time %.60s: must be a finite number", time);
    const int refused = settings_resolve(scene, &request, &settings, reason);
    if (refused)
        return complain(outcome_exit_code((enum outcome)refused), "%s", reason);
    struct model *model =
        memory_needed(scene->problem->create(scene, settings.treatment, settings_lanes(&settings)));
    int code = 0;
    if (state && load_state(model, state, &t, reason))
        code = complain(1, "%s", reason);
    model->t = time ? given : t;
    if (!code)
        code = print_accelerations(scene, model);
    scene->problem->free(model);
    return code;
}

static int eval(const struct arguments *arguments) {
    char reason[REASON_SIZE];
    int count;
    const char *const *sets = argument_list(arguments, "set", &count);
    struct scene *scene = scene_load(arguments->words[0], sets, count, reason);
    if (!scene)
        return complain(errno == ENOMEM ? 2 : 1, "%s", reason);
    const int code = evaluate(arguments, scene);
    scene_free(scene);
    return code;
}

const struct command eval_command = {
    .name = "eval",
    .usage = "SCENE [--treatment T] [--time T] [--state FILE]",
    .summary = "print the accelerations at a state",
    .details =
        "On standard output, a row for each wisp and node: wisp node ax ay az, then rdd0 ... or,\n"
        "with penalty, e0ax e0ay e0az ... of the samples; nodes 0 and 1 belong to the head.\n"
        "\n"
        "  wisplab eval swing\n"
        "  wisplab eval swing-envelope --treatment penalty --time 0.5\n"
        "  wisplab eval swing-envelope --treatment projection --state results/states.tsv\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "scenes",
    .run = eval,
};
