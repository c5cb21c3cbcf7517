/* The slow, obvious twin of the kernel: the same model of one wisp, term by term, in plain scalar C
 * (Plante 1999, sections 4.1 and 4.2.1; README.md says where the model differs). Tests hold the
 * vectorised kernel against it, so the two share no code; it is also the baseline of speed
 * comparisons, so it does nothing that a plain program would not.
 *
 * Vectors: the free nodes 2, 3, ..., n-1 in turn; of each x y z, then r_0 ... r_{M-1}, or with
 * `penalty` e_0x e_0y e_0z e_1x ...; v holds the rates of the same. They never alias. The head is
 * at rest: nodes 0 and 1 stay where the wisp starts. */
#ifndef WISPLAB_WISP_TWIN_H
#define WISPLAB_WISP_TWIN_H

#include "wisp/wisp.h"

enum { WISP_TWIN_NODES_MAX = 64 };

enum wisp_twin_term { WISP_TWIN_STRETCH, WISP_TWIN_BEND };

/* The parts of a term; to be or'ed. */
enum wisp_twin_part { WISP_TWIN_ELASTIC = 1, WISP_TWIN_DAMPING = 2 };

/* Three components for each node. */
typedef double wisp_twin_vectors[WISP_TWIN_NODES_MAX][3];

struct wisp_twin {
    int nodes, samples, unknowns; /* n, M, of one free node */
    enum wisp_treatment treatment;
    double root[3], direction[3], spacing;

    double gravity[3], drag_rate;
    const struct body *pushing; /* by penalty; not owned */
    int pushing_count;
    struct wind wind;
    double wind_angular_frequency[WIND_TERMS_MAX]; /* 2 pi f_k */

    enum stretch stretch;
    enum bending bending;
    double stretch_constant, stretch_damping; /* k, c */
    double bend_constant, bend_damping;       /* k, c of a skip spring; kappa, tau_b kappa */

    double radius;
    double cosine[SAMPLES_MAX], sine[SAMPLES_MAX]; /* of 2 pi j/M */

    /* By node; those of nodes 0 and 1 are not used. */
    double mass[WISP_TWIN_NODES_MAX], inverse_mass[WISP_TWIN_NODES_MAX];
    double sample_mass[WISP_TWIN_NODES_MAX], inverse_sample_mass[WISP_TWIN_NODES_MAX]; /* mu */
    double envelope_constant[WISP_TWIN_NODES_MAX], envelope_damping[WISP_TWIN_NODES_MAX];
    double penalty_constant[WISP_TWIN_NODES_MAX], penalty_damping[WISP_TWIN_NODES_MAX];
    double inverse_mass_along[WISP_TWIN_NODES_MAX];  /* `generalised`: along w, */
    double inverse_mass_across[WISP_TWIN_NODES_MAX]; /* and across it */

    /* What follows from the state at hand, at time t. Rows 0 and 1 of positions, velocities and
     * frames, and row 0 of the segments, are the head's and written once. */
    double t;
    wisp_twin_vectors position, velocity, force;
    wisp_twin_vectors tangent;                                               /* t_i */
    double length[WISP_TWIN_NODES_MAX], inverse_length[WISP_TWIN_NODES_MAX]; /* of (i, i+1) */
    wisp_twin_vectors frame_u, frame_v, frame_w;
};

/* 0; -1 where the numbers are none of a wisp, or it has more than WISP_TWIN_NODES_MAX nodes. The
 * wisp's direction must be a unit vector. */
int wisp_twin_init(struct wisp_twin *twin, const struct wisp *wisp,
                   const struct surroundings *surroundings, enum wisp_treatment treatment);

/* Doubles in q, in v, in a. */
int wisp_twin_size(const struct wisp_twin *twin);

/* The start: rest shape, at rest, every sample on its half-line at r = R. */
void wisp_twin_rest(const struct wisp_twin *twin, double *q, double *v);

/* 0; -1 where a segment has no length, or a skip spring has none: its direction is not defined; or
 * where no tensions keep rigid segments at their length. */
int wisp_twin_acceleration(struct wisp_twin *twin, double t, const double *q, const double *v,
                           double *a);

/* The acceleration with the frames given, n rows each (u, v and w of wisp_twin_frames). */
int wisp_twin_acceleration_frozen(struct wisp_twin *twin, double t, const double *q,
                                  const double *v, const double (*u)[3],
                                  const double (*v_normal)[3], const double (*w)[3], double *a);

/* The frames of all nodes, n rows each. */
void wisp_twin_frames(struct wisp_twin *twin, const double *q, double (*u)[3], double (*v)[3],
                      double (*w)[3]);

/* Kinetic, elastic and gravitational energy of free nodes and samples, J; potential 0 at the
 * origin. Elastic: stretch, bending, envelope springs, with `penalty` also the springs across.
 *
 * In `projection` and `generalised` a sample is at p + r a with velocity v + r' a, its line not
 * turning. Without drag and damping
 *   - and without an envelope, this energy is conserved;
 *   - in `generalised` and `penalty` it is conserved as long as the frames are held: frames that
 *     turn with the nodes do work on the samples that no node pays for;
 *   - in `projection` not even then: what pushes a sample across its line is lost. */
double wisp_twin_energy(struct wisp_twin *twin, double t, const double *q, const double *v);

/* The energy with the frames given. */
double wisp_twin_energy_frozen(struct wisp_twin *twin, double t, const double *q, const double *v,
                               const double (*u)[3], const double (*v_normal)[3],
                               const double (*w)[3]);

/* For each component of a the sum of the absolute values of what it is summed from, differences
 * taken apart: rounding makes errors of some 1e-16 of this. Where a frame's vector enters, it
 * counts as 1 in each component, since its error is about the same in all. */
void wisp_twin_scale(struct wisp_twin *twin, double t, const double *q, const double *v,
                     double *scale);

/* The forces of one term, of all its springs, on all nodes, prescribed ones included: 3n numbers.
 * `parts` is of enum wisp_twin_part. 0; -1 as for the acceleration. */
int wisp_twin_spring_forces(struct wisp_twin *twin, enum wisp_twin_term term, unsigned parts,
                            const double *q, const double *v, double *f);

#endif
