/* Hair by laws that came before the thesis's (its chapter 3): the wisps of a scene as chains of n
 * nodes, of which 0 and 1 rest, each alone in a part of one lane, in plain scalar code. What the
 * laws have in common is here; rosenblum.c and anjyo.c are the laws. */
#ifndef WISPLAB_CHAINS_H
#define WISPLAB_CHAINS_H

#include "model.h"
#include "scene.h"

/* One wisp. Laws extend it: the first member of a struct of their own. */
struct chain {
    const struct chain_law *law;
    const struct wisp *wisp; /* the scene's */
    const struct surroundings *around;
    struct system *system; /* of its part */
    struct sparse_matrix pattern;
    double (*point)[3]; /* by node: room for who needs one vector each */
};

struct chain_law {
    const struct problem *problem;
    const struct system_ops *ops;
    const char *name;            /* for messages */
    unsigned matrix;             /* enum matrix_property of its exact Jacobian */
    const char *matrix_note;     /* why it is not symmetric, or NULL */
    int node_unknowns;           /* of each free node, those of node 2 first */
    const char *const *unknowns; /* their names, and their unit */
    const char *unit;
    int reach; /* how many nodes away an unknown is felt in the Jacobian */

    /* A chain with what the law needs, one block, but for struct chain; NULL where memory cannot be
     * had. */
    struct chain *(*create)(const struct scene *scene, const struct wisp *wisp);

    /* The state at rest. */
    void (*start)(const struct chain *chain, double *q, double *v);

    /* Positions of all nodes in space (derivative 0), or velocities (1), or accelerations (2; only
     * then is `a` looked at) into chain->point. */
    void (*points)(const struct chain *chain, int derivative, const double *q, const double *v,
                   const double *a);

    /* A state of its nodes: rows of `stride` numbers that begin with x y z vx vy vz. */
    void (*take)(const struct chain *chain, const double *rows, int stride, double *q, double *v);
};

/* For the functions of a problem. */
struct model *chains_create(const struct scene *scene, const struct chain_law *law);
void chains_free(struct model *model);
void chains_sample(const struct model *model, double *rows);
void chains_restore(struct model *model, const double *rows);
void chains_sample_accelerations(const struct model *model, double *const *a, double *rows);
struct unknown chains_unknown(const struct model *model, int i, int k);
extern const struct treatment chain_treatments[];

/* The chain of part i. */
static inline const struct chain *chain_of(const struct model *model, int i) {
    return model->parts[i].system.ctx;
}

#endif
