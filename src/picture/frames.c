#include "frames.h"

#include "base/files.h"
#include "base/memory.h"
#include "base/vector.h"
#include "model/model.h"
#include "run/results.h"
#include "scene/scene_load.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* "file: what is wrong". Returns 1. */
__attribute__((format(printf, 3, 4))) static int refuse(const char *file, char *reason,
                                                        const char *format, ...) {
    va_list arguments;
    const int used = snprintf(reason, REASON_SIZE, "%.120s: ", file);
    va_start(arguments, format);
    vsnprintf(reason + used, (size_t)(REASON_SIZE - used), format, arguments);
    va_end(arguments);
    return 1;
}

static double number(const struct frames *f, int row, int column) {
    return trajectory_row(f->states, row)[column];
}

/* --- the columns --- */

static void column_name(int column, int penalty, char *name, size_t size) {
    static const char *const fixed[STATE_SAMPLES] = {"t", "wisp", "node", "x", "y",
                                                     "z", "vx",   "vy",   "vz"};
    static const char *const distance[] = {"r", "rd"};
    static const char *const particle[] = {"x", "y", "z", "vx", "vy", "vz"};
    const int k = column - STATE_SAMPLES;
    if (k < 0)
        snprintf(name, size, "%s", fixed[column]);
    else if (penalty)
        snprintf(name, size, "e%d%s", k / 6, particle[k % 6]);
    else
        snprintf(name, size, "%s%d", distance[k % 2], k / 2);
}

static int check_columns(struct frames *f, const char *states, char *reason) {
    const int samples = f->scene->wisps[0].samples;
    const int penalty = table_column(&f->states->table, "e0x") >= 0;
    const int expected = STATE_SAMPLES + samples * (penalty ? 6 : 2),
              count = f->states->table.column_count;
    f->treatment = penalty ? WISP_PENALTY : WISP_GENERALISED; /* projection's columns are these */
    for (int i = 0; i < expected && i < count; i++) {
        char name[32];
        column_name(i, penalty, name, sizeof name);
        if (strcmp(name, f->states->table.name[i]) == 0)
            continue;
        return refuse(states, reason, "column %d is '%.20s'; in states of this scene it is %s",
                      i + 1, f->states->table.name[i], name);
    }
    if (count == expected)
        return 0;
    return refuse(states, reason,
                  "has %d columns besides parent; states of wisps with %d samples have %d", count,
                  samples, expected);
}

/* --- the rows --- */

/* How many rows from this one on are nodes 0, 1, 2, ... of a wisp at a time, up to `most`. */
static int count_nodes(const struct frames *f, int row, double t, int wisp, int most) {
    int n = 0;
    while (n < most && row + n < f->states->table.row_count && number(f, row + n, STATE_T) == t &&
           number(f, row + n, STATE_WISP) == wisp && number(f, row + n, STATE_NODE) == n)
        n++;
    return n;
}

/* How far rows go on as a frame: whole wisps, and nodes of one that is not whole. */
struct reach {
    int end; /* the first row that does not belong to it */
    int wisps, rest;
};

/* What a wisp that no frame before had has here is what it has. */
static struct reach find_reach(const struct frames *f, int row, int *nodes) {
    struct reach reach = {.end = row};
    const double t = number(f, row, STATE_T);
    for (; reach.wisps < f->wisp_count; reach.wisps++) {
        const int known = nodes[reach.wisps];
        const int n = count_nodes(f, reach.end, t, reach.wisps, known ? known : INT_MAX);
        reach.end += n;
        if (!known && n >= 3)
            nodes[reach.wisps] = n;
        if (n == 0 || n != nodes[reach.wisps]) {
            reach.rest = n;
            break;
        }
    }
    return reach;
}

/* A frame that begins at `row`. Returns 0, 1 with a reason, or -1 where the table ends within it.
 */
