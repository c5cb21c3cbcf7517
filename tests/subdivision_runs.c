/* Runs of wisps that split: nothing depends on threads or on the file, and what reads runs knows
 * that their frames grow. */
#include "experiments/common/measure.h"
#include "run/reference_check.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- runs --- */

enum { FRAMES_MAX = 128 };

/* A run with frames of different sizes. */
struct film {
    struct run_result result;
    int frames, columns;
    int rows[FRAMES_MAX];
    double t[FRAMES_MAX], *row[FRAMES_MAX];
};

static int keep(void *ctx, const struct model *model, double t, const double *rows) {
    struct film *film = ctx;
    const size_t bytes = (size_t)(model->row_count * model->column_count) * sizeof *rows;
    const int f = film->frames++;
    cr_assert(f < FRAMES_MAX);
    film->columns = model->column_count;
    film->rows[f] = model->row_count;
    film->t[f] = t;
    film->row[f] = test_room(bytes);
    memcpy(film->row[f], rows, bytes);
    return 0;
}

/* Runs; 0 where the request is refused. film_free it in any case. */
static int film_make(struct film *film, const struct scene *scene,
                     const struct run_request *request) {
    struct settings settings;
    char reason[REASON_SIZE];
    *film = (struct film){.frames = 0};
    if (settings_resolve(scene, request, &settings, reason))
        return 0;
    simulate(scene, &settings, &(struct observer){keep, film}, NULL, &film->result);
    return 1;
}

/* Whether two films are the same, to the last bit, in frames before `end`. */
static int same(const struct film *a, const struct film *b, int end) {
    for (int f = 0; f < end; f++)
        if (a->rows[f] != b->rows[f] || a->t[f] != b->t[f] ||
            memcmp(a->row[f], b->row[f], (size_t)(a->rows[f] * a->columns) * sizeof *a->row[f]) !=
                0)
            return 0;
    return a->frames == b->frames;
}

/* First frame, from 0, with more rows than the one at the start; the number of frames: none. */
static int first_split(const struct film *film) {
    int f = 0;
    while (f < film->frames && film->rows[f] == film->rows[0])
        f++;
    return f;
}

/* What the scene's first line says, with every treatment. */
Test(subdivision_runs, the_shipped_scene_splits_each_wisp_once_within_a_second) {
    struct scene *scene = lab_load("subdivision", NULL, 0);
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct film film;
        const struct run_request request = {.treatment = treatment_names[treatment]};
        cr_assert(film_make(&film, scene, &request));
        const int f = first_split(&film);
        cr_assert_eq(film.result.outcome, FINISHED, "%s", film.result.reason);
        cr_assert(f >= 6 && f <= 12, "%s: frame %d", request.treatment, f + 1);
        cr_assert(film.frames == 84 && film.rows[30] == 4 * 11 && film.rows[83] == 4 * 11,
                  "%s: %d rows at frame 31, %d at the end", request.treatment, film.rows[30],
                  film.rows[83]);
        cr_assert(film.result.counters.splits == 2 && film.result.wisps == 4);
    }
}

Test(subdivision_runs, the_motion_is_another_after_the_split_and_only_then) {
    struct scene *scene = LAB_LOAD("subdivision", "duration=0.9"),
                 *without = LAB_LOAD("subdivision", "duration=0.9", "subdivision.limit=2");
    struct film film, plain;
    cr_assert(film_make(&film, scene, &(struct run_request){.stepper = "rk4"}));
    cr_assert(film_make(&plain, without, &(struct run_request){.stepper = "rk4"}));
    const int f = first_split(&film);
    cr_assert_lt(f, film.frames, "no split");
    cr_assert(same(&film, &plain, f), "the motion differs before the split");
    double most = 0;
    for (int i = 0; i < plain.rows[f] * plain.columns; i++)
        most = fmax(most, fabs(film.row[plain.frames - 1][i] - plain.row[plain.frames - 1][i]));
    cr_assert_gt(most, 1e-3, "the motion is the same after the split");
    cr_assert(plain.result.counters.splits == 0 && first_split(&plain) == plain.frames);
}

