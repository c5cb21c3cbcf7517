#include "identity.h"

#include "base/hash.h"
#include "build_info.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

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
