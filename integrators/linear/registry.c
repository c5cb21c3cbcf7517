/* Every linear solver, by name. */
#include "linear.h"

#include <string.h>

/* A new solver is one line here. */
#define SOLVERS(X)         \
    X(direct)              \
    X(conjugate_gradients) \
    X(klu)                 \
    X(cholmod)

#define X(method) extern const struct linear_method method;
SOLVERS(X)
#undef X

const struct linear_method *const linear_methods[] = {
#define X(method) &method,
    SOLVERS(X)
#undef X
        NULL,
};

const struct linear_method *linear_find(const char *name) {
    for (int i = 0; linear_methods[i]; i++)
        if (strcmp(linear_methods[i]->name, name) == 0)
            return linear_methods[i];
    return NULL;
}