Test(subdivision_runs, a_rule_that_never_holds_changes_nothing) {
    static const char *const steppers[] = {"rk4", "cvode"};
    struct scene *scene = LAB_LOAD("interactions", "duration=0.9", "subdivision={ ratio = 1e-6; }"),
                 *without = LAB_LOAD("interactions", "duration=0.9");
    for (int i = 0; i < 2; i++) {
        struct film film, plain;
        cr_assert(film_make(&film, scene, &(struct run_request){.stepper = steppers[i]}));
        cr_assert(film_make(&plain, without, &(struct run_request){.stepper = steppers[i]}));
        cr_assert(same(&film, &plain, plain.frames), "%s: the rule alone matters", steppers[i]);
        cr_assert_eq(film.result.counters.force_evaluations,
                     plain.result.counters.force_evaluations, "%s: or costs", steppers[i]);
    }
}

/* Five that meet; with a ratio this high all split, some more than once. */
#define BUNDLE(order)                                                   \
    "duration=0.25", "run.step=2e-4", "contacts={ viscosity = 50.0; }", \
        "subdivision={ ratio = 0.9; separation = 4e-3; limit = 100; }", "wisps=(" order ")"

/* Number of wisps of b whose rows, but for their number, are one of a's, each used once. */
static int wisps_found(const struct film *a, const struct film *b, int f) {
    const int stride = a->columns;
    char used[100 * 8] = {0};
    int found = 0;
    for (int i = 0; i < b->rows[f]; i++) {
        const double *x = b->row[f] + i * stride;
        int there = 0;
        for (int k = 0; k < a->rows[f] && x[1] == 0 && !there; k++) {
            const double *y = a->row[f] + k * stride;
            int n = 0;
            while (i + n < b->rows[f] && x[n * stride] == x[0] && k + n < a->rows[f] &&
                   memcmp(x + n * stride + 1, y + n * stride + 1,
                          (size_t)(stride - 1) * sizeof *x) == 0)
                n++;
            there = y[1] == 0 && !used[k] &&
                    (i + n == b->rows[f] || b->row[f][(i + n) * stride] != x[0]);
            used[k] |= (char)there;
        }
        found += there;
    }
    return found;
}

Test(subdivision_runs, runs_do_not_depend_on_threads_or_on_the_file) {
    static const char *const steppers[] = {"rk4", "cvode"};
    struct scene *scene =
        LAB_LOAD("subdivision", BUNDLE(WISP_A "," WISP_B "," WISP_C "," WISP_D "," WISP_E));
    struct scene *other =
        LAB_LOAD("subdivision", BUNDLE(WISP_C "," WISP_E "," WISP_B "," WISP_D "," WISP_A));
    for (int m = 0; m < 2; m++) {
        struct film first, film;
        struct run_request request = {.stepper = steppers[m], .threads = 1};
        cr_assert(film_make(&first, scene, &request));
        cr_assert_eq(first.result.outcome, FINISHED, "%s", first.result.reason);
        cr_assert(first.result.wisps > 8 && first.result.wisps < 100, "%d wisps",
                  first.result.wisps); /* the limit goes by the file's order */
        for (request.threads = 2; request.threads <= 3; request.threads++) {
            cr_assert(film_make(&film, scene, &request));
            cr_assert(same(&first, &film, first.frames), "%s: threads matter", steppers[m]);
        }
        cr_assert(film_make(&film, other, &request));
        for (int f = 0; f < film.frames; f++) {
            const int wisps = (int)film.row[f][(film.rows[f] - 1) * film.columns] + 1;
            cr_assert_eq(film.rows[f], first.rows[f], "%s: frame %d", steppers[m], f);
            cr_assert_eq(wisps_found(&first, &film, f), wisps, "%s: the file matters at frame %d",
                         steppers[m], f);
        }
    }
}

/* One of two wisps swings; in penalty that alone flattens it. The other hangs and is left alone:
 * its steps go on, and its bits are those of a run in which nothing splits. */
