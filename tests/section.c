/* Whether a point is in a section, against the thesis's own definition (section 4.3.2): the point
 * is in one and only one of two triangles. */
#include "wisp/section.h"

#include "base/vector.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

enum { NODES = 5 };

/* A bent wisp with radii between 0.05 and `widest` R; turns up to about 2 `turn`. */
static struct strand *bent(struct wisp *wisp, int samples, double turn, double widest,
                           unsigned *seed) {
    *wisp = lab_wisp(NODES, samples, BENDING_NONE, seed);
    struct strand *s = lab_strand(wisp, WISP_GENERALISED);
    double along[3];
    memcpy(along, wisp->direction, sizeof along);
    for (int i = 0; i < NODES; i++) {
        if (i > 1)
            lab_turn(along, turn, seed);
        for (int k = 0; k < 3; k++)
            s->p[i][k] = i ? s->p[i - 1][k] + along[k] * wisp_spacing(wisp) : wisp->root[k];
        for (int j = 0; j < samples; j++)
            s->r[i * samples + j] = wisp->radius * lab_between(seed, 0.05, widest);
    }
    strand_refresh(s);
    return s;
}

/* --- the definition, written out --- */

/* The ellipse-like arc between the two samples beside a direction. */
static double arc(const struct strand *s, int node, const double d[3]) {
    const int samples = s->wisp->samples;
    double theta = atan2(vector_dot(d, s->axis_v[node]), vector_dot(d, s->axis_u[node]));
    if (theta < 0)
        theta += 2 * M_PI;
    int j = 0;
    while (j < samples - 1 && theta >= 2 * M_PI * (j + 1) / samples)
        j++;
    const double psi = (theta - 2 * M_PI * j / samples) * samples / 4;
    const double r0 = fmax(s->r[node * samples + j], 1e-3 * s->wisp->radius);
    const double r1 = fmax(s->r[node * samples + (j + 1) % samples], 1e-3 * s->wisp->radius);
    return 1 / sqrt(pow(cos(psi) / r0, 2) + pow(sin(psi) / r1, 2));
}

/* z of a node, as a point in space: from the node along the line that the plane through the axis
 * and X has in common with the bisector plane, on X's side. */
static void rim_point(const struct strand *s, int node, const double t[3], const double q[3],
                      double z[3]) {
    const double *w = s->axis_w[node];
    double normal[3] = {t[1] * q[2] - t[2] * q[1], t[2] * q[0] - t[0] * q[2],
                        t[0] * q[1] - t[1] * q[0]};
    double line[3] = {normal[1] * w[2] - normal[2] * w[1], normal[2] * w[0] - normal[0] * w[2],
                      normal[0] * w[1] - normal[1] * w[0]};
    const double side = vector_dot(line, q) > 0 ? 1 : -1, length = sqrt(vector_dot(line, line));
    for (int k = 0; k < 3; k++)
        line[k] *= side / length;
    const double rho = arc(s, node, line);
    for (int k = 0; k < 3; k++)
        z[k] = s->p[node][k] + rho * line[k];
}

struct plane_case {
    double corner[4][2], x[2]; /* p_i, p_i+1, z_i+1, z_i and the point, in the half-plane */
};

static void lay_out(const struct strand *s, int i, const double x[3], struct plane_case *flat) {
    double t[3], q[3], z[3], d[3];
    for (int k = 0; k < 3; k++)
        t[k] = s->p[i + 1][k] - s->p[i][k];
    const double length = sqrt(vector_dot(t, t));
    for (int k = 0; k < 3; k++) {
        t[k] /= length;
        d[k] = x[k] - s->p[i][k];
    }
    const double along = vector_dot(d, t);
    for (int k = 0; k < 3; k++)
        q[k] = d[k] - along * t[k];
    const double y = sqrt(vector_dot(q, q));
    for (int k = 0; k < 3; k++)
        q[k] /= y;
    *flat = (struct plane_case){.corner = {{0, 0}, {length, 0}}, .x = {along, y}};
    for (int end = 0; end < 2; end++) {
        rim_point(s, i + end, t, q, z);
        for (int k = 0; k < 3; k++)
            d[k] = z[k] - s->p[i][k];
        flat->corner[3 - end][0] = vector_dot(d, t);
        flat->corner[3 - end][1] = vector_dot(d, q);
    }
}

