#include "canvas.h"

#include "base/files.h"
#include "base/markup.h"
#include "base/memory.h"
#include "base/visible.h"
#include "raster.h"

#include <cairo.h>
#include <stdlib.h>
#include <string.h>
#include <sys/param.h>

/* The reader's own sans in an SVG, and what fontconfig has for it in a PNG: DejaVu Sans. */
static const char font[] = "sans-serif";

struct canvas {
    int width, height;
    struct window {
        int left, top, width, height;
    } window;
    double pen;

    cairo_surface_t *surface; /* of a PNG */
    cairo_t *cairo;
    struct raster raster; /* the window's part of it */

    FILE *svg; /* into text */
    char *text;
    size_t size;
    int in_pen; /* a group for lines of one width is open, */
    long ink;   /* and in it a path of this colour, or -1 */
    int broken; /* memory could not be had */
};

#ifdef __SANITIZE_ADDRESS__
/* fontconfig keeps addresses as distances from each other, which a leak checker does not see. */
__attribute__((weak)) const char *__lsan_default_suppressions(void);
__attribute__((weak)) const char *__lsan_default_options(void);

const char *__lsan_default_suppressions(void) {
    return "leak:libfontconfig";
}

const char *__lsan_default_options(void) {
    return "print_suppressions=0";
}
#endif

static int is_svg(const struct canvas *canvas) {
    return !canvas->surface;
}

/* --- the page --- */

static void begin_svg(struct canvas *canvas) {
    canvas->svg = memory_needed(open_memstream(&canvas->text, &canvas->size));
    fprintf(canvas->svg,
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<svg width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" xmlns=\"http://www.w3.org/2000/svg\" "
            "xmlns:xlink=\"http://www.w3.org/1999/xlink\">\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"#ffffff\"/>\n",
            canvas->width, canvas->height, canvas->width, canvas->height, canvas->width,
            canvas->height);
}

static void begin_png(struct canvas *canvas) {
    canvas->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, canvas->width, canvas->height);
    canvas->cairo = cairo_create(canvas->surface);
    cairo_set_source_rgb(canvas->cairo, 1, 1, 1);
    cairo_paint(canvas->cairo);
}

struct canvas *canvas_create(int width, int height, int as_svg) {
    struct canvas *canvas = memory_needed(calloc(1, sizeof *canvas));
    canvas->width = width;
    canvas->height = height;
    canvas->ink = -1;
    (as_svg ? begin_svg : begin_png)(canvas);
    if (as_svg || cairo_status(canvas->cairo) == CAIRO_STATUS_SUCCESS)
        return canvas;
    canvas_free(canvas);
    return NULL;
}

void canvas_free(struct canvas *canvas) {
    if (!canvas)
        return;
    if (canvas->svg)
        fclose(canvas->svg);
    free(canvas->text);
    cairo_destroy(canvas->cairo);
    cairo_surface_destroy(canvas->surface);
    free(canvas);
}

/* --- words --- */

static void set_colour(cairo_t *cairo, unsigned colour) {
    cairo_set_source_rgb(cairo, (colour >> 16 & 255) / 255., (colour >> 8 & 255) / 255.,
                         (colour & 255) / 255.);
}

static void text_on_png(cairo_t *cairo, const struct canvas_text *how, double baseline,
                        const char *text) {
    char shown[512]; /* cairo takes no bytes that are not UTF-8 */
    cairo_text_extents_t extents;
    visible_text(text, shown, sizeof shown);
    cairo_select_font_face(cairo, font, CAIRO_FONT_SLANT_NORMAL,
                           how->bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, how->size);
    cairo_text_extents(cairo, shown, &extents);
    set_colour(cairo, how->colour);
    cairo_move_to(cairo, how->x - (how->centred ? extents.x_advance / 2 : 0), baseline);
    cairo_show_text(cairo, shown);
}

