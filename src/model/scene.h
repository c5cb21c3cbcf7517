/* A scene in plain numbers: what its file says, checked. */
#ifndef WISPLAB_SCENE_H
#define WISPLAB_SCENE_H

#include "wisp/body.h"
#include "wisp/interaction.h"
#include "wisp/subdivision.h"
#include "wisp/wisp.h"

#include <jansson.h>

/* Settings for runs of a scene where the command line gives none. */
struct run_defaults {
    double step;         /* s */
    double rtol, atol;   /* atol in m and m/s */
    double strain_limit; /* beyond which a run has diverged; 0: the problem's */
    int project;         /* of rigid segments, after each step: 1, 0, or -1: as suits the method */
};

/* A state to start from: rows of frames, as a model of that treatment writes them. */
struct start {
    int treatment;
    int columns, count; /* numbers in a row, and in all */
    double *rows;       /* owned; NULL: wisps start at rest */
};

/* Nearer to the eye than this, nothing is drawn, m. */
#define RENDER_NEAREST 1e-3

/* The scene's group `render`, all of which has defaults. It is no part of what is integrated. */
struct render_settings {
    int has_eye, has_target;  /* else the camera finds a place from which all hair is seen */
    double eye[3], target[3]; /* m */
    double angle;             /* of view, from the picture's bottom to its top, rad */
    double light[3];          /* towards the light, a unit vector; 0: over the camera's shoulder */
    double colour[3];         /* of hair in full light: red, green, blue, from 0 to 1 */
    int hairs;                /* drawn in a wisp that has not split */
    int pieces;               /* straight ones in a hair, for each segment of its wisp */
};

struct scene {
    char name[64];
    const struct problem *problem;
    double begin;      /* s: the time of the first frame */
    double duration;   /* from there to the last one, s */
    double frame_rate; /* Hz; 0: every step is a frame */
    double seed;       /* a whole number */
    struct run_defaults run;

    /* of problem "wisps", and some of them of "rosenblum" and "anjyo" */
    struct surroundings around;
    struct wisp *wisps; /* in the order of the file, grids spread out; owned */
    int wisp_count;
    struct body *bodies;   /* BODIES_MAX at most: those of ticks, then those that push by penalty,
                              which `around` has too; both in the order of the file; owned */
    int body_count;        /* of both */
    double collision_rate; /* Hz */
    struct interaction_settings interaction; /* of wisps; both responses off: none */
    struct subdivision subdivision;          /* of wisps, at interaction.rate; limit 0: none */

    double anjyo_constant; /* of problem "anjyo": c, 1/(kg m^2) */

    struct start start;

    struct render_settings render; /* how it is looked at: no part of what is integrated */

    json_t *source; /* all settings as they were given, numbers as reals: what is hashed */
};

/* Rows of states, one for each frame and node, that a run may write: as text some 15 gigabytes. */
#define SCENE_ROWS_MOST 1e8

/* Rows of a frame: nodes, or the particle. */
static inline double scene_nodes(const struct scene *scene) {
    double nodes = scene->wisp_count == 0;
    for (int i = 0; i < scene->wisp_count; i++)
        nodes += scene->wisps[i].nodes;
    return nodes;
}

/* How many bodies act at ticks: the first ones. */
static inline int scene_tick_bodies(const struct scene *scene) {
    return scene->body_count - scene->around.pushing_count;
}

#endif
