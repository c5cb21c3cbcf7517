/* The group render of a scene file. */
#ifndef WISPLAB_SCENE_RENDER_H
#define WISPLAB_SCENE_RENDER_H

#include "config.h"
#include "model/scene.h"

/* Reads and checks the group, whose defaults hold without it. */
void render_read(struct config_reader *reader, config_setting_t *top,
                 struct render_settings *render);

#endif
