#include "registry.h"

#include <string.h>

/* A new experiment is one file and one line here. */
#define EXPERIMENTS(X) \
    X(circle)          \
    X(treatments)      \
    X(work_precision)  \
    X(solvers)         \
    X(horizon)         \
    X(ladder)          \
    X(history)         \
    X(stability)       \
    X(needs)           \
    X(radii)           \
    X(interactions)    \
    X(viscosity)       \
    X(sphere)          \
    X(subdivision)     \
    X(wind)            \
    X(shake)           \
    X(chapter5)        \
    X(speed)           \
    X(kernel)          \
    X(contact_rate)

#define X(name) extern const struct experiment name##_experiment;
EXPERIMENTS(X)
#undef X

const struct experiment *const experiments[] = {
#define X(name) &name##_experiment,
    EXPERIMENTS(X)
#undef X
        NULL,
};

const struct experiment *experiment_find(const char *name) {
    for (int i = 0; experiments[i]; i++)
        if (strcmp(experiments[i]->name, name) == 0)
            return experiments[i];
    return NULL;
}
