/* Sections of wisps whose volumes cross and none of whose points is in the other: what the test of
 * points does not see (Plante 1999, section 4.3.2, figure 4.13). */
#ifndef WISPLAB_MISSES_H
#define WISPLAB_MISSES_H

struct hair;

/* Pairs of sections. They cross where one of so many points that are spread evenly over the part of
 * space that their boxes have in common is in both: brute force, which misses crossings that are
 * smaller than that. A crossing is missed where no node and no sample at the ends of either is in
 * the other. */
struct misses {
    int crossings, missed;
};

/* Room for that; NULL where memory cannot be had. */
struct brute;
struct brute *brute_create(void);
void brute_free(struct brute *brute);

/* Tries pairs of sections at rest, `slenderness` diameters long, that lie any way: as many as it
 * takes for that many crossings; the same each time. Returns 0, or -1 where memory cannot be had.
 */
int random_misses(struct brute *brute, double slenderness, int crossings, struct misses *misses);

/* Counts pairs of sections of different wisps of a run in a frame; and whole pairs of wisps, missed
 * where no point of either is in the other. Adds to both. Lays the frame open. */
void hair_misses(struct brute *brute, struct hair *hair, int frame, struct misses *sections,
                 struct misses *wisps);

#endif
