#include "workers.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>

struct workers {
    int threads; /* besides the caller's */
    pthread_mutex_t mutex;
    pthread_cond_t begin, end;
    long round; /* counts the calls of workers_run; a new one wakes the threads */
    int busy;   /* threads that have not finished the round */
    int leave;

    void (*task)(void *ctx, int index);
    void *ctx;
    int count;
    atomic_int next; /* task to be done next */
    pthread_t thread[];
};

static void do_tasks(struct workers *w) {
    for (int i; (i = atomic_fetch_add(&w->next, 1)) < w->count;)
        w->task(w->ctx, i);
}

static void *work(void *ctx) {
    struct workers *w = ctx;
    pthread_mutex_lock(&w->mutex);
    for (long seen = 0;;) {
        while (w->round == seen && !w->leave)
            pthread_cond_wait(&w->begin, &w->mutex);
        if (w->leave)
            break;
        seen = w->round;
        pthread_mutex_unlock(&w->mutex);
        do_tasks(w);
        pthread_mutex_lock(&w->mutex);
        if (--w->busy == 0)
            pthread_cond_signal(&w->end);
    }
    pthread_mutex_unlock(&w->mutex);
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

void workers_run(struct workers *w, void (*task)(void *ctx, int index), void *ctx, int count) {
    if (!w || w->threads == 0 || count <= 1) {
        for (int i = 0; i < count; i++)
            task(ctx, i);
        return;
    }
    w->task = task;
    w->ctx = ctx;
    w->count = count;
    atomic_store(&w->next, 0);
    pthread_mutex_lock(&w->mutex);
    w->busy = w->threads;
    w->round++;
    pthread_cond_broadcast(&w->begin);
    pthread_mutex_unlock(&w->mutex);
    do_tasks(w);
    pthread_mutex_lock(&w->mutex);
    while (w->busy > 0)
        pthread_cond_wait(&w->end, &w->mutex);
    pthread_mutex_unlock(&w->mutex);
}
