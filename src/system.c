#include "system.h"

#include <stdarg.h>
#include <stdio.h>

int system_acceleration(struct system *s, double t, const double *q, const double *v, double *a) {
    s->counters.force_evaluations += s->wisps;
    return s->ops->acceleration(s->ctx, t, q, v, a);
}

int system_has_projection(const struct system *s) {
    return s->ops->project != NULL;
}

int system_project(struct system *s, double t, double *q, double *v) {
    s->counters.projections += s->wisps;
    return s->ops->project(s->ctx, t, q, v);
}

int system_linearise(struct system *s, enum jacobian kind, double t, const double *q,
                     const double *v) {
    s->counters.linearisations += s->wisps;
    return s->ops->linearise(s->ctx, kind, t, q, v);
}

void system_product(struct system *s, double m, double d, double k, const double *x, double *y) {
    s->counters.jacobian_products += s->wisps;
    s->ops->product(s->ctx, m, d, k, x, y);
}

int system_factor(struct system *s, double alpha, double beta) {
    s->counters.factorisations += s->wisps;
    return s->ops->factor(s->ctx, alpha, beta);
}

void system_solve(struct system *s, const double *b, double *x) {
    s->ops->solve(s->ctx, b, x);
}

void system_assemble(struct system *s, double alpha, double beta, double *values) {
    s->counters.assemblies += s->wisps;
    s->ops->assemble(s->ctx, alpha, beta, values);
}

int system_fail(struct system *s, int code, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(s->reason, sizeof s->reason, format, arguments);
    va_end(arguments);
    return code;
}
