/* Runs with rigid segments: a double pendulum, the limit of stiff springs, lengths through steps,
 * contacts and subdivisions, orders of methods, energy, and what is refused. */
#include "base/vector.h"
#include "fixture.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RIGID "material={ stretch = \"rigid\"; }"

/* --- a double pendulum --- */

/* Two nodes of masses m and m/2 on lines of length l, angles from the vertical: Lagrange's
 * equations, solved for the angles' accelerations. */
static int pendulum(double t, const double y[], double rate[], void *gravity_over_length) {
    (void)t;
    const double g = *(const double *)gravity_over_length, second = 1. / 3; /* of both masses */
    const double difference = y[0] - y[1], c = cos(difference), s = sin(difference);
    const double b0 = -second * s * y[3] * y[3] - g * sin(y[0]);
    const double b1 = s * y[2] * y[2] - g * sin(y[1]);
    /* a0 + second c a1 = b0, c a0 + a1 = b1 */
    const double determinant = 1 - second * c * c;
    rate[0] = y[2];
    rate[1] = y[3];
    rate[2] = (b0 - second * c * b1) / determinant;
    rate[3] = (b1 - c * b0) / determinant;
    return 0;
}

Test(rigid_runs, a_wisp_of_two_free_nodes_is_a_double_pendulum) {
    struct scene *scene =
        LAB_LOAD("swing", "material={ stretch=\"rigid\"; bending=\"none\"; drag_rate=0; }",
                 "wisps.[0].nodes=4", "frame_rate=50.0");
    const double l = wisp_spacing(&scene->wisps[0]);
    double gravity_over_length = 9.81 / l, y[4] = {M_PI / 2, M_PI / 2, 0, 0}, t = 0;
    gsl_odeiv2_system equations = {pendulum, NULL, 4, &gravity_over_length};
    gsl_odeiv2_driver *driver =
        gsl_odeiv2_driver_alloc_y_new(&equations, gsl_odeiv2_step_rk8pd, 1e-6, 1e-15, 1e-14);
    const struct run_request request = {
        .stepper = "reference", .rtol = 1e-14, .atol = 1e-16, .treatment = "generalised"};
    struct lab_run run;
    double worst = 0;
    lab_finish(scene, &request, &run);
    for (int f = 0; f < run.frames; f++) {
        cr_assert(run.t[f] == 0 || gsl_odeiv2_driver_apply(driver, &t, run.t[f], y) == 0);
        const double *row = run.row + (f * run.rows + 2) * run.columns + 2;
        const double x[2] = {l + l * sin(y[0]), l + l * (sin(y[0]) + sin(y[1]))},
                     z[2] = {-l * cos(y[0]), -l * (cos(y[0]) + cos(y[1]))};
        for (int i = 0; i < 2; i++, row += run.columns)
            worst = fmax(worst, hypot(row[0] - x[i], row[1] - z[i]));
    }
    cr_log_info("double pendulum: %.2e m", worst);
    cr_assert_leq(worst, 1e-12, "%.2e m from the double pendulum", worst);
    gsl_odeiv2_driver_free(driver);
}

/* --- the limit of stiff springs --- */

/* In each of the treatments with an envelope, and without: the distance falls as 1 / EA at a fixed
 * damping ratio of the stiffest mode. */
