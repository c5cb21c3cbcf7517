#include "runs.h"

#include "base/files.h"
#include "base/hash.h"
#include "base/progress.h"
#include "identity.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* After its time limit a run has this long to end by itself and keep what it has. */
static const double grace_seconds = 1;

/* An enum outcome once a signal asks the run of this process to end, else 0. */
static volatile sig_atomic_t stop_request;

static void on_signal(int signal) {
    stop_request = signal == SIGALRM ? OUT_OF_TIME : INTERRUPTED;
}

int runs_interrupted(void) {
    return stop_request != 0;
}

void runs_catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGALRM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN); /* a file-size limit is an error of write, not a death */
}

void run_folder(const char *root, const struct scene *scene, const struct settings *settings,
                char *folder) {
    char hash[HASH_SIZE], name[sizeof scene->name];
    run_hash(scene, settings, hash);
    snprintf(name, sizeof name, "%s", scene->name);
    for (char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '_')
            *c = '_'; /* a name is free text: no slash, no dots */
    path_format(folder, "%s/runs/%s-%s-%s-%s", root, name, settings->method->name,
                scene->problem->treatments[settings->treatment].name, hash);
}

int run_is_complete(const char *folder) {
    char path[PATH_SIZE];
    return path_format(path, "%s/run.json", folder) == 0 && file_exists(path);
}

/* --- the child --- */

/* What a child tells its parent while it runs, in shared memory. */
struct report {
    _Atomic double reached;   /* simulated time, s */
    char reason[REASON_SIZE]; /* of a failure to write */
};

static void limit_memory(double bytes) {
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
#else
    (void)bytes;
#endif
}

/* A time of 0 would be none, and one beyond the century no number of the timer's. */
static void limit_time(double seconds) {
    const double limit = fmin(seconds, 3e9), whole = floor(limit);
    const struct itimerval timer = {
        .it_value = {(time_t)whole, (suseconds_t)fmax(1, 1e6 * (limit - whole))}};
    setitimer(ITIMER_REAL, &timer, NULL);
}

/* Runs and never returns; the exit code is the outcome. */
static void child(const struct run_case *run, const struct run_limits *limits,
                  struct report *report) {
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* nothing goes on when the parent is killed */
    if (limits->bytes > 0)
        limit_memory(limits->bytes);
    if (limits->seconds > 0)
        limit_time(limits->seconds);
    const struct watch watch = {.stop = &stop_request, .reached = &report->reached};
    _exit((int)record_run(run->scene, &run->settings, run->folder, &watch, report->reason));
}

/* --- the parent --- */

struct running {
    const struct run_case *run;
    struct report *report; /* shared with the child */
    pid_t pid;             /* 0: the slot is free */
    double deadline;   /* monotonic s, after which the child is killed; infinite without a limit */
    int lock;          /* file descriptor of the locked folder, or -1 */
    int asked, killed; /* to end, by SIGTERM and by SIGKILL */
    int resumable;     /* an interrupted run is no result, but to be done again */
};

static void remove_result(const char *folder) {
    static const char *const files[] = {"run.json", "states.tsv", "diagnostics.tsv"};
    char path[PATH_SIZE];
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        if (path_format(path, "%s/%s", folder, files[i]) == 0)
            unlink(path);
}

