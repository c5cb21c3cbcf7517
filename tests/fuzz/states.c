/* States: a trajectory, its last frame as a state of two wisps, and all as the frames of a run. */
#include "fuzz.h"
#include "model/state.h"
#include "picture/frames.h"
#include "scene/scene_load.h"

#include <stdlib.h>
#include <string.h>

static const char scene_text[] =
    "duration = 1.0; frame_rate = 10.0; gravity = [0.0, -9.81, 0.0]; material = { };\n"
    "envelope = { samples = 3; }; wisps = ( { root = [0.0, 0.0, 0.0]; length = 0.2; nodes = 3;\n"
    "direction = [1.0, 0.0, 0.0]; grid = [2, 1]; spacing = 1.0;\n"
    "across = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); } );\n";

static struct scene *the_scene(void) {
    static struct scene *scene;
    char reason[REASON_SIZE];
    if (!scene)
        scene = scene_load(fuzz_file("scene.cfg", (const uint8_t *)scene_text, strlen(scene_text)),
                           NULL, 0, reason);
    return scene;
}

/* As a state of the scene's wisps under each treatment. */
static void as_state(const struct trajectory *trajectory, const char *path, char *reason) {
    const struct scene *scene = the_scene();
    double t;
    for (int treatment = 0; treatment < 3; treatment++) {
        struct model *model = scene->problem->create(scene, treatment, 1);
        double *rows = calloc((size_t)(model->row_count * model->column_count), sizeof *rows);
        if (state_of(model, trajectory, path, rows, &t, reason))
            fuzz_refusal(reason);
        else
            scene->problem->restore(model, rows);
        free(rows);
        scene->problem->free(model);
    }
}

/* As the frames of a run that failed, in which the last may be cut short. */
static void as_frames(const char *path, struct trajectories *owner, char *reason) {
    static const double axes[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    double most[4] = {0};
    struct frames frames;
    char *source = json_dumps(the_scene()->source, 0), json[4096];
    snprintf(json, sizeof json, "{\"status\": \"diverged\", \"scene\": %s}", source);
    free(source);
    fuzz_file("run.json", (const uint8_t *)json, strlen(json));
    if (frames_open(&frames, path, owner, NULL, 0, reason)) {
        fuzz_refusal(reason);
    } else {
        frames_extent(&frames, axes, most);
        for (int wisp = 0; wisp < frames.wisp_count; wisp++) {
            frames_share(&frames, frames.count, wisp);
            frames_ancestor(&frames, wisp);
        }
        struct strand *strand = strand_create(&frames.wisps[0], frames.treatment);
        if (strand)
            frames_load(&frames, frames.count, 0, strand);
        strand_free(strand);
    }
    frames_close(&frames);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char reason[REASON_SIZE] = "", path[PATH_SIZE], save[PATH_SIZE];
    the_scene();
    path_format(path, "%s", fuzz_file("states.tsv", data, size));
    path_format(save, "%s.saved", path);
    trajectory_is_begun(path);
    struct trajectories *owner = trajectories_create();
    const struct trajectory *trajectory = trajectories_take(owner, path, reason);
    if (!trajectory) {
        fuzz_refusal(reason);
    } else {
        for (int frame = 0; frame < trajectory->frame_count; frame++)
            trajectory_end(trajectory, frame);
        as_state(trajectory, path, reason);
        as_frames(path, owner, reason);
        trajectories_return(owner, trajectory);
    }
    if (state_save(path, save, reason))
        fuzz_refusal(reason);
    trajectories_free(owner);
    return 0;
}
