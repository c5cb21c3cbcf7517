/* BDF with error control: orders, tolerances, and that each wisp of a part has steps of its own,
 * those that it has alone. And CVODE where wisps share an integrator. */
#include "fixture.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

static const char *const order_options[] = {"order=2", "order=3"};

/* --- tolerances --- */

/* Steps and error (rms over all frames, m) at a tolerance. */
static double error_at(const struct scene *scene, const char *treatment, const char *option,
                       double rtol, const struct lab_run *exact, double *steps) {
    const struct run_request request = {.stepper = "bdf",
                                        .treatment = treatment,
                                        .rtol = rtol,
                                        .atol = 1e-3 * rtol,
                                        .options = &option,
                                        .option_count = 1};
    struct lab_run run;
    lab_finish(scene, &request, &run);
    const double error = lab_distance(&run, exact, 1, 2).rms;
    *steps = (double)run.result.counters.steps;
    return error;
}

/* The tolerance is of a step, of which there are more the smaller it is: errors fall like
 * rtol^(p/(p+1)), over three decades to 1/100 and 1/178, and like the p-th power of the number of
 * steps. Less, 1/20, is asked for: at loose tolerances stops make steps shorter than they need be.
 */
static void check_tolerances(const char *name, int treatment) {
    struct scene *scene = LAB_LOAD(name, "duration=0.3");
    const char *called = treatment_names[treatment];
    const struct run_request tight = {
        .stepper = "reference", .treatment = called, .rtol = 1e-12, .atol = 1e-13};
    struct lab_run exact;
    lab_run(scene, &tight, &exact);
    for (int i = 0; i < 2; i++) {
        double error[5], steps[5];
        for (int k = 0; k < 5; k++) {
            error[k] =
                error_at(scene, called, order_options[i], pow(10, -3 - k), &exact, &steps[k]);
            cr_assert(k == 0 || error[k] <= error[k - 1] / 1.5, "%s, %s, %s: %.2e after %.2e", name,
                      called, order_options[i], error[k], error[k - 1]);
        }
        const double order = log(error[2] / error[4]) / log(steps[4] / steps[2]);
        cr_log_info("%s, %s, %s: errors %.1e to %.1e, order %.2f", name, called, order_options[i],
                    error[0], error[4], order);
        cr_assert(error[4] <= error[1] / 20, "%s, %s, %s: errors %.2e to %.2e", name, called,
                  order_options[i], error[1], error[4]);
        cr_assert(order >= i + 2 - 0.3 && order <= i + 2 + 0.6, "%s, %s, %s: order %.2f", name,
                  called, order_options[i], order);
    }
}

Test(adaptive_bdf, errors_fall_with_the_tolerance) {
    check_tolerances("swing", WISP_GENERALISED);
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        check_tolerances("swing-envelope", treatment);
}

/* How many steps a millimetre takes does not depend on how stiff stretching is: with real hair's
 * stiffness and a hundred times that they are no more than with the default. */
Test(adaptive_bdf, steps_do_not_feel_the_stiffness_of_stretching) {
    static const char *const stiffness[] = {"material.stretch_stiffness=90",
                                            "material.stretch_stiffness=16800",
                                            "material.stretch_stiffness=1.68e6"};
    for (int i = 0; i < 2; i++) {
        double steps[3];
        for (int k = 0; k < 3; k++) {
            struct scene *scene = LAB_LOAD("swing", stiffness[k]);
            struct lab_run run;
            const struct run_request request = {.stepper = "bdf",
                                                .rtol = 1e-2,
                                                .atol = 1e-5,
                                                .options = &order_options[i],
                                                .option_count = 1};
            lab_finish(scene, &request, &run);
            steps[k] = (double)(run.result.counters.steps + run.result.counters.rejected_steps);
        }
        cr_log_info("%s: %g, %g and %g steps", order_options[i], steps[0], steps[1], steps[2]);
        cr_assert(steps[1] <= 1.5 * steps[0] && steps[2] <= 1.5 * steps[0],
                  "%s: %g, %g and %g steps", order_options[i], steps[0], steps[1], steps[2]);
    }
}

/* --- energy --- */

static void without_damping(const struct fixture *f, double t, const double *q, const double *v,
                            double *a) {
    (void)f, (void)t, (void)v;
    a[0] = -q[0];
}

static void no_changes(struct fixture *f, double t, const double *q, const double *v) {
    (void)f, (void)t, (void)q, (void)v;
}

