#include "prescribed.h"

#include <math.h>
#include <string.h>

/* --- between knots --- */

/* The interval [time[k], time[k + 1]] that holds t; k = -1 before the first knot, knots - 1 after
 * the last. */
static int interval(const double *time, int knots, double t) {
    int k = -1;
    while (k + 1 < knots && time[k + 1] <= t)
        k++;
    return k;
}

/* Slope at a knot: of the chord between its neighbours, 0 at the ends. */
static double slope(const double *time, const double (*x)[3], int knots, int k, int component) {
    if (k == 0 || k == knots - 1)
        return 0;
    return (x[k + 1][component] - x[k - 1][component]) / (time[k + 1] - time[k - 1]);
}

/* Cubic Hermite (value, first and second derivative) of one component, between knots k and k + 1.
 */
static void hermite(const double *time, const double (*x)[3], int knots, int k, double t,
                    int component, double result[3]) {
    result[1] = result[2] = 0;
    if (k < 0 || k >= knots - 1) {
        result[0] = x[k < 0 ? 0 : knots - 1][component];
        return;
    }
    const double h = time[k + 1] - time[k], s = (t - time[k]) / h;
    const double a = x[k][component], rise = x[k + 1][component] - a;
    const double m0 = h * slope(time, x, knots, k, component);
    const double m1 = h * slope(time, x, knots, k + 1, component);
    /* a + m0 s + c s^2 + d s^3 meets value and slope at s = 1 */
    const double c = 3 * rise - 2 * m0 - m1, d = m0 + m1 - 2 * rise;
    result[0] = a + s * (m0 + s * (c + s * d));
    result[1] = (m0 + s * (2 * c + 3 * s * d)) / h;
    result[2] = (2 * c + 6 * s * d) / (h * h);
}

/* --- rotations --- */

/* A(z) = sin(a) / a and B(z) = (1 - cos a) / a^2 of z = a^2 with their first two derivatives. The
 * power series where z is small: the closed forms divide by z. */
static void rotation_functions(double z, double A[3], double B[3]) {
    if (z < 1) {
        memset(A, 0, 3 * sizeof *A);
        memset(B, 0, 3 * sizeof *B);
        double term = 1; /* (-1)^k / (2k + 1)! */
        for (int k = 0; k < 14; k++, term /= -(2 * k) * (2 * k + 1)) {
            const double powers[3] = {pow(z, k), k > 0 ? k * pow(z, k - 1) : 0,
                                      k > 1 ? k * (k - 1) * pow(z, k - 2) : 0};
            for (int d = 0; d < 3; d++) {
                A[d] += term * powers[d];
                B[d] += term / (2 * k + 2) * powers[d];
            }
        }
        return;
    }
    const double a = sqrt(z);
    A[0] = sin(a) / a;
    B[0] = (1 - cos(a)) / z;
    A[1] = (cos(a) - A[0]) / (2 * z);
    B[1] = (A[0] / 2 - B[0]) / z;
    A[2] = -(A[0] / 2 + 3 * A[1]) / (2 * z);
    B[2] = (A[1] / 2 - 2 * B[1]) / z;
}

/* f(z(t)) and its first two derivatives by t, from those of f by z and of z by t. */
static void chain(const double f[3], const double z[3], double result[3]) {
    result[0] = f[0];
    result[1] = f[1] * z[1];
    result[2] = f[2] * z[1] * z[1] + f[1] * z[2];
}

/* Derivatives of a product. */
static void product(const double f[3], const double g[3], double result[3]) {
    result[0] = f[0] * g[0];
    result[1] = f[1] * g[0] + f[0] * g[1];
    result[2] = f[2] * g[0] + 2 * f[1] * g[1] + f[0] * g[2];
}

static void add(double sum[3], const double f[3], double sign) {
    for (int d = 0; d < 3; d++)
        sum[d] += sign * f[d];
}

/* Rodrigues: turn = 1 + A [r] + B [r]^2 with [r]^2 = r r' - (r.r) 1, each number with its
 * derivatives; r[component][derivative]. */
