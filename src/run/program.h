/* Other programs as children, with the limits, signals and exit codes that runs have. None
 * outlives this program. */
#ifndef WISPLAB_PROGRAM_H
#define WISPLAB_PROGRAM_H

#include "runs.h"

/* Where a program's words go; -1: where ours do. */
struct program_words {
    int output, errors;
};

/* Runs the program argv[0], a path or a name to be looked for in PATH, to its end; argv ends with
 * NULL. It is asked to end past the limit of time and where the user ends this program, and killed
 * soon after. Returns 0 with its status, as waitpid gives it, and whether its time was over; or an
 * errno where it could not be started. May be called by any thread. */
int program_finish(const char *const argv[], const struct run_limits *limits,
                   const struct program_words *words, int *status, int *out_of_time);

/* Runs a program and tells what became of it: standard output is ours, and the first line of
 * standard error becomes the reason. Returns 0; its exit code, or 3 where it died or ran out of
 * time, or 2 where it could not be started, with one line in `reason` (REASON_SIZE). */
int program_run(const char *const argv[], const struct run_limits *limits, char *reason);

#endif
