/* The arithmetic floor of an evaluation: the operations that the model needs, at the rates at which
 * this machine does nothing else. A kernel whose operations are all independent and whose numbers
 * are all at hand would take that long. It is one for so many lanes: a wider register does more in
 * the same time on some machines, and takes twice as long on others. */
#include "measure.h"

#include <math.h>

/* --- what the model needs --- */

/* Operations of a term; a multiplication and an addition are two, for they round twice here. What
 * depends on the scene alone (masses, 1/(m + ...), g + gamma w) is known before. */
static const struct operations
    /* d = p_b - p_a: 3; d.d: 5; L; 1/L; n: 3; v_b - v_a: 3; ().n: 5; k(L - L0) + c(): 4; times n: 3
     */
    spring = {1, 1, 26},
    /* onto the sum of forces of one of its nodes: 3 */
    spring_end = {0, 0, 3},
    /* g + gamma w - gamma v: 6; + f/m: 6 */
    node = {0, 0, 12},
    /* t x t: 9; its norm: 5 and a root; t.t: 5; atan2: a division and some 45 (a vector
     * library's: one quotient, a polynomial of degree 19 in its square); 1/sin; b - cos a, a -
     * cos b: 12; times 1/(L sin): 8; rate: 11; k angle + c rate: 3; forces on the edges: 6; to
     * 3 nodes: 12 */
    hinge = {1, 2, 116},
    /* t + t: 3; its norm: 5 and a root; unit: 3 and a division */
    bisector = {1, 1, 11},
    /* u.w, w.w + 1: 11; a division; w + w: 3; u - (): 6; v = w x u: 9 */
    transport = {0, 1, 29},
    /* G.u, G.v: 10; to the node: sums times mass ratio and axes: 14 */
    projection_node = {0, 0, 24},
    /* R - r, k(), c r', -: 4; into the sums: 4; F.a: 3 + 1; gamma r': 2 */
    projection_sample = {0, 0, 14},
    /* w.G, half (): 6; + half G, + () w: 12; by the mass across: 3; and along: 12; a.u, a.v: 10
     */
    generalised_node = {0, 0, 43},
    /* rddot - a.a_j: 4 */
    generalised_sample = {0, 0, 4},
    /* sum, over the mass: 6 */
    penalty_node = {0, 0, 6},
    /* a_j: 9; e - p, e' - v: 6; along a: 10; s: 4; s + k_p r + c_p r': 4; the pull: 3 + 6 + 6;
     * into the sum: 3; the sample's air and all: 9 */
    penalty_sample = {0, 0, 60};

static void count(struct operations *sum, double times, struct operations term) {
    sum->square_roots += times * term.square_roots;
    sum->divisions += times * term.divisions;
    sum->others += times * term.others;
}

static void count_samples(struct operations *sum, const struct wisp_set *set, double nodes) {
    const double samples = nodes * set->samples;
    count(sum, nodes - 1, bisector); /* the last node takes its segment's direction */
    count(sum, nodes, transport);
    if (set->treatment == WISP_PENALTY) {
        count(sum, nodes, penalty_node);
        count(sum, samples, penalty_sample);
        return;
    }
    count(sum, nodes, projection_node);
    count(sum, samples, projection_sample);
    if (set->treatment == WISP_GENERALISED) {
        count(sum, nodes, generalised_node);
        count(sum, samples, generalised_sample);
    }
}

struct operations needed_operations(const struct wisp_set *set) {
    struct operations sum = {0, 0, 0};
    const double nodes = KERNEL_NODES - 2; /* and as many segments and bends that move */
    count(&sum, nodes, node);
    count(&sum, nodes, spring);
    count(&sum, 2 * nodes - 1, spring_end); /* the first segment's other end is the head's */
    if (set->bending == BENDING_SKIP) {
        count(&sum, nodes, spring);
        count(&sum, 2 * nodes - 2, spring_end);
    }
    if (set->bending == BENDING_HINGE)
        count(&sum, nodes, hinge);
    if (set->samples > 0)
        count_samples(&sum, set, nodes);
    return (struct operations){sum.square_roots / nodes, sum.divisions / nodes, sum.others / nodes};
}

/* --- what the machine can --- */

/* Chains that do not wait for each other: enough to hide any latency, few enough for registers. */
enum { CHAINS = 12, TURNS = 200 };

