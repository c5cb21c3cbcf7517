/* Hairs: where they are in a wisp, the curves through these places, and the light on them. */
#include "wisp/hair.h"

#include "base/vector.h"
#include "picture/shade.h"
#include "wisp/section.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct hairs *make(const struct wisp *wisp, double seed, int count) {
    struct hairs *hairs = hairs_create(wisp, seed, count);
    cr_assert(hairs, "no memory");
    return hairs;
}

/* --- places in the disc --- */

/* |sum / n - mean| within five standard errors, the variance of one being given. */
static void near_mean(double sum, double n, double mean, double variance, const char *what) {
    const double error = fabs(sum / n - mean), allowed = 5 * sqrt(variance / n);
    cr_expect(error <= allowed, "%s: %g is %g from %g, more than %g", what, sum / n, error, mean,
              allowed);
}

/* A Gaussian cut off at the unit circle: r^2 is exponential with mean 2 sigma^2 = m, cut off at 1,
 * so that P(r < s) = (1 - e^(-s^2/m)) / (1 - e^(-1/m)), and E[r^2] = m - 1 / (e^(1/m) - 1). */
Test(hair, places_are_gaussian_and_drawn_again_outside_the_disc) {
    enum { COUNT = 40000 };
    unsigned seed = 5;
    const struct wisp wisp = lab_wisp(4, 4, BENDING_NONE, &seed);
    struct hairs *hairs = make(&wisp, 1, COUNT);
    const double m = 2 * 0.35 * 0.35, square = m - 1 / (exp(1 / m) - 1);
    double x = 0, y = 0, xx = 0, xy = 0, within[9] = {0};
    for (int i = 0; i < COUNT; i++) {
        const double *p = hairs->place[i * 4], r = hypot(p[0], p[1]);
        x += p[0];
        y += p[1];
        xx += p[0] * p[0];
        xy += p[0] * p[1];
        for (int k = 0; k < 9; k++)
            within[k] += r < 0.1 * (k + 1);
        for (int node = 0; node < 4; node++)
            cr_assert(hypot(hairs->place[i * 4 + node][0], hairs->place[i * 4 + node][1]) <= 1);
    }
    near_mean(x, COUNT, 0, square / 2, "x");
    near_mean(y, COUNT, 0, square / 2, "y");
    near_mean(xx, COUNT, square / 2, 0.03, "x^2");
    near_mean(xy, COUNT, 0, 0.03, "x y");
    for (int k = 0; k < 9; k++) {
        const double s = 0.1 * (k + 1), p = (1 - exp(-s * s / m)) / (1 - exp(-1 / m));
        near_mean(within[k], COUNT, p, p * (1 - p), "within a circle");
    }
    hairs_free(hairs);
}

/* From plane to plane a place walks on: two steps have twice the variance of one. */
Test(hair, places_walk_from_plane_to_plane) {
    enum { COUNT = 20000, NODES = 12 };
    unsigned seed = 6;
    const struct wisp wisp = lab_wisp(NODES, 4, BENDING_NONE, &seed);
    struct hairs *hairs = make(&wisp, 2, COUNT);
    double sum[NODES] = {0}, n = 0;
    for (int i = 0; i < COUNT; i++) {
        const double(*p)[2] = (const double(*)[2])(hairs->place + (size_t)i * NODES);
        if (hypot(p[0][0], p[0][1]) > 0.5)
            continue; /* far from the rim, which would turn steps back */
        n++;
        for (int node = 1; node < NODES; node++)
            sum[node] += pow(p[node][0] - p[0][0], 2) + pow(p[node][1] - p[0][1], 2);
    }
    for (int node = 1; node < NODES; node++) {
        const double expected = 2 * 0.02 * 0.02 * node;
        near_mean(sum[node], n, expected, expected * expected, "square of the way");
    }
    hairs_free(hairs);
}

Test(hair, lengths_are_even_from_nine_tenths_to_all) {
    enum { COUNT = 20000 };
    unsigned seed = 7;
    const struct wisp wisp = lab_wisp(3, 4, BENDING_NONE, &seed);
    struct hairs *hairs = make(&wisp, 3, COUNT);
    double tenth[10] = {0};
    for (int i = 0; i < COUNT; i++) {
        const double part = hairs->length[i] / wisp.length;
        cr_assert(part >= 0.9 && part <= 1);
        tenth[(int)fmin(9, (part - 0.9) * 100)]++;
    }
    for (int k = 0; k < 10; k++)
        near_mean(tenth[k], COUNT, 0.1, 0.09, "a tenth of the lengths");
    hairs_free(hairs);
}

