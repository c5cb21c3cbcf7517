/* What the experiments of chapter 5 measure, on states made by hand. */
#include "experiments/chapter5/hair_frames.h"

#include "experiments/chapter5/crossing.h"
#include "experiments/chapter5/misses.h"
#include "scene/scene_load.h"
#include "wisp/section.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- states made by hand --- */

enum { FRAMES = 4, WISPS = 3, NODES = 6, SAMPLES = 4, COLUMNS = 9 + 2 * SAMPLES };
static const double length = 0.3, radius = 0.02;

/* A run of hand-made frames: wisp w hangs straight down from (0.1 w, 0, 0). */
struct made {
    struct scene *scene;
    double *value; /* until it is opened */
    struct trajectory states;
    struct hair hair;
    int wisps[FRAMES];
};

static struct wisp hanging_wisp(int w) {
    return (struct wisp){.nodes = NODES,
                         .samples = SAMPLES,
                         .root = {0.1 * w, 0, 0},
                         .direction = {0, -1, 0},
                         .length = length,
                         .hair_count = 1000,
                         .hair_density = 5.7e-6,
                         .stretch_stiffness = 90,
                         .radius = radius,
                         .mass_fraction = 0.15,
                         .frequency = 10};
}

static double *row_of(struct made *made, int frame, int wisp, int node) {
    int row = 0;
    for (int f = 0; f < frame; f++)
        row += made->wisps[f] * NODES;
    double *value = made->value ? made->value : made->states.table.value;
    return value + (size_t)((row + wisp * NODES + node) * COLUMNS);
}

/* Wisps beyond the scene's are children of wisp 1. */
static void make(struct made *made, int scene_wisps, const int wisps[FRAMES]) {
    struct wisp numbers[WISPS];
    const struct surroundings around = {.gravity = {0, -9.81, 0}};
    for (int w = 0; w < WISPS; w++)
        numbers[w] = hanging_wisp(w);
    *made = (struct made){.scene = lab_scene(numbers, scene_wisps, &around)};
    made->scene->frame_rate = 30;
    memcpy(made->wisps, wisps, sizeof made->wisps);
    made->value = calloc((size_t)FRAMES * WISPS * NODES * COLUMNS, sizeof(double));
    for (int f = 0; f < FRAMES; f++)
        for (int w = 0; w < wisps[f]; w++)
            for (int i = 0; i < NODES; i++) {
                double *row = row_of(made, f, w, i);
                row[0] = f / 30.;
                row[1] = w;
                row[2] = i;
                row[3] = 0.1 * (w < scene_wisps ? w : 1);
                row[4] = -i * length / (NODES - 1);
                for (int j = 0; j < SAMPLES; j++)
                    row[9 + 2 * j] = radius;
            }
}

static struct hair *opened(struct made *made) {
    char reason[REASON_SIZE];
    int rows = 0;
    for (int f = 0; f < FRAMES; f++)
        rows += made->wisps[f] * NODES;
    lab_trajectory(&made->states, made->value, rows, COLUMNS);
    made->value = NULL;
    for (int w = made->scene->wisp_count; w < made->states.wisp_count; w++)
        made->states.parent[w] = 1;
    cr_assert_eq(hair_open(&made->hair, made->scene, &made->states, WISP_GENERALISED, reason), 0,
                 "%s", reason);
    return &made->hair;
}

static void unmake(struct made *made) {
    hair_close(&made->hair);
    trajectory_free(&made->states);
}

static const int always_two[FRAMES] = {2, 2, 2, 2};

/* Turns a wisp of a frame about its node 1 and the z axis, anticlockwise seen from +z. */
static void lean(struct made *made, int frame, int wisp, double angle) {
    for (int i = 2; i < NODES; i++) {
        const double along = (i - 1) * length / (NODES - 1);
        double *row = row_of(made, frame, wisp, i);
        row[3] = 0.1 * wisp + along * sin(angle);
        row[4] = -length / (NODES - 1) - along * cos(angle);
    }
}

