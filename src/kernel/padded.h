/* Vectors of all lanes, written as those of each. */
#ifndef WISPLAB_KERNEL_PADDED_H
#define WISPLAB_KERNEL_PADDED_H

#include "part.h"

/* A vector of every lane as three numbers and one of no use: four at once cost less than three, and
 * the next ones that are written take the place of the fourth. */
struct padded {
    double x[LANES][4];
};

static inline struct padded pad(struct vec v) {
    struct padded padded;
#if LANES >= 4
    typedef double four __attribute__((vector_size(32)));
    for (int k = 0; k < LANES; k += 4) {
        four x, y, z, row[4];
        memcpy(&x, (const double *)&v.x + k, sizeof x);
        memcpy(&y, (const double *)&v.y + k, sizeof y);
        memcpy(&z, (const double *)&v.z + k, sizeof z);
        const four even = __builtin_shufflevector(x, y, 0, 4, 2, 6);
        const four odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
        row[0] = __builtin_shufflevector(even, z, 0, 1, 4, 4);
        row[1] = __builtin_shufflevector(odd, z, 0, 1, 5, 5);
        row[2] = __builtin_shufflevector(even, z, 2, 3, 6, 6);
        row[3] = __builtin_shufflevector(odd, z, 2, 3, 7, 7);
        memcpy(padded.x[k], row, sizeof row);
    }
#else
    vec_get(padded.x[0], v, 0);
    padded.x[0][3] = 0;
#endif
    return padded;
}

/* Into arrays of three numbers each that have room for one more. */
static inline void put(double *to, const struct padded *padded, int k) {
    memcpy(to, padded->x[k], sizeof padded->x[k]);
}

#endif
