/* wisplab render: pictures of hair, strips of them, films. */
#include "base/complain.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/workers.h"
#include "cli.h"
#include "picture/film.h"
#include "picture/layout.h"
#include "picture/strip.h"
#include "run/runs.h"
#include "scene/scene_load.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct cli_option options[] = {
    {"frames", "LIST", "1,6,10 or 1-31 or both, or all (default: 6 from first to last)", 0},
    {"size", "WxH", "of a picture, or of each in a strip, pixels (1280x960; strip 320x240)", 0},
    {"hair", NULL, "show the hair (default)", 0},
    {"skeleton", NULL, "show nodes, samples on their half-lines, and frames", 0},
    {"envelope", NULL, "show the outline of the sections", 0},
    {"style", NULL, "show the style field as arrows", 0},
    {"bodies", NULL, "show bodies alone", 0},
    {"section", "[WISP:]NODE", "show the plane of a node alone: samples, rim, where hairs are", 0},
    {"strip", NULL, "all pictures on one page: a row for each run, a column for each frame", 0},
    {"columns", "N", "pictures side by side in a strip (default: all of a run, with --large fewer)",
     0},
    {"beside", NULL, "runs beside each other in a strip, frames below each other", 0},
    {"large", "FRAME", "in a strip: another frame of the first run, shown large", 0},
    {"error", "STATES", "colour is the distance from these states at the same frame", 0},
    {"film", NULL, "also a film of the pictures: GIF, and MP4 where ffmpeg is installed", 0},
    {"rate", "R", "pictures a second in the film (default 30)", 0},
    {"format", "F", "png or svg (default png)", 0},
    {"set", "PATH=VALUE", "override a setting of the scene: --set 'render={hairs=20;}'",
     CLI_REPEATS},
    {"threads", "N", "pictures at a time (default: processors)", 0},
    {"out", "DIR", "folder for the pictures (default results/render)", 0},
    {"no-progress", NULL, "show no progress line", 0},
    {0},
};

enum { RUNS_MAX = 8 };

/* What was asked for. */
struct task {
    const struct arguments *arguments;
    struct strip_request request;
    struct strip_row rows[RUNS_MAX];
    struct scene *scenes[RUNS_MAX]; /* of words that are scenes */
    char states[RUNS_MAX][PATH_SIZE], reference[PATH_SIZE];
    const char *out, *format;
    double rate;
    int threads, as_strip, film;

    struct trajectories *trajectories;
    struct strip *strip;
    int *frames, count;
    char name[80];          /* of the scene, for file names */
    pthread_mutex_t shared; /* by the threads that write pictures: what follows */
    struct progress progress;
    int done, code;
    char reason[REASON_SIZE];
};

/* --- the command line --- */

static int read_size(struct task *task) {
    const char *text = argument_text(task->arguments, "size");
    int length = 0;
    int width = task->as_strip ? 320 : 1280, height = task->as_strip ? 240 : 960;
    if (text && (sscanf(text, "%5dx%5d%n", &width, &height, &length) != 2 || text[length] ||
                 width < 64 || height < 64 || width > 8192 || height > 8192))
        return complain(-1, "--size %s: must be two whole numbers from 64 to 8192, as 1280x960",
                        text);
    task->request.width = width;
    task->request.height = height - (task->as_strip ? 0 : LAYOUT_TITLE);
    return 0;
}

/* A GIF counts in hundredths of a second. */
static int read_rate(struct task *task) {
    if (argument_positive(task->arguments, "rate", 30, &task->rate))
        return -1;
    if (task->rate < 0.01 || task->rate > 1000)
        return complain(-1, "--rate %g: must be from 0.01 to 1000", task->rate);
    return 0;
}

static unsigned read_views(const struct arguments *arguments) {
    const unsigned views = (argument_given(arguments, "hair") ? VIEW_HAIR : 0u) |
                           (argument_given(arguments, "skeleton") ? VIEW_SKELETON : 0u) |
                           (argument_given(arguments, "envelope") ? VIEW_ENVELOPE : 0u);
    const unsigned style = argument_given(arguments, "style") ? VIEW_STYLE : 0u;
    if (argument_given(arguments, "bodies"))
        return views | style;
    return (views ? views : VIEW_HAIR) | style;
}

