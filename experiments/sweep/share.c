#include "share.h"

#include "base/complain.h"
#include "base/progress.h"
#include "pack.h"
#include "run/child.h"
#include "run/host.h"
#include "run/lock.h"
#include "work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Runs are claimed in blocks, by a lock on each: for a run of milliseconds alone a lock would cost
 * as much on a file server as the run. The nearer to the end, the smaller, so that none of many
 * processes is left with much when the others have nothing; and by the number of runs alone, so
 * that all have the same. */
static int block_size(int left) {
    enum { SHARES = 64, MOST = 32 };
    const int size = left / SHARES;
    return size < 1 ? 1 : size > MOST ? MOST : size;
}

enum { TRIES = 2 }; /* of a run that is killed from outside */

static const double round_seconds = 0.1, shortest_look = 2e-3, longest_look = 0.5, patience = 2;

struct block {
    int first, count;
    struct lock *lock; /* while it is this process's */
    int next;          /* of its runs, to be looked at */
    int running;
};

struct slot {
    struct sweep_job job; /* run < 0: free */
    struct block *block;
    struct run_case run;
    struct child child;
};

struct share {
    struct sweep *sweep;
    const struct run_sink *sink;
    const struct run_limits *limits;
    struct progress progress;
    struct pack pack;
    struct block *blocks;
    int block_count, cursor;
    struct slot *slots;
    int jobs, active, ran, killed;
    double look, pause; /* when to look for work again, monotonic s, and the time between, s */
    double waits_since; /* for others, monotonic s; 0: it does not */
    int said, damage_said;
    char plan[HASH_SIZE]; /* of all keys: blocks of another sweep are other blocks */
};

/* --- blocks --- */

static int make_blocks(struct share *share) {
    const int count = share->sweep->count;
    share->blocks = calloc((size_t)count, sizeof *share->blocks); /* they are no more than that */
    if (!share->blocks)
        return -1;
    for (int first = 0; first < count; share->block_count++) {
        const int size = block_size(count - first);
        share->blocks[share->block_count] =
            (struct block){.first = first, .count = size, .next = first};
        first += size;
    }
    return 0;
}

static void name_plan(struct share *share) {
    char both[2 * HASH_SIZE] = "";
    for (int i = 0; i < share->sweep->count; i++) {
        snprintf(both, sizeof both, "%s%s", share->plan, share->sweep->runs[i].key);
        hash_bytes(both, strlen(both), share->plan);
    }
}

static int is_settled(const struct sweep_run *run) {
    return run->cells || run->killed >= TRIES;
}

/* The next run of a block that is to be started, or -1. */
static int next_run(const struct share *share, struct block *block) {
    for (; block->next < block->first + block->count; block->next++) {
        const struct sweep_run *run = &share->sweep->runs[block->next];
        if (!is_settled(run) && !run->running)
            break;
    }
    return block->next < block->first + block->count ? block->next : -1;
}

static void start_over(struct block *block) {
    block->next = block->first;
}

/* Gives a block back when all of its runs are settled, or none of them can be any more. */
static int finish_block(struct share *share, struct block *block, char *reason) {
    if (!block->lock || block->running > 0 || (next_run(share, block) >= 0 && !stop_request))
        return 0;
    const int code = pack_settle(&share->pack, reason);
    lock_release(block->lock);
    free(block->lock);
    block->lock = NULL;
    return code;
}

/* Tries to make a block this process's own. Returns 1; 0 where another has it or nothing is left of
 * it; or -1 with a reason. */
static int claim(struct share *share, struct block *block, char *holder, char *reason) {
    char path[PATH_SIZE];
    start_over(block);
    if (next_run(share, block) < 0)
        return 0;
    if (path_format(path, "%s/.claim-%s-%d", share->pack.folder, share->plan,
                    (int)(block - share->blocks)))
        return fail_with(reason, "%.150s: the path is too long", share->pack.folder);
    block->lock = malloc(sizeof *block->lock);
    if (!block->lock)
        return fail_with(reason, "out of memory");
    const enum lock_state state = lock_take_file(block->lock, path, reason);
    if (state == LOCK_TAKEN) {
        if (pack_look(&share->pack, sweep_take, share->sweep, reason))
            return -1;
        if (next_run(share, block) >= 0)
            return 1;
        lock_release(block->lock);
    }
    free(block->lock);
    block->lock = NULL;
    if (state == LOCK_HELD)
        snprintf(holder, REASON_SIZE, "%s", reason);
    return state == LOCK_FAILED ? -1 : 0;
}

/* A block with a run to be started, from the last one on; NULL where there is none now. *failed
 * where it could not be found out, with a reason. */