Test(hair, frames_and_wisps_are_found_also_when_they_become_more) {
    struct made made;
    make(&made, 2, (const int[]){2, 2, 3, 3});
    row_of(&made, 3, 2, 4)[7] = 12.5;
    const struct hair *hair = opened(&made);
    cr_assert_eq(hair->frame_count, FRAMES);
    cr_assert_eq(hair->states->wisp_count, 3);
    for (int f = 0; f < FRAMES; f++) {
        cr_assert_eq(hair->frames[f].wisps, made.wisps[f], "frame %d", f);
        cr_assert_float_eq(hair->frames[f].t, f / 30., 0);
        for (int w = 0; w < made.wisps[f]; w++) {
            cr_assert_eq(hair_nodes(hair, f, w), NODES, "frame %d, wisp %d", f, w);
            cr_assert_eq(hair_ancestor(hair, w), w < 2 ? w : 1, "frame %d, wisp %d", f, w);
        }
    }
    cr_assert_float_eq(hair_node(hair, 3, 2, 4)[4], 12.5, 0);
    cr_assert_eq(hair_frame_at(hair, 0.06), 2);
    cr_assert_eq(hair_frame_at(hair, 0.2), -1, "after the end");
    unmake(&made);
}

Test(hair, inclination_is_the_angle_from_gravity) {
    struct made made;
    make(&made, 2, always_two);
    lean(&made, 1, 0, 0.3);
    lean(&made, 1, 1, -0.7);
    lean(&made, 2, 0, 3.);
    const struct hair *hair = opened(&made);
    const double mean[] = {0, 0.5, 1.5}, largest[] = {0, 0.7, 3};
    for (int f = 0; f < 3; f++) {
        const struct inclination i = hair_inclination(hair, f);
        cr_assert_float_eq(i.mean, mean[f], 1e-12, "frame %d: mean %g", f, i.mean);
        cr_assert_float_eq(i.largest, largest[f], 1e-12, "frame %d: largest %g", f, i.largest);
    }
    unmake(&made);
}

/* The free nodes and samples of either wisp that are in a section of the other, one by one. */
static int overlap_by_brute_force(const struct hair *hair) {
    int count = 0;
    for (int w = 0; w < 2; w++)
        for (int i = 1; i + 1 < NODES; i++) {
            struct section section;
            struct section_place place;
            const struct strand *other = hair->strands[1 - w];
            section_make(&section, hair->strands[w], i);
            for (int k = 2; k < NODES; k++) {
                count += section_contains(&section, other->p[k], &place);
                for (int j = 0; j < SAMPLES; j++)
                    count += section_contains(&section, other->e[k * SAMPLES + j], &place);
            }
        }
    return count;
}

/* The second wisp is further away from frame to frame: nodes are in the other up to R, samples up
 * to 2 R. What is in a section of its own wisp does not count: the third wisp is folded. */
Test(hair, overlap_counts_points_of_one_wisp_in_another) {
    static const double apart[FRAMES] = {0.001, 0.0185, 0.0395, 0.0405};
    struct made made;
    make(&made, 3, (const int[]){3, 3, 3, 3});
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < NODES; i++) {
            row_of(&made, f, 1, i)[3] = apart[f];
            row_of(&made, f, 1, i)[4] -= 0.013;
            if (i == NODES - 1)
                memcpy(row_of(&made, f, 2, i) + 3, (const double[]){0.21, -0.07, 0},
                       3 * sizeof(double));
        }
    struct hair *hair = opened(&made);
    for (int f = 0; f < FRAMES; f++) {
        const int found = hair_overlap(hair, f), expected = overlap_by_brute_force(hair);
        cr_assert_eq(found, expected, "%g m apart: %d, one by one %d", apart[f], found, expected);
        cr_assert_eq(found > 0, apart[f] < 2 * radius, "%g m apart: %d", apart[f], found);
    }
    unmake(&made);
}

/* Figure 4.13: thin wisps at right angles, the third section of one across the middle of the
 * other's; then with a node there, whose samples are in the sections beside it; hardly across it;
 * and beside it, where their boxes still have a part in common. */
