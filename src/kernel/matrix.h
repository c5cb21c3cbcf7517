/* The matrices of a part's equations M v' = f with frozen frames: M, C = -df/dv and S = -df/dq.
 *
 * Skeleton: block-pentadiagonal in the free nodes, 3x3 blocks; drag is apart from C. Samples: the
 * same few numbers for all samples of a node, from which each place writes what it needs:
 *
 *   per sample mass mu, with a the half-line, P = 1 - aa', k and c of the spring over mu,
 *                      node-node        node-sample      sample-node      sample-sample
 *   projection    M    -                -                -                1
 *                 C    -                -c a             gamma a'         c + gamma
 *                 S    -                -k a             -                k
 *   generalised   M    1                a                a'               1
 *                 C    gamma            gamma a          gamma a'         c + gamma
 *                 S    -                -                -                k
 *   penalty       M    -                -                -                1
 *                 C    c aa' + c_p P    minus that       minus that       that + gamma
 *                 S    k aa' + k_p P    minus that       minus that       that
 *
 * Bodies that push by penalty add to the blocks of nodes and samples that they hold: penetrating.h.
 * A style field that parts hair pulls on all masses of a node by where the node is: with D = B n'
 * times `steep`, S of kind `exact` has -m D besides in node-node, -mu a'D in sample-node (-mu D in
 * `penalty`), and -M mu D in node-node of `generalised`; `spd` leaves it out.
 *
 * For `generalised` the equations are those of the coordinates (p, r) as Lagrange has them, which
 * are symmetric: the node's row is the row of the model plus the sum of a times the samples'. */
#ifndef WISPLAB_KERNEL_MATRIX_H
#define WISPLAB_KERNEL_MATRIX_H

#include "blocks.h"
#include "push.h"

enum { PANEL_ROWS = 9 };

/* The three columns of a node in the lower half of the nodes' matrix: row r of column c, r >= c,
 * is row r of the node for r < 3, then of the next node, and of the one after. */
struct panel {
    lane m[3][PANEL_ROWS];
};

struct kernel_matrix {
    enum jacobian kind;
    double alpha, beta; /* of the last factor */

    /* by free node i, blocks (i, i), (i, i - 1), (i, i - 2); S of kind `exact` is not symmetric,
     * its blocks (i - 1, i) and (i - 2, i) are apart */
    struct block (*stiffness)[3], (*damping)[3], (*stiffness_above)[2];

    /* by node, of the state linearised at: with stiffness and damping they are all that products
     * and factors are made of, so these hold whatever the part is asked in between */
    struct frame *frames;
    struct penetrations penetrations; /* of bodies that push; without them nothing is there */
    lane *steep;         /* by free node: how fast a parting's tanh grows with the distance, 1/m */
    struct vec *parting; /* B of that parting, m/s^2 */

    /* The matrix of the nodes after the samples are eliminated, factorised as L D L': 1 / D on the
     * diagonal, L below; two panels of zeros behind the last */
    struct panel *panel;
    size_t jacobian_numbers; /* from `stiffness` on to the panels */

    lane *kept; /* of these, while they are written anew for some lanes; or NULL */

    lane *x; /* right side and solution, 3 for each free node, and two nodes of zeros */
};

/* What eliminating the samples of a node does, for given alpha and beta: with A the sample's own
 * diagonal over mu, along the half-line and across it. */
struct elimination {
    lane to_node_along, to_node_across;     /* adds (.) b_sample to the node's right side */
    lane from_node_along, from_node_across; /* sample = b_sample / (mu A) + (.) v_node */
    lane inverse_along, inverse_across;     /* 1 / A */
    lane diagonal, diagonal_ww;             /* the node's matrix gains mu (diagonal 1 + ww w w') */
    lane alpha, beta;
};

/* Number of free nodes. */
static inline int free_nodes(const struct kernel_part *part) {
    return part->nodes - 2;
}

#endif
