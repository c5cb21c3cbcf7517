/* A batch of LANES wisps with equal numbers of nodes and samples and one treatment, laid out for
 * the kernel: lane k of every number belongs to wisp k.
 *
 * The positions among the unknowns are those from each wisp's origin, where the head has its node 0
 * at t = 0: neither an error that is measured by the size of the unknowns nor the rounding of a
 * spring's length depends on where a scene stands. What leaves the folder is in space. */
#ifndef WISPLAB_KERNEL_PART_H
#define WISPLAB_KERNEL_PART_H

#include "base/lanes.h"
#include "kernel.h"

/* Material axes and the envelope's plane at a node (section 4.1.2 of the thesis). */
struct frame {
    struct vec u, v, w;
};

/* Symmetric and general 3x3 blocks. */
struct block {
    lane m[3][3];
};

/* A sample keeps this distance from its node along its line, of R; */
#define LEAST_DISTANCE 1e-3
/* up to this one it is there but for rounding, put there by a body maybe. */
#define AT_LEAST_DISTANCE (LEAST_DISTANCE * (1 + 1e-9))

struct kernel_part {
    int nodes, samples;
    int node_unknowns; /* of one free node */
    enum wisp_treatment treatment;
    enum bending bending;
    const struct surroundings *surroundings;
    int far_side;          /* of the bodies' box, beyond which the wisps were last: a first guess */
    struct system *system; /* whose ctx this is; for reasons of failure */

    struct vec rest_root, rest_tangent, rest_normal; /* as the head rests */
    struct placement start;                          /* where the head is at t = 0 */
    struct vec origin;                               /* of the unknowns, in space, m */
    struct placement head;                           /* where the head was when last asked for, */
    double head_time;                                /* which was then, s */
    struct placement shift;                          /* how far that is from the start */
    struct vec p[2], v[2];                           /* nodes 0 and 1 then, from the origin */
    struct vec tangent, normal;                      /* t_0 and u_0 = u_1 then */
    lane spacing, skip_length;                       /* rest lengths, m */
    lane stretch_k, stretch_c;                       /* N/m, N s/m */
    lane bend_k, bend_c;                             /* of the law in use */
    lane drag;                                       /* 1/s */
    lane radius;                                     /* m */
    lane spring_k, spring_c;   /* of a sample along its line, over its mass: 1/s^2, 1/s */
    lane penalty_k, penalty_c; /* the same across it */
    double cosine[SAMPLES_MAX], sine[SAMPLES_MAX]; /* directions of the samples */

    /* by node, 0 and 1 unused */
    lane *mass, *inverse_mass;            /* a node's own, kg and 1/kg */
    lane *sample_mass;                    /* of each of its samples, kg */
    lane *inverse_across, *inverse_along; /* 1/kg, of node and samples together in `generalised`:
                                             across and along the normal w of its plane */

    /* work space, by node */
    struct vec *t;        /* unit tangents of the segments (i, i + 1) */
    struct vec *chord;    /* by node i >= 2: unit vectors of the skip springs (i - 2, i) */
    lane *inverse_length; /* of segments (i - 1, i) between hinges, 1/m */
    struct vec *force;    /* springs on a node, N */
    struct vec *swing;    /* what carries u from one node to the next, see frames.h */
    struct frame *frames; /* of the last acceleration or tick; those of Jacobians are theirs */
    lane *spare;          /* the same for who measures; made by the first energies or powers */

    struct kernel_matrix *matrix; /* Jacobians and factors; made by the first linearisation */
    lane *rows;                   /* of solves with a part of the forces; made by the first */
    struct kernel_panels *panels; /* of such solves with all forces, likewise */
    struct kernel_rigid *rigid;   /* of rigid segments; NULL: they are springs */
    struct kernel_push *push;     /* of bodies that push by penalty; NULL: there are none */
};

/* The operations of a struct system, by the rest of the folder, as struct system_ops declares them;
 * `ctx` is a struct kernel_part. */
#define X(call) __typeof__(*((struct system_ops *)0)->call) LANED(kernel_##call);
SYSTEM_CALLS(X)
X(energies)
X(powers)
#undef X

/* Says why a state has no acceleration and no Jacobians. Returns an enum outcome. */
int LANED(kernel_refuse_state)(const struct kernel_part *part, const double *q, const double *v);
/* The solve with all forces, part of solve_part. */
int LANED(kernel_solve_full)(struct kernel_part *part, const struct part_equation *equation,
                             double *x);

/* The operations of a struct kernel. */
#define X(type, name, arguments) type LANED(kernel_##name) arguments;
KERNEL_OPERATIONS(X)
#undef X

/* The rate of a direction that turns with the head, where the head was last; `rest`: as it rests.
 */
struct vec LANED(kernel_turning)(const struct kernel_part *part, struct vec rest);

/* The acceleration of node 0 or 1 at time t, where the head was last: it jumps at the head's knots,
 * and at the end of an interval that is advanced over it is that of the time before. */
struct vec LANED(kernel_carried_acceleration)(const struct kernel_part *part, double t, int node);

/* Where a node or sample is in space whose place from the origin is among the unknowns. */
static inline struct vec in_space(const struct kernel_part *part, struct vec place) {
    return add(part->origin, place);
}

/* Where node i is, from the origin, in a state to whose time the head is prescribed. */
static inline struct vec place_of(const struct kernel_part *part, const double *q, int i) {
    return i < 2 ? part->p[i] : vec_load(q, (i - 2) * part->node_unknowns);
}

/* Tangents and frames of a state, into part->t and `frames`, which has one for each node; the lanes
 * in which every segment has a direction. */
mask LANED(kernel_frames)(struct kernel_part *part, const double *q, struct frame *frames);

/* Room for Jacobians and factors; NULL where memory cannot be had. */
struct kernel_matrix *LANED(kernel_matrix_create)(const struct kernel_part *part);
void LANED(kernel_matrix_free)(struct kernel_matrix *matrix);

#endif
