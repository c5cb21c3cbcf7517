/* The part of a scene file that describes wisps. */
#ifndef WISPLAB_SCENE_WISPS_H
#define WISPLAB_SCENE_WISPS_H

#include "config.h"
#include "scene_load.h"

/* Fill scene->around, wisps and rates from the top group, of the problems "wisps", "rosenblum" and
 * "anjyo"; what the problem has not is refused. Errors are the reader's. */
void scene_read_wisps(struct config_reader *reader, config_setting_t *top, struct scene *scene);
void scene_read_rosenblum(struct config_reader *reader, config_setting_t *top, struct scene *scene);
void scene_read_anjyo(struct config_reader *reader, config_setting_t *top, struct scene *scene);

/* Makes of a scene what it would be without the group `envelope`. */
void scene_remove_envelope(struct scene *scene);

#endif