static void check_limit(const char *name, int treatment) {
    struct scene *rigid = LAB_LOAD(name, RIGID, "duration=0.2");
    const struct run_request request = {.stepper = "reference",
                                        .treatment = treatment_names[treatment]};
    const double stiffness[] = {3e3, 1.2e4, 4.8e4};
    double distance[3];
    struct lab_run limit;
    lab_run(rigid, &request, &limit);
    for (int k = 0; k < 3; k++) {
        const struct wisp *wisp = &rigid->wisps[0];
        const double m = wisp_node_mass(wisp, 2) + wisp->samples * wisp_sample_mass(wisp, 2);
        const double omega = 2 * sqrt(stiffness[k] / wisp_spacing(wisp) / m);
        const char *const ea = printed("material.stretch_stiffness=%.17e", stiffness[k]);
        const char *const tau = printed("material.stretch_time=%.17e", 2 * 0.5 / omega);
        distance[k] = lab_error(LAB_LOAD(name, ea, tau, "duration=0.2"), &request, &limit);
    }
    for (int k = 0; k < 2; k++) {
        const double slope = log(distance[k + 1] / distance[k]) / log(4);
        cr_log_info("%s, %s: %.3e m at EA %g: slope %.3f", name, treatment_names[treatment],
                    distance[k], stiffness[k], slope);
        cr_expect(fabs(slope + 1) < 0.05, "%s, %s: distances %.3e, %.3e: slope %.3f", name,
                  treatment_names[treatment], distance[k], distance[k + 1], slope);
    }
}

Test(rigid_runs, stiff_springs_come_near_rigid_segments, .timeout = 120) {
    check_limit("swing", WISP_GENERALISED);
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        check_limit("swing-envelope", treatment);
}

/* What this is for: few and cheap steps, and hair that is real. Runge-Kutta 4 at 300 Hz is within
 * 0.02 mm of its own reference solution, and of real hair's that may stretch (EA 16 800 N). */
Test(rigid_runs, a_few_steps_are_near_real_hair, .timeout = 60) {
    const struct run_request request = {.stepper = "rk4", .step = 1 / 300.},
                             tight = {.stepper = "reference"};
    struct scene *rigid = LAB_LOAD("swing", RIGID),
                 *real = LAB_LOAD("swing", "material.stretch_stiffness=16800");
    struct lab_run run, own, other;
    lab_run(rigid, &request, &run);
    lab_run(rigid, &tight, &own);
    lab_run(real, &tight, &other);
    const double error = lab_distance(&run, &own, 0, 2).rms,
                 model = lab_distance(&run, &other, 0, 2).rms;
    cr_log_info("%.4f mm from its own reference, %.4f mm from real hair", 1e3 * error, 1e3 * model);
    cr_expect(error < 2e-5 && model < 2e-5, "%g and %g m", error, model);
}

/* --- lengths --- */

/* By how much the segments of any frame are off, of their length; nodes in rows follow each other.
 */
static double off_length(const struct scene *scene, const struct lab_run *run) {
    double most = 0;
    for (int f = 0; f < run->frames; f++)
        for (int i = 1; i < run->rows; i++) {
            const double *a = run->row + (f * run->rows + i - 1) * run->columns,
                         *b = a + run->columns;
            if (b[1] < 2)
                continue;
            const double d[3] = {b[2] - a[2], b[3] - a[3], b[4] - a[4]};
            const struct wisp *wisp = &scene->wisps[(int)b[0] < scene->wisp_count ? (int)b[0] : 0];
            most = fmax(most, fabs(vector_length(d) / wisp_spacing(wisp) - 1));
        }
    return most;
}

/* Rounding of places in space, beside the model's 1e-13. */
static const double length_tolerance = 1.2e-13;

Test(rigid_runs, methods_keep_lengths_in_all_treatments, .timeout = 60) {
    struct scene *scene = LAB_LOAD("swing-envelope", RIGID, "duration=0.3", "run.project=true");
    for (int m = 0; stepper_methods[m]; m++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            const struct stepper_method *method = stepper_methods[m];
            const int adaptive = (method->capabilities & STEPPER_ADAPTIVE) != 0;
            const struct run_request request = {.stepper = method->name,
                                                .treatment = treatment_names[treatment],
                                                .step = adaptive ? 0 : 1e-3,
                                                .rtol = adaptive ? 1e-6 : 0,
                                                .atol = adaptive ? 1e-8 : 0};
            struct settings settings;
            struct lab_run run;
            char reason[REASON_SIZE];
            if (settings_resolve(scene, &request, &settings, reason)) {
                cr_expect(!(method->capabilities & STEPPER_JACOBIAN_FREE) &&
                              method->capabilities & STEPPER_IMPLICIT &&
                              strstr(reason, method->name) && strstr(reason, "rigid"),
                          "%s", reason);
                continue;
            }
            lab_finish(scene, &request, &run);
            cr_expect_leq(off_length(scene, &run), length_tolerance, "%s, %s: off by %.2e",
                          method->name, treatment_names[treatment], off_length(scene, &run));
            cr_expect_geq(run.result.counters.projections, run.result.counters.steps, "%s",
                          method->name);
        }
}

