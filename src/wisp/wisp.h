/* One deformable wisp and its surroundings, as numbers: what the scene says and every computation
 * starts from (Plante 1999, section 4.1). SI units. */
#ifndef WISPLAB_WISP_H
#define WISPLAB_WISP_H

#include "prescribed.h"

enum { SAMPLES_MAX = 16 };

enum bending { BENDING_NONE, BENDING_SKIP, BENDING_HINGE };

/* What keeps neighbours at their distance: spring-dampers, or a constraint that keeps it exactly.
 */
enum stretch { STRETCH_SPRING, STRETCH_RIGID };

/* How a sample of the envelope is kept on its half-line. */
enum wisp_treatment { WISP_PROJECTION, WISP_PENALTY, WISP_GENERALISED };

struct wisp {
    int nodes;           /* n >= 3; nodes 0 and 1 belong to the head */
    int samples;         /* M of the envelope, 3 to SAMPLES_MAX; 0: no envelope */
    double root[3];      /* of node 0, m */
    double direction[3]; /* of the wisp at rest, a unit vector */
    double length;       /* m */

    double hair_count;
    int splits;               /* subdivisions behind it: it has 2^-splits of the hairs at first */
    double hair_density;      /* kg/m of one hair */
    enum stretch stretch;     /* where it is rigid, the next two are 0 */
    double stretch_stiffness; /* EA, N */
    double stretch_time;      /* damping over stiffness, s */
    enum bending bending;
    double bending_stiffness; /* EI, N m^2 */
    double bending_angle;     /* at which a skip spring's energy is the hinge's, rad */
    double bending_time;      /* damping over stiffness, s */
    double drag_rate;         /* 1/s */

    double radius;        /* R, rest length of a sample's spring, m */
    double mass_fraction; /* of a node's mass that is in its samples */
    double frequency;     /* of a sample on its spring, Hz */
    double damping_ratio; /* of a sample on its spring */
    double penalty_ratio; /* k_p / k_e of the treatment `penalty` */
};

enum wind_kind { WIND_NONE, WIND_STEADY, WIND_GUST, WIND_IRREGULAR };

enum { WIND_TERMS_MAX = 16 };

struct wind {
    enum wind_kind kind;
    double velocity[3];                                          /* m/s */
    double hold, decay;                                          /* of a gust, s */
    int terms;                                                   /* of irregular wind */
    double amplitude[WIND_TERMS_MAX], frequency[WIND_TERMS_MAX]; /* relative to velocity; Hz */
};

struct body;

struct surroundings {
    double gravity[3]; /* m/s^2 */
    struct wind wind;
    struct style style;
    struct head_motion head;
    const struct body *pushing; /* the bodies that push by penalty, which is a force */
    int pushing_count;
};

/* w(t): uniform in space. */
void wind_velocity(const struct wind *wind, double t, double velocity[3]);

/* dw/dt, m/s^2; at the kink of a gust it is that of the side on which `inside` is. */
void wind_rate(const struct wind *wind, double inside, double t, double rate[3]);

/* Distance between nodes at rest, m. */
double wisp_spacing(const struct wisp *wisp);

/* What follows from the scene's numbers for node i >= 2: the node's own mass, and the mass of each
 * of its samples, kg. */
double wisp_node_mass(const struct wisp *wisp, int node);
double wisp_sample_mass(const struct wisp *wisp, int node);

/* Spring constants: N/m. The damping constants are these times stretch_time and bending_time. The
 * bending one belongs to the law: of a skip spring N/m, of a hinge N m. */
double wisp_stretch_constant(const struct wisp *wisp);
double wisp_bending_constant(const struct wisp *wisp);

/* Unknowns of one free node: 3 coordinates, then a distance r for each sample, or with `penalty`
 * 3 coordinates for each sample. A wisp's vector has those of nodes 2, 3, ..., n-1 in turn. */
int wisp_node_unknowns(const struct wisp *wisp, enum wisp_treatment treatment);

/* The way of the half-line of sample j of M in the envelope's plane, a unit vector along axis_u and
 * axis_v: quarter turns are exact. */
void wisp_sample_way(int samples, int j, double way[2]);

/* The first normal u_0 = u_1 of the frames: h, the y axis, or the x axis where the tangent is
 * within acos 0.9 of y, made perpendicular to the tangent. */
void wisp_first_normal(const double tangent[3], double normal[3]);

#endif
