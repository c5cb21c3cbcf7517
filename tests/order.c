/* Orders of accuracy, observed; stage times; the effect of tolerances. */
#include "order.h"

#include "model/circle.h"
#include "scene/scene_load.h"

#include <complex.h>
#include <criterion/criterion.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void integrate_fixture(struct fixture *fixture, const struct variant *variant, double to, int steps,
                       double rtol, double *q, double *v) {
    const struct stepper_settings settings = variant_settings(variant, rtol, rtol);
    struct stepper *stepper = stepper_create(variant->method, &settings, &fixture->system);
    cr_assert(stepper, "%s on %s cannot be made", variant->name, fixture->system.name);
    const int code = integrate(stepper, 0, to, steps, q, v);
    cr_assert_eq(code, 0, "%s on %s: %s", variant->name, fixture->system.name,
                 fixture->system.reason);
    variant->method->free(stepper);
}

/* The error of (q, v) is left in q and v once the solution is taken off. */
static void oscillator_error(const struct variant *variant, int steps, double rtol, double *error) {
    static struct fixture fixture;
    const double to = 1.7;
    error[0] = 0;
    error[1] = 1;
    fixture_manufactured(&fixture);
    integrate_fixture(&fixture, variant, to, steps, rtol, error, error + 1);
    error[0] -= sin(to);
    error[1] -= cos(to);
}

static void quadrature_error(const struct variant *variant, int steps, double rtol, double *error) {
    static struct fixture fixture;
    const double to = 1.7;
    error[0] = -1; /* q'' = cos t: q = -cos t, v = sin t */
    error[1] = 0;
    fixture_quadrature(&fixture);
    integrate_fixture(&fixture, variant, to, steps, rtol, error, error + 1);
    error[0] += cos(to);
    error[1] -= sin(to);
}

static void dahlquist_error(const struct variant *variant, int steps, double rtol, double *error) {
    static struct fixture fixture;
    const double to = 1.7;
    const double complex z = -0.3 + 1.1 * I, exact = (1 + 0.5 * I) * cexp(to * z);
    double q[2] = {0};
    error[0] = 1;
    error[1] = 0.5;
    fixture_dahlquist(&fixture, z);
    integrate_fixture(&fixture, variant, to, steps, rtol, q, error);
    error[0] -= creal(exact);
    error[1] -= cimag(exact);
}

static void circle_error(const struct variant *variant, int steps, double rtol, double *error) {
    const double to = 20;
    double exact[2];
    struct orbit orbit;
    const int adaptive = (variant->method->capabilities & STEPPER_ADAPTIVE) != 0;
    struct scene *scene = circle_scene(to, 1 / to);
    run_circle(scene,
               &(struct run_request){.stepper = variant->method->name,
                                     .step = adaptive ? 0 : to / steps,
                                     .rtol = adaptive ? rtol : 0,
                                     .atol = adaptive ? rtol : 0,
                                     .options = &variant->option,
                                     .option_count = variant->option != NULL},
               &orbit);
    cr_assert_eq(orbit.result.outcome, FINISHED, "%s: %s", variant->name, orbit.result.reason);
    circle_exact(to, exact);
    error[0] = orbit.x - exact[0];
    error[1] = orbit.y - exact[1];
}

const struct yardstick small_yardsticks[SMALL_YARDSTICKS] = {
    [OSCILLATOR] = {"the made-up oscillator", 2, oscillator_error, 0},
    [DAHLQUIST] = {"u' = z u", 2, dahlquist_error, 0},
    [QUADRATURE] = {"quadrature", 2, quadrature_error, 1},
};
static const struct yardstick circle = {"the circle", 2, circle_error, 1};

static void each_yardstick(void (*use)(const struct variant *, const struct yardstick *),
                           const struct variant *variant) {
    use(variant, &circle);
    for (int y = 0; y < SMALL_YARDSTICKS; y++)
        use(variant, &small_yardsticks[y]);
}

static double dot(const struct yardstick *yardstick, const double *x, const double *y) {
    double sum = 0;
    for (int i = 0; i < yardstick->size; i++)
        sum += x[i] * y[i];
    return sum;
}

