/* What happens to wisps at times rather than between them: the tick that keeps samples off their
 * node, and wind, whose kinks stop the advance. */
#include "model/clock.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the tick --- */

/* r and its rate of a sample: unknowns themselves, or along the line of the twin's frame. */
static void distance_and_rate(struct wisp_twin *twin, const double *q, const double *v, int node,
                              int sample, double *r, double *rate) {
    static double u[LAB_NODES][3], normal[LAB_NODES][3], w[LAB_NODES][3];
    const int at = (node - 2) * twin->unknowns;
    if (twin->treatment != WISP_PENALTY) {
        *r = q[at + 3 + sample];
        *rate = v[at + 3 + sample];
        return;
    }
    wisp_twin_frames(twin, q, u, normal, w);
    *r = *rate = 0;
    for (int k = 0; k < 3; k++) {
        const double a = twin->cosine[sample] * u[node][k] + twin->sine[sample] * normal[node][k];
        *r += (q[at + 3 + 3 * sample + k] - q[at + k]) * a;
        *rate += (v[at + 3 + 3 * sample + k] - v[at + k]) * a;
    }
}

/* Of all samples of random states: up to 1e-3 R (1 + 1e-9) r becomes 1e-3 R, an inward rate is
 * removed, and nothing else changes by a bit: nodes, samples that are further out, what is across
 * the line. */
static void check_clamp(int lanes, enum wisp_treatment treatment, int samples, unsigned *seed) {
    static struct wisp_twin twin;
    static double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE], q1[LAB_SIZE], v1[LAB_SIZE];
    static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE];
    enum { NODES = 6 };
    const struct surroundings around = lab_surroundings(WIND_NONE, seed);
    struct wisp wisps[LAB_LANES];
    struct lab_part part;
    int inside = 0, changed;
    for (int k = 0; k < lanes; k++)
        wisps[k] = lab_wisp(NODES, samples, BENDING_SKIP, seed);
    lab_part_make(&part, lanes, wisps, lanes, &around, treatment);
    for (int k = 0; k < lanes; k++) {
        lab_state(&wisps[k], treatment, STATE_RANDOM, 0, seed, q[k], v[k]);
        for (int i = 0; i < (NODES - 2) * samples && treatment != WISP_PENALTY; i++)
            if (lab_between(seed, 0, 1) < 0.5) /* in penalty half are behind their node already */
                q[k][i / samples * (3 + samples) + 3 + i % samples] *= lab_between(seed, -1, 2e-3);
        for (int i = 0; i < 3 && treatment != WISP_PENALTY; i++) /* there, or next to it */
            q[k][3 + i] = (1 + (i - 1) * 4e-10) * 1e-3 * wisps[k].radius;
        lab_place(&part, k, q[k], Q);
        lab_gather(&part, k, Q, q[k]); /* from the root, and so are the twin's below */
        lab_scatter(&part, k, v[k], V);
    }
    changed = kernel_of(lanes)->clamp(part.system.ctx, Q, V);
    for (int k = 0; k < lanes; k++) {
        const double least = 1e-3 * wisps[k].radius;
        memset(wisps[k].root, 0, sizeof wisps[k].root);
        wisp_twin_init(&twin, &wisps[k], &around, treatment);
        lab_gather(&part, k, Q, q1);
        lab_gather(&part, k, V, v1);
        for (int i = 2; i < NODES; i++) {
            const int at = (i - 2) * twin.unknowns, per = treatment == WISP_PENALTY ? 3 : 1;
            cr_assert(memcmp(q1 + at, q[k] + at, 3 * sizeof *q1) == 0 &&
                          memcmp(v1 + at, v[k] + at, 3 * sizeof *v1) == 0,
                      "a node moves");
            for (int j = 0; j < samples; j++) {
                const int e = at + 3 + per * j;
                const size_t bytes = (size_t)per * sizeof *q1;
                double before, rate, r, rate1;
                distance_and_rate(&twin, q[k], v[k], i, j, &before, &rate);
                distance_and_rate(&twin, q1, v1, i, j, &r, &rate1);
                if (before > (1 + 1e-9) * least) {
                    cr_assert(memcmp(q1 + e, q[k] + e, bytes) == 0 &&
                                  memcmp(v1 + e, v[k] + e, bytes) == 0,
                              "a sample at %g changes", before);
                    continue;
                }
                inside++;
                /* roundings of coordinates and of the frames: 1 m, 1 m/s */
                const double slack = treatment == WISP_PENALTY ? 1e-14 : 0;
                cr_assert(fabs(r - least) <= slack, "r is %.17g, not %.17g", r, least);
                cr_assert(fabs(rate1 - fmax(rate, 0)) <= 10 * slack, "a rate of %g becomes %g",
                          rate, rate1);
                double moved = 0, slower = 0; /* along the line and no other way */
                for (int c = 0; c < per; c++) {
                    moved += pow(q1[e + c] - q[k][e + c], 2);
                    slower += pow(v1[e + c] - v[k][e + c], 2);
                }
                cr_assert(fabs(sqrt(moved) - fabs(least - before)) <= 1e-14 + slack &&
                              fabs(sqrt(slower) - fmax(-rate, 0)) <= 1e-14 + 10 * slack,
                          "a sample moves across its line");
            }
        }
    }
    cr_assert_eq(changed != 0, inside > 0, "%d inside, changed says %d", inside, changed);
    cr_assert_geq(inside, treatment == WISP_PENALTY ? 0 : 3 * lanes);
    /* what has been put there stays */
    if (treatment != WISP_PENALTY)
        cr_assert_eq(kernel_of(lanes)->clamp(part.system.ctx, Q, V), 0,
                     "the second clamp finds something");
}

