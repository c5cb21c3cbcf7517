/* Semi-implicit backward differentiation of fixed steps, see bdf.c: for the functions of a
 * stepper_method of order 2 or 3 whose first option is `matrix`. */
#ifndef WISPLAB_BDF_H
#define WISPLAB_BDF_H

#include "semi_implicit.h"

struct stepper *bdf_create(int order, const struct stepper_settings *settings,
                           struct system *system);
int bdf_step(struct stepper *stepper, double t, double h, double *q, double *v);
const char *bdf_caution(const struct stepper *stepper);
int bdf_reset(struct stepper *stepper, unsigned lanes);
void bdf_free(struct stepper *stepper);

#endif
