#include "owner.h"

#include <ctype.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The first line of a file of /proc, or "". */
static void read_line(const char *path, char *line, int size) {
    FILE *file = fopen(path, "r");
    if (!file || !fgets(line, size, file))
        line[0] = '\0';
    if (file)
        fclose(file);
}

const char *owner_host(void) {
    static char host[HOST_SIZE];
    if (host[0])
        return host;
    const char *given = getenv("WISPLAB_HOST");
    if (given && *given) {
        snprintf(host, sizeof host, "%s", given);
    } else {
        char name[65] = "", boot[64], space[32];
        gethostname(name, sizeof name - 1);
        read_line("/proc/sys/kernel/random/boot_id", boot, sizeof boot);
        /* The kernel numbers spaces of processes: "pid:[4026531836]". */
        const ssize_t length = readlink("/proc/self/ns/pid", space, sizeof space - 1);
        space[length > 0 ? length : 0] = '\0';
        snprintf(host, sizeof host, "%s/%.8s/%s", *name ? name : "unnamed", boot, space);
    }
    for (char *c = host; *c; c++)
        if (!isgraph((unsigned char)*c))
            *c = '_';
    return host;
}

/* What proc(5) tells in /proc/PID/stat: the third word is the state, the 22nd the start. The second
 * is the program's name in parentheses, with whatever it has of blanks and parentheses. Returns 0,
 * or -1 where there is nothing to be read. */
static int read_stat(long pid, char *state, unsigned long long *start) {
    char path[64], line[1024];
    snprintf(path, sizeof path, "/proc/%ld/stat", pid);
    read_line(path, line, sizeof line);
    const char *end = strrchr(line, ')');
    return end && sscanf(end + 1,
                         " %c %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s "
                         "%*s %llu",
                         state, start) == 2
               ? 0
               : -1;
}

struct owner owner_self(void) {
    struct owner self = {.pid = (long)getpid()};
    char state;
    snprintf(self.host, sizeof self.host, "%s", owner_host());
    if (read_stat(self.pid, &state, &self.start))
        self.start = 0;
    return self;
}

enum owner_state owner_look(const struct owner *owner) {
    char state;
    unsigned long long start;
    if (strcmp(owner->host, owner_host()) != 0)
        return OWNER_ELSEWHERE;
    if (owner->pid <= 0)
        return OWNER_GONE;
    if (read_stat(owner->pid, &state, &start)) /* it may be hidden; signal 0 is none */
        return kill((pid_t)owner->pid, 0) && errno == ESRCH ? OWNER_GONE : OWNER_THERE;
    if (state == 'Z' || state == 'X') /* dead, and nobody has asked how it ended */
        return OWNER_GONE;
    return owner->start == 0 || owner->start == start ? OWNER_THERE : OWNER_GONE;
}

void signal_process(long pid, int signal) {
    if (pid > 0)
        kill((pid_t)pid, signal);
}
