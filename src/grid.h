/* Points in the cells of a uniform grid, to be found again by box. Space is without bounds: cells
 * are kept by hash, and memory goes with the number of points alone. */
#ifndef WISPLAB_GRID_H
#define WISPLAB_GRID_H

struct grid;

/* NULL where memory cannot be had. */
struct grid *grid_create(void);
void grid_free(struct grid *grid);

/* Takes the place of what was there; `cell` is a cell's side, m. Returns 0, or -1 where memory
 * cannot be had. Memory is kept for the next time. */
int grid_fill(struct grid *grid, double cell, const double (*points)[3], int count);

/* Writes the numbers of all points in a box, borders included, each once, in no useful order;
 * `found` has room for one more than all points. Returns how many. */
int grid_find(const struct grid *grid, const double low[3], const double high[3], int *found);

#endif