/* A picture of its own: what belongs to others is refused. */
static int read_section(struct task *task) {
    static const char *const others[] = {"hair",   "skeleton", "envelope", "style",
                                         "bodies", "error",    NULL};
    const char *text = argument_text(task->arguments, "section");
    struct plane_view *plane = &task->request.plane;
    int length = 0;
    if (!text)
        return 0;
    for (int i = 0; others[i]; i++)
        if (argument_given(task->arguments, others[i]))
            return complain(-1, "--section: is a picture of its own; leave out --%s", others[i]);
    if ((sscanf(text, "%7d%n", &plane->node, &length) != 1 || text[length]) &&
        (sscanf(text, "%7d:%7d%n", &plane->wisp, &plane->node, &length) != 2 || text[length]))
        return complain(
            -1, "--section %s: must be the number of a node, or of wisp and node, as 3:8", text);
    if (plane->wisp < 0)
        return complain(-1, "--section %s: there is no wisp %d", text, plane->wisp);
    task->request.views = VIEW_PLANE;
    return 0;
}

static int read_task(struct task *task) {
    const struct arguments *arguments = task->arguments;
    task->as_strip = arguments->word_count > 1 || argument_given(arguments, "strip") ||
                     argument_given(arguments, "columns") || argument_given(arguments, "large");
    task->film = argument_given(arguments, "film");
    task->out = argument_or(arguments, "out", "results/render");
    task->format = argument_or(arguments, "format", "png");
    task->request.views = read_views(arguments);
    task->request.beside = argument_given(arguments, "beside");
    task->request.sets = argument_list(arguments, "set", &task->request.set_count);
    if (strcmp(task->format, "png") != 0 && strcmp(task->format, "svg") != 0)
        return complain(-1, "--format %s: is not one of png, svg", task->format);
    if (task->film && task->as_strip)
        return complain(-1, "--film: is of single pictures of one run; leave out the strip");
    if (task->film && strcmp(task->format, "png") != 0)
        return complain(-1, "--film: is made of png; leave out --format");
    return read_section(task) || read_size(task) || read_rate(task) ||
                   argument_whole(arguments, "columns", 0, 400, &task->request.columns) ||
                   argument_whole(arguments, "large", 0, INT_MAX, &task->request.large) ||
                   argument_whole(arguments, "threads", (int)sysconf(_SC_NPROCESSORS_ONLN), 1024,
                                  &task->threads)
               ? -1
               : 0;
}

/* --- runs --- */

/* A scene is run with its defaults, or was: runs are kept by what they are of. Returns the exit
 * code. */
static int run_scene(struct task *task, int i) {
    const struct run_limits limits = {.seconds = 0};
    const struct run_request request = {.threads = task->threads};
    struct run_case run = {.sink = NULL};
    char reason[REASON_SIZE];
    struct scene *scene =
        scene_load(task->arguments->words[i], task->request.sets, task->request.set_count, reason);
    task->scenes[i] = scene;
    if (!scene)
        return complain(errno == ENOMEM ? 2 : 1, "%s", reason);
    if (scene->wisp_count == 0)
        return complain(1, "%s: has no wisps, and so no hair", scene->name);
    run.scene = scene;
    const int refused = settings_resolve(scene, &request, &run.settings, reason);
    if (refused)
        return complain(outcome_exit_code((enum outcome)refused), "%s", reason);
    run_folder("results", scene, &run.settings, run.folder);
    const int ran =
        runs_do_all(&run, 1, &limits, 1, !argument_given(task->arguments, "no-progress"), reason);
    if (ran < 0)
        return complain(outcome_exit_code((enum outcome) - ran), "%s", reason);
    say("%s with %s: %s %s", scene->name, run.settings.method->name,
        ran ? "run, in" : "has been run, in", run.folder);
    path_format(task->states[i], "%s/states.tsv", run.folder);
    return 0;
}

/* Returns the exit code. */
static int find_runs(struct task *task) {
    const struct arguments *arguments = task->arguments;
    const char *reference = argument_text(arguments, "error");
    for (int i = 0; i < arguments->word_count; i++) {
        const char *word = arguments->words[i];
        if (!frames_path(word, task->states[i])) {
            const int code = run_scene(task, i);
            if (code)
                return code;
        }
        task->rows[i] = (struct strip_row){.states = task->states[i], .scene = task->scenes[i]};
    }
    task->request.trajectories = task->trajectories;
    task->request.rows = task->rows;
    task->request.row_count = arguments->word_count;
    if (reference && !frames_path(reference, task->reference))
        return complain(1, "--error %s: is neither a file of states nor the folder of a run",
                        reference);
    task->request.reference = reference ? task->reference : NULL;
    return 0;
}

