/* What wisps that touch have for each other: nodes and samples as points, and what contacts ask of
 * these. Of each free node in turn the node itself, then its samples. */
#ifndef WISPLAB_CONTACT_H
#define WISPLAB_CONTACT_H

/* 64 bytes. */
struct contact_point {
    double x[3];         /* m */
    int node, sample;    /* number of the node among all that touch; -1: the node itself */
    double v[3];         /* of a node the mean of its own velocity and its samples', m/s */
    double inverse_mass; /* 1 / mass of what moves with it, 1/kg */
};

struct contact_push {
    double dv[3]; /* what all corrections add up to, m/s */
    int shares;   /* in how many it takes part */
};

#endif
