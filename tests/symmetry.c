/* What must not matter: where everything points, which hand it has, in what units it is, how often
 * it is looked at, and whether the head moves or the field that it is in. Each compares two scenes
 * that are the same motion; one that must differ shows that the comparison can fail. */
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

enum { X = 2, V = 5, R = 8 }; /* columns of a frame's rows, after wisp and node */

static const double *row_at(const struct lab_run *run, int frame, int row) {
    return run->row + ((long)frame * run->rows + row) * run->columns;
}

static void run_it(const char *text, const char *stepper, const char *treatment, double step,
                   struct lab_run *run) {
    struct scene *scene = lab_read(text);
    const struct run_request request = {.stepper = stepper, .treatment = treatment, .step = step};
    lab_finish(scene, &request, run);
}

/* --- rotation --- */

/* A wisp with an envelope beside a body, on a head that is turned, in a wind. */
#define TURNED                                                                                   \
    "duration = 0.2; frame_rate = 30.0; gravity = [%.17e, %.17e, %.17e]; material = { };\n"      \
    "envelope = { }; head = { times = [0.0]; positions = ([0.0, 0.0, 0.0]);\n"                   \
    "rotations = ([%.17e, %.17e, %.17e]); };\n"                                                  \
    "wind = { kind = \"steady\"; velocity = [%.17e, %.17e, %.17e]; };\n"                         \
    "body = ( { name = \"b\"; center = [0.15, -0.05, 0.0]; radii = [0.1, 0.08, 0.09];\n"         \
    "           friction = 50.0; elasticity = 0.1; offset = 1e-4; } );\n"                        \
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.2, 0.1]; length = 0.2; nodes = 7; " \
    "} );\n"

/* Rodrigues: x turned about `axis`, whose length is the angle. */
static void turn(const double axis[3], const double x[3], double to[3]) {
    const double angle = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double k[3] = {0, 0, 0}, along = 0;
    for (int i = 0; i < 3 && angle > 0; i++)
        k[i] = axis[i] / angle;
    for (int i = 0; i < 3; i++)
        along += k[i] * x[i];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        to[i] = x[i] * cos(angle) + (k[j] * x[l] - k[l] * x[j]) * sin(angle) +
                k[i] * along * (1 - cos(angle));
    }
}

static void run_turned(const double axis[3], const char *treatment, struct lab_run *run) {
    static const double gravity[3] = {0, -9.81, 0}, wind[3] = {1, 0.5, 2};
    double g[3], w[3];
    turn(axis, gravity, g);
    turn(axis, wind, w);
    const char *const text =
        printed(TURNED, g[0], g[1], g[2], axis[0], axis[1], axis[2], w[0], w[1], w[2]);
    run_it(text, "rk4", treatment, 1e-4, run);
}

Test(symmetry, turned_with_everything_it_is_the_same_motion) {
    static const double none[3] = {0, 0, 0}, axis[3] = {0.7, -1.1, 0.4};
    for (int t = 0; t < TREATMENTS; t++) {
        struct lab_run plain, turned;
        double off = 0, moved = 0;
        run_turned(none, treatment_names[t], &plain);
        run_turned(axis, treatment_names[t], &turned);
        cr_assert_gt(plain.result.counters.body_contacts, 0, "nothing is touched");
        cr_expect_eq(plain.result.counters.body_contacts, turned.result.counters.body_contacts);
        for (int f = 0; f < plain.frames; f++)
            for (int i = 0; i < plain.rows; i++) {
                double expected[3];
                turn(axis, row_at(&plain, f, i) + X, expected);
                for (int k = 0; k < 3; k++) {
                    off = fmax(off, fabs(row_at(&turned, f, i)[X + k] - expected[k]));
                    moved = fmax(moved,
                                 fabs(row_at(&turned, f, i)[X + k] - row_at(&plain, f, i)[X + k]));
                }
            }
        cr_expect_lt(off, 1e-12, "%s: %g", treatment_names[t], off);
        cr_expect_gt(moved, 0.1, "nothing is turned");
    }
}

/* --- mirror --- */

#define HANDED                                                                           \
    "duration = 0.3; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"  \
    "envelope = { samples = 5; }; contacts = { };\n"                                     \
    "wind = { kind = \"steady\"; velocity = [1.0, 0.0, %s]; };\n"                        \
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.1, %s]; length = 0.2;\n"    \
    "            nodes = 7; }, { root = [0.0, 0.01, %s]; direction = [1.0, 0.2, 0.0];\n" \
    "            length = 0.2; nodes = 7; } );\n"