Test(subdivision_runs, only_the_wisp_that_splits_begins_anew) {
    static const char two[] =
        "wisps=({ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.5, 0.0]; length = 0.3; nodes = 8; },"
        "{ root = [1.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.3; nodes = 8; })";
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.3", two,
                                   "subdivision={ ratio = 0.97; }"),
                 *never = LAB_LOAD("swing-envelope", "duration=0.3", two,
                                   "subdivision={ ratio = 1e-6; }");
    const struct run_request request = {.stepper = "cvode", .treatment = "penalty"};
    struct film film, plain;
    cr_assert(film_make(&film, scene, &request) && film_make(&plain, never, &request));
    cr_assert_eq(plain.result.counters.restarts, 0, "ticks restart");
    cr_assert_eq(film.result.counters.splits, 1);
    cr_assert_eq(film.result.counters.restarts, 1, "%lld restarts", film.result.counters.restarts);
    for (int f = 0; f < film.frames; f++)
        cr_assert(memcmp(film.row[f] + 8 * film.columns, plain.row[f] + 8 * film.columns,
                         8 * (size_t)film.columns * sizeof(double)) == 0,
                  "the other wisp has changed at frame %d", f + 1);
}

/* Every stepper with every treatment and linear solver, or a refusal. */
Test(subdivision_runs, slow_every_stepper_goes_on_with_the_children) {
    static const char *const solvers[] = {"direct", "klu", "cholmod", "cg"};
    struct scene *scene = LAB_LOAD("subdivision", "duration=0.9");
    int runs = 0;
    for (int i = 0; stepper_methods[i]; i++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            const int implicit = (stepper_methods[i]->capabilities & STEPPER_SOLVES) != 0;
            if (is_tried_elsewhere(stepper_methods[i]))
                continue;
            for (int solver = 0; solver < (implicit ? 4 : 1); solver++) {
                const struct run_request request = {.stepper = stepper_methods[i]->name,
                                                    .step = usual_step(scene, stepper_methods[i]),
                                                    .treatment = treatment_names[treatment],
                                                    .linear = implicit ? solvers[solver] : NULL};
                struct film film;
                if (film_make(&film, scene, &request)) {
                    cr_assert_eq(film.result.outcome, FINISHED, "%s, %s, %s: %s", request.stepper,
                                 request.treatment, solvers[solver], film.result.reason);
                    cr_assert_eq(film.result.counters.splits, 2, "%s, %s, %s: %lld splits",
                                 request.stepper, request.treatment, solvers[solver],
                                 film.result.counters.splits);
                    runs++;
                }
            }
        }
    cr_assert_geq(runs, program_method ? 3 : 3 * 6 + 2 * 7, "%d runs", runs);
}

/* --- what reads runs --- */

/* The first `frames` of a film, with the wisps of the last in another order where `turned`: rows of
 * 16 nodes change places. */
static void trajectory_of(const struct film *film, int frames, int turned,
                          struct trajectory *trajectory) {
    const int columns = film->columns + 1;
    int rows = 0;
    for (int f = 0; f < frames; f++)
        rows += film->rows[f];
    double *value = malloc((size_t)(rows * columns) * sizeof *value), *row = value;
    cr_assert(value, "no memory");
    for (int f = 0; f < frames; f++)
        for (int i = 0; i < film->rows[f]; i++, row += columns) {
            row[0] = film->t[f];
            memcpy(row + 1, film->row[f] + i * film->columns, (size_t)film->columns * sizeof *row);
        }
    for (int i = 0; i < 16 && turned; i++)
        for (int c = 2; c < columns; c++) {
            double *x = &value[(rows - 32 + i) * columns + c], *y = x + 16 * columns, z = *x;
            *x = *y;
            *y = z;
        }
    lab_trajectory(trajectory, value, rows, columns);
}

/* Runs are compared up to where their wisps are no longer the same ones. */
Test(subdivision_runs, runs_that_part_are_compared_up_to_there) {
    struct scene *scene = LAB_LOAD("subdivision", "duration=0.9"),
                 *without = LAB_LOAD("subdivision", "duration=0.9", "subdivision.limit=2");
    struct film film, plain;
    struct trajectory run, other;
    struct deviation d;
    char reason[REASON_SIZE];
    cr_assert(film_make(&film, scene, &(struct run_request){.stepper = "rk4"}));
    cr_assert(film_make(&plain, without, &(struct run_request){.stepper = "rk4"}));
    trajectory_of(&film, film.frames, 0, &run);
    trajectory_of(&plain, plain.frames, 0, &other);
    const int f = first_split(&film);

    cr_assert_eq(measure_deviation(scene, &run, &run, 1, &d, reason), 0, "%s", reason);
    cr_assert(isnan(d.history_diverged) && d.rms == 0 && d.end == 0, "a run and itself");
    cr_assert_eq(measure_deviation(scene, &run, &other, 1, &d, reason), 0, "%s", reason);
    cr_assert(d.history_diverged == film.t[f] && d.rms == 0, "they part at %g, not %g",
              d.history_diverged, film.t[f]);
    cr_assert(isnan(d.end) && isnan(d.end_largest) && isnan(d.mescd), "ends are compared");
    trajectory_free(&other);

    trajectory_of(&film, film.frames, 1, &other); /* equally many, in another order */
    cr_assert_eq(measure_deviation(scene, &run, &other, 1, &d, reason), 0, "%s", reason);
    cr_assert_eq(d.history_diverged, film.t[film.frames - 1], "they part at %g",
                 d.history_diverged);
    trajectory_free(&other);

    trajectory_of(&film, film.frames - 1, 0, &other); /* a frame less is no subdivision */
    cr_assert_eq(measure_deviation(scene, &run, &other, 1, &d, reason), -1);
    trajectory_free(&run);
    trajectory_free(&other);
}

