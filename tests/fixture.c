#include "fixture.h"

#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const fixture_call_names[] = {"acceleration", "linearise", "factor", "project"};

double random_number(unsigned *state) {
    *state = *state * 1664525u + 1013904223u; /* Numerical Recipes' quick one */
    return (*state >> 8) / 16777216.;
}

/* --- dense algebra, row by row --- */

static int lu_factor(int n, double *a, int *pivot) {
    for (int k = 0; k < n; k++) {
        pivot[k] = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[pivot[k] * n + k]))
                pivot[k] = i;
        if (a[pivot[k] * n + k] == 0)
            return -1;
        for (int j = 0; j < n; j++) {
            const double swapped = a[k * n + j];
            a[k * n + j] = a[pivot[k] * n + j];
            a[pivot[k] * n + j] = swapped;
        }
        for (int i = k + 1; i < n; i++) {
            a[i * n + k] /= a[k * n + k];
            for (int j = k + 1; j < n; j++)
                a[i * n + j] -= a[i * n + k] * a[k * n + j];
        }
    }
    return 0;
}

static void lu_solve(int n, const double *a, const int *pivot, const double *b, double *x) {
    memcpy(x, b, (size_t)n * sizeof *x);
    for (int k = 0; k < n; k++) {
        const double swapped = x[k];
        x[k] = x[pivot[k]];
        x[pivot[k]] = swapped;
    }
    for (int i = 1; i < n; i++)
        for (int j = 0; j < i; j++)
            x[i] -= a[i * n + j] * x[j];
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++)
            x[i] -= a[i * n + j] * x[j];
        x[i] /= a[i * n + i];
    }
}

void dense_solve(int n, const double *a, const double *b, double *x) {
    double lu[FIXTURE_SIZE_MAX * FIXTURE_SIZE_MAX];
    int pivot[FIXTURE_SIZE_MAX];
    memcpy(lu, a, (size_t)(n * n) * sizeof *lu);
    lu_factor(n, lu, pivot);
    lu_solve(n, lu, pivot, b, x);
}

/* --- the operations --- */

/* Whether this call is one that fails. */
static int fails(struct fixture *f, enum fixture_call call) {
    const int count = ++f->calls[call];
    if (f->fail_at == 0 || call != f->fail_call)
        return 0;
    const int now = count == f->fail_at || (f->fail_on && count > f->fail_at);
    f->failures += now;
    return now;
}

static int fail(struct fixture *f) {
    return system_fail(f->reports_to, f->fail_code, "told to fail");
}

static int acceleration(void *ctx, double t, const double *q, const double *v, double *a) {
    struct fixture *f = ctx;
    const int failing = fails(f, CALL_ACCELERATION);
    if (failing && !f->nan) {
        for (int i = 0; i < f->n; i++)
            a[i] = 1e300; /* what a failed call leaves must not be used */
        return fail(f);
    }
    f->rate(f, t, q, v, a);
    if (failing)
        a[0] = NAN;
    return 0;
}

static int project(void *ctx, double t, double *q, double *v) {
    (void)t;
    struct fixture *f = ctx;
    if (!fails(f, CALL_PROJECT))
        return 0;
    for (int i = 0; i < f->n; i++)
        q[i] = v[i] = 1e300;
    return fail(f);
}

static int linearise(void *ctx, enum jacobian kind, double t, const double *q, const double *v) {
    (void)kind;
    struct fixture *f = ctx;
    if (fails(f, CALL_LINEARISE))
        return fail(f);
    f->jacobians(f, t, q, v);
    return 0;
}

static void product(void *ctx, double m, double d, double k, const double *x, double *y) {
    const struct fixture *f = ctx;
    for (int i = 0; i < f->n; i++) {
        y[i] = 0;
        for (int j = 0; j < f->n; j++) {
            const int at = i * f->n + j;
            y[i] += (m * f->m[at] + d * f->d[at] + k * f->k[at]) * x[j];
        }
    }
}

static int factor(void *ctx, double alpha, double beta) {
    struct fixture *f = ctx;
    if (fails(f, CALL_FACTOR))
        return fail(f);
    for (int i = 0; i < f->n * f->n; i++)
        f->lu[i] = f->m[i] - alpha * f->d[i] - beta * f->k[i];
    return lu_factor(f->n, f->lu, f->pivot)
               ? system_fail(f->reports_to, SOLVER_STALLED, "the fixture's matrix is singular")
               : 0;
}

static void solve(void *ctx, const double *b, double *x) {
    const struct fixture *f = ctx;
    lu_solve(f->n, f->lu, f->pivot, b, x);
}

