#include "options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int options_find(const struct option_spec *specs, const char *name, size_t length) {
    for (int i = 0; specs && specs[i].name; i++)
        if (strlen(specs[i].name) == length && strncmp(specs[i].name, name, length) == 0)
            return i;
    return -1;
}

int parse_real(const char *text, double *value) {
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    return end == text || *end != '\0' || !isfinite(*value) ? -1 : 0;
}

static int parse_choice(const struct option_spec *spec, const char *text, double *value,
                        char *reason, size_t reason_size) {
    size_t used = 0;
    for (int i = 0; spec->choices[i]; i++) {
        if (strcmp(spec->choices[i], text) == 0) {
            *value = i;
            return 0;
        }
    }
    used +=
        (size_t)snprintf(reason, reason_size, "option %s: '%s' is not one of", spec->name, text);
    for (int i = 0; spec->choices[i] && used < reason_size; i++)
        used += (size_t)snprintf(reason + used, reason_size - used, "%s %s", i ? "," : "",
                                 spec->choices[i]);
    return -1;
}

int options_parse(const struct option_spec *spec, const char *text, double *value, char *reason,
                  size_t reason_size) {
    if (spec->kind == OPTION_CHOICE)
        return parse_choice(spec, text, value, reason, reason_size);
    if (parse_real(text, value) || *value < spec->least || *value > spec->most ||
        (spec->kind == OPTION_COUNT && *value != floor(*value))) {
        snprintf(reason, reason_size, "option %s: '%s' is not a%s from %g to %g", spec->name, text,
                 spec->kind == OPTION_COUNT ? " whole number" : " number", spec->least, spec->most);
        return -1;
    }
    return 0;
}

double option_value(const struct options *options, const struct option_spec *spec) {
    const size_t length = strlen(spec->name);
    double value = spec->initial;
    char reason[256];
    for (int i = 0; i < options->count; i++) {
        const char *text = options->given[i];
        if (strncmp(text, spec->name, length) == 0 && text[length] == '=')
            options_parse(spec, text + length + 1, &value, reason, sizeof reason);
    }
    return value;
}
