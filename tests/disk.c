#include "disk.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

char disk_done[64];
int disk_noting;
void (*disk_before_rename)(void);
long disk_clock;

static void note(char what) {
    const size_t used = strlen(disk_done);
    if (disk_noting && used + 1 < sizeof disk_done)
        disk_done[used] = what;
}

int fsync(int file) {
    struct stat status;
    note(fstat(file, &status) == 0 && S_ISDIR(status.st_mode) ? 'd' : 'f');
    return (int)syscall(SYS_fsync, file);
}

int rename(const char *from, const char *to) {
    void (*before)(void) = disk_before_rename;
    disk_before_rename = NULL;
    if (before)
        before();
    note('r');
    return renameat(AT_FDCWD, from, AT_FDCWD, to);
}

int fstat(int file, struct stat *status) {
    const int code = fstatat(file, "", status, AT_EMPTY_PATH);
    if (code == 0)
        status->st_mtim.tv_sec += disk_clock;
    return code;
}
