/* When the smooth advance must stop: at frames, at ticks, where a prescribed function of time has
 * a kink, and at the end. Times come from integer counts, never from adding steps. */
#ifndef WISPLAB_CLOCK_H
#define WISPLAB_CLOCK_H

#include <stdbool.h>

enum stop_event {
    STOP_END = 1,
    STOP_FRAME = 2,
    STOP_COLLISION = 4,   /* body contact and the clamp of samples */
    STOP_INTERACTION = 8, /* wisp contact and subdivision */
    STOP_KINK = 16,
};

enum { CLOCK_SOURCES_MAX = 4 };

/* Stops at k / rate, or at k * interval where rate is 0; k = 1, 2, ... */
struct clock_source {
    enum stop_event event;
    double rate;     /* Hz */
    double interval; /* s */
    long long next;  /* k of the next stop */
};

struct clock {
    double begin, end; /* s */
    int source_count;
    struct clock_source source[CLOCK_SOURCES_MAX];
    const double *kink; /* ascending, not owned */
    int kink_count, next_kink;
    bool ended;
};

struct stop {
    double t;        /* s */
    unsigned events; /* enum stop_event: all that falls on this time */
};

/* A clock at t = begin, which goes on for `duration`, s, or up to `end`, s. The end is a stop, and
 * always a frame. What falls on the begin, or before, has happened. */
struct clock clock_start(double begin, double duration);
struct clock clock_until(double begin, double end);

/* Adds stops at k / rate, or, where rate is 0, at k * interval (both 0: nothing is added). */
void clock_add(struct clock *clock, enum stop_event event, double rate, double interval);

/* Whether two times count as one: they are within 1e-12 max(1, t) of each other. */
bool clock_same(double one, double other);

/* Moves on to the next stop; false when the last was the end. */
bool clock_next(struct clock *clock, struct stop *stop);

/* Number of equal steps of at most `step`, up to a relative slack of 1e-9, over an interval. */
long long clock_steps(double interval, double step);

#endif
