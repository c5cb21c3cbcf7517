/* A section of a wisp: the volume between the bisector planes of two nodes (Plante 1999, section
 * 4.3.2), and whether a point is in it. */
#ifndef WISPLAB_SECTION_H
#define WISPLAB_SECTION_H

#include "grid.h"
#include "strand.h"

struct section {
    const struct strand *strand;
    int index;         /* i >= 1: from node i to node i + 1 */
    int usable;        /* 0: has no length, or leans on one of its planes; contains nothing */
    double t[3];       /* axis, a unit vector */
    double length;     /* m */
    double reach;      /* nothing in it is further from the axis, m */
    double mean_r2;    /* mean of r^2 over the samples of both ends, m^2 */
    double low[3];     /* a box with all of it, */
    double high[3];    /* rounding of section_contains included */
    double lean[2][3]; /* w / (t.w) of both ends: the plane is x = -(d.lean), d across the axis */
    double turn[2][2]; /* t.u and t.v of both ends */
    double wedge;      /* margin of x beyond the planes where nothing is; infinite where they meet
                          within reach and the quadrilateral may cross itself */
};

/* Where in a section a point is. */
struct section_place {
    double x;    /* along the axis from node i, m */
    double q[3]; /* unit direction from the axis to the point; 0 on the axis */
};

/* Section `index` of a strand whose frames are up to date; it holds while the strand is not
 * changed in place. */
void section_make(struct section *section, const struct strand *strand, int index);

/* Several points are asked about at once: as many as fit into a register. */
#ifdef __AVX512F__
enum { SECTION_POINTS = 8 };
#else
enum { SECTION_POINTS = 4 };
#endif
struct section_places {
    double x[SECTION_POINTS], q[3][SECTION_POINTS];
};

/* Which of these points are in the section, bit k for point k, and where; what is written of others
 * is of no use. A usable section. */
unsigned section_find(const struct section *section, const double *const point[SECTION_POINTS],
                      struct section_places *places);

/* What a grid is asked for to find all points in a usable section, but for `except`. */
void section_search(const struct section *section, struct grid_search *search);

/* Whether a point is in the section, and where: the same, to the last bit. */
int section_contains(const struct section *section, const double point[3],
                     struct section_place *place);

/* The radius that counts: no less than a thousandth of the rest length. */
double section_radius(const struct strand *strand, int node, int sample);

/* The envelope's rim at a node, m from it, `turn` of the way round from axis_u, 0 to 1. */
double section_rim(const struct strand *strand, int node, double turn);

#endif
