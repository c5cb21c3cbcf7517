/* The scenes in experiments/: each loads and runs with every stepper, and those of the thesis's
 * chapter 5 show what their comments say. */
#include "experiments/common/measure.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp/interaction.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int is_scene(const struct dirent *entry) {
    const size_t length = strlen(entry->d_name);
    return length > 4 && strcmp(entry->d_name + length - 4, ".cfg") == 0;
}

/* The names of all; returns their number. */
static int shipped(struct dirent ***entries) {
    const char *const folder = printed("%s/experiments", data_folder());
    const int count = scandir(folder, entries, is_scene, alphasort);
    cr_assert_gt(count, 8, "%d scenes in %s", count, folder);
    for (int i = 0; i < count; i++)
        *strrchr((*entries)[i]->d_name, '.') = '\0';
    return count;
}

Test(shipped, every_scene_runs_with_every_stepper) {
    struct dirent **entries;
    const int count = shipped(&entries);
    for (int i = 0; i < count; i++) {
        const char *name = entries[i]->d_name;
        struct scene *scene = LAB_LOAD(name, "duration=0.005");
        for (int m = 0; stepper_methods[m]; m++) {
            const struct run_request request = {.stepper = stepper_methods[m]->name,
                                                .step = usual_step(scene, stepper_methods[m]),
                                                .threads = 2};
            struct lab_run run;
            lab_finish(scene, &request, &run);
            cr_assert_eq(run.result.counters.nodes_left_inside, 0, "%s with %s: nodes inside", name,
                         request.stepper);
        }
        free(entries[i]);
    }
    free(entries);
}

/* --- what chapter 5 shows --- */

static void run_scene(const struct scene *scene, const char *stepper, double rate,
                      struct lab_run *run) {
    const struct run_request request = {.stepper = stepper, .step = 1 / rate, .threads = 2};
    lab_finish(scene, &request, run);
    cr_assert_eq(run->result.counters.nodes_left_inside, 0, "%s, %s: nodes inside", scene->name,
                 stepper);
}

/* Rows of a wisp's first and last node at a frame; all wisps have as many nodes. */
static const double *root_of(const struct lab_run *run, int nodes, int frame, int wisp) {
    return run->row + (frame * run->rows + wisp * nodes) * run->columns;
}

/* Of the line from a node to the tip against the vertical, degrees: mean and largest. */
static double inclination_from(const struct lab_run *run, int nodes, int node, int frame,
                               double *largest) {
    const int wisps = run->rows / nodes;
    double sum = 0;
    *largest = 0;
    for (int w = 0; w < wisps; w++) {
        const double *root = root_of(run, nodes, frame, w), *a = root + node * run->columns,
                     *b = root + (nodes - 1) * run->columns;
        const double d[3] = {b[2] - a[2], b[3] - a[3], b[4] - a[4]};
        const double angle = atan2(hypot(d[0], d[2]), -d[1]) * 180 / M_PI;
        sum += angle;
        *largest = fmax(*largest, angle);
    }
    return sum / wisps;
}

static double inclination(const struct lab_run *run, int nodes, int frame, double *largest) {
    return inclination_from(run, nodes, 0, frame, largest);
}

/* Mean over all wisps of a coordinate of the tip, relative to that of the root. */
static double mean_reach(const struct lab_run *run, int nodes, int frame, int component) {
    const int wisps = run->rows / nodes;
    double sum = 0;
    for (int w = 0; w < wisps; w++) {
        const double *a = root_of(run, nodes, frame, w), *b = a + (nodes - 1) * run->columns;
        sum += b[2 + component] - a[2 + component];
    }
    return sum / wisps;
}

static double largest_strain(const struct lab_run *run, const struct scene *scene) {
    const double spacing = wisp_spacing(scene->wisps);
    double most = 0;
    for (int i = 1; i < run->frames * run->rows; i++) {
        const double *b = run->row + i * run->columns, *a = b - run->columns;
        const double d[3] = {b[2] - a[2], b[3] - a[3], b[4] - a[4]};
        if (b[1] > 0)
            most = fmax(most, fabs(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / spacing - 1));
    }
    return most;
}

/* Points found in sections, at all frames together. */
static int contacts_of(const struct lab_run *run, const struct scene *scene) {
    struct strand *strands[16];
    struct interaction *interaction = interaction_create(&scene->interaction);
    int contacts = 0;
    cr_assert(interaction && scene->wisp_count <= 16);
    for (int w = 0; w < scene->wisp_count; w++)
        strands[w] = lab_strand(&scene->wisps[w], WISP_GENERALISED);
    for (int f = 0; f < run->frames; f++) {
        for (int w = 0; w < scene->wisp_count; w++)
            strand_load(strands[w], root_of(run, scene->wisps->nodes, f, w) + 2, run->columns);
        contacts += interaction_find(interaction, strands, scene->wisp_count);
    }
    interaction_free(interaction);
    return contacts;
}

/* What the comment in experiments/radii.cfg promises. */
Test(shipped, slow_radii_shows_what_it_says) {
    static const char *const radii[] = {"envelope.radius=0.01", "envelope.radius=0.02",
                                        "envelope.radius=0.03"};
    static const double expected[] = {72.5, 65.1, 56.3};
    int contacts[3];
    for (int i = 0; i < 3; i++) {
        struct scene *scene = LAB_LOAD("radii", radii[i]);
        struct lab_run run;
        double most = 0, here;
        run_scene(scene, "rk4", 4000, &run);
        cr_assert_eq(run.frames, 123, "%d frames", run.frames);
        for (int f = 0; f < run.frames; f++) {
            inclination_from(&run, 8, 1, f, &here); /* node 1, as the experiment does */
            most = fmax(most, here);
        }
        contacts[i] = contacts_of(&run, scene);
        cr_log_info("%s: %g degrees, %d contacts", radii[i], most, contacts[i]);
        cr_assert(fabs(most - expected[i]) <= 0.1, "%s: %g degrees", radii[i], most);
    }
    cr_assert(contacts[1] > 2 * contacts[0] && 2 * contacts[2] > 3 * contacts[1],
              "%d, %d, %d contacts", contacts[0], contacts[1], contacts[2]);
}

