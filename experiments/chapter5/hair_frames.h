/* The frames of a run of wisps, read back: where nodes, envelopes and bodies are, and what may be
 * measured of them. Wisps may become more from frame to frame, by subdivision. SI units. */
#ifndef WISPLAB_HAIR_FRAMES_H
#define WISPLAB_HAIR_FRAMES_H

#include "model/scene.h"
#include "model/trajectory.h"

struct hair {
    const struct scene *scene;       /* lent */
    const struct trajectory *states; /* lent */
    enum wisp_treatment treatment;
    int frame_count; /* the states', as the frames are */
    const struct trajectory_frame *frames;

    struct strand **strands; /* of the frame laid open; owned, with the wisps they are of */
    struct wisp *wisps;
    struct interaction *interaction;
};

/* Returns 0, or -1 with one line in `reason` where the states do not fit the scene or memory cannot
 * be had. hair_close it in any case. */
int hair_open(struct hair *hair, const struct scene *scene, const struct trajectory *states,
              enum wisp_treatment treatment, char *reason);
void hair_close(struct hair *hair);

/* Lays the wisps of a frame open as strands[0], strands[1], ..., until the next call. */
void hair_lay_open(struct hair *hair, int frame);

/* Nodes of a wisp of a frame, and where one is: x y z vx vy vz. */
int hair_nodes(const struct hair *hair, int frame, int wisp);
const double *hair_node(const struct hair *hair, int frame, int wisp, int node);

/* The square of the distance of two points, m^2. */
double square_distance(const double *a, const double *b);

/* The wisp of the scene that this one is, or that it came from by subdivision. */
int hair_ancestor(const struct hair *hair, int wisp);

/* The frame nearest to a time, or -1 where the run ended more than half a frame before it. */
int hair_frame_at(const struct hair *hair, double t);

/* --- measures of one frame --- */

/* Angle between gravity and the line from the root (node 1) to the tip, rad: the mean over wisps
 * and the largest. */
struct inclination {
    double mean, largest;
};
struct inclination hair_inclination(const struct hair *hair, int frame);

/* How often a node or sample of one wisp is in a section of another one, or -1 where memory cannot
 * be had. Lays the frame open. */
int hair_overlap(struct hair *hair, int frame);

/* The largest |L / l - 1| of all stretch springs; l: length at rest. */
double hair_strain(const struct hair *hair, int frame);

/* How deep the hair is in bodies, m, along the normal; 0: it is outside. Lays the frame open. */
struct depth {
    double points;   /* of nodes and samples */
    double segments; /* of the straight lines between nodes */
};
struct depth hair_depth(struct hair *hair, int frame);

/* How far the tips have moved along a unit direction since the first frame, m: the mean. */
double hair_tips_along(const struct hair *hair, int frame, const double direction[3]);

/* The angle about the head's position and a unit axis that takes the tips of the first frame
 * nearest to where they are now, by least squares, rad, -pi to pi; and that of the head itself. */
double hair_turn(const struct hair *hair, int frame, const double axis[3]);
double hair_head_turn(const struct scene *scene, double t, const double axis[3]);

/* rms distance of the free nodes of two runs at a frame, m; NaN where they have not the same
 * wisps. */
double hair_distance(const struct hair *a, const struct hair *b, int frame);

/* Whether two runs have bit for bit the same state at a frame. */
int hair_same(const struct hair *a, const struct hair *b, int frame);

#endif
