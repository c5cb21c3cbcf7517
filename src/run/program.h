/* Another program as a child, with the limits, signals and exit codes that runs have. */
#ifndef WISPLAB_PROGRAM_H
#define WISPLAB_PROGRAM_H

#include "runs.h"

/* Runs the program argv[0], a path, to its end; argv ends with NULL. What it writes to standard
 * output is ours; the first line that it writes to standard error becomes the reason. It is asked
 * to end past the limit of time and where the user ends this program, killed a second later, and
 * does not outlive this program. Returns 0; its exit code, or 3 where it died or ran out of time,
 * or 2 where it could not be started, with one line in `reason` (REASON_SIZE). */
int program_run(const char *const argv[], const struct run_limits *limits, char *reason);

#endif
