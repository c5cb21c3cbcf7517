/* Locks of folders: among processes of one host, of two, and with a holder that is gone; and who is
 * alone on a host. */
#include "run/lock.h"

#include "disk.h"
#include "run/host.h"
#include "support.h"

#include <criterion/criterion.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static char *folder;
static const char *path;
static char reason[REASON_SIZE];
static struct lock lock;

static void set_up(void) {
    folder = folder_make();
    path = printed("%s/.lock", folder);
}

static void expect(enum lock_state expected, const char *when) {
    const enum lock_state state = lock_take(&lock, folder, reason);
    cr_assert_eq(state, expected, "%s: state %d (%s)", when, (int)state, reason);
    if (state == LOCK_TAKEN)
        lock_release(&lock);
    if (state != LOCK_FAILED)
        cr_assert_eq(count_files(folder, ""), state == LOCK_HELD, "%s: files are left", when);
}

/* A lock file that somebody else made so many seconds ago. */
static void put(const char *text, long age) {
    struct timespec now;
    file_write(folder, ".lock", text);
    clock_gettime(CLOCK_REALTIME, &now);
    const struct timespec times[2] = {{.tv_nsec = UTIME_OMIT},
                                      {.tv_sec = now.tv_sec - age, .tv_nsec = now.tv_nsec}};
    cr_assert_eq(utimensat(AT_FDCWD, path, times, 0), 0);
}

/* Whether the lock file says this. */
static int says(const char *text) {
    char *now = file_read(path);
    return now && strcmp(now, text) == 0;
}

/* --- processes that do one thing, say how it went, and wait --- */

struct other {
    pid_t pid;
    int code;
};

static struct other start_other(int (*act)(void)) {
    struct other other;
    int ready[2];
    cr_assert_eq(pipe(ready), 0);
    other.pid = fork();
    if (other.pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        other.code = act();
        if (write(ready[1], &other.code, sizeof other.code) > 0)
            pause();
        _exit(0);
    }
    cr_assert(other.pid > 0 && read(ready[0], &other.code, sizeof other.code) > 0);
    close(ready[0]);
    close(ready[1]);
    return other;
}

static void end_other(const struct other *other) {
    kill(other->pid, SIGKILL);
    waitpid(other->pid, NULL, 0);
}

static int take(void) {
    return (int)lock_take(&lock, folder, reason);
}

/* --- one host --- */

Test(lock, a_holder_that_lives_keeps_it_and_one_that_is_gone_does_not, .init = set_up) {
    siginfo_t info;
    expect(LOCK_TAKEN, "nobody has it");
    const struct other other = start_other(take);
    cr_assert_eq(other.code, LOCK_TAKEN);
    expect(LOCK_HELD, "another has it");
    const char *const name = printed("process %ld on ", (long)other.pid);
    cr_assert(strstr(reason, name), "'%s' is not '%s'", reason, name);
    kill(other.pid, SIGKILL);
    cr_assert_eq(waitid(P_PID, (id_t)other.pid, &info, WEXITED | WNOWAIT), 0);
    expect(LOCK_TAKEN, "it is dead, and nobody has asked how it ended");
    end_other(&other);
    const struct other next = start_other(take);
    end_other(&next);
    expect(LOCK_TAKEN, "it is gone");
}

Test(lock, a_number_that_another_process_has_by_now_holds_nothing, .init = set_up) {
    const struct owner self = owner_self();
    const char *text = printed("%s %ld %llu 0\n", self.host, self.pid, self.start);
    put(text, 1000);
    expect(LOCK_HELD, "on one host it need not be touched");
    text = printed("%s %ld %llu 0\n", self.host, self.pid, self.start - 1);
    put(text, 0);
    expect(LOCK_TAKEN, "that process began before this one");
}

/* Of those who see that a holder is gone, one gets the lock, in whatever order they come to it. */
Test(lock, one_of_many_gets_what_is_stale, .init = set_up) {
    enum { MANY = 8, ROUNDS = 40 };
    disk_hesitates = 1;
    for (int round = 0; round < ROUNDS; round++) {
        int start[2], results[2], taken = 0;
        pid_t pids[MANY];
        char byte, codes[MANY];
        put("gone 1 1 0\n", 100);
        cr_assert(pipe(start) == 0 && pipe(results) == 0);
        for (int i = 0; i < MANY; i++) {
            pids[i] = fork();
            if (pids[i] == 0) {
                prctl(PR_SET_PDEATHSIG, SIGKILL);
                close(start[1]);
                if (read(start[0], &byte, 1) != 0) /* until all are there */
                    _exit(1);
                byte = (char)take();
                if (write(results[1], &byte, 1) == 1)
                    pause();
                _exit(0);
            }
        }
        close(start[0]);
        close(start[1]);
        for (int i = 0; i < MANY; i++) {
            cr_assert_eq(read(results[0], &codes[i], 1), 1);
            taken += codes[i] == LOCK_TAKEN;
        }
        cr_assert_eq(taken, 1, "round %d: %d have it", round, taken);
        for (int i = 0; i < MANY; i++) {
            kill(pids[i], SIGKILL);
            waitpid(pids[i], NULL, 0);
        }
        close(results[0]);
        close(results[1]);
    }
}

