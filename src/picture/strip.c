#include "strip.h"

#include "base/files.h"
#include "base/memory.h"
#include "base/vector.h"
#include "canvas.h"
#include "layout.h"
#include "plane.h"

#include <stdlib.h>
#include <string.h>
#include <sys/param.h>

/* Pixels. */
enum { LETTER = 7, LETTERS = 13 };
enum { GREY = 0x666666 };
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
    struct strip_request wanted; /* with defaults for width, height */
    char title[200];
    int longest; /* letters in a label */
    double most; /* of all distances from the reference, m; 0: there is none */
};

/* --- reading --- */

static int check_views(const struct frames *frames, unsigned views, const char *states,
                       char *reason) {
    if (views & (VIEW_HAIR | VIEW_ENVELOPE) && frames->scene->wisps[0].samples == 0)
        return fail_as(1, reason,
                       "%.120s: wisps without an envelope have no hair; --skeleton shows them",
                       states);
    if (views & VIEW_STYLE && frames->scene->around.style.knots == 0)
        return fail_as(1, reason, "%.120s: the scene has no style field to be shown", states);
    return 0;
}

/* A free node of a wisp of the scene. */
static int check_plane(const struct frames *frames, const struct plane_view *plane,
                       const char *states, char *reason) {
    const struct scene *scene = frames->scene;
    if (scene->wisps[0].samples == 0)
        return fail_as(1, reason, "%.120s: wisps without an envelope have no sections", states);
    if (plane->wisp >= scene->wisp_count)
        return fail_as(1, reason, "%.120s: --section: there is no wisp %d; there are wisps 0 to %d",
                       states, plane->wisp, scene->wisp_count - 1);
    if (plane->node < 2 || plane->node >= scene->wisps[plane->wisp].nodes)
        return fail_as(1, reason,
                       "%.120s: --section: wisp %d has no free node %d, but nodes 2 to %d", states,
                       plane->wisp, plane->node, scene->wisps[plane->wisp].nodes - 1);
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
    if (!code && request->views & VIEW_PLANE)
        code = check_plane(&run->frames, &request->plane, row->states, reason);
    if (!code)
        drawing_create(&run->drawing, &run->frames, request->views);
    return code;
}

