#include "circle.h"

#include "model.h"
#include "problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FREE, PROJECTION, GENERALISED };

static const struct treatment treatments[] = {
    [FREE] = {"free", "position and velocity in the plane, no constraint"},
    [PROJECTION] = {"projection", "after each step put back to the radius and the speed"},
    [GENERALISED] = {"generalised", "the angle is the only unknown"},
    {0},
};

static const int own_parent[] = {0};

struct circle {
    struct model model;
    struct part part;
    int treatment;
    double state[4];                 /* q, then v */
    double stiffness[4], damping[4]; /* K and D, row by row; 0 in `generalised` */
    double matrix[4], determinant;   /* M - alpha D - beta K, M = 1 */
    struct sparse_matrix pattern;
};

/* The matrix is full: columns (0, 1) with rows (0, 1) each. */
static int column_start_1[] = {0, 1}, column_start_2[] = {0, 2, 4};
static int rows_1[] = {0}, rows_2[] = {0, 1, 0, 1};

void circle_exact(double t, double position[2]) {
    position[0] = CIRCLE_RADIUS * cos(CIRCLE_RATE * t);
    position[1] = -CIRCLE_RADIUS * sin(CIRCLE_RATE * t);
}

static int is_angle(const struct circle *circle) {
    return circle->treatment == GENERALISED;
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1];
}

/* The centre is where the force has no direction. */
static int at_centre(struct circle *circle) {
    return system_fail(&circle->part.system, MODEL_FAILED,
                       "the particle is at the centre, where the force is not defined");
}

/* On the circle the force has no part along the motion: the angle turns freely. */
static int acceleration(void *ctx, double t, const double *p, const double *v, double *a) {
    (void)t;
    if (is_angle(ctx)) {
        a[0] = 0;
        return 0;
    }
    const double pp = dot(p, p);
    if (pp == 0)
        return at_centre(ctx);
    const double factor = -dot(v, v) / pp;
    a[0] = factor * p[0];
    a[1] = factor * p[1];
    return 0;
}

/* K = -(v.v)/(p.p) (1 - 2 p p'/(p.p)),  D = -2 p v'/(p.p). */
static int linearise(void *ctx, enum jacobian kind, double t, const double *p, const double *v) {
    (void)kind, (void)t;
    struct circle *circle = ctx;
    if (is_angle(circle))
        return 0;
    const double pp = dot(p, p);
    if (pp == 0)
        return at_centre(ctx);
    const double factor = -dot(v, v) / pp;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            circle->stiffness[2 * i + j] = factor * ((i == j) - 2 * p[i] * p[j] / pp);
            circle->damping[2 * i + j] = -2 * p[i] * v[j] / pp;
        }
    return 0;
}

static int project(void *ctx, double t, double *p, double *v) {
    (void)t;
    const double radius = sqrt(dot(p, p)), speed = sqrt(dot(v, v));
    if (radius == 0 || speed == 0)
        return at_centre(ctx);
    for (int i = 0; i < 2; i++) {
        p[i] *= CIRCLE_RADIUS / radius;
        v[i] *= CIRCLE_SPEED / speed;
    }
    return 0;
}

static void product(void *ctx, double m, double d, double k, const double *x, double *y) {
    const struct circle *circle = ctx;
    const int n = circle->part.system.size;
    for (int i = 0; i < n; i++) {
        y[i] = m * x[i];
        for (int j = 0; j < n; j++)
            y[i] += (d * circle->damping[n * i + j] + k * circle->stiffness[n * i + j]) * x[j];
    }
}

static double entry(const struct circle *circle, double alpha, double beta, int i, int j) {
    const int at = circle->part.system.size * i + j;
    return (i == j) - alpha * circle->damping[at] - beta * circle->stiffness[at];
}

static void assemble(void *ctx, double alpha, double beta, double *values) {
    const struct circle *circle = ctx;
    const int n = circle->part.system.size;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            values[n * j + i] = entry(circle, alpha, beta, i, j);
}

static int factor(void *ctx, double alpha, double beta) {
    struct circle *circle = ctx;
    const int n = circle->part.system.size;
    double *m = circle->matrix;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            m[n * i + j] = entry(circle, alpha, beta, i, j);
    circle->determinant = n == 1 ? m[0] : m[0] * m[3] - m[1] * m[2];
    if (circle->determinant == 0)
        return system_fail(&circle->part.system, SOLVER_STALLED, "the 2x2 matrix is singular");
    return 0;
}

static void solve(void *ctx, const double *b, double *x) {
    const struct circle *circle = ctx;
    const double *m = circle->matrix;
    if (circle->part.system.size == 1) {
        x[0] = b[0] / circle->determinant;
        return;
    }
    x[0] = (m[3] * b[0] - m[1] * b[1]) / circle->determinant;
    x[1] = (m[0] * b[1] - m[2] * b[0]) / circle->determinant;
}

static const struct system_ops ops = {.acceleration = acceleration,
                                      .linearise = linearise,
                                      .product = product,
                                      .factor = factor,
                                      .solve = solve,
                                      .assemble = assemble};

