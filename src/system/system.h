/* The seam between models and steppers: a second-order system
 *
 *     q' = v,   M(q) v' = f(t, q, v),
 *
 * asked for its acceleration v' = a(t, q, v), and optionally for Jacobians, linear solves and a
 * projection onto its constraint. A first-order problem u' = g(t, u) rides on v: a = g(t, v).
 *
 * A system is one part of a model: `lanes` wisps side by side with equal numbers of unknowns,
 * interleaved (unknown i of lane k at index i * lanes + k), so that inner loops run across lanes.
 *
 * Return codes, here and in steppers: 0 done; otherwise an enum outcome: positive where the state
 * is as before and a smaller step might do, negative where nothing will help. The reason is in
 * `system->reason`. */
#ifndef WISPLAB_SYSTEM_H
#define WISPLAB_SYSTEM_H

#include "base/outcome.h"
#include "counters.h"
#include "energy.h"

/* Which Jacobians: all terms, or an approximation that is symmetric and positive definite. */
enum jacobian { JACOBIAN_EXACT, JACOBIAN_SPD, JACOBIAN_COUNT };

/* What the matrix M - alpha D - beta K is, for alpha, beta >= 0. */
enum matrix_property {
    MATRIX_AVAILABLE = 1, /* this kind of Jacobian exists */
    MATRIX_SYMMETRIC = 2,
    MATRIX_DEFINITE = 4,   /* positive */
    MATRIX_FACTORABLE = 8, /* the model's own factor and solve take it */
};

/* Which of the forces a solve with a part of them has in its D and K, in order of size; the others
 * are for the method to treat explicitly. */
enum force_part {
    FORCES_STRETCH, /* what keeps neighbours at their distance, along the line between them */
    FORCES_AXIAL,   /* and all other springs, along theirs */
    FORCES_FULL, /* all that JACOBIAN_SPD has, but for the transverse stiffness of springs: hinges
                    too, the envelope, bodies that push by penalty */
    FORCES_SPD,  /* and that */
    FORCE_PARTS,
};

/* (M - alpha D - beta K) x = M r + gamma K g, with D and K of a part of the forces; `r` and `g` are
 * rates or velocities, not forces. Coefficients have a number for each lane, and are not negative.
 */
struct part_equation {
    enum force_part part;
    const double *alpha, *beta, *gamma;
    const double *q; /* where the last acceleration was */
    const double *r, *g;
};

/* Where a square sparse matrix has its entries, by columns; row indices ascending in each, the
 * diagonal always present. */
struct sparse_matrix {
    int size;
    int *column_start; /* size + 1 */
    int *row;          /* column_start[size] */
};

/* What a model implements. Vectors have `size` doubles and never alias; `ctx` is the model's own.
 * Required: acceleration. The other operations are NULL where the model cannot. */
struct system_ops {
    /* a <- v' at (t, q, v). */
    int (*acceleration)(void *ctx, double t, const double *q, const double *v, double *a);

    /* Puts (q, v) onto the constraint, keeping what the treatment says is kept. */
    int (*project)(void *ctx, double t, double *q, double *v);

    /* Computes M, D = df/dv and K = df/dq at (t, q, v). They, and what factor makes of them, hold
     * until the next linearise, whatever else is asked for in between. Lanes that wait keep what
     * they have. */
    int (*linearise)(void *ctx, enum jacobian kind, double t, const double *q, const double *v);

    /* y <- (m M + d D + k K) x, after linearise. */
    void (*product)(void *ctx, double m, double d, double k, const double *x, double *y);

    /* Prepares M - alpha D - beta K for solve, after linearise: the model's own, direct solver. */
    int (*factor)(void *ctx, double alpha, double beta);

    /* Solves (M - alpha D - beta K) x = b with the last factor. */
    void (*solve)(void *ctx, const double *b, double *x);

    /* Solves an equation with a part of the forces, of the parts in system->force_parts, at the
     * state and time of the last acceleration. It must have succeeded, and nothing else but such
     * solves may have been asked for since: what it has found on its way is used. What linearise
     * and factor have prepared is left alone. The first call may be refused memory. */
    int (*solve_part)(void *ctx, const struct part_equation *equation, double *x);

    /* rate <- how a changes with time where q and v stay, at the state and time of the last
     * acceleration, which are given again, and on the same condition as solve_part; all lanes are
     * at t. NULL: it does not, or there are no Jacobians. */
    void (*time_rate)(void *ctx, double t, const double *q, const double *v, double *rate);