Test(wisp_clock, the_clamp_sets_what_is_inside_and_nothing_else) {
    static const int samples[] = {3, 4, 5, 8, 16};
    unsigned seed = 51;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int m = 0; m < 5; m++)
            for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
                for (int repeat = 0; repeat < 5; repeat++)
                    check_clamp(lanes, (enum wisp_treatment)treatment, samples[m], &seed);
}

/* A body that ends 1e-6 m below a node puts the sample between them at 1e-3 R, and leaves it the
 * rate at which it goes inwards; the clamp of the same tick does not. */
Test(wisp_clock, a_sample_that_a_body_puts_at_its_node_stops) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int count = 1; count <= 5; count += 4) {
            struct scene *scene = LAB_LOAD("swing-envelope", "wisps.[0].nodes=5",
                                           "body=({ name=\"b\"; center=[0.15, -1.0, 0.0];"
                                           "        radii=[0.999999, 0.999999, 0.999999];"
                                           "        friction=0; elasticity=0; offset=0; })");
            struct wisp wisps[5];
            for (int i = 0; i < count; i++) {
                wisps[i] = scene->wisps[0];
                wisps[i].root[0] = -0.075 * (i % 2); /* by a segment: another node is there */
            }
            free(scene->wisps);
            scene->wisps = malloc(sizeof wisps);
            cr_assert(scene->wisps, "no memory");
            memcpy(scene->wisps, wisps, sizeof wisps);
            scene->wisp_count = count;
            struct model *model = lab_model(scene, treatment, 4);
            const int columns = model->column_count, per = treatment == WISP_PENALTY ? 6 : 2;
            double *rows = test_room((size_t)(model->row_count * columns) * sizeof *rows);
            int changed[5], found = 0;
            cr_assert(rows, "no memory");
            wisp_problem.sample(model, rows);
            for (int i = 0; i < model->row_count; i++)
                for (int j = 0; j < 4; j++) { /* all samples go inwards, by 7 m/s */
                    double *row = rows + i * columns, *sample = row + 8 + per * j;
                    for (int k = 0; k < 3 && per == 6; k++)
                        sample[3 + k] = -350 * (sample[k] - row[2 + k]);
                    if (per == 2)
                        sample[1] = -7;
                }
            wisp_problem.restore(model, rows);
            cr_assert_eq(wisp_problem.tick(model, NULL, STOP_COLLISION, changed), FINISHED);
            wisp_problem.sample(model, rows);
            for (int i = 0; i < model->row_count; i++)
                for (int j = 0; j < 4 && rows[i * columns + 1] >= 2; j++) {
                    const double *row = rows + i * columns, *sample = row + 8 + per * j;
                    double r = 0, rate = 0;
                    for (int k = 0; k < 3 && per == 6; k++) {
                        r += pow(sample[k] - row[2 + k], 2);
                        rate += sample[3 + k] * (sample[k] - row[2 + k]);
                    }
                    rate = per == 6 ? rate / sqrt(r) : sample[1];
                    r = per == 6 ? sqrt(r) : sample[0];
                    if (r > 1.1e-3 * wisps->radius)
                        continue;
                    found++;
                    cr_assert(fabs(r - 1e-3 * wisps->radius) <= 1e-15 && fabs(rate) <= 1e-12,
                              "%s, row %d: r = %g, rate %g", treatment_names[treatment], i, r,
                              rate);
                }
            cr_assert_eq(found, count, "%d samples stop", found);
        }
}

