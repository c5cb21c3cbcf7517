/* One run of a sweep, in a process of its own: done, compared with its reference, and put into the
 * cells that it shares with its parent. */
#ifndef WISPLAB_SWEEP_WORK_H
#define WISPLAB_SWEEP_WORK_H

#include "cells.h"
#include "sweep.h"

/* A run_case's ctx. */
struct sweep_job {
    const struct sweep *sweep;
    int run;     /* its number */
    char *cells; /* CELLS_SIZE, shared with the run's process */
};

extern const struct run_sink sweep_sink;

#endif
