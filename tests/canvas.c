/* What is painted for pictures of hair. */
#include "picture/canvas.h"

#include "base/files.h"
#include "picture/raster.h"
#include "support.h"

#include <cairo.h>
#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 64, WHITE = 0xFFFFFF };

static void whiten(unsigned *pixels) {
    for (int i = 0; i < SIDE * SIDE; i++)
        pixels[i] = WHITE;
}

/* How much of the page is black, pixels. */
static double black(const unsigned *pixels) {
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += 1 - (pixels[i] & 255) / 255.;
    return sum;
}

/* A rectangle and half a disc at each end, whatever its direction. */
Test(canvas, a_line_covers_its_area) {
    static const double widths[] = {1, 1.3, 2.5, 6};
    static unsigned pixels[SIDE * SIDE];
    const struct raster raster = {pixels, SIDE, 0, 0, SIDE, SIDE};
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++)
        for (int degrees = 0; degrees < 360; degrees += 15)
            for (double length = 0.5; length < 40; length *= 4) {
                const double angle = degrees * M_PI / 180, width = widths[w],
                             dx = length * cos(angle), dy = length * sin(angle),
                             area = width * length + M_PI / 4 * width * width;
                whiten(pixels);
                raster_line(&raster, 31.7 - dx / 2, 32.2 - dy / 2, dx, dy, width, 0);
                cr_expect_float_eq(black(pixels), area, 0.09 * area + 0.4,
                                   "%g wide, %g long, at %d degrees: %g, not %g", width, length,
                                   degrees, black(pixels), area);
            }
}

Test(canvas, nothing_is_painted_outside_of_the_window) {
    static unsigned pixels[SIDE * SIDE];
    const struct raster raster = {pixels, SIDE, 10, 20, 30, 50};
    whiten(pixels);
    for (int degrees = 0; degrees < 360; degrees += 5)
        raster_line(&raster, 20, 35, 1e4 * cos(degrees * M_PI / 180),
                    1e4 * sin(degrees * M_PI / 180), 3, 0);
    int inside = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int x = i % SIDE, y = i / SIDE, in = x >= 10 && x < 30 && y >= 20 && y < 50;
        cr_expect(in || pixels[i] == WHITE, "pixel %d, %d", x, y);
        inside += in && pixels[i] != WHITE;
    }
    cr_expect_eq(inside, 20 * 30);
}

/* The first pixel is the lower left one; what lets all through leaves what is there. */
Test(canvas, an_image_is_laid_over_what_is_there) {
    unsigned pixels[4] = {0x000000, 0x000000, 0x102030, 0x102030};
    static const unsigned char image[] = {200, 100, 50, 255, 200, 100, 50, 0,
                                          200, 100, 50, 128, 0,   0,   0,  255};
    const struct raster raster = {pixels, 2, 0, 0, 2, 2};
    raster_image(&raster, image);
    cr_expect_eq(pixels[2], 0xC86432);
    cr_expect_eq(pixels[3], 0x102030);
    cr_expect_eq(pixels[0], 0x643219, "%06x", pixels[0]);
    cr_expect_eq(pixels[1], 0x000000);
}

/* A page with a body, lines over it, an arrow's head and words. */
static void draw_page(struct canvas *canvas) {
    unsigned char body[4 * 40 * 30];
    for (int i = 0; i < 40 * 30; i++)
        memcpy(body + 4 * i, (const unsigned char[]){180, 90, 20, i / 40 < 10 ? 255 : 128}, 4);
    canvas_text(canvas, &(struct canvas_text){5, 8, 13, 1, 0, 0x202020}, "hair");
    canvas_window(canvas, 20, 20, 40, 30);
    canvas_image(canvas, body);
    canvas_pen(canvas, 3);
    for (int i = 0; i < 4; i++)
        canvas_line(canvas, 2, 3 + 2 * i, 30, 4 * i, i < 2 ? 0x0000FF : 0x00A000);
    canvas_polygon(canvas, (const double[3][2]){{30, 28}, {38, 28}, {34, 10}}, 3, 0xC00000);
    canvas_window_end(canvas);
}

static cairo_surface_t *image_of(const char *path) {
    cairo_surface_t *image = cairo_image_surface_create_from_png(path);
    cr_assert_eq(cairo_surface_status(image), CAIRO_STATUS_SUCCESS, "%s", path);
    return image;
}

/* By another program's reading of the SVG, where it is installed. */
Test(canvas, both_formats_show_the_same) {
    char reason[REASON_SIZE];
    const char *const folder = folder_make();
    const char *const svg = printed("%s/page.svg", folder);
    const char *const png = printed("%s/page.png", folder);
    const char *const other = printed("%s/other.png", folder);
    for (int as_svg = 0; as_svg < 2; as_svg++) {
        struct canvas *canvas = canvas_create(SIDE + 16, SIDE, as_svg);
        draw_page(canvas);
        cr_assert_eq(canvas_write(canvas, as_svg ? svg : png, reason), 0, "%s", reason);
        canvas_free(canvas);
    }
    char *text = file_read(svg);
    cr_expect(strstr(text, ">hair</text>"), "words are no words");
    const struct finished *f = shell("rsvg-convert '%s' -o '%s'", svg, other);
    if (f->code == 127)
        skip_test("an SVG seen by rsvg-convert, which is not installed");
    cr_assert_eq(f->code, 0, "%s", f->out);
    cairo_surface_t *a = image_of(png), *b = image_of(other);
    const int stride = cairo_image_surface_get_stride(a);
    cr_assert_eq(stride, cairo_image_surface_get_stride(b));
    double sum = 0;
    for (int y = 16; y < SIDE; y++) /* below the words, whose letters may be others */
        for (int i = y * stride; i < (y + 1) * stride; i++)
            sum +=
                i % 4 == 3
                    ? 0
                    : abs(cairo_image_surface_get_data(a)[i] - cairo_image_surface_get_data(b)[i]);
    cr_expect_lt(sum / (3. * (SIDE - 16) * (SIDE + 16)), 1, "%g in all", sum);
    cairo_surface_destroy(a);
    cairo_surface_destroy(b);
}
