/* Where hair grows: points spread evenly over half of an ellipsoid. */
#ifndef WISPLAB_SCALP_H
#define WISPLAB_SCALP_H

#include "body.h"

/* `count` points of the body's scalp and the outward unit normals there. The scalp is the half of
 * its surface that is on the side of `crown` (a direction from the centre, no zero vector) of a
 * plane through the centre; every point has as much of its area. The same arguments give the same
 * points, each just outside, at the body's offset above the surface; m. Returns 0, or -1 where
 * memory cannot be had. */
int scalp_points(const struct body *body, const double crown[3], int count, double (*points)[3],
                 double (*normals)[3]);

#endif
