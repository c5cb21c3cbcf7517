/* Adaptive subdivision (Plante 1999, section 4.3.3): a wisp that is pressed flat somewhere becomes
 * two with half of its hairs each. Here is the rule: which wisp splits, and its children's state.
 */
#ifndef WISPLAB_SUBDIVISION_H
#define WISPLAB_SUBDIVISION_H

#include "strand.h"

struct subdivision {
    double ratio; /* of the least to the largest diameter at a node, below which a wisp splits */
    double separation; /* mean distance of their nodes beyond which twins are two wisps, m */
    int limit;         /* wisps at most; 0: none ever splits */
};

/* The node where a wisp is flattest. */
struct flattening {
    int node;     /* a free one */
    double ratio; /* of its least to its largest diameter */
    int longest;  /* sample j whose diameter r_j + r_(j+M/2) is the largest */
};

/* Lets twins go that are farther apart than `separation`: of both strand->twin becomes NULL. For
 * strands of equal time. */
void subdivision_separate(const struct subdivision *rule, struct strand *strand);

/* Whether the strand splits now, and where; M even. */
int subdivision_due(const struct subdivision *rule, const struct strand *strand,
                    struct flattening *at);

/* Either child's numbers: half the hairs, masses, stiffness and damping of the parent. */
struct wisp subdivision_child(const struct wisp *parent);

/* Makes of the parent's state that of a child: `side` is 1 for the child that goes the way of the
 * longest diameter, -1 for the other. They differ in the velocity of the node alone. */
void subdivision_turn(struct strand *strand, const struct flattening *at,
                      const struct placement *head, int side);

#endif
