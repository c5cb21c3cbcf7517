/* The part of a scene file that says where wisps grow. */
#ifndef WISPLAB_SCENE_ROOTS_H
#define WISPLAB_SCENE_ROOTS_H

#include "config.h"
#include "scene_load.h"

/* Fills scene->wisps from the list `wisps`: one by one, in grids, or on the scalp of a body, all of
 * `material`. The bodies must have been read. Errors are the reader's. */
void scene_read_roots(struct config_reader *reader, config_setting_t *top,
                      const struct wisp *material, struct scene *scene);

#endif
