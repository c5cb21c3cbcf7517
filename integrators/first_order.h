/* A second-order system as libraries of first-order methods see it: y' = g(t, y), y = (q, v). */
#ifndef WISPLAB_FIRST_ORDER_H
#define WISPLAB_FIRST_ORDER_H

#include "system/system.h"

/* rate <- (v, v') at y, both of 2 * size doubles. A rate that is not finite is NOT_FINITE, for a
 * smaller step may do: the libraries do not look, and would accept a NaN of an error as small. */
int first_order_rate(struct system *system, double t, const double *y, double *rate);

/* Whether a step of h from t is lost in the rounding of t. */
int step_is_lost(double t, double h);

#endif
