/* The head's motion and style fields: against differences, closed forms and each other. */
#include "wisp/prescribed.h"

#include "model/model.h"
#include "run/settings.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

/* Turns of more than one revolution, of little, and of none. */
static const struct head_motion motion = {
    .knots = 5,
    .time = {0.1, 0.3, 0.55, 0.8, 1.4},
    .position = {{0}, {0.05, 0.01, 0}, {0, 0.02, -0.03}, {0.1, 0, 0}, {0.1, 0, 0}},
    .rotation = {{0}, {0, 1, 0.2}, {4, -5, 3}, {0, 1e-3, 0}, {0}},
};

static void point_at(double t, int derivative, double point[3]) {
    static const double rest[3] = {0.1, -0.2, 0.07};
    struct placement at;
    head_placement(&motion, t, &at);
    placed_point(&at, derivative, rest, point);
}

/* Velocity and acceleration against differences of the position: fourth order in h, so that the
 * truncation, 1e5 h^4 with the motion's fifth derivative, and rounding, 1e-16 / h^2, are small. */
Test(prescribed, velocities_and_accelerations_are_derivatives) {
    const double h = 1e-3;
    for (double t = 0.113; t < 1.4; t += 0.0371) {
        double x[5][3], v[3], a[3];
        int knot_near = 0;
        for (int k = 0; k < motion.knots; k++)
            knot_near |= fabs(t - motion.time[k]) < 3 * h; /* the second derivative jumps there */
        if (knot_near)
            continue;
        for (int k = -2; k <= 2; k++)
            point_at(t + k * h, 0, x[k + 2]);
        point_at(t, 1, v);
        point_at(t, 2, a);
        for (int c = 0; c < 3; c++) {
            const double by_v = (x[0][c] - 8 * x[1][c] + 8 * x[3][c] - x[4][c]) / (12 * h);
            const double by_a =
                (-x[0][c] + 16 * x[1][c] - 30 * x[2][c] + 16 * x[3][c] - x[4][c]) / (12 * h * h);
            cr_assert_float_eq(v[c], by_v, 1e-5, "t = %g: velocity %g, %g", t, v[c], by_v);
            cr_assert_float_eq(a[c], by_a, 1e-2, "t = %g: acceleration %g, %g", t, a[c], by_a);
        }
    }
}

Test(prescribed, turns_are_rotations_and_are_held_outside_the_knots) {
    struct placement at, before, after;
    for (double t = 0; t < 2; t += 0.013) {
        head_placement(&motion, t, &at);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                double product = 0;
                for (int k = 0; k < 3; k++)
                    product += at.turn[0][i][k] * at.turn[0][j][k];
                cr_assert_float_eq(product, i == j, 1e-14, "t = %g: rows %d, %d: %g", t, i, j,
                                   product);
            }
    }
    head_placement(&motion, 0.1, &at);
    head_placement(&motion, -5, &before);
    head_placement(&motion, 50, &after);
    cr_assert(memcmp(at.position[0], before.position[0], sizeof at.position[0]) == 0);
    for (int c = 0; c < 3; c++) {
        cr_assert_eq(before.position[1][c], 0, "it moves before its first knot");
        cr_assert_eq(after.position[1][c], 0, "it moves after its last knot");
        cr_assert_eq(after.position[0][c], motion.position[4][c]);
    }
}

/* About one axis the rotation vector is the angle. */
Test(prescribed, about_one_axis_the_turn_is_the_angle) {
    struct head_motion one = {.knots = 1, .rotation = {{0, 0, 0}}};
    const double x[3] = {1, 0, 0};
    for (double angle = 1e-9; angle < 20; angle *= 1.7) {
        struct placement at;
        double turned[3];
        one.rotation[0][2] = angle;
        head_placement(&one, 0, &at);
        placed_direction(&at, x, turned);
        cr_assert_float_eq(turned[0], cos(angle), 1e-14, "angle %g", angle);
        cr_assert_float_eq(turned[1], sin(angle), 1e-14, "angle %g", angle);
    }
}

Test(prescribed, slopes_at_knots_are_those_of_the_chords) {
    for (int k = 0; k < motion.knots; k++) {
        struct placement at;
        head_placement(&motion, motion.time[k], &at);
        for (int c = 0; c < 3; c++) {
            const int end = k == 0 || k == motion.knots - 1;
            const double slope = end ? 0
                                     : (motion.position[k + 1][c] - motion.position[k - 1][c]) /
                                           (motion.time[k + 1] - motion.time[k - 1]);
            cr_assert_float_eq(at.position[0][c], motion.position[k][c], 1e-15);
            cr_assert_float_eq(at.position[1][c], slope, 1e-14);
        }
    }
}

/* The acceleration jumps at knots: what is asked for at one is what comes after it, at the last one
 * rest. Between 0 and 1 s the head goes 1 m, from rest to the slope of 1 m/s, with 4 - 6 t; then
 * 2 m in 2 s to rest, with 1 - 1.5 (t - 1). */
