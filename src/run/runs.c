#include "runs.h"

#include "base/complain.h"
#include "base/memory.h"
#include "base/progress.h"
#include "child.h"
#include "host.h"
#include "lock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIES = 2 }; /* of a run that is killed from outside */

/* A round of looking after children: their ends wake it, the user's word too. */
static const double round_seconds = 0.1;

/* What others are at is looked at again after a while, which grows to the longest. */
static const double shortest_look = 2e-3, longest_look = 0.5;

/* What is waited for is said when that has taken so long. */
static const double patience = 2;

/* Says once what is being waited for. */
struct waiting {
    double since; /* monotonic s; 0: nothing is waited for */
    int said;
};

static void wait_for(struct waiting *waiting, struct progress *progress, const char *what) {
    const double now = monotonic_seconds();
    if (waiting->since == 0)
        waiting->since = now;
    if (waiting->said || now - waiting->since < patience)
        return;
    progress_end(progress);
    complain(0, "waiting for %s", what);
    waiting->said = 1;
}

static void say_who(char *what, int timed, long who) {
    char process[40] = "another process";
    if (who > 0)
        snprintf(process, sizeof process, "process %ld", who);
    snprintf(what, REASON_SIZE, "%s on this host: %s runs %s", process, timed ? "timed" : "its",
             timed ? "are alone" : "are timed, and alone");
}

/* --- one run --- */

/* Enters the host, as soon as nobody wants to be alone there. Returns 0, or -1 where the user ends
 * the program first. */
static int enter_host(struct progress *progress) {
    struct waiting waiting = {0};
    char what[REASON_SIZE];
    for (long who; host_enter(0, &who);) {
        say_who(what, 0, who);
        wait_for(&waiting, progress, what);
        children_wait(round_seconds);
        if (stop_request)
            return -1;
    }
    return 0;
}

/* The run, looked after to its end. */
static enum child_state see_through(struct child *child, struct lock *lock,
                                    struct progress *progress, enum outcome *outcome,
                                    char *reason) {
    enum child_state state;
    while ((state = child_poll(child, outcome, reason)) == CHILD_RUNS) {
        char note[80];
        const struct scene *scene = child->run->scene;
        const double gone = fmax(0, child_reached(child) - scene->begin);
        snprintf(note, sizeof note, "t = %.4g of %.4g s", scene->begin + gone,
                 scene->begin + scene->duration);
        progress_show(progress, gone / scene->duration, note);
        if (lock_keep(lock)) {
            child_abandon(child);
            snprintf(reason, REASON_SIZE, "%.150s: another host has taken the folder",
                     child->run->folder);
            *outcome = OUTPUT_FAILED;
            return CHILD_ENDED;
        }
        children_wait(round_seconds);
    }
    return state;
}

static void say_killed(const struct run_case *run, int last, const char *why,
                       struct progress *progress) {
    progress_end(progress);
    complain(0, "%.150s: %.150s; that is no result: it is %s", run->folder, why,
             last ? "left out" : "run again");
}

static enum outcome try_twice(const struct run_case *run, const struct run_limits *limits,
                              struct lock *lock, struct progress *progress, char *reason) {
    for (int i = 1; !stop_request; i++) {
        struct child child;
        enum outcome outcome = OUTPUT_FAILED;
        if (enter_host(progress))
            break;
        const enum child_state state = child_start(&child, run, limits, reason)
                                           ? CHILD_ENDED
                                           : see_through(&child, lock, progress, &outcome, reason);
        host_leave();
        if (state == CHILD_ENDED)
            return outcome;
        if (i == TRIES)
            return OUTPUT_FAILED;
        say_killed(run, 0, reason, progress);
    }
    return INTERRUPTED;
}

enum outcome runs_do_one(const struct run_case *run, const struct run_limits *limits,
                         int show_progress, char *reason) {
    struct lock lock;
    char holder[REASON_SIZE];
    if (make_folder(run->folder, reason))
        return OUTPUT_FAILED;
    const enum lock_state state = lock_take(&lock, run->folder, holder);
    if (state != LOCK_TAKEN) {
        if (state == LOCK_HELD)
            snprintf(reason, REASON_SIZE, "%.150s: another run is at work there, of %.200s",
                     run->folder, holder);
        else
            snprintf(reason, REASON_SIZE, "%s", holder);
        return OUTPUT_FAILED;
    }
    struct progress progress = progress_start(run->scene->name, show_progress);
    children_begin();
    const enum outcome outcome = try_twice(run, limits, &lock, &progress, reason);
    children_end();
    progress_end(&progress);
    lock_release(&lock);
    return outcome;
}