/* z becomes -z; sample j, whose angle is from a direction in the mirror, becomes sample -j. */
Test(symmetry, a_mirror_changes_the_hand_alone) {
    const char *const text = printed(HANDED, "2.0", "0.3", "0.02");
    const char *const mirrored = printed(HANDED, "-2.0", "-0.3", "-0.02");
    for (int t = 0; t < TREATMENTS; t++) {
        struct lab_run one, other;
        double off = 0, aside = 0;
        run_it(text, "rk4", treatment_names[t], 1e-4, &one);
        run_it(mirrored, "rk4", treatment_names[t], 1e-4, &other);
        cr_assert_gt(one.result.counters.wisp_contacts, 0, "nothing is touched");
        cr_expect_eq(one.result.counters.wisp_contacts, other.result.counters.wisp_contacts);
        for (int f = 0; f < one.frames; f++)
            for (int i = 0; i < one.rows; i++) {
                const double *a = row_at(&one, f, i), *b = row_at(&other, f, i);
                for (int k = 0; k < 3; k++)
                    off = fmax(off, fabs(a[X + k] - (k == 2 ? -b[X + k] : b[X + k])));
                aside = fmax(aside, fabs(a[X + 2]));
                for (int j = 0; j < 5 && strcmp(treatment_names[t], "penalty") != 0; j++)
                    off = fmax(off, fabs(a[R + 2 * j] - b[R + 2 * ((5 - j) % 5)]));
            }
        cr_expect_lt(off, 1e-11, "%s: %g", treatment_names[t], off);
        cr_expect_gt(aside, 0.05, "it stays in the mirror");
    }
}

/* --- units --- */

/* Lengths in units of `l`, times of `s`, and masses as they are: numbers of the file by their
 * dimensions. */
static void write_in_units(char text[4096], double l, double s) {
    snprintf(
        text, 4096,
        "duration = %.17e; frame_rate = %.17e; gravity = [0.0, %.17e, 0.0];\n"
        "material = { hair_count = 1000.0; hair_density = %.17e; stretch_stiffness = %.17e;\n"
        "  stretch_time = %.17e; bending = \"skip\"; bending_stiffness = %.17e;\n"
        "  bending_angle = 0.3; bending_time = %.17e; drag_rate = %.17e; };\n"
        "envelope = { samples = 4; radius = %.17e; mass_fraction = 0.15; frequency = %.17e; };\n"
        "contacts = { collision_rate = %.17e; interaction_rate = %.17e; viscosity = %.17e; };\n"
        "wind = { kind = \"steady\"; velocity = [%.17e, 0.0, 0.0]; };\n"
        "body = ( { name = \"b\"; center = [%.17e, %.17e, 0.0];\n"
        "  radii = [%.17e, %.17e, %.17e]; friction = %.17e; elasticity = 0.5;\n"
        "  offset = %.17e; } );\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.2, 0.1]; length = %.17e;\n"
        "  nodes = 7; }, { root = [0.0, %.17e, 0.0]; direction = [1.0, 0.1, 0.0];\n"
        "  length = %.17e; nodes = 7; } );\n",
        0.25 * s, 32 / s, -9.81 * l / s / s, 5.7e-6 / l, 90 * l / s / s, 1.2e-4 * s,
        1e-5 * l * l * l / s / s, 1e-3 * s, 4 / s, 0.02 * l, 10 / s, 256 / s, 64 / s, 5 / s, l / s,
        0.15 * l, -0.12 * l, 0.1 * l, 0.08 * l, 0.09 * l, 50 / s, 1e-4 * l, 0.2 * l, 0.02 * l,
        0.2 * l);
}

/* By powers of two not a bit changes but the size. */
Test(symmetry, other_units_are_the_same_bits) {
    const double l = 4, s = 0.5;
    char plain[4096], scaled[4096];
    write_in_units(plain, 1, 1);
    write_in_units(scaled, l, s);
    for (int t = 0; t < TREATMENTS; t++) {
        struct lab_run one, other;
        run_it(plain, "rk4", treatment_names[t], ldexp(1, -13), &one);
        run_it(scaled, "rk4", treatment_names[t], s * ldexp(1, -13), &other);
        cr_assert(one.result.counters.body_contacts > 0 && one.result.counters.wisp_contacts > 0,
                  "nothing is touched");
        for (int f = 0; f < one.frames; f++)
            for (int i = 0; i < one.rows; i++)
                for (int k = 0; k < 3; k++) {
                    const double *a = row_at(&one, f, i), *b = row_at(&other, f, i);
                    cr_assert(b[X + k] == l * a[X + k] && b[V + k] == l / s * a[V + k],
                              "%s, frame %d, row %d: %.17g and %.17g", treatment_names[t], f, i,
                              a[X + k], b[X + k]);
                }
    }
}

/* --- who looks --- */