Test(prescribed, accelerations_at_knots_are_those_after_them) {
    static const struct head_motion jerky = {
        .knots = 3, .time = {0, 1, 3}, .position = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}};
    static const struct {
        double t, position, velocity, acceleration;
    } cases[] = {{-1e-9, 0, 0, 0},      {0, 0, 0, 4}, {0.5, 0.375, 1.25, 1}, {1, 1, 1, 1},
                 {2, 2.25, 1.25, -0.5}, {3, 3, 0, 0}, {9, 3, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct placement at;
        head_placement(&jerky, cases[i].t, &at);
        cr_assert(fabs(at.position[0][0] - cases[i].position) <= 1e-15 &&
                      fabs(at.position[1][0] - cases[i].velocity) <= 1e-15 &&
                      fabs(at.position[2][0] - cases[i].acceleration) <= 1e-14,
                  "at %g s: %.17g, %.17g, %.17g", cases[i].t, at.position[0][0], at.position[1][0],
                  at.position[2][0]);
    }
}

Test(prescribed, style_is_linear_between_knots_and_held_outside) {
    const struct style style = {
        .knots = 3, .time = {1, 2, 4}, .acceleration = {{1, 0, 0}, {3, 2, 0}, {3, -2, 6}}};
    static const double expected[][4] = {{0, 1, 0, 0}, {1, 1, 0, 0}, {1.5, 2, 1, 0},
                                         {2, 3, 2, 0}, {3, 3, 0, 3}, {9, 3, -2, 6}};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        double s[3];
        style_acceleration(&style, expected[i][0], s);
        for (int c = 0; c < 3; c++)
            cr_assert_float_eq(s[c], expected[i][1 + c], 1e-15, "t = %g", expected[i][0]);
    }
}

/* --- on wisps --- */

static const char scene_text[] =
    "duration = 0.3; frame_rate = 30.0; %s material = { }; envelope = { };\n"
    "wisps = ( { root = [0.1, 0.0, 0.05]; direction = [1.0, 0.2, 0.1]; length = 0.3; nodes = 6; } "
    ");"
    "%s\n";

static struct scene *scene_with(const char *gravity, const char *more) {
    return lab_read(printed(scene_text, gravity, more));
}

static void run_to_end(const struct scene *scene, const char *stepper, const char *treatment,
                       struct lab_run *run) {
    lab_finish(scene, &(struct run_request){.stepper = stepper, .treatment = treatment}, run);
}

/* A row of the last frame: of wisp 0, the node of that number. */
static const double *last_row(const struct lab_run *run, int row) {
    return run->row + ((run->frames - 1) * run->rows + row) * run->columns;
}

/* A constant style is gravity by another name. */
Test(prescribed, a_constant_style_is_gravity) {
    struct scene *heavy = scene_with("gravity = [1.0, -9.0, 0.5];", "");
    struct scene *styled =
        scene_with("gravity = [0.0, 0.0, 0.0];",
                   "style = { times = [0.0]; accelerations = ([1.0, -9.0, 0.5]); };");
    for (int i = 0; i < TREATMENTS; i++) {
        struct lab_run one, other;
        run_to_end(heavy, "rk4", treatment_names[i], &one);
        run_to_end(styled, "rk4", treatment_names[i], &other);
        cr_assert(memcmp(last_row(&one, 0), last_row(&other, 0),
                         (size_t)(one.rows * one.columns) * sizeof(double)) == 0,
                  "%s", treatment_names[i]);
    }
}

/* A head that has been turned for ever is a scene that is turned: gravity and direction. */
Test(prescribed, a_head_turned_for_ever_is_a_turned_scene) {
    struct scene *plain = scene_with("gravity = [0.0, -9.81, 0.0];", "");
    /* a quarter turn about z takes x to y and y to -x, and gravity with them */
    struct scene *turned = scene_with("gravity = [9.81, 0.0, 0.0];",
                                      "head = { times = [0.0]; positions = ([0.0, 0.0, 0.0]); "
                                      "rotations = ([0.0, 0.0, 1.5707963267948966]); };");
    for (int i = 0; i < TREATMENTS; i++) {
        struct lab_run one, other;
        run_to_end(plain, "rk4", treatment_names[i], &one);
        run_to_end(turned, "rk4", treatment_names[i], &other);
        for (int row = 0; row < one.rows; row++) {
            const double *a = last_row(&one, row), *b = last_row(&other, row);
            cr_assert_float_eq(b[2], -a[3], 1e-11, "%s: node %d", treatment_names[i], row);
            cr_assert_float_eq(b[3], a[2], 1e-11, "%s: node %d", treatment_names[i], row);
            cr_assert_float_eq(b[4], a[4], 1e-11, "%s: node %d", treatment_names[i], row);
        }
    }
}

/* Two unlike methods agree on a head that shakes: the motion reaches every stage and its knots stop
 * the advance. */
Test(prescribed, methods_agree_on_a_head_that_shakes) {
    struct scene *scene = scene_with(
        "gravity = [0.0, -9.81, 0.0];",
        "head = { times = [0.02, 0.1, 0.21]; positions = ([0.0, 0.0, 0.0], [0.02, 0.0, 0.0], "
        "[0.0, 0.0, 0.0]); rotations = ([0.0, 0.0, 0.0], [0.0, 0.9, 0.2], [0.0, 0.0, 0.0]); };");
    struct lab_run one, other;
    run_to_end(scene, "rk4", "generalised", &one);
    run_to_end(scene, "reference", "generalised", &other);
    cr_assert_eq(one.rows, 6);
    for (int row = 0; row < one.rows; row++)
        for (int c = 2; c < 5; c++) {
            const double a = last_row(&one, row)[c], b = last_row(&other, row)[c];
            /* Runge-Kutta 4 at 10 kHz is good to some 1e-10 m on these scenes */
            cr_assert_float_eq(a, b, 1e-8, "node %d: %g", row, a - b);
        }
}
