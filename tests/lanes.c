/* How wide parts are: whole runs have the same bits and counts in parts of 1, 4 and 8 wisps, where
 * wisps touch bodies, each other and themselves, where they split, and where segments are rigid. */
#include "model/problems.h"
#include "model/wisp_model.h"
#include "run/settings.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <stdlib.h>

#define RIGID "material.stretch=\"rigid\""
#define CROWDED                                                                            \
    "wisps=({ root=[0.0, 0.0, 0.0]; direction=[1.0, 0.345, -0.074]; length=0.3; nodes=11;" \
    "         grid=[5, 4]; spacing=0.012; across=([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); })"

static const char *const runs[][4] = {
    /* scene, settings, method */
    {"sphere", "duration=0.25", "run.step=1e-4", "rk4"},
    {"sphere", "duration=0.25", RIGID, "rk4"},
    {"interactions", "duration=0.15", CROWDED, "euler"},
    {"interactions", "duration=0.15", CROWDED, "bdf2"},
    {"viscosity", "duration=0.2", "run.step=1e-4", "implicit-euler"},
    {"subdivision", "duration=0.4", "run.step=1e-4", "rk4"},
    {"subdivision", "duration=0.4", "run.step=1e-3", "bdf3"},
    {"wind", "duration=0.1", "run.step=1e-4", "euler"},
    {"wind", "duration=0.1", "run.step=1e-3", "linear-euler"},
    {"wind", "duration=0.1", RIGID, "rk4"},
};
enum { RUNS = sizeof runs / sizeof *runs };

Test(lanes, runs_with_contacts_and_splits_do_not_depend_on_them) {
    long long contacts = 0, splits = 0;
    for (int r = 0; r < RUNS; r++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            struct scene *scene = LAB_LOAD(runs[r][0], runs[r][1], runs[r][2]);
            struct run_request request = lab_request(stepper_find(runs[r][3]), treatment);
            struct lab_sum one, more;
            lab_take_lanes(1);
            request.threads = 1;
            lab_sum_run(scene, &request, 1, &one);
            contacts += one.result.counters.body_contacts + one.result.counters.wisp_contacts;
            splits += one.result.counters.splits;
            for (int lanes = 4; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                const char *const what = printed("%s, %s, %s, %d lanes", runs[r][0], runs[r][3],
                                                 treatment_names[treatment], lanes);
                lab_take_lanes(lanes);
                request.threads = 1 + lanes / 4;
                lab_sum_run(scene, &request, lanes, &more);
                /* a child that takes the padding of a multistep method's part counts as a restart
                 */
                if (more.result.counters.splits > 0)
                    more.result.counters.restarts = one.result.counters.restarts;
                lab_same_sum(&more, &one, what);
            }
        }
    cr_assert(contacts > 1000 && splits > 0, "%lld contacts, %lld splits", contacts, splits);
}

/* --- the width that is taken --- */

static int width_of(int count, int other, const char *stepper, int diagnostics,
                    const char *option) {
    struct wisp wisps[40];
    unsigned seed = 5;
    const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
    const struct run_request request = {.stepper = stepper,
                                        .diagnostics = diagnostics,
                                        .options = &option,
                                        .option_count = option != NULL};
    for (int i = 0; i < count + other; i++)
        wisps[i] = lab_wisp(i < count ? 9 : 7, 4, BENDING_SKIP, &seed);
    struct scene *scene = lab_scene(wisps, count + other, &around);
    scene->duration = 1;
    scene->frame_rate = 30;
    scene->run.step = 1e-4;
    scene->run.rtol = scene->run.atol = 1e-4;
    const struct settings settings = settings_of(scene, &request);
    return settings_lanes(&settings);
}

/* As many as are not mostly padding, where they have registers; what a method or a diagnosis needs
 * goes before. */
Test(lanes, their_number_goes_by_the_wisps_and_the_method) {
#ifdef __AVX512F__
    const int widest = 8;
#else
    const int widest = kernel_of(8) == &kernel_8 ? 4 : 8; /* chosen when it runs */
#endif
    unsetenv("WISPLAB_LANES");
    cr_assert_eq(width_of(1, 0, "rk4", 0, NULL), 1);
    cr_assert_eq(width_of(1, 1, "rk4", 0, NULL), 1);
    cr_assert_eq(width_of(2, 0, "rk4", 0, NULL), 4);
    cr_assert_eq(width_of(8, 0, "rk4", 0, NULL), 4);
    cr_assert_eq(width_of(13, 0, "rk4", 0, NULL), widest);
    cr_assert_eq(width_of(8, 4, "rk4", 0, NULL), 4);
    cr_assert_eq(width_of(8, 5, "rk4", 0, NULL), widest);
    cr_assert_eq(width_of(32, 1, "bdf", 0, NULL), widest);
    cr_assert_eq(width_of(32, 0, "rk4", 1, NULL), 4);
    cr_assert_eq(width_of(32, 0, "bdf", 1, NULL), 1);
    cr_assert_eq(width_of(32, 0, "cvode", 0, NULL), 1);
    cr_assert_eq(width_of(32, 0, "cvode", 0, "lanes=4"), 4);
    cr_assert_eq(width_of(1, 0, "cvode", 0, "lanes=4"), 4);
}
