/* The same bits twice: every stepper on every treatment that it supports, in two processes. */
#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

struct repetition {
    const char *scene, *duration, *treatment, *folder;
    const struct stepper_method *last; /* that was compared */
    int compared;                      /* steppers */
};

static void check_twice(struct repetition *repetition, const struct variant *variant,
                        const char *linear) {
    char *states[2] = {NULL, NULL};
    for (int i = 0; i < 2; i++) {
        int used = 10;
        const char *words[16] = {
            "run",        repetition->scene,    "--stepper",   variant->method->name,
            "--duration", repetition->duration, "--treatment", repetition->treatment,
            "--out",      repetition->folder};
        if (variant->option) {
            words[used++] = "--option";
            words[used++] = variant->option;
        }
        if (linear) {
            words[used++] = "--linear";
            words[used++] = linear;
        }
        struct finished *f = program_done(NULL, words);
        if (f->code == 1)
            return; /* refused by name: not supported */
        cr_assert_eq(f->code, 0, "%s, %s: exit code %d, %s", variant->name, repetition->treatment,
                     f->code, f->err);
        states[i] = file_read(printed("%s/states.tsv", repetition->folder));
        cr_assert(states[i], "%s: no states", variant->name);
    }
    cr_assert(strcmp(states[0], states[1]) == 0, "%s, %s: two runs differ", variant->name,
              repetition->treatment);
    cr_assert(count_lines(states[0]) > 10, "%s: nothing to compare", variant->name);
    repetition->compared += variant->method != repetition->last;
    repetition->last = variant->method;
}

static void check_variant(const struct variant *variant, void *ctx) {
    const int implicit = (variant->method->capabilities & STEPPER_SOLVES) != 0;
    if (is_tried_elsewhere(variant->method))
        return;
    check_twice(ctx, variant, NULL);
    for (int i = 0; linear_methods[i] && implicit && !variant->option; i++)
        check_twice(ctx, variant, linear_methods[i]->name);
}

/* On each treatment of a scene every stepper is there, with each solver that takes its matrix. */
static void check_scene(const char *scene, const char *duration, const char *folder) {
    struct repetition repetition = {.scene = scene, .duration = duration, .folder = folder};
    struct scene *loaded = lab_load(scene, NULL, 0);
    for (int i = 0; loaded->problem->treatments[i].name; i++) {
        if (loaded->wisp_count > 0 && loaded->wisps->samples == 0 && i > 0)
            break; /* treatments are of samples */
        repetition.treatment = loaded->problem->treatments[i].name;
        int steppers = 0;
        for (int m = 0; stepper_methods[m]; m++) {
            const int solves = (stepper_methods[m]->capabilities & STEPPER_SOLVES) != 0;
            if (is_tried_elsewhere(stepper_methods[m]))
                continue;
            steppers += is_taken(loaded, &(struct run_request){.stepper = stepper_methods[m]->name,
                                                               .treatment = repetition.treatment,
                                                               .linear = solves ? "direct" : NULL});
        }
        repetition.compared = 0;
        repetition.last = NULL;
        each_variant(check_variant, &repetition);
        cr_assert_eq(repetition.compared, steppers, "%s, %s: %d of %d steppers were compared",
                     scene, repetition.treatment, repetition.compared, steppers);
    }
}

Test(repeat, every_stepper_gives_the_same_bits_twice) {
    const char *const folder = folder_make();
    check_scene("circle", "40", folder);
    check_scene("swing", "0.04", folder);
    check_scene("swing-envelope", "0.04", folder);
}
