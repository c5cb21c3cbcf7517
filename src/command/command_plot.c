/* wisplab plot: figures again, from the tables of earlier experiments. */
#include "base/complain.h"
#include "base/memory.h"
#include "base/text_table.h"
#include "cli.h"
#include "experiments/common/plan.h"
#include "experiments/registry.h"
#include "picture/paper.h"
#include "picture/plot.h"
#include "run/runs.h"

#include <stdlib.h>
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

/* --- for papers --- */

/* What was asked for besides the experiment. */
struct wanted {
    struct paper_request request;
    int is_paper;
    char *words; /* of --methods, cut up */
    int *panels;
    const char **methods;
};

/* Numbers and commas. */
static int read_panels(struct wanted *wanted, const char *text) {
    wanted->panels = memory_needed(calloc(strlen(text) + 1, sizeof *wanted->panels));
    for (const char *at = text;;) {
        int length = 0, *panel = &wanted->panels[wanted->request.panel_count++];
        if (sscanf(at, "%5d%n", panel, &length) != 1 || *panel < 1 ||
            (at[length] && at[length] != ','))
            return complain(-1, "--panel %s: must be numbers of panels, counted from 1, as 1,3",
                            text);
        if (!at[length])
            break;
        at += length + 1;
    }
    wanted->request.panels = wanted->panels;
    return 0;
}

static int read_methods(struct wanted *wanted, const char *text) {
    wanted->words = memory_needed(strdup(text));
    wanted->methods = memory_needed(calloc(strlen(text) + 1, sizeof *wanted->methods));
    char *rest = wanted->words;
    for (char *word; (word = strsep(&rest, ",")) != NULL;) {
        if (!*word)
            return complain(-1, "--methods %s: must be names with commas between, as rk4,cvode",
                            text);
        wanted->methods[wanted->request.method_count++] = word;
    }
    wanted->request.methods = wanted->methods;
    return 0;
}

static int is_one_of(const char *word, const char *first, const char *second, const char *third) {
    return strcmp(word, first) == 0 || strcmp(word, second) == 0 || strcmp(word, third) == 0;
}

static int read_wanted(const struct arguments *arguments, struct wanted *wanted) {
    static const char *const others[] = {"format", "figure", "panel", "methods"};
    const char *paper = argument_text(arguments, "paper"),
               *format = argument_text(arguments, "format"),
               *panel = argument_text(arguments, "panel"),
               *methods = argument_text(arguments, "methods");
    *wanted = (struct wanted){.is_paper = paper != NULL};
    for (size_t i = 0; i < sizeof others / sizeof *others && !paper; i++)
        if (argument_given(arguments, others[i]))
            return complain(-1, "--%s: is of figures for papers; say --paper column or page",
                            others[i]);
    if (paper && !is_one_of(paper, "column", "page", "page"))
        return complain(-1, "--paper %s: is not one of column, page", paper);
    if (format && !is_one_of(format, "pdf", "svg", "png"))
        return complain(-1, "--format %s: is not one of pdf, svg, png", format);
    wanted->request.is_column = paper && strcmp(paper, "column") == 0;
    wanted->request.format = format;
    wanted->request.figure = argument_text(arguments, "figure");
    return (panel && read_panels(wanted, panel)) || (methods && read_methods(wanted, methods)) ? -1
                                                                                               : 0;
}

/* --- drawing --- */

/* Draws what plots/NAME.gp draws of the tables in a folder. Returns the exit code. */
static int draw(const char *name, const char *folder, int of_experiment,
                const struct wanted *wanted) {
    char reason[REASON_SIZE], to[PATH_SIZE];
    struct paper_request request = wanted->request;
    int code;
    request.name = name;
    request.folder = folder;
    path_format(to, wanted->is_paper ? "%s/paper" : "%s", folder);
    if (wanted->is_paper)
        code = paper_draw(&request, to, reason);
    else if (of_experiment)
        code = plot_experiment(name, folder, reason) ? 2 : 0;
    else
        code = plot_diagnostics(folder, reason) < 0 ? 2 : 0;
    if (runs_interrupted()) /* so may gnuplot have been */
        return complain(3, "interrupted");
    if (code)
        return complain(code, "%s", reason);
    if (of_experiment)
        say("%s: figures in %s", name, to);
    else
        say("figures in %s", to);
    return 0;
}

