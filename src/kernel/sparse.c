/* The part's matrix for general sparse solvers: every unknown kept, samples too. */
#include "frames.h"
#include "matrix.h"
#include "parting.h"
#include "penetrating.h"

#include <stdlib.h>

/* An unknown of a part: its free node, and which of the node's unknowns. */
struct place {
    int node, unknown;
};

/* Sample of an unknown, or -1 where it is a coordinate of the node itself. */
static int sample_of(const struct kernel_part *part, int unknown) {
    return unknown < 3 ? -1 : (unknown - 3) / (part->treatment == WISP_PENALTY ? 3 : 1);
}

/* Whether the matrix can have an entry there: nodes reach two nodes on, samples their node. */
static int coupled(const struct kernel_part *part, struct place row, struct place column) {
    const int r = sample_of(part, row.unknown), c = sample_of(part, column.unknown);
    if (r < 0 && c < 0)
        return abs(row.node - column.node) <= 2;
    return row.node == column.node && (r < 0 || c < 0 || r == c);
}

/* Calls for every entry in the order of the pattern: columns in turn, rows ascending. */
#define FOR_EACH_ENTRY(part, row, column)                                   \
    for (struct place column = {0, 0}; column.node < free_nodes(part);      \
         column = next_place(part, column))                                 \
        for (struct place row = {column.node > 2 ? column.node - 2 : 0, 0}; \
             row.node < free_nodes(part) && row.node <= column.node + 2;    \
             row = next_place(part, row))                                   \
            if (coupled(part, row, column))

static struct place next_place(const struct kernel_part *part, struct place at) {
    return at.unknown + 1 < part->node_unknowns ? (struct place){at.node, at.unknown + 1}
                                                : (struct place){at.node + 1, 0};
}

struct sparse_matrix *LANED(kernel_pattern)(const void *ctx) {
    const struct kernel_part *part = ctx;
    const int size = free_nodes(part) * part->node_unknowns;
    int count = 0;
    FOR_EACH_ENTRY (part, row, column)
        count++;
    struct sparse_matrix *pattern =
        malloc(sizeof *pattern + (size_t)(size + 1 + count) * sizeof(int));
    if (!pattern)
        return NULL;
    *pattern = (struct sparse_matrix){.size = size, .column_start = (int *)(pattern + 1)};
    pattern->row = pattern->column_start + size + 1;
    count = 0;
    pattern->column_start[0] = 0;
    FOR_EACH_ENTRY (part, row, column) {
        pattern->row[count++] = row.node * part->node_unknowns + row.unknown;
        pattern->column_start[column.node * part->node_unknowns + column.unknown + 1] = count;
    }
    return pattern;
}

static lane component(struct vec a, int c) {
    return c == 0 ? a.x : c == 1 ? a.y : a.z;
}

/* Entry of the skeleton between two nodes' coordinates. */
static lane node_entry(const struct kernel_part *part, lane alpha, lane beta, struct place row,
                       struct place column) {
    const struct kernel_matrix *m = part->matrix;
    const int b = row.node - column.node, r = row.unknown, c = column.unknown;
    if (b >= 0)
        return alpha * m->damping[row.node][b].m[r][c] + beta * m->stiffness[row.node][b].m[r][c];
    const lane stiffness = m->kind == JACOBIAN_EXACT
                               ? m->stiffness_above[column.node][-b - 1].m[r][c]
                               : m->stiffness[column.node][-b].m[c][r];
    return alpha * m->damping[column.node][-b].m[c][r] + beta * stiffness;
}

/* Entry over mu between a node and its samples, from the table in matrix.h; r, c: samples, or -1
 * for the node. */
