/* Eight neighbours of a vector: unknowns of eight lanes, two of each of four, or eight of a lane
 * alone. What goes by lane stands in an eight again and again; it fits wherever a multiple of eight
 * begins. */
#ifndef WISPLAB_EIGHTS_H
#define WISPLAB_EIGHTS_H

#include <string.h>

/* How vectors wider than the machine's registers are passed is this program's own matter. */
#pragma GCC diagnostic ignored "-Wpsabi"

enum { EIGHT = 8 };
typedef double eight __attribute__((vector_size(8 * EIGHT), aligned(8)));

static inline eight load(const double *x, int i) {
    eight y;
    memcpy(&y, x + i, sizeof y);
    return y;
}

static inline void store(double *x, int i, eight y) {
    memcpy(x + i, &y, sizeof y);
}

static inline eight all(double x) {
    return x - (eight){0};
}

/* Numbers by lane, of 1, 4 or 8 lanes. */
static inline eight by_lane(const double *x, int lanes) {
    eight y;
    for (int k = 0; k < EIGHT; k++)
        y[k] = x[k % lanes];
    return y;
}

#endif
