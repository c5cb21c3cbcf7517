#include "stepper.h"

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
