/* Timed runs are alone on their host, among the runs of all processes of this program there. */
#ifndef WISPLAB_HOST_H
#define WISPLAB_HOST_H

/* Before a run: asks for a place among the runs of the host, or to be alone there. Never waits.
 * Returns 0, or 1 where it cannot be had now, with the number of a process that is in the way in
 * `*who` (0: not known). Who was refused to be alone is next: new runs of other processes wait
 * until it was, or has called host_leave. */
int host_enter(int alone, long *who);

/* After a run, or instead of asking again. */
void host_leave(void);

#endif
