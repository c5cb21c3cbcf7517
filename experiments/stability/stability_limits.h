/* Inside experiment stability: the searches for the longest stable step on wisps. */
#ifndef WISPLAB_STABILITY_LIMITS_H
#define WISPLAB_STABILITY_LIMITS_H

#include "base/files.h"
#include "stability.h"

enum { VALUES_MAX = 6, AXES = 4 };

/* What is varied, on which scene, and by which setting. */
struct axis {
    const char *name, *scene, *setting;
    enum wisp_treatment treatment;
    int values;
    double value[VALUES_MAX];
};
extern const struct axis limits_axes[AXES];

/* What a stable step may be besides, from the least to the most: within a twentieth of the wisp's
 * length, within a millimetre (rms over free nodes and frames); and apart from these, of the
 * method's order: its error is at most ten times what the order makes of that at the anchor. */
enum aim_kind { NEAR, MILLIMETRE, IN_ORDER, AIMS };
struct aim {
    struct bracket place; /* reached: of the longest step, or -1 */
    double error;         /* of that, m */
    int timed;            /* its case in the plan, or -1 */
    struct cost cost;
};

enum phase { ANCHORING, SEARCHING, AIMING, TIMING, DONE };

/* One method in one cell. */
struct trial {
    const struct configuration *configuration;
    double predicted; /* step, s; NaN: no prediction */
    enum phase phase;
    struct bracket place; /* reached: of the longest stable step, or -1 */
    int run;              /* its last case in the plan */
    double anchor_step, anchor_error;
    struct verdict missed; /* of the finest place that fails */
    double error;          /* of the coarsest that does not, m */
    struct cost cost;      /* of its timed run */
    enum aim_kind aiming;
    struct aim aims[AIMS];
    char note[REASON_SIZE];
};

/* A scene with a treatment, and the methods on it. */
struct cell {
    const struct scene *scene;
    enum wisp_treatment treatment;
    const struct axis *axis; /* NULL: a whole scene */
    double value;
    const char *subject;  /* its name; of a whole scene */
    char name[96];        /* of its runs */
    int reference;        /* its case in the plan */
    struct trial *trials; /* at most one for each of the plan's configurations; in the memo */
    int trial_count;
};

/* The plan's memo. */
struct limits {
    int cell_count;
    struct cell cells[];
};

/* Whether the budget lets a whole scene run for less than the others. */
int limits_is_cut(const struct plan *plan, const struct cell *cell);

/* --- stability_tables.c --- */

/* States how long a method's steps may be in a cell of a whole scene, and what happens beyond. */
void limits_state_trial(struct statements *statements, const struct cell *cell,
                        const struct trial *trial, enum question answers);

/* --- cell.c --- */

/* Places of a cell to the octave of steps. */
enum { LIMITS_STRIDE = 24 };

/* The step of a place in a cell, s; NaN of a place below 0. */
double limits_step(const struct cell *cell, int place);

/* The coarsest place of which the step is at most `step`. */
int limits_place(const struct cell *cell, double step);

const char *limits_treatment(const struct cell *cell);
struct run_request limits_request(const struct cell *cell,
                                  const struct configuration *configuration, double step);

/* The error, m, that a step may have for an aim. */
double limits_allowed(const struct cell *cell, const struct trial *trial, enum aim_kind aim,
                      double step);

/* --- stability_trial.c --- */

/* The rtol of adaptive methods, which choose their steps and are only timed. */
#define LIMITS_TOLERANCE 1e-3

/* Adds the trial of a method to a cell whose modes are these, or NULL, and its first run to
 * the plan. A method that refuses the scene is done, and the note says why. 0, or -1 with
 * plan->reason. */
int limits_begin(struct plan *plan, struct cell *cell, const struct configuration *configuration,
                 const struct mode_rate *modes, int mode_count);

/* Takes what the trial's last run has shown, and plans its next one. 0, or -1 with plan->reason. */
int limits_go_on(struct plan *plan, const struct cell *cell, struct trial *trial,
                 const struct run_files *reference);

/* --- stability_failures.c: 0, or -1 with plan->reason --- */

/* Plans runs on either side of the limits of `swing`, at round rates. */
int limits_plan_known(struct plan *plan, const struct cell *cell);

/* Plans runs above the limit that a trial has found. */
int limits_plan_failures(struct plan *plan, const struct cell *cell, const struct trial *trial);

/* Writes the table failures. */
int limits_write_failures(struct plan *plan);

#endif
