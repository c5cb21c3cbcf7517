/* Symplectic Euler as a plug-in in which one thing is wrong: the build says which, by FAULT. */
#include "stepper.h"

#include <signal.h>
#include <stdlib.h>

enum { NOTHING, BUILD, VERSION, SYMBOL, NAME, TABLE, LOAD, UNKNOWN, REFUSE, STEP, EXIT, LEAVE };

struct own {
    struct stepper base;
    double a[];
};

__attribute__((constructor)) static void on_load(void) {
    if (FAULT == LOAD)
        raise(SIGSEGV);
    if (FAULT == EXIT)
        exit(0);
}

static int refuse(const struct stepper_settings *settings, struct system *system) {
    (void)settings, (void)system;
    if (FAULT == REFUSE)
        raise(SIGSEGV);
    if (FAULT == LEAVE)
        quick_exit(0);
    return 0;
}

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    struct own *own = stepper_memory(sizeof *own + (size_t)system->size * sizeof(double));
    return own ? &own->base : NULL;
}

int simulate(void); /* is in the program, but no header of plug-ins has it */

static int step(struct stepper *stepper, double t, double h, double *q, double *v) {
    double *a = ((struct own *)stepper)->a;
    if (FAULT == UNKNOWN)
        return simulate();
    if (FAULT == STEP && t > 0.01)
        raise(SIGSEGV);
    const int code = system_acceleration(stepper->system, t, q, v, a);
    for (int i = 0; i < stepper->system->size && !code; i++) {
        v[i] += h * a[i];
        q[i] += h * v[i];
    }
    return code;
}

static void destroy(struct stepper *stepper) {
    free(stepper);
}

static const struct stepper_method method = {
    .name = FAULT == NAME ? "rk4" : "own",
    .summary = "symplectic Euler, from outside",
    .reference = FAULT == BUILD ? "another build" : "Hairer, Lubich & Wanner",
    .order = 1,
    .refuse = refuse,
    .create = create,
    .step = FAULT == TABLE ? NULL : step,
    .free = destroy,
};

/* As STEPPER_PLUGIN(method) has it, but for the faults. */
#ifdef NO_SYMBOL
#define wisplab_plugin another_name
#endif
extern const struct stepper_plugin wisplab_plugin;
const struct stepper_plugin wisplab_plugin = {STEPPER_INTERFACE + (FAULT == VERSION), &method};