static void rotation_matrix(double r[3][3], double turn[3][3][3]) {
    double z[3] = {0}, fA[3], fB[3], A[3], B[3], term[3], square[3];
    for (int c = 0; c < 3; c++) {
        product(r[c], r[c], square);
        add(z, square, 1);
    }
    rotation_functions(z[0], fA, fB);
    chain(fA, z, A);
    chain(fB, z, B);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double entry[3] = {i == j, 0, 0};
            product(r[i], r[j], square);
            if (i == j)
                add(square, z, -1);
            product(B, square, term);
            add(entry, term, 1);
            if (i != j) { /* [r] x = r cross x */
                product(A, r[3 - i - j], term);
                add(entry, term, (j - i + 3) % 3 == 1 ? -1 : 1);
            }
            for (int d = 0; d < 3; d++)
                turn[d][i][j] = entry[d];
        }
    }
}

int head_interval(const struct head_motion *head, double t) {
    return interval(head->time, head->knots, t);
}

void head_placement(const struct head_motion *head, double t, struct placement *placement) {
    head_placement_within(head, t, t, placement);
}

void head_placement_within(const struct head_motion *head, double inside, double t,
                           struct placement *placement) {
    const int k = head_interval(head, inside);
    double r[3][3] = {{0}}, p[3];
    memset(placement, 0, sizeof *placement);
    for (int c = 0; c < 3 && head->knots > 0; c++) {
        hermite(head->time, head->position, head->knots, k, t, c, p);
        hermite(head->time, head->rotation, head->knots, k, t, c, r[c]);
        for (int d = 0; d < 3; d++)
            placement->position[d][c] = p[d];
    }
    rotation_matrix(r, placement->turn);
}

void placed_point(const struct placement *placement, int derivative, const double rest[3],
                  double point[3]) {
    for (int i = 0; i < 3; i++) {
        point[i] = placement->position[derivative][i];
        for (int j = 0; j < 3; j++)
            point[i] += placement->turn[derivative][i][j] * rest[j];
    }
}

void placed_direction(const struct placement *placement, const double rest[3],
                      double direction[3]) {
    for (int i = 0; i < 3; i++) {
        direction[i] = 0;
        for (int j = 0; j < 3; j++)
            direction[i] += placement->turn[0][i][j] * rest[j];
    }
}

/* --- style --- */

/* Linear between knots; 0 where there are none. */
static void between_knots(const struct style *style, const double (*x)[3], double t,
                          double result[3]) {
    const int k = interval(style->time, style->knots, t), last = style->knots - 1;
    memset(result, 0, 3 * sizeof *result);
    if (style->knots == 0)
        return;
    const int from = k < 0 ? 0 : k, to = k < 0 ? 0 : k < last ? k + 1 : last;
    const double length = style->time[to] - style->time[from];
    const double s = length > 0 ? (t - style->time[from]) / length : 0;
    for (int c = 0; c < 3; c++)
        result[c] = (1 - s) * x[from][c] + s * x[to][c];
}

void style_acceleration(const struct style *style, double t, double acceleration[3]) {
    between_knots(style, style->acceleration, t, acceleration);
}

void style_parting(const struct style *style, double t, double acceleration[3]) {
    between_knots(style, style->parting.acceleration, t, acceleration);
}

void style_at(const struct style *style, double t, const double point[3], double acceleration[3]) {
    const struct parting *parting = &style->parting;
    style_acceleration(style, t, acceleration);
    if (!(parting->width > 0))
        return;
    double parted[3], distance = 0;
    style_parting(style, t, parted);
    for (int c = 0; c < 3; c++)
        distance += (point[c] - parting->origin[c]) * parting->normal[c];
    for (int c = 0; c < 3; c++)
        acceleration[c] += tanh(distance / parting->width) * parted[c];
}

static void rate_between_knots(const struct style *style, const double (*accelerations)[3],
                               double inside, double rate[3]) {
    const int k = interval(style->time, style->knots, inside);
    const int between = k >= 0 && k < style->knots - 1;
    for (int c = 0; c < 3; c++)
        rate[c] = between ? (accelerations[k + 1][c] - accelerations[k][c]) /
                                (style->time[k + 1] - style->time[k])
                          : 0;
}

void style_rate(const struct style *style, double inside, double rate[3]) {
    rate_between_knots(style, style->acceleration, inside, rate);
}

void style_parting_rate(const struct style *style, double inside, double rate[3]) {
    rate_between_knots(style, style->parting.acceleration, inside, rate);
}
