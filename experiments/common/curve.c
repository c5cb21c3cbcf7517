#include "curve.h"

#include <math.h>
#include <string.h>

enum { CHORDS = 16 }; /* of a segment */

struct curve {
    const double *nodes;
    int stride, n;
};

/* Coordinate k of node i, which may be one beyond either end. */
static double node_at(const struct curve *c, int i, int k) {
    if (c->n == 2)
        return c->nodes[k] + i * (c->nodes[c->stride + k] - c->nodes[k]);
    if (i < 0)
        return 3 * (node_at(c, 0, k) - node_at(c, 1, k)) + node_at(c, 2, k);
    if (i >= c->n)
        return 3 * (node_at(c, i - 1, k) - node_at(c, i - 2, k)) + node_at(c, i - 3, k);
    return c->nodes[i * c->stride + k];
}

/* The end of chord `chord`, counted along the whole curve from 1. */
static void chord_end(const struct curve *c, int chord, double point[3]) {
    const int i = (chord - 1) / CHORDS;
    const double u = (chord - i * CHORDS) / (double)CHORDS;
    for (int k = 0; k < 3; k++) {
        const double a = node_at(c, i - 1, k), b = node_at(c, i, k), d = node_at(c, i + 1, k),
                     e = node_at(c, i + 2, k);
        point[k] =
            b + u / 2 * (d - a + u * (2 * a - 5 * b + 4 * d - e + u * (3 * (b - d) + e - a)));
    }
}

static double distance(const double *a, const double *b) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static double curve_length(const struct curve *c) {
    double length = 0, from[3], to[3];
    memcpy(from, c->nodes, sizeof from);
    for (int chord = 1; chord <= (c->n - 1) * CHORDS; chord++) {
        chord_end(c, chord, to);
        length += distance(from, to);
        memcpy(from, to, sizeof from);
    }
    return length;
}

void curve_points(const double *nodes, int stride, int n, int count, double (*points)[3]) {
    const struct curve c = {nodes, stride, n};
    const double part = curve_length(&c) / count;
    double from[3], to[3], behind = 0; /* arc length up to `from` */
    int next = 0;
    memcpy(from, nodes, sizeof from);
    for (int chord = 1; chord <= (n - 1) * CHORDS; chord++) {
        chord_end(&c, chord, to);
        const double length = distance(from, to);
        for (; next < count - 1 && behind + length >= (next + 1) * part; next++)
            for (int k = 0; k < 3; k++)
                points[next][k] =
                    from[k] + ((next + 1) * part - behind) / length * (to[k] - from[k]);
        behind += length;
        memcpy(from, to, sizeof from);
    }
    for (; next < count; next++) /* the tip, which rounding must not miss */
        memcpy(points[next], nodes + (n - 1) * stride, 3 * sizeof(double));
}
