/* The real steppers on the smallest systems: by what factor a step grows, and how an oscillator
 * rings down. The seam is the one that wisps use; only the model is small. */
#include "stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the systems --- */

static int acceleration(void *ctx, double t, const double *q, const double *v, double *a) {
    (void)t;
    const struct small_system *s = ctx;
    for (int i = 0; i < s->n; i++) {
        a[i] = 0;
        for (int j = 0; j < s->n; j++)
            a[i] += s->k[i * s->n + j] * q[j] + s->d[i * s->n + j] * v[j];
    }
    return 0;
}

static int linearise(void *ctx, enum jacobian kind, double t, const double *q, const double *v) {
    (void)ctx, (void)kind, (void)t, (void)q, (void)v; /* it is linear */
    return 0;
}

/* The entry of m M + d D + k K. */
static double entry(const struct small_system *s, int i, int j, double m, double d, double k) {
    return m * (i == j) + d * s->d[i * s->n + j] + k * s->k[i * s->n + j];
}

static void product(void *ctx, double m, double d, double k, const double *x, double *y) {
    const struct small_system *s = ctx;
    for (int i = 0; i < s->n; i++) {
        y[i] = 0;
        for (int j = 0; j < s->n; j++)
            y[i] += entry(s, i, j, m, d, k) * x[j];
    }
}

static void assemble(void *ctx, double alpha, double beta, double *values) {
    const struct small_system *s = ctx;
    for (int j = 0; j < s->n; j++)
        for (int i = 0; i < s->n; i++)
            values[j * s->n + i] = entry(s, i, j, 1, -alpha, -beta);
}

static double determinant(const struct small_system *s) {
    const double *m = s->matrix;
    return s->n == 1 ? m[0] : m[0] * m[3] - m[1] * m[2];
}

static int factor(void *ctx, double alpha, double beta) {
    struct small_system *s = ctx;
    assemble(s, alpha, beta, s->matrix); /* by columns */
    return determinant(s) == 0 ? system_fail(&s->system, SOLVER_STALLED, "the matrix is singular")
                               : 0;
}

static void solve(void *ctx, const double *b, double *x) {
    const struct small_system *s = ctx;
    const double *m = s->matrix, over = 1 / determinant(s);
    if (s->n == 1) {
        x[0] = b[0] * over;
        return;
    }
    x[0] = (m[3] * b[0] - m[2] * b[1]) * over;
    x[1] = (m[0] * b[1] - m[1] * b[0]) * over;
}

static void begin(struct small_system *s, const char *name, int n, unsigned matrix) {
    static const struct system_ops ops = {
        .acceleration = acceleration,
        .linearise = linearise,
        .product = product,
        .factor = factor,
        .solve = solve,
        .assemble = assemble,
    };
    *s = (struct small_system){.n = n};
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++)
            s->row[j * n + i] = i;
        s->column_start[j + 1] = (j + 1) * n;
    }
    s->pattern = (struct sparse_matrix){.size = n, .column_start = s->column_start, .row = s->row};
    s->system = (struct system){
        .ops = &ops,
        .ctx = s,
        .name = name,
        .size = n,
        .lanes = 1,
        .wisps = 1,
        .matrix = {[JACOBIAN_EXACT] = MATRIX_AVAILABLE | MATRIX_FACTORABLE | matrix},
        .pattern = &s->pattern,
    };
}

void small_dahlquist(struct small_system *s, double complex z) {
    begin(s, "u' = z u", 2, 0);
    s->d[0] = s->d[3] = creal(z);
    s->d[1] = -cimag(z);
    s->d[2] = cimag(z);
}

void small_oscillator(struct small_system *s, double zeta) {
    begin(s, "the oscillator", 1, MATRIX_SYMMETRIC | MATRIX_DEFINITE);
    s->k[0] = -1;
    s->d[0] = -2 * zeta;
}

/* A stepper on the system with the defaults of its options and the direct solver, or NULL with a
 * reason in small->system: it refuses, or there is no memory. */
static struct stepper *small_stepper(const struct stepper_method *method, double tolerance,
                                     struct small_system *small) {
    struct stepper_settings settings = {.rtol = tolerance, .atol = 1e-3 * tolerance};
    if (method->capabilities & STEPPER_SOLVES)
        settings.linear = linear_find("direct");
    if (stepper_refuse(method, &settings, &small->system))
        return NULL;
    return stepper_create(method, &settings, &small->system);
}

