/* base = "other.cfg": a scene that says only what differs from another one. Groups are merged
 * setting by setting; everything else, lists too, is taken whole from the file that says it last.
 */
#include "config_parts.h"

#include <stdlib.h>
#include <string.h>

/* A scene has a name of its own, and its base is no part of what it is. */
static bool is_inherited(const config_setting_t *setting) {
    const char *name = config_setting_name(setting);
    return !config_setting_is_root(config_setting_parent(setting)) ||
           (strcmp(name, "base") != 0 && strcmp(name, "name") != 0);
}

/* Gives a group what a group of a base has and it has not. */
static void inherit(config_setting_t *group, const config_setting_t *from) {
    for (int i = 0; i < config_setting_length(from); i++) {
        const config_setting_t *theirs = config_setting_get_elem(from, (unsigned)i);
        const char *name = config_setting_name(theirs);
        config_setting_t *ours = config_setting_get_member(group, name);
        if (!ours && is_inherited(theirs))
            config_copy(group, name, theirs, 0);
        else if (ours && config_setting_is_group(ours) && config_setting_is_group(theirs))
            inherit(ours, theirs);
    }
}

/* Whether the file is one of those that have led to it; the scene's own is among them the second
 * time. */
static bool goes_round(const struct config_reader *reader, const struct stat *status) {
    for (const struct config_base *base = reader->bases; base; base = base->next)
        if (base->status.st_dev == status->st_dev && base->status.st_ino == status->st_ino)
            return true;
    return false;
}

/* The path that a setting `base` names. Returns 0, or -1 where it is none. */
static int find_base(struct config_reader *reader, const config_setting_t *said,
                     struct config_base *base) {
    const char *name = config_setting_get_string(said);
    const char *why = NULL;
    if (!name || !*name || config_path(name, config_file_of(reader, said), base->file))
        config_fail(reader, said,
                    "base: must be a text in quotes, the path of a scene file from this one's "
                    "folder or the name of a shipped scene");
    else if (stat(base->file, &base->status) || !file_exists(base->file))
        why = strchr(name, '/') || strchr(name, '.')
                  ? "there is no such file beside this one, or it cannot be read"
                  : "there is no such shipped scene; a file's name ends in .cfg";
    else if (!S_ISREG(base->status.st_mode))
        why = "is no regular file";
    else if (goes_round(reader, &base->status))
        why = "goes in a circle: that scene builds on this one";
    if (why)
        config_fail(reader, said, "base: \"%.100s\": %s", name, why);
    return reader->failed ? -1 : 0;
}

/* Reads the file that `said` names; returns its own setting `base`, or NULL. */
static const config_setting_t *read_base(struct config_reader *reader,
                                         const config_setting_t *said) {
    int lines;
    struct config_base *base = calloc(1, sizeof *base);
    if (!base) {
        reader->out_of_memory = true;
        config_fail(reader, said, "base: out of memory");
        return NULL;
    }
    config_init(&base->config);
    base->depth = reader->bases ? reader->bases->depth + 1 : 1;
    if (find_base(reader, said, base) == 0)
        config_read_scene(reader, &base->config, base->file, NULL, &lines);
    base->next = reader->bases;
    reader->bases = base;
    if (reader->failed)
        return NULL;
    const config_setting_t *top = config_root_setting(&base->config);
    inherit(config_top(reader), top);
    return config_setting_get_member(top, "base");
}

void config_build(struct config_reader *reader) {
    const config_setting_t *said =
        reader->failed ? NULL : config_setting_get_member(config_top(reader), "base");
    while (said)
        said = read_base(reader, said);
    if (!reader->failed && reader->bases)
        config_setting_remove(config_top(reader), "base");
}

void config_free_bases(struct config_reader *reader) {
    while (reader->bases) {
        struct config_base *next = reader->bases->next;
        config_destroy(&reader->bases->config);
        free(reader->bases);
        reader->bases = next;
    }
}
