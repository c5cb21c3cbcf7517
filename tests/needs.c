/* What a scene needs: curves of unlike numbers of nodes against closed forms, scenes of other
 * detail, and an experiment whose verdicts follow from its numbers. */
#include "experiments/common/curve.h"
#include "experiments/common/measure.h"
#include "model/problems.h"
#include "run/identity.h"
#include "scene/scene_detail.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- curves --- */

enum { NODES_MAX = 41, POINTS = 7 };

/* The largest distance of points of a quarter circle of radius 1, by n nodes, from where equal
 * shares of its arc are. */
static double circle_error(int n) {
    double node[NODES_MAX][3], point[POINTS][3], worst = 0;
    for (int i = 0; i < n; i++) {
        const double angle = M_PI_2 * i / (n - 1);
        node[i][0] = cos(angle);
        node[i][1] = sin(angle);
        node[i][2] = 2;
    }
    curve_points(node[0], 3, n, POINTS, point);
    for (int k = 0; k < POINTS; k++) {
        const double angle = M_PI_2 * (k + 1) / POINTS;
        worst = fmax(worst, hypot(point[k][0] - cos(angle), point[k][1] - sin(angle)));
        cr_assert_float_eq(point[k][2], 2, 1e-15);
    }
    return worst;
}

/* Of second order, by the chords that measure the arc; but a polyline's sagitta at 11 nodes would
 * be 3e-3. */
Test(curve, follows_a_circle_by_equal_arcs) {
    const double coarse = circle_error(11), fine = circle_error(21), finest = circle_error(41);
    cr_assert(coarse < 3e-5, "11 nodes: %g", coarse);
    cr_assert(coarse > 4 * fine && fine > 4 * finest, "%g, %g, %g", coarse, fine, finest);
}

/* Any three nodes of a parabola give all of it: y = x^2 / 2 has the arc length
 * (x sqrt(1 + x^2) + asinh x) / 2. */
Test(curve, parabolas_are_met_by_any_number_of_nodes) {
    for (int n = 3; n <= 9; n += 3) {
        double node[NODES_MAX][3], point[POINTS][3];
        for (int i = 0; i < n; i++) {
            const double x = 2. * i / (n - 1);
            node[i][0] = x;
            node[i][1] = x * x / 2;
            node[i][2] = 0;
        }
        const double length = (2 * sqrt(5) + asinh(2)) / 2;
        curve_points(node[0], 3, n, POINTS, point);
        for (int k = 0; k < POINTS; k++) {
            const double x = point[k][0], arc = (x * sqrt(1 + x * x) + asinh(x)) / 2;
            cr_assert_float_eq(arc, length * (k + 1) / POINTS, 2e-3, "%d nodes, %d: %g", n, k, arc);
            cr_assert_float_eq(point[k][1], x * x / 2, 2e-3, "%d nodes, %d", n, k);
        }
    }
}

Test(curve, of_two_nodes_is_a_line) {
    const double node[2][3] = {{1, 2, 3}, {5, 4, 3}};
    double point[4][3];
    curve_points(node[0], 3, 2, 4, point);
    for (int k = 0; k < 4; k++)
        cr_assert(fabs(point[k][0] - 2 - k) < 1e-14 && fabs(point[k][1] - 2.5 - 0.5 * k) < 1e-14);
}

/* --- distances --- */

enum { FRAMES = 3, WISPS = 2, COLUMNS = 9 };

/* States of straight wisps whose free hair begins at (w, 0, 0) and goes down by `length`; from
 * frame to frame all moves by `slide` along z. */
static struct trajectory straight(int frames, int wisps, int nodes, double length, double slide) {
    struct trajectory made;
    const int rows = frames * wisps * nodes;
    double *value = calloc((size_t)(rows * COLUMNS), sizeof *value), *row = value;
    cr_assert(row, "no memory");
    for (int f = 0; f < frames; f++)
        for (int w = 0; w < wisps; w++)
            for (int i = 0; i < nodes; i++, row += COLUMNS) {
                row[0] = f / 30.;
                row[1] = w;
                row[2] = i;
                row[3] = w;
                row[4] = -length * (i - 1) / (nodes - 2);
                row[5] = f * slide;
            }
    lab_trajectory(&made, value, rows, COLUMNS);
    return made;
}

