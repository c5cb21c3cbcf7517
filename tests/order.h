/* The gate of order: what a fixed-step method is held to, whoever made it. */
#ifndef WISPLAB_TESTS_ORDER_H
#define WISPLAB_TESTS_ORDER_H

#include "fixture.h"
#include "support.h"

enum { YARDSTICK_SIZE_MAX = 8 };

/* A problem with a solution: integrates it to the end with a variant in so many steps, or to rtol,
 * and gives the error vector, of `size` numbers. */
struct yardstick {
    const char *name;
    int size;
    void (*error)(const struct variant *variant, int steps, double rtol, double *error);
    int undamped; /* nothing is damped */
};

/* The made-up oscillator, u' = z u, and pure quadrature. */
enum { OSCILLATOR, DAHLQUIST, QUADRATURE, SMALL_YARDSTICKS };
extern const struct yardstick small_yardsticks[SMALL_YARDSTICKS];

/* Integrates a fixture from (0, q, v), in place; stops the test where that fails. */
void integrate_fixture(struct fixture *fixture, const struct variant *variant, double to, int steps,
                       double rtol, double *q, double *v);

/* What halving the step twice from `coarsest` steps shows. */
struct order_seen {
    double order[2];
    char fault[256]; /* why this is not the order that the method claims; empty: it is */
};
struct order_seen see_order(const struct variant *variant, const struct yardstick *yardstick,
                            int coarsest);

#endif
