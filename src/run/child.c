#include "child.h"

#include "base/memory.h"
#include "base/owner.h"
#include "base/progress.h"
#include "record.h"
#include "seal.h"
#include "stop.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A run that is to end has this long to do so by itself and keep what it has: of CPU time after its
 * limit, of wall time after the user's word. */
static const double grace_seconds = 1, user_grace_seconds = 0.3;

/* What a child tells its parent. How it ended stands here, not in its exit code: whoever calls
 * exit() inside a library says nothing by that. */
struct child_report {
    _Atomic double reached;     /* simulated time, s */
    _Atomic int ended, outcome; /* whether it came to its end, and to which */
    _Atomic int gave_up;        /* it did not come to its end in the grace after its limit */
    _Atomic int without_memory; /* it could not have some, and that was no limit of ours */
    _Atomic int short_of_it;    /* it crashed after it had hit ours */
    _Atomic int sent;           /* a signal that is usually a crash, but was sent from outside */
    char reason[REASON_SIZE];   /* of a failure to write */
};

/* --- the child --- */

static struct child_report *own_report;

/* Signals by which the kernel says what the process has done wrong, and abort's. */
static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
enum { FATAL = sizeof fatal / sizeof *fatal };
static struct sigaction usual[FATAL];

/* Notes where somebody else has sent it, and hands it on. What the kernel raises comes again when
 * the instruction is tried again. A process that cannot run this, for its stack is full, did that
 * by itself. */
static void on_fatal(int signal, siginfo_t *info, void *context) {
    (void)context;
    const int was_sent = info->si_code <= 0;
    own_report->short_of_it = memory_was_short;
    if (was_sent && info->si_pid != getpid())
        own_report->sent = signal;
    for (int i = 0; i < FATAL; i++)
        if (fatal[i] == signal)
            sigaction(signal, &usual[i], NULL);
    if (was_sent)
        raise(signal);
}

static void watch_fatal_signals(void) {
    const struct sigaction action = {.sa_sigaction = on_fatal, .sa_flags = SA_SIGINFO};
    for (int i = 0; i < FATAL; i++)
        sigaction(fatal[i], &action, &usual[i]);
}

void limit_memory(double bytes) {
#ifndef __SANITIZE_ADDRESS__ /* its shadow memory alone is terabytes */
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld", &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    const double most = 1e18; /* more is no rlim_t, and no machine's */
    const rlim_t limit = (rlim_t)fmin(most, bytes + (double)pages * (double)sysconf(_SC_PAGESIZE));
    struct rlimit limits;
    getrlimit(RLIMIT_AS, &limits);
    limits.rlim_cur = limit < limits.rlim_max ? limit : limits.rlim_max;
    setrlimit(RLIMIT_AS, &limits); /* the soft one: record_run lifts it to say that it was hit */
    memory_is_limited = limit < limits.rlim_max; /* by us, and not from outside */
#else
    (void)bytes;
#endif
}

/* The limit of CPU time. No timer of the system's runs with that: while one is set, Linux tells
 * CPU times by clock ticks, 4 ms each, and timings would be good for nothing. Instead the CPU time
 * is looked at when it may have been used up at the earliest, by all threads at full speed, and
 * again when what was left then may have been. */
static struct {
    double seconds; /* at which the next thing happens */
    int threads;
    int asked;
} cpu_limit;

/* A time of 0 would be none, and one beyond the century no number of the timer's. */
static void wake_after(double seconds) {
    const double limit = fmin(seconds, 3e9), whole = floor(limit);
    const struct itimerval timer = {
        .it_value = {(time_t)whole, (suseconds_t)fmax(1, 1e6 * (limit - whole))}};
    setitimer(ITIMER_REAL, &timer, NULL);
}

