/* Problems of others, with solutions that others published: stiff ones of the Test Set for IVP
 * Solvers (F. Mazzia & C. Magherini, release 2.4, University of Bari, 2008; archimede.uniba.it/
 * ~testset). Published are equations, starts and the values at the end, computed there with RADAU5
 * and RADAU at tolerances of 1.1e-18, and printed to 16 digits. */
#include "experiments/common/measure.h"
#include "order.h"
#include "scene/scene_load.h"

#include <criterion/criterion.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

struct published {
    const char *name;
    int size; /* of y: u, or (q, v) */
    int is_second_order;
    double end;
    const double *start, *solution; /* y at 0 and at the end */
    void (*make)(struct fixture *fixture);
};

/* --- HIRES: how light makes a plant grow; 8 equations of first order, which ride on v --- */

static void hires_rate(const struct fixture *f, double t, const double *q, const double *v,
                       double *a) {
    (void)f, (void)t, (void)q;
    a[0] = -1.71 * v[0] + 0.43 * v[1] + 8.32 * v[2] + 0.0007;
    a[1] = 1.71 * v[0] - 8.75 * v[1];
    a[2] = -10.03 * v[2] + 0.43 * v[3] + 0.035 * v[4];
    a[3] = 8.32 * v[1] + 1.71 * v[2] - 1.12 * v[3];
    a[4] = -1.745 * v[4] + 0.43 * v[5] + 0.43 * v[6];
    a[5] = -280 * v[5] * v[7] + 0.69 * v[3] + 1.71 * v[4] - 0.43 * v[5] + 0.69 * v[6];
    a[6] = 280 * v[5] * v[7] - 1.81 * v[6];
    a[7] = -a[6];
}

static void hires_jacobians(struct fixture *f, double t, const double *q, const double *v) {
    (void)t, (void)q;
    const double to_7 = 280 * v[7], from_5 = 280 * v[5];
    const double d[8][8] = {{-1.71, 0.43, 8.32},
                            {1.71, -8.75},
                            {0, 0, -10.03, 0.43, 0.035},
                            {0, 8.32, 1.71, -1.12},
                            {0, 0, 0, 0, -1.745, 0.43, 0.43},
                            {0, 0, 0, 0.69, 1.71, -to_7 - 0.43, 0.69, -from_5},
                            {0, 0, 0, 0, 0, to_7, -1.81, from_5},
                            {0, 0, 0, 0, 0, -to_7, 1.81, -from_5}};
    memcpy(f->d, d, sizeof d);
}

static void make_hires(struct fixture *f) {
    fixture_begin(f, "HIRES", 8, 7, MATRIX_AVAILABLE);
    f->rate = hires_rate;
    f->jacobians = hires_jacobians;
}

/* --- van der Pol: one equation of second order, in two scales of time --- */

static void vdpol_rate(const struct fixture *f, double t, const double *q, const double *v,
                       double *a) {
    (void)f, (void)t;
    a[0] = ((1 - q[0] * q[0]) * v[0] - q[0]) / 1e-6;
}

static void vdpol_jacobians(struct fixture *f, double t, const double *q, const double *v) {
    (void)t;
    f->k[0] = (-2 * q[0] * v[0] - 1) / 1e-6;
    f->d[0] = (1 - q[0] * q[0]) / 1e-6;
}

static void make_vdpol(struct fixture *f) {
    fixture_begin(f, "vdpol", 1, 0, MATRIX_AVAILABLE | MATRIX_SYMMETRIC);
    f->rate = vdpol_rate;
    f->jacobians = vdpol_jacobians;
}

static void vdpolm_rate(const struct fixture *f, double t, const double *q, const double *v,
                        double *a) {
    (void)f, (void)t;
    a[0] = 1e3 * (1 - q[0] * q[0]) * v[0] - q[0];
}

static void vdpolm_jacobians(struct fixture *f, double t, const double *q, const double *v) {
    (void)t;
    f->k[0] = -2e3 * q[0] * v[0] - 1;
    f->d[0] = 1e3 * (1 - q[0] * q[0]);
}

static void make_vdpolm(struct fixture *f) {
    fixture_begin(f, "vdpolm", 1, 0, MATRIX_AVAILABLE | MATRIX_SYMMETRIC);
    f->rate = vdpolm_rate;
    f->jacobians = vdpolm_jacobians;
}

