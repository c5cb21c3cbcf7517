/* Every stepper and every linear solver, by name. A new one is one line here. */
#include "stepper.h"

#include <stdio.h>
#include <string.h>

extern const struct stepper_method euler, midpoint, rk4, implicit_euler, cvode, reference;
extern const struct linear_method direct, conjugate_gradients, klu, cholmod;

const struct stepper_method *const stepper_methods[] = {
    &euler, &midpoint, &rk4, &implicit_euler, &cvode, &reference, NULL,
};

const struct linear_method *const linear_methods[] = {
    &direct, &conjugate_gradients, &klu, &cholmod, NULL,
};

const struct stepper_method *stepper_find(const char *name) {
    for (int i = 0; stepper_methods[i]; i++)
        if (strcmp(stepper_methods[i]->name, name) == 0)
            return stepper_methods[i];
    return NULL;
}

const struct linear_method *linear_find(const char *name) {
    for (int i = 0; linear_methods[i]; i++)
        if (strcmp(linear_methods[i]->name, name) == 0)
            return linear_methods[i];
    return NULL;
}

int stepper_refuse(const struct stepper_method *method, const struct stepper_settings *settings,
                   struct system *system) {
    if (system_has_projection(system) && !(method->capabilities & STEPPER_PROJECTS))
        return system_fail(system, REFUSED, "%s does not keep the constraint of %s", method->name,
                           system->name);
    return method->refuse ? method->refuse(settings, system) : 0;
}

struct stepper *stepper_create(const struct stepper_method *method,
                               const struct stepper_settings *settings, struct system *system) {
    struct stepper *stepper = method->create(settings, system);
    if (stepper) {
        stepper->method = method;
        stepper->system = system;
    }
    return stepper;
}
