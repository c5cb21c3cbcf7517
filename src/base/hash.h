/* Hashes that name things: 64 bits by Fowler, Noll and Vo, as text. */
#ifndef WISPLAB_HASH_H
#define WISPLAB_HASH_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

enum { HASH_SIZE = 17 }; /* 16 hexadecimal digits and a zero */

/* FNV-1a of bytes, as a number that more bytes may be added to; it begins with HASH_START. */
#define HASH_START 0xcbf29ce484222325u
uint64_t hash_add(uint64_t hash, const void *bytes, size_t count);

/* FNV-1a of bytes in memory. */
void hash_bytes(const void *bytes, size_t count, char hash[HASH_SIZE]);

/* FNV-1a of a JSON value in canonical form: keys sorted, reals with 17 digits. */
void hash_json(const json_t *json, char hash[HASH_SIZE]);

/* FNV-1a of a file's bytes. Returns 0, or -1 with errno. */
int hash_file(const char *path, char hash[HASH_SIZE]);

/* FNV-1a of the program file that is running: another compiler or flag is another program. */
const char *program_hash(void);

#endif
