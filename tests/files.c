/* Files that appear whole or not at all, whoever is killed, and what is left of those that did not.
 */
#include "base/files.h"

#include "base/owner.h"
#include "disk.h"
#include "support.h"

#include <criterion/criterion.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

Test(files, are_on_the_disk_before_they_have_their_name) {
    char reason[REASON_SIZE];
    struct atomic_file file;
    const char *const folder = folder_make();
    const char *const path = printed("%s/a", folder);
    const char *const other = printed("%s/b", folder);
    disk_noting = 1;
    cr_assert_eq(atomic_open(&file, path, reason), 0, "%s", reason);
    fputs("all of it\n", file.stream);
    cr_assert_eq(atomic_commit(&file, reason), 0, "%s", reason);
    cr_assert_str_eq(disk_done, "frd");
    cr_assert_eq(file_put(path, other), 0);
    cr_assert_str_eq(disk_done, "frdfrd");
    char *text = file_read(other);
    cr_assert(text && strcmp(text, "all of it\n") == 0);
}

/* Files that belong together: all have their names, or none. */
Test(files, that_belong_together_get_their_names_together) {
    char reason[REASON_SIZE];
    for (int fails = 0; fails < 2; fails++) {
        struct atomic_file files[3] = {0};
        const char *const folder = folder_make(), *path = NULL;
        disk_noting = 0;
        for (int i = 0; i < 3; i++) {
            path = printed("%s/%d", folder, i);
            if (i == 1) /* was not opened */
                continue;
            cr_assert_eq(atomic_open(&files[i], path, reason), 0, "%s", reason);
            fputs("all of it\n", files[i].stream);
            cr_assert_eq(atomic_close(&files[i], 1, reason), 0, "%s", reason);
        }
        cr_assert_eq(count_files(folder, ".part"), 2);
        memset(disk_done, 0, sizeof disk_done);
        disk_noting = 1;
        if (fails)
            cr_assert_eq(mkdir(path, 0777), 0); /* where the last one should be */
        cr_assert_eq(atomic_name(files, 3, reason), fails ? -1 : 0, "%s", reason);
        cr_assert_eq(count_files(folder, ""), fails ? 0 : 2, "%s", reason);
        cr_assert_str_eq(disk_done, fails ? "rr" : "rrd");
    }
}

Test(files, have_temporary_names_that_nobody_foresees) {
    char reason[REASON_SIZE];
    struct atomic_file one, two;
    const char *const folder = folder_make();
    const char *const path = printed("%s/a", folder);
    cr_assert_eq(atomic_open(&one, path, reason), 0, "%s", reason);
    cr_assert_eq(atomic_open(&two, path, reason), 0, "%s", reason);
    cr_assert(strcmp(one.temporary, two.temporary) != 0);
    fputs("one", one.stream);
    fputs("two", two.stream);
    cr_assert(atomic_commit(&one, reason) == 0 && atomic_commit(&two, reason) == 0, "%s", reason);
    char *text = file_read(path);
    cr_assert(text && strcmp(text, "two") == 0);
    cr_assert_eq(count_files(folder, ""), 1);
}

/* --- leftovers --- */

/* Begins a file in a process of its own, on a host of that name or this one, and stops there. */
static pid_t begin_file(const char *path, const char *host) {
    int ready[2];
    char reason[REASON_SIZE], byte;
    cr_assert_eq(pipe(ready), 0);
    const pid_t pid = fork();
    if (pid == 0) {
        struct atomic_file file;
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (host)
            setenv("WISPLAB_HOST", host, 1);
        if (atomic_open(&file, path, reason) || write(ready[1], "", 1) != 1)
            _exit(1);
        pause();
        _exit(0);
    }
    cr_assert(pid > 0 && read(ready[0], &byte, 1) == 1, "no process has begun a file");
    close(ready[0]);
    close(ready[1]);
    return pid;
}

