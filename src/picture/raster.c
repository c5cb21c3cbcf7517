#include "raster.h"

#include <math.h>

/* `part` of the colour over what is there, from 0 to 256. */
static unsigned blend(unsigned below, unsigned colour, unsigned part) {
    const unsigned two = 0xFF00FF, one = 0x00FF00; /* red and blue at once: 8 bits are between */
    const unsigned left = 256 - part;
    return ((((below & two) * left + (colour & two) * part) >> 8) & two) |
           ((((below & one) * left + (colour & one) * part) >> 8) & one);
}

/* From where pixel centres may be nearer than `reach` to a line, and to before where. */
static int first_pixel(double a, double b, double reach, int least) {
    const double first = ceil((a < b ? a : b) - reach - 0.5);
    return first > least ? (int)first : least;
}

static int last_pixel(double a, double b, double reach, int most) {
    const double last = floor((a > b ? a : b) + reach - 0.5) + 1;
    return last < most ? (int)last : most;
}

/* A pixel is covered by as much of its width as is on this side of the line's edge, half the line's
 * width from its axis: exact for a line along rows or columns. */
void raster_line(const struct raster *raster, double x, double y, double dx, double dy,
                 double width, unsigned colour) {
    const double reach = 0.5 * width + 0.5, square = dx * dx + dy * dy,
                 part = square > 0 ? 1 / square : 0;
    const int left = first_pixel(x, x + dx, reach, raster->left),
              right = last_pixel(x, x + dx, reach, raster->right),
              top = first_pixel(y, y + dy, reach, raster->top),
              bottom = last_pixel(y, y + dy, reach, raster->bottom);
    for (int row = top; row < bottom; row++) {
        unsigned *pixel = raster->pixels + (long)row * raster->stride;
        const double below = row + 0.5 - y;
        for (int column = left; column < right; column++) {
            const double beside = column + 0.5 - x, along = (beside * dx + below * dy) * part,
                         s = along < 0   ? 0
                             : along > 1 ? 1
                                         : along,
                         across = beside - s * dx, down = below - s * dy,
                         distance = across * across + down * down;
            if (distance >= reach * reach)
                continue;
            const double covered = reach - sqrt(distance);
            pixel[column] =
                blend(pixel[column], colour, covered < 1 ? (unsigned)(256 * covered) : 256);
        }
    }
}

void raster_image(const struct raster *raster, const unsigned char *pixels) {
    for (int row = raster->bottom - 1; row >= raster->top; row--)
        for (int column = raster->left; column < raster->right; column++, pixels += 4) {
            unsigned *pixel = raster->pixels + (long)row * raster->stride + column;
            const unsigned colour =
                (unsigned)pixels[0] << 16 | (unsigned)pixels[1] << 8 | pixels[2];
            *pixel = blend(*pixel, colour, pixels[3] + (pixels[3] >= 128 ? 1u : 0u));
        }
}
