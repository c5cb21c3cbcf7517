/* Checked reading of libconfig groups. The first error is kept and later reads do nothing, so that
 * a caller asks for everything and looks once. */
#ifndef WISPLAB_CONFIG_H
#define WISPLAB_CONFIG_H

#include "base/files.h"

#include <jansson.h>
#include <libconfig.h>
#include <stdbool.h>

/* What a number may be. */
enum config_range { ANY, POSITIVE, NOT_NEGATIVE, WHOLE };

struct config_reader {
    config_t config;
    char file[PATH_SIZE]; /* for messages */
    int lines;            /* of it, where what is missing at its top is missed; 0: not known */
    bool failed;
    bool out_of_memory; /* the failure is the machine's */
    char *reason;       /* REASON_SIZE, the caller's */
};

/* Reads a file, with what it includes from its folder, and applies overrides "path=value". Check
 * reader->failed; close in any case. */
void config_open(struct config_reader *reader, const char *path, const char *const *sets,
                 int set_count, char *reason);

/* The same of a scene in the form of config_to_json; `file`, where it is from, is for messages. */
void config_open_json(struct config_reader *reader, const json_t *json, const char *file,
                      const char *const *sets, int set_count, char *reason);

void config_close(struct config_reader *reader);

/* The root group. */
config_setting_t *config_top(struct config_reader *reader);

/* A group inside `group`, or NULL where it is absent or, which is an error, no group. */
config_setting_t *config_group(struct config_reader *reader, config_setting_t *group,
                               const char *name);

/* A number or a text; the second form returns `absent` where the setting is absent, and each a
 * number that is in the range, or `absent`, where it is wrong. */
double config_required(struct config_reader *reader, config_setting_t *group, const char *name,
                       enum config_range range);
double config_number(struct config_reader *reader, config_setting_t *group, const char *name,
                     enum config_range range, double absent);
const char *config_text(struct config_reader *reader, config_setting_t *group, const char *name,
                        const char *absent);

/* true or false. */
bool config_switch(struct config_reader *reader, config_setting_t *group, const char *name,
                   bool absent);

/* `count` numbers in brackets; where `least` is less than `count`, that many will do. Returns how
 * many there are, 0 where the setting is absent. */
int config_numbers(struct config_reader *reader, config_setting_t *group, const char *name,
                   int least, int count, double *values);

/* The same of a setting itself; `name` is for messages. */
int config_numbers_of(struct config_reader *reader, const config_setting_t *setting,
                      const char *name, int least, int count, double *values);

/* A list of `count` vectors, ([x, y, z], ...), which must be there. */
void config_vectors(struct config_reader *reader, config_setting_t *group, const char *name,
                    int count, double (*vectors)[3]);

/* Three numbers in brackets, which must be there. */
void config_vector(struct config_reader *reader, config_setting_t *group, const char *name,
                   double vector[3]);

/* Refuses settings of `group` whose names are not in `known` (NULL-terminated). */
void config_known(struct config_reader *reader, config_setting_t *group, const char *const *known);

/* Records an error at `setting`: file and line, of the root group the last; NULL: the file alone.
 */
void config_fail(struct config_reader *reader, const config_setting_t *setting, const char *format,
                 ...) __attribute__((format(printf, 3, 4)));

/* Whether --set gave the setting, which may be NULL. */
bool config_is_set(const config_setting_t *setting);

/* The whole setting as JSON, every number a real: equal scenes give equal texts. New reference. */
json_t *config_to_json(const config_setting_t *setting);

#endif