/* The figure of a run by its folder. */
static int plot_run(const char *folder, const struct wanted *wanted) {
    char reason[REASON_SIZE];
    const int count = count_tables(folder, "diagnostics*.tsv", reason);
    if (count < 0)
        return complain(1, "%s", reason);
    if (count == 0)
        return complain(1,
                        "no experiment '%.60s' (`wisplab list experiments` names them), and no "
                        "folder with diagnostics.tsv",
                        folder);
    return draw("diagnostics", folder, 0, wanted);
}

static int plot_experiments(const struct arguments *arguments, const struct wanted *wanted) {
    char folder[PATH_SIZE], reason[REASON_SIZE];
    const char *out = argument_or(arguments, "out", "results"), *name = arguments->words[0];
    const int all = strcmp(name, "all") == 0;
    int drawn = 0;
    for (int i = 0; experiments[i]; i++) {
        if (!all && strcmp(experiments[i]->name, name) != 0)
            continue;
        path_format(folder, "%s/%s", out, experiments[i]->name);
        const int count = count_tables(folder, "*.tsv", reason);
        if (count < 0)
            return complain(1, "%s", reason);
        if (count == 0)
            continue;
        const int code = draw(experiments[i]->name, folder, 1, wanted);
        if (code)
            return code;
        drawn++;
    }
    if (!drawn)
        return complain(1, "no tables of '%s' in %s; run `wisplab experiment %s` first", name, out,
                        all ? "NAME" : name);
    return 0;
}

static int plot(const struct arguments *arguments) {
    const char *name = arguments->words[0];
    struct wanted wanted;
    int code = read_wanted(arguments, &wanted) ? 1 : 0;
    if (!code)
        code = strcmp(name, "all") == 0 || experiment_find(name)
                   ? plot_experiments(arguments, &wanted)
                   : plot_run(name, &wanted);
    free(wanted.panels);
    free(wanted.methods);
    free(wanted.words);
    return code;
}

static const struct cli_option options[] = {
    {"paper", "WIDTH", "for a paper: column (86 mm) or page (178 mm), letters of 7 to 8 pt", 0},
    {"format", "F", "of figures for papers: pdf, svg or png at 300 dpi (default: all three)", 0},
    {"figure", "NAME", "this figure for a paper alone", 0},
    {"panel", "LIST", "these panels for a paper alone, counted from 1, as 1,3", 0},
    {"methods", "LIST", "these methods for a paper alone, as rk4,cvode", 0},
    {"out", "DIR", "the --out of the experiment (default results)", 0},
    CLI_PLUGIN_OPTION,
    {0},
};

const struct command plot_command = {
    .name = "plot",
    .usage = "NAME|all|FOLDER [--paper column|page] [--out DIR] ...",
    .summary = "draw the figures of an experiment, or a run's diagnostics, from their tables",
    .details =
        "FOLDER is that of a run with --diagnostics. Nothing is integrated. Figures for papers\n"
        "have no titles and go to the folder `paper` beside the tables; a column is for few\n"
        "panels, which then are below each other.\n"
        "\n"
        "  wisplab plot circle\n"
        "  wisplab plot all --out results\n"
        "  wisplab run swing --diagnostics --out swing && wisplab plot swing\n"
        "  wisplab plot circle --paper column --figure work-precision --panel 2 --methods "
        "rk4,cvode\n",
    .options = options,
    .words_least = 1,
    .words_most = 1,
    .first_word = "experiments",
    .run = plot,
};
