/* Hashes that name things: 64 bits by Fowler, Noll and Vo, as text. */
#ifndef WISPLAB_HASH_H
#define WISPLAB_HASH_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { HASH_SIZE = 17 }; /* 16 hexadecimal digits and a zero */

/* FNV-1a of bytes, as a number that more bytes may be added to; it begins with HASH_START. */
#define HASH_START 0xcbf29ce484222325u
uint64_t hash_add(uint64_t hash, const void *bytes, size_t count);

/* Such a number as text. */
void hash_text(uint64_t hash, char text[HASH_SIZE]);

/* What is written to the stream goes on to another one, and into the hash. */
struct hashed {
    FILE *to; /* not written to otherwise; errors are its, too */
    uint64_t hash;
};

/* The stream, to be closed before the other one, which nothing was written to as yet and which
 * stays open. NULL where memory cannot be had. */
FILE *hashed_open(struct hashed *hashed, FILE *to);

/* FNV-1a of bytes in memory. */
void hash_bytes(const void *bytes, size_t count, char hash[HASH_SIZE]);

/* FNV-1a of a JSON value in canonical form: keys sorted, reals with 17 digits. */
void hash_json(const json_t *json, char hash[HASH_SIZE]);

/* FNV-1a of a file's bytes. Returns 0, or -1 with errno. */
int hash_file(const char *path, char hash[HASH_SIZE]);

/* FNV-1a of the program file that is running: another compiler or flag is another program. */
const char *program_hash(void);

#endif
