/* Frames as rows of a numpy file. */
#ifndef WISPLAB_FRAME_BINARY_H
#define WISPLAB_FRAME_BINARY_H

#include "model/model.h"

#include <stdio.h>

/* The columns of the text: t, the model's, parent. Returns 0, or -1 where memory cannot be had. */
int frame_binary_begin(FILE *stream, const struct model *model);

/* A row for each of the model's; errors are the stream's. */
void frame_binary_write(FILE *stream, const struct model *model, double t, const double *rows);

#endif