/* x <- by / x: the chain goes to and fro between two numbers. x <- sqrt(by - x): goes to a number
 * of no simple form. x <- x by + plus: half of them multiplications, half additions, as in the
 * model. */
#define RATES_OF(LANES)                                                                         \
    typedef double vector_##LANES __attribute__((vector_size(8 * LANES)));                      \
    struct chains_##LANES {                                                                     \
        vector_##LANES x[CHAINS], by, plus;                                                     \
    };                                                                                          \
    static void divide_##LANES(void *ctx) {                                                     \
        struct chains_##LANES chains = *(struct chains_##LANES *)ctx;                           \
        for (int turn = 0; turn < TURNS; turn++)                                                \
            for (int k = 0; k < CHAINS; k++)                                                    \
                chains.x[k] = chains.by / chains.x[k];                                          \
        *(struct chains_##LANES *)ctx = chains;                                                 \
    }                                                                                           \
    static void take_roots_##LANES(void *ctx) {                                                 \
        struct chains_##LANES chains = *(struct chains_##LANES *)ctx;                           \
        for (int turn = 0; turn < TURNS; turn++)                                                \
            for (int k = 0; k < CHAINS; k++) {                                                  \
                const vector_##LANES difference = chains.by - chains.x[k];                      \
                for (int lane = 0; lane < LANES; lane++)                                        \
                    chains.x[k][lane] = sqrt(difference[lane]);                                 \
            }                                                                                   \
        *(struct chains_##LANES *)ctx = chains;                                                 \
    }                                                                                           \
    static void multiply_and_add_##LANES(void *ctx) {                                           \
        struct chains_##LANES chains = *(struct chains_##LANES *)ctx;                           \
        for (int turn = 0; turn < TURNS; turn++)                                                \
            for (int k = 0; k < CHAINS; k++)                                                    \
                chains.x[k] = chains.x[k] * chains.by + chains.plus;                            \
        *(struct chains_##LANES *)ctx = chains;                                                 \
    }                                                                                           \
    static struct chains_##LANES *chains_of_##LANES(double by, double plus) {                   \
        struct chains_##LANES *chains = zeros(sizeof *chains);                                  \
        for (int lane = 0; lane < LANES; lane++) {                                              \
            chains->by[lane] = by + 0.01 * lane;                                                \
            chains->plus[lane] = plus;                                                          \
            for (int k = 0; k < CHAINS; k++)                                                    \
                chains->x[k][lane] = 1.1 + 0.01 * k;                                            \
        }                                                                                       \
        return chains;                                                                          \
    }                                                                                           \
    /* Units: an operation on LANES numbers. */                                                 \
    static void enter_rates_##LANES(struct contest *contest, const char *subject) {             \
        const double units = CHAINS * TURNS;                                                    \
        contest_add(contest, "rate", subject, "division " #LANES, units, divide_##LANES,        \
                    chains_of_##LANES(1.7, 0));                                                 \
        contest_add(contest, "rate", subject, "square root " #LANES, units, take_roots_##LANES, \
                    chains_of_##LANES(3.1, 0));                                                 \
        contest_add(contest, "rate", subject, "add or multiply " #LANES, 2 * units,             \
                    multiply_and_add_##LANES, chains_of_##LANES(0.9, 0.2));                     \
    }

RATES_OF(4)
RATES_OF(8)

void enter_rates(struct contest *contest, const char *subject) {
    enter_rates_4(contest, subject);
    enter_rates_8(contest, subject);
}

static const struct series *rate_series(const struct samples *samples, const struct wisp_set *set,
                                        const char *operation, int lanes) {
    char subject[SUBJECT_SIZE], name[32];
    rates_subject(set, subject);
    snprintf(name, sizeof name, "%s %d", operation, lanes);
    return series_find(samples, "rate", subject, name);
}

/* Divisions and roots share a unit that does little else; the others go on beside them. */
int floor_times(const struct samples *samples, const struct wisp_set *set, int lanes,
                double *floor) {
    const struct operations need = needed_operations(set);
    const struct series *division = rate_series(samples, set, "division", lanes);
    const struct series *root = rate_series(samples, set, "square root", lanes);
    const struct series *other = rate_series(samples, set, "add or multiply", lanes);
    if (!division || !root || !other)
        return 0;
    for (int i = 0; i < division->count; i++) {
        const double slow =
            need.divisions * division->value[i] + need.square_roots * root->value[i];
        floor[i] = fmax(slow, need.others * other->value[i]) / lanes;
    }
    return division->count;
}
