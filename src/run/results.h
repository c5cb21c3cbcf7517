/* Reading back what runs have written. */
#ifndef WISPLAB_RESULTS_H
#define WISPLAB_RESULTS_H

#include "base/files.h"
#include "base/outcome.h"
#include "base/table.h"

#include <jansson.h>

/* A run's folder read back. */
struct run_files {
    json_t *json; /* run.json */
    struct table states;
    enum outcome outcome;
};

int run_read(struct run_files *run, const char *folder, char *reason);
void run_free(struct run_files *run);

/* A number of run.json by its path, "counters.steps"; NaN where there is none. */
double run_number(const struct run_files *run, const char *path);

/* Median, least and greatest of the repeated CPU times, s; NaN where there are none. */
struct spread {
    double median, least, greatest;
};
struct spread run_cpu_time(const struct run_files *run);

#endif
