/* Stops: from integer counts, merged, and none lost. */
#include "model/clock.h"

#include <criterion/criterion.h>
#include <math.h>

/* k / 30 exactly, an hour long: 108 000 frames, where adding 1/30 would be 1e-9 off. */
Test(clock, frames_come_from_integer_counts) {
    struct clock clock = clock_start(0, 3600);
    struct stop stop;
    long long frames = 0;
    clock_add(&clock, STOP_FRAME, 30, 0);
    while (clock_next(&clock, &stop)) {
        frames++;
        cr_assert_eq(stop.t, (double)frames / 30, "frame %lld at %.17g", frames, stop.t);
        cr_assert(stop.events & STOP_FRAME, "stop %lld is no frame", frames);
    }
    cr_assert_eq(frames, 108000, "%lld frames", frames);
    cr_assert_eq(stop.t, 3600, "the last is at %.17g", stop.t);
    cr_assert(stop.events & STOP_END, "it does not say that it ends");
    cr_assert_not(clock_next(&clock, &stop), "it goes on after the end");
}

/* 300, 90 and 30 Hz meet every 1/30 s, 300 and 90 Hz too: gcd(300, 90) = 30. In a second there are
 * 300 + 90 + 30 ticks; at 30 times all three meet, and nowhere else any two: 360 stops fewer 2
 * * 30. */
Test(clock, ticks_of_three_rates_merge) {
    struct clock clock = clock_start(0, 100);
    struct stop stop;
    long long stops = 0, count[3] = {0};
    double last = 0;
    clock_add(&clock, STOP_COLLISION, 300, 0);
    clock_add(&clock, STOP_INTERACTION, 90, 0);
    clock_add(&clock, STOP_FRAME, 30, 0);
    while (clock_next(&clock, &stop)) {
        stops++;
        cr_assert(stop.t > last + 1e-4, "two stops for one time: %.17g and %.17g", last, stop.t);
        last = stop.t;
        static const unsigned events[] = {STOP_COLLISION, STOP_INTERACTION, STOP_FRAME};
        static const double rates[] = {300, 90, 30};
        for (int i = 0; i < 3; i++) {
            const double k = round(stop.t * rates[i]);
            const int due = fabs(stop.t - k / rates[i]) <= 1e-12 * fmax(1, stop.t);
            cr_assert_eq((stop.events & events[i]) != 0, due, "at %.17g: events %u", stop.t,
                         stop.events);
            count[i] += due;
        }
    }
    cr_assert(count[0] == 30000 && count[1] == 9000 && count[2] == 3000, "%lld, %lld, %lld ticks",
              count[0], count[1], count[2]);
    cr_assert_eq(stops, 100 * (300 + 90 + 30 - 2 * 30), "%lld stops", stops);
}

/* A duration that no rate divides: the end is a stop and a frame, and no tick of its own. */
Test(clock, the_end_is_a_stop) {
    struct clock clock = clock_start(0, 0.1234);
    struct stop stop, before = {0};
    int frames = 0;
    clock_add(&clock, STOP_FRAME, 30, 0);
    clock_add(&clock, STOP_COLLISION, 300, 0);
    while (clock_next(&clock, &stop)) {
        frames += (stop.events & STOP_FRAME) != 0;
        if (!(stop.events & STOP_END))
            before = stop;
    }
    cr_assert_eq(stop.t, 0.1234, "ends at %.17g", stop.t);
    cr_assert_eq(stop.events, (unsigned)(STOP_END | STOP_FRAME), "events %u at the end",
                 stop.events);
    cr_assert_eq(before.t, 37. / 300, "the last tick is at %.17g", before.t);
    cr_assert_eq(frames, 4, "%d frames: 3 and the end", frames);

    clock = clock_start(0, 2); /* nothing but the end */
    cr_assert(clock_next(&clock, &stop) && stop.t == 2 && (stop.events & STOP_END), "no end");
    cr_assert_not(clock_next(&clock, &stop), "two ends");
}