/* --- many runs --- */

/* A case on its way: TO_DO, RUNNING, and then SETTLED: it is there, or was left out. */
struct task {
    const struct run_case *run;
    enum { TO_DO, RUNNING, SETTLED } state;
    int started; /* by this process: what is there then need not be looked at for damage */
    int killed;  /* how often */
};

struct slot {
    struct task *task; /* NULL: free */
    struct child child;
    struct lock lock;
};

struct pool {
    struct task *tasks;
    int count, settled, ran;
    struct slot *slots;
    int jobs, active;
    int timed; /* each of its runs is alone on the host */
    const struct run_limits *limits;
    struct progress *progress;

    double look, pause; /* when to look at what can be started, monotonic s; the time between, s */
    struct waiting waiting;
};

static void settle(struct pool *pool, struct task *task) {
    task->state = SETTLED;
    pool->settled++;
}

/* Also where it was asked for more than once. */
static void leave_out(struct pool *pool, const struct run_case *run) {
    for (int i = 0; i < pool->count; i++)
        if (pool->tasks[i].state == TO_DO && strcmp(pool->tasks[i].run->folder, run->folder) == 0)
            settle(pool, &pool->tasks[i]);
    pool->ran--;
}

static struct slot *free_slot(const struct pool *pool) {
    for (int i = 0; i < pool->jobs; i++)
        if (!pool->slots[i].task)
            return &pool->slots[i];
    return NULL;
}

static void clear_slot(struct pool *pool, struct slot *slot) {
    host_leave();
    slot->task = NULL;
    pool->active--;
    pool->look = 0; /* there is room now */
    pool->pause = shortest_look;
}

/* What came of starting a case: it was; its results are there; another process is at it, or another
 * one's runs keep all of this one's from the host, with who that is in the reason; or it failed. */
enum attempt { STARTED, THERE, OTHERS, HOST_IS_TAKEN, FAILED };

/* With the lock of its folder. */
static enum attempt start_locked(struct pool *pool, struct slot *slot, struct task *task,
                                 char *reason) {
    if (run_is_complete(task->run->folder)) /* since it was looked for */
        return THERE;
    if (child_start(&slot->child, task->run, pool->limits, reason))
        return FAILED;
    task->state = RUNNING;
    task->started = 1;
    slot->task = task;
    pool->active++;
    pool->ran += task->killed == 0;
    return STARTED;
}

static enum attempt try_to_start(struct pool *pool, struct slot *slot, struct task *task,
                                 char *reason) {
    const char *folder = task->run->folder;
    long who;
    const int there = task->started ? run_is_complete(folder) : run_is_sound(folder, reason);
    if (there)
        return there > 0 ? THERE : FAILED;
    if (host_enter(pool->timed, &who)) {
        say_who(reason, pool->timed, who);
        return HOST_IS_TAKEN;
    }
    char holder[REASON_SIZE];
    enum attempt attempt = FAILED;
    if (make_folder(folder, reason) == 0) {
        const enum lock_state state = lock_take(&slot->lock, folder, holder);
        if (state == LOCK_TAKEN)
            attempt = start_locked(pool, slot, task, reason);
        if (state == LOCK_TAKEN && attempt != STARTED)
            lock_release(&slot->lock);
        if (state == LOCK_HELD) {
            attempt = OTHERS;
            snprintf(reason, REASON_SIZE, "%.150s, which %.200s is at", folder, holder);
        }
        if (state == LOCK_FAILED)
            snprintf(reason, REASON_SIZE, "%s", holder);
    }
    if (attempt != STARTED)
        host_leave();
    return attempt;
}

/* Starts what can be started, from the first case on. Returns 0, or -1 with a reason. */
static int start_some(struct pool *pool, char *reason) {
    char what[REASON_SIZE] = "";
    struct slot *slot = free_slot(pool);
    for (int i = 0; i < pool->count && slot; i++) {
        struct task *task = &pool->tasks[i];
        if (task->state != TO_DO)
            continue;
        const enum attempt attempt = try_to_start(pool, slot, task, reason);
        if (attempt == FAILED)
            return -1;
        if (attempt == THERE)
            settle(pool, task);
        if (attempt == STARTED)
            slot = free_slot(pool);
        if (attempt == OTHERS || attempt == HOST_IS_TAKEN)
            snprintf(what, sizeof what, "%s", reason);
        if (attempt == HOST_IS_TAKEN)
            break;
    }
    if (pool->active > 0 || pool->settled == pool->count)
        pool->waiting.since = 0;
    else if (what[0])
        wait_for(&pool->waiting, pool->progress, what);
    pool->look = monotonic_seconds() + pool->pause;
    pool->pause = fmin(2 * pool->pause, longest_look);
    return 0;
}