static struct curve_deviation distance_of(const struct trajectory *a, const struct trajectory *b) {
    const struct scene scene = {.name = "two", .wisp_count = WISPS};
    struct curve_deviation deviation;
    char reason[REASON_SIZE];
    cr_assert_eq(measure_curves(&scene, a, b, &deviation, reason), 0, "%s", reason);
    return deviation;
}

/* Nothing between equal curves; what frame f slides, f d; and where one is longer by a share e of
 * its length, e s/32 at point s of 32. */
Test(curve, distances_do_not_ask_for_equal_nodes) {
    struct trajectory few = straight(FRAMES, WISPS, 5, 1, 0),
                      many = straight(FRAMES, WISPS, 12, 1, 0),
                      slid = straight(FRAMES, WISPS, 9, 1, 0.01),
                      longer = straight(FRAMES, WISPS, 7, 1.1, 0),
                      shorter = straight(FRAMES - 1, WISPS, 12, 1, 0);
    struct curve_deviation d = distance_of(&few, &many);
    cr_assert(d.rms < 1e-14 && d.largest < 1e-14 && d.end < 1e-14, "%g", d.largest);
    d = distance_of(&few, &slid);
    cr_assert_float_eq(d.rms, 0.01 * sqrt((0 + 1 + 4) / 3.), 1e-14, "%g", d.rms);
    cr_assert_float_eq(d.largest, 0.02, 1e-14, "%g", d.largest);
    cr_assert_float_eq(d.end, 0.02, 1e-14, "%g", d.end);
    d = distance_of(&many, &longer);
    cr_assert_float_eq(d.rms, 0.1 * sqrt(33. * 65 / 6 / 32 / 32), 1e-14, "%g", d.rms);
    cr_assert_float_eq(d.largest, 0.1, 1e-14, "%g", d.largest);
    const struct scene scene = {.name = "two", .wisp_count = WISPS};
    char reason[REASON_SIZE];
    cr_assert_eq(measure_curves(&scene, &shorter, &few, &d, reason), -1);
    cr_assert_eq(measure_curves(&scene, &few, &shorter, &d, reason), -1);
    trajectory_free(&few);
    trajectory_free(&many);
    trajectory_free(&slid);
    trajectory_free(&longer);
    trajectory_free(&shorter);
}

/* The root's node is one more segment away from node 1 than the hair is long. Of one wisp, too: its
 * rows of all frames have the same number of a wisp. */
Test(curve, deviations_are_relative_to_the_length_of_their_wisp) {
    const struct scene scene = {.name = "some", .wisp_count = WISPS};
    for (int wisps = 1; wisps <= WISPS; wisps++) {
        struct trajectory still = straight(FRAMES, wisps, 6, 2, 0),
                          slid = straight(FRAMES, wisps, 6, 2, 1e-10);
        struct deviation d;
        char reason[REASON_SIZE];
        cr_assert_eq(measure_deviation(&scene, &slid, &still, 1, &d, reason), 0, "%s", reason);
        cr_assert_float_eq(d.relative, d.rms / 2.5, 1e-9 * d.rms, "%d wisps: %g of %g", wisps,
                           d.relative, d.rms);
        cr_assert_float_eq(d.rms, 1e-10 * sqrt((0 + 1 + 4) / 3.), 1e-20, "%g", d.rms);
        trajectory_free(&still);
        trajectory_free(&slid);
    }
}

/* --- scenes of other detail --- */

static double gap(const double *a, const double *b) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* `wind` begins with a state of 11 nodes and 4 samples. Of any other detail: the head has nodes 0
 * and 1 where the start has them, node 1 where it was, segments have their length at rest, and tips
 * are not far from where they were. */
