#include "grid.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Points are sorted by the hash of their cell, so that a cell's points stand together; those of
 * another cell with the same hash stand among them and are told apart by their cell. A point is in
 * one cell and a box asks for each cell once: nothing is found twice, and no mailbox is needed
 * (the thesis puts sections into all cells that they touch). */
struct slot {
    double x[3];
    uint64_t cell;
    int point;
};

enum { CELLS = 1 << 21 }; /* along each axis; three such numbers in one of 64 bits */

struct grid {
    double per_metre; /* cells */
    int count, room;
    unsigned mask;     /* number of hashes - 1; a power of two >= count, less 1 */
    int *start;        /* by hash: first of its slots; mask + 2 of them */
    uint64_t *cell;    /* by point */
    struct slot *slot; /* in the order of hashes, then of points */
};

struct grid *grid_create(void) {
    return calloc(1, sizeof(struct grid));
}

void grid_free(struct grid *grid) {
    if (!grid)
        return;
    free(grid->start);
    free(grid->cell);
    free(grid->slot);
    free(grid);
}

/* The cell of a coordinate. What is too far out for the number goes with the outermost cell; that
 * keeps the order of coordinates, so that a box still covers the cells of all that is in it. */
static int cell_along(double x, double per_metre) {
    const double most = CELLS - 1, cell = floor(x * per_metre) + CELLS / 2;
    return (int)(cell > most ? most : cell > 0 ? cell : 0);
}

static uint64_t cell_at(int x, int y, int z) {
    return ((uint64_t)x * CELLS + (uint64_t)y) * CELLS + (uint64_t)z;
}

/* Cells that follow one another along z do so in memory: a box is read in runs (1.2 times as quick
 * as cells strewn at random). Fibonacci hashing of the rest. */
static unsigned hash_of(uint64_t cell, unsigned mask) {
    const uint64_t column = cell / CELLS;
    return ((unsigned)(column * 0x9e3779b97f4a7c15u >> 32) + (unsigned)(cell % CELLS)) & mask;
}

static int make_room(struct grid *g, int count) {
    if (count <= g->room)
        return 0;
    size_t hashes = 16;
    while (hashes < (size_t)count)
        hashes *= 2;
    free(g->start);
    free(g->cell);
    free(g->slot);
    g->room = 0;
    g->start = malloc((hashes + 1) * sizeof *g->start);
    g->cell = malloc(hashes * sizeof *g->cell);
    g->slot = malloc(hashes * sizeof *g->slot);
    if (!g->start || !g->cell || !g->slot)
        return -1;
    g->room = (int)hashes;
    g->mask = (unsigned)hashes - 1;
    return 0;
}

int grid_fill(struct grid *g, double cell, const double (*points)[3], int count) {
    g->count = 0;
    if (make_room(g, count))
        return -1;
    g->per_metre = 1 / cell;
    g->count = count;
    memset(g->start, 0, (g->mask + 2) * sizeof *g->start);
    for (int i = 0; i < count; i++) {
        const double *x = points[i];
        g->cell[i] = cell_at(cell_along(x[0], g->per_metre), cell_along(x[1], g->per_metre),
                             cell_along(x[2], g->per_metre));
        g->start[hash_of(g->cell[i], g->mask)]++;
    }
    for (unsigned h = 1; h <= g->mask + 1; h++) /* now the end of each hash's slots */
        g->start[h] += g->start[h - 1];
    for (int i = count - 1; i >= 0; i--) { /* and with the last point put, their start */
        struct slot *slot = &g->slot[--g->start[hash_of(g->cell[i], g->mask)]];
        slot->point = i;
        slot->cell = g->cell[i];
        memcpy(slot->x, points[i], sizeof slot->x);
    }
    return 0;
}

static int in_box(const struct slot *slot, const double low[3], const double high[3]) {
    int in = 1;
    for (int k = 0; k < 3; k++)
        in &= (slot->x[k] >= low[k]) & (slot->x[k] <= high[k]); /* both: no branch to guess */
    return in;
}

static int find_in_cell(const struct grid *g, uint64_t cell, const double low[3],
                        const double high[3], int *found) {
    const unsigned hash = hash_of(cell, g->mask);
    int count = 0;
    for (int i = g->start[hash]; i < g->start[hash + 1]; i++) {
        found[count] = g->slot[i].point; /* to stay if it counts: no branch to guess */
        count += (g->slot[i].cell == cell) & in_box(&g->slot[i], low, high);
    }
    return count;
}

static int find_anywhere(const struct grid *g, const double low[3], const double high[3],
                         int *found) {
    int count = 0;
    for (int i = 0; i < g->count; i++)
        if (in_box(&g->slot[i], low, high))
            found[count++] = g->slot[i].point;
    return count;
}

int grid_find(const struct grid *g, const double low[3], const double high[3], int *found) {
    int from[3], to[3], count = 0;
    double cells = 1;
    for (int k = 0; k < 3; k++) {
        from[k] = cell_along(low[k], g->per_metre);
        to[k] = cell_along(high[k], g->per_metre);
        cells *= (double)to[k] - from[k] + 1;
    }
    if (cells > g->count) /* of a box that large it is quicker to look at every point */
        return find_anywhere(g, low, high, found);
    for (int x = from[0]; x <= to[0]; x++)
        for (int y = from[1]; y <= to[1]; y++)
            for (int z = from[2]; z <= to[2]; z++)
                count += find_in_cell(g, cell_at(x, y, z), low, high, found + count);
    return count;
}
