/* How far a step of a method carries news, counted on the graph of couplings alone: which node's
 * acceleration depends on which others. */
#ifndef WISPLAB_GRAPH_H
#define WISPLAB_GRAPH_H

#include "integrators/stepper.h"

/* How many nodes away a node's position and its velocity are felt by a force; -1: not at all. */
struct reach {
    int position, velocity;
};

/* When the nodes of a chain first hear of a change at its last node, by node, that one's time being
 * 0: after how many steps, and how many evaluations. -1: never. */
struct arrival {
    int step, evaluations;
};

/* Steps a linear chain with these couplings, which rests but for its last node, until its first
 * node stirs or `most` steps are over. From rest nothing is rounded away: what has not heard is 0
 * exactly. `solves`: the linear systems that were solved. Returns 0, or -1 where memory cannot be
 * had, or 1 where the method does not take it. */
int graph_arrivals(const struct stepper_method *method, int nodes, struct reach reach, int most,
                   struct arrival *arrivals, int *solves);

/* A step of any method, in place, from *t on: of fixed-step methods of h. Returns 0 or its code. */
int any_step(struct stepper *stepper, double *t, double h, double *q, double *v);

/* A stepper with the defaults of its method, and the direct solver. NULL where memory cannot be
 * had or it refuses the system. */
struct stepper *any_stepper(const struct stepper_method *method, struct system *system);

#endif
