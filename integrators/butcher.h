/* Runge-Kutta methods as data. */
#ifndef WISPLAB_BUTCHER_H
#define WISPLAB_BUTCHER_H

#include <complex.h>

/* u' = g(t, u):  k_i = g(t + c_i h, u + h sum_j a_ij k_j),  u <- u + h sum_i b_i k_i. */
struct butcher_table {
    int stages;
    const double *a;     /* row by row: stages * stages */
    const double *b, *c; /* stages each */
};

/* Row i of a. */
const double *butcher_row(const struct butcher_table *table, int i);

/* The stability function R(z) = 1 + z b' (1 - z A)^-1 (1, ..., 1)': a step on u' = lambda u
 * multiplies u by R(h lambda) (Hairer & Wanner, Solving ODEs II, section IV.3). */
double complex butcher_stability(const struct butcher_table *table, double complex z);

#endif
