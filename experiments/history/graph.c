#include "graph.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

/* v' = K q + D v, one unknown a node. */
struct graph {
    struct system system;
    struct reach reach;
    double *q, *v;
    gsl_matrix *matrix;
    gsl_permutation *order;
};

static const double time_step = 0.1; /* of 2 and less over the fastest frequency */

/* Entries of K, and a tenth of them of D: springs to all nodes within reach, which pull all with
 * different strength, so that nothing cancels, and one to where the node rests. */
static double coupling(int reach, int i, int j) {
    const int apart = abs(i - j);
    if (apart > reach)
        return 0;
    return apart > 0 ? 1. / (1 + apart) : -2. - reach;
}

static double entry(const struct graph *graph, double m, double d, double k, int i, int j) {
    return m * (i == j) + 0.1 * d * coupling(graph->reach.velocity, i, j) +
           k * coupling(graph->reach.position, i, j);
}

static void product(void *ctx, double m, double d, double k, const double *x, double *y) {
    const struct graph *graph = ctx;
    const int n = graph->system.size;
    for (int i = 0; i < n; i++) {
        y[i] = 0;
        for (int j = 0; j < n; j++)
            y[i] += entry(graph, m, d, k, i, j) * x[j];
    }
}

static int acceleration(void *ctx, double t, const double *q, const double *v, double *a) {
    (void)t;
    const struct graph *graph = ctx;
    const int n = graph->system.size;
    for (int i = 0; i < n; i++) {
        a[i] = 0;
        for (int j = 0; j < n; j++)
            a[i] += entry(graph, 0, 0, 1, i, j) * q[j] + entry(graph, 0, 1, 0, i, j) * v[j];
    }
    return 0;
}

static int linearise(void *ctx, enum jacobian kind, double t, const double *q, const double *v) {
    (void)ctx, (void)kind, (void)t, (void)q, (void)v;
    return 0;
}

static int factor(void *ctx, double alpha, double beta) {
    struct graph *graph = ctx;
    const int n = graph->system.size;
    int sign;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            gsl_matrix_set(graph->matrix, (size_t)i, (size_t)j,
                           entry(graph, 1, -alpha, -beta, i, j));
    return gsl_linalg_LU_decomp(graph->matrix, graph->order, &sign) ? SOLVER_STALLED : 0;
}

static void solve(void *ctx, const double *b, double *x) {
    const struct graph *graph = ctx;
    const size_t n = (size_t)graph->system.size;
    gsl_vector_const_view from = gsl_vector_const_view_array(b, n);
    gsl_vector_view to = gsl_vector_view_array(x, n);
    gsl_linalg_LU_solve(graph->matrix, graph->order, &from.vector, &to.vector);
}

static const struct system_ops ops = {.acceleration = acceleration,
                                      .linearise = linearise,
                                      .product = product,
                                      .factor = factor,
                                      .solve = solve};

static void graph_free(struct graph *graph) {
    free(graph->q);
    free(graph->v);
    gsl_matrix_free(graph->matrix);
    gsl_permutation_free(graph->order);
}

static int graph_make(struct graph *graph, int nodes, struct reach reach) {
    const size_t n = (size_t)nodes;
    const unsigned matrix =
        MATRIX_AVAILABLE | MATRIX_SYMMETRIC | MATRIX_DEFINITE | MATRIX_FACTORABLE;
    *graph =
        (struct graph){.system = {.ops = &ops,
                                  .ctx = graph,
                                  .name = "the graph of couplings",
                                  .size = nodes,
                                  .lanes = 1,
                                  .wisps = 1,
                                  .matrix = {[JACOBIAN_EXACT] = matrix, [JACOBIAN_SPD] = matrix}},
                       .reach = reach,
                       .q = calloc(n, sizeof(double)),
                       .v = calloc(n, sizeof(double)),
                       .matrix = gsl_matrix_alloc(n, n),
                       .order = gsl_permutation_alloc(n)};
    return graph->q && graph->v && graph->matrix && graph->order ? 0 : -1;
}

/* --- any method --- */

struct stepper *any_stepper(const struct stepper_method *method, struct system *system) {
    const struct stepper_settings settings = {
        .linear = method->capabilities & STEPPER_SOLVES ? linear_find("direct") : NULL,
        .rtol = 1e-2, /* no shorter steps than need be: what a short one passes on underflows */
        .atol = 1e-2};
    return stepper_refuse(method, &settings, system) ? NULL
                                                     : stepper_create(method, &settings, system);
}

int any_step(struct stepper *stepper, double *t, double h, double *q, double *v) {
    if (stepper->method->advance)
        return stepper->method->advance(stepper, t, *t + 1e3 * h, q, v);
    const int code = stepper->method->step(stepper, *t, h, q, v);
    *t += h;
    return code;
}

/* --- the count --- */

static void look(const struct graph *graph, int step, struct arrival *arrivals) {
    for (int i = 0; i < graph->system.size; i++)
        if (arrivals[i].step < 0 && (graph->q[i] != 0 || graph->v[i] != 0))
            arrivals[i] = (struct arrival){step, (int)graph->system.counters.force_evaluations};
}

int graph_arrivals(const struct stepper_method *method, int nodes, struct reach reach, int most,
                   struct arrival *arrivals, int *solves) {
    struct graph graph;
    double t = 0;
    int code = graph_make(&graph, nodes, reach);
    struct stepper *stepper = code ? NULL : any_stepper(method, &graph.system);
    if (!code && !stepper)
        code = 1;
    for (int i = 0; i < nodes; i++)
        arrivals[i] = (struct arrival){-1, -1};
    if (!code) {
        graph.q[nodes - 1] = 1;
        look(&graph, 0, arrivals);
    }
    for (int step = 1; !code && step <= most && arrivals[0].step < 0; step++) {
        code = any_step(stepper, &t, time_step, graph.q, graph.v) ? 1 : 0;
        look(&graph, step, arrivals);
    }
    *solves = (int)(graph.system.counters.linear_solves + graph.system.counters.part_solves);
    if (stepper)
        method->free(stepper);
    graph_free(&graph);
    return code;
}
