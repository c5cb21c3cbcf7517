#include "grid.h"

#include "base/vector.h"
#include "base/workers.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef __SSE__
#include <immintrin.h>
#endif

/* Points are sorted by the number of their cell, and cells that follow one another along z have
 * numbers that do: a box is a few runs of slots, one for each column of cells along z that it
 * touches. Cells are numbered column by column where the box around all points has few enough;
 * else, and outside of it, they share numbers. What is in a run and not in the box is told by its
 * coordinates alone, and runs that overlap are made one, so that nothing is found twice. A point is
 * in one cell: no mailbox is needed (the thesis puts sections into all cells that they touch).
 *
 * Slots have coordinates in single precision: twice as many are compared at a time, and who asks
 * looks again at what is found. */
struct grid {
    double per_metre[3]; /* cells */
    int first[3];        /* cell of the box */
    unsigned across[2];  /* from a column's numbers to those of the next along x, y */
    unsigned mask;       /* how many numbers there are, a power of two, less 1 */
    int count, room;     /* of points */
    int *start;          /* by number: first of its slots; mask + 2 of them */
    unsigned *cell;      /* by point: its number */
    float *x[3];         /* by slot, m; in the order of numbers, then of points */
    int *number;         /* of the point, by slot */
};

enum {
    CELLS = 1 << 30, /* along each axis */
    FLATNESS = 2     /* a cell's side over its height along z, where a run is cut to measure (4: no
                        better, 8: slower by a tenth where wisps hardly touch) */
};

/* As many slots as fit into a register. */
#if defined(__AVX512F__) && defined(__AVX512DQ__)
enum { TURN = 16 };
#elif defined(__AVX__)
enum { TURN = 8 };
#else
enum { TURN = 4 };
#endif
typedef float reals __attribute__((vector_size(4 * TURN)));
typedef int whole __attribute__((vector_size(4 * TURN)));

struct grid *grid_create(void) {
    return calloc(1, sizeof(struct grid));
}

static void release(struct grid *g) {
    free(g->start);
    free(g->cell);
    free(g->number);
    for (int k = 0; k < 3; k++)
        free(g->x[k]);
}

void grid_free(struct grid *grid) {
    if (grid)
        release(grid);
    free(grid);
}

/* The cell of a coordinate. What is too far out for the number goes with the outermost cell; that
 * keeps the order of coordinates, so that a box still covers the cells of all that is in it. */
static inline int cell_along(double x, double per_metre) {
    const double most = CELLS - 1, cell = x * per_metre + CELLS / 2;
    return (int)(cell > most ? most : cell > 0 ? cell : 0);
}

static inline unsigned column_number(const struct grid *g, int x, int y) {
    return (unsigned)(x - g->first[0]) * g->across[0] + (unsigned)(y - g->first[1]) * g->across[1];
}

/* So many numbers cells have at most: a power of two, twice as many as points or more. */
static size_t most_cells(size_t points) {
    size_t cells = 16;
    while (cells < 2 * points)
        cells *= 2;
    return cells;
}

/* Room for `count` points and for twice as many cells, contents lost. */
static int make_room(struct grid *g, int count) {
    if (count <= g->room)
        return 0;
    const size_t room = (size_t)count + (size_t)count / 2;
    release(g);
    *g = (struct grid){.start = malloc((most_cells(room) + 1) * sizeof *g->start),
                       .cell = malloc(room * sizeof *g->cell),
                       .number = calloc(room + TURN, sizeof *g->number)}; /* read in turns */
    int there = g->start && g->cell && g->number;
    for (int k = 0; k < 3; k++) {
        g->x[k] = calloc(room + TURN, sizeof *g->x[k]);
        there = there && g->x[k];
    }
    g->room = there ? (int)room : 0;
    return there ? 0 : -1;
}

/* Numbers the cells of the box column by column; where there are too many, or it is none, as an odd
 * multiple of each coordinate, by which columns side by side are far from each other. */
static void number_cells(struct grid *g, double cell, const double box[6], int count) {
    const size_t most = most_cells((size_t)count);
    double cells = 1, along[3];
    for (int k = 0; k < 3; k++) {
        g->per_metre[k] = (k < 2 ? 1 : FLATNESS) / cell;
        g->first[k] = cell_along(box[k], g->per_metre[k]);
        along[k] = cell_along(box[3 + k], g->per_metre[k]) - g->first[k] + 1.;
        cells *= along[k];
    }
    const int fits = cells >= 1 && cells <= (double)most;
    g->across[0] = fits ? (unsigned)(along[1] * along[2]) : 0x9e3779b1;
    g->across[1] = fits ? (unsigned)along[2] : 0x85ebca6b;
    size_t numbers = 16;
    while (numbers < (fits ? (size_t)cells : most))
        numbers *= 2;
    g->mask = (unsigned)numbers - 1;
}