/* Who takes a stale lock away may be killed meanwhile, and who takes that one's lock away too. */
Test(lock, who_breaks_it_may_be_gone, .init = set_up) {
    const struct owner self = owner_self();
    const char *text = printed("%s %ld %llu 0\n", self.host, self.pid, self.start - 1);
    file_write(folder, ".lock-break-break", text);
    file_write(folder, ".lock-break", text);
    put(text, 0);
    expect(LOCK_TAKEN, "three that are gone");
    text = printed("%s %ld %llu 0\n", self.host, self.pid, self.start);
    file_write(folder, ".lock-break", text);
    put("gone 1 1 0\n", 100);
    cr_assert_eq(take(), LOCK_HELD, "one that is slow: %s", reason);
    cr_assert(says("gone 1 1 0\n"), "it is that one's to take away");
}

/* --- two hosts --- */

static const char elsewhere[] = "elsewhere/1/2 17 99 abc\n";

Test(lock, a_holder_on_another_host_is_gone_when_it_has_not_touched_it, .init = set_up) {
    put(elsewhere, 0);
    expect(LOCK_HELD, "now");
    cr_assert_str_eq(reason, "process 17 on elsewhere");
    put(elsewhere, 15);
    expect(LOCK_HELD, "15 s ago");
    put(elsewhere, 32);
    expect(LOCK_TAKEN, "32 s ago");
    for (int i = 0; i < 2; i++) { /* killed before it wrote, or something else */
        const char *text = i ? "who knows" : "";
        put(text, 15);
        expect(LOCK_HELD, "of nobody, 15 s ago");
        put(text, 32);
        expect(LOCK_TAKEN, "of nobody, 32 s ago");
    }
}

static int take_elsewhere(void) {
    setenv("WISPLAB_HOST", "elsewhere", 1);
    return take();
}

Test(lock, two_hosts_exclude_each_other, .init = set_up) {
    const struct other other = start_other(take_elsewhere);
    cr_assert_eq(other.code, LOCK_TAKEN);
    expect(LOCK_HELD, "it has it");
    cr_assert(strstr(reason, "on elsewhere"), "%s", reason);
    end_other(&other);
    expect(LOCK_HELD, "who could know?");
}

/* What counts is the file server's clock, not this machine's. */
Test(lock, hosts_need_not_agree_on_the_time, .init = set_up) {
    for (disk_clock = -3600; disk_clock <= 3600; disk_clock += 7200) {
        put(elsewhere, 15);
        expect(LOCK_HELD, "15 s ago");
        put(elsewhere, 32);
        expect(LOCK_TAKEN, "32 s ago");
    }
}

static double age(void) {
    struct timespec now;
    struct stat status;
    clock_gettime(CLOCK_REALTIME, &now);
    cr_assert_eq(stat(path, &status), 0);
    return difftime(now.tv_sec, status.st_mtim.tv_sec);
}

Test(lock, a_holder_touches_it, .init = set_up) {
    cr_assert_eq(take(), LOCK_TAKEN);
    put(lock.text, 1000);
    cr_assert_eq(lock_keep(&lock), 0);
    cr_assert(age() > 900, "at every look");
    lock.touched -= 6; /* as if that had been then */
    cr_assert_eq(lock_keep(&lock), 0);
    cr_assert(age() < 900, "it has not been touched");
    cr_assert(says(lock.text));
}

/* This process stood still for so long that it was taken for gone. */
Test(lock, a_holder_sees_that_it_has_lost_it, .init = set_up) {
    cr_assert_eq(take(), LOCK_TAKEN);
    put(elsewhere, 0);
    lock.touched -= 6;
    cr_assert_eq(lock_keep(&lock), -1);
    lock_release(&lock);
    cr_assert(says(elsewhere), "it has taken the new holder's lock away");
    unlink(path);
    cr_assert_eq(lock_keep(&lock), -1);
}

