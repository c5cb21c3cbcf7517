/* --set path.to.setting=value. */
#include "config_parts.h"
#include "config_text.h"
#include "scene_settings.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { SET_MAX = 4096 }; /* letters of a value */

/* Reads a value; a bare word is taken as text. */
static bool read_value(struct config_reader *reader, const char *set, const char *text,
                       config_t *value) {
    char snippet[SET_MAX + 16], why[REASON_SIZE];
    for (int quoted = 0; quoted <= (isalpha((unsigned char)*text) != 0); quoted++) {
        snprintf(snippet, sizeof snippet, quoted ? "value = \"%s\";" : "value = %s;", text);
        if (config_check_text(snippet, why)) {
            config_fail(reader, NULL, "--set %.100s: %s", set, why);
            return false;
        }
        if (config_read_string(value, snippet))
            return true;
    }
    config_fail(reader, NULL, "--set %.100s: the value cannot be read: %s%s", set,
                config_error_text(value), config_hint(config_error_text(value)));
    return false;
}

static void replace(struct config_reader *reader, const char *set, config_setting_t *parent,
                    const char *name, const config_setting_t *value) {
    if (config_setting_get_member(parent, name))
        config_setting_remove(parent, name);
    if (!config_copy(parent, name, value, 1))
        config_fail(reader, NULL, "--set %.100s: '%.60s' is not a setting's name", set, name);
}

/* A group takes the place of the scene's, of which the rest may not go with it (wind = { kind =
 * "gust"; ... }). The material is one thing that every scene has: a group that names some of its
 * settings changes those. An empty one stands for the defaults. */
static bool keeps_others(const config_setting_t *parent, const char *name,
                         const config_setting_t *there, const config_setting_t *value) {
    return config_setting_is_root(parent) && strcmp(name, "material") == 0 &&
           config_setting_is_group(there) && config_setting_is_group(value) &&
           config_setting_length(value) > 0;
}

/* Where a path begins with an entry that its list has not, or that is written otherwise. Returns
 * whether it does. */
static bool fail_entry(struct config_reader *reader, const char *set) {
    char list[256], entry[300];
    const size_t length = strcspn(set, ".[:/=");
    const char *digits = set + length + strspn(set + length, ".[");
    snprintf(list, sizeof list, "%.*s", (int)length, set);
    const config_setting_t *entries = config_lookup(&reader->config, list);
    const int count =
        entries && config_setting_is_list(entries) ? config_setting_length(entries) : 0;
    if (count == 0 || !isdigit((unsigned char)*digits))
        return false;
    char *rest;
    const long asked = strtol(digits, &rest, 10), last = count - 1;
    snprintf(entry, sizeof entry, "%s.[%ld]", list, asked < last ? asked : last);
    if (strncmp(set, entry, strlen(entry)) == 0)
        return false;
    config_fail(reader, NULL, "--set %.100s: the last entry of %.40s is [%ld]; write %.60s%.100s",
                set, list, last, entry, rest + (*rest == ']'));
    return true;
}

/* Where a path leaves what the scene has. */
static void fail_path(struct config_reader *reader, const char *set, const char *path,
                      const config_setting_t *found) {
    const struct scene_setting *nearest = setting_nearest("", path, OF_ALL);
    if (found && config_setting_is_aggregate(found))
        config_fail(reader, NULL,
                    "--set %.100s: the scene has no group %.60s but a list; its first entry is "
                    "[0], as in wisps.[0].nodes=5",
                    set, path);
    else if (nearest && strcmp(nearest->name, path) != 0)
        config_fail(reader, NULL, "--set %.100s: there is no group %.60s; did you mean %s?", set,
                    path, nearest->name);
    else
        config_fail(reader, NULL, "--set %.100s: the scene has no group %.60s", set, path);
}

/* Puts the value in the place of the setting, which is made if its group exists. */
static void put_value(struct config_reader *reader, const char *set, char *path,
                      const config_setting_t *value) {
    char *dot = strrchr(path, '.');
    const char *name = dot ? dot + 1 : path;
    if (dot)
        *dot = '\0';
    config_setting_t *parent =
        dot ? config_lookup(&reader->config, path) : config_root_setting(&reader->config);
    if (!parent || !config_setting_is_group(parent)) {
        if (!fail_entry(reader, set))
            fail_path(reader, set, path, parent);
        return;
    }
    config_setting_t *there = config_setting_get_member(parent, name);
    if (there && keeps_others(parent, name, there, value)) {
        for (int i = 0; i < config_setting_length(value); i++) {
            const config_setting_t *member = config_setting_get_elem(value, (unsigned)i);
            replace(reader, set, there, config_setting_name(member), member);
        }
        return;
    }
    replace(reader, set, parent, name, value);
}

/* path.to.setting=value; the value is a number, "text", true, or a [list], (list), {group}. */
void config_set(struct config_reader *reader, const char *set) {
    const char *equals = strchr(set, '=');
    if (!equals || equals == set) {
        config_fail(reader, NULL, "--set %.100s: write --set path.to.setting=value", set);
        return;
    }
    char path[256];
    if ((size_t)(equals - set) >= sizeof path || strlen(equals) > SET_MAX) {
        config_fail(reader, NULL, "--set %.60s...: is too long", set);
        return;
    }
    snprintf(path, sizeof path, "%.*s", (int)(equals - set), set);
    config_t value;
    config_init(&value);
    if (read_value(reader, set, equals + 1, &value)) {
        if (config_setting_length(config_root_setting(&value)) != 1)
            config_fail(reader, NULL, "--set %.100s: holds more than one setting; repeat --set",
                        set);
        else
            put_value(reader, set, path, config_lookup(&value, "value"));
    }
    config_destroy(&value);
}