void canvas_text(struct canvas *canvas, const struct canvas_text *how, const char *text) {
    const double baseline = how->y + 0.36 * how->size; /* half of a capital letter below */
    if (!is_svg(canvas)) {
        text_on_png(canvas->cairo, how, baseline, text);
        return;
    }
    fprintf(canvas->svg,
            "<text x=\"%.2f\" y=\"%.2f\" font-family=\"%s\" font-size=\"%.4g\"%s%s fill=\"#%06x\">",
            how->x, baseline, font, how->size, how->bold ? " font-weight=\"bold\"" : "",
            how->centred ? " text-anchor=\"middle\"" : "", how->colour);
    markup_text(canvas->svg, text);
    fputs("</text>\n", canvas->svg);
}

/* --- windows --- */

void canvas_window(struct canvas *canvas, int left, int top, int width, int height) {
    canvas->window = (struct window){left, top, width, height};
    if (is_svg(canvas)) {
        fprintf(canvas->svg,
                "<svg x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" overflow=\"hidden\">\n", left,
                top, width, height);
        return;
    }
    cairo_save(canvas->cairo);
    cairo_rectangle(canvas->cairo, left, top, width, height);
    cairo_clip(canvas->cairo);
    cairo_translate(canvas->cairo, left, top + height);
    cairo_scale(canvas->cairo, 1, -1);
    canvas->raster = (struct raster){
        .pixels = (unsigned *)(void *)cairo_image_surface_get_data(canvas->surface),
        .stride = cairo_image_surface_get_stride(canvas->surface) / (int)sizeof(unsigned),
        .left = MAX(left, 0),
        .top = MAX(top, 0),
        .right = MIN(left + width, canvas->width),
        .bottom = MIN(top + height, canvas->height)};
    cairo_surface_flush(canvas->surface); /* lines and images are painted behind cairo's back */
}

static void end_path(struct canvas *canvas) {
    if (canvas->ink >= 0)
        fputs("\"/>\n", canvas->svg);
    canvas->ink = -1;
}

static void end_pen(struct canvas *canvas) {
    end_path(canvas);
    if (canvas->in_pen)
        fputs("</g>\n", canvas->svg);
    canvas->in_pen = 0;
}

void canvas_window_end(struct canvas *canvas) {
    if (is_svg(canvas)) {
        end_pen(canvas);
        fputs("</svg>\n", canvas->svg);
    } else {
        cairo_surface_mark_dirty(canvas->surface);
        cairo_restore(canvas->cairo);
    }
}

/* --- pictures --- */

static cairo_status_t write_bytes(void *stream, const unsigned char *bytes, unsigned count) {
    return fwrite(bytes, 1, count, stream) == count ? CAIRO_STATUS_SUCCESS
                                                    : CAIRO_STATUS_WRITE_ERROR;
}

/* As PNG, from the top, in words of opacity and colours that are already multiplied with it. */
static int write_image(FILE *stream, const unsigned char *pixels, int width, int height) {
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
    unsigned char *data = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int row = height - 1; data && row >= 0; row--) {
        unsigned *word = (unsigned *)(void *)(data + (long)row * stride);
        for (int column = 0; column < width; column++, pixels += 4, word++) {
            *word = (unsigned)pixels[3] << 24;
            for (int k = 0; k < 3; k++)
                *word |= (unsigned)(pixels[k] * pixels[3] / 255) << (16 - 8 * k);
        }
    }
    cairo_surface_mark_dirty(surface);
    const int bad =
        cairo_surface_write_to_png_stream(surface, write_bytes, stream) != CAIRO_STATUS_SUCCESS;
    cairo_surface_destroy(surface);
    return bad;
}

static void image_in_svg(struct canvas *canvas, const unsigned char *pixels) {
    FILE *png = tmpfile();
    if (!png || write_image(png, pixels, canvas->window.width, canvas->window.height)) {
        canvas->broken = 1;
    } else {
        rewind(png);
        fprintf(canvas->svg,
                "<image width=\"%d\" height=\"%d\" xlink:href=\"data:image/png;base64,",
                canvas->window.width, canvas->window.height);
        markup_base64(canvas->svg, png);
        fputs("\"/>\n", canvas->svg);
    }
    if (png)
        fclose(png);
}