/* Undamped and let go from (1, 0): the largest energy in a hundred radians, and the last. */
static void oscillate(const char *option, double rtol, double *most, double *last) {
    static struct fixture fixture;
    const struct stepper_settings settings = {.rtol = rtol, .atol = rtol, .options = {&option, 1}};
    double q = 1, v = 0, t = 0;
    fixture_begin(&fixture, "an oscillator", 1, 0, MATRIX_AVAILABLE);
    fixture.rate = without_damping;
    fixture.jacobians = no_changes;
    fixture.k[0] = -1;
    struct stepper *stepper = stepper_create(stepper_find("bdf"), &settings, &fixture.system);
    cr_assert(stepper, "no memory");
    for (*most = *last = 1; t < 100; *last = q * q + v * v, *most = fmax(*most, *last))
        cr_assert_eq(stepper->method->advance(stepper, &t, 100, &q, &v), 0);
    stepper->method->free(stepper);
}

/* An oscillator without damping gains nothing at order 2, which is stable there at every step, and
 * keeps what it has as well as it is asked to. At order 3, which is not stable on the imaginary
 * axis, it gains as much as its error allows: that is why 2 is the default. */
Test(adaptive_bdf, an_oscillator_gains_no_energy_at_order_2) {
    double most, last;
    for (double rtol = 1e-1; rtol > 1e-7; rtol /= 10) {
        oscillate(order_options[0], rtol, &most, &last);
        cr_assert(most <= 1 + rtol, "rtol %g: energy %.9g of 1", rtol, most);
        cr_assert(rtol > 2e-6 || last > 0.999, "rtol %g: energy %.9g of 1", rtol, last);
    }
    oscillate(order_options[1], 1e-2, &most, &last);
    cr_assert_gt(most, 10, "order 3 is stable");
    oscillate(order_options[1], 1e-7, &most, &last);
    cr_assert(fabs(last - 1) < 1e-2, "order 3: energy %.9g of 1", last);
}

/* --- lanes --- */

enum { STOPS = 12 };

/* A head that shakes and nods, style and wind: what lanes at times of their own feel at these. */
static struct surroundings changing_surroundings(unsigned *seed) {
    struct surroundings around = lab_surroundings(WIND_IRREGULAR, seed);
    around.head = (struct head_motion){.knots = 3,
                                       .time = {0, 0.04, 0.1},
                                       .position = {{0, 0, 0}, {0.02, 0.01, 0}, {0, 0, 0.01}},
                                       .rotation = {{0, 0, 0}, {0.1, 0.3, 0}, {0, 0, 0.2}}};
    around.style = (struct style){.knots = 2,
                                  .time = {0, 0.1},
                                  .acceleration = {{1, 0, 2}, {-3, 5, 0}},
                                  .parting = {.width = 0.02,
                                              .origin = {0.1, 0, 0.05},
                                              .normal = {0.6, 0, 0.8},
                                              .acceleration = {{5, 0, 0}, {0, -5, 5}}}};
    return around;
}

/* Makes the model fail for one wisp where it steps by more than that between two times. */
static struct {
    const struct system_ops *ops;
    struct system *system;
    const double *now;
    int lane, times;
} failing;

static int failing_acceleration(void *ctx, double t, const double *q, const double *v, double *a) {
    const struct system *s = failing.system;
    const double to = s->times ? s->times[failing.lane] : t;
    if (!(s->waiting >> failing.lane & 1) && to > 0.03 && to < 0.05 &&
        to - failing.now[failing.lane] > 1e-4) {
        failing.times++;
        return system_fail(failing.system, MODEL_FAILED, "told to fail");
    }
    return failing.ops->acceleration(ctx, t, q, v, a);
}

/* Lanes that begin anew at a stop. */
static unsigned beginning(int stop) {
    return stop == 3 ? 0x22 : stop == 4 ? 0x8c : stop == 8 ? 0xff : 0;
}

struct choice {
    const char *option;
    int fails; /* the place of the wisp whose model does, or -1 */
};

