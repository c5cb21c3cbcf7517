/* Methods that are implicit in a part of the forces, and the symplectic ones: orders on wisps,
 * lanes that begin anew by themselves, and what a part that is too small has to say. */
#include "fixture.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- orders --- */

/* At rates beyond those at which the next term of the error counts. */
static const struct method_case {
    const char *stepper, *option;
    double order, rates[3]; /* Hz */
} methods[] = {
    {"linear-euler", "matrix=auto", 1, {7680, 15360, 30720}},
    {"linear-euler", "matrix=stretch", 1, {7680, 15360, 30720}},
    {"linear-euler", "matrix=spd", 1, {7680, 15360, 30720}},
    {"bdf2", "matrix=auto", 2, {3840, 7680, 15360}},
    {"bdf2", "matrix=stretch", 2, {3840, 7680, 15360}},
    {"bdf2", "matrix=full", 2, {3840, 7680, 15360}},
    {"bdf3", "matrix=auto", 3, {3840, 7680, 15360}},
    {"bdf3", "matrix=stretch", 3, {3840, 7680, 15360}},
    {"bdf3", "matrix=full", 3, {3840, 7680, 15360}},
    {"symplectic-euler", NULL, 1, {30720, 61440, 122880}},
    {"drift-kick", NULL, 1, {30720, 61440, 122880}},
};

/* A higher order than that is right where the leading term of the error is small (`more`). */
static void check_orders(const char *name, int treatment, double tolerance, double more) {
    struct scene *scene = LAB_LOAD(name, "duration=0.15", "frame_rate=20.0");
    const struct run_request tight = {.stepper = "reference",
                                      .treatment = treatment_names[treatment],
                                      .rtol = 1e-13,
                                      .atol = 1e-14};
    struct lab_run exact;
    lab_run(scene, &tight, &exact);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        double error[3];
        for (int k = 0; k < 3; k++) {
            const struct run_request request = {.stepper = methods[i].stepper,
                                                .treatment = treatment_names[treatment],
                                                .step = 1 / methods[i].rates[k],
                                                .options = &methods[i].option,
                                                .option_count = methods[i].option != NULL};
            error[k] = lab_error(scene, &request, &exact);
        }
        lab_check_order(printed("%s, %s, %s %s", name, treatment_names[treatment],
                                methods[i].stepper, methods[i].option ? methods[i].option : ""),
                        error, methods[i].order, tolerance, more);
    }
}

Test(semi_implicit, methods_have_their_order_on_the_swing) {
    check_orders("swing", WISP_GENERALISED, 0.1, 0.1);
}

/* Out of the plane, with hinges, a head that moves and forces that have kinks. */
Test(semi_implicit, methods_have_their_order_on_the_shaken_swing) {
    check_orders("swing-shaken", WISP_GENERALISED, 0.1, 2);
}

Test(semi_implicit, methods_have_their_order_with_an_envelope) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        check_orders("swing-envelope", treatment, 0.15, 0.15);
}

/* --- linear systems --- */

enum { CHAIN = 7, TRAIN = 6 };

/* |to - sum_j weight_j x_j| of a component against the sum of absolute terms. */
static void must_vanish(const char *who, int step, const double *weight, double x[][CHAIN],
                        int last, int count, int i, double rate) {
    double sum = -rate, terms = fabs(rate);
    for (int j = 0; j < count; j++) {
        sum += weight[j] * x[last - j][i];
        terms += fabs(weight[j] * x[last - j][i]);
    }
    cr_assert(fabs(sum) <= 1e-12 * terms, "%s, step %d: a residual of %.1e in %.1e", who, step, sum,
              terms);
}

/* There one Newton iteration solves the implicit equations: what comes out fulfils the formulas of
 * backward differentiation, linear Euler and the first step of bdf2 those of implicit Euler. The
 * forces are of 40 times the state. */
static void check_formula(const char *name, int order, double h) {
    static struct fixture fixture;
    static const double weights[3][4] = {{1, -1}, {1.5, -2, 0.5}, {11. / 6, -3, 1.5, -1. / 3}};
    const struct stepper_method *method = stepper_find(name);
    const struct stepper_settings none = {0};
    double q[TRAIN + 1][CHAIN], v[TRAIN + 1][CHAIN], a[CHAIN];
    unsigned seed = 11;
    for (int i = 0; i < CHAIN; i++) {
        q[0][i] = 2 * random_number(&seed) - 1;
        v[0][i] = 2 * random_number(&seed) - 1;
    }
    fixture_chain(&fixture, CHAIN, 5, 1);
    struct stepper *stepper = stepper_create(method, &none, &fixture.system);
    cr_assert(stepper, "no memory");
    for (int k = 1; k <= TRAIN; k++) {
        memcpy(q[k], q[k - 1], sizeof q[k]);
        memcpy(v[k], v[k - 1], sizeof v[k]);
        cr_assert_eq(method->step(stepper, (k - 1) * h, h, q[k], v[k]), 0);
        if (k == 1 && order == 3)
            continue; /* it begins otherwise */
        const int count = k < order ? k : order;
        fixture.system.ops->acceleration(&fixture, k * h, q[k], v[k], a);
        for (int i = 0; i < CHAIN; i++) {
            const double *w = weights[count - 1];
            double terms = fabs(a[i]);
            for (int j = 0; j < CHAIN; j++)
                terms += 40 * (fabs(q[k][j]) + fabs(v[k][j]));
            double sum = -h * a[i], most = h * terms;
            for (int j = 0; j <= count; j++) {
                sum += w[j] * v[k - j][i];
                most += fabs(w[j] * v[k - j][i]);
            }
            cr_assert(fabs(sum) <= 1e-13 * most, "%s, step %d of %g: off by %.1e of %.1e", name, k,
                      h, sum, most);
            must_vanish(name, k, w, q, k, count + 1, i, h * v[k][i]);
        }
    }
    method->free(stepper);
}

