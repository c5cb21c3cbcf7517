/* Frames for ParaView and other readers of VTK's XML files: lines with data at their points. */
#ifndef WISPLAB_VTK_H
#define WISPLAB_VTK_H

#include "frames.h"

/* Writes folder/name-0001.vtp, ..., one for each frame, and then folder/name.pvd, which names them
 * with their times. Wisps are lines through their nodes; at each node are velocity (m/s), strain
 * (of the segments at it, in the mean; 0.01 is longer by a hundredth) and radius (of the envelope,
 * the mean over its samples, m; 0 without), and each line has the number of its wisp and of the one
 * that it split off from (else its own). Returns 0 or the exit code, with one line in `reason`
 * (REASON_SIZE). */
int vtk_write(const struct frames *frames, const char *folder, const char *name, char *reason);

#endif