static int start(struct running *slot, const struct run_case *run, const struct run_limits *limits,
                 int lock, char *reason) {
    *slot = (struct running){.run = run, .lock = lock, .deadline = INFINITY};
    slot->report =
        mmap(NULL, sizeof *slot->report, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (slot->report == MAP_FAILED) {
        snprintf(reason, REASON_SIZE, "no memory to start a run");
        return -1;
    }
    if (limits->seconds > 0)
        slot->deadline = monotonic_seconds() + limits->seconds + grace_seconds;
    remove_result(run->folder);
    fflush(NULL);
    const pid_t pid = fork();
    if (pid == 0)
        child(run, limits, slot->report);
    if (pid > 0) {
        slot->pid = pid;
        return 0;
    }
    snprintf(reason, REASON_SIZE, "cannot start a process: %s", strerror(errno));
    munmap(slot->report, sizeof *slot->report);
    return -1;
}

/* The one place that signals: a number of 0 or below would not be a process, but a group of them or
 * all that the user has. */
static void signal_child(const struct running *slot, int signal) {
    if (slot->pid > 0)
        kill(slot->pid, signal);
}

/* Writes down a death in the place of the process that died. */
static enum outcome bury(const struct running *slot, int status, char *reason) {
    char why[REASON_SIZE];
    if (slot->killed)
        snprintf(why, sizeof why, "it did not answer when asked to end, and was killed");
    else if (WIFSIGNALED(status))
        snprintf(why, sizeof why, "its process died of signal %d (%s)", WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    else
        snprintf(why, sizeof why, "its process left with code %d", WEXITSTATUS(status));
    const enum outcome outcome = !slot->killed ? CRASHED : stop_request ? INTERRUPTED : OUT_OF_TIME;
    const int failed = record_death(slot->run->scene, &slot->run->settings, slot->run->folder,
                                    outcome, why, slot->report->reached, reason);
    return failed ? OUTPUT_FAILED : outcome;
}

/* How the child ended. */
static enum outcome finish(struct running *slot, int status, char *reason) {
    enum outcome outcome = CRASHED;
    if (WIFEXITED(status) && WEXITSTATUS(status) == OUTPUT_FAILED) {
        outcome = OUTPUT_FAILED;
        snprintf(reason, REASON_SIZE, "%s", slot->report->reason);
    } else if (WIFEXITED(status) && WEXITSTATUS(status) < OUTCOME_COUNT &&
               run_is_complete(slot->run->folder)) {
        outcome = (enum outcome)WEXITSTATUS(status);
    } else {
        outcome = bury(slot, status, reason);
    }
    if (outcome == INTERRUPTED && slot->resumable)
        remove_result(slot->run->folder);
    munmap(slot->report, sizeof *slot->report);
    if (slot->lock >= 0)
        close(slot->lock);
    slot->pid = 0;
    return outcome;
}

/* Whether a running child has ended, killing it past its deadline; `*outcome` says how. */
static int poll_child(struct running *slot, enum outcome *outcome, char *reason) {
    int status;
    if (waitpid(slot->pid, &status, WNOHANG) == slot->pid) {
        *outcome = finish(slot, status, reason);
        return 1;
    }
    if (stop_request && !slot->asked) {
        slot->asked = 1;
        signal_child(slot, SIGTERM);
        slot->deadline = monotonic_seconds() + grace_seconds;
    }
    if (monotonic_seconds() > slot->deadline && !slot->killed) {
        slot->killed = 1;
        signal_child(slot, SIGKILL);
    }
    return 0;
}

static void nap(void) {
    nanosleep(&(struct timespec){.tv_nsec = 500000}, NULL);
}

/* Half files of a process that was killed. */
static void remove_leftovers(const char *folder) {
    glob_t found;
    files_like(folder, "*.part", &found);
    for (size_t i = 0; i < found.gl_pathc; i++)
        unlink(found.gl_pathv[i]);
    globfree(&found);
}

/* The folder, made and locked for this process; -1 where another process is at it. The lock goes
 * with the process that holds it, however it ends. */
static int lock_folder(const char *folder, char *reason) {
    if (make_folder(folder, reason))
        return -2;
    const int lock = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0) {
        remove_leftovers(folder);
        return lock;
    }
    if (lock >= 0)
        close(lock);
    return -1;
}

enum outcome runs_do_one(const struct run_case *run, const struct run_limits *limits,
                         int show_progress, char *reason) {
    struct running slot;
    enum outcome outcome;
    struct progress progress = progress_start(run->scene->name, show_progress);

    const int lock = lock_folder(run->folder, reason);
    if (lock == -1)
        snprintf(reason, REASON_SIZE, "%.150s: another run is at work there", run->folder);
    if (lock < 0)
        return OUTPUT_FAILED;
    if (start(&slot, run, limits, lock, reason)) {
        close(lock);
        return OUTPUT_FAILED;
    }
    for (long polls = 0; !poll_child(&slot, &outcome, reason); polls++) {
        if (polls % 500 == 0) {
            char note[80];
            snprintf(note, sizeof note, "t = %.4g of %.4g s", slot.report->reached,
                     run->scene->duration);
            progress_show(&progress, slot.report->reached / run->scene->duration, note);
        }
        nap();
    }
    progress_end(&progress);
    return outcome;
}

struct pool {
    const struct run_case *cases;
    char *done; /* by case */
    int count, done_count, ran;
    struct running *slots;
    int jobs, active;
    const struct run_limits *limits;
};

static int is_running(const struct pool *pool, const struct run_case *run) {
    for (int i = 0; i < pool->jobs; i++)
        if (pool->slots[i].pid && strcmp(pool->slots[i].run->folder, run->folder) == 0)
            return 1;
    return 0;
}

/* Starts the next case that nobody is at, if a slot is free. Returns 0, or the negative of an
 * outcome with a reason. */
static int start_next(struct pool *pool, char *reason) {
    int free_slot = 0;
    while (free_slot < pool->jobs && pool->slots[free_slot].pid)
        free_slot++;
    for (int i = 0; i < pool->count && free_slot < pool->jobs; i++) {
        const struct run_case *run = &pool->cases[i];
        if (pool->done[i] || is_running(pool, run))
            continue;
        if (!run_is_complete(run->folder)) {
            const int lock = lock_folder(run->folder, reason);
            if (lock == -2)
                return -OUTPUT_FAILED;
            if (lock == -1)
                continue;
            if (!run_is_complete(run->folder)) {
                if (start(&pool->slots[free_slot], run, pool->limits, lock, reason)) {
                    close(lock);
                    return -OUTPUT_FAILED;
                }
                pool->slots[free_slot].resumable = 1;
                pool->active++;
                pool->ran++;
                return 0;
            }
            close(lock);
        }
        pool->done[i] = 1;
        pool->done_count++;
    }
    return 0;
}

/* Looks after the children. Returns 0, or -1 with a reason. */
static int tend(struct pool *pool, char *reason) {
    int code = 0;
    for (int i = 0; i < pool->jobs; i++) {
        enum outcome outcome;
        struct running *slot = &pool->slots[i];
        if (!slot->pid || !poll_child(slot, &outcome, reason))
            continue;
        pool->active--;
        if (outcome == OUTPUT_FAILED)
            code = -1;
    }
    return code;
}

static int run_pool(struct pool *pool, struct progress *progress, int total_done, int total,
                    char *reason) {
    int code = 0;
    for (long polls = 0; pool->active > 0 || (!code && pool->done_count < pool->count); polls++) {
        if (!code && !stop_request)
            code = start_next(pool, reason);
        if (tend(pool, reason))
            code = -OUTPUT_FAILED;
        if (stop_request && pool->active == 0 && !code) {
            snprintf(reason, REASON_SIZE, "interrupted; the same command goes on from here");
            return -INTERRUPTED;
        }
        if (polls % 500 == 0) {
            char note[80];
            const int done = total_done + pool->done_count;
            snprintf(note, sizeof note, "%d of %d runs", done, total);
            progress_show(progress, (double)done / total, note);
        }
        if (pool->active > 0 || pool->done_count < pool->count)
            nap();
    }
    return code;
}

/* The cases that are timed, or those that are not, through a pool of their own. Returns the number
 * that were run, or the negative of an outcome. */
static int run_kind(const struct run_case *cases, int count, int timed,
                    const struct run_limits *limits, int jobs, struct progress *progress,
                    int *total_done, char *reason) {
    struct pool pool = {.limits = limits, .jobs = timed ? 1 : jobs};
    struct run_case *chosen = calloc((size_t)count + 1, sizeof *chosen);
    pool.done = calloc((size_t)count + 1, 1);
    pool.slots = calloc((size_t)pool.jobs, sizeof *pool.slots);
    int code = -OUT_OF_MEMORY;
    if (chosen && pool.done && pool.slots) {
        for (int i = 0; i < count; i++)
            if ((cases[i].settings.timings > 0) == timed)
                chosen[pool.count++] = cases[i];
        pool.cases = chosen;
        code = run_pool(&pool, progress, *total_done, count, reason);
        *total_done += pool.done_count;
    } else {
        snprintf(reason, REASON_SIZE, "out of memory");
    }
    free(chosen);
    free(pool.done);
    free(pool.slots);
    return code ? code : pool.ran;
}

int runs_do_all(const struct run_case *cases, int count, const struct run_limits *limits, int jobs,
                int show_progress, char *reason) {
    struct progress progress = progress_start("runs", show_progress);
    int ran = 0, done = 0;
    for (int timed = 0; timed <= 1 && ran >= 0; timed++) {
        const int now = run_kind(cases, count, timed, limits, jobs, &progress, &done, reason);
        ran = now < 0 ? now : ran + now;
    }
    progress_end(&progress);
    return ran;
}
