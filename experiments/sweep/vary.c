#include "vary.h"

#include "base/digits.h"
#include "base/files.h"
#include "base/options.h"
#include "base/visible.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* More runs than anybody waits for are a slip of the finger. */
static const double most_values = 1e6;

__attribute__((format(printf, 3, 4))) static int fail(char *reason, const char *text,
                                                      const char *format, ...) {
    const int used = snprintf(reason, REASON_SIZE, "--vary %.100s: ", text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason + used, REASON_SIZE - (size_t)used, format, arguments);
    va_end(arguments);
    return -1;
}

static int out_of_memory(char *reason) {
    return fail_with(reason, "out of memory");
}

/* Adds the first `length` letters of a text. Returns 0, or -1 where there is no memory. */
static int add_value(struct vary *vary, const char *text, size_t length) {
    if (vary->count == vary->capacity) {
        const int capacity = 2 * vary->capacity + 8;
        char **value = realloc(vary->value, (size_t)capacity * sizeof *value);
        if (!value)
            return -1;
        vary->value = value;
        vary->capacity = capacity;
    }
    vary->value[vary->count] = strndup(text, length);
    return vary->value[vary->count++] ? 0 : -1;
}

/* --- ranges --- */

/* A value in twelve digits: 0.3 and 1e-4, not what rounding makes of them. libconfig takes a number
 * without a point for 32 bits. */
static int add_number(struct vary *vary, double x) {
    char text[DIGITS_SIZE + 2], rounded[32];
    snprintf(rounded, sizeof rounded, "%.12g", x);
    char *end = digits_put(text, atof(rounded));
    if (fabs(x) >= 2147483648. && !strpbrk(text, ".e"))
        memcpy(end, ".0", 3);
    return add_value(vary, text, strlen(text));
}

static int add_range(struct vary *vary, double from, double to, int logarithmic, int count) {
    for (int i = 0; i < count; i++) {
        const double share = (double)i / (count - 1);
        const double x = logarithmic ? from * pow(to / from, share) : from + (to - from) * share;
        if (add_number(vary, x))
            return -1;
    }
    return 0;
}

/* What stands before the dots of a range, where it is a number: "../start.tsv" is a value. Returns
 * what stands behind them, or NULL. */
static const char *behind_dots(const char *values, double *from) {
    char number[64];
    const char *dots = strstr(values, "..");
    if (!dots || (size_t)(dots - values) >= sizeof number)
        return NULL;
    snprintf(number, sizeof number, "%.*s", (int)(dots - values), values);
    return parse_real(number, from) ? NULL : dots + 2;
}

static int read_range(struct vary *vary, const char *text, double from, const char *rest,
                      char *reason) {
    char copy[128], *at = copy;
    snprintf(copy, sizeof copy, "%s", rest);
    const char *end = strsep(&at, ":"), *kind = strsep(&at, ":"), *last = strsep(&at, ":");
    const int logarithmic = kind && strcmp(kind, "log") == 0;
    const char *number = logarithmic ? last : kind;
    double to, count;
    if (!number || at || (!logarithmic && last) || parse_real(end, &to) ||
        parse_real(number, &count))
        return fail(reason, text, "a range is FROM..TO:N, or FROM..TO:log:N, as 300..3000:10");
    if (count < 2 || count != floor(count) || count > most_values)
        return fail(reason, text, "the number of values must be a whole number from 2 to %g",
                    most_values);
    if (logarithmic && (from <= 0 || to <= 0))
        return fail(reason, text, "both ends of a logarithmic range must be positive");
    if (!isnormal(logarithmic ? to / from : to - from) && to != from)
        return fail(reason, text, "the ends are too far apart");
    return add_range(vary, from, to, logarithmic, (int)count) ? out_of_memory(reason) : 0;
}

/* --- lists --- */

/* The length of a value: up to a comma that is in no brackets, braces or quotes. */
static size_t value_length(const char *text) {
    int depth = 0, quoted = 0;
    const char *at = text;
    for (; *at && (*at != ',' || depth > 0 || quoted); at++) {
        quoted ^= *at == '"';
        if (!quoted)
            depth += (strchr("[({", *at) != NULL) - (strchr("])}", *at) != NULL);
    }
    return (size_t)(at - text);
}

static int read_list(struct vary *vary, const char *text, const char *values, char *reason) {
    for (const char *at = values;; at++) {
        at += strspn(at, " ");
        const size_t length = value_length(at);
        if (length == 0)
            return fail(reason, text, "a value is empty");
        if (add_value(vary, at, length))
            return out_of_memory(reason);
        at += length;
        if (!*at)
            return 0;
    }
}

/* --- the whole --- */

/* An order in which values that are the same stand side by side: numbers by what they are, before
 * words by their letters. */
static int compare_values(const void *a, const void *b) {
    const char *one = *(char *const *)a, *other = *(char *const *)b;
    double x, y;
    const int no_x = parse_real(one, &x), no_y = parse_real(other, &y);
    return no_x || no_y ? no_x && no_y ? strcmp(one, other) : no_x - no_y : (x > y) - (x < y);
}

/* Runs that are the same would be rows that are the same. */
static int check_distinct(const struct vary *vary, const char *text, char *reason) {
    int code = 0;
    char **sorted = malloc((size_t)vary->count * sizeof *sorted);
    if (!sorted)
        return out_of_memory(reason);
    memcpy(sorted, vary->value, (size_t)vary->count * sizeof *sorted);
    qsort(sorted, (size_t)vary->count, sizeof *sorted, compare_values);
    for (int i = 1; i < vary->count && !code; i++)
        if (compare_values(&sorted[i - 1], &sorted[i]) == 0)
            code = strcmp(sorted[i - 1], sorted[i]) == 0
                       ? fail(reason, text, "the value %.60s is given twice", sorted[i])
                       : fail(reason, text, "the value %.60s is given twice, also as %.60s",
                              sorted[i - 1], sorted[i]);
    free(sorted);
    return code;
}

static int check_letters(const char *text, char *reason) {
    char shown[100];
    for (const char *at = text; *at; at += utf8_length(at))
        if (utf8_length(at) == 0 || is_control(at)) {
            visible_text(text, shown, sizeof shown);
            return fail(reason, shown, "holds a letter that cannot stand in a table");
        }
    return 0;
}

int vary_read(struct vary *vary, const char *text, char *reason) {
    *vary = (struct vary){0};
    const char *equals = strchr(text, '=');
    double from;
    if (check_letters(text, reason))
        return -1;
    if (!equals || equals == text || !equals[1])
        return fail(reason, text, "write NAME=A,B,C or NAME=FROM..TO:N, as rate=300,900");
    vary->name = strndup(text, (size_t)(equals - text));
    if (!vary->name)
        return out_of_memory(reason);
    const char *rest = behind_dots(equals + 1, &from);
    const int code = rest ? read_range(vary, text, from, rest, reason)
                          : read_list(vary, text, equals + 1, reason);
    return code ? code : check_distinct(vary, text, reason);
}

int vary_fix(struct vary *vary, const char *name, const char *value, char *reason) {
    *vary = (struct vary){.name = strdup(name)};
    return !vary->name || add_value(vary, value, strlen(value)) ? out_of_memory(reason) : 0;
}

void vary_free(struct vary *vary) {
    for (int i = 0; i < vary->count; i++)
        free(vary->value[i]);
    free(vary->value);
    free(vary->name);
    *vary = (struct vary){0};
}
