/* The plain loop that others are measured with computes the model: its accelerations are the
 * twin's, and its steps those of the methods that they are named after. */
#include "experiments/bench/plain_chain.h"

#include "experiments/bench/wisp_twin.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

static const double gravity[3] = {0.3, -9.81, 0.1};

static struct wisp wisp_of(unsigned *seed) {
    return lab_wisp((int)lab_between(seed, 4, LAB_NODES + 0.999), 0, BENDING_SKIP, seed);
}

/* A chain, its twin, and a state in motion. */
struct pair {
    struct chain chain;
    struct wisp_twin twin;
    double q[LAB_SIZE], v[LAB_SIZE];
};

static void make_pair(struct pair *pair, unsigned *seed) {
    struct surroundings around = {.wind = {.kind = WIND_NONE}};
    const struct wisp wisp = wisp_of(seed);
    memcpy(around.gravity, gravity, sizeof gravity);
    chain_init(&pair->chain, &wisp, &around);
    cr_assert_eq(wisp_twin_init(&pair->twin, &wisp, &around, WISP_GENERALISED), 0, "no twin");
    lab_state(&wisp, WISP_GENERALISED, STATE_RANDOM, 0, seed, pair->q, pair->v);
}

Test(plain_chain, accelerations_are_the_twins) {
    unsigned seed = 3;
    for (int n = 0; n < 50; n++) {
        struct pair p;
        double a[LAB_SIZE], twins[LAB_SIZE], scale[LAB_SIZE];
        make_pair(&p, &seed);
        chain_acceleration(&p.chain, p.q, p.v, a);
        cr_assert_eq(wisp_twin_acceleration(&p.twin, 0, p.q, p.v, twins), 0);
        wisp_twin_scale(&p.twin, 0, p.q, p.v, scale);
        for (int i = 0; i < p.chain.size; i++)
            cr_assert(fabs(a[i] - twins[i]) <= 1e-14 * scale[i], "%d: %.17g, not %.17g", i, a[i],
                      twins[i]);
    }
}

/* Halving the step divides the error of a step by 2 to the order and one. */
static double order_of(void (*step)(const struct chain *, double, double *, double *)) {
    unsigned seed = 5;
    double moved[3][LAB_SIZE], first = 0, second = 0;
    struct pair p;
    make_pair(&p, &seed);
    for (int k = 0; k < 3; k++) {
        double q[LAB_SIZE], v[LAB_SIZE];
        memcpy(q, p.q, sizeof q);
        memcpy(v, p.v, sizeof v);
        for (int n = 0; n < 8 << k; n++)
            step(&p.chain, 4e-5 / (8 << k), q, v);
        memcpy(moved[k], q, sizeof q);
    }
    for (int i = 0; i < p.chain.size; i++) {
        first += pow(moved[1][i] - moved[0][i], 2);
        second += pow(moved[2][i] - moved[1][i], 2);
    }
    return log2(sqrt(first / second));
}

Test(plain_chain, steps_have_their_orders) {
    cr_assert_float_eq(order_of(chain_euler), 1, 0.1, "Euler: %g", order_of(chain_euler));
    cr_assert_float_eq(order_of(chain_rk4), 4, 0.3, "RK4: %g", order_of(chain_rk4));
}
