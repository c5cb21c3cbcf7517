#include "ellipsoid.h"

#include "base/vector.h"

#include <string.h>

void ellipsoid_to_sphere(const double radii[3], const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++)
        y[k] = x[k] / radii[k];
}

int ellipsoid_contains(const double radii[3], const double x[3]) {
    double y[3];
    ellipsoid_to_sphere(radii, x, y);
    return vector_dot(y, y) < 1;
}

/* x_k / R_k^2, in units in which neither squares nor sums overflow or vanish. */
void ellipsoid_normal(const double radii[3], const double x[3], double normal[3]) {
    double y[3];
    int smallest = 0;
    for (int k = 1; k < 3; k++)
        if (radii[k] < radii[smallest])
            smallest = k;
    ellipsoid_to_sphere(radii, x, y);
    for (int k = 0; k < 3; k++)
        normal[k] = y[k] * (radii[smallest] / radii[k]);
    if (vector_largest(normal) == 0) {
        memset(normal, 0, 3 * sizeof *normal);
        normal[smallest] = 1;
    } else {
        vector_normalise_any(normal);
    }
}

/* The line y + s e in the sphere's coordinates, e scaled to a largest component of 1: crossings are
 * where a s^2 + 2 b s + c = 0. */
struct line {
    double a, b, c;
    double unit; /* of s, in ||d|| */
    double miss; /* ||y x e||^2: a^(1/2) times the line's distance from the centre, squared */
};

static struct line line_through(const double radii[3], const double x[3], const double d[3]) {
    double y[3], e[3], n[3];
    ellipsoid_to_sphere(radii, x, y);
    ellipsoid_to_sphere(radii, d, e);
    const double most = vector_largest(e);
    for (int k = 0; k < 3; k++)
        e[k] /= most;
    vector_cross(y, e, n);
    return (struct line){.a = vector_dot(e, e),
                         .b = vector_dot(y, e),
                         .c = vector_dot(y, y) - 1,
                         .unit = 1 / most,
                         .miss = vector_dot(n, n)};
}

/* Each root in the form that subtracts no equals. */
double ellipsoid_exit(const double radii[3], const double x[3], const double d[3]) {
    const struct line l = line_through(radii, x, d);
    const double c = fmin(l.c, 0), root = sqrt(l.b * l.b - l.a * c);
    return l.unit * (l.b > 0 ? -c / (l.b + root) : (root - l.b) / l.a);
}

/* b^2 - a c = a - ||y x e||^2: where the line grazes, the first cancels. */
double ellipsoid_entry(const double radii[3], const double x[3], const double d[3]) {
    const struct line l = line_through(radii, x, d);
    const double discriminant = l.a - l.miss;
    if (l.b >= 0 || discriminant < 0)
        return INFINITY;
    return l.unit * (fmax(l.c, 0) / (sqrt(discriminant) - l.b));
}
