/* Products with the matrices of a part, and the direct solver of M + alpha C + beta S: samples
 * eliminated node by node, then L D L' of the block-pentadiagonal matrix of the nodes. */
#include "frames.h"
#include "matrix.h"

/* --- samples --- */

/* See the table in matrix.h for M, C and S, from which A = M + alpha C + beta S. For evenly spread
 * half-lines sum aa' = M/2 (1 - ww'), which gives the node's gain. */
static inline struct elimination eliminate(const struct kernel_part *part, lane alpha, lane beta) {
    const lane half = lane_all(0.5 * part->samples), zero = lane_all(0);
    const lane h = alpha * part->spring_c + beta * part->spring_k;
    const lane air = alpha * part->drag, g = 1 + air;
    const lane inverse = 1 / (g + h);
    struct elimination e = {.inverse_along = inverse, .inverse_across = zero};
    lane gain; /* along each half-line, times aa' */
    switch (part->treatment) {
    case WISP_PROJECTION:
        gain = h * air * inverse;
        e.to_node_along = h * inverse;
        e.from_node_along = -air * inverse;
        e.to_node_across = e.from_node_across = zero;
        e.diagonal = half * gain;
        e.diagonal_ww = -half * gain;
        break;
    case WISP_GENERALISED:
        gain = -g * g * inverse;
        e.to_node_along = e.from_node_along = -g * inverse;
        e.to_node_across = e.from_node_across = zero;
        e.diagonal = 2 * half * g + half * gain;
        e.diagonal_ww = -half * gain;
        break;
    default: {
        const lane h_across = alpha * part->penalty_c + beta * part->penalty_k;
        const lane gain_across = h_across * g / (g + h_across);
        gain = h * g * inverse;
        e.inverse_across = 1 / (g + h_across);
        e.to_node_along = e.from_node_along = h * inverse;
        e.to_node_across = e.from_node_across = h_across / (g + h_across);
        e.diagonal = 2 * half * gain_across + half * (gain - gain_across);
        e.diagonal_ww = -half * (gain - gain_across);
    }
    }
    return e;
}

/* s_along times the part of x along a, s_across times the rest. */
static inline struct vec split(lane s_along, lane s_across, struct vec a, struct vec x) {
    return add_scaled(scale(s_across, x), (s_along - s_across) * dot(a, x), a);
}

/* --- products --- */

static inline void add_node(lane *y, int node, struct vec a) {
    y[3 * node] += a.x;
    y[3 * node + 1] += a.y;
    y[3 * node + 2] += a.z;
}

static inline struct vec block_times(const struct block *b, struct vec x) {
    return (struct vec){b->m[0][0] * x.x + b->m[0][1] * x.y + b->m[0][2] * x.z,
                        b->m[1][0] * x.x + b->m[1][1] * x.y + b->m[1][2] * x.z,
                        b->m[2][0] * x.x + b->m[2][1] * x.y + b->m[2][2] * x.z};
}

static inline struct vec transposed_times(const struct block *b, struct vec x) {
    return (struct vec){b->m[0][0] * x.x + b->m[1][0] * x.y + b->m[2][0] * x.z,
                        b->m[0][1] * x.x + b->m[1][1] * x.y + b->m[2][1] * x.z,
                        b->m[0][2] * x.x + b->m[1][2] * x.y + b->m[2][2] * x.z};
}

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

/* The rows of a node's samples, and what they add to the node's: y = (m M + d C + k S) x. */
static struct vec samples_times(const struct kernel_part *part, int i, lane m, lane d, lane k,
                                const double *x, double *y) {
    const struct frame *frame = &part->frames[i];
    const lane mu = part->sample_mass[i], h = d * part->spring_c + k * part->spring_k;
    const lane g = m + d * part->drag;
    const struct vec node = vec_load(x, 0);
    struct vec sum = {lane_all(0), lane_all(0), lane_all(0)};
    for (int j = 0; j < part->samples; j++) {
        const struct vec a = half_line(part, frame, j, part->samples);
        if (part->treatment == WISP_PENALTY) {
            const struct vec e = vec_load(x, 3 + 3 * j);
            const lane across = d * part->penalty_c + k * part->penalty_k;
            const struct vec pull = split(h, across, a, sub(e, node));
            vec_store(y, 3 + 3 * j, scale(mu, add_scaled(pull, g, e)));
            sum = sub(sum, scale(mu, pull));
            continue;
        }
        const lane r = load(x, 3 + j);
        const int coupled = part->treatment == WISP_GENERALISED;
        const lane to_sample = coupled ? g : d * part->drag, to_node = coupled ? g : -h;
        store(y, 3 + j, mu * (to_sample * dot(a, node) + (g + h) * r));
        sum = add_scaled(sum, mu * to_node * r, a);
        if (coupled)
            sum = add_scaled(sum, mu * g, node);
    }
    return sum;
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
        const struct vec a = scale(own, nodes[i]);
        sum[3 * i] = a.x, sum[3 * i + 1] = a.y, sum[3 * i + 2] = a.z;
    }
    skeleton_times(part, damping, stiffness, nodes, sum);
    for (int i = 0; i < f; i++) {
        const int at = i * part->node_unknowns * LANES;
        if (part->samples > 0)
            add_node(sum, i, samples_times(part, i + 2, mass, damping, stiffness, x + at, y + at));
        for (int c = 0; c < 3; c++)
            store(y + at, c, sum[3 * i + c]);
    }
}

/* --- factorisation --- */

