/* Hair on a scalp: even, outside, along the normals, and as a scene's wisps. */
#include "wisp/scalp.h"

#include "base/vector.h"
#include "scene/scene_load.h"
#include "wisp/ellipsoid.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 3000 };

static const struct body shapes[] = {
    {.radii = {0.1, 0.1, 0.1}, .offset = 1e-4},
    {.centre = {0.3, -0.2, 0.1}, .radii = {0.075, 0.115, 0.095}, .offset = 1e-3},
    {.centre = {-5, 3, 2}, .radii = {1, 2, 3}},
    {.centre = {0, 0, 1e3}, .radii = {0.3, 0.1, 0.1}, .offset = 1e-2},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static const double crowns[][3] = {{0, 1, -1}, {0, 0, 1}, {1, 0, 0}, {0.3, -0.7, 0.2}};
enum { CROWNS = sizeof crowns / sizeof *crowns };

static double points[MOST][3], normals[MOST][3];

static void place(const struct body *body, const double crown[3], int count) {
    cr_assert_eq(scalp_points(body, crown, count, points, normals), 0, "no memory");
}

/* x / R^2 is along the normal, and the surface is `offset` below the point. */
Test(scalp, points_are_outside_at_the_offset_along_the_normal) {
    for (int s = 0; s < SHAPES; s++)
        for (int c = 0; c < CROWNS; c++) {
            const struct body *b = &shapes[s];
            const double far = fabs(b->centre[0]) + fabs(b->centre[1]) + fabs(b->centre[2]) + 1;
            place(b, crowns[c], 500);
            for (int i = 0; i < 500; i++) {
                double x[3], y[3], along[3], level = 0, side = 0;
                for (int k = 0; k < 3; k++) {
                    x[k] = points[i][k] - b->centre[k];
                    y[k] = x[k] - b->offset * normals[i][k];
                    level += y[k] * y[k] / (b->radii[k] * b->radii[k]);
                    along[k] = y[k] / (b->radii[k] * b->radii[k]);
                    side += y[k] * crowns[c][k];
                }
                cr_assert(!ellipsoid_contains(b->radii, x), "shape %d: point %d is inside", s, i);
                cr_assert(fabs(level - 1) <= 1e-13 * far / b->radii[1], "shape %d: level %g", s,
                          level - 1);
                cr_assert(fabs(vector_dot(along, normals[i]) / sqrt(vector_dot(along, along)) -
                               1) <= 1e-9 * far,
                          "shape %d: point %d has another normal", s, i);
                cr_assert(fabs(vector_dot(normals[i], normals[i]) - 1) <= 1e-15);
                cr_assert(side > 0, "shape %d: point %d is beyond the plane", s, i);
            }
        }
}

/* The share of the scalp's area on one side of a plane, by latitudes and longitudes about the
 * axes: dA = sqrt(sum (y_k / R_k)^2) R_1 R_2 R_3 d(cos) d(angle). */
static double area_share(const struct body *b, const double crown[3], const double d[3],
                         double beyond) {
    enum { N = 300 };
    double all = 0, part = 0;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            const double z = (2 * i + 1.) / N - 1, angle = 2 * M_PI * (j + 0.5) / N;
            const double y[3] = {sqrt(1 - z * z) * cos(angle), sqrt(1 - z * z) * sin(angle), z};
            double x[3], n[3];
            for (int k = 0; k < 3; k++) {
                x[k] = b->radii[k] * y[k];
                n[k] = y[k] / b->radii[k];
            }
            const double area = vector_dot(x, crown) > 0 ? sqrt(vector_dot(n, n)) : 0;
            all += area;
            part += vector_dot(x, d) > beyond ? area : 0;
        }
    return part / all;
}

