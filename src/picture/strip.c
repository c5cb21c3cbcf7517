#include "strip.h"

#include "base/files.h"
#include "base/vector.h"
#include "base/visible.h"
#include "plot.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/param.h>
#include <unistd.h>

/* Pixels. */
enum { TITLE = STRIP_TITLE, CAPTION = 20, LETTER = 7, BAR = 70, GAP = 6 };
enum { PANELS_MAX = 400 };

struct run {
    struct frames frames;
    struct drawing drawing;
    char label[80];
};

struct strip {
    struct run *runs;
    int run_count;
    struct frames reference;
    char title[200];
    int width, height, columns;
    int longest; /* letters in a label */
    double most; /* of all distances from the reference, m; 0: there is none */
};

/* --- reading --- */

/* "file: what is wrong". Returns 1. */
static int refuse(const char *file, const char *what, char *reason) {
    snprintf(reason, REASON_SIZE, "%.120s: %.110s", file, what);
    return 1;
}

static int check_views(const struct frames *frames, unsigned views, const char *states,
                       char *reason) {
    if (views & (VIEW_HAIR | VIEW_ENVELOPE) && frames->scene->wisps[0].samples == 0)
        return refuse(states, "wisps without an envelope have no hair; --skeleton shows them",
                      reason);
    if (views & VIEW_STYLE && frames->scene->around.style.knots == 0)
        return refuse(states, "the scene has no style field to be shown", reason);
    return 0;
}

static int open_run(struct strip *strip, int i, const struct strip_request *request, char *reason) {
    const struct strip_row *row = &request->rows[i];
    struct run *run = &strip->runs[i];
    int code = frames_open(&run->frames, row->states, request->trajectories, request->sets,
                           request->set_count, reason);
    strip->run_count++;
    if (code)
        return code;
    if (row->scene) {
        memcpy(run->frames.scene->name, row->scene->name, sizeof row->scene->name);
        run->frames.scene->render = row->scene->render;
    }
    snprintf(run->label, sizeof run->label, "%s",
             row->label               ? row->label
             : request->row_count > 1 ? run->frames.run
                                      : "");
    strip->longest = MAX(strip->longest, (int)strlen(run->label));
    code = check_views(&run->frames, request->views, row->states, reason);
    if (!code && drawing_create(&run->drawing, &run->frames, request->views)) {
        snprintf(reason, REASON_SIZE, "out of memory");
        code = 2;
    }
    return code;
}

/* Towards where gravity does not pull; y where there is none. */
static void find_upwards(const struct scene *scene, double upwards[3]) {
    const double *g = scene->around.gravity, length = vector_length(g);
    for (int k = 0; k < 3; k++)
        upwards[k] = length > 0 ? -g[k] / length : k == 1;
}

