/* Vectors of three numbers. */
#ifndef WISPLAB_VECTOR_H
#define WISPLAB_VECTOR_H

#include <math.h>

static inline double vector_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vector_cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* a += s b */
static inline void vector_add(double a[3], double s, const double b[3]) {
    for (int k = 0; k < 3; k++)
        a[k] += s * b[k];
}

static inline double vector_length(const double a[3]) {
    return sqrt(vector_dot(a, a));
}

static inline double vector_largest(const double a[3]) {
    return fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
}

/* Scales to length 1; what has no length stays 0, a direction that no test takes for one. */
static inline void vector_normalise(double a[3]) {
    const double length = vector_length(a);
    for (int k = 0; k < 3; k++)
        a[k] = length > 0 ? a[k] / length : 0;
}

/* Normalises a vector, not 0, of any size: it is scaled first by its largest component, so that no
 * square overflows or vanishes. */
static inline void vector_normalise_any(double a[3]) {
    const double most = vector_largest(a);
    for (int k = 0; k < 3; k++)
        a[k] /= most;
    vector_normalise(a);
}

/* Whether all of n numbers are finite. */
static inline int all_finite(const double *x, int n) {
    double sum[8] = {
        0}; /* 0 * x is NaN where x is not finite; eight chains of additions, not one */
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int k = 0; k < 8; k++)
            sum[k] += 0 * x[i + k];
    for (; i < n; i++)
        sum[0] += 0 * x[i];
    for (int k = 1; k < 8; k++)
        sum[0] += sum[k];
    return sum[0] == 0;
}

#endif