static double norm(const struct yardstick *yardstick, const double *x) {
    return sqrt(dot(yardstick, x, x));
}

/* What the method claims there. */
static int claimed(const struct stepper_method *method, const struct yardstick *yardstick) {
    return yardstick->undamped && method->undamped_order > 0 ? method->undamped_order
                                                             : method->order;
}

/* e(h) = C h^p + O(h^(p+1)): halving h twice must give log2 |e(h)| / |e(h/2)| = p both times (the
 * asymptotic range), and errors of the same direction (the sign: two errors that cancel or a C
 * that changes its sign give any number). The finest error must be far above rounding, unless all
 * are rounding: then the method has the exact solution, and no order there. */
struct order_seen see_order(const struct variant *variant, const struct yardstick *yardstick,
                            int coarsest) {
    struct order_seen seen = {.fault = ""};
    double error[3][YARDSTICK_SIZE_MAX];
    const int order = claimed(variant->method, yardstick);
    int turns = 0;
    for (int k = 0; k < 3; k++)
        yardstick->error(variant, coarsest << k, 0, error[k]);
    for (int k = 0; k < 2; k++) {
        const double coarse = norm(yardstick, error[k]), fine = norm(yardstick, error[k + 1]);
        seen.order[k] = log2(coarse / fine);
        turns |= !(dot(yardstick, error[k], error[k + 1]) > 0.99 * coarse * fine);
    }
    const double finest = norm(yardstick, error[2]);
    /* Exponential methods have nothing but rounding where a linear equation is the whole of it. */
    if (norm(yardstick, error[0]) <= 1e4 * DBL_EPSILON && finest <= 1e4 * DBL_EPSILON)
        return seen;
    const int holds = fabs(seen.order[0] - order) <= 0.05 && fabs(seen.order[1] - order) <= 0.05;
    if (turns)
        snprintf(seen.fault, sizeof seen.fault, "the error turns when the step is halved");
    else if (!(finest > 1e4 * DBL_EPSILON))
        snprintf(seen.fault, sizeof seen.fault, "an error of %.1e is rounding; use fewer steps",
                 finest);
    else if (!holds)
        snprintf(seen.fault, sizeof seen.fault, "observed orders %.3f and %.3f, not %d",
                 seen.order[0], seen.order[1], order);
    return seen;
}

static void check_yardstick(const struct variant *variant, const struct yardstick *yardstick) {
    const int order = claimed(variant->method, yardstick);
    const struct order_seen seen = see_order(variant, yardstick, 1024 / (order * order));
    cr_assert_str_empty(seen.fault, "%s on %s: %s", variant->name, yardstick->name, seen.fault);
}

static void check_order(const struct variant *variant, void *ctx) {
    (void)ctx;
    if (!(variant->method->capabilities & STEPPER_ADAPTIVE))
        each_yardstick(check_yardstick, variant);
}

Test(order, fixed_steps_have_the_order_they_claim) {
    each_variant(check_order, NULL);
}

/* Local errors are kept at rtol, and the global error of a method of order p follows as
 * rtol^(p/(p+1)): over six decades even order 1 must gain three. Not decade by decade: a single
 * adaptive run is a draw from a distribution. */
static void check_errors_fall(const struct variant *variant, const struct yardstick *yardstick) {
    static const double rtol[] = {1e-4, 1e-7, 1e-10};
    double off[3];
    for (int k = 0; k < 3; k++) {
        double error[YARDSTICK_SIZE_MAX];
        yardstick->error(variant, 0, rtol[k], error);
        off[k] = norm(yardstick, error);
    }
    cr_assert(off[2] < off[1] && off[1] < off[0] && off[2] <= 1e-3 * off[0],
              "%s on %s: errors %.1e, %.1e, %.1e at rtol 1e-4, 1e-7, 1e-10", variant->name,
              yardstick->name, off[0], off[1], off[2]);
    /* and the rough one is of the size that was asked for, far from no answer at all */
    cr_assert(off[0] < 0.1, "%s on %s: error %.1e at rtol 1e-4", variant->name, yardstick->name,
              off[0]);
}

