#include "workers.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Between two ticks of a scene of 100 wisps there may be 10 us of work, and to wake a sleeping
 * thread takes 50: a thread looks for work this often before it sleeps. A round ends with its last
 * task: nobody waits for a thread that has not woken in time. */
enum { LOOKS = 4000 };

/* The tasks of a round that are some thread's to begin with: the same ones in every round, so that
 * their data stay in its cache. (Dealt out one by one to whoever was free, 100 wisps with contacts
 * at 9000 Hz were 1.2 times as fast on two threads as on one; so they are 1.6 times.) Who has none
 * left takes them from others. The next task, and in the upper half where the share ends: one
 * number, so that both are of one round. */
struct share {
    _Alignas(64) atomic_uint_fast64_t left;
};

struct workers {
    int threads; /* the caller's included */
    pthread_mutex_t mutex;
    pthread_cond_t begin, end;
    atomic_int asleep;  /* threads that wait for `begin` */
    atomic_int waiting; /* whether the caller waits for `end` */
    atomic_uint round;  /* number of the last one that began */
    int leave;
    struct share *share; /* by thread */

    /* What belongs to a round. Who takes a task away may read it: they stay until all tasks are
     * finished. */
    void (*task)(void *ctx, int index);
    void *ctx;
    _Alignas(64) atomic_int unfinished;
    struct helper {
        struct workers *workers;
        int index;
        pthread_t thread;
    } helper[];
};

static void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

/* A task of a share, or -1. */
static int take(struct share *share) {
    uint_fast64_t left = atomic_load(&share->left);
    while ((left & 0xffffffff) < left >> 32)
        if (atomic_compare_exchange_weak(&share->left, &left, left + 1))
            return (int)(left & 0xffffffff);
    return -1;
}

static void finish_tasks(struct workers *w, int count) {
    if (count > 0 && atomic_fetch_sub(&w->unfinished, count) == count && atomic_load(&w->waiting)) {
        pthread_mutex_lock(&w->mutex);
        pthread_cond_signal(&w->end);
        pthread_mutex_unlock(&w->mutex);
    }
}

/* First one's own, then what others have not begun. */
static void do_tasks(struct workers *w, int own) {
    for (int k = 0; k < w->threads; k++) {
        struct share *share = &w->share[(own + k) % w->threads];
        int done = 0;
        for (int i; (i = take(share)) >= 0; done++)
            w->task(w->ctx, i);
        finish_tasks(w, done);
    }
}

/* Until a round begins that is not `seen`; returns whether one has, and not the end. */
static int await_work(struct workers *w, unsigned *seen) {
    for (int i = 0; i < LOOKS && atomic_load(&w->round) == *seen; i++)
        pause_briefly();
    if (atomic_load(&w->round) == *seen) {
        pthread_mutex_lock(&w->mutex);
        atomic_fetch_add(&w->asleep, 1);
        while (atomic_load(&w->round) == *seen && !w->leave)
            pthread_cond_wait(&w->begin, &w->mutex);
        atomic_fetch_sub(&w->asleep, 1);
        pthread_mutex_unlock(&w->mutex);
    }
    const unsigned round = atomic_load(&w->round);
    const int begun = round != *seen;
    *seen = round;
    return begun;
}

static void *work(void *ctx) {
    const struct helper *self = ctx;
    for (unsigned seen = 0; await_work(self->workers, &seen);)
        do_tasks(self->workers, self->index);
    return NULL;
}

struct workers *workers_create(int threads) {
    struct workers *w =
        aligned_alloc(64, (sizeof *w + (size_t)threads * sizeof *w->helper + 63) / 64 * 64);
    if (!w)
        return NULL;
    memset(w, 0, sizeof *w);
    w->share = aligned_alloc(64, (size_t)threads * sizeof *w->share);
    if (!w->share) {
        free(w);
        return NULL;
    }
    for (int i = 0; i < threads; i++)
        atomic_init(&w->share[i].left, 0);
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->begin, NULL);
    pthread_cond_init(&w->end, NULL);

    sigset_t all, before; /* signals are the first thread's business */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int there = 1;
    for (; there < threads; there++) {
        struct helper *helper = &w->helper[there];
        *helper = (struct helper){.workers = w, .index = there};
        if (pthread_create(&helper->thread, NULL, work, helper))
            break;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    w->threads = there;
    if (there == threads)
        return w;
    workers_free(w);
    return NULL;
}

void workers_free(struct workers *w) {
    if (!w)
        return;
    pthread_mutex_lock(&w->mutex);
    w->leave = 1;
    pthread_cond_broadcast(&w->begin);
    pthread_mutex_unlock(&w->mutex);
    for (int i = 1; i < w->threads; i++)
        pthread_join(w->helper[i].thread, NULL);
    pthread_mutex_destroy(&w->mutex);
    pthread_cond_destroy(&w->begin);
    pthread_cond_destroy(&w->end);
    free(w->share);
    free(w);
}

int workers_threads(const struct workers *w) {
    return w ? w->threads : 1;
}

/* Wakes the threads that sleep. One that is about to has counted itself before it looks for a round
 * a last time, and the round has begun before they are counted: nobody sleeps through it. */
static void wake(struct workers *w) {
    if (atomic_load(&w->asleep) == 0)
        return;
    pthread_mutex_lock(&w->mutex);
    pthread_cond_broadcast(&w->begin);
    pthread_mutex_unlock(&w->mutex);
}

/* Until the last task is finished, by whom ever. */
static void await_end(struct workers *w) {
    for (int i = 0; i < LOOKS; i++, pause_briefly())
        if (atomic_load(&w->unfinished) == 0)
            return;
    pthread_mutex_lock(&w->mutex);
    atomic_store(&w->waiting, 1);
    while (atomic_load(&w->unfinished) > 0)
        pthread_cond_wait(&w->end, &w->mutex);
    atomic_store(&w->waiting, 0);
    pthread_mutex_unlock(&w->mutex);
}

void workers_run(struct workers *w, void (*task)(void *ctx, int index), void *ctx, int count) {
    if (!w || w->threads == 1 || count <= 1) {
        for (int i = 0; i < count; i++)
            task(ctx, i);
        return;
    }
    w->task = task;
    w->ctx = ctx;
    atomic_store(&w->unfinished, count);
    for (int i = 0; i < w->threads; i++) {
        const uint_fast64_t from = (uint_fast64_t)count * (unsigned)i / (unsigned)w->threads;
        const uint_fast64_t to = (uint_fast64_t)count * ((unsigned)i + 1) / (unsigned)w->threads;
        atomic_store(&w->share[i].left, to << 32 | from);
    }
    atomic_fetch_add(&w->round, 1);
    wake(w);
    do_tasks(w, 0);
    await_end(w);
}