Test(hair, crossings_are_missed_where_no_point_shows_them) {
    static const double thin = 0.003, l = 0.06, half = M_SQRT1_2;
    static const struct {
        double way[3], beside[3], node, radius[2]; /* of the second: which node is nearest */
        struct misses sections, wisps;
    } at[FRAMES] = {
        {{1, 0, 0}, {0, 0, 0}, 2.5, {0.003, 0.003}, {1, 1}, {1, 1}},
        {{1, 0, 0}, {0, 0, 0}, 2, {0.04, 0.008}, {6, 0}, {1, 0}},
        {{1, 0, 0}, {0, 0, 0.0055}, 2.5, {0.003, 0.003}, {1, 1}, {1, 1}},
        {{half, 0, half}, {0.01 * half, 0, -0.01 * half}, 2.5, {0.003, 0.003}, {0, 0}, {0, 0}}};
    struct made made;
    struct brute *brute = brute_create();
    make(&made, 2, always_two);
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < NODES; i++)
            for (int w = 0; w < 2; w++) {
                double *row = row_of(&made, f, w, i);
                for (int j = 0; j < SAMPLES; j++)
                    row[9 + 2 * j] = w == 0 ? thin : at[f].radius[j % 2];
                for (int k = 0; k < 3 && w == 1; k++)
                    row[3 + k] =
                        at[f].beside[k] + (i - at[f].node) * l * at[f].way[k] - (k == 1) * 2.5 * l;
            }
    struct hair *hair = opened(&made);
    for (int f = 0; f < FRAMES; f++) {
        struct misses sections = {0, 0}, wisps = {0, 0};
        hair_misses(brute, hair, f, &sections, &wisps);
        cr_expect(memcmp(&sections, &at[f].sections, sizeof sections) == 0,
                  "frame %d: %d crossings, %d missed", f, sections.crossings, sections.missed);
        cr_expect(memcmp(&wisps, &at[f].wisps, sizeof wisps) == 0, "frame %d: %d wisps, %d missed",
                  f, wisps.crossings, wisps.missed);
    }
    brute_free(brute);
    unmake(&made);
}

/* The same each time; and lines that are infinitely thin have no points in each other. */
Test(hair, the_thinner_the_more_crossings_are_missed) {
    static const double slenderness[] = {1, 4, 16, 64};
    struct brute *brute = brute_create();
    struct misses misses, again;
    double before = 0.1;
    for (int i = 0; i < 4; i++) {
        cr_assert_eq(random_misses(brute, slenderness[i], 300, &misses), 0);
        cr_assert_eq(random_misses(brute, slenderness[i], 300, &again), 0);
        const double share = misses.missed / 300.;
        cr_expect(misses.crossings == 300 && misses.missed == again.missed);
        cr_expect(share > before, "%g diameters: %g", slenderness[i], share);
        before = share;
    }
    cr_expect_gt(before, 0.85);
    brute_free(brute);
}

Test(hair, strain_is_the_largest_change_of_a_length) {
    struct made made;
    make(&made, 2, always_two);
    row_of(&made, 1, 1, NODES - 1)[4] -= 0.03 * length / (NODES - 1);
    row_of(&made, 2, 0, NODES - 1)[4] += 0.04 * length / (NODES - 1);
    row_of(&made, 3, 0, 0)[4] += 0.5; /* between the head's nodes there is no spring */
    const struct hair *hair = opened(&made);
    const double expected[FRAMES] = {0, 0.03, 0.04, 0};
    for (int f = 0; f < FRAMES; f++)
        cr_assert_float_eq(hair_strain(hair, f), expected[f], 1e-12, "frame %d: %g", f,
                           hair_strain(hair, f));
    unmake(&made);
}

