#include "scene_load.h"

#include "base/visible.h"
#include "config.h"
#include "model/model.h"
#include "model/problems.h"
#include "scene_settings.h"
#include "scene_start.h"
#include "scene_wisps.h"
#include "setting_read.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The file's name without folders and ending. */
static void stem(const char *path, char *name, size_t size) {
    const char *slash = strrchr(path, '/');
    snprintf(name, size, "%.*s", (int)size - 1, slash ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot)
        *dot = '\0';
}

/* Such ticks are lost in the rounding of the time, and the run would never end. */
static void check_rates(struct config_reader *reader, config_setting_t *top,
                        const struct scene *scene) {
    config_setting_t *contacts = config_setting_get_member(top, "contacts");
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

/* More frames than anybody could want fill the disk before that shows. */
static void check_frames(struct config_reader *reader, config_setting_t *top,
                         const struct scene *scene) {
    const double nodes = scene_nodes(scene), most = SCENE_ROWS_MOST / nodes / scene->duration;
    if (!(scene->frame_rate > most))
        return;
    const double digit = pow(10, floor(log10(most)) - 1); /* the second, so that it is not more */
    config_fail(
        reader, config_setting_get_member(top, "frame_rate"),
        "frame_rate: %g Hz for %g s are %.3g rows of states, of %g nodes, and a run has up to "
        "%g; at most %g Hz would do, or a shorter duration",
        scene->frame_rate, scene->duration, scene->frame_rate * scene->duration * nodes, nodes,
        SCENE_ROWS_MOST, floor(most / digit) * digit);
}

/* What a setting cannot change is refused. */
static void check_projection(struct config_reader *reader, const struct scene *scene) {
    if (scene->run.project >= 0 && scene->wisp_count > 0 &&
        scene->wisps[0].stretch != STRETCH_RIGID)
        config_fail(reader, config_lookup(&reader->config, "run.project"),
                    "project: only rigid segments are put back to their length, material.stretch = "
                    "\"rigid\"");
}

static void read_name(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    char file[PATH_SIZE];
    stem(reader->file, file, sizeof file);
    visible_text(setting_text(reader, top, "", "name", file), scene->name, sizeof scene->name);
    if (!*scene->name)
        config_fail(reader, config_setting_get_member(top, "name"), "name: is empty");
    if (config_setting_get_member(top, "base"))
        config_fail(reader, config_setting_get_member(top, "base"),
                    "base: is said by a scene's file alone");
}

/* The words of the table are in the order of `problems`, and its bits in that of the words. */
static void read_problem(struct config_reader *reader, config_setting_t *top, struct scene *scene) {
    const int problem = setting_choice(reader, top, "", "problem");
    scene->problem = problems[problem];
    reader->problem = 1u << problem;
}

static void read_scene(struct config_reader *reader, struct scene *scene) {
    config_setting_t *top = config_top(reader);
    read_problem(reader, top, scene);
    read_name(reader, top, scene);
    settings_read(reader, top, "", scene);
    settings_read(reader, setting_group(reader, top, "", "run"), "run", &scene->run);
    if (scene->problem == &rosenblum_problem)
        scene_read_rosenblum(reader, top, scene);
    else if (scene->problem == &anjyo_problem)
        scene_read_anjyo(reader, top, scene);
    else if (scene->problem == &wisp_problem)
        scene_read_wisps(reader, top, scene);
    check_projection(reader, scene);
    check_rates(reader, top, scene);
    check_frames(reader, top, scene);
    scene->source = config_to_json(top);
    scene_note_start(scene);
}

/* The scene of a reader that is open or has failed to open, and closes it. */
static struct scene *finish(struct config_reader *reader) {
    struct scene *scene = calloc(1, sizeof *scene);
    if (!scene && !reader->failed) {
        reader->failed = reader->out_of_memory = true;
        snprintf(reader->reason, REASON_SIZE, "out of memory");
    }
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

struct scene *scene_load(const char *name, const char *const *sets, int set_count, char *reason) {
    char path[PATH_SIZE];
    struct config_reader reader;
    config_path(name, "", path);
    config_open(&reader, path, sets, set_count, reason);
    return finish(&reader);
}

struct scene *scene_from_text(const char *text, const char *path, const char *const *sets,
                              int set_count, char *reason) {
    struct config_reader reader;
    config_open_text(&reader, text, path, sets, set_count, reason);
    return finish(&reader);
}

struct scene *scene_from_json(const json_t *source, const char *file, const char *const *sets,
                              int set_count, char *reason) {
    json_t *copy = json_copy((json_t *)source);
    struct config_reader reader;
    json_object_del(copy, "start");
    config_open_json(&reader, copy, file, sets, set_count, reason);
    json_decref(copy);
    return finish(&reader);
}

void scene_name_sets(struct scene *scene, const char *const *sets, int set_count) {
    char name[2 * sizeof scene->name], shown[sizeof scene->name];
    snprintf(name, sizeof name, "%s", scene->name);
    for (int i = 0; i < set_count; i++) {
        visible_text(sets[i], shown, sizeof shown);
        strncat(name, i ? ", " : " with ", sizeof name - strlen(name) - 1);
        strncat(name, shown, sizeof name - strlen(name) - 1);
    }
    if (strlen(name) >= sizeof scene->name)
        strcpy(name + sizeof scene->name - 4, "...");
    visible_text(name, scene->name, sizeof scene->name);
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
