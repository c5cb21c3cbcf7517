/* The table of a kernel's operations. */
#include "part.h"
#include "rigid.h"

static const struct system_ops ops = {
    .acceleration = LANED(kernel_acceleration),
    .linearise = LANED(kernel_linearise),
    .product = LANED(kernel_product),
    .factor = LANED(kernel_factor),
    .solve = LANED(kernel_solve),
    .solve_part = LANED(kernel_solve_part),
    .time_rate = LANED(kernel_time_rate),
    .without_springs = LANED(kernel_without_springs),
    .sweep_springs = LANED(kernel_sweep_springs),
    .assemble = LANED(kernel_assemble),
    .energies = LANED(kernel_energies),
    .powers = LANED(kernel_powers),
};

/* A segment that is rigid has no stiffness: there are no Jacobians. */
static const struct system_ops rigid_ops = {
    .acceleration = LANED(kernel_acceleration),
    .project = LANED(kernel_project),
    .energies = LANED(kernel_energies),
    .powers = LANED(kernel_powers),
};

const struct kernel LANED(kernel) = {.lanes = LANES,
                                     .ops = &ops,
                                     .rigid_ops = &rigid_ops,
#define X(type, name, arguments) .name = LANED(kernel_##name),
                                     KERNEL_OPERATIONS(X)
#undef X
};
