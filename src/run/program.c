#include "program.h"

#include "base/owner.h"
#include "base/progress.h"
#include "child.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The child's part; it never returns. `started` closes itself when the program begins. */
static void become(const char *const argv[], const struct run_limits *limits,
                   const struct program_words *words, pid_t parent, int started) {
    sigset_t none;
    sigemptyset(&none);
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* nothing goes on when this program is killed, */
    if (getppid() != parent)          /* and it was */
        _exit(2);
    if (limits->bytes > 0)
        limit_memory(limits->bytes);
    if (words->output >= 0)
        dup2(words->output, STDOUT_FILENO);
    if (words->errors >= 0)
        dup2(words->errors, STDERR_FILENO);
    sigprocmask(SIG_SETMASK, &none, NULL); /* of a thread that leaves signals to the first */
    execvp(argv[0], (char *const *)argv);
    const int error = errno;
    _exit(write(started, &error, sizeof error) != sizeof error);
}

/* Waits for its end, and brings it about past the time limit or where the user wants it. Returns
 * its status. */
static int see_to_its_end(pid_t pid, double seconds, int *out_of_time) {
    const double grace = 0.3;
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

int program_finish(const char *const argv[], const struct run_limits *limits,
                   const struct program_words *words, int *status, int *out_of_time) {
    int started[2], error = 0;
    if (pipe2(started, O_CLOEXEC))
        return errno;
    fflush(NULL); /* or the child's words come before ours */
    const pid_t parent = getpid(), pid = fork();
    if (pid == 0)
        become(argv, limits, words, parent, started[1]);
    if (pid < 0)
        error = errno;
    close(started[1]);
    while (pid > 0 && read(started[0], &error, sizeof error) < 0 && errno == EINTR)
        ; /* nothing, where it has begun */
    close(started[0]);
    if (pid > 0)
        *status = see_to_its_end(pid, limits->seconds, out_of_time);
    return error;
}

static void first_line(FILE *errors, char *line) {
    rewind(errors);
    if (!fgets(line, REASON_SIZE, errors))
        line[0] = '\0';
    line[strcspn(line, "\n")] = '\0';
}

int program_run(const char *const argv[], const struct run_limits *limits, char *reason) {
    int out_of_time = 0, status = 0;
    FILE *errors = tmpfile();
    const struct program_words words = {-1, errors ? fileno(errors) : -1};
    const int error = errors ? program_finish(argv, limits, &words, &status, &out_of_time) : errno;
    reason[0] = '\0';
    if (errors) {
        first_line(errors, reason);
        fclose(errors);
    }
    const int died = WIFSIGNALED(status);
    if (error)
        snprintf(reason, REASON_SIZE, "%.150s: cannot be started: %s", argv[0], strerror(error));
    else if (died && out_of_time)
        snprintf(reason, REASON_SIZE, "%.150s: out of time: it was stopped after %g s", argv[0],
                 limits->seconds);
    else if (died)
        snprintf(reason, REASON_SIZE, "%.150s: died of signal %d (%s)", argv[0], WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    else if (WEXITSTATUS(status) && !reason[0])
        snprintf(reason, REASON_SIZE, "%.150s: left with code %d", argv[0], WEXITSTATUS(status));
    return error ? 2 : died ? 3 : WEXITSTATUS(status);
}
