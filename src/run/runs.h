/* Runs as child processes, and folders of runs that are done once, whoever asks, on whatever host,
 * and however often it is interrupted. */
#ifndef WISPLAB_RUNS_H
#define WISPLAB_RUNS_H

#include "case.h"
#include "stop.h"

/* Runs one case, in its folder, whether or not it is there already. A run that was killed from
 * outside is tried a second time; killed again, it is OUTPUT_FAILED. Returns how it ended, with a
 * reason where that is OUTPUT_FAILED. */
enum outcome runs_do_one(const struct run_case *run, const struct run_limits *limits,
                         int show_progress, char *reason);

/* Sees to it that every case's folder holds a complete run; what is there already stays, and runs
 * that another process is at are waited for. At most `jobs` at a time, and those that are timed
 * alone on their host, after the others. A run that was killed from outside is tried again, and
 * left out when it was killed twice: it is not complete then. Both are said on standard error, and
 * what is waited for. Returns the number of cases that were run, or with a reason the negative of
 * an enum outcome where results could not be written or the user ended it. */
int runs_do_all(const struct run_case *cases, int count, const struct run_limits *limits, int jobs,
                int show_progress, char *reason);

#endif
