/* What a tick's two passes share: interaction.c finds contacts, interaction_push.c has them act. */
#ifndef WISPLAB_INTERACTION_PARTS_H
#define WISPLAB_INTERACTION_PARTS_H

#include "grid.h"
#include "interaction.h"
#include "section.h"

/* A section with what its responses need to know. */
struct volume {
    struct section section;
    int strand;
    double density;    /* chi */
    int found;         /* points near it, while they are looked at */
    int first_contact; /* first of its contacts, which end where the next one's begin */
};

/* A free node. Sections and free nodes of a wisp are equal in number: node i + 1
 * has the number of section (i, i + 1), which it ends. Points are numbered node by node, each
 * before its samples. */
struct node {
    double direction[3]; /* w */
    int strand, index;
};

enum { POINT_NUMBERS = sizeof(struct contact_point) / sizeof(double) };

/* Some wisps after each other: a task for a thread. */
struct share {
    int from, to; /* strands, to before */
    int count, room;
    struct contact *contact; /* of their sections */
    int failed;              /* no memory for those */
    double sides;            /* of their sections, see cell_side, m */
    double box[6];           /* around them: least x y z, most x y z, m */
    struct grid_found found; /* near a section */
};
enum { SHARES = 32 };

struct interaction {
    struct interaction_settings settings;
    struct workers *workers;
    struct grid *grid;
    int volume_count, point_count, contact_count;
    int strand_room, volume_room, point_room, contact_room;
    struct strand *const *strand; /* of the tick */
    int node_points;              /* of a node: 1 and its samples */
    int *first;                   /* by strand: number of its first section and first free node */
    struct volume *volume;        /* by section */
    struct node *node;            /* by section */
    struct contact_point *point;
    struct contact_push *push; /* by point */
    struct contact *contact;
    struct share share[SHARES];
};

/* The node that begins or ends a section, as a point; -1: prescribed. */
static inline int end_point(const struct interaction *it, int section, int end) {
    const int prescribed = it->volume[section].section.index + end < 2;
    return prescribed ? -1 : (section - 1 + end) * it->node_points;
}

#endif