/* Points to be put, by ranges of points or of cells. */
struct filling {
    struct grid *grid;
    const double *points;
    int stride; /* numbers from point to point */
    int ranges; /* of cells */
    int tasks;
    int *end; /* by range: how many points are in it and those before */
};
enum { TASKS = 32, TASK_LEAST = 500 }; /* fewer points are not worth a thread's while */

static int share_of(long long all, int index, int shares) {
    return (int)(all * index / shares);
}

static void find_cells(void *ctx, int index) {
    const struct filling *f = ctx;
    struct grid *g = f->grid;
    const int to = share_of(g->count, index + 1, f->tasks);
    for (int i = share_of(g->count, index, f->tasks); i < to; i++) {
        const double *x = f->points + (size_t)i * (size_t)f->stride;
        const unsigned column =
            column_number(g, cell_along(x[0], g->per_metre[0]), cell_along(x[1], g->per_metre[1]));
        const int z = cell_along(x[2], g->per_metre[2]) - g->first[2];
        g->cell[i] = (column + (unsigned)z) & g->mask;
    }
}

/* The cells of a range: from, and to before. */
static void cells_of(const struct filling *f, int index, unsigned *from, unsigned *to) {
    const long long cells = (long long)f->grid->mask + 1;
    *from = (unsigned)share_of(cells, index, f->ranges);
    *to = (unsigned)share_of(cells, index + 1, f->ranges);
}

/* How many points the cells of a range have, each with those before it. */
static void count_range(void *ctx, int index) {
    const struct filling *f = ctx;
    struct grid *g = f->grid;
    unsigned from, to;
    cells_of(f, index, &from, &to);
    int sum = 0;
    memset(g->start + from, 0, (to - from) * sizeof *g->start);
    for (int i = 0; i < g->count; i++)
        if (g->cell[i] - from < to - from)
            g->start[g->cell[i]]++;
    for (unsigned c = from; c < to; c++)
        g->start[c] = sum += g->start[c];
    f->end[index] = sum;
}

/* Each point before those of its cell that are there: with the last one, starts are starts. */
static void put_range(void *ctx, int index) {
    const struct filling *f = ctx;
    struct grid *g = f->grid;
    unsigned from, to;
    cells_of(f, index, &from, &to);
    const int before = index > 0 ? f->end[index - 1] : 0;
    for (unsigned c = from; c < to; c++)
        g->start[c] += before;
    for (int i = g->count - 1; i >= 0; i--) {
        if (g->cell[i] - from >= to - from)
            continue;
        const double *x = f->points + (size_t)i * (size_t)f->stride;
        const int slot = --g->start[g->cell[i]];
        g->number[slot] = i;
        for (int k = 0; k < 3; k++)
            g->x[k][slot] = (float)x[k];
    }
}

int grid_fill(struct grid *g, const struct grid_points *points, struct workers *workers) {
    int end[TASKS] = {0};
    const int count = points->count, tasks = 1 + count / TASK_LEAST;
    g->count = 0;
    if (make_room(g, count))
        return -1;
    number_cells(g, points->cell, points->box, count);
    g->count = count;
    struct filling filling = {.grid = g,
                              .points = points->x,
                              .stride = points->stride,
                              .tasks = tasks < TASKS ? tasks : TASKS,
                              .end = end};
    filling.ranges = workers_threads(workers);
    if (filling.ranges > filling.tasks)
        filling.ranges = filling.tasks;
    workers_run(workers, find_cells, &filling, filling.tasks);
    workers_run(workers, count_range, &filling, filling.ranges);
    for (int i = 1; i < filling.ranges; i++)
        end[i] += end[i - 1];
    g->start[g->mask + 1] = count;
    workers_run(workers, put_range, &filling, filling.ranges);
    return 0;
}

/* --- runs of slots --- */

enum { RUNS_MAX = 128 };

/* Slots of cells that a box touches: to before. */
struct runs {
    int count;
    int in_order; /* whether they ascend and do not overlap */
    int from[RUNS_MAX], to[RUNS_MAX];
};

static inline void add_run(struct runs *runs, int from, int to) {
    runs->from[runs->count] = from;
    runs->to[runs->count] = to;
    runs->in_order &= runs->count == 0 || from >= runs->to[runs->count - 1];
    runs->count += from < to;
}

