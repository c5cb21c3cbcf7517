/* One frame of a run as what is to be drawn: straight segments, those in front last, over an image
 * of the bodies. */
#ifndef WISPLAB_PICTURE_H
#define WISPLAB_PICTURE_H

#include "camera.h"
#include "frames.h"

/* What is shown besides bodies; bits of `views`. Without any, bodies alone. */
enum view {
    VIEW_HAIR = 1,
    VIEW_SKELETON = 2, /* nodes, crosses of samples, frames */
    VIEW_ENVELOPE = 4, /* outline of the sections */
    VIEW_STYLE = 8,    /* arrows along the style field */
    VIEW_PLANE = 16,   /* nothing but the envelope's plane at one node */
};

/* Which plane, and how far from the node it is drawn, m. */
struct plane_view {
    int wisp, node;
    double extent;
};

/* All frames of a run as seen from one place. */
struct drawing {
    const struct frames *frames;
    const struct frames *reference; /* colour is the distance from it at the same frame; or NULL */
    struct camera camera;
    unsigned views;
    struct plane_view plane; /* of VIEW_PLANE */
    struct hairs **hairs;    /* by wisp of the scene; owned */
};

/* Makes the hairs. Both runs' frames must outlive it. */
void drawing_create(struct drawing *drawing, const struct frames *frames, unsigned views);
void drawing_free(struct drawing *drawing);

struct segment {
    float x, y, dx, dy; /* pixels from the lower left corner */
    float depth;        /* from the camera, m */
    float error;        /* of drawings with a reference, m */
    unsigned colour;    /* 0xrrggbb */
};

/* Layers are drawn in this order: arrows, lines of several widths, and points. */
enum layer_kind {
    LAYER_STYLE,
    LAYER_HAIR,
    LAYER_ENVELOPE,
    LAYER_SKELETON,
    LAYER_NODES,
    LAYER_SAMPLES, /* bold */
    LAYER_COUNT
};

struct picture {
    int width, height;     /* pixels */
    unsigned char *bodies; /* as figure_paint has it; NULL: none is seen */
    struct layer {
        struct segment *segments; /* from back to front */
        size_t count, room;
    } layer[LAYER_COUNT];
};

/* Draws a frame that both runs have; to be freed. Several threads may draw from one drawing. */
void picture_draw(struct picture *picture, const struct drawing *drawing, int frame);
void picture_free(struct picture *picture);

/* Adds to a layer. */
void picture_add(struct picture *picture, enum layer_kind kind, const struct segment *segment);

/* Sorts a layer: the furthest first; of equal depth as they were. */
void layer_sort(struct layer *layer);

#endif
