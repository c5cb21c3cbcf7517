#include "linear.h"

const char *const jacobian_choices[] = {"exact", "spd", "auto", NULL};

static int fits(const struct linear_method *method, const struct system *system,
                enum jacobian kind) {
    const unsigned needs = method->needs | MATRIX_AVAILABLE;
    return (system->matrix[kind] & needs) == needs;
}

/* auto: spd where it serves; else exact where that does; else what there is, to be refused. */
static enum jacobian preferred(const struct linear_method *method, const struct system *system,
                               int option) {
    if (option != JACOBIAN_AUTO)
        return (enum jacobian)option;
    if (fits(method, system, JACOBIAN_SPD) || fits(method, system, JACOBIAN_EXACT))
        return fits(method, system, JACOBIAN_SPD) ? JACOBIAN_SPD : JACOBIAN_EXACT;
    return system->matrix[JACOBIAN_SPD] & MATRIX_AVAILABLE ? JACOBIAN_SPD : JACOBIAN_EXACT;
}

int linear_choose(const struct linear_method *method, struct system *system, int option,
                  enum jacobian *kind) {
    if (system->no_jacobians)
        return system_fail(system, REFUSED, "linear solver %s needs Jacobians, and %s",
                           method->name, system->no_jacobians);
    if (!system->ops->linearise || !system->ops->product)
        return system_fail(system, REFUSED,
                           "linear solver %s has nothing to solve: %s has no Jacobians",
                           method->name, system->name);
    if (!method->supports(system))
        return system_fail(system, REFUSED, "linear solver %s is not there for %s", method->name,
                           system->name);
    *kind = preferred(method, system, option);
    if (fits(method, system, *kind))
        return 0;
    if (!(system->matrix[*kind] & MATRIX_AVAILABLE))
        return system_fail(system, REFUSED, "%s has no %s Jacobian", system->name,
                           jacobian_choices[*kind]);
    if (method->needs & ~system->matrix[*kind] & MATRIX_FACTORABLE)
        return system_fail(system, REFUSED, "linear solver %s does not take the %s Jacobian of %s",
                           method->name, jacobian_choices[*kind], system->name);
    const int symmetric = (system->matrix[*kind] & MATRIX_SYMMETRIC) != 0;
    return system_fail(system, REFUSED,
                       "linear solver %s needs a %s matrix, and the %s one of %s is not%s%s",
                       method->name, symmetric ? "positive definite" : "symmetric",
                       jacobian_choices[*kind], system->name, system->matrix_note ? ": " : "",
                       system->matrix_note ? system->matrix_note : "");
}

struct linear_solver *linear_create(const struct linear_method *method, struct system *system,
                                    const struct options *options) {
    struct linear_solver *solver = method->create(system, options);
    if (solver) {
        solver->method = method;
        solver->system = system;
    }
    return solver;
}

int linear_factor(struct linear_solver *solver, double alpha, double beta) {
    return solver->method->factor(solver, alpha, beta);
}

int linear_solve(struct linear_solver *solver, const double *b, double *x) {
    solver->system->counters.linear_solves += solver->system->wisps;
    return solver->method->solve(solver, b, x);
}

int linear_solves_at_once(const struct linear_solver *solver, enum jacobian kind) {
    return solver->method->solve_at_once && kind == JACOBIAN_SPD &&
           solver->system->force_parts >> FORCES_SPD & 1;
}

int linear_solve_at_once(struct linear_solver *solver, struct part_equation *equation, double *x) {
    return solver->method->solve_at_once(solver, equation, x);
}
