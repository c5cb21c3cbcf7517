/* Conjugate gradients by SUNDIALS, without ever forming the matrix. Not preconditioned: dividing
 * by the diagonal took more iterations on wisps than nothing at all. */
#include "linear.h"
#include "sundials_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_pcg.h>

enum { TOLERANCE, ITERATIONS };

static const struct option_spec options[] = {
    [TOLERANCE] = {"cg.tolerance", "residual at which to stop, over that of x = 0", OPTION_REAL,
                   .initial = 1e-8, .least = 1e-15, .most = 0.9},
    [ITERATIONS] = {"cg.iterations", "iterations at most", OPTION_COUNT, .initial = 1000,
                    .least = 1, .most = 1e6},
    {.name = NULL},
};

struct cg {
    struct linear_solver base;
    struct sundials sundials;
    N_Vector b, x;
    SUNLinearSolver pcg;
    double tolerance;
    double alpha, beta; /* of the last factor */
};

static int cg_supports(const struct system *system) {
    return system->ops->product != NULL;
}

/* z <- (M - alpha D - beta K) v */
static int times(void *cg_, N_Vector v, N_Vector z) {
    const struct cg *cg = cg_;
    system_product(cg->base.system, 1, -cg->alpha, -cg->beta, N_VGetArrayPointer(v),
                   N_VGetArrayPointer(z));
    return 0;
}

static void cg_free(struct linear_solver *solver) {
    struct cg *cg = (struct cg *)solver;
    if (cg->pcg)
        SUNLinSolFree(cg->pcg);
    if (cg->x)
        N_VDestroy(cg->x);
    if (cg->b)
        N_VDestroy(cg->b);
    sundials_close(&cg->sundials);
    free(cg);
}

static struct linear_solver *cg_create(struct system *system, const struct options *given) {
    struct cg *cg = calloc(1, sizeof *cg);
    if (!cg)
        return NULL;
    if (sundials_open(&cg->sundials)) {
        free(cg);
        return NULL;
    }
    cg->tolerance = option_value(given, &options[TOLERANCE]);
    cg->b = sundials_vector(&cg->sundials, system->size);
    cg->x = sundials_vector(&cg->sundials, system->size);
    if (cg->b && cg->x)
        cg->pcg =
            SUNLinSol_PCG(cg->x, SUN_PREC_NONE, (int)option_value(given, &options[ITERATIONS]),
                          cg->sundials.context);
    if (!cg->pcg || SUNLinSolSetATimes(cg->pcg, cg, times) < 0 ||
        SUNLinSolInitialize(cg->pcg) < 0 || SUNLinSolSetup(cg->pcg, NULL) < 0) {
        cg_free(&cg->base);
        return NULL;
    }
    return &cg->base;
}

static int cg_factor(struct linear_solver *solver, double alpha, double beta) {
    struct cg *cg = (struct cg *)solver;
    cg->alpha = alpha;
    cg->beta = beta;
    return 0;
}

static int cg_solve(struct linear_solver *solver, const double *b, double *x) {
    struct cg *cg = (struct cg *)solver;
    struct system *system = solver->system;
    const size_t bytes = (size_t)system->size * sizeof(double);

    memcpy(N_VGetArrayPointer(cg->b), b, bytes);
    const double norm = sqrt(N_VDotProd(cg->b, cg->b));
    if (!isfinite(norm))
        return system_fail(system, SOLVER_STALLED, "cg: the right side is not finite");

    /* Both, before every solve: the flag is cleared by a solve, and x stays as it is where the
     * first residual is small enough. The tolerance is absolute. */
    N_VConst(0, cg->x);
    SUNLinSolSetZeroGuess(cg->pcg, SUNTRUE);
    const int flag = SUNLinSolSolve(cg->pcg, NULL, cg->x, cg->b, cg->tolerance * norm);
    const int iterations = SUNLinSolNumIters(cg->pcg);
    system->counters.linear_iterations += (long long)iterations * system->wisps;
    if (flag != 0)
        return system_fail(system, SOLVER_STALLED,
                           "cg: the residual is %.1e of the right side after %d iterations",
                           SUNLinSolResNorm(cg->pcg) / norm, iterations);
    memcpy(x, N_VGetArrayPointer(cg->x), bytes);
    return 0;
}

const struct linear_method conjugate_gradients = {
    .name = "cg",
    .summary = "conjugate gradients, matrix-free, not preconditioned (SUNDIALS)",
    .reference = "Hestenes & Stiefel 1952, J. Res. Nat. Bur. Standards 49, 409",
    .needs = MATRIX_SYMMETRIC | MATRIX_DEFINITE,
    .max_lanes = 1,
    .options = options,
    .supports = cg_supports,
    .create = cg_create,
    .factor = cg_factor,
    .solve = cg_solve,
    .free = cg_free,
};
