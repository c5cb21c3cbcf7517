/* A sweep: one scene over the product of its steppers and of the values that settings take. Its
 * runs are numbered with the last setting varied first, and share files: pack.h. */
#ifndef WISPLAB_SWEEP_H
#define WISPLAB_SWEEP_H

#include "base/hash.h"
#include "run/runs.h"
#include "vary.h"

/* One of its runs. */
struct sweep_run {
    char key[HASH_SIZE];       /* of scene, settings and program, and of the reference */
    char reference[HASH_SIZE]; /* the reference's; empty: it has none */
    char *cells; /* of the table, behind the settings; NULL: it is to be done; owned */
    int running; /* here, now */
    int killed;  /* how often, from outside */
};

struct sweep {
    const char *scene, *out; /* a name or a path; the folder of results */
    const char *const *steppers;
    int stepper_count;
    struct vary *vary; /* those that have a value for all runs, then those that vary */
    int vary_count, fixed;
    enum states_format states; /* none, or each run has a folder of its own too */
    int reference;             /* whether errors are asked for */

    struct sweep_run *runs; /* owned; see sweep_plan */
    int count, done;
    int *by_key; /* owned: runs in the order of their keys */
};

/* A run made ready: its scene and settings. */
struct sweep_point {
    struct scene *scene; /* owned */
    struct settings settings;
    struct run_request request;
    int count;
    char **text; /* owned: NAME=VALUE of each setting; the lists point there */
    const char **sets, **options;
    int set_count, option_count;
};

/* Returns 0; REFUSED where scene and stepper cannot do that; -1 where a name or a value is wrong;
 * the last two with one line in `reason`. To be closed in any case. */
int sweep_open(const struct sweep *sweep, int run, struct sweep_point *point, char *reason);
void sweep_close(struct sweep_point *point);

/* The settings of the reference that a run is compared with. Returns 0, or not, with a reason. */
int sweep_reference(const struct sweep_point *point, struct settings *settings, char *reason);

/* Which of its values a setting has in a run, and which stepper that is. */
const char *sweep_value(const struct sweep *sweep, int run, int setting);
const char *sweep_stepper(const struct sweep *sweep, int run);

/* Names all runs, and those that were refused are done by that. Returns 0, or the exit code with
 * one line in `reason`: where a setting is wrong, or all are refused. */
int sweep_plan(struct sweep *sweep, char *reason);

/* What was found of the runs with that key. */
void sweep_take(void *sweep, const char *key, const char *cells);

void sweep_free(struct sweep *sweep);

/* The whole, from the plan to `out`/table.tsv, which says what came of it on standard output. Any
 * number of processes may be at it in one folder: they share the work and wait for each other, and
 * what an earlier one has done is not done again. Returns 0 or the exit code, having said why. */
int run_sweep(struct sweep *sweep, const struct run_limits *limits, int jobs, int show_progress);

#endif