static int take_frame(struct frames *f, int row, int *nodes, const char *states, char *reason) {
    const struct reach reach = find_reach(f, row, nodes);
    const int due = f->count ? frames_wisps(f, f->count) : f->scene->wisp_count;
    const int end = reach.end, more = end < f->states->table.row_count;
    const double t = number(f, row, STATE_T);
    if (!more && (reach.wisps < due || reach.rest > 0)) {
        refuse(states, reason,
               "frame %d, the last, is not complete: it ends before wisp %d, node %d", f->count + 1,
               reach.wisps, reach.rest);
        return -1;
    }
    if (more && (reach.wisps < due || reach.rest > 0 || number(f, end, STATE_T) == t))
        return refuse(states, reason,
                      "frame %d: row %d is wisp %g, node %g at %g s, where wisp %d, node %d at "
                      "%g s should be",
                      f->count + 1, end + 1, number(f, end, STATE_WISP), number(f, end, STATE_NODE),
                      number(f, end, STATE_T), reach.wisps, reach.rest, t);
    if (f->count && !(t > frames_time(f, f->count)))
        return refuse(states, reason, "frame %d: its time %g s does not come after %g s",
                      f->count + 1, t, frames_time(f, f->count));
    f->first_row[++f->count] = end;
    return 0;
}

static int check_numbers(const struct frames *f, const char *states, char *reason) {
    const int columns = f->states->table.column_count;
    for (int row = 0; row < f->states->table.row_count; row++)
        for (int k = 0; k < columns; k++) {
            if (isfinite(number(f, row, k)))
                continue;
            return refuse(states, reason,
                          "row %d (t = %g s, wisp %g, node %g): %s is not a finite number", row + 1,
                          number(f, row, STATE_T), number(f, row, STATE_WISP),
                          number(f, row, STATE_NODE), f->states->table.name[k]);
        }
    return 0;
}

/* Frame by frame; wisps that frames have more of than the scene come of subdivisions. */
static int take_frames(struct frames *f, int failed, const char *states, char *reason) {
    const int known = f->scene->wisp_count, rows = f->states->table.row_count;
    f->wisp_count = known;
    for (int row = 0; row < rows; row++)
        if (number(f, row, STATE_WISP) >= f->wisp_count && number(f, row, STATE_WISP) < rows)
            f->wisp_count = (int)number(f, row, STATE_WISP) + 1;
    int *nodes = memory_needed(calloc((size_t)f->wisp_count, sizeof *nodes));
    f->first_row = memory_needed(calloc((size_t)rows + 2, sizeof *f->first_row));
    f->offset = memory_needed(calloc((size_t)f->wisp_count + 1, sizeof *f->offset));
    for (int i = 0; i < known; i++)
        nodes[i] = f->scene->wisps[i].nodes;
    int code = 0;
    while (!code && f->first_row[f->count] < rows)
        code = take_frame(f, f->first_row[f->count], nodes, states, reason);
    for (int i = 0; i < f->wisp_count; i++)
        f->offset[i + 1] = f->offset[i] + nodes[i];
    free(nodes);
    if (code < 0)
        code = failed && f->count > 0 ? 0 : 1;
    if (!code && f->count == 0)
        code = refuse(states, reason, "has no frames");
    if (!code)
        f->wisp_count = frames_wisps(f, f->count);
    return code;
}

/* --- who came of whom --- */

static const double *position(const struct frames *f, int frame, int wisp, int node) {
    return trajectory_row(f->states, f->first_row[frame - 1] + f->offset[wisp] + node) + STATE_X;
}

static int node_count(const struct frames *f, int wisp) {
    return f->offset[wisp + 1] - f->offset[wisp];
}

/* The scene's wisps split off from none, and all others did. */
static int check_parent(const struct frames *f, int wisp, const char *states, char *reason) {
    const int parent = f->parent[wisp];
    if (wisp < f->scene->wisp_count && parent != wisp)
        return refuse(states, reason, "wisp %d is one of the scene's, and has a parent: wisp %d",
                      wisp, parent);
    if (wisp < f->scene->wisp_count ||
        (parent != wisp && node_count(f, parent) == node_count(f, wisp)))
        return 0;
    return refuse(states, reason,
                  "frame %d: wisp %d is none of the scene's, and has no parent with as many nodes, "
                  "of which it could have split",
                  f->born[wisp], wisp);
}

