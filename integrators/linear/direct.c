/* The model's own direct solver: 2x2 elimination on the circle, block-pentadiagonal on wisps. */
#include "linear.h"

#include <stdlib.h>

static int direct_supports(const struct system *system) {
    return system->ops->factor && system->ops->solve;
}

static struct linear_solver *direct_create(struct system *system, const struct options *options) {
    (void)system, (void)options;
    return malloc(sizeof(struct linear_solver));
}

static int direct_factor(struct linear_solver *solver, double alpha, double beta) {
    return system_factor(solver->system, alpha, beta);
}

static int direct_solve(struct linear_solver *solver, const double *b, double *x) {
    system_solve(solver->system, b, x);
    return 0;
}

static int direct_solve_at_once(struct linear_solver *solver, struct part_equation *equation,
                                double *x) {
    equation->part = FORCES_SPD;
    return system_solve_part(solver->system, equation, x);
}

static void direct_free(struct linear_solver *solver) {
    free(solver);
}

const struct linear_method direct = {
    .name = "direct",
    .summary = "the problem's own structured solver",
    .reference = "Golub & Van Loan, Matrix Computations, 4th ed., chapters 3 and 4",
    .needs = MATRIX_FACTORABLE,
    .max_lanes = LANES_MOST,
    .supports = direct_supports,
    .create = direct_create,
    .factor = direct_factor,
    .solve = direct_solve,
    .solve_at_once = direct_solve_at_once,
    .free = direct_free,
};
