/* Where the clock begins: a run that is cut in two and goes on is the run, and ticks, frames, wind,
 * style, head and bodies are those of the time. */
#include "model/clock.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* All that depends on time at once: two wisps that touch, on a head that turns, in a wind, a style
 * field and the way of a body. */
static const char restless[] =
    "%s duration = %s; frame_rate = 20.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
    "envelope = { }; contacts = { };\n"
    "wisps = ( { root = [0.0, 0.3, 0.0]; direction = [1.0, 0.2, 0.1]; length = 0.2; nodes = 7; },\n"
    "          { root = [0.0, 0.32, 0.01]; direction = [1.0, 0.1, 0.0]; length = 0.2;\n"
    "            nodes = 7; } );\n"
    "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 2.0]; amplitudes = [1.0];\n"
    "         frequencies = [2.5]; };\n"
    "style = { times = [0.0, 0.13, 0.3]; accelerations = ([0.0, 0.0, 0.0], [0.0, 5.0, 0.0],\n"
    "          [1.0, 0.0, 0.0]); };\n"
    "head = { times = [0.05, 0.17, 0.4]; positions = ([0.0, 0.0, 0.0], [0.0, 0.02, 0.0],\n"
    "         [0.0, 0.0, 0.0]); rotations = ([0.0, 0.0, 0.0], [0.0, 0.3, 0.1], [0.0, 0.0, 0.0]);\n"
    "         };\n"
    "body = ( { name = \"b\"; center = [0.1, 0.2, 0.0]; radii = [0.1, 0.08, 0.08];\n"
    "           velocity = [0.1, 0.2, 0.0]; friction = 50.0; elasticity = 0.1; offset = 1e-4; } "
    ");\n";

static struct scene *restless_scene(const char *begin, const char *duration) {
    return lab_read(printed(restless, begin, duration));
}

/* The frame of a run as the start of a scene. */
static void start_from(struct scene *scene, const struct lab_run *run, int frame, int treatment) {
    const int count = run->rows * run->columns;
    scene->start = (struct start){.treatment = treatment,
                                  .columns = run->columns,
                                  .count = count,
                                  .rows = malloc((size_t)count * sizeof(double))};
    cr_assert(scene->start.rows, "no memory");
    memcpy(scene->start.rows, run->row + frame * count, (size_t)count * sizeof(double));
}

/* Fixed steps are the same in both pieces, but for the rounding of a position from the root; an
 * adaptive method begins anew in the middle. */
Test(begin, a_run_in_two_pieces_is_the_run) {
    struct scene *scene = restless_scene("", "0.4");
    for (int m = 0; stepper_methods[m]; m++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            if (is_tried_elsewhere(stepper_methods[m]))
                continue;
            const struct run_request request = lab_request(stepper_methods[m], treatment);
            const int adaptive = stepper_methods[m]->capabilities & STEPPER_ADAPTIVE;
            struct scene *rest = restless_scene("begin = 0.2;", "0.2");
            struct lab_run whole, second;
            double most = 0;
            lab_finish(scene, &request, &whole);
            cr_assert_eq(whole.frames, 9);
            start_from(rest, &whole, 4, treatment);
            lab_finish(rest, &request, &second);
            cr_assert_eq(second.frames, 5);
            for (int f = 0; f < 5; f++) {
                cr_assert_eq(second.t[f], whole.t[4 + f], "a frame at %.17g", second.t[f]);
                for (int i = 0; i < whole.rows; i++)
                    for (int k = 2; k < 5; k++) {
                        const int at = (f * whole.rows + i) * whole.columns + k;
                        most = fmax(most, fabs(second.row[at] -
                                               whole.row[at + 4 * whole.rows * whole.columns]));
                    }
            }
            cr_log_info("%s, %s: %g m apart, %lld and %lld contacts", request.stepper,
                        request.treatment, most, whole.result.counters.wisp_contacts,
                        whole.result.counters.body_contacts);
            cr_assert_gt(whole.result.counters.body_contacts, 100);
            cr_assert_leq(most, adaptive ? 1e-3 : 1e-11, "%s, %s: %g m apart", request.stepper,
                          request.treatment, most);
        }
}

/* Ticks and frames stay at multiples of their rates; what falls on the begin has been. */
Test(begin, ticks_and_frames_are_multiples_of_their_rates) {
    static const double begins[] = {0, 1. / 300, 0.05, 0.1, 0.2 / 3, 1e-13, 7.77, 1000, 123456.7};
    for (size_t i = 0; i < sizeof begins / sizeof *begins; i++) {
        const double begin = begins[i], same = 1e-12 * fmax(1, begin);
        struct clock clock = clock_start(begin, 0.35);
        struct stop stop;
        double last = begin;
        int frames = 0, ticks = 0;
        clock_add(&clock, STOP_COLLISION, 300, 0);
        clock_add(&clock, STOP_FRAME, 30, 0);
        while (clock_next(&clock, &stop)) {
            cr_assert_gt(stop.t, last + same, "from %g s: %.17g after %.17g", begin, stop.t, last);
            const int end = (stop.events & STOP_END) != 0;
            cr_assert(end || fabs(stop.t * 300 - round(stop.t * 300)) <= 1e-9 * fmax(1, stop.t),
                      "a stop at %.17g", stop.t);
            ticks += (stop.events & STOP_COLLISION) != 0;
            frames += (stop.events & STOP_FRAME) != 0 && !end;
            last = stop.t;
        }
        cr_assert_eq(last, begin + 0.35);
        cr_assert_eq(ticks, (int)(floor((last + same) * 300) - floor((begin + same) * 300)),
                     "from %g s: %d ticks", begin, ticks);
        cr_assert(frames == 10 || frames == 11, "from %g s: %d frames", begin, frames);
    }
}

