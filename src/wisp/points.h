/* Arithmetic on the points that are held against a section at once. */
#ifndef WISPLAB_POINTS_H
#define WISPLAB_POINTS_H

#include "section.h"

#ifdef __AVX512F__
#define LANES 8
#else
#define LANES 4
#endif
#include "base/lanes.h"

_Static_assert(LANES == (int)SECTION_POINTS, "a lane for each point");

/* Component k of a vector for each lane. */
static inline lane component(const double *const x[LANES], int k) {
#if LANES == 8
    return (lane){x[0][k], x[1][k], x[2][k], x[3][k], x[4][k], x[5][k], x[6][k], x[7][k]};
#else
    return (lane){x[0][k], x[1][k], x[2][k], x[3][k]};
#endif
}

static inline struct vec vec_of(const double *const x[LANES]) {
    return (struct vec){component(x, 0), component(x, 1), component(x, 2)};
}

#endif
