#include "section.h"

#include "vector.h"

#include <string.h>

/* Between two samples the envelope's r^-2 goes over as cos^2 to sin^2 of an angle that runs from 0
 * to a right one: for 4 samples a quarter of an ellipse. */

static const double least_lean = 0.1; /* of the axis on a plane's normal, cos of 84 degrees */
static const double on_axis = 1e-12;  /* m: no direction from the axis is to be had */

double section_radius(const struct strand *strand, int node, int sample) {
    return fmax(strand->r[node * strand->wisp->samples + sample], 1e-3 * strand->wisp->radius);
}

/* --- making one --- */

/* The largest radius at a node; adds the squares of all. */
static double largest_radius(const struct strand *strand, int node, double *squares) {
    double most = 0;
    for (int j = 0; j < strand->wisp->samples; j++) {
        const double r = section_radius(strand, node, j);
        most = fmax(most, r);
        *squares += r * r;
    }
    return most;
}

/* The volume is in the hull of the two discs in the bisector planes: z is no further from its node
 * than the largest r there, and within the plane. */
static void make_box(struct section *s, const double most[2]) {
    const double slack = 1e-9 * (most[0] + most[1] + s->length);
    for (int k = 0; k < 3; k++) {
        s->low[k] = INFINITY;
        s->high[k] = -INFINITY;
        for (int end = 0; end < 2; end++) {
            const double p = s->strand->p[s->index + end][k];
            const double w = s->strand->axis_w[s->index + end][k];
            const double margin = most[end] * sqrt(fmax(0, 1 - w * w)) + slack + 1e-15 * fabs(p);
            s->low[k] = fmin(s->low[k], p - margin);
            s->high[k] = fmax(s->high[k], p + margin);
        }
    }
}

void section_make(struct section *s, const struct strand *strand, int index) {
    double most[2], squares = 0;
    *s = (struct section){.strand = strand, .index = index};
    for (int k = 0; k < 3; k++)
        s->t[k] = strand->p[index + 1][k] - strand->p[index][k];
    s->length = vector_length(s->t);
    if (!(s->length > 0) || isinf(s->length))
        return;
    for (int k = 0; k < 3; k++)
        s->t[k] /= s->length;
    for (int end = 0; end < 2; end++) {
        const double *w = strand->axis_w[index + end], along = vector_dot(s->t, w);
        if (!(along >= least_lean))
            return;
        for (int k = 0; k < 3; k++)
            s->lean[end][k] = w[k] / along;
        most[end] = largest_radius(strand, index + end, &squares);
    }
    s->usable = 1;
    s->reach = fmax(most[0], most[1]);
    s->mean_r2 = squares / (2 * strand->wisp->samples);
    make_box(s, most);
    double apart[3] = {s->lean[0][0], s->lean[0][1], s->lean[0][2]};
    vector_add(apart, -1, s->lean[1]);
    s->wedge =
        s->reach * vector_length(apart) < s->length ? 1e-9 * (s->length + s->reach) : INFINITY;
}

/* --- is a point in it --- */

/* The radius of the envelope at a node in a direction of its bisector plane. */
static double radius_towards(const struct strand *strand, int node, const double direction[3]) {
    const int samples = strand->wisp->samples;
    const double u = vector_dot(direction, strand->axis_u[node]),
                 v = vector_dot(direction, strand->axis_v[node]);
    if (samples == 4) { /* psi's cosine and sine are u and v themselves, in some order */
        const double a = section_radius(strand, node, u < 0 ? 2 : 0),
                     b = section_radius(strand, node, v < 0 ? 3 : 1);
        return a * b / sqrt(u * u * b * b + v * v * a * a);
    }
    const double turn = atan2(v, u) / (2 * M_PI); /* from -1/2 to 1/2 */
    const double at = (turn < 0 ? turn + 1 : turn) * samples;
    const int j = (int)at < samples ? (int)at : samples - 1; /* turn + 1 may round to 1 */
    const double psi = (at - j) * (M_PI / 2), c = cos(psi), d = sin(psi);
    const double r0 = section_radius(strand, node, j),
                 r1 = section_radius(strand, node, (j + 1) % samples);
    return 1 / sqrt(c * c / (r0 * r0) + d * d / (r1 * r1));
}

/* z of an end in the half-plane of the axis and q: along the axis from the node, and across it. */
static void rim(const struct section *s, int end, const double q[3], double z[2]) {
    const double along = vector_dot(q, s->lean[end]), norm = sqrt(1 + along * along);
    double direction[3];
    for (int k = 0; k < 3; k++)
        direction[k] = (q[k] - along * s->t[k]) / norm;
    const double rho = radius_towards(s->strand, s->index + end, direction);
    z[0] = -rho * along / norm;
    z[1] = rho / norm;
}

/* Whether the ray from x towards greater x[0] crosses an edge that has its lower and not its upper
 * end. The end that is lower comes first whoever asks, so that two polygons with a common edge
 * agree about it. */
static int crosses(const double a[2], const double b[2], const double x[2]) {
    const double *low = a[1] < b[1] ? a : b, *high = a[1] < b[1] ? b : a;
    if ((low[1] > x[1]) == (high[1] > x[1]))
        return 0;
    return x[0] < low[0] + (x[1] - low[1]) * (high[0] - low[0]) / (high[1] - low[1]);
}

static int in_quadrilateral(const struct section *s, const double q[3], const double x[2]) {
    double corner[4][2] = {{0, 0}, {s->length, 0}};
    rim(s, 1, q, corner[2]);
    corner[2][0] += s->length;
    rim(s, 0, q, corner[3]);
    int inside = 0;
    for (int i = 0; i < 4; i++)
        inside ^= crosses(corner[i], corner[(i + 1) % 4], x);
    return inside;
}

int section_contains(const struct section *s, const double point[3], struct section_place *place) {
    double across[3], x[2];
    if (!s->usable)
        return 0;
    for (int k = 0; k < 3; k++)
        across[k] = point[k] - s->strand->p[s->index][k];
    x[0] = place->x = vector_dot(across, s->t);
    vector_add(across, -x[0], s->t);
    const double square = vector_dot(across, across);
    if (!(square <= s->reach * s->reach))
        return 0;
    if (x[0] < -vector_dot(across, s->lean[0]) - s->wedge ||
        x[0] > s->length - vector_dot(across, s->lean[1]) + s->wedge)
        return 0; /* most points are told here, without a root */
    x[1] = sqrt(square);
    memset(place->q, 0, sizeof place->q);
    if (x[1] < on_axis)
        return x[0] >= 0 && x[0] < s->length;
    for (int k = 0; k < 3; k++)
        place->q[k] = across[k] / x[1];
    return in_quadrilateral(s, place->q, x);
}
