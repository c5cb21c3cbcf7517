/* A states.tsv or states.npy read back: the frames of a run as plain numbers, and who split off
 * whom. */
#ifndef WISPLAB_TRAJECTORY_H
#define WISPLAB_TRAJECTORY_H

#include "base/table.h"

#include <stddef.h>

/* Columns of a row, SI units; behind them come those of the samples. */
enum state_column { STATE_T, STATE_WISP, STATE_NODE, STATE_X, STATE_VX = 6, STATE_SAMPLES = 9 };

struct trajectory_frame {
    double t;       /* s */
    int row;        /* the first of its rows */
    int first_wisp; /* index of its first wisp in trajectory.wisp_row */
    int wisps;
};

/* Frames follow each other as t changes, wisps of a frame as their numbers do: whether they are
 * those of a scene is for who knows the scene. */
struct trajectory {
    struct table table; /* all rows; the column `parent` is not among its columns */
    int frame_count;
    struct trajectory_frame *frames;
    int *wisp_row;  /* by frame and wisp: its first row; one more at the end */
    int wisp_count; /* the most that a frame has */
    int *parent;    /* by wisp: the one that it split off from, which comes before it; itself where
                       there is none, or the file is of a time before that column */
};

/* Makes a trajectory of a table that begins with t, wisp and node, and takes the table over, right
 * or wrong; `file` is for messages. Returns 0, or -1 with one line in `reason` (REASON_SIZE); errno
 * is ENOMEM where it was memory. */
int trajectory_of_table(struct trajectory *trajectory, struct table *table, const char *file,
                        char *reason);

/* The file of states in a run's folder, states.npy where there is one, else states.tsv, into `path`
 * (PATH_SIZE). Returns 0, or -1 where that does not fit. */
int trajectory_path(const char *folder, char *path);

/* Whether a file begins as a table of states, if it can be read. Of one that does not nothing need
 * be shown: whoever named it may not own it. */
int trajectory_is_begun(const char *path);

/* Reads a file; the same. */
int trajectory_read(struct trajectory *trajectory, const char *path, char *reason);
void trajectory_free(struct trajectory *trajectory);

/* A row, and the one behind a frame. */
const double *trajectory_row(const struct trajectory *trajectory, int row);
int trajectory_end(const struct trajectory *trajectory, int frame);

/* The first row of a wisp of a frame, and how many nodes it has there. */
int trajectory_wisp(const struct trajectory *trajectory, int frame, int wisp);
int trajectory_nodes(const struct trajectory *trajectory, int frame, int wisp);

/* --- each file once --- */

/* The files that a command has read, so that nobody reads one again. Those that nobody uses stay
 * as long as they are at most 500 and take no more than 256 MiB. Not for several threads at a time.
 */
struct trajectories;

/* NULL where memory cannot be had. Freed when nobody uses any. */
struct trajectories *trajectories_create(void);
void trajectories_free(struct trajectories *all);

/* What the file holds, to be returned to the same owner; NULL with one line in `reason`. Files are
 * told apart by what they are, not by their paths: one that was written anew is another. Without an
 * owner (NULL) it is read for the caller alone. */
const struct trajectory *trajectories_take(struct trajectories *all, const char *path,
                                           char *reason);
void trajectories_return(struct trajectories *all, const struct trajectory *trajectory);

/* How many files were read so far. */
int trajectories_parsed(const struct trajectories *all);

#endif
