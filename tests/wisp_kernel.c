/* The kernel against the scalar twin of the model, and its bits against its own: a wisp's numbers
 * depend neither on its lane, nor on its neighbours, nor on the order of the scene. */
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int sample_counts[] = {0, 3, 4, 5, 8, 16};
enum { SAMPLE_COUNTS = sizeof sample_counts / sizeof *sample_counts };

static void check_part(int lanes, int nodes, int samples, enum bending law,
                       enum wisp_treatment treatment, unsigned *seed, double *worst) {
    const enum wind_kind kind = (enum wind_kind)((nodes + samples + (int)law) % WINDS);
    const struct surroundings around = lab_surroundings(kind, seed);
    const double t = lab_between(seed, 0, 1);
    struct wisp wisps[LAB_LANES];
    for (int k = 0; k < lanes; k++)
        wisps[k] = lab_wisp(nodes, samples, law, seed);
    lab_check_with_twins(lanes, wisps, &around, treatment, t, seed, worst);
}

Test(wisp_kernel, accelerations_are_the_twins) {
    double worst = 0;
    unsigned seed = 1;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int s = 0; s < SAMPLE_COUNTS; s++)
                for (int nodes = 3; nodes <= LAB_NODES; nodes++)
                    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
                        check_part(lanes, nodes, sample_counts[s], (enum bending)law,
                                   (enum wisp_treatment)treatment, &seed, &worst);
    cr_log_info("largest difference: %.2g of the tolerance", worst);
}

/* --- models of several wisps --- */

enum { WISPS_MOST = 9 };

/* A scene's wisps, each with its own state; `order` says where each stands in the scene. */
struct flock {
    int count;
    enum wisp_treatment treatment;
    struct surroundings around;
    struct wisp wisps[WISPS_MOST];
    double q[WISPS_MOST][LAB_SIZE], v[WISPS_MOST][LAB_SIZE];
};

static void make_flock(struct flock *flock, int count, int samples, enum bending law,
                       enum wisp_treatment treatment, unsigned *seed) {
    flock->count = count;
    flock->treatment = treatment;
    flock->around = lab_surroundings(WIND_IRREGULAR, seed);
    for (int i = 0; i < count; i++) {
        const int nodes = (int)lab_between(seed, 4, 6.999);
        flock->wisps[i] = lab_wisp(nodes, samples, law, seed);
        lab_state(&flock->wisps[i], treatment, STATE_RANDOM, 0, seed, flock->q[i], flock->v[i]);
    }
}

/* Columns of a row in which unknown u and its rate are. */
static int column_of(const struct flock *flock, int u, int *gap) {
    const int penalty = flock->treatment == WISP_PENALTY;
    *gap = u < 3 || penalty ? 3 : 1;
    return u < 3 ? 2 + u : penalty ? 8 + 6 * ((u - 3) / 3) + (u - 3) % 3 : 8 + 2 * (u - 3);
}

/* A wisp's free unknowns into the rows of a frame (to_rows) or out of them. */
static void copy_rows(const struct flock *flock, int wisp, int columns, double *row, double *q,
                      double *v, int to_rows) {
    const struct wisp *w = &flock->wisps[wisp];
    const int unknowns = wisp_node_unknowns(w, flock->treatment);
    for (int i = 2; i < w->nodes; i++)
        for (int u = 0; u < unknowns; u++) {
            int gap;
            double *at = row + i * columns + column_of(flock, u, &gap);
            double *x = &q[(i - 2) * unknowns + u], *y = &v[(i - 2) * unknowns + u];
            *(to_rows ? at : x) = *(to_rows ? x : at);
            *(to_rows ? at + gap : y) = *(to_rows ? y : at + gap);
        }
}

typedef void use_part(struct part *part, double *result);

/* Makes the flock's model in this order, sets its states, calls `use` for each part, and gathers
 * what it left in `result` by wisp of the flock. Checks that the model says of itself what it is.
 */
static void with_model(const struct flock *flock, int lanes, const int *order, use_part *use,
                       double (*result)[LAB_SIZE]) {
    const void *const mark = test_mark();
    struct wisp wisps[WISPS_MOST];
    for (int i = 0; i < flock->count; i++)
        wisps[i] = flock->wisps[order[i]];
    struct scene *scene = lab_scene(wisps, flock->count, &flock->around);
    struct model *model = lab_model(scene, flock->treatment, lanes);
    const int columns = model->column_count;
    double *rows = test_room((size_t)(model->row_count * columns) * sizeof *rows), *row = rows;
    struct flock *states = test_room(sizeof *states);
    *states = *flock;
    wisp_problem.sample(model, rows);
    for (int i = 0; i < flock->count; row += flock->wisps[order[i++]].nodes * columns) {
        cr_assert_eq((int)row[0], i, "row of wisp %d says %g", i, row[0]);
        copy_rows(states, order[i], columns, row, states->q[order[i]], states->v[order[i]], 1);
    }
    wisp_problem.restore(model, rows);
    int wisps_in_parts = 0;
    for (int i = 0; i < model->part_count; i++) {
        struct part *part = &model->parts[i];
        double *x = test_room((size_t)part->system.size * sizeof *x);
        cr_assert_eq(part->system.lanes, lanes, "a part of %d lanes", part->system.lanes);
        wisps_in_parts += part->system.wisps;
        use(part, x);
        memcpy(part->v, x, (size_t)part->system.size * sizeof *x);
    }
    cr_assert_eq(wisps_in_parts, flock->count, "%d wisps in parts", wisps_in_parts);
    wisp_problem.sample(model, rows);
    row = rows;
    for (int i = 0; i < flock->count; row += flock->wisps[order[i++]].nodes * columns)
        copy_rows(flock, order[i], columns, row, states->q[0], result[order[i]], 0);
    test_gives_back(mark);
}

