/* Inside experiment circle: the panels of the thesis's figures 2.4 and 2.5, and what it says of
 * them. */
#ifndef WISPLAB_CIRCLE_PANELS_H
#define WISPLAB_CIRCLE_PANELS_H

#include "experiments/common/plan.h"

/* Plans the panels' runs. Returns 0, or -1 with plan->reason. */
int circle_plan_panels(struct plan *plan);

/* Writes the tables orbits-30s, orbits-160s and table, and states what they show. Returns 0, or -1
 * with plan->reason. */
int circle_tabulate_panels(struct plan *plan);

/* How far the particle of a row of states is from where it should be, and from the circle's centre,
 * m. */
double circle_error(const double *row);
double circle_radius(const double *row);

/* The scene of its tables, that of its first run; NULL: there is none. */
const struct scene *circle_table_scene(const struct plan *plan);

#endif