static void check_tolerance(const struct variant *variant, void *ctx) {
    (void)ctx;
    if (variant->method->capabilities & STEPPER_ADAPTIVE)
        each_yardstick(check_errors_fall, variant);
}

Test(order, errors_of_adaptive_methods_fall_with_the_tolerance) {
    each_variant(check_tolerance, NULL);
}

/* --- where the right-hand side is asked for --- */

/* One step on v' = cos t from t is a quadrature rule; the rules by their textbook names. */
Test(order, stage_times_are_those_of_the_quadrature_rule) {
    static struct fixture fixture;
    const double t = 0.4, h = 0.9;
    const struct {
        const char *stepper;
        double sum; /* of weights times cos at the nodes */
    } rules[] = {
        {"euler", cos(t)},
        {"midpoint", cos(t + h / 2)},
        {"rk4", (cos(t) + 4 * cos(t + h / 2) + cos(t + h)) / 6},
        {"implicit-euler", cos(t + h)},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        const struct variant variant = {.method = stepper_find(rules[i].stepper)};
        const struct stepper_settings settings = variant_settings(&variant, 0, 0);
        double q = 0, v = 0;
        fixture_quadrature(&fixture);
        struct stepper *stepper = stepper_create(variant.method, &settings, &fixture.system);
        cr_assert(stepper, "no memory");
        cr_assert_eq(variant.method->step(stepper, t, h, &q, &v), 0, "%s", fixture.system.reason);
        variant.method->free(stepper);
        cr_assert(fabs(v - h * rules[i].sum) <= 8 * DBL_EPSILON,
                  "%s: a step on v' = cos t gives %.17g, its rule %.17g", rules[i].stepper, v,
                  h * rules[i].sum);
    }
}

/* The conditions on a table up to order 4 (Hairer, Norsett & Wanner, Solving ODEs I, theorem
 * II.2.1), and c_i = sum_j a_ij. Coefficients are of order one: a few roundings. */
static double conditions(const struct butcher_table *table, int condition) {
    double sum = 0;
    for (int i = 0; i < table->stages; i++) {
        double ac = 0, acc = 0, aac = 0;
        const double c = table->c[i];
        for (int j = 0; j < table->stages; j++) {
            double inner = 0;
            for (int k = 0; k < table->stages; k++)
                inner += butcher_row(table, j)[k] * table->c[k];
            ac += butcher_row(table, i)[j] * table->c[j];
            acc += butcher_row(table, i)[j] * table->c[j] * table->c[j];
            aac += butcher_row(table, i)[j] * inner;
        }
        const double terms[] = {1, c, c * c, ac, c * c * c, c * ac, acc, aac};
        sum += table->b[i] * terms[condition];
    }
    return sum;
}

Test(order, tables_fulfil_the_order_conditions) {
    static const double expected[] = {1, 1. / 2, 1. / 3, 1. / 6, 1. / 4, 1. / 8, 1. / 12, 1. / 24};
    static const int count_of_order[] = {0, 1, 2, 4, 8};
    for (int m = 0; stepper_methods[m]; m++) {
        const struct butcher_table *table = stepper_methods[m]->table;
        if (!table)
            continue;
        for (int i = 0; i < table->stages; i++) {
            double row = 0;
            for (int j = 0; j < table->stages; j++)
                row += butcher_row(table, i)[j];
            cr_assert(fabs(row - table->c[i]) <= 8 * DBL_EPSILON,
                      "%s: c_%d is %g and its row of A adds up to %g", stepper_methods[m]->name, i,
                      table->c[i], row);
        }
        const int order = stepper_methods[m]->order;
        for (int i = 0; i < count_of_order[order < 4 ? order : 4]; i++)
            cr_assert(fabs(conditions(table, i) - expected[i]) <= 8 * DBL_EPSILON,
                      "%s: order condition %d gives %.17g, not %.17g", stepper_methods[m]->name, i,
                      conditions(table, i), expected[i]);
    }
}

/* --- implicit equations --- */