/* Wisps so stiff that gravity does not bend them, with samples so soft that it pulls them onto and
 * past their nodes: ticks have work to do. */
#define SOFT                                                                       \
    "envelope={ samples = 4; radius = 0.02; frequency = 2.0; damping_ratio = 0.2;" \
    "           penalty_ratio = 1000.0; }",                                        \
        "material.bending=\"hinge\"", "material.bending_stiffness=1e-2"
#define LEVEL "{ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.30; nodes = 6; }"
#define HANGING \
    "{ root = [1.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.30; nodes = 6; }"

/* At 300 frames per second every tick is a frame, and no frame has a sample inside. */
Test(wisp_clock, no_frame_of_any_stepper_has_a_sample_inside) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE];
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.1", "frame_rate=300.0", SOFT,
                                   "wisps=(" LEVEL ")", "run.step=5e-5");
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        for (int m = 0; stepper_methods[m]; m++) {
            const struct run_request request = lab_request(stepper_methods[m], treatment);
            struct lab_run run;
            int clamped = 0;
            if (!is_taken(scene, &request))
                continue;
            lab_finish(scene, &request, &run);
            wisp_twin_init(&twin, scene->wisps, &scene->around, (enum wisp_treatment)treatment);
            for (int f = 0; f < run.frames; f++) {
                for (int i = 2; i < twin.nodes; i++) {
                    const double *row = run.row + (f * run.rows + i) * run.columns + 2;
                    double *x = q + (i - 2) * twin.unknowns, *y = v + (i - 2) * twin.unknowns;
                    const int per = treatment == WISP_PENALTY ? 3 : 1;
                    memcpy(x, row, 3 * sizeof *x);
                    memcpy(y, row + 3, 3 * sizeof *y);
                    for (int u = 0; u < twin.unknowns - 3; u++) {
                        x[3 + u] = row[6 + u / per * 2 * per + u % per];
                        y[3 + u] = row[6 + u / per * 2 * per + per + u % per];
                    }
                }
                for (int i = 2; i < twin.nodes; i++)
                    for (int j = 0; j < 4; j++) {
                        double r, rate;
                        const double least = 1e-3 * twin.radius;
                        distance_and_rate(&twin, q, v, i, j, &r, &rate);
                        cr_assert(r >= least - 1e-14, "%s, %s, frame %d: r = %g", request.stepper,
                                  request.treatment, f, r);
                        if (r > least + 1e-14)
                            continue;
                        clamped++;
                        cr_assert(rate >= -1e-13, "%s, %s, frame %d: a rate of %g", request.stepper,
                                  request.treatment, f, rate);
                    }
            }
            cr_assert_gt(clamped, 10, "%s, %s: only %d samples were clamped", request.stepper,
                         request.treatment, clamped);
        }
    }
}

static long long restarts(const char *stepper, const char *wisps, const char *treatment) {
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.1", SOFT, wisps);
    const struct run_request request = {.stepper = stepper, .treatment = treatment};
    struct lab_run run;
    lab_finish(scene, &request, &run);
    const long long count = run.result.counters.restarts;
    return count;
}

/* Of two wisps, one with samples that fall onto their nodes and one whose samples gravity does not
 * pull along their lines: only the first restarts, as often as alone. */
