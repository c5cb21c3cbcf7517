/* The group render of a scene file. */
#ifndef WISPLAB_SCENE_RENDER_H
#define WISPLAB_SCENE_RENDER_H

#include "config.h"
#include "model/scene.h"

/* What holds where a scene has no group `render`. */
struct render_settings render_defaults(void);

/* Reads and checks the group. */
void render_read(struct config_reader *reader, config_setting_t *top,
                 struct render_settings *render);

#endif