/* A cross-check whose wisps split elsewhere gives no bound, and says why. */
Test(subdivision_runs, a_cross_check_that_parts_gives_no_bound) {
    struct scene *scene = LAB_LOAD("subdivision", "duration=0.9"),
                 *without = LAB_LOAD("subdivision", "duration=0.9", "subdivision.limit=2");
    for (int same_scene = 0; same_scene < 2; same_scene++) {
        struct kept_frames kept = {0};
        const struct run_request request = {.stepper = "reference", .rtol = 1e-8, .atol = 1e-8};
        const struct settings settings = settings_of(scene, &request);
        run_finished(scene, &request, keep_frame, &kept);
        json_t *json = cross_check(same_scene ? scene : without, &settings, &kept, NULL);
        const json_t *bound = json_object_get(json, "bound");
        if (same_scene)
            cr_assert(json_is_real(bound) && json_real_value(bound) < 1e-6, "no bound");
        else
            cr_assert(json_is_null(bound) &&
                          strstr(json_string_value(json_object_get(json, "reason")), "differ"),
                      "a bound of runs that differ");
        json_decref(json);
        kept_frames_free(&kept);
    }
}

/* A state with more wisps than the scene is no state of it. */
Test(subdivision_runs, eval_refuses_a_state_after_a_subdivision) {
    const char *const folder = folder_make();
    WORKS("run", "subdivision", "--duration", "0.9", "--out", folder, "--no-progress");
    struct finished *f =
        FAILS(1, "4 wisps", "eval", "subdivision", "--state", printed("%s/states.tsv", folder));
    cr_assert(strstr(f->err, "subdivision"), "%s", f->err);
}

/* The last column says whom a wisp split off from: one that stands on the same root. */
Test(subdivision_runs, states_name_the_parents) {
    char reason[REASON_SIZE];
    struct trajectory states;
    const char *const folder = folder_make();
    PROGRAM(NULL, "run", "subdivision", "--duration", "0.9", "--out", folder, "--no-progress");
    cr_assert_eq(trajectory_read(&states, printed("%s/states.tsv", folder), reason), 0, "%s",
                 reason);
    const int last = states.frame_count - 1;
    cr_assert_eq(states.wisp_count, 4);
    cr_assert(states.parent[0] == 0 && states.parent[1] == 1);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 2; k++) {
            const double *child = trajectory_row(&states, trajectory_wisp(&states, last, i)),
                         *other = trajectory_row(&states, trajectory_wisp(&states, last, k));
            cr_assert_eq(states.parent[i] == k,
                         memcmp(child + STATE_X, other + STATE_X, 3 * sizeof *child) == 0,
                         "wisp %d is a child of %d", i, states.parent[i]);
        }
    trajectory_free(&states);
}

/* Parts that choose their own steps have no common frames. */
Test(subdivision_runs, every_step_a_frame_is_refused_where_parts_may_come) {
    char reason[REASON_SIZE];
    struct scene *scene = LAB_LOAD("swing-envelope", "subdivision={ }");
    scene->frame_rate = 0;
    const struct run_request request = {.stepper = "cvode"};
    struct settings settings;
    cr_assert_eq(settings_resolve(scene, &request, &settings, reason), REFUSED);
    cr_assert(strstr(reason, "frame_rate"), "%s", reason);
    scene->subdivision.limit = 1;
    settings_of(scene, &request);
}
