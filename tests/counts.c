/* What a step costs, as a contract; and that counters count what happens. */
#include "fixture.h"
#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

/* Evaluations of a step: as many as stages, and where there is no table, one or more, the same in
 * each. */
static int evaluations_fit(const struct stepper_method *method, const struct counters *c) {
    return method->table ? c->force_evaluations == c->steps * method->table->stages
                         : c->force_evaluations >= c->steps && c->force_evaluations % c->steps == 0;
}

/* The circle's treatments through every fixed-step method: exactly so many steps, each of exactly
 * so many evaluations. */
Test(counts, explicit_methods_evaluate_the_force_once_per_stage) {
    struct scene *scene = circle_scene(16, 0);
    for (int m = 0; stepper_methods[m]; m++) {
        const struct stepper_method *method = stepper_methods[m];
        if (method->capabilities & (STEPPER_ADAPTIVE | STEPPER_IMPLICIT))
            continue;
        for (int i = 0; scene->problem->treatments[i].name; i++) {
            struct orbit orbit;
            const char *treatment = scene->problem->treatments[i].name;
            const struct run_request request = {
                .stepper = method->name, .treatment = treatment, .step = 0.5};
            if (!is_taken(scene, &request))
                continue;
            run_circle(scene, &request, &orbit);
            const struct counters *c = &orbit.result.counters;
            cr_assert_eq(c->steps, 32, "%s, %s: %lld steps", method->name, treatment, c->steps);
            cr_assert(evaluations_fit(method, c), "%s, %s: %lld evaluations in 32 steps",
                      method->name, treatment, c->force_evaluations);
            cr_assert_eq(c->projections, strcmp(treatment, "projection") == 0 ? 32 : 0,
                         "%s, %s: %lld projections", method->name, treatment, c->projections);
            cr_assert_eq(c->rejected_steps + c->linear_solves + c->newton_iterations + c->restarts,
                         0, "%s counts what it does not do", method->name);
            cr_assert_eq(orbit.result.frames, 33, "%s: %d frames", method->name,
                         orbit.result.frames);
        }
    }
}

/* The numbers that the chart of cost is drawn from. */
Test(counts, of_the_circle_test) {
    static const struct {
        const char *stepper;
        double step;
        int evaluations;
    } rows[] = {{"euler", 0.8, 200}, {"midpoint", 1.6, 200}, {"rk4", 3.2, 200}};
    struct scene *scene = circle_scene(160, 0);
    for (int i = 0; i < 3; i++) {
        struct orbit orbit;
        run_circle(scene, &(struct run_request){.stepper = rows[i].stepper, .step = rows[i].step},
                   &orbit);
        cr_assert_eq(orbit.result.counters.force_evaluations, rows[i].evaluations,
                     "%s at %g s: %lld evaluations, not %d", rows[i].stepper, rows[i].step,
                     orbit.result.counters.force_evaluations, rows[i].evaluations);
    }
}

/* Linearised once per step: one of each. Newton's iteration: one of each per iteration. */
Test(counts, of_an_implicit_step) {
    struct scene *scene = circle_scene(16, 0);
    for (int iterated = 0; iterated <= 1; iterated++) {
        const char *option = "newton.iterations=30";
        struct orbit orbit;
        run_circle(scene,
                   &(struct run_request){.stepper = "implicit-euler",
                                         .step = 0.5,
                                         .options = &option,
                                         .option_count = iterated},
                   &orbit);
        const struct counters *c = &orbit.result.counters;
        const long long n = c->newton_iterations;
        cr_assert(iterated ? n > 32 && n < 320 : n == 32, "%lld iterations in 32 steps", n);
        cr_assert_eq(c->steps, 32, "%lld steps", c->steps);
        cr_assert_eq(c->force_evaluations, n, "%lld evaluations", c->force_evaluations);
        cr_assert_eq(c->linearisations, n, "%lld linearisations", c->linearisations);
        cr_assert_eq(c->factorisations, n, "%lld factorisations", c->factorisations);
        cr_assert_eq(c->linear_solves, n, "%lld solves", c->linear_solves);
        cr_assert_eq(c->jacobian_products, 2 * n, "%lld products", c->jacobian_products);
    }
}

/* Every step needs an evaluation, and a step that works needs at most as many iterations as it may
 * make (3, and one more to test the last); what is tried in vain costs as much. */