/* First the run is asked to end; it may be where it does not hear that. */
static void look_at_cpu_time(int signal) {
    (void)signal;
    double left = cpu_limit.seconds - cpu_seconds();
    if (left <= 0 && cpu_limit.asked) {
        own_report->gave_up = 1;
        _exit(0);
    }
    if (left <= 0) {
        cpu_limit.asked = 1;
        stop_request = stop_request ? stop_request : OUT_OF_TIME;
        cpu_limit.seconds += grace_seconds;
        left = grace_seconds;
    }
    wake_after(left / cpu_limit.threads);
}

static void limit_cpu_time(double seconds, int threads) {
    const struct sigaction action = {.sa_handler = look_at_cpu_time};
    sigaction(SIGALRM, &action, NULL);
    cpu_limit.seconds = seconds;
    cpu_limit.threads = threads;
    wake_after(seconds / threads);
}

static void note_no_memory(void) {
    own_report->without_memory = 1;
}

static sigset_t mask_before; /* children_begin's */

/* Runs and never returns. */
static void be_child(const struct run_case *run, const struct run_limits *limits, pid_t parent,
                     struct child_report *report) {
    own_report = report;
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* nothing goes on when the parent is killed, */
    if (getppid() != parent)          /* and it was */
        _exit(0);
    runs_leave_signals_to_parent();
    sigprocmask(SIG_SETMASK, &mask_before, NULL);
    watch_fatal_signals();
    memory_last_word = note_no_memory;
    if (limits->bytes > 0)
        limit_memory(limits->bytes);
    if (limits->seconds > 0)
        limit_cpu_time(limits->seconds, run->settings.threads);
    const struct watch watch = {.stop = &stop_request,
                                .reached = &report->reached,
                                .cpu_seconds = limits->seconds,
                                .evaluations = limits->evaluations};
    report->outcome = (int)(run->sink ? run->sink->run(run, &watch, report->reason)
                                      : record_run(run->scene, &run->settings, run->folder, &watch,
                                                   NULL, report->reason));
    report->ended = 1;
    _exit(0);
}

/* --- the parent --- */

void children_begin(void) {
    sigset_t end_of_child;
    sigemptyset(&end_of_child);
    sigaddset(&end_of_child, SIGCHLD);
    sigprocmask(SIG_BLOCK, &end_of_child, &mask_before);
}

void children_end(void) {
    sigprocmask(SIG_SETMASK, &mask_before, NULL);
}

void children_wait(double seconds) {
    sigset_t end_of_child;
    const double whole = floor(seconds);
    const struct timespec time = {(time_t)whole, (long)(1e9 * (seconds - whole))};
    sigemptyset(&end_of_child);
    sigaddset(&end_of_child, SIGCHLD);
    sigtimedwait(&end_of_child, NULL, &time); /* at once where one has ended since the last */
}

static double watchdog_seconds(const struct run_limits *limits) {
    static const double slack = 10, least = 60;
    return limits->wall_seconds > 0 ? limits->wall_seconds
           : limits->seconds > 0    ? fmax(least, slack * limits->seconds)
                                    : INFINITY;
}

