/* Settings that belong to one stepper or one linear solver: declared as data beside the method,
 * checked and documented in one place, given as --option KEY=VALUE. */
#ifndef WISPLAB_OPTIONS_H
#define WISPLAB_OPTIONS_H

#include <stddef.h>

enum option_kind { OPTION_REAL, OPTION_COUNT, OPTION_CHOICE };

/* A list of these ends with a name of NULL. A value is a double: the number itself, or the index
 * of a choice. */
struct option_spec {
    const char *name; /* "newton.iterations" */
    const char *help; /* one line, with the unit */
    enum option_kind kind;
    double initial;             /* default value */
    double least, most;         /* inclusive range of a number */
    const char *const *choices; /* of OPTION_CHOICE, NULL-terminated */
};

/* What was given of them, each as "key=value" that has been checked: the last one of a key counts.
 * List and texts belong to who made them, and must stay as long as this is used. */
struct options {
    const char *const *given;
    int count;
};

/* What was given of `spec`, or its default. */
double option_value(const struct options *options, const struct option_spec *spec);

/* Index of the option called `name` (its first `length` characters), or -1. */
int options_find(const struct option_spec *specs, const char *name, size_t length);

/* Reads `text` as a value of `spec`. Returns 0, or -1 with one line in `reason`. */
int options_parse(const struct option_spec *spec, const char *text, double *value, char *reason,
                  size_t reason_size);

/* Reads a finite number that fills the whole of `text`. Returns 0, or -1. */
int parse_real(const char *text, double *value);

#endif
