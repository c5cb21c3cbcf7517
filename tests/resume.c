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

/* "circle: 62 runs, 40 of them new" */
static void read_counts(const struct finished *f, int *runs, int *new) {
    const char *line = strstr(f->out, "circle: ");
    cr_assert(line && sscanf(line, "circle: %d runs, %d of them new", runs, new) == 2,
              "exit code %d, no count of runs in '%s', '%s'", f->code, f->out, f->err);
}

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

static void nap(long milliseconds) {
    nanosleep(&(struct timespec){.tv_nsec = 1000000 * milliseconds}, NULL);
}

Test(resume, slow_an_experiment_goes_on_after_kill_9, .init = gnuplot_stub_quiet,
     .fini = gnuplot_stub_remove) {
    char folder[PATH_SIZE];
    const char *const words[] = {"experiment", "circle", "--quick", "--out", folder, NULL};
    struct finished f;
    int runs = 0, new = 0, killed_between = 0;
    struct inventory before = {0};
    folder_make(folder);
    for (int round = 1; round <= 2; round++) {
        const struct process process = program_start(NULL, words);
        while (look(folder).count < 10 * round && kill(process.pid, 0) == 0)
            nap(1);
        kill(process.pid, SIGKILL);
        program_wait(&process, &f);
        nap(100); /* its children die with it, but not before it */
        const struct inventory now = look(folder);
        cr_assert_eq(kept(&before, &now), before.count, "a complete run was done again");
        before = now;
        killed_between += f.code == -SIGKILL;
    }
    cr_assert_eq(killed_between, 2, "it was over before it could be killed");
    const struct process process = program_start(NULL, words);
    program_wait(&process, &f);
    const struct inventory after = look(folder);
    read_counts(&f, &runs, &new);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    cr_assert_eq(after.count, runs, "%d of %d runs are there", after.count, runs);
    cr_assert_eq(new, runs - before.count, "%d new runs where %d of %d were there", new,
                 before.count, runs);
    cr_assert_eq(kept(&before, &after), before.count, "a complete run was done again");
    folder_remove(folder);
}

/* Two processes on one folder, at once: together they do each run once. */
static int share(void) {
    char folder[PATH_SIZE];
    struct finished f[2];
    int runs[2], new[2];
    folder_make(folder);
    const char *const words[] = {"experiment", "circle", "--quick", "--out", folder, NULL};
    const struct process first = program_start(NULL, words), second = program_start(NULL, words);
    program_wait(&first, &f[0]);
    program_wait(&second, &f[1]);
    for (int i = 0; i < 2; i++) {
        cr_assert_eq(f[i].code, 0, "exit code %d: %s", f[i].code, f[i].err);
        read_counts(&f[i], &runs[i], &new[i]);
    }
    cr_assert_eq(new[0] + new[1], runs[0], "%d + %d new runs for %d", new[0], new[1], runs[0]);
    cr_assert_eq(look(folder).count, runs[0], "%d runs are there", look(folder).count);
    folder_remove(folder);
    return new[0] > 0 && new[1] > 0;
}

/* On a busy machine one may have done all before the other begins: that is no test. */
Test(resume, slow_two_processes_share_a_folder, .init = gnuplot_stub_quiet,
     .fini = gnuplot_stub_remove) {
    int shared = 0;
    for (int i = 0; i < 5 && !shared; i++)
        shared = share();
    cr_assert(shared, "one did all the runs every time");
}

Test(resume, slow_fresh_keeps_nothing, .init = gnuplot_stub_quiet, .fini = gnuplot_stub_remove) {
    char folder[PATH_SIZE];
    struct finished f;
    int runs, new;
    struct inventory before = {0};
    folder_make(folder);
    for (int round = 0; round < 3; round++) {
        PROGRAM(&f, NULL, "experiment", "circle", "--quick", "--stepper", "rk4", "--stepper",
                "euler", "--out", folder, round == 2 ? "--fresh" : NULL);
        cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
        read_counts(&f, &runs, &new);
        cr_assert_eq(new, round == 1 ? 0 : runs, "round %d: %d new runs", round, new);
        const struct inventory after = look(folder);
        cr_assert_eq(kept(&before, &after), round == 1 ? runs : 0, "round %d", round);
        before = after;
    }
    folder_remove(folder);
}

/* Kills the children that a process has now. */
static void kill_children(pid_t parent) {
    char path[64];
    long pid;
    snprintf(path, sizeof path, "/proc/%ld/task/%ld/children", (long)parent, (long)parent);
    FILE *file = fopen(path, "r");
    while (file && fscanf(file, "%ld", &pid) == 1)
        kill((pid_t)pid, SIGKILL);
    if (file)
        fclose(file);
}