/* A ball beside wisp 0, between two nodes, and a flat one that moves past its tip. */
Test(hair, depth_is_along_the_normal_of_points_and_of_lines_between_them) {
    struct made made;
    make(&made, 1, (const int[]){1, 1, 1, 1});
    made.scene->bodies = calloc(1, sizeof(struct body));
    made.scene->body_count = 1;
    struct body *ball = made.scene->bodies;
    for (int i = 0; i < FRAMES * NODES * SAMPLES; i++) /* thin, so that nodes alone count */
        made.value[i / SAMPLES * COLUMNS + 9 + 2 * (i % SAMPLES)] = 1e-9;
    *ball = (struct body){.centre = {0.01, -0.15, 0}, .radii = {0.015, 0.015, 0.015}};
    struct hair *hair = opened(&made);
    struct depth depth = hair_depth(hair, 0);
    cr_assert_float_eq(depth.points, 0, 0, "%g m at nodes", depth.points);
    cr_assert_float_eq(depth.segments, 0.005, 1e-12, "%g m between nodes", depth.segments);
    *ball = (struct body){
        .centre = {0, -length - 0.015, 0}, .radii = {0.1, 0.02, 0.05}, .velocity = {0, 0.03, 0}};
    depth = hair_depth(hair, 0);
    cr_assert_float_eq(depth.points, 0.005, 1e-8, "%g m at the tip", depth.points);
    cr_assert_float_eq(depth.segments, 0.005, 1e-8, "%g m at the tip", depth.segments);
    depth = hair_depth(hair, 3);
    cr_assert_float_eq(depth.points, 0.008, 1e-8, "%g m after it moved", depth.points);
    for (int j = 0; j < SAMPLES; j++)
        row_of(&made, 0, 0, NODES - 1)[9 + 2 * j] = 0.1;
    ball->centre[0] = 0.15;
    depth = hair_depth(hair, 0);
    cr_assert_gt(depth.points, 0, "a sample in the body is not seen");
    cr_assert_float_eq(depth.segments, 0, 0);
    unmake(&made);
}

Test(hair, tips_move_along_a_direction_in_the_mean) {
    struct made made;
    make(&made, 2, (const int[]){2, 2, 3, 3});
    row_of(&made, 1, 0, NODES - 1)[3] += 0.02;
    row_of(&made, 1, 1, NODES - 1)[3] += 0.04;
    row_of(&made, 1, 1, NODES - 1)[5] += 0.5; /* across */
    row_of(&made, 2, 2, NODES - 1)[3] += 0.03;
    const struct hair *hair = opened(&made);
    const double x[3] = {1, 0, 0}, expected[3] = {0, 0.03, 0.01};
    for (int f = 0; f < 3; f++)
        cr_assert_float_eq(hair_tips_along(hair, f, x), expected[f], 1e-12, "frame %d: %g", f,
                           hair_tips_along(hair, f, x));
    unmake(&made);
}

/* Tips turned about an axis through the head's position, which has moved besides; and the head. */
Test(hair, turns_are_about_the_axis_of_the_head) {
    static const double angle = 0.6, axis[3] = {0, 1, 0};
    struct made made;
    make(&made, 2, always_two);
    struct head_motion *head = &made.scene->around.head;
    head->knots = 2;
    head->time[1] = 1 / 30.;
    head->position[1][0] = 0.5;
    head->rotation[1][1] = 0.9;
    for (int w = 0; w < 2; w++)
        for (int f = 0; f < 2; f++) {
            double *tip = row_of(&made, f, w, NODES - 1);
            const double x = 0.1 + w, z = 0.05 - w; /* from the head */
            tip[3] = f ? 0.5 + x * cos(angle) + z * sin(angle) : x;
            tip[5] = f ? -x * sin(angle) + z * cos(angle) : z;
        }
    const struct hair *hair = opened(&made);
    cr_assert_float_eq(hair_turn(hair, 0, axis), 0, 1e-15);
    cr_assert_float_eq(hair_turn(hair, 1, axis), angle, 1e-12, "%g", hair_turn(hair, 1, axis));
    cr_assert_float_eq(hair_head_turn(made.scene, 1, axis), 0.9, 1e-12);
    unmake(&made);
}

Test(hair, runs_are_compared_node_by_node_and_bit_by_bit) {
    struct made a, b;
    make(&a, 2, (const int[]){2, 2, 2, 3});
    make(&b, 2, always_two);
    row_of(&b, 1, 1, 3)[9] = nextafter(radius, 1);
    row_of(&b, 2, 1, 3)[4] += 0.008;
    opened(&a);
    opened(&b);
    cr_assert(hair_same(&a.hair, &b.hair, 0));
    cr_assert_not(hair_same(&a.hair, &b.hair, 1), "one bit of a sample");
    cr_assert_float_eq(hair_distance(&a.hair, &b.hair, 1), 0, 0);
    cr_assert_float_eq(hair_distance(&a.hair, &b.hair, 2), 0.008 / sqrt(2 * (NODES - 2)), 1e-12);
    cr_assert(isnan(hair_distance(&a.hair, &b.hair, 3)), "another number of wisps");
    cr_assert_not(hair_same(&a.hair, &b.hair, 3));
    unmake(&a);
    unmake(&b);
}

