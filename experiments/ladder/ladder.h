/* What a millimetre costs along stretch stiffness: the cells that are tried, the searches in them,
 * and who writes what of them. */
#ifndef WISPLAB_LADDER_H
#define WISPLAB_LADDER_H

#include "experiments/common/search.h"
#include "experiments/common/statements.h"

/* A kind of hair, of which a panel of a figure shows the cost along its stiffness. */
struct hair {
    const char *name;    /* in tables */
    const char *phrase;  /* in sentences, after "of" */
    const char *scene;   /* of the experiment's own; NULL: the one asked for */
    const char *sets[3]; /* overrides; NULL: no more */
    double detail;       /* segments over those of the scene; 0: the same */
    double most;         /* EA, N, beyond which nobody waits for a reference solution; 0: none */
    double damping;      /* of the highest stretch mode; 0: the scene's stretch_time */
    int rigid;           /* of infinite stiffness: no other has a meaning */
    int quick_from, quick_end; /* of the stiffnesses, those that --quick has */
    const char *figure;        /* without .svg */
};

/* One kind of hair at one stiffness. The cells of a kind follow each other from soft to stiff. */
struct cell {
    const struct hair *hair;
    double stiffness; /* EA, N; infinite: the segments are rigid */
    double damping;   /* of the highest stretch mode; NaN where there is none */
};

/* What a search waits for: a run at a place, more that confirm it, the timing of the best. */
enum phase { TRYING, CONFIRMING, TIMING, DONE };

/* The search of one configuration in one cell: for the largest setting that reaches the target. */
struct search {
    const struct configuration *configuration;
    int cell;
    enum phase phase;
    struct bracket place;
    double first_error;          /* of the first run of a place, while others confirm it */
    int first, count;            /* its runs in the plan */
    double missed_error, error;  /* there, m; of adaptive methods the worst of the jittered runs */
    enum outcome missed_outcome; /* of the run that missed */
    double missed_time;          /* of a failure: when, s */
    struct cost cost; /* of the last run within the target; in the end of the timed one */
    int refused;      /* it cannot run here; the note says why */
    char note[REASON_SIZE];
};

/* The plan's memo; its cell i is of plan->subjects[i]. */
enum { LADDER_CELLS = 64 };
struct ladder {
    int cell_count;
    struct cell cell[LADDER_CELLS];
    int count;
    struct search search[]; /* at most one for each cell and configuration */
};

#define LADDER_TARGET 1e-3 /* m, rms over the free nodes and all frames */

/* How many tolerances that differ in the twelfth digit an adaptive method's error is the worst of;
 * of costly ones it is the only one's. */
enum { JITTERED = 5, JITTERED_QUICK = 3 };

/* --- ladder_cells.c --- */

/* Makes the cells, and their scenes the plan's subjects, called "default, EA 90 N", or of rigid
 * segments by their hair's name. Returns 0, or -1 with plan->reason. */
int ladder_cells(struct plan *plan, struct ladder *ladder);

/* Whether a cell's kind is the one of the cell before it. */
int ladder_goes_on(const struct ladder *ladder, int cell);

/* --- ladder.c --- */

/* The step, s, or tolerance of a place; NaN where it is negative. */
double ladder_setting(const struct plan *plan, const struct search *s, int place);

/* --- ladder_tables.c --- */

/* The search of a configuration in a cell; NULL: there is none. */
const struct search *ladder_search(const struct ladder *ladder, int cell,
                                   const struct configuration *configuration);

/* Whether it has reached the target and was timed; s may be NULL. */
int ladder_has_cost(const struct search *s);

/* Whether one of the two is known to be cheaper. */
int ladder_is_apart(const struct search *a, const struct search *b);

/* Where two costs that are straight lines in logarithms are equal, between two stiffnesses, N; NaN
 * where they keep their order. */
double ladder_crossing(const double stiffness[2], const double a[2], const double b[2]);

/* Writes the tables. Returns 0, or -1 with plan->reason. */
int ladder_write(struct plan *plan);

/* --- ladder_statements.c --- */

/* Returns 0, or -1 with plan->reason. */
int ladder_state(struct statements *statements, struct plan *plan);

#endif
