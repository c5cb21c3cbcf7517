/* Experiments that are killed, shared and split: every run is done once, and none is lost. */
#include "run/results.h"
#include "support.h"

#include <criterion/criterion.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { RUNS_MAX = 200 };

/* The run.json files of a folder: their inodes change when they are written again. */
struct inventory {
    int count;
    ino_t inode[RUNS_MAX];
    struct timespec time[RUNS_MAX];
};

static void add_run(const char *path, void *ctx) {
    struct inventory *all = ctx;
    const char *slash = strrchr(path, '/');
    struct stat status;
    if (strcmp(slash, "/run.json") != 0 || all->count == RUNS_MAX || stat(path, &status))
        return;
    all->inode[all->count] = status.st_ino;
    all->time[all->count++] = status.st_mtim;
}

static struct inventory look(const char *folder) {
    struct inventory all = {.count = 0};
    each_file(folder, add_run, &all);
    return all;
}

/* How many of the runs of `before` are untouched in `after`. */
static int kept(const struct inventory *before, const struct inventory *after) {
    int same = 0;
    for (int i = 0; i < before->count; i++)
        for (int k = 0; k < after->count; k++)
            same += before->inode[i] == after->inode[k] &&
                    before->time[i].tv_sec == after->time[k].tv_sec &&
                    before->time[i].tv_nsec == after->time[k].tv_nsec;
    return same;
}

Test(resume, slow_an_experiment_goes_on_after_kill_9, .init = gnuplot_stub_quiet) {
    const char *const folder = folder_make();
    const char *const words[] = {"experiment", "circle", "--quick", "--out", folder, NULL};
    int runs = 0, killed_between = 0;
    struct inventory before = {0};
    for (int round = 1; round <= 2; round++) {
        const struct process process = program_start(NULL, words);
        while (look(folder).count < 10 * round && kill(process.pid, 0) == 0)
            wait_for(1e-3);
        kill(process.pid, SIGKILL);
        const struct finished *f = program_wait(&process);
        wait_for(0.1); /* its children die with it, but not before it */
        const struct inventory now = look(folder);
        cr_assert_eq(kept(&before, &now), before.count, "a complete run was done again");
        before = now;
        killed_between += f->code == -SIGKILL;
    }
    cr_assert_eq(killed_between, 2, "it was over before it could be killed");
    const int new = new_runs(program_must(NULL, 0, NULL, words), &runs);
    const struct inventory after = look(folder);
    cr_assert_eq(after.count, runs, "%d of %d runs are there", after.count, runs);
    cr_assert_eq(new, runs - before.count, "%d new runs where %d of %d were there", new,
                 before.count, runs);
    cr_assert_eq(kept(&before, &after), before.count, "a complete run was done again");
}

/* Two processes on one folder, at once: together they do each run once. */
static int share(void) {
    int runs, new[2];
    const char *const folder = folder_make();
    const char *const words[] = {"experiment", "circle", "--quick", "--out", folder, NULL};
    const struct process first = program_start(NULL, words), second = program_start(NULL, words);
    for (int i = 0; i < 2; i++) {
        const struct finished *f = program_wait(i == 0 ? &first : &second);
        cr_assert_eq(f->code, 0, "exit code %d: %s", f->code, f->err);
        new[i] = new_runs(f, &runs);
    }
    cr_assert_eq(new[0] + new[1], runs, "%d + %d new runs for %d", new[0], new[1], runs);
    cr_assert_eq(look(folder).count, runs, "%d runs are there", look(folder).count);
    return new[0] > 0 && new[1] > 0;
}

/* On a busy machine one may have done all before the other begins: that is no test. */
Test(resume, slow_two_processes_share_a_folder, .init = gnuplot_stub_quiet) {
    int shared = 0;
    for (int i = 0; i < 5 && !shared; i++)
        shared = share();
    cr_assert(shared, "one did all the runs every time");
}

