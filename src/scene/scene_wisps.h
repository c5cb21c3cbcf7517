/* The part of a scene file that describes wisps. */
#ifndef WISPLAB_SCENE_WISPS_H
#define WISPLAB_SCENE_WISPS_H

#include "config.h"
#include "scene_load.h"

/* Fills scene->around, wisps and rates from the top group; errors are the reader's. */
void scene_read_wisps(struct config_reader *reader, config_setting_t *top, struct scene *scene);

/* The groups `material`, and `wind`, which may be absent. */
void scene_read_material(struct config_reader *reader, config_setting_t *top, struct wisp *wisp);
void scene_read_wind(struct config_reader *reader, config_setting_t *top, struct wind *wind);

/* Makes of a scene what it would be without the group `envelope`. */
void scene_remove_envelope(struct scene *scene);

#endif
