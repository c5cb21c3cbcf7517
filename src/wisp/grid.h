/* Points in the cells of a uniform grid, to be found again by box. Space is without bounds: cells
 * are kept by hash, and memory goes with the number of points alone. */
#ifndef WISPLAB_GRID_H
#define WISPLAB_GRID_H

struct grid;
enum { GRID_RUNS_MAX = 128, GRID_BATCH = 256 };

/* NULL where memory cannot be had. */
struct grid *grid_create(void);
void grid_free(struct grid *grid);

/* Takes the place of what was there; `cell` is a cell's side, m; workers share what can be shared
 * (NULL: nobody does). Returns 0, or -1 where memory cannot be had. Memory is kept for the next
 * time. */
struct workers;
int grid_fill(struct grid *grid, double cell, const double (*points)[3], int count,
              struct workers *workers);

/* Points as they stand in the grid, those of a cell side by side; until the grid is filled again.
 */
struct grid_slots {
    const double *x[3];   /* by axis and slot, m */
    const double *number; /* of the point, by slot */
};
static inline int grid_point(const struct grid_slots *slots, int slot) {
    return (int)slots->number[slot];
}
struct grid_slots grid_slots(const struct grid *grid);

/* A search for the points in a box, borders included, but for those numbered except[0] to before
 * except[1]. It has all that it needs in itself: threads may search at the same time. */
struct grid_search {
    double low[3], high[3];
    int except[2];
    int run, from; /* where it stands */
    struct grid_runs {
        int count;
        int from[GRID_RUNS_MAX], to[GRID_RUNS_MAX]; /* slots, ascending: to before */
    } runs;
};
void grid_begin(const struct grid *grid, const double low[3], const double high[3],
                const int except[2], struct grid_search *search);

/* Writes slots of points found, each once in all calls, in no useful order. Returns how many: 0
 * once there are no more. */
int grid_next(const struct grid *grid, struct grid_search *search, int found[GRID_BATCH]);

#endif
