#include "host.h"

#include "base/complain.h"
#include "base/hash.h"
#include "base/owner.h"
#include "base/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

/* Record locks in a file that only this host has, in memory. Who runs has the room, with others or
 * alone. Who enters it passes the gate; who wants to be alone closes the gate behind itself and
 * waits until the room is empty. Who waits stands in the queue; who was alone lets those in who do
 * before it is alone again, or a series of timed runs would keep everybody else out to its end. The
 * locks go with the process that has them, however it ends, and the system tells who that is. */
enum place { GATE, ROOM, QUEUE, PLACES = 4 };

static int inside;       /* runs of this process that have entered */
static int was_alone;    /* the last of them */
static double left_room; /* then, monotonic s */

/* A process in the queue that is stopped holds up nobody for longer, s. */
static const double courtesy = 1;

/* The file, or -1 where there can be none. It is for all users of the host. */
static int open_file(void) {
    static int file = -2;
    if (file == -2)
        file = shm_open("/wisplab", O_RDWR, 0);
    if (file < 0) { /* in a folder for all, who does not own a file may not ask to make it */
        file = shm_open("/wisplab", O_RDWR | O_CREAT, 0666);
        if (file >= 0)
            fchmod(file, 0666);
    }
    return file;
}

/* A few bytes for each host by name: one machine may have several. */
static struct flock record(enum place place, int type) {
    static long long at;
    if (!at) {
        char hash[HASH_SIZE];
        hash_bytes(owner_host(), strlen(owner_host()), hash);
        at = (long long)(strtoull(hash, NULL, 16) >> 4);
    }
    return (struct flock){
        .l_type = (short)type, .l_whence = SEEK_SET, .l_start = PLACES * at + place, .l_len = 1};
}

/* Returns 0; 1 where another process has it, `*who`; or -1 with errno. */
static int get(enum place place, int type, long *who) {
    struct flock wanted = record(place, type), other = wanted;
    if (fcntl(open_file(), F_SETLK, &wanted) == 0)
        return 0;
    if (errno != EAGAIN && errno != EACCES)
        return -1;
    *who = fcntl(open_file(), F_GETLK, &other) == 0 && other.l_type != F_UNLCK ? other.l_pid : 0;
    return 1;
}

static void give_back(enum place place) {
    struct flock none = record(place, F_UNLCK);
    fcntl(open_file(), F_SETLK, &none);
}

/* Whether somebody has waited since this process was alone, `*who`. */
static int must_let_others_in(long *who) {
    struct flock other = record(QUEUE, F_WRLCK);
    if (!was_alone || monotonic_seconds() - left_room > courtesy ||
        fcntl(open_file(), F_GETLK, &other) || other.l_type == F_UNLCK)
        return 0;
    *who = other.l_pid;
    return 1;
}

int host_enter(int alone, long *who) {
    static int said;
    const int type = alone ? F_WRLCK : F_RDLCK;
    int code = open_file() < 0 ? -1 : alone && must_let_others_in(who) ? 1 : get(GATE, type, who);
    if (code == 0)
        code = get(ROOM, type, who);
    if (!alone && code >= 0)
        give_back(GATE);
    if (code > 0) {
        long nobody;
        get(QUEUE, F_RDLCK, &nobody);
        return 1;
    }
    if (code < 0 && alone && !said++)
        complain(0, "timed runs may not be alone on this host: no lock in its shared memory: %s",
                 strerror(errno));
    if (code == 0)
        give_back(QUEUE);
    was_alone = alone;
    inside++;
    return 0;
}

void host_leave(void) {
    inside -= inside > 0;
    if (inside > 0 || open_file() < 0)
        return;
    give_back(QUEUE);
    give_back(ROOM);
    give_back(GATE);
    left_room = monotonic_seconds();
}