/* From stop to stop. */
static void go(struct lab_part *part, int place, double *q, double *v, void *ctx) {
    const struct choice *choice = ctx;
    const int fails = place < 0 ? choice->fails : place == choice->fails ? 0 : -1;
    const struct stepper_settings settings = {
        .rtol = 1e-3, .atol = 1e-5, .options = {&choice->option, 1}};
    const struct stepper_method *method = stepper_find("bdf");
    double t[LAB_LANES] = {0};
    struct system_ops ops = *part->system.ops;
    part->system.force_parts = (1u << FORCE_PARTS) - 1;
    part->system.stiff_part = FORCES_AXIAL;
    failing.times = 0;
    if (fails >= 0) {
        failing.ops = part->system.ops;
        failing.system = &part->system;
        failing.now = t;
        failing.lane = fails;
        ops.acceleration = failing_acceleration;
        part->system.ops = &ops;
    }
    struct stepper *stepper = stepper_create(method, &settings, &part->system);
    cr_assert(stepper, "no memory");
    for (int k = 0; k < STOPS; k++) {
        const double stop = (k + 1) / 100.;
        const unsigned lanes = place < 0 ? beginning(k) : beginning(k) >> place & 1;
        int there = 0;
        if (lanes)
            method->reset(stepper, lanes);
        while (!there) {
            cr_assert_eq(method->advance(stepper, t, stop, q, v), 0, "%s", part->system.reason);
            there = 1;
            for (int i = 0; i < part->lanes; i++)
                there &= t[i] == stop;
        }
    }
    method->free(stepper);
    if (fails >= 0)
        part->system.ops = failing.ops;
    cr_assert(place >= 0 || (failing.times > 0) == (fails >= 0));
}

static void check_lanes(int lanes, const char *option, enum bending law,
                        enum wisp_treatment treatment, int fails) {
    unsigned seed = 37;
    const struct surroundings around = changing_surroundings(&seed);
    const struct lab_company company =
        lab_company(lanes, law, treatment, &around, &seed, go, &(struct choice){option, fails});
    /* who waits is not counted; of failures of others each is tried once more */
#define X(field, definition)                                                     \
    cr_assert(fails >= 0 || company.alone.field == company.together.field,       \
              "%s: %lld " #field ", alone %lld", option, company.together.field, \
              company.alone.field);
    COUNTERS(X)
#undef X
    cr_assert(company.alone.restarts == (lanes == 4 ? 7 : 13) && company.alone.rejected_steps > 0,
              "%lld restarts, %lld rejected", company.alone.restarts, company.alone.rejected_steps);
}

Test(adaptive_bdf, a_wisp_has_the_bits_that_it_has_alone) {
    static const char *const options[] = {"order=2", "order=3", "matrix=full", "matrix=stretch"};
    for (int lanes = 4; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
        for (int treatment = 0; treatment < TREATMENTS; treatment++)
            for (int i = 0; i < 4; i++)
                check_lanes(lanes, options[i], BENDING_SKIP, (enum wisp_treatment)treatment, -1);
        check_lanes(lanes, "matrix=full", BENDING_HINGE, WISP_GENERALISED, -1);
    }
}

/* The model fails for one of them where it steps too far: it takes shorter steps, and the others
 * those that they take without it. */
Test(adaptive_bdf, a_wisp_whose_model_fails_does_not_hold_others_back) {
    check_lanes(4, "order=2", BENDING_SKIP, WISP_GENERALISED, 2);
    check_lanes(4, "order=3", BENDING_SKIP, WISP_PENALTY, 1);
    check_lanes(8, "order=2", BENDING_SKIP, WISP_PENALTY, 6);
}

/* Diagnoses look at all wisps of a part at one time, so they are then one by one: in scenes with
 * contacts, and wisps that split, states have the same bits, on any number of threads. */
Test(adaptive_bdf, whole_runs_do_not_depend_on_lanes_or_threads) {
    static const char *const scenes[][2] = {{"shake", "duration=0.2"},
                                            {"viscosity", "duration=0.2"},
                                            {"subdivision", "duration=0.4"},
                                            {"wind", "duration=0.1"}};
    for (int s = 0; s < 4; s++) {
        struct scene *scene = LAB_LOAD(scenes[s][0], scenes[s][1]);
        struct run_request request = {.stepper = "bdf", .rtol = 1e-3, .atol = 1e-6};
        struct lab_sum packed, single;
        request.diagnostics = 1;
        request.threads = 2;
        lab_sum_run(scene, &request, 1, &single);
        cr_assert(s != 2 || single.result.counters.splits > 0, "nothing splits");
        request.diagnostics = 0;
        for (int lanes = 4; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
            request.threads = lanes / 4;
            lab_take_lanes(lanes);
            lab_sum_run(scene, &request, lanes, &packed);
            lab_same_sum(&packed, &single, scenes[s][0]);
        }
    }
}

