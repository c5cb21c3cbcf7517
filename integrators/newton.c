#include "newton.h"

#include <math.h>
#include <stdlib.h>

struct newton {
    struct system *system; /* not owned */
    struct linear_solver *linear;
    enum jacobian kind;
    int iterations;
    double tolerance;
    unsigned moving; /* lanes that have not converged, bit k for lane k */

    /* with newton.reuse */
    int reuse;                    /* 0: without */
    unsigned kept;                /* lanes that have a matrix that may be used */
    double gamma, beta;           /* with which those were factorised */
    int age[LANES_MOST];          /* steps that a lane's has been used in */
    double change_by[LANES_MOST]; /* what the last iteration changed a lane by; 0: there was none */

    double *a;            /* the iterate's acceleration */
    double *rhs, *change; /* of the linear system */
    double *work;
    IN_LINES double memory[];
};

/* The solver must fit the Jacobian, of which the default is the same for all methods. */
static int choose(const struct stepper_settings *settings, struct system *system,
                  enum jacobian *kind) {
    static const struct option_spec specs[] = {NEWTON_OPTION_SPECS(1)};
    const double jacobian = option_value(&settings->options, &specs[NEWTON_JACOBIAN]);
    return linear_choose(settings->linear, system, (int)jacobian, kind);
}

int newton_refuse(const struct stepper_settings *settings, struct system *system) {
    enum jacobian kind;
    return choose(settings, system, &kind);
}

struct newton *newton_create(const struct stepper_settings *settings,
                             const struct option_spec *options, struct system *system) {
    const size_t n = (size_t)system->size;
    const struct options *given = &settings->options;
    struct newton *self = stepper_memory(sizeof *self + 4 * n * sizeof(double));
    if (!self)
        return NULL;
    *self = (struct newton){.system = system,
                            .iterations = (int)option_value(given, &options[NEWTON_ITERATIONS]),
                            .tolerance = option_value(given, &options[NEWTON_TOLERANCE]),
                            .reuse = (int)option_value(given, &options[NEWTON_REUSE]),
                            .a = self->memory,
                            .rhs = self->memory + n,
                            .change = self->memory + 2 * n,
                            .work = self->memory + 3 * n};
    if (!choose(settings, system, &self->kind))
        self->linear = linear_create(settings->linear, system, given);
    if (!self->linear) {
        free(self);
        return NULL;
    }
    return self;
}

void newton_free(struct newton *self) {
    if (self)
        self->linear->method->free(self->linear);
    free(self);
}

/* The two vectors of the right side, M r and gamma K g. */
static void find_residuals(const struct newton *self, const struct newton_equation *e,
                           const double *restrict q, const double *restrict v, double *restrict r,
                           double *restrict g) {
    const double *restrict q0 = e->q0, *restrict v0 = e->v0, *restrict a = self->a;
    const double beta = e->beta, gamma = e->gamma;
    for (int i = 0; i < self->system->size; i++) {
        g[i] = q0[i] + beta * v[i] - q[i];
        r[i] = v0[i] - v[i] + gamma * a[i];
    }
}

/* q of the iterate whose velocities are v: the same bits again where v has stopped. */
static void follow(const struct newton *self, const struct newton_equation *e, double *restrict q,
                   const double *restrict v) {
    const double *restrict q0 = e->q0;
    const double beta = e->beta;
    for (int i = 0; i < self->system->size; i++)
        q[i] = q0[i] + beta * v[i];
}

/* The linear system at (q, v), see newton.h, and its solution, by a solver that does it at once. */
static int find_change_at_once(struct newton *self, const struct newton_equation *e,
                               const double *q, const double *v) {
    double alpha[LANES_MOST], beta[LANES_MOST];
    struct part_equation equation = {
        .alpha = alpha, .beta = beta, .gamma = alpha, .q = q, .r = self->rhs, .g = self->work};
    const int code = system_acceleration(self->system, e->t, q, v, self->a);
    if (code)
        return code;
    for (int k = 0; k < self->system->lanes; k++) {
        alpha[k] = e->gamma;
        beta[k] = e->gamma * e->beta;
    }
    find_residuals(self, e, q, v, self->rhs, self->work);
    return linear_solve_at_once(self->linear, &equation, self->change);
}

