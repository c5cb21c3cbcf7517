/* How often wisps pass through each other. */
#ifndef WISPLAB_CROSSING_H
#define WISPLAB_CROSSING_H

/* Two segments a b and c d of two wisps, from before to after.
 *
 * While all four ends move on straight lines, the signed volume of the tetrahedron a b c d is a
 * cubic in time: it is zero when the segments are in one plane, which is the only time they can
 * meet (Provot 1997, Collision and self-collision handling in cloth model dedicated to design
 * garments, section 3.1; Bridson, Fedkiw & Anderson 2002, doi 10.1145/566654.566623, section 6). A
 * crossing is a change of its sign while they meet: those that touch and part again have a double
 * root, and those that pass beside each other do not meet. Ends count on one side only, so that a
 * crossing at a node is one and not two. Segments that stay in one plane never cross. */
struct segment_pair {
    double before[4][3], after[4][3]; /* a, b, c, d, m */
};

/* What is kept of a pair from one interval to the next: the sign of the volume, 0 unknown. Without
 * it a meeting at the very time of a frame would be seen in neither or in both intervals. */
typedef signed char segment_side;

/* How often a pair crosses in an interval: in all, and in one direction less the other. */
struct crossings {
    int count, net;
};
struct crossings segments_cross(const struct segment_pair *pair, segment_side *side);

struct hair;

/* Counts the crossings of all pairs of segments (from node 1 on) of different wisps of a run: by
 * frame those up to it, added up. `count` and `net` have hair->frame_count numbers. Returns 0, or
 * -1 where memory cannot be had. Wisps that are not there in both frames of an interval are left
 * out of it. */
int hair_crossings(const struct hair *hair, double *count, double *net);

#endif
