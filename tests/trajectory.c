/* States read back: frames, wisps and parents; and that a command reads each file once. */
#include "model/trajectory.h"

#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

static char *folder;

static void open_folder(void) {
    folder = folder_make();
}

#define NAMES  "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz"
#define NODE_0 "\t0\t1\t2\t3\t4\t5\t6"
#define NODE_1 "\t1\t7\t8\t9\t0\t0\t0"

/* Wisps 0 and 1 of two nodes; wisp 2 splits off from wisp 1 at the second frame. */
static const char family[] = NAMES "\tparent\n"
                                   "0\t0" NODE_0 "\t0\n0\t0" NODE_1 "\t0\n"
                                   "0\t1" NODE_0 "\t1\n0\t1" NODE_1 "\t1\n"
                                   "0.1\t0" NODE_0 "\t0\n0.1\t0" NODE_1 "\t0\n"
                                   "0.1\t1" NODE_0 "\t1\n0.1\t1" NODE_1 "\t1\n"
                                   "0.1\t2" NODE_0 "\t1\n0.1\t2" NODE_1 "\t1\n";

static const char orphans[] = NAMES "\n0\t0" NODE_0 "\n0\t0" NODE_1 "\n"
                                    "0\t1" NODE_0 "\n0\t1" NODE_1 "\n";

Test(trajectory, frames_wisps_and_parents_are_those_of_the_file, .init = open_folder) {
    char reason[REASON_SIZE];
    struct trajectory t;
    cr_assert_eq(trajectory_read(&t, file_write(folder, "states.tsv", family), reason), 0, "%s",
                 reason);
    cr_assert(t.frame_count == 2 && t.wisp_count == 3 && t.table.row_count == 10);
    cr_assert_eq(t.table.column_count, STATE_SAMPLES, "the parent is no column of the state");
    cr_assert(t.frames[1].t == 0.1 && t.frames[1].row == 4 && t.frames[1].wisps == 3);
    cr_assert(trajectory_end(&t, 0) == 4 && trajectory_end(&t, 1) == 10);
    cr_assert(trajectory_wisp(&t, 1, 2) == 8 && trajectory_nodes(&t, 1, 2) == 2);
    cr_assert_eq(trajectory_row(&t, 9)[STATE_X + 1], 8, "row 9 is another");
    cr_assert(t.parent[0] == 0 && t.parent[1] == 1 && t.parent[2] == 1);
    trajectory_free(&t);
    cr_assert_eq(trajectory_read(&t, file_write(folder, "states.tsv", orphans), reason), 0, "%s",
                 reason);
    cr_assert(t.wisp_count == 2 && t.parent[0] == 0 && t.parent[1] == 1, "of an older file");
    trajectory_free(&t);
}

/* A parent is one of those before, a whole number, and in the wisp's next row the same. */
Test(trajectory, wrong_parents_are_refused, .init = open_folder) {
    static const char *const wrong[] = {"3", "-1", "0.5", "nan", "0"};
    char reason[REASON_SIZE];
    struct trajectory t;
    for (int i = 0; i < 5; i++) {
        const char *at = strstr(family, "0.1\t2\t0"); /* the child's first row, or its second */
        for (int row = 0; row <= (i == 4); row++)
            at = strchr(at, '\n') + 1;
        const char *const text =
            printed("%.*s%s%s", (int)(at - 2 - family), family, wrong[i], at - 1);
        const char *const says =
            printed("row %d: the parent of wisp 2 is not %s", i == 4 ? 10 : 9, wrong[i]);
        cr_assert_eq(trajectory_read(&t, file_write(folder, "states.tsv", text), reason), -1,
                     "%s is a parent", wrong[i]);
        cr_assert(strstr(reason, says), "not '%s': %s", says, reason);
    }
}

