/* The experiment of stability: growth of the real steps against closed forms, eigenvalues of a
 * chain that is solved by hand, ring-down against R(ih), searches that come to what was measured
 * before; and that wrong is a failure however finite it is. */
#include "closed_forms.h"
#include "experiments/stability/stability_limits.h"
#include "fixture.h"
#include "integrators/configurations.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- regions --- */

static double growth_at(const char *stepper, double complex z) {
    struct small_system small;
    small_dahlquist(&small, z);
    return measured_growth(stepper_find(stepper), 1e-2, &small, 1);
}

Test(stability, measured_growth_is_the_stability_function) {
    for (int i = 0; i < CLOSED_FORMS; i++)
        for (double x = -4; x <= 3; x += 0.25)
            for (double y = -3.5; y <= 3.5; y += 0.25) {
                const double expected = cabs(closed_forms[i].r(x + I * y));
                const double growth = growth_at(closed_forms[i].stepper, x + I * y);
                cr_assert(isinf(expected) ? isinf(growth)
                                          : fabs(growth - expected) <= 1e-9 * expected + 1e-12,
                          "%s at %g + %gi: grows by %.17g, and |R| is %.17g",
                          closed_forms[i].stepper, x, y, growth, expected);
            }
}

Test(stability, every_table_has_its_measured_growth) {
    for (int i = 0; stepper_methods[i]; i++)
        for (double x = -3.1; x < 2 && stepper_methods[i]->table && stepper_methods[i]->step;
             x += 0.7) {
            const double complex z = x + 0.9 * I;
            const double expected = cabs(butcher_stability(stepper_methods[i]->table, z));
            cr_assert_float_eq(growth_at(stepper_methods[i]->name, z), expected, 1e-9 * expected,
                               "%s at %g + 0.9i", stepper_methods[i]->name, x);
        }
}

/* What an error test of 0.01 leaves of it: decay decays, growth grows as it should. */
Test(stability, adaptive_methods_grow_as_the_equation_does) {
    for (int i = 0; stepper_methods[i]; i++) {
        const char *name = stepper_methods[i]->name;
        if (stepper_methods[i]->step)
            continue;
        cr_assert_lt(growth_at(name, -0.5 + 3 * I), 1, "%s", name);
        cr_assert_lt(growth_at(name, -4), 1, "%s", name);
        cr_assert_float_eq(growth_at(name, 0.5 + 2 * I), exp(0.5), 0.05, "%s: %g", name,
                           growth_at(name, 0.5 + 2 * I));
    }
}

/* --- the oscillator --- */

/* The longest stable omega h, by halves. */
static double oscillator_limit(const char *stepper, double zeta) {
    double low = 0.01, high = 20;
    for (int i = 0; i < 30; i++) {
        const double middle = (low + high) / 2;
        struct small_system small;
        small_oscillator(&small, zeta);
        *(measured_growth(stepper_find(stepper), 1e-2, &small, middle) <= 1 + 1e-9 ? &low : &high) =
            middle;
    }
    return low;
}

/* Modes s of s^2 + 2 zeta s + 1: |1 + h s| <= 1 for h <= 2 zeta; RK4 reaches 2 sqrt 2 on the
 * imaginary axis and 2.7853 on the real one (Hairer & Wanner, Solving ODEs II, section IV.2). */
Test(stability, oscillator_limits_are_the_known_ones) {
    static const struct {
        const char *stepper;
        double zeta, limit, within;
    } known[] = {
        {"euler", 0.1, 0.2, 1e-3},
        {"euler", 0.3, 0.6, 2e-3},
        {"euler", 0.7, 1.4, 5e-3},
        {"euler", 1.25, 1, 1e-3},
        {"midpoint", 1.25, 1, 1e-3},
        {"rk4", 0, 2.8284271247, 1e-4},
        {"rk4", 1.25, 2.7852935634 / 2, 1e-3},
        {"implicit-euler", 0, 20, 1e-3},
        {"implicit-euler", 0.5, 20, 1e-3},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const double limit = oscillator_limit(known[i].stepper, known[i].zeta);
        cr_assert_float_eq(limit, known[i].limit, known[i].within,
                           "%s, zeta %g: stable to %.6g, not to %.6g", known[i].stepper,
                           known[i].zeta, limit, known[i].limit);
    }
    cr_assert_lt(oscillator_limit("euler", 0), 0.02);
    cr_assert_lt(oscillator_limit("midpoint", 0), 0.04);
}

