/* Threads: each task is done once, all are done when the call returns, and a run's bits depend
 * neither on how many threads there are nor on how wide parts are. */
#include "base/workers.h"

#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TASKS_MOST = 40 };

struct work {
    atomic_int done[TASKS_MOST];
};

/* Long enough for other threads to wake, the later tasks less so. */
static void count_task(void *ctx, int index) {
    struct work *work = ctx;
    nanosleep(&(struct timespec){.tv_nsec = 20000 * (long)(TASKS_MOST - index) / TASKS_MOST}, NULL);
    atomic_fetch_add(&work->done[index], 1);
}

Test(workers, each_task_is_done_once_before_the_call_returns) {
    static const int counts[] = {0, 1, 2, 3, 7, TASKS_MOST};
    for (int threads = 1; threads <= 5; threads++) {
        struct workers *workers = workers_create(threads);
        cr_assert(workers, "no %d threads", threads);
        for (int round = 0; round < 60; round++) {
            const int count = counts[round % 6];
            struct work work = {0};
            workers_run(workers, count_task, &work, count);
            for (int i = 0; i < TASKS_MOST; i++)
                cr_assert_eq(atomic_load(&work.done[i]), i < count,
                             "%d threads, %d tasks: task %d was done %d times", threads, count, i,
                             atomic_load(&work.done[i]));
        }
        workers_free(workers);
    }
}

/* --- runs --- */

/* Nine wisps of one node count in a grid, two of another and one of a third. */
#define GRID                                                                                       \
    "wisps=({ root=[0.0, 0.0, 0.0]; direction=[1.0, 0.1, 0.0]; length=0.3; nodes=11; grid=[3, 3];" \
    "         spacing=0.05; across=([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); },"                         \
    "       { root=[1.0, 0.0, 0.0]; direction=[1.0, 0.0, 1.0]; length=0.2; nodes=7; grid=[2, 1];"  \
    "         spacing=0.05; across=([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); },"                         \
    "       { root=[0.0, 0.5, 0.0]; direction=[0.0, 1.0, 0.2]; length=0.35; nodes=12; })"
#define WIND                                                                      \
    "wind={ kind=\"irregular\"; velocity=[1.0, 0.5, 2.0]; amplitudes=[0.5, 0.2];" \
    "       frequencies=[2.0, 7.0]; }"

static void same_run(const struct lab_run *a, const struct lab_run *b, const char *what,
                     int threads) {
    const size_t size = (size_t)(a->frames * a->rows * a->columns) * sizeof *a->row;
    cr_assert(a->frames == b->frames && memcmp(a->t, b->t, (size_t)a->frames * sizeof *a->t) == 0,
              "%s: %d frames with one thread, %d with %d", what, a->frames, b->frames, threads);
    cr_assert_eq(memcmp(a->row, b->row, size), 0, "%s: other bits with %d threads", what, threads);
    cr_assert_eq(memcmp(&a->result.counters, &b->result.counters, sizeof a->result.counters), 0,
                 "%s: other counts with %d threads", what, threads);
}

static void check_threads(const struct scene *scene, struct run_request *request) {
    struct lab_run one, more;
    const char *const what = printed("%s, %s, %s", request->stepper, request->treatment,
                                     request->linear ? request->linear : "explicit");
    request->threads = 1;
    lab_take_lanes(1);
    lab_run(scene, request, &one);
    cr_assert(one.frames == 3 && one.rows == 9 * 11 + 2 * 7 + 12, "%s: %d frames of %d rows, %s",
              what, one.frames, one.rows, one.result.reason);
    for (request->threads = 2; request->threads <= 3; request->threads++) {
        lab_take_lanes(4 * (request->threads - 1));
        lab_run(scene, request, &more);
        same_run(&one, &more, what, request->threads);
    }
}

/* Every stepper on every treatment; implicit ones with each solver that takes its matrix. */
Test(workers, bits_and_counts_of_a_run_do_not_depend_on_threads_or_lanes) {
    struct scene *scene = LAB_LOAD("swing-envelope", GRID, WIND, "duration=0.01",
                                   "frame_rate=200.0", "run.step=1e-4", "run.rtol=1e-4");
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int m = 0; stepper_methods[m]; m++) {
            struct run_request request = {.stepper = stepper_methods[m]->name,
                                          .treatment = treatment_names[treatment]};
            if (!(stepper_methods[m]->capabilities & STEPPER_SOLVES)) {
                if (is_taken(scene, &request))
                    check_threads(scene, &request);
                continue;
            }
            for (int l = 0; linear_methods[l]; l++)
                if (treatment != WISP_PROJECTION ||
                    !(linear_methods[l]->needs & MATRIX_SYMMETRIC)) {
                    request.linear = linear_methods[l]->name;
                    check_threads(scene, &request);
                }
        }
}

/* As a user asks for them; the file says nothing of threads. */
Test(workers, the_program_writes_the_same_file_with_1_2_and_3_threads) {
    char *states[3];
    static const char *const threads[] = {"1", "2", "3"};
    const char *const folder = folder_make();
    const char *const path = printed("%s/states.tsv", folder);
    for (int i = 0; i < 3; i++) {
        WORKS("run", "swing-envelope", "--set", GRID, "--set", WIND, "--duration", "0.1",
              "--threads", threads[i], "--out", folder);
        states[i] = file_read(path);
        cr_assert(states[i], "no states");
    }
    cr_assert_gt(count_lines(states[0]), 4 * 125, "%d lines", count_lines(states[0]));
    for (int i = 1; i < 3; i++)
        cr_assert(strcmp(states[0], states[i]) == 0, "--threads %s: another file", threads[i]);
}
