/* Where points are in a picture, what bodies hide, and the order in which all is drawn. */
#include "picture/camera.h"

#include "base/hash.h"
#include "base/vector.h"
#include "picture/bodies.h"
#include "picture/picture.h"
#include "run/identity.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double y_axis[3] = {0, 1, 0};

/* Of a scene that wishes nothing. */
static struct render_settings render_defaults(void) {
    struct scene *scene = lab_load("swing", NULL, 0);
    const struct render_settings render = scene->render;
    return render;
}

/* At (0, 0, 2), looking down on the origin along -z, with a right angle from bottom to top: at a
 * distance of 2 it sees 4 m in 100 pixels of height. */
static struct camera by_hand(void) {
    struct render_settings render = render_defaults();
    render.has_eye = render.has_target = 1;
    render.eye[2] = 2;
    render.angle = M_PI / 2;
    return camera_make(&render, y_axis, 200, 100);
}

Test(camera, points_are_where_a_hand_made_camera_has_them) {
    static const struct {
        double point[3], place[3];
    } expected[] = {
        {{0, 0, 0}, {100, 50, 2}},  {{1, 0, 0}, {125, 50, 2}},        {{0, 1, 0}, {100, 75, 2}},
        {{1, 1, 1}, {150, 100, 1}}, {{-2, -0.5, -2}, {75, 43.75, 4}},
    };
    const struct camera camera = by_hand();
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        double place[3];
        cr_assert(camera_project(&camera, expected[i].point, place));
        for (int k = 0; k < 3; k++)
            cr_expect(fabs(place[k] - expected[i].place[k]) < 1e-12, "point %zu: %g, not %g", i,
                      place[k], expected[i].place[k]);
    }
}

Test(camera, what_is_behind_it_is_not_seen) {
    const struct camera camera = by_hand();
    double place[3];
    cr_expect(!camera_project(&camera, (const double[]){0, 0, 2}, place), "in the eye");
    cr_expect(!camera_project(&camera, (const double[]){0.5, 0.1, 3}, place), "behind");
    cr_expect(!camera_project(&camera, (const double[]){NAN, 0, 0}, place), "nowhere");
}

Test(camera, a_ray_goes_through_what_is_seen_there) {
    const struct camera camera = by_hand();
    unsigned seed = 3;
    for (int i = 0; i < 100; i++) {
        const double point[3] = {lab_between(&seed, -1, 1), lab_between(&seed, -1, 1),
                                 lab_between(&seed, -1, 1)};
        double place[3], ray[3], at[3];
        camera_project(&camera, point, place);
        camera_ray(&camera, place[0], place[1], ray);
        memcpy(at, camera.eye, sizeof at);
        vector_add(at, place[2], ray);
        for (int k = 0; k < 3; k++)
            cr_assert(fabs(at[k] - point[k]) < 1e-14);
    }
}

/* Any way upwards; straight down too, where it is up to the camera what is right. */
Test(camera, axes_are_unit_vectors_across_each_other) {
    unsigned seed = 4;
    for (int i = 0; i < 200; i++) {
        struct render_settings render = render_defaults();
        double upwards[3] = {lab_between(&seed, -1, 1), lab_between(&seed, -1, 1),
                             lab_between(&seed, -1, 1)};
        const double length = vector_length(upwards);
        for (int k = 0; k < 3; k++)
            upwards[k] = i < 3 ? k == i : i < 6 ? -(k == i - 3) : upwards[k] / length;
        render.has_eye = render.has_target = i % 2;
        memcpy(render.eye, upwards, sizeof upwards); /* above the target */
        const struct camera camera = camera_make(&render, upwards, 300, 200);
        const double *axes[3] = {camera.right, camera.up, camera.forward};
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                cr_assert(fabs(vector_dot(axes[a], axes[b]) - (a == b)) < 1e-14);
        double out[3];
        vector_cross(camera.right, camera.up, out);
        cr_assert(vector_dot(out, camera.forward) < -0.999, "a mirror image");
        if (!render.has_eye)
            cr_assert(vector_dot(camera.up, upwards) > 0.9 && camera.forward[2] < 0.95);
    }
}

