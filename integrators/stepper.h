/* What a time integrator is to the rest of the program: a table of facts and a few functions.
 * A method lives in one file, ends in one static const table, and is known everywhere once
 * registry.c names it. */
#ifndef WISPLAB_STEPPER_H
#define WISPLAB_STEPPER_H

#include "base/options.h"
#include "butcher.h"
#include "integrators/linear/linear.h"
#include "system/system.h"

enum stepper_capability {
    STEPPER_IMPLICIT = 1, /* solves M - alpha D - beta K: takes a linear solver, needs Jacobians */
    STEPPER_ADAPTIVE = 2, /* chooses its own steps: takes tolerances instead of a step */
    STEPPER_PROJECTS = 4, /* puts the state back onto a system's constraint after each step */
};

/* What a stepper is made with. */
struct stepper_settings {
    const struct linear_method *linear; /* of implicit steppers, else NULL */
    double rtol, atol;                  /* of adaptive steppers: relative; absolute, in m and m/s */
    double option[OPTIONS_MAX];         /* in the order of method->options */
    double linear_option[OPTIONS_MAX];  /* in the order of linear->options */
};

/* A method at work on one system; concrete steppers begin with this, set by
 * stepper_create. */
struct stepper {
    const struct stepper_method *method;
    struct system *system; /* not owned */
};

/* A method unlike the one that names it, run a second time on the same scene: the difference of
 * the two bounds the error of both. */
struct second_opinion {
    const char *method;
    double rtol_ratio;          /* its tolerances over those of the first */
    const char *const *options; /* "key=value", NULL-terminated */
};

struct stepper_method {
    const char *name;
    const char *summary;                     /* one line */
    const char *reference;                   /* paper, book or manual */
    int order;                               /* of accuracy; the highest where it varies */
    unsigned capabilities;                   /* enum stepper_capability */
    const struct option_spec *options;       /* its own, or NULL */
    const struct butcher_table *table;       /* of Runge-Kutta methods, else NULL */
    const struct second_opinion *checked_by; /* or NULL */
    double rtol, atol; /* of adaptive methods, where the user gives none; 0: the scene's */

    /* Why this pair of settings and system is not supported: REFUSED with system->reason, or 0.
     * May be NULL. */
    int (*refuse)(const struct stepper_settings *settings, struct system *system);

    /* A stepper for `system`, to be freed with free; NULL where memory cannot be had. */
    struct stepper *(*create)(const struct stepper_settings *settings, struct system *system);

    /* Fixed-step methods: one step from t to t + h, in place, projection included. */
    int (*step)(struct stepper *stepper, double t, double h, double *q, double *v);

    /* Adaptive methods: one accepted step of the method's choice from *t, in place, not beyond
     * `stop`, which is met exactly; *t becomes the time reached. */
    int (*advance)(struct stepper *stepper, double *t, double stop, double *q, double *v);

    /* Forgets the history: an event changed the state, the system or both. NULL: has none. */
    int (*reset)(struct stepper *stepper);

    void (*free)(struct stepper *stepper);
};

/* All methods, in the order of lists and legends; NULL-terminated. */
extern const struct stepper_method *const stepper_methods[];

/* The method of that name, or NULL. */
const struct stepper_method *stepper_find(const char *name);

/* REFUSED with system->reason where `method` with `settings` cannot run on `system`, else 0. */
int stepper_refuse(const struct stepper_method *method, const struct stepper_settings *settings,
                   struct system *system);

/* A stepper made by the method's table, or NULL where memory cannot be had. */
struct stepper *stepper_create(const struct stepper_method *method,
                               const struct stepper_settings *settings, struct system *system);

#endif
