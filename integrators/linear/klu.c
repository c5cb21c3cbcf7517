/* Sparse LU with partial pivoting (SuiteSparse): any matrix, symmetric or not. */
#include "linear.h"

#include <klu.h>
#include <stdlib.h>
#include <string.h>

/* The pivots of an older matrix are kept while no column of U outgrows its column of the matrix
 * by more than the inverse of this: half of the digits are then still right. */
static const double least_reciprocal_growth = 1e-8;

struct lu {
    struct linear_solver base;
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric; /* NULL before the first factor and after a singular matrix */
    double values[];      /* in the order of the pattern */
};

static int lu_supports(const struct system *system) {
    return system->pattern && system->ops->assemble;
}

static struct linear_solver *lu_create(struct system *system, const struct options *options) {
    (void)options;
    const struct sparse_matrix *a = system->pattern;
    struct lu *lu = malloc(sizeof *lu + (size_t)a->column_start[a->size] * sizeof(double));
    if (!lu)
        return NULL;
    klu_defaults(&lu->common);
    lu->numeric = NULL;
    lu->symbolic = klu_analyze(a->size, a->column_start, a->row, &lu->common);
    if (!lu->symbolic) {
        free(lu);
        return NULL;
    }
    return &lu->base;
}

/* Whether the pivots of the last factor serve for the new values too; then they are factorised. */
static int refactor(struct lu *lu, const struct sparse_matrix *a) {
    return lu->numeric &&
           klu_refactor(a->column_start, a->row, lu->values, lu->symbolic, lu->numeric,
                        &lu->common) &&
           klu_rgrowth(a->column_start, a->row, lu->values, lu->symbolic, lu->numeric,
                       &lu->common) &&
           lu->common.rgrowth >= least_reciprocal_growth;
}

static int lu_factor(struct linear_solver *solver, double alpha, double beta) {
    struct lu *lu = (struct lu *)solver;
    struct system *system = solver->system;
    const struct sparse_matrix *a = system->pattern;

    system_assemble(system, alpha, beta, lu->values);
    system->counters.factorisations += system->wisps;
    if (refactor(lu, a))
        return 0;
    klu_free_numeric(&lu->numeric, &lu->common);
    lu->numeric = klu_factor(a->column_start, a->row, lu->values, lu->symbolic, &lu->common);
    if (lu->numeric)
        return 0;
    if (lu->common.status == KLU_SINGULAR)
        return system_fail(system, SOLVER_STALLED, "klu: the matrix is singular (column %d)",
                           lu->common.singular_col);
    return system_fail(system, -OUT_OF_MEMORY, "klu: no memory for the factors");
}

static int lu_solve(struct linear_solver *solver, const double *b, double *x) {
    struct lu *lu = (struct lu *)solver;
    const int n = solver->system->size;
    memcpy(x, b, (size_t)n * sizeof(double));
    if (!klu_solve(lu->symbolic, lu->numeric, n, 1, x, &lu->common))
        return system_fail(solver->system, SOLVER_STALLED, "klu: the last matrix had no factors");
    return 0;
}

static void lu_free(struct linear_solver *solver) {
    struct lu *lu = (struct lu *)solver;
    klu_free_numeric(&lu->numeric, &lu->common);
    klu_free_symbolic(&lu->symbolic, &lu->common);
    free(lu);
}

const struct linear_method klu = {
    .name = "klu",
    .summary = "sparse LU with partial pivoting, analysed once (SuiteSparse KLU)",
    .reference = "Davis & Palamadai Natarajan 2010, ACM Trans. Math. Softw. 37, 36:1",
    .max_lanes = 1,
    .supports = lu_supports,
    .create = lu_create,
    .factor = lu_factor,
    .solve = lu_solve,
    .free = lu_free,
};
