/* The lock of a run's folder, by which processes on any number of machines share work: a file
 * called .lock that is made with O_EXCL, in which file servers too let only one succeed, and that
 * says whose it is: host, process, the time it began. On one host, a holder that is gone is seen at
 * once. One of another host touches its lock every 5 s; it is taken for gone when it has not for
 * 30 s, by the clock of the file server, which alone is the same for all. A lock file that says
 * nothing, for its writer was killed before that, is as if of another host. */
#ifndef WISPLAB_LOCK_H
#define WISPLAB_LOCK_H

#include "base/files.h"
#include "base/owner.h"

enum { LOCK_TEXT_SIZE = HOST_SIZE + 80 };

struct lock {
    char path[PATH_SIZE];
    char text[LOCK_TEXT_SIZE]; /* that no other lock has */
    double touched;            /* monotonic s */
};

enum lock_state {
    LOCK_TAKEN,
    LOCK_HELD,  /* by another process: `reason` says which one */
    LOCK_FAILED /* there cannot be one: `reason` says why */
};

/* Tries to take the lock of a folder, which must be there; waits for moments at most. */
enum lock_state lock_take(struct lock *lock, const char *folder, char *reason);

/* Tries to take the lock of a part of the work in a folder: the lock is a file of that path. */
enum lock_state lock_take_file(struct lock *lock, const char *path, char *reason);

/* To be called at least every few seconds while a lock is held. Returns 0, or -1 where it has been
 * lost: this process had not called for so long that another one has taken it for gone. */
int lock_keep(struct lock *lock);

/* Lets go of a lock that was taken; one that was lost is left to its new holder. */
void lock_release(struct lock *lock);

#endif