static void accelerate(struct part *part, double *result) {
    cr_assert_eq(system_acceleration(&part->system, 0.3, part->q, part->v, result), 0, "%s",
                 part->system.reason);
}

static const int in_order[WISPS_MOST] = {0, 1, 2, 3, 4, 5, 6, 7, 8};

Test(wisp_kernel, models_of_1_to_9_wisps_are_the_twins) {
    static struct flock flock;
    static double a[WISPS_MOST][LAB_SIZE];
    unsigned seed = 2;
    double worst = 0;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int count = 1; count <= WISPS_MOST; count++)
            for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                make_flock(&flock, count, sample_counts[count % SAMPLE_COUNTS],
                           (enum bending)(count % LAWS), (enum wisp_treatment)treatment, &seed);
                with_model(&flock, lanes, in_order, accelerate, a);
                for (int i = 0; i < count; i++)
                    lab_check_with_twin(&flock.wisps[i], &flock.around,
                                        (enum wisp_treatment)treatment, 0.3, flock.q[i], flock.v[i],
                                        a[i], &worst);
            }
}

/* --- the same bits --- */

static void solve_spd(struct part *part, double *result) {
    cr_assert_eq(system_linearise(&part->system, JACOBIAN_SPD, 0.3, part->q, part->v), 0, "%s",
                 part->system.reason);
    cr_assert_eq(system_factor(&part->system, 1e-3, 1e-6), 0, "%s", part->system.reason);
    system_solve(&part->system, part->v, result);
}

static void multiply_exact(struct part *part, double *result) {
    cr_assert_eq(system_linearise(&part->system, JACOBIAN_EXACT, 0.3, part->q, part->v), 0, "%s",
                 part->system.reason);
    system_product(&part->system, 1, -1e-3, -1e-6, part->v, result);
}

static void multiply_spd(struct part *part, double *result) {
    cr_assert_eq(system_linearise(&part->system, JACOBIAN_SPD, 0.3, part->q, part->v), 0, "%s",
                 part->system.reason);
    system_product(&part->system, 1, -1e-3, -1e-6, part->v, result);
}

static void steps(struct part *part, const char *name, double *result) {
    struct stepper_settings settings = {.linear = linear_find("direct")};
    const struct stepper_method *method = stepper_find(name);
    struct stepper *stepper = stepper_create(method, &settings, &part->system);
    cr_assert(stepper, "no stepper");
    for (int k = 0; k < 30; k++)
        cr_assert_eq(method->step(stepper, 0.3 + k * 1e-5, 1e-5, part->q, part->v), 0, "%s: %s",
                     name, part->system.reason);
    memcpy(result, part->v, (size_t)part->system.size * sizeof *result);
    method->free(stepper);
}

static void steps_of_rk4(struct part *part, double *result) {
    steps(part, "rk4", result);
}

static void steps_of_implicit_euler(struct part *part, double *result) {
    steps(part, "implicit-euler", result);
}

static const struct {
    const char *name;
    use_part *use;
} uses[] = {
    {"acceleration", accelerate},      {"spd solve", solve_spd},
    {"exact product", multiply_exact}, {"spd product", multiply_spd},
    {"steps of rk4", steps_of_rk4},    {"steps of implicit-euler", steps_of_implicit_euler}};

static void same_bits(const struct flock *flock, double (*expected)[LAB_SIZE],
                      double (*got)[LAB_SIZE], const char *what) {
    for (int i = 0; i < flock->count; i++) {
        const struct wisp *wisp = &flock->wisps[i];
        const size_t size =
            (size_t)((wisp->nodes - 2) * wisp_node_unknowns(wisp, flock->treatment));
        cr_assert_eq(memcmp(expected[i], got[i], size * sizeof(double)), 0,
                     "%s, %s, bending %s, %d samples: other bits for wisp %d", what,
                     treatment_names[flock->treatment], law_names[wisp->bending], wisp->samples, i);
    }
}

Test(wisp_kernel, bits_do_not_depend_on_lanes_neighbours_or_order) {
    static struct flock flock, alone;
    static double one[WISPS_MOST][LAB_SIZE], more[WISPS_MOST][LAB_SIZE],
        single[WISPS_MOST][LAB_SIZE];
    static const int orders[][WISPS_MOST] = {{8, 7, 6, 5, 4, 3, 2, 1, 0},
                                             {3, 1, 4, 0, 5, 8, 2, 6, 7}};
    unsigned seed = 3;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int s = 0; s < SAMPLE_COUNTS; s++) {
                make_flock(&flock, WISPS_MOST, sample_counts[s], (enum bending)law,
                           (enum wisp_treatment)treatment, &seed);
                for (size_t u = 0; u < sizeof uses / sizeof *uses; u++) {
                    with_model(&flock, 1, in_order, uses[u].use, one);
                    for (int lanes = 4; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                        with_model(&flock, lanes, in_order, uses[u].use, more);
                        same_bits(&flock, one, more, uses[u].name);
                        for (int o = 0; o < 2; o++) {
                            with_model(&flock, lanes, orders[o], uses[u].use, more);
                            same_bits(&flock, one, more, uses[u].name);
                        }
                        alone = flock; /* and with nobody beside it */
                        alone.count = 1;
                        with_model(&alone, lanes, in_order, uses[u].use, single);
                        same_bits(&alone, one, single, uses[u].name);
                    }
                }
            }
}