/* Without a projection of each step lengths drift, with the order of the method. */
Test(rigid_runs, lengths_that_are_not_kept_drift_with_the_order) {
    struct scene *scene = LAB_LOAD("swing", RIGID, "duration=0.2", "run.project=false");
    double off[3];
    for (int k = 0; k < 3; k++) {
        const struct run_request request = {.stepper = "rk4", .step = 1 / (300 * pow(2, k))};
        struct lab_run run;
        lab_run(scene, &request, &run);
        cr_assert_eq(run.result.counters.projections, 0);
        off[k] = off_length(scene, &run);
    }
    for (int k = 0; k < 2; k++)
        cr_expect(off[k + 1] > 1e-13 && log2(off[k] / off[k + 1]) > 3.5, "off by %.2e, then %.2e",
                  off[k], off[k + 1]);
}

/* --- orders --- */

static void check_order(const struct scene *scene, const char *stepper, double order,
                        double coarse) {
    const struct run_request tight = {
        .stepper = "reference", .treatment = "generalised", .rtol = 1e-13, .atol = 1e-14};
    struct lab_run exact;
    double error[3];
    lab_run(scene, &tight, &exact);
    for (int k = 0; k < 3; k++) {
        const struct run_request request = {
            .stepper = stepper, .treatment = "generalised", .step = coarse / pow(2, k)};
        error[k] = lab_error(scene, &request, &exact);
    }
    lab_check_order(printed("%s, %s", scene->name, stepper), error, order, 0.25, 0.25);
}

Test(rigid_runs, methods_have_their_order, .timeout = 120) {
    struct scene *scenes[] = {LAB_LOAD("swing", RIGID, "duration=0.2", "frame_rate=20.0"),
                              LAB_LOAD("swing-envelope", RIGID, "duration=0.2", "frame_rate=20.0"),
                              LAB_LOAD("swing-shaken", RIGID, "material.bending=skip",
                                       "duration=0.5", "frame_rate=20.0")};
    for (int s = 0; s < 3; s++) {
        check_order(scenes[s], "euler", 1, 1. / 9600);
        check_order(scenes[s], "symplectic-euler", 1, 1. / 9600);
        check_order(scenes[s], "drift-kick", 1, 1. / 9600);
        check_order(scenes[s], "midpoint", 2, 1. / 2400);
        check_order(scenes[s], "rk4", 4, 1. / 1200);
    }
}

/* The head's acceleration jumps at knots, which are the ends of steps: each step has it from its
 * own side. Of a wrong one projections would mend the most. */
Test(rigid_runs, knots_of_the_head_leave_the_order) {
    struct scene *scene = LAB_LOAD("swing-shaken", RIGID, "material.bending=skip", "duration=0.5",
                                   "frame_rate=20.0", "run.project=false");
    check_order(scene, "midpoint", 2, 1. / 2400);
    check_order(scene, "rk4", 4, 1. / 1200);
}

/* --- contacts and subdivision --- */

struct film {
    const struct scene *scene;
    double off;       /* largest of any frame */
    int frames, rows; /* of the last */
};

static int look(void *ctx, const struct model *model, double t, const double *rows) {
    struct film *film = ctx;
    struct lab_run run = {.frames = 1, .rows = model->row_count, .columns = model->column_count};
    double *copy = test_room((size_t)(run.rows * run.columns) * sizeof *copy);
    memcpy(copy, rows, (size_t)(run.rows * run.columns) * sizeof *copy);
    run.row = copy;
    film->off = fmax(film->off, off_length(film->scene, &run));
    film->frames++;
    film->rows = run.rows;
    (void)t;
    return 0;
}