/* What is killed again and again is left out, and that is said; then the same command does it. */
Test(resume, slow_runs_that_are_killed_are_missed, .init = gnuplot_stub_quiet,
     .fini = gnuplot_stub_remove) {
    char folder[PATH_SIZE];
    const char *const words[] = {"experiment", "circle", "--quick", "--stepper",
                                 "reference",  "--out",  folder,    NULL};
    struct finished f;
    folder_make(folder);
    const struct process process = program_start(NULL, words);
    for (siginfo_t info = {0};
         waitid(P_PID, (id_t)process.pid, &info, WEXITED | WNOWAIT | WNOHANG) == 0 &&
         info.si_pid == 0;)
        kill_children(process.pid);
    program_wait(&process, &f);
    cr_assert_eq(f.code, 2, "exit code %d: %s", f.code, f.err);
    cr_assert(strstr(f.err, "killed from outside and are left out"), "'%s'", f.err);
    cr_assert_eq(count_files(folder, "statements.tsv"), 0, "a table is made of what there is");
    const struct process again = program_start(NULL, words);
    program_wait(&again, &f);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    folder_remove(folder);
}

/* Figures from run folders alone. */
Test(resume, slow_figures_are_drawn_again_without_runs) {
    char folder[PATH_SIZE], *path = strdup(getenv("PATH"));
    struct finished f;
    folder_make(folder);
    gnuplot_stub_quiet();
    PROGRAM(&f, NULL, "experiment", "circle", "--quick", "--out", folder);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    cr_assert_eq(count_files(folder, "orbits-30s.svg"), 0, "figures without gnuplot");
    const struct inventory before = look(folder);
    gnuplot_stub_remove();
    setenv("PATH", path, 1);
    PROGRAM(&f, NULL, "plot", "circle", "--out", folder);
    cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
    const int svg = count_files(folder, ".svg"), png = count_files(folder, ".png");
    cr_assert_eq(count_files(folder, "orbits-30s.svg"), 1);
    cr_assert(svg > 0 && svg == png, "%d svg and %d png files", svg, png);
    const struct inventory after = look(folder);
    cr_assert(kept(&before, &after) == before.count && before.count == after.count,
              "plot touches runs");
    folder_remove(folder);
    free(path);
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
    char folder[PATH_SIZE], *path = strdup(getenv("PATH"));
    struct finished f;
    folder_make(folder);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        setenv("PATH", path, 1);
        gnuplot_stub(cases[i].action);
        PROGRAM(&f, NULL, "experiment", "circle", "--quick", "--stepper", "rk4", "--out", folder);
        cr_assert_eq(f.code, 2, "%s: exit code %d, %s", cases[i].action, f.code, f.err);
        cr_assert(count_lines(f.err) == 1 && strstr(f.err, cases[i].says), "%s: '%s'",
                  cases[i].action, f.err);
        cr_assert_eq(count_files(folder, ".svg"), 0, "%s: half a figure is left", cases[i].action);
        gnuplot_stub_remove();
    }
    folder_remove(folder);
    free(path);
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
        char folder[PATH_SIZE], reason[REASON_SIZE] = "";
        struct run_files run;
        folder_make(folder);
        file_write(folder, "run.json", files[i].json, NULL);
        if (files[i].states)
            file_write(folder, "states.tsv", files[i].states, NULL);
        const int code = run_read_states(&run, folder, NULL, reason);
        cr_expect_eq(code, files[i].says ? -1 : 0, "row %d: '%s'", (int)i, reason);
        cr_expect(!files[i].says || strstr(reason, files[i].says), "row %d: '%s'", (int)i, reason);
        if (!code)
            run_free(&run);
        folder_remove(folder);
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
    free(text);
}

/* What is damaged is set aside and done again; everything else stays, and all tables appear as they
 * were. */
Test(resume, slow_damage_is_local, .init = gnuplot_stub_quiet, .fini = gnuplot_stub_remove) {
    char folder[PATH_SIZE], table[PATH_SIZE];
    struct victims victims = {0};
    struct finished f;
    int runs, new;
    folder_make(folder);
    path_format(table, "%s/circle/radius.tsv", folder);
    const char *const words[] = {"experiment", "circle", "--quick", "--stepper", "rk4",
                                 "--stepper",  "euler",  "--out",   folder,      NULL};
    struct process process = program_start(NULL, words);
    program_wait(&process, &f);
    char *before = file_read(table);
    const struct inventory all = look(folder);
    each_file(folder, add_victim, &victims);
    cr_assert(f.code == 0 && before && victims.count == DAMAGES, "%d: %s", f.code, f.err);
    for (int i = 0; i < DAMAGES; i++)
        damage(victims.path[i], i % 3);
    for (int again = 0; again < 2; again++) {
        process = program_start(NULL, words);
        program_wait(&process, &f);
        read_counts(&f, &runs, &new);
        cr_assert_eq(f.code, 0, "exit code %d: %s", f.code, f.err);
        cr_assert_eq(new, again ? 0 : DAMAGES, "%d runs are done again", new);
        cr_assert_eq(count_of(f.err, "it is set aside as"), new, "%s", f.err);
    }
    const struct inventory after = look(folder);
    cr_expect_geq(kept(&all, &after), all.count - DAMAGES);
    char *now = file_read(table);
    cr_expect(now && strcmp(now, before) == 0, "the table is another one");
    free(now);
    free(before);
    folder_remove(folder);
}
