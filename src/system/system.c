#include "system.h"

#include "base/progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Does something, and adds its time to the profile where there is one. */
#define TIMED(s, call, what)                                         \
    do {                                                             \
        const double begin = (s)->profile ? monotonic_seconds() : 0; \
        what;                                                        \
        if ((s)->profile)                                            \
            (s)->profile->call += monotonic_seconds() - begin;       \
    } while (0)

/* The wisps that are asked about. */
static int asked(const struct system *s) {
    return s->wisps - __builtin_popcount(s->waiting & ~(~0u << s->wisps));
}

int system_acceleration(struct system *s, double t, const double *q, const double *v, double *a) {
    int code;
    s->counters.force_evaluations += asked(s);
    TIMED(s, acceleration, code = s->ops->acceleration(s->ctx, t, q, v, a));
    return code;
}

int system_has_projection(const struct system *s) {
    return s->ops->project && !s->unprojected;
}

int system_project(struct system *s, double t, double *q, double *v) {
    int code;
    s->counters.projections += s->wisps;
    TIMED(s, project, code = s->ops->project(s->ctx, t, q, v));
    return code;
}

int system_linearise(struct system *s, enum jacobian kind, double t, const double *q,
                     const double *v) {
    int code;
    s->counters.linearisations += asked(s);
    TIMED(s, linearise, code = s->ops->linearise(s->ctx, kind, t, q, v));
    return code;
}

void system_product(struct system *s, double m, double d, double k, const double *x, double *y) {
    s->counters.jacobian_products += s->wisps;
    TIMED(s, product, s->ops->product(s->ctx, m, d, k, x, y));
}

int system_factor(struct system *s, double alpha, double beta) {
    int code;
    s->counters.factorisations += asked(s);
    TIMED(s, factor, code = s->ops->factor(s->ctx, alpha, beta));
    return code;
}

void system_solve(struct system *s, const double *b, double *x) {
    TIMED(s, solve, s->ops->solve(s->ctx, b, x));
}

int system_solve_part(struct system *s, const struct part_equation *equation, double *x) {
    int code;
    s->counters.part_solves += asked(s);
    TIMED(s, solve_part, code = s->ops->solve_part(s->ctx, equation, x));
    return code;
}

void system_time_rate(struct system *s, double t, const double *q, const double *v, double *rate) {
    if (!s->ops->time_rate) {
        memset(rate, 0, (size_t)s->size * sizeof *rate);
        return;
    }
    s->counters.time_rates += asked(s);
    TIMED(s, time_rate, s->ops->time_rate(s->ctx, t, q, v, rate));
}

int system_without_springs(struct system *s, double t, const double *q, const double *v,
                           double *a) {
    int code;
    s->counters.force_evaluations += s->wisps;
    TIMED(s, without_springs, code = s->ops->without_springs(s->ctx, t, q, v, a));
    return code;
}

void system_sweep_springs(struct system *s, double t, double h, const double *q, double *x,
                          double *multipliers) {
    s->counters.sweeps += s->wisps;
    TIMED(s, sweep_springs, s->ops->sweep_springs(s->ctx, t, h, q, x, multipliers));
}

void system_assemble(struct system *s, double alpha, double beta, double *values) {
    s->counters.assemblies += s->wisps;
    TIMED(s, assemble, s->ops->assemble(s->ctx, alpha, beta, values));
}

int system_fail(struct system *s, int code, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(s->reason, sizeof s->reason, format, arguments);
    va_end(arguments);
    return code;
}
