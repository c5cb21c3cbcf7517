/* Segments of a length that stays: the tensions along them. */
#ifndef WISPLAB_KERNEL_RIGID_H
#define WISPLAB_KERNEL_RIGID_H

#include "part.h"

/* Work space of a part with rigid segments; numbers of a segment are by the node at its end. */
struct kernel_rigid {
    lane *turning;         /* |P (v_b - v_a)|^2 / |d|, which the acceleration leaves, m/s^2 */
    lane *upper, *tension; /* of the tridiagonal system; its solution */
    lane *gap;             /* by how much a segment is too long, m */
    struct vec *p, *from;  /* nodes: on their way, and where they came from */
    struct vec *t;         /* directions of the segments there, as part->t has them */
    double *v;             /* velocities, in the part's layout */
};

struct kernel_rigid *LANED(kernel_rigid_create)(int nodes, int unknowns);

/* Adds what the tensions do to the accelerations `a` without them, after the springs and frames of
 * the state have been walked along. */
void LANED(kernel_tighten)(struct kernel_part *part, double t, double *a);

#endif
