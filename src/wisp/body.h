/* What hair falls on: ellipsoids that push nodes and samples out (Plante 1999, section
 * 4.2.2). SI units. */
#ifndef WISPLAB_BODY_H
#define WISPLAB_BODY_H

#include "strand.h"

enum { BODIES_MAX = 64, BODY_NAME_SIZE = 64 };

/* When a body acts on what is inside it: at ticks, where it puts nodes and samples outside; or at
 * all times, as an acceleration that pushes them (Plante 1999, section 3.1, of others' heads). */
enum body_response { RESPONSE_TICK, RESPONSE_PENALTY };

struct body {
    char name[BODY_NAME_SIZE];
    double centre[3];   /* at t = 0 as the head rests, m */
    double radii[3];    /* along the head's axes, m */
    double velocity[3]; /* with respect to the head and along its axes, constant, m/s */
    int moves;          /* whether the scene says so, by a velocity, also of 0, or by a head */
    double friction;    /* at which what is along the surface slows down, 1/s */
    enum body_response response;
    double elasticity;    /* at ticks, of what is across it: 0 nothing comes back, 1 all */
    double offset;        /* at ticks: above the surface at which a node is put down, m */
    double frequency;     /* by penalty: of a point on its spring along the least radius, Hz */
    double damping_ratio; /* by penalty: of that */
};

/* --- where a body is --- */

struct body_motion {
    double centre[3], velocity[3]; /* m, m/s */
    double spin[3];                /* rad/s */
    double axes[3][3];             /* column k: the direction of radius k */
};

/* At time t, the head being at `head` then: bodies move with it. */
struct body_motion body_motion(const struct body *body, const struct placement *head, double t);

/* A vector of the world along the body's axes. */
void body_to_axes(const struct body_motion *motion, const double x[3], double y[3]);

/* The box around a body, least x y z and most x y z, for kernel_near. */
void body_box(const struct body *body, const struct body_motion *motion, double box[6]);

/* A body as the kernel wants it. */
struct obstacle {
    double centre[3], radii[3];  /* m */
    double axes[3][3];           /* by radius: its direction */
    int turned;                  /* whether they are not the world's axes */
    double inverse[3];           /* of the radii, */
    double inverse_least;        /* of the least of them, 1/m */
    double velocity[3], spin[3]; /* of the centre, and about it, m/s, rad/s */
};
struct obstacle body_obstacle(const struct body *body, const struct body_motion *motion);

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