static struct run_result watch_lengths(const struct scene *scene, const char *stepper,
                                       int treatment, double step, int threads, struct film *film) {
    const struct run_request request = {.stepper = stepper,
                                        .treatment = treatment_names[treatment],
                                        .step = step,
                                        .threads = threads};
    *film = (struct film){.scene = scene};
    return run_finished(scene, &request, look, film);
}

/* Frames come after a tick's projection, here without any of a step: what contacts stretch is put
 * back where they did. */
Test(rigid_runs, contacts_and_subdivisions_keep_lengths, .timeout = 120) {
    static const char *const names[] = {"interactions", "sphere", "subdivision", "shake"};
    static const char *const durations[] = {"duration=0.5", "duration=0.6", "duration=0.7",
                                            "duration=0.1"};
    for (int s = 0; s < 4; s++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            struct scene *scene =
                LAB_LOAD(names[s], RIGID, durations[s], "frame_rate=90.0", "run.project=true");
            struct film film;
            const struct run_result r = watch_lengths(scene, "rk4", treatment, 1. / 1800, 2, &film);
            cr_expect_leq(film.off, 2e-13, "%s, %s: off by %.2e", names[s],
                          treatment_names[treatment], film.off);
            cr_expect_gt(r.counters.wisp_contacts + r.counters.body_contacts, 0, "%s, %s", names[s],
                         treatment_names[treatment]);
            cr_expect(s != 2 || r.counters.splits > 0, "nothing splits");
        }
}

/* Without a projection of each step a tick's still puts back the wisps that it changed, and no
 * others: one that is far from all others moves to the bit as if it were alone. */
Test(rigid_runs, a_tick_puts_back_the_wisps_that_it_changed) {
#define FAR "{ root = [5.0, 5.0, 5.0]; direction = [1.0, 0.2, 0.1]; length = 0.2; nodes = 8; }"
    static const char *const wisps[] = {"wisps=(" WISP_A "," WISP_B "," FAR ")", "wisps=(" FAR ")"};
    const struct run_request request = {.stepper = "rk4", .step = 1. / 300};
    struct lab_run run[2];
    for (int k = 0; k < 2; k++) {
        struct scene *scene = LAB_LOAD("interactions", RIGID, "duration=0.4", "run.project=false",
                                       "frame_rate=30.0", wisps[k]);
        lab_finish(scene, &request, &run[k]);
        cr_expect_gt(off_length(scene, &run[k]), 1e-12, "nothing drifts");
    }
    cr_expect_gt(run[0].result.counters.wisp_contacts, 0, "nothing touches");
    cr_expect_gt(run[0].result.counters.projections, 0, "no tick projects");
    cr_expect_eq(run[1].result.counters.projections, 0, "a wisp alone is projected");
    for (int f = 0; f < run[1].frames; f++)
        for (int i = 0; i < 8; i++)
            cr_expect_eq(memcmp(run[0].row + (f * 24 + 16 + i) * run[0].columns + 1,
                                run[1].row + (f * 8 + i) * run[1].columns + 1,
                                (size_t)(run[1].columns - 1) * sizeof(double)),
                         0, "frame %d, node %d: other bits in company", f, i);
}

/* --- bits --- */

/* Wisps of one scene in three orders of the file and on 1, 2 and 3 threads, with contacts between
 * them; by the entry's root, which none shares. */