/* By the step: k h, the last stop at the duration even where the count does not come out. */
Test(clock, stops_at_every_step) {
    struct clock clock = clock_start(0, 30);
    struct stop stop;
    int stops = 0;
    clock_add(&clock, STOP_FRAME, 0, 0.8);
    while (clock_next(&clock, &stop)) {
        stops++;
        cr_assert_eq(stop.t, stops == 38 ? 30 : stops * 0.8, "stop %d at %.17g", stops, stop.t);
    }
    cr_assert_eq(stops, 38, "%d stops", stops);
    clock = clock_start(0, 0.3); /* 3 * 0.1 is one rounding beyond 0.3: one stop, not two */
    clock_add(&clock, STOP_FRAME, 0, 0.1);
    for (stops = 0; clock_next(&clock, &stop);)
        stops++;
    cr_assert_eq(stops, 3, "%d stops of 0.1 in 0.3", stops);
    cr_assert_eq(stop.t, 0.3, "ends at %.17g", stop.t);
}

Test(clock, kinks_are_stops_and_merge_with_ticks) {
    static const double kinks[] = {0.05, 0.1, 0.1 + 5e-13, 0.25, 7};
    struct clock clock = clock_start(0, 1);
    struct stop stop;
    int stops = 0, kinked = 0;
    clock.kink = kinks;
    clock.kink_count = 5;
    clock_add(&clock, STOP_FRAME, 10, 0);
    while (clock_next(&clock, &stop)) {
        stops++;
        kinked += (stop.events & STOP_KINK) != 0;
        if (stop.t == 0.1)
            cr_assert_eq(stop.events, (unsigned)(STOP_KINK | STOP_FRAME), "events %u at 0.1 s",
                         stop.events);
        if (stop.t == 0.05 || stop.t == 0.25)
            cr_assert_eq(stop.events, (unsigned)STOP_KINK, "events %u at %g s", stop.events,
                         stop.t);
    }
    cr_assert_eq(stops, 12, "%d stops: 10 frames and 2 kinks between them", stops);
    cr_assert_eq(kinked, 3, "%d stops with kinks; one is beyond the end", kinked);
}

/* Within 1e-12 max(1, t) is one time, beyond it is another. */
Test(clock, the_tolerance_of_one_time) {
    for (int beyond = 0; beyond <= 1; beyond++)
        for (double t = 0.5; t < 2000; t *= 10) {
            const double kink[] = {t, t + (beyond ? 2e-12 : 0.5e-12) * fmax(1, t)};
            struct clock clock = clock_start(0, 2 * t);
            struct stop stop;
            int stops = 0;
            clock.kink = kink;
            clock.kink_count = 2;
            while (clock_next(&clock, &stop))
                stops++;
            cr_assert_eq(stops, beyond ? 3 : 2, "two kinks near %g s: %d stops", t, stops);
        }
}

/* ceil(D / h - 1e-9), and at least one. */
Test(clock, steps_of_an_interval) {
    cr_assert_eq(clock_steps(160, 3.2), 50, "160 / 3.2: %lld", clock_steps(160, 3.2));
    cr_assert_eq(clock_steps(30, 0.8), 38, "30 / 0.8 = 37.5: %lld", clock_steps(30, 0.8));
    cr_assert_eq(clock_steps(0.3, 0.1), 3, "0.3 / 0.1: %lld", clock_steps(0.3, 0.1));
    cr_assert_eq(clock_steps(0.1, 0.8), 1, "shorter than a step: %lld", clock_steps(0.1, 0.8));
    cr_assert_eq(clock_steps(1e-300, 1), 1, "next to nothing: %lld", clock_steps(1e-300, 1));
    for (long long n = 1; n <= 1000; n += 37) {
        const double h = 1 / 30.;
        /* the slack is 1e-9 of a step: half of it makes no step more, twice of it does */
        cr_assert_eq(clock_steps(h * ((double)n + 0.5e-9), h), n, "%lld steps and half the slack",
                     n);
        cr_assert_eq(clock_steps(h * ((double)n + 2e-9), h), n + 1, "%lld and twice the slack", n);
        cr_assert_eq(clock_steps(h * ((double)n - 1e-6), h), n, "%lld less a little", n);
    }
    /* frames that are k / 30 apart with roundings of k / 30 at 3600 s, and 1/300 steps: 10 each */
    for (int k = 100000; k < 108000; k++)
        cr_assert_eq(clock_steps((k + 1) / 30. - k / 30., 1 / 300.), 10, "frame %d", k);
}
