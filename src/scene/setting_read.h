/* Reads settings as the table of scene_settings.h has them. What is wrong with one is the reader's
 * error, at its line: what stands there, and what would be right. */
#ifndef WISPLAB_SETTING_READ_H
#define WISPLAB_SETTING_READ_H

#include "config.h"

/* Reads a group, or an entry of a list, whose settings the table has under `path`, into its struct,
 * which is all 0 where nothing says otherwise: every setting that has a place there, with its
 * default where it is absent (a switch without one is then -1). Refuses what is not known, what
 * another problem has, and what goes with something that is not there; what a file that is built
 * upon has of the latter is taken out. `group` NULL: the defaults alone. */
void settings_read(struct config_reader *reader, config_setting_t *group, const char *path,
                   void *into);

/* Those that are read by hand, after settings_read: one of a group by its name. */

/* A group or a list, or NULL where it is absent or is none; a list has an entry at least. */
config_setting_t *setting_group(struct config_reader *reader, config_setting_t *group,
                                const char *path, const char *name);

/* A number, its default, or 0. */
double setting_number(struct config_reader *reader, config_setting_t *group, const char *path,
                      const char *name);

/* A text, or `absent`. */
const char *setting_text(struct config_reader *reader, config_setting_t *group, const char *path,
                         const char *name, const char *absent);

/* Which of its words a choice is. */
int setting_choice(struct config_reader *reader, config_setting_t *group, const char *path,
                   const char *name);

/* Numbers in brackets, into room for as many as there may be. Returns how many there are; without
 * any, its default's, or 0. */
int setting_numbers(struct config_reader *reader, config_setting_t *group, const char *path,
                    const char *name, double *values);

/* A list of `count` vectors. */
void setting_vectors(struct config_reader *reader, config_setting_t *group, const char *path,
                     const char *name, int count, double (*vectors)[3]);

/* Scales the vector of that name to length 1; a zero vector is refused. */
void setting_normalise(struct config_reader *reader, config_setting_t *group, const char *name,
                       double vector[3]);

#endif
