/* Wisps against wisps (Plante 1999, section 4.3.2): which points are in which sections of other
 * wisps, and what that does to their velocities. */
#ifndef WISPLAB_INTERACTION_H
#define WISPLAB_INTERACTION_H

#include "base/workers.h"
#include "contact.h"
#include "strand.h"

struct interaction_settings {
    double rate;          /* of the ticks, Hz */
    double threshold;     /* of the part of u across both wisps: below it they interpenetrate */
    double viscosity;     /* of interpenetration, 1/s */
    int interpenetration; /* whether that response, */
    int collision;        /* and this one, does anything */
    int reciprocal;       /* impulses on both sides; 0: the point alone changes, as in the thesis */
};

/* A point in a section of another wisp, or of its own at some distance along it. Sections i >= 1
 * and points (each free node, then its samples) are numbered through all strands in their order. */
struct contact {
    int section, point;
    int corrected;    /* whether a response acts on it */
    double lambda;    /* where along the section it is, 0 to 1 */
    double change[3]; /* u' - u: what the response asks of the relative velocity, m/s */
};

struct interaction;

/* NULL where memory cannot be had. */
struct interaction *interaction_create(const struct interaction_settings *settings);
void interaction_free(struct interaction *interaction);

/* Who shares the work of all later calls; NULL, as at first: nobody. Results do not depend on it.
 */
void interaction_share(struct interaction *interaction, struct workers *workers);

/* One tick: interaction_find and interaction_apply. Returns the number of contacts, or -1 where
 * memory cannot be had and nothing was changed. Memory is kept from tick to tick. */
int interaction_tick(struct interaction *interaction, struct strand *const *strands, int count);

/* First pass: finds all contacts, in (strand, section, point) order, and what their responses ask
 * for. All strands have the same number of samples. Returns the number of contacts or -1. They hold
 * until the next call. */
int interaction_find(struct interaction *interaction, struct strand *const *strands, int count);
struct contact *interaction_contacts(struct interaction *interaction);

/* A tick in steps, for who has no use for strands but as sections, and writes points and takes
 * pushes by himself. First room for the points of these strands: 0, or -1; where those of one go,
 * and the number of its first free node. Then the search, as interaction_find does it, with p, the
 * axes and r of strands, and v of their first nodes. Then what all contacts ask of the points, and
 * of those of a strand. */
int interaction_begin(struct interaction *interaction, struct strand *const *strands, int count);
struct contact_point *interaction_points(struct interaction *interaction, int strand);
int interaction_first_node(const struct interaction *interaction, int strand);
int interaction_search(struct interaction *interaction);
void interaction_add_up(struct interaction *interaction);
const struct contact_push *interaction_pushes(const struct interaction *interaction, int strand);

/* In how many sections the last search looked: all those of the strands that it was given. */
int interaction_sections(const struct interaction *interaction);

/* Second pass: the changes of velocity that `count` contacts, all or some of those found in that
 * order, make together. Every change is from the velocities that interaction_find saw. */
void interaction_apply(struct interaction *interaction, struct strand *const *strands,
                       const struct contact *contacts, int count);

/* What the numbers in a contact stand for: strand, then node i of section (i, i + 1), or node and
 * sample of a point; a sample of -1 is the node itself. */
struct contact_place {
    int strand, node, sample;
};
struct contact_place interaction_section(const struct interaction *interaction, int section);
struct contact_place interaction_point(const struct interaction *interaction, int point);

#endif