Test(wisp_clock, multistep_methods_restart_only_what_a_tick_changed) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const char *name = treatment_names[treatment];
        const long long level = restarts("cvode", "wisps=(" LEVEL ")", name);
        const long long hanging = restarts("cvode", "wisps=(" HANGING ")", name);
        const long long both = restarts("cvode", "wisps=(" HANGING "," LEVEL ")", name);
        cr_assert(level >= 5 && level <= 30, "%s: %lld restarts in 30 ticks", name, level);
        cr_assert_eq(hanging, 0, "%s: %lld restarts where nothing changes", name, hanging);
        cr_assert_eq(both, level, "%s: %lld restarts with a still wisp beside it, %lld without",
                     name, both, level);
    }
}

/* The reference and its cross-check across ticks that do something. */
Test(wisp_clock, slow_the_reference_with_ticks_agrees_with_its_cross_check) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.1", "frame_rate=300.0", SOFT,
                                       "wisps=(" LEVEL ")");
        const struct run_request request = {.stepper = "reference",
                                            .treatment = treatment_names[treatment]};
        struct lab_run a;
        lab_run(scene, &request, &a);
        const double d = lab_cross_check(scene, treatment, &a);
        cr_log_info("%s: %.1e m", treatment_names[treatment], d);
        /* as without ticks (wisp_runs.c), and a tick passes an error of r on as it is */
        cr_assert_leq(d, 1e-11, "%s: %.1e m apart", treatment_names[treatment], d);
    }
}

/* --- wind --- */

/* Each kind's formula in another form than the program's. */
Test(wisp_clock, wind_follows_its_formulas) {
    const struct wind steady = {.kind = WIND_STEADY, .velocity = {3, -2, 0.5}};
    const struct wind gust = {
        .kind = WIND_GUST, .velocity = {3, -2, 0.5}, .hold = 1, .decay = 0.082};
    const struct wind irregular = {.kind = WIND_IRREGULAR,
                                   .velocity = {3, -2, 0.5},
                                   .terms = 3,
                                   .amplitude = {0.5, -0.25, 1.5},
                                   .frequency = {1, 0.3, 7}};
    const struct wind none = {.kind = WIND_NONE, .velocity = {3, -2, 0.5}};
    for (double t = 0; t < 3; t += 0.0123) {
        double w[3];
        /* sin 2 pi x by its period and symmetry; decays by powers of the factor of one frame */
        double factor = 1;
        for (int k = 0; k < 3; k++) {
            const double x = remainder(irregular.frequency[k] * t, 1);
            factor += irregular.amplitude[k] * cos(2 * M_PI * (x - 0.25));
        }
        const double decayed = t < 1 ? 1 : pow(exp(-1 / (30 * 0.082)), 30 * (t - 1));
        for (int k = 0; k < 3; k++) {
            const double v = steady.velocity[k];
            wind_velocity(&none, t, w);
            cr_assert_eq(w[k], 0, "wind where there is none");
            wind_velocity(&steady, t, w);
            cr_assert_eq(w[k], v, "steady wind of %g, not %g", w[k], v);
            wind_velocity(&gust, t, w);
            cr_assert(fabs(w[k] - decayed * v) <= 1e-14 * fabs(v), "a gust of %.17g, not %.17g",
                      w[k], decayed * v);
            wind_velocity(&irregular, t, w);
            /* arguments of up to 2 pi 21, each rounding of which is 1.4e-14 */
            cr_assert(fabs(w[k] - factor * v) <= 1e-13 * fabs(v), "irregular wind %.17g, not %.17g",
                      w[k], factor * v);
        }
    }
    /* the source's factor of 1.5 per frame at 30 Hz is its 0.082 s */
    cr_assert(fabs(exp(1 / (30 * 0.082)) - 1.5) < 2e-3);
    for (double t = -1e-9; t <= 1e-9; t += 2e-9) { /* continuous at the end of the hold */
        double w[3];
        wind_velocity(&gust, 1 + t, w);
        cr_assert(fabs(w[0] - 3) <= 3 * 1e-9 / 0.08, "a jump to %.17g", w[0]);
    }
}

/* --- its kinks --- */

#define GUST(hold) \
    "wind={ kind = \"gust\"; velocity = [2.0, 0.0, 3.0]; hold = " hold "; decay = 0.02; }"
/* soft and short: explicit methods are accurate long before they are unstable */
#define LIMP                                                        \
    "material.stretch_stiffness=0.5", "material.stretch_time=2e-3", \
        "material.bending_stiffness=1e-7"