Test(detail, a_start_is_carried_over) {
    static const double factors[] = {2, 1, 0.5};
    static const int samples[] = {8, 3, 6};
    struct scene *old = LAB_LOAD("wind", "gravity=[0.0, -9.81, 0.0]");
    for (int c = 0; c < 3; c++) {
        struct scene *scene = LAB_LOAD("wind", "gravity=[0.0, -9.81, 0.0]");
        char reason[REASON_SIZE];
        double worst = 0;
        cr_assert_eq(scene_set_detail(scene, factors[c], samples[c], reason), 0, "%s", reason);
        struct model *model = lab_model(scene, WISP_GENERALISED, 1);
        const int columns = model->column_count, nodes = scene->wisps[0].nodes;
        cr_assert_eq(scene->start.columns, columns);
        cr_assert_eq(scene->start.count, columns * model->row_count);
        double *head = test_room((size_t)scene->start.count * sizeof *head);
        wisp_problem.sample(model, head);
        for (int w = 0; w < scene->wisp_count; w++) {
            const double *row = scene->start.rows + w * nodes * columns;
            const double *before = old->start.rows + w * 11 * old->start.columns;
            const double spacing = wisp_spacing(&scene->wisps[w]);
            cr_assert_float_eq(spacing * (nodes - 2), 0.27, 1e-14);
            for (int k = 0; k < 2; k++)
                cr_assert(gap(row + k * columns + 2, head + (w * nodes + k) * columns + 2) < 1e-6,
                          "wisp %d, node %d", w, k);
            cr_assert(gap(row + columns + 2, before + old->start.columns + 2) < 1e-15);
            for (int i = 1; factors[c] != 1 && i + 1 < nodes; i++)
                cr_assert_float_eq(gap(row + i * columns + 2, row + (i + 1) * columns + 2), spacing,
                                   1e-14);
            worst = fmax(
                worst, gap(row + (nodes - 1) * columns + 2, before + 10 * old->start.columns + 2));
        }
        cr_assert(worst < (factors[c] < 1 ? 0.03 : 0.01), "tips move by %g", worst);
        if (factors[c] == 1)
            cr_assert(worst < 1e-15, "tips move by %g", worst);
    }
}

/* Around a node distances are linear in the angle: of 4 samples at angles 0, 90, ..., 8 are these
 * and their means. */
Test(detail, samples_are_interpolated_around_a_node) {
    struct scene *old = LAB_LOAD("wind", "gravity=[0.0, -9.81, 0.0]");
    struct scene *scene = LAB_LOAD("wind", "gravity=[0.0, -9.81, 0.0]");
    char reason[REASON_SIZE];
    int unlike = 0;
    cr_assert_eq(scene_set_detail(scene, 1, 8, reason), 0, "%s", reason);
    for (int i = 0; i < 11 * scene->wisp_count; i++) {
        const double *row = scene->start.rows + i * 24 + 8, *before = old->start.rows + i * 16 + 8;
        for (int j = 0; j < 8; j++)
            for (int part = 0; part < 2; part++) {
                const double a = before[2 * (j / 2) + part],
                             b = before[2 * ((j + 1) / 2 % 4) + part];
                cr_assert_float_eq(row[2 * j + part], (a + b) / 2, 1e-15);
                unlike += a != b;
            }
    }
    cr_assert(unlike > 0);
}

Test(detail, unchanged_is_the_same_scene_and_the_impossible_is_refused) {
    static const struct {
        const char *set;
        double factor;
        int samples;
        const char *why;
    } bad[] = {{"seed=1", 1, 0, "wisps touch"},
               {"seed=1", 2, 17, "no such number"},
               {"seed=1", 0, 4, "no such number"},
               {"subdivision={ limit = 400; }", 1, 3, "odd"}};
    struct scene *old = LAB_LOAD("interactions", "seed=1");
    struct scene *scene = LAB_LOAD("interactions", "seed=1");
    char reason[REASON_SIZE];
    cr_assert_eq(scene_set_detail(scene, 1, 4, reason), 0);
    cr_assert(json_equal(old->source, scene->source));
    cr_assert_eq(scene_set_detail(scene, 2, 4, reason), 0);
    cr_assert(!json_equal(old->source, scene->source));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scene = LAB_LOAD("interactions", bad[i].set);
        cr_assert_eq(scene_set_detail(scene, bad[i].factor, bad[i].samples, reason), -1);
        cr_assert(strstr(reason, bad[i].why), "%s", reason);
    }
    scene = LAB_LOAD("swing", "seed=1");
    cr_assert_eq(scene_set_detail(scene, 1, 4, reason), -1);
    cr_assert(strstr(reason, "no envelope"), "%s", reason);
}

/* --- the experiment --- */

static char *folder;
static const char *scene_path;