static void assemble(void *ctx, double alpha, double beta, double *values) {
    const struct fixture *f = ctx;
    for (int j = 0; j < f->n; j++)
        for (int at = f->column_start[j]; at < f->column_start[j + 1]; at++) {
            const int i = f->row[at] * f->n + j;
            values[at] = f->m[i] - alpha * f->d[i] - beta * f->k[i];
        }
}

/* By differences of fourth order, to about 1e-12. */
static void time_rate(void *ctx, double t, const double *q, const double *v, double *rate) {
    const struct fixture *f = ctx;
    const double h = 1e-3;
    double a[4][FIXTURE_SIZE_MAX] = {{0}};
    for (int k = 0; k < 4; k++)
        f->rate(f, t + h * (k < 2 ? k - 2 : k - 1), q, v, a[k]);
    for (int i = 0; i < f->n; i++)
        rate[i] = (8 * (a[2][i] - a[1][i]) - (a[3][i] - a[0][i])) / (12 * h);
}

static const struct system_ops without_projection = {
    .acceleration = acceleration,
    .time_rate = time_rate,
    .linearise = linearise,
    .product = product,
    .factor = factor,
    .solve = solve,
    .assemble = assemble,
};

static const struct system_ops with_projection = {
    .acceleration = acceleration,
    .time_rate = time_rate,
    .project = project,
    .linearise = linearise,
    .product = product,
    .factor = factor,
    .solve = solve,
    .assemble = assemble,
};

void fixture_begin(struct fixture *f, const char *name, int n, int band, unsigned matrix) {
    *f = (struct fixture){.n = n, .reports_to = &f->system};
    for (int j = 0, used = 0; j < n; j++) {
        for (int i = j > band ? j - band : 0; i <= j + band && i < n; i++)
            f->row[used++] = i;
        f->column_start[j + 1] = used;
    }
    f->pattern = (struct sparse_matrix){.size = n, .column_start = f->column_start, .row = f->row};
    f->system = (struct system){
        .ops = &without_projection,
        .ctx = f,
        .name = name,
        .size = n,
        .lanes = 1,
        .wisps = 1,
        .matrix = {[JACOBIAN_EXACT] = matrix | MATRIX_FACTORABLE, [JACOBIAN_SPD] = 0},
        .pattern = &f->pattern,
    };
    for (int i = 0; i < n; i++)
        f->m[i * n + i] = 1;
}

void fixture_add_projection(struct fixture *fixture) {
    fixture->system.ops = &with_projection;
}

/* --- the systems --- */

static void no_jacobian_changes(struct fixture *f, double t, const double *q, const double *v) {
    (void)f, (void)t, (void)q, (void)v;
}

static void chain_rate(const struct fixture *f, double t, const double *q, const double *v,
                       double *a) {
    double force[FIXTURE_SIZE_MAX];
    for (int i = 0; i < f->n; i++) {
        force[i] = cos(t);
        for (int j = 0; j < f->n; j++)
            force[i] += f->k[i * f->n + j] * q[j] + f->d[i * f->n + j] * v[j];
    }
    dense_solve(f->n, f->m, force, a);
}

/* matrix <- matrix + strength (e_i - e_j)(e_i - e_j)'; j < 0: the fixed end. */
static void add_link(double *matrix, int n, int i, int j, double strength) {
    matrix[i * n + i] += strength;
    if (j < 0)
        return;
    matrix[j * n + j] += strength;
    matrix[i * n + j] -= strength;
    matrix[j * n + i] -= strength;
}

void fixture_chain(struct fixture *f, int n, unsigned seed, int symmetric) {
    fixture_begin(f, symmetric ? "the chain" : "the skew chain", n, 1,
                  MATRIX_AVAILABLE | (symmetric ? MATRIX_SYMMETRIC | MATRIX_DEFINITE : 0));
    f->system.matrix_note = symmetric ? NULL : "made so";
    for (int i = 0; i < n; i++) {
        add_link(f->m, n, i, i - 1, random_number(&seed));
        add_link(f->k, n, i, i - 1, -1 - 9 * random_number(&seed));
        add_link(f->d, n, i, i - 1, -random_number(&seed));
        if (!symmetric && i > 0) {
            f->d[(i - 1) * n + i] += 0.3 * random_number(&seed);
            f->k[(i - 1) * n + i] += 0.3 * random_number(&seed);
        }
    }
    f->rate = chain_rate;
    f->jacobians = no_jacobian_changes;
}