static int stop_times(const struct model *model, double duration, double *t) {
    struct clock clock = clock_start(0, duration);
    struct stop stop;
    int count = 0;
    clock_add(&clock, STOP_FRAME, 10, 0);
    clock.kink = model->kinks;
    clock.kink_count = model->kink_count;
    while (clock_next(&clock, &stop))
        t[count++] = stop.events & STOP_KINK ? -stop.t : stop.t;
    return count;
}

Test(wisp_clock, the_end_of_a_gust_is_a_stop) {
    static const struct {
        const char *set;
        int stops;
        double t[5]; /* a kink is negative */
    } cases[] = {
        {GUST("0.0637"), 4, {-0.0637, 0.1, 0.2, 0.3}},
        {GUST("0.2"), 3, {0.1, -0.2, 0.3}},
        {GUST("0.5"), 3, {0.1, 0.2, 0.3}},
        {"wind={ kind = \"steady\"; velocity = [1.0, 0.0, 0.0]; }", 3, {0.1, 0.2, 0.3}},
    };
    for (int i = 0; i < 4; i++) {
        struct scene *scene = LAB_LOAD("swing", cases[i].set);
        struct model *model = lab_model(scene, WISP_GENERALISED, 4);
        double t[10];
        cr_assert(model, "no memory");
        cr_assert_eq(stop_times(model, 0.3, t), cases[i].stops, "%s", cases[i].set);
        for (int k = 0; k < cases[i].stops; k++)
            cr_assert(fabs(t[k] - cases[i].t[k]) <= 1e-15, "%s: stop %d at %g", cases[i].set, k,
                      t[k]);
    }
}

/* What was before a kink says nothing of what comes: every method with a history begins anew there,
 * for all wisps, once where two kinks fall together. */
Test(wisp_clock, methods_with_a_history_restart_at_every_kink) {
    static const struct {
        const char *set;
        int kinks;
    } cases[] = {
        {GUST("0.0637"), 1},
        {"style={ times = [0.0, 0.031, 0.07, 0.5]; accelerations = ([0.0, 0.0, 0.0], [1.0, 0.0, "
         "0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]); }",
         2},
        {"head={ times = [0.011, 0.02, 0.09]; positions = ([0.0, 0.0, 0.0], [0.001, 0.0, 0.0], "
         "[0.0, 0.0, 0.0]); rotations = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]); }",
         3},
        {"wind={ kind = \"irregular\"; velocity = [1.0, 0.0, 0.0]; amplitudes = [1.0]; "
         "frequencies = [9.0]; }",
         0},
    };
    for (int i = 0; i < 4; i++)
        for (int m = 0; stepper_methods[m]; m++) {
            const struct stepper_method *method = stepper_methods[m];
            struct scene *scene =
                LAB_LOAD("swing", LIMP, "duration=0.1", "frame_rate=20.0",
                         "wisps=({ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = "
                         "0.3; nodes = 5; }, { root = [0.0, 0.0, 1.0]; direction = [0.0, 0.1, "
                         "1.0]; length = 0.3; nodes = 5; })",
                         cases[i].set);
            const struct run_request request = lab_request(method, WISP_GENERALISED);
            struct lab_run run;
            lab_finish(scene, &request, &run);
            cr_assert_eq(run.result.counters.restarts, method->reset ? 2 * cases[i].kinks : 0,
                         "%s: %lld restarts of two wisps at %d kinks: %s", method->name,
                         run.result.counters.restarts, cases[i].kinks, cases[i].set);
        }
}

/* A kink inside a step would leave an error of h^2 times the jump of the force's slope, once: order
 * 2 for all methods. With the stop there they keep their own. */
