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
    cr_assert_eq(f->code, code, "exit code %d: %s", f->code, f->err);
    cr_assert_eq(count_lines(f->err), 1, "%s", f->err);
    cr_assert(strstr(f->err, says), "'%s' is not in %s", says, f->err);
    cr_assert_eq(count_files(folder, "samples"), 0, "samples are left");
    cr_assert_eq(count_files(folder, ".part"), 0, "half a file is left");
}

/* --- what it says --- */

Test(bench, a_failed_measurement_is_said_in_one_line) {
    static const char scene[] =
        "duration = 1.0;\ngravity = [0, -10, 0];\nmaterial = { };\nenvelope = { };\n"
        "wisps = ({ root = [0, 0, 0]; direction = [1, 0, 0]; length = 1e-300; nodes = 5; });\n";
    char folder[PATH_SIZE], path[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    file_write(folder, "point.cfg", scene, path);
    PROGRAM(&f, NULL, "experiment", "kernel", "--quick", "--scene", path, "--out", folder);
    check(&f, 3, "bench: the twin has no acceleration", folder);
    folder_remove(folder);
}

Test(bench, a_scene_without_envelopes_is_refused) {
    static const char *const scenes[] = {"circle", "swing"};
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    for (int i = 0; i < 2; i++) {
        PROGRAM(&f, NULL, "experiment", "kernel", "--scene", scenes[i], "--out", folder);
        check(&f, 1, "needs wisps with an envelope", folder);
    }
    folder_remove(folder);
}

Test(bench, out_of_time_is_out_of_time) {
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "experiment", "kernel", "--time-limit", "0.05", "--out", folder);
    check(&f, 3, "out of time", folder);
    folder_remove(folder);
}

/* The limit is one of memory that the program can have, and it says that it has no more. */
Test(bench, a_limit_of_memory_is_the_measurements) {
#ifndef __SANITIZE_ADDRESS__
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    PROGRAM(&f, NULL, "experiment", "kernel", "--memory-limit", "16", "--out", folder);
    check(&f, 2, "out of memory", folder);
    folder_remove(folder);
#endif
}

/* A copy of the program that stands alone finds scenes, but nothing that measures. */
Test(bench, where_it_is_missing_that_is_said) {
    char folder[PATH_SIZE], command[6 * PATH_SIZE], path[PATH_SIZE];
    struct finished f = {.code = 0};
    folder_make(folder);
    snprintf(command, sizeof command,
             "cp '%s' '%s' && '%s/wisplab' experiment kernel --out '%s/out' >/dev/null 2>'%s/said'",
             program_path, folder, folder, folder, folder);
    f.code = WEXITSTATUS(system(command));
    path_format(path, "%s/said", folder);
    char *said = file_read(path);
    snprintf(f.err, sizeof f.err, "%s", said ? said : "");
    check(&f, 2, "wisplab-bench: cannot be started: No such file or directory", folder);
    free(said);
    folder_remove(folder);
}

/* --- what ends it --- */

/* The program that measures, once it is one: a child is at first what its parent is. */
static pid_t measuring_child(pid_t parent) {
    char path[PATH_SIZE], exe[PATH_SIZE] = "";
    long child = 0;
    for (int i = 0; i < 4000 && !strstr(exe, "/wisplab-bench"); i++) {
        path_format(path, "/proc/%ld/task/%ld/children", (long)parent, (long)parent);
        FILE *children = fopen(path, "r");
        if (children && fscanf(children, "%ld", &child) == 1) {
            path_format(path, "/proc/%ld/exe", child);
            const ssize_t length = readlink(path, exe, sizeof exe - 1);
            exe[length > 0 ? length : 0] = '\0';
        }
        if (children)
            fclose(children);
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
    cr_assert(strstr(exe, "/wisplab-bench"), "nobody measures");
    return (pid_t)child;
}

/* It may stay a while as a dead process without a program, if nobody asks how it ended. */
static int goes_away(pid_t child) {
    char path[PATH_SIZE], exe[PATH_SIZE];
    path_format(path, "/proc/%ld/exe", (long)child);
    for (int i = 0; i < 4000; i++) {
        if (readlink(path, exe, sizeof exe) < 0)
            return 1;
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
    return 0;
}

/* A signal to the one or the other. */
static void end_one(int signal, int to_child, int code, const char *says) {
    char folder[PATH_SIZE];
    struct finished f;
    folder_make(folder);
    const char *const words[] = {"experiment", "kernel", "--out", folder, NULL};
    const struct process process = program_start(NULL, words);
    const pid_t child = measuring_child(process.pid);
    kill(to_child ? child : process.pid, signal);
    program_wait(&process, &f);
    if (says)
        check(&f, code, says, folder);
    else
        cr_assert_eq(f.code, code, "exit code %d: %s", f.code, f.err);
    cr_assert(goes_away(child), "it goes on measuring");
    folder_remove(folder);
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
