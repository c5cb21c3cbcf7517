/* All experiments. */
#ifndef WISPLAB_EXPERIMENTS_REGISTRY_H
#define WISPLAB_EXPERIMENTS_REGISTRY_H

#include "experiments/common/plan.h"

/* In the order of lists; NULL-terminated. */
extern const struct experiment *const experiments[];

/* The one of that name, or NULL. */
const struct experiment *experiment_find(const char *name);

#endif
