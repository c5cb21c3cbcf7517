#include "crossing.h"

#include "base/vector.h"
#include "hair_frames.h"

#include <gsl/gsl_poly.h>
#include <math.h>
#include <stdlib.h>

/* --- two segments --- */

/* Where the four ends are at time s of the interval, 0 to 1. */
static void place_at(const struct segment_pair *pair, double s, double p[4][3]) {
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = (1 - s) * pair->before[i][k] + s * pair->after[i][k];
}

static void subtract(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++)
        c[k] = a[k] - b[k];
}

/* (ab x cd) . ac, six times the volume. */
static double volume(const struct segment_pair *pair, double s) {
    double p[4][3], ab[3], cd[3], ac[3], normal[3];
    place_at(pair, s, p);
    subtract(p[1], p[0], ab);
    subtract(p[3], p[2], cd);
    subtract(p[2], p[0], ac);
    vector_cross(ab, cd, normal);
    return vector_dot(normal, ac);
}

/* The roots in [0, 1] of the cubic through four values of the volume, ascending. */
static int plane_times(const struct segment_pair *pair, double times[3]) {
    const double y0 = volume(pair, 0), y1 = volume(pair, 1. / 3), y2 = volume(pair, 2. / 3),
                 y3 = volume(pair, 1);
    /* Newton's forward differences in u = 3 s, written out in powers of u */
    const double d1 = y1 - y0, d2 = y2 - 2 * y1 + y0, d3 = y3 - 3 * y2 + 3 * y1 - y0;
    const double c3 = d3 / 6, c2 = d2 / 2 - d3 / 2, c1 = d1 - d2 / 2 + d3 / 3;
    const double size = fabs(y0) + fabs(y1) + fabs(y2) + fabs(y3);
    double root[3];
    int found = 0, kept = 0;
    if (fabs(c3) > 1e-12 * size)
        found = gsl_poly_solve_cubic(c2 / c3, c1 / c3, y0 / c3, &root[0], &root[1], &root[2]);
    else
        found = gsl_poly_solve_quadratic(c2, c1, y0, &root[0], &root[1]);
    for (int i = 0; i < found; i++)
        if (root[i] >= 0 && root[i] <= 3)
            times[kept++] = root[i] / 3;
    return kept;
}

/* Whether the nearest points of the two lines are on both segments, at a time when they are in one
 * plane. */
static int meet(const struct segment_pair *pair, double s) {
    double p[4][3], d[3], e[3], r[3];
    place_at(pair, s, p);
    subtract(p[1], p[0], d);
    subtract(p[3], p[2], e);
    subtract(p[0], p[2], r);
    const double dd = vector_dot(d, d), ee = vector_dot(e, e), de = vector_dot(d, e);
    const double sine2 = dd * ee - de * de;
    const double x = (de * vector_dot(e, r) - ee * vector_dot(d, r)) / sine2;
    const double y = (dd * vector_dot(e, r) - de * vector_dot(d, r)) / sine2;
    return x >= 0 && x < 1 && y >= 0 && y < 1;
}

static segment_side sign_of(double x) {
    return (segment_side)((x > 0) - (x < 0));
}

struct crossings segments_cross(const struct segment_pair *pair, segment_side *side) {
    struct crossings crossings = {0, 0};
    double times[5] = {0};
    const int roots = plane_times(pair, times + 1);
    times[roots + 1] = 1;
    /* Between roots the sign is that of the middle. A double root, as of a touch, may come out as
     * two that are some 1e-8 apart, with noise between them. */
    for (int i = 0; i <= roots; i++) {
        if (times[i + 1] - times[i] < 1e-6)
            continue;
        const segment_side now = sign_of(volume(pair, (times[i] + times[i + 1]) / 2));
        if (now && *side == -now && meet(pair, times[i])) {
            crossings.count++;
            crossings.net += now;
        }
        *side = now ? now : *side;
    }
    return crossings;
}

/* --- all of them --- */

/* The segments (i, i + 1), i >= 1, of two wisps in an interval that ends at a frame. */
struct wisp_pair {
    const struct hair *hair;
    int frame, first, second;
};

static void take(const struct wisp_pair *wisps, int i, int j, struct segment_pair *pair) {
    for (int k = 0; k < 3; k++)
        for (int end = 0; end < 2; end++) {
            const int f = wisps->frame;
            pair->before[end][k] = hair_node(wisps->hair, f - 1, wisps->first, i + end)[k];
            pair->after[end][k] = hair_node(wisps->hair, f, wisps->first, i + end)[k];
            pair->before[2 + end][k] = hair_node(wisps->hair, f - 1, wisps->second, j + end)[k];
            pair->after[2 + end][k] = hair_node(wisps->hair, f, wisps->second, j + end)[k];
        }
}

/* Whether boxes around both segments' ways are apart: then they do not meet. */
static int far_apart(const struct segment_pair *pair) {
    for (int k = 0; k < 3; k++) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int i = 0; i < 4; i++) {
            low[i / 2] = fmin(low[i / 2], fmin(pair->before[i][k], pair->after[i][k]));
            high[i / 2] = fmax(high[i / 2], fmax(pair->before[i][k], pair->after[i][k]));
        }
        if (low[0] > high[1] || low[1] > high[0])
            return 1;
    }
    return 0;
}

/* Far from each other segments may go round each other's ends: their side is not kept. */
static struct crossings look_at_segments(const struct wisp_pair *wisps, int i, int j,
                                         segment_side *side) {
    struct segment_pair pair;
    take(wisps, i, j, &pair);
    if (far_apart(&pair)) {
        *side = sign_of(volume(&pair, 1));
        return (struct crossings){0, 0};
    }
    return segments_cross(&pair, side);
}

static struct crossings look_at_wisps(const struct wisp_pair *wisps, segment_side *sides) {
    struct crossings sum = {0, 0};
    const int first = hair_nodes(wisps->hair, wisps->frame, wisps->first),
              second = hair_nodes(wisps->hair, wisps->frame, wisps->second);
    for (int i = 1; i + 1 < first; i++)
        for (int j = 1; j + 1 < second; j++) {
            const struct crossings one = look_at_segments(wisps, i, j, &sides[i * second + j]);
            sum.count += one.count;
            sum.net += one.net;
        }
    return sum;
}

int hair_crossings(const struct hair *hair, double *count, double *net) {
    const int wisps = hair->states->wisp_count;
    int most_nodes = 0;
    for (int w = 0; w < wisps; w++)
        most_nodes = hair->wisps[w].nodes > most_nodes ? hair->wisps[w].nodes : most_nodes;
    const size_t each = (size_t)most_nodes * (size_t)most_nodes;
    segment_side *sides = calloc((size_t)wisps * (size_t)wisps * each + 1, sizeof *sides);
    if (!sides)
        return -1;
    for (int f = 0; f < hair->frame_count; f++) {
        count[f] = f > 0 ? count[f - 1] : 0;
        net[f] = f > 0 ? net[f - 1] : 0;
        const int there = f > 0 ? hair->frames[f - 1].wisps : 0;
        for (int a = 0; a < there; a++)
            for (int b = a + 1; b < there; b++) {
                const struct wisp_pair pair = {hair, f, a, b};
                const size_t at = ((size_t)a * (size_t)wisps + (size_t)b) * each;
                const struct crossings sum = look_at_wisps(&pair, sides + at);
                count[f] += sum.count;
                net[f] += sum.net;
            }
    }
    free(sides);
    return 0;
}
