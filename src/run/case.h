/* A run to be done: what is run, where its results are, and what it may take. */
#ifndef WISPLAB_CASE_H
#define WISPLAB_CASE_H

#include "base/files.h"
#include "settings.h"

/* What a run may take. Only counts and CPU time are the method's: they end it with a result. The
 * clock on the wall also tells how busy the machine is; where it ends a run, there is none. */
struct run_limits {
    double seconds;      /* of CPU time of the run's process, all its threads together, repetitions
                            included; 0: no limit */
    double evaluations;  /* of the force, in wisps (counters.force_evaluations), diagnoses and
                            repetitions not counted; 0: no limit */
    double bytes;        /* of address space on top of the program's own; 0: no limit */
    double wall_seconds; /* after which the watchdog ends it; 0: ten times `seconds`, and a minute
                            at least; with both 0 there is no watchdog */
};

struct run_case;
struct watch;

/* What is done in place of record_run and record_death, by their rules, where results go elsewhere.
 */
struct run_sink {
    enum outcome (*run)(const struct run_case *run, const struct watch *watch, char *reason);
    int (*death)(const struct run_case *run, enum outcome outcome, const char *why, double reached,
                 char *reason);
};

/* One run to be done. */
struct run_case {
    const struct scene *scene;
    struct settings settings;
    char folder[PATH_SIZE];      /* for states.tsv and run.json; empty: it has none */
    const struct run_sink *sink; /* NULL: results go into the folder */
    void *ctx;                   /* the sink's; scene and settings then need not be there */
};

/* A folder for the run under `root`/runs, named by stepper, treatment and hash. */
void run_folder(const char *root, const struct scene *scene, const struct settings *settings,
                char *folder);

/* Whether a folder holds a complete run. */
int run_is_complete(const char *folder);

/* Whether a folder holds a complete run as it was written. One of which something is damaged is set
 * aside, to a name beside it that ends with .damaged, and that is said; it is then to be run again.
 * Returns 1; 0: there is none, or no more; or -1 with a reason where it cannot be set aside. */
int run_is_sound(const char *folder, char *reason);

/* Removes a run from its folder, and what is left of unfinished ones. The folder is locked, or
 * nobody else's; "" is none. */
void run_remove(const char *folder);

#endif
