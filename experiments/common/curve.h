/* The curve of a wisp: what its nodes stand for, however many they are. */
#ifndef WISPLAB_CURVE_H
#define WISPLAB_CURVE_H

/* Uniform Catmull-Rom through n >= 2 nodes, whose x, y, z stand `stride` numbers apart, as hairs
 * are drawn; beyond its ends the chain goes on as the parabola through the last three nodes (two:
 * the line), so that parabolas are met everywhere. Points at 1/count, 2/count, ..., 1 of its arc
 * length: the root is not among them. The arc length is that of 16 chords per segment. Same unit as
 * the nodes. */
void curve_points(const double *nodes, int stride, int n, int count, double (*points)[3]);

#endif
