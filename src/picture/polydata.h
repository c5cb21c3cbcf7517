/* One file of VTK's PolyData: points with lines or polygons, and data at both, as XML whose numbers
 * are binary (appended raw, little-endian). */
#ifndef WISPLAB_POLYDATA_H
#define WISPLAB_POLYDATA_H

#include <stddef.h>

enum polydata_kind { POLYDATA_LINES, POLYDATA_POLYGONS };

/* Doubles at points, or whole numbers of cells; what is added to it grows it. */
struct polydata_array {
    const char *name;
    int components;
    int is_whole;
    double *value;
    size_t count, room; /* of values */
};

enum { POLYDATA_ARRAYS = 4 };

struct polydata {
    enum polydata_kind kind;
    double time;                                      /* s */
    struct polydata_array points;                     /* three components */
    struct polydata_array at_points[POLYDATA_ARRAYS]; /* those with a name */
    struct polydata_array at_cells[POLYDATA_ARRAYS];
    struct polydata_array corners; /* numbers of points, cell after cell */
    struct polydata_array ends;    /* of each cell: how many corners there are up to its end */
};

/* None of both is without a name of its own. */
void polydata_begin(struct polydata *data, enum polydata_kind kind, double time);
void polydata_free(struct polydata *data);

/* Arrays that are to be filled, one value (of all components) for each point or cell. */
struct polydata_array *polydata_at_points(struct polydata *data, const char *name, int components);
struct polydata_array *polydata_at_cells(struct polydata *data, const char *name);

void polydata_add(struct polydata_array *array, const double *value);
void polydata_add_whole(struct polydata_array *array, int value);

/* The number of the next point. */
int polydata_points(const struct polydata *data);

/* A corner of the cell at hand, and its end. */
void polydata_corner(struct polydata *data, int point);
void polydata_end_cell(struct polydata *data);

/* Writes it whole or not at all. Returns 0 or the exit code, with one line in `reason`. */
int polydata_write(const struct polydata *data, const char *path, char *reason);

#endif
