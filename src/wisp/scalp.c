#include "scalp.h"

#include "base/vector.h"
#include "ellipsoid.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* A Fibonacci lattice in the unit square, (i + 1/2) / count by the fractional part of i times the
 * golden ratio, is even there (Gonzalez, Mathematical Geosciences 42, 2010, has it on the sphere).
 * Its first number becomes the share of the scalp's area that is higher than the point, its second
 * the share of the ring at that height that is before it: a map that keeps areas. */
enum { RINGS = 256, STEPS = 256 };

/* The ellipsoid as a unit sphere, y_k = x_k / R_k: m looks to the crown, e_1 and e_2 across. */
struct scalp {
    const double *radii;
    double m[3], e[2][3];
};

/* The side x.crown > 0 is the side y_k R_k crown_k > 0. */
static void look_at(struct scalp *scalp, const double radii[3], const double crown[3]) {
    int least = 0;
    scalp->radii = radii;
    for (int k = 0; k < 3; k++)
        scalp->m[k] = radii[k] * crown[k];
    vector_normalise_any(scalp->m);
    for (int k = 1; k < 3; k++)
        if (fabs(scalp->m[k]) < fabs(scalp->m[least]))
            least = k;
    for (int k = 0; k < 3; k++)
        scalp->e[0][k] = (k == least) - scalp->m[least] * scalp->m[k];
    vector_normalise_any(scalp->e[0]);
    vector_cross(scalp->m, scalp->e[0], scalp->e[1]);
}

/* The point of the unit sphere at height z (0 to 1) and a share of a turn. */
static void on_sphere(const struct scalp *scalp, double z, double turn, double y[3]) {
    const double across = sqrt(1 - z * z), angle = 2 * M_PI * turn;
    for (int k = 0; k < 3; k++)
        y[k] =
            z * scalp->m[k] + across * (cos(angle) * scalp->e[0][k] + sin(angle) * scalp->e[1][k]);
}

/* The ellipsoid's area over the sphere's there, but for the factor R_1 R_2 R_3. */
static double stretch(const struct scalp *scalp, double z, double turn) {
    double y[3];
    on_sphere(scalp, z, turn, y);
    return hypot(hypot(y[0] / scalp->radii[0], y[1] / scalp->radii[1]), y[2] / scalp->radii[2]);
}

/* Area of a ring up to each of STEPS parts of the turn, by the trapezoidal rule. */
static double ring(const struct scalp *scalp, double z, double area[STEPS + 1]) {
    double before = stretch(scalp, z, 0);
    area[0] = 0;
    for (int k = 1; k <= STEPS; k++) {
        const double here = stretch(scalp, z, (double)k / STEPS);
        area[k] = area[k - 1] + (before + here) / 2;
        before = here;
    }
    return area[STEPS];
}

/* Area above each of RINGS steps down from the crown; on a sphere equal heights have equal areas
 * (Archimedes). */
static void rings(const struct scalp *scalp, double area[RINGS + 1]) {
    double around[STEPS + 1], before = ring(scalp, 1, around);
    area[0] = 0;
    for (int k = 1; k <= RINGS; k++) {
        const double here = ring(scalp, 1 - (double)k / RINGS, around);
        area[k] = area[k - 1] + (before + here) / 2;
        before = here;
    }
}

/* Where in 0 to 1 an ascending table of `steps` steps reaches a share of its last number. */
static double reach(const double *table, int steps, double share) {
    const double wanted = share * table[steps];
    int k = 0;
    while (k + 1 < steps && table[k + 1] < wanted)
        k++;
    return (k + (wanted - table[k]) / (table[k + 1] - table[k])) / steps;
}

/* From y on the unit sphere to just outside the ellipsoid: rounding must not leave it inside. */
static void put_outside(const struct body *body, const double y[3], double point[3],
                        double normal[3]) {
    double x[3], size = 0;
    for (int k = 0; k < 3; k++) {
        x[k] = body->radii[k] * y[k];
        size = fmax(size, fmax(body->radii[k], fabs(body->centre[k])));
    }
    ellipsoid_normal(body->radii, x, normal);
    for (int k = 0; k < 3; k++)
        point[k] = body->centre[k] + x[k] + (body->offset + 8 * DBL_EPSILON * size) * normal[k];
}

int scalp_points(const struct body *body, const double crown[3], int count, double (*points)[3],
                 double (*normals)[3]) {
    const double golden = (sqrt(5) - 1) / 2;
    double *above = malloc((RINGS + 1 + STEPS + 1) * sizeof *above);
    if (!above)
        return -1;
    double *around = above + RINGS + 1;
    struct scalp scalp;
    look_at(&scalp, body->radii, crown);
    rings(&scalp, above);
    for (int i = 0; i < count; i++) {
        double y[3];
        const double z = 1 - reach(above, RINGS, (i + 0.5) / count);
        ring(&scalp, z, around);
        on_sphere(&scalp, z, reach(around, STEPS, i * golden - floor(i * golden)), y);
        put_outside(body, y, points[i], normals[i]);
    }
    free(above);
    return 0;
}
