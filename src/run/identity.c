#include "identity.h"

#include "build_info.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

/* Fowler-Noll-Vo 1a with 64 bits (RFC 9923). */
static const uint64_t fnv_start = 0xcbf29ce484222325u;

static uint64_t fnv_bytes(uint64_t hash, const void *bytes, size_t count) {
    const unsigned char *p = bytes;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ p[i]) * 0x100000001b3u;
    return hash;
}

static void print_hash(uint64_t hash, char text[HASH_SIZE]) {
    snprintf(text, HASH_SIZE, "%016llx", (unsigned long long)hash);
}

void hash_bytes(const void *bytes, size_t count, char hash[HASH_SIZE]) {
    print_hash(fnv_bytes(fnv_start, bytes, count), hash);
}

void hash_json(const json_t *json, char hash[HASH_SIZE]) {
    char *text = json_dumps(json, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    print_hash(text ? fnv_bytes(fnv_start, text, strlen(text)) : 0, hash);
    free(text);
}

const char *program_hash(void) {
    static char text[HASH_SIZE];
    if (text[0])
        return text;
    uint64_t hash = fnv_start;
    FILE *program = fopen("/proc/self/exe", "rb");
    char block[65536];
    for (size_t n; program && (n = fread(block, 1, sizeof block, program)) > 0;)
        hash = fnv_bytes(hash, block, n);
    if (program)
        fclose(program);
    print_hash(hash, text);
    return text;
}

json_t *build_to_json(void) {
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s}", "version", WISPLAB_VERSION, "commit",
                     WISPLAB_COMMIT, "compiler", WISPLAB_COMPILER, "flags", WISPLAB_FLAGS,
                     "libraries", WISPLAB_LIBRARIES, "program_hash", program_hash());
}

/* The processor's name as the kernel gives it. */
static void processor_name(char *name, size_t size) {
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(name, size, "unknown");
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !colon)
            continue;
        snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
        break;
    }
    if (file)
        fclose(file);
}

json_t *machine_to_json(void) {
    char processor[256];
    struct utsname os;
    processor_name(processor, sizeof processor);
    uname(&os);
    return json_pack("{s:s, s:i, s:s, s:s}", "processor", processor, "cores",
                     (int)sysconf(_SC_NPROCESSORS_ONLN), "system", os.sysname, "architecture",
                     os.machine);
}

/* All of the scene but how it is looked at: a run is good from every side. New reference. */
static json_t *scene_proper(const struct scene *scene) {
    json_t *source = json_copy(scene->source);
    json_object_del(source, "render");
    return source;
}

void scene_hash(const struct scene *scene, char hash[HASH_SIZE]) {
    json_t *source = scene_proper(scene);
    hash_json(source, hash);
    json_decref(source);
}

void run_hash(const struct scene *scene, const struct settings *settings, char hash[HASH_SIZE]) {
    json_t *all = json_pack("{s:o, s:o, s:s}", "scene", scene_proper(scene), "settings",
                            settings_to_json(scene, settings), "program", program_hash());
    hash_json(all, hash);
    json_decref(all);
}
