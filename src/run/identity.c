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

/* The first line of a file that begins with a word, or an empty one. */
static void find_line(const char *path, const char *word, char line[256]) {
    FILE *file = fopen(path, "r");
    int found = 0;
    while (file && !found && fgets(line, 256, file))
        found = strncmp(line, word, strlen(word)) == 0;
    if (!found)
        line[0] = '\0';
    if (file)
        fclose(file);
}

/* The processor's name as the kernel gives it. */
static void processor_name(char *name, size_t size) {
    char line[256];
    find_line("/proc/cpuinfo", "model name", line);
    const char *colon = strchr(line, ':');
    if (colon)
        snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
    else
        snprintf(name, size, "unknown");
}

/* The first number of such a line, or 0. */
static double number_in(const char *path, const char *word) {
    char line[256];
    find_line(path, word, line);
    return strtod(line + strcspn(line, "0123456789"), NULL);
}

/* The clock that the processor was made for, MHz: where the kernel sets clocks, its highest, so
 * that it does not depend on the load; a virtual machine's is only told. 0: nobody knows. */
static double clock_megahertz(void) {
    const double most = number_in("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq", "");
    return most > 0 ? 1e-3 * most : number_in("/proc/cpuinfo", "cpu MHz");
}

json_t *machine_to_json(void) {
    char processor[256], clock[32] = "unknown";
    struct utsname os;
    const double megahertz = clock_megahertz();
    if (megahertz > 0)
        snprintf(clock, sizeof clock, "%.2f GHz", 1e-3 * megahertz);
    processor_name(processor, sizeof processor);
    uname(&os);
    return json_pack("{s:s, s:s, s:i, s:s, s:s}", "processor", processor, "clock", clock, "cores",
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
