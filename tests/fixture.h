/* Small systems with known answers, all operations, and callbacks that fail when told to. */
#ifndef WISPLAB_TESTS_FIXTURE_H
#define WISPLAB_TESTS_FIXTURE_H

#include "model/model.h"
#include "scene/scene_load.h"

#include <complex.h>

enum { FIXTURE_SIZE_MAX = 30 };

/* The operations that can fail. */
enum fixture_call {
    CALL_ACCELERATION,
    CALL_LINEARISE,
    CALL_FACTOR,
    CALL_PROJECT,
    FIXTURE_CALLS,
};
extern const char *const fixture_call_names[];

struct fixture {
    struct system system;      /* ctx is the fixture */
    struct system *reports_to; /* whose reason failures write: &system, or a copy of it */
    int n;
    /* a at (t, q, v); and M, D, K there, row by row, n * n each. */
    void (*rate)(const struct fixture *fixture, double t, const double *q, const double *v,
                 double *a);
    void (*jacobians)(struct fixture *fixture, double t, const double *q, const double *v);
    double m[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX], d[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX],
        k[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX];
    double lu[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX]; /* of the last factor */
    int pivot[FIXTURE_SIZE_MAX];
    struct sparse_matrix pattern;
    int column_start[FIXTURE_SIZE_MAX + 1], row[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX];

    /* The `fail_at`-th call (from 1; 0: none) of `fail_call` returns fail_code; with fail_on, so
     * do all calls after it. With nan, an acceleration is NaN instead. */
    enum fixture_call fail_call;
    int fail_at, fail_code, fail_on, nan;
    int calls[FIXTURE_CALLS];
    int failures; /* so far */
};

/* n unknowns without motion yet: M = 1, D = K = 0, with room in the sparse pattern for entries so
 * far from the diagonal. The caller sets rate and jacobians. `matrix` is what M - alpha D - beta K
 * is, enum matrix_property; all are factorable. */
void fixture_begin(struct fixture *fixture, const char *name, int n, int band, unsigned matrix);

/* M v' = K q + D v + (1, ..., 1) cos t with M symmetric positive definite and not diagonal, -D and
 * -K positive semidefinite: a chain of springs and dampers of random strength, fixed at one end.
 * The smallest eigenvalue of M is 1 or more. Not symmetric: D and K get random entries of up to 0.3
 * above the diagonal. */
void fixture_chain(struct fixture *fixture, int n, unsigned seed, int symmetric);

/* v' = z v, as two real equations: the stability function at work. */
void fixture_dahlquist(struct fixture *fixture, double complex z);

/* v' = cos t: pure quadrature, where only the stage times matter. */
void fixture_quadrature(struct fixture *fixture);

/* v' = -sin t + g(q, v) - g(sin t, cos t), g = -q^3 - q v^2 / 2 - v / 3: nonlinear, damped, moved
 * from outside, and solved by q = sin t. */
void fixture_manufactured(struct fixture *fixture);

/* A projection that changes nothing, and so is right for every state; it can still fail. */
void fixture_add_projection(struct fixture *fixture);

/* A problem of one part, for simulate() and runs: a fixture made anew by `make` from the state
 * (q, v), then changed by `change` (may be NULL). Set before use; not for threads. */
struct fixture_start {
    void (*make)(struct fixture *fixture);
    void (*change)(struct fixture *fixture);
    double q, v;
};
extern struct fixture_start fixture_start;
extern const struct problem fixture_problem;

/* A scene of that problem; it belongs to the test. */
struct scene *fixture_scene(double duration, double frame_rate, double step);

/* Dense elimination with partial pivoting: x <- A^-1 b, A row by row. */
void dense_solve(int n, const double *a, const double *b, double *x);

/* The next of a row of reproducible numbers in [0, 1). */
double random_number(unsigned *state);

#endif