Test(rigid_runs, bits_do_not_depend_on_order_and_threads, .timeout = 60) {
    static const char *const orders[] = {
        "wisps=(" WISP_A "," WISP_B "," WISP_C "," WISP_D "," WISP_E ")",
        "wisps=(" WISP_E "," WISP_D "," WISP_C "," WISP_B "," WISP_A ")",
        "wisps=(" WISP_C "," WISP_A "," WISP_E "," WISP_B "," WISP_D ")"};
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct lab_run first = {0};
        for (int order = 0; order < 3; order++)
            for (int threads = 1; threads <= 3; threads++) {
                struct scene *scene = LAB_LOAD("interactions", RIGID, "duration=0.25",
                                               "frame_rate=20.0", orders[order]);
                const struct run_request request = {.stepper = "rk4",
                                                    .treatment = treatment_names[treatment],
                                                    .step = 1e-3,
                                                    .threads = threads};
                struct lab_run run;
                lab_finish(scene, &request, &run);
                cr_assert_gt(run.result.counters.wisp_contacts, 0, "they do not touch");
                if (!first.row) {
                    first = run;
                    continue;
                }
                for (int f = 0; f < run.frames; f++)
                    for (int i = 0, found; i < run.rows; i += found) { /* root by root */
                        const double *x = run.row + (f * run.rows + i) * run.columns;
                        const double *y = first.row + f * first.rows * first.columns;
                        int k = 0;
                        while (k < first.rows &&
                               memcmp(x + 1, y + k * run.columns + 1, 4 * sizeof *x) != 0)
                            k++;
                        cr_assert_lt(k, first.rows, "%s, order %d, %d threads: no such wisp",
                                     treatment_names[treatment], order, threads);
                        for (found = 0;
                             i + found < run.rows && (found == 0 || x[found * run.columns + 1] > 0);
                             found++)
                            cr_assert_eq(memcmp(x + found * run.columns + 1,
                                                y + (k + found) * run.columns + 1,
                                                (size_t)(run.columns - 1) * sizeof *x),
                                         0, "%s, order %d, %d threads: other bits, frame %d",
                                         treatment_names[treatment], order, threads, f);
                    }
            }
    }
}

/* --- energy --- */

/* Of all wisps; `*terms` without signs. */
static double energy_of(struct model *model, double *terms) {
    double sum = 0;
    *terms = 0;
    for (int i = 0; i < model->part_count; i++) {
        struct part *part = &model->parts[i];
        struct energies energies;
        cr_assert_eq(
            part->system.ops->energies(part->system.ctx, model->t, part->q, part->v, &energies), 0);
        sum += energies_sum(&energies);
        *terms += fabs(energies.kinetic) + fabs(energies.gravity) + fabs(energies.bending);
    }
    return sum;
}

static double first_energy, worst_energy, scale_energy;
static int keep_energy(void *ctx, const struct model *model, double t, const double *rows) {
    double terms;
    const double energy = energy_of((struct model *)model, &terms);
    (void)ctx, (void)rows;
    first_energy = t == 0 ? energy : first_energy;
    worst_energy = fmax(worst_energy, fabs(energy - first_energy));
    scale_energy = fmax(scale_energy, terms);
    return 0;
}

/* Tensions do no work where nothing moves their segments' lengths: without damping and air a wisp
 * keeps its energy, also with hinges and skip springs. */
Test(rigid_runs, energy_is_kept_without_damping) {
    static const char *const laws[] = {"material.bending=none", "material.bending=skip",
                                       "material.bending=hinge"};
    for (int law = 0; law < 3; law++) {
        struct scene *scene =
            LAB_LOAD("swing", "material={ stretch=\"rigid\"; drag_rate=0; bending_time=0; }",
                     laws[law], "duration=0.5");
        const struct run_request request = {.stepper = "reference"};
        worst_energy = scale_energy = 0;
        run_finished(scene, &request, keep_energy, NULL);
        cr_log_info("%s: energy off by %.2e of %.2e", laws[law], worst_energy, scale_energy);
        cr_expect_leq(worst_energy, 1e-9 * scale_energy, "%s: off by %.2e J of %.2e", laws[law],
                      worst_energy, scale_energy);
    }
}