static void place_camera(struct strip *strip) {
    double upwards[3], sides[4][3], most[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
    const struct scene *scene = strip->runs[0].frames.scene;
    find_upwards(scene, upwards);
    struct camera camera = camera_make(&scene->render, upwards, strip->width, strip->height);
    camera_sides(&camera, sides);
    for (int i = 0; i < strip->run_count; i++)
        frames_extent(&strip->runs[i].frames, (const double(*)[3])sides, most);
    camera_fit(&camera, &scene->render, most);
    for (int i = 0; i < strip->run_count; i++)
        strip->runs[i].drawing.camera = camera;
}

/* --- the reference --- */

/* Whether two runs have the same wisps at the same times, as far as both go. */
static int comparable(const struct frames *a, const struct frames *b) {
    for (int frame = 1; frame <= a->count && frame <= b->count; frame++) {
        const double t = frames_time(a, frame);
        if (frames_wisps(a, frame) != frames_wisps(b, frame) ||
            fabs(frames_time(b, frame) - t) > 1e-9 * fmax(1, t))
            return 0;
    }
    for (int i = 0; i < a->wisp_count && i < b->wisp_count; i++)
        if (a->wisps[i].nodes != b->wisps[i].nodes || a->wisps[i].samples != b->wisps[i].samples)
            return 0;
    return 1;
}

static const double *node_at(const struct frames *frames, int row) {
    return trajectory_row(frames->states, row) + STATE_X;
}

static double largest_distance(const struct frames *a, const struct frames *b) {
    const int common = a->count < b->count ? a->count : b->count;
    double most = 0;
    for (int row = 0; row < a->first_row[common]; row++) {
        const double *p = node_at(a, row), *q = node_at(b, row);
        const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
        most = fmax(most, vector_length(d));
    }
    return most;
}

static int open_reference(struct strip *strip, const struct strip_request *request, char *reason) {
    const int code = frames_open(&strip->reference, request->reference, request->trajectories,
                                 request->sets, request->set_count, reason);
    for (int i = 0; i < strip->run_count && !code; i++) {
        struct run *run = &strip->runs[i];
        if (!comparable(&run->frames, &strip->reference))
            return refuse(request->rows[i].states,
                          "has other wisps or frames than the reference: nothing to be compared",
                          reason);
        run->drawing.reference = &strip->reference;
        strip->most = fmax(strip->most, largest_distance(&run->frames, &strip->reference));
    }
    if (!code && !(strip->most > 0))
        return refuse(request->reference, "no run is different from it: no error to be shown",
                      reason);
    return code;
}

/* --- making one --- */

static void make_title(struct strip *strip, const struct strip_request *request) {
    const struct frames *first = &strip->runs[0].frames;
    if (request->title)
        snprintf(strip->title, sizeof strip->title, "%s", request->title);
    else if (strip->run_count > 1)
        snprintf(strip->title, sizeof strip->title, "%s", first->scene->name);
    else
        snprintf(strip->title, sizeof strip->title, "%s, %s", first->scene->name, first->run);
}

static int open_strip(struct strip *strip, const struct strip_request *request, char *reason) {
    int code = 0;
    strip->width = request->width > 0 ? request->width : 320;
    strip->height = request->height > 0 ? request->height : 240;
    strip->columns = request->columns;
    for (int i = 0; i < request->row_count && !code; i++)
        code = open_run(strip, i, request, reason);
    if (!code && request->reference)
        code = open_reference(strip, request, reason);
    if (!code) {
        place_camera(strip);
        make_title(strip, request);
    }
    return code;
}

struct strip *strip_create(const struct strip_request *request, int *code, char *reason) {
    struct strip *strip = calloc(1, sizeof *strip);
    if (strip)
        strip->runs = calloc((size_t)request->row_count, sizeof *strip->runs);
    if (!strip || !strip->runs) {
        free(strip);
        snprintf(reason, REASON_SIZE, "out of memory");
        *code = 2;
        return NULL;
    }
    *code = open_strip(strip, request, reason);
    if (*code) {
        strip_free(strip);
        return NULL;
    }
    return strip;
}

void strip_free(struct strip *strip) {
    if (!strip)
        return;
    for (int i = 0; i < strip->run_count; i++) {
        drawing_free(&strip->runs[i].drawing);
        frames_close(&strip->runs[i].frames);
    }
    frames_close(&strip->reference);
    free(strip->runs);
    free(strip);
}

int strip_frames(const struct strip *strip) {
    int least = strip->most > 0 ? strip->reference.count : strip->runs[0].frames.count;
    for (int i = 0; i < strip->run_count; i++)
        least = MIN(least, strip->runs[i].frames.count);
    return least;
}

const char *strip_name(const struct strip *strip) {
    return strip->runs[0].frames.scene->name;
}

/* --- a page --- */

struct layout {
    int columns, lines;          /* panels side by side; of each run, below each other */
    int left, top, across, down; /* the first panel, and the way from one to the next, pixels */
    int width, height;
};

static struct layout lay_out(const struct strip *strip, int count) {
    struct layout page;
    const int alone = strip->run_count == 1 && count == 1; /* its title says which frame it is */
    page.columns = strip->columns > 0 && strip->columns < count ? strip->columns : count;
    page.lines = (count + page.columns - 1) / page.columns;
    page.left = strip->longest > 0 ? 2 * GAP + LETTER * strip->longest : 0;
    page.top = TITLE + (alone ? 0 : CAPTION);
    page.across = strip->width + (alone ? 0 : GAP);
    page.down = strip->height + (alone ? 0 : GAP) + (page.lines > 1 ? CAPTION : 0);
    page.width = page.left + page.columns * page.across;
    page.height = page.top + strip->run_count * page.lines * page.down +
                  (strip->most > 0 ? BAR : 0) - (page.lines > 1 ? CAPTION : 0);
    return page;
}

void strip_size(const struct strip *strip, int count, int *width, int *height) {
    const struct layout page = lay_out(strip, count);
    *width = page.width;
    *height = page.height;
}

/* A label at a place in pixels from the top left, in gnuplot's words. */
static void write_label(FILE *file, int number, const struct layout *page, double x, double y,
                        const char *how, const char *text) {
    char shown[512], *c = shown;
    visible_text(text, shown, sizeof shown); /* a newline would begin a command */
    fprintf(file, "set label %d '", number);
    for (; *c; c++)
        fprintf(file, *c == '\'' ? "''" : "%c", *c);
    fprintf(file, "' at screen %.17g, screen %.17g %s noenhanced\n", x / page->width,
            1 - y / page->height, how);
}

/* Corner of panel `column` of a run, from the page's top left. */
static void panel_corner(const struct layout *page, int run, int column, int corner[2]) {
    corner[0] = page->left + column % page->columns * page->across;
    corner[1] = page->top + (run * page->lines + column / page->columns) * page->down;
}

static void write_labels(const struct strip *strip, const struct layout *page, const int *frames,
                         int count, FILE *file) {
    char text[256], font[64];
    int number = 1, corner[2];
    const struct frames *first = &strip->runs[0].frames;
    if (strip->run_count == 1 && count == 1)
        snprintf(text, sizeof text, "%s, frame %d, t = %.3f s", strip->title, frames[0],
                 frames_time(first, frames[0]));
    else
        snprintf(text, sizeof text, "%s", strip->title);
    snprintf(font, sizeof font, "left font FONT.':Bold,%.3g'",
             fmin(13, 1.3 * page->width / (double)strlen(text))); /* a letter of 13 has 10 pixels */
    write_label(file, number++, page, 10, TITLE / 2., font, text);
    for (int run = 0; run < strip->run_count; run++) {
        panel_corner(page, run, 0, corner);
        if (strip->longest > 0)
            write_label(file, number++, page, 10, corner[1] + strip->height / 2., "left",
                        strip->runs[run].label);
        if (run > 0 && page->lines == 1)
            continue; /* the first row's captions are the columns' */
        for (int i = 0; i < count && (strip->run_count > 1 || count > 1); i++) {
            panel_corner(page, run, i, corner);
            snprintf(text, sizeof text, "frame %d, %.3f s", frames[i],
                     frames_time(first, frames[i]));
            write_label(file, number++, page, corner[0] + strip->width / 2.,
                        corner[1] - CAPTION / 2., "center textcolor rgb GREY", text);
        }
    }
}

/* Binary: an image, and structs of segments. */
static int write_bytes(const char *folder, const char *name, const void *bytes, size_t size,
                       size_t count, char *reason) {
    char path[PATH_SIZE];
    path_format(path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    int bad = !file || fwrite(bytes, size, count, file) != count;
    if (file && fclose(file))
        bad = 1;
    if (!bad)
        return 0;
    snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", path, strerror(errno));
    return 2;
}

/* Writes a panel's data, and into the page what there is of them. */
static int write_panel(const struct strip *strip, const struct layout *page, int run, int column,
                       int frame, const char *folder, FILE *file, char *reason) {
    struct picture picture;
    char name[64];
    int corner[2], code = 0;
    panel_corner(page, run, column, corner);
    if (picture_draw(&picture, &strip->runs[run].drawing, frame)) {
        picture_free(&picture);
        snprintf(reason, REASON_SIZE, "out of memory");
        return 2;
    }
    fprintf(file, "panels = panels + 1; left[panels] = %d; top[panels] = %d; bodies[panels] = %d\n",
            corner[0], corner[1], picture.bodies != NULL);
    snprintf(name, sizeof name, "bodies-%d-%d", run, column);
    fprintf(file, "image[panels] = '%s'\n", name);
    if (picture.bodies)
        code = write_bytes(folder, name, picture.bodies, 4,
                           (size_t)picture.width * (size_t)picture.height, reason);
    for (int k = 0; k < LAYER_COUNT && !code; k++) {
        const struct layer *layer = &picture.layer[k];
        snprintf(name, sizeof name, "layer-%d-%d-%d", run, column, k);
        fprintf(file, "layer%d[panels] = '%s'\n", k, layer->count > 0 ? name : "");
        if (layer->count > 0)
            code = write_bytes(folder, name, layer->segments, sizeof *layer->segments, layer->count,
                               reason);
    }
    picture_free(&picture);
    return code;
}

static int write_page(const struct strip *strip, const int *frames, int count, const char *folder,
                      char *reason) {
    char path[PATH_SIZE];
    const struct layout page = lay_out(strip, count);
    const int panels = strip->run_count * count;
    int code = 0;
    path_format(path, "%s/page.gp", folder);
    FILE *file = fopen(path, "w");
    if (!file) {
        snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", path, strerror(errno));
        return 2;
    }
    fprintf(file, "WIDTH = %d; HEIGHT = %d; panel_width = %d; panel_height = %d; most = %.17g\n",
            page.width, page.height, strip->width, strip->height, strip->most);
    fprintf(file, "panels = 0; array left[%d]; array top[%d]; array bodies[%d]; array image[%d]\n",
            panels, panels, panels, panels);
    for (int k = 0; k < LAYER_COUNT; k++)
        fprintf(file, "array layer%d[%d]\n", k, panels);
    for (int i = 0; i < panels && !code; i++)
        code = write_panel(strip, &page, i / count, i % count, frames[i % count], folder, file,
                           reason);
    write_labels(strip, &page, frames, count, file);
    if (fclose(file) && !code) {
        snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", path, strerror(errno));
        code = 2;
    }
    return code;
}

static int check_frames(const struct strip *strip, const int *frames, int count, char *reason) {
    const int last = strip_frames(strip);
    for (int i = 0; i < count; i++)
        if (frames[i] < 1 || frames[i] > last) {
            snprintf(reason, REASON_SIZE, "there is no frame %d; there are frames 1 to %d",
                     frames[i], last);
            return 1;
        }
    if (count >= 1 && strip->run_count * count <= PANELS_MAX)
        return 0;
    snprintf(reason, REASON_SIZE, "%d pictures are not from 1 to %d, what a page can have",
             strip->run_count * count, PANELS_MAX);
    return 1;
}

int strip_write(const struct strip *strip, const int *frames, int count, const char *folder,
                const char *name, const char *format, char *reason) {
    char drawing[PATH_SIZE], drawn[PATH_SIZE], file[PATH_SIZE], none[REASON_SIZE];
    int code = check_frames(strip, frames, count, reason);
    if (code)
        return code;
    if (temporary_folder(folder, drawing, reason))
        return 2;
    path_format(drawn, "%s/picture.%s", drawing, format);
    path_format(file, "%s/%s.%s", folder, name, format);
    code = write_page(strip, frames, count, drawing, reason);
    if (!code && plot_draw("pictures", drawing, drawing, format, reason))
        code = 2;
    if (!code && file_put(drawn, file)) {
        snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", file, strerror(errno));
        code = 2;
    }
    plot_empty_folder(drawing, NULL, none);
    return code;
}

int strip_draw(const struct strip_request *request, const int *frames, int count,
               const char *folder, const char *name, char *reason) {
    int code;
    struct strip *strip = strip_create(request, &code, reason);
    if (strip)
        code = strip_write(strip, frames, count, folder, name, "png", reason);
    strip_free(strip);
    return code;
}
