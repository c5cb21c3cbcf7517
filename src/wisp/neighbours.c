#include "neighbours.h"

#include "base/vector.h"
#include "grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct neighbours {
    struct grid *grid;   /* of centres */
    double (*centre)[3]; /* m */
    struct grid_found found;
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
    free(n->found.number);
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

/* Centres; the box around all; the sum of the boxes' sides, each its largest. Returns the largest
 * side of all, m. */
static double measure(struct neighbours *n, const double (*boxes)[6], int count, double box[6],
                      double *sum) {
    double largest = 0;
    *sum = 0;
    memcpy(box, boxes[0], sizeof *boxes);
    for (int i = 0; i < count; i++) {
        double side = 0;
        for (int k = 0; k < 3; k++) {
            const double length = boxes[i][3 + k] - boxes[i][k];
            n->centre[i][k] = boxes[i][k] + length / 2;
            side = length > side ? length : side;
            box[k] = fmin(box[k], boxes[i][k]);
            box[3 + k] = fmax(box[3 + k], boxes[i][3 + k]);
        }
        *sum += side;
        largest = side > largest ? side : largest;
    }
    return largest;
}

/* Looks for centres in the box, `around` wider on all sides: they are in a ball around it. */
static int meets_any(struct neighbours *n, const double (*boxes)[6], int i, double around) {
    struct grid_search search = {
        .axis = {0, 0, 1}, .side = {{0, 0, 1}, {0, 0, 1}}, .except = {i, i + 1}};
    double half[3];
    for (int k = 0; k < 3; k++) {
        search.low[k] = boxes[i][k] - around;
        search.high[k] = boxes[i][3 + k] + around;
        search.from[k] = n->centre[i][k];
        half[k] = (search.high[k] - search.low[k]) / 2;
    }
    search.reach = search.slack = vector_length(half);
    n->found.count = 0;
    if (grid_find(n->grid, &search, &n->found))
        return -1;
    for (int k = 0; k < n->found.count; k++)
        if (meet(boxes[i], boxes[n->found.number[k]]))
            return 1;
    return 0;
}

/* The centre of a box that meets another is no further from that than half the largest side. (One
 * that has flown apart would make all of them look far: then nobody looks.) */
int neighbours_find(struct neighbours *n, const double (*boxes)[6], int count,
                    unsigned char *near) {
    double sum, box[6];
    if (look_at_the_next(boxes, count, near) == 0)
        return 0;
    const double largest = measure(n, boxes, count, box, &sum);
    if (!(largest <= 8 * sum / count) || isinf(largest)) {
        memset(near, 1, (size_t)count);
        return 0;
    }
    struct grid_points points = {.x = n->centre[0], .stride = 3, .count = count, .cell = largest};
    memcpy(points.box, box, sizeof box);
    if (grid_fill(n->grid, &points, NULL))
        return -1;
    for (int i = 0; i < count; i++) {
        const int meets = near[i] ? 1 : meets_any(n, boxes, i, (1 + 1e-9) * largest / 2);
        if (meets < 0)
            return -1;
        near[i] = (unsigned char)meets;
    }
    return 0;
}
