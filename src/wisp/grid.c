#include "grid.h"

#define LANES 4
#include "base/lanes.h"
#include "base/workers.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Points are sorted by the hash of their cell, and cells that follow one another along z do so in
 * memory: a box is a few runs of slots, one for each column of cells along z that it touches.
 * Columns with hashes nearby share runs; what is in a run and not in the box is told by its
 * coordinates alone, and runs that overlap are made one, so that nothing is found twice. A point is
 * in one cell: no mailbox is needed (the thesis puts sections into all cells that they touch). */
struct grid {
    double per_metre[3]; /* cells */
    int count, room;
    unsigned mask;  /* number of hashes - 1; a power of two >= count, less 1 */
    int *start;     /* by hash: first of its slots; mask + 2 of them */
    unsigned *hash; /* by point */
    double *x[4];   /* by slot: coordinates and, to be compared with them, the point's number; in
                       the order of hashes, then of points */
};

enum {
    CELLS = 1 << 21, /* along each axis; two such numbers in one of 64 bits */
    FLATNESS = 2     /* a cell's side over its height along z, where a run is cut to measure (4: no
                        better, 8: slower by a tenth where wisps hardly touch) */
};

struct grid *grid_create(void) {
    return calloc(1, sizeof(struct grid));
}

static void release(struct grid *g) {
    free(g->start);
    free(g->hash);
    for (int k = 0; k < 4; k++)
        free(g->x[k]);
}

void grid_free(struct grid *grid) {
    if (grid)
        release(grid);
    free(grid);
}

struct grid_slots grid_slots(const struct grid *g) {
    return (struct grid_slots){{g->x[0], g->x[1], g->x[2]}, g->x[3]};
}

/* The cell of a coordinate. What is too far out for the number goes with the outermost cell; that
 * keeps the order of coordinates, so that a box still covers the cells of all that is in it. */
static int cell_along(double x, double per_metre) {
    const double most = CELLS - 1, cell = floor(x * per_metre) + CELLS / 2;
    return (int)(cell > most ? most : cell > 0 ? cell : 0);
}

/* Where a column's hashes begin, by Fibonacci hashing; those of its cells follow, in a circle. */
static unsigned hash_of_column(int x, int y) {
    const uint64_t column = (uint64_t)x * CELLS + (uint64_t)y;
    return (unsigned)(column * 0x9e3779b97f4a7c15u >> 32);
}

/* Room for `count` points, contents lost. */
static int make_room(struct grid *g, int count) {
    if (count <= g->room)
        return 0;
    size_t hashes = 16;
    while (hashes < (size_t)count)
        hashes *= 2;
    release(g);
    *g = (struct grid){.mask = (unsigned)hashes - 1,
                       .start = malloc((hashes + 1) * sizeof *g->start),
                       .hash = malloc(hashes * sizeof *g->hash)};
    int there = g->start && g->hash;
    for (int k = 0; k < 4; k++) {
        g->x[k] = calloc(hashes + LANES, sizeof(double)); /* read in fours */
        there = there && g->x[k];
    }
    g->room = there ? (int)hashes : 0;
    return there ? 0 : -1;
}

/* Points to be put, and in how many tasks their cells are looked for. */
struct filling {
    struct grid *grid;
    const double (*points)[3];
    int tasks;
};
enum { TASKS = 32, TASK_LEAST = 500 }; /* fewer points are not worth a thread's while */

static void hash_points(void *ctx, int index) {
    const struct filling *filling = ctx;
    struct grid *g = filling->grid;
    const int from = (int)((long long)g->count * index / filling->tasks),
              to = (int)((long long)g->count * (index + 1) / filling->tasks);
    for (int i = from; i < to; i++) {
        const double *x = filling->points[i];
        const int column[2] = {cell_along(x[0], g->per_metre[0]),
                               cell_along(x[1], g->per_metre[1])};
        g->hash[i] =
            (hash_of_column(column[0], column[1]) + (unsigned)cell_along(x[2], g->per_metre[2])) &
            g->mask;
    }
}

int grid_fill(struct grid *g, double cell, const double (*points)[3], int count,
              struct workers *workers) {
    g->count = 0;
    if (make_room(g, count))
        return -1;
    g->per_metre[0] = g->per_metre[1] = 1 / cell;
    g->per_metre[2] = FLATNESS / cell;
    g->count = count;
    struct filling filling = {g, points,
                              count < TASKS * TASK_LEAST ? 1 + count / TASK_LEAST : TASKS};
    workers_run(workers, hash_points, &filling, filling.tasks);
    memset(g->start, 0, (g->mask + 2) * sizeof *g->start);
    for (int i = 0; i < count; i++)
        g->start[g->hash[i]]++;
    for (unsigned h = 1; h <= g->mask + 1; h++) /* now the end of each hash's slots */
        g->start[h] += g->start[h - 1];
    for (int i = count - 1; i >= 0; i--) { /* and with the last point put, their start */
        const int slot = --g->start[g->hash[i]];
        g->x[3][slot] = i;
        for (int k = 0; k < 3; k++)
            g->x[k][slot] = points[i][k];
    }
    return 0;
}

