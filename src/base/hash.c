#include "hash.h"

#include "files.h"

#include <stdlib.h>
#include <string.h>

/* Fowler-Noll-Vo 1a with 64 bits (RFC 9923). */
uint64_t hash_add(uint64_t hash, const void *bytes, size_t count) {
    const unsigned char *p = bytes;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ p[i]) * 0x100000001b3u;
    return hash;
}

void hash_text(uint64_t hash, char text[HASH_SIZE]) {
    snprintf(text, HASH_SIZE, "%016llx", (unsigned long long)hash);
}

static ssize_t write_hashed(void *cookie, const char *bytes, size_t count) {
    struct hashed *hashed = cookie;
    const size_t written = fwrite(bytes, 1, count, hashed->to);
    hashed->hash = hash_add(hashed->hash, bytes, written);
    return (ssize_t)written;
}

FILE *hashed_open(struct hashed *hashed, FILE *to) {
    *hashed = (struct hashed){to, HASH_START};
    setvbuf(to, NULL, _IONBF, 0); /* it gets blocks */
    return fopencookie(hashed, "w", (cookie_io_functions_t){.write = write_hashed});
}

void hash_bytes(const void *bytes, size_t count, char hash[HASH_SIZE]) {
    hash_text(hash_add(HASH_START, bytes, count), hash);
}

void hash_json(const json_t *json, char hash[HASH_SIZE]) {
    char *text = json_dumps(json, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    hash_text(text ? hash_add(HASH_START, text, strlen(text)) : 0, hash);
    free(text);
}

int hash_file(const char *path, char hash[HASH_SIZE]) {
    uint64_t sum = HASH_START;
    FILE *file = fopen(path, "rb");
    char block[65536];
    if (!file)
        return -1;
    for (size_t n; (n = fread(block, 1, sizeof block, file)) > 0;)
        sum = hash_add(sum, block, n);
    const int failed = ferror(file);
    fclose(file);
    hash_text(sum, hash);
    return failed ? -1 : 0;
}

const char *program_hash(void) {
    static char text[HASH_SIZE];
    if (!text[0])
        hash_file("/proc/self/exe", text);
    return text;
}
