/* Ticks of wisps against wisps by brute force and the words of the model's text, to hold the code
 * against. */
#ifndef WISPLAB_TESTS_INTERACTION_ORACLE_H
#define WISPLAB_TESTS_INTERACTION_ORACLE_H

#include "wisp/interaction.h"

enum { TWIN_NODES = 12, TWIN_SLOTS = 1 + SAMPLES_MAX }; /* nodes of a wisp at most */

/* What a tick asks of every velocity. */
struct twin {
    struct strand *const *strand; /* borrowed */
    int count;
    struct interaction_settings set;
    double (*dv)[TWIN_SLOTS][3]; /* m/s, by wisp * TWIN_NODES + node; slot 0: the node, 1 + j: a
                                    sample */
    int (*shares)[TWIN_SLOTS], (*own)[TWIN_SLOTS]; /* contacts that touch it; that are its own */
};

/* The tick by the book, without changing anything. */
void twin_tick(struct twin *twin, struct strand *const *strand, int count,
               const struct interaction_settings *settings);

/* Of node k with its samples, m/s. */
void twin_mean_velocity(const struct strand *s, int k, double v[3]);

#endif
