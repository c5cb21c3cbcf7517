#include "neighbours.h"

#include "grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct neighbours {
    struct grid *grid;   /* of centres */
    double (*centre)[3]; /* m */
};

struct neighbours *neighbours_create(int most) {
    struct neighbours *n = calloc(1, sizeof *n);
    if (!n)
        return NULL;
    n->grid = grid_create();
    n->centre = malloc((size_t)most * sizeof *n->centre);
    if (n->grid && n->centre)
        return n;
    neighbours_free(n);
    return NULL;
}

void neighbours_free(struct neighbours *n) {
    if (!n)
        return;
    grid_free(n->grid);
    free(n->centre);
    free(n);
}

static int meet(const double a[6], const double b[6]) {
    int apart = 0;
    for (int k = 0; k < 3; k++)
        apart |= (a[3 + k] < b[k]) | (b[3 + k] < a[k]);
    return !apart;
}

/* Boxes that meet the next one; returns how many are not known to meet any. */
static int look_at_the_next(const double (*boxes)[6], int count, unsigned char *near) {
    int left = 0;
    for (int i = 0; i + 1 < count; i++)
        if (meet(boxes[i], boxes[i + 1]))
            near[i] = near[i + 1] = 1;
    for (int i = 0; i < count; i++)
        left += !near[i];
    return left;
}

/* Centres; the sum of the boxes' sides, each its largest. Returns the largest of all, m. */
static double measure(struct neighbours *n, const double (*boxes)[6], int count, double *sum) {
    double largest = 0;
    *sum = 0;
    for (int i = 0; i < count; i++) {
        double side = 0;
        for (int k = 0; k < 3; k++) {
            const double length = boxes[i][3 + k] - boxes[i][k];
            n->centre[i][k] = boxes[i][k] + length / 2;
            side = length > side ? length : side;
        }
        *sum += side;
        largest = side > largest ? side : largest;
    }
    return largest;
}

static int meets_any(const struct neighbours *n, const double (*boxes)[6], int i, double around) {
    const struct grid_slots slots = grid_slots(n->grid);
    struct grid_search search;
    int slot[GRID_BATCH];
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = boxes[i][k] - around;
        high[k] = boxes[i][3 + k] + around;
    }
    grid_begin(n->grid, low, high, (const int[]){i, i + 1}, &search);
    for (int found; (found = grid_next(n->grid, &search, slot)) > 0;)
        for (int k = 0; k < found; k++)
            if (meet(boxes[i], boxes[grid_point(&slots, slot[k])]))
                return 1;
    return 0;
}

/* The centre of a box that meets another is no further from that than half the largest side. (One
 * that has flown apart would make all of them look far: then nobody looks.) */
int neighbours_find(struct neighbours *n, const double (*boxes)[6], int count,
                    unsigned char *near) {
    double sum;
    if (look_at_the_next(boxes, count, near) == 0)
        return 0;
    const double largest = measure(n, boxes, count, &sum);
    if (!(largest <= 8 * sum / count) || isinf(largest)) {
        memset(near, 1, (size_t)count);
        return 0;
    }
    if (grid_fill(n->grid, largest, (const double(*)[3])n->centre, count, NULL))
        return -1;
    for (int i = 0; i < count; i++)
        if (!near[i])
            near[i] = (unsigned char)meets_any(n, boxes, i, (1 + 1e-9) * largest / 2);
    return 0;
}
