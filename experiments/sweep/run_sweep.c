/* The plan, the references, the runs, the table. */
#include "base/complain.h"
#include "run/record.h"
#include "run/warnings.h"
#include "scene/scene_load.h"
#include "share.h"
#include "work.h"

#include <stdlib.h>
#include <string.h>

/* --- references --- */

static const struct sweep_run *sorted; /* qsort hands nothing on */

static int compare_references(const void *a, const void *b) {
    return strcmp(sorted[*(const int *)a].reference, sorted[*(const int *)b].reference);
}

/* One run of each reference. Returns their number, in `first`, or -1. */
static int choose_references(const struct sweep *sweep, int **first) {
    int count = 0;
    int *order = calloc((size_t)sweep->count, sizeof *order);
    *first = order;
    if (!order)
        return -1;
    for (int i = 0; i < sweep->count; i++)
        order[i] = i;
    sorted = sweep->runs;
    qsort(order, (size_t)sweep->count, sizeof *order, compare_references);
    for (int i = 0; i < sweep->count; i++) {
        const char *key = sorted[order[i]].reference;
        if (*key && (count == 0 || strcmp(sorted[order[count - 1]].reference, key) != 0))
            order[count++] = order[i];
    }
    return count;
}

/* Their folders are whole runs, which processes share, as those of experiments. Returns 0 or an
 * exit code. */
static int do_references(const struct sweep *sweep, const struct run_limits *limits, int jobs,
                         int show_progress) {
    int *first, ran = -OUT_OF_MEMORY;
    char reason[REASON_SIZE] = "out of memory";
    const int count = choose_references(sweep, &first);
    struct run_case *cases = calloc((size_t)abs(count) + 1, sizeof *cases);
    struct sweep_point *points = calloc((size_t)abs(count) + 1, sizeof *points);
    int opened = 0, code = count < 0 || !cases || !points;
    for (; opened < count && !code; opened++) {
        struct sweep_point *point = &points[opened];
        code = sweep_open(sweep, first[opened], point, reason) ||
               sweep_reference(point, &cases[opened].settings, reason);
        cases[opened].scene = point->scene;
        if (!code)
            run_folder(sweep->out, point->scene, &cases[opened].settings, cases[opened].folder);
    }
    if (!code)
        ran = runs_do_all(cases, count, limits, jobs, show_progress, reason);
    for (int i = 0; i < opened; i++)
        sweep_close(&points[i]);
    free(first);
    free(cases);
    free(points);
    return ran < 0 ? complain(outcome_exit_code((enum outcome) - ran), "%s", reason) : 0;
}

/* --- the table --- */

static void describe(FILE *stream, const struct sweep *sweep) {
    fprintf(stream, "# run, 1: its number in the sweep\n# stepper, -: time integrator\n");
    for (int i = sweep->fixed; i < sweep->vary_count; i++)
        fprintf(stream, "# %s, as set: a setting of this sweep, %d values\n", sweep->vary[i].name,
                sweep->vary[i].count);
    cells_describe(stream, sweep->reference);
    fputs("run\tstepper", stream);
    for (int i = sweep->fixed; i < sweep->vary_count; i++)
        fprintf(stream, "\t%s", sweep->vary[i].name);
    cells_name(stream, sweep->reference);
    fputc('\n', stream);
}

static void write_row(FILE *stream, const struct sweep *sweep, int run) {
    fprintf(stream, "%d\t%s", run + 1, sweep_stepper(sweep, run));
    for (int i = sweep->fixed; i < sweep->vary_count; i++)
        fprintf(stream, "\t%s", sweep_value(sweep, run, i));
    fprintf(stream, "\t%s\n", sweep->runs[run].cells);
}

/* The scene as all runs have it. */
static void write_settings(FILE *stream, const struct sweep *sweep) {
    for (int i = 0; i < sweep->fixed; i++)
        fprintf(stream, "# all with %s=%s\n", sweep->vary[i].name, sweep->vary[i].value[0]);
}

static int write_table(const struct sweep *sweep, char *path, char *reason) {
    struct atomic_file file;
    char what[256];
    snprintf(what, sizeof what, "sweep of %.200s", sweep->scene);
    if (path_format(path, "%s/table.tsv", sweep->out))
        return fail_with(reason, "the path of the folder is too long");
    if (atomic_open(&file, path, reason))
        return -1;
    write_provenance(file.stream, what, NULL);
    write_settings(file.stream, sweep);
    describe(file.stream, sweep);
    for (int i = 0; i < sweep->count; i++)
        if (sweep->runs[i].cells)
            write_row(file.stream, sweep, i);
    return atomic_commit(&file, reason);
}

/* --- what came of it --- */

/* How many runs ended in each way. */
static void say_outcomes(const struct sweep *sweep) {
    for (int k = 0; k < OUTCOME_COUNT; k++) {
        const char *name = outcome_name((enum outcome)k);
        const size_t length = strlen(name);
        int count = 0;
        for (int i = 0; i < sweep->count; i++) {
            const char *cells = sweep->runs[i].cells;
            count += cells && strncmp(cells, name, length) == 0 && cells[length] == '\t';
        }
        if (count > 0)
            say("  %d %s", count, name);
    }
}

/* What the first run's scene makes it likely to miss. */
static void say_warnings(const struct sweep *sweep) {
    struct sweep_point point;
    char reason[REASON_SIZE];
    if (sweep_open(sweep, 0, &point, reason) == 0) {
        json_t *warnings = scene_warnings(point.scene, NULL), *one;
        size_t i;
        json_array_foreach(warnings, i, one) complain(0, "warning: %s", json_string_value(one));
        json_decref(warnings);
    }
    sweep_close(&point);
}

int run_sweep(struct sweep *sweep, const struct run_limits *limits, int jobs, int show_progress) {
    char path[PATH_SIZE], reason[REASON_SIZE] = "";
    int ran = 0, code = sweep_plan(sweep, reason);
    if (code)
        return complain(code, "%s", reason);
    say_warnings(sweep);
    code = do_references(sweep, limits, jobs, show_progress);
    if (code)
        return code;
    const enum outcome outcome =
        sweep_share(sweep, &sweep_sink, limits, jobs, show_progress, &ran, reason);
    if (outcome != FINISHED)
        return complain(outcome_exit_code(outcome), "%s", reason);
    if (write_table(sweep, path, reason))
        return complain(2, "%s", reason);
    say("sweep: %d runs, %d of them new; %s", sweep->count, ran, path);
    say_outcomes(sweep);
    const int missing = sweep->count - sweep->done;
    return missing ? complain(2,
                              "%d runs are not in the table: they were killed from outside; the "
                              "same command tries them again",
                              missing)
                   : 0;
}
