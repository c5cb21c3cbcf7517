/* The table of configurations: that it fits the registry, that what stands in one chart can be told
 * apart, and that what is asked for and cannot be compared is named. */
#include "integrators/configurations.h"

#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

static struct configuration *choose(unsigned kinds, unsigned capabilities) {
    struct configuration *all = configurations_choose(kinds, capabilities);
    cr_assert(all, "no memory");
    return all;
}

/* In the registry's order each method as it is, once; of the others nobody is called the same. */
Test(configurations, every_method_has_one_that_is_plain) {
    struct configuration *all = choose(CONFIGURATION_PLAIN | CONFIGURATION_COSTLY, 0);
    for (int m = 0; stepper_methods[m]; m++)
        cr_assert(all[m].name && all[m].method == stepper_methods[m] &&
                      strcmp(all[m].stepper, stepper_methods[m]->name) == 0,
                  "place %d is not %s", m, stepper_methods[m]->name);
    free(all);
    all = choose(CONFIGURATION_ANY, 0);
    for (int i = 0; all[i].name; i++)
        for (int k = 0; k < i; k++)
            cr_assert_str_neq(all[i].name, all[k].name);
    free(all);
}

Test(configurations, are_chosen_by_kind_and_capability) {
    struct configuration *all = choose(CONFIGURATION_ANY, STEPPER_SOLVES | STEPPER_ADAPTIVE);
    cr_assert(all[0].name && strcmp(all[0].stepper, "arkode-dirk") == 0 && all[1].name);
    for (int i = 1; all[i].name; i++)
        cr_assert_str_eq(all[i].stepper, "cvode");
    free(all);
    all = choose(CONFIGURATION_FORMULA, 0);
    cr_assert(all[0].name && strcmp(all[0].name, "cvode adams") == 0 && !all[1].name);
    free(all);
}

/* Where they say nothing they are complete, and each runs on a wisp or is refused by its name. */
Test(configurations, are_complete_and_run) {
    struct scene *scene = LAB_LOAD("swing-envelope", "duration=0.01");
    struct configuration *all = choose(CONFIGURATION_ANY, 0);
    for (int i = 0; all[i].name; i++) {
        int options = 0;
        while (all[i].options && all[i].options[options])
            options++;
        const struct run_request request = {.stepper = all[i].stepper,
                                            .treatment = "generalised",
                                            .linear = all[i].linear,
                                            .options = all[i].options,
                                            .option_count = options};
        const int adaptive = (all[i].method->capabilities & STEPPER_ADAPTIVE) != 0;
        cr_assert(is_taken(scene, &request), "%s", all[i].name);
        cr_assert(adaptive ? all[i].finest > 0 && all[i].order > 0 : all[i].cost > 0, "%s",
                  all[i].name);
    }
    free(all);
}

static int same_method(const struct configuration *a, const struct configuration *b) {
    return a->method == b->method;
}

/* Colours are methods', and are not shared; marks are not shared by variants of a method, nor by
 * methods as they are. */
Test(configurations, of_one_chart_can_be_told_apart) {
    static const struct {
        unsigned kinds, capabilities;
    } charts[] = {
        {CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_SOLVER |
             CONFIGURATION_SOLVER_ITERATED | CONFIGURATION_ORDER | CONFIGURATION_LANES,
         0}, /* more than ladder and work-precision */
        {CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_FORMULA, 0}, /* circle */
        {CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_SOLVER | CONFIGURATION_ORDER |
             CONFIGURATION_SOLVER_DETAILS,
         STEPPER_SOLVES}, /* solvers */
    };
    for (size_t c = 0; c < sizeof charts / sizeof *charts; c++) {
        struct configuration *all = choose(charts[c].kinds, charts[c].capabilities);
        for (int i = 0; all[i].name; i++) {
            cr_assert(all[i].mark >= 1 && all[i].mark <= 15 && all[i].mark != 2, "%s", all[i].name);
            for (int k = 0; k < i; k++) {
                cr_assert((strcmp(all[i].colour, all[k].colour) == 0) ==
                              same_method(&all[i], &all[k]),
                          "%s and %s: colour %s", all[i].name, all[k].name, all[i].colour);
                const int variants = same_method(&all[i], &all[k])
                                         ? 0
                                         : (all[i].kind | all[k].kind) != CONFIGURATION_PLAIN;
                cr_assert(variants || all[i].mark != all[k].mark, "%s and %s: mark %d", all[i].name,
                          all[k].name, all[i].mark);
            }
        }
        free(all);
    }
}

/* Names of treatments and solvers in the facts of methods are names of something. */
Test(configurations, facts_name_what_there_is) {
    for (int m = 0; stepper_methods[m]; m++) {
        const struct stepper_method *method = stepper_methods[m];
        cr_assert_geq(wisp_problem.default_treatment(method), 0, "%s", method->name);
        cr_assert(!(method->capabilities & STEPPER_SOLVES) ||
                      linear_find(wisp_problem.default_linear(method)),
                  "%s", method->name);
    }
}

/* A key is not another one that begins with it; the last of a key counts. */
Test(configurations, options_are_those_that_were_given_last) {
    static const struct option_spec spec = {
        .name = "cg", .kind = OPTION_REAL, .initial = 3, .least = 0, .most = 10};
    static const char *const given[] = {"cg.tolerance=1", "cg=5", "cgs=7", "cg=6"};
    cr_assert_eq(option_value(&(struct options){given, 0}, &spec), 3);
    cr_assert_eq(option_value(&(struct options){given, 1}, &spec), 3);
    cr_assert_eq(option_value(&(struct options){given, 3}, &spec), 5);
    cr_assert_eq(option_value(&(struct options){given, 4}, &spec), 6);
}

Test(configurations, lanes_and_usual_rates_are_facts_with_defaults) {
    struct stepper_method method = {.step = NULL};
    struct settings settings = {.method = &method, .lanes = 8};
    cr_assert_eq(settings_lanes(&settings), 8);
    settings.diagnostics = 1; /* of sums over parts */
    cr_assert_eq(settings_lanes(&settings), 4);
    settings.diagnostics = 0;
    cr_assert_eq(stepper_usual_rate(&method), 9000);
    method.capabilities = STEPPER_IMPLICIT | STEPPER_ADAPTIVE;
    cr_assert_eq(settings_lanes(&settings), 1);
    cr_assert_eq(stepper_usual_rate(&method), 300);
    method.lanes = 3;
    method.usual_rate = 77;
    cr_assert_eq(settings_lanes(&settings), 3);
    cr_assert_eq(stepper_usual_rate(&method), 77);
}

/* --- what is asked for and cannot be --- */

Test(configurations, a_stepper_that_takes_no_part_is_named) {
    static const struct {
        const char *experiment, *stepper, *says;
    } rows[] = {
        {"solvers", "rk4", "implicit-euler, cvode"},
        {"solvers", "reference", "implicit-euler, cvode"},
        {"kernel", "rk4", "kernel"},
        {"needs", "rk4", "leave out --stepper"},
        {"treatments", "rk4", "leave out --stepper"},
    };
    const char *const folder = folder_make();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        FAILS(1, rows[i].says, "experiment", rows[i].experiment, "--quick", "--stepper",
              rows[i].stepper, "--out", folder);
        cr_assert_eq(count_files(folder, ""), 0, "%s leaves files", rows[i].experiment);
    }
}
