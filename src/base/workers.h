/* Threads that share out independent tasks. Which thread does which task is left to chance: a
 * task's result must not depend on it. */
#ifndef WISPLAB_WORKERS_H
#define WISPLAB_WORKERS_H

struct workers;

/* `threads` in all, the caller's included; NULL where they cannot be had. With 1, no thread is
 * started. */
struct workers *workers_create(int threads);
void workers_free(struct workers *workers);

/* How many there are; of NULL, 1. */
int workers_threads(const struct workers *workers);

/* Calls task(ctx, 0), ..., task(ctx, count - 1), each once, and returns when all are done. NULL:
 * the caller does them alone, one after the other. */
void workers_run(struct workers *workers, void (*task)(void *ctx, int index), void *ctx, int count);

#endif
