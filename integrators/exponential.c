/* Exponential Rosenbrock-Euler: the equations linearised at the step's start, and that solved
 * exactly,
 *
 *     y1 = y0 + h phi_1(h J) F(y0),   phi_1(z) = (exp z - 1) / z,   y = (q, v, t),
 *
 * of order 2 with all of J. Time is an unknown like the others, so that forces may change with it.
 * The product of phi_1 with F is looked for in the Krylov
 * space of J and F, which grows until the estimate of what lies outside is small (Hochbruck, Lubich
 * & Selhofer 1998, SIAM J. Sci. Comput. 19, 1552; on hair Michels et al. 2014).
 *
 * Hair's springs are so much faster than its swing that the space must grow to the stiffest of
 * them: it is here to show by how much that loses. */
#include "stepper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TOLERANCE };
static const struct option_spec options[] = {
    [TOLERANCE] = {"krylov.tolerance",
                   "what may lie outside of the space, relative to the step's move", OPTION_REAL,
                   .initial = 1e-10, .least = 1e-14, .most = 0.1},
    {.name = NULL},
};

enum { DIMENSION = 60, ROWS = DIMENSION + 2 };
typedef double square[ROWS][ROWS];

struct exponential {
    struct stepper base;
    double tolerance;
    enum jacobian kind;
    int n;                         /* unknowns; a vector of the space has 2 n + 1 numbers */
    double *basis;                 /* DIMENSION + 1 of them, orthonormal in `inner` */
    double *w;                     /* the next one */
    double *right, *stiff;         /* of the mass matrix's solve */
    double *a, *rate;              /* acceleration, and its rate in time */
    double *q, *v;                 /* of the end */
    square h, power, sum, squared; /* the projected J, times h; for its exponential */
    double memory[];
};

static struct stepper *exponential_create(const struct stepper_settings *settings,
                                          struct system *system) {
    const size_t n = (size_t)system->size, vector = 2 * n + 1;
    struct exponential *s = malloc(sizeof *s + ((DIMENSION + 2) * vector + 6 * n) * sizeof(double));
    if (!s)
        return NULL;
    s->tolerance = option_value(&settings->options, &options[TOLERANCE]);
    s->kind = system->matrix[JACOBIAN_EXACT] & MATRIX_AVAILABLE ? JACOBIAN_EXACT : JACOBIAN_SPD;
    s->n = (int)n;
    s->basis = s->memory;
    s->w = s->basis + (DIMENSION + 1) * vector;
    s->right = s->w + vector;
    s->stiff = s->right + n;
    s->a = s->stiff + n;
    s->rate = s->a + n;
    s->q = s->rate + n;
    s->v = s->q + n;
    return &s->base;
}

static double *basis(const struct exponential *s, int j) {
    return s->basis + (size_t)j * (size_t)(2 * s->n + 1);
}

/* Positions count in units of h, as do times: so all parts of a vector are velocities. */
static double inner(const struct exponential *s, double h, const double *x, const double *y) {
    double positions = 0, velocities = 0;
    for (int i = 0; i < s->n; i++) {
        positions += x[i] * y[i];
        velocities += x[s->n + i] * y[s->n + i];
    }
    return (positions + x[2 * s->n] * y[2 * s->n]) / (h * h) + velocities;
}

/* w <- h J x: (v, M^-1 (K q + D v) + the forces' rate, 0). */
static void times_jacobian(struct exponential *s, double h, const double *x, double *w) {
    struct system *system = s->base.system;
    const int n = s->n;
    system_product(system, 0, 1, 0, x + n, s->right);
    system_product(system, 0, 0, 1, x, s->stiff);
    for (int i = 0; i < n; i++)
        s->right[i] += s->stiff[i];
    system_solve(system, s->right, w + n);
    for (int i = 0; i < n; i++) {
        w[n + i] = h * (w[n + i] + x[2 * n] * s->rate[i]);
        w[i] = h * x[n + i];
    }
    w[2 * n] = 0;
}

/* --- the exponential of a small matrix --- */

static void multiply(int m, square x, square y, square to) {
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            double sum = 0;
            for (int k = 0; k < m; k++)
                sum += x[i][k] * y[k][j];
            to[i][j] = sum;
        }
}

static double largest_row(int m, square x) {
    double largest = 0;
    for (int i = 0; i < m; i++) {
        double sum = 0;
        for (int j = 0; j < m; j++)
            sum += fabs(x[i][j]);
        largest = fmax(largest, sum);
    }
    return largest;
}

/* sum <- exp x by Taylor's series of x / 2^k, which is squared k times; x is changed. */
static void take_exponential(struct exponential *s, int m, square x) {
    enum { TERMS = 16 }; /* 0.5^17 / 17! is below the rounding */
    const double norm = largest_row(m, x);
    const int halvings = norm > 0.5 ? (int)ceil(log2(2 * norm)) : 0;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            x[i][j] = ldexp(x[i][j], -halvings);
            s->sum[i][j] = i == j;
        }
    for (int term = TERMS; term > 0; term--) {
        multiply(m, x, s->sum, s->squared);
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m; j++)
                s->sum[i][j] = (i == j) + s->squared[i][j] / term;
    }
    for (int k = 0; k < halvings; k++) {
        multiply(m, s->sum, s->sum, s->squared);
        memcpy(s->sum, s->squared, sizeof s->sum);
    }
}

