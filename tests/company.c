/* A wisp's bits do not depend on its company: neither on who else is in the scene, nor on the order
 * of the file, and so not on who shares its part and how wide that is. In whole runs, of every
 * stepper, with every linear solver and every option. */
#include "integrators/configurations.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

/* --- wisps in company --- */

static const char *const entries[] = {
    "{ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0]; length = 0.30; nodes = 11; }",
    "{ root = [0.1, 0.0, 0.2]; direction = [1.0, 0.3, 0.2]; length = 0.25; nodes = 11; }",
    "{ root = [0.0, 0.2, 0.0]; direction = [0.0, 1.0, 0.1]; length = 0.20; nodes = 7; }",
    "{ root = [0.3, 0.0, 0.0]; direction = [-1.0, 0.2, 1.0]; length = 0.30; nodes = 11; }",
    "{ root = [0.0, 0.0, 0.4]; direction = [0.2, -1.0, 0.0]; length = 0.20; nodes = 7; }",
    "{ root = [0.0, 0.5, 0.0]; direction = [1.0, 1.0, 1.0]; length = 0.35; nodes = 11; }",
};
enum { ENTRIES = sizeof entries / sizeof *entries };

static const int plain[ENTRIES] = {0, 1, 2, 3, 4, 5}, mixed[ENTRIES] = {4, 3, 0, 5, 2, 1};

/* A scene file with these entries in this order. */
static struct scene *scene_of_entries(const int *order, int count) {
    char text[2000];
    int used = snprintf(
        text, sizeof text,
        "duration = 0.04; frame_rate = 50.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
        "envelope = { radius = 0.01; };\n"
        "wind = { kind = \"irregular\"; velocity = [1.0, 0.5, 2.0];\n"
        "         amplitudes = [0.5, 0.2]; frequencies = [2.0, 7.0]; };\n"
        "run = { step = 2e-4; rtol = 1e-5; atol = 1e-8; };\n"
        "wisps = (");
    for (int i = 0; i < count; i++)
        used += snprintf(text + used, sizeof text - (size_t)used, "%s\n%s", i ? "," : "",
                         entries[order[i]]);
    snprintf(text + used, sizeof text - (size_t)used, ");\n");
    return lab_read(text);
}

/* The rows of one wisp in the frames that both runs have, behind the column that numbers it. */
static void compare_wisp(const struct lab_run *a, int first_a, const struct lab_run *b, int first_b,
                         int nodes, const char *what) {
    for (int f = 0; f < a->frames && f < b->frames; f++)
        for (int i = 0; i < nodes; i++) {
            const double *x = a->row + (f * a->rows + first_a + i) * a->columns,
                         *y = b->row + (f * b->rows + first_b + i) * b->columns;
            cr_assert_eq(memcmp(x + 1, y + 1, (size_t)(a->columns - 1) * sizeof *x), 0,
                         "%s: other bits in frame %d, node %d", what, f, i);
        }
}

/* The wisps in two orders, and some of them alone. */
struct company {
    struct scene *plain, *mixed, *alone[2];
    int first_plain[ENTRIES], first_mixed[ENTRIES];
};

static void first_rows(const struct scene *scene, int *first) {
    first[0] = 0;
    for (int i = 1; i < scene->wisp_count; i++)
        first[i] = first[i - 1] + scene->wisps[i - 1].nodes;
}

static void make_company(struct company *c) {
    c->plain = scene_of_entries(plain, ENTRIES);
    c->mixed = scene_of_entries(mixed, ENTRIES);
    for (int i = 0; i < 2; i++)
        c->alone[i] = scene_of_entries(&mixed[i], 1);
    first_rows(c->plain, c->first_plain);
    first_rows(c->mixed, c->first_mixed);
}

/* The wisps in one order in parts of four, in the other in parts of eight, and alone.
 *
 * Whether there was something to compare: a run that is refused, or that fails before its first
 * frame, says nothing. One that fails later ends for all wisps at once. */
static int keeps_bits(const struct company *c, const struct run_request *request,
                      const char *what) {
    struct settings settings;
    struct lab_run a, b, single;
    char reason[REASON_SIZE];
    if (settings_resolve(c->plain, request, &settings, reason))
        return 0;
    lab_take_lanes(4);
    lab_run(c->plain, request, &a);
    lab_take_lanes(8);
    lab_run(c->mixed, request, &b);
    lab_take_lanes(1);
    cr_assert_eq(a.frames, b.frames, "%s: %d and %d frames", what, a.frames, b.frames);
    cr_assert_eq(a.result.counters.newton_iterations, b.result.counters.newton_iterations,
                 "%s: %lld and %lld iterations", what, a.result.counters.newton_iterations,
                 b.result.counters.newton_iterations);
    for (int i = 0; i < ENTRIES; i++) {
        const int e = mixed[i], nodes = c->plain->wisps[e].nodes;
        compare_wisp(&a, c->first_plain[e], &b, c->first_mixed[i], nodes, what);
    }
    for (int i = 0; i < 2; i++) {
        const int e = mixed[i];
        lab_run(c->alone[i], request, &single);
        compare_wisp(&a, c->first_plain[e], &single, 0, c->plain->wisps[e].nodes, what);
    }
    return a.frames > 1;
}

/* --- options --- */

/* An option at a value that is not its default, and whether a run with it could be compared. */
struct choice {
    const struct option_spec *spec;
    char text[80]; /* "key=value" */
    int compared;
};