void canvas_image(struct canvas *canvas, const unsigned char *pixels) {
    if (is_svg(canvas)) {
        end_pen(canvas);
        image_in_svg(canvas, pixels);
    } else {
        raster_image(&canvas->raster, pixels);
    }
}

/* --- lines --- */

void canvas_pen(struct canvas *canvas, double width) {
    canvas->pen = width;
    if (!is_svg(canvas))
        return;
    end_pen(canvas);
    fprintf(canvas->svg, "<g fill=\"none\" stroke-linecap=\"round\" stroke-width=\"%.4g\">\n",
            width);
    canvas->in_pen = 1;
}

/* Lines of a colour share a path; one that goes on from the last says only where it goes. */
static void line_in_svg(struct canvas *canvas, double x, double y, double dx, double dy,
                        unsigned colour) {
    const double top = canvas->window.height - y;
    if (canvas->ink != (long)colour) {
        end_path(canvas);
        fprintf(canvas->svg, "<path stroke=\"#%06x\" d=\"", colour);
        canvas->ink = (long)colour;
    }
    fprintf(canvas->svg, "M%.2f %.2fl%.2f %.2f", x, top, dx, -dy);
}

void canvas_line(struct canvas *canvas, double x, double y, double dx, double dy, unsigned colour) {
    if (is_svg(canvas)) {
        line_in_svg(canvas, x, y, dx, dy, colour);
    } else {
        raster_line(&canvas->raster, canvas->window.left + x,
                    canvas->window.top + canvas->window.height - y, dx, -dy, canvas->pen, colour);
    }
}

void canvas_polygon(struct canvas *canvas, const double (*corners)[2], int count, unsigned colour) {
    if (is_svg(canvas)) {
        end_path(canvas);
        fprintf(canvas->svg, "<path stroke=\"none\" fill=\"#%06x\" d=\"", colour);
        for (int i = 0; i < count; i++)
            fprintf(canvas->svg, "%c%.2f %.2f", i == 0 ? 'M' : 'L', corners[i][0],
                    canvas->window.height - corners[i][1]);
        fputs("Z\"/>\n", canvas->svg);
        return;
    }
    cairo_surface_mark_dirty(canvas->surface);
    set_colour(canvas->cairo, colour);
    for (int i = 0; i < count; i++)
        cairo_line_to(canvas->cairo, corners[i][0], corners[i][1]);
    cairo_close_path(canvas->cairo);
    cairo_fill(canvas->cairo);
    cairo_surface_flush(canvas->surface);
}

/* --- the file --- */

/* Returns whether it could not be written. */
static int write_png(struct canvas *canvas, FILE *stream) {
    cairo_surface_flush(canvas->surface);
    return cairo_surface_write_to_png_stream(canvas->surface, write_bytes, stream) !=
           CAIRO_STATUS_SUCCESS;
}

static int write_svg(struct canvas *canvas, FILE *stream) {
    fputs("</svg>\n", canvas->svg);
    const int bad = fflush(canvas->svg) || ferror(canvas->svg);
    return bad || fwrite(canvas->text, 1, canvas->size, stream) != canvas->size;
}

int canvas_write(struct canvas *canvas, const char *path, char *reason) {
    struct atomic_file file;
    if (canvas->broken || (canvas->cairo && cairo_status(canvas->cairo) != CAIRO_STATUS_SUCCESS))
        return fail_with(reason, "%.150s: cannot be drawn: out of memory", path);
    if (atomic_open(&file, path, reason))
        return -1;
    if ((is_svg(canvas) ? write_svg : write_png)(canvas, file.stream)) {
        atomic_discard(&file);
        return fail_with(reason, "%.150s: cannot write", path);
    }
    return atomic_commit(&file, reason);
}
