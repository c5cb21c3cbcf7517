#include "section.h"

#include "base/vector.h"
#include "points.h"

#include <string.h>

/* Between two samples the envelope's r^-2 goes over as cos^2 to sin^2 of an angle that runs from 0
 * to a right one: for 4 samples a quarter of an ellipse. */

static const double least_lean = 0.1; /* of the axis on a plane's normal, cos of 84 degrees */
static const double on_axis = 1e-12;  /* m: no direction from the axis is to be had */

double section_radius(const struct strand *strand, int node, int sample) {
    const double r = strand->r[node * strand->wisp->samples + sample];
    const double least = 1e-3 * strand->wisp->radius;
    return r > least ? r : least;
}

double section_rim(const struct strand *strand, int node, double turn) {
    const int samples = strand->wisp->samples;
    const double at = turn * samples;
    const int j = (int)at < samples ? (int)at : samples - 1; /* a turn may be rounded to 1 */
    const double psi = (at - j) * (M_PI / 2), c = cos(psi), d = sin(psi);
    const double r0 = section_radius(strand, node, j),
                 r1 = section_radius(strand, node, (j + 1) % samples);
    return 1 / sqrt(c * c / (r0 * r0) + d * d / (r1 * r1));
}

/* --- making one --- */

/* The largest radius at a node; adds the squares of all. */
static double largest_radius(const struct strand *strand, int node, double *squares) {
    double most = 0;
    for (int j = 0; j < strand->wisp->samples; j++) {
        const double r = section_radius(strand, node, j);
        most = r > most ? r : most;
        *squares += r * r;
    }
    return most;
}

/* The volume is in the hull of the two discs in the bisector planes: z is no further from its node
 * than the largest r there, and within the plane. */
static void make_box(struct section *s, const double most[2]) {
    const double slack = 1e-9 * (most[0] + most[1] + s->length);
    double low[2][3], high[2][3];
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            const double p = s->strand->p[s->index + end][k];
            const double w = s->strand->axis_w[s->index + end][k], square = 1 - w * w;
            const double in_plane = sqrt(square > 0 ? square : 0);
            const double margin = most[end] * in_plane + slack + 1e-15 * fabs(p);
            low[end][k] = p - margin;
            high[end][k] = p + margin;
        }
    for (int k = 0; k < 3; k++) {
        s->low[k] = low[1][k] < low[0][k] ? low[1][k] : low[0][k];
        s->high[k] = high[1][k] > high[0][k] ? high[1][k] : high[0][k];
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
        s->turn[end][0] = vector_dot(s->t, strand->axis_u[index + end]);
        s->turn[end][1] = vector_dot(s->t, strand->axis_v[index + end]);
        most[end] = largest_radius(strand, index + end, &squares);
    }
    s->usable = 1;
    s->reach = most[0] > most[1] ? most[0] : most[1];
    s->mean_r2 = squares / (2 * strand->wisp->samples);
    make_box(s, most);
    double apart[3] = {s->lean[0][0], s->lean[0][1], s->lean[0][2]};
    vector_add(apart, -1, s->lean[1]);
    s->wedge =
        s->reach * vector_length(apart) < s->length ? 1e-9 * (s->length + s->reach) : INFINITY;
}

/* --- are points in it --- */

/* Some points at a time: where they are, and in which lanes the answer is yes. */
struct probe {
    lane x;          /* along the axis */
    struct vec away; /* across it, */
    lane square;     /* and its square */
    mask in;
};

/* Most points are told here, without a root. */
static inline struct probe probe_points(const struct section *s, struct vec point) {
    const struct vec t = vec_all(s->t);
    const struct vec d = sub(point, vec_all(s->strand->p[s->index]));
    struct probe probe = {.x = dot(d, t)};
    probe.away = add_scaled(d, -probe.x, t);
    probe.square = dot(probe.away, probe.away);
    const lane before = -dot(probe.away, vec_all(s->lean[0])) - s->wedge;
    const lane behind = s->length - dot(probe.away, vec_all(s->lean[1])) + s->wedge;
    probe.in =
        (probe.square <= lane_all(s->reach * s->reach)) & ~(probe.x < before) & ~(probe.x > behind);
    return probe;
}

/* rho / sqrt(U^2 + V^2), rho being the envelope's radius in the direction whose components in the
 * bisector plane go as U, V. */
