/* Scene files: read, checked to the last setting, and turned into plain numbers. */
#ifndef WISPLAB_SCENE_LOAD_H
#define WISPLAB_SCENE_LOAD_H

#include "base/files.h"
#include "model/scene.h"

/* Reads a scene: a path to a .cfg file, or the name of a shipped one. `sets` are `set_count`
 * overrides "path.to.setting=value". Returns a scene for scene_free, or NULL with one line in
 * `reason` (REASON_SIZE): file, line, name, what is wrong and what would be right; errno is ENOMEM
 * where it was memory. */
struct scene *scene_load(const char *name, const char *const *sets, int set_count, char *reason);

/* Reads a scene from the text that stands for the file `path`, as config_open_text has it. */
struct scene *scene_from_text(const char *text, const char *path, const char *const *sets,
                              int set_count, char *reason);

/* Reads a scene from its `source`, as run.json has it in `file`, which is for messages; without
 * `start`, for what it was started from need not be there any more. */
struct scene *scene_from_json(const json_t *source, const char *file, const char *const *sets,
                              int set_count, char *reason);

/* Tells in a scene's name what was set, for tables and pictures: "swing with material.drag_rate=2";
 * what does not fit ends in dots. */
void scene_name_sets(struct scene *scene, const char *const *sets, int set_count);

void scene_free(struct scene *scene);

#endif
