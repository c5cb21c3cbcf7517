/* The envelope's plane at one node, and the hairs that go through it (figures 4.4 to 4.6 of the
 * thesis): drawn as it is, whatever the camera. */
#ifndef WISPLAB_PLANE_H
#define WISPLAB_PLANE_H

#include "picture.h"

/* How far out its samples ever are in a run's frames, m. */
double plane_extent(const struct frames *frames, int wisp, int node);

/* Adds to a picture the lines to the samples and these, rim and rest shape, and the hairs with the
 * ways that they have gone from where they are in the rest shape. */
void plane_draw(struct picture *picture, const struct drawing *drawing, int frame);

#endif