/* A run that has ended, or was ended from outside. Returns 0, or -1 with a reason. */
static int take_back(struct pool *pool, struct slot *slot, enum child_state state,
                     enum outcome outcome, char *why, char *reason) {
    struct task *task = slot->task;
    task->state = TO_DO;
    if (state == CHILD_KILLED && !stop_request) {
        const int last = ++task->killed == TRIES;
        say_killed(task->run, last, why, pool->progress);
        if (last)
            leave_out(pool, task->run);
    }
    if (state == CHILD_ENDED && outcome == INTERRUPTED)
        run_remove(task->run->folder); /* no result here: the next call is to go on with it */
    lock_release(&slot->lock);
    clear_slot(pool, slot);
    if (state == CHILD_ENDED && outcome == OUTPUT_FAILED)
        return fail_with(reason, "%s", why);
    return 0;
}

/* Looks after the children. Returns 0, or -1 with a reason. */
static int tend(struct pool *pool, char *reason) {
    int code = 0;
    for (int i = 0; i < pool->jobs; i++) {
        enum outcome outcome = FINISHED;
        char why[REASON_SIZE] = "";
        struct slot *slot = &pool->slots[i];
        if (!slot->task)
            continue;
        if (lock_keep(&slot->lock)) { /* another host is at it by now */
            child_abandon(&slot->child);
            slot->task->state = TO_DO;
            clear_slot(pool, slot);
            continue;
        }
        const enum child_state state = child_poll(&slot->child, &outcome, why);
        if (state != CHILD_RUNS && take_back(pool, slot, state, outcome, why, reason))
            code = -1;
    }
    return code;
}

static int run_pool(struct pool *pool, int total_done, int total, char *reason) {
    int code = 0;
    while (pool->active > 0 || (!code && pool->settled < pool->count)) {
        char note[80];
        if (!code && !stop_request && monotonic_seconds() >= pool->look && start_some(pool, reason))
            code = -OUTPUT_FAILED;
        if (stop_request && pool->active == 0 && !code) {
            snprintf(reason, REASON_SIZE, "interrupted; the same command goes on from here");
            code = -INTERRUPTED;
        }
        const int done = total_done + pool->settled;
        snprintf(note, sizeof note, "%d of %d runs", done, total);
        progress_show(pool->progress, (double)done / total, note);
        if (pool->active > 0 || (!code && pool->settled < pool->count))
            children_wait(fmin(round_seconds, fmax(0, pool->look - monotonic_seconds())));
        if (tend(pool, reason))
            code = -OUTPUT_FAILED;
    }
    host_leave(); /* it may have asked to be alone */
    return code;
}

/* The cases that are timed, or those that are not, through a pool of their own. Returns the number
 * that were run, or the negative of an outcome. */
static int run_kind(const struct run_case *cases, int count, int timed,
                    const struct run_limits *limits, int jobs, struct progress *progress,
                    int *total_done, char *reason) {
    struct pool pool = {.timed = timed,
                        .limits = limits,
                        .jobs = timed ? 1 : jobs,
                        .progress = progress,
                        .pause = shortest_look};
    pool.tasks = memory_needed(calloc((size_t)count + 1, sizeof *pool.tasks));
    pool.slots = memory_needed(calloc((size_t)pool.jobs, sizeof *pool.slots));
    for (int i = 0; i < count; i++)
        if ((cases[i].settings.timings > 0) == timed)
            pool.tasks[pool.count++].run = &cases[i];
    const int code = run_pool(&pool, *total_done, count, reason);
    *total_done += pool.settled;
    free(pool.tasks);
    free(pool.slots);
    return code ? code : pool.ran;
}

int runs_do_all(const struct run_case *cases, int count, const struct run_limits *limits, int jobs,
                int show_progress, char *reason) {
    struct progress progress = progress_start("runs", show_progress);
    int ran = 0, done = 0;
    children_begin();
    for (int timed = 0; timed <= 1 && ran >= 0; timed++) {
        const int now = run_kind(cases, count, timed, limits, jobs, &progress, &done, reason);
        ran = now < 0 ? now : ran + now;
    }
    children_end();
    progress_end(&progress);
    return ran;
}
