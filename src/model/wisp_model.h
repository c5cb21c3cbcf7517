/* Inside the problem of wisps: what its files share. wisps.c is the problem, wisp_parts.c who sits
 * in which part, wisp_ticks.c what happens at a tick, but for subdivision, which is wisp_splits.c.
 */
#ifndef WISPLAB_WISP_MODEL_H
#define WISPLAB_WISP_MODEL_H

#include "kernel/kernel.h"
#include "model.h"
#include "scene.h"

/* Which wisps of the model a part holds, by lane; padding lanes repeat the first. */
struct batch {
    int wisp[LANES_MOST];
    int count;
    int trouble;                   /* the outcome of its projection at the last tick, or 0 */
    struct sparse_matrix *pattern; /* owned; of parts of one wisp */
};

struct wisp_model {
    struct model model;
    const struct scene *scene;
    struct wisp *wisps; /* the scene's, then those that subdivisions made */
    int wisp_count, wisp_room;
    int *parent; /* the model's */
    const struct kernel *kernel;
    enum wisp_treatment treatment;
    struct batch *batches;   /* one for each part */
    int *first_row;          /* by wisp: its first row of a frame */
    struct strand **strands; /* by wisp, where something happens to wisps; NULL-terminated */
    double *strand_rows;     /* by task: of the wisp with most nodes, without columns wisp, node */
    size_t strand_row_room;  /* numbers for a task */
    struct bodies *bodies;   /* as they are at a tick */
    struct interaction *interaction; /* NULL where wisps do not touch */
    struct strand **in_order;        /* those of all wisps as they touch; NULL likewise */
    struct neighbours *neighbours;   /* likewise */
    double (*boxes)[6];              /* by wisp: around it at a tick */
    unsigned char *near;             /* by wisp: whether it may touch at a tick */
    struct strand **touching;        /* those of in_order that may */
    int *place;                      /* by wisp that may: where it is in `touching` */
    const char **columns, **rate_columns;
    char name[64];
    double kinks[1 + 2 * KNOTS_MAX];
};

/* wisp_parts.c */

/* The problem's `lanes`. */
int wisps_lanes(const struct scene *scene);

/* The kernel for parts of 1, 4 or 8 lanes that fits this processor. All give the same bits. */
const struct kernel *kernel_of(int lanes);

/* Whether wisps of the scene may split. */
int wisps_split(const struct scene *scene);

/* Gives a wisp a lane that is free in a part of wisps with as many nodes, or else in a part that is
 * not there yet. Returns the part. */
int wisp_take_lane(struct wisp_model *m, int wisp);

/* Makes a part of the wisps in its lanes, as they start. 0, or -1 where memory cannot be had. */
int wisp_part_create(struct wisp_model *m, int part);

/* Gives a wisp its rows of a frame, after all others'. */
void wisp_take_rows(struct wisp_model *m, int wisp);

/* Puts rigid segments of a part's lanes, and of the padding that repeats them, back to their
 * length; of springs nothing is asked. Returns 0, or a positive enum outcome with the system's
 * reason. */
int wisp_part_project(struct wisp_model *m, int part, unsigned lanes);

/* Takes a wisp's strand back into its lane and the padding that repeats it, by way of `rows`. */
void wisp_close(const struct wisp_model *m, int part, int lane, double *rows);

/* wisp_ticks.c */

/* What ticks need: strands and what they touch with. 0, or -1 where memory cannot be had. */
int wisp_ticks_create(struct wisp_model *m);
void wisp_ticks_free(struct wisp_model *m);

/* The problem's `tick_part` and `tick`. */
unsigned wisps_tick_part(struct model *model, int i, double t);
enum outcome wisps_tick(struct model *model, struct workers *workers, unsigned events,
                        int *changed);

/* wisp_splits.c */

/* Subdivision at a tick, all strands being open: FINISHED, or OUT_OF_MEMORY. */
enum outcome wisp_splits_tick(struct wisp_model *m, int *changed);

/* wisp_extremes.c: the problem's `extremes`. */
int wisps_extremes(const struct model *model, const double *rows, struct extremes *extremes);

/* wisp_start.c */

/* Puts the model into the state from which its scene starts, where that is not rest. 0, or -1 where
 * memory cannot be had. */
int wisps_start(struct wisp_model *m);

#endif
