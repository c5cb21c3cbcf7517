/* Sparse Cholesky (SuiteSparse), of the upper triangle alone; the lower one is taken to mirror it.
 * Simplicial: a wisp's columns are too short for dense blocks to pay. */
#include "linear.h"

#include <cholmod.h>
#include <stdlib.h>
#include <string.h>

struct cholesky {
    struct linear_solver base;
    cholmod_common common;
    cholmod_sparse matrix; /* the pattern of the system with the values below */
    cholmod_factor *factor;
    cholmod_dense *x, *y, *e; /* solution and workspaces, made by the first solve */
    double values[];          /* in the order of the pattern */
};

static int cholesky_supports(const struct system *system) {
    return system->pattern && system->ops->assemble;
}

static void cholesky_free(struct linear_solver *solver) {
    struct cholesky *c = (struct cholesky *)solver;
    cholmod_free_dense(&c->x, &c->common);
    cholmod_free_dense(&c->y, &c->common);
    cholmod_free_dense(&c->e, &c->common);
    cholmod_free_factor(&c->factor, &c->common);
    cholmod_finish(&c->common);
    free(c);
}

static cholmod_sparse upper_triangle(const struct sparse_matrix *a, double *values) {
    return (cholmod_sparse){
        .nrow = (size_t)a->size,
        .ncol = (size_t)a->size,
        .nzmax = (size_t)a->column_start[a->size],
        .p = a->column_start,
        .i = a->row,
        .x = values,
        .stype = 1, /* symmetric, the upper triangle counts */
        .itype = CHOLMOD_INT,
        .xtype = CHOLMOD_REAL,
        .dtype = CHOLMOD_DOUBLE,
        .sorted = 1,
        .packed = 1,
    };
}

static struct linear_solver *cholesky_create(struct system *system, const struct options *options) {
    (void)options;
    const struct sparse_matrix *a = system->pattern;
    struct cholesky *c = malloc(sizeof *c + (size_t)a->column_start[a->size] * sizeof(double));
    if (!c)
        return NULL;
    cholmod_start(&c->common);
    c->common.supernodal = CHOLMOD_SIMPLICIAL;
    c->common.final_ll = 1; /* LL^T: LDL^T would go on with an indefinite matrix */
    c->common.print = 0;
    c->matrix = upper_triangle(a, c->values);
    c->x = c->y = c->e = NULL;
    c->factor = cholmod_analyze(&c->matrix, &c->common);
    if (!c->factor) {
        cholesky_free(&c->base);
        return NULL;
    }
    return &c->base;
}

static int cholesky_factor(struct linear_solver *solver, double alpha, double beta) {
    struct cholesky *c = (struct cholesky *)solver;
    struct system *system = solver->system;

    system_assemble(system, alpha, beta, c->values);
    system->counters.factorisations += system->wisps;
    cholmod_factorize(&c->matrix, c->factor, &c->common);
    if (c->common.status == CHOLMOD_OK)
        return 0;
    if (c->common.status == CHOLMOD_NOT_POSDEF)
        return system_fail(system, SOLVER_STALLED,
                           "cholmod: the matrix is not positive definite (column %zu)",
                           c->factor->minor);
    return system_fail(system, -OUT_OF_MEMORY, "cholmod: no memory for the factors");
}

static int cholesky_solve(struct linear_solver *solver, const double *b, double *x) {
    struct cholesky *c = (struct cholesky *)solver;
    const size_t n = (size_t)solver->system->size;
    cholmod_dense right = {
        .nrow = n,
        .ncol = 1,
        .nzmax = n,
        .d = n,
        .x = (void *)b, /* only read */
        .xtype = CHOLMOD_REAL,
        .dtype = CHOLMOD_DOUBLE,
    };
    if (!cholmod_solve2(CHOLMOD_A, c->factor, &right, NULL, &c->x, NULL, &c->y, &c->e, &c->common))
        return system_fail(solver->system, -OUT_OF_MEMORY, "cholmod: no memory for a solution");
    memcpy(x, c->x->x, n * sizeof(double));
    return 0;
}

const struct linear_method cholmod = {
    .name = "cholmod",
    .summary = "sparse Cholesky, simplicial, analysed once (SuiteSparse CHOLMOD)",
    .reference = "Chen, Davis, Hager & Rajamanickam 2008, ACM Trans. Math. Softw. 35, 22:1",
    .needs = MATRIX_SYMMETRIC | MATRIX_DEFINITE,
    .max_lanes = 1,
    .supports = cholesky_supports,
    .create = cholesky_create,
    .factor = cholesky_factor,
    .solve = cholesky_solve,
    .free = cholesky_free,
};
