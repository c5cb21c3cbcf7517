/* How near is the kernel to what the hardware can? Measured here and now, not by runs, by a program
 * of its own, wisplab-bench: it writes the tables and prints what they say. */
#include "kernel.h"

#include "base/files.h"
#include "experiments/common/bench.h"
#include "model/problems.h"
#include "scene/scene_load.h"

struct scene *kernel_scene(const char *name, const char *const *sets, int set_count, char *reason) {
    struct scene *scene = scene_load(name, sets, set_count, reason);
    if (scene && (scene->problem != &wisp_problem || scene->wisps[0].samples == 0)) {
        snprintf(reason, REASON_SIZE,
                 "experiment kernel needs wisps with an envelope, scene %.60s has none",
                 scene->name);
        scene_free(scene);
        return NULL;
    }
    if (scene)
        scene_name_sets(scene, sets, set_count);
    return scene;
}

static const char *scene_of(const struct plan *plan) {
    return plan->scene_count ? plan->scenes[0] : "swing-envelope";
}

static int kernel_plan(struct plan *plan) {
    if (plan->scene_count > 1)
        return fail_with(plan->reason, "experiment kernel takes the material of one scene");
    struct scene *scene = kernel_scene(scene_of(plan), plan->sets, plan->set_count, plan->reason);
    scene_free(scene);
    plan->run_seconds = plan->quick ? 300 : 900; /* ten times what it takes */
    return scene ? 0 : -1;
}

static int kernel_tabulate(struct plan *plan) {
    return bench_run(plan, "kernel", scene_of(plan));
}

const struct experiment kernel_experiment = {
    .name = "kernel",
    .question = "how near to the hardware are evaluations, linear solvers, the seam and contacts?",
    .chapter = CHAPTER_ACCURACY,
    .place = 19,
    .full_seconds = 70,
    .plan = kernel_plan,
    .tabulate = kernel_tabulate,
};
