/* Frames as rows of a table, which the workers write side by side. */
#ifndef WISPLAB_FRAME_TEXT_H
#define WISPLAB_FRAME_TEXT_H

#include "model/model.h"

#include <stdio.h>

/* What a frame is written into before it goes to a file; all zero before the first. */
struct frame_text {
    char *room; /* owned */
    size_t size;
};

/* A row for each of the model's: t, its numbers, whom its wisp split off from. Returns 0, or -1
 * where memory cannot be had; whether the file took it is for who asks the stream. */
int frame_text_write(struct frame_text *text, FILE *stream, const struct model *model, double t,
                     const double *rows);
void frame_text_free(struct frame_text *text);

#endif
