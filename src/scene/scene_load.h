/* Scene files: read, checked to the last setting, and turned into plain numbers. */
#ifndef WISPLAB_SCENE_H
#define WISPLAB_SCENE_H

#include "base/files.h"
#include "picture/camera.h"
#include "wisp/body.h"
#include "wisp/interaction.h"
#include "wisp/subdivision.h"
#include "wisp/wisp.h"

#include <jansson.h>

/* Settings for runs of a scene where the command line gives none. */
struct run_defaults {
    double step;       /* s */
    double rtol, atol; /* atol in m and m/s */
};

/* A state to start from: rows of frames, as a model of that treatment writes them. */
struct start {
    int treatment;
    int columns, count; /* numbers in a row, and in all */
    double *rows;       /* owned; NULL: wisps start at rest */
};

struct scene {
    char name[64];
    const struct problem *problem;
    double duration;   /* s */
    double frame_rate; /* Hz; 0: every step is a frame */
    double seed;       /* a whole number */
    struct run_defaults run;

    /* of problem "wisps" */
    struct surroundings around;
    struct wisp *wisps; /* in the order of the file, grids spread out; owned */
    int wisp_count;
    struct body *bodies; /* in the order of the file, BODIES_MAX at most; owned */
    int body_count;
    double collision_rate;                   /* Hz */
    struct interaction_settings interaction; /* of wisps; both responses off: none */
    struct subdivision subdivision;          /* of wisps, at interaction.rate; limit 0: none */

    struct start start;

    struct render_settings render; /* how it is looked at: no part of what is integrated */

    json_t *source; /* all settings as they were given, numbers as reals: what is hashed */
};

/* Reads a scene: a path to a .cfg file, or the name of a shipped one. `sets` are `set_count`
 * overrides "path.to.setting=value". Returns a scene for scene_free, or NULL with one line in
 * `reason` (REASON_SIZE): file, line, name, what is wrong and what would be right; errno is ENOMEM
 * where it was memory. */
struct scene *scene_load(const char *name, const char *const *sets, int set_count, char *reason);

/* The same of a scene's `source`, as run.json has it in `file`, which is for messages; without
 * `start`, for what it was started from need not be there any more. */
struct scene *scene_from_json(const json_t *source, const char *file, const char *const *sets,
                              int set_count, char *reason);

void scene_free(struct scene *scene);

#endif
