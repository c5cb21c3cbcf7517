/* What the sources of a configuration share: its file, those that it builds on, --set. */
#ifndef WISPLAB_CONFIG_PARTS_H
#define WISPLAB_CONFIG_PARTS_H

#include "config.h"

#include <sys/stat.h>

/* A file that is built upon, kept as it was read: copies of its settings point to them. */
struct config_base {
    config_t config;
    char file[PATH_SIZE];
    struct stat status; /* of the file, which tells it from others */
    int depth;          /* 1: the scene names it; 2: that one does; ... */
    struct config_base *next;
};

/* Reads one file, or the text that stands for it, with what it includes, and tells how many lines
 * it has, 0: not known. */
void config_read_scene(struct config_reader *reader, config_t *config, const char *path,
                       const char *instead, int *lines);

/* Adds what the file's bases say and it does not. */
void config_build(struct config_reader *reader);
void config_free_bases(struct config_reader *reader);

/* Applies one override. */
void config_set(struct config_reader *reader, const char *set);

/* Adds a copy of a setting, which stands where that one does, or was set; NULL where the name is
 * none. */
config_setting_t *config_copy(config_setting_t *parent, const char *name,
                              const config_setting_t *from, int is_set);

/* What libconfig means by an array of unlike numbers. */
const char *config_hint(const char *error);

#endif