static void dahlquist_rate(const struct fixture *f, double t, const double *q, const double *v,
                           double *a) {
    (void)t, (void)q;
    a[0] = f->d[0] * v[0] + f->d[1] * v[1];
    a[1] = f->d[2] * v[0] + f->d[3] * v[1];
}

void fixture_dahlquist(struct fixture *f, double complex z) {
    fixture_begin(f, "u' = z u", 2, 1, MATRIX_AVAILABLE);
    f->d[0] = f->d[3] = creal(z);
    f->d[1] = -cimag(z);
    f->d[2] = cimag(z);
    f->rate = dahlquist_rate;
    f->jacobians = no_jacobian_changes;
}

static void quadrature_rate(const struct fixture *f, double t, const double *q, const double *v,
                            double *a) {
    (void)f, (void)q, (void)v;
    a[0] = cos(t);
}

void fixture_quadrature(struct fixture *f) {
    fixture_begin(f, "u' = cos t", 1, 0, MATRIX_AVAILABLE | MATRIX_SYMMETRIC | MATRIX_DEFINITE);
    f->rate = quadrature_rate;
    f->jacobians = no_jacobian_changes;
}

static double g(double q, double v) {
    return -q * q * q - q * v * v / 2 - v / 3;
}

static void manufactured_rate(const struct fixture *f, double t, const double *q, const double *v,
                              double *a) {
    (void)f;
    a[0] = -sin(t) + g(q[0], v[0]) - g(sin(t), cos(t));
}

static void manufactured_jacobians(struct fixture *f, double t, const double *q, const double *v) {
    (void)t;
    f->k[0] = -3 * q[0] * q[0] - v[0] * v[0] / 2;
    f->d[0] = -q[0] * v[0] - 1. / 3;
}

void fixture_manufactured(struct fixture *f) {
    fixture_begin(f, "the made-up oscillator", 1, 0, MATRIX_AVAILABLE | MATRIX_SYMMETRIC);
    f->rate = manufactured_rate;
    f->jacobians = manufactured_jacobians;
}

/* --- as a problem --- */

struct fixture_start fixture_start;

static const int own_parent[] = {0};

static const char *const columns[] = {"wisp", "node", "x", "y", "z", "vx", "vy", "vz", NULL};

struct fixture_model {
    struct model model;
    struct part part;
    struct fixture fixture;
    double q[FIXTURE_SIZE_MAX], v[FIXTURE_SIZE_MAX];
};

static struct model *create(const struct scene *scene, int treatment, int lanes) {
    (void)scene, (void)treatment, (void)lanes;
    struct fixture_model *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    fixture_start.make(&m->fixture);
    if (fixture_start.change)
        fixture_start.change(&m->fixture);
    m->fixture.reports_to = &m->part.system;
    m->part = (struct part){.system = m->fixture.system, .q = m->q, .v = m->v};
    m->q[0] = fixture_start.q;
    m->v[0] = fixture_start.v;
    m->model = (struct model){.problem = &fixture_problem,
                              .parts = &m->part,
                              .part_count = 1,
                              .row_count = 1,
                              .parent = own_parent,
                              .columns = columns,
                              .column_count = 8};
    return &m->model;
}

static void free_model(struct model *model) {
    free(model);
}

static void sample(const struct model *model, double *rows) {
    const struct fixture_model *m = (const struct fixture_model *)model;
    memcpy(rows, (double[]){0, 0, m->q[0], 0, 0, m->v[0], 0, 0}, 8 * sizeof *rows);
}

static int default_treatment(const struct stepper_method *method) {
    (void)method;
    return 0;
}

static const char *default_linear(const struct stepper_method *method) {
    (void)method;
    return "direct";
}

static const struct treatment treatments[] = {{"free", "as it is"}, {0}};

const struct problem fixture_problem = {
    .name = "fixture",
    .treatments = treatments,
    .default_treatment = default_treatment,
    .default_linear = default_linear,
    .create = create,
    .free = free_model,
    .sample = sample,
};

struct scene *fixture_scene(double duration, double frame_rate, double step) {
    struct scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return NULL;
    *scene = (struct scene){.name = "fixture",
                            .problem = &fixture_problem,
                            .duration = duration,
                            .frame_rate = frame_rate,
                            .seed = 1,
                            .run = {.step = step, .rtol = 1e-6, .atol = 1e-9},
                            .source = json_pack("{s:f, s:f, s:f}", "duration", duration,
                                                "frame_rate", frame_rate, "step", step)};
    return test_owns_scene(scene);
}