/* What the head puts in goes through the first tension: what the books cannot account for is the
 * error of their trapezoid rule, of order 2. */
static int keep_residual(void *worst, const struct model *model, double t, const double *rows) {
    (void)t, (void)rows;
    *(double *)worst = fmax(*(double *)worst, fabs(model->diagnosis->residual));
    return 0;
}

Test(rigid_runs, the_heads_work_is_in_the_books) {
    double residual[2];
    for (int k = 0; k < 2; k++) {
        struct scene *scene = LAB_LOAD("swing-shaken", RIGID, "material.bending=skip",
                                       "duration=0.4", "frame_rate=10.0");
        const struct run_request request = {
            .stepper = "rk4", .step = 1. / (1200 << k), .diagnostics = 1};
        residual[k] = 0;
        run_finished(scene, &request, keep_residual, &residual[k]);
    }
    const double order = log2(residual[0] / residual[1]);
    cr_expect(fabs(order - 2) < 0.2, "residuals %.2e, %.2e J: order %.2f", residual[0], residual[1],
              order);
}

/* --- what fails --- */

/* An absurd step leaves a state that no tension puts back. */
Test(rigid_runs, a_step_that_cannot_be_put_back_ends_the_run) {
    struct scene *scene = LAB_LOAD("swing", RIGID);
    const struct run_request request = {.stepper = "euler", .step = 1};
    struct lab_run run;
    scene->frame_rate = 1;
    scene->duration = 20;
    lab_run(scene, &request, &run);
    cr_assert(run.result.outcome == SOLVER_STALLED || run.result.outcome == NOT_FINITE, "%s",
              outcome_name(run.result.outcome));
    cr_assert(run.result.outcome == NOT_FINITE || strstr(run.result.reason, "length"), "%s",
              run.result.reason);
}

/* A method with error control takes half the step where the end of one cannot be put back. */
Test(rigid_runs, a_projection_that_fails_is_tried_with_half_the_step) {
    static const char *const names[] = {"reference", "cvode"};
    for (int i = 0; i < 2; i++)
        for (int on = 0; on < 2; on++) {
            static struct fixture f;
            const struct stepper_method *method = stepper_find(names[i]);
            const struct stepper_settings settings = {
                .linear = linear_find("direct"), .rtol = 1e-6, .atol = 1e-8};
            double q = 0, v = 1, t = 0;
            int code = 0;
            fixture_manufactured(&f);
            fixture_add_projection(&f);
            f.fail_call = CALL_PROJECT;
            f.fail_at = 5;
            f.fail_code = SOLVER_STALLED;
            f.fail_on = on;
            struct stepper *stepper = stepper_create(method, &settings, &f.system);
            cr_assert(stepper, "no memory");
            while (t < 1 && !code)
                code = method->advance(stepper, &t, 1, &q, &v);
            if (on)
                cr_expect(code == -SOLVER_STALLED && t < 1, "%s: %d at t = %g", names[i], code, t);
            else
                cr_expect(code == 0 && fabs(q - sin(1)) < 1e-4, "%s: %d at t = %g, %g", names[i],
                          code, t, q);
            cr_expect(f.failures > 0 && f.system.counters.rejected_steps > 0, "%s", names[i]);
            method->free(stepper);
        }
}

/* A body that puts nodes metres away leaves a tick that cannot be completed, on whatever thread. */
Test(rigid_runs, a_tick_that_cannot_be_put_back_ends_the_run) {
    struct scene *scene = LAB_LOAD(
        "swing", RIGID, "run.project=false",
        "body=({ name=\"b\"; center=[0.15, -0.1, 0.0]; radii=[0.05, 0.05, 0.05]; friction=0.0;"
        "        elasticity=0.0; offset=50.0; })");
    for (int threads = 1; threads <= 2; threads++) {
        const struct run_request request = {.stepper = "rk4", .step = 1 / 300., .threads = threads};
        struct lab_run run;
        lab_run(scene, &request, &run);
        cr_assert_eq(run.result.outcome, SOLVER_STALLED, "%s", outcome_name(run.result.outcome));
        cr_assert(strstr(run.result.reason, "wisp 0: the segments"), "%s", run.result.reason);
    }
}

