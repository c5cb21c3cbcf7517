/* Implicit Euler, by default linearised once per step as in Baraff & Witkin 1998 and the thesis's
 * equation 2.4; more Newton iterations as an option. */
#include "stepper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NEWTON_ITERATIONS, NEWTON_TOLERANCE, JACOBIAN };

static const struct option_spec options[] = {
    {"newton.iterations", "Newton iterations at most; 1 takes the linearised step unchecked",
     OPTION_COUNT, .initial = 1, .least = 1, .most = 100},
    {"newton.tolerance", "largest last change of a velocity, relative to 1 m/s + the largest speed",
     OPTION_REAL, .initial = 1e-12, .least = 0, .most = 1},
    {"jacobian", "exact, spd (symmetric positive definite), or auto: spd where there is one",
     OPTION_CHOICE, .initial = JACOBIAN_AUTO, .choices = jacobian_choices},
    {0},
};

static double value(const struct stepper_settings *settings, int option) {
    return option_value(&settings->options, &options[option]);
}

/* Implicit Euler as a Runge-Kutta method; the linearised step has the same stability function. */
static const struct butcher_table table = {
    .stages = 1, .a = (const double[]){1}, .b = (const double[]){1}, .c = (const double[]){1}};

struct implicit_euler {
    struct stepper base;
    enum jacobian kind;
    int iterations;
    double tolerance;
    struct linear_solver *linear;
    double *q, *v;        /* the iterate */
    double *a;            /* its acceleration */
    double *rhs, *change; /* of the linear system */
    double *work;
    double memory[];
};

static int implicit_euler_refuse(const struct stepper_settings *settings, struct system *system) {
    enum jacobian kind;
    return linear_choose(settings->linear, system, (int)value(settings, JACOBIAN), &kind);
}

static struct stepper *implicit_euler_create(const struct stepper_settings *settings,
                                             struct system *system) {
    const size_t n = (size_t)system->size;
    struct implicit_euler *self = malloc(sizeof *self + 6 * n * sizeof(double));
    if (!self)
        return NULL;
    double **const vectors[] = {&self->q,   &self->v,      &self->a,
                                &self->rhs, &self->change, &self->work};
    for (size_t i = 0; i < 6; i++)
        *vectors[i] = self->memory + i * n;
    self->iterations = (int)value(settings, NEWTON_ITERATIONS);
    self->tolerance = value(settings, NEWTON_TOLERANCE);
    self->linear = NULL;
    if (!linear_choose(settings->linear, system, (int)value(settings, JACOBIAN), &self->kind))
        self->linear = linear_create(settings->linear, system, &settings->options);
    if (!self->linear) {
        free(self);
        return NULL;
    }
    return &self->base;
}

static double largest(const double *x, int n) {
    double most = 0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

/* One Newton iteration for v1 = v0 + h a(t1, q1, v1), q1 = q0 + h v1. Linearised at the iterate
 * (q, v), with v1 = v + dv and so q1 - q = (q0 + h v - q) + h dv:
 *
 *     (M - h D - h^2 K) dv = M (v0 - v + h a) + h K (q0 + h v - q).
 *
 * The first iterate is (q0, v0), which makes this equation 2.4; later ones have q = q0 + h v. */
static int newton_iteration(struct implicit_euler *self, double t1, double h, const double *q0,
                            const double *v0) {
    struct system *system = self->base.system;
    const int n = system->size;
    double *q = self->q, *v = self->v;
    int code = system_linearise(system, self->kind, t1, q, v);

    if (!code)
        code = linear_factor(self->linear, h, h * h);
    if (!code)
        code = system_acceleration(system, t1, q, v, self->a);
    if (code)
        return code;
    for (int i = 0; i < n; i++)
        self->work[i] = q0[i] + h * v[i] - q[i];
    system_product(system, 0, 0, h, self->work, self->change);
    for (int i = 0; i < n; i++)
        self->work[i] = v0[i] - v[i] + h * self->a[i];
    system_product(system, 1, 0, 0, self->work, self->rhs);
    for (int i = 0; i < n; i++)
        self->rhs[i] += self->change[i];

    code = linear_solve(self->linear, self->rhs, self->change);
    if (code)
        return code;
    for (int i = 0; i < n; i++) {
        v[i] += self->change[i];
        q[i] = q0[i] + h * v[i];
    }
    system->counters.newton_iterations += system->wisps;
    return 0;
}

static int has_converged(const struct implicit_euler *self, int n) {
    return largest(self->change, n) <= self->tolerance * (1 + largest(self->v, n));
}

static int implicit_euler_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct implicit_euler *self = (struct implicit_euler *)stepper;
    struct system *system = stepper->system;
    const int n = system->size;
    const size_t bytes = (size_t)n * sizeof(double);
    int converged = 0;

    memcpy(self->q, q, bytes);
    memcpy(self->v, v, bytes);
    for (int k = 0; k < self->iterations && !converged; k++) {
        const int code = newton_iteration(self, t + h, h, q, v);
        if (code)
            return code;
        converged = self->iterations == 1 || has_converged(self, n);
    }
    if (!converged)
        return system_fail(system, SOLVER_STALLED,
                           "Newton's iteration did not converge in %d iterations",
                           self->iterations);
    if (system_has_projection(system)) {
        const int code = system_project(system, t + h, self->q, self->v);
        if (code)
            return code;
    }
    memcpy(q, self->q, bytes);
    memcpy(v, self->v, bytes);
    return 0;
}

static void implicit_euler_free(struct stepper *stepper) {
    struct implicit_euler *self = (struct implicit_euler *)stepper;
    if (self)
        self->linear->method->free(self->linear);
    free(self);
}

const struct stepper_method implicit_euler = {
    .name = "implicit-euler",
    .summary = "implicit Euler, linearised once per step or iterated",
    .reference = "Baraff & Witkin 1998, doi:10.1145/280814.280821; Plante 1999, eq. 2.4",
    .order = 1,
    .capabilities = STEPPER_IMPLICIT | STEPPER_SOLVES | STEPPER_PROJECTS,
    .options = options,
    .table = &table,
    .on_wisps = {.treatment = "penalty", .linear = "cg"}, /* as in Baraff & Witkin */
    .usual_rate = 300,
    .refuse = implicit_euler_refuse,
    .create = implicit_euler_create,
    .step = implicit_euler_step,
    .free = implicit_euler_free,
};
