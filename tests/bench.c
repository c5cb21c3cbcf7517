/* The program that measures, as the experiment `kernel` starts it: whatever becomes of it is said
 * in one line, and it leaves nothing behind. */
#include "support.h"

#include <criterion/criterion.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void check(const struct finished *f, int code, const char *says, const char *folder) {
    must_have_failed(f, code, says);
    cr_assert_eq(count_files(folder, "samples"), 0, "samples are left");
    cr_assert_eq(count_files(folder, ".part"), 0, "half a file is left");
}

/* --- what it says --- */

Test(bench, a_failed_measurement_is_said_in_one_line) {
    static const char scene[] =
        "duration = 1.0;\ngravity = [0, -10, 0];\nmaterial = { };\nenvelope = { };\n"
        "wisps = ({ root = [0, 0, 0]; direction = [1, 0, 0]; length = 1e-300; nodes = 5; });\n";
    const char *const folder = folder_make();
    struct finished *f = PROGRAM(NULL, "experiment", "kernel", "--quick", "--scene",
                                 file_write(folder, "point.cfg", scene), "--out", folder);
    check(f, 3, "bench: the twin has no acceleration", folder);
}

Test(bench, a_scene_without_envelopes_is_refused) {
    static const char *const scenes[] = {"circle", "swing"};
    const char *const folder = folder_make();
    for (int i = 0; i < 2; i++) {
        struct finished *f =
            PROGRAM(NULL, "experiment", "kernel", "--scene", scenes[i], "--out", folder);
        check(f, 1, "needs wisps with an envelope", folder);
    }
}

Test(bench, out_of_time_is_out_of_time) {
    const char *const folder = folder_make();
    struct finished *f =
        PROGRAM(NULL, "experiment", "kernel", "--time-limit", "0.05", "--out", folder);
    check(f, 3, "out of time", folder);
}

/* The limit is one of memory that the program can have, and it says that it has no more. */
Test(bench, a_limit_of_memory_is_the_measurements) {
#ifndef SANITIZED
    const char *const folder = folder_make();
    struct finished *f =
        PROGRAM(NULL, "experiment", "kernel", "--memory-limit", "16", "--out", folder);
    check(f, 2, "out of memory", folder);
#endif
}

/* A copy of the program that stands alone finds scenes, but nothing that measures. */
Test(bench, where_it_is_missing_that_is_said) {
    const char *const folder = folder_make();
    struct finished *f =
        shell("cp '%s' '%s' && '%s/wisplab' experiment kernel --out '%s/out' >/dev/null",
              program_path, folder, folder, folder);
    f->err = f->out;
    check(f, 2, "wisplab-bench: cannot be started: No such file or directory", folder);
}

/* --- what ends it --- */

/* The program that measures, once it is one: a child is at first what its parent is. */
static pid_t measuring_child(pid_t parent) {
    char exe[PATH_SIZE] = "";
    const char *path;
    long child = 0;
    for (int i = 0; i < 4000 && !strstr(exe, "/wisplab-bench"); i++) {
        path = printed("/proc/%ld/task/%ld/children", (long)parent, (long)parent);
        FILE *children = fopen(path, "r");
        if (children && fscanf(children, "%ld", &child) == 1) {
            path = printed("/proc/%ld/exe", child);
            const ssize_t length = readlink(path, exe, sizeof exe - 1);
            exe[length > 0 ? length : 0] = '\0';
        }
        if (children)
            fclose(children);
        wait_for(5e-3);
    }
    cr_assert(strstr(exe, "/wisplab-bench"), "nobody measures");
    return (pid_t)child;
}

/* It may stay a while as a dead process without a program, if nobody asks how it ended. */
static int goes_away(pid_t child) {
    char exe[PATH_SIZE];
    const char *const path = printed("/proc/%ld/exe", (long)child);
    for (int i = 0; i < 4000; i++) {
        if (readlink(path, exe, sizeof exe) < 0)
            return 1;
        wait_for(5e-3);
    }
    return 0;
}

/* A signal to the one or the other. */
static void end_one(int signal, int to_child, int code, const char *says) {
    const char *const folder = folder_make();
    const struct process process =
        program_start(NULL, WORDS("experiment", "kernel", "--out", folder));
    const pid_t child = measuring_child(process.pid);
    kill(to_child ? child : process.pid, signal);
    struct finished *f = program_wait(&process);
    if (says)
        check(f, code, says, folder);
    else
        cr_assert_eq(f->code, code, "exit code %d: %s", f->code, f->err);
    cr_assert(goes_away(child), "it goes on measuring");
}

Test(bench, the_users_signal_ends_it) {
    end_one(SIGINT, 0, 3, "interrupted");
}

Test(bench, its_death_is_a_failure_of_the_measurement) {
    end_one(SIGUSR1, 1, 3, "died of signal 10");
}

Test(bench, it_does_not_outlive_who_started_it) {
    end_one(SIGKILL, 0, -SIGKILL, NULL);
}
