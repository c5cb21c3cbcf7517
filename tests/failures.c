/* Callbacks that fail, and numbers that are not finite. */
#include "fixture.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 3 };

/* A stepper on a chain, about to be failed. */
struct trial {
    const struct variant *variant;
    struct fixture fixture;
    struct stepper_settings settings;
    struct stepper *stepper;
    double t, q[N], v[N];
};

/* Returns 0 where the variant does not run on the chain. */
static int open_trial(struct trial *trial, const struct variant *variant, int projection) {
    *trial = (struct trial){.variant = variant, .q = {1, 0, -1}, .v = {0, 0.5, 0}};
    fixture_chain(&trial->fixture, N, 7, 1);
    if (projection)
        fixture_add_projection(&trial->fixture);
    trial->settings = variant_settings(variant, 1e-6, 1e-8);
    if (stepper_refuse(variant->method, &trial->settings, &trial->fixture.system))
        return 0;
    trial->stepper = stepper_create(variant->method, &trial->settings, &trial->fixture.system);
    cr_assert(trial->stepper, "%s cannot be made", variant->name);
    return 1;
}

static int step_once(struct trial *trial) {
    const struct stepper_method *method = trial->variant->method;
    if (method->advance)
        return method->advance(trial->stepper, &trial->t, 100, trial->q, trial->v);
    const int code = method->step(trial->stepper, trial->t, 0.05, trial->q, trial->v);
    if (!code)
        trial->t += 0.05;
    return code;
}

/* Steps until a callback has failed, or 100 steps were fine. Returns the code of the last, and
 * checks that a failure left t, q and v as they were, bit for bit, and a reason. */
static int step_until_failure(struct trial *trial, const char *what, int k) {
    const struct trial *now = trial;
    for (int i = 0; i < 100; i++) {
        double q[N], v[N];
        const double t = trial->t;
        memcpy(q, trial->q, sizeof q);
        memcpy(v, trial->v, sizeof v);
        trial->fixture.system.reason[0] = '\0';
        const int code = step_once(trial);
        if (!code && !trial->fixture.failures)
            continue;
        if (code) {
            cr_assert(now->t == t && memcmp(q, now->q, sizeof q) == 0 &&
                          memcmp(v, now->v, sizeof v) == 0,
                      "%s changed the state in a step whose call %d of %s failed",
                      trial->variant->name, k, what);
            cr_assert(strstr(trial->fixture.system.reason, "told to fail"),
                      "%s, call %d of %s: the reason is lost: '%s'", trial->variant->name, k, what,
                      trial->fixture.system.reason);
        }
        return code;
    }
    return 0;
}

/* After a failure: the callback works again, and the stepper goes on from where it was, after a
 * reset where it has one, as if it had just been made. */
static void check_going_on(struct trial *trial, const char *what, int k) {
    const struct stepper_method *method = trial->variant->method;
    struct trial other = *trial;
    trial->fixture.fail_at = 0;
    if (method->reset)
        cr_assert_eq(method->reset(trial->stepper, ~0u), 0, "%s cannot be reset",
                     trial->variant->name);
    cr_assert_eq(step_once(trial), 0, "%s does not go on after call %d of %s failed: %s",
                 trial->variant->name, k, what, trial->fixture.system.reason);
    cr_assert(isfinite(trial->q[0] + trial->v[0]) && fabs(trial->q[0]) < 10,
              "%s goes on wildly after call %d of %s failed", trial->variant->name, k, what);
    if (method->capabilities & STEPPER_ADAPTIVE)
        return;

    /* A method of fixed steps has no history: a new one does the same, to the bit. */
    other.fixture.fail_at = 0;
    other.fixture.system.ctx = &other.fixture;
    other.fixture.reports_to = &other.fixture.system;
    other.fixture.system.pattern = &other.fixture.pattern;
    other.stepper = stepper_create(method, &other.settings, &other.fixture.system);
    cr_assert(other.stepper, "no memory");
    cr_assert_eq(step_once(&other), 0, "%s", other.fixture.system.reason);
    cr_assert(memcmp(other.q, trial->q, sizeof other.q) == 0 &&
                  memcmp(other.v, trial->v, sizeof other.v) == 0,
              "%s remembers the failure of call %d of %s", trial->variant->name, k, what);
    method->free(other.stepper);
}

enum { ONCE_FATAL, ONCE_RECOVERABLE, FOR_EVER_RECOVERABLE };