/* --- a chain by hand --- */

enum { LINKS = 6 };
static const double chain_k = 3, chain_m = 2;

static void still(const struct fixture *f, double t, const double *q, const double *v, double *a) {
    (void)t, (void)q, (void)v;
    memset(a, 0, (size_t)f->n * sizeof *a);
}

static void as_it_is(struct fixture *f, double t, const double *q, const double *v) {
    (void)f, (void)t, (void)q, (void)v;
}

/* Masses m between walls, springs k, dampers tau k: w_j = 2 sqrt(k/m) sin(j pi / 2 (n + 1)). */
static void make_chain(struct fixture *f, double tau) {
    fixture_begin(f, "equal masses", LINKS, 1, MATRIX_AVAILABLE);
    f->rate = still;
    f->jacobians = as_it_is;
    for (int i = 0; i < LINKS; i++)
        for (int j = 0; j < LINKS; j++) {
            const double k = i == j ? -2 * chain_k : abs(i - j) == 1 ? chain_k : 0;
            f->m[i * LINKS + j] = i == j ? chain_m : 0;
            f->k[i * LINKS + j] = k;
            f->d[i * LINKS + j] = tau * k;
        }
}

static double chain_frequency(int j) {
    return 2 * sqrt(chain_k / chain_m) * sin(j * M_PI / (2 * (LINKS + 1)));
}

static double nearest(const struct mode_rate *modes, double complex wanted,
                      double complex partner) {
    double least = INFINITY;
    for (int i = 0; i < 2 * LINKS; i++)
        least = fmin(least, cabs(modes[i].rate - wanted) + cabs(modes[i].partner - partner));
    return least;
}

Test(stability, modes_of_a_chain_are_the_written_out_ones) {
    static const double taus[] = {0, 0.1, 3};
    const double zero[LINKS] = {0};
    for (int k = 0; k < 3; k++) {
        static struct fixture chain;
        make_chain(&chain, taus[k]);
        struct mode_rate *modes = system_modes(&chain.system, 0, zero, zero);
        cr_assert(modes);
        for (int j = 1; j <= LINKS; j++) {
            const double w = chain_frequency(j), half = taus[k] * w * w / 2;
            const double complex root = csqrt(half * half - w * w);
            cr_assert_lt(nearest(modes, -half + root, -half - root), 1e-8, "mode %d at tau %g", j,
                         taus[k]);
            cr_assert_lt(nearest(modes, -half - root, -half + root), 1e-8, "mode %d at tau %g", j,
                         taus[k]);
        }
        free(modes);
    }
}

/* Euler's limit is tau where every mode swings, and 2 over the fastest rate where some creep;
 * Runge-Kutta 4's is 2 sqrt 2 over the highest frequency without damping. */
Test(stability, predicted_steps_of_a_chain_are_the_written_out_ones) {
    static struct fixture chain;
    const double zero[LINKS] = {0}, w = chain_frequency(LINKS);
    const struct stepper_method *euler = stepper_find("euler");
    make_chain(&chain, 0.1);
    struct mode_rate *modes = system_modes(&chain.system, 0, zero, zero);
    cr_assert_float_eq(stable_step(euler, modes, 2 * LINKS), 0.1, 1e-4);
    cr_assert(isinf(stable_step(stepper_find("implicit-euler"), modes, 2 * LINKS)));
    free(modes);
    make_chain(&chain, 3);
    modes = system_modes(&chain.system, 0, zero, zero);
    const double half = 3 * w * w / 2;
    cr_assert_float_eq(stable_step(euler, modes, 2 * LINKS), 2 / (half + sqrt(half * half - w * w)),
                       1e-6);
    free(modes);
    make_chain(&chain, 0);
    modes = system_modes(&chain.system, 0, zero, zero);
    cr_assert_float_eq(stable_step(stepper_find("rk4"), modes, 2 * LINKS), sqrt(8) / w, 1e-4);
    cr_assert_lt(stable_step(euler, modes, 2 * LINKS), 2e-3 / w * 2);
    free(modes);
}

/* What grows by itself is no fault of the method: only what it adds is. */
Test(stability, growth_of_the_equations_is_none_of_the_method) {
    const struct mode_rate modes[] = {{0.01, 0.01}, {-100, -100}};
    cr_assert_float_eq(stable_step(stepper_find("euler"), modes, 2), 0.02, 1e-6);
    cr_assert(isinf(stable_step(stepper_find("euler"), modes, 1)));
}