/* phi_1(H) e_1 of the first m rows and columns, as the last column of the exponential of
 * (H e_1; 0 0). */
static void phi_1(struct exponential *s, int m, double *phi) {
    for (int i = 0; i <= m; i++)
        for (int j = 0; j <= m; j++)
            s->power[i][j] = i == m ? 0 : j == m ? i == 0 : s->h[i][j];
    take_exponential(s, m + 1, s->power);
    for (int i = 0; i < m; i++)
        phi[i] = s->sum[i][m];
}

/* --- the space --- */

/* w becomes the next vector of the basis, what it was a column of h. Returns its length. */
static double orthogonalise(struct exponential *s, double h, int j) {
    const int size = 2 * s->n + 1;
    for (int i = 0; i < DIMENSION + 1; i++)
        s->h[i][j] = 0;
    for (int pass = 0; pass < 2; pass++) /* the second takes the rounding of the first away */
        for (int i = 0; i <= j; i++) {
            const double part = inner(s, h, s->w, basis(s, i));
            s->h[i][j] += part;
            for (int k = 0; k < size; k++)
                s->w[k] -= part * basis(s, i)[k];
        }
    const double length = sqrt(inner(s, h, s->w, s->w));
    s->h[j + 1][j] = length;
    for (int k = 0; k < size; k++)
        basis(s, j + 1)[k] = length > 0 ? s->w[k] / length : 0;
    return length;
}

/* Makes the space of F, of length `length`, and writes phi_1(h J) F in its basis. Returns its
 * dimension, or 0: it would be too large. */
static int find_move(struct exponential *s, double h, double *phi) {
    const double breakdown = 1e-14;
    for (int j = 0, look = 3; j < DIMENSION; j++) {
        times_jacobian(s, h, basis(s, j), s->w);
        const double length = orthogonalise(s, h, j);
        const int ends = length <= breakdown * largest_row(j + 1, s->h);
        if (!ends && j + 1 < look && j + 1 < DIMENSION)
            continue;
        phi_1(s, j + 1, phi);
        if (ends || length * fabs(phi[j]) <= s->tolerance)
            return j + 1;
        look = (look * 5 + 3) / 4; /* the exponential costs more than a vector */
    }
    return 0;
}

static int evaluate(struct exponential *s, double t, const double *q, const double *v) {
    struct system *system = s->base.system;
    int code = system_acceleration(system, t, q, v, s->a);
    if (code)
        return code;
    system_time_rate(system, t, q, v, s->rate);
    code = system_linearise(system, s->kind, t, q, v);
    return code ? code : system_factor(system, 0, 0);
}

static int exponential_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct exponential *s = (struct exponential *)stepper;
    struct system *system = stepper->system;
    const int n = s->n;
    double phi[DIMENSION + 1], *first = basis(s, 0);
    const int code = evaluate(s, t, q, v);
    if (code)
        return code;
    memcpy(first, v, (size_t)n * sizeof(double));
    memcpy(first + n, s->a, (size_t)n * sizeof(double));
    first[2 * n] = 1;
    const double length = sqrt(inner(s, h, first, first));
    if (!isfinite(length))
        return system_fail(system, NOT_FINITE, "exponential: the state is not finite");
    for (int i = 0; i < 2 * n + 1; i++)
        first[i] /= length;
    const int dimension = find_move(s, h, phi);
    if (dimension == 0)
        return system_fail(system, SOLVER_STALLED,
                           "exponential: a Krylov space of %d vectors leaves more outside "
                           "than %g of the move",
                           DIMENSION, s->tolerance);
    memcpy(s->q, q, (size_t)n * sizeof(double));
    memcpy(s->v, v, (size_t)n * sizeof(double));
    for (int j = 0; j < dimension; j++)
        for (int i = 0; i < n; i++) {
            s->q[i] += h * length * phi[j] * basis(s, j)[i];
            s->v[i] += h * length * phi[j] * basis(s, j)[n + i];
        }
    return stepper_arrive(stepper, t + h, s->q, s->v, q, v);
}

static int exponential_refuse(const struct stepper_settings *settings, struct system *system) {
    (void)settings;
    if (!system->ops->linearise || !system->ops->factor)
        return system_fail(system, REFUSED, "exponential needs Jacobians, which %s does not have",
                           system->name);
    return 0;
}

/* The exact solution of a linear equation grows as that. */
static double complex amplification(double complex z, double complex partner) {
    return creal(partner) > creal(z) ? cexp(partner) : cexp(z);
}

const struct stepper_method exponential = {
    .name = "exponential",
    .summary = "exponential Rosenbrock-Euler in Krylov spaces",
    .reference = "Hochbruck, Ostermann & Schweitzer 2009, doi:10.1137/080717717; Michels et al. "
                 "2014, doi:10.1145/2508462",
    .order = 2,
    .capabilities = STEPPER_IMPLICIT | STEPPER_PROJECTS,
    .options = options,
    .usual_rate = 600,
    .lanes = 1, /* a space of its own for each wisp */
    .amplification = amplification,
    .refuse = exponential_refuse,
    .create = exponential_create,
    .step = exponential_step,
    .free = stepper_free,
};
