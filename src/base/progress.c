#include "progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double monotonic_seconds(void) {
    return seconds_of(CLOCK_MONOTONIC);
}

double cpu_seconds(void) {
    return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

/* The longer job that all others are parts of; none: `what` is NULL. */
static struct {
    const char *what;
    double start, from, to;
} whole;

void progress_of_whole(const char *what, double start, double from, double to) {
    whole.what = what;
    whole.start = start;
    whole.from = from;
    whole.to = to;
}

struct progress progress_start(const char *what, int enabled) {
    return (struct progress){
        .what = what, .start = monotonic_seconds(), .enabled = enabled && isatty(STDERR_FILENO)};
}

void progress_show(struct progress *progress, double done, const char *note) {
    const double now = monotonic_seconds();
    const double spent = now - (whole.what ? whole.start : progress->start);
    if (!progress->enabled || spent < 2 || now - progress->last < 0.2)
        return;
    progress->last = now;
    if (whole.what)
        done = whole.from + done * (whole.to - whole.from);
    fprintf(stderr, "\r\033[K%s: %3.0f %%", whole.what ? whole.what : progress->what, 100 * done);
    if (*note)
        fprintf(stderr, ", %s", note);
    if (done > 0.01) {
        const int left = (int)(spent * (1 - done) / done + 0.5);
        fprintf(stderr, ", %d:%02d left", left / 60, left % 60);
    }
    fflush(stderr);
    progress->shown = 1;
}

void progress_end(struct progress *progress) {
    if (progress->shown)
        fprintf(stderr, "\r\033[K");
    progress->shown = 0;
}