/* Entry (i, j) of the matrix of node i + 2 itself, c >= e, without the skeleton's springs. */
static inline lane own_entry(const struct kernel_part *part, const struct elimination *e, int i,
                             int row, int column, lane air) {
    const struct vec w = part->frames[i + 2].w;
    const lane ww[3] = {w.x, w.y, w.z};
    lane entry = row == column ? part->mass[i + 2] * (1 + air) : lane_all(0);
    if (part->samples > 0) {
        const lane mu = part->sample_mass[i + 2];
        entry += mu * e->diagonal_ww * ww[row] * ww[column];
        if (row == column)
            entry += mu * e->diagonal;
    }
    return entry;
}

/* The lower half of the nodes' matrix, by columns: the blocks (i, i - b) of S and C. */
static void fill_columns(const struct kernel_part *part, lane alpha, lane beta) {
    struct kernel_matrix *m = part->matrix;
    const struct elimination e = eliminate(part, alpha, beta);
    const int f = free_nodes(part);
    memset(m->column, 0, (size_t)(3 * f + BAND) * sizeof *m->column);
    for (int i = 0; i < f; i++)
        for (int b = 0; b <= 2 && b <= i; b++)
            for (int row = 0; row < 3; row++)
                for (int column = 0; column < (b == 0 ? row + 1 : 3); column++) {
                    lane entry = alpha * m->damping[i][b].m[row][column] +
                                 beta * m->stiffness[i][b].m[row][column];
                    if (b == 0)
                        entry += own_entry(part, &e, i, row, column, alpha * part->drag);
                    m->column[3 * (i - b) + column][3 * b + row - column] = entry;
                }
}

int LANED(kernel_factor)(void *ctx, double alpha, double beta) {
    struct kernel_part *part = ctx;
    struct kernel_matrix *m = part->matrix;
    const int rows = 3 * free_nodes(part);
    mask positive = lane_all(0) == 0;
    m->alpha = alpha;
    m->beta = beta;
    fill_columns(part, lane_all(alpha), lane_all(beta));
    for (int k = 0; k < rows; k++) {
        lane *column = m->column[k];
        positive &= column[0] > 0;
        const lane inverse = 1 / column[0];
        for (int j = 1; j < BAND; j++) {
            const lane l = column[j] * inverse;
            lane *to = m->column[k + j];
            for (int i = j; i < BAND; i++)
                to[i - j] -= l * column[i];
        }
        for (int j = 1; j < BAND; j++)
            column[j] *= inverse;
        column[0] = inverse;
    }
    if (mask_all(positive))
        return 0;
    return system_fail(part->system, SOLVER_STALLED,
                       "the matrix of the implicit step is not positive definite");
}

/* --- solution --- */

static void solve_nodes(const struct kernel_matrix *m, int rows) {
    lane *x = m->x;
    for (int k = 0; k < rows; k++)
        for (int j = 1; j < BAND; j++)
            x[k + j] -= m->column[k][j] * x[k];
    for (int k = rows - 1; k >= 0; k--) {
        x[k] *= m->column[k][0];
        for (int j = 1; j < BAND; j++)
            x[k] -= m->column[k][j] * x[k + j];
    }
}

/* What the samples' right sides add to their node's. */
static struct vec gather_samples(const struct kernel_part *part, const struct elimination *e,
                                 const struct frame *frame, const double *b) {
    struct vec sum = {lane_all(0), lane_all(0), lane_all(0)};
    for (int j = 0; j < part->samples; j++) {
        const struct vec a = half_line(part, frame, j, part->samples);
        sum = part->treatment == WISP_PENALTY
                  ? add(sum, split(e->to_node_along, e->to_node_across, a, vec_load(b, 3 + 3 * j)))
                  : add_scaled(sum, e->to_node_along * load(b, 3 + j), a);
    }
    return sum;
}

/* The samples' solutions from their right sides and their node's solution. */
static void scatter_samples(const struct kernel_part *part, const struct elimination *e, int i,
                            const double *b, struct vec node, double *x) {
    const lane inverse_mass = 1 / part->sample_mass[i];
    for (int j = 0; j < part->samples; j++) {
        const struct vec a = half_line(part, &part->frames[i], j, part->samples);
        if (part->treatment == WISP_PENALTY) {
            const struct vec own =
                split(e->inverse_along * inverse_mass, e->inverse_across * inverse_mass, a,
                      vec_load(b, 3 + 3 * j));
            vec_store(x, 3 + 3 * j,
                      add(own, split(e->from_node_along, e->from_node_across, a, node)));
        } else {
            store(x, 3 + j,
                  e->inverse_along * inverse_mass * load(b, 3 + j) +
                      e->from_node_along * dot(a, node));
        }
    }
}

void LANED(kernel_solve)(void *ctx, const double *b, double *x) {
    struct kernel_part *part = ctx;
    const struct kernel_matrix *m = part->matrix;
    const int f = free_nodes(part), stride = part->node_unknowns * LANES;
    const struct elimination e = eliminate(part, lane_all(m->alpha), lane_all(m->beta));

    for (int i = 0; i < f; i++) {
        struct vec rhs = vec_load(b + i * stride, 0);
        if (part->samples > 0)
            rhs = add(rhs, gather_samples(part, &e, &part->frames[i + 2], b + i * stride));
        m->x[3 * i] = rhs.x, m->x[3 * i + 1] = rhs.y, m->x[3 * i + 2] = rhs.z;
    }
    for (int j = 0; j < BAND; j++)
        m->x[3 * f + j] = lane_all(0);
    solve_nodes(m, 3 * f);
    for (int i = 0; i < f; i++) {
        const struct vec node = {m->x[3 * i], m->x[3 * i + 1], m->x[3 * i + 2]};
        vec_store(x + i * stride, 0, node);
        if (part->samples > 0)
            scatter_samples(part, &e, i + 2, b + i * stride, node, x + i * stride);
    }
}
