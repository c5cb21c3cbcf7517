#include "trajectory.h"

#include "base/files.h"
#include "base/npy.h"

#include <errno.h>
#include <malloc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int out_of_memory(char *reason) {
    errno = ENOMEM;
    return fail_with(reason, "out of memory");
}

const double *trajectory_row(const struct trajectory *t, int row) {
    return t->table.value + (size_t)row * (size_t)t->table.column_count;
}

int trajectory_end(const struct trajectory *t, int frame) {
    return frame + 1 < t->frame_count ? t->frames[frame + 1].row : t->table.row_count;
}

int trajectory_wisp(const struct trajectory *t, int frame, int wisp) {
    return t->wisp_row[t->frames[frame].first_wisp + wisp];
}

int trajectory_nodes(const struct trajectory *t, int frame, int wisp) {
    const int *row = t->wisp_row + t->frames[frame].first_wisp + wisp;
    return row[1] - row[0];
}

/* --- frames and wisps --- */

static int begins_frame(const struct trajectory *t, int row) {
    return row == 0 || trajectory_row(t, row)[STATE_T] != trajectory_row(t, row - 1)[STATE_T];
}

static int begins_wisp(const struct trajectory *t, int row) {
    return begins_frame(t, row) ||
           trajectory_row(t, row)[STATE_WISP] != trajectory_row(t, row - 1)[STATE_WISP];
}

/* Marks where frames and wisps begin. Returns 0, or -1 where memory cannot be had. */
static int find_frames(struct trajectory *t) {
    const int rows = t->table.row_count;
    size_t frames = 0, wisps = 0;
    for (int row = 0; row < rows; row++) {
        frames += (size_t)begins_frame(t, row);
        wisps += (size_t)begins_wisp(t, row);
    }
    t->frames = calloc(frames + 1, sizeof *t->frames);
    t->wisp_row = calloc(wisps + 1, sizeof *t->wisp_row);
    if (!t->frames || !t->wisp_row)
        return -1;
    int wisp = 0;
    for (int row = 0; row < rows; row++) {
        if (begins_frame(t, row))
            t->frames[t->frame_count++] = (struct trajectory_frame){
                .t = trajectory_row(t, row)[STATE_T], .row = row, .first_wisp = wisp};
        if (!begins_wisp(t, row))
            continue;
        struct trajectory_frame *frame = &t->frames[t->frame_count - 1];
        t->wisp_row[wisp++] = row;
        if (++frame->wisps > t->wisp_count)
            t->wisp_count = frame->wisps;
    }
    t->wisp_row[wisp] = rows;
    return 0;
}

/* --- the column `parent` --- */

/* Takes the last column off the table, into an array of its own: it is none of the state. NULL
 * where memory cannot be had. */
static double *take_last_column(struct table *table) {
    const size_t rows = (size_t)table->row_count, columns = (size_t)table->column_count;
    double *taken = malloc((rows + 1) * sizeof *taken);
    if (!taken)
        return NULL;
    for (size_t row = 0; row < rows; row++) {
        taken[row] = table->value[row * columns + columns - 1];
        memmove(table->value + row * (columns - 1), table->value + row * columns,
                (columns - 1) * sizeof *table->value);
    }
    free(table->name[--table->column_count]);
    return taken;
}

/* Notes whom a row's wisp split off from: the same in all of its rows, itself or one before it.
 * Rows that are not where their wisp should be are somebody else's to refuse. Returns whether it is
 * right. */
static int note_parent(struct trajectory *t, int wisp, int row, double parent) {
    int *known = &t->parent[wisp];
    if (trajectory_row(t, row)[STATE_WISP] != wisp)
        return 1;
    if (*known < 0 && parent >= 0 && parent <= wisp && parent == floor(parent))
        *known = (int)parent;
    return *known >= 0 && parent == *known;
}

static int take_parents(struct trajectory *t, const double *column, const char *file,
                        char *reason) {
    for (int frame = 0; frame < t->frame_count; frame++)
        for (int wisp = 0; wisp < t->frames[frame].wisps; wisp++) {
            const int first = trajectory_wisp(t, frame, wisp);
            for (int row = first; row < first + trajectory_nodes(t, frame, wisp); row++) {
                if (note_parent(t, wisp, row, column[row]))
                    continue;
                return fail_with(reason, "%.150s: row %d: the parent of wisp %d is not %g", file,
                                 row + 1, wisp, column[row]);
            }
        }
    return 0;
}

static int find_parents(struct trajectory *t, const double *column, const char *file,
                        char *reason) {
    t->parent = calloc((size_t)t->wisp_count + 1, sizeof *t->parent);
    if (!t->parent)
        return out_of_memory(reason);
    for (int wisp = 0; wisp < t->wisp_count; wisp++)
        t->parent[wisp] = -1;
    const int code = column ? take_parents(t, column, file, reason) : 0;
    for (int wisp = 0; wisp < t->wisp_count; wisp++)
        if (t->parent[wisp] < 0)
            t->parent[wisp] = wisp;
    return code;
}

/* --- reading --- */

static int begins_as_states(const struct table *table) {
    static const char *const first[] = {"t", "wisp", "node"};
    for (int i = 0; i < 3; i++)
        if (i >= table->column_count || strcmp(table->name[i], first[i]) != 0)
            return 0;
    return 1;
}

