/* The wisp model at work on 1, 4 or 8 wisps at once: what the rest of the program sees of this
 * folder. The kernels for 1, 4 and 8 lanes are one source. */
#ifndef WISPLAB_KERNEL_H
#define WISPLAB_KERNEL_H

#include "system/system.h"
#include "wisp/wisp.h"

struct contact_point;
struct contact_push;
struct obstacle;
struct strand;

/* A lane's wisp among those that touch; NULL: it does not. */
struct contact_wisp {
    struct strand *strand;
    struct contact_point *point;     /* its first */
    const struct contact_push *push; /* likewise */
    int first_node;                  /* the number of its first free node among all that touch */
};

/* X(type, name, arguments): what a kernel does with a part besides being a system. */
#define KERNEL_OPERATIONS(X)                                                                       \
    /* A part for `lanes` wisps that agree in nodes, samples and bending law; `around` and         \
     * `system` must outlive it. NULL where memory cannot be had. */                               \
    X(void *, create,                                                                              \
      (const struct wisp *const *wisps, const struct surroundings *around,                         \
       enum wisp_treatment treatment, struct system *system))                                      \
    X(void, free, (void *part))                                                                    \
    /* Gives a lane another wisp's numbers at time t; the wisp agrees with those of the part. */   \
    X(void, fill, (void *part, int which, const struct wisp *wisp, double t))                      \
    /* The start of a scene at time t: rest shape, at rest, samples at r = R. */                   \
    X(void, rest, (void *part, double t, double *q, double *v))                                    \
    /* One lane as rows of a frame, for nodes 0 to n - 1, of 6 numbers and 2 or 6 for each sample; \
     * the first row's first number goes to rows[0], the next row's to rows[stride]. */            \
    X(void, sample,                                                                                \
      (void *part, int which, const double *q, const double *v, double *rows, int stride))         \
    /* The reverse. */                                                                             \
    X(void, restore,                                                                               \
      (void *part, int which, const double *rows, int stride, double *q, double *v))               \
    /* Accelerations `a`, in the layout of v, likewise: 3 numbers for a node and 1 or 3 for each   \
     * sample; those of nodes 0 and 1 are the head's at the time last prescribed. */               \
    X(void, sample_accelerations,                                                                  \
      (void *part, int which, const double *a, double *rows, int stride))                          \
    /* Puts nodes 0 and 1 where the head has them at time t; without head motion they stay.        \
     * Accelerations and linearisations do so by themselves. */                                    \
    X(void, prescribe, (void *part, double t))                                                     \
    /* Keeps samples on their side of the node (Plante 1999, section 4.1.2): those at 1e-3 R, to   \
     * rounding, or nearer are put there and no longer move inwards. Returns the lanes that        \
     * changed. */                                                                                 \
    X(unsigned, clamp, (void *part, double *q, double *v))                                         \
    /* Gives the segments of the lanes, bit k for lane k, of a part with rigid ones their length   \
     * back, and takes from the velocities at time t what would change it (see rigid.c). Returns   \
     * 0, or a positive enum outcome where the state is too far from it and is left alone. */      \
    X(int, project_lanes, (void *part, double t, double *q, double *v, unsigned lanes))            \
    /* Lanes, bit k for lane k, whose free nodes and samples may be in one of `count` boxes (least \
     * x y z, most x y z; `hull` is around them all); none that is in one is missed. Says besides, \
     * looking at samples only once, whether the clamp may find anything. */                       \
    X(unsigned, near,                                                                              \
      (void *part, const double *q, const double *hull, const double *boxes, int count,            \
       int *clamp))                                                                                \
    /* Pulls samples out of at most BODIES_MAX bodies with these boxes (Plante 1999, section       \
     * 4.2.2) in lanes that have no free node inside one. Returns the lanes that have, or that     \
     * cannot be treated so, and leaves those alone; bits of other lanes are never set. `pulled`   \
     * becomes the number of samples found inside in the lanes of `counted`, `pulled_lanes` says   \
     * in which. */                                                                                \
    X(unsigned, pull,                                                                              \
      (void *part, double *q, double *v, const struct obstacle *bodies, const double *boxes,       \
       int count, unsigned counted, int *pulled, unsigned *pulled_lanes))                          \
    /* A box around each lane, padding included: of the volume from node 1 on and of the samples   \
     * of free nodes (least x y z, most x y z). Returns the lanes, others' bits aside, in which    \
     * the wisp may touch itself; none that does is missed. */                                     \
    X(unsigned, boxes, (void *part, const double *q, double(*boxes)[6]))                           \
    /* Lays lanes open: fills in all that strand_load does, but for lanes of NULL. Nodes 0 and 1   \
     * are where they were last prescribed. Behind nodes that coincide axes are NaN, not 0. */     \
    X(void, open, (void *part, const double *q, const double *v, struct strand *const *strands))   \
    /* Fills in, for the lanes that have a strand, p, the axes, r, and v of nodes 0 and 1; and all \
     * points. */                                                                                  \
    X(void, contact_points,                                                                        \
      (void *part, const double *q, const double *v, const struct contact_wisp *wisps))            \
    /* Changes velocities by what contacts ask of the points of all lanes that have a push, as     \
     * interaction_apply does those of strands; `turn` is theirs. The axes are those of the last   \
     * `contact_points`. Returns the lanes that changed. */                                        \
    X(unsigned, push,                                                                              \
      (void *part, double *q, double *v, const struct contact_wisp *wisps,                         \
       const double(*turn)[2]))                                                                    \
    /* Largest | L / rest length - 1 | over the segments of a lane, nodes 0 and 1 being where they \
     * were last. */                                                                               \
    X(double, strain, (void *part, int which, const double *q))                                    \
    /* Lanes, bit k for lane k, in which that is above `limit` at time t: without a root, and so   \
     * cheap enough for every step. What is not a number is not above it. */                       \
    X(unsigned, strained, (void *part, double t, const double *q, double limit))                   \
    /* Where the part's matrix has its entries, as general sparse solvers want it, for a part of   \
     * one wisp; one block, to be freed with free. NULL where memory cannot be had. */             \
    X(struct sparse_matrix *, pattern, (const void *part))

struct kernel {
    int lanes;                          /* wisps side by side in a part */
    const struct system_ops *ops;       /* a part as a system; ctx is the part */
    const struct system_ops *rigid_ops; /* likewise, of parts whose segments are rigid */
#define X(type, name, arguments) type(*name) arguments;
    KERNEL_OPERATIONS(X)
#undef X
};

/* The wide ones are there with WISPLAB_WIDE_KERNELS, for processors with AVX2, and with AVX-512. */
extern const struct kernel kernel_1, kernel_4, kernel_8, kernel_wide_4, kernel_wide_8;

#endif
