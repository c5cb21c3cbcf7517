/* The same bits twice: every stepper on every treatment that it supports, in two processes. */
#include "support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

struct repetition {
    const char *treatment, *folder;
    int compared;
};

static void check_variant(const struct variant *variant, void *ctx) {
    struct repetition *repetition = ctx;
    char *states[2] = {NULL, NULL}, path[PATH_SIZE];
    struct finished f;
    for (int i = 0; i < 2; i++) {
        const char *words[16] = {"run",         "circle",
                                 "--stepper",   variant->method->name,
                                 "--duration",  "40",
                                 "--treatment", repetition->treatment,
                                 "--out",       repetition->folder};
        if (variant->option) {
            words[10] = "--option";
            words[11] = variant->option;
        }
        const struct process process = program_start(NULL, words);
        program_wait(&process, &f);
        if (f.code == 1)
            return; /* refused by name: not supported */
        cr_assert_eq(f.code, 0, "%s, %s: exit code %d, %s", variant->name, repetition->treatment,
                     f.code, f.err);
        path_format(path, "%s/states.tsv", repetition->folder);
        states[i] = file_read(path);
        cr_assert(states[i], "%s: no states", variant->name);
    }
    cr_assert(strcmp(states[0], states[1]) == 0, "%s, %s: two runs differ", variant->name,
              repetition->treatment);
    cr_assert(count_lines(states[0]) > 10, "%s: nothing to compare", variant->name);
    repetition->compared++;
    free(states[0]);
    free(states[1]);
}

Test(repeat, every_stepper_gives_the_same_bits_twice) {
    char folder[PATH_SIZE];
    folder_make(folder);
    struct repetition repetition = {.folder = folder};
    int steppers = 0;
    while (stepper_methods[steppers])
        steppers++;
    for (int p = 0; problems[p]; p++) {
        if (strcmp(problems[p]->name, "circle") != 0)
            continue; /* the scene that is run above */
        for (int i = 0; problems[p]->treatments[i].name; i++) {
            repetition.treatment = problems[p]->treatments[i].name;
            repetition.compared = 0;
            each_variant(check_variant, &repetition);
            cr_assert(repetition.compared >= steppers, "%s: only %d of %d steppers were compared",
                      repetition.treatment, repetition.compared, steppers);
        }
    }
    folder_remove(folder);
}