static inline lane radius_over_length(const struct section *s, int end, lane u, lane v) {
    const struct strand *strand = s->strand;
    const int node = s->index + end, samples = strand->wisp->samples;
    double ratio[LANES];
    if (samples == 4) { /* psi's cosine and sine are U and V themselves, in some order */
        const lane a = lane_select(u < 0, lane_all(section_radius(strand, node, 2)),
                                   lane_all(section_radius(strand, node, 0)));
        const lane b = lane_select(v < 0, lane_all(section_radius(strand, node, 3)),
                                   lane_all(section_radius(strand, node, 1)));
        return a * b / lane_sqrt(u * u * b * b + v * v * a * a);
    }
    for (int k = 0; k < LANES; k++) {
        const double turn = atan2(v[k], u[k]) / (2 * M_PI); /* from -1/2 to 1/2 */
        const double rho = section_rim(strand, node, turn < 0 ? turn + 1 : turn);
        ratio[k] = rho / sqrt(u[k] * u[k] + v[k] * v[k]);
    }
    return load(ratio, 0);
}

/* A point of a half-plane bounded by the axis: along it from node i, and away from it. */
struct flat {
    lane x, y;
};

/* z of an end in the half-plane of q. With a = q.lean the direction delta is q - a t over its
 * length N; U and V are its components times N, and z = rho / N (-a, 1): N cancels. */
static inline struct flat rim(const struct section *s, int end, struct vec q) {
    const int node = s->index + end;
    const lane a = dot(q, vec_all(s->lean[end]));
    const lane u = dot(q, vec_all(s->strand->axis_u[node])) - a * s->turn[end][0];
    const lane v = dot(q, vec_all(s->strand->axis_v[node])) - a * s->turn[end][1];
    const lane y = radius_over_length(s, end, u, v);
    return (struct flat){-a * y + (end ? s->length : 0), y};
}

/* Whether the ray from `at` towards greater x crosses an edge that has its lower and not its upper
 * end. The end that is lower comes first whoever asks, so that two polygons with a common edge
 * agree about it. */
static inline mask crosses(struct flat a, struct flat b, struct flat at) {
    const mask order = a.y < b.y;
    const struct flat low = {lane_select(order, a.x, b.x), lane_select(order, a.y, b.y)};
    const struct flat high = {lane_select(order, b.x, a.x), lane_select(order, b.y, a.y)};
    const mask before = (at.x - low.x) * (high.y - low.y) < (at.y - low.y) * (high.x - low.x);
    return ((low.y > at.y) ^ (high.y > at.y)) & before;
}

/* The quadrilateral 0, L, z_(i+1), z_i; its side on the axis is crossed by no ray off the axis. */
static inline mask in_quadrilateral(const struct section *s, struct vec q, struct flat at) {
    const struct flat begin = {lane_all(0), lane_all(0)}, end = {lane_all(s->length), lane_all(0)};
    const struct flat z0 = rim(s, 0, q), z1 = rim(s, 1, q);
    return crosses(end, z1, at) ^ crosses(z1, z0, at) ^ crosses(z0, begin, at);
}

/* The rest of the answer; q is 0 on the axis, and of points that are far and may be no numbers. */
static inline mask decide(const struct section *s, const struct probe *probe, struct vec *q) {
    const lane y = lane_sqrt(probe->square);
    const mask on = y < on_axis;
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    *q = vec_select(on | ~probe->in, none, scale(1 / y, probe->away));
    const mask along = (probe->x >= 0) & (probe->x < s->length);
    const mask inside = in_quadrilateral(s, *q, (struct flat){probe->x, y});
    return probe->in & ((on & along) | (~on & inside));
}

unsigned section_find(const struct section *s, const double *const point[SECTION_POINTS],
                      struct section_places *places) {
    const struct probe probe = probe_points(s, vec_of(point));
    struct vec q;
    const unsigned in = mask_bits(decide(s, &probe, &q));
    store(places->x, 0, probe.x);
    store(places->q[0], 0, q.x);
    store(places->q[1], 0, q.y);
    store(places->q[2], 0, q.z);
    return in;
}

int section_contains(const struct section *s, const double point[3], struct section_place *place) {
    const double *points[SECTION_POINTS];
    for (int k = 0; k < SECTION_POINTS; k++)
        points[k] = point;
    struct section_places places;
    if (!s->usable || !(section_find(s, points, &places) & 1))
        return 0;
    *place = (struct section_place){places.x[0], {places.q[0][0], places.q[1][0], places.q[2][0]}};
    return 1;
}

void section_search(const struct section *s, struct grid_search *search) {
    *search = (struct grid_search){.reach = s->reach, .length = s->length, .slack = s->wedge};
    memcpy(search->from, s->strand->p[s->index], sizeof search->from);
    memcpy(search->axis, s->t, sizeof s->t);
    memcpy(search->side, s->lean, sizeof s->lean);
    memcpy(search->low, s->low, sizeof s->low);
    memcpy(search->high, s->high, sizeof s->high);
}