Test(resume, slow_fresh_keeps_nothing, .init = gnuplot_stub_quiet) {
    int runs;
    struct inventory before = {0};
    const char *const folder = folder_make();
    for (int round = 0; round < 3; round++) {
        const int new =
            new_runs(WORKS("experiment", "circle", "--quick", "--stepper", "rk4", "--stepper",
                           "euler", "--out", folder, round == 2 ? "--fresh" : NULL),
                     &runs);
        cr_assert_eq(new, round == 1 ? 0 : runs, "round %d: %d new runs", round, new);
        const struct inventory after = look(folder);
        cr_assert_eq(kept(&before, &after), round == 1 ? runs : 0, "round %d", round);
        before = after;
    }
}

/* Kills the children that a process has now. */
static void kill_children(pid_t parent) {
    long pid;
    const char *const path = printed("/proc/%ld/task/%ld/children", (long)parent, (long)parent);
    FILE *file = fopen(path, "r");
    while (file && fscanf(file, "%ld", &pid) == 1)
        kill((pid_t)pid, SIGKILL);
    if (file)
        fclose(file);
}

/* What is killed again and again is left out, and that is said; then the same command does it. */
Test(resume, slow_runs_that_are_killed_are_missed, .init = gnuplot_stub_quiet) {
    const char *const folder = folder_make();
    const char *const words[] = {"experiment", "circle", "--quick", "--stepper",
                                 "reference",  "--out",  folder,    NULL};
    const struct process process = program_start(NULL, words);
    for (siginfo_t info = {0};
         waitid(P_PID, (id_t)process.pid, &info, WEXITED | WNOWAIT | WNOHANG) == 0 &&
         info.si_pid == 0;)
        kill_children(process.pid);
    struct finished *f = program_wait(&process);
    cr_assert(f->code == 2 && strstr(f->err, "killed from outside and are left out"), "%d: %s",
              f->code, f->err);
    cr_assert_eq(count_files(folder, "statements.tsv"), 0, "a table is made of what there is");
    program_must(NULL, 0, NULL, words);
}

/* Figures from run folders alone. */
Test(resume, slow_figures_are_drawn_again_without_runs) {
    const char *const folder = folder_make();
    gnuplot_stub_quiet();
    WORKS("experiment", "circle", "--quick", "--out", folder);
    cr_assert_eq(count_files(folder, "orbits-30s.svg"), 0, "figures without gnuplot");
    const struct inventory before = look(folder);
    gnuplot_unstub();
    WORKS("plot", "circle", "--out", folder);
    const int svg = count_files(folder, ".svg"), png = count_files(folder, ".png");
    cr_assert_eq(count_files(folder, "orbits-30s.svg"), 1);
    cr_assert(svg > 0 && svg == png, "%d svg and %d png files", svg, png);
    const struct inventory after = look(folder);
    cr_assert(kept(&before, &after) == before.count && before.count == after.count,
              "plot touches runs");
}

/* A gnuplot that fails or writes nothing into a figure: exit code 2, in one line, no half figure.
 */
Test(resume, a_gnuplot_that_fails_exits_2) {
    static const struct {
        const char *action, *says;
    } cases[] = {
        {"exit 1", "gnuplot failed"},
        {"kill -9 $$", "gnuplot died of signal 9"},
        /* the folder to draw into is in the variables, which are of gnuplot's language */
        {"d=${3#*out=\\'}; : >\"${d%%\\'*}/half.svg\"", "drawn no png"},
    };
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        gnuplot_stub(cases[i].action);
        FAILS(2, cases[i].says, "experiment", "circle", "--quick", "--stepper", "rk4", "--out",
              folder);
        cr_assert_eq(count_files(folder, ".svg"), 0, "%s: half a figure is left", cases[i].action);
    }
}