/* Without a projection the strain limit says that a run is wrong. */
Test(rigid_runs, an_unprojected_run_diverges_by_its_strain) {
    struct scene *scene = LAB_LOAD("swing", RIGID, "run.project=false");
    const struct run_request request = {.stepper = "euler", .step = 1. / 30};
    struct lab_run run;
    lab_run(scene, &request, &run);
    cr_assert_eq(run.result.outcome, DIVERGED, "%s: %s", outcome_name(run.result.outcome),
                 run.result.reason);
}

/* --- the start --- */

static char *folder;
static const char *path;

static void open_folder(void) {
    folder = folder_make();
    path = printed("%s/state.tsv", folder);
}

/* The rest shape of `swing`, all its segments behind the head longer by a share. */
static void write_state(double longer) {
    FILE *file = fopen(path, "w");
    cr_assert(file);
    fprintf(file, "t\twisp\tnode\tx\ty\tz\tvx\tvy\tvz\n");
    for (int i = 0; i < 11; i++)
        fprintf(file, "0\t0\t%d\t%.17g\t%.17g\t0\t%g\t0\t%g\n", i,
                i < 2 ? 0.03 * i : 0.03 + 0.03 * (i - 1) * (1 + longer) * 0.8,
                i < 2 ? 0 : 0.03 * (i - 1) * (1 + longer) * 0.6, i < 2 ? 0. : 0.1 * i,
                i < 2 ? 0. : 0.2);
    fclose(file);
}

static struct scene *load_from_state(char *reason) {
    char set[PATH_SIZE + 32];
    const char *const sets[] = {RIGID, set, "duration=0.01", "frame_rate=100.0"};
    snprintf(set, sizeof set, "start=\"%s\"", path);
    return scene_load("swing", sets, 4, reason);
}

Test(rigid_runs, a_loaded_state_is_put_back_before_the_first_frame, .init = open_folder) {
    const struct run_request request = {.stepper = "cvode"}; /* of which no step is projected */
    char reason[REASON_SIZE];
    struct lab_run run;
    write_state(9e-3);
    struct scene *scene = load_from_state(reason);
    cr_assert(scene, "%s", reason);
    test_owns_scene(scene);
    lab_run(scene, &request, &run);
    run.frames = 1;
    cr_assert_leq(off_length(scene, &run), length_tolerance, "off by %.2e",
                  off_length(scene, &run));
}

Test(rigid_runs, a_state_far_from_its_lengths_is_refused, .init = open_folder) {
    char reason[REASON_SIZE];
    write_state(1.1e-2);
    cr_assert_null(load_from_state(reason), "it is taken");
    cr_assert(strstr(reason, "start: the segment before node 2 of wisp 0") &&
                  strstr(reason, "0.011"),
              "%s", reason);
}

/* `eval` has the state as it is. */
Test(rigid_runs, eval_leaves_its_state_alone, .init = open_folder) {
    static struct wisp_twin twin;
    double q[27], v[27], a[27], largest = 0;
    struct scene *scene = LAB_LOAD("swing", RIGID);
    write_state(5e-2);
    struct finished *f = WORKS("eval", "swing", "--set", RIGID, "--state", path);
    wisp_twin_init(&twin, &scene->wisps[0], &scene->around, WISP_GENERALISED);
    for (int i = 0; i < 9; i++) {
        const double along = 0.03 * (i + 1) * 1.05;
        const double place[3] = {0.03 + along * 0.8, along * 0.6, 0},
                     speed[3] = {0.1 * (i + 2), 0, 0.2};
        memcpy(q + 3 * i, place, sizeof place);
        memcpy(v + 3 * i, speed, sizeof speed);
    }
    cr_assert_eq(wisp_twin_acceleration(&twin, 0, q, v, a), 0);
    for (int i = 0; i < 27; i++)
        largest = fmax(largest, fabs(a[i]));
    const char *row = strstr(f->out, "\n0\t2\t");
    for (int i = 0; i < 9; i++, row = strchr(row + 1, '\n')) {
        double x[3];
        cr_assert_eq(sscanf(row, " 0 %*d %lf %lf %lf", &x[0], &x[1], &x[2]), 3, "%s", row);
        for (int k = 0; k < 3; k++)
            cr_assert_leq(fabs(x[k] - a[3 * i + k]), 1e-11 * largest, "node %d: %g, twin %g", i + 2,
                          x[k], a[3 * i + k]);
    }
}