/* The stretch modes of a wisp, which decide, by the kernel's Jacobians: a chain whose last mass is
 * half, all springs and dampers in one ratio, is on Euler's limit at stretch_time. */
Test(stability, modes_of_a_wisp_come_from_its_jacobians) {
    struct scene *scene = LAB_LOAD("swing", "material.bending=none", "material.drag_rate=0");
    const double longest = stiffest_mode(scene).frequency;
    int count = 0;
    double fastest = 0;
    struct mode_rate *modes = scene_modes(scene, WISP_GENERALISED, &count);
    cr_assert(modes && count == 2 * 3 * 9, "%d modes", count);
    for (int i = 0; i < count; i++)
        fastest = fmax(fastest, cabs(modes[i].rate));
    cr_assert(fastest < longest && fastest > 0.98 * longest, "%g, and at most %g", fastest,
              longest);
    cr_assert_float_eq(stable_step(stepper_find("euler"), modes, count), 1.2e-4, 1e-6);
    free(modes);
}

static int keep_history(struct stepper *stepper, unsigned lanes) {
    (void)stepper, (void)lanes;
    return 0;
}

/* A method that has a history is known from many steps only; Runge-Kutta 4 looked at so is itself.
 */
Test(stability, a_train_of_steps_grows_and_rings_as_one_step_does) {
    struct stepper_method other = *stepper_find("rk4");
    other.reset = keep_history;
    for (double x = -3; x <= 1; x += 0.35)
        for (double y = 0; y <= 3; y += 0.35) {
            struct small_system small;
            small_dahlquist(&small, x + I * y);
            const double expected = growth_at("rk4", x + I * y);
            cr_assert_float_eq(measured_growth(&other, 1e-2, &small, 1), expected,
                               1e-9 * expected + 1e-12, "at %g + %gi", x, y);
        }
    for (double h = 0.1; h < 1.9; h += 0.3) {
        const struct ring_down one = measured_ring_down(stepper_find("rk4"), 1e-2, h),
                               train = measured_ring_down(&other, 1e-2, h);
        cr_assert(fabs(one.damping - train.damping) < 1e-10 &&
                      fabs(one.frequency_shift - train.frequency_shift) < 1e-10,
                  "h = %g: %g and %g", h, one.damping, train.damping);
    }
}

/* --- a method that is none of Runge and Kutta's --- */

static struct stepper *symplectic_create(const struct stepper_settings *settings,
                                         struct system *system) {
    (void)settings, (void)system;
    return calloc(1, sizeof(struct stepper));
}

static int symplectic_step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct system *system = stepper->system;
    double a[2];
    const int code = system_acceleration(system, t, q, v, a);
    for (int i = 0; i < system->size && !code; i++) {
        v[i] += h * a[i];
        q[i] += h * v[i];
    }
    return code;
}

static void symplectic_free(struct stepper *stepper) {
    free(stepper);
}

/* (q, h v) is multiplied by ( 1 + k h^2, 1 + d h; k h^2, 1 + d h ): its determinant is 1 + d h. */
static double complex symplectic_amplification(double complex z, double complex partner) {
    const double complex d = z + partner, k = -z * partner;
    const double complex half = 1 + (k + d) / 2, root = csqrt(half * half - 1 - d);
    return cabs(half + root) > cabs(half - root) ? half + root : half - root;
}

static const struct stepper_method symplectic = {.name = "symplectic",
                                                 .order = 1,
                                                 .amplification = symplectic_amplification,
                                                 .create = symplectic_create,
                                                 .step = symplectic_step,
                                                 .free = symplectic_free};

/* Its own amplification predicts what its steps do, swinging and creeping. */
Test(stability, a_method_has_its_own_amplification) {
    for (double zeta = 0; zeta <= 2; zeta += 0.13)
        for (double h = 0.1; h <= 3; h += 0.17) {
            const double complex root = csqrt(zeta * zeta - 1);
            const double predicted =
                cabs(stepper_amplification(&symplectic, h * (-zeta + root), h * (-zeta - root)));
            struct small_system small;
            small_oscillator(&small, zeta);
            const double growth = measured_growth(&symplectic, 1e-2, &small, h);
            cr_assert_float_eq(growth, predicted, 1e-7, "h = %g, zeta = %g: %.9g, not %.9g", h,
                               zeta, growth, predicted);
        }
}

