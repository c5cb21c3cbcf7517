/* Products with the matrices of a part, and the direct solver of M + alpha C + beta S: samples
 * eliminated node by node, then L D L' of the block-pentadiagonal matrix of the nodes. */
#include "panel.h"
#include "parting.h"

/* --- products --- */

/* y += (d C + k S) x of the skeleton; x and y have one vector for each free node. */
static void skeleton_times(const struct kernel_part *part, lane d, lane k, const struct vec *x,
                           lane *y) {
    const struct kernel_matrix *m = part->matrix;
    const int exact = m->kind == JACOBIAN_EXACT;
    for (int i = 0; i < free_nodes(part); i++) {
        for (int b = 0; b <= 2 && b <= i; b++) {
            const struct block *C = &m->damping[i][b], *S = &m->stiffness[i][b];
            add_node(y, i,
                     add(scale(d, block_times(C, x[i - b])), scale(k, block_times(S, x[i - b]))));
            if (b == 0)
                continue;
            const struct vec above = exact ? block_times(&m->stiffness_above[i][b - 1], x[i])
                                           : transposed_times(S, x[i]);
            add_node(y, i - b, add(scale(d, transposed_times(C, x[i])), scale(k, above)));
        }
    }
}

/* Adds k S x of a parting, of free node i to `sum` and of its samples to y. */
static void parting_times(const struct kernel_part *part, int i, lane k, const double *x, lane *sum,
                          double *y) {
    const struct kernel_matrix *m = part->matrix;
    const struct vec pull =
        scale(-k * m->steep[i] * dot(parting_normal(part), vec_load(x, 0)), *m->parting);
    const lane mu = part->sample_mass[i + 2];
    const int coupled = part->treatment == WISP_GENERALISED ? part->samples : 0;
    add_node(sum, i, scale(part->mass[i + 2] + coupled * mu, pull));
    for (int j = 0; j < part->samples; j++) {
        if (part->treatment == WISP_PENALTY) {
            vec_store(y, 3 + 3 * j, add_scaled(vec_load(y, 3 + 3 * j), mu, pull));
            continue;
        }
        const struct vec a = half_line(part, &m->frames[i + 2], j, part->samples);
        store(y, 3 + j, load(y, 3 + j) + mu * dot(a, pull));
    }
}

void LANED(kernel_product)(void *ctx, double m, double d, double k, const double *x, double *y) {
    struct kernel_part *part = ctx;
    const int f = free_nodes(part);
    struct vec *nodes = part->force; /* work space */
    lane *sum = part->matrix->x;
    /* the seam's D and K are -C and -S */
    const lane mass = lane_all(m), damping = lane_all(-d), stiffness = lane_all(-k);

    for (int i = 0; i < f; i++) {
        const int at = i * part->node_unknowns;
        nodes[i] = vec_load(x, at);
        const lane own = part->mass[i + 2] * (mass + damping * part->drag);
        put_node(sum, i, scale(own, nodes[i]));
    }
    if (d != 0 || k != 0) /* M alone is asked for at every solve of CVODE */
        skeleton_times(part, damping, stiffness, nodes, sum);
    for (int i = 0; i < f; i++) {
        const int at = i * part->node_unknowns * LANES;
        if (part->samples > 0) {
            const struct frame *frame = &part->matrix->frames[i + 2];
            const struct penetration *penetrations =
                penetrating_node(part, &part->matrix->penetrations, i);
            struct vec on =
                samples_times(part, frame, i + 2, mass, damping, stiffness, x + at, y + at);
            if (penetrations)
                on = penetrating_times(part, frame, penetrations, i + 2, damping, stiffness, x + at,
                                       y + at, on);
            add_node(sum, i, on);
        }
        if (part->matrix->kind == JACOBIAN_EXACT && has_parting(part))
            parting_times(part, i, stiffness, x + at, sum, y + at);
        for (int c = 0; c < 3; c++)
            store(y + at, c, sum[3 * i + c]);
    }
}

/* --- factorisation --- */

/* Rows first_row to first_row + 2 of a panel: alpha C + beta S. The node's own block is wanted
 * below its diagonal only, but all of it is written. */
SPECIALISED void combine_blocks(struct panel *panel, int first_row, lane alpha, lane beta,
                                const struct block *C, const struct block *S) {
    EACH (c, 0, 3)
        EACH (r, 0, 3)
            panel->m[c][first_row + r] = alpha * C->m[r][c] + beta * S->m[r][c];
}

SPECIALISED void clear_rows(struct panel *panel, int first_row) {
    EACH (c, 0, 3)
        EACH (r, 0, 3)
            panel->m[c][first_row + r] = lane_all(0);
}

/* The columns of a node, as assembled; rows beyond the tip are zero. */
SPECIALISED void assemble_panel(const struct kernel_part *part, const struct elimination *e, int i,
                                lane alpha, lane beta, struct panel *panel) {
    const struct kernel_matrix *m = part->matrix;
    const int left = free_nodes(part) - i;
    combine_blocks(panel, 0, alpha, beta, &m->damping[i][0], &m->stiffness[i][0]);
    add_samples(part, m->frames, e, &m->penetrations, i, panel);
    if (left > 1)
        combine_blocks(panel, 3, alpha, beta, &m->damping[i + 1][1], &m->stiffness[i + 1][1]);
    else
        clear_rows(panel, 3);
    if (left > 2)
        combine_blocks(panel, 6, alpha, beta, &m->damping[i + 2][2], &m->stiffness[i + 2][2]);
    else
        clear_rows(panel, 6);
}

int LANED(kernel_factor)(void *ctx, double alpha, double beta) {
    struct kernel_part *part = ctx;
    struct kernel_matrix *m = part->matrix;
    const lane a = lane_all(alpha), b = lane_all(beta);
    const struct elimination e = eliminate(part, a, b);
    mask positive = lane_all(0) == 0;
    struct pending_update pending = no_pending_update();
    m->alpha = alpha;
    m->beta = beta;
    for (int i = 0; i < free_nodes(part); i++) {
        struct panel ld;
        assemble_panel(part, &e, i, a, b, &ld);
        positive &= factor_panel(&ld, &pending, &m->panel[i]);
    }
    return mask_all(positive) ? 0 : refuse_matrix(part);
}

void LANED(kernel_solve)(void *ctx, const double *b, double *x) {
    struct kernel_part *part = ctx;
    const struct kernel_matrix *m = part->matrix;
    const struct elimination e = eliminate(part, lane_all(m->alpha), lane_all(m->beta));
    for (int i = 0; i < free_nodes(part); i++)
        put_node(m->x, i, vec_load(b, i * part->node_unknowns));
    solve_all(part, m->frames, &e, &m->penetrations, m->panel, b, m->x, x);
}