/* As many points are beyond a plane as area is. */
Test(scalp, every_point_has_as_much_area) {
    unsigned seed = 17;
    for (int s = 0; s < SHAPES; s++)
        for (int c = 0; c < CROWNS; c++) {
            const struct body *b = &shapes[s];
            place(b, crowns[c], MOST);
            for (int i = 0; i < 6; i++) {
                const double d[3] = {lab_between(&seed, -1, 1), lab_between(&seed, -1, 1),
                                     lab_between(&seed, -1, 1)};
                const double beyond = lab_between(&seed, -0.3, 0.3) * b->radii[i % 3];
                int count = 0;
                for (int p = 0; p < MOST; p++) {
                    double x[3];
                    for (int k = 0; k < 3; k++)
                        x[k] = points[p][k] - b->centre[k] - b->offset * normals[p][k];
                    count += vector_dot(x, d) > beyond;
                }
                const double share = area_share(b, crowns[c], d, beyond);
                /* both have errors of some 1e-3 */
                cr_assert(fabs((double)count / MOST - share) <= 5e-3,
                          "shape %d, crown %d: %g of the points on %g of the area", s, c,
                          (double)count / MOST, share);
            }
        }
}

/* Area of the scalp: half of the ellipsoid's, by Knud Thomsen's formula (within 1.1 %). */
static double scalp_area(const double r[3]) {
    const double p = 1.6075;
    return 2 * M_PI *
           pow((pow(r[0] * r[1], p) + pow(r[0] * r[2], p) + pow(r[1] * r[2], p)) / 3, 1 / p);
}

/* In a hexagonal pattern each point is 1.07 sqrt(area each) from its neighbours. */
Test(scalp, neighbours_are_evenly_far) {
    static const int counts[] = {30, 100, 400};
    for (int s = 0; s < SHAPES; s++)
        for (int n = 0; n < 3; n++) {
            const struct body *b = &shapes[s];
            const double each = sqrt(scalp_area(b->radii) / counts[n]);
            double least = INFINITY, most = 0;
            place(b, crowns[0], counts[n]);
            for (int i = 0; i < counts[n]; i++) {
                double nearest = INFINITY;
                for (int j = 0; j < counts[n]; j++) {
                    double d[3];
                    for (int k = 0; k < 3; k++)
                        d[k] = points[i][k] - points[j][k];
                    nearest = i == j ? nearest : fmin(nearest, sqrt(vector_dot(d, d)));
                }
                least = fmin(least, nearest / each);
                most = fmax(most, nearest / each);
            }
            cr_log_info("shape %d, %d points: neighbours at %g to %g", s, counts[n], least, most);
            cr_assert(least > 0.55 && most < 1.25, "shape %d, %d points: neighbours at %g to %g", s,
                      counts[n], least, most);
        }
}

Test(scalp, the_same_arguments_give_the_same_points) {
    place(&shapes[1], crowns[3], 200);
    double(*again)[3] = test_room(400 * sizeof *again);
    const double longer[3] = {30, -70, 20};
    cr_assert(again);
    memcpy(again, points, 200 * sizeof *again);
    memcpy(again + 200, normals, 200 * sizeof *again);
    place(&shapes[1], crowns[3], 200);
    cr_assert(memcmp(again, points, 200 * sizeof *again) == 0);
    cr_assert(memcmp(again + 200, normals, 200 * sizeof *again) == 0);
    place(&shapes[1], longer, 200); /* the crown is a direction */
    for (int i = 0; i < 200; i++)
        for (int k = 0; k < 3; k++)
            cr_assert(fabs(points[i][k] - again[i][k]) <= 1e-14);
}

/* --- in scenes --- */

#define HEAD                                                                               \
    "{ name=\"head\"; center=[0.1, 0.0, 0.0]; radii=[0.075, 0.115, 0.095]; friction=1.0;"  \
    "  elasticity=0.0; offset=1e-3; }, { name=\"ball\"; center=[1, 0, 0]; radii=[1, 2, 3]" \
    "; friction=1.0; elasticity=0.0; offset=1e-3; }"
#define ON_HEAD "{ scalp=\"head\"; count=50; length=0.2; nodes=5; }"
#define SINGLE  "{ root=[0, 1, 0]; direction=[0, 1, 0]; length=0.2; nodes=5; }"

