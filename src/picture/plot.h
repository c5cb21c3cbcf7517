/* Figures, from tables, by gnuplot. */
#ifndef WISPLAB_PLOT_H
#define WISPLAB_PLOT_H

#include "base/files.h"

/* Draws every figure of an experiment as .svg and .png beside its tables in `folder`, with
 * plots/NAME.gp, all together or none, and then its diagnoses. Returns 0, or -1 with one line in
 * `reason`. */
int plot_experiment(const char *name, const char *folder, char *reason);

/* Draws each diagnostics*.tsv in `folder`: a run's, or those that an experiment kept. Returns 1, 0
 * where there are none, or -1 with one line in `reason`. */
int plot_diagnostics(const char *folder, char *reason);

/* What plots/style.gp does for paper: "survey" or "draw" (it says what they are), and a script that
 * it loads. */
struct plot_paper {
    const char *task, *layout;
};

/* The steps of that, for other drawings. One gnuplot over plots/NAME.gp, which finds its data in
 * `folder` and writes figures of one format, "svg" or "png", or "pdf" for paper (NULL: for the
 * screen), into the folder `to`. Returns 0, or -1 with one line in `reason`. Threads may call it
 * side by side, with folders of their own. */
int plot_draw(const char *name, const char *folder, const char *to, const struct plot_paper *paper,
              const char *format, char *reason);

/* Moves every file of `from` into `to`, or removes them where `to` is NULL; then the folder `from`.
 * Returns 0, or -1 with one line in `reason`. */
int plot_empty_folder(const char *from, const char *to, char *reason);

#endif