/* The nearest place from which all is seen: nothing is outside, and two opposite sides, or, with
 * the middle given, one, are touched. */
Test(camera, it_finds_a_place_from_which_all_is_seen) {
    enum { COUNT = 50 };
    unsigned seed = 5;
    for (int trial = 0; trial < 100; trial++) {
        struct render_settings render = render_defaults();
        double p[COUNT][3], sides[4][3], most[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
        const double width = lab_between(&seed, 50, 500), height = lab_between(&seed, 50, 500);
        render.has_target = trial % 2;
        struct camera camera = camera_make(&render, y_axis, width, height);
        camera_sides(&camera, sides);
        for (int i = 0; i < COUNT; i++)
            for (int k = 0; k < 3; k++)
                p[i][k] = 0.3 + lab_between(&seed, -1, 1) * (k + 1);
        for (int i = 0; i < COUNT; i++)
            for (int d = 0; d < 4; d++)
                most[d] = fmax(most[d], vector_dot(p[i], sides[d]));
        camera_fit(&camera, &render, most);
        double reach[4] = {0}; /* right, left, up, down: of half the picture */
        for (int i = 0; i < COUNT; i++) {
            double place[3];
            cr_assert(camera_project(&camera, p[i], place));
            const double x = 2 * place[0] / width - 1, y = 2 * place[1] / height - 1;
            const double at[4] = {x, -x, y, -y};
            for (int d = 0; d < 4; d++)
                reach[d] = fmax(reach[d], at[d]);
        }
        int touched = 0;
        for (int d = 0; d < 4; d++) {
            cr_assert(reach[d] < 0.92 + 1e-9, "a point is %g off the middle", reach[d]);
            touched += reach[d] > 0.85;
        }
        cr_assert(touched >= (render.has_target ? 1 : 2), "%g %g %g %g: too far away", reach[0],
                  reach[1], reach[2], reach[3]);
        if (render.has_target) {
            double place[3];
            camera_project(&camera, render.target, place);
            cr_assert(fabs(place[0] - width / 2) + fabs(place[1] - height / 2) < 1e-9);
        }
    }
}

/* --- bodies --- */

static struct figure one_ellipsoid(void) {
    struct figure figure = {.count = 1};
    figure.body[0] = (struct figure_body){
        .radii = {0.5, 0.25, 1},
        .motion = {.centre = {0.1, 0, 0}, .axes = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}}};
    return figure;
}