/* On a linear system one Newton iteration solves implicit Euler's equations: what comes out must
 * fulfil v1 = v0 + h a(t1, q1, v1) and q1 = q0 + h v1, with M not diagonal and D, K not
 * symmetric. Rounding: the residual is that of a backward stable solve of n = 7 equations with
 * entries of order 10, relative to the sizes of its terms. */
Test(order, implicit_euler_solves_its_equations) {
    static struct fixture fixture;
    enum { N = 7 };
    for (int symmetric = 0; symmetric <= 1; symmetric++)
        for (double h = 1e-3; h < 20; h *= 10) {
            const struct variant variant = {.method = stepper_find("implicit-euler")};
            const struct stepper_settings settings = variant_settings(&variant, 0, 0);
            const double t = 0.3;
            double q0[N], v0[N], q[N], v[N], a[N];
            unsigned seed = 11;
            for (int i = 0; i < N; i++) {
                q[i] = q0[i] = 2 * random_number(&seed) - 1;
                v[i] = v0[i] = 2 * random_number(&seed) - 1;
            }
            fixture_chain(&fixture, N, 5, symmetric);
            struct stepper *stepper = stepper_create(variant.method, &settings, &fixture.system);
            cr_assert(stepper, "no memory");
            cr_assert_eq(variant.method->step(stepper, t, h, q, v), 0, "%s", fixture.system.reason);
            variant.method->free(stepper);
            fixture.system.ops->acceleration(&fixture, t + h, q, v, a);
            for (int i = 0; i < N; i++) {
                cr_assert(fabs(q[i] - q0[i] - h * v[i]) <=
                              4 * DBL_EPSILON * (fabs(q0[i]) + h * fabs(v[i])),
                          "h = %g: q1 is not q0 + h v1", h);
                double scale = fabs(v0[i]) + fabs(v[i]) + h;
                for (int j = 0; j < N; j++)
                    scale += h * 40 * (fabs(q[j]) + fabs(v[j]) + fabs(q0[j]));
                cr_assert(fabs(v[i] - v0[i] - h * a[i]) <= 1e-13 * scale,
                          "h = %g: v1 - v0 - h a(t1, q1, v1) is %.1e", h, v[i] - v0[i] - h * a[i]);
            }
        }
}

/* --- events --- */

/* Something outside turns u round at t = 1 and resets the stepper: u(2) = -u(0) e^(2 z). A stepper
 * that goes on from its history would be 2 |e^(2 z)| = 1.1 off; with 1e5 steps or at rtol 1e-8 none
 * is 1e-4 off (implicit Euler: h |z|^2 t |u| = 3e-5). */
static void check_event(const struct variant *variant, void *ctx) {
    (void)ctx;
    static struct fixture fixture;
    const double complex z = -0.3 + 1.1 * I, exact = -(1 + 0.5 * I) * cexp(2 * z);
    double q[2] = {0}, u[2] = {1, 0.5};
    const struct stepper_settings settings = variant_settings(variant, 1e-8, 1e-8);
    fixture_dahlquist(&fixture, z);
    struct stepper *stepper = stepper_create(variant->method, &settings, &fixture.system);
    cr_assert(stepper, "no memory");
    cr_assert_eq(integrate(stepper, 0, 1, 50000, q, u), 0, "%s", fixture.system.reason);
    u[0] = -u[0];
    u[1] = -u[1];
    if (variant->method->reset)
        cr_assert_eq(variant->method->reset(stepper, ~0u), 0, "%s: reset", variant->name);
    cr_assert_eq(integrate(stepper, 1, 2, 50000, q, u), 0, "%s", fixture.system.reason);
    const double off = cabs(u[0] + I * u[1] - exact);
    cr_assert(off <= 1e-4, "%s does not take up what an event changed: %.1e off", variant->name,
              off);
    cr_assert_eq(fixture.system.counters.restarts, variant->method->reset ? 1 : 0,
                 "%s: %lld restarts counted", variant->name, fixture.system.counters.restarts);
    variant->method->free(stepper);
}

Test(order, events_are_taken_up) {
    each_variant(check_event, NULL);
}
