/* Runs as child processes, so that one that hangs, crashes or eats memory is a result and the rest
 * go on; and folders of runs that are done once, whoever asks and however often it is interrupted.
 */
#ifndef WISPLAB_RUNS_H
#define WISPLAB_RUNS_H

#include "base/files.h"
#include "record.h"

struct run_limits {
    double seconds; /* of wall time for a run and its repetitions; 0: none */
    double bytes;   /* of address space on top of the program's own; 0: none */
};

/* Lets a child have no more address space than that on top of what it has. */
void limit_memory(double bytes);

/* One run to be done. */
struct run_case {
    const struct scene *scene;
    struct settings settings;
    char folder[PATH_SIZE]; /* for states.tsv and run.json */
};

/* A folder for the run under `root`/runs, named by stepper, treatment and hash. */
void run_folder(const char *root, const struct scene *scene, const struct settings *settings,
                char *folder);

/* Runs one case in a child, in its folder, whether or not it is there already. */
enum outcome runs_do_one(const struct run_case *run, const struct run_limits *limits,
                         int show_progress, char *reason);

/* Sees to it that every case's folder holds a complete run; what is there already stays, and runs
 * that another process is at are waited for. At most `jobs` at a time, and those that are timed
 * alone, after the others. Returns the number of cases that were run, or with a reason the negative
 * of an enum outcome where results could not be written or the user ended it. */
int runs_do_all(const struct run_case *cases, int count, const struct run_limits *limits, int jobs,
                int show_progress, char *reason);

/* Whether a folder holds a complete run. */
int run_is_complete(const char *folder);

/* SIGINT and SIGTERM end runs tidily from here on. Called once by main. */
void runs_catch_signals(void);

/* Whether one of them has come. */
int runs_interrupted(void);

#endif
