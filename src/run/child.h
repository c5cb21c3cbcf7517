/* A run in a process of its own, so that one that hangs, crashes or eats memory is a result and the
 * rest go on. A result is only what the method did: that it reached the end, failed, met one of its
 * limits, crashed by a signal of its own or left. Where a signal from outside ended the process,
 * or the watchdog did, there is none, and the run may be tried again. */
#ifndef WISPLAB_CHILD_H
#define WISPLAB_CHILD_H

#include "case.h"

#include <sys/types.h>

struct child {
    const struct run_case *run;
    struct child_report *report; /* what it tells, in memory shared with it */
    pid_t pid;                   /* 0: there is none */
    double deadline;   /* monotonic s, when it is killed; infinite where nothing is to do that */
    double allowed;    /* wall time until then, s */
    int asked, killed; /* by this process: to end, by SIGTERM; by SIGKILL */
};

enum child_state {
    CHILD_RUNS,
    CHILD_ENDED,  /* how, says the outcome; all but OUTPUT_FAILED have their results */
    CHILD_KILLED, /* from outside, or by the watchdog: there are no results */
};

/* Between these two, the end of a child wakes children_wait. */
void children_begin(void);
void children_end(void);

/* Sleeps, until a child ends, a signal comes or the time is over. */
void children_wait(double seconds);

/* Starts a run; what its folder, which must be there and locked, holds of it is removed. Returns 0,
 * or -1 with a reason and child->pid 0. */
int child_start(struct child *child, const struct run_case *run, const struct run_limits *limits,
                char *reason);

/* Looks after a child: asks it to end when the program is to, and kills it at its deadline. Once it
 * has ended, child->pid is 0; `reason` (REASON_SIZE) then says why it was killed, or what could not
 * be written. */
enum child_state child_poll(struct child *child, enum outcome *outcome, char *reason);

/* How far it has come, simulated s. */
double child_reached(const struct child *child);

/* Lets a process that is a child have no more address space than that on top of what it has. */
void limit_memory(double bytes);

/* Kills it and forgets it, and its unfinished files: the folder is another process's by now. */
void child_abandon(struct child *child);

#endif