static double turn_of(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static int in_triangle(const double a[2], const double b[2], const double c[2], const double x[2]) {
    const double ab = turn_of(a, b, x), bc = turn_of(b, c, x), ca = turn_of(c, a, x);
    return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

static int in_one_of_two(const struct plane_case *f) {
    return in_triangle(f->corner[0], f->corner[1], f->corner[2], f->x) !=
           in_triangle(f->corner[0], f->corner[2], f->corner[3], f->x);
}

/* The parity of crossings with the border along a ray in any direction is the same. */
static int odd_along(const struct plane_case *f, double angle) {
    const double d[2] = {cos(angle), sin(angle)};
    int odd = 0;
    for (int i = 0; i < 4; i++) {
        const double *a = f->corner[i], *b = f->corner[(i + 1) % 4];
        const double sa = d[0] * (a[1] - f->x[1]) - d[1] * (a[0] - f->x[0]);
        const double sb = d[0] * (b[1] - f->x[1]) - d[1] * (b[0] - f->x[0]);
        if ((sa > 0) == (sb > 0))
            continue;
        const double s = sa / (sa - sb);
        odd ^= d[0] * (a[0] + s * (b[0] - a[0]) - f->x[0]) +
                   d[1] * (a[1] + s * (b[1] - a[1]) - f->x[1]) >
               0;
    }
    return odd;
}

/* How near the point is to a border or to the diagonal, where roundings decide. */
static double clearance(const struct plane_case *f) {
    static const int edges[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}};
    double least = INFINITY;
    for (int e = 0; e < 5; e++) {
        const double *a = f->corner[edges[e][0]], *b = f->corner[edges[e][1]];
        const double length = hypot(b[0] - a[0], b[1] - a[1]);
        least = fmin(least, fabs(turn_of(a, b, f->x)) / fmax(length, 1e-30));
    }
    return least;
}

/* Concave, or with edges that cross. */
static int turns_both_ways(const struct plane_case *f) {
    int left = 0, right = 0;
    for (int i = 0; i < 4; i++) {
        const double turn = turn_of(f->corner[i], f->corner[(i + 1) % 4], f->corner[(i + 2) % 4]);
        left += turn > 0;
        right += turn < 0;
    }
    return left && right;
}

/* --- tests --- */

/* Anywhere in the box, but mostly about the axis. */
static void random_point(const struct section *section, unsigned *seed, double x[3]) {
    const double pull = lab_between(seed, 0, 1), at = lab_between(seed, -0.5, 1.5);
    for (int k = 0; k < 3; k++)
        x[k] = pull * lab_between(seed, section->low[k], section->high[k]) +
               (1 - pull) *
                   (section->strand->p[section->index][k] + at * section->length * section->t[k]);
}

Test(section, agrees_with_one_and_only_one_of_two_triangles) {
    unsigned seed = 81;
    for (int samples = 3; samples <= 8; samples++) {
        int inside = 0, outside = 0, bent_over = 0;
        for (int repeat = 0; repeat < 300; repeat++) {
            struct wisp wisp;
            struct strand *s =
                bent(&wisp, samples, 0.1 + repeat % 3 * 0.5, 3 + repeat % 4 * 4, &seed);
            for (int i = 1; i < NODES - 1; i++) {
                struct section section;
                struct section_place place;
                struct plane_case flat;
                section_make(&section, s, i);
                for (int trial = 0; trial < 50 && section.usable; trial++) {
                    double x[3];
                    random_point(&section, &seed, x);
                    lay_out(s, i, x, &flat);
                    if (clearance(&flat) < 1e-12)
                        continue;
                    const int in = section_contains(&section, x, &place);
                    cr_assert_eq(in, in_one_of_two(&flat), "M = %d: %d by triangles", samples, !in);
                    cr_assert_eq(in, odd_along(&flat, lab_between(&seed, 0, 6)),
                                 "M = %d: %d by another ray", samples, !in);
                    inside += in;
                    outside += !in;
                    bent_over += in && turns_both_ways(&flat);
                }
            }
        }
        cr_assert(inside > 3000 && outside > 3000 && bent_over > 100,
                  "M = %d: %d inside, %d outside, %d concave or crossed", samples, inside, outside,
                  bent_over);
    }
}

/* A straight section is a cylinder over the curve through its samples. */
static void check_straight(int samples, double theta, double rho, const double *r) {
    struct wisp wisp = {
        .nodes = 4, .samples = samples, .length = 3, .radius = 0.5, .direction = {1, 0, 0}};
    struct strand *s = lab_strand(&wisp, WISP_GENERALISED);
    struct section section;
    struct section_place place;
    for (int i = 0; i < 4; i++) {
        s->p[i][0] = i;
        memcpy(s->r + i * samples, r, (size_t)samples * sizeof *r);
    }
    strand_refresh(s);
    section_make(&section, s, 2);
    for (int k = -1; k <= 1; k += 2) {
        const double y = rho * (1 + k * 1e-12);
        double x[3] = {2.3, 0, 0};
        for (int c = 1; c < 3; c++)
            x[c] = y * (cos(theta) * s->axis_u[2][c] + sin(theta) * s->axis_v[2][c]);
        cr_assert_eq(section_contains(&section, x, &place),
                     k<0, "theta %g: %d at %.15g", theta, k> 0, y);
        cr_assert(k > 0 ||
                      (fabs(place.x - 0.3) < 1e-15 && fabs(vector_dot(place.q, x) - y) < 1e-14),
                  "the place is wrong");
    }
}

Test(section, four_samples_are_quarters_of_ellipses) {
    const double r[4] = {0.4, 0.1, 0.2, 0.9};
    for (int i = 0; i < 64; i++) {
        const double theta = 2 * M_PI * (i + 0.37) / 64;
        const double a = cos(theta) > 0 ? r[0] : r[2], b = sin(theta) > 0 ? r[1] : r[3];
        check_straight(4, theta, a * b / hypot(b * cos(theta), a * sin(theta)), r);
    }
}

Test(section, the_rim_goes_through_every_sample) {
    static const double r[8] = {0.4, 0.1, 0.2, 0.9, 0.3, 0.35, 0.05, 0.6};
    for (int samples = 3; samples <= 8; samples++)
        for (int j = 0; j < samples; j++)
            check_straight(samples, 2 * M_PI * j / samples + 1e-14, r[j], r);
}

Test(section, a_point_on_the_axis_is_in_one_section_only) {
    struct wisp wisp = {
        .nodes = 6, .samples = 4, .length = 5, .radius = 0.5, .direction = {0, 0, 1}};
    struct strand *s = lab_strand(&wisp, WISP_GENERALISED);
    for (int i = 0; i < 6; i++)
        s->p[i][2] = i;
    for (int i = 0; i < 24; i++)
        s->r[i] = i % 3 ? -1 : 0; /* as thin as they count */
    strand_refresh(s);
    for (double z = 0.5; z <= 6; z += 0.5) {
        int in = 0;
        for (int i = 1; i < 5; i++) {
            struct section section;
            struct section_place place;
            section_make(&section, s, i);
            const int here = section_contains(&section, (const double[3]){0, 0, z}, &place);
            cr_assert(!here || vector_dot(place.q, place.q) == 0, "a direction from the axis");
            in += here;
            /* a thousandth of R counts where r is less */
            cr_assert_eq(section_contains(&section, (const double[3]){4.99e-4, 0, z}, &place), here,
                         "r < 0 is not taken for R/1000");
            cr_assert_not(section_contains(&section, (const double[3]){5.01e-4, 0, z}, &place));
        }
        cr_assert_eq(in, z >= 1 && z < 5, "%d sections have z = %g", in, z);
    }
}

/* Whatever is asked beside them: points are looked at several at a time. */
Test(section, what_is_no_number_or_far_is_in_none) {
    static const double far[] = {NAN, INFINITY, -INFINITY, 1e300, -1e160};
    struct wisp wisp = {
        .nodes = 5, .samples = 5, .length = 4, .radius = 0.5, .direction = {1, 0, 0}};
    struct strand *s = lab_strand(&wisp, WISP_GENERALISED);
    for (int i = 0; i < 5; i++)
        s->p[i][0] = i;
    for (int i = 0; i < 25; i++)
        s->r[i] = 0.5;
    strand_refresh(s);
    struct section section;
    section_make(&section, s, 2);
    for (size_t c = 0; c < sizeof far / sizeof *far; c++)
        for (int k = 0; k < 3; k++) {
            const double in[3] = {2.5, 0.1, 0.1};
            double out[3] = {2.5, 0.1, 0.1};
            const double *points[SECTION_POINTS];
            struct section_places places;
            unsigned expected = 0;
            out[k] = far[c];
            for (int i = 0; i < SECTION_POINTS; i++) {
                points[i] = i % 3 ? in : out;
                expected |= (unsigned)(i % 3 > 0) << i;
            }
            cr_assert_eq(section_find(&section, points, &places), expected, "%g along axis %d",
                         far[c], k);
        }
}

/* Sections that lean on a plane, have no length, or are far out: nothing in them, all finite. */
Test(section, sections_without_a_shape_contain_nothing) {
    struct wisp wisp = {
        .nodes = 5, .samples = 5, .length = 4, .radius = 0.5, .direction = {1, 0, 0}};
    static const double tails[][3][3] = {
        {{0.01, 0.01, 0}, {-1, 0.1, 0}, {-2, 0.1, 0}}, /* turns back by nearly pi */
        {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},             /* onto node 0: back exactly */
        {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}},             /* no length at all */
        {{2, 0, 0}, {2, 0, 0}, {2, 0, 0}},
        {{1e200, 0, 0}, {-1e200, 1e200, 0}, {0, 0, 1e308}},
        {{2, 0, 0}, {1.005, 0.0998, 0}, {0.01, 0.1996, 0}}, /* leans by 0.05, within the 0.1 */
        {{1e-200, 0, 0}, {2e-200, 0, 0}, {0, 3e-320, 0}},
    };
    for (size_t c = 0; c < sizeof tails / sizeof *tails; c++) {
        struct strand *s = lab_strand(&wisp, WISP_GENERALISED);
        s->p[1][0] = 1;
        memcpy(s->p[2], tails[c], sizeof tails[c]);
        for (int i = 0; i < 25; i++)
            s->r[i] = 0.5;
        strand_refresh(s);
        for (int i = 0; i < 25; i++)
            for (int k = 0; k < 3; k++)
                cr_assert(isfinite(s->e[i][k]) && isfinite(s->ev[i][k]), "case %zu: not finite", c);
        for (int i = 1; i < 4; i++) {
            struct section section;
            struct section_place place;
            section_make(&section, s, i);
            double t[3];
            for (int k = 0; k < 3; k++)
                t[k] = s->p[i + 1][k] - s->p[i][k];
            const double length = sqrt(vector_dot(t, t));
            const int sound = length > 0 && isfinite(length) &&
                              vector_dot(t, s->axis_w[i]) >= 0.1 * length &&
                              vector_dot(t, s->axis_w[i + 1]) >= 0.1 * length;
            cr_assert_eq(section.usable, sound, "case %zu, section %d", c, i);
            if (!sound)
                cr_assert_not(section_contains(&section, s->p[i], &place));
        }
    }
}