Test(semi_implicit, on_linear_systems_they_solve_their_equations) {
    for (double h = 1e-3; h < 2; h *= 5) {
        check_formula("linear-euler", 1, h);
        check_formula("bdf2", 2, h);
        check_formula("bdf3", 3, h);
    }
}

/* --- steps of unequal lengths --- */

/* u' = z u with steps of h, h/2, 3h/4 in turn: without weights of their own errors would fall like
 * h. */
static double unequal_error(const struct stepper_method *method, int turns) {
    static struct fixture fixture;
    static const double part[] = {4. / 9, 2. / 9, 3. / 9};
    const double to = 1.7, turn = to / turns;
    const double complex z = -0.3 + 1.1 * I, exact = (1 + 0.5 * I) * cexp(to * z);
    const struct stepper_settings none = {0};
    double q[2] = {0}, u[2] = {1, 0.5}, t = 0;
    fixture_dahlquist(&fixture, z);
    struct stepper *stepper = stepper_create(method, &none, &fixture.system);
    cr_assert(stepper, "no memory");
    for (int k = 0; k < turns; k++)
        for (int i = 0; i < 3; i++, t += turn * part[(i + 2) % 3])
            cr_assert_eq(method->step(stepper, t, turn * part[i], q, u), 0);
    method->free(stepper);
    return cabs(u[0] + I * u[1] - exact);
}

Test(semi_implicit, unequal_steps_keep_the_order) {
    static const char *const names[] = {"bdf2", "bdf3"};
    for (int i = 0; i < 2; i++) {
        const struct stepper_method *method = stepper_find(names[i]);
        const double order = log2(unequal_error(method, 100) / unequal_error(method, 200));
        cr_assert(fabs(order - method->order) < 0.05, "%s: order %.3f", names[i], order);
    }
}

/* --- lanes --- */

enum { STEPS = 24 };

/* Which lanes begin anew after so many steps. */
static unsigned beginning(int step) {
    return step == 6 ? 0x42 : step == 7 ? 4 : step == 13 ? 0x85 : step == 20 ? 0xff : 0;
}

struct choice {
    const struct stepper_method *method;
    const char *option;
};

static void step_on(struct lab_part *part, int place, double *q, double *v, void *ctx) {
    const struct choice *choice = ctx;
    const struct stepper_method *method = choice->method;
    const struct stepper_settings settings = {.options = {&choice->option, choice->option != NULL}};
    part->system.force_parts = (1u << FORCE_PARTS) - 1;
    part->system.stiff_part = FORCES_AXIAL;
    struct stepper *stepper = stepper_create(method, &settings, &part->system);
    cr_assert(stepper, "no memory");
    for (int k = 0; k < STEPS; k++) {
        const double h = k < 10 ? 1e-4 : 7e-5;
        const unsigned lanes = place < 0 ? beginning(k) : beginning(k) >> place & 1;
        if (lanes && method->reset)
            method->reset(stepper, lanes);
        cr_assert_eq(method->step(stepper, k * 1e-4, h, q, v), 0, "%s", part->system.reason);
    }
    method->free(stepper);
}

/* A wisp's bits are those that it has alone, whoever beside it begins anew, and when. */
static void check_lanes(int lanes, const struct stepper_method *method, const char *option,
                        enum wisp_treatment treatment) {
    unsigned seed = 31;
    const struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
    const long long restarts = lab_company(lanes, BENDING_SKIP, treatment, &around, &seed, step_on,
                                           &(struct choice){method, option})
                                   .together.restarts;
    cr_assert_eq(restarts,
                 !method->reset ? 0
                 : lanes == 4   ? 8
                                : 14,
                 "%s, %s: %lld restarts", method->name, option, restarts);
}

