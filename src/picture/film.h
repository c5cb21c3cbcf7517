/* Films of pictures that are there as files: GIF by gnuplot, MP4 where ffmpeg is installed. */
#ifndef WISPLAB_FILM_H
#define WISPLAB_FILM_H

#include "base/files.h"

struct film {
    char (*pictures)[PATH_SIZE]; /* paths of png files of one size, in order */
    int count;
    int width, height; /* pixels */
    double rate;       /* pictures a second */
};

/* Writes folder/name.gif, and folder/name.mp4 where it can; *mp4 says whether it could. Returns 0
 * or the exit code, with one line in `reason` (REASON_SIZE). */
int film_write(const struct film *film, const char *folder, const char *name, int *mp4,
               char *reason);

#endif
