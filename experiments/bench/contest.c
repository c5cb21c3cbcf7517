/* The contest: all candidates in turn, again and again, a short sample each time, so that what the
 * machine does to one it does to its neighbours too; ratios are formed round by round. */
#include "measure.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* s: long against reading the clock (0.2 us), short against a time slice (ms) */
static const double sample_length = 60e-6;

void contest_add(struct contest *contest, const char *group, const char *subject, const char *name,
                 double units, void (*run)(void *), void *ctx) {
    if (contest->count == contest->capacity) {
        contest->capacity = 2 * contest->capacity + 64;
        contest->all = realloc(contest->all, (size_t)contest->capacity * sizeof *contest->all);
        if (!contest->all)
            out_of_memory();
    }
    struct candidate *new = &contest->all[contest->count++];
    *new = (struct candidate){.run = run, .ctx = ctx, .units = units};
    snprintf(new->group, sizeof new->group, "%s", group);
    snprintf(new->subject, sizeof new->subject, "%s", subject);
    snprintf(new->name, sizeof new->name, "%s", name);
}

void contest_add_wall(struct contest *contest, const char *group, const char *subject,
                      const char *name, double units, void (*run)(void *), void *ctx) {
    contest_add(contest, group, subject, name, units, run, ctx);
    contest->all[contest->count - 1].wall = 1;
}

void contest_note(struct contest *contest, const char *group, const char *subject, const char *name,
                  double value) {
    fprintf(contest->notes, "%s\t%s\t%s\t%.17g\n", group, subject, name, value);
}

static double now(clockid_t clock) {
    struct timespec time;
    clock_gettime(clock, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* In CPU time: what others take of the processor is not counted. */
static double sample(const struct candidate *c) {
    const clockid_t clock = c->wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
    const double start = now(clock);
    for (int i = 0; i < c->repeats; i++)
        c->run(c->ctx);
    return now(clock) - start;
}

/* How often each runs in a sample; the least of three is its time. */
static void calibrate(struct contest *contest) {
    for (int i = 0; i < contest->count; i++) {
        struct candidate *c = &contest->all[i];
        double least = INFINITY;
        c->repeats = 1;
        for (int k = 0; k < 3; k++)
            least = fmin(least, sample(c));
        c->repeats = (int)ceil(fmin(sample_length / fmax(least, 1e-9), 1e6));
        c->warms_itself = least > 20 * sample_length;
    }
}

/* Another candidate has been here: data come back into the cache before the clock runs, unless
 * that is soon forgotten. */
static double warm_sample(const struct candidate *c) {
    if (!c->warms_itself)
        c->run(c->ctx);
    return sample(c);
}

void contest_run(struct contest *contest, double seconds, FILE *stream) {
    double *value = zeros((size_t)contest->count * KERNEL_ROUNDS_MAX * sizeof *value);
    int rounds = 0;
    calibrate(contest);
    for (const double start = now(CLOCK_MONOTONIC);
         rounds < KERNEL_ROUNDS_MAX && (rounds < 3 || now(CLOCK_MONOTONIC) - start < seconds);
         rounds++)
        for (int i = 0; i < contest->count; i++) {
            const struct candidate *c = &contest->all[i];
            value[(size_t)i * KERNEL_ROUNDS_MAX + (size_t)rounds] =
                1e9 * warm_sample(c) / (c->repeats * c->units);
        }
    for (int i = 0; i < contest->count; i++) {
        const struct candidate *c = &contest->all[i];
        fprintf(stream, "%s\t%s\t%s", c->group, c->subject, c->name);
        for (int r = 0; r < rounds; r++)
            fprintf(stream, "\t%.6g", value[(size_t)i * KERNEL_ROUNDS_MAX + (size_t)r]);
        fputc('\n', stream);
    }
}

/* --- reading back --- */

/* Cuts a line into its series; returns 0, or -1. */
static int read_series(struct series *series, char *line) {
    const char *word[3];
    char *at = line;
    int capacity = 1;
    for (char *c = line; *c; c++)
        capacity += *c == '\t';
    *series = (struct series){.line = line};
    for (int i = 0; i < 3; i++)
        if (!(word[i] = strsep(&at, "\t")))
            return -1;
    series->group = word[0], series->subject = word[1], series->name = word[2];
    series->value = malloc((size_t)capacity * sizeof *series->value);
    if (!series->value)
        return -1;
    for (char *number; (number = strsep(&at, "\t")) != NULL;)
        series->value[series->count++] = strtod(number, NULL);
    return series->count > 0 ? 0 : -1;
}

static int read_all(struct samples *samples, FILE *file) {
    char *line = NULL;
    size_t size = 0;
    for (ssize_t length; (length = getline(&line, &size, file)) > 0; line = NULL, size = 0) {
        struct series *all = realloc(samples->series, (size_t)(samples->count + 1) * sizeof *all);
        if (!all) {
            free(line);
            return -1;
        }
        samples->series = all;
        line[length - 1] = '\0';
        if (read_series(&all[samples->count++], line))
            return -1;
    }
    free(line);
    return samples->count > 0 ? 0 : -1;
}

int samples_read(struct samples *samples, const char *path, const char *heading) {
    const size_t length = strlen(heading);
    char *begins = malloc(length + 1);
    FILE *file = fopen(path, "r");
    *samples = (struct samples){0};
    const int there = begins && file && fread(begins, 1, length, file) == length &&
                      memcmp(begins, heading, length) == 0 && read_all(samples, file) == 0;
    free(begins);
    if (file)
        fclose(file);
    if (!there)
        samples_free(samples);
    return there;
}

void samples_free(struct samples *samples) {
    for (int i = 0; i < samples->count; i++) {
        free(samples->series[i].line);
        free(samples->series[i].value);
    }
    free(samples->series);
    *samples = (struct samples){0};
}

const struct series *series_find(const struct samples *samples, const char *group,
                                 const char *subject, const char *name) {
    for (int i = 0; i < samples->count; i++) {
        const struct series *s = &samples->series[i];
        if (strcmp(s->group, group) == 0 && strcmp(s->subject, subject) == 0 &&
            strcmp(s->name, name) == 0)
            return s;
    }
    return NULL;
}

double note_find(const struct samples *samples, const char *group, const char *subject,
                 const char *name) {
    const struct series *note = series_find(samples, group, subject, name);
    return note ? note->value[0] : NAN;
}

/* --- statistics --- */

struct quartiles quartiles(const double *value, int count) {
    double sorted[KERNEL_ROUNDS_MAX];
    const size_t n = (size_t)count;
    if (count <= 0)
        return (struct quartiles){NAN, NAN, NAN};
    memcpy(sorted, value, n * sizeof *sorted);
    gsl_sort(sorted, 1, n);
    return (struct quartiles){gsl_stats_median_from_sorted_data(sorted, 1, n),
                              gsl_stats_quantile_from_sorted_data(sorted, 1, n, 0.25),
                              gsl_stats_quantile_from_sorted_data(sorted, 1, n, 0.75)};
}

struct quartiles series_quartiles(const struct series *a) {
    return a ? quartiles(a->value, a->count) : quartiles(NULL, 0);
}

struct quartiles ratio_quartiles(const struct series *a, const struct series *b) {
    double ratio[KERNEL_ROUNDS_MAX];
    if (!a || !b)
        return quartiles(NULL, 0);
    for (int i = 0; i < a->count; i++)
        ratio[i] = a->value[i] / b->value[i];
    return quartiles(ratio, a->count);
}
