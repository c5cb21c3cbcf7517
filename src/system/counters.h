/* What a run counts. One list makes the fields, the column names and the definitions. */
#ifndef WISPLAB_COUNTERS_H
#define WISPLAB_COUNTERS_H

/* X(field, definition): numbers of events since the run began, summed over wisps: a call for a
 * part of 4 wisps counts 4. Calls made inside a library are counted too, because every call to
 * the model goes through the wrappers of system.h. */
#define COUNTERS(X)                                                                         \
    X(steps, "accepted steps")                                                              \
    X(rejected_steps, "steps tried and thrown away by an error test or a failed iteration") \
    X(force_evaluations, "accelerations computed")                                          \
    X(time_rates, "rates of accelerations in time computed")                                \
    X(linearisations, "states at which the Jacobians were computed")                        \
    X(jacobian_products, "products of a combination of M, D and K with a vector")           \
    X(assemblies, "combinations of M, D and K written out as a sparse matrix")              \
    X(factorisations, "combinations of M, D and K factorised")                              \
    X(linear_solves, "linear systems solved")                                               \
    X(part_solves, "linear systems with a part of the forces made and solved")              \
    X(sweeps, "sweeps over the springs as constraints")                                     \
    X(linear_iterations, "iterations of an iterative linear solver")                        \
    X(newton_iterations, "iterations of a nonlinear solver, of a wisp until it converges")  \
    X(projections, "states put back onto their constraint")                                 \
    X(restarts, "times a stepper began anew after an event")                                \
    X(body_contacts, "times a node or sample was inside a body and was put outside")        \
    X(nodes_left_inside, "times a node was still inside a body after a tick's passes")      \
    X(sections_tested, "times points were looked for in a section of a wisp")               \
    X(wisp_contacts, "times a point was found in a section of another wisp")                \
    X(splits, "wisps that were divided in two")

struct counters {
#define X(field, definition) long long field;
    COUNTERS(X)
#undef X
};

/* The shortest and the longest accepted step of any wisp, s, as they were taken: a fixed step is
 * divided so that the time to each stop has a whole number of them, and a step of a method's own
 * choice may be cut short by a stop. largest = 0: none was taken. */
struct step_range {
    double least, largest;
};

#endif
