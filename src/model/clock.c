#include "clock.h"

#include <math.h>

struct clock clock_start(double duration) {
    return (struct clock){.duration = duration};
}

void clock_add(struct clock *clock, enum stop_event event, double rate, double interval) {
    if (rate > 0 || interval > 0)
        clock->source[clock->source_count++] =
            (struct clock_source){.event = event, .rate = rate, .interval = interval, .next = 1};
}

static double source_time(const struct clock_source *source) {
    const double k = (double)source->next;
    return source->rate > 0 ? k / source->rate : k * source->interval;
}

bool clock_next(struct clock *clock, struct stop *stop) {
    if (clock->ended)
        return false;
    while (clock->next_kink < clock->kink_count && clock->kink[clock->next_kink] <= 1e-12)
        clock->next_kink++; /* one with the start, or before it */

    double t = clock->duration;
    for (int i = 0; i < clock->source_count; i++)
        t = fmin(t, source_time(&clock->source[i]));
    if (clock->next_kink < clock->kink_count)
        t = fmin(t, clock->kink[clock->next_kink]);

    const double same = t + 1e-12 * fmax(1, t);
    *stop = (struct stop){.t = t};
    for (int i = 0; i < clock->source_count; i++) {
        if (source_time(&clock->source[i]) <= same) {
            stop->events |= clock->source[i].event;
            clock->source[i].next++;
        }
    }
    while (clock->next_kink < clock->kink_count && clock->kink[clock->next_kink] <= same) {
        stop->events |= STOP_KINK;
        clock->next_kink++;
    }
    if (clock->duration <= same) {
        stop->t = clock->duration;
        stop->events |= STOP_END | STOP_FRAME;
        clock->ended = true;
    }
    return true;
}

long long clock_steps(double interval, double step) {
    return (long long)fmax(1, ceil(interval / step - 1e-9));
}