/* Of a Runge-Kutta method it is the larger one of R on both rates. */
Test(stability, amplification_is_of_the_faster_growing_rate) {
    const struct stepper_method *rk4 = stepper_find("rk4");
    cr_assert(stepper_amplification(rk4, -0.1, -3) == butcher_stability(rk4->table, -3));
    cr_assert(stepper_amplification(rk4, -3, -0.1) == butcher_stability(rk4->table, -3));
    cr_assert(stepper_amplification(rk4, 2 * I, -2 * I) == butcher_stability(rk4->table, 2 * I));
}

/* Jury's criterion on that matrix: h^2 w^2 + 2 h tau w^2 < 4. */
Test(stability, steps_are_predicted_by_a_methods_own_amplification) {
    static const double taus[] = {0, 0.1, 3};
    static struct fixture chain;
    const double zero[LINKS] = {0}, w = chain_frequency(LINKS);
    for (int k = 0; k < 3; k++) {
        const double tau = taus[k], limit = -tau + sqrt(tau * tau + 4 / (w * w));
        make_chain(&chain, tau);
        struct mode_rate *modes = system_modes(&chain.system, 0, zero, zero);
        cr_assert_float_eq(stable_step(&symplectic, modes, 2 * LINKS), limit, 1e-3 * limit,
                           "tau = %g: %g, not %g", tau, stable_step(&symplectic, modes, 2 * LINKS),
                           limit);
        free(modes);
    }
}

/* --- ring-down --- */

Test(stability, ring_down_is_the_stability_function_on_the_axis) {
    for (int i = 0; i < CLOSED_FORMS; i++)
        for (double h = 0.05; h < 1.9; h *= 1.4) {
            const double complex r = closed_forms[i].r(I * h);
            const double damping = -log(cabs(r)) / cabs(clog(r)), shift = carg(r) / h - 1;
            const struct ring_down ring =
                measured_ring_down(stepper_find(closed_forms[i].stepper), 1e-2, h);
            cr_assert(fabs(ring.damping - damping) <= 1e-10 &&
                          fabs(ring.frequency_shift - shift) <= 1e-10,
                      "%s, h = %g: damping %.12g, shift %.12g; by R %.12g, %.12g",
                      closed_forms[i].stepper, h, ring.damping, ring.frequency_shift, damping,
                      shift);
            cr_assert_float_eq(ring.steps_per_period, 2 * M_PI / h, 1e-9);
        }
}

/* Of critical: a method that loses as much as a damper of zeta does has that zeta. */
Test(stability, ring_down_of_adaptive_methods_follows_the_tolerance) {
    for (int i = 0; stepper_methods[i]; i++) {
        if (stepper_methods[i]->step)
            continue;
        const struct ring_down loose = measured_ring_down(stepper_methods[i], 1e-3, 0),
                               tight = measured_ring_down(stepper_methods[i], 1e-8, 0);
        cr_assert_lt(fabs(tight.damping), 1e-6, "%s", stepper_methods[i]->name);
        cr_assert_lt(fabs(tight.damping), 0.1 * fabs(loose.damping), "%s",
                     stepper_methods[i]->name);
        cr_assert_gt(tight.steps_per_period, loose.steps_per_period, "%s",
                     stepper_methods[i]->name);
    }
}

/* --- the search --- */

Test(stability, brackets_close_on_every_threshold) {
    for (int threshold = 0; threshold < 60; threshold++)
        for (int start = 0; start < 60; start += 7) {
            struct bracket b = bracket_begin(start, 0);
            int tries = 1;
            while (bracket_take(&b, b.at >= threshold, 8, 1) && tries < 40)
                tries++;
            cr_assert(b.reached == threshold && (threshold == 0 || b.missed == threshold - 1),
                      "from %d: reached %d, missed %d, not %d", start, b.reached, b.missed,
                      threshold);
        }
}

Test(stability, places_divide_the_interval) {
    for (int place = 0; place < 200; place++) {
        const double step = place_step(0.1, 24, place), pieces = 0.1 / step;
        cr_assert_float_eq(pieces, round(pieces), 1e-9);
        const int back = step_place(0.1, 24, step);
        cr_assert(back <= place && place_step(0.1, 24, back) == step, "place %d: %d", place, back);
        cr_assert(back == 0 || place_step(0.1, 24, back - 1) > step);
    }
}

/* --- the program --- */

