#include "case.h"

#include "base/complain.h"
#include "identity.h"
#include "seal.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>
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

/* To the first name that is free. Another process may have been faster. */
static int set_aside(const char *folder, char *to, char *reason) {
    for (int k = 1;; k++) {
        char number[16] = "";
        if (k > 1)
            snprintf(number, sizeof number, "-%d", k);
        if (path_format(to, "%s.damaged%s", folder, number) == 0 && !file_exists(to))
            break;
    }
    if (rename(folder, to) == 0 || errno == ENOENT)
        return 0;
    return fail_with(reason, "%.200s is damaged, and cannot be set aside: %s", folder,
                     strerror(errno));
}

int run_is_sound(const char *folder, char *reason) {
    char to[PATH_SIZE];
    if (!run_is_complete(folder))
        return 0;
    if (seal_holds(folder, reason))
        return 1;
    char what[REASON_SIZE];
    snprintf(what, sizeof what, "%s", reason);
    if (set_aside(folder, to, reason))
        return -1;
    complain(0, "%.150s: %.150s; it is set aside as %.150s, and run again", folder, what, to);
    return 0;
}

static void remove_like(const char *folder, const char *const *patterns) {
    for (; *patterns; patterns++) {
        glob_t found;
        files_like(folder, *patterns, &found);
        for (size_t k = 0; k < found.gl_pathc; k++)
            unlink(found.gl_pathv[k]);
        globfree(&found);
    }
}

void run_remove(const char *folder) {
    static const char *const first[] = {"run.json", NULL}, /* without it there is no run */
        *const others[] = {"*.part", ".lock-*", NULL};
    if (!*folder)
        return;
    remove_like(folder, first);
    remove_like(folder, run_tables);
    remove_like(folder, others);
}
