/* What points in a section of another wisp ask of their velocities (Plante 1999, section 4.3.2). */
#ifndef WISPLAB_RESPONSE_H
#define WISPLAB_RESPONSE_H

#include "interaction.h"
#include "section.h"

/* A section for responses. */
struct answerer {
    const struct interaction_settings *settings;
    const struct section *section;
    const double *v[2]; /* of its ends: the means of a node's own velocity and its samples', m/s */
    double rest;        /* e^(-nu chi dt), nu being the viscosity and chi the density */
};

/* For each of some points at `places`, with velocities v and, of their wisps, directions w: where
 * along the section it is, 0 to 1, and u' - u for its velocity u against the section there, m/s.
 * Returns the points whose u changes, bit k for point k; of others it is 0. */
struct responses {
    double lambda[SECTION_POINTS], change[3][SECTION_POINTS];
};
unsigned respond(const struct answerer *answerer, const struct section_places *places,
                 const double *const v[SECTION_POINTS], const double *const w[SECTION_POINTS],
                 struct responses *responses);

#endif