static int find_parents(struct frames *f, const char *states, char *reason) {
    const size_t count = (size_t)f->wisp_count;
    f->wisps = memory_needed(calloc(count, sizeof *f->wisps));
    f->born = memory_needed(calloc(count, sizeof *f->born));
    f->parent = f->states->parent;
    int frame = 1, code = 0;
    for (int i = 0; i < f->wisp_count && !code; i++) {
        while (frames_wisps(f, frame) <= i)
            frame++;
        f->born[i] = frame;
        code = check_parent(f, i, states, reason);
        if (!code)
            f->wisps[i] = i < f->scene->wisp_count ? f->scene->wisps[i] : f->wisps[f->parent[i]];
    }
    return code;
}

/* --- opening --- */

static const char *text_of(const json_t *json, const char *group, const char *name) {
    const char *text = json_string_value(json_object_get(json_object_get(json, group), name));
    return text ? text : "?";
}

/* run.json beside the states. */
static json_t *read_run(const char *states, char *path, char *reason) {
    const char *slash = strrchr(states, '/');
    json_error_t error;
    if (path_format(path, "%.*srun.json", slash ? (int)(slash - states + 1) : 0, states) ||
        !file_exists(path)) {
        refuse(states, reason,
               "has no run.json beside it, which says of what scene these states are");
        return NULL;
    }
    json_t *json = json_of_file(path, &error);
    if (!json)
        refuse(path, reason, "line %d: %s", error.line, error.text);
    return json;
}

/* There is no such file: of a run that was to leave none, that is said. */
static void refuse_missing(const char *states, char *path, char *reason) {
    json_t *run = read_run(states, path, reason);
    refuse(states, reason, "%s",
           run && run_left_no_states(run) ? LEFT_NO_STATES : "no such file, or it cannot be read");
    json_decref(run);
}

/* A scene is named after its file, but this one's is not known. */
static void name_after_folder(const char *path, struct scene *scene) {
    const char *end = strrchr(path, '/'), *start = end;
    while (start && start > path && start[-1] != '/')
        start--;
    if (start && end > start)
        snprintf(scene->name, sizeof scene->name, "%.*s", (int)(end - start), start);
}

static int open_scene(struct frames *f, const json_t *run, const char *path,
                      const char *const *sets, int set_count, char *reason) {
    const json_t *source = json_object_get(run, "scene");
    if (!json_is_object(source))
        return refuse(path, reason, "has no scene; it is not the run.json of a run");
    f->scene = scene_from_json(source, path, sets, set_count, reason);
    if (!f->scene)
        return errno == ENOMEM ? 2 : 1;
    if (!json_object_get(source, "name"))
        name_after_folder(path, f->scene);
    if (f->scene->wisp_count > 0)
        return 0;
    return refuse(path, reason, "the scene %s has no wisps, and so no hair", f->scene->name);
}

int frames_path(const char *word, char *states) {
    const char *dot = strrchr(word, '.');
    struct stat status;
    if (dot && (strcmp(dot, ".tsv") == 0 || strcmp(dot, ".npy") == 0))
        return path_format(states, "%s", word) == 0;
    return stat(word, &status) == 0 && S_ISDIR(status.st_mode) &&
           trajectory_path(word, states) == 0;
}

int frames_open(struct frames *f, const char *states, struct trajectories *owner,
                const char *const *sets, int set_count, char *reason) {
    char path[PATH_SIZE];
    *f = (struct frames){.owner = owner};
    json_t *run = NULL;
    if (file_exists(states))
        run = read_run(states, path, reason);
    else
        refuse_missing(states, path, reason);
    if (!run)
        return 1;
    const char *status = json_string_value(json_object_get(run, "status"));
    const int failed = !status || outcome_from_name(status) != FINISHED;
    snprintf(f->run, sizeof f->run, failed ? "%.28s %.28s (%.16s)" : "%.28s %.28s",
             text_of(run, "settings", "stepper"), text_of(run, "settings", "treatment"),
             status ? status : "failed");
    const int code = open_scene(f, run, path, sets, set_count, reason);
    json_decref(run);
    if (code)
        return code;
    f->states = trajectories_take(owner, states, reason);
    return !f->states || check_columns(f, states, reason) || check_numbers(f, states, reason) ||
           take_frames(f, failed, states, reason) || find_parents(f, states, reason);
}