/* Whoever asks, by whatever path, gets the same numbers; a file that was written anew is read. */
Test(trajectory, each_file_is_read_once, .init = open_folder) {
    char reason[REASON_SIZE];
    struct trajectories *all = trajectories_create();
    cr_assert(all);
    const char *path = file_write(folder, "states.tsv", family);
    const struct trajectory *first = trajectories_take(all, path, reason),
                            *second =
                                trajectories_take(all, printed("%s/./states.tsv", folder), reason);
    cr_assert(first && first == second && trajectories_parsed(all) == 1);
    trajectories_return(all, first);
    trajectories_return(all, second);
    second = trajectories_take(all, path, reason);
    cr_assert(second == first && trajectories_parsed(all) == 1, "returned and read again");
    path = file_write(folder, "states.tsv", orphans);
    first = trajectories_take(all, path, reason);
    cr_assert(first && first != second && trajectories_parsed(all) == 2);
    cr_assert(first->wisp_count == 2 && second->wisp_count == 3, "the old file for the new one");
    trajectories_return(all, first);
    trajectories_return(all, second);
    unlink(path);
    cr_assert(!trajectories_take(all, path, reason) && strstr(reason, "states.tsv"), "%s", reason);
    trajectories_free(all);
    path = file_write(folder, "states.tsv", family);
    first = trajectories_take(NULL, path, reason);
    second = trajectories_take(NULL, path, reason);
    cr_assert(first && second && first != second, "nobody shares without an owner");
    trajectories_return(NULL, first);
    trajectories_return(NULL, second);
}

/* --- a command --- */

/* How often the files of that name were opened in the folders that are watched, all together and
 * the one that was most often. */
struct openings {
    int watch, files, all, most;
    int count[512]; /* by watch descriptor */
};

static void watch_folder(const char *path, void *ctx) {
    struct openings *openings = ctx;
    const char *slash = strrchr(path, '/');
    if (strcmp(slash, "/states.tsv") != 0)
        return;
    const char *const watched = printed("%.*s", (int)(slash - path), path);
    const int descriptor = inotify_add_watch(openings->watch, watched, IN_OPEN | IN_CLOSE);
    cr_assert(descriptor > 0 && descriptor < 512, "no watch of %s", watched);
    openings->files++;
}

static void count_openings(struct openings *openings) {
    static char events[1 << 20] __attribute__((aligned(__alignof__(struct inotify_event))));
    for (ssize_t size; (size = read(openings->watch, events, sizeof events)) > 0;)
        for (char *at = events; at < events + size;) {
            const struct inotify_event *event = (const struct inotify_event *)at;
            at += sizeof *event + event->len;
            cr_assert(!(event->mask & IN_Q_OVERFLOW), "too many events");
            if (!(event->mask & IN_OPEN) || strcmp(event->name, "states.tsv") != 0)
                continue;
            openings->all++;
            if (++openings->count[event->wd] > openings->most)
                openings->most = openings->count[event->wd];
        }
}

static void begin_watch(struct openings *openings) {
    *openings = (struct openings){.watch = inotify_init1(IN_NONBLOCK)};
    cr_assert(openings->watch >= 0, "files cannot be watched");
    each_file(folder, watch_folder, openings);
}

static void end_watch(struct openings *openings) {
    count_openings(openings);
    close(openings->watch);
}

/* Seen from outside: experiments whose runs are there already look once whether each file is as it
 * was written, read it once, and that is all they do. */
Test(trajectory, a_command_reads_each_file_at_most_once, .init = open_folder) {
    static const char *const experiments[] = {"subdivision", "treatments"};
    gnuplot_stub_quiet();
    for (int i = 0; i < 2; i++) {
        struct openings openings;
        WORKS("experiment", experiments[i], "--quick", "--out", folder);
        begin_watch(&openings);
        struct finished *f =
            PROGRAM(NULL, "experiment", experiments[i], "--quick", "--out", folder);
        end_watch(&openings);
        cr_expect_eq(f->code, 0, "%s", f->err);
        cr_expect(openings.files >= 8 && openings.all >= 8, "%s: %d of %d files", experiments[i],
                  openings.all, openings.files);
        cr_expect_eq(openings.most, 2, "%s: one is opened %d times", experiments[i], openings.most);
    }
}

Test(trajectory, render_opens_each_file_once, .init = open_folder) {
    struct openings openings;
    const char *const out = printed("%s/pictures", folder);
    const char *const other = printed("%s/other", folder);
    PROGRAM(NULL, "run", "swing", "--duration", "0.1", "--out", folder);
    PROGRAM(NULL, "run", "swing", "--duration", "0.1", "--rate", "5000", "--out", other);
    begin_watch(&openings);
    struct finished *f = PROGRAM(NULL, "render", folder, other, folder, "--skeleton", "--error",
                                 other, "--frames", "1", "--out", out);
    end_watch(&openings);
    cr_assert_eq(f->code, 0, "%s", f->err);
    cr_assert(openings.files == 2 && openings.all == 2 && openings.most == 1, "%d openings",
              openings.all);
}
