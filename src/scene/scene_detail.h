/* A scene's hair with other numbers of nodes and samples. */
#ifndef WISPLAB_SCENE_DETAIL_H
#define WISPLAB_SCENE_DETAIL_H

#include "scene_load.h"

/* round(factor (nodes - 1)) + 1, but at least 3. */
int detailed_nodes(int nodes, double factor);

/* Makes of a scene what it would be with detailed_nodes() and so many samples per node; 0 takes the
 * envelope away, and with it subdivision.
 *
 * The free hair stays the same: it begins at node 1, which stays where it is in the head, and its
 * length is shared out anew, so that only the root, a new segment's length behind node 1, moves.
 * (With a root that stays, shorter segments would also mean that the head holds less of the hair.)
 *
 * A start is carried over: new nodes go along the old chain at equal parts of its length, a
 * segment's length at rest apart, so that no spring is stretched by it; velocities and the samples'
 * distances are interpolated along the chain and around it.
 *
 * Returns 0, or -1 with one line in `reason` (REASON_SIZE), where the scene cannot be so; errno is
 * ENOMEM where it was memory. After a failure the scene is good for scene_free only. */
int scene_set_detail(struct scene *scene, double factor, int samples, char *reason);

#endif
