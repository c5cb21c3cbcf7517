/* A line on the terminal that says how far a long job is and how long it will take. */
#ifndef WISPLAB_PROGRESS_H
#define WISPLAB_PROGRESS_H

struct progress {
    const char *what; /* "12 of 40 runs" is made by the caller; this is the job's name */
    double start;     /* s, monotonic */
    double last;      /* when it was shown, s, monotonic */
    int shown;        /* a line stands on the terminal */
    int enabled;
};

/* From here on, jobs are parts of a longer one called `what`, which began at `start` (monotonic s):
 * their lines speak of the whole, of which the next job is what lies from `from` to `to`, in [0,
 * 1].
 */
void progress_of_whole(const char *what, double start, double from, double to);

/* Shows nothing in the first two seconds, nor where standard error is no terminal. */
struct progress progress_start(const char *what, int enabled);

/* `done` in [0, 1]; `note` may be empty. Shows it a few times a second at most. */
void progress_show(struct progress *progress, double done, const char *note);

/* Removes the line. */
void progress_end(struct progress *progress);

/* Seconds on a clock that never jumps; and of CPU time of this process, all its threads together.
 */
double monotonic_seconds(void);
double cpu_seconds(void);

#endif
