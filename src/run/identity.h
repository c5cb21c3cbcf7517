/* What makes two runs the same: scene, settings and program. */
#ifndef WISPLAB_IDENTITY_H
#define WISPLAB_IDENTITY_H

#include "settings.h"

enum { HASH_SIZE = 17 }; /* 16 hexadecimal digits and a zero */

/* FNV-1a of bytes in memory. */
void hash_bytes(const void *bytes, size_t count, char hash[HASH_SIZE]);

/* FNV-1a of a JSON value in canonical form: keys sorted, reals with 17 digits. */
void hash_json(const json_t *json, char hash[HASH_SIZE]);

/* FNV-1a of the program file that is running: another compiler or flag is another program. */
const char *program_hash(void);

/* Version, commit, compiler, flags, libraries, program hash; machine. New references. */
json_t *build_to_json(void);
json_t *machine_to_json(void);

/* Hash of the scene alone, and of everything that decides a run. */
void scene_hash(const struct scene *scene, char hash[HASH_SIZE]);
void run_hash(const struct scene *scene, const struct settings *settings, char hash[HASH_SIZE]);

#endif
