/* Every stepper, by name. */
#include "stepper.h"

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
    X(bdf2)             \
    X(bdf3)             \
    X(bdf)              \
    X(cvode)            \
    X(reference)

#define X(method) extern const struct stepper_method method;
STEPPERS(X)
#undef X

const struct stepper_method *const stepper_methods[] = {
#define X(method) &method,
    STEPPERS(X)
#undef X
        NULL,
};

const struct stepper_method *stepper_find(const char *name) {
    for (int i = 0; stepper_methods[i]; i++)
        if (strcmp(stepper_methods[i]->name, name) == 0)
            return stepper_methods[i];
    return NULL;
}
