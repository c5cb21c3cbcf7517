/* An ellipsoid, seen from its centre along its axes: sum (x_k / R_k)^2 = 1. */
#ifndef WISPLAB_ELLIPSOID_H
#define WISPLAB_ELLIPSOID_H

/* x_k / R_k: there it is the unit sphere. */
void ellipsoid_to_sphere(const double radii[3], const double x[3], double y[3]);

int ellipsoid_contains(const double radii[3], const double x[3]);

/* The outward normal of the shell (scaled ellipsoid) through x; at the centre the positive axis of
 * smallest radius, the first on ties. */
void ellipsoid_normal(const double radii[3], const double x[3], double normal[3]);

/* Distance in units of ||d|| from a point inside to the surface along d. */
double ellipsoid_exit(const double radii[3], const double x[3], const double d[3]);

/* The distance from a point outside to the first crossing; INFINITY where there is none ahead. */
double ellipsoid_entry(const double radii[3], const double x[3], const double d[3]);

#endif
