/* Whether the program is to end: by the user's word or, in the process of a run, by its limit. */
#ifndef WISPLAB_STOP_H
#define WISPLAB_STOP_H

#include "base/outcome.h"

#include <signal.h>

/* The enum outcome with which what goes on is to end, INTERRUPTED or OUT_OF_TIME; 0: it may go on.
 */
extern volatile sig_atomic_t stop_request;

/* SIGINT and SIGTERM end the program from here on: tidily where stop_request is looked at, and
 * within a second wherever it is. Called once by main. */
void runs_catch_signals(void);

/* In a child: its parent sees to it that it ends in time, and that what it has is kept. */
void runs_leave_signals_to_parent(void);

/* Whether one of them has come. */
int runs_interrupted(void);

#endif