static int same_places(const struct hairs *a, const struct hairs *b, int count) {
    return memcmp(a->place, b->place, (size_t)(count * a->nodes) * sizeof *a->place) == 0;
}

static int same(const struct hairs *a, const struct hairs *b, int count) {
    return same_places(a, b, count) &&
           memcmp(a->length, b->length, (size_t)count * sizeof *a->length) == 0;
}

/* They follow from seed, root, direction and length: from each of these, and from nothing else. */
Test(hair, a_wisp_has_the_same_hair_whatever_becomes_of_it) {
    unsigned seed = 8;
    const struct wisp wisp = lab_wisp(7, 4, BENDING_NONE, &seed);
    struct wisp other = wisp;
    struct hairs *hairs = make(&wisp, 1, 30), *again;
    other.hair_count /= 2;
    other.splits++;
    other.radius *= 2;
    other.stretch_stiffness = 1;
    again = make(&other, 1, 50);
    cr_expect(same(hairs, again, 30), "the first of many are not those of few");
    hairs_free(again);
    double *const numbers[] = {&other.root[2], &other.direction[1], &other.length};
    for (int i = 0; i < 3; i++) {
        other = wisp;
        *numbers[i] = nextafter(*numbers[i], 10);
        again = make(&other, 1, 30);
        cr_expect(!same_places(hairs, again, 1), "number %d makes no difference", i);
        hairs_free(again);
    }
    again = make(&wisp, 2, 30);
    cr_expect(!same_places(hairs, again, 1), "the seed makes no difference");
    hairs_free(again);
    hairs_free(hairs);
}

/* -0 and 0 are the same place. */
Test(hair, a_zero_has_no_sign) {
    unsigned seed = 9;
    struct wisp wisp = lab_wisp(3, 4, BENDING_NONE, &seed);
    wisp.root[0] = 0;
    struct hairs *hairs = make(&wisp, 1, 5);
    wisp.root[0] = -0.0;
    struct hairs *again = make(&wisp, 1, 5);
    cr_expect(same(hairs, again, 5));
    hairs_free(hairs);
    hairs_free(again);
}

/* --- subdivision --- */

/* However often who splits, each hair is one wisp's. */
Test(hair, children_share_the_hairs_of_their_parent) {
    enum { WISPS = 60, HAIRS = 200 };
    struct hair_share share[WISPS] = {{0, 0}};
    unsigned seed = 10;
    for (int count = 1; count < WISPS; count++) {
        const int parent = count < 40 ? 0 : (int)lab_between(&seed, 0, count);
        const struct hair_share before = share[parent];
        hair_share_split(&share[parent], &share[count]);
        for (int i = 0; i < HAIRS; i++) {
            int owners = 0;
            for (int k = 0; k <= count; k++)
                owners += hair_share_has(share[k], i);
            cr_assert_eq(owners, 1, "hair %d has %d wisps after %d splits", i, owners, count);
            cr_assert_eq(hair_share_has(share[parent], i) + hair_share_has(share[count], i),
                         hair_share_has(before, i));
        }
    }
}

Test(hair, twins_have_half_of_it_each) {
    struct hair_share first = {0, 0}, second;
    int has[2] = {0, 0};
    hair_share_split(&first, &second);
    for (int i = 0; i < 50; i++) {
        has[0] += hair_share_has(first, i);
        has[1] += hair_share_has(second, i);
    }
    cr_expect(has[0] == 25 && has[1] == 25, "%d and %d", has[0], has[1]);
}

/* --- in the section --- */

/* A strand at random, with radii from 0.0001 to 2 R. */
static struct strand *bent(struct wisp *wisp, int nodes, int samples, unsigned *seed) {
    *wisp = lab_wisp(nodes, samples, BENDING_NONE, seed);
    struct strand *s = lab_strand(wisp, WISP_GENERALISED);
    for (int i = 0; i < nodes; i++) {
        for (int k = 0; k < 3; k++)
            s->p[i][k] = wisp->root[k] + wisp_spacing(wisp) * (i * wisp->direction[k] +
                                                               lab_between(seed, -0.5, 0.5));
        for (int j = 0; j < samples; j++)
            s->r[i * samples + j] = wisp->radius * (j == 1 ? 1e-4 : lab_between(seed, 0.05, 2));
    }
    strand_refresh(s);
    return s;
}

