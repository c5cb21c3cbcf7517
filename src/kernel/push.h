/* Bodies that push by penalty: an acceleration of what is inside them, that grows with the depth
 * (the heads of Rosenblum, Carlson & Tripp 1991 and of Anjyo, Usami & Kurihara 1992; Plante 1999,
 * sections 3.1 and 3.3). In the body's axes, with R its radii, R_m the least of them and
 *
 *     sigma = sqrt(sum (x_k / R_k)^2),   n = grad sigma / |grad sigma|,   s = min(1, (1 - sigma) /
 * 0.05),
 *
 * a point with velocity u relative to the body, u_t of it across n, has where sigma < 1
 *
 *     max(0, omega^2 R_m^2 (1 - sigma) |grad sigma| - 2 zeta omega s u.n) n - s friction u_t. */
#ifndef WISPLAB_KERNEL_PUSH_H
#define WISPLAB_KERNEL_PUSH_H

#include "part.h"

/* A body where it is, for each lane from its origin; bodies move with the head. */
struct pusher {
    struct vec centre, axes[3]; /* m; direction of radius k */
    struct vec velocity, spin;  /* of the centre, and about it, m/s, rad/s */
    struct vec half;            /* of the box around it, m */
    double inverse[3];          /* of the radii, 1/m */
    double inverse_least;       /* of the least of them, 1/m */
    double stiffness;           /* omega^2 R_m^2, m^2/s^2 */
    double damping, friction;   /* 2 zeta omega, 1/s */
    int turned;                 /* whether the axes are not the world's */
};

/* What bodies do to a point, as its Jacobians have it: minus the derivatives of its acceleration by
 * its velocity and by its position. In `projection`, where only what is along the line counts, that
 * of a sample of kind `spd` is of the part along the line, aa' . aa': else eliminating the sample
 * would leave a matrix that is not symmetric. */
struct penetration {
    lane inside; /* 1 in lanes in which some body holds the point, else 0, and the rest is 0 */
    struct block damping, stiffness;
};

/* By free node: its own, and those of its samples behind it. Where no body holds any of a node's
 * points, in any lane, only `any` is there. */
struct penetrations {
    lane *any; /* by free node: 1 in lanes in which some body holds one of its points */
    struct penetration *point;
};

struct kernel_push {
    int count;
    int rest;      /* bodies never move, */
    double time;   /* for which they were placed; NAN: they were not, or by lane */
    int near;      /* whether some body was near in the last acceleration, */
    double *spare; /* room for accelerations */
    double *v;     /* and the velocities there, for who asks for its Jacobians afterwards: */
    struct penetrations penetrations; /* of kernel_push_penetrations */
    struct vec *on;                   /* accelerations of one node's points */
    struct pusher pusher[];
};

/* Lanes-wide numbers that the penetrations of a part take, and these in such room. */
size_t LANED(kernel_penetrations_size)(const struct kernel_part *part);
struct penetrations LANED(kernel_penetrations_in)(const struct kernel_part *part, lane *room);

/* Room for the bodies that push the part's wisps; NULL where memory cannot be had. */
struct kernel_push *LANED(kernel_push_create)(const struct kernel_part *part);

/* Adds what bodies do to the accelerations `a` without tensions, after the frames of the state. */
void LANED(kernel_push_accelerate)(struct kernel_part *part, double t, const double *q,
                                   const double *v, double *a);

/* Adds to `rate` how that changes with time, at the state of the last acceleration, which stays the
 * last: by differences in time, towards later (side 1) or earlier (-1), for the head may jump
 * there. */
void LANED(kernel_push_rate)(struct kernel_part *part, double t, int side, const double *q,
                             const double *v, double *rate);

/* Makes push->penetrations the Jacobians of kind `spd` of the last acceleration, which was at q. */
void LANED(kernel_push_penetrations)(struct kernel_part *part, const double *q);

/* The Jacobians of that at a state with these frames, the head having been prescribed. */
void LANED(kernel_push_linearise)(struct kernel_part *part, enum jacobian kind, double t,
                                  const double *q, const double *v, const struct frame *frames,
                                  struct penetrations *to);

/* What all bodies do to a point, by its mass: its energy in them, the acceleration, of this what is
 * minus the energy's gradient, the power of the rest as a body sees the point, and that of all of
 * it by the bodies' motion. The energy changes by these two, less what they add to the kinetic one.
 */
struct pushed {
    lane energy;
    struct vec acceleration, elastic;
    lane loss, work;
};
struct pushed LANED(kernel_pushed)(struct kernel_part *part, double t, struct vec p, struct vec v);

/* The penetrations of free node i, its samples' behind its own; NULL where no body holds any of
 * them. */
static inline const struct penetration *
penetrating_node(const struct kernel_part *part, const struct penetrations *penetrations, int i) {
    if (!part->push || mask_none(penetrations->any[i] != 0))
        return NULL;
    return penetrations->point + (size_t)i * (size_t)(1 + part->samples);
}

/* alpha damping + beta stiffness */
static inline struct block penetration_matrix(const struct penetration *penetration, lane alpha,
                                              lane beta) {
    struct block b;
    EACH (r, 0, 3)
        EACH (c, 0, 3)
            b.m[r][c] =
                alpha * penetration->damping.m[r][c] + beta * penetration->stiffness.m[r][c];
    return b;
}

#endif