enum { HIRES, VDPOL, VDPOLM, PROBLEMS };
static const struct published published[PROBLEMS] = {
    [HIRES] = {.name = "HIRES",
               .size = 8,
               .end = 321.8122,
               .start = (const double[]){1, 0, 0, 0, 0, 0, 0, 0.0057},
               .solution = (const double[]){0.7371312573325668e-3, 0.1442485726316185e-3,
                                            0.5888729740967575e-4, 0.1175651343283149e-2,
                                            0.2386356198831331e-2, 0.6238968252742796e-2,
                                            0.2849998395185769e-2, 0.2850001604814231e-2},
               .make = make_hires},
    [VDPOL] = {.name = "vdpol",
               .size = 2,
               .is_second_order = 1,
               .end = 2,
               .start = (const double[]){2, 0},
               .solution = (const double[]){0.1706167732170483e1, -0.8928097010247975e0},
               .make = make_vdpol},
    [VDPOLM] = {.name = "vdpolm",
                .size = 2,
                .is_second_order = 1,
                .end = 2000,
                .start = (const double[]){2, 0},
                .solution = (const double[]){0.1706167732170469e1, -0.8928097010248125e-3},
                .make = make_vdpolm},
};

/* --- integration --- */

/* y at the end, and the counters; stops the test where a step fails. */
static void solve(const struct published *p, const struct variant *variant, int steps, double rtol,
                  double *y, struct counters *counters) {
    static struct fixture fixture;
    double q[YARDSTICK_SIZE_MAX] = {0}, v[YARDSTICK_SIZE_MAX];
    p->make(&fixture);
    const size_t bytes = (size_t)fixture.n * sizeof *y;
    memcpy(v, p->start + (p->is_second_order ? fixture.n : 0), bytes);
    if (p->is_second_order)
        memcpy(q, p->start, bytes);
    integrate_fixture(&fixture, variant, p->end, steps, rtol, q, v);
    memcpy(y + (p->is_second_order ? fixture.n : 0), v, bytes);
    if (p->is_second_order)
        memcpy(y, q, bytes);
    if (counters)
        *counters = fixture.system.counters;
}

/* Significant correct digits: -log10 of the largest |y - solution| / (floor + |solution|): scd with
 * a floor of 0; mescd with atol/rtol, which is 1 here. */
static double digits(const struct published *p, const double *y, double floor) {
    return -log10(mixed_error(y, p->solution, p->size, floor));
}

/* --- the printed numbers, and what is written here, before anything is measured by them --- */

/* No equation of HIRES changes y7 + y8, which starts as 0.0057; vdpolm is vdpol in units of 1/1000
 * of its time. The printed values know both, to their last digits. */
Test(published, the_printed_solutions_fit_together) {
    const double *hires = published[HIRES].solution, *vdpol = published[VDPOL].solution,
                 *vdpolm = published[VDPOLM].solution;
    const double rescaled[] = {vdpolm[0], 1e3 * vdpolm[1]};
    cr_assert_float_eq(hires[6] + hires[7], 0.0057, 1e-18, "y7 + y8 is %.17g", hires[6] + hires[7]);
    cr_assert(mixed_error(rescaled, vdpol, 2, 0) <= 5e-14, "two forms of van der Pol end apart");
}

/* Column j of df/dv and of df/dq against central differences. The rates are of second degree in v
 * and in q alone: nothing but rounding is left, of some 1e-16 / 1e-3 of the largest rates. */
static void check_column(struct fixture *f, int j, double *q, double *v) {
    const double step = 1e-3;
    for (int of_v = 0; of_v <= 1; of_v++) {
        double forward[YARDSTICK_SIZE_MAX], back[YARDSTICK_SIZE_MAX];
        double *x = of_v ? &v[j] : &q[j];
        const double at = *x;
        *x = at + step;
        f->rate(f, 0, q, v, forward);
        *x = at - step;
        f->rate(f, 0, q, v, back);
        *x = at;
        for (int i = 0; i < f->n; i++) {
            const double slope = (forward[i] - back[i]) / (2 * step);
            const double entry = (of_v ? f->d : f->k)[i * f->n + j];
            const double scale = fabs(forward[i]) + fabs(back[i]);
            cr_assert(fabs(slope - entry) <= 1e-12 * (scale / step + 1),
                      "%s: df%d/d%c%d is %g, and by differences %g", f->system.name, i,
                      of_v ? 'v' : 'q', j, entry, slope);
        }
    }
}

Test(published, jacobians_are_derivatives) {
    static struct fixture fixture;
    unsigned seed = 3;
    for (int p = 0; p < PROBLEMS; p++)
        for (int repeat = 0; repeat < 10; repeat++) {
            double q[YARDSTICK_SIZE_MAX], v[YARDSTICK_SIZE_MAX];
            for (int i = 0; i < YARDSTICK_SIZE_MAX; i++) {
                q[i] = 4 * random_number(&seed) - 2;
                v[i] = 4 * random_number(&seed) - 2;
            }
            published[p].make(&fixture);
            fixture.jacobians(&fixture, 0, q, v);
            for (int j = 0; j < fixture.n; j++)
                check_column(&fixture, j, q, v);
        }
}

