/* Solvers of (M - alpha D - beta K) x = b, the system of every implicit step. */
#ifndef WISPLAB_LINEAR_H
#define WISPLAB_LINEAR_H

#include "base/options.h"
#include "system/system.h"

/* A solver at work on one system; concrete solvers begin with this, set by linear_create. */
struct linear_solver {
    const struct linear_method *method;
    struct system *system; /* not owned */
};

struct linear_method {
    const char *name;
    const char *summary;
    const char *reference;
    unsigned needs; /* enum matrix_property, besides MATRIX_AVAILABLE */
    int max_lanes;  /* widest part in which it solves each lane as if it were alone */
    const struct option_spec *options;

    /* Whether the system has the operations it uses. */
    int (*supports)(const struct system *system);

    /* A solver for `system`, to be freed with free; NULL where memory cannot be had. */
    struct linear_solver *(*create)(struct system *system, const struct options *options);

    /* Prepares M - alpha D - beta K of the last system_linearise. */
    int (*factor)(struct linear_solver *solver, double alpha, double beta);

    /* Solves for x; b and x do not alias. */
    int (*solve)(struct linear_solver *solver, const double *b, double *x);

    /* Makes and solves an equation with the spd matrix at the last acceleration, in one go: the
     * equation's part is set here. NULL: it has nothing that is cheaper than the above. */
    int (*solve_at_once)(struct linear_solver *solver, struct part_equation *equation, double *x);

    void (*free)(struct linear_solver *solver);
};

/* All solvers, NULL-terminated, and the one of that name or NULL. */
extern const struct linear_method *const linear_methods[];
const struct linear_method *linear_find(const char *name);

/* The value of an implicit stepper's option "jacobian". */
enum { JACOBIAN_AUTO = JACOBIAN_COUNT };
extern const char *const jacobian_choices[]; /* "exact", "spd", "auto" */

/* Which Jacobian `method` can use on `system`, given the option's value; auto prefers spd where
 * the system has one. Returns 0 and the kind, or REFUSED with system->reason. */
int linear_choose(const struct linear_method *method, struct system *system, int option,
                  enum jacobian *kind);

/* create, factor and solve through the method's table; solves are counted. */
struct linear_solver *linear_create(const struct linear_method *method, struct system *system,
                                    const struct options *options);
int linear_factor(struct linear_solver *solver, double alpha, double beta);
int linear_solve(struct linear_solver *solver, const double *b, double *x);

/* Whether there is solve_at_once for that kind of matrix of its system; and it. */
int linear_solves_at_once(const struct linear_solver *solver, enum jacobian kind);
int linear_solve_at_once(struct linear_solver *solver, struct part_equation *equation, double *x);

#endif
