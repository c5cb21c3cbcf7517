/* What a sweep's table says of a run behind its settings: how it ended, how far it was from the
 * reference where that was asked for, what it counted and what it took. */
#ifndef WISPLAB_CELLS_H
#define WISPLAB_CELLS_H

#include "run/simulation.h"

enum { CELLS_SIZE = 4096 };

/* How far a run was from its reference; NaN where that cannot be said, with why. */
struct sweep_error {
    double rms, largest, end; /* of nodes, m: over all frames, and rms at the last one */
    double bound;             /* of the reference itself, m */
    char why[REASON_SIZE];
};

/* Writes the cells, with tabs between and no newline; `why` where the result has no reason. Of a
 * run whose process died, not `counted`, there are no counts. `error` is NULL where none was asked
 * for. Returns 0, or -1 where they do not fit. */
int cells_write(char cells[CELLS_SIZE], const struct run_result *result, const char *why,
                int counted, const struct sweep_error *error);

/* A `#` line for each column, and their names, each behind a tab. */
void cells_describe(FILE *stream, int errors);
void cells_name(FILE *stream, int errors);

#endif