struct limit_row {
    double step, rate, predicted, unstable, time, error, near, mm, in_order;
    char scene[64], treatment[32], stepper[32], kind[32];
};
enum { ROWS_MAX = 64 };

static char *folder;

static void set_up(void) {
    folder = folder_make();
    gnuplot_stub_quiet();
}

static char *read_table(const char *name) {
    char *text = file_read(printed("%s/stability/%s.tsv", folder, name));
    cr_assert(text, "no table %s", name);
    return text;
}

static void stated(void) {
    statements_must_be_whole(printed("%s/stability", folder));
}

static int read_limits(struct limit_row *row) {
    struct text_table text;
    table_must_be_read(&text, folder, "stability/largest-step");
    const int count = text.row_count;
    cr_assert_leq(count, ROWS_MAX);
    for (int i = 0; i < count; i++) {
        struct limit_row *r = &row[i];
        *r = (struct limit_row){.step = text_table_number(&text, i, "step"),
                                .rate = text_table_number(&text, i, "rate"),
                                .predicted = text_table_number(&text, i, "predicted"),
                                .unstable = text_table_number(&text, i, "unstable_step"),
                                .time = text_table_number(&text, i, "time"),
                                .error = text_table_number(&text, i, "error"),
                                .near = text_table_number(&text, i, "near_step"),
                                .mm = text_table_number(&text, i, "mm_step"),
                                .in_order = text_table_number(&text, i, "order_step")};
        snprintf(r->scene, sizeof r->scene, "%s", text_table_cell(&text, i, "scene"));
        snprintf(r->treatment, sizeof r->treatment, "%s", text_table_cell(&text, i, "treatment"));
        snprintf(r->stepper, sizeof r->stepper, "%s", text_table_cell(&text, i, "stepper"));
        snprintf(r->kind, sizeof r->kind, "%s", text_table_cell(&text, i, "kind"));
    }
    return count;
}

static double error_at(const struct scene *scene, const struct limit_row *row, double step,
                       const struct lab_run *tight, enum outcome *outcome) {
    const struct run_request request = {
        .stepper = row->stepper,
        .treatment = row->treatment,
        .linear = strncmp(row->stepper, "implicit", 8) == 0 ? "direct" : NULL,
        .step = step};
    struct lab_run run;
    lab_run(scene, &request, &run);
    *outcome = run.result.outcome;
    return *outcome == FINISHED ? lab_distance(&run, tight, 0, 2).rms : NAN;
}

/* The step of a row is stable, the next is not, in the way that it says; both again here. The
 * shorter the scene, the longer the steps whose growth does not show. */
static void check_row(const struct scene *scene, const struct limit_row *row, double within) {
    struct lab_run tight;
    enum outcome outcome;
    lab_run(scene, &(struct run_request){.stepper = "reference", .treatment = row->treatment},
            &tight);
    const double error = error_at(scene, row, row->step, &tight, &outcome);
    cr_assert(outcome == FINISHED && fabs(error - row->error) <= 1e-6 * error, "%s: %g, not %g",
              row->stepper, error, row->error);
    error_at(scene, row, row->unstable, &tight, &outcome);
    cr_assert_neq(outcome, FINISHED, "%s at %g s", row->stepper, row->unstable);
    cr_assert_str_eq(outcome_name(outcome), row->kind, "%s at %g s", row->stepper, row->unstable);
    cr_assert(row->unstable <= 1.13 * row->step && row->unstable > row->step, "%s: %g and %g",
              row->stepper, row->step, row->unstable);
    cr_assert(row->step > 0.85 * row->predicted && row->step < (1 + within) * row->predicted,
              "%s: %g, and predicted %g", row->stepper, row->step, row->predicted);
    cr_assert(row->time > 0 && row->time <= scene->duration, "%s: at %g s", row->stepper,
              row->time);
}

/* Measured on `swing`: Euler at 9000 Hz is right, at 8000 finite and wrong;
 * Runge-Kutta 4 at 4000 Hz is right, at 3000 stretches too far after 0.04 s, and would be wrong by
 * decimetres. */
