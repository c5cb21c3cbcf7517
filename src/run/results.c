#include "results.h"

#include "base/table.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whether all frames are there that run.json counts, and the last has no fewer nodes than the one
 * before: wisps become more, but not fewer. */
static int has_all_frames(const struct run_files *run) {
    const struct table *states = &run->states;
    int frames = 0, rows = 0, rows_before = 0;
    for (int i = 0; i < states->row_count; i++) {
        if (i == 0 || table_value(states, i, 0) != table_value(states, i - 1, 0)) {
            rows_before = rows;
            rows = 0;
            frames++;
        }
        rows++;
    }
    return frames > 0 && frames == run_number(run, "frames") && rows >= rows_before;
}

static int states_fail(const char *path, const char *what, char *reason) {
    snprintf(reason, REASON_SIZE, "%.150s: %s", path, what);
    return -1;
}

/* A run that died early has no frames. */
static int read_states(struct run_files *run, const char *path, char *reason) {
    enum { T_TO_VZ = 9 };
    if (run->outcome != FINISHED && !file_exists(path))
        return 0;
    if (table_read(&run->states, path, reason))
        return -1;
    if (run->states.column_count < T_TO_VZ)
        return states_fail(path, "has not the columns of states", reason);
    if (run->outcome == FINISHED && !has_all_frames(run))
        return states_fail(path, "has not all frames of a run that finished", reason);
    return 0;
}

int run_read(struct run_files *run, const char *folder, char *reason) {
    char path[PATH_SIZE];
    json_error_t error;
    *run = (struct run_files){0};
    path_format(path, "%s/run.json", folder);
    run->json = json_load_file(path, 0, &error);
    if (!run->json) {
        snprintf(reason, REASON_SIZE, "%.120s:%d: %.100s", path, error.line, error.text);
        return -1;
    }
    const char *status = json_string_value(json_object_get(run->json, "status"));
    run->outcome = outcome_from_name(status ? status : "");
    path_format(path, "%s/states.tsv", folder);
    if (run->outcome == OUTCOME_COUNT) {
        snprintf(reason, REASON_SIZE, "%.150s/run.json: unknown status", folder);
    } else if (read_states(run, path, reason) == 0) {
        return 0;
    }
    run_free(run);
    return -1;
}

void run_free(struct run_files *run) {
    json_decref(run->json);
    run->json = NULL;
    table_free(&run->states);
}

double run_number(const struct run_files *run, const char *path) {
    char copy[128];
    const json_t *json = run->json;
    snprintf(copy, sizeof copy, "%s", path);
    for (char *at = copy, *name; (name = strsep(&at, ".")) != NULL;)
        json = json_object_get(json, name);
    return json_is_number(json) ? json_number_value(json) : NAN;
}

struct spread run_cpu_time(const struct run_files *run) {
    const json_t *list = json_object_get(run->json, "cpu_seconds_repeated");
    const size_t count = json_array_size(list);
    double *seconds = malloc((count + 1) * sizeof *seconds);
    struct spread spread = {NAN, NAN, NAN};
    if (count > 0 && seconds) {
        for (size_t i = 0; i < count; i++)
            seconds[i] = json_number_value(json_array_get(list, i));
        gsl_sort(seconds, 1, count);
        spread = (struct spread){gsl_stats_median_from_sorted_data(seconds, 1, count), seconds[0],
                                 seconds[count - 1]};
    }
    free(seconds);
    return spread;
}
