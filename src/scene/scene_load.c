#include "scene_load.h"

#include "base/visible.h"
#include "config.h"
#include "model/model.h"
#include "model/problems.h"
#include "scene_start.h"
#include "scene_wisps.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* A name is a shipped scene, anything with a slash or an ending .cfg a path. */
static void scene_path(const char *name, char *path) {
    const size_t length = strlen(name);
    if (strchr(name, '/') || (length > 4 && strcmp(name + length - 4, ".cfg") == 0))
        path_format(path, "%s", name);
    else
        path_format(path, "%s/experiments/%s.cfg", data_folder(), name);
}

/* The file's name without folders and ending. */
static void stem(const char *path, char *name, size_t size) {
    const char *slash = strrchr(path, '/');
    snprintf(name, size, "%.*s", (int)size - 1, slash ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot)
        *dot = '\0';
}

static void read_run(struct config_reader *reader, config_setting_t *top,
                     const struct problem *problem, struct run_defaults *run) {
    const char *const known[] = {"step",
                                 "rtol",
                                 "atol",
                                 problem->strain_limit ? "strain_limit" : NULL,
                                 problem->strain_limit ? "project" : NULL,
                                 NULL};
    config_setting_t *group = config_group(reader, top, "run");
    config_known(reader, group, known);
    run->step = config_number(reader, group, "step", POSITIVE, 1e-4);
    run->rtol = config_number(reader, group, "rtol", POSITIVE, 1e-6);
    run->atol = config_number(reader, group, "atol", POSITIVE, 1e-9);
    run->strain_limit = config_number(reader, group, "strain_limit", POSITIVE, 0);
    run->project = -1;
    if (group && config_setting_get_member(group, "project"))
        run->project = config_switch(reader, group, "project", true);
}

/* Such ticks are lost in the rounding of the time, and the run would never end. */
static void check_rates(struct config_reader *reader, config_setting_t *top,
                        const struct scene *scene) {
    config_setting_t *contacts = config_group(reader, top, "contacts");
    const struct {
        config_setting_t *group;
        const char *name;
        double rate;
    } rates[] = {{top, "frame_rate", scene->frame_rate},
                 {contacts, "collision_rate", scene->collision_rate},
                 {contacts, "interaction_rate", scene->interaction.rate}};
    const double end = scene->begin + scene->duration;
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++) {
        config_setting_t *group = rates[i].group;
        if (rates[i].rate * end > 1e15)
            config_fail(reader, group ? config_setting_get_member(group, rates[i].name) : NULL,
                        "%s: %g Hz up to %g s: is more than 1e15 times", rates[i].name,
                        rates[i].rate, end);
    }
}

/* What a setting cannot change is refused. */
static void check_projection(struct config_reader *reader, config_setting_t *top,
                             const struct scene *scene) {
    if (scene->run.project >= 0 && scene->wisp_count > 0 &&
        scene->wisps[0].stretch != STRETCH_RIGID)
        config_fail(reader, config_setting_get_member(config_group(reader, top, "run"), "project"),
                    "project: only rigid segments are put back to their length, material.stretch = "
                    "\"rigid\"");
}

static void read_circle(struct config_reader *reader, config_setting_t *top) {
    static const char *const known[] = {"name", "problem", "duration", "frame_rate",
                                        "seed", "run",     NULL};
    config_known(reader, top, known);
}

static void read_scene(struct config_reader *reader, struct scene *scene) {
    config_setting_t *top = config_top(reader);
    const char *problem = config_text(reader, top, "problem", "wisps");
    char default_name[PATH_SIZE];

    stem(reader->file, default_name, sizeof default_name);
    visible_text(config_text(reader, top, "name", default_name), scene->name, sizeof scene->name);
    if (!*scene->name)
        config_fail(reader, config_setting_get_member(top, "name"), "name: is empty");
    scene->problem = problem_find(problem);
    if (!scene->problem)
        config_fail(reader, config_setting_get_member(top, "problem"),
                    "problem: '%.60s' is not there; known: circle; none for wisps", problem);
    scene->begin = config_number(reader, top, "begin", NOT_NEGATIVE, 0);
    scene->duration = config_required(reader, top, "duration", POSITIVE);
    scene->frame_rate = config_number(reader, top, "frame_rate", POSITIVE, 0);
    scene->seed = config_number(reader, top, "seed", WHOLE, 1);
    if (scene->problem)
        read_run(reader, top, scene->problem, &scene->run);
    if (scene->problem == &circle_problem)
        read_circle(reader, top);
    else
        scene_read_wisps(reader, top, scene);
    check_projection(reader, top, scene);
    check_rates(reader, top, scene);
    scene->source = config_to_json(top);
    scene_note_start(scene);
}

/* The scene of a reader that is open or has failed to open, and closes it. */
static struct scene *finish(struct config_reader *reader, struct scene *scene) {
    if (!reader->failed)
        read_scene(reader, scene);
    const int error = reader->out_of_memory ? ENOMEM : 0;
    if (reader->failed) {
        scene_free(scene);
        scene = NULL;
    }
    config_close(reader);
    errno = error;
    return scene;
}

static struct scene *create_scene(char *reason) {
    errno = 0;
    struct scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        snprintf(reason, REASON_SIZE, "out of memory");
    return scene;
}

struct scene *scene_load(const char *name, const char *const *sets, int set_count, char *reason) {
    struct scene *scene = create_scene(reason);
    if (!scene)
        return NULL;
    char path[PATH_SIZE];
    struct config_reader reader;
    scene_path(name, path);
    config_open(&reader, path, sets, set_count, reason);
    return finish(&reader, scene);
}

struct scene *scene_from_json(const json_t *source, const char *file, const char *const *sets,
                              int set_count, char *reason) {
    struct scene *scene = create_scene(reason);
    if (!scene)
        return NULL;
    json_t *copy = json_copy((json_t *)source);
    struct config_reader reader;
    json_object_del(copy, "start");
    config_open_json(&reader, copy, file, sets, set_count, reason);
    json_decref(copy);
    return finish(&reader, scene);
}

void scene_free(struct scene *scene) {
    if (scene) {
        json_decref(scene->source);
        free(scene->wisps);
        free(scene->bodies);
        free(scene->start.rows);
    }
    free(scene);
}
