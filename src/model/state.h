/* A state in a file: a table of states, of which the last frame counts. */
#ifndef WISPLAB_STATE_H
#define WISPLAB_STATE_H

#include "model.h"
#include "trajectory.h"

#include <stdio.h>

/* The last frame of a trajectory, which must have the columns and rows of the model's frames, as
 * row_count times column_count numbers into `rows`, and its time; `file` is for messages. Returns
 * 0, or -1 with one line in `reason` (REASON_SIZE); errno is ENOMEM where it was memory. */
int state_of(const struct model *model, const struct trajectory *trajectory, const char *file,
             double *rows, double *t, char *reason);

/* Writes what the columns of a table of the model's frames are, and their names: t, the model's,
 * and parent; or of a table of accelerations, which has the model's alone. */
void state_write_columns(FILE *stream, const struct model *model);
void state_write_rate_columns(FILE *stream, const struct model *model);

/* Makes of the last frame of the file `states` a file of its own, which appears whole or not at
 * all. Returns 0, or -1 with one line in `reason` (REASON_SIZE). */
int state_save(const char *states, const char *file, char *reason);

#endif