/* Four samples: the envelope is a quarter of an ellipse between two of them. */
Test(hair, hairs_are_inside_the_envelope) {
    unsigned seed = 11;
    struct wisp wisp;
    struct strand *s = bent(&wisp, 8, 4, &seed);
    struct hairs *hairs = make(&wisp, 1, 500);
    for (int i = 0; i < 500; i++) {
        double controls[8][3];
        const double(*place)[2] = (const double(*)[2])(hairs->place + (size_t)i * 8);
        hair_controls(s, place, controls);
        for (int node = 0; node < 8; node++) {
            double from[3], u, v;
            memcpy(from, controls[node], sizeof from);
            vector_add(from, -1, s->p[node]);
            u = vector_dot(from, s->axis_u[node]) /
                section_radius(s, node, place[node][0] < 0 ? 2 : 0);
            v = vector_dot(from, s->axis_v[node]) /
                section_radius(s, node, place[node][1] < 0 ? 3 : 1);
            cr_assert(u * u + v * v <= 1 + 1e-9, "hair %d, node %d: outside", i, node);
            cr_assert(fabs(vector_dot(from, s->axis_w[node])) < 1e-15, "out of the plane");
            cr_assert(fabs(u - place[node][0]) + fabs(v - place[node][1]) < 1e-9, "hair %d", i);
        }
    }
    hairs_free(hairs);
}

/* On four samples each coordinate of a place grows with the sample on its side: to the bit. */
Test(hair, wedges_of_four_samples_are_quadrants) {
    unsigned seed = 12;
    struct wisp wisp;
    struct strand *s = bent(&wisp, 4, 4, &seed);
    for (int trial = 0; trial < 2000; trial++) {
        double place[2] = {lab_between(&seed, -1, 1), lab_between(&seed, -1, 1)}, x[2];
        if (trial % 10 == 0) /* hardly off an axis: the angle does not tell on which side */
            place[trial / 10 % 2] *= 1e-20;
        const double expected[2] = {place[0] * section_radius(s, 3, place[0] < 0 ? 2 : 0),
                                    place[1] * section_radius(s, 3, place[1] < 0 ? 3 : 1)};
        hair_position(s, 3, place, x);
        cr_assert(memcmp(x, expected, sizeof x) == 0, "(%g, %g): (%.17g, %.17g)", place[0],
                  place[1], x[0] - expected[0], x[1] - expected[1]);
    }
}

/* Any number of samples: what is f of the way to one sample and g of that to the next is so after
 * they have moved. */
Test(hair, places_keep_their_parts_along_the_samples_beside_them) {
    unsigned seed = 12;
    for (int samples = 3; samples <= 16; samples++) {
        struct wisp wisp;
        struct strand *s = bent(&wisp, 4, samples, &seed);
        for (int trial = 0; trial < 200; trial++) {
            const int j = trial % samples, next = (j + 1) % samples;
            const double f = trial % 7 ? lab_between(&seed, 0, 1) : 0,
                         g = trial % 5 ? lab_between(&seed, 0, 1) : 0;
            const double a = 2 * M_PI * j / samples, b = 2 * M_PI * (j + 1) / samples;
            const double place[2] = {f * cos(a) + g * cos(b), f * sin(a) + g * sin(b)};
            const double fr = f * section_radius(s, 3, j), gr = g * section_radius(s, 3, next);
            double x[2];
            hair_position(s, 3, place, x);
            cr_assert(hypot(x[0] - fr * cos(a) - gr * cos(b), x[1] - fr * sin(a) - gr * sin(b)) <
                          1e-14 * wisp.radius,
                      "%d samples: %g to sample %d and %g to the next", samples, f, j, g);
        }
    }
}

Test(hair, all_placements_agree_on_an_undeformed_section) {
    unsigned seed = 13;
    for (int samples = 3; samples <= 16; samples++) {
        struct wisp wisp;
        struct strand *s = bent(&wisp, 3, samples, &seed);
        for (int j = 0; j < samples; j++)
            s->r[2 * samples + j] = wisp.radius;
        for (int trial = 0; trial < 100; trial++) {
            const double place[2] = {lab_between(&seed, -1, 1), lab_between(&seed, -1, 1)};
            double x[2];
            hair_position(s, 2, place, x);
            cr_assert(hypot(x[0] - wisp.radius * place[0], x[1] - wisp.radius * place[1]) <
                      1e-15 * wisp.radius * 4);
        }
    }
}

