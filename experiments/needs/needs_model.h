/* Models of a scene: what can be chosen in them, the scene that a choice makes, and the step that
 * it is integrated with. */
#ifndef WISPLAB_NEEDS_MODEL_H
#define WISPLAB_NEEDS_MODEL_H

#include "experiments/common/plan.h"

/* Y(X, symbol, name, meaning of its option). */
#define EACH_THING(Y, X)                                                    \
    Y(X, NODES, "nodes", "number of nodes")                                 \
    Y(X, ENVELOPE, "envelope", "samples of the envelope")                   \
    Y(X, BENDING, "bending law", "law of bending")                          \
    Y(X, STRETCHING, "stretching", "springs or rigid segments")             \
    Y(X, TREATMENT, "treatment", "how samples are kept on their lines")     \
    Y(X, COLLISION_RATE, "body contact rate", "rate of the bodies' ticks")  \
    Y(X, INTERACTION_RATE, "wisp contact rate", "rate of the wisps' ticks") \
    Y(X, INTERACTIONS, "wisp contact", "what wisps do to each other")       \
    Y(X, BODIES, "bodies", "whether and how bodies act")                    \
    Y(X, STYLE, "style field", "whether there is one")                      \
    Y(X, SPLITS, "subdivision", "whether there is one")

enum thing {
#define Y(X, symbol, name, meaning) symbol,
    EACH_THING(Y, )
#undef Y
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

enum { AT_TICKS = 1 };

/* The chosen option's value: a factor of segments, a number of samples, an enum bending, an enum
 * stretch, an enum wisp_treatment, a rate in Hz; of bodies AT_TICKS, the frequency in Hz with which
 * they push by penalty, or 0; of the rest 1 where it is there and 0 where it is left out. */

double value_of(const struct menu *menu, const struct choice *choice, enum thing thing);

/* What can be chosen for a scene; with `quick`, fewer numbers of nodes. */
void make_menu(struct menu *menu, const struct scene *scene, int quick);

/* Whether a thing has a meaning: it has none where what it belongs to is left out. */
int applies(const struct menu *menu, const struct choice *choice, enum thing thing);

/* The subject's scene over that many seconds as chosen. NULL with plan->reason where it cannot be
 * so; errno is ENOMEM where it was memory. */
const struct scene *choose_scene(struct plan *plan, const struct subject *subject, double duration,
                                 const struct menu *menu, const struct choice *choice);

/* The step for Runge-Kutta 4: this share of the longest one that linear theory allows, s. */
#define STABILITY_SHARE 0.7
double recipe_step(const struct scene *scene);

/* Whether steps of a method are worth a try: no more than twice what linear theory allows, where it
 * says anything. */
int may_hold(const struct scene *scene, const struct stepper_method *method, double step);

/* CPU time of a run with that step, s, roughly. */
double model_seconds(const struct scene *scene);

#endif
