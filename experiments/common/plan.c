#include "plan.h"

#include "base/files.h"
#include "model/model.h"
#include "model/problems.h"
#include "scene/scene_contacts.h"
#include "scene/scene_detail.h"
#include "scene/scene_load.h"
#include "scene/scene_wisps.h"
#include "sets.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void experiment_title(const struct experiment *experiment, char title[256]) {
    if (experiment->thesis)
        snprintf(title, 256, "thesis, %s: %s", experiment->thesis, experiment->question);
    else
        snprintf(title, 256, "%s", experiment->question);
}

/* Whether a change of a scene undoes an earlier one: it is of the same setting, or of a group that
 * holds it. How long a run is and how many frames it has follow from what the user wants. */
static int undoes(const char *later, const char *earlier) {
    const size_t length = strcspn(later, "=");
    return strncmp(later, earlier, length) == 0 && strchr("=.", earlier[length]) &&
           strncmp(later, "duration=", 9) != 0 && strncmp(later, "frame_rate=", 11) != 0;
}

static unsigned long long lost_of(const struct plan *plan, const char *const *sets, int set_count) {
    unsigned long long lost = 0;
    for (int u = 0; u < plan->set_count; u++)
        for (int i = 0; i < set_count; i++)
            if (undoes(sets[i], plan->sets[u]))
                lost |= 1ull << u;
    return lost;
}

static int grow(void *list, int count, size_t size) {
    void *grown = realloc(*(void **)list, (size_t)(count + 1) * size);
    if (grown)
        *(void **)list = grown;
    return grown ? 0 : -1;
}

/* Takes the scene over, NULL or not. */
static const struct scene *keep_scene(struct plan *plan, struct scene *scene,
                                      unsigned long long lost) {
    const int count = plan->loaded_count;
    if (!scene)
        return NULL;
    if (grow(&plan->loaded, count, sizeof *plan->loaded) ||
        grow(&plan->lost, count, sizeof *plan->lost)) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        scene_free(scene);
        return NULL;
    }
    plan->loaded[count] = scene;
    plan->lost[count] = lost;
    plan->loaded_count++;
    return scene;
}

/* The user's changes, and then the experiment's. */
static struct scene *load(struct plan *plan, const char *name, const char *const *sets,
                          int set_count) {
    const size_t own = (size_t)plan->set_count, count = own + (size_t)set_count;
    const char **all = malloc((count + 1) * sizeof *all);
    if (!all) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        return NULL;
    }
    for (size_t i = 0; i < count; i++)
        all[i] = i < own ? plan->sets[i] : sets[i - own];
    struct scene *scene = scene_load(name, all, (int)count, plan->reason);
    free(all);
    if (scene)
        scene_name_sets(scene, plan->sets, plan->set_count);
    return scene;
}

const struct scene *plan_scene(struct plan *plan, const char *name, const char *const *sets,
                               int set_count) {
    return keep_scene(plan, load(plan, name, sets, set_count), lost_of(plan, sets, set_count));
}

const struct scene *plan_scene_bare(struct plan *plan, const char *name, double frame_rate) {
    static const char *const gone[] = {"envelope="};
    struct sets sets = {0};
    set_add(&sets, "frame_rate=%.17e", frame_rate);
    struct scene *scene = load(plan, name, sets.list, sets.count);
    if (scene)
        scene_remove_envelope(scene);
    return keep_scene(plan, scene, lost_of(plan, gone, 1));
}

const struct scene *plan_scene_detail(struct plan *plan, const char *name, const char *const *sets,
                                      int set_count, double factor, int samples) {
    struct scene *scene = load(plan, name, sets, set_count);
    if (scene && scene_set_detail(scene, factor, samples, plan->reason)) {
        scene_free(scene);
        return NULL;
    }
    return keep_scene(plan, scene, lost_of(plan, sets, set_count));
}

const struct scene *plan_push_bodies(struct plan *plan, const struct scene *scene,
                                     double frequency) {
    if (scene)
        scene_push_bodies(plan->loaded[plan->loaded_count - 1], frequency);
    return scene;
}

