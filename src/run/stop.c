#include "stop.h"

volatile sig_atomic_t stop_request;

static void on_signal(int signal) {
    (void)signal;
    stop_request = INTERRUPTED;
}

int runs_interrupted(void) {
    return stop_request != 0;
}

void runs_catch_signals(void) {
    const struct sigaction action = {.sa_handler = on_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN); /* a file-size limit is an error of write, not a death */
    signal(SIGCHLD, SIG_DFL); /* who started the program may have ignored it, and lost every end */
}