/* Hair that nobody gave a state is in its rest shape on the head as it is then. */
Test(begin, hair_starts_at_rest_on_the_head_of_that_time) {
    struct scene *scene = restless_scene("begin = 0.11;", "0.03");
    const struct run_request request = {.stepper = "rk4"};
    struct placement head;
    struct lab_run run;
    head_placement(&scene->around.head, 0.11, &head);
    lab_finish(scene, &request, &run);
    cr_assert_eq(run.frames, 2);
    cr_assert(run.t[0] == 0.11 && run.t[1] == 0.11 + 0.03, "from %g to %g s", run.t[0], run.t[1]);
    for (int i = 0; i < run.rows; i++) {
        const double *row = run.row + i * run.columns;
        const struct wisp *wisp = &scene->wisps[(int)row[0]];
        double rest[3], p[3], v[3];
        for (int k = 0; k < 3; k++)
            rest[k] = wisp->root[k] + row[1] * wisp_spacing(wisp) * wisp->direction[k];
        placed_point(&head, 0, rest, p);
        placed_point(&head, 1, rest, v);
        for (int k = 0; k < 3; k++)
            cr_assert(fabs(row[2 + k] - p[k]) <= 1e-15 && fabs(row[5 + k] - v[k]) <= 1e-14,
                      "node %g is not where the head has it", row[1]);
    }
}

/* --- as a user meets it --- */

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

/* The second half of a run from what the first has saved, with further settings. */
static const char *go_on(const char *settings) {
    static char text[2048];
    const char *const wind =
        "frame_rate = 2.0; gravity = [0.0, 0.0, 0.0]; material = { };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.3;\n"
        "            nodes = 3; } );\n";
    snprintf(text, sizeof text, "duration = 0.5;\n%s%s", wind, settings);
    return WORKS("run", file_write(folder, "hair.cfg", text), "--out", printed("%s/run", folder),
                 "--no-progress")
        ->err;
}

#define IRREGULAR                                                                      \
    "wind = { kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; amplitudes = [1.0];\n" \
    "         frequencies = [0.5]; };\n"
#define STEADY "wind = { kind = \"steady\"; velocity = [1.0, 0.0, 0.0]; };\n"
#define STYLE  "style = { times = [0.0, 1.0]; accelerations = ([0, 0, 0], [1, 0, 0]); };\n"
#define HEAD                                                                         \
    "head = { times = [0.0, 0.4]; positions = ([0, 0, 0], [0, 0, 0]); rotations = (" \
    "[0, 0, 0], [0, 0, 0]); };\n"
#define START "start = \"state.tsv\"; "

Test(begin, a_start_without_begin_warns_where_time_matters, .init = open_folder) {
    static const struct {
        const char *settings;
        int warned;
    } cases[] = {{IRREGULAR, 0},
                 {START STEADY, 0},
                 {START IRREGULAR, 1},
                 {START "begin = 0.5; " IRREGULAR, 0},
                 {START "begin = 0.0; " IRREGULAR, 0},
                 {START STYLE, 1},
                 {START HEAD, 1},
                 {START, 0}};
    go_on(STEADY);
    file_write(folder, "state.tsv", file_of(folder, "run/states.tsv"));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *said = go_on(cases[i].settings);
        cr_assert_eq(strstr(said, "warning: start without begin") != NULL, cases[i].warned,
                     "case %zu: %s", i, said);
        cr_assert_eq(strstr(file_of(folder, "run/run.json"), "\"start without begin") != NULL,
                     cases[i].warned, "case %zu", i);
    }
}

/* `eval` looks at the start as it is at the begin, and --time counts from 0. */
Test(begin, eval_is_at_the_begin, .init = open_folder) {
    static const char *const times[] = {"0.11", "0.3"};
    const char *const scene =
        file_write(folder, "hair.cfg", printed(restless, "begin = 0.11;", "0.1"));
    const char *begun = WORKS("eval", scene)->out;
    for (int i = 0; i < 2; i++)
        cr_assert_eq(strcmp(begun, WORKS("eval", scene, "--time", times[i])->out) == 0, i == 0,
                     "at %s s", times[i]);
    cr_assert(strstr(begun, "accelerations at t = 0.11"), "%s", begun);
    FAILS(1, "begin", "run", "circle", "--set", "begin=1.0", "--no-progress");
}