/* The cells of one column, in the circle of numbers. */
static inline void add_column(const struct grid *g, int x, int y, const int z[2],
                              struct runs *runs) {
    const unsigned first = (column_number(g, x, y) + (unsigned)(z[0] - g->first[2])) & g->mask;
    const unsigned last = first + (unsigned)(z[1] - z[0]);
    add_run(runs, g->start[first], g->start[(last < g->mask ? last : g->mask) + 1]);
    if (last > g->mask) /* once around */
        add_run(runs, 0, g->start[last - g->mask]);
}

/* Sorts runs by where they begin, and cuts off what is in one before; there are few. */
static void part_runs(struct runs *runs) {
    int end = 0;
    for (int k = 1; k < runs->count; k++) {
        const int from = runs->from[k], to = runs->to[k];
        int i = k;
        for (; i > 0 && runs->from[i - 1] > from; i--) {
            runs->from[i] = runs->from[i - 1];
            runs->to[i] = runs->to[i - 1];
        }
        runs->from[i] = from;
        runs->to[i] = to;
    }
    for (int i = 0; i < runs->count; i++) {
        runs->from[i] = runs->from[i] > end ? runs->from[i] : end;
        end = runs->to[i] > end ? runs->to[i] : end;
    }
}

/* All cells that a box touches; or all points, where these are too many to ask one by one. */
static void gather_runs(const struct grid *g, const double low[3], const double high[3],
                        struct runs *runs) {
    int cell[3][2];
    runs->count = 0;
    runs->in_order = 1;
    for (int k = 0; k < 3; k++) {
        cell[k][0] = cell_along(low[k], g->per_metre[k]);
        cell[k][1] = cell_along(high[k], g->per_metre[k]);
    }
    const double columns =
        ((double)cell[0][1] - cell[0][0] + 1) * ((double)cell[1][1] - cell[1][0] + 1);
    if (2 * columns > RUNS_MAX || (unsigned)(cell[2][1] - cell[2][0]) >= g->mask) {
        add_run(runs, 0, g->count);
        return;
    }
    for (int x = cell[0][0]; x <= cell[0][1]; x++)
        for (int y = cell[1][0]; y <= cell[1][1]; y++)
            add_column(g, x, y, cell[2], runs);
    if (!runs->in_order)
        part_runs(runs);
}

/* --- points near a line --- */

/* A search in single precision: a turn of slots is compared with it at once. */
struct near_line {
    float from[3], axis[3], side[2][3];
    float square, least, most;
    int own[2];
};

/* Nothing that is asked for may be lost by rounding. With e = 2^-24 and all coordinates at most
 * `size`, a component of d is wrong by 3 e size, so that d.side is by less than 32 e size |side|,
 * and d.d - (d.axis)^2 by less than 80 e size |d|. */
static struct near_line near_line_of(const struct grid_search *s) {
    const double most = s->reach + s->length;
    const double size = most + fmax(fabs(s->from[0]), fmax(fabs(s->from[1]), fabs(s->from[2])));
    const double margin[2] = {1e-5 * size * vector_length(s->side[0]),
                              1e-5 * size * vector_length(s->side[1])};
    struct near_line line = {
        .square = (float)(s->reach * s->reach + 1e-5 * size * most),
        .least = (float)(-s->slack - margin[0]),
        .most = (float)(s->length + s->slack + margin[1]),
        .own = {s->except[0], s->except[1]},
    };
    for (int k = 0; k < 3; k++) {
        line.from[k] = (float)s->from[k];
        line.axis[k] = (float)s->axis[k];
        line.side[0][k] = (float)s->side[0][k];
        line.side[1][k] = (float)s->side[1][k];
    }
    return line;
}

/* Bit k for slot k of a turn. */
static inline unsigned bits_of(whole m) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    return _mm512_movepi32_mask((__m512i)m);
#elif defined(__AVX__)
    return (unsigned)_mm256_movemask_ps((__m256)m);
#elif defined(__SSE__)
    return (unsigned)_mm_movemask_ps((__m128)m);
#else
    unsigned bits = 0;
    for (int k = 0; k < TURN; k++)
        bits |= (unsigned)(m[k] != 0) << k;
    return bits;
#endif
}