static void name_subject(const struct plan *plan, struct subject *subject) {
    static const char safe[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
    int same = 0;
    snprintf(subject->name, sizeof subject->name, "%s", subject->scene->name);
    for (char *at = subject->name; *at; at++)
        if (!strchr(safe, *at) || (at == subject->name && *at == '.'))
            *at = '-';
    const size_t length = strlen(subject->name);
    for (int i = 0; i < plan->subject_count; i++)
        same += strncmp(plan->subjects[i].name, subject->name, length) == 0;
    if (same > 0 || length == 0)
        snprintf(subject->name + length, sizeof subject->name - length, "-%d", same + 1);
}

static int add_subject(struct plan *plan, const char *name) {
    static const char *const frames[] = {"frame_rate=30"};
    const struct scene *scene = plan_scene(plan, name, NULL, 0);
    if (scene && scene->problem != &wisp_problem)
        return fail_with(plan->reason,
                         "experiment %s is of wisps, and scene %s is of problem \"%s\"",
                         plan->experiment->name, scene->name, scene->problem->name);
    if (scene && scene->frame_rate == 0)
        scene = plan_scene(plan, name, frames, 1);
    if (!scene)
        return -1;
    struct subject *subject = &plan->subjects[plan->subject_count];
    *subject = (struct subject){.scene = scene, .source = name};
    name_subject(plan, subject);
    plan->subject_count++;
    return 0;
}

int plan_subjects(struct plan *plan, const char *const *own, int own_count) {
    const char *const *names = plan->scene_count ? plan->scenes : own;
    const int count = plan->scene_count ? plan->scene_count : own_count;
    plan->subjects = calloc((size_t)count + 1, sizeof *plan->subjects);
    if (!plan->subjects)
        return fail_with(plan->reason, "out of memory");
    for (int i = 0; i < count; i++)
        if (add_subject(plan, names[i]))
            return -1;
    return 0;
}

int free_nodes(const struct scene *scene) {
    int nodes = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        nodes += scene->wisps[i].nodes - 2;
    return nodes;
}

double sparse_frame_rate(const struct scene *scene, double duration) {
    const double most = 200000; /* 4 MB of text */
    const double nodes = free_nodes(scene) + 2. * scene->wisp_count;
    const double numbers = nodes * (7 + 6 * scene->wisps[0].samples) * duration * scene->frame_rate;
    return scene->frame_rate / fmax(1, ceil(numbers / most));
}

const struct scene *plan_cut_scene(struct plan *plan, const struct subject *subject, double rate,
                                   double duration, const char *set) {
    struct sets sets = {0};
    const double frames = fmax(1, floor(duration * rate + 1e-9));
    set_add(&sets, "frame_rate=%.17e", rate);
    set_add(&sets, "duration=%.17e", fmin(frames / rate, subject->scene->duration));
    if (set)
        set_add(&sets, "%s", set);
    return plan_scene(plan, subject->source, sets.list, sets.count);
}

int plan_wants(const struct plan *plan, const char *stepper) {
    for (int i = 0; i < plan->stepper_count; i++)
        if (strcmp(plan->steppers[i], stepper) == 0)
            return 1;
    return plan->stepper_count == 0;
}

/* Says that the experiment does not take a stepper that the user asked for, and which it does.
 * Returns -1. */
static int refuse_stepper(struct plan *plan, const char *stepper) {
    const char *before = "; it compares ";
    int used = snprintf(plan->reason, REASON_SIZE, "experiment %s does not take stepper %s",
                        plan->experiment->name, stepper);
    if (plan->refused && strcmp(plan->refused->name, stepper) == 0) {
        snprintf(plan->reason + used, REASON_SIZE - (size_t)used, ": %s", plan->refusal);
        return -1;
    }
    for (int i = 0; plan->configurations && plan->configurations[i].name; i++) {
        const struct configuration *one = &plan->configurations[i];
        if (one->kind != CONFIGURATION_PLAIN || used >= REASON_SIZE)
            continue;
        used +=
            snprintf(plan->reason + used, REASON_SIZE - (size_t)used, "%s%s", before, one->stepper);
        before = ", ";
    }
    return -1;
}

int plan_configurations(struct plan *plan, unsigned kinds, unsigned capabilities) {
    struct configuration *all = configurations_choose(kinds, capabilities);
    if (!all)
        return fail_with(plan->reason, "out of memory");
    plan->configurations = all;
    for (int k = 0; k < plan->stepper_count; k++) {
        int found = 0;
        for (int i = 0; all[i].name; i++)
            found |= strcmp(all[i].stepper, plan->steppers[k]) == 0;
        if (!found)
            return refuse_stepper(plan, plan->steppers[k]);
    }
    for (int i = 0; all[i].name; i++)
        if (plan_wants(plan, all[i].stepper))
            all[plan->configuration_count++] = all[i];
    return 0;
}

int plan_has_no_scenes(struct plan *plan) {
    if (plan_is_own(plan))
        return 0;
    return fail_with(plan->reason, "experiment %s has scenes of its own; leave out %s",
                     plan->experiment->name, plan->scene_count > 0 ? "--scene" : "--set");
}

int plan_has_no_steppers(struct plan *plan, const char *compared) {
    if (plan->stepper_count == 0)
        return 0;
    return fail_with(plan->reason, "experiment %s compares %s, not steppers; leave out --stepper",
                     plan->experiment->name, compared);
}

void plan_refuse(struct plan *plan, const struct stepper_method *method, const char *why) {
    if (plan->refused)
        return;
    plan->refused = method;
    snprintf(plan->refusal, sizeof plan->refusal, "%s", why);
}

int plan_takes(struct plan *plan, const struct scene *scene, const struct run_request *request,
               char *reason) {
    struct settings settings;
    reason[0] = '\0';
    if (settings_resolve(scene, request, &settings, reason)) {
        plan_refuse(plan, stepper_find(request->stepper), reason);
        return 0;
    }
    for (int k = 0; k < plan->stepper_count; k++)
        plan->taken[k] |= strcmp(plan->steppers[k], request->stepper) == 0;
    return 1;
}

static int has_run(const struct plan *plan, const struct stepper_method *method) {
    for (int i = 0; i < plan->case_count; i++)
        if (plan->cases[i].run.settings.method == method)
            return 1;
    return 0;
}

/* Which of the user's changes the scene of a case has not. */
static unsigned long long lost_in(const struct plan *plan, const struct labelled_case *one) {
    for (int i = 0; i < plan->loaded_count; i++)
        if (plan->loaded[i] == one->run.scene)
            return plan->lost[i];
    return 0;
}

/* A change that the experiment undoes in all of its runs would only be in its tables' names. */
static int check_sets(struct plan *plan) {
    unsigned long long lost = plan->case_count > 0 ? ~0ull : 0;
    for (int i = 0; i < plan->case_count; i++)
        lost &= lost_in(plan, &plan->cases[i]);
    for (int u = 0; u < plan->set_count; u++)
        if (lost >> u & 1)
            return fail_with(plan->reason,
                             "--set %.100s: experiment %s sets that itself in all of its runs",
                             plan->sets[u], plan->experiment->name);
    return 0;
}

int plan_check(struct plan *plan) {
    for (int k = 0; k < plan->stepper_count; k++)
        if (!plan->taken[k] && !has_run(plan, stepper_find(plan->steppers[k])))
            return refuse_stepper(plan, plan->steppers[k]);
    return check_sets(plan);
}

int plan_add(struct plan *plan, const struct scene *scene, const struct run_request *request,
             const char *group, const char *label, ...) {
    if (plan->case_count == plan->case_capacity) {
        const int capacity = 2 * plan->case_capacity + 16;
        struct labelled_case *cases = realloc(plan->cases, (size_t)capacity * sizeof *cases);
        if (!cases)
            return fail_with(plan->reason, "out of memory");
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

/* The largest strain of the reference's runs of a scene; 0 where there are none. */
static int reference_strain(struct plan *plan, const struct scene *scene, double *most,
                            char *waiting) {
    *most = 0;
    *waiting = 0;
    for (int i = 0; i < plan->case_count; i++) {
        const struct run_case *one = &plan->cases[i].run;
        struct run_files run;
        if (one->scene != scene || !one->settings.method->checked_by)
            continue;
        if (!run_is_complete(one->folder)) {
            *waiting = 1;
            continue;
        }
        if (run_read(&run, one->folder, plan->reason))
            return -1;
        if (run.outcome == FINISHED)
            *most = fmax(*most, run_number(&run, "largest_strain"));
        run_free(&run);
    }
    return 0;
}

int plan_allow_strain(struct plan *plan, int first, char *waiting) {
    const struct scene *scene = NULL;
    double most = 0;
    char missing = 0;
    for (int i = first; i < plan->case_count; i++) {
        struct run_case *one = &plan->cases[i].run;
        waiting[i - first] = 0;
        if (one->settings.method->checked_by)
            continue;
        if (one->scene != scene && reference_strain(plan, one->scene, &most, &missing))
            return -1;
        scene = one->scene;
        waiting[i - first] = missing;
        if (missing || 2 * most <= one->settings.strain_limit)
            continue;
        one->settings.strain_limit = 2 * most;
        run_folder(plan->out, one->scene, &one->settings, one->folder);
    }
    return 0;
}

const struct labelled_case *find_case(const struct plan *plan, const char *group, const char *label,
                                      ...) {
    char named[sizeof plan->cases->label];
    va_list arguments;
    va_start(arguments, label);
    vsnprintf(named, sizeof named, label, arguments);
    va_end(arguments);
    for (int i = 0; i < plan->case_count; i++)
        if (strcmp(plan->cases[i].group, group) == 0 && strcmp(plan->cases[i].label, named) == 0)
            return &plan->cases[i];
    return NULL;
}

int plan_read(struct plan *plan, const struct labelled_case *one, struct run_files *run) {
    return run_read_states(run, one->run.folder, plan->trajectories, plan->reason);
}

int plan_open_statements(struct plan *plan, const struct scene *scene, const char *cut) {
    if (output_statements(&plan->output, scene, cut))
        return -1;
    statements_of_changed(&plan->output.statements, plan->sets, plan->set_count);
    return 0;
}

void plan_free(struct plan *plan) {
    for (int i = 0; i < plan->loaded_count; i++)
        scene_free(plan->loaded[i]);
    free(plan->loaded);
    free(plan->lost);
    free(plan->subjects);
    free(plan->configurations);
    free(plan->taken);
    free(plan->cases);
    free(plan->memo);
}
