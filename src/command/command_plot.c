/* wisplab plot: figures again, from the tables of earlier experiments. */
#include "base/complain.h"
#include "base/files.h"
#include "base/text_table.h"
#include "cli.h"
#include "experiments/common/plan.h"
#include "experiments/registry.h"
#include "picture/plot.h"
#include "run/runs.h"

#include <string.h>

/* How many tables there are to draw from, or -1 where one of them is none, or not whole. */
static int count_tables(const char *folder, const char *names, char *reason) {
    glob_t found;
    int count = 0;
    files_like(folder, names, &found);
    for (size_t i = 0; i < found.gl_pathc && count >= 0; i++) {
        struct text_table table;
        count = text_table_read(&table, found.gl_pathv[i], reason) ? -1 : count + 1;
        text_table_free(&table);
    }
    globfree(&found);
    return count;
}

/* The figure of a run by its folder. */
static int plot_run(const char *folder) {
    char reason[REASON_SIZE];
    const int count = count_tables(folder, "diagnostics*.tsv", reason);
    if (count < 0)
        return complain(1, "%s", reason);
    if (count == 0)
        return complain(1,
                        "no experiment '%.60s' (`wisplab list experiments` names them), and no "
                        "folder with diagnostics.tsv",
                        folder);
    if (plot_diagnostics(folder, reason) < 0)
        return complain(2, "%s", reason);
    say("figures in %s", folder);
    return 0;
}

static int plot(const struct arguments *arguments) {
    char folder[PATH_SIZE], reason[REASON_SIZE];
    const char *out = argument_text(arguments, "out"), *name = arguments->words[0];
    const int all = strcmp(name, "all") == 0;
    int drawn = 0;

    if (!all && !experiment_find(name))
        return plot_run(name);
    for (int i = 0; experiments[i]; i++) {
        if (!all && strcmp(experiments[i]->name, name) != 0)
            continue;
        path_format(folder, "%s/%s", out ? out : "results", experiments[i]->name);
        const int count = count_tables(folder, "*.tsv", reason);
        if (count < 0)
            return complain(1, "%s", reason);
        if (count == 0)
            continue;
        const int undrawn = plot_experiment(experiments[i]->name, folder, reason);
        if (runs_interrupted()) /* so may gnuplot have been */
            return complain(3, "interrupted");
        if (undrawn)
            return complain(2, "%s", reason);
        say("%s: figures in %s", experiments[i]->name, folder);
        drawn++;
    }
    if (!drawn)
        return complain(1, "no tables of '%s' in %s; run `wisplab experiment %s` first", name,
                        out ? out : "results", all ? "NAME" : name);
    return 0;
}

static const struct cli_option options[] = {
    {"out", "DIR", "the --out of the experiment (default results)", 0},
    {0},
};

const struct command plot_command = {
    .name = "plot",
    .usage = "NAME|all|FOLDER [--out DIR]",
    .summary = "draw the figures of an experiment, or a run's diagnostics, from their tables",
    .details = "FOLDER is that of a run with --diagnostics. Nothing is integrated.\n"
               "\n"
               "  wisplab plot circle\n"
               "  wisplab plot all --out results\n"
               "  wisplab run swing --diagnostics --out swing && wisplab plot swing\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "experiments",
    .run = plot,
};
