/* Models of a scene: what can be chosen in them, the scene that a choice makes, and the step that
 * it is integrated with. */
#ifndef WISPLAB_NEEDS_MODEL_H
#define WISPLAB_NEEDS_MODEL_H

#include "experiments/common/plan.h"

enum thing {
    NODES,
    ENVELOPE,
    BENDING,
    STRETCHING,
    TREATMENT,
    COLLISION_RATE,
    INTERACTION_RATE,
    INTERACTIONS,
    BODIES,
    STYLE,
    SPLITS,
    THINGS
};
extern const char *const thing_names[THINGS];

enum { CHOICES = 5 };
struct option {
    double value;
    char name[40];
};

/* What there is to choose for a scene; option 0 is the full model's, if that can be run. A thing
 * that the scene does not have has no more than that one. */
struct menu {
    int count[THINGS];
    struct option option[THINGS][CHOICES];
};

/* A model: an option of each thing. */
struct choice {
    int of[THINGS];
};

/* The chosen option's value: a factor of segments, a number of samples, an enum bending, an enum
 * stretch, an enum wisp_treatment, a rate in Hz; of the rest 1 where it is there and 0 where it is
 * left out. */
double value_of(const struct menu *menu, const struct choice *choice, enum thing thing);

/* What can be chosen for a scene; with `quick`, fewer numbers of nodes. */
void make_menu(struct menu *menu, const struct scene *scene, int quick);

/* Whether another thing that is left out leaves this one without a meaning. */
int is_moot(const struct menu *menu, const struct choice *choice, enum thing thing);

/* The subject's scene over that many seconds as chosen. NULL with plan->reason where it cannot be
 * so; errno is ENOMEM where it was memory. */
const struct scene *choose_scene(struct plan *plan, const struct subject *subject, double duration,
                                 const struct menu *menu, const struct choice *choice);

/* The step for Runge-Kutta 4: this share of the longest one that linear theory allows, s. */
#define STABILITY_SHARE 0.7
double recipe_step(const struct scene *scene);

/* CPU time of a run with that step, s, roughly. */
double model_seconds(const struct scene *scene);

#endif