Test(stability, swing_fails_as_it_was_measured_before, .init = set_up) {
    static const char *const known[] = {
        "euler\t0.000111111111\t9000\tstable\tnan\tyes", "euler\t0.000125\t8000\tdiverged\t",
        "rk4\t0.00025\t4000\tstable\tnan\tyes",
        "rk4\t0.000333333333\t3000\tdiverged\t0.0386666667\tyes\t2.3"};
    static struct limit_row row[ROWS_MAX];
    struct finished *f = WORKS("experiment", "stability", "--quick", "--scene", "swing",
                               "--stepper", "euler", "--stepper", "rk4", "--out", folder);
    cr_assert(strstr(f->out,
                     "On swing explicit methods fail beyond steps of 0.119 ms (euler) to "
                     "0.309 ms (rk4), and rk4 stays within a millimetre with steps of 0.309 "
                     "ms."),
              "%s", f->out);
    char *text = read_table("failures");
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        cr_assert(strstr(text, known[i]), "not '%s' in %s", known[i], text);
    struct scene *scene = LAB_LOAD("swing", "duration=0.5");
    const int rows = read_limits(row);
    cr_assert_eq(rows, 2, "%d rows", rows);
    for (int i = 0; i < rows; i++)
        check_row(scene, &row[i], 0.03);
}

#define SCENE                                                                                      \
    "name = \"short\"; duration = 0.03333333333333333; frame_rate = 30.0; gravity = [0.0, -9.81, " \
    "0.0];\n"                                                                                      \
    "material = { hair_count = 1000.0; hair_density = 5.7e-6; };\n"                                \
    "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.30;\n"            \
    "            nodes = 5; } );\n"                                                                \
    "run = { step = 1.0e-4; rtol = 1.0e-6; atol = 1.0e-9; };\n"

/* Stable is not good: what a step errs is a column of its own, and so is whether the method's order
 * still holds. In one frame an instability has no time to be seen in a length, and implicit Euler
 * is stable at every step. */
Test(stability, how_wrong_a_stable_step_is_has_columns_of_its_own, .init = set_up) {
    static struct limit_row row[ROWS_MAX];
    int order_lost = 0;
    const char *const path = file_write(folder, "short.cfg", SCENE);
    WORKS("experiment", "stability", "--quick", "--scene", path, "--stepper", "implicit-euler",
          "--stepper", "euler", "--stepper", "rk4", "--out", folder);
    struct scene *scene = lab_load(path, NULL, 0);
    struct lab_run tight;
    lab_run(scene, &(struct run_request){.stepper = "reference"}, &tight);
    const int rows = read_limits(row);
    cr_assert_eq(rows, 3, "%d rows", rows);
    for (int i = 0; i < rows; i++) {
        enum outcome outcome;
        cr_expect(row[i].step * 1.00001 > row[i].near && row[i].near >= row[i].mm, "%s: %g, %g, %g",
                  row[i].stepper, row[i].step, row[i].near, row[i].mm);
        const double error = error_at(scene, &row[i], row[i].mm, &tight, &outcome);
        cr_expect(error <= 1e-3, "%s: %g", row[i].stepper, error);
        order_lost += row[i].in_order < 0.999 * row[i].step;
    }
    cr_expect_gt(order_lost, 0, "a step that loses its order counts as unstable");
    for (int i = 0; i < rows; i++)
        if (strcmp(row[i].stepper, "implicit-euler") == 0)
            cr_expect(strcmp(row[i].kind, "none") == 0 && row[i].mm < row[i].step);
}

/* The whole of it: every stepper is in the tables, and nothing is left to do the second time. */
Test(stability, slow_quick_run_has_every_table_and_figure) {
    static const char *const figures[] = {"regions.svg", "oscillator.svg", "limits.svg",
                                          "damping.svg"};
    folder = folder_make();
    struct finished *f = WORKS("experiment", "stability", "--quick", "--out", folder);
    cr_assert(strstr(f->out, "left out of --quick"), "it does not say what it leaves out");
    stated();
    for (int k = 0; k < 4; k++)
        cr_assert_eq(count_files(folder, figures[k]), 1, "no figure %s", figures[k]);
    char *regions = read_table("regions"), *largest = read_table("largest-step");
    for (int i = 0; stepper_methods[i]; i++)
        cr_assert(configuration_of(stepper_methods[i]).kind == CONFIGURATION_COSTLY ||
                      (strstr(regions, stepper_methods[i]->name) &&
                       strstr(largest, stepper_methods[i]->name)),
                  "%s is missing", stepper_methods[i]->name);
    gnuplot_stub_quiet();
    f = PROGRAM(NULL, "experiment", "stability", "--quick", "--out", folder);
    cr_assert(strstr(f->out, " 0 of them new"), "a complete search does more: %s", f->out);
}