/* --- adaptive methods --- */

static struct variant variant_of(const char *stepper, const char *option) {
    struct variant variant = {.method = stepper_find(stepper), .option = option};
    snprintf(variant.name, sizeof variant.name, "%s", stepper);
    return variant;
}

/* The fewest digits of nine runs whose tolerances are all but the same: those of one adaptive run
 * are a draw from a distribution (HIRES at 1e-8: 4.5 to 7.0). */
static void worst_digits(const struct published *p, const struct variant *variant, double rtol,
                         double *scd, double *mescd) {
    *scd = *mescd = INFINITY;
    for (int j = 0; j < 9; j++) {
        double y[YARDSTICK_SIZE_MAX];
        solve(p, variant, 0, rtol * (1 + 1e-3 * j), y, NULL);
        *scd = fmin(*scd, digits(p, y, 0));
        *mescd = fmin(*mescd, digits(p, y, 1));
    }
}

/* As measured; half a digit, a factor of 3, on either side. More than was measured is as wrong as
 * less: it says that something else was. */
Test(published, cvode_has_the_digits_that_its_tolerance_buys) {
    static const double rtol[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
    static const double measured[PROBLEMS][5][2] = {
        [HIRES] = {{0.95, 3.16}, {2.40, 4.61}, {4.48, 6.68}, {6.16, 8.36}, {7.82, 10.03}},
        [VDPOL] = {{2.62, 2.94}, {4.29, 4.62}, {6.11, 6.44}, {7.85, 8.18}, {9.71, 10.04}},
        [VDPOLM] = {{2.00, 2.49}, {3.51, 4.00}, {5.18, 5.69}, {6.96, 7.47}, {8.59, 9.10}},
    };
    const struct variant cvode = variant_of("cvode", NULL);
    for (int p = 0; p < PROBLEMS; p++) {
        double before = -INFINITY;
        for (int k = 0; k < 5; k++) {
            double scd, mescd;
            worst_digits(&published[p], &cvode, rtol[k], &scd, &mescd);
            cr_assert(fabs(scd - measured[p][k][0]) <= 0.5 &&
                          fabs(mescd - measured[p][k][1]) <= 0.5,
                      "cvode on %s at rtol %g: scd %.2f, mescd %.2f, and had %.2f and %.2f",
                      published[p].name, rtol[k], scd, mescd, measured[p][k][0], measured[p][k][1]);
            cr_assert(scd > before + 1, "cvode on %s: from %.2f to %.2f digits at rtol %g",
                      published[p].name, before, scd, rtol[k]);
            before = scd;
        }
    }
}

/* To what its own rounding leaves of the printed digits: a million steps on van der Pol. Nine
 * tolerances near 1e-13 gave at least 11.8, 11.0 and 10.8 digits. */
Test(published, reference_ends_on_the_printed_digits) {
    static const double least[PROBLEMS] = {[HIRES] = 11.5, [VDPOL] = 10.7, [VDPOLM] = 10.5};
    const struct variant reference = variant_of("reference", NULL);
    for (int p = 0; p < PROBLEMS; p++) {
        double rough[YARDSTICK_SIZE_MAX], tight[YARDSTICK_SIZE_MAX];
        solve(&published[p], &reference, 0, 1e-4, rough, NULL);
        solve(&published[p], &reference, 0, 1e-13, tight, NULL);
        const double few = digits(&published[p], rough, 0), many = digits(&published[p], tight, 0);
        cr_assert(many >= least[p] && few <= many - 5, "%s: %.2f digits, at rtol 1e-4 %.2f",
                  published[p].name, many, few);
    }
}

/* Here the truth is known that a cross-check stands for: the difference of the two opinions, as
 * runs state it, bounds the distance of the first from the printed solution. */
Test(published, the_cross_check_bounds_the_error_of_the_reference) {
    const struct variant reference = variant_of("reference", NULL);
    const struct cross_check *check = reference.method->checked_by;
    const struct variant second = variant_of(check->method, check->options[1]);
    const double rtol = reference.method->rtol;
    cr_assert_str_eq(check->options[1], "max_order=5");
    for (int p = 0; p < PROBLEMS; p++) {
        double one[YARDSTICK_SIZE_MAX], other[YARDSTICK_SIZE_MAX];
        solve(&published[p], &reference, 0, rtol, one, NULL);
        solve(&published[p], &second, 0, rtol * check->rtol_ratio, other, NULL);
        const double bound = mixed_error(one, other, published[p].size, 0);
        const double error = mixed_error(one, published[p].solution, published[p].size, 0);
        cr_assert(error <= bound && bound <= 1e-7, "%s: %.1e from the solution, bound %.1e",
                  published[p].name, error, bound);
    }
}

/* What stiff means. Four decades of tolerance cost the explicit reference nothing, for stability
 * chooses its step: about 6 over the rate 3e6 of van der Pol's fast motion, so that it takes a
 * million steps of 13 evaluations, where BDF takes thousands and pays for accuracy. */
Test(published, stiffness_decides_what_an_explicit_method_costs) {
    const struct variant reference = variant_of("reference", NULL),
                         cvode = variant_of("cvode", NULL);
    for (int p = VDPOL; p <= VDPOLM; p++) {
        struct counters rough, tight, implicit_rough, implicit_tight;
        double y[YARDSTICK_SIZE_MAX];
        solve(&published[p], &reference, 0, 1e-4, y, &rough);
        solve(&published[p], &reference, 0, 1e-8, y, &tight);
        solve(&published[p], &cvode, 0, 1e-4, y, &implicit_rough);
        solve(&published[p], &cvode, 0, 1e-8, y, &implicit_tight);
        const double r = (double)rough.force_evaluations, t = (double)tight.force_evaluations;
        cr_assert(r > 1e7 && r < 2e7 && fabs(t - r) <= 0.01 * r, "%s: %g and %g evaluations",
                  published[p].name, r, t);
        cr_assert(r > 1e3 * (double)implicit_tight.force_evaluations &&
                      implicit_tight.force_evaluations > 2 * implicit_rough.force_evaluations,
                  "%s: cvode takes %lld and %lld evaluations", published[p].name,
                  implicit_rough.force_evaluations, implicit_tight.force_evaluations);
    }
}

/* --- fixed steps --- */

/* Relative errors of HIRES at the end. */
static void hires_error(const struct variant *variant, int steps, double rtol, double *error) {
    solve(&published[HIRES], variant, steps, rtol, error, NULL);
    for (int i = 0; i < published[HIRES].size; i++)
        error[i] = error[i] / published[HIRES].solution[i] - 1;
}
static const struct yardstick hires = {"HIRES", 8, hires_error, 0};

Test(published, implicit_euler_is_of_first_order_on_hires) {
    const struct variant variant = variant_of("implicit-euler", "newton.iterations=20");
    const struct order_seen seen = see_order(&variant, &hires, 32000);
    cr_assert_str_empty(seen.fault, "%s", seen.fault);
}

/* The largest eigenvalue of HIRES on its way, 1/s: it is real, negative, and largest at 10.7 s. */
static double fastest_decay(void) {
    static struct fixture fixture;
    const struct published *p = &published[HIRES];
    const struct variant reference = variant_of("reference", NULL);
    const struct stepper_settings settings = variant_settings(&reference, 1e-8, 1e-8);
    double q[8] = {0}, v[8], most = 0, t = 0;
    gsl_eigen_nonsymm_workspace *workspace = gsl_eigen_nonsymm_alloc(8);
    gsl_vector_complex *values = gsl_vector_complex_alloc(8);
    make_hires(&fixture);
    struct stepper *stepper = stepper_create(reference.method, &settings, &fixture.system);
    cr_assert(workspace && values && stepper, "no memory");
    memcpy(v, p->start, sizeof v);
    while (t < p->end) {
        cr_assert_eq(reference.method->advance(stepper, &t, p->end, q, v), 0);
        hires_jacobians(&fixture, t, q, v);
        gsl_matrix_view matrix = gsl_matrix_view_array(fixture.d, 8, 8);
        cr_assert_eq(gsl_eigen_nonsymm(&matrix.matrix, values, workspace), 0);
        for (size_t i = 0; i < 8; i++)
            most = fmax(most, -GSL_REAL(*gsl_vector_complex_ptr(values, i)));
    }
    reference.method->free(stepper);
    gsl_vector_complex_free(values);
    gsl_eigen_nonsymm_free(workspace);
    return most;
}

/* The largest x for which |R(-x)| <= 1, of an explicit method. */
static double real_stability_limit(const struct butcher_table *table) {
    double low = 1, high = 10;
    while (high - low > 1e-12) {
        const double middle = (low + high) / 2;
        *(cabs(butcher_stability(table, -middle)) <= 1 ? &low : &high) = middle;
    }
    return low;
}

/* Explicit with fixed steps, and R(z) is known. */
static int is_explicit(const struct stepper_method *method) {
    return method->table && !(method->capabilities & (STEPPER_ADAPTIVE | STEPPER_IMPLICIT));
}

/* With a tenth more steps than linear theory asks for, the error is that of the order; with a tenth
 * fewer HIRES ends in another world. At its limit rk4 is good to 3e-10, which one halving takes to
 * the rounding of 60 000 steps: its order shows in one halving and to a third. */
Test(published, explicit_methods_need_the_steps_of_linear_theory_on_hires) {
    const double decay = fastest_decay();
    cr_assert_float_eq(decay, 211.76, 0.05, "the fastest motion decays at %.2f 1/s", decay);
    for (int m = 0; stepper_methods[m]; m++) {
        if (!is_explicit(stepper_methods[m]))
            continue;
        const struct variant variant = variant_of(stepper_methods[m]->name, NULL);
        const double least =
            published[HIRES].end * decay / real_stability_limit(variant.method->table);
        const int stable = (int)(1.1 * least), order = variant.method->order;
        double y[YARDSTICK_SIZE_MAX], finer[YARDSTICK_SIZE_MAX];
        if (order < 4) {
            const struct order_seen seen = see_order(&variant, &hires, stable);
            cr_assert_str_empty(seen.fault, "%s: %s", variant.name, seen.fault);
        }
        solve(&published[HIRES], &variant, stable, 0, y, NULL);
        solve(&published[HIRES], &variant, 2 * stable, 0, finer, NULL);
        const double scd = digits(&published[HIRES], y, 0);
        const double gain = digits(&published[HIRES], finer, 0) - scd;
        cr_assert(scd > 2 && fabs(gain / log10(2) - order) <= 0.33,
                  "%s: %.2f digits at a stable step, and %.2f more at half of it", variant.name,
                  scd, gain);
        solve(&published[HIRES], &variant, (int)(0.9 * least), 0, y, NULL);
        cr_assert(!(digits(&published[HIRES], y, 0) > 0.5), "%s: has digits at an unstable step",
                  variant.name);
    }
}

static int keep_position(void *ctx, const struct model *model, double t, const double *rows) {
    (void)model, (void)t;
    *(double *)ctx = rows[2];
    return 0;
}

/* vdpol to t = 0.5, before its first jump, as a run. */
static double run_vdpol(const struct stepper_method *method, double step,
                        struct run_result *result) {
    struct scene *scene = fixture_scene(0.5, 10, step);
    double q = NAN;
    fixture_start = (struct fixture_start){.make = make_vdpol, .q = 2};
    cr_assert(scene, "no memory");
    const struct run_request request = {.stepper = method->name, .step = step};
    const struct settings settings = settings_of(scene, &request);
    simulate(scene, &settings, &(struct observer){keep_position, &q}, NULL, result);
    return q;
}

/* The fast motion decays at (q^2 - 1) / 1e-6, 3e6 at the start and less until the jump. What is
 * left is the slow one, q' = q / (1 - q^2) to 1e-6: log q - q^2 / 2 = t + log 2 - 2. With steps a
 * tenth too long a run overflows, and says so by name and at the first frame; but midpoint, where
 * R > 1 lets the fast motion grow to one side, drifts to where its step is stable, and is a
 * thousand times as wrong as it should be. */
Test(published, too_long_steps_fail_by_name_or_are_wrong) {
    int failures = 0;
    for (int m = 0; stepper_methods[m]; m++) {
        const struct stepper_method *method = stepper_methods[m];
        if (!is_explicit(method))
            continue;
        struct run_result good, bad;
        const double limit = real_stability_limit(method->table) / 3e6;
        const double q = run_vdpol(method, 0.95 * limit, &good);
        const double off = log(q) - q * q / 2 - 0.5 - log(2) + 2;
        cr_assert_eq(good.outcome, FINISHED, "%s: %s", method->name, good.reason);
        cr_assert(fabs(off) <= 2e-6, "%s: ends at %.9g, off by %.1e", method->name, q, off);
        const double r = run_vdpol(method, 1.1 * limit, &bad);
        const int wrong = fabs(log(r) - r * r / 2 - 0.5 - log(2) + 2) > 2e-3;
        const int failed = bad.outcome == NOT_FINITE && bad.reason[0] && bad.time == 0.1;
        cr_assert(failed || (wrong && bad.outcome == FINISHED), "%s: %s at t = %g s (%s)",
                  method->name, outcome_name(bad.outcome), bad.time, bad.reason);
        failures += failed;
    }
    cr_assert(failures > 0, "no run failed by name");
}
