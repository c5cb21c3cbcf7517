/* What hair falls on: ellipsoids that push nodes and samples out (Plante 1999, section
 * 4.2.2). SI units. */
#ifndef WISPLAB_BODY_H
#define WISPLAB_BODY_H

#include "strand.h"

enum { BODIES_MAX = 64, BODY_NAME_SIZE = 64 };

struct body {
    char name[BODY_NAME_SIZE];
    double centre[3];   /* at t = 0 as the head rests, m */
    double radii[3];    /* along the head's axes, m */
    double velocity[3]; /* with respect to the head and along its axes, constant, m/s */
    int moves;          /* whether the scene says so, by a velocity, also of 0, or by a head */
    double friction;    /* at which what is along the surface slows down, 1/s */
    double elasticity;  /* of what is across it: 0 nothing comes back, 1 all */
    double offset;      /* above the surface at which a node is put down, m */
};

/* --- where a body is --- */

struct body_motion {
    double centre[3], velocity[3]; /* m, m/s */
    double spin[3];                /* rad/s */
    double axes[3][3];             /* column k: the direction of radius k */
};

/* At time t, the head being at `head` then: bodies move with it. */
struct body_motion body_motion(const struct body *body, const struct placement *head, double t);

/* The box around a body, least x y z and most x y z, for kernel_near. */
void body_box(const struct body *body, const struct body_motion *motion, double box[6]);

/* The same as the kernel wants it. */
struct obstacle {
    double centre[3], radii[3];  /* m */
    double axes[3][3];           /* by radius: its direction */
    int turned;                  /* whether they are not the world's axes */
    double inverse[3];           /* of the radii, */
    double inverse_least;        /* of the least of them, 1/m */
    double velocity[3], spin[3]; /* of the centre, and about it, m/s, rad/s */
};
struct obstacle body_obstacle(const struct body *body, const struct body_motion *motion);

/* --- the ellipsoid, seen from its centre along its axes --- */

int ellipsoid_contains(const double radii[3], const double x[3]);

/* The outward normal of the shell (scaled ellipsoid) through x; at the centre the positive axis of
 * smallest radius, the first on ties. */
void ellipsoid_normal(const double radii[3], const double x[3], double normal[3]);

/* Distance in units of ||d|| from a point inside to the surface along d. */
double ellipsoid_exit(const double radii[3], const double x[3], const double d[3]);

/* Likewise from a point outside to the first crossing; INFINITY where there is none ahead. */
double ellipsoid_entry(const double radii[3], const double x[3], const double d[3]);

/* How deep a point of the world is in a body, along the normal of the shell through it, m; negative
 * where it is not in it. */
double body_depth(const struct body *body, const struct body_motion *motion, const double p[3]);

/* --- contact --- */

/* What a tick did; numbers are added to. */
struct body_report {
    long long nodes, samples; /* how often one was inside and was pushed or pulled out */
    long long inside;         /* nodes still in a body after all passes */
};

/* The response of one strand at a tick to `count` bodies, which are where `motion` says, under
 * gravity, m/s^2, the last tick being dt ago. */
void body_contact(struct strand *strand, const struct body *bodies,
                  const struct body_motion *motion, int count, const double gravity[3], double dt,
                  struct body_report *report);

#endif
