/* The plain loop: a wisp's skeleton with skip springs as one writes it when there is no program
 * yet, one wisp, one scalar after the other. What a general program is measured against. */
#ifndef WISPLAB_PLAIN_CHAIN_H
#define WISPLAB_PLAIN_CHAIN_H

#include "wisp/wisp.h"

enum { CHAIN_NODES_MAX = 64, CHAIN_SIZE_MAX = 3 * CHAIN_NODES_MAX };

struct chain {
    int nodes, size; /* size: 3 numbers for each free node */
    double spacing, gravity[3], drag_rate;
    double stretch, stretch_damping, bend,
        bend_damping; /* k, c of a segment and of a skip spring */
    double inverse_mass[CHAIN_NODES_MAX];
    double head[2][3];        /* nodes 0 and 1 */
    double q[CHAIN_SIZE_MAX]; /* the start: straight, at rest */
};

/* Makes a chain of a wisp without envelope, with skip springs, no wind, no style and a head at
 * rest. */
void chain_init(struct chain *chain, const struct wisp *wisp,
                const struct surroundings *surroundings);

/* a <- accelerations of the free nodes at (q, v): x y z of nodes 2, 3, ... */
void chain_acceleration(const struct chain *chain, const double *q, const double *v, double *a);

/* One step of h, in place. */
void chain_euler(const struct chain *chain, double h, double *q, double *v);
void chain_rk4(const struct chain *chain, double h, double *q, double *v);

#endif
