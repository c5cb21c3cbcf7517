/* What makes two runs the same: scene, settings and program. */
#ifndef WISPLAB_IDENTITY_H
#define WISPLAB_IDENTITY_H

#include "base/hash.h"
#include "settings.h"

/* Version, commit, compiler, flags, libraries, program hash; machine. New references. */
json_t *build_to_json(void);
json_t *machine_to_json(void);

/* Hash of the scene alone, and of everything that decides a run. */
void scene_hash(const struct scene *scene, char hash[HASH_SIZE]);
void run_hash(const struct scene *scene, const struct settings *settings, char hash[HASH_SIZE]);

#endif