static lane sample_entry(const struct kernel_part *part, lane alpha, lane beta, struct place row,
                         struct place column, int j) {
    const struct frame *frame = &part->matrix->frames[row.node + 2];
    const struct vec a = half_line(part, frame, j, part->samples);
    const int row_node = row.unknown < 3, column_node = column.unknown < 3;
    const lane g = 1 + alpha * part->drag, h = alpha * part->spring_c + beta * part->spring_k;
    if (part->treatment == WISP_PENALTY) {
        const int x = row.unknown % 3, y = column.unknown % 3;
        const lane across = alpha * part->penalty_c + beta * part->penalty_k;
        lane pull = (h - across) * component(a, x) * component(a, y);
        if (x == y)
            pull += across;
        if (row_node != column_node)
            return -pull;
        return !row_node && x == y ? pull + g : pull;
    }
    const int mixed = part->treatment == WISP_GENERALISED;
    if (row_node && column_node)
        return mixed && row.unknown == column.unknown ? g : lane_all(0);
    if (row_node)
        return (mixed ? g : -h) * component(a, row.unknown);
    if (column_node)
        return (mixed ? g : alpha * part->drag) * component(a, column.unknown);
    return g + h;
}

/* What bodies add to that, see penetrating.h. */
static lane penetrating_entry(const struct kernel_part *part, lane alpha, lane beta,
                              struct place row, struct place column, int j) {
    const struct kernel_matrix *m = part->matrix;
    const struct penetration *penetrations = penetrating_node(part, &m->penetrations, row.node);
    if (!is_penetrating(penetrations, j))
        return lane_all(0);
    const struct block T = penetration_matrix(&penetrations[1 + j], alpha, beta);
    const struct vec a = half_line(part, &m->frames[row.node + 2], j, part->samples);
    const int row_node = row.unknown < 3, column_node = column.unknown < 3;
    if (part->treatment == WISP_PENALTY)
        return row_node || column_node ? lane_all(0) : T.m[row.unknown % 3][column.unknown % 3];
    if (row_node && part->treatment == WISP_PROJECTION)
        return lane_all(0);
    if (row_node)
        return column_node ? T.m[row.unknown][column.unknown]
                           : component(block_times(&T, a), row.unknown);
    const struct vec along = transposed_times(&T, a);
    return column_node ? component(along, column.unknown) : dot(along, a);
}

static lane of_sample(const struct kernel_part *part, lane alpha, lane beta, struct place row,
                      struct place column, int j) {
    const lane own = sample_entry(part, alpha, beta, row, column, j);
    return part->push ? own + penetrating_entry(part, alpha, beta, row, column, j) : own;
}

static lane entry(const struct kernel_part *part, lane alpha, lane beta, struct place row,
                  struct place column) {
    const int r = sample_of(part, row.unknown), c = sample_of(part, column.unknown);
    const lane mu = part->sample_mass[row.node + 2];
    if (r >= 0 || c >= 0)
        return mu * of_sample(part, alpha, beta, row, column, r >= 0 ? r : c);
    lane sum = node_entry(part, alpha, beta, row, column);
    if (row.node != column.node)
        return sum;
    if (row.unknown == column.unknown)
        sum += part->mass[row.node + 2] * (1 + alpha * part->drag);
    for (int j = 0; j < part->samples; j++)
        sum += mu * of_sample(part, alpha, beta, row, column, j);
    return sum;
}

/* What a parting adds there. */
static lane parting_entry(const struct kernel_part *part, lane beta, struct place row,
                          struct place column) {
    const struct kernel_matrix *m = part->matrix;
    const int i = row.node, j = sample_of(part, row.unknown);
    if (row.node != column.node || column.unknown >= 3)
        return lane_all(0);
    const lane along = m->steep[i] * component(parting_normal(part), column.unknown);
    lane pull = component(*m->parting, row.unknown % 3), mass = part->sample_mass[i + 2];
    if (j < 0)
        mass = part->mass[i + 2] + (part->treatment == WISP_GENERALISED ? part->samples : 0) * mass;
    else if (part->treatment != WISP_PENALTY)
        pull = dot(half_line(part, &m->frames[i + 2], j, part->samples), *m->parting);
    return -beta * mass * along * pull;
}

void LANED(kernel_assemble)(void *ctx, double alpha, double beta, double *values) {
    const struct kernel_part *part = ctx;
    const int parted = part->matrix->kind == JACOBIAN_EXACT && has_parting(part);
    int at = 0;
    FOR_EACH_ENTRY (part, row, column) {
        lane sum = entry(part, lane_all(alpha), lane_all(beta), row, column);
        if (parted)
            sum += parting_entry(part, lane_all(beta), row, column);
        store(values, at++, sum);
    }
}