/* Fixed-step methods pass the code on. Adaptive ones give up at once where it is negative; where it
 * is positive they try smaller steps, which succeed if the failure was a single one, and else say
 * that smaller steps do not help: negative. The one failure that they may not survive is that of
 * the first call, before there is a step. */
static void check_failure(const struct variant *variant, enum fixture_call call, int manner,
                          int k) {
    static struct trial trial;
    const char *what = fixture_call_names[call];
    if (!open_trial(&trial, variant, call == CALL_PROJECT))
        return;
    trial.fixture.fail_call = call;
    trial.fixture.fail_at = k;
    trial.fixture.fail_code = manner == ONCE_FATAL ? -MODEL_FAILED : MODEL_FAILED;
    trial.fixture.fail_on = manner == FOR_EVER_RECOVERABLE;
    const int code = step_until_failure(&trial, what, k);
    if (!trial.fixture.failures) {
        variant->method->free(trial.stepper); /* it does not use that operation */
        return;
    }
    const int adaptive = (variant->method->capabilities & STEPPER_ADAPTIVE) != 0;
    if (!adaptive)
        cr_assert_eq(code, trial.fixture.fail_code, "%s returned %d where call %d of %s gave %d",
                     variant->name, code, k, what, trial.fixture.fail_code);
    else if (manner == FOR_EVER_RECOVERABLE || manner == ONCE_FATAL)
        cr_assert_eq(code, -MODEL_FAILED, "%s returned %d (%s) where call %d of %s failed %s",
                     variant->name, code, outcome_name((enum outcome)abs(code)), k, what,
                     manner == ONCE_FATAL ? "fatally" : "from then on");
    else
        cr_assert(code == 0 || code == -MODEL_FAILED, "%s returned %d after one failure of %s",
                  variant->name, code, what);
    check_going_on(&trial, what, k);
    variant->method->free(trial.stepper);
}

static void check_variant(const struct variant *variant, void *ctx) {
    const int manner = *(const int *)ctx;
    for (int call = 0; call < FIXTURE_CALLS; call++)
        for (int k = 1; k <= 20; k++)
            check_failure(variant, (enum fixture_call)call, manner, k);
}

Test(failures, a_fatal_failure_of_any_call_leaves_the_state) {
    each_variant(check_variant, &(int){ONCE_FATAL});
}

Test(failures, a_recoverable_failure_of_any_call_leaves_the_state) {
    each_variant(check_variant, &(int){ONCE_RECOVERABLE});
}

Test(failures, a_failure_for_ever_ends_every_method) {
    each_variant(check_variant, &(int){FOR_EVER_RECOVERABLE});
}

/* The tests above would be empty if the callbacks were not used. */
static void check_use(const struct variant *variant, void *ctx) {
    static struct trial trial;
    (void)ctx;
    if (!open_trial(&trial, variant, 1) && !open_trial(&trial, variant, 0))
        cr_assert_fail("%s runs on no chain: %s", variant->name, trial.fixture.system.reason);
    for (int i = 0; i < 5; i++)
        cr_assert_eq(step_once(&trial), 0, "%s", trial.fixture.system.reason);
    const int *calls = trial.fixture.calls;
    cr_assert(calls[CALL_ACCELERATION], "%s asks for no acceleration", variant->name);
    const int projects = trial.fixture.system.ops->project != NULL;
    cr_assert(!projects || calls[CALL_PROJECT], "%s projects nothing", variant->name);
    const int newton = (variant->method->capabilities & STEPPER_SOLVES) &&
                       !(variant->option && strcmp(variant->option, "nonlinear=fixed-point") == 0);
    cr_assert(!newton || (calls[CALL_LINEARISE] && calls[CALL_FACTOR]), "%s solves nothing",
              variant->name);
    variant->method->free(trial.stepper);
}

Test(failures, every_method_uses_the_callbacks) {
    each_variant(check_use, NULL);
}

/* --- models that fail from a call on, to the end of the run --- */

/* A run of 20 s on the made-up oscillator with this done to it. */
static void run_changed(const struct variant *variant, void (*change)(struct fixture *fixture),
                        const struct observer *observer, struct run_result *result) {
    fixture_start = (struct fixture_start){.make = fixture_manufactured, .change = change, .v = 1};
    struct scene *scene = fixture_scene(20, 10, 0.1);
    const struct run_request request = {.stepper = variant->method->name,
                                        .options = &variant->option,
                                        .option_count = variant->option != NULL};
    const struct settings settings = settings_of(scene, &request);
    simulate(scene, &settings, observer, NULL, result);
}