/* --- runs of slots --- */

/* Keeps runs sorted by where they begin; there are few. */
static void add_run(struct grid_runs *runs, int from, int to) {
    if (from == to)
        return;
    int i = runs->count++;
    for (; i > 0 && runs->from[i - 1] > from; i--) {
        runs->from[i] = runs->from[i - 1];
        runs->to[i] = runs->to[i - 1];
    }
    runs->from[i] = from;
    runs->to[i] = to;
}

/* The cells of one column, in the circle of hashes. */
static void add_column(const struct grid *g, int x, int y, const int z[2], struct grid_runs *runs) {
    const unsigned first = (hash_of_column(x, y) + (unsigned)z[0]) & g->mask;
    const unsigned last = first + (unsigned)(z[1] - z[0]);
    add_run(runs, g->start[first], g->start[(last < g->mask ? last : g->mask) + 1]);
    if (last > g->mask) /* once around */
        add_run(runs, 0, g->start[last - g->mask]);
}

/* All cells that a box touches; or all points, where these are too many to ask one by one. */
static void gather_runs(const struct grid *g, const double low[3], const double high[3],
                        struct grid_runs *runs) {
    int cell[3][2];
    runs->count = 0;
    for (int k = 0; k < 3; k++) {
        cell[k][0] = cell_along(low[k], g->per_metre[k]);
        cell[k][1] = cell_along(high[k], g->per_metre[k]);
    }
    const double columns =
        ((double)cell[0][1] - cell[0][0] + 1) * ((double)cell[1][1] - cell[1][0] + 1);
    if (2 * columns > GRID_RUNS_MAX || (unsigned)(cell[2][1] - cell[2][0]) >= g->mask) {
        add_run(runs, 0, g->count);
        return;
    }
    for (int x = cell[0][0]; x <= cell[0][1]; x++)
        for (int y = cell[1][0]; y <= cell[1][1]; y++)
            add_column(g, x, y, cell[2], runs);
}

/* --- points in a box --- */

enum { BLOCK = 64 }; /* slots that are looked at between looks at the room in `found` */

/* The set bits of a number below 16, ascending; what follows them does not count. Slots are written
 * four at a time and as many are kept as were hit: a loop over bits is a branch that nobody can
 * guess (it made searches where wisps touch 1.4 times as long). */
typedef int four_slots __attribute__((vector_size(16)));
static const four_slots packed[1 << LANES] = {
    {0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
    {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};

/* Four slots at a time; those behind the run are looked at for nothing. */
static int find_in_run(const struct grid *g, int from, int to, const struct grid_search *s,
                       int *found) {
    const lane x0 = lane_all(s->low[0]), y0 = lane_all(s->low[1]), z0 = lane_all(s->low[2]);
    const lane x1 = lane_all(s->high[0]), y1 = lane_all(s->high[1]), z1 = lane_all(s->high[2]);
    const lane own = lane_all(s->except[0]), behind = lane_all(s->except[1]);
    int hits = 0;
    for (int i = from; i < to; i += LANES) {
        const lane x = load(g->x[0] + i, 0), y = load(g->x[1] + i, 0), z = load(g->x[2] + i, 0);
        const lane number = load(g->x[3] + i, 0);
        const mask in = (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1) & (z >= z0) & (z <= z1) &
                        ((number < own) | (number >= behind));
        const unsigned last = to - i < LANES ? (1u << (to - i)) - 1 : (1u << LANES) - 1;
        const unsigned bits = mask_bits(in) & last;
        const four_slots slots = packed[bits] + i;
        memcpy(found + hits, &slots, sizeof slots);
        hits += __builtin_popcount(bits);
    }
    return hits;
}

void grid_begin(const struct grid *g, const double low[3], const double high[3],
                const int except[2], struct grid_search *s) {
    memcpy(s->low, low, sizeof s->low);
    memcpy(s->high, high, sizeof s->high);
    memcpy(s->except, except, sizeof s->except);
    s->run = s->from = 0;
    gather_runs(g, low, high, &s->runs);
}

int grid_next(const struct grid *g, struct grid_search *s, int found[GRID_BATCH]) {
    int count = 0;
    while (s->run < s->runs.count && count <= GRID_BATCH - BLOCK - LANES) {
        const int to = s->runs.to[s->run];
        if (s->from < s->runs.from[s->run]) /* further on in a run that overlaps the last */
            s->from = s->runs.from[s->run];
        if (s->from >= to) {
            s->run++;
            continue;
        }
        const int block = to - s->from < BLOCK ? to - s->from : BLOCK;
        count += find_in_run(g, s->from, s->from + block, s, found + count);
        s->from += block;
    }
    return count;
}
