/* What a time integrator is to the rest of the program: a table of facts and a few functions.
 * A method lives in one file, ends in one static const table, and is known everywhere once
 * registry.c names it: a fact that its table does not state has the default that is said here, and
 * nothing else in the program asks what a method is called. How the methods are compared, with
 * which solvers, options, colours and marks, is configurations.h. */
#ifndef WISPLAB_STEPPER_H
#define WISPLAB_STEPPER_H

#include "base/options.h"
#include "butcher.h"
#include "integrators/linear/linear.h"
#include "system/system.h"

enum stepper_capability {
    STEPPER_IMPLICIT = 1,   /* its steps are not bounded by stiffness: needs Jacobians */
    STEPPER_ADAPTIVE = 2,   /* chooses its own steps: takes tolerances instead of a step */
    STEPPER_PROJECTS = 4,   /* puts the state back onto a system's constraint after each step */
    STEPPER_SOLVES = 8,     /* solves M - alpha D - beta K by a solver that the user may choose */
    STEPPER_MULTISTEP = 16, /* its steps make use of states before the last */
    STEPPER_JACOBIAN_FREE = 32, /* implicit, and can do without Jacobians where there are none */
};

/* What a stepper is made with. */
struct stepper_settings {
    const struct linear_method *linear; /* of steppers that take one, else NULL */
    double rtol, atol;                  /* of adaptive steppers: relative; absolute, in m and m/s */
    struct options options;             /* of the method and of its solver */
};

/* A method at work on one system; concrete steppers begin with this, set by
 * stepper_create. */
struct stepper {
    const struct stepper_method *method;
    struct system *system; /* not owned */
};

/* A method unlike the one that names it, run a second time on the same scene: the difference of
 * the two bounds the error of both. */
struct cross_check {
    const char *method;
    double rtol_ratio;          /* its tolerances over those of the first */
    const char *const *options; /* "key=value", NULL-terminated */
};

struct stepper_method {
    const char *name;
    const char *summary;                  /* one line */
    const char *reference;                /* paper, book or manual */
    int order;                            /* of accuracy; the highest where it varies */
    int undamped_order;                   /* where nothing is damped, if another; else 0 */
    unsigned capabilities;                /* enum stepper_capability */
    const struct option_spec *options;    /* its own, or NULL */
    const struct butcher_table *table;    /* of Runge-Kutta methods, else NULL */
    const struct cross_check *checked_by; /* or NULL */
    double rtol, atol; /* of adaptive methods, where the user gives none; 0: the scene's */

    /* On wisps, where the user says nothing; elsewhere it is the problem that decides. */
    struct {
        const char *treatment; /* its name; NULL: "generalised" */
        const char *linear;    /* of those that take a solver, its name; NULL: "direct" */
    } on_wisps;

    /* Fixed-step methods: at how many Hz one would run it on wisps of the default material; see
     * stepper_usual_rate for 0. */
    double usual_rate;

    /* Most wisps of a part; 0: 1 of adaptive methods, else as many as the kernel takes. An adaptive
     * method that says more takes steps of its own with each. */
    int lanes;

    /* How many wisps may share a step, in adaptive methods that have one step for a whole part: an
     * option of theirs, "1" or "4" (STEPPER_SHARING). With 4 a wisp's bits depend on
     * the others. NULL: none. */
    const struct option_spec *shared_steps;

    /* By what a step multiplies a mode of a linear system, see stepper_amplification; NULL: what
     * `table` says, and without one nobody knows. */
    double complex (*amplification)(double complex z, double complex partner);

    /* Why this pair of settings and system is not supported: REFUSED with system->reason, or 0.
     * May be NULL. */
    int (*refuse)(const struct stepper_settings *settings, struct system *system);

    /* A stepper for `system`, to be freed with free; NULL where memory cannot be had. */
    struct stepper *(*create)(const struct stepper_settings *settings, struct system *system);

    /* Fixed-step methods: one step from t to t + h, in place, projection included. */
    int (*step)(struct stepper *stepper, double t, double h, double *q, double *v);

    /* Adaptive methods: an accepted step of the method's choice, in place, of some or all of the
     * lanes that are before `stop`, not beyond it; it is met exactly. t has the time of each lane,
     * which becomes the one reached. (Lanes have times of their own in methods that take several
     * and do not share steps.) After a failure lanes are where t says. */
    int (*advance)(struct stepper *stepper, double *t, double stop, double *q, double *v);

