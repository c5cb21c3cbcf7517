#include "seal.h"

#include "base/hash.h"

#include <string.h>

const char *const run_tables[] = {"states.tsv", "states.npy", "diagnostics.tsv", NULL};

/* The hash of everything but the seal itself. */
static void hash_of(json_t *json, char hash[HASH_SIZE]) {
    json_t *others = json_copy(json);
    json_object_del(others, "seal");
    hash_json(others, hash);
    json_decref(others);
}

void seal_add(json_t *json, json_t *files) {
    char hash[HASH_SIZE];
    json_object_set_new(json, "files", files);
    hash_of(json, hash);
    json_object_set_new(json, "seal", json_string(hash));
}

static int is_table(const char *name) {
    int i = 0;
    while (run_tables[i] && strcmp(run_tables[i], name) != 0)
        i++;
    return run_tables[i] != NULL;
}

static int files_hold(const json_t *files, const char *folder, char *reason) {
    const char *name;
    json_t *hash;
    json_object_foreach((json_t *)files, name, hash) {
        char path[PATH_SIZE], now[HASH_SIZE];
        if (!is_table(name)) {
            snprintf(reason, REASON_SIZE, "%.80s is no table of a run", name);
            return 0;
        }
        if (path_format(path, "%s/%s", folder, name) || hash_file(path, now)) {
            snprintf(reason, REASON_SIZE, "%.80s cannot be read", name);
            return 0;
        }
        if (!json_is_string(hash) || strcmp(json_string_value(hash), now) != 0) {
            snprintf(reason, REASON_SIZE, "%.80s is not what the run has written", name);
            return 0;
        }
    }
    return 1;
}

int seal_holds(const char *folder, char *reason) {
    char path[PATH_SIZE], hash[HASH_SIZE];
    json_error_t error;
    path_format(path, "%s/run.json", folder);
    json_t *json = json_of_file(path, &error);
    if (!json) {
        snprintf(reason, REASON_SIZE, "run.json:%d: %.100s", error.line, error.text);
        return 0;
    }
    const char *seal = json_string_value(json_object_get(json, "seal"));
    hash_of(json, hash);
    int holds = seal && strcmp(seal, hash) == 0;
    if (!holds)
        snprintf(reason, REASON_SIZE, "run.json is not what the run has written");
    else
        holds = files_hold(json_object_get(json, "files"), folder, reason);
    json_decref(json);
    return holds;
}