static void end(pid_t pid) {
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
}

/* Writes a whole file, as the next process would; returns how many files there are then. */
static int write_next(const char *folder, const char *path) {
    char reason[REASON_SIZE];
    struct atomic_file file;
    cr_assert_eq(atomic_open(&file, path, reason), 0, "%s", reason);
    cr_assert_eq(atomic_commit(&file, reason), 0, "%s", reason);
    return count_files(folder, "");
}

static void age(const char *path, void *ctx) {
    const struct timespec before[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = *(const long *)ctx}};
    if (strstr(path, ".part"))
        cr_assert_eq(utimensat(AT_FDCWD, path, before, 0), 0);
}

/* The next writer of a file removes what one that is gone left, and nothing of one that is not. */
Test(files, the_next_removes_what_a_killed_one_left) {
    const char *const folder = folder_make();
    const char *const path = printed("%s/a", folder);
    const pid_t alive = begin_file(path, NULL);
    cr_assert_eq(write_next(folder, path), 2, "what is being written is gone");
    kill(alive, SIGKILL);
    siginfo_t info; /* dead, but still a row in the table of processes */
    cr_assert_eq(waitid(P_PID, (id_t)alive, &info, WEXITED | WNOWAIT), 0);
    cr_assert_eq(write_next(folder, path), 1, "it is left");
    end(alive);
    end(begin_file(path, NULL));
    atomic_remove_leftovers(path);
    cr_assert_eq(count_files(folder, ""), 1, "it is left");
}

/* Other hosts cannot be asked: the file server's time tells. */
Test(files, what_another_host_left_is_removed_in_time) {
    struct stat status;
    const char *const folder = folder_make();
    const char *const path = printed("%s/a", folder);
    end(begin_file(path, "elsewhere"));
    cr_assert_eq(write_next(folder, path), 2, "who knows whether that one is gone?");
    cr_assert_eq(stat(path, &status), 0);
    long then = (long)status.st_mtime - 3500;
    each_file(folder, age, &then);
    cr_assert_eq(write_next(folder, path), 2, "less than an hour");
    then -= 200;
    each_file(folder, age, &then);
    cr_assert_eq(write_next(folder, path), 1, "more than an hour");
}

/* --- who it was --- */

Test(files, an_owner_is_a_process_at_a_time_on_a_host) {
    struct owner owner = owner_self();
    cr_assert_eq(owner.pid, getpid());
    cr_assert(owner.start > 0 && strpbrk(owner.host, " \n") == NULL, "'%s'", owner.host);
    cr_assert_eq(owner_look(&owner), OWNER_THERE);
    owner.start--;
    cr_assert_eq(owner_look(&owner), OWNER_GONE, "another one had that number");
    owner.start = 0;
    cr_assert_eq(owner_look(&owner), OWNER_THERE, "not known when");
    owner.pid = 0;
    cr_assert_eq(owner_look(&owner), OWNER_GONE, "0 is no process");
    owner.pid = -1;
    cr_assert_eq(owner_look(&owner), OWNER_GONE, "nor is -1");
    strcat(owner.host, "x");
    cr_assert_eq(owner_look(&owner), OWNER_ELSEWHERE);
}

/* Containers may share a name, and numbers begin anew after a boot. */
Test(files, a_host_is_a_name_a_boot_and_a_space_of_processes) {
    char name[65] = "", boot[64];
    unsetenv("WISPLAB_HOST");
    cr_assert_eq(gethostname(name, sizeof name - 1), 0);
    FILE *file = fopen("/proc/sys/kernel/random/boot_id", "r");
    cr_assert(file && fgets(boot, sizeof boot, file));
    fclose(file);
    boot[8] = '\0';
    const char *host = owner_host();
    cr_assert(strncmp(host, name, strlen(name)) == 0 && strstr(host, boot), "%s", host);
    cr_assert(strstr(host, "/pid:["), "%s", host);
}