/* --- no step is good --- */

static void noise(const struct fixture *f, double t, const double *q, const double *v, double *a) {
    static unsigned seed = 5;
    (void)f, (void)t, (void)q, (void)v;
    a[0] = 1e15 * random_number(&seed);
}

/* A floor ends what no step can satisfy, in some forty tries, with a name. */
Test(adaptive_bdf, stalls_where_no_step_meets_the_tolerances) {
    static struct fixture fixture;
    const struct stepper_settings settings = {.rtol = 1e-9, .atol = 1e-9};
    double q = 0, v = 0, t = 0;
    int code = 0;
    fixture_begin(&fixture, "noise", 1, 0, MATRIX_AVAILABLE);
    fixture.rate = noise;
    fixture.jacobians = no_changes;
    struct stepper *stepper = stepper_create(stepper_find("bdf"), &settings, &fixture.system);
    cr_assert(stepper, "no memory");
    for (int k = 0; k < 10 && !code; k++)
        code = stepper->method->advance(stepper, &t, 1, &q, &v);
    cr_assert(code == -STEP_TOO_SMALL && strstr(fixture.system.reason, "stalled"), "%d: %s", code,
              fixture.system.reason);
    cr_assert_lt(fixture.system.counters.rejected_steps, 60);
    stepper->method->free(stepper);
}

/* --- CVODE's lanes --- */

static void run_lanes(const struct scene *scene, const char *option, struct lab_run *run) {
    const struct run_request request = {.stepper = "cvode",
                                        .rtol = 1e-5,
                                        .atol = 1e-8,
                                        .options = &option,
                                        .option_count = option != NULL};
    lab_finish(scene, &request, run);
}

/* Four wisps that share an integrator share its steps, and are as near to the truth as one by one;
 * their bits depend on each other, which is why that is not the default. */
Test(adaptive_bdf, cvode_steps_four_wisps_at_once_where_asked) {
    static const char *const wisps[] = {"duration=0.3",
                                        "wisps=(" WISP_A "," WISP_B "," WISP_D "," WISP_E ")"};
    struct scene *scene = lab_load("swing-envelope", wisps, 2);
    struct scene *alone = LAB_LOAD("swing-envelope", "duration=0.3", "wisps=(" WISP_A ")");
    struct lab_run exact, one, four, first;
    lab_run(scene, &(struct run_request){.stepper = "reference", .rtol = 1e-9, .atol = 1e-9},
            &exact);
    run_lanes(scene, NULL, &one);
    run_lanes(scene, "lanes=4", &four);
    run_lanes(alone, "lanes=4", &first);
    const double error = lab_distance(&one, &exact, 1, 2).rms,
                 shared = lab_distance(&four, &exact, 1, 2).rms;
    cr_log_info("errors %.2e and %.2e, steps %lld and %lld", error, shared,
                one.result.counters.steps, four.result.counters.steps);
    cr_assert(shared < 5 * error, "%.2e, and %.2e one by one", shared, error);
    cr_assert_eq(four.result.counters.steps % 4, 0);
    cr_assert_neq(four.result.counters.steps, one.result.counters.steps);
    cr_assert_neq(memcmp(four.row + four.rows * four.columns * (four.frames - 1) + 1,
                         first.row + first.rows * first.columns * (first.frames - 1) + 1,
                         (size_t)(first.columns * first.rows - 1) * sizeof(double)),
                  0, "company has no bits");
}

Test(adaptive_bdf, cvode_refuses_lanes_to_solvers_of_one) {
    struct scene *scene = LAB_LOAD("swing", "duration=0.1");
    const char *option = "lanes=4";
    struct run_request request = {
        .stepper = "cvode", .linear = "klu", .options = &option, .option_count = 1};
    char reason[REASON_SIZE];
    struct settings settings;
    cr_assert(settings_resolve(scene, &request, &settings, reason) == REFUSED &&
                  strstr(reason, "klu takes one wisp only"),
              "%s", reason);
    request.linear = "direct";
    settings = settings_of(scene, &request);
    json_t *json = settings_to_json(scene, &settings);
    cr_assert_str_eq(json_string_value(json_object_get(json_object_get(json, "options"), "lanes")),
                     "4");
    json_decref(json);
}