    /* Forgets the history of these lanes, bit k for lane k: an event changed their state, their
     * system or both, or the forces have a kink here. A method that has one step for all lanes may
     * forget them all. NULL: has none. */
    int (*reset)(struct stepper *stepper, unsigned lanes);

    /* What a user should know of the settings when a run has failed, or NULL; itself NULL: nothing.
     */
    const char *(*caution)(const struct stepper *stepper);

    void (*free)(struct stepper *stepper);
};

/* Zeroed memory of a stepper, for free; NULL where it cannot be had. Vectors of 8 lanes that follow
 * each other from a member IN_LINES on begin with lines of the cache, and their numbers side by
 * side never lie in two of them. */
#define IN_LINES _Alignas(64)
void *stepper_memory(size_t bytes);

/* A stepper that is nothing but `count` vectors of the system's size, one behind the other from
 * stepper_vectors on, for stepper_free; NULL where memory cannot be had. */
struct stepper *stepper_of_vectors(struct system *system, size_t count);
double *stepper_vectors(struct stepper *stepper);

/* The `free` of steppers of one block of memory. */
void stepper_free(struct stepper *stepper);

/* Makes (q1, v1), the end of a fixed step at time t1, the state (q, v), once it is projected where
 * that belongs to steps: only then they must be apart, for the state stays where that fails. */
int stepper_arrive(struct stepper *stepper, double t1, double *q1, double *v1, double *q,
                   double *v);

/* All methods, in the order of lists and legends, those of plug-ins last; NULL-terminated. */
extern const struct stepper_method *const *stepper_methods;

/* The method of that name, or NULL. */
const struct stepper_method *stepper_find(const char *name);

/* Adds a method, which stays, to the list; none of that name is there. Returns 0, or -1 where
 * memory cannot be had. Before any thread or run is started. */
int stepper_add(const struct stepper_method *method);

/* The most wisps of a part: as many as the method says, or its option, and the solver takes (NULL:
 * it has none), at most LANES_MOST, which is what the kernel has. */
int stepper_lanes(const struct stepper_method *method, const struct linear_method *linear,
                  const struct options *options);

/* Whether the wisps of a part share a step by such an option. Then there are as many of them in a
 * part as it says, or padding, for the steps depend on that. */
enum { STEPPER_SHARING = 4 };
int stepper_shares_steps(const struct stepper_method *method, const struct options *options);

/* Whether a part's wisps have steps of their own, and times of their own between stops. */
int stepper_steps_by_lane(const struct stepper_method *method);

/* Hz: usual_rate, and where that is 0, 300 of implicit methods and 9000 of others. */
double stepper_usual_rate(const struct stepper_method *method);

/* Whether linear theory says where it is stable: then the next one can be asked. */
int stepper_is_predictable(const struct stepper_method *method);

/* A step of h on q'' = k q + d q', of which the solutions are exp(z t / h) and exp(partner t / h),
 * multiplies (q, q') by a matrix: its eigenvalue of largest modulus. (k h^2 = -z partner and
 * d h = z + partner; of a Runge-Kutta method they are R(z) and R(partner).) */
double complex stepper_amplification(const struct stepper_method *method, double complex z,
                                     double complex partner);

/* REFUSED with system->reason where `method` with `settings` cannot run on `system`, else 0. */
int stepper_refuse(const struct stepper_method *method, const struct stepper_settings *settings,
                   struct system *system);

/* A stepper made by the method's table, or NULL where memory cannot be had. */
struct stepper *stepper_create(const struct stepper_method *method,
                               const struct stepper_settings *settings, struct system *system);

/* --- plug-ins --- */

/* Which edition of this interface: raised whenever a struct, a function or the meaning of either
 * changes in a header that is installed for plug-ins (CMakeLists.txt lists them). */
enum { STEPPER_INTERFACE = 1 };

/* What a plug-in exports, under the name wisplab_plugin; plugin.h says how it is loaded. */
struct stepper_plugin {
    int interface; /* STEPPER_INTERFACE of the headers it was compiled with; always the first */
    const struct stepper_method *method;
};

/* The last line of a method's file makes it a plug-in: STEPPER_PLUGIN(rosenbrock_euler); */
#define STEPPER_PLUGIN(method)                                                                \
    extern __attribute__((visibility("default"))) const struct stepper_plugin wisplab_plugin; \
    const struct stepper_plugin wisplab_plugin = {STEPPER_INTERFACE, &(method)}

#endif
