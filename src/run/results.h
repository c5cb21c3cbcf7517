/* Reading back what runs have written. */
#ifndef WISPLAB_RESULTS_H
#define WISPLAB_RESULTS_H

#include "base/files.h"
#include "base/outcome.h"
#include "model/trajectory.h"

#include <jansson.h>

/* A run's folder read back. */
struct run_files {
    json_t *json;                    /* run.json */
    const struct trajectory *states; /* without frames where they were not asked for, or the run
                                        died before its first */
    enum outcome outcome;
    struct trajectories *owner; /* of the states; not the run's */
};

/* How a run went: run.json alone. Returns 0, or -1 with one line in `reason` (REASON_SIZE). */
int run_read(struct run_files *run, const char *folder, char *reason);

/* Reads a run and its states, which `owner` has read or reads now; NULL: the run's own. */
int run_read_states(struct run_files *run, const char *folder, struct trajectories *owner,
                    char *reason);

/* Whether a run was asked to leave no states, by its run.json; and what to say to who needs some.
 */
int run_left_no_states(const json_t *json);
#define LEFT_NO_STATES "the run was made with --states none, and left none"

/* Frees what either of the two has read. */
void run_free(struct run_files *run);

/* A number of run.json by its path, "counters.steps"; NaN where there is none. */
double run_number(const struct run_files *run, const char *path);

/* Median, least and greatest of the repeated CPU times, s; NaN where there are none. */
struct spread {
    double median, least, greatest;
};
struct spread run_cpu_time(const struct run_files *run);

#endif