void frames_close(struct frames *f) {
    if (f->states)
        trajectories_return(f->owner, f->states);
    scene_free(f->scene);
    free(f->wisps);
    free(f->born);
    free(f->first_row);
    free(f->offset);
    *f = (struct frames){0};
}

/* --- what is in them --- */

double frames_time(const struct frames *f, int frame) {
    return number(f, f->first_row[frame - 1], STATE_T);
}

int frames_wisps(const struct frames *f, int frame) {
    return (int)number(f, f->first_row[frame] - 1, STATE_WISP) + 1;
}

void frames_load(const struct frames *f, int frame, int wisp, struct strand *strand) {
    struct placement head;
    head_placement(&f->scene->around.head, frames_time(f, frame), &head);
    strand_turn(strand, &head);
    strand_load(strand, position(f, frame, wisp, 0), f->states->table.column_count);
}

struct strand **frames_strands(const struct frames *f) {
    struct strand **strands = memory_needed(calloc((size_t)f->wisp_count, sizeof *strands));
    for (int i = 0; i < f->wisp_count; i++)
        strands[i] = memory_needed(strand_create(&f->wisps[i], f->treatment));
    return strands;
}

void frames_strands_free(const struct frames *f, struct strand **strands) {
    for (int i = 0; i < f->wisp_count; i++)
        strand_free(strands[i]);
    free(strands);
}

int frames_ancestor(const struct frames *f, int wisp) {
    while (f->parent[wisp] != wisp)
        wisp = f->parent[wisp];
    return wisp;
}

static int came_of(const struct frames *f, int wisp, int parent) {
    return wisp != parent && f->parent[wisp] == parent;
}

/* What its parent had left when it was born, halved; and then what its own children took. */
struct hair_share frames_share(const struct frames *f, int frame, int wisp) {
    struct hair_share share = {0, 0}, second;
    const int parent = f->parent[wisp];
    if (parent != wisp) {
        share = frames_share(f, 0, parent); /* as its parent was born */
        for (int i = 0; i < wisp; i++)
            if (came_of(f, i, parent))
                hair_share_split(&share, &second);
        hair_share_split(&share, &second);
        share = second;
    }
    for (int i = 0; i < f->wisp_count; i++)
        if (came_of(f, i, wisp) && f->born[i] <= frame)
            hair_share_split(&share, &second);
    return share;
}

/* At most a tenth further from the root than the wisp is long. */
static void within_reach(const double root[3], double length, const double node[3],
                         double place[3]) {
    double from[3] = {node[0], node[1], node[2]};
    vector_add(from, -1, root);
    memcpy(place, root, 3 * sizeof *place);
    vector_add(place, fmin(1, 1.1 * length / fmax(vector_length(from), 1e-300)), from);
}

void frames_extent(const struct frames *f, const double directions[4][3], double most[4]) {
    for (int frame = 1; frame <= f->count; frame++)
        for (int wisp = 0; wisp < frames_wisps(f, frame); wisp++) {
            const struct wisp *numbers = &f->wisps[wisp];
            const double radius = numbers->samples > 0 ? numbers->radius : 0;
            for (int i = 0; i < numbers->nodes; i++) {
                double place[3];
                within_reach(position(f, frame, wisp, 0), numbers->length,
                             position(f, frame, wisp, i), place);
                for (int d = 0; d < 4; d++)
                    most[d] = fmax(most[d], vector_dot(place, directions[d]) +
                                                radius * vector_length(directions[d]));
            }
        }
}
