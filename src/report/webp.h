/* The page's pictures of hair as WebP: a fifth of what they are as PNG, and nobody sees it. */
#ifndef WISPLAB_WEBP_H
#define WISPLAB_WEBP_H

#include <stddef.h>

struct webp {
    unsigned char *bytes;
    size_t count;
    int width, height; /* pixels */
};

/* The picture of a .png file, or where it is a sheet of so many frames below each other the last of
 * them, coded with a quality from 0 to 100; to be freed if that went well. Returns 0, or -1 with
 * one line in `reason`. */
int webp_of_png(struct webp *webp, const char *path, int frames, double quality, char *reason);
void webp_free(struct webp *webp);

#endif