int trajectory_of_table(struct trajectory *t, struct table *table, const char *file, char *reason) {
    double *column = NULL;
    int code = 0;
    *t = (struct trajectory){.table = *table};
    *table = (struct table){0};
    if (!begins_as_states(&t->table)) {
        snprintf(reason, REASON_SIZE, "%.150s: has not the columns of states: t, wisp, node, ...",
                 file);
        code = -1;
    }
    if (!code && table_column(&t->table, "parent") == t->table.column_count - 1) {
        column = take_last_column(&t->table);
        code = column ? 0 : out_of_memory(reason);
    }
    if (!code && find_frames(t))
        code = out_of_memory(reason);
    if (!code)
        code = find_parents(t, column, file, reason);
    free(column);
    if (code)
        trajectory_free(t);
    return code;
}

int trajectory_path(const char *folder, char *path) {
    if (path_format(path, "%s/states.npy", folder) == 0 && file_exists(path))
        return 0;
    return path_format(path, "%s/states.tsv", folder);
}

int trajectory_is_begun(const char *path) {
    static const char names[] = "t\twisp\tnode\t";
    FILE *file = open_regular(path);
    if (file && npy_is_begun(file)) { /* of which messages show nothing */
        fclose(file);
        return 1;
    }
    char *line = NULL;
    size_t size = 0;
    ssize_t length = 0;
    while (file && (length = getline(&line, &size, file)) > 0 && line[0] == '#')
        ;
    const int begins = !file || (length > 0 && strncmp(line, names, sizeof names - 1) == 0);
    free(line);
    if (file)
        fclose(file);
    return begins;
}

int trajectory_read(struct trajectory *t, const char *path, char *reason) {
    struct table table;
    return table_read(&table, path, reason) ? -1 : trajectory_of_table(t, &table, path, reason);
}

void trajectory_free(struct trajectory *t) {
    table_free(&t->table);
    free(t->frames);
    free(t->wisp_row);
    free(t->parent);
    *t = (struct trajectory){0};
}

/* --- each file once --- */

/* Bytes that nobody uses, and files. What is kept every run pays for that is started later: to fork
 * costs 3 ms for each 200 MB. */
static const size_t idle_most = (size_t)256 << 20;
static const int idle_files_most = 500;

/* A file that was read. What identifies it: a file that is replaced has another inode, one that is
 * written to another time. */
struct entry {
    struct trajectory trajectory; /* first: what is handed out is an entry, too */
    struct stat file;
    int users;
    struct entry *next; /* read or used before this one */
};

struct trajectories {
    struct entry *latest;
    int parsed;
};

struct trajectories *trajectories_create(void) {
    return calloc(1, sizeof(struct trajectories));
}

static void free_entry(struct entry *entry) {
    trajectory_free(&entry->trajectory);
    free(entry);
}

void trajectories_free(struct trajectories *all) {
    while (all && all->latest) {
        struct entry *next = all->latest->next;
        free_entry(all->latest);
        all->latest = next;
    }
    free(all);
    malloc_trim(0); /* to the system: see idle_most */
}

static int same_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
           a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

/* Takes the entry of a file out of the list. NULL: it has none. */
static struct entry *unlink_entry(struct trajectories *all, const struct stat *file) {
    for (struct entry **at = &all->latest; *at; at = &(*at)->next)
        if (same_file(&(*at)->file, file)) {
            struct entry *entry = *at;
            *at = entry->next;
            return entry;
        }
    return NULL;
}

static struct entry *read_entry(const char *path, char *reason) {
    struct entry *entry = calloc(1, sizeof *entry);
    if (!entry) {
        out_of_memory(reason);
        return NULL;
    }
    if (trajectory_read(&entry->trajectory, path, reason) == 0)
        return entry;
    free(entry);
    return NULL;
}

/* Forgets those that were not used for longest, as far as they are too much. */
static void forget(struct trajectories *all) {
    size_t idle = 0;
    int files = 0;
    for (struct entry **at = &all->latest; *at;) {
        struct entry *entry = *at;
        const struct table *table = &entry->trajectory.table;
        if (entry->users == 0) {
            idle += (size_t)table->row_count * (size_t)table->column_count * sizeof(double);
            files++;
        }
        if (entry->users == 0 && (idle > idle_most || files > idle_files_most)) {
            *at = entry->next;
            free_entry(entry);
        } else {
            at = &entry->next;
        }
    }
}

const struct trajectory *trajectories_take(struct trajectories *all, const char *path,
                                           char *reason) {
    struct stat file = {0};
    const int there = all && stat(path, &file) == 0;
    struct entry *entry = there ? unlink_entry(all, &file) : NULL;
    if (!entry) {
        entry = read_entry(path, reason);
        if (entry && all)
            all->parsed++;
    }
    if (!entry)
        return NULL;
    entry->users++;
    if (all) {
        entry->file = file;
        entry->next = all->latest;
        all->latest = entry;
    }
    return &entry->trajectory;
}

void trajectories_return(struct trajectories *all, const struct trajectory *trajectory) {
    struct entry *entry = (struct entry *)trajectory;
    entry->users--;
    if (all)
        forget(all);
    else
        free_entry(entry);
}

int trajectories_parsed(const struct trajectories *all) {
    return all->parsed;
}
