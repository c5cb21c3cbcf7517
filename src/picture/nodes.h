/* What is shown at a node besides where it is. */
#ifndef WISPLAB_NODES_H
#define WISPLAB_NODES_H

#include "wisp/strand.h"

/* The mean strain of the segments at a node: 0.01 is longer by a hundredth. */
double node_strain(const struct strand *strand, int node);

/* The envelope's radius, the mean over its samples, m; 0 without one. */
double node_radius(const struct strand *strand, int node);

/* A point of the envelope's rim in its plane, `turn` of the way round. */
void node_rim(const struct strand *strand, int node, double turn, double point[3]);

#endif
