/* The settings of a scene as they stand in its file, in those that it builds on, in what was set on
 * the command line or in a run.json: one tree, which remembers where each is from. The first error
 * is kept, so that a caller asks for everything and looks once. */
#ifndef WISPLAB_CONFIG_H
#define WISPLAB_CONFIG_H

#include "base/files.h"

#include <jansson.h>
#include <libconfig.h>
#include <stdbool.h>

struct config_base;

struct config_reader {
    config_t config;
    char file[PATH_SIZE];      /* for messages */
    int lines;                 /* of it, where what is missing at its top is missed; 0: not known */
    struct config_base *bases; /* what it builds on, the farthest first */
    unsigned problem;          /* that the scene poses, a bit of scene_settings.h; 0: none known */
    bool failed;
    bool out_of_memory; /* the failure is the machine's */
    char *reason;       /* REASON_SIZE, the caller's */
};

/* Reads a file, with what it includes from its folder and what it builds on, and applies overrides
 * "path=value". Check reader->failed; close in any case. */
void config_open(struct config_reader *reader, const char *path, const char *const *sets,
                 int set_count, char *reason);

/* Opens the text that stands for a file: what it includes is in that file's folder, and
 * messages name it. */
void config_open_text(struct config_reader *reader, const char *text, const char *path,
                      const char *const *sets, int set_count, char *reason);

/* Opens a scene in the form of config_to_json; `file`, where it is from, is for messages. */
void config_open_json(struct config_reader *reader, const json_t *json, const char *file,
                      const char *const *sets, int set_count, char *reason);

void config_close(struct config_reader *reader);

/* The root group. */
config_setting_t *config_top(struct config_reader *reader);

/* Records an error at `setting`: the file and line where it stands, of the root group the last; of
 * what was set, that; NULL: the file alone. */
void config_fail(struct config_reader *reader, const config_setting_t *setting, const char *format,
                 ...) __attribute__((format(printf, 3, 4)));

/* How late a setting was said: what a file says is above what those say that it builds on, and what
 * was set is above all. */
int config_layer(const struct config_reader *reader, const config_setting_t *setting);

/* The scene file that says it, from whose folder paths are. */
const char *config_file_of(const struct config_reader *reader, const config_setting_t *setting);

/* The file of a scene, into `path` (PATH_SIZE): a name is a shipped scene, anything with a slash or
 * an ending .cfg a path from the folder of the file `beside`; "" is the current folder's. Returns
 * 0, or -1 where it is too long. */
int config_path(const char *name, const char *beside, char *path);

/* The whole setting as JSON, every number a real: equal scenes give equal texts. New reference. */
json_t *config_to_json(const config_setting_t *setting);

#endif
