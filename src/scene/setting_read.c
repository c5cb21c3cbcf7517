#include "setting_read.h"

#include "scene_settings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- wrong values --- */

/* "NAME: WRONG RIGHT", what would be right being the row's. */
static void fail_value(struct config_reader *reader, const config_setting_t *at,
                       const struct scene_setting *row, const char *wrong) {
    char right[REASON_SIZE];
    setting_right(row, right, sizeof right);
    config_fail(reader, at, "%s: %s %s", row->name, wrong, right);
}

static void fail_type(struct config_reader *reader, const config_setting_t *setting,
                      const struct scene_setting *row) {
    fail_value(reader, setting, row, "must be");
}

static bool in_range(double x, const struct setting_range *range) {
    return isfinite(x) && (range->above ? x > range->least : x >= range->least) &&
           (range->below ? x < range->most : x <= range->most) && (!range->whole || x == floor(x));
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

/* --- defaults --- */

/* Numbers as a file has them, in brackets or alone. Returns how many. */
static int initial_numbers(const char *text, double *values) {
    int count = 0;
    for (text += strspn(text, "[ "); *text && *text != ']'; text += strspn(text, ", "))
        values[count++] = strtod(text, (char **)&text);
    return count;
}

static int place_among(const char *word, const char *const *words) {
    int i = 0;
    while (words[i] && strcmp(words[i], word) != 0)
        i++;
    return words[i] ? i : -1;
}

/* --- one setting --- */

/* The setting, or NULL where it is absent, which is an error if it must be there. */
static config_setting_t *find(struct config_reader *reader, config_setting_t *group,
                              const struct scene_setting *row) {
    config_setting_t *setting = group ? config_setting_get_member(group, row->name) : NULL;
    if (group && !setting && !row->initial)
        fail_value(reader, group, row, "missing; must be");
    return setting;
}

static double read_number(struct config_reader *reader, config_setting_t *group,
                          const struct scene_setting *row) {
    const config_setting_t *setting = find(reader, group, row);
    double initial = 0;
    if (row->initial)
        initial_numbers(row->initial, &initial);
    if (!setting)
        return initial;
    if (!config_setting_is_number(setting)) {
        fail_type(reader, setting, row);
        return initial;
    }
    const double x = number_of(setting);
    if (in_range(x, &row->range))
        return x;
    char wrong[40];
    snprintf(wrong, sizeof wrong, "%g is not", x);
    fail_value(reader, setting, row, wrong);
    return initial;
}

/* One of several numbers; they have to be finite whatever comes of it. */
static double read_member(struct config_reader *reader, const config_setting_t *member, int i,
                          const struct scene_setting *row) {
    const double x = number_of(member);
    if (in_range(x, &row->range))
        return x;
    struct scene_setting one = *row;
    char right[REASON_SIZE], shown[40] = " of it";
    one.type = SETTING_NUMBER;
    setting_what(&one, right, sizeof right);
    if (config_setting_is_number(member))
        snprintf(shown, sizeof shown, ", %g,", x);
    config_fail(reader, member, "%s: number %d%s is not %s", row->name, i + 1, shown, right);
    return one.range.least > 0 ? one.range.least : 0;
}

static int read_numbers(struct config_reader *reader, config_setting_t *group,
                        const struct scene_setting *row, double *values) {
    const config_setting_t *setting = find(reader, group, row);
    if (!setting)
        return row->initial ? initial_numbers(row->initial, values) : 0;
    const int length = config_setting_is_aggregate(setting) ? config_setting_length(setting) : -1;
    if (config_setting_is_group(setting) || length < row->least || length > row->most) {
        fail_type(reader, setting, row);
        return 0;
    }
    for (int i = 0; i < length; i++)
        values[i] = read_member(reader, config_setting_get_elem(setting, (unsigned)i), i, row);
    return length;
}

static const char *read_text(struct config_reader *reader, config_setting_t *group,
                             const struct scene_setting *row) {
    const config_setting_t *setting = find(reader, group, row);
    if (!setting)
        return NULL;
    if (config_setting_type(setting) != CONFIG_TYPE_STRING) {
        fail_value(reader, setting, row,
                   row->type == SETTING_CHOICE ? "must be a text in quotes," : "must be");
        return NULL;
    }
    const char *text = config_setting_get_string(setting);
    json_t *is_utf8 = json_string(text); /* which escapes like \xff need not give */
    if (!is_utf8) {
        config_fail(reader, setting, "%s: must be a text in UTF-8", row->name);
        return NULL;
    }
    json_decref(is_utf8);
    return text;
}

static int read_choice(struct config_reader *reader, config_setting_t *group,
                       const struct scene_setting *row) {
    const char *text = read_text(reader, group, row);
    const int at = place_among(text ? text : row->initial ? row->initial : "", row->choices);
    if (at >= 0 || !text)
        return at >= 0 ? at : 0;
    char wrong[80];
    snprintf(wrong, sizeof wrong, "'%.60s' is not", text);
    fail_value(reader, config_setting_get_member(group, row->name), row, wrong);
    return 0;
}

/* -1 where it is absent and has no default of its own. */
static int read_switch(struct config_reader *reader, config_setting_t *group,
                       const struct scene_setting *row) {
    const config_setting_t *setting = find(reader, group, row);
    if (!setting)
        return row->initial && *row->initial ? strcmp(row->initial, "true") == 0 : -1;
    if (config_setting_type(setting) != CONFIG_TYPE_BOOL)
        fail_type(reader, setting, row);
    return config_setting_get_bool(setting);
}

/* --- what a setting goes with --- */

/* The setting of the group that decides, and whether it decides for this one. */
static bool goes(struct config_reader *reader, config_setting_t *group,
                 const struct scene_setting *row, config_setting_t **decides) {
    char name[40];
    const char *with = row->with;
    *decides = NULL;
    if (!with || !group)
        return true;
    const int negated = *with == '!', length = (int)strcspn(with + negated, "=");
    snprintf(name, sizeof name, "%.*s", length, with + negated);
    *decides = config_setting_get_member(group, name);
    if (!with[negated + length])
        return (*decides != NULL) != negated;
    const struct scene_setting *other = setting_find(row->group, name);
    return strcmp(other->choices[read_choice(reader, group, other)], with + length + 1) == 0;
}

static void fail_together(struct config_reader *reader, const config_setting_t *setting,
                          const config_setting_t *decides, const struct scene_setting *row) {
    const char *with = row->with, *value = strchr(with, '=');
    char name[40];
    snprintf(name, sizeof name, "%.*s", value ? (int)(value - with) : 0, with);
    if (value)
        config_fail(reader, setting, "%s: goes with %s = \"%s\", not with \"%s\"%s", row->name,
                    name, value + 1,
                    decides ? config_setting_get_string(decides)
                            : setting_find(row->group, name)->initial,
                    decides ? "" : ", its default");
    else if (*with == '!')
        config_fail(reader, setting, "%s: does not go with a %s; leave one of them out", row->name,
                    with + 1);
    else
        config_fail(reader, setting, "%s: goes with a %s, and there is none", row->name, with);
}

/* What goes with a choice that a later file or --set has overridden goes with the choice. */
static bool refuse_or_drop(struct config_reader *reader, config_setting_t *group,
                           config_setting_t *setting, const config_setting_t *decides,
                           const struct scene_setting *row) {
    if (decides && config_layer(reader, decides) > config_layer(reader, setting))
        config_setting_remove(group, row->name);
    else
        fail_together(reader, setting, decides, row);
    return false;
}

/* Whether a setting is to be read: it is this problem's, and goes with what is there. */
static bool belongs(struct config_reader *reader, config_setting_t *group,
                    const struct scene_setting *row) {
    config_setting_t *setting = group ? config_setting_get_member(group, row->name) : NULL;
    config_setting_t *decides;
    if (setting && !(row->problems & reader->problem)) {
        char problems[100];
        setting_problems(row, problems, sizeof problems);
        config_fail(reader, setting, "%s: unknown setting of this problem; it is of %s", row->name,
                    problems);
    }
    if (goes(reader, group, row, &decides))
        return true;
    return setting ? refuse_or_drop(reader, group, setting, decides, row) : false;
}

/* --- unknown names --- */

static void add_name(char *names, const char *name) {
    strncat(names, *names ? ", " : "", REASON_SIZE - strlen(names) - 1);
    strncat(names, name, REASON_SIZE - strlen(names) - 1);
}

/* The name that it resembles, the groups that have it, or the names that there are. */
static void fail_unknown(struct config_reader *reader, const config_setting_t *setting,
                         const char *path) {
    const char *name = config_setting_name(setting);
    const struct scene_setting *nearest = setting_nearest(path, name, reader->problem);
    char elsewhere[REASON_SIZE] = "", known[REASON_SIZE] = "";
    for (const struct scene_setting *s = scene_settings; s->name; s++) {
        if (strcmp(s->name, name) == 0)
            add_name(elsewhere, *s->group ? s->group : "the scene itself");
        if (strcmp(s->group, path) == 0 && s->problems & reader->problem)
            add_name(known, s->name);
    }
    if (nearest)
        config_fail(reader, setting, "%.60s: unknown setting; did you mean %s?", name,
                    nearest->name);
    else if (*elsewhere)
        config_fail(reader, setting, "%.60s: unknown setting here; it is one of %s", name,
                    elsewhere);
    else
        config_fail(reader, setting, "%.60s: unknown setting; known here: %s", name, known);
}

static void refuse_unknown(struct config_reader *reader, config_setting_t *group,
                           const char *path) {
    for (int i = 0; group && i < config_setting_length(group); i++) {
        const config_setting_t *setting = config_setting_get_elem(group, (unsigned)i);
        if (!setting_find(path, config_setting_name(setting)))
            fail_unknown(reader, setting, path);
    }
}

/* --- a group --- */

static void read_into(struct config_reader *reader, config_setting_t *group,
                      const struct scene_setting *row, char *into) {
    double values[3] = {0};
    int count = 1;
    if (row->type == SETTING_CHOICE)
        values[0] = read_choice(reader, group, row);
    else if (row->type == SETTING_SWITCH)
        values[0] = read_switch(reader, group, row);
    else if (row->type == SETTING_NUMBERS)
        count = read_numbers(reader, group, row, values);
    else
        values[0] = read_number(reader, group, row);
    const int whole = (int)values[0];
    if (row->size == sizeof whole)
        memcpy(into + row->at, &whole, sizeof whole);
    else
        memcpy(into + row->at, values, (size_t)count * sizeof *values);
}

void settings_read(struct config_reader *reader, config_setting_t *group, const char *path,
                   void *into) {
    refuse_unknown(reader, group, path);
    for (const struct scene_setting *row = scene_settings; row->name; row++)
        if (strcmp(row->group, path) == 0 && belongs(reader, group, row) && row->size > 0)
            read_into(reader, row->problems & reader->problem ? group : NULL, row, into);
}

/* --- by hand --- */

config_setting_t *setting_group(struct config_reader *reader, config_setting_t *group,
                                const char *path, const char *name) {
    const struct scene_setting *row = setting_find(path, name);
    config_setting_t *found = find(reader, group, row);
    const bool list = row->type == SETTING_LIST;
    if (!found || (!list && config_setting_is_group(found)) ||
        (list && config_setting_is_list(found) && config_setting_length(found) > 0))
        return found;
    fail_type(reader, found, row);
    return NULL;
}

double setting_number(struct config_reader *reader, config_setting_t *group, const char *path,
                      const char *name) {
    return read_number(reader, group, setting_find(path, name));
}

const char *setting_text(struct config_reader *reader, config_setting_t *group, const char *path,
                         const char *name, const char *absent) {
    const char *text = read_text(reader, group, setting_find(path, name));
    return text ? text : absent;
}

int setting_choice(struct config_reader *reader, config_setting_t *group, const char *path,
                   const char *name) {
    return read_choice(reader, group, setting_find(path, name));
}

int setting_numbers(struct config_reader *reader, config_setting_t *group, const char *path,
                    const char *name, double *values) {
    return read_numbers(reader, group, setting_find(path, name), values);
}

void setting_vectors(struct config_reader *reader, config_setting_t *group, const char *path,
                     const char *name, int count, double (*vectors)[3]) {
    const struct scene_setting *row = setting_find(path, name);
    const config_setting_t *list = config_setting_get_member(group, name);
    if (!list || !config_setting_is_list(list) || config_setting_length(list) != count) {
        config_fail(reader, list ? list : group,
                    "%s: must be a list of %d vectors, ([x, y, z], "
                    "...)%s%s",
                    name, count, row->unit ? ", in " : "", row->unit ? row->unit : "");
        return;
    }
    for (int k = 0; k < count; k++) {
        const config_setting_t *entry = config_setting_get_elem(list, (unsigned)k);
        const int length = config_setting_is_aggregate(entry) ? config_setting_length(entry) : -1;
        if (config_setting_is_group(entry) || length != 3)
            config_fail(reader, entry, "%s: vector %d is not 3 numbers in brackets", name, k + 1);
        for (int i = 0; i < 3 && length == 3; i++)
            vectors[k][i] =
                read_member(reader, config_setting_get_elem(entry, (unsigned)i), i, row);
    }
}

void setting_normalise(struct config_reader *reader, config_setting_t *group, const char *name,
                       double x[3]) {
    const double most = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
    double length = 0;
    if (most == 0) {
        config_fail(reader, config_setting_get_member(group, name), "%s: has no length", name);
        return;
    }
    for (int k = 0; k < 3; k++) /* first by the largest, so that no square overflows or vanishes */
        length += (x[k] / most) * (x[k] / most);
    for (int k = 0; k < 3; k++)
        x[k] = x[k] / most / sqrt(length);
}
