/* Scene files of the problems that came before the thesis's: "rosenblum" and "anjyo". */
#ifndef WISPLAB_SCENE_CHAINS_H
#define WISPLAB_SCENE_CHAINS_H

#include "config.h"
#include "scene_load.h"

/* Fill scene->around and wisps from the top group; what the problem has not is refused. Errors are
 * the reader's. */
void scene_read_rosenblum(struct config_reader *reader, config_setting_t *top, struct scene *scene);
void scene_read_anjyo(struct config_reader *reader, config_setting_t *top, struct scene *scene);

#endif
