#include "workers.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Between two ticks of a scene of 100 wisps there may be 50 us of work, and to wake a sleeping
 * thread takes as long: a thread looks for work this often before it sleeps, some 50 us. A round
 * ends with its last task: nobody waits for a thread that has not woken in time. */
enum { LOOKS = 2000 };

struct workers {
    int threads; /* besides the caller's */
    pthread_mutex_t mutex;
    pthread_cond_t begin, end;
    atomic_int asleep;     /* threads that wait for `begin` */
    atomic_int waiting;    /* whether the caller waits for `end` */
    atomic_int unfinished; /* tasks */
    int leave;

    /* Tasks of the round that nobody has begun. Who takes one away may read what is below: it
     * stays until all tasks are finished. */
    atomic_int unbegun;
    void (*task)(void *ctx, int index);
    void *ctx;
    int count;
    pthread_t thread[];
};

static void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

static void do_tasks(struct workers *w) {
    int left = atomic_load(&w->unbegun);
    while (left > 0) {
        if (!atomic_compare_exchange_weak(&w->unbegun, &left, left - 1))
            continue;
        w->task(w->ctx, w->count - left);
        if (atomic_fetch_sub(&w->unfinished, 1) == 1 && atomic_load(&w->waiting)) {
            pthread_mutex_lock(&w->mutex);
            pthread_cond_signal(&w->end);
            pthread_mutex_unlock(&w->mutex);
        }
        left = atomic_load(&w->unbegun);
    }
}

/* Until there is work; returns whether there is, and not the end. */
static int await_work(struct workers *w) {
    for (int i = 0; i < LOOKS; i++, pause_briefly())
        if (atomic_load(&w->unbegun) > 0)
            return 1;
    pthread_mutex_lock(&w->mutex);
    atomic_fetch_add(&w->asleep, 1);
    while (atomic_load(&w->unbegun) == 0 && !w->leave)
        pthread_cond_wait(&w->begin, &w->mutex);
    atomic_fetch_sub(&w->asleep, 1);
    const int leave = w->leave;
    pthread_mutex_unlock(&w->mutex);
    return !leave;
}

static void *work(void *ctx) {
    while (await_work(ctx))
        do_tasks(ctx);
    return NULL;
}
struct workers *workers_create(int threads) {
    struct workers *w = calloc(1, sizeof *w + (size_t)threads * sizeof(pthread_t));
    if (!w)
        return NULL;
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->begin, NULL);
    pthread_cond_init(&w->end, NULL);

    sigset_t all, before; /* signals are the first thread's business */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (w->threads < threads - 1 && pthread_create(&w->thread[w->threads], NULL, work, w) == 0)
        w->threads++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (w->threads == threads - 1)
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
    for (int i = 0; i < w->threads; i++)
        pthread_join(w->thread[i], NULL);
    pthread_mutex_destroy(&w->mutex);
    pthread_cond_destroy(&w->begin);
    pthread_cond_destroy(&w->end);
    free(w);
}

/* Wakes the threads that sleep. One that is about to has counted itself before it looks for work a
 * last time, and work is there before it is counted: nobody sleeps through it. */
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
    if (!w || w->threads == 0 || count <= 1) {
        for (int i = 0; i < count; i++)
            task(ctx, i);
        return;
    }
    w->task = task;
    w->ctx = ctx;
    w->count = count;
    atomic_store(&w->unfinished, count);
    atomic_store(&w->unbegun, count);
    wake(w);
    do_tasks(w);
    await_end(w);
}