/* Two short wisps, and one of each thing that can be modelled, over three frames. */
static const char scene_text[] =
    "name = \"short\"; duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
    "material = { }; envelope = { }; contacts = { }; subdivision = { limit = 10; };\n"
    "style = { times = [0.0]; accelerations = ([0.0, 9.81, -20.0]); };\n"
    "body = ( { name = \"b\"; center = [0.2, -0.05, 0.0]; radii = [0.05, 0.05, 0.05];\n"
    "           friction = 50.0; elasticity = 0.1; offset = 1.0e-4; } );\n"
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.3; nodes = 5; },\n"
    "          { root = [0.1, 0.0, -0.1]; direction = [0.0, 0.1, 1.0]; length = 0.3; nodes = 5; } "
    ");\n"
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n";

static void set_up(void) {
    folder = folder_make();
    scene_path = file_write(folder, "short.cfg", scene_text);
}

struct row {
    char thing[32], option[40], verdict[32], model[240];
    double rms, largest, end, cpu[3], ratio, step;
};
enum { ROWS_MAX = 40 };

static int read_rows(struct row *rows) {
    struct text_table text;
    table_must_be_read(&text, folder, "needs/needs");
    const int count = text.row_count;
    cr_assert_leq(count, ROWS_MAX);
    for (int i = 0; i < count; i++) {
        struct row *r = &rows[i];
        *r = (struct row){.rms = text_table_number(&text, i, "change_rms"),
                          .largest = text_table_number(&text, i, "change_largest"),
                          .end = text_table_number(&text, i, "change_end"),
                          .cpu = {text_table_number(&text, i, "cpu_median"),
                                  text_table_number(&text, i, "cpu_least"),
                                  text_table_number(&text, i, "cpu_greatest")},
                          .ratio = text_table_number(&text, i, "cost_ratio"),
                          .step = text_table_number(&text, i, "step")};
        snprintf(r->thing, sizeof r->thing, "%s", text_table_cell(&text, i, "thing"));
        snprintf(r->option, sizeof r->option, "%s", text_table_cell(&text, i, "option"));
        snprintf(r->verdict, sizeof r->verdict, "%s", text_table_cell(&text, i, "verdict"));
        snprintf(r->model, sizeof r->model, "%s", text_table_cell(&text, i, "model"));
    }
    return count;
}

static const struct row *row_named(const struct row *rows, int count, const char *option) {
    for (int i = 0; i < count; i++)
        if (strcmp(rows[i].option, option) == 0)
            return &rows[i];
    cr_assert_fail("no row '%s'", option);
    return NULL;
}

/* Whoever is near enough is within a millimetre, and the best is the cheapest of these. */
static void check_methods(void) {
    struct text_table methods;
    double least = INFINITY, best = NAN;
    table_must_be_read(&methods, folder, "needs/methods");
    cr_assert_gt(methods.row_count, 3);
    for (int i = 0; i < methods.row_count; i++) {
        const int reached = text_table_number(&methods, i, "reached") == 1;
        const double counted = text_table_number(&methods, i, "counted");
        cr_assert_eq(reached, text_table_number(&methods, i, "error") <= 1e-3);
        if (reached)
            least = fmin(least, counted);
        if (text_table_number(&methods, i, "best") == 1)
            best = counted;
    }
    cr_assert_eq(best, least);
    cr_assert_lt(text_table_number(&methods, 0, "cost_ratio"), 1e9);
}