static void seize(void) {
    file_write(folder, ".lock", elsewhere);
}

/* Between the look at a stale lock and the hand on it, another one has taken it. (The file that is
 * removed there is the one that told the time.) */
Test(lock, who_comes_late_leaves_it, .init = set_up) {
    put("gone 1 1 0\n", 100);
    disk_before_unlink = seize;
    expect(LOCK_HELD, "by the one who was faster");
    cr_assert(says(elsewhere));
}

/* --- where there can be no lock --- */

Test(lock, where_none_can_be_that_is_said, .init = set_up) {
    const char *other = printed("%s/nowhere", folder);
    cr_assert_eq(lock_take(&lock, other, reason), LOCK_FAILED);
    cr_assert(strstr(reason, other) && strstr(reason, "cannot be locked"), "%s", reason);
    other = file_write(folder, "precious", "mine");
    cr_assert_eq(symlink(other, path), 0);
    expect(LOCK_FAILED, "a link");
    cr_assert(strstr(reason, path) && strstr(reason, "cannot be read"), "%s", reason);
    cr_assert(unlink(path) == 0 && mkdir(path, 0777) == 0);
    expect(LOCK_FAILED, "a folder");
    char *text = file_read(other);
    cr_assert(text && strcmp(text, "mine") == 0);
}

/* --- alone on a host --- */

static long who;

static int run_with_others(void) {
    return host_enter(0, &who);
}

static int run_alone(void) {
    return host_enter(1, &who);
}

static int run_alone_elsewhere(void) {
    setenv("WISPLAB_HOST", "elsewhere", 1);
    return host_enter(1, &who);
}

Test(lock, timed_runs_are_alone_on_their_host) {
    const struct other far = start_other(run_alone_elsewhere); /* before this host has a name */
    const struct other one = start_other(run_with_others), two = start_other(run_with_others);
    cr_assert_eq(far.code, 0);
    cr_assert(one.code == 0 && two.code == 0, "runs go on together");
    cr_assert_eq(run_alone(), 1, "it is not alone");
    cr_assert(who == one.pid || who == two.pid, "%ld is in the way", who);
    const struct other three = start_other(run_with_others);
    cr_assert_eq(three.code, 1, "who wants to be alone is next");
    end_other(&one);
    cr_assert_eq(run_alone(), 1);
    cr_assert_eq(who, two.pid);
    end_other(&two);
    end_other(&three);
    cr_assert_eq(run_alone(), 0, "nobody is left");
    const struct other four = start_other(run_with_others), five = start_other(run_alone);
    cr_assert_eq(four.code, 1, "it is not alone");
    cr_assert_eq(five.code, 1, "nor is this one");
    end_other(&four);
    end_other(&five);
    host_leave();
    const struct other six = start_other(run_alone);
    cr_assert_eq(six.code, 0);
    cr_assert_eq(run_with_others(), 1);
    cr_assert_eq(who, six.pid);
    end_other(&six);
    cr_assert_eq(run_with_others(), 0, "its lock outlived it");
    host_leave();
    cr_assert_eq(run_alone(), 0);
    end_other(&far);
}

/* Who does not want to be alone any more lets the others in. */
Test(lock, who_leaves_is_not_waited_for) {
    const struct other one = start_other(run_with_others);
    cr_assert_eq(run_alone(), 1);
    host_leave();
    const struct other two = start_other(run_with_others);
    cr_assert_eq(two.code, 0);
    cr_assert(run_with_others() == 0 && run_with_others() == 0);
    end_other(&one);
    end_other(&two);
    host_leave(); /* one of two is left */
    const struct other three = start_other(run_alone);
    cr_assert_eq(three.code, 1);
    end_other(&three);
}

/* A series of timed runs would else keep the others out to its end. */
Test(lock, who_was_alone_lets_those_in_who_wait) {
    cr_assert_eq(run_alone(), 0);
    const struct other one = start_other(run_with_others);
    cr_assert_eq(one.code, 1);
    host_leave();
    cr_assert_eq(run_alone(), 1);
    cr_assert_eq(who, one.pid);
    const struct other two = start_other(run_with_others);
    cr_assert_eq(two.code, 0, "the gate is open meanwhile");
    end_other(&two);
    end_other(&one);
    cr_assert_eq(run_alone(), 0, "nobody waits");
    const struct other three = start_other(run_alone);
    host_leave();
    cr_assert_eq(run_alone(), 1, "nor are those kept out who want to be alone");
    end_other(&three);
}
