#include "clock.h"

#include <criterion/criterion.h>

Test(clock, stops_come_from_integer_counts) {
    struct clock clock = clock_start(1);
    struct stop stop;
    int frames = 0;
    clock_add(&clock, STOP_FRAME, 30, 0);
    while (clock_next(&clock, &stop)) {
        frames++;
        cr_assert_eq(stop.t, frames / 30.);
    }
    cr_assert_eq(frames, 30);
}
