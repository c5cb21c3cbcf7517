/* Figures, from tables, by gnuplot. */
#ifndef WISPLAB_PLOT_H
#define WISPLAB_PLOT_H

#include "files.h"

/* Draws every figure of an experiment as .svg and .png beside its tables in `folder`, with
 * plots/NAME.gp. All appear together or none does. Returns 0, or -1 with one line in `reason`. */
int plot_experiment(const char *name, const char *folder, char *reason);

#endif