static void nan_from_call_30(struct fixture *fixture) {
    fixture->fail_call = CALL_ACCELERATION;
    fixture->fail_at = 30;
    fixture->fail_on = 1;
    fixture->nan = 1;
}

static int finite_frames(void *ctx, const struct model *model, double t, const double *rows) {
    (void)model, (void)t;
    int *frames = ctx;
    cr_assert(isfinite(rows[2]) && isfinite(rows[5]), "a frame that is not finite is shown");
    ++*frames;
    return 0;
}

/* A model whose accelerations turn to NaN is never finished, whatever the method makes of it. */
static void check_nan(const struct variant *variant, void *ctx) {
    (void)ctx;
    struct run_result result;
    int frames = 0;
    run_changed(variant, nan_from_call_30, &(struct observer){finite_frames, &frames}, &result);
    cr_assert(result.outcome == NOT_FINITE, "%s: '%s' (%s) where accelerations are NaN",
              variant->name, outcome_name(result.outcome), result.reason);
    cr_assert(result.time < 20 && result.reason[0], "%s: says nothing of when and why",
              variant->name);
    cr_assert_eq(result.frames, frames, "%s: %d frames counted, %d shown", variant->name,
                 result.frames, frames);
}

Test(failures, accelerations_that_are_not_finite_never_finish) {
    each_variant(check_nan, NULL);
}

static void recoverable_for_ever(struct fixture *fixture) {
    fixture->fail_call = CALL_ACCELERATION;
    fixture->fail_at = 30;
    fixture->fail_on = 1;
    fixture->fail_code = MODEL_FAILED;
}

/* What failed is what the run reports, with the time it had reached. */
static void check_model_failure(const struct variant *variant, void *ctx) {
    (void)ctx;
    struct run_result result;
    run_changed(variant, recoverable_for_ever, NULL, &result);
    cr_assert_eq(result.outcome, MODEL_FAILED, "%s: '%s' (%s) where the model failed",
                 variant->name, outcome_name(result.outcome), result.reason);
    cr_assert(strstr(result.reason, "told to fail"), "%s: the reason is '%s'", variant->name,
              result.reason);
    cr_assert(result.time >= 0 && result.time < 20, "%s: failed at %g s", variant->name,
              result.time);
}

Test(failures, a_failing_model_is_reported_as_such) {
    each_variant(check_model_failure, NULL);
}

/* --- the constraint, where it has no direction --- */

static int one_step_at(const struct stepper_method *method, int treatment, double x, double *q,
                       double *v, char *reason) {
    struct scene *scene = circle_scene(1, 0);
    const struct variant variant = {.method = method};
    const struct stepper_settings settings = variant_settings(&variant, 1e-6, 1e-9);
    struct model *model = lab_model(scene, treatment, 1);
    struct part *part = &model->parts[0];
    struct stepper *stepper = stepper_create(method, &settings, &part->system);
    double t = 0;
    part->q[0] = q[0] = x;
    part->q[1] = q[1] = 0;
    const int code = method->advance ? method->advance(stepper, &t, 0.1, part->q, part->v)
                                     : method->step(stepper, t, 0.1, part->q, part->v);
    memcpy(q, part->q, 2 * sizeof *q);
    memcpy(v, part->v, 2 * sizeof *v);
    snprintf(reason, REASON_SIZE, "%s", part->system.reason);
    method->free(stepper);
    return code;
}

Test(failures, the_centre_of_the_circle_is_refused_by_name) {
    int elsewhere = 0;
    for (int m = 0; stepper_methods[m]; m++)
        for (int treatment = 0; treatment < 2; treatment++) {
            double q[2], v[2];
            if (treatment == 1 && !(stepper_methods[m]->capabilities & STEPPER_PROJECTS))
                continue; /* refused */
            char reason[REASON_SIZE];
            const int code = one_step_at(stepper_methods[m], treatment, 0, q, v, reason);
            if (code == 0 && (treatment == 1 || hypot(q[0], q[1]) < 0.1) && v[1] != -0.2) {
                elsewhere++; /* it drifts away before it asks, and is projected from there */
                continue;
            }
            cr_assert_eq(abs(code), MODEL_FAILED, "%s at the centre: %d", stepper_methods[m]->name,
                         code);
            cr_assert(strstr(reason, "centre"), "%s: '%s'", stepper_methods[m]->name, reason);
            cr_assert(q[0] == 0 && q[1] == 0 && v[0] == 0 && v[1] == -0.2,
                      "%s changed the state at the centre", stepper_methods[m]->name);
        }
    cr_assert_leq(elsewhere, 2, "%d runs do not fail", elsewhere);
}
