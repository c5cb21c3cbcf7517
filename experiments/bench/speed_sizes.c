/* What a step of each method costs, and how cost and memory grow with wisps, nodes and samples. */
#include "integrators/configurations.h"
#include "model/problems.h"
#include "scene/scene_detail.h"
#include "scene/scene_load.h"
#include "speed.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

/* --- steps --- */

/* Without envelope and with one. */
const char *const step_sets[STEP_SETS] = {"swing", "swing-envelope"};

enum { STEP_WISPS = 16, STEP_COUNT = 200 };
static const double step_length = 1e-4; /* s: stable with all of them */

/* The scene's first wisp many times, each a little farther to the side, for a time; the name of the
 * scene stays. */
static struct scene *crowd(const char *name, int wisps, double duration) {
    struct scene *scene = bench_scene(name, NULL, 0);
    const struct wisp first = scene->wisps[0];
    scene->wisps = realloc(scene->wisps, (size_t)wisps * sizeof *scene->wisps);
    if (!scene->wisps)
        out_of_memory();
    for (int k = 0; k < wisps; k++) {
        scene->wisps[k] = first;
        scene->wisps[k].root[2] += 0.05 * k;
    }
    scene->wisp_count = wisps;
    scene->duration = duration;
    scene->frame_rate = 1 / duration;
    return scene;
}

static struct run_request request_for(const struct configuration *method, double step) {
    int options = 0;
    while (method->options && method->options[options])
        options++;
    return (struct run_request){.stepper = method->stepper,
                                .linear = method->linear,
                                .options = method->options,
                                .option_count = options,
                                .treatment = wisp_problem.treatments[WISP_GENERALISED].name,
                                .step = step};
}

void enter_steps(struct contest *contest) {
    struct configuration *all = configurations_choose(
        CONFIGURATION_PLAIN | CONFIGURATION_MATRIX | CONFIGURATION_ITERATED, 0);
    if (!all)
        out_of_memory();
    for (int s = 0; s < STEP_SETS; s++) {
        const struct scene *scene = crowd(step_sets[s], STEP_WISPS, STEP_COUNT * step_length);
        for (int i = 0; all[i].name; i++)
            if (!(all[i].method->capabilities & STEPPER_ADAPTIVE)) {
                const struct run_request request = request_for(&all[i], step_length);
                contest_add(contest, "step", step_sets[s], all[i].name, STEP_WISPS * STEP_COUNT,
                            timed_run_do, timed_run(scene, &request));
            }
    }
    /* The contest keeps them to its end. */
}

/* --- sizes --- */

const char *const sized_methods[SIZED_METHODS] = {"euler", "rk4", "bdf2"};

/* In units of wisps and simulated seconds, each at its usual rate. Few wisps run for longer, or it
 * would be the threads' beginning and end that are measured. */
static void enter_wisps(struct contest *contest, int wisps) {
    const double duration = wisps < 64 ? 1 : 0.1;
    const struct scene *scene = crowd("swing", wisps, duration);
    char subject[SUBJECT_SIZE];
    snprintf(subject, sizeof subject, "%d", wisps);
    for (int m = 0; m < SIZED_METHODS; m++)
        for (int threads = 1; threads <= THREADS; threads++) {
            const struct configuration method = configuration_of(stepper_find(sized_methods[m]));
            struct run_request request =
                request_for(&method, 1 / stepper_usual_rate(method.method));
            char name[32];
            request.threads = threads;
            snprintf(name, sizeof name, "%s %d", method.name, threads);
            (threads == 1 ? contest_add : contest_add_wall)(contest, "wisps", subject, name,
                                                            wisps * duration, timed_run_do,
                                                            timed_run(scene, &request));
        }
}

/* In units of wisps and steps, which are so short that all numbers of nodes take them. */
static void enter_detail(struct contest *contest, const char *group, int nodes, int samples) {
    enum { WISPS = 16, STEPS = 200 };
    const double step = 1e-6;
    struct scene *scene = crowd(samples ? "swing-envelope" : "swing", WISPS, STEPS * step);
    char subject[SUBJECT_SIZE], reason[REASON_SIZE];
    if (scene_set_detail(scene, (nodes - 1.) / (scene->wisps[0].nodes - 1.), samples, reason))
        give_up("%s", reason);
    snprintf(subject, sizeof subject, "%d", samples ? samples : nodes);
    for (int m = 0; m < SIZED_METHODS; m++) {
        const struct configuration method = configuration_of(stepper_find(sized_methods[m]));
        const struct run_request request = request_for(&method, step);
        contest_add(contest, group, subject, method.name, WISPS * STEPS, timed_run_do,
                    timed_run(scene, &request));
    }
}

static size_t memory_in_use(void) {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

/* Bytes of a wisp: the model's and its stepper's. */
static void note_memory(struct contest *contest, const char *scene_name) {
    enum { WISPS = 1024 };
    const struct scene *scene = crowd(scene_name, WISPS, 1);
    for (int m = 0; m < SIZED_METHODS; m++) {
        const struct configuration method = configuration_of(stepper_find(sized_methods[m]));
        const struct run_request request = request_for(&method, 1e-4);
        const struct timed_run *run = timed_run(scene, &request);
        const size_t before = memory_in_use();
        struct model *model =
            wisp_problem.create(scene, WISP_GENERALISED, settings_lanes(&run->settings));
        if (!model)
            out_of_memory();
        struct stepper **stepper = zeros((size_t)model->part_count * sizeof *stepper);
        for (int i = 0; i < model->part_count; i++)
            if (!(stepper[i] = stepper_create(run->settings.method, &run->settings.stepper,
                                              &model->parts[i].system)))
                out_of_memory();
        contest_note(contest, "memory", scene_name, method.name,
                     (double)(memory_in_use() - before) / WISPS);
        for (int i = 0; i < model->part_count; i++)
            method.method->free(stepper[i]);
        free(stepper);
        wisp_problem.free(model);
    }
}

void enter_sizes(struct contest *contest, int quick) {
    static const int nodes[] = {6, 11, 21, 41}, samples[] = {4, 8, 16};
    const int most = quick ? 256 : 16384;
    for (int wisps = 1; wisps <= most; wisps *= 4)
        enter_wisps(contest, wisps);
    for (size_t i = 0; i < sizeof nodes / sizeof *nodes; i++)
        enter_detail(contest, "nodes", nodes[i], 0);
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++)
        enter_detail(contest, "samples", 11, samples[i]);
    for (int s = 0; s < STEP_SETS; s++)
        note_memory(contest, step_sets[s]);
}
