/* How a scene is run: what the user asked for, completed with defaults and checked. */
#ifndef WISPLAB_SETTINGS_H
#define WISPLAB_SETTINGS_H

#include "model/model.h"
#include "model/scene.h"

#include <jansson.h>

/* What becomes of a run's states: states.tsv, states.npy, no file. */
enum states_format { STATES_TEXT, STATES_BINARY, STATES_NONE, STATES_FORMATS };
extern const char *const states_format_names[STATES_FORMATS];

/* What was asked for; NULL or 0 is not said. */
struct run_request {
    const char *stepper, *treatment, *linear;
    double step, rtol, atol;    /* s; relative; m and m/s */
    const char *const *options; /* "key=value"; the settings go on to use list and texts */
    int option_count;
    double strain_limit; /* beyond which the run has diverged; not said: the scene's */
    int timings;         /* how many CPU times of it there are to be; record_run repeats it */
    int threads;         /* that share out a scene's parts; 0: one */
    double perturbation; /* rms displacement of each node's start, m; 0: none */
    int draw;            /* which one of such displacements: the seed of the random numbers */
    int profile;         /* whether calls to the model are timed */
    int diagnostics;     /* whether there is a diagnosis of each frame */
    enum states_format states;
};

struct settings {
    const struct stepper_method *method;
    struct stepper_settings stepper;
    int treatment;         /* index into the problem's list */
    double step;           /* s, of fixed-step methods */
    double frame_interval; /* s, where the scene has no frame rate; 0: every accepted step */
    int every_step;        /* that is so: every accepted step is a frame */
    double strain_limit;   /* beyond which a finite state has diverged; infinite: never */
    int unprojected;       /* steps leave states off a constraint that could be kept */
    double perturbation;   /* rms displacement of each node's start, m */
    int draw;              /* which one: seeds the random numbers */
    int timings;
    int threads;     /* results do not depend on it */
    int profile;     /* nor on this */
    int lanes;       /* of parts, where method and solver can; nor on this */
    int diagnostics; /* states do not depend on it; times do */
    enum states_format states;
    int unknowns;      /* of the whole model: coordinates, not counting velocities */
    int rows, columns; /* of its first frame in a file of states */
};

/* Completes a request for a scene. Returns 0, or with one line in `reason` (REASON_SIZE) REFUSED
 * where a name is unknown, a value out of range, or the combination not supported, or
 * OUT_OF_MEMORY. */
int settings_resolve(const struct scene *scene, const struct run_request *request,
                     struct settings *settings, char *reason);

/* The settings of the cross-check on a run, or 0 where the method has none. */
int settings_cross_check(const struct scene *scene, const struct settings *settings,
                         struct settings *second, char *reason);

/* Beyond which strain runs of a scene have diverged where nothing else is said. */
double scene_strain_limit(const struct scene *scene);

/* About how many frames a run has, if it is known beforehand, else 0. */
double settings_frames(const struct scene *scene, const struct settings *settings);

/* How many wisps one part may hold under these settings. */
int settings_lanes(const struct settings *settings);

/* Everything that decides a run's result besides scene and program. New reference. */
json_t *settings_to_json(const struct scene *scene, const struct settings *settings);

#endif