static struct block *find_block(struct share *share, char *holder, int *failed, char *reason) {
    struct block *last = &share->blocks[share->cursor];
    if (last->lock && next_run(share, last) >= 0)
        return last;
    *failed = pack_look(&share->pack, sweep_take, share->sweep, reason);
    for (int k = 0; k < share->block_count && !*failed; k++) {
        struct block *block = &share->blocks[(share->cursor + k) % share->block_count];
        if (block->lock && next_run(share, block) < 0)
            continue; /* its last runs are under way */
        const int got = block->lock ? 1 : claim(share, block, holder, reason);
        *failed = got < 0;
        if (got <= 0)
            continue;
        share->cursor = (int)(block - share->blocks);
        return block;
    }
    return NULL;
}

/* --- runs --- */

/* Where states are asked for, a run has a folder, too. */
static int prepare(const struct share *share, struct slot *slot, char *reason) {
    slot->run =
        (struct run_case){.settings = {.threads = 1}, .sink = share->sink, .ctx = &slot->job};
    if (share->sweep->states == STATES_NONE)
        return 0;
    struct sweep_point point;
    int code = sweep_open(share->sweep, slot->job.run, &point, reason);
    if (!code)
        run_folder(share->sweep->out, point.scene, &point.settings, slot->run.folder);
    sweep_close(&point);
    return code ? code : make_folder(slot->run.folder, reason);
}

static int start(struct share *share, struct slot *slot, struct block *block, char *reason) {
    slot->job.run = block->next++;
    slot->block = block;
    if (prepare(share, slot, reason) ||
        child_start(&slot->child, &slot->run, share->limits, reason)) {
        slot->job.run = -1;
        return -1;
    }
    share->sweep->runs[slot->job.run].running = 1;
    block->running++;
    share->active++;
    share->ran++;
    return 0;
}

/* Fills the free slots. Returns 0, or -1 with a reason. */
static int start_some(struct share *share, char *holder, char *reason) {
    int failed = 0;
    for (int i = 0; i < share->jobs; i++) {
        struct slot *slot = &share->slots[i];
        long who;
        if (slot->job.run >= 0)
            continue;
        struct block *block = find_block(share, holder, &failed, reason);
        if (!block)
            return failed ? -1 : 0;
        if (host_enter(0, &who)) {
            snprintf(holder, REASON_SIZE, "process %ld, whose runs are timed, and alone", who);
            return 0;
        }
        if (start(share, slot, block, reason)) {
            host_leave();
            return -1;
        }
    }
    return 0;
}

/* A run whose process has ended. Returns 0, or -1 with a reason. */
static int take_back(struct share *share, struct slot *slot, enum child_state state,
                     enum outcome outcome, const char *why, char *reason) {
    const int number = slot->job.run;
    struct sweep_run *run = &share->sweep->runs[number];
    struct block *block = slot->block;
    int code = 0;
    slot->job.run = -1;
    host_leave();
    run->running = 0;
    block->running--;
    share->active--;
    share->look = 0;
    share->pause = shortest_look;
    if (state == CHILD_KILLED && !stop_request) {
        run->killed++;
        share->killed++;
        progress_end(&share->progress);
        complain(0, "run %d: %.200s; that is no result: it is %s", number + 1, why,
                 run->killed < TRIES ? "run again" : "left out");
        start_over(block);
    }
    if (state == CHILD_ENDED && outcome == OUTPUT_FAILED) {
        snprintf(reason, REASON_SIZE, "%s", why);
        code = -1;
    } else if (state == CHILD_ENDED && outcome != INTERRUPTED) {
        code = pack_append(&share->pack, run->key, slot->job.cells, reason);
        sweep_take(share->sweep, run->key, slot->job.cells);
    }
    if (state == CHILD_ENDED && outcome == INTERRUPTED)
        run_remove(slot->run.folder);
    return finish_block(share, block, reason) ? -1 : code;
}

static int tend(struct share *share, char *reason) {
    int code = 0;
    for (int i = 0; i < share->jobs; i++) {
        struct slot *slot = &share->slots[i];
        enum outcome outcome = FINISHED;
        char why[REASON_SIZE] = "";
        if (slot->job.run < 0)
            continue;
        const enum child_state state = child_poll(&slot->child, &outcome, why);
        if (state != CHILD_RUNS && take_back(share, slot, state, outcome, why, reason))
            code = -1;
    }
    /* One that was lost, for this process stood still, costs no more than runs done twice. */
    for (int i = 0; i < share->block_count && share->active > 0; i++)
        if (share->blocks[i].lock)
            lock_keep(share->blocks[i].lock);
    return code;
}

/* --- all of them --- */

static int is_done(const struct share *share) {
    const struct sweep *sweep = share->sweep;
    int left_out = sweep->count - sweep->done;
    for (int i = 0; i < sweep->count && left_out > 0 && share->killed > 0; i++)
        left_out -= !sweep->runs[i].cells && sweep->runs[i].killed >= TRIES;
    return left_out <= 0;
}

/* A damaged line does not say whose it was: perhaps of another sweep, or of a run that was done
 * again long ago. So it is told where something is left to be done, and once. */
