/* A scene brought to life: the parts that steppers advance, and what the rest of the program may
 * ask of them. What differs from problem to problem (the circle, wisps) is behind struct problem.
 */
#ifndef WISPLAB_MODEL_H
#define WISPLAB_MODEL_H

#include "base/workers.h"
#include "diagnosis.h"
#include "integrators/stepper.h"
#include "system/system.h"

struct scene;

/* The unit of advance: one system and its state. Parts do not see each other between stops. */
struct part {
    struct system system;
    double *q, *v;           /* system.size doubles each, owned by the model */
    struct account *account; /* of the energy, owned by who asks for it; NULL: none is kept */
};

struct model {
    const struct problem *problem;
    double t;                          /* of the state, s: kept by who advances it */
    const struct diagnosis *diagnosis; /* of a frame while it is shown, likewise; or NULL */
    struct workers *workers;           /* who share the work on such a frame, likewise; or NULL */
    struct part *parts;
    int part_count;
    int parts_to_come;          /* that ticks may add to those at the start, at most */
    int row_count;              /* of a frame: one per wisp and node */
    int rows_to_come;           /* likewise */
    const int *parent;          /* by wisp: the one that it split off from, or itself */
    const char *const *columns; /* of a frame's rows, after `t`; NULL-terminated */
    int column_count;
    const char *const *rate_columns; /* of the accelerations, likewise */
    int rate_column_count;
    double collision_rate;   /* Hz of ticks at which `tick` has work; 0: never */
    double interaction_rate; /* likewise, of those between wisps */
    const char *trouble;     /* why the last tick could not be completed, of a part; or NULL */
    int ticks_alone;     /* whether at ticks of the first kind a part needs no other: tick_part */
    const double *kinks; /* times at which the forces have one, s, ascending */
    int kink_count;
};

/* What an unknown is: a coordinate of a node, or of a sample at it. */
struct unknown {
    int wisp, node;
    const char *name; /* of the column of a frame that it fills, where there is one */
    const char *unit; /* its velocity's is that over s */
};

/* How a constraint is kept; an index into a problem's list. */
struct treatment {
    const char *name, *summary;
};

struct problem {
    const char *name;                   /* the scene's `problem` */
    const struct treatment *treatments; /* ends with a name of NULL */

    /* What runs where nothing is said: an index of `treatments`, and the name of a linear solver.
     */
    int (*default_treatment)(const struct stepper_method *method);
    const char *(*default_linear)(const struct stepper_method *method);

    /* The scene at its begin in parts of at most `lanes` wisps; NULL where memory cannot be had. */
    struct model *(*create)(const struct scene *scene, int treatment, int lanes);
    void (*free)(struct model *model);

    /* With how many lanes a scene is fastest on this machine; NULL: that is not known. */
    int (*lanes)(const struct scene *scene);

    /* Writes the current state as row_count rows of column_count numbers. */
    void (*sample)(const struct model *model, double *rows);

    /* Takes a state from rows as `frame` writes them; NULL where states cannot be loaded. */
    void (*restore)(struct model *model, const double *rows);

    /* Puts the state onto a constraint that it may have been set off from a little; what is too far
     * from it stays as it is, and steps will say so. NULL: there is none that states can be off. */
    void (*project)(struct model *model);

    /* Writes accelerations, given by part in the layout of v, as row_count rows of
     * rate_column_count numbers. */
    void (*sample_accelerations)(const struct model *model, double *const *a, double *rows);

    /* What unknown k of part i is; what it names stays as long as the model. */
    struct unknown (*unknown)(const struct model *model, int i, int k);

    /* The force terms that a scene has, by name, at most `most` of them; returns their number.
     * NULL: no names. */
    int (*terms)(const struct scene *scene, const char **names, int most);

    /* What happens at a stop besides the smooth motion; sets in changed[i] the bits of those lanes
     * of part i whose state is no longer what its stepper left. New parts come after the others,
     * which stay where they are; `changed` has room for all to come. The workers, or NULL, share
     * the work; what happens does not depend on them. Returns FINISHED, or why the run cannot go
     * on: OUT_OF_MEMORY, or what model->trouble tells more of. NULL: nothing. */
    enum outcome (*tick)(struct model *model, struct workers *workers, unsigned events,
                         int *changed);

    /* What `tick` does to part i at a stop that is nothing but a STOP_COLLISION (or a frame, or the
     * end) where the model's parts tick alone: returns the bits of the lanes whose state is no
     * longer what the stepper left. For different parts, from different threads. */
    unsigned (*tick_part)(struct model *model, int i, double t);

    /* By how much a state can be wrong and finite: the largest strain in part i at time t where
     * that is above `limit`, with the wisp that has it, else 0. NULL: nobody can say. */
    double (*strain)(const struct model *model, int i, double t, double limit, int *wisp);

    /* Which strain a run may have where nothing is said; NULL likewise. */
    double (*strain_limit)(const struct scene *scene);

    /* Extremes of a frame's rows. Returns 0 or OUT_OF_MEMORY. NULL: there are no diagnoses; else
     * the systems have energies and powers. */
    int (*extremes)(const struct model *model, const double *rows, struct extremes *extremes);
};

#endif
