/* Figures, from tables, by gnuplot. */
#ifndef WISPLAB_PLOT_H
#define WISPLAB_PLOT_H

#include "files.h"

/* Draws every figure of an experiment as .svg and .png beside its tables in `folder`, with
 * plots/NAME.gp, all together or none, and then its diagnoses. Returns 0, or -1 with one line in
 * `reason`. */
int plot_experiment(const char *name, const char *folder, char *reason);

/* Draws each diagnostics*.tsv in `folder`: a run's, or those that an experiment kept. Returns 1, 0
 * where there are none, or -1 with one line in `reason`. */
int plot_diagnostics(const char *folder, char *reason);

#endif
