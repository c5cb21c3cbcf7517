/* Where a system's energy is, and what changes it. */
#ifndef WISPLAB_ENERGY_H
#define WISPLAB_ENERGY_H

/* X(name, meaning). Of free nodes and samples, and of all springs that act on them, J. */
#define ENERGIES(X)                                                              \
    X(kinetic, "kinetic energy of free nodes and samples")                       \
    X(gravity, "potential energy of gravity, 0 where a root is at t = 0")        \
    X(stretch, "elastic energy of the stretch springs")                          \
    X(bending, "elastic energy of the bending law")                              \
    X(envelope, "elastic energy of the samples' springs, in penalty across the " \
                "half-lines too")                                                \
    X(bodies, "elastic energy in bodies that push by penalty")

/* X(name, meaning). What changes the sum of the above while the motion is smooth, W; its works, J.
 * Together they are the sum's derivative by time along the model's accelerations. */
#define POWERS(X)                                                                                \
    X(drag, "the air's drag on nodes and samples, wind included")                                \
    X(stretch_damping, "damping of the stretch springs")                                         \
    X(bending_damping, "damping of the bending law")                                             \
    X(envelope_damping, "damping of the samples' springs, in penalty across the half-lines too") \
    X(style, "the style field")                                                                  \
    X(head, "what the nodes that follow the head put in through the springs")                    \
    X(treatment, "what the treatment of the half-lines adds where it does not conserve energy; " \
                 "in penalty mostly what dampers across the half-lines take as these turn")      \
    X(body_damping, "damping and friction of bodies that push by penalty")                       \
    X(bodies, "what bodies that push by penalty put in as they move")

struct energies {
#define X(name, meaning) double name;
    ENERGIES(X)
#undef X
};

struct powers {
#define X(name, meaning) double name;
    POWERS(X)
#undef X
};

/* The sums of all members. */
double energies_sum(const struct energies *energies);
double powers_sum(const struct powers *powers);

#endif