/* Makes the matrices of the lanes that have none, or of all without newton.reuse. */
static int make_matrices(struct newton *self, const struct newton_equation *e, const double *q,
                         const double *v) {
    struct system *system = self->system;
    const unsigned lanes = self->reuse ? self->moving & ~self->kept : ~0u;
    if (!lanes)
        return 0;
    system->waiting = ~lanes;
    int code = system_linearise(system, self->kind, e->t, q, v);
    if (!code)
        code = linear_factor(self->linear, e->gamma, e->gamma * e->beta);
    system->waiting = 0;
    self->kept = code ? 0 : self->kept | lanes;
    for (int k = 0; k < system->lanes; k++)
        self->age[k] = lanes >> k & 1 ? 0 : self->age[k];
    return code;
}

/* Solves the equation step by step. */
static int find_change(struct newton *self, const struct newton_equation *e, const double *q,
                       const double *v) {
    struct system *system = self->system;
    int code = make_matrices(self, e, q, v);
    if (!code)
        code = system_acceleration(system, e->t, q, v, self->a);
    if (code)
        return code;
    find_residuals(self, e, q, v, self->rhs, self->work);
    system_product(system, 0, 0, e->gamma, self->work, self->change);
    system_product(system, 1, 0, 0, self->rhs, self->work);
    for (int i = 0; i < system->size; i++)
        self->rhs[i] = self->work[i] + self->change[i];
    return linear_solve(self->linear, self->rhs, self->change);
}

/* Changes v in one lane, which stops moving where that has hardly changed it. */
static int move_lane(struct newton *self, int lane, double *v) {
    struct system *system = self->system;
    double change = 0, speed = 0;
    int finite = 1;
    for (int i = lane; i < system->size; i += system->lanes) {
        v[i] += self->change[i];
        const double by = fabs(self->change[i]), to = fabs(v[i]);
        change = by > change ? by : change; /* fmax is a call */
        speed = to > speed ? to : speed;
        finite &= to < INFINITY;
    }
    if (!finite)
        return system_fail(system, NOT_FINITE, "Newton's iterate overflowed or became NaN");
    if (change <= self->tolerance * (1 + speed))
        self->moving &= ~(1u << lane);
    else if (self->age[lane] > 0 && self->change_by[lane] > 0 &&
             change > 0.25 * self->change_by[lane])
        self->kept &= ~(1u << lane); /* it would not converge soon */
    self->change_by[lane] = change;
    return 0;
}

static int move(struct newton *self, double *v) {
    int code = 0;
    for (int lane = 0; lane < self->system->lanes && !code; lane++)
        if (self->moving >> lane & 1)
            code = move_lane(self, lane, v);
    return code;
}

/* The linearised step, unchecked: all lanes at once. */
static int move_once(struct newton *self, double *restrict v) {
    const double *restrict change = self->change;
    for (int i = 0; i < self->system->size; i++)
        v[i] += change[i];
    self->moving = 0;
    return 0;
}

int newton_reuses(const struct newton *self) {
    return self->reuse > 0;
}

void newton_forget(struct newton *self, unsigned lanes) {
    self->kept &= ~lanes;
}

/* Before a step with newton.reuse: what is too old, or for other coefficients, is not kept. */
static void begin_step(struct newton *self, const struct newton_equation *e) {
    if (e->gamma != self->gamma || e->beta != self->beta)
        self->kept = 0;
    self->gamma = e->gamma;
    self->beta = e->beta;
    for (int k = 0; k < self->system->lanes; k++) {
        if (++self->age[k] >= self->reuse)
            self->kept &= ~(1u << k);
        self->change_by[k] = 0;
    }
}

int newton_solve(struct newton *self, const struct newton_equation *e, double *q, double *v) {
    struct system *system = self->system;
    const unsigned counted = ~(~0u << system->wisps); /* without the padding */
    self->moving = ~(~0u << system->lanes);
    if (self->reuse)
        begin_step(self, e);
    for (int k = 0; k < self->iterations && self->moving; k++) {
        system->counters.newton_iterations += __builtin_popcount(self->moving & counted);
        int code = !self->reuse && linear_solves_at_once(self->linear, self->kind)
                       ? find_change_at_once(self, e, q, v)
                       : find_change(self, e, q, v);
        if (!code)
            code = self->iterations == 1 ? move_once(self, v) : move(self, v);
        if (code)
            return code;
        follow(self, e, q, v);
    }
    if (self->moving)
        return system_fail(system, SOLVER_STALLED,
                           "Newton's iteration did not converge in %d iterations",
                           self->iterations);
    return 0;
}
