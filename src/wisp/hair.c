#include "hair.h"

#include "base/hash.h"
#include "base/vector.h"
#include "section.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <stdlib.h>
#include <string.h>

/* In radii of the undeformed section (the thesis, figure 4.2). */
static const double spread = 0.35;  /* of both coordinates */
static const double shift = 0.02;   /* from one plane to the next */
static const double shortest = 0.9; /* of the wisp's length */

/* --- places --- */

/* Adding 0 makes one zero of the two. */
static uint64_t hash_number(uint64_t hash, double x) {
    x += 0;
    return hash_add(hash, &x, sizeof x);
}

/* 32 bits are what the generator takes. */
static unsigned long identity(const struct wisp *wisp, double seed) {
    uint64_t hash = hash_number(HASH_START, seed);
    for (int k = 0; k < 3; k++)
        hash = hash_number(hash, wisp->root[k]);
    for (int k = 0; k < 3; k++)
        hash = hash_number(hash, wisp->direction[k]);
    hash = hash_number(hash, wisp->length);
    return (unsigned long)((hash >> 32) ^ (hash & 0xffffffffu));
}

/* A Gaussian step from `from`, drawn again where it leaves the disc. */
static void draw_place(gsl_rng *random, const double from[2], double sigma, double place[2]) {
    do {
        for (int k = 0; k < 2; k++)
            place[k] = from[k] + gsl_ran_gaussian(random, sigma);
    } while (place[0] * place[0] + place[1] * place[1] > 1);
}

/* Hair by hair, so that the first of them do not depend on how many there are. */
static void draw_hairs(gsl_rng *random, const struct wisp *wisp, struct hairs *hairs) {
    static const double centre[2] = {0, 0};
    for (int i = 0; i < hairs->count; i++) {
        double(*place)[2] = hairs->place + (size_t)i * (size_t)hairs->nodes;
        draw_place(random, centre, spread, place[0]);
        hairs->length[i] = wisp->length * (shortest + (1 - shortest) * gsl_rng_uniform(random));
        for (int node = 1; node < hairs->nodes; node++)
            draw_place(random, place[node - 1], shift, place[node]);
    }
}

struct hairs *hairs_create(const struct wisp *wisp, double seed, int count) {
    const size_t hairs_many = (size_t)count, places = hairs_many * (size_t)wisp->nodes;
    struct hairs *hairs = malloc(sizeof *hairs + (2 * places + hairs_many) * sizeof(double));
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!hairs || !random) {
        free(hairs);
        gsl_rng_free(random);
        return NULL;
    }
    double *numbers = (double *)(hairs + 1);
    *hairs = (struct hairs){count, wisp->nodes, (double(*)[2])numbers, numbers + 2 * places};
    gsl_rng_set(random, identity(wisp, seed));
    draw_hairs(random, wisp, hairs);
    gsl_rng_free(random);
    return hairs;
}

void hairs_free(struct hairs *hairs) {
    free(hairs);
}

/* --- subdivision: every second hair goes with the second child --- */

static const unsigned deepest = 31, none = ~0u; /* bits of a hair's number; a path that none has */

void hair_share_split(struct hair_share *parent_and_first, struct hair_share *second) {
    *second = *parent_and_first;
    if (parent_and_first->level == deepest) {
        second->path = none; /* one hair at most is left to share out */
        return;
    }
    second->path |= 1u << second->level;
    parent_and_first->level = ++second->level;
}

int hair_share_has(struct hair_share share, int hair) {
    return ((unsigned)hair & ((1u << share.level) - 1)) == share.path;
}

/* --- in the section --- */

/* A place as first a_j + second a_(j+1), j being the sample before it or a guess that is one off.
 */
struct wedge {
    int j, next;
    double way[2][2];     /* a_j and a_(j+1) */
    double first, second; /* none is negative in the wedge that has the place */
};

/* Barycentric coordinates with the plane's origin as third base (figure 4.5 of the thesis). What
 * one wedge has as `first` its neighbour has as `second` with the other sign, to the bit. */