/* From t over h: a step, or of adaptive methods as many as it takes. 0, or a code. */
static int go(struct stepper *stepper, double t, double h, double *q, double *v) {
    const struct stepper_method *method = stepper->method;
    double now = t;
    int code = 0;
    if (method->step)
        return method->step(stepper, t, h, q, v);
    while (now < t + h && !code)
        code = method->advance(stepper, &now, t + h, q, v);
    return code;
}

/* --- growth --- */

/* Nothing depends on q: u' = z u rides on v. */
static int is_first_order(const struct small_system *s) {
    for (int i = 0; i < s->n * s->n; i++)
        if (s->k[i] != 0)
            return 0;
    return 1;
}

static double norm(const struct small_system *s, const double *q, const double *v) {
    double square = 0;
    for (int i = 0; i < s->n; i++)
        square += v[i] * v[i] + (is_first_order(s) ? 0 : q[i] * q[i]);
    return sqrt(square);
}

/* A fixed step of a method without a history is a linear map on these systems: it is known from
 * what it makes of the ends of the plane, (q, v) of one unknown, or u of u' = z u. Row by row.
 * Returns 0, or -1 where a step fails. */
static int step_matrix(struct stepper *stepper, struct small_system *s, double h,
                       double matrix[4]) {
    const int first_order = is_first_order(s);
    for (int j = 0; j < 2; j++) {
        double q[2] = {!first_order && j == 0, 0}, v[2] = {j == (first_order ? 0 : 1), 0};
        v[1] = first_order && j == 1;
        if (go(stepper, 0, h, q, v))
            return -1;
        matrix[j] = first_order ? v[0] : q[0];
        matrix[2 + j] = first_order ? v[1] : v[0];
        if (!isfinite(matrix[j]) || !isfinite(matrix[2 + j]))
            return -1;
    }
    return 0;
}

/* One eigenvalue, in the upper half plane where they are complex; the other is as far on the other
 * side of half the trace. */
static double complex eigenvalue(const double m[4]) {
    const double half = (m[0] - m[3]) / 2;
    return (m[0] + m[3]) / 2 + csqrt(half * half + m[1] * m[2]);
}

static int has_matrix(const struct stepper_method *method) {
    return method->step && !method->reset;
}

static double matrix_growth(struct stepper *stepper, struct small_system *s, double h) {
    double m[4];
    if (step_matrix(stepper, s, h, m))
        return INFINITY;
    const double complex one = eigenvalue(m);
    return fmax(cabs(one), cabs(m[0] + m[3] - one));
}

/* log of the growth over so many steps. Fixed steps are linear maps, so that the state may be
 * scaled before it overflows; an adaptive method would see another problem, and is not. */
static int add_growth(struct stepper *stepper, struct small_system *s, double h, int steps,
                      double *t, double *q, double *v, double *log_growth) {
    double from = norm(s, q, v);
    *log_growth = 0;
    for (int i = 0; i < steps; i++, *t += h) {
        if (go(stepper, *t, h, q, v))
            return -1;
        const double now = norm(s, q, v);
        if (is_first_order(s)) /* what v moves is nothing to it, and would overflow */
            q[0] = q[1] = 0;
        if (now == 0) {
            *log_growth = -INFINITY;
            return 0;
        }
        if (!isfinite(now))
            return -1;
        if (stepper->method->step && (now > 1e100 || now < 1e-100)) {
            *log_growth += log(now / from);
            from = 1;
            for (int k = 0; k < s->n; k++) {
                q[k] /= now;
                v[k] /= now;
            }
        }
    }
    *log_growth += log(norm(s, q, v) / from);
    return 0;
}

enum { LEAD_IN = 100, STEPS = 300, ADAPTIVE_STEPS = 40 };

/* Over a train of steps. */
static double train_growth(const struct stepper_method *method, double tolerance,
                           struct small_system *s, double h) {
    double largest = 0;
    /* From both ends of the plane: one start may lie in the mode that dies out. */
    for (int start = 0; start < (is_first_order(s) ? 1 : 2); start++) {
        double q[2] = {start == 0 && !is_first_order(s), 0}, v[2] = {q[0] == 0, 0};
        double t = 0, lead_in, growth = 0;
        const int steps = method->step ? STEPS : ADAPTIVE_STEPS;
        struct stepper *stepper = small_stepper(method, tolerance, s);
        if (!stepper)
            return NAN;
        int code = add_growth(stepper, s, h, method->step ? LEAD_IN : 0, &t, q, v, &lead_in);
        if (!code && lead_in > -INFINITY)
            code = add_growth(stepper, s, h, steps, &t, q, v, &growth);
        else if (!code)
            growth = -INFINITY;
        method->free(stepper);
        largest = fmax(largest, code ? INFINITY : exp(growth / steps));
    }
    return largest;
}