Test(counts, of_cvode_are_in_a_band) {
    static const char *const options[] = {"method=bdf", "method=adams", "nonlinear=fixed-point"};
    struct scene *scene = circle_scene(160, 0.1);
    for (int i = 0; i < 3; i++) {
        struct orbit orbit;
        run_circle(scene,
                   &(struct run_request){.stepper = "cvode",
                                         .rtol = 1e-6,
                                         .atol = 1e-6,
                                         .options = &options[i],
                                         .option_count = 1},
                   &orbit);
        const struct counters *c = &orbit.result.counters;
        cr_assert_eq(orbit.result.outcome, FINISHED, "%s: %s", options[i], orbit.result.reason);
        cr_assert(c->steps > 100 && c->steps < 4000, "%s: %lld steps", options[i], c->steps);
        cr_assert(c->force_evaluations >= c->steps &&
                      c->force_evaluations <= 4 * (c->steps + c->rejected_steps) + 10,
                  "%s: %lld evaluations in %lld steps", options[i], c->force_evaluations, c->steps);
        cr_assert(c->newton_iterations >= c->steps &&
                      c->newton_iterations <= 3 * (c->steps + c->rejected_steps),
                  "%s: %lld iterations in %lld steps", options[i], c->newton_iterations, c->steps);
        cr_assert(c->rejected_steps < c->steps / 4, "%s: %lld of %lld steps rejected", options[i],
                  c->rejected_steps, c->steps);
        cr_assert_eq(c->restarts, 0, "%s: %lld restarts though nothing happens", options[i],
                     c->restarts);
        const int newton = strcmp(options[i], "nonlinear=fixed-point") != 0;
        cr_assert(newton ? c->factorisations > c->steps / 5 && c->linear_solves >= c->steps
                         : c->factorisations + c->linear_solves + c->linearisations == 0,
                  "%s: %lld factorisations, %lld solves", options[i], c->factorisations,
                  c->linear_solves);
    }
}

/* The counters against the model's own count of its calls, for whatever a library does behind the
 * steppers' backs: a part of 4 lanes with 3 wisps counts 3. */
static void check_calls(const struct variant *variant, void *ctx) {
    static struct fixture fixture;
    const char *const *linear_name = ctx;
    double q[4] = {1, 0, -1, 0.5}, v[4] = {0};
    struct stepper_settings settings = variant_settings(variant, 1e-5, 1e-7);
    fixture_chain(&fixture, 4, 3, 1);
    fixture_add_projection(&fixture);
    fixture.system.lanes = 4;
    fixture.system.wisps = 3;
    if (settings.linear)
        settings.linear = linear_find(*linear_name);
    if (stepper_refuse(variant->method, &settings, &fixture.system))
        return;
    struct stepper *stepper = stepper_create(variant->method, &settings, &fixture.system);
    cr_assert(stepper, "no memory");
    cr_assert_eq(integrate(stepper, 0, 2, 40, q, v), 0, "%s: %s", variant->name,
                 fixture.system.reason);
    variant->method->free(stepper);

    const struct counters *c = &fixture.system.counters;
    cr_assert_eq(c->force_evaluations, 3LL * fixture.calls[CALL_ACCELERATION],
                 "%s: counts %lld evaluations where 3 wisps had %d", variant->name,
                 c->force_evaluations, fixture.calls[CALL_ACCELERATION]);
    cr_assert_eq(c->linearisations, 3LL * fixture.calls[CALL_LINEARISE], "%s: %lld linearisations",
                 variant->name, c->linearisations);
    cr_assert_eq(c->projections, 3LL * fixture.calls[CALL_PROJECT], "%s: %lld projections",
                 variant->name, c->projections);
    if (settings.linear && strcmp(settings.linear->name, "direct") == 0)
        cr_assert_eq(c->factorisations, 3LL * fixture.calls[CALL_FACTOR], "%s: %lld factorisations",
                     variant->name, c->factorisations);
    cr_assert(fixture.calls[CALL_ACCELERATION] > 0 && fixture.calls[CALL_PROJECT] > 0,
              "%s did nothing", variant->name);
}

Test(counts, agree_with_the_calls_of_the_model) {
    for (int i = 0; linear_methods[i]; i++)
        each_variant(check_calls, (void *)&linear_methods[i]->name);
}