/* --- the curve --- */

/* Barry and Goldman's pyramid (1988) for knots -1, 0, 1, 2: another way to the same spline. */
static double pyramid(const double p[4], double s) {
    double a[3], b[2];
    for (int i = 0; i < 3; i++)
        a[i] = (i - s) * p[i] + (s - i + 1) * p[i + 1];
    for (int i = 0; i < 2; i++)
        b[i] = ((i + 1 - s) * a[i] + (s - i + 1) * a[i + 1]) / 2;
    return (1 - s) * b[0] + s * b[1];
}

enum { CONTROLS = 7, PIECES = 5, POINTS = (CONTROLS - 1) * PIECES + 1 };

static void some_controls(double controls[CONTROLS][3], unsigned *seed) {
    for (int i = 0; i < CONTROLS; i++)
        for (int k = 0; k < 3; k++)
            controls[i][k] = lab_between(seed, -1, 1);
}

Test(hair, curves_are_catmull_rom_splines_through_their_points) {
    double controls[CONTROLS][3], points[POINTS][3], end;
    unsigned seed = 14;
    some_controls(controls, &seed);
    const int count =
        hair_curve((const double(*)[3])controls, CONTROLS, PIECES, INFINITY, points, &end);
    cr_assert_eq(count, POINTS);
    cr_assert_eq(end, CONTROLS - 1);
    for (int i = 0; i < POINTS; i++) {
        const int span = i / PIECES < CONTROLS - 1 ? i / PIECES : CONTROLS - 2;
        for (int k = 0; k < 3; k++) {
            const double p[4] = {controls[span > 0 ? span - 1 : 0][k], controls[span][k],
                                 controls[span + 1][k],
                                 controls[span + 2 < CONTROLS ? span + 2 : CONTROLS - 1][k]};
            const double expected = pyramid(p, (double)(i - span * PIECES) / PIECES);
            cr_assert(fabs(points[i][k] - expected) < 1e-14, "point %d", i);
            if (i % PIECES == 0)
                cr_assert_eq(points[i][k], controls[i / PIECES][k], "control %d", i / PIECES);
        }
    }
}

static double length_of(const double (*points)[3], int count) {
    double length = 0;
    for (int i = 1; i < count; i++) {
        double d[3] = {points[i][0], points[i][1], points[i][2]};
        vector_add(d, -1, points[i - 1]);
        length += vector_length(d);
    }
    return length;
}

/* At its own length, on the way of the whole curve; or where the wisp ends. */
Test(hair, a_hair_stops_at_its_length_or_at_the_end_of_the_wisp) {
    double controls[CONTROLS][3], whole[POINTS][3], points[POINTS][3], end;
    unsigned seed = 15;
    some_controls(controls, &seed);
    hair_curve((const double(*)[3])controls, CONTROLS, PIECES, INFINITY, whole, &end);
    const double all = length_of((const double(*)[3])whole, POINTS);
    for (int trial = 0; trial < 200; trial++) {
        const double length = all * lab_between(&seed, 0.001, 1.3);
        const int count =
            hair_curve((const double(*)[3])controls, CONTROLS, PIECES, length, points, &end);
        const double got = length_of((const double(*)[3])points, count);
        cr_assert(fabs(got - fmin(length, all)) < 1e-12, "%g of %g is %g long", length, all, got);
        cr_assert_eq(memcmp(points, whole, (size_t)(count - 1) * sizeof *points), 0);
        const int piece = (int)fmin(end * PIECES, POINTS - 2);
        cr_assert(length > all ? end == CONTROLS - 1 : piece == count - 2);
        for (int k = 0; k < 3; k++) {
            const double part = end * PIECES - piece;
            cr_assert(fabs(points[count - 1][k] -
                           (whole[piece][k] + part * (whole[piece + 1][k] - whole[piece][k]))) <
                          1e-12,
                      "the end is not where it is said to be");
        }
    }
}