/* Its radii of 0.5 and 0.25 are along y and x here. From the eye (0.1, 0, 5) straight at it. */
Test(camera, bodies_hide_what_is_behind_them) {
    const struct figure figure = one_ellipsoid();
    const double eye[3] = {0.1, 0, 5};
    const struct {
        double point[3];
        int hidden;
    } cases[] = {
        {{0.1, 0, 2}, 0},    {{0.1, 0, 1}, 0},  {{0.1, 0, 0.9}, 1}, {{0.1, 0, -3}, 1},
        {{0.4, 0, 0}, 0},    {{0.3, 0, 0}, 1},  {{0.1, 0.4, 0}, 1}, {{0.1, 0.6, 0}, 0},
        {{0.1, -0.4, 0}, 1}, {{0.36, 0, 0}, 0}, {{-0.14, 0, 0}, 1}, {{0.1, 0, 7}, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        cr_expect_eq(figure_hides(&figure, eye, cases[i].point), cases[i].hidden, "point %zu", i);
    for (int side = -1; side <= 1; side += 2) /* past its ends, across */
        for (double z = 0.05; z < 1.5; z += 0.1)
            cr_expect_eq(figure_hides(&figure, (const double[]){5, 0, side * z},
                                      (const double[]){-5, 0, side * z}),
                         z < 1, "z = %g", side * z);
}

/* The outline of a sphere of radius r at distance d on the camera's axis is a circle whose angular
 * radius has the sine r / d. */
Test(camera, a_sphere_is_painted_as_large_as_it_is_seen) {
    struct figure figure = {.count = 1};
    figure.body[0] = (struct figure_body){.radii = {0.7, 0.7, 0.7},
                                          .motion.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    struct camera camera = by_hand();
    camera.scale = 100;
    camera.width = 200;
    camera.height = 160;
    unsigned char *pixels = test_room(4 * 200 * 160);
    cr_assert(pixels && figure_paint(&figure, &camera, (const double[]){1, 0, 0}, pixels));
    double area = 0;
    for (int i = 0; i < 200 * 160; i++)
        area += pixels[4 * i + 3] / 255.;
    const double radius = 100 * tan(asin(0.7 / 2));
    cr_expect(fabs(area / (M_PI * radius * radius) - 1) < 0.01, "%g pixels", area);
    const unsigned char *lit = pixels + 4 * (80 * 200 + 130), *dark = pixels + 4 * (80 * 200 + 70);
    cr_expect(lit[0] > dark[0] + 40, "the light does not come from the right: %d, %d", lit[0],
              dark[0]);
    cr_expect_eq(pixels[3], 0, "something in the corner");
    figure.body[0].motion.centre[2] = 10; /* behind the camera */
    cr_expect(!figure_paint(&figure, &camera, (const double[]){1, 0, 0}, pixels));
}

/* --- order --- */

Test(camera, the_furthest_comes_first_and_equals_stay_in_order) {
    enum { COUNT = 5000 };
    struct segment *segments = calloc(COUNT, sizeof *segments);
    struct layer layer = {segments, COUNT, COUNT};
    unsigned seed = 6;
    cr_assert(segments);
    for (int i = 0; i < COUNT; i++) {
        segments[i].depth = (float)(int)lab_between(&seed, -100, 400);
        segments[i].colour = (unsigned)i;
    }
    layer_sort(&layer);
    for (int i = 1; i < COUNT; i++) {
        const struct segment *a = &layer.segments[i - 1], *b = &layer.segments[i];
        cr_assert(a->depth >= b->depth, "segment %d", i);
        cr_assert(a->depth > b->depth || a->colour < b->colour, "equals at %d", i);
    }
    free(layer.segments); /* other ones: sorting needs room */
}

/* --- the scene's group --- */

Test(camera, wishes_of_the_scene_are_checked) {
    static const char *const wrong[][2] = {
        {"render={eye=[0,0,1];}", "target"},
        {"render={eye=[0,0,1]; target=[0,0,1];}", "where the target is"},
        {"render={eye=[0,0]; target=[0,0,0];}", "eye: must be 3 numbers"},
        {"render={hairs=0;}", "hairs: 0 is not a whole number from 1"},
        {"render={hairs=2.5;}", "hairs"},
        {"render={pieces=5000;}", "pieces: 5000 is not"},
        {"render={angle=0;}", "angle"},
        {"render={angle=3.2;}", "angle: 3.2 is not"},
        {"render={colour=[0.5,0.5,1.5];}", "colour: number 3, 1.5"},
        {"render={light=[0,0,0];}", "light: has no length"},
        {"render={fov=1;}", "fov: unknown setting"},
        {"render=3", "render"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        LAB_REFUSE("swing-envelope", wrong[i][0], wrong[i][1]);
}

/* A run is good from every side. */
Test(camera, how_a_scene_is_looked_at_is_no_part_of_what_it_is) {
    struct scene *a = lab_load("swing-envelope", NULL, 0),
                 *b = LAB_LOAD("swing-envelope", "render={hairs=7;}");
    char first[HASH_SIZE], second[HASH_SIZE];
    scene_hash(a, first);
    scene_hash(b, second);
    cr_expect_str_eq(first, second);
    cr_expect_eq(b->render.hairs, 7);
}
