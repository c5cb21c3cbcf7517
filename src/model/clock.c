#include "clock.h"

#include <math.h>

/* Times this near to t are one with it, and are no later. */
static double same_time(double t) {
    return t + 1e-12 * fmax(1, fabs(t));
}

bool clock_same(double one, double other) {
    return other <= same_time(one) && one <= same_time(other);
}

struct clock clock_until(double begin, double end) {
    return (struct clock){.begin = begin, .end = end};
}

struct clock clock_start(double begin, double duration) {
    return clock_until(begin, begin + duration);
}

static double source_time(const struct clock_source *source) {
    const double k = (double)source->next;
    return source->rate > 0 ? k / source->rate : k * source->interval;
}

void clock_add(struct clock *clock, enum stop_event event, double rate, double interval) {
    if (!(rate > 0 || interval > 0))
        return;
    const double passed = floor(rate > 0 ? clock->begin * rate : clock->begin / interval);
    struct clock_source *source = &clock->source[clock->source_count++];
    *source = (struct clock_source){
        .event = event, .rate = rate, .interval = interval, .next = (long long)fmax(1, passed)};
    while (source_time(source) <= same_time(clock->begin))
        source->next++;
}

bool clock_next(struct clock *clock, struct stop *stop) {
    if (clock->ended)
        return false;
    while (clock->next_kink < clock->kink_count &&
           clock->kink[clock->next_kink] <= same_time(clock->begin))
        clock->next_kink++;

    double t = clock->end;
    for (int i = 0; i < clock->source_count; i++)
        t = fmin(t, source_time(&clock->source[i]));
    if (clock->next_kink < clock->kink_count)
        t = fmin(t, clock->kink[clock->next_kink]);

    const double same = same_time(t);
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
    if (clock->end <= same) {
        stop->t = clock->end;
        stop->events |= STOP_END | STOP_FRAME;
        clock->ended = true;
    }
    return true;
}

long long clock_steps(double interval, double step) {
    return (long long)fmax(1, ceil(interval / step - 1e-9));
}
