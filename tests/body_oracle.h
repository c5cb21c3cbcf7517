/* The contact of a wisp with bodies by bisection and the words of the model's text, to hold the
 * code against. */
#ifndef WISPLAB_TESTS_BODY_ORACLE_H
#define WISPLAB_TESTS_BODY_ORACLE_H

#include "wisp/body.h"

/* sum(y_k^2 / R_k^2) - 1 of y = x + s d, extended; d may be NULL. */
long double twin_level(const double radii[3], const double x[3], const double d[3], long double s);

/* The s at which x + s d leaves the ellipsoid that x is in. */
double twin_exit(const double radii[3], const double x[3], const double d[3]);

/* Whether p is in the body at t; x = p - c(t). */
int twin_inside(const struct body *b, double t, const double p[3], double x[3]);

/* A tick of dt at t, under gravity; returns how many nodes are left inside. */
int twin_contact(struct strand *s, const struct body *b, int count, const double gravity[3],
                 double t, double dt);

#endif