/* --- frames --- */

/* One number or a-b at *text, which goes behind it. Returns 0, or -1. */
static int read_range(const char **text, int last, int range[2]) {
    for (int i = 0; i < 2; i++) {
        char *end;
        if (!isdigit((unsigned char)**text))
            return -1;
        const long number = strtol(*text, &end, 10);
        if (number < 1 || number > last)
            return complain(-2, "--frames: there is no frame %ld; there are frames 1 to %d", number,
                            last);
        range[i] = (int)number;
        *text = end;
        if (i == 0 && **text != '-') {
            range[1] = range[0];
            break;
        }
        *text += i == 0;
    }
    if (**text == ',' && (*text)[1] != '\0')
        ++*text;
    else if (**text != '\0')
        return -1;
    return range[1] < range[0] ? -1 : 0;
}

static int has_frame(const struct task *task, int frame) {
    int i = 0;
    while (i < task->count && task->frames[i] != frame)
        i++;
    return i < task->count;
}

/* Those that are not there yet: two would be one file. There is room for all. */
static void add_frames(struct task *task, int first, int last) {
    for (int frame = first; frame <= last; frame++)
        if (!has_frame(task, frame))
            task->frames[task->count++] = frame;
}

/* From the first to the last. */
static void some_frames(struct task *task, int last) {
    const int count = last < 6 ? last : 6;
    for (int i = 0; i < count; i++) {
        const int frame = count > 1 ? 1 + i * (last - 1) / (count - 1) : 1;
        add_frames(task, frame, frame);
    }
}

/* Returns the exit code. */
static int choose_frames(struct task *task) {
    const char *list = argument_text(task->arguments, "frames");
    const int last = strip_frames(task->strip);
    task->frames = memory_needed(calloc((size_t)last + 1, sizeof *task->frames));
    if (list ? strcmp(list, "all") == 0 : task->film)
        add_frames(task, 1, last);
    else if (!list)
        some_frames(task, last);
    for (const char *text = list; text && *text && strcmp(list, "all") != 0;) {
        int range[2] = {1, 1};
        const int code = read_range(&text, last, range);
        if (code == -1)
            complain(1, "--frames %s: must be numbers and ranges, as 1,6,10 or 1-31, or all", list);
        if (code)
            return 1;
        add_frames(task, range[0], range[1]);
    }
    return 0;
}

/* --- pictures --- */

static void picture_name(const struct task *task, int frame, char name[100]) {
    snprintf(name, 100, "%s-%04d", task->name, frame);
}

static int write_strip(struct task *task) {
    char name[100];
    snprintf(name, sizeof name, "%s-strip", task->name);
    const int code = strip_write(task->strip, task->frames, task->count, task->out, name,
                                 task->format, task->reason);
    if (!code)
        say("%s/%s.%s", task->out, name, task->format);
    return code;
}

/* One picture, by any thread; the first that fails ends it for all. */
static void write_picture(void *ctx, int i) {
    struct task *task = ctx;
    char name[100], reason[REASON_SIZE];
    pthread_mutex_lock(&task->shared);
    const int failed = task->code;
    pthread_mutex_unlock(&task->shared);
    if (failed)
        return;
    picture_name(task, task->frames[i], name);
    int code = strip_write(task->strip, &task->frames[i], 1, task->out, name, task->format, reason);
    if (code && runs_interrupted()) { /* so may gnuplot have been */
        code = 3;
        snprintf(reason, sizeof reason, "interrupted");
    }
    pthread_mutex_lock(&task->shared);
    if (code && !task->code) {
        task->code = code;
        memcpy(task->reason, reason, sizeof reason);
    }
    progress_show(&task->progress, (double)++task->done / task->count, "");
    pthread_mutex_unlock(&task->shared);
}

