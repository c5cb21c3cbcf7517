#include "config.h"

#include "base/visible.h"
#include "config_parts.h"
#include "config_text.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* --- where a setting is from --- */

/* A copy has a hook, which libconfig keeps and never looks at: what it is a copy of, or of what was
 * set this mark, for its text is gone. */
static char was_set;

static const config_setting_t *original(const config_setting_t *setting) {
    const void *hook = config_setting_get_hook(setting);
    return hook && hook != &was_set ? hook : setting;
}

/* NULL: the scene's own. */
static const struct config_base *base_of(const struct config_reader *reader,
                                         const config_setting_t *setting) {
    const struct config_base *base = reader->bases;
    while (base && original(setting)->config != &base->config)
        base = base->next;
    return base;
}

int config_layer(const struct config_reader *reader, const config_setting_t *setting) {
    const struct config_base *base = base_of(reader, setting);
    return config_setting_get_hook(setting) == &was_set ? INT_MAX : base ? -base->depth : 0;
}

const char *config_file_of(const struct config_reader *reader, const config_setting_t *setting) {
    const struct config_base *base = base_of(reader, setting);
    return base ? base->file : reader->file;
}

/* "file:line: ", as much as is known. Returns its length. */
static int print_place(const struct config_reader *reader, const config_setting_t *setting,
                       char *text) {
    if (setting && config_setting_get_hook(setting) == &was_set)
        return snprintf(text, REASON_SIZE, "%.120s: --set: ", reader->file);
    const config_setting_t *from = setting ? original(setting) : NULL;
    const char *file = from ? config_setting_source_file(from) : NULL;
    const unsigned line = !from                          ? 0
                          : config_setting_is_root(from) ? (unsigned)reader->lines
                                                         : config_setting_source_line(from);
    if (line > 0)
        return snprintf(text, REASON_SIZE, "%.120s:%u: ", file ? file : reader->file, line);
    return snprintf(text, REASON_SIZE, "%.120s: ", file ? file : reader->file);
}

void config_fail(struct config_reader *reader, const config_setting_t *setting, const char *format,
                 ...) {
    if (reader->failed)
        return;
    reader->failed = true;
    char why[REASON_SIZE]; /* with texts of the scene, which may have lines */
    const int used = print_place(reader, setting, why);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why + used, REASON_SIZE - (size_t)used, format, arguments);
    va_end(arguments);
    visible_text(why, reader->reason, REASON_SIZE);
}

/* --- copies --- */

static int copy_value(config_setting_t *to, const config_setting_t *from, int is_set) {
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
            if (!config_copy(to, config_setting_name(member), member, is_set))
                return 0;
        }
        return 1;
    }
}

config_setting_t *config_copy(config_setting_t *parent, const char *name,
                              const config_setting_t *from, int is_set) {
    config_setting_t *to = config_setting_add(parent, name, config_setting_type(from));
    if (to)
        config_setting_set_hook(to, is_set ? (void *)&was_set : (void *)(uintptr_t)from);
    return to && copy_value(to, from, is_set) ? to : NULL;
}

/* --- files --- */

const char *config_hint(const char *error) {
    return strstr(error, "element type") ? "; write 2.0 beside 2.5, not 2" : "";
}

/* What a scene includes stands beside it, wherever the program was started. */
static void folder_of(const char *path, char *folder) {
    const char *slash = strrchr(path, '/');
    path_format(folder, "%.*s", slash == path ? 1 : slash ? (int)(slash - path) : 0, path);
}

int config_path(const char *name, const char *beside, char *path) {
    const size_t length = strlen(name);
    char folder[PATH_SIZE];
    if (!strchr(name, '/') && (length <= 4 || strcmp(name + length - 4, ".cfg") != 0))
        return path_format(path, "%s/experiments/%s.cfg", data_folder(), name);
    folder_of(beside, folder);
    if (name[0] == '/' || !*folder)
        return path_format(path, "%s", name);
    return path_format(path, "%s/%s", folder, name);
}

void config_read_scene(struct config_reader *reader, config_t *config, const char *path,
                       const char *instead, int *lines) {
    char folder[PATH_SIZE];
    folder_of(path, folder);
    if (*folder)
        config_set_include_dir(config, folder);
    const int wrong = instead ? config_check_scene(instead, path, folder, lines, reader->reason)
                              : config_check_file(path, folder, lines, reader->reason);
    reader->failed = wrong != 0;
    reader->out_of_memory = wrong < 0;
    if (wrong || (instead ? config_read_string(config, instead) : config_read_file(config, path)))
        return;
    reader->failed = true;
    const char *file = config_error_file(config), *text = config_error_text(config);
    const int line = config_error_line(config);
    if (line > 0)
        snprintf(reader->reason, REASON_SIZE, "%.120s:%d: %s%s", file ? file : path, line, text,
                 config_hint(text));
    else
        snprintf(reader->reason, REASON_SIZE, "%.120s: %s", path, text);
}

static void begin(struct config_reader *reader, const char *file, char *reason) {
    *reader = (struct config_reader){.reason = reason};
    path_format(reader->file, "%s", file);
    config_init(&reader->config);
}

static void set_all(struct config_reader *reader, const char *const *sets, int set_count) {
    for (int i = 0; i < set_count && !reader->failed; i++)
        config_set(reader, sets[i]);
}

void config_open(struct config_reader *reader, const char *path, const char *const *sets,
                 int set_count, char *reason) {
    begin(reader, path, reason);
    if (file_exists(path))
        config_read_scene(reader, &reader->config, path, NULL, &reader->lines);
    else if (errno == EACCES)
        config_fail(reader, NULL, "cannot be read: %s", strerror(errno));
    else
        config_fail(reader, NULL,
                    "no such scene file; `wisplab list scenes` names the shipped ones");
    config_build(reader);
    set_all(reader, sets, set_count);
}

void config_open_text(struct config_reader *reader, const char *text, const char *path,
                      const char *const *sets, int set_count, char *reason) {
    begin(reader, path, reason);
    config_read_scene(reader, &reader->config, reader->file, text, &reader->lines);
    config_build(reader);
    set_all(reader, sets, set_count);
}

/* --- JSON --- */

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
    begin(reader, file, reason);
    if (!add_members(config_root_setting(&reader->config), json))
        config_fail(reader, NULL, "what it has for a scene is none");
    set_all(reader, sets, set_count);
}

void config_close(struct config_reader *reader) {
    config_destroy(&reader->config);
    config_free_bases(reader);
}

config_setting_t *config_top(struct config_reader *reader) {
    return config_root_setting(&reader->config);
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