/* Frames are stops that change nothing: steps between them divide the same times. */
Test(symmetry, how_often_it_is_looked_at_changes_nothing) {
    for (int t = 0; t < TREATMENTS; t++) {
        struct lab_run seldom, often;
        double off = 0;
        struct scene *scene[2] = {LAB_LOAD("swing-envelope", "duration=0.2", "frame_rate=10.0"),
                                  LAB_LOAD("swing-envelope", "duration=0.2", "frame_rate=60.0")};
        const struct run_request request = {
            .stepper = "rk4", .treatment = treatment_names[t], .step = 1 / 6000.};
        lab_run(scene[0], &request, &seldom);
        lab_run(scene[1], &request, &often);
        cr_assert(seldom.frames == 3 && often.frames == 13);
        for (int f = 0; f < seldom.frames; f++)
            for (int i = 0; i < seldom.rows; i++)
                for (int k = 0; k < 3; k++)
                    off = fmax(
                        off, fabs(row_at(&seldom, f, i)[X + k] - row_at(&often, 6 * f, i)[X + k]));
        cr_expect_lt(off, 1e-13, "%s: %g", treatment_names[t], off);
    }
}

/* --- head or field --- */

#define CARRIED                                                                                  \
    "duration = 0.4; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"                          \
    "material = { drag_rate = 0.0; }; envelope = { };\n"                                         \
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.2, 0.1]; length = 0.2; nodes = 7; " \
    "} );\n"

/* From rest to rest over D in T by 3 s^2 - 2 s^3: its acceleration is D/T^2 (6 - 12 s), and a field
 * of the opposite on a head at rest is, seen from there, the same. In `projection`, which loses
 * what pushes across a sample's line, it is not. */
Test(symmetry, a_moved_head_is_a_field_on_one_at_rest) {
    static const char moved[] =
        CARRIED "head = { times = [0.0, 0.4]; positions = ([0.0, 0.0, 0.0], [0.1, 0.05, -0.2]);\n"
                "         rotations = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]); };\n";
    static const char held[] =
        CARRIED "style = { times = [0.0, 0.4]; accelerations = ([-3.75, -1.875, 7.5],\n"
                "          [3.75, 1.875, -7.5]); };\n";
    static const double far[3] = {0.1, 0.05, -0.2};
    for (int t = 0; t < TREATMENTS; t++) {
        struct lab_run head, field;
        double off = 0;
        run_it(moved, "rk4", treatment_names[t], 2.5e-5, &head);
        run_it(held, "rk4", treatment_names[t], 2.5e-5, &field);
        for (int f = 0; f < head.frames; f++) {
            const double s = head.t[f] / 0.4, share = s * s * (3 - 2 * s);
            for (int i = 0; i < head.rows; i++)
                for (int k = 0; k < 3; k++)
                    off = fmax(off, fabs(row_at(&head, f, i)[X + k] - share * far[k] -
                                         row_at(&field, f, i)[X + k]));
        }
        if (strcmp(treatment_names[t], "projection") == 0)
            cr_expect_gt(off, 1e-4, "projection: %g", off);
        else
            cr_expect_lt(off, 1e-12, "%s: %g", treatment_names[t], off);
    }
}

/* --- without weight, and at rest under it --- */

/* A field that bears all weight leaves straight hair where it is, in every treatment. */
Test(symmetry, without_weight_nothing_moves) {
    static const char text[] =
        CARRIED "style = { times = [0.0]; accelerations = ([0.0, 9.81, 0.0]); };\n";
    for (int t = 0; t < TREATMENTS; t++) {
        struct lab_run run;
        run_it(text, "rk4", treatment_names[t], 1e-4, &run);
        for (int i = 0; i < run.rows; i++)
            for (int k = 0; k < 3; k++)
                cr_expect_lt(
                    fabs(row_at(&run, run.frames - 1, i)[X + k] - row_at(&run, 0, i)[X + k]), 1e-13,
                    "%s, node %d", treatment_names[t], i);
    }
}

/* Soft hair hangs longer, segment by segment, by what hangs below: l (1 + W / EA). */
Test(symmetry, soft_hair_hangs_as_statics_says) {
    static const char text[] =
        "duration = 3.0; frame_rate = 1.0; gravity = [0.0, -9.81, 0.0];\n"
        "material = { stretch_stiffness = 1.0; stretch_time = 0.01; bending = \"none\";\n"
        "             drag_rate = 40.0; };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.2;\n"
        "            nodes = 6; } );\n";
    const double spacing = 0.04, mass = 1000 * 5.7e-6 * spacing, stiffness = 1;
    struct lab_run run;
    run_it(text, "rk4", "generalised", 5e-4, &run);
    for (int i = 1; i < 5; i++) {
        const double weight = 9.81 * mass * (4 - i + 0.5); /* the last node has half a segment */
        const double length =
            row_at(&run, run.frames - 1, i)[X + 1] - row_at(&run, run.frames - 1, i + 1)[X + 1];
        cr_expect_float_eq(length, spacing * (1 + weight / stiffness), 1e-9, "segment %d: %.12g", i,
                           length);
    }
}
