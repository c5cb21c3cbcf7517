/* The part of a scene file that describes contacts. */
#ifndef WISPLAB_SCENE_CONTACTS_H
#define WISPLAB_SCENE_CONTACTS_H

#include "config.h"
#include "scene_load.h"

/* Fills scene->bodies, and collision_rate and interaction from group `contacts` or with what holds
 * without it; `samples` of the envelope, 0: none. Errors are the reader's. */
void scene_read_contacts(struct config_reader *reader, config_setting_t *top, int samples,
                         struct scene *scene);

/* Fills scene->subdivision, all 0 without the group; the scene's wisps are there. */
void scene_read_subdivision(struct config_reader *reader, config_setting_t *top, int samples,
                            struct scene *scene);

/* Makes all bodies of a scene push by penalty, Hz, with damping ratio 1: as if its file said so,
 * but that hair on a scalp stays where the body of ticks has it. */
void scene_push_bodies(struct scene *scene, double frequency);

#endif
