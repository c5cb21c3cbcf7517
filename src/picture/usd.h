/* Frames for what reads Pixar's Universal Scene Description. */
#ifndef WISPLAB_USD_H
#define WISPLAB_USD_H

#include "frames.h"

/* Writes folder/name.usda, a layer of text in metres whose time codes are the frames' numbers:
 * wisps as linear BasisCurves through their nodes, as wide as their envelopes, and bodies as unit
 * Spheres that a matrix makes ellipsoids. Hairs are not in it: as text, those of 500 wisps are 30
 * MB in each frame. Returns 0 or the exit code, with one line in `reason` (REASON_SIZE). */
int usd_write(const struct frames *frames, const char *folder, const char *name, char *reason);

#endif
