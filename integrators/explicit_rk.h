/* One step of any explicit Runge-Kutta method, from its table. */
#ifndef WISPLAB_EXPLICIT_RK_H
#define WISPLAB_EXPLICIT_RK_H

#include "stepper.h"

/* The create, step and free of a stepper_method whose `table` is explicit. */
struct stepper *explicit_rk_create(const struct stepper_settings *settings, struct system *system);
int explicit_rk_step(struct stepper *stepper, double t, double h, double *q, double *v);
void explicit_rk_free(struct stepper *stepper);

#endif