Test(scalp, wisps_of_a_scene) {
    const char *body = "body=(" HEAD ")", *far = "body.[1].center=[5, 0, 0]";
    struct scene *scene = LAB_LOAD("swing-envelope", body, far, "wisps=(" ON_HEAD "," SINGLE ")");
    struct scene *other = LAB_LOAD("swing-envelope", body, far, "wisps=(" SINGLE "," ON_HEAD ")");
    cr_assert(scene->wisp_count == 51 && other->wisp_count == 51);
    cr_assert(memcmp(scene->wisps, other->wisps + 1, 50 * sizeof *scene->wisps) == 0,
              "they depend on what else is in the file");
    for (int i = 0; i < 50; i++) {
        const struct wisp *w = &scene->wisps[i];
        cr_assert(w->nodes == 5 && w->length == 0.2 && w->radius == 0.02);
        for (int b = 0; b < 2; b++)
            for (int node = 0; node < 2; node++) {
                double x[3];
                for (int k = 0; k < 3; k++)
                    x[k] = w->root[k] + node * 0.05 * w->direction[k] - scene->bodies[b].centre[k];
                cr_assert(!ellipsoid_contains(scene->bodies[b].radii, x), "wisp %d is inside", i);
            }
    }
}

Test(scalp, what_is_wrong_is_refused) {
    static const struct {
        const char *entry, *says[2];
    } bad[] = {
        {"{ scalp=\"hat\"; count=5; length=0.2; nodes=5; }",
         {"scalp: no body 'hat'", "head, ball"}},
        {"{ scalp=3; count=5; length=0.2; nodes=5; }", {"scalp", "text"}},
        {"{ scalp=\"head\"; length=0.2; nodes=5; }", {"count", "missing"}},
        {"{ scalp=\"head\"; count=2.5; length=0.2; nodes=5; }", {"count", "whole"}},
        {"{ scalp=\"head\"; count=0; length=0.2; nodes=5; }", {"count", "whole"}},
        {"{ scalp=\"head\"; count=-3; length=0.2; nodes=5; }", {"count", "whole"}},
        {"{ scalp=\"head\"; count=1e9; length=0.2; nodes=5; }", {"count", "100000"}},
        {"{ scalp=\"head\"; count=5; nodes=5; }", {"length", "missing"}},
        {"{ scalp=\"head\"; count=5; length=0.2; }", {"nodes", "missing"}},
        {"{ scalp=\"head\"; count=5; length=0.2; nodes=5; root=[0, 0, 0]; }", {"root", "scalp"}},
        {"{ scalp=\"head\"; count=5; length=0.2; nodes=5; direction=[0, 0, 1]; }",
         {"direction", "scalp"}},
        {"{ scalp=\"head\"; count=5; length=0.2; nodes=5; grid=[2, 2]; }", {"grid", "scalp"}},
        {"{ scalp=\"head\"; count=5; length=0.2; nodes=5; spacing=0.1; }", {"spacing", "grid"}},
        {"{ scalp=\"head\"; count=5; length=0.2; nodes=5; crown=[0, 0, 0]; }",
         {"crown", "no length"}},
        {"{ scalp=\"head\"; count=5; length=0.2; nodes=5; crown=[0, 1]; }", {"crown", "3 numbers"}},
        {"{ count=5; root=[0, 0, 0]; direction=[0, 0, 1]; length=0.2; nodes=5; }",
         {"count", "scalp"}},
        {"{ crown=[0, 0, 1]; root=[0, 0, 0]; direction=[0, 0, 1]; length=0.2; nodes=5; }",
         {"crown", "scalp"}},
        {ON_HEAD, {"wisp 1 of 50 starts in the body 'ball'", "crown"}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *sets[] = {"body=(" HEAD ")", printed("wisps=(%s)", bad[i].entry)};
        lab_refuse("swing-envelope", sets, 2, bad[i].says, 2);
    }
    LAB_REFUSE("swing-envelope", "wisps=(" ON_HEAD ")", "none, add body"); /* a scalp of nobody */
}
