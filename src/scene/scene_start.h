/* The part of a scene file that says from what state it starts. */
#ifndef WISPLAB_SCENE_START_H
#define WISPLAB_SCENE_START_H

#include "config.h"
#include "scene_load.h"

/* Fills scene->start from the file that `start` names, after all else of the scene. Errors are the
 * reader's. */
void scene_read_start(struct config_reader *reader, config_setting_t *top, struct scene *scene);

/* Puts the state in the place of the file's name in scene->source: it is what counts. */
void scene_note_start(struct scene *scene);

#endif
