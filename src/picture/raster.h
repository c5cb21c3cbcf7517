/* Lines painted into an image: many and short ones, each of a colour of its own, as hair has them.
 * cairo takes 1.4 to 2.1 s for the 800 000 of 500 wisps, gnuplot (which has cairo paint) 2.5 s,
 * this 0.1 s: they keep account of what each line covers, and this only asks every pixel near it
 * how far away it is. */
#ifndef WISPLAB_RASTER_H
#define WISPLAB_RASTER_H

/* An image of words 0x..rrggbb, row by row from the top, and the part of it that is painted in:
 * pixels from `left` and `top` to before `right` and `bottom`. */
struct raster {
    unsigned *pixels;
    int stride; /* words from one row to the next */
    int left, top, right, bottom;
};

/* From (x, y) to (x + dx, y + dy), pixels from the image's top left corner, with round ends. */
void raster_line(const struct raster *raster, double x, double y, double dx, double dy,
                 double width, unsigned colour);

/* Puts a picture with its lower left corner at the part's: red, green, blue and opacity, a byte
 * each, row by row from the bottom; as large as the part. */
void raster_image(const struct raster *raster, const unsigned char *pixels);

#endif
