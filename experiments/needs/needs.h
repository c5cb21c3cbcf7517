/* Inside experiment needs: what its runs have shown, for its tables and its answer. */
#ifndef WISPLAB_NEEDS_H
#define WISPLAB_NEEDS_H

#include "base/files.h"
#include "experiments/common/measure.h"
#include "needs_model.h"

/* A model is near that differs by less, m, rms over curves and frames. */
#define NEEDS_TARGET 1e-3

/* A model of a scene, and what its run has shown. */
enum fate { REFUSED_SCENE, RUN, CHANGED, FAILED };
struct variant {
    struct choice choice;
    enum thing thing; /* that differs from the full model; THINGS: none, or several */
    char name[40];
    enum fate fate;                /* RUN: not judged yet */
    int at;                        /* its case in the plan */
    double step;                   /* s */
    struct curve_deviation change; /* from the full model, m */
    struct cost cost;
    char note[REASON_SIZE];
};

enum { VARIANTS_MAX = 2 + THINGS * CHOICES, CHECKS = 4 };

/* Runs beside the full model's that say how far its own states can be trusted: the integrator's
 * error, and what a perturbation makes of it; and half the step for the smallest model. */
enum check { HALF_STEP, PERTURBED, SCATTERED, SMALLEST_HALF_STEP };

enum phase { FULL, SINGLES, COMBINING, CHECKING, RACING, DONE };

/* A method on the smallest model, at the setting that was tried last: a step, s, or an rtol. */
struct contender {
    const struct configuration *method;
    int place;             /* from the coarsest setting on */
    double setting, error; /* s or 1; rms over curves and frames, m */
    int at;                /* its case in the plan */
    int reached, over;     /* it is near enough; no more runs are made */
    struct cost cost;
};

struct study {
    const struct subject *subject;
    double need;     /* CPU time of all its runs over the whole scene, s, roughly */
    double duration; /* s */
    struct menu menu;
    struct variant full, own, single[VARIANTS_MAX], smallest;
    int singles;
    int check_case[CHECKS];
    double check[CHECKS]; /* rms change that it makes, m; NaN: it did not finish */
    double horizon;       /* s; NaN: a run did not finish */
    int tried;            /* combinations */
    enum phase phase;

    /* the race on the smallest model */
    const struct scene *race_scene;
    enum wisp_treatment race_treatment;
    int race_yardstick; /* the case that errors are from */
    double cheapest;    /* s, counted: more is not tried */
    struct contender
        *contender; /* in the memo, one for each of the plan's configurations at most */
    int contenders;

    char note[REASON_SIZE]; /* why there is no answer, or the full model is no finer */
};

/* The plan's memo. */
struct needs {
    int count;
    struct study study[]; /* of the plan's subjects */
};

int needs_is_full(const struct study *study, enum thing thing, int option);

/* The change that cannot be told from what a perturbation makes, m. */
double needs_noise(const struct study *study);
int needs_is_near(const struct study *study, const struct variant *variant);

/* --- needs_race.c: 0, or -1 with plan->reason --- */

/* Plans the first runs of the methods on the smallest model, whose own run is judged; errors are
 * from study->race_yardstick. */
int needs_begin_race(struct plan *plan, struct study *study);

/* Takes what their last runs have shown, and plans the next ones. */
int needs_go_on_racing(struct plan *plan, struct study *study);

/* The cheapest method that is near enough, by steps counted; NULL: none is cheaper than rk4 at its
 * longest step. */
const struct contender *needs_winner(const struct study *study);

/* tabulate of struct experiment. */
int needs_tabulate(struct plan *plan);

#endif
