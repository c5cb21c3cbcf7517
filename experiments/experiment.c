#include "experiment.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

extern const struct experiment circle_experiment, kernel_experiment;

/* A new experiment is one file and one line here. */
const struct experiment *const experiments[] = {
    &circle_experiment,
    &kernel_experiment,
    NULL,
};

const struct experiment *experiment_find(const char *name) {
    for (int i = 0; experiments[i]; i++)
        if (strcmp(experiments[i]->name, name) == 0)
            return experiments[i];
    return NULL;
}

const struct scene *plan_scene(struct plan *plan, const char *name, const char *const *sets,
                               int set_count) {
    struct scene *scene = scene_load(name, sets, set_count, plan->reason);
    struct scene **loaded =
        scene ? realloc(plan->loaded, (size_t)(plan->loaded_count + 1) * sizeof *loaded) : NULL;
    if (!loaded) {
        scene_free(scene);
        return NULL;
    }
    plan->loaded = loaded;
    plan->loaded[plan->loaded_count++] = scene;
    return scene;
}

int plan_wants(const struct plan *plan, const char *stepper) {
    for (int i = 0; i < plan->stepper_count; i++)
        if (strcmp(plan->steppers[i], stepper) == 0)
            return 1;
    return plan->stepper_count == 0;
}

int plan_add(struct plan *plan, const struct scene *scene, const struct run_request *request,
             const char *group, const char *label, ...) {
    if (plan->case_count == plan->case_capacity) {
        const int capacity = 2 * plan->case_capacity + 16;
        struct labelled_case *cases = realloc(plan->cases, (size_t)capacity * sizeof *cases);
        if (!cases) {
            snprintf(plan->reason, REASON_SIZE, "out of memory");
            return -1;
        }
        plan->cases = cases;
        plan->case_capacity = capacity;
    }
    struct labelled_case *new = &plan->cases[plan->case_count];
    *new = (struct labelled_case){.run.scene = scene};
    if (settings_resolve(scene, request, &new->run.settings, plan->reason))
        return -1;
    run_folder(plan->out, scene, &new->run.settings, new->run.folder);
    snprintf(new->group, sizeof new->group, "%s", group);
    va_list arguments;
    va_start(arguments, label);
    vsnprintf(new->label, sizeof new->label, label, arguments);
    va_end(arguments);
    plan->case_count++;
    return 0;
}

void plan_free(struct plan *plan) {
    for (int i = 0; i < plan->loaded_count; i++)
        scene_free(plan->loaded[i]);
    free(plan->loaded);
    free(plan->cases);
}
