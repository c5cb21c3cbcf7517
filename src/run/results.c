#include "results.h"

#include "settings.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct trajectory no_states;

/* Whether all frames are there that run.json counts, and the last has no fewer nodes than the one
 * before: wisps become more, but not fewer. */
static int has_all_frames(const struct run_files *run) {
    const struct trajectory *states = run->states;
    const int frames = states->frame_count;
    if (frames == 0 || frames != run_number(run, "frames"))
        return 0;
    const int last = states->frames[frames - 1].row,
              before = frames > 1 ? last - states->frames[frames - 2].row : 0;
    return states->table.row_count - last >= before;
}

int run_read(struct run_files *run, const char *folder, char *reason) {
    char path[PATH_SIZE];
    json_error_t error;
    *run = (struct run_files){.states = &no_states};
    path_format(path, "%s/run.json", folder);
    run->json = json_of_file(path, &error);
    if (!run->json)
        return fail_with(reason, "%.120s:%d: %.100s", path, error.line, error.text);
    const char *status = json_string_value(json_object_get(run->json, "status"));
    run->outcome = outcome_from_name(status ? status : "");
    if (run->outcome != OUTCOME_COUNT)
        return 0;
    run_free(run);
    return fail_at(reason, path, 0, "unknown status");
}

/* A run that died early has no frames. */
static int read_states(struct run_files *run, const char *path, char *reason) {
    if (run->outcome != FINISHED && !file_exists(path))
        return 0;
    const struct trajectory *states = trajectories_take(run->owner, path, reason);
    if (!states)
        return -1;
    run->states = states;
    if (states->table.column_count < STATE_SAMPLES)
        return fail_at(reason, path, 0, "has not the columns of states");
    if (run->outcome == FINISHED && !has_all_frames(run))
        return fail_at(reason, path, 0, "has not all frames of a run that finished");
    return 0;
}

int run_left_no_states(const json_t *json) {
    const char *format =
        json_string_value(json_object_get(json_object_get(json, "settings"), "states"));
    return format && strcmp(format, states_format_names[STATES_NONE]) == 0;
}

int run_read_states(struct run_files *run, const char *folder, struct trajectories *owner,
                    char *reason) {
    char path[PATH_SIZE];
    if (run_read(run, folder, reason))
        return -1;
    run->owner = owner;
    trajectory_path(folder, path);
    if (run_left_no_states(run->json))
        fail_at(reason, folder, 0, LEFT_NO_STATES);
    else if (read_states(run, path, reason) == 0)
        return 0;
    run_free(run);
    return -1;
}

void run_free(struct run_files *run) {
    json_decref(run->json);
    run->json = NULL;
    if (run->states && run->states != &no_states)
        trajectories_return(run->owner, run->states);
    run->states = NULL;
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
