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

/* The same of a scene's `source`, as run.json has it in `file`, which is for messages; without
 * `start`, for what it was started from need not be there any more. */
struct scene *scene_from_json(const json_t *source, const char *file, const char *const *sets,
                              int set_count, char *reason);

void scene_free(struct scene *scene);

#endif
