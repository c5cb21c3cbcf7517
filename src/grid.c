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
    int cell[3];
    int point;
    double x[3];
};

struct grid {
    double cell; /* side, m */
    int count, room;
    unsigned mask;     /* number of hashes - 1; a power of two >= count, less 1 */
    int *start;        /* by hash: first of its slots; mask + 2 of them */
    unsigned *hash;    /* by point: of its cell */
    struct slot *slot; /* in the order of hashes, then of points */
};

struct grid *grid_create(void) {
    return calloc(1, sizeof(struct grid));
}

void grid_free(struct grid *grid) {
    if (!grid)
        return;
    free(grid->start);
    free(grid->hash);
    free(grid->slot);
    free(grid);
}

/* The cell of a coordinate. What is too far out for the number goes with the outermost cell; that
 * keeps the order of coordinates, so that a box still covers the cells of all that is in it. */
static int cell_of(double x, double side) {
    const double most = 1 << 30, cell = floor(x / side);
    return (int)(cell > most ? most : cell > -most ? cell : -most);
}

static unsigned hash_of(const int cell[3]) {
    uint32_t h = (uint32_t)cell[0] * 0x9e3779b1u ^ (uint32_t)cell[1] * 0x85ebca77u ^
                 (uint32_t)cell[2] * 0xc2b2ae3du; /* odd numbers with bits everywhere */
    h ^= h >> 15;
    return h * 0x2c1b3c6du ^ h >> 12;
}

static int make_room(struct grid *g, int count) {
    if (count <= g->room)
        return 0;
    size_t hashes = 16;
    while (hashes < (size_t)count)
        hashes *= 2;
    free(g->start);
    free(g->hash);
    free(g->slot);
    g->room = 0;
    g->start = malloc((hashes + 1) * sizeof *g->start);
    g->hash = malloc(hashes * sizeof *g->hash);
    g->slot = malloc(hashes * sizeof *g->slot);
    if (!g->start || !g->hash || !g->slot)
        return -1;
    g->room = (int)hashes;
    g->mask = (unsigned)hashes - 1;
    return 0;
}

int grid_fill(struct grid *g, double cell, const double (*points)[3], int count) {
    g->count = 0;
    if (make_room(g, count))
        return -1;
    g->cell = cell;
    g->count = count;
    memset(g->start, 0, (g->mask + 2) * sizeof *g->start);
    for (int i = 0; i < count; i++) {
        const int at[3] = {cell_of(points[i][0], cell), cell_of(points[i][1], cell),
                           cell_of(points[i][2], cell)};
        g->hash[i] = hash_of(at) & g->mask;
        g->start[g->hash[i]]++;
    }
    for (unsigned h = 1; h <= g->mask + 1; h++) /* now the end of each hash's slots */
        g->start[h] += g->start[h - 1];
    for (int i = count - 1; i >= 0; i--) { /* and with the last point put, their start */
        struct slot *slot = &g->slot[--g->start[g->hash[i]]];
        slot->point = i;
        for (int k = 0; k < 3; k++) {
            slot->x[k] = points[i][k];
            slot->cell[k] = cell_of(points[i][k], cell);
        }
    }
    return 0;
}

static int in_box(const struct slot *slot, const double low[3], const double high[3]) {
    int in = 1;
    for (int k = 0; k < 3; k++)
        in &= slot->x[k] >= low[k] && slot->x[k] <= high[k];
    return in;
}

static int find_in_cell(const struct grid *g, const int cell[3], const double low[3],
                        const double high[3], int *found) {
    const unsigned hash = hash_of(cell) & g->mask;
    int count = 0;
    for (int i = g->start[hash]; i < g->start[hash + 1]; i++)
        if (memcmp(g->slot[i].cell, cell, sizeof g->slot[i].cell) == 0 &&
            in_box(&g->slot[i], low, high))
            found[count++] = g->slot[i].point;
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
        from[k] = cell_of(low[k], g->cell);
        to[k] = cell_of(high[k], g->cell);
        cells *= (double)to[k] - from[k] + 1;
    }
    if (cells > g->count) /* of a box that large it is quicker to look at every point */
        return find_anywhere(g, low, high, found);
    for (int x = from[0]; x <= to[0]; x++)
        for (int y = from[1]; y <= to[1]; y++)
            for (int z = from[2]; z <= to[2]; z++)
                count += find_in_cell(g, (const int[3]){x, y, z}, low, high, found + count);
    return count;
}