static int write_pictures(struct task *task) {
    char first[100], last[100];
    struct workers *workers =
        workers_create(task->threads < task->count ? task->threads : task->count);
    if (!workers)
        return fail_as(2, task->reason, "no threads to be had");
    task->progress = progress_start("pictures", !argument_given(task->arguments, "no-progress"));
    pthread_mutex_init(&task->shared, NULL);
    workers_run(workers, write_picture, task, task->count);
    pthread_mutex_destroy(&task->shared);
    progress_end(&task->progress);
    workers_free(workers);
    picture_name(task, task->frames[0], first);
    picture_name(task, task->frames[task->count - 1], last);
    if (!task->code)
        say(task->count > 1 ? "%s/%s.%s to %s.%s, %d pictures" : "%s/%s.%s", task->out, first,
            task->format, last, task->format, task->count);
    return task->code;
}

static int write_film(struct task *task) {
    char(*paths)[PATH_SIZE] = memory_needed(malloc((size_t)task->count * sizeof *paths));
    struct film film = {.pictures = paths, .count = task->count, .rate = task->rate};
    int mp4 = 0;
    for (int i = 0; i < task->count; i++) {
        char name[100];
        picture_name(task, task->frames[i], name);
        path_format(paths[i], "%s/%s.png", task->out, name);
    }
    strip_size(task->strip, 1, &film.width, &film.height);
    const int code = film_write(&film, task->out, task->name, &mp4, task->reason);
    if (!code)
        say("%s/%s.gif%s", task->out, task->name, mp4 ? " and .mp4" : " (no ffmpeg: no mp4)");
    free(paths);
    return code;
}

/* Returns the exit code; what is 2 or from the strip has its line in task->reason. */
static int draw(struct task *task) {
    int code;
    task->strip = strip_create(&task->request, &code, task->reason);
    if (!task->strip)
        return complain(code, "%s", task->reason);
    code = choose_frames(task);
    if (code)
        return code;
    plain_name(strip_name(task->strip), task->name, sizeof task->name);
    code =
        strip_check_size(task->strip, task->as_strip ? task->count : 1, task->format, task->reason);
    if (!code && make_folder(task->out, task->reason))
        code = 2;
    if (!code)
        code = (task->as_strip ? write_strip : write_pictures)(task);
    if (!code && task->film)
        code = write_film(task);
    return code ? complain(code, "%s", task->reason) : 0;
}

static int render(const struct arguments *arguments) {
    struct task *task = memory_needed(calloc(1, sizeof *task));
    task->arguments = arguments;
    task->trajectories = trajectories_create();
    int code = read_task(task) ? 1 : find_runs(task);
    if (!code)
        code = draw(task);
    strip_free(task->strip);
    trajectories_free(task->trajectories);
    for (int i = 0; i < RUNS_MAX; i++)
        scene_free(task->scenes[i]);
    free(task->frames);
    free(task);
    return code;
}

const struct command render_command = {
    .name = "render",
    .usage = "SCENE|STATES... [--frames LIST] [--size WxH] [--hair|--skeleton|--envelope] ...",
    .summary = "draw pictures of the hair: frames, strips, films",
    .details =
        "STATES is a states.tsv or states.npy, or the folder of a run that has one; its run.json\n"
        "must be beside it. A SCENE is run first with its defaults; the run is kept in "
        "results/runs, and is not\n"
        "done again. Several of them make a strip with a row for each.\n"
        "\n"
        "  wisplab render sphere --frames 50,75,100,125,150,200 --strip --columns 3\n"
        "  wisplab run interactions --stepper cvode --out cvode\n"
        "  wisplab render cvode --frames 24 --size 1280x960\n"
        "  wisplab render swing-envelope --frames 1,8 --skeleton --envelope\n"
        "  wisplab render swing --skeleton --film --size 480x360\n"
        "  wisplab render swing-envelope --section 8 --frames 1,8 --strip\n"
        "  wisplab render euler rk4 --error reference --frames 5,10,20 --beside\n"
        "  wisplab render sphere --set 'render={eye=[0,0,1]; target=[0,-0.2,0]; hairs=100;}'\n"
        "\n"
        "The scene's group `render` may have eye and target (m), angle (of view, rad), light\n"
        "(towards it), colour (red, green, blue, 0 to 1), hairs (of a wisp) and pieces (of a hair\n"
        "in a segment). Without eye and target all hair of all frames is in the picture.\n",
    .options = options,
    .words_least = 1,
    .words_most = RUNS_MAX,
    .run = render,
};