static const struct system_ops projecting_ops = {.acceleration = acceleration,
                                                 .project = project,
                                                 .linearise = linearise,
                                                 .product = product,
                                                 .factor = factor,
                                                 .solve = solve,
                                                 .assemble = assemble};

static struct model *circle_create(const struct scene *scene, int treatment, int lanes) {
    static const char *const names[] = {"the circle (free)", "the circle (projection)",
                                        "the circle (generalised)"};
    (void)scene, (void)lanes;
    struct circle *circle = calloc(1, sizeof *circle);
    if (!circle)
        return NULL;

    const int angle = treatment == GENERALISED;
    const unsigned always = MATRIX_AVAILABLE | MATRIX_FACTORABLE;
    circle->treatment = treatment;
    circle->pattern =
        (struct sparse_matrix){.size = angle ? 1 : 2,
                               .column_start = angle ? column_start_1 : column_start_2,
                               .row = angle ? rows_1 : rows_2};
    circle->part = (struct part){
        .system = {.ops = treatment == PROJECTION ? &projecting_ops : &ops,
                   .ctx = circle,
                   .name = names[treatment],
                   .size = circle->pattern.size,
                   .lanes = 1,
                   .wisps = 1,
                   .matrix = {[JACOBIAN_EXACT] =
                                  angle ? always | MATRIX_SYMMETRIC | MATRIX_DEFINITE : always},
                   .matrix_note = angle ? NULL : "df/dv = -2m p v'/(p.p); use --linear direct",
                   .pattern = &circle->pattern},
        .q = circle->state,
        .v = circle->state + 2,
    };
    circle->model = (struct model){.problem = &circle_problem,
                                   .parts = &circle->part,
                                   .part_count = 1,
                                   .row_count = 1,
                                   .parent = own_parent,
                                   .columns = node_columns,
                                   .column_count = NODE_COLUMNS,
                                   .rate_columns = node_rate_columns,
                                   .rate_column_count = NODE_RATE_COLUMNS};
    if (angle) {
        circle->part.v[0] = -CIRCLE_RATE;
    } else {
        circle->part.q[0] = CIRCLE_RADIUS;
        circle->part.v[1] = -CIRCLE_SPEED;
    }
    return &circle->model;
}

static void circle_free(struct model *model) {
    free(model);
}

static void circle_sample(const struct model *model, double *row) {
    const struct circle *circle = (const struct circle *)model;
    const double *q = circle->part.q, *v = circle->part.v;
    double p[2] = {q[0], q[1]}, velocity[2] = {v[0], v[1]};
    if (is_angle(circle)) {
        p[0] = CIRCLE_RADIUS * cos(q[0]);
        p[1] = CIRCLE_RADIUS * sin(q[0]);
        velocity[0] = -v[0] * p[1];
        velocity[1] = v[0] * p[0];
    }
    memcpy(row, (double[]){0, 0, p[0], p[1], 0, velocity[0], velocity[1], 0},
           NODE_COLUMNS * sizeof *row);
}

/* In `generalised` the particle has the centripetal acceleration that the angle does not see. */
static void circle_sample_accelerations(const struct model *model, double *const *a, double *row) {
    const struct circle *circle = (const struct circle *)model;
    const double *q = circle->part.q, *v = circle->part.v;
    double x = a[0][0], y = a[0][circle->part.system.size - 1];
    if (is_angle(circle)) {
        const double c = CIRCLE_RADIUS * cos(q[0]), s = CIRCLE_RADIUS * sin(q[0]);
        x = -a[0][0] * s - v[0] * v[0] * c;
        y = a[0][0] * c - v[0] * v[0] * s;
    }
    memcpy(row, (double[]){0, 0, x, y, 0}, NODE_RATE_COLUMNS * sizeof *row);
}

static void circle_restore(struct model *model, const double *row) {
    struct circle *circle = (struct circle *)model;
    double *q = circle->part.q, *v = circle->part.v;
    if (is_angle(circle)) {
        q[0] = atan2(row[3], row[2]);
        v[0] = (row[2] * row[6] - row[3] * row[5]) / (row[2] * row[2] + row[3] * row[3]);
        return;
    }
    memcpy(q, row + 2, 2 * sizeof *q);
    memcpy(v, row + 5, 2 * sizeof *v);
}

static struct unknown circle_unknown(const struct model *model, int i, int k) {
    const int angle = is_angle((const struct circle *)model);
    (void)i;
    return (struct unknown){0, 0, angle ? "angle" : node_columns[2 + k], angle ? "rad" : "m"};
}

static int circle_terms(const struct scene *scene, const char **names, int most) {
    (void)scene, (void)most;
    names[0] = "centripetal";
    return 1;
}

const struct problem circle_problem = {
    .name = "circle",
    .treatments = treatments,
    .default_treatment = first_treatment,
    .default_linear = direct_solver,
    .create = circle_create,
    .free = circle_free,
    .sample = circle_sample,
    .restore = circle_restore,
    .sample_accelerations = circle_sample_accelerations,
    .unknown = circle_unknown,
    .terms = circle_terms,
};
