/* Whose a file is: a process, told to processes of this and other hosts, and whether it is still
 * there. A file that outlives its owner may be taken or removed. */
#ifndef WISPLAB_OWNER_H
#define WISPLAB_OWNER_H

enum { HOST_SIZE = 128 };

struct owner {
    char host[HOST_SIZE];     /* see owner_host */
    long pid;                 /* of the process, on its host */
    unsigned long long start; /* when it began, in clock ticks since its host was booted: the same
                                 number at another time is another process; 0: not known */
};

/* This host: its name, its boot and its space of process numbers, separated by slashes, without
 * blanks; only where all three are the same does a process number mean the same. The environment's
 * WISPLAB_HOST takes its place: two processes of one machine then are as if on two. Static. */
const char *owner_host(void);

/* The calling process. */
struct owner owner_self(void);

/* Whether an owner is still there; only this host can be asked. */
enum owner_state { OWNER_GONE, OWNER_THERE, OWNER_ELSEWHERE };
enum owner_state owner_look(const struct owner *owner);

/* Sends a signal to a process. To numbers of 0 and below, which would be groups of processes or all
 * that the user has, nothing is ever sent: this is the one place that does. */
void signal_process(long pid, int signal);

#endif
