/* What the tests of the wisp model share: random wisps and states, parts of the kernel, scenes from
 * numbers, and runs in this process with all their frames. */
#ifndef WISPLAB_TESTS_WISP_SUPPORT_H
#define WISPLAB_TESTS_WISP_SUPPORT_H

#include "experiments/bench/wisp_twin.h"
#include "kernel/kernel.h"
#include "model/trajectory.h"
#include "model/wisp_model.h"
#include "support.h"

enum { TREATMENTS = 3, LAWS = 3, WINDS = 4, LAB_LANES = LANES_MOST, LAB_NODES = 40 };
enum { LAB_SIZE = (LAB_NODES - 2) * (3 + 3 * SAMPLES_MAX) }; /* unknowns of one wisp at most */

extern const char *const treatment_names[TREATMENTS];
extern const char *const law_names[LAWS];

/* --- random numbers, reproducible --- */

double lab_between(unsigned *seed, double least, double most);

/* Turns a direction by up to about 2 `turn`. */
void lab_turn(double along[3], double turn, unsigned *seed);

/* A wisp with every number within a factor of about two of the defaults, in any direction. */
struct wisp lab_wisp(int nodes, int samples, enum bending law, unsigned *seed);

/* Gravity in any direction and wind of a kind; forces change in time for 0 < t < 1. */
struct surroundings lab_surroundings(enum wind_kind kind, unsigned *seed);

/* States, by what is hard in them: nothing; lengths and angles at random; all segments shorter
 * than at rest; a random walk that turns back on itself, with angles up to 3 rad. */
enum lab_state { STATE_REST, STATE_RANDOM, STATE_COMPRESSED, STATE_FOLDED, STATES };

/* q and v in the order of the twin, positions in space. With `still`, v = 0. */
void lab_state(const struct wisp *wisp, enum wisp_treatment treatment, enum lab_state kind,
               int still, unsigned *seed, double *q, double *v);

/* --- a part of the kernel --- */

/* The number of lanes after these: 1, 4, 8. */
int lab_wider(int lanes);

/* Runs of this test have parts of so many lanes, where method and solver can. */
void lab_take_lanes(int lanes);

struct lab_part {
    int lanes, size; /* size: of one wisp */
    struct system system;
    struct sparse_matrix *pattern; /* of one lane */
    int node_unknowns, places;     /* of a node; how many of those, first ones, are coordinates */
    double origin[LAB_LANES][3];   /* from which they are, in space */
};

/* `count` wisps, 1 to `lanes`; the last lanes repeat the first wisp. Stops the test where memory
 * cannot be had. */
void lab_part_make(struct lab_part *part, int lanes, const struct wisp *wisps, int count,
                   const struct surroundings *around, enum wisp_treatment treatment);

/* One wisp's vector into or out of a lane: rates, or unknowns, whose places are from the origin. */
void lab_scatter(const struct lab_part *part, int lane, const double *x, double *to);
void lab_gather(const struct lab_part *part, int lane, const double *from, double *x);

/* One wisp's q, whose places are in space, into a lane. */
void lab_place(const struct lab_part *part, int lane, const double *q, double *to);

/* Stops the test where accelerations are not the scalar twin's to rounding; keeps the largest ratio
 * to the tolerance. */
void lab_check_with_twin(const struct wisp *wisp, const struct surroundings *around,
                         enum wisp_treatment treatment, double t, const double *q, const double *v,
                         const double *a, double *worst);

/* Stops the test where the accelerations of a part of these `lanes` wisps, each in another kind of
 * state, are not their twins'. */
void lab_check_with_twins(int lanes, struct wisp *wisps, const struct surroundings *around,
                          enum wisp_treatment treatment, double t, unsigned *seed, double *worst);

/* Whoever is beside it, a wisp has the bits that it has alone: so many wisps at rest as a part, and
 * each as a part of its own, go through `step`, with its place among them, or -1 for all. */