/* That in experiments/wind.cfg, and that its start is at rest. */
Test(shipped, slow_wind_shows_what_it_says) {
    struct scene *scene = lab_load("wind", NULL, 0);
    struct lab_run run;
    double most;
    run_scene(scene, "rk4", 4000, &run);
    cr_assert(scene->wisp_count == 100 && scene->body_count == 10 && run.frames == 121);
    const double start = inclination(&run, 11, 0, &most), laid = inclination(&run, 11, 9, &most),
                 last = inclination(&run, 11, 30, &most), end = inclination(&run, 11, 120, &most);
    const double left = mean_reach(&run, 11, 9, 0), back = mean_reach(&run, 11, 45, 0);
    cr_assert(fabs(start - 28.6) <= 0.1 && fabs(laid - 80) <= 1 && last > 60 &&
                  fabs(end - start) <= 0.2,
              "leans by %g, %g, %g, %g degrees", start, laid, last, end);
    cr_assert(left > 0.2 && back < -0.02, "reaches %g, then %g m to the left", left, back);
    cr_assert_lt(largest_strain(&run, scene), 0.035);
    scene = LAB_LOAD("wind", "wind.velocity=[0.0, 0.0, 0.0]", "duration=0.3");
    run_scene(scene, "rk4", 4000, &run);
    double moved = 0;
    for (int i = 0; i < run.rows; i++)
        for (int k = 2; k < 5; k++)
            moved = fmax(moved, fabs(run.row[i * run.columns + k] -
                                     run.row[((run.frames - 1) * run.rows + i) * run.columns + k]));
    cr_assert_lt(moved, 3e-3, "a node moves by %g m without wind", moved);
}

/* That in experiments/shake.cfg. */
Test(shipped, slow_shake_shows_what_it_says) {
    struct scene *scene = lab_load("shake", NULL, 0);
    struct lab_run run;
    double most;
    run_scene(scene, "rk4", 4000, &run);
    cr_assert_eq(run.frames, 91, "%d frames", run.frames);
    static const int flies[] = {11, 22, 31};
    for (int i = 0; i < 3; i++) {
        const double mean = inclination(&run, 11, flies[i], &most);
        cr_assert(mean > 50 && mean < 66, "frame %d: %g degrees", flies[i] + 1, mean);
    }
    const double hangs = inclination(&run, 11, 45, &most), end = inclination(&run, 11, 90, &most);
    cr_assert(hangs < 31 && fabs(end - 28.6) < 0.5, "%g, %g degrees", hangs, end);
    cr_assert_lt(largest_strain(&run, scene), 0.035);
}

/* The start of a scene is another's end, to what trembles on the figure. */
static void start_is_the_end_of(const char *combed, const char *blown, struct lab_run *end) {
    struct scene *settle = lab_load(combed, NULL, 0), *wind = lab_load(blown, NULL, 0);
    struct lab_run run;
    double sum = 0;
    run_scene(settle, "rk4", 4000, &run);
    for (int i = 0; i < run.rows; i++)
        for (int k = 2; k < 5; k++) {
            const double d = run.row[((run.frames - 1) * run.rows + i) * run.columns + k] -
                             wind->start.rows[i * wind->start.columns + k];
            sum += d * d;
        }
    cr_assert_lt(sqrt(sum / run.rows), 2e-3, "rms distance %g m", sqrt(sum / run.rows));
    *end = run;
}

/* Wisps with a node before the face, seen from the front, at a frame. */
static int before_the_face(const struct lab_run *run, int nodes, int frame) {
    int wisps = 0;
    for (int w = 0; w < run->rows / nodes; w++) {
        int there = 0;
        for (int i = 2; i < nodes; i++) {
            const double *x = root_of(run, nodes, frame, w) + i * run->columns + 2;
            there |= fabs(x[0]) < 0.05 && x[1] > -0.13 && x[1] < 0.06 && x[2] > 0;
        }
        wisps += there;
    }
    return wisps;
}

/* How far the nearest tip is from the middle on the side of its root, m; negative: on the other. */
static double parted_by(const struct lab_run *run, int nodes, int frame) {
    double least = INFINITY;
    for (int w = 0; w < run->rows / nodes; w++) {
        const double *root = root_of(run, nodes, frame, w) + 2,
                     *tip = root + (nodes - 1) * run->columns;
        least = fmin(least, root[0] > 0 ? tip[0] : -tip[0]);
    }
    return least;
}

/* wind-settle is the control of parting: a field that does not part, and a face that is not free.
 */
Test(shipped, slow_starts_of_wind_are_ends_of_what_combs) {
    struct lab_run back, parted;
    start_is_the_end_of("wind-settle", "wind", &back);
    start_is_the_end_of("parting", "wind-parted", &parted);
    cr_expect_gt(parted_by(&parted, 11, 30), 0.15, "parted by %g m", parted_by(&parted, 11, 30));
    cr_expect_lt(parted_by(&back, 11, 30), 0.05, "parted by %g m", parted_by(&back, 11, 30));
    cr_expect_eq(before_the_face(&parted, 11, 180), 0);
    cr_expect_gt(before_the_face(&back, 11, 180), 1, "%d", before_the_face(&back, 11, 180));
}
