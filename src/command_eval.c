/* wisplab eval: the accelerations at one state, to be compared with another program's. */
#include "cli.h"
#include "results.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct cli_option options[] = {
    {"treatment", "NAME", "how constraints are kept (default generalised; circle: free)", 0},
    {"time", "T", "time, s (default: that of the state; 0 at the start)", 0},
    {"state", "FILE", "a states.tsv, of which the last frame is taken (default: the start)", 0},
    {"set", "PATH=VALUE", "override a setting of the scene", 1},
    {0},
};

/* The column of each of the model's columns in the table. Returns 0, or -1 with a reason. */
static int match_columns(const struct model *model, const struct table *table, const char *file,
                         int *columns, char *reason) {
    for (int i = 0; i < model->column_count; i++) {
        columns[i] = table_column(table, model->columns[i]);
        if (columns[i] < 0) {
            snprintf(reason, REASON_SIZE, "%.120s: no column '%s', which this treatment needs",
                     file, model->columns[i]);
            return -1;
        }
    }
    if (table_column(table, "t") == 0 && table->column_count == model->column_count + 1)
        return 0;
    snprintf(reason, REASON_SIZE, "%.120s: has %d columns; this scene and treatment have t and %d",
             file, table->column_count, model->column_count);
    return -1;
}

/* The last frame of a table, in the order of the model's rows. Returns 0, or -1 with a reason. */
static int last_frame(const struct model *model, const struct table *table, const char *file,
                      double *rows, double *t, char *reason) {
    int columns[TABLE_COLUMNS_MAX];
    const int first = table->row_count - model->row_count, count = model->column_count;
    if (match_columns(model, table, file, columns, reason))
        return -1;
    double *expected = malloc((size_t)(model->row_count * count) * sizeof *expected);
    if (!expected || first < 0) {
        free(expected);
        snprintf(reason, REASON_SIZE, "%.120s: has %d rows; a frame of this scene has %d", file,
                 table->row_count, model->row_count);
        return -1;
    }
    model->problem->sample(model, expected); /* for the numbers of wisps and nodes */
    *t = table_value(table, table->row_count - 1, 0);
    const double wisps = table_value(table, table->row_count - 1, columns[0]) + 1;
    const double scene_wisps = expected[(model->row_count - 1) * count] + 1;
    int code = 0;
    if (wisps > scene_wisps) {
        snprintf(
            reason, REASON_SIZE,
            "%.120s: its last frame has %g wisps, and the scene %g: after a subdivision a state "
            "is none of the scene's",
            file, wisps, scene_wisps);
        code = -1;
    }
    for (int i = 0; i < model->row_count && !code; i++) {
        for (int j = 0; j < count; j++)
            rows[i * count + j] = table_value(table, first + i, columns[j]);
        int sound = isfinite(*t) && table_value(table, first + i, 0) == *t;
        for (int j = 0; j < count; j++)
            sound &= isfinite(rows[i * count + j]) &&
                     (j >= 2 || rows[i * count + j] == expected[i * count + j]);
        if (!sound) {
            snprintf(reason, REASON_SIZE,
                     "%.120s: row %d is not wisp %g, node %g of the last frame in finite numbers",
                     file, first + i + 1, expected[i * count], expected[i * count + 1]);
            code = -1;
        }
    }
    free(expected);
    return code;
}

static int load_state(struct model *model, const char *file, double *t, char *reason) {
    struct table table;
    if (table_read(&table, file, reason))
        return -1;
    double *rows = malloc((size_t)(model->row_count * model->column_count) * sizeof *rows);
    int code = -1;
    if (!rows)
        snprintf(reason, REASON_SIZE, "out of memory");
    else
        code = last_frame(model, &table, file, rows, t, reason);
    if (!code)
        model->problem->restore(model, rows);
    free(rows);
    table_free(&table);
    return code;
}

static void print_rows(const struct scene *scene, const struct model *model, const double *rows) {
    char what[80];
    snprintf(what, sizeof what, "accelerations at t = %.17g s: m/s^2", model->t);
    write_provenance(stdout, what, scene);
    for (int i = 0; i < model->rate_column_count; i++)
        printf("%s%s", i ? "\t" : "", model->rate_columns[i]);
    putchar('\n');
    for (int i = 0; i < model->row_count; i++)
        for (int j = 0; j < model->rate_column_count; j++)
            printf("%.17g%c", rows[i * model->rate_column_count + j],
                   j + 1 == model->rate_column_count ? '\n' : '\t');
}

/* Evaluates every part and prints. Returns the exit code. */
static int print_accelerations(const struct scene *scene, struct model *model) {
    const size_t parts = (size_t)model->part_count;
    double **a = calloc(parts, sizeof *a);
    double *rows = calloc((size_t)(model->row_count * model->rate_column_count), sizeof *rows);
    int code = a && rows ? 0 : complain(2, "out of memory");
    for (size_t i = 0; i < parts && !code; i++) {
        struct part *part = &model->parts[i];
        a[i] = calloc((size_t)part->system.size, sizeof(double));
        if (!a[i])
            code = complain(2, "out of memory");
        else if (system_acceleration(&part->system, model->t, part->q, part->v, a[i]))
            code = complain(3, "%s: %s", scene->name, part->system.reason);
    }
    if (!code) {
        model->problem->sample_accelerations(model, a, rows);
        print_rows(scene, model, rows);
    }
    for (size_t i = 0; a && i < parts; i++)
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
    double t = 0, given = 0;

    if (time && parse_real(time, &given))
        return complain(1, "--time %s: must be a finite number", time);
    const int refused = settings_resolve(scene, &request, &settings, reason);
    if (refused)
        return complain(outcome_exit_code((enum outcome)refused), "%s", reason);
    struct model *model =
        scene->problem->create(scene, settings.treatment, settings_lanes(&settings));
    if (!model)
        return complain(2, "out of memory");
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
    .run = eval,
};