/* --- crossings --- */

/* ab along x through the origin, cd along z at height y before and after, its middle at x. */
static struct segment_pair passing(double x, double z, double before, double after) {
    return (struct segment_pair){{{-1, 0, 0}, {1, 0, 0}, {x, before, z - 1}, {x, before, z + 1}},
                                 {{-1, 0, 0}, {1, 0, 0}, {x, after, z - 1}, {x, after, z + 1}}};
}

static struct crossings count_passages(double x, double z, const double *heights, int count) {
    segment_side side = 0;
    struct crossings sum = {0, 0};
    for (int i = 0; i + 1 < count; i++) {
        const struct segment_pair pair = passing(x, z, heights[i], heights[i + 1]);
        const struct crossings one = segments_cross(&pair, &side);
        sum.count += one.count;
        sum.net += one.net;
    }
    return sum;
}

Test(crossing, passages_are_counted_and_touches_and_misses_are_not) {
    static const struct {
        const char *what;
        double x, z, heights[5];
        int count, net;
    } cases[] = {
        {"through", 0, 0, {1, 0.4, -0.3, -1, -1}, 1, 1},
        {"and back", 0, 0, {1, -1, 1, 2, 2}, 2, 0},
        {"through at the very time of a frame", 0, 0, {1, 0, -1, -1, -1}, 1, 1},
        {"through, with a halt at it", 0, 0, {1, 0, 0, -1, -1}, 1, 1},
        {"touching at a frame and back", 0, 0, {1, 0, 1, 1, 1}, 0, 0},
        {"never there", 0, 0, {1, 0.1, 1e-9, 0.1, 1}, 0, 0},
        {"past the end of ab", 1.001, 0, {1, -1, -1, -1, -1}, 0, 0},
        {"past the other end", -1.001, 0, {1, -1, -1, -1, -1}, 0, 0},
        {"past the end of cd", 0, 1.001, {1, -1, -1, -1, -1}, 0, 0},
        {"just on the ends", 0.999, 0.999, {1, -1, -1, -1, -1}, 1, 1},
        {"many times", 0, 0, {1, -1, 1, -1, 1}, 4, 0},
    };
    int sign = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct crossings found = count_passages(cases[i].x, cases[i].z, cases[i].heights, 5);
        sign = sign ? sign : found.net;
        cr_assert_eq(found.count, cases[i].count, "%s: %d", cases[i].what, found.count);
        cr_assert_eq(found.net * sign, cases[i].net, "%s: net %d", cases[i].what, found.net);
    }
    cr_assert_eq(abs(sign), 1);
}

/* Of two segments joined in a node that is passed exactly, one counts. */
Test(crossing, at_a_node_it_is_one_and_not_two) {
    const double heights[2] = {1, -1};
    const struct crossings before = count_passages(1, 0, heights, 2),
                           after = count_passages(-1, 0, heights, 2);
    cr_assert_eq(before.count + after.count, 1, "%d and %d", before.count, after.count);
}

/* The line of cd swings up to ab, meets it at time s and swings away on the same side: with ac_z =
 * t - q, cd = (0, t - p, 1) and ac_y as below the volume is 2 (t - s)^2. In rounding the double
 * root is none, one or two. */
Test(crossing, a_double_root_is_a_touch) {
    for (double s = 0.1; s < 0.9; s += 0.0013) {
        const double p = s - 0.7, q = s + 0.5;
        struct segment_pair touch = {{{-1, 0, 0}, {1, 0, 0}}, {{-1, 0, 0}, {1, 0, 0}}};
        for (int t = 0; t < 2; t++) {
            double(*at)[3] = t ? touch.after : touch.before;
            at[2][1] = at[3][1] = t * (2 * s - p - q) + p * q - s * s;
            at[2][2] = at[3][2] = t - q;
            at[3][1] += t - p;
            at[3][2] += 1;
        }
        segment_side side = 0;
        const struct crossings found = segments_cross(&touch, &side);
        cr_assert_eq(found.count, 0, "a touch at %g counts %d", s, found.count);
        cr_assert_neq(side, 0, "it is on neither side");
    }
}

