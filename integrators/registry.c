/* Every stepper, by name. */
#include "stepper.h"

#include <stdlib.h>
#include <string.h>

/* A new stepper is one line here, at its place in lists and legends. */
#define STEPPERS(X)     \
    X(euler)            \
    X(midpoint)         \
    X(rk4)              \
    X(symplectic_euler) \
    X(drift_kick)       \
    X(implicit_euler)   \
    X(linear_euler)     \
    X(exponential)      \
    X(xpbd)             \
    X(arkode_erk)       \
    X(arkode_dirk)      \
    X(arkode_imex)      \
    X(bdf2)             \
    X(bdf3)             \
    X(bdf)              \
    X(cvode)            \
    X(reference)

#define X(method) extern const struct stepper_method method;
STEPPERS(X)
#undef X

static const struct stepper_method *const built_in[] = {
#define X(method) &method,
    STEPPERS(X)
#undef X
        NULL,
};

const struct stepper_method *const *stepper_methods = built_in;

int stepper_add(const struct stepper_method *method) {
    size_t count = 0;
    while (stepper_methods[count])
        count++;
    const struct stepper_method **longer = calloc(count + 2, sizeof *longer);
    if (!longer)
        return -1;
    memcpy(longer, stepper_methods, count * sizeof *longer);
    longer[count] = method;
    if (stepper_methods != built_in)
        free((void *)stepper_methods);
    stepper_methods = longer;
    return 0;
}

const struct stepper_method *stepper_find(const char *name) {
    for (int i = 0; stepper_methods[i]; i++)
        if (strcmp(stepper_methods[i]->name, name) == 0)
            return stepper_methods[i];
    return NULL;
}
