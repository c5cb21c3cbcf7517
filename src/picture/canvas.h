/* A page to draw on, which becomes a PNG (by cairo, and raster.h) or an SVG, whose words stay
 * words. Drawing on a page for which there is no memory is without effect; canvas_write says so.
 * Several threads may draw, each on a page of its own. */
#ifndef WISPLAB_CANVAS_H
#define WISPLAB_CANVAS_H

struct canvas;

enum { CANVAS_SIDE_MOST = 32767 }; /* pixels of a PNG: cairo's */

/* A white page of so many pixels; NULL where memory cannot be had. */
struct canvas *canvas_create(int width, int height, int as_svg);
void canvas_free(struct canvas *canvas);

struct canvas_text {
    double x, y; /* pixels from the top left corner: of the text's left end or middle; its middle */
    double size; /* of the letters, pixels */
    int bold, centred;
    unsigned colour; /* 0xrrggbb */
};

void canvas_text(struct canvas *canvas, const struct canvas_text *how, const char *text);

/* Opens a window with its top left corner there. Until it is closed nothing is drawn outside of it,
 * and places are pixels from its lower left corner, y upwards. */
void canvas_window(struct canvas *canvas, int left, int top, int width, int height);
void canvas_window_end(struct canvas *canvas);

/* Fills the window with a picture of its size: red, green, blue, opacity, row by row from the
 * bottom. */
void canvas_image(struct canvas *canvas, const unsigned char *pixels);

/* Lines that follow are so wide, pixels; their ends are round. */
void canvas_pen(struct canvas *canvas, double width);
void canvas_line(struct canvas *canvas, double x, double y, double dx, double dy, unsigned colour);

void canvas_polygon(struct canvas *canvas, const double (*corners)[2], int count, unsigned colour);

/* Writes the page whole or not at all. Returns 0, or -1 with one line in `reason`. */
int canvas_write(struct canvas *canvas, const char *path, char *reason);

#endif