double measured_growth(const struct stepper_method *method, double tolerance,
                       struct small_system *s, double h) {
    if (!has_matrix(method))
        return train_growth(method, tolerance, s, h);
    struct stepper *stepper = small_stepper(method, tolerance, s);
    if (!stepper)
        return NAN;
    const double growth = matrix_growth(stepper, s, h);
    method->free(stepper);
    return growth;
}

/* --- ringing down --- */

enum { TRAIN = 200 };

/* Slopes of log amplitude and of phase over time. */
struct ring_fit {
    double n, t, tt, log_r, t_log_r, phase, t_phase;
};

static void fit_add(struct ring_fit *f, double t, double log_r, double phase) {
    f->n++;
    f->t += t;
    f->tt += t * t;
    f->log_r += log_r;
    f->t_log_r += t * log_r;
    f->phase += phase;
    f->t_phase += t * phase;
}

/* With y = q - i v an undamped oscillator turns by exp(i t); a method's own turns by
 * exp((-damping + i (1 + shift) ...) t). The damping is given over the whole rate, as of critical.
 */
static struct ring_down ring_of(double log_rate, double phase_rate, double steps_per_period) {
    return (struct ring_down){-log_rate / hypot(log_rate, phase_rate), phase_rate - 1,
                              steps_per_period};
}

/* One accepted step: the method's own, or of h. */
static int one_step(struct stepper *stepper, double *t, double h, double end, double *q,
                    double *v) {
    if (stepper->method->advance)
        return stepper->method->advance(stepper, t, end, q, v);
    const int code = stepper->method->step(stepper, *t, h, q, v);
    *t += h;
    return code;
}

static const struct ring_down unknown = {NAN, NAN, NAN};

/* The ring-down of one step, by the eigenvalue that turns as the step turns y = 1. */
static struct ring_down matrix_ring_down(struct stepper *stepper, struct small_system *s,
                                         double h) {
    double m[4];
    if (step_matrix(stepper, s, h, m))
        return unknown;
    const double complex upper = eigenvalue(m), turn = m[2] <= 0 ? upper : conj(upper);
    if (cimag(upper) == 0 || fabs(carg(turn)) > 0.9 * M_PI)
        return unknown;
    return ring_of(log(cabs(turn)) / h, carg(turn) / h, 2 * M_PI / h);
}

/* The ring-down of a train of steps. */
static struct ring_down train_ring_down(const struct stepper_method *method, double tolerance,
                                        double h) {
    struct small_system small;
    struct ring_fit f = {0};
    const double end = 2 * M_PI * 30;
    double q = 1, v = 0, t = 0, phase = 0, largest = 0;
    int code = 0, steps = 0;
    small_oscillator(&small, 0);
    struct stepper *stepper = small_stepper(method, tolerance, &small);
    if (!stepper)
        return unknown;
    for (; !code && (method->advance ? t < end : steps < TRAIN); steps++) {
        const double complex before = q - I * v;
        code = one_step(stepper, &t, h, end, &q, &v);
        const double complex y = q - I * v;
        const double turn = carg(y / before);
        phase += turn;
        largest = fmax(largest, fabs(turn));
        if (!isfinite(cabs(y)) || cabs(y) == 0)
            code = -1;
        fit_add(&f, t, log(cabs(y)), phase);
    }
    method->free(stepper);
    if (code || largest > 0.9 * M_PI)
        return unknown;
    const double spread = f.n * f.tt - f.t * f.t;
    return ring_of((f.n * f.t_log_r - f.t * f.log_r) / spread,
                   (f.n * f.t_phase - f.t * f.phase) / spread, 2 * M_PI * steps / t);
}

struct ring_down measured_ring_down(const struct stepper_method *method, double tolerance,
                                    double h) {
    if (!has_matrix(method))
        return train_ring_down(method, tolerance, h);
    struct small_system small;
    small_oscillator(&small, 0);
    struct stepper *stepper = small_stepper(method, tolerance, &small);
    if (!stepper)
        return unknown;
    const struct ring_down ring = matrix_ring_down(stepper, &small, h);
    method->free(stepper);
    return ring;
}

struct ring_down predicted_ring_down(const struct stepper_method *method, double h) {
    const double complex r = stepper_amplification(method, I * h, -I * h);
    return ring_of(log(cabs(r)) / h, carg(r) / h, 2 * M_PI / h);
}
