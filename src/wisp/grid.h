/* Points in the cells of a uniform grid, to be found again near a line. Space is without bounds:
 * cells are kept by hash, and memory goes with the number of points alone. */
#ifndef WISPLAB_GRID_H
#define WISPLAB_GRID_H

struct grid;

/* NULL where memory cannot be had. */
struct grid *grid_create(void);
void grid_free(struct grid *grid);

struct grid_points {
    const double *x; /* of each point three numbers, m, */
    int stride;      /* so many numbers from point to point */
    int count;
    double cell;   /* a cell's side, m */
    double box[6]; /* least x y z, most x y z of where it is searched, for speed alone */
};

/* Takes the place of what was there; workers share what can be shared (NULL: nobody does). Returns
 * 0, or -1 where memory cannot be had. Memory is kept for the next time. */
struct workers;
int grid_fill(struct grid *grid, const struct grid_points *points, struct workers *workers);

/* What is asked for: the points d from `from` that are no further than `reach` from the line along
 * `axis` (a unit vector) and between two planes, d.side[0] >= -slack and d.side[1] <= length +
 * slack, and in the box from `low` to `high`; but for those numbered except[0] to before except[1].
 * All m. */
struct grid_search {
    double from[3], axis[3], side[2][3];
    double reach, length, slack;
    double low[3], high[3];
    int except[2];
};

/* Numbers of points; memory that only grows, to be freed by who has it. */
struct grid_found {
    int *number;
    int count, room;
};

/* Appends the numbers of all such points, each once and ascending, and of some more that are very
 * nearly so or as near to the box as a cell is wide. For different `found` from different threads.
 * Returns 0, or -1 where memory cannot be had. */
int grid_find(const struct grid *grid, const struct grid_search *search, struct grid_found *found);

#endif
