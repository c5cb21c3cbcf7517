/* The one linear system of a step of methods that are implicit in a part of the forces only: they
 * ask for the forces once, at a state that is known, and solve once,
 *
 *     (M - alpha D - beta K) x = M r + gamma K g,
 *
 * with D and K of what the option `matrix` names. These methods have their order whatever D and K
 * are (W-methods: Steihaug & Wolfbrandt 1979, doi:10.1090/S0025-5718-1979-0521280-3); what is not
 * in the matrix bounds their steps as it bounds an explicit method's. On a system whose forces have
 * no parts it is the whole matrix, by the model's own solver. */
#ifndef WISPLAB_SEMI_IMPLICIT_H
#define WISPLAB_SEMI_IMPLICIT_H

#include "stepper.h"

/* The option of these methods: enum force_part, or auto. */
enum { MATRIX_AUTO = FORCE_PARTS };
extern const char *const matrix_choices[];
#define MATRIX_OPTION_SPEC                                                                        \
    {                                                                                             \
        .name = "matrix",                                                                         \
        .help = "forces in the matrix: of springs along the segments (stretch), of skip springs " \
                "too (axial), all but what springs do across (full), that too (spd); auto: the "  \
                "least that has all that may be stiff",                                           \
        .kind = OPTION_CHOICE, .initial = MATRIX_AUTO, .choices = matrix_choices                  \
    }

struct semi_implicit;

/* For the functions of a stepper_method whose first option this is. */
int semi_implicit_refuse(const struct stepper_settings *settings, struct system *system);
struct semi_implicit *semi_implicit_create(const struct stepper_settings *settings,
                                           struct system *system);
void semi_implicit_free(struct semi_implicit *self);

/* What a run that fails should be told of the choice of matrix, or NULL. */
const char *semi_implicit_caution(const struct semi_implicit *self);

/* What steppers of such a method begin with: their base, and the matrix. One is made with `bytes`
 * of zeroed memory, see stepper_memory; NULL where memory cannot be had. */
struct semi_implicit_stepper {
    struct stepper base;
    struct semi_implicit *matrix;
};
void *semi_implicit_stepper(const struct stepper_settings *settings, struct system *system,
                            size_t bytes);
void semi_implicit_stepper_free(struct stepper *stepper);
const char *semi_implicit_stepper_caution(const struct stepper *stepper);

/* Solves at (t, equation->q, v), where the system's last acceleration has been; the equation's part
 * is set here. On a system without parts all lanes have the coefficients of the first. */
int semi_implicit_solve(struct semi_implicit *self, double t, const double *v,
                        struct part_equation *equation, double *x);

/* Linear Euler from (q, v) at t to (q1, v1) at t + h, see linear_euler.c, which may be in place. */
int semi_implicit_euler(struct semi_implicit *self, double t, double h, const double *q,
                        const double *v, double *q1, double *v1);

/* Makes a step of its own in each lane, to time t1, or in each lane to system->times; 0 leaves a
 * lane where it is. */
int semi_implicit_euler_lanes(struct semi_implicit *self, double t1, const double *h,
                              const double *q, const double *v, double *q1, double *v1);

#endif
