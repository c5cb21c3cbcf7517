/* The angle between two unit vectors from its sine and cosine, on all lanes at once: libm's atan2
 * takes lanes one by one and cost twice as much as all the rest of a hinge. */
#ifndef WISPLAB_KERNEL_ARC_H
#define WISPLAB_KERNEL_ARC_H

#include "base/lanes.h"

/* (atan(r) - r) / r^3 in z = r^2 for 0 <= r <= tan(pi / 8): interpolation at Chebyshev nodes in 60
 * digits, wrong by less than 5e-18 r. */
static const double arc_coefficient[] = {
    -0.3333333333333333,   0.19999999999995516, -0.14285714284665682,  0.11111111015187018,
    -0.0909090457530649,   0.07692183125376892, -0.06664510525508936,  0.05858140904866328,
    -0.050854078345894844, 0.03923044778479309, -0.019175404711104935,
};
enum { ARC_TERMS = sizeof arc_coefficient / sizeof *arc_coefficient };

/* atan2(sine, cosine) for sine >= 0, in [0, pi], to 2 units in the last place. With the smaller of
 * sine and |cosine| over the larger, x / y <= 1, and atan(x / y) = pi/4 + atan((x - y) / (x + y)),
 * the argument is at most tan(pi / 8). */
static inline lane arc(lane sine, lane cosine) {
    const lane width = lane_select(cosine < 0, -cosine, cosine);
    const mask steep = sine > width;
    const lane y = lane_select(steep, sine, width), x = lane_select(steep, width, sine);
    const mask wide = x > 0.41421356237309503 * y;
    const lane r = lane_select(wide, x - y, x) / lane_select(wide, x + y, y), z = r * r;

    lane series = lane_all(arc_coefficient[ARC_TERMS - 1]);
    for (int k = ARC_TERMS - 2; k >= 0; k--)
        series = series * z + arc_coefficient[k];
    lane angle = r + r * (z * series);
    angle = lane_select(wide, M_PI_4 + angle, angle);
    angle = lane_select(steep, M_PI_2 - angle, angle);
    return lane_select(cosine < 0, M_PI - angle, angle);
}

#endif