    /* For methods that treat springs, and hinges, as constraints: `without_springs` is the
     * acceleration without them, `sweep_springs` a Gauss-Seidel sweep over them, as constraints
     * with their stiffnesses and dampings, of a step of h that began at q, ends at t and has come
     * to x. It changes x and their multipliers, of which there are system->springs, 0 before the
     * first sweep, and has the masses of the last `without_springs`. */
    int (*without_springs)(void *ctx, double t, const double *q, const double *v, double *a);
    void (*sweep_springs)(void *ctx, double t, double h, const double *q, double *x,
                          double *multipliers);

    /* Writes M - alpha D - beta K into `values`, in the order of system->pattern. */
    void (*assemble)(void *ctx, double alpha, double beta, double *values);

    /* Where the energy is, and what changes it. Both leave no trace: what linearise and factor
     * have prepared, and every bit of a run, is as without them. The first call for a system takes
     * memory, and may be refused it. */
    int (*energies)(void *ctx, double t, const double *q, const double *v,
                    struct energies *energies);
    int (*powers)(void *ctx, double t, const double *q, const double *v, struct powers *powers);
};

/* The calls to a model, for profiles. */
#define SYSTEM_CALLS(X) \
    X(acceleration)     \
    X(project)          \
    X(linearise)        \
    X(product)          \
    X(factor)           \
    X(solve)            \
    X(solve_part)       \
    X(time_rate)        \
    X(without_springs)  \
    X(sweep_springs)    \
    X(assemble)

/* Seconds of wall time spent in each; only where a profile was asked for, since reading a clock
 * costs a tenth of an evaluation. */
struct profile {
#define X(call) double call;
    SYSTEM_CALLS(X)
#undef X
};

/* The most wisps that any system has side by side. */
enum { LANES_MOST = 8 };

struct system {
    const struct system_ops *ops;
    void *ctx;          /* owned by the model */
    const char *name;   /* for messages: "circle (free)" */
    int size;           /* doubles in q, in v, in a */
    int lanes;          /* wisps side by side, padding included */
    int wisps;          /* wisps that count: lanes without the padding */
    const int *numbers; /* of the wisps in the lanes, for messages; or NULL */

    /* Set by a method whose lanes have steps of their own, while it asks for something: */
    const double *times; /* by lane, in place of the t that is given; NULL: all are at t */
    unsigned waiting;    /* lanes that it does not ask about, and that are not counted; their
                            numbers are those of a state that was reached */

    unsigned matrix[JACOBIAN_COUNT]; /* enum matrix_property, by kind of Jacobian */
    const char *matrix_note;         /* why the matrix is not symmetric, or NULL */
    unsigned force_parts;            /* that solve_part takes, bit k for part k; 0: none */
    enum force_part stiff_part;      /* the least of them that has all that may be stiff */
    int springs;                     /* multipliers of sweep_springs; 0: it has no such springs */
    int unprojected;                 /* steps leave the state off the constraint that there is */
    double from, until;              /* of the smooth motion being advanced over, s: prescribed
                                        functions of time with a jump at an end have there what they
                                        have inside; until 0: none is */
    const char *no_jacobians;        /* that something has none, and what to do; NULL: not said */
    const struct sparse_matrix *pattern; /* of assemble; NULL without it */
    struct counters counters;
    struct profile *profile; /* NULL: none is kept */
    char reason[240];        /* of the last failure, for the user */
};

/* The wrappers: they count, and are the only way to a model. See struct system_ops. */
int system_acceleration(struct system *s, double t, const double *q, const double *v, double *a);
int system_project(struct system *s, double t, double *q, double *v);
int system_linearise(struct system *s, enum jacobian kind, double t, const double *q,
                     const double *v);
void system_product(struct system *s, double m, double d, double k, const double *x, double *y);
int system_factor(struct system *s, double alpha, double beta);
void system_solve(struct system *s, const double *b, double *x);
int system_solve_part(struct system *s, const struct part_equation *equation, double *x);
void system_time_rate(struct system *s, double t, const double *q, const double *v, double *rate);
int system_without_springs(struct system *s, double t, const double *q, const double *v, double *a);
void system_sweep_springs(struct system *s, double t, double h, const double *q, double *x,
                          double *multipliers);
void system_assemble(struct system *s, double alpha, double beta, double *values);

/* Whether a projection onto a constraint belongs to every step. */
int system_has_projection(const struct system *s);

/* Writes the reason of a failure (printf) and returns `code`. */
int system_fail(struct system *s, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