struct lab_company {
    struct counters together, alone; /* alone: their sum */
};
struct lab_company lab_company(int lanes, enum bending law, enum wisp_treatment treatment,
                               const struct surroundings *around, unsigned *seed,
                               void (*step)(struct lab_part *part, int place, double *q, double *v,
                                            void *ctx),
                               void *ctx);

/* What gravity takes to lift a wisp's free nodes and samples from the root to 0, J. */
double lab_root_potential(const struct wisp *wisp, const struct surroundings *around);

/* --- scenes and runs --- */

/* A scene of these wisps. Runs need duration and frame_rate set by the caller. */
struct scene *lab_scene(const struct wisp *wisps, int count, const struct surroundings *around);

/* A model of a scene, of parts of so many lanes. */
struct model *lab_model(const struct scene *scene, int treatment, int lanes);

struct strand *lab_strand(const struct wisp *wisp, enum wisp_treatment treatment);

/* The scene of a file with this text; stops the test where it cannot be read. */
struct scene *lab_read(const char *text);

/* Five wisps of a scene file that meet where gravity pulls them. */
#define WISP_A "{ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.1]; length = 0.2; nodes = 8; }"
#define WISP_B \
    "{ root = [0.0, 0.02, 0.02]; direction = [1.0, 0.1, -0.2]; length = 0.2; nodes = 8; }"
#define WISP_C \
    "{ root = [0.01, -0.02, 0.0]; direction = [1.0, 0.4, 0.2]; length = 0.15; nodes = 6; }"
#define WISP_D \
    "{ root = [0.1, 0.03, -0.1]; direction = [0.0, -0.1, 1.0]; length = 0.2; nodes = 8; }"
#define WISP_E "{ root = [0.2, 0.0, 0.1]; direction = [-0.3, 0.0, -1.0]; length = 0.2; nodes = 8; }"

/* A run with all its frames. */
struct lab_run {
    struct run_result result;
    int frames, rows, columns;
    double *t, *row; /* by frame; by frame, row, column */
};

/* With what every method runs in every treatment: implicit ones solve directly. */
struct run_request lab_request(const struct stepper_method *method, int treatment);

/* Runs; stops the test where the request is refused. */
void lab_run(const struct scene *scene, const struct run_request *request, struct lab_run *run);

/* The same, and the run must finish. */
void lab_finish(const struct scene *scene, const struct run_request *request, struct lab_run *run);

/* A finished run by a sum of all bits of all frames; where `lanes` is not 0, one of parts of that
 * width. */
struct lab_sum {
    struct run_result result;
    unsigned long long bits;
};
void lab_sum_run(const struct scene *scene, const struct run_request *request, int lanes,
                 struct lab_sum *sum);

/* Stops the test where they have other bits or counts. */
void lab_same_sum(const struct lab_sum *a, const struct lab_sum *b, const char *what);

/* `rows` rows of `columns` numbers as a trajectory, for trajectory_free: t, wisp, node and so on,
 * from the tenth column on r0 rd0 ... It takes `value` over. No wisp has a parent. */
void lab_trajectory(struct trajectory *trajectory, double *value, int rows, int columns);

/* rms and largest distance of the nodes of two runs, from frame `from` on; of nodes >= `first`. */
struct lab_distance {
    double rms, largest;
};
struct lab_distance lab_distance(const struct lab_run *a, const struct lab_run *b, int from,
                                 int first);

/* rms distance of a run, which must finish, from `exact`: of free nodes, without the first frame.
 */
double lab_error(const struct scene *scene, const struct run_request *request,
                 const struct lab_run *exact);

/* The largest distance of a run of `reference` from its cross-check's. */
double lab_cross_check(const struct scene *scene, int treatment, const struct lab_run *reference);

/* Stops the test unless errors whose steps halve twice show an order from order - less to order +
 * more. */
void lab_check_order(const char *what, const double error[3], double order, double less,
                     double more);

/* |a - b| <= tolerance * scale, stops the test otherwise, NaN too; keeps the largest ratio. */
int lab_close(double a, double b, double limit, double *worst);

#endif
