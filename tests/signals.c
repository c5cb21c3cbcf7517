/* The user's word ends the program wherever it is, and what it has started; what it leaves is whole
 * or not there. */
#include "base/owner.h"
#include "run/case.h"
#include "run/seal.h"
#include "support.h"

#include <criterion/criterion.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

/* Until the program catches signals; before that, none of its code has run. */
static void await_handlers(pid_t pid) {
    unsigned long long caught = 0;
    const char *const path = printed("/proc/%ld/status", (long)pid);
    while (!(caught >> (SIGTERM - 1) & 1)) {
        char *status = file_text(path), *line = status ? strstr(status, "SigCgt:") : NULL;
        cr_assert(line, "the program is gone");
        caught = strtoull(line + strlen("SigCgt:"), NULL, 16);
        free(status);
        wait_for(5e-3);
    }
}

/* Seconds of work that asks nobody whether it may go on. */
Test(signals, work_that_does_not_look_is_left, .init = open_folder) {
    static const int signals[] = {SIGINT, SIGTERM};
    const char *const path = file_write(
        folder, "many.cfg",
        "duration = 0.01; frame_rate = 100.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.3;\n"
        "nodes = 20; grid = [400, 400]; spacing = 0.1;\n"
        "across = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); } );\n");
    for (int i = 0; i < 2; i++) {
        const struct process process = program_start(NULL, WORDS("eval", path));
        await_handlers(process.pid);
        kill(process.pid, signals[i]);
        struct finished *f = program_wait(&process);
        cr_expect_eq(f->code, 3, "exit code %d", f->code);
        cr_expect_str_eq(f->err, "wisplab: interrupted\n");
    }
}

/* --- a run with a long table --- */

static void add_size(const char *path, void *ctx) {
    struct stat status;
    *(off_t *)ctx += stat(path, &status) == 0 ? status.st_size : 0;
}

/* What a run has written for seconds takes longer than its grace to be read again. The folder then
 * has a run that is sealed, or none; and so it has where the run had its last frame and was on its
 * way to the end. */
Test(signals, slow_a_long_table_is_there_whole_or_not, .init = open_folder) {
    static const char *const formats[] = {"text", "binary"};
    char reason[REASON_SIZE];
    for (int i = 0; i < 2; i++) {
        off_t size = 0;
        const struct process process =
            program_start(NULL, WORDS("run", "swing", "--duration", "3", "--set", "frame_rate=1e6",
                                      "--states", formats[i], "--out", folder, "--no-progress"));
        for (; size < 300000000; wait_for(5e-3)) {
            size = 0;
            each_file(folder, add_size, &size);
            cr_assert_eq(kill(process.pid, 0), 0);
        }
        kill(process.pid, SIGINT);
        const struct finished *f = program_wait(&process);
        cr_expect_eq(f->code, 3, "exit code %d: %s", f->code, f->err);
        const int named =
            count_files(folder, "") - count_files(folder, ".part") - count_files(folder, ".lock");
        cr_expect(named == 0 || (named == 2 && seal_holds(folder, reason)), "%s: %d files: %s",
                  formats[i], named, reason);
        cr_expect(named == 2 || i == 1, "what was hashed on the way was not kept");
        run_remove(folder);
    }
}

/* --- gnuplot --- */

/* A plot whose gnuplot hangs, once that has begun. Returns its process number. */
static struct process start_plot(long *gnuplot) {
    const char *const tables = printed("%s/circle", folder);
    char reason[REASON_SIZE];
    cr_assert_eq(make_folder(tables, reason), 0, "%s", reason);
    file_write(tables, "table.tsv", "a\n1\n");
    file_write(tables, "orbits.svg", "the last one");
    const char *const action =
        printed("echo $$ >%s/new && mv %s/new %s/pid; exec sleep 1000", folder, folder, folder);
    gnuplot_stub(action);
    const struct process process = program_start(NULL, WORDS("plot", "circle", "--out", folder));
    const char *const path = printed("%s/pid", folder);
    while (access(path, F_OK))
        wait_for(5e-3);
    char *text = file_read(path);
    *gnuplot = strtol(text, NULL, 10);
    return process;
}

static int is_there(long pid) {
    struct owner owner = owner_self();
    owner.pid = pid;
    owner.start = 0;
    return owner_look(&owner) == OWNER_THERE;
}

/* Folders in which gnuplot has drawn; a file is put into each, as by it. */
static int drawings_left(void) {
    glob_t found;
    files_like(printed("%s/circle", folder), ".drawing.*.part", &found);
    const int left = (int)found.gl_pathc;
    for (int i = 0; i < left; i++)
        file_write(found.gl_pathv[i], "half.svg", "half");
    globfree(&found);
    return left;
}

Test(signals, a_gnuplot_that_hangs_ends_too, .init = open_folder) {
    long gnuplot;
    const struct process process = start_plot(&gnuplot);
    kill(process.pid, SIGINT);
    struct finished *f = program_wait(&process);
    cr_expect_eq(f->code, 3, "exit code %d", f->code);
    cr_expect(strstr(f->err, "interrupted") && count_lines(f->err) == 1, "'%s'", f->err);
    cr_expect(!is_there(gnuplot), "gnuplot goes on");
    cr_expect_eq(drawings_left(), 0, "half a drawing is left");
}

/* What the killed one leaves, the next one removes. */
Test(signals, a_program_that_is_killed_leaves_no_gnuplot, .init = open_folder) {
    long gnuplot;
    const struct process process = start_plot(&gnuplot);
    kill(process.pid, SIGKILL);
    program_wait(&process);
    while (is_there(gnuplot)) /* to the end of the test's time */
        wait_for(5e-3);
    gnuplot_stub_quiet();
    cr_assert_eq(drawings_left(), 1, "the killed one has left nothing");
    WORKS("plot", "circle", "--out", folder);
    cr_expect_eq(drawings_left(), 0, "the killed one's is still there");
}