Test(needs, slow_verdicts_follow_from_the_numbers, .init = set_up) {
    static struct row rows[ROWS_MAX];
    struct finished *f =
        WORKS("experiment", "needs", "--quick", "--scene", scene_path, "--out", folder);
    const int count = read_rows(rows);
    cr_assert_eq(count, 1 + 2 + 4 + 2 + 1 + 2 + 3 + 2 + 6 + 2, "%d rows", count);
    for (int i = 0; i < count; i++) {
        if (strcmp(rows[i].option, "3 samples") == 0) {
            cr_assert_str_eq(rows[i].verdict, "impossible"); /* wisps split by diameters */
            continue;
        }
        cr_assert_str_eq(rows[i].verdict, rows[i].rms > 1e-3 ? "needed" : "not needed", "%s",
                         rows[i].option);
        cr_assert(rows[i].rms <= rows[i].largest && rows[i].end <= rows[i].largest);
        cr_assert_float_eq(rows[i].ratio, rows[i].cpu[0] / rows[0].cpu[0], 1e-12 * rows[i].ratio);
    }
    cr_assert_eq(rows[0].rms, 0);
    const struct row *smallest = row_named(rows, count, "smallest model");
    cr_assert(smallest->rms <= 1e-3 && smallest->ratio <= 1, "%g, %g", smallest->rms,
              smallest->ratio);
    cr_assert_str_eq(
        row_named(rows, count, "no envelope")->model,
        "9 nodes, no envelope, hinges, springs that stretch, bodies at 600 Hz, bodies, "
        "style field");
    cr_assert(row_named(rows, count, "rigid segments")->step >
                  3 * row_named(rows, count, "no bending")->step,
              "no longer steps without stretching");
    /* a field of 20 m/s^2 alone moves free hair by 10 cm in 0.1 s; the others do something */
    const double style = row_named(rows, count, "no style field")->largest;
    cr_assert(style > 0.08 && style < 0.13, "%g", style);
    cr_assert(row_named(rows, count, "no wisp contact")->rms > 1e-5, "contact changes nothing");
    cr_assert(row_named(rows, count, "no bodies")->rms > 1e-5, "bodies change nothing");
    cr_assert(row_named(rows, count, "bodies by penalty, 30 Hz")->rms > 1e-5, "nor does penalty");
    cr_assert(row_named(rows, count, "bodies at 75 Hz")->rms > 1e-5, "their rate does not either");
    cr_assert(row_named(rows, count, "wisps at 45 Hz")->rms > 1e-5, "nor that of wisps");
    cr_assert(strstr(f->out, "The cheapest method for the smallest model of short is "), "%s",
              f->out);
    check_methods();
    f = PROGRAM(NULL, "experiment", "needs", "--quick", "--scene", scene_path, "--out", folder);
    cr_assert(strstr(f->out, " 0 of them new"), "a complete search does more: %s", f->out);
    cr_assert_eq(count_files(folder, "short.svg"), 1, "no figure");
    statements_must_be_whole(printed("%s/needs", folder));
}

/* Failure is a result: without the full model there is a table that says so. */
Test(needs, without_its_runs_it_says_so, .init = set_up) {
    static struct row rows[ROWS_MAX];
    struct finished *f = WORKS("experiment", "needs", "--quick", "--scene", scene_path, "--out",
                               folder, "--time-limit", "0.0001");
    cr_assert(
        strstr(f->out, "short has no answer, for its full model's runs fail (9 nodes: out of"),
        "%s", f->out);
    statements_must_be_whole(printed("%s/needs", folder));
    const int count = read_rows(rows);
    cr_assert_eq(count, 1);
    cr_assert_str_eq(rows[0].verdict, "failed");
}

/* Of several scenes it says on how many less is enough: hair that hangs still needs fewer nodes. */
Test(needs, scenes_are_summed_up, .init = set_up) {
    const char *const bare = "name = \"%s\"; duration = %.1f; frame_rate = 30.0; "
                             "gravity = [0.0, %.2f, 0.0]; material = { };\n"
                             "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; "
                             "length = 0.3; nodes = 5; } );\n"
                             "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n";
    char text[2][512];
    snprintf(text[0], 512, bare, "still", 0.1, 0.);
    snprintf(text[1], 512, bare, "falls", 1., -9.81);
    const char *const still = file_write(folder, "still.cfg", text[0]), *const falls = file_write(
                                                                            folder, "falls.cfg",
                                                                            text[1]);
    struct finished *f = WORKS("experiment", "needs", "--quick", "--scene", still, "--scene", falls,
                               "--out", folder);
    cr_assert(
        strstr(f->out, "2 of 2 scenes stay within 1 mm of their full model with less, for ") &&
            strstr(f->out, "scenes that have it: nodes on 1 of 2, stretching on 2 of 2."),
        "%s", f->out);
    statements_must_be_whole(printed("%s/needs", folder));
}

Test(needs, compares_models_and_not_steppers, .init = set_up) {
    FAILS(1, "--stepper", "experiment", "needs", "--stepper", "rk4", "--out", folder);
}
