/* Inside the problem of wisps: what its files share. wisps.c makes parts and frames, and
 * wisp_ticks.c is what happens to them at a tick. */
#ifndef WISPLAB_WISP_MODEL_H
#define WISPLAB_WISP_MODEL_H

#include "model.h"
#include "scene.h"

enum { LANES_MAX = 4 };

/* The kernel for a number of lanes. */
struct obstacle;
struct kernel {
    int lanes;
    void *(*create)(const struct wisp *const *, const struct surroundings *, enum wisp_treatment,
                    struct system *);
    void (*free)(void *);
    void (*rest)(void *, double *, double *);
    void (*prescribe)(void *, double);
    void (*sample)(void *, int, const double *, const double *, double *, int);
    void (*sample_accelerations)(void *, int, const double *, double *, int);
    void (*restore)(void *, int, const double *, int, double *, double *);
    int (*clamp)(void *, double *, double *);
    unsigned (*near)(void *, const double *, const double *, const double *, int, int *);
    unsigned (*pull)(void *, double *, double *, const struct obstacle *, const double *, int,
                     unsigned, int *);
    double (*strain)(void *, int, const double *);
    const struct system_ops *ops;
};

/* Which wisps of the scene a part holds, by lane; padding lanes repeat the first. */
struct batch {
    int wisp[LANES_MAX];
    int count;
    struct sparse_matrix *pattern; /* owned; of parts of one wisp */
};

struct wisp_model {
    struct model model;
    const struct scene *scene;
    const struct kernel *kernel;
    enum wisp_treatment treatment;
    struct batch *batches;   /* one for each part */
    int *first_row;          /* by wisp: its first row of a frame */
    struct strand **strands; /* by wisp, where the scene has contacts; NULL-terminated */
    double *strand_rows;     /* by task: of the wisp with most nodes, without columns wisp, node */
    size_t strand_row_room;  /* numbers for a task */
    struct touch *touch;     /* NULL where wisps do not interact */
    char **columns, **rate_columns;
    char name[64];
    double kinks[1 + 2 * KNOTS_MAX];
};

/* What contacts need: strands and what they touch with. 0, or -1 where memory cannot be had. */
int wisp_ticks_create(struct wisp_model *m);
void wisp_ticks_free(struct wisp_model *m);

/* The problem's `tick`. */
enum outcome wisps_tick(struct model *model, struct workers *workers, unsigned events,
                        int *changed);

#endif