/* --- scenes --- */

/* One line that says what, and what to do. */
static void expect_refusal(const char *const *words, const char *what, const char *more) {
    struct finished *f = program_done(NULL, words);
    cr_expect(f->code == 1 && count_lines(f->err) == 1 && strstr(f->err, what) &&
                  strstr(f->err, more),
              "exit code %d, no '%s', '%s': %s", f->code, what, more, f->err);
}

Test(rigid_runs, what_needs_jacobians_refuses_them) {
    static const char *const steppers[] = {"implicit-euler", "linear-euler", "bdf2", "bdf3"};
    for (int i = 0; i < 4; i++)
        expect_refusal(
            (const char *const[]){"run", "swing", "--set", RIGID, "--stepper", steppers[i], NULL},
            steppers[i], "rigid segments have none");
    expect_refusal((const char *const[]){"run", "swing", "--set", RIGID, "--stepper", "cvode",
                                         "--option", "nonlinear=newton", NULL},
                   "Jacobians", "rigid segments have none");
    expect_refusal((const char *const[]){"run", "swing", "--set", "run.project=true", NULL},
                   "project:", "rigid");
}

/* --set changes the settings of the material that it names and leaves the others; the springs that
 * it puts rigid segments in the place of go with it. What says both is refused, in its place. */
Test(rigid_runs, the_material_keeps_what_is_not_overridden) {
    struct scene *scene = LAB_LOAD("swing-shaken", RIGID);
    const struct wisp *wisp = &scene->wisps[0];
    cr_assert(wisp->stretch == STRETCH_RIGID && wisp->stretch_stiffness == 0 &&
              wisp->stretch_time == 0);
    cr_assert(wisp->bending == BENDING_HINGE, "the rest of the material is lost");
    const json_t *material = json_object_get(scene->source, "material");
    cr_assert(!json_object_get(material, "stretch_time") && json_object_get(material, "bending"));
    scene = LAB_LOAD("swing-shaken", "material={}");
    cr_assert(scene->wisps[0].bending == BENDING_SKIP, "no defaults");

    static const char *const both[][2] = {{"material.stretch_time=1e-4", RIGID},
                                          {RIGID, "material={ stretch_stiffness = 90; }"}};
    static const char *const says[] = {"stretch_time: goes with", "stretch_stiffness: goes with"};
    for (int i = 0; i < 2; i++)
        lab_refuse("swing", both[i], 2, &says[i], 1);
}

/* --- experiments --- */

/* A scene of one's own goes through those that ask linear theory or stiffness, which rigid segments
 * have no answer for. */
Test(rigid_runs, slow_experiments_take_a_scene_of_rigid_segments, .init = open_folder,
     .timeout = 120) {
    static const char *const names[] = {"stability", "ladder", "needs", "work-precision"};
    path = file_write(
        folder, "rigid.cfg",
        "name = \"rigid\"; duration = 0.1; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0];\n"
        "material = { stretch = \"rigid\"; };\n"
        "wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
        "            length = 0.30; nodes = 5; } );\n"
        "run = { step = 1.0e-3; };\n");
    for (int i = 0; i < 4; i++) {
        WORKS("experiment", names[i], "--quick", "--scene", path, "--out", folder, "--no-progress");
    }
}