static void split(int samples, int j, const double place[2], struct wedge *w) {
    w->j = (j + samples) % samples;
    w->next = (w->j + 1) % samples;
    wisp_sample_way(samples, w->j, w->way[0]);
    wisp_sample_way(samples, w->next, w->way[1]);
    const double *a = w->way[0], *b = w->way[1], sine = a[0] * b[1] - a[1] * b[0];
    w->first = (place[0] * b[1] - place[1] * b[0]) / sine;
    w->second = (a[0] * place[1] - a[1] * place[0]) / sine;
}

static struct wedge wedge_of(int samples, const double place[2]) {
    const double turn = atan2(place[1], place[0]) / (2 * M_PI); /* from -1/2 to 1/2 */
    struct wedge w;
    split(samples, (int)floor(turn * samples), place, &w);
    if (w.first < 0)
        split(samples, w.j + 1, place, &w);
    else if (w.second < 0)
        split(samples, w.j - 1, place, &w);
    return w;
}

/* Each of a place's two parts grows with the sample on whose line it is (figure 4.6): with four
 * samples, each of its coordinates (figure 4.4). */
void hair_position(const struct strand *strand, int node, const double place[2],
                   double position[2]) {
    const struct wedge w = wedge_of(strand->wisp->samples, place);
    const double first = w.first * section_radius(strand, node, w.j),
                 second = w.second * section_radius(strand, node, w.next);
    for (int k = 0; k < 2; k++)
        position[k] = first * w.way[0][k] + second * w.way[1][k];
}

void hair_controls(const struct strand *strand, const double (*place)[2], double (*controls)[3]) {
    for (int i = 0; i < strand->wisp->nodes; i++) {
        double position[2];
        hair_position(strand, i, place[i], position);
        for (int k = 0; k < 3; k++)
            controls[i][k] = strand->p[i][k] + position[0] * strand->axis_u[i][k] +
                             position[1] * strand->axis_v[i][k];
    }
}

/* --- the curve --- */

/* A span from p1 to p2 as c0 + s (c1 + s (c2 + s c3)), 0 <= s <= 1: slopes (p2 - p0) / 2 and
 * (p3 - p1) / 2 at its ends (Catmull & Rom 1974). */
static void span_cubic(const double (*controls)[3], int count, int span, double c[4][3]) {
    const double *p0 = controls[span > 0 ? span - 1 : 0], *p1 = controls[span],
                 *p2 = controls[span + 1], *p3 = controls[span + 2 < count ? span + 2 : count - 1];
    for (int k = 0; k < 3; k++) {
        c[0][k] = p1[k];
        c[1][k] = 0.5 * (p2[k] - p0[k]);
        c[2][k] = p0[k] - 2.5 * p1[k] + 2 * p2[k] - 0.5 * p3[k];
        c[3][k] = 0.5 * (p3[k] - p0[k]) + 1.5 * (p1[k] - p2[k]);
    }
}

int hair_curve(const double (*controls)[3], int count, int pieces, double length,
               double (*points)[3], double *end) {
    double left = length;
    int n = 1;
    memcpy(points[0], controls[0], sizeof points[0]);
    for (int span = 0; span + 1 < count; span++) {
        double c[4][3];
        span_cubic(controls, count, span, c);
        for (int i = 1; i <= pieces; i++, n++) {
            const double s = (double)i / pieces;
            double piece[3];
            for (int k = 0; k < 3; k++) {
                points[n][k] = i < pieces ? c[0][k] + s * (c[1][k] + s * (c[2][k] + s * c[3][k]))
                                          : controls[span + 1][k];
                piece[k] = points[n][k] - points[n - 1][k];
            }
            const double step = vector_length(piece);
            if (step > left) { /* the wisp is longer than the hair: it ends within this piece */
                memcpy(points[n], points[n - 1], sizeof points[n]);
                vector_add(points[n], left / step, piece);
                *end = span + (i - 1 + left / step) / pieces;
                return n + 1;
            }
            left -= step;
        }
    }
    *end = count - 1;
    return n;
}
