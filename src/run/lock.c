#include "lock.h"

#include "base/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const double touch_seconds = 5, stale_seconds = 30;

static const char cannot[] = "the folder cannot be locked";

static enum lock_state fail(const char *path, const char *what, char *reason) {
    snprintf(reason, REASON_SIZE, "%.150s: %s: %s", path, what, strerror(errno));
    return LOCK_FAILED;
}

/* Reads what a lock says, and when it was last touched. It is opened, not asked by name: an open
 * makes a client of a file server ask, where else it may know things from a minute ago. Returns 0,
 * or -1 with errno. */
static int read_lock(const char *path, char text[LOCK_TEXT_SIZE], struct timespec *touched) {
    struct stat status;
    const int file = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0)
        return -1;
    ssize_t length = -1;
    errno = EEXIST; /* something else */
    if (fstat(file, &status) == 0 && S_ISREG(status.st_mode))
        length = read(file, text, LOCK_TEXT_SIZE - 1);
    const int error = errno;
    close(file);
    errno = error;
    if (length < 0)
        return -1;
    text[length] = '\0';
    *touched = status.st_mtim;
    return 0;
}

static int is_ours(const struct lock *lock) {
    char text[LOCK_TEXT_SIZE];
    struct timespec touched;
    return read_lock(lock->path, text, &touched) == 0 && strcmp(text, lock->text) == 0;
}

/* The time of the file server: that of a file which is made there now. Returns 0, or -1. */
static int server_time(const char *beside, struct timespec *now) {
    char path[PATH_SIZE];
    struct stat status;
    if (path_format(path, "%s-XXXXXX", beside))
        return -1;
    const int file = mkostemp(path, O_CLOEXEC);
    if (file < 0)
        return -1;
    const int bad = fstat(file, &status), error = errno;
    close(file);
    unlink(path);
    errno = error;
    *now = status.st_mtim;
    return bad;
}

static double seconds_between(const struct timespec *from, const struct timespec *to) {
    return difftime(to->tv_sec, from->tv_sec) + 1e-9 * (double)(to->tv_nsec - from->tv_nsec);
}

/* Whether the holder of a lock is gone, and in `holder` who that is. Returns 0, 1, or -1 with
 * errno. */
static int is_stale(const char *path, const char *text, const struct timespec *touched,
                    char holder[LOCK_TEXT_SIZE]) {
    _Static_assert(HOST_SIZE == 128, "of the format");
    struct owner owner = {.pid = 0};
    struct timespec now;
    snprintf(holder, LOCK_TEXT_SIZE, "somebody");
    if (sscanf(text, "%127s %ld %llu", owner.host, &owner.pid, &owner.start) == 3) {
        snprintf(holder, LOCK_TEXT_SIZE, "process %ld on %.*s", owner.pid,
                 (int)strcspn(owner.host, "/"), owner.host);
        const enum owner_state state = owner_look(&owner);
        if (state != OWNER_ELSEWHERE)
            return state == OWNER_GONE;
    }
    if (server_time(path, &now))
        return -1;
    return seconds_between(touched, &now) > stale_seconds;
}

/* Returns 1 where the lock is ours, 0 where there is one, or -1 with errno. The text is on its way
 * to the file server when the file is closed. */
static int make_lock(const struct lock *lock) {
    const size_t length = strlen(lock->text);
    const int file = open(lock->path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0)
        return errno == EEXIST ? 0 : -1;
    errno = ENOSPC; /* where less is written than was given */
    const int bad = write(file, lock->text, length) != (ssize_t)length, error = errno;
    if (close(file) || bad) {
        unlink(lock->path);
        errno = bad ? error : errno;
        return -1;
    }
    return 1;
}

/* What a look at a lock shows. */
enum look { FREE, HELD, STALE, UNREADABLE, UNKNOWN };

/* Looks, and says in `holder` whose it is. The last two with errno. */
static enum look look_at(const char *path, char holder[LOCK_TEXT_SIZE]) {
    char text[LOCK_TEXT_SIZE];
    struct timespec touched;
    if (read_lock(path, text, &touched))
        return errno == ENOENT ? FREE : UNREADABLE;
    const int stale = is_stale(path, text, &touched, holder);
    return stale < 0 ? UNKNOWN : stale ? STALE : HELD;
}

static enum lock_state take(struct lock *lock, char *reason);

/* Takes away a stale lock. That is done under a lock of its own, and after another look: whoever
 * saw the same holder gone may be faster, and what is there by now be its lock. (To get hold of it
 * by a rename and to link back what is not stale would leave a moment without a lock, in which a
 * third one makes its own.) Where another one is at it, that takes moments: this one naps. Returns
 * LOCK_FAILED with a reason, or LOCK_TAKEN: it may be asked for again. */
static enum lock_state break_lock(const char *path, char *reason) {
    const struct timespec moments = {.tv_nsec = 2000000};
    struct lock breaking;
    char holder[LOCK_TEXT_SIZE];
    if (path_format(breaking.path, "%s-break", path))
        return fail(path, cannot, reason);
    enum lock_state state = take(&breaking, reason);
    if (state == LOCK_FAILED)
        return state;
    if (state == LOCK_HELD) {
        nanosleep(&moments, NULL);
        return LOCK_TAKEN;
    }
    if (look_at(path, holder) == STALE && unlink(path) && errno != ENOENT)
        state = fail(path, cannot, reason);
    lock_release(&breaking);
    return state;
}

/* Tries to take the lock of a path. */
static enum lock_state take(struct lock *lock, char *reason) {
    const struct owner self = owner_self();
    unsigned random[2] = {0};
    if (getrandom(random, sizeof random, 0) < 0)
        return fail(lock->path, cannot, reason);
    snprintf(lock->text, sizeof lock->text, "%s %ld %llu %08x%08x\n", self.host, self.pid,
             self.start, random[0], random[1]);
    for (int tries = 0; tries < 10; tries++) {
        char holder[LOCK_TEXT_SIZE];
        const int made = make_lock(lock);
        if (made < 0)
            return fail(lock->path, cannot, reason);
        lock->touched = monotonic_seconds();
        if (made)
            return LOCK_TAKEN;
        switch (look_at(lock->path, holder)) {
        case FREE: /* it was just given back */
            break;
        case HELD:
            snprintf(reason, REASON_SIZE, "%s", holder);
            return LOCK_HELD;
        case STALE:
            if (break_lock(lock->path, reason) == LOCK_FAILED)
                return LOCK_FAILED;
            break;
        case UNREADABLE:
            return fail(lock->path, "is there and cannot be read", reason);
        case UNKNOWN:
            return fail(lock->path, cannot, reason);
        }
    }
    snprintf(reason, REASON_SIZE, "many processes");
    return LOCK_HELD;
}

enum lock_state lock_take_file(struct lock *lock, const char *path, char *reason) {
    return path_format(lock->path, "%s", path) ? fail(path, cannot, reason) : take(lock, reason);
}

enum lock_state lock_take(struct lock *lock, const char *folder, char *reason) {
    char path[PATH_SIZE];
    return path_format(path, "%s/.lock", folder) ? fail(folder, cannot, reason)
                                                 : lock_take_file(lock, path, reason);
}

int lock_keep(struct lock *lock) {
    const double now = monotonic_seconds();
    if (now - lock->touched < touch_seconds)
        return 0;
    if (!is_ours(lock))
        return -1;
    lock->touched = now;
    utimensat(AT_FDCWD, lock->path, NULL, AT_SYMLINK_NOFOLLOW); /* to the server's time */
    return 0;
}

void lock_release(struct lock *lock) {
    if (is_ours(lock))
        unlink(lock->path);
}
