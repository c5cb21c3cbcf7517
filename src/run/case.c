#include "case.h"

#include "identity.h"

#include <ctype.h>
#include <unistd.h>

void run_folder(const char *root, const struct scene *scene, const struct settings *settings,
                char *folder) {
    char hash[HASH_SIZE], name[sizeof scene->name];
    run_hash(scene, settings, hash);
    snprintf(name, sizeof name, "%s", scene->name);
    for (char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '_')
            *c = '_'; /* a name is free text: no slash, no dots */
    path_format(folder, "%s/runs/%s-%s-%s-%s", root, name, settings->method->name,
                scene->problem->treatments[settings->treatment].name, hash);
}

int run_is_complete(const char *folder) {
    char path[PATH_SIZE];
    return path_format(path, "%s/run.json", folder) == 0 && file_exists(path);
}

void run_remove(const char *folder) {
    static const char *const patterns[] = {"run.json", "states.tsv", "diagnostics.tsv", "*.part",
                                           ".lock-*"};
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        glob_t found;
        files_like(folder, patterns[i], &found);
        for (size_t k = 0; k < found.gl_pathc; k++)
            unlink(found.gl_pathv[k]);
        globfree(&found);
    }
}