Test(stability, without_a_reference_solution_rows_say_why, .init = set_up) {
    WORKS("experiment", "stability", "--quick", "--scene", "swing", "--stepper", "rk4", "--out",
          folder, "--time-limit", "0.0001");
    char *text = read_table("largest-step");
    cr_assert(strstr(text, "no reference solution: out of time"), "%s", text);
    stated();
}

Test(stability, is_of_wisps, .init = set_up) {
    FAILS(1, "of wisps", "experiment", "stability", "--scene", "circle", "--out", folder);
}

/* --- what is said of a trial --- */

static void trial_says(const struct cell *cell, const struct trial *trial, const char *verdict,
                       const char *says) {
    struct statements statements;
    struct text_table rows;
    char reason[REASON_SIZE];
    cr_assert_eq(statements_open(&statements, folder, NULL, NULL, reason), 0, "%s", reason);
    limits_state_trial(&statements, cell, trial, ANSWERS_FAILURES);
    cr_assert_eq(statements_close(&statements, 0, reason), 0, "%s", reason);
    statements_must_be_read(&rows, folder);
    const char *sentence = text_table_cell(&rows, 0, "statement");
    cr_assert(strstr(sentence, says), "'%s' does not say '%s'", sentence, says);
    cr_assert_str_eq(text_table_cell(&rows, 0, "verdict"), verdict, "%s", sentence);
    cr_assert_str_eq(text_table_cell(&rows, 0, "question"), "failures");
}

/* The sentence and its verdict follow what the runs have shown. */
Test(stability, a_trial_is_told_as_it_went, .init = set_up) {
    const struct configuration euler = {.name = "euler", .method = stepper_find("euler")},
                               cvode = {.name = "cvode", .method = stepper_find("cvode")};
    struct scene *scene = lab_load("swing", NULL, 0);
    const struct cell cell = {.scene = scene,
                              .treatment = WISP_GENERALISED,
                              .subject = "swing",
                              .name = "swing generalised"};
    struct trial fixed = {.configuration = &euler,
                          .place = {.missed = 100, .reached = 101},
                          .missed = {NAN, DIVERGED, 0.25},
                          .aims = {{.place.reached = -1}, {.place.reached = -1}}};
    trial_says(&cell, &fixed, "holds", "euler is stable on swing (generalised) with steps up to ");
    trial_says(&cell, &fixed, "holds",
               "the next longer one tried ends 'diverged' at 0.25 s; it is within 1 mm at none "
               "that was tried.");
    fixed.aims[NEAR].place.reached = 101;
    fixed.aims[MILLIMETRE].place.reached = 125;
    trial_says(&cell, &fixed, "holds",
               "; with all of them it is within 5 % of the wisp's length, and within 1 mm up to "
               "0.901 ms.");
    fixed.aims[NEAR].place.reached = 103;
    trial_says(&cell, &fixed, "holds", "; it is within 5 % of the wisp's length up to ");
    fixed.aims[NEAR].place.reached = 125;
    trial_says(&cell, &fixed, "holds", "at 0.25 s; it is within 1 mm up to 0.901 ms.");
    fixed.aims[NEAR].place.reached = fixed.aims[MILLIMETRE].place.reached = 101;
    trial_says(&cell, &fixed, "holds", "at 0.25 s; with all of them it is within 1 mm.");
    fixed.place.missed = -1;
    trial_says(&cell, &fixed, "holds", "is stable on swing (generalised) at every step tried");
    fixed.place = (struct bracket){.missed = 100, .reached = -1};
    snprintf(fixed.note, sizeof fixed.note, "it takes too long");
    trial_says(&cell, &fixed, "not reached", "that was tried on swing (generalised) is stable: it");
    fixed.place.missed = -1;
    trial_says(&cell, &fixed, "not reached", "No step of euler was tried");
    struct trial adaptive = {.configuration = &cvode,
                             .place = {.missed = -1, .reached = -1},
                             .cost = {.outcome = FINISHED, .steps = 1000 * scene->duration}};
    trial_says(&cell, &adaptive, "holds",
               "cvode chooses its steps on swing (generalised), 1 ms in the mean at rtol 0.001, "
               "and has no longest one.");
    adaptive.cost.outcome = OUT_OF_TIME;
    trial_says(&cell, &adaptive, "not reached", "did not reach its end: out of time.");
}
