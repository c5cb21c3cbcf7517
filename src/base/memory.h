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

#endif
