#include "program.h"

#include "base/owner.h"
#include "base/progress.h"
#include "child.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The child's part; it never returns. */
static void become(const char *const argv[], const struct run_limits *limits, int errors) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (limits->bytes > 0)
        limit_memory(limits->bytes);
    dup2(errors, STDERR_FILENO);
    execv(argv[0], (char *const *)argv);
    dprintf(STDERR_FILENO, "%s: cannot be started: %s\n", argv[0], strerror(errno));
    _exit(2);
}

/* Waits for its end, and brings it about past the time limit or where the user wants it. Returns
 * its status. */
static int see_to_its_end(pid_t pid, double seconds, int *out_of_time) {
    const double grace = 1;
    double deadline = seconds > 0 ? monotonic_seconds() + seconds : INFINITY;
    int status = 0, asked = 0;
    *out_of_time = 0;
    while (waitpid(pid, &status, WNOHANG) == 0) {
        const int late = monotonic_seconds() > deadline;
        if (asked && late) {
            signal_process(pid, SIGKILL);
        } else if (!asked && (late || runs_interrupted())) {
            signal_process(pid, SIGTERM);
            asked = 1;
            *out_of_time = late;
            deadline = monotonic_seconds() + grace;
        }
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    }
    return status;
}

static void first_line(FILE *errors, char *line) {
    rewind(errors);
    if (!fgets(line, REASON_SIZE, errors))
        line[0] = '\0';
    line[strcspn(line, "\n")] = '\0';
}

int program_run(const char *const argv[], const struct run_limits *limits, char *reason) {
    int out_of_time = 0;
    FILE *errors = tmpfile();
    fflush(NULL); /* or the child's words come before ours */
    const pid_t pid = errors ? fork() : -1;
    if (pid == 0)
        become(argv, limits, fileno(errors));
    if (pid < 0) {
        snprintf(reason, REASON_SIZE, "%.150s: cannot be started: %s", argv[0], strerror(errno));
        if (errors)
            fclose(errors);
        return 2;
    }
    const int status = see_to_its_end(pid, limits->seconds, &out_of_time);
    const int died = WIFSIGNALED(status);
    first_line(errors, reason);
    fclose(errors);
    if (died && out_of_time)
        snprintf(reason, REASON_SIZE, "%.150s: out of time: it was stopped after %g s", argv[0],
                 limits->seconds);
    else if (died)
        snprintf(reason, REASON_SIZE, "%.150s: died of signal %d (%s)", argv[0], WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    else if (WEXITSTATUS(status) && !reason[0])
        snprintf(reason, REASON_SIZE, "%.150s: left with code %d", argv[0], WEXITSTATUS(status));
    return died ? 3 : WEXITSTATUS(status);
}
