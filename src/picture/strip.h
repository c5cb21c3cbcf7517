/* Pages of pictures: rows are runs, columns are frames, all seen by the first run's camera. One run
 * at one frame is a page too. */
#ifndef WISPLAB_STRIP_H
#define WISPLAB_STRIP_H

#include "picture.h"

struct strip_row {
    const char *label;  /* left of the row; empty: none; NULL: the stepper, of several runs */
    const char *states; /* path of a states.tsv with its run.json beside it */
    const struct scene *scene; /* for its name and camera; NULL: as run.json has them */
};

/* What is wanted; numbers that are 0 have defaults. */
struct strip_request {
    const struct strip_row *rows;
    int row_count;
    const char *const *sets; /* changes to the runs' scenes, as in scene_load: render={...} */
    int set_count;
    unsigned views;          /* bits of enum view */
    struct plane_view plane; /* of VIEW_PLANE; its extent is found */
    const char *title;       /* NULL: the scene's name, and of one run its stepper */
    int width, height;       /* of a panel, pixels; 320 x 240 */
    double scale;            /* by which both are multiplied; 0: 1 */
    int columns;             /* panels of a run in one row; 0: as in struct layout */
    int beside;              /* runs stand beside each other, each with its label above */
    int untitled;            /* no title above all */
    int large, large_row;    /* another frame, of one run, shown large left of all; 0: none */
    const char *reference;   /* states from which the distance is shown as colour, or NULL */
    int error_frame; /* whose largest distance the scale of colours ends with; 0: all have it */
    struct trajectories *trajectories; /* that have read the states, or will; NULL: nobody has */
};

struct strip;

/* Reads the runs. Returns NULL with one line in `reason` (REASON_SIZE), and in *code the exit code:
 * 1 for what is wrong with the input, 2 for the machine. */
struct strip *strip_create(const struct strip_request *request, int *code, char *reason);
void strip_free(struct strip *strip);

/* Frames that all its runs have. */
int strip_frames(const struct strip *strip);

/* The name of the scene of the first run. */
const char *strip_name(const struct strip *strip);

/* Pixels of a page of so many frames. */
void strip_size(const struct strip *strip, int count, int *width, int *height);

/* Whether a page of so many frames can be written. Returns 0, or 1 with one line in `reason`: what
 * is too large, and what would do. */
int strip_check_size(const struct strip *strip, int count, const char *format, char *reason);

/* Writes a page with these frames (numbered from 1) as folder/name.png or .svg, by `format` "png"
 * or "svg"; it appears whole or not at all. Returns 0 or the exit code, with one line in `reason`.
 * Several threads may write pages of one strip. */
int strip_write(const struct strip *strip, const int *frames, int count, const char *folder,
                const char *name, const char *format, char *reason);

/* All of that, as png: for experiments. */
int strip_draw(const struct strip_request *request, const int *frames, int count,
               const char *folder, const char *name, char *reason);

#endif