/* A wisp whose nodes are in one place. */
Test(hair, a_curve_of_no_length_has_its_points) {
    double controls[3][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, points[7][3], end;
    cr_expect_eq(hair_curve((const double(*)[3])controls, 3, 3, 0.1, points, &end), 7);
    for (int i = 0; i < 7; i++)
        cr_expect_eq(memcmp(points[i], controls[0], sizeof points[i]), 0);
}

/* --- light --- */

static void unit(double a[3], unsigned *seed) {
    do {
        for (int k = 0; k < 3; k++)
            a[k] = lab_between(seed, -1, 1);
    } while (vector_length(a) > 1 || vector_length(a) < 0.1);
    const double length = vector_length(a);
    for (int k = 0; k < 3; k++)
        a[k] /= length;
}

/* What is left of a across t, as a unit vector. */
static double across(const double a[3], const double t[3], double rest[3]) {
    memcpy(rest, a, 3 * sizeof *rest);
    vector_add(rest, -vector_dot(a, t), t);
    const double length = vector_length(rest);
    for (int k = 0; k < 3; k++)
        rest[k] /= length;
    return length;
}

/* (reflection of the light at this normal) . eye */
static double reflected(const double n[3], const double light[3], const double eye[3]) {
    double reflection[3] = {-light[0], -light[1], -light[2]};
    vector_add(reflection, 2 * vector_dot(n, light), n);
    return vector_dot(reflection, eye);
}

/* The appendix word by word: project, take the bisector, reflect; and for the diffuse term look at
 * all normals for the brightest. */
Test(hair, light_is_that_of_the_best_normals) {
    unsigned seed = 16;
    for (int trial = 0; trial < 300; trial++) {
        double t[3], light[3], eye[3], l[3], e[3], other[3], n[3], best = 0;
        unit(t, &seed);
        unit(light, &seed);
        unit(eye, &seed);
        if (across(light, t, l) < 1e-3 || across(eye, t, e) < 1e-3)
            continue;
        vector_cross(t, l, other);
        for (int i = 0; i < 3600; i++) {
            double normal[3] = {0, 0, 0};
            vector_add(normal, cos(M_PI * i / 1800), l);
            vector_add(normal, sin(M_PI * i / 1800), other);
            best = fmax(best, vector_dot(normal, light));
        }
        for (int k = 0; k < 3; k++)
            n[k] = l[k] + e[k];
        const double length = vector_length(n);
        if (length < 1e-3)
            continue;
        for (int k = 0; k < 3; k++)
            n[k] /= length;
        const struct shine shine = shade_hair(t, light, eye, 1);
        cr_assert(fabs(shine.diffuse - best) < 1e-6, "%g, best %g", shine.diffuse, best);
        cr_assert(fabs(shine.specular - fmax(0, reflected(n, light, eye))) < 1e-12);
        cr_assert(fabs(shade_hair(t, light, eye, 7).specular - pow(shine.specular, 7)) < 1e-12);
    }
}

/* Where a projection vanishes, any perpendicular does; where the two are opposite, the one across
 * both. */
Test(hair, light_without_a_best_normal) {
    unsigned seed = 17;
    for (int trial = 0; trial < 50; trial++) {
        double t[3], a[3], n[3], opposite[3];
        unit(t, &seed);
        unit(a, &seed);
        across(a, t, n); /* any perpendicular */
        const struct shine along = shade_hair(t, t, a, 1), away = shade_hair(t, a, t, 1);
        cr_assert(along.diffuse < 1e-7);
        cr_assert(fabs(along.specular - fmax(0, reflected(n, t, a))) < 1e-7);
        double third[3];
        vector_cross(t, n, third);
        cr_assert(fabs(away.specular - fmax(0, reflected(third, a, t))) < 1e-7);
        for (int k = 0; k < 3; k++) /* the same along t, turned round across it */
            opposite[k] = -a[k] + 2 * vector_dot(a, t) * t[k];
        cr_assert(fabs(shade_hair(t, a, opposite, 1).specular -
                       fmax(0, reflected(third, a, opposite))) < 1e-12);
    }
}

Test(hair, light_across_a_hair_comes_back_to_its_source) {
    const double t[3] = {0, 1, 0}, light[3] = {0.6, 0, 0.8};
    const struct shine shine = shade_hair(t, light, light, 50);
    cr_expect(fabs(shine.diffuse - 1) < 1e-15 && fabs(shine.specular - 1) < 1e-13);
}