/* A run that finished has all its frames, whatever befell its files since. */
Test(resume, what_is_left_of_a_run_is_no_run) {
#define NAMES        "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\n"
#define ROW(t, node) #t "\t0\t" #node "\t0\t0\t0\t0\t0\t0\n"
    static const char whole[] = NAMES ROW(0, 0) ROW(0, 1) ROW(1, 0) ROW(1, 1);
    static const char finished[] = "{\"status\": \"finished\", \"frames\": 2}";
    static const struct {
        const char *json, *states, *says; /* says: NULL: taken */
    } files[] = {
        {finished, whole, NULL},
        {finished, NAMES ROW(0, 0) ROW(1, 0) ROW(1, 1), NULL}, /* one more after a split */
        {finished, NAMES ROW(0, 0) ROW(0, 1) ROW(1, 0), "states.tsv: has not all frames"},
        {finished, NAMES ROW(0, 0) ROW(0, 1), "states.tsv: has not all frames"},
        {finished, NAMES, "states.tsv: has not all frames"},
        {finished, "t\n0\n1\n", "states.tsv: has not the columns"},
        {finished, "t\twisp\tnode\n0\t0\t0\n1\t0\t0\n", "states.tsv: has not the columns"},
        {finished, NULL, "states.tsv: cannot be read"},
        {"{\"status\": \"finished\"}", whole, "states.tsv: has not all frames"},
        {"{\"status\": \"not finite\"}", NULL, NULL},
        {"{\"status\": \"not finite\"}", NAMES ROW(0, 0), NULL},
        {"{\"status\": 3}", whole, "run.json: unknown status"},
        {"[]", whole, "run.json: unknown status"},
        {"{\"status\": \"fini", whole, "run.json:1: "},
        {"", whole, "run.json:1: "},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char reason[REASON_SIZE] = "";
        struct run_files run;
        const char *const folder = folder_make();
        file_write(folder, "run.json", files[i].json);
        if (files[i].states)
            file_write(folder, "states.tsv", files[i].states);
        const int code = run_read_states(&run, folder, NULL, reason);
        cr_expect_eq(code, files[i].says ? -1 : 0, "row %d: '%s'", (int)i, reason);
        cr_expect(!files[i].says || strstr(reason, files[i].says), "row %d: '%s'", (int)i, reason);
        if (!code)
            run_free(&run);
    }
}

/* --- damage --- */

enum { DAMAGES = 6 };

/* The files of the first so many runs, one each. */
struct victims {
    int count;
    char path[DAMAGES][PATH_SIZE];
};

static void add_victim(const char *path, void *ctx) {
    struct victims *all = ctx;
    const char *end = strrchr(path, '/'), *const names[DAMAGES] = {"run.json",   "run.json",
                                                                   "run.json",   "states.tsv",
                                                                   "states.tsv", "states.tsv"};
    if (strcmp(end, "/run.json") == 0 && all->count < DAMAGES) {
        snprintf(all->path[all->count], PATH_SIZE, "%.*s/%s", (int)(end - path), path,
                 names[all->count]);
        all->count++;
    }
}

/* An empty file, a cut one, and one of which a digit is another. */
static void damage(const char *path, int how) {
    char *text = file_read(path);
    cr_assert(text, "no %s", path);
    const size_t length = strlen(text);
    char *digit = strrchr(text, '7');
    if (how == 2 && digit)
        *digit = '3';
    FILE *file = fopen(path, "w");
    cr_assert(file && (how != 2 || digit));
    fwrite(text, 1, how == 0 ? 0 : how == 1 ? length / 2 : length, file);
    fclose(file);
}

/* What is damaged is set aside and done again; everything else stays, and all tables appear as they
 * were. */
Test(resume, slow_damage_is_local, .init = gnuplot_stub_quiet) {
    struct victims victims = {0};
    const char *const folder = folder_make();
    const char *const table = printed("%s/circle/radius.tsv", folder);
    const char *const words[] = {"experiment", "circle", "--quick", "--stepper", "rk4",
                                 "--stepper",  "euler",  "--out",   folder,      NULL};
    program_must(NULL, 0, NULL, words);
    char *before = file_read(table);
    const struct inventory all = look(folder);
    each_file(folder, add_victim, &victims);
    cr_assert(before && victims.count == DAMAGES);
    for (int i = 0; i < DAMAGES; i++)
        damage(victims.path[i], i % 3);
    for (int again = 0; again < 2; again++) {
        const struct finished *f = program_must(NULL, 0, NULL, words);
        const int new = new_runs(f, NULL);
        cr_assert_eq(new, again ? 0 : DAMAGES, "%d runs are done again", new);
        cr_assert_eq(count_of(f->err, "it is set aside as"), new, "%s", f->err);
    }
    const struct inventory after = look(folder);
    cr_expect_geq(kept(&all, &after), all.count - DAMAGES);
    char *now = file_read(table);
    cr_expect(now && strcmp(now, before) == 0, "the table is another one");
}