int child_start(struct child *child, const struct run_case *run, const struct run_limits *limits,
                char *reason) {
    const double allowed = watchdog_seconds(limits);
    *child =
        (struct child){.run = run, .allowed = allowed, .deadline = monotonic_seconds() + allowed};
    struct child_report *report =
        mmap(NULL, sizeof *report, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (report == MAP_FAILED)
        return fail_with(reason, "no memory to start a run");
    run_remove(run->folder);
    fflush(NULL);
    const pid_t parent = getpid(), pid = fork();
    if (pid == 0)
        be_child(run, limits, parent, report);
    if (pid > 0) {
        child->report = report;
        child->pid = pid;
        return 0;
    }
    snprintf(reason, REASON_SIZE, "cannot start a process: %s", strerror(errno));
    munmap(report, sizeof *report);
    return -1;
}

static int is_crash(int signal) {
    for (int i = 0; i < FATAL; i++)
        if (fatal[i] == signal)
            return 1;
    return 0;
}

/* Writes down a death in the place of the process that died. */
static enum child_state record_crash(const struct child *child, enum outcome death, const char *why,
                                     enum outcome *outcome, char *reason) {
    const struct run_case *run = child->run;
    const double reached = child->report->reached;
    const int failed = run->sink ? run->sink->death(run, death, why, reached, reason)
                                 : record_death(run->scene, &run->settings, run->folder, death, why,
                                                reached, reason);
    *outcome = failed ? OUTPUT_FAILED : death;
    return CHILD_ENDED;
}

static enum child_state killed(const struct child *child, int signal, char *reason) {
    run_remove(child->run->folder);
    if (child->killed)
        snprintf(reason, REASON_SIZE, "the watchdog ended it after %g s by the clock",
                 child->allowed);
    else
        snprintf(reason, REASON_SIZE, "killed from outside by signal %d (%s)", signal,
                 strsignal(signal));
    return CHILD_KILLED;
}

/* How the child has ended. */
static enum child_state judge(const struct child *child, int status, enum outcome *outcome,
                              char *reason) {
    const struct child_report *report = child->report;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    char why[REASON_SIZE];
    if (report->ended && report->outcome == INTERRUPTED && !stop_request)
        return killed(child, SIGTERM, reason); /* or SIGINT: it was not this process that asked */
    if (report->ended) {
        *outcome = (enum outcome)report->outcome;
        if (*outcome == OUTPUT_FAILED)
            snprintf(reason, REASON_SIZE, "%s", report->reason);
        return CHILD_ENDED;
    }
    if (report->without_memory) {
        run_remove(child->run->folder);
        snprintf(reason, REASON_SIZE, "out of memory");
        *outcome = OUTPUT_FAILED;
        return CHILD_ENDED;
    }
    snprintf(why, sizeof why, "it did not answer when asked to end, and was ended");
    if (report->gave_up)
        return record_crash(child, OUT_OF_TIME, why, outcome, reason);
    if (child->killed && child->asked)
        return record_crash(child, INTERRUPTED, why, outcome, reason);
    if (signal && (!is_crash(signal) || report->sent == signal))
        return killed(child, signal, reason);
    if (signal)
        snprintf(why, sizeof why, "its process died of signal %d (%s)", signal, strsignal(signal));
    else
        snprintf(why, sizeof why, "its process left with code %d", WEXITSTATUS(status));
    return record_crash(child, report->short_of_it ? OUT_OF_MEMORY : CRASHED, why, outcome, reason);
}

static void forget(struct child *child) {
    munmap(child->report, sizeof *child->report);
    child->pid = 0;
}

enum child_state child_poll(struct child *child, enum outcome *outcome, char *reason) {
    int status = SIGKILL; /* where the system cannot say */
    const pid_t ended = waitpid(child->pid, &status, WNOHANG);
    if (ended == child->pid || (ended < 0 && errno == ECHILD)) {
        const enum child_state state = judge(child, status, outcome, reason);
        forget(child);
        return state;
    }
    if (stop_request && !child->asked) {
        child->asked = 1;
        signal_process(child->pid, SIGTERM);
        child->deadline = fmin(child->deadline, monotonic_seconds() + user_grace_seconds);
    }
    if (monotonic_seconds() > child->deadline && !child->killed) {
        child->killed = 1;
        signal_process(child->pid, SIGKILL);
    }
    return CHILD_RUNS;
}

double child_reached(const struct child *child) {
    return child->report->reached;
}

static void remove_leftovers(const struct child *child, const char *name) {
    char path[PATH_SIZE];
    if (path_format(path, "%s/%s", child->run->folder, name) == 0)
        atomic_remove_leftovers(path);
}

void child_abandon(struct child *child) {
    signal_process(child->pid, SIGKILL);
    while (waitpid(child->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    for (int i = 0; run_tables[i]; i++)
        remove_leftovers(child, run_tables[i]);
    remove_leftovers(child, "run.json");
    forget(child);
}
