/* Symmetric and general 3x3 blocks, of all lanes. */
#ifndef WISPLAB_KERNEL_BLOCKS_H
#define WISPLAB_KERNEL_BLOCKS_H

#include "part.h"

/* s a b' */
SPECIALISED struct block block_outer(lane s, struct vec a, struct vec b) {
    const lane x[3] = {s * a.x, s * a.y, s * a.z}, y[3] = {b.x, b.y, b.z};
    struct block c;
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            c.m[i][j] = x[i] * y[j];
    return c;
}

SPECIALISED void block_add_scaled(struct block *sum, lane s, const struct block *b) {
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            sum->m[i][j] += s * b->m[i][j];
}

SPECIALISED void block_add(struct block *sum, const struct block *b) {
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            sum->m[i][j] += b->m[i][j];
}

SPECIALISED void block_add_diagonal(struct block *sum, lane s) {
    EACH (i, 0, 3)
        sum->m[i][i] += s;
}

/* s (1 - nn') */
SPECIALISED struct block block_across(lane s, struct vec n) {
    struct block b = block_outer(-s, n, n);
    block_add_diagonal(&b, s);
    return b;
}

static inline struct block block_product(const struct block *a, const struct block *b) {
    struct block c;
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j];
    return c;
}

static inline struct block block_transpose(const struct block *a) {
    struct block b;
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            b.m[i][j] = a->m[j][i];
    return b;
}

/* A block, and its transpose, times a vector. */
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

#endif
