/* Hairs: drawn in the volume of a wisp, not simulated (Plante 1999, section 4.1.3). Each has a
 * place in the unit disc for every plane of the wisp, and a length; the envelope gives the places
 * their positions in space, and a curve goes through these. */
#ifndef WISPLAB_HAIR_H
#define WISPLAB_HAIR_H

#include "strand.h"

#include <stddef.h>

/* What does not change while a wisp moves. */
struct hairs {
    int count, nodes;
    double (*place)[2]; /* in the unit disc, index hair * nodes + node */
    double *length;     /* of each hair, m */
};

/* The hairs of a wisp as the scene has it. They follow from `seed` and the wisp's root, direction
 * and length, not from its place in the scene; and the first of many are those of few. NULL where
 * memory cannot be had. */
struct hairs *hairs_create(const struct wisp *wisp, double seed, int count);
void hairs_free(struct hairs *hairs);

/* Which of them a wisp has that came of a wisp of the scene by subdivisions. All zero: all. */
struct hair_share {
    unsigned level; /* subdivisions behind it */
    unsigned path;  /* bit k: it is the second child of the k-th of these */
};

/* The shares of both children; together they are the parent's. */
void hair_share_split(struct hair_share *parent_and_first, struct hair_share *second);
int hair_share_has(struct hair_share share, int hair);

/* Where a place of the unit disc is in the plane of a node: its part along axis_u and axis_v, m.
 * The strand's frames are up to date. */
void hair_position(const struct strand *strand, int node, const double place[2],
                   double position[2]);

/* Where a hair goes through the planes, strand->wisp->nodes points, m. */
void hair_controls(const struct strand *strand, const double (*place)[2], double (*controls)[3]);

/* Points of the uniform Catmull-Rom curve through `count` controls, end points doubled: `pieces`
 * for each span and the first; room for (count - 1) * pieces + 1. The curve ends at its last
 * control or, its pieces being straight, where it is `length` long; `end` is where that is,
 * controls counted from 0. Returns the number of points. */
int hair_curve(const double (*controls)[3], int count, int pieces, double length,
               double (*points)[3], double *end);

#endif