static void say_damage(struct share *share) {
    char others[64] = "";
    if (share->pack.damaged == 0 || share->damage_said++)
        return;
    if (share->pack.damaged > 1)
        snprintf(others, sizeof others, ", and %d more in this folder", share->pack.damaged - 1);
    progress_end(&share->progress);
    complain(0, "%s: damaged%s; runs of this sweep that stand nowhere else are done again",
             share->pack.first_damaged, others);
}

/* Looks for work, and at what others have done. Returns 0, or -1 with a reason. */
static int look(struct share *share, char *reason) {
    char holder[REASON_SIZE] = "";
    int code = start_some(share, holder, reason);
    say_damage(share);
    const double now = monotonic_seconds();
    if (share->active > 0 || !*holder)
        share->waits_since = 0;
    else if (share->waits_since == 0)
        share->waits_since = now;
    else if (now - share->waits_since > patience && !share->said++) {
        progress_end(&share->progress);
        complain(0, "waiting for %s", holder);
    }
    share->look = now + share->pause;
    share->pause = fmin(2 * share->pause, longest_look);
    return code;
}

static enum outcome go_on(struct share *share, char *reason) {
    enum outcome outcome = FINISHED;
    while (share->active > 0 || (outcome == FINISHED && !is_done(share))) {
        char note[80];
        if (outcome == FINISHED && !stop_request && monotonic_seconds() >= share->look &&
            look(share, reason))
            outcome = OUTPUT_FAILED;
        if (stop_request && share->active == 0 && outcome == FINISHED && !is_done(share)) {
            snprintf(reason, REASON_SIZE, "interrupted; the same command goes on from here");
            return INTERRUPTED;
        }
        snprintf(note, sizeof note, "%d of %d runs", share->sweep->done, share->sweep->count);
        progress_show(&share->progress, (double)share->sweep->done / share->sweep->count, note);
        const int looks = outcome == FINISHED && !stop_request;
        if (share->active > 0 || (looks && !is_done(share)))
            children_wait(looks ? fmin(round_seconds, fmax(0, share->look - monotonic_seconds()))
                                : round_seconds);
        if (tend(share, reason))
            outcome = OUTPUT_FAILED;
    }
    return outcome;
}

static int open_share(struct share *share, char *reason) {
    char folder[PATH_SIZE];
    if (path_format(folder, "%s/runs", share->sweep->out))
        return fail_with(reason, "the path of the folder is too long");
    if (make_folder(folder, reason) || pack_open(&share->pack, folder) ||
        pack_look(&share->pack, sweep_take, share->sweep, reason))
        return -1;
    share->slots = calloc((size_t)share->jobs, sizeof *share->slots);
    char *cells = mmap(NULL, (size_t)share->jobs * CELLS_SIZE, PROT_READ | PROT_WRITE,
                       MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!share->slots || cells == MAP_FAILED || make_blocks(share))
        return fail_with(reason, "out of memory");
    for (int i = 0; i < share->jobs; i++)
        share->slots[i].job = (struct sweep_job){share->sweep, -1, cells + i * CELLS_SIZE};
    name_plan(share);
    return 0;
}

/* Claims of processes that are gone, when there is nothing left to be claimed. */
static void remove_claims(const struct share *share) {
    char pattern[64];
    glob_t found;
    snprintf(pattern, sizeof pattern, ".claim-%s-*", share->plan);
    files_like(share->pack.folder, pattern, &found);
    for (size_t i = 0; i < found.gl_pathc; i++)
        unlink(found.gl_pathv[i]);
    globfree(&found);
}

static void close_share(struct share *share) {
    char reason[REASON_SIZE];
    if (share->sweep->done == share->sweep->count)
        remove_claims(share);
    for (int i = 0; i < share->block_count; i++) {
        start_over(&share->blocks[i]);
        if (share->blocks[i].lock) { /* after a failure: others may try */
            lock_release(share->blocks[i].lock);
            free(share->blocks[i].lock);
        }
    }
    if (share->slots)
        munmap(share->slots[0].job.cells, (size_t)share->jobs * CELLS_SIZE);
    pack_settle(&share->pack, reason);
    pack_close(&share->pack);
    free(share->slots);
    free(share->blocks);
}

enum outcome sweep_share(struct sweep *sweep, const struct run_sink *sink,
                         const struct run_limits *limits, int jobs, int show_progress, int *ran,
                         char *reason) {
    struct share share = {.sweep = sweep,
                          .sink = sink,
                          .limits = limits,
                          .jobs = jobs,
                          .pause = shortest_look,
                          .pack = {.file = -1},
                          .progress = progress_start("runs", show_progress)};
    children_begin();
    enum outcome outcome = open_share(&share, reason) ? OUTPUT_FAILED : go_on(&share, reason);
    children_end();
    host_leave();
    progress_end(&share.progress);
    close_share(&share);
    *ran = share.ran;
    return outcome;
}