/* Upwards is where gravity does not pull; y where there is none. */
static void place_camera(struct strip *strip) {
    double upwards[3], sides[4][3], most[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
    const struct scene *scene = strip->runs[0].frames.scene;
    const double *g = scene->around.gravity, length = vector_length(g);
    for (int k = 0; k < 3; k++)
        upwards[k] = length > 0 ? -g[k] / length : k == 1;
    struct camera camera =
        camera_make(&scene->render, upwards, strip->wanted.width, strip->wanted.height);
    camera_sides(&camera, sides);
    for (int i = 0; i < strip->run_count; i++)
        frames_extent(&strip->runs[i].frames, (const double(*)[3])sides, most);
    camera_fit(&camera, &scene->render, most);
    for (int i = 0; i < strip->run_count; i++)
        strip->runs[i].drawing.camera = camera;
}

/* All planes are drawn in one measure. */
static void place_planes(struct strip *strip) {
    struct plane_view plane = strip->wanted.plane;
    for (int i = 0; i < strip->run_count; i++)
        plane.extent =
            fmax(plane.extent, plane_extent(&strip->runs[i].frames, plane.wisp, plane.node));
    for (int i = 0; i < strip->run_count; i++)
        strip->runs[i].drawing.plane = plane;
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

/* To the largest distance from the reference at a frame. */
static void raise_most(struct strip *strip, const struct frames *frames, int frame) {
    for (int row = frames->first_row[frame - 1]; row < frames->first_row[frame]; row++) {
        const double *p = node_at(frames, row), *q = node_at(&strip->reference, row);
        const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
        strip->most = fmax(strip->most, vector_length(d));
    }
}

/* As far as wisps that are whole can be apart, m: a run that diverged would otherwise have a scale
 * of its own on which nothing else is seen. */
static double farthest(const struct frames *frames) {
    double length = 0;
    for (int i = 0; i < frames->wisp_count; i++)
        length = fmax(length, frames->wisps[i].length);
    return 2 * length;
}

static int open_reference(struct strip *strip, const struct strip_request *request, char *reason) {
    const int code = frames_open(&strip->reference, request->reference, request->trajectories,
                                 request->sets, request->set_count, reason);
    for (int i = 0; i < strip->run_count && !code; i++) {
        struct run *run = &strip->runs[i];
        if (!comparable(&run->frames, &strip->reference))
            return fail_as(
                1, reason,
                "%.120s: has other wisps or frames than the reference: nothing to be compared",
                request->rows[i].states);
        run->drawing.reference = &strip->reference;
        const int common = MIN(run->frames.count, strip->reference.count);
        for (int frame = 1; frame <= common; frame++)
            if (request->error_frame == 0 || request->error_frame == frame)
                raise_most(strip, &run->frames, frame);
    }
    strip->most = code ? 0 : fmin(strip->most, farthest(&strip->reference));
    if (!code && !(strip->most > 0))
        return fail_as(1, reason, "%.120s: no run is different from it: no error to be shown",
                       request->reference);
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
    if (request->views & VIEW_PLANE && !request->title)
        snprintf(strip->title + strlen(strip->title), sizeof strip->title - strlen(strip->title),
                 ", wisp %d, node %d", request->plane.wisp, request->plane.node);
}

static int open_strip(struct strip *strip, const struct strip_request *request, char *reason) {
    int code = 0;
    const double scale = request->scale > 0 ? request->scale : 1;
    strip->wanted = *request;
    strip->wanted.width = (int)(scale * (request->width > 0 ? request->width : 320));
    strip->wanted.height = (int)(scale * (request->height > 0 ? request->height : 240));
    for (int i = 0; i < request->row_count && !code; i++)
        code = open_run(strip, i, request, reason);
    if (!code && request->reference)
        code = open_reference(strip, request, reason);
    if (code)
        return code;
    if (request->views & VIEW_PLANE)
        place_planes(strip);
    place_camera(strip);
    make_title(strip, request);
    return 0;
}

struct strip *strip_create(const struct strip_request *request, int *code, char *reason) {
    struct strip *strip = memory_needed(calloc(1, sizeof *strip));
    strip->runs = memory_needed(calloc((size_t)request->row_count, sizeof *strip->runs));
    *code = open_strip(strip, request, reason);
    if (!*code)
        return strip;
    strip_free(strip);
    return NULL;
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

static struct layout layout_of(const struct strip *strip, int count) {
    const struct strip_request *wanted = &strip->wanted;
    struct layout page = {.runs = strip->run_count,
                          .frames = count,
                          .width = wanted->width,
                          .height = wanted->height,
                          .columns = wanted->columns,
                          .label = strip->longest > 0 && !wanted->beside
                                       ? 2 * LAYOUT_GAP + LETTER * strip->longest
                                       : 0,
                          .beside = wanted->beside,
                          .untitled = wanted->untitled,
                          .has_bar = strip->most > 0,
                          .has_large = wanted->large > 0};
    lay_out(&page);
    return page;
}

void strip_size(const struct strip *strip, int count, int *width, int *height) {
    const struct layout page = layout_of(strip, count);
    *width = page.page_width;
    *height = page.page_height;
}

/* Panels count to those of the rows, and the large one is behind them. */
static int panel_count(const struct layout *page) {
    return page->groups * page->each + (page->has_large ? 1 : 0);
}

/* The panel has the number of its frame in place of its index. */
static struct panel panel_at(const struct strip *strip, const struct layout *page,
                             const int *frames, int i) {
    const int is_large = i == page->groups * page->each;
    struct panel panel = is_large ? layout_large(page) : layout_panel(page, i);
    panel.frame = is_large ? strip->wanted.large : frames[panel.frame];
    if (is_large)
        panel.run = strip->wanted.large_row;
    return panel;
}

/* A caption says whose picture it is, where the row does not, and of which frame, where not all are
 * of one. */
static void draw_caption(const struct strip *strip, const struct panel *panel, int count,
                         struct canvas *canvas) {
    const struct canvas_text how = {.x = panel->x + panel->scale * strip->wanted.width / 2,
                                    .y = panel->y - LAYOUT_CAPTION / 2.,
                                    .size = LETTERS,
                                    .centred = 1,
                                    .colour = GREY};
    const char *label = strip->runs[panel->run].label;
    const double t = frames_time(&strip->runs[0].frames, panel->frame);
    char text[256];
    if (strip->wanted.beside && *label && count == 1)
        snprintf(text, sizeof text, "%s", label);
    else if (strip->wanted.beside && *label)
        snprintf(text, sizeof text, "%s, %.3f s", label, t);
    else
        snprintf(text, sizeof text, "%s%sframe %d, %.3f s", panel->scale > 1 ? label : "",
                 panel->scale > 1 && *label ? ", " : "", panel->frame, t);
    canvas_text(canvas, &how, text);
}

static void draw_title(const struct strip *strip, const struct layout *page, const int *frames,
                       struct canvas *canvas) {
    char text[256];
    if (layout_is_alone(page))
        snprintf(text, sizeof text, "%s, frame %d, t = %.3f s", strip->title, frames[0],
                 frames_time(&strip->runs[0].frames, frames[0]));
    else
        snprintf(text, sizeof text, "%s", strip->title);
    const double size =
        fmin(17, 1.7 * page->page_width / (double)strlen(text)); /* 10 pixels of 17 */
    canvas_text(canvas, &(struct canvas_text){10, LAYOUT_TITLE / 2., size, 1, 0, 0}, text);
}

static void draw_labels(const struct strip *strip, const struct layout *page, const int *frames,
                        int count, struct canvas *canvas) {
    if (!strip->wanted.untitled)
        draw_title(strip, page, frames, canvas);
    for (int i = 0; i < panel_count(page) && !layout_is_alone(page); i++) {
        const struct panel panel = panel_at(strip, page, frames, i);
        const struct canvas_text row = {
            .x = page->left - page->label + 10, .y = panel.y + page->height / 2., .size = LETTERS};
        if (i % page->each == 0 && page->label > 0 && panel.scale == 1)
            canvas_text(canvas, &row, strip->runs[panel.run].label);
        if (i < page->each || page->lines > 1 || panel.scale > 1) /* else the first row's will do */
            draw_caption(strip, &panel, count, canvas);
    }
}

/* Distances over four decades, from pale to dark; `most` is of all that are shown, m. */
static unsigned error_colour(double part) {
    static const unsigned colours[] = {0xF2C14E, 0xF08A4B, 0xCC4778, 0x7E03A8, 0x0D0887};
    enum { STEPS = sizeof colours / sizeof *colours - 1 };
    const double at = STEPS * fmin(1, fmax(0, part));
    const int step = MIN((int)at, STEPS - 1);
    unsigned colour = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        const double from = colours[step] >> shift & 255, to = colours[step + 1] >> shift & 255;
        colour = colour << 8 | (unsigned)(from + (at - step) * (to - from) + 0.5);
    }
    return colour;
}

enum { DECADES = 4 };

static double highest_decade(const struct strip *strip) {
    return ceil(log10(strip->most));
}

static void colour_by_error(const struct strip *strip, struct layer *layer) {
    const double lowest = highest_decade(strip) - DECADES;
    for (size_t i = 0; i < layer->count; i++)
        layer->segments[i].colour = error_colour(
            (log10(fmax((double)layer->segments[i].error, 1e-300)) - lowest) / DECADES);
}

/* 10 to the power of so much. */
static void power_of_ten(int power, char *text, size_t size) {
    static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    char digits[16];
    snprintf(digits, sizeof digits, "%d", abs(power));
    snprintf(text, size, "10%s", power < 0 ? "⁻" : "");
    for (const char *c = digits; *c; c++)
        strncat(text, raised[*c - '0'], size - strlen(text) - 1);
}

static void draw_bar(const struct strip *strip, const struct layout *page, struct canvas *canvas) {
    enum { LONG = 320, HIGH = 10, TIC = 6 };
    const int left = (page->page_width - LONG) / 2, top = page->page_height - 60;
    canvas_window(canvas, left, top, LONG, HIGH);
    for (int x = 0; x < LONG; x++)
        canvas_polygon(canvas, (const double[4][2]){{x, 0}, {x + 1, 0}, {x + 1, HIGH}, {x, HIGH}},
                       4, error_colour((x + 0.5) / LONG));
    canvas_window_end(canvas);
    for (int i = 0; i <= DECADES; i++) {
        char text[32];
        const double x = left + i * LONG / (double)DECADES;
        power_of_ten((int)highest_decade(strip) - DECADES + i, text, sizeof text);
        canvas_text(canvas, &(struct canvas_text){x, top + HIGH + 12, LETTERS, 0, 1, 0}, text);
    }
    canvas_text(canvas,
                &(struct canvas_text){page->page_width / 2., top + HIGH + 30, LETTERS, 0, 1, 0},
                "distance from the reference, m");
}

/* An arrow's head. */
static void draw_head(struct canvas *canvas, const struct segment *arrow) {
    static const double reach = 12, half = 4, notch = 9.5; /* pixels */
    const double length = hypot((double)arrow->dx, (double)arrow->dy);
    const double along[2] = {(double)arrow->dx / length, (double)arrow->dy / length};
    const double tip[2] = {(double)(arrow->x + arrow->dx), (double)(arrow->y + arrow->dy)};
    const double back[4] = {0, reach, notch, reach}, beside[4] = {0, half, 0, -half};
    double corners[4][2];
    for (int i = 0; i < 4; i++) {
        corners[i][0] = tip[0] - back[i] * along[0] - beside[i] * along[1];
        corners[i][1] = tip[1] - back[i] * along[1] + beside[i] * along[0];
    }
    canvas_polygon(canvas, (const double(*)[2])corners, 4, arrow->colour);
}

static void draw_layer(struct canvas *canvas, const struct layer *layer, double width) {
    canvas_pen(canvas, width);
    for (size_t i = 0; i < layer->count; i++) {
        const struct segment *s = &layer->segments[i];
        canvas_line(canvas, (double)s->x, (double)s->y, (double)s->dx, (double)s->dy, s->colour);
    }
}

/* Widths are pixels; a hair is as thick as a pixel of a picture of some 700 lines. */
static void draw_picture(const struct strip *strip, struct picture *picture,
                         struct canvas *canvas) {
    const double hair = fmin(3, fmax(0.6, picture->height / 700.));
    const double widths[LAYER_COUNT] = {
        [LAYER_STYLE] = 1.6,  [LAYER_HAIR] = hair, [LAYER_ENVELOPE] = 1,
        [LAYER_SKELETON] = 3, [LAYER_NODES] = 4.5, [LAYER_SAMPLES] = 8.5};
    const struct layer *arrows = &picture->layer[LAYER_STYLE];
    draw_layer(canvas, arrows, widths[LAYER_STYLE]);
    for (size_t i = 0; i < arrows->count; i++)
        if (arrows->segments[i].dx != 0 || arrows->segments[i].dy != 0)
            draw_head(canvas, &arrows->segments[i]);
    if (picture->bodies)
        canvas_image(canvas, picture->bodies);
    for (int kind = LAYER_HAIR; kind < LAYER_COUNT; kind++) {
        if (strip->most > 0 && kind != LAYER_SAMPLES)
            colour_by_error(strip, &picture->layer[kind]);
        draw_layer(canvas, &picture->layer[kind], widths[kind]);
    }
}

static void draw_panel(const struct strip *strip, const struct panel *panel,
                       struct canvas *canvas) {
    struct drawing drawing = strip->runs[panel->run].drawing;
    struct picture picture;
    camera_enlarge(&drawing.camera, panel->scale);
    picture_draw(&picture, &drawing, panel->frame);
    canvas_window(canvas, panel->x, panel->y, picture.width, picture.height);
    draw_picture(strip, &picture, canvas);
    canvas_window_end(canvas);
    picture_free(&picture);
}

static void draw_page(const struct strip *strip, const struct layout *page, const int *frames,
                      int count, struct canvas *canvas) {
    draw_labels(strip, page, frames, count, canvas);
    for (int i = 0; i < panel_count(page); i++) {
        const struct panel panel = panel_at(strip, page, frames, i);
        draw_panel(strip, &panel, canvas);
    }
    if (strip->most > 0)
        draw_bar(strip, page, canvas);
}

static int check_frame(int frame, int last, char *reason) {
    if (frame >= 1 && frame <= last)
        return 0;
    return fail_as(1, reason, "there is no frame %d; there are frames 1 to %d", frame, last);
}

static int check_frames(const struct strip *strip, const int *frames, int count, char *reason) {
    const int last = strip_frames(strip), large = strip->wanted.large;
    if (large && check_frame(large, last, reason))
        return 1;
    for (int i = 0; i < count; i++)
        if (check_frame(frames[i], last, reason))
            return 1;
    if (count < 1 || strip->run_count * count > PANELS_MAX)
        return fail_as(1, reason, "%d pictures are not from 1 to %d, what a page can have",
                       strip->run_count * count, PANELS_MAX);
    return 0;
}

int strip_check_size(const struct strip *strip, int count, const char *format, char *reason) {
    const struct layout page = layout_of(strip, count);
    const int most = MAX(page.page_width, page.page_height);
    if (strcmp(format, "svg") == 0 || most <= CANVAS_SIDE_MOST)
        return 0;
    const double part = 0.99 * CANVAS_SIDE_MOST / most; /* gaps and words do not become less */
    return fail_as(
        1, reason,
        "a page of %d x %d pixels is larger than a PNG can be, %d each way: pictures of --size "
        "%dx%d, fewer --frames, other --columns or --format svg would do",
        page.page_width, page.page_height, CANVAS_SIDE_MOST, (int)(part * strip->wanted.width),
        (int)(part * strip->wanted.height));
}

int strip_write(const struct strip *strip, const int *frames, int count, const char *folder,
                const char *name, const char *format, char *reason) {
    char file[PATH_SIZE];
    if (check_frames(strip, frames, count, reason))
        return 1;
    const struct layout page = layout_of(strip, count);
    struct canvas *canvas =
        canvas_create(page.page_width, page.page_height, strcmp(format, "svg") == 0);
    if (!canvas)
        return fail_as(
            2, reason,
            "no memory for a page of %d x %d pixels: a smaller --size or fewer --frames need less",
            page.page_width, page.page_height);
    path_format(file, "%s/%s.%s", folder, name, format);
    draw_page(strip, &page, frames, count, canvas);
    const int code = canvas_write(canvas, file, reason) ? 2 : 0;
    canvas_free(canvas);
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
