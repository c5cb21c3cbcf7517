#include "config.h"

#include "base/visible.h"
#include "config_text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void config_fail(struct config_reader *reader, const config_setting_t *setting, const char *format,
                 ...) {
    if (reader->failed)
        return;
    reader->failed = true;
    const char *file = setting ? config_setting_source_file(setting) : NULL;
    const unsigned line = !setting                          ? 0
                          : config_setting_is_root(setting) ? (unsigned)reader->lines
                                                            : config_setting_source_line(setting);
    char why[REASON_SIZE]; /* with texts of the scene, which may have lines */
    int used = snprintf(why, REASON_SIZE, "%.120s:", file ? file : reader->file);
    if (line > 0)
        used += snprintf(why + used, REASON_SIZE - (size_t)used, "%u:", line);
    why[used++] = ' ';
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why + used, REASON_SIZE - (size_t)used, format, arguments);
    va_end(arguments);
    visible_text(why, reader->reason, REASON_SIZE);
}

/* What --set gave is marked by a hook, which libconfig keeps and never looks at. */
static void mark_set(config_setting_t *setting) {
    static char mark;
    config_setting_set_hook(setting, &mark);
}

bool config_is_set(const config_setting_t *setting) {
    return setting && config_setting_get_hook(setting);
}

static config_setting_t *copy_setting(config_setting_t *parent, const char *name,
                                      const config_setting_t *from);

static int copy_value(config_setting_t *to, const config_setting_t *from) {
    switch (config_setting_type(from)) {
    case CONFIG_TYPE_INT:
        return config_setting_set_int(to, config_setting_get_int(from));
    case CONFIG_TYPE_INT64:
        return config_setting_set_int64(to, config_setting_get_int64(from));
    case CONFIG_TYPE_FLOAT:
        return config_setting_set_float(to, config_setting_get_float(from));
    case CONFIG_TYPE_BOOL:
        return config_setting_set_bool(to, config_setting_get_bool(from));
    case CONFIG_TYPE_STRING:
        return config_setting_set_string(to, config_setting_get_string(from));
    default:
        for (int i = 0; i < config_setting_length(from); i++) {
            const config_setting_t *member = config_setting_get_elem(from, (unsigned)i);
            if (!copy_setting(to, config_setting_name(member), member))
                return 0;
        }
        return 1;
    }
}

static config_setting_t *copy_setting(config_setting_t *parent, const char *name,
                                      const config_setting_t *from) {
    config_setting_t *to = config_setting_add(parent, name, config_setting_type(from));
    if (to)
        mark_set(to);
    return to && copy_value(to, from) ? to : NULL;
}

/* What libconfig means by an array of unlike numbers. */
static const char *hint(const char *error) {
    return strstr(error, "element type") ? "; write 2.0 beside 2.5, not 2" : "";
}

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
                config_error_text(value), hint(config_error_text(value)));
    return false;
}

