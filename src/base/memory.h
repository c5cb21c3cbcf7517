/* Memory that cannot be had. Libraries that this program stands on do not all look at what malloc
 * gives, and write half a file or a wrong hash, or crash. So the program's malloc (allocator.c,
 * linked to it alone) says that here, and the process ends at once: files appear whole or not at
 * all. Only below a limit of our own, where that is a run's result, does the caller get NULL. */
#ifndef WISPLAB_MEMORY_H
#define WISPLAB_MEMORY_H

#include <signal.h>
#include <stddef.h>

/* Whether a limit of our own is there, and whether it was hit. */
extern volatile sig_atomic_t memory_is_limited, memory_was_short;

/* What is said before the end; NULL: one line on standard error. */
extern void (*memory_last_word)(void);

/* An allocation of so many bytes has failed. Returns where a limit of our own was hit; else ends
 * the process with exit code 2. Allocates nothing. */
void memory_failed(size_t bytes);

/* What was asked for or made in memory, where it is there; NULL ends the process as above. So what
 * draws, writes pages and waits for runs need not be able to go on without. Not for what runs below
 * a limit of our own, or in a program that is not ours. */
void *memory_needed(void *memory);

/* An array, owned by the caller, that has room for `count` things of so many bytes; *room is how
 * many it has room for. By the rule of memory_needed. */
void *memory_for(void *things, size_t count, size_t *room, size_t bytes);

#endif
