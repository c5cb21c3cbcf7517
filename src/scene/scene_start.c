#include "scene_start.h"

#include "base/files.h"
#include "base/hash.h"
#include "base/table.h"
#include "base/vector.h"
#include "model/state.h"
#include "setting_read.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far the head's nodes may be from the head, m and m/s, for coordinates up to 1 m: a file of
 * nine digits has 1e-9. */
static const double tolerance = 1e-6;

/* A path is taken from the folder of the scene file that says it. */
static int start_path(const char *file, const char *name, char *path) {
    const char *slash = strrchr(file, '/');
    if (name[0] == '/' || !slash)
        return path_format(path, "%s", name);
    return path_format(path, "%.*s/%s", (int)(slash - file), file, name);
}

/* The largest difference in position or velocity of a row, relative to numbers beyond 1. */
static double apart(const double *row, const double *expected) {
    double most = 0;
    for (int k = 2; k < 8; k++)
        most = fmax(most, fabs(row[k] - expected[k]) / fmax(1, fabs(expected[k])));
    return most;
}

/* Nodes 0 and 1 must be where the head has them at the begin. */
static void check_head(struct config_reader *reader, const config_setting_t *setting,
                       const struct model *model, const double *rows, const double *expected) {
    for (int i = 0; i < model->row_count; i++) {
        const double *row = rows + i * model->column_count,
                     *head = expected + i * model->column_count;
        const double difference = row[1] < 2 ? apart(row, head) : 0;
        if (difference > tolerance)
            config_fail(
                reader, setting,
                "start: node %g of wisp %g is %.3g m or m/s away from where the head has "
                "it at t = %g; this must be a state of these wisps, the head being the same",
                row[1], row[0], difference, model->t);
    }
}

/* Rigid segments are put back to their length, if they are near it. */
static const double most_stretched = 1e-2;

static void check_lengths(struct config_reader *reader, const config_setting_t *setting,
                          const struct scene *scene, const double *rows, const double *expected,
                          int columns) {
    for (int w = 0; w < scene->wisp_count; w++) {
        const struct wisp *wisp = &scene->wisps[w];
        for (int i = 2; i < wisp->nodes && wisp->stretch == STRETCH_RIGID; i++) {
            const double *p = rows + i * columns + 2;
            const double *before = (i == 2 ? expected : rows) + (i - 1) * columns + 2;
            const double d[3] = {p[0] - before[0], p[1] - before[1], p[2] - before[2]};
            const double off = vector_length(d) / wisp_spacing(wisp) - 1;
            if (!(fabs(off) <= most_stretched))
                config_fail(reader, setting,
                            "start: the segment before node %d of wisp %d is %.3g of its length "
                            "away from it: segments are rigid here, and may be %g",
                            i, w, off, most_stretched);
        }
        rows += wisp->nodes * columns;
        expected += wisp->nodes * columns;
    }
}

static void fail(struct config_reader *reader, const config_setting_t *setting,
                 const char *reason) {
    reader->out_of_memory |= errno == ENOMEM;
    config_fail(reader, setting, "start: %s", reason);
}

/* What is in the file, as a model of the treatment whose columns it has knows it. */
static void take_states(struct config_reader *reader, const config_setting_t *setting,
                        const struct trajectory *states, const char *file, struct scene *scene) {
    char reason[REASON_SIZE] = "out of memory";
    struct start start = {.treatment = table_column(&states->table, "e0x") >= 0 ? WISP_PENALTY
                                                                                : WISP_GENERALISED};
    double t;
    errno = 0;
    struct model *model = scene->problem->create(scene, start.treatment, 1);
    if (!model) {
        reader->out_of_memory = true;
        fail(reader, setting, reason);
        return;
    }
    const size_t size = (size_t)(model->row_count * model->column_count);
    double *expected = malloc(size * sizeof *expected);
    start.columns = model->column_count;
    start.count = (int)size;
    start.rows = malloc(size * sizeof *start.rows);
    if (!expected || !start.rows || state_of(model, states, file, start.rows, &t, reason)) {
        fail(reader, setting, reason);
    } else {
        model->problem->sample(model, expected);
        check_head(reader, setting, model, start.rows, expected);
        check_lengths(reader, setting, scene, start.rows, expected, model->column_count);
    }
    free(expected);
    scene->problem->free(model);
    scene->start = start; /* freed with the scene, right or wrong */
}

void scene_read_start(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    const config_setting_t *setting = config_setting_get_member(top, "start");
    const char *name = setting_text(reader, top, "", "start", NULL);
    char path[PATH_SIZE], reason[REASON_SIZE];
    struct trajectory states;
    if (reader->failed || !name)
        return;
    if (!*name || start_path(config_file_of(reader, setting), name, path)) {
        config_fail(reader, setting, "start: must be the path of a file, from the scene's folder");
        return;
    }
    errno = 0;
    if (trajectory_read(&states, path, reason)) {
        if (file_exists(path) && errno != ENOMEM && !trajectory_is_begun(path))
            snprintf(reason, sizeof reason, "%.150s: is no table of states", path);
        fail(reader, setting, reason);
        return;
    }
    take_states(reader, setting, &states, path, scene);
    trajectory_free(&states);
}

void scene_note_start(struct scene *scene) {
    char hash[HASH_SIZE];
    if (!scene->start.rows)
        return;
    hash_bytes(scene->start.rows, (size_t)scene->start.count * sizeof *scene->start.rows, hash);
    json_t *file = json_incref(json_object_get(scene->source, "start"));
    json_object_set_new(scene->source, "start",
                        json_pack("{s:o, s:s}", "file", file, "hash", hash));
}
