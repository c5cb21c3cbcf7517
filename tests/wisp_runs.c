/* Whole runs of wisps against `reference`: observed orders, limits of stability, and what the three
 * treatments cost. */
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* rms over free nodes and frames of a run with this request, against `exact`. */
static double error_of(const struct scene *scene, const struct run_request *request,
                       const struct lab_run *exact) {
    struct lab_run run;
    lab_run(scene, request, &run);
    cr_assert_eq(run.result.outcome, FINISHED, "%s at %g s: %s", request->stepper, request->step,
                 run.result.reason);
    const double error = lab_distance(&run, exact, 1, 2).rms;
    lab_run_free(&run);
    return error;
}

/* --- orders on `swing` --- */

static const struct {
    const char *stepper, *linear, *option;
    double order, rates[3]; /* Hz: multiples of the frame rate, so that steps are what they say */
} orders[] = {
    {"euler", NULL, NULL, 1, {60000, 120000, 240000}},
    {"midpoint", NULL, NULL, 2, {15360, 30720, 61440}},
    {"rk4", NULL, NULL, 4, {3840, 7680, 15360}},
    {"implicit-euler", "direct", NULL, 1, {15360, 30720, 61440}},
    {"implicit-euler", "cg", NULL, 1, {15360, 30720, 61440}},
    {"implicit-euler", "direct", "newton.iterations=20", 1, {15360, 30720, 61440}},
};

Test(wisp_runs, steppers_have_their_order_on_the_swing) {
    struct scene *scene = LAB_LOAD("swing", "duration=0.3");
    const struct run_request tight = {.stepper = "reference"};
    struct lab_run exact;
    lab_run(scene, &tight, &exact);
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++) {
        double error[3];
        for (int k = 0; k < 3; k++) {
            const struct run_request request = {.stepper = orders[i].stepper,
                                                .linear = orders[i].linear,
                                                .step = 1 / orders[i].rates[k],
                                                .options = &orders[i].option,
                                                .option_count = orders[i].option != NULL};
            error[k] = error_of(scene, &request, &exact);
        }
        for (int k = 0; k < 2; k++) {
            const double order = log2(error[k] / error[k + 1]);
            cr_log_info("%s %s: errors %.2e %.2e, order %.3f", orders[i].stepper,
                        orders[i].linear ? orders[i].linear : "", error[k], error[k + 1], order);
        }
    }
    lab_run_free(&exact);
    scene_free(scene);
}

Test(wisp_runs, errors_of_cvode_fall_with_its_tolerance) {
    struct scene *scene = LAB_LOAD("swing", "duration=0.3");
    const struct run_request tight = {.stepper = "reference"};
    struct lab_run exact;
    lab_run(scene, &tight, &exact);
    for (int treatment = 0; treatment < 1; treatment++)
        for (double rtol = 1e-4; rtol > 1e-11; rtol /= 10) {
            const struct run_request request = {.stepper = "cvode", .rtol = rtol, .atol = rtol};
            cr_log_info("cvode %.0e: %.2e", rtol, error_of(scene, &request, &exact));
        }
    lab_run_free(&exact);
    scene_free(scene);
}

/* --- stability --- */

Test(wisp_runs, stability_facts) {
    struct scene *scene = LAB_LOAD("swing", "duration=0.5");
    const struct run_request tight = {.stepper = "reference"};
    struct lab_run exact, run;
    lab_run(scene, &tight, &exact);
    static const struct {
        const char *s;
        double hz;
    } c[] = {{"euler", 9000}, {"euler", 8500}, {"euler", 8000},
             {"euler", 7000}, {"rk4", 4000},   {"rk4", 3000}};
    for (int i = 0; i < 6; i++) {
        const struct run_request request = {.stepper = c[i].s, .step = 1 / c[i].hz};
        lab_run(scene, &request, &run);
        struct lab_distance d = {0, 0};
        if (run.frames == exact.frames)
            d = lab_distance(&run, &exact, 0, 2);
        cr_log_info("%s %g: %s %s t=%g rms %.3e max %.3e", c[i].s, c[i].hz,
                    outcome_name(run.result.outcome), run.result.reason, run.result.time, d.rms,
                    d.largest);
        lab_run_free(&run);
    }
}

/* --- treatments --- */

Test(wisp_runs, treatments) {
    static const char *const wisp =
        "wisps=({root=[0.0,0.0,0.0];direction=[1.0,0.2,0.1];length=0.3;nodes=6;})";
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.3", "frame_rate=10.0", wisp,
                                   "material.stretch_stiffness=15.0", "material.stretch_time=2e-4");
    struct scene *bare = LAB_LOAD("swing", "duration=0.3", "frame_rate=10.0", wisp,
                                  "material.stretch_stiffness=15.0", "material.stretch_time=2e-4");
    struct lab_run r[7];
    static const char *t[] = {"projection", "generalised", "penalty",
                              "penalty",    "penalty",     "penalty"};
    static const double ratio[] = {100, 100, 100, 300, 1000, 3000};
    for (int i = 0; i < 6; i++) {
        char set[60];
        snprintf(set, 60, "envelope.penalty_ratio=%.1f", ratio[i]);
        struct scene *sc =
            LAB_LOAD("swing-envelope", "duration=0.3", "frame_rate=10.0", wisp,
                     "material.stretch_stiffness=15.0", "material.stretch_time=2e-4", set);
        const struct run_request q = {.stepper = "reference", .treatment = t[i]};
        lab_run(sc, &q, &r[i]);
        cr_log_info("%s %g: %s %s steps %lld %g s", t[i], ratio[i],
                    outcome_name(r[i].result.outcome), r[i].result.reason,
                    r[i].result.counters.steps, r[i].result.cpu_seconds);
        scene_free(sc);
    }
    const struct run_request q = {.stepper = "reference"};
    lab_run(bare, &q, &r[6]);
    for (int mode = 0; mode < 3; mode++) {
        for (int i = 0; i < 7; i++) {
            double sum = 0;
            for (int n = 2; n < 6; n++)
                for (int k = 2; k < 5; k++) {
#define X(i) r[i].row[(3 * 6 + n) * r[i].columns + k]
                    const double a = 1 / 300., b = 1 / 1000., c = 1 / 3000.;
                    double f[3] = {X(3), X(4), X(5)}, x[3] = {a, b, c};
                    if (mode == 1)
                        for (int j = 0; j < 3; j++)
                            x[j] = sqrt(x[j]);
                    double e = mode == 2
                                   ? f[2]
                                   : f[0] * x[1] * x[2] / ((x[0] - x[1]) * (x[0] - x[2])) +
                                         f[1] * x[0] * x[2] / ((x[1] - x[0]) * (x[1] - x[2])) +
                                         f[2] * x[0] * x[1] / ((x[2] - x[0]) * (x[2] - x[1]));
                    sum += (X(i) - e) * (X(i) - e);
                }
            cr_log_info("mode %d: %d: %.5g mm over all, %.5g mm over free", mode, i,
                        1e3 * sqrt(sum / 6), 1e3 * sqrt(sum / 4));
        }
    }
    scene_free(scene);
    scene_free(bare);
}
