/* Frames for ParaView and other readers of VTK's XML files. */
#ifndef WISPLAB_VTK_H
#define WISPLAB_VTK_H

#include "frames.h"

/* Writes a series of .vtp files for each thing that the scene has, one for each frame, and a .pvd
 * that names them with their times, to be opened in ParaView:
 *
 *   name.pvd            wisps as lines through their nodes, with velocity (m/s), strain (of the
 *                       segments at a node, in the mean; 0.01 is longer by a hundredth) and radius
 *                       (of the envelope, the mean over its samples, m; 0 without) at each node
 *   name-envelopes.pvd  the surfaces through the rims of their sections
 *   name-hairs.pvd      the hairs that pictures show, as lines
 *   name-bodies.pvd     the bodies as meshes
 *
 * Each line or surface has the number of its wisp, and of the one that it split off from (else its
 * own); each face of a body the body's. Returns 0 or the exit code, with one line in `reason`
 * (REASON_SIZE). */
int vtk_write(const struct frames *frames, const char *folder, const char *name, char *reason);

#endif
