/* One wisp's state laid open for contacts: plain arrays, whatever treatment and packing it has in
 * the kernel. Contacts read and change these; what they changed goes back into the part. */
#ifndef WISPLAB_STRAND_H
#define WISPLAB_STRAND_H

#include "wisp.h"

struct strand {
    const struct wisp *wisp; /* numbers; n = wisp->nodes, M = wisp->samples */
    enum wisp_treatment treatment;

    /* by node, 0 and 1 (the head's) included: m, m/s */
    double (*p)[3], (*v)[3];
    double (*axis_u)[3], (*axis_v)[3], (*axis_w)[3]; /* frames of section "envelope", unit vectors;
                                                        without envelope w only is of use */

    double head[3][3]; /* of the head, whose axes give the first normal; 1 where it rests */

    /* by node and sample, index node * M + sample */
    double *r, *rate;         /* distance along the half-line and its rate, m, m/s */
    double (*e)[3], (*ev)[3]; /* position and velocity, m, m/s: v + rate a where the treatment has
                                 (r, rate), else the particle's own */

    double (*turn)[2]; /* by sample: cosine and sine of its angle from axis_u */

    struct strand *twin; /* born of the same subdivision and not separated from it since: they do
                            not touch; or NULL */

    int changed; /* set by whoever changes p, v, r, rate, e or ev */
};

/* The unit half-line a of a sample. */
void strand_half_line(const struct strand *strand, int node, int sample, double a[3]);

/* Tells how the head is turned. */
void strand_turn(struct strand *strand, const struct placement *head);

/* After p changed: tangents and frames again, then e and ev
 * of samples given by (r, rate), or r and rate of particles. */
void strand_refresh(struct strand *strand);

/* Moves a node by dp and its velocity by dv, and in `penalty` its samples with it. */
void strand_move_node(struct strand *strand, int node, const double dp[3], const double dv[3]);

/* Sets a sample's distance and rate along its half-line: in `penalty` e and ev change along it. */
void strand_set_sample(struct strand *strand, int node, int sample, double r, double rate);

/* A strand of one allocation for a wisp, all zero; NULL where memory cannot be had. */
struct strand *strand_create(const struct wisp *wisp, enum wisp_treatment treatment);
void strand_free(struct strand *strand);

/* From and to the rows of a frame of this wisp (columns x y z vx vy vz, then samples; `stride`
 * numbers from row to row), as kernel_sample and kernel_restore have them. */
void strand_load(struct strand *strand, const double *rows, int stride);
void strand_store(const struct strand *strand, double *rows, int stride);

#endif
