/* One step of any explicit Runge-Kutta method, from its table. */
#ifndef WISPLAB_EXPLICIT_RK_H
#define WISPLAB_EXPLICIT_RK_H

#include "stepper.h"

/* For the create of a stepper_method with this table, which is explicit; and its step and free. */
struct stepper *explicit_rk_create(const struct butcher_table *table, struct system *system);
int explicit_rk_step(struct stepper *stepper, double t, double h, double *q, double *v);
void explicit_rk_free(struct stepper *stepper);

#endif
