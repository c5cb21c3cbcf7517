#include "stop.h"

#include "base/complain.h"

#include <sys/time.h>
#include <unistd.h>

volatile sig_atomic_t stop_request;

/* Most loops look at stop_request and end tidily. Whatever is not such a loop, a file of a gigabyte
 * that is read, a library's call, is left where it stands: files appear whole or not at all, and
 * the system ends the children with us. */
static const suseconds_t patience = 500000; /* microseconds after the signal */

static volatile sig_atomic_t answers_itself;

static void leave(int signal) {
    (void)signal;
    complain_last("interrupted");
    _exit(outcome_exit_code(INTERRUPTED));
}

static void on_signal(int signal) {
    const struct itimerval timer = {.it_value = {0, patience}};
    (void)signal;
    if (answers_itself && !stop_request)
        setitimer(ITIMER_REAL, &timer, NULL);
    stop_request = INTERRUPTED;
}

int runs_interrupted(void) {
    return stop_request != 0;
}

void runs_catch_signals(void) {
    const struct sigaction action = {.sa_handler = on_signal}, last = {.sa_handler = leave};
    answers_itself = 1;
    sigaction(SIGALRM, &last, NULL);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN); /* a file-size limit is an error of write, not a death */
    signal(SIGCHLD, SIG_DFL); /* who started the program may have ignored it, and lost every end */
}

void runs_leave_signals_to_parent(void) {
    answers_itself = 0;
    setitimer(ITIMER_REAL, &(struct itimerval){.it_value = {0, 0}}, NULL);
}