static const int places[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

#if !(defined(__AVX512F__) && defined(__AVX512DQ__))
/* The set bits of a number below 16, ascending; what follows them does not count. */
typedef int four_slots __attribute__((vector_size(16)));
static const four_slots packed[16] = {{0},    {0},       {1},       {0, 1},      {2},    {0, 2},
                                      {1, 2}, {0, 1, 2}, {3},       {0, 3},      {1, 3}, {0, 1, 3},
                                      {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
#endif

static inline whole load_whole(const int *x) {
    whole y;
    memcpy(&y, x, sizeof y);
    return y;
}

static inline reals load_reals(const float *x) {
    reals y;
    memcpy(&y, x, sizeof y);
    return y;
}

/* d.a of the slots' d */
static inline reals dots(const reals d[3], const float a[3]) {
    return d[0] * a[0] + d[1] * a[1] + d[2] * a[2];
}

/* Which slots of a turn are near. What is no number is not far. */
static inline unsigned near_slots(const struct grid *g, const struct near_line *l, int slot) {
    const whole number = load_whole(g->number + slot);
    reals d[3];
    for (int k = 0; k < 3; k++)
        d[k] = load_reals(g->x[k] + slot) - l->from[k];
    const reals along = dots(d, l->axis);
    const reals square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - along * along;
    const whole far = (square > l->square) | (dots(d, l->side[0]) < l->least) |
                      (dots(d, l->side[1]) > l->most) |
                      ((number >= l->own[0]) & (number < l->own[1]));
    return ~bits_of(far) & ((1u << TURN) - 1);
}

/* Writes the slots from `slot` on whose bits are set: without a branch, which nobody could guess (a
 * loop over bits made searches where wisps touch 1.4 times as long). Returns how many; as many as a
 * turn has are written. */
static inline int keep(int slot, unsigned bits, int *found) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    const whole slots = load_whole(places) + slot;
    _mm512_storeu_si512(found, _mm512_maskz_compress_epi32((__mmask16)bits, (__m512i)slots));
    return __builtin_popcount(bits);
#else
    int count = 0;
    for (int k = 0; k < TURN; k += 4) { /* four at a time, and as many are kept as are set */
        const unsigned four = bits >> k & 15;
        const four_slots slots = packed[four] + (slot + k);
        memcpy(found + count, &slots, sizeof slots);
        count += __builtin_popcount(four);
    }
    return count;
#endif
}

/* Room for `more` numbers and a turn. */
static int make_found(struct grid_found *found, int more) {
    const size_t need = (size_t)found->count + (size_t)more + TURN;
    if (need <= (size_t)found->room)
        return 0;
    const size_t room = need + need / 2;
    int *grown = room > INT_MAX ? NULL : realloc(found->number, room * sizeof *grown);
    if (!grown)
        return -1;
    found->number = grown;
    found->room = (int)room;
    return 0;
}

/* A turn at a time; those behind the run are looked at for nothing. Returns how many are found. */
static inline int find_in_run(const struct grid *g, int from, int to, const struct near_line *line,
                              int *found) {
    int count = 0;
    for (int i = from; i < to; i += TURN) {
        const unsigned last = to - i < TURN ? (1u << (to - i)) - 1 : (1u << TURN) - 1;
        count += keep(i, near_slots(g, line, i) & last, found + count);
    }
    return count;
}

/* Insertion at shrinking distances (Shell; Knuth's), for qsort may allocate. */
static void sort_many(int *number, int count) {
    int gap = 1;
    while (gap < count / 3)
        gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3) {
        for (int i = gap; i < count; i++) {
            const int moving = number[i];
            int to = i;
            for (; to >= gap && number[to - gap] > moving; to -= gap)
                number[to] = number[to - gap];
            number[to] = moving;
        }
    }
}

/* No more than a turn has: each goes behind all that are less, which are counted without a branch.
 */
static void sort_few(int *number, int count) {
    int few[TURN];
    const whole there = load_whole(places) < count;
    const whole all = (load_whole(number) & there) | (~there & INT_MAX);
    memcpy(few, &all, sizeof few);
    for (int i = 0; i < count; i++)
        number[__builtin_popcount(bits_of(all < few[i]))] = few[i];
}

int grid_find(const struct grid *g, const struct grid_search *search, struct grid_found *found) {
    const struct near_line line = near_line_of(search);
    struct runs runs;
    int slots = 0, count = 0;
    gather_runs(g, search->low, search->high, &runs);
    for (int i = 0; i < runs.count; i++)
        slots += runs.to[i] > runs.from[i] ? runs.to[i] - runs.from[i] : 0;
    if (make_found(found, slots))
        return -1;
    int *number = found->number + found->count;
    for (int i = 0; i < runs.count; i++)
        count += find_in_run(g, runs.from[i], runs.to[i], &line, number + count);
    for (int i = 0; i < count; i++)
        number[i] = g->number[number[i]];
    if (count > TURN)
        sort_many(number, count);
    else
        sort_few(number, count);
    found->count += count;
    return 0;
}
