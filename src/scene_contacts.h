/* The part of a scene file that describes contacts. */
#ifndef WISPLAB_SCENE_CONTACTS_H
#define WISPLAB_SCENE_CONTACTS_H

#include "config.h"
#include "scene.h"

/* Fills scene->bodies and the rates of contacts from the top group; errors are the reader's. */
void scene_read_contacts(struct config_reader *reader, config_setting_t *top, struct scene *scene);

#endif
