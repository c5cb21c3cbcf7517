#include "disk.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

char disk_done[64];
int disk_noting;
void (*disk_before_unlink)(void);
int disk_hesitates;
long disk_clock;

static void note(char what) {
    const size_t used = strlen(disk_done);
    if (disk_noting && used + 1 < sizeof disk_done)
        disk_done[used] = what;
}

/* Half of the times not at all: who is held up meets who is not. */
static void hesitate(void) {
    unsigned random = 0;
    if (!disk_hesitates)
        return;
    if (getrandom(&random, sizeof random, 0) == sizeof random && random % 2)
        nanosleep(&(struct timespec){.tv_nsec = random % 1000000}, NULL);
}

int fsync(int file) {
    struct stat status;
    note(fstat(file, &status) == 0 && S_ISDIR(status.st_mode) ? 'd' : 'f');
    return (int)syscall(SYS_fsync, file);
}

int rename(const char *from, const char *to) {
    hesitate();
    note('r');
    return renameat(AT_FDCWD, from, AT_FDCWD, to);
}

int link(const char *from, const char *to) {
    hesitate();
    return linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
}

int unlink(const char *path) {
    void (*before)(void) = disk_before_unlink;
    disk_before_unlink = NULL;
    if (before)
        before();
    hesitate();
    return unlinkat(AT_FDCWD, path, 0);
}

int fstat(int file, struct stat *status) {
    hesitate();
    const int code = fstatat(file, "", status, AT_EMPTY_PATH);
    if (code == 0)
        status->st_mtim.tv_sec += disk_clock;
    return code;
}