Test(semi_implicit, lanes_begin_anew_by_themselves) {
    static const char *const options[] = {"matrix=stretch", "matrix=axial", "matrix=full"};
    static const char *const names[] = {"linear-euler", "bdf2", "bdf3"};
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int i = 0; i < 3; i++)
            for (int m = 0; m < 3; m++)
                for (int lanes = 4; lanes <= LAB_LANES; lanes = lab_wider(lanes))
                    check_lanes(lanes, stepper_find(names[m]), options[i],
                                (enum wisp_treatment)treatment);
}

/* --- symplectic methods --- */

static void without_damping(const struct fixture *f, double t, const double *q, const double *v,
                            double *a) {
    (void)f, (void)t, (void)v;
    a[0] = -q[0];
}

static struct stepper *oscillate(struct fixture *fixture, const char *name) {
    const struct stepper_settings none = {0};
    fixture_begin(fixture, "an oscillator", 1, 0, MATRIX_AVAILABLE);
    fixture->rate = without_damping;
    struct stepper *stepper = stepper_create(stepper_find(name), &none, &fixture->system);
    cr_assert(stepper, "no memory");
    return stepper;
}

/* On q'' = -q symplectic Euler keeps q^2 + v^2 - h q v, the energy of a near-by system, to
 * rounding: a thousand steps, each of a few. */
Test(semi_implicit, symplectic_euler_keeps_an_energy) {
    static struct fixture fixture;
    struct stepper *stepper = oscillate(&fixture, "symplectic-euler");
    const double h = 0.7;
    double q = 1, v = 0.3;
    const double first = q * q + v * v - h * q * v;
    for (int k = 0; k < 1000; k++)
        stepper->method->step(stepper, k * h, h, &q, &v);
    cr_assert(fabs(q * q + v * v - h * q * v - first) < 1e-12, "%.17g, not %.17g",
              q * q + v * v - h * q * v, first);
    stepper->method->free(stepper);
}

/* Turned round, the leapfrog goes back the way it came. */
Test(semi_implicit, drift_kick_is_reversible) {
    static struct fixture fixture;
    struct stepper *stepper = oscillate(&fixture, "drift-kick");
    double q = 1, v = 0.3;
    for (int k = 0; k < 2000; k++) {
        if (k == 1000)
            v = -v;
        stepper->method->step(stepper, 0.7 * k, 0.7, &q, &v);
    }
    cr_assert(fabs(q - 1) < 1e-12 && fabs(v + 0.3) < 1e-12, "%.17g, %.17g", q, v);
    stepper->method->free(stepper);
}

/* --- what is stiff --- */

/* At one step methods are as near to the motion of the thesis's hair with real hair's stiffness and
 * a hundred times beyond, where explicit methods would need steps of a tenth of a microsecond: the
 * motions themselves differ by less than a millimetre. With the pull left out linear Euler lets go.
 */
Test(semi_implicit, steps_do_not_feel_the_stiffness_of_stretching) {
    static const struct {
        const char *stepper;
        double rate, most; /* Hz; m */
    } rows[] = {{"linear-euler", 480, 3e-3}, {"bdf2", 480, 1.5e-3}, {"bdf3", 600, 1.5e-3}};
    static const char *const stiffness[] = {"material.stretch_stiffness=90",
                                            "material.stretch_stiffness=16800",
                                            "material.stretch_stiffness=1.68e6"};
    struct scene *soft = LAB_LOAD("swing", "duration=0.4", stiffness[0]);
    struct lab_run exact;
    lab_run(soft, &(struct run_request){.stepper = "reference", .rtol = 1e-9, .atol = 1e-9},
            &exact);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        for (int k = 0; k < 3; k++) {
            struct scene *scene = LAB_LOAD("swing", "duration=0.4", stiffness[k]);
            const struct run_request request = {.stepper = rows[i].stepper,
                                                .step = 1 / rows[i].rate};
            const double error = lab_error(scene, &request, &exact);
            cr_assert(error < rows[i].most, "%s, %s: %.2e m", rows[i].stepper, stiffness[k], error);
        }
}

/* --- what is too stiff --- */

/* Bending a hundred times stiffer than by default is too stiff to be explicit at 500 Hz: a matrix
 * without it ends the run and says so, one with it does not. */
Test(semi_implicit, a_matrix_without_stiff_bending_says_why_it_fails) {
    static const char *const names[] = {"linear-euler", "bdf2", "bdf3"};
    static const char *const options[] = {"matrix=stretch", "matrix=auto"};
    struct scene *scene = LAB_LOAD("swing", "duration=0.2", "material.bending_stiffness=1e-3");
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) {
            struct lab_run run;
            lab_run(
                scene,
                &(struct run_request){
                    .stepper = names[i], .step = 2e-3, .options = &options[k], .option_count = 1},
                &run);
            if (k == 0)
                cr_assert(run.result.outcome != FINISHED &&
                              strstr(run.result.reason, "matrix=stretch leaves bending"),
                          "%s: %s: %s", names[i], outcome_name(run.result.outcome),
                          run.result.reason);
            else
                cr_assert_eq(run.result.outcome, FINISHED, "%s: %s", names[i], run.result.reason);
        }
}