static void replace(struct config_reader *reader, const char *set, config_setting_t *parent,
                    const char *name, const config_setting_t *value) {
    if (config_setting_get_member(parent, name))
        config_setting_remove(parent, name);
    if (!copy_setting(parent, name, value))
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
        config_fail(reader, NULL, "--set %.100s: the scene has no group %.60s%s", set, path,
                    parent && config_setting_is_aggregate(parent)
                        ? " but a list; its first entry is [0], as in wisps.[0].nodes=5"
                        : "");
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
static void apply_set(struct config_reader *reader, const char *set) {
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

/* What a scene includes stands beside it, wherever the program was started. */
static void folder_of(const char *path, char *folder) {
    const char *slash = strrchr(path, '/');
    path_format(folder, "%.*s", slash == path ? 1 : slash ? (int)(slash - path) : 0, path);
}

static void read_file(struct config_reader *reader, const char *path) {
    char folder[PATH_SIZE];
    folder_of(path, folder);
    if (*folder)
        config_set_include_dir(&reader->config, folder);
    const int wrong = config_check_file(path, folder, &reader->lines, reader->reason);
    reader->failed = wrong != 0;
    reader->out_of_memory = wrong < 0;
    if (wrong || config_read_file(&reader->config, path))
        return;
    reader->failed = true;
    const char *file = config_error_file(&reader->config),
               *text = config_error_text(&reader->config);
    const int line = config_error_line(&reader->config);
    if (line > 0)
        snprintf(reader->reason, REASON_SIZE, "%.120s:%d: %s%s", file ? file : path, line, text,
                 hint(text));
    else
        snprintf(reader->reason, REASON_SIZE, "%.120s: %s", path, text);
}

void config_open(struct config_reader *reader, const char *path, const char *const *sets,
                 int set_count, char *reason) {
    *reader = (struct config_reader){.reason = reason};
    path_format(reader->file, "%s", path);
    config_init(&reader->config);
    if (file_exists(path))
        read_file(reader, path);
    else if (errno == EACCES)
        config_fail(reader, NULL, "cannot be read: %s", strerror(errno));
    else
        config_fail(reader, NULL,
                    "no such scene file; `wisplab list scenes` names the shipped ones");
    for (int i = 0; i < set_count && !reader->failed; i++)
        apply_set(reader, sets[i]);
}

static int add_json(config_setting_t *parent, const char *name, const json_t *json);

/* Arrays become lists, which are read wherever an array is. Every member, or 0. */
static int add_members(config_setting_t *group, const json_t *json) {
    const char *name;
    json_t *member;
    size_t i;
    int ok = 1;
    if (json_is_array(json)) {
        json_array_foreach(json, i, member) ok = ok && add_json(group, NULL, member);
    } else {
        json_object_foreach((json_t *)json, name, member) ok = ok && add_json(group, name, member);
    }
    return ok;
}

static int config_type(const json_t *json) {
    static const int types[] = {
        [JSON_OBJECT] = CONFIG_TYPE_GROUP,  [JSON_ARRAY] = CONFIG_TYPE_LIST,
        [JSON_STRING] = CONFIG_TYPE_STRING, [JSON_INTEGER] = CONFIG_TYPE_FLOAT,
        [JSON_REAL] = CONFIG_TYPE_FLOAT,    [JSON_TRUE] = CONFIG_TYPE_BOOL,
        [JSON_FALSE] = CONFIG_TYPE_BOOL,    [JSON_NULL] = CONFIG_TYPE_NONE};
    return types[json_typeof(json)];
}

static int add_json(config_setting_t *parent, const char *name, const json_t *json) {
    const int type = config_type(json);
    config_setting_t *setting =
        type == CONFIG_TYPE_NONE ? NULL : config_setting_add(parent, name, type);
    if (!setting) /* nor for a name that libconfig would not read */
        return 0;
    if (type == CONFIG_TYPE_FLOAT)
        return config_setting_set_float(setting, json_number_value(json));
    if (type == CONFIG_TYPE_BOOL)
        return config_setting_set_bool(setting, json_is_true(json));
    if (type == CONFIG_TYPE_STRING)
        return config_setting_set_string(setting, json_string_value(json));
    return add_members(setting, json);
}

void config_open_json(struct config_reader *reader, const json_t *json, const char *file,
                      const char *const *sets, int set_count, char *reason) {
    *reader = (struct config_reader){.reason = reason};
    path_format(reader->file, "%s", file);
    config_init(&reader->config);
    if (!add_members(config_root_setting(&reader->config), json))
        config_fail(reader, NULL, "what it has for a scene is none");
    for (int i = 0; i < set_count && !reader->failed; i++)
        apply_set(reader, sets[i]);
}

void config_close(struct config_reader *reader) {
    config_destroy(&reader->config);
}

config_setting_t *config_top(struct config_reader *reader) {
    return config_root_setting(&reader->config);
}

config_setting_t *config_group(struct config_reader *reader, config_setting_t *group,
                               const char *name) {
    config_setting_t *found = group ? config_setting_get_member(group, name) : NULL;
    if (found && !config_setting_is_group(found))
        config_fail(reader, found, "%s: must be a group in braces", name);
    return found && config_setting_is_group(found) ? found : NULL;
}

static const char *range_name(enum config_range range) {
    static const char *const names[] = {"a finite number", "a positive number",
                                        "a number that is not negative",
                                        "a whole number that is not negative"};
    return names[range];
}

static bool in_range(double x, enum config_range range) {
    return isfinite(x) && (range != POSITIVE || x > 0) && (range < NOT_NEGATIVE || x >= 0) &&
           (range != WHOLE || x == floor(x));
}

/* The value of a setting that holds a number, else NaN. */
static double number_of(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
        return config_setting_get_int(setting);
    case CONFIG_TYPE_INT64:
        return (double)config_setting_get_int64(setting);
    case CONFIG_TYPE_FLOAT:
        return config_setting_get_float(setting);
    default:
        return NAN;
    }
}

double config_number(struct config_reader *reader, config_setting_t *group, const char *name,
                     enum config_range range, double absent) {
    config_setting_t *setting = group ? config_setting_get_member(group, name) : NULL;
    if (!setting)
        return absent;
    const double x = number_of(setting);
    if (config_setting_is_number(setting) && in_range(x, range))
        return x;
    if (!config_setting_is_number(setting))
        config_fail(reader, setting, "%s: must be %s", name, range_name(range));
    else
        config_fail(reader, setting, "%s: %g is not %s", name, x, range_name(range));
    return absent;
}

int config_numbers_of(struct config_reader *reader, const config_setting_t *setting,
                      const char *name, int least, int count, double *values) {
    const int length = config_setting_is_aggregate(setting) ? config_setting_length(setting) : -1;
    if (config_setting_is_group(setting) || length < least || length > count) {
        if (least == count)
            config_fail(reader, setting, "%s: must be %d numbers in brackets", name, count);
        else
            config_fail(reader, setting, "%s: must be %d to %d numbers in brackets", name, least,
                        count);
        return 0;
    }
    for (int i = 0; i < length; i++) {
        values[i] = number_of(config_setting_get_elem(setting, (unsigned)i));
        if (isfinite(values[i]))
            continue;
        config_fail(reader, setting, "%s: number %d of it is not a finite number", name, i + 1);
        values[i] = 0;
    }
    return length;
}

int config_numbers(struct config_reader *reader, config_setting_t *group, const char *name,
                   int least, int count, double *values) {
    const config_setting_t *setting = group ? config_setting_get_member(group, name) : NULL;
    return setting ? config_numbers_of(reader, setting, name, least, count, values) : 0;
}

void config_vectors(struct config_reader *reader, config_setting_t *group, const char *name,
                    int count, double (*vectors)[3]) {
    const config_setting_t *list = config_setting_get_member(group, name);
    if (!list || !config_setting_is_list(list) || config_setting_length(list) != count) {
        config_fail(reader, list ? list : group,
                    "%s: must be a list of %d vectors, ([x, y, z], ...)", name, count);
        return;
    }
    for (int k = 0; k < count; k++)
        config_numbers_of(reader, config_setting_get_elem(list, (unsigned)k), name, 3, 3,
                          vectors[k]);
}

void config_vector(struct config_reader *reader, config_setting_t *group, const char *name,
                   double vector[3]) {
    if (group && !config_setting_get_member(group, name))
        config_fail(reader, group, "%s: missing; must be 3 numbers in brackets", name);
    config_numbers(reader, group, name, 3, 3, vector);
}

double config_required(struct config_reader *reader, config_setting_t *group, const char *name,
                       enum config_range range) {
    if (group && !config_setting_get_member(group, name))
        config_fail(reader, group, "%s: missing; must be %s", name, range_name(range));
    return config_number(reader, group, name, range, 0);
}

const char *config_text(struct config_reader *reader, config_setting_t *group, const char *name,
                        const char *absent) {
    config_setting_t *setting = group ? config_setting_get_member(group, name) : NULL;
    if (!setting)
        return absent;
    if (config_setting_type(setting) != CONFIG_TYPE_STRING) {
        config_fail(reader, setting, "%s: must be a text in quotes", name);
        return absent;
    }
    const char *text = config_setting_get_string(setting);
    json_t *is_utf8 = json_string(text); /* which escapes like \xff need not give */
    if (!is_utf8) {
        config_fail(reader, setting, "%s: must be a text in UTF-8", name);
        return absent;
    }
    json_decref(is_utf8);
    return text;
}

bool config_switch(struct config_reader *reader, config_setting_t *group, const char *name,
                   bool absent) {
    config_setting_t *setting = group ? config_setting_get_member(group, name) : NULL;
    if (!setting)
        return absent;
    if (config_setting_type(setting) != CONFIG_TYPE_BOOL)
        config_fail(reader, setting, "%s: must be true or false", name);
    return config_setting_get_bool(setting);
}

void config_known(struct config_reader *reader, config_setting_t *group, const char *const *known) {
    for (int i = 0; group && i < config_setting_length(group); i++) {
        const config_setting_t *setting = config_setting_get_elem(group, (unsigned)i);
        int k = 0;
        while (known[k] && strcmp(known[k], config_setting_name(setting)) != 0)
            k++;
        if (known[k])
            continue;
        char names[REASON_SIZE] = "";
        for (k = 0; known[k]; k++) {
            strncat(names, k ? ", " : "", sizeof names - strlen(names) - 1);
            strncat(names, known[k], sizeof names - strlen(names) - 1);
        }
        config_fail(reader, setting, "%.60s: unknown setting; known here: %s",
                    config_setting_name(setting), names);
    }
}

json_t *config_to_json(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
        return json_real(config_setting_get_int(setting));
    case CONFIG_TYPE_INT64:
        return json_real((double)config_setting_get_int64(setting));
    case CONFIG_TYPE_FLOAT:
        return json_real(config_setting_get_float(setting));
    case CONFIG_TYPE_BOOL:
        return json_boolean(config_setting_get_bool(setting));
    case CONFIG_TYPE_STRING:
        return json_string(config_setting_get_string(setting));
    default:
        break;
    }
    json_t *json = config_setting_is_group(setting) ? json_object() : json_array();
    for (int i = 0; i < config_setting_length(setting); i++) {
        const config_setting_t *member = config_setting_get_elem(setting, (unsigned)i);
        if (config_setting_is_group(setting))
            json_object_set_new(json, config_setting_name(member), config_to_json(member));
        else
            json_array_append_new(json, config_to_json(member));
    }
    return json;
}