enum { CHOICES_MAX = 64 };

struct choices {
    int count;
    struct choice choice[CHOICES_MAX];
};

static void add_number(struct choices *all, const struct option_spec *spec, double value) {
    const double inside = fmin(fmax(value, spec->least), spec->most);
    if (inside == spec->initial)
        return;
    cr_assert_lt(all->count, CHOICES_MAX, "more options than there is room for");
    struct choice *choice = &all->choice[all->count++];
    *choice = (struct choice){.spec = spec};
    snprintf(choice->text, sizeof choice->text, "%s=%.17g", spec->name, inside);
}

/* Each other choice; numbers on both sides of the default. */
static void add_choices(struct choices *all, const struct option_spec *spec) {
    const double middle = spec->initial != 0 ? spec->initial : (spec->least + spec->most) / 2;
    switch (spec->kind) {
    case OPTION_COUNT:
        add_number(all, spec, spec->least);
        add_number(all, spec, spec->initial + 2);
        add_number(all, spec, 10 * spec->initial + 10);
        break;
    case OPTION_REAL:
        add_number(all, spec, middle / 100);
        add_number(all, spec, middle * 100);
        break;
    case OPTION_CHOICE:
        for (int i = 0; spec->choices[i]; i++) {
            if (i == (int)spec->initial)
                continue;
            cr_assert_lt(all->count, CHOICES_MAX, "more options than there is room for");
            struct choice *choice = &all->choice[all->count++];
            *choice = (struct choice){.spec = spec};
            snprintf(choice->text, sizeof choice->text, "%s=%s", spec->name, spec->choices[i]);
        }
    }
}

/* All options but one, or NULL. */
static void list_choices(struct choices *all, const struct option_spec *specs,
                         const struct option_spec *but) {
    for (; specs && specs->name; specs++)
        if (specs != but)
            add_choices(all, specs);
}

static void try_choices(const struct company *c, const struct run_request *request, const char *who,
                        struct choice *one, struct choice *other) {
    const char *options[] = {one->text, other ? other->text : NULL};
    struct run_request with = *request;
    with.options = options;
    with.option_count = other ? 2 : 1;
    const char *const what = printed("%s %s %s", who, one->text, other ? other->text : "");
    const int compared = keeps_bits(c, &with, what);
    one->compared |= compared;
    if (other)
        other->compared |= compared;
}

/* Whether wisps share parts: two options may then meet in what they share. */
static int has_company(const struct company *c, const struct run_request *request) {
    struct settings settings;
    char reason[REASON_SIZE];
    lab_take_lanes(LAB_LANES);
    return settings_resolve(c->plain, request, &settings, reason) == 0 &&
           settings_lanes(&settings) > 1;
}

/* A stepper with a linear solver, or NULL: as it is, with each option, with each two. */
static void check_options(const struct company *c, const struct stepper_method *method,
                          const struct linear_method *linear, int treatment) {
    static struct choices all;
    const struct run_request request = {.stepper = method->name,
                                        .treatment = treatment_names[treatment],
                                        .linear = linear ? linear->name : NULL};
    const char *const who =
        printed("%s, %s, %s:", method->name, linear ? linear->name : "no solver",
                treatment_names[treatment]);
    if (!keeps_bits(c, &request, who))
        return; /* a solver that does not take this treatment's matrix */
    all.count = 0;
    list_choices(&all, method->options, method->shared_steps);
    list_choices(&all, linear ? linear->options : NULL, NULL);
    for (int i = 0; i < all.count; i++)
        try_choices(c, &request, who, &all.choice[i], NULL);
    for (int i = 0; i < all.count && has_company(c, &request); i++)
        for (int j = 0; j < i; j++)
            if (all.choice[i].spec != all.choice[j].spec)
                try_choices(c, &request, who, &all.choice[i], &all.choice[j]);
    for (int i = 0; i < all.count; i++) {
        int compared = 0;
        for (int j = 0; j < all.count; j++)
            compared |= all.choice[j].spec == all.choice[i].spec && all.choice[j].compared;
        cr_assert(compared, "%s no value of %s could be tried", who, all.choice[i].spec->name);
    }
}

static void check_steppers(unsigned capability, unsigned wanted) {
    struct company company;
    make_company(&company);
    for (int m = 0; stepper_methods[m]; m++) {
        const struct stepper_method *method = stepper_methods[m];
        const int solves = (method->capabilities & STEPPER_SOLVES) != 0;
        if ((method->capabilities & capability) != wanted || is_tried_elsewhere(method))
            continue;
        const int costly = configuration_of(method).kind == CONFIGURATION_COSTLY;
        for (int treatment = 0; treatment < TREATMENTS; treatment++) {
            if (costly && treatment != WISP_GENERALISED)
                continue; /* company is the same everywhere, and these take minutes */
            if (!solves)
                check_options(&company, method, NULL, treatment);
            for (int l = 0; solves && linear_methods[l]; l++)
                check_options(&company, method, linear_methods[l], treatment);
        }
    }
}

Test(company, bits_of_fixed_steps_do_not_depend_on_it_for_any_option) {
    check_steppers(STEPPER_ADAPTIVE, 0);
}

Test(company, bits_of_adaptive_steps_do_not_depend_on_it_for_any_option) {
    check_steppers(STEPPER_ADAPTIVE, STEPPER_ADAPTIVE);
}