Test(crossing, in_one_plane_nothing_crosses) {
    struct segment_pair plane = passing(0, 0, 0, 0);
    segment_side side = 0;
    for (int i = 0; i < 4; i++)
        plane.after[i][0] += 3 * i;
    cr_assert_eq(segments_cross(&plane, &side).count, 0);
}

/* The oracle: a thousand short intervals, in each of which the volume is nearly linear in time. */
static int crossings_by_small_steps(const struct segment_pair *pair, int *near_end) {
    enum { STEPS = 2000 };
    double last = 0;
    int count = 0;
    *near_end = 0;
    for (int n = 0; n <= STEPS; n++) {
        const double s = (double)n / STEPS;
        double p[4][3], d[3], e[3], r[3], normal[3];
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                p[i][k] = pair->before[i][k] + s * (pair->after[i][k] - pair->before[i][k]);
        for (int k = 0; k < 3; k++) {
            d[k] = p[1][k] - p[0][k];
            e[k] = p[3][k] - p[2][k];
            r[k] = p[2][k] - p[0][k];
        }
        for (int k = 0; k < 3; k++)
            normal[k] = d[(k + 1) % 3] * e[(k + 2) % 3] - d[(k + 2) % 3] * e[(k + 1) % 3];
        /* Cramer: r = x d - y e + z normal */
        const double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        double x = 0, y = 0, volume = 0;
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            x += (r[i] * e[j] - r[j] * e[i]) * normal[k] / square;
            y += (r[i] * d[j] - r[j] * d[i]) * normal[k] / square;
            volume += r[k] * normal[k];
        }
        if (n > 0 && volume * last < 0) {
            count += x >= 0 && x < 1 && y >= 0 && y < 1;
            *near_end |= fmin(fmin(fabs(x), fabs(x - 1)), fmin(fabs(y), fabs(y - 1))) < 0.02;
        }
        last = volume;
    }
    return count;
}

Test(crossing, random_motions_cross_as_often_as_in_small_steps) {
    unsigned seed = 11;
    int some = 0, several = 0;
    for (int trial = 0; trial < 2000; trial++) {
        struct segment_pair pair;
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) {
                pair.before[i][k] = lab_between(&seed, -1, 1);
                pair.after[i][k] = lab_between(&seed, -1, 1);
            }
        segment_side side = 0;
        int near_end;
        const int expected = crossings_by_small_steps(&pair, &near_end);
        const struct crossings found = segments_cross(&pair, &side);
        if (near_end)
            continue;
        cr_assert_eq(found.count, expected, "trial %d: %d, by small steps %d", trial, found.count,
                     expected);
        cr_assert(abs(found.net) <= found.count && (found.count - found.net) % 2 == 0);
        some += expected > 0;
        several += expected > 1;
    }
    cr_assert(some > 100 && several > 3, "%d trials cross, %d more than once", some, several);
}

/* Wisp 1 sweeps through wisp 0 and half way back; wisp 2 goes round wisp 0's tip. */
Test(crossing, of_wisps_are_added_up_over_frames) {
    struct made made;
    double count[FRAMES], net[FRAMES];
    make(&made, 3, (const int[]){3, 3, 3, 3});
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < NODES; i++) {
            double *one = row_of(&made, f, 1, i), *two = row_of(&made, f, 2, i);
            one[3] = (f % 2 ? -1 : 1) * 0.01;
            one[4] = -0.143;
            one[5] = 0.06 * (i - 2.7);
            two[3] = (f % 2 ? -1 : 1) * 0.3;
            two[4] = -length - 0.001;
            two[5] = 0.06 * (i - 2.7);
        }
    const struct hair *hair = opened(&made);
    cr_assert_eq(hair_crossings(hair, count, net), 0);
    for (int f = 0; f < FRAMES; f++) {
        cr_assert_float_eq(count[f], f, 0, "frame %d: %g crossings", f, count[f]);
        cr_assert_float_eq(fabs(net[f]), f % 2, 0, "frame %d: net %g", f, net[f]);
    }
    unmake(&made);
}