Test(wisp_clock, steppers_keep_their_order_across_the_end_of_a_gust) {
    static const struct {
        const char *stepper;
        double order, rate;
    } cases[] = {{"euler", 1, 8000}, {"midpoint", 2, 4000}, {"rk4", 4, 2000}};
    struct scene *scene = LAB_LOAD("swing", LIMP, "duration=0.2", "frame_rate=5.0", GUST("0.0637"));
    const struct run_request tight = {.stepper = "reference", .rtol = 1e-13, .atol = 1e-14};
    struct lab_run exact;
    lab_finish(scene, &tight, &exact);
    for (int i = 0; i < 3; i++) {
        double error[3];
        for (int k = 0; k < 3; k++) {
            const struct run_request request = {.stepper = cases[i].stepper,
                                                .step = 1 / (cases[i].rate * (1 << k))};
            error[k] = lab_error(scene, &request, &exact);
        }
        cr_log_info("%s: %.2e %.2e %.2e", cases[i].stepper, error[0], error[1], error[2]);
        lab_check_order(cases[i].stepper, error, cases[i].order, 0.1, 0.1);
    }
}

/* Ends of a hold where a stop is already, at the start, at the end, and beyond: every stepper runs
 * on, and to the same end as where nothing is there. */
Test(wisp_clock, kinks_at_awkward_times) {
    static const char *const gusts[] = {GUST("0.0"), GUST("0.05"),  GUST("0.1"),
                                        GUST("7.0"), GUST("1e-14"), GUST("0.0500000000001")};
    for (int i = 0; i < 6; i++)
        for (int m = 0; stepper_methods[m]; m++) {
            struct scene *scene =
                LAB_LOAD("swing-envelope", LIMP, "duration=0.1", "frame_rate=20.0", gusts[i]);
            const struct run_request request = lab_request(stepper_methods[m], WISP_GENERALISED);
            struct lab_run run;
            lab_finish(scene, &request, &run);
            cr_assert_eq(run.frames, 3, "%s, %s: %d frames", request.stepper, gusts[i], run.frames);
        }
}

/* Where the clamp is all that happens at a tick, each part does it by itself; beside a body, be it
 * ever so far away, all parts stop for each other. Soft envelopes sag onto their nodes under their
 * weight: without ticks they are elsewhere. Every fifth tick wisps touch, which no part does alone.
 */
Test(wisp_clock, a_part_that_ticks_alone_does_what_all_do_together) {
    static const char *const steppers[] = {"euler", "rk4", "linear-euler", "bdf2", "cvode"};
#define SAGGING                                                                          \
    "envelope.frequency=1.0", "duration=0.1", "run.step=1e-4",                           \
        "wisps=({ root=[0.0, 0.0, 0.0]; direction=[1.0, 0.1, 0.0]; length=0.3; nodes=7;" \
        "         grid=[3, 3]; spacing=0.02; across=([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); })"
#define TOUCHING(rate) "contacts={ interaction_rate=60.0; collision_rate=" rate "; }"
    struct scene *alone = LAB_LOAD("swing-envelope", SAGGING, TOUCHING("300.0"));
    struct scene *together = LAB_LOAD("swing-envelope", SAGGING, TOUCHING("300.0"),
                                      "body=({ name=\"far\"; center=[0.0, 0.0, 100.0];"
                                      "        radii=[1.0, 1.0, 1.0];"
                                      "        friction=0; elasticity=0; offset=0; })");
    struct scene *never = LAB_LOAD("swing-envelope", SAGGING, TOUCHING("0.0"));
    for (size_t s = 0; s < sizeof steppers / sizeof *steppers; s++)
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            struct run_request request = lab_request(stepper_find(steppers[s]), treatment);
            struct lab_run a, b, c;
            request.threads = 1 + treatment % 2;
            if (!is_taken(alone, &request))
                continue;
            lab_run(alone, &request, &a);
            lab_run(together, &request, &b);
            lab_run(never, &request, &c);
            cr_assert(a.frames == b.frames && a.rows == b.rows && a.frames == c.frames);
            const size_t bytes = (size_t)(a.frames * a.rows * a.columns) * sizeof(double);
            cr_assert_eq(memcmp(a.row, b.row, bytes), 0, "%s, %s: other bits", steppers[s],
                         treatment_names[treatment]);
            cr_assert_eq(memcmp(&a.result.counters, &b.result.counters, sizeof a.result.counters),
                         0, "%s, %s: other counts", steppers[s], treatment_names[treatment]);
            cr_assert_gt(a.result.counters.wisp_contacts, 0, "nothing touches");
            cr_assert_neq(memcmp(a.row, c.row, bytes), 0, "%s, %s: nothing is clamped", steppers[s],
                          treatment_names[treatment]);
        }
}
