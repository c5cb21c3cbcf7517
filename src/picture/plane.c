#include "plane.h"

#include "base/memory.h"
#include "wisp/section.h"

#include <math.h>

double plane_extent(const struct frames *frames, int wisp, int node) {
    const struct wisp *numbers = &frames->wisps[wisp];
    struct strand *strand = memory_needed(strand_create(numbers, frames->treatment));
    double most = numbers->radius;
    for (int frame = 1; frame <= frames->count; frame++) {
        frames_load(frames, frame, wisp, strand);
        for (int j = 0; j < numbers->samples; j++)
            most = fmax(most, section_radius(strand, node, j));
    }
    strand_free(strand);
    return most;
}

/* --- in the plane: u to the right, v upwards, m --- */

struct plane {
    struct picture *picture;
    const struct strand *strand;
    int node;
    double middle[2], scale; /* pixels, and for 1 m */
};

static const unsigned arrow_colour = 0x6C88A8, rim_colour = 0x3F6690, rest_colour = 0xB9C4D0,
                      way_colour = 0xD8BE98, hair_colour = 0x8F6136, sample_colour = 0x1F1F1F;

/* A line, or where both ends are one a point. */
static void put(struct plane *plane, enum layer_kind kind, const double a[2], const double b[2],
                unsigned colour) {
    const double s = plane->scale;
    const struct segment segment = {.x = (float)(plane->middle[0] + s * a[0]),
                                    .y = (float)(plane->middle[1] + s * a[1]),
                                    .dx = (float)(s * (b[0] - a[0])),
                                    .dy = (float)(s * (b[1] - a[1])),
                                    .colour = colour};
    picture_add(plane->picture, kind, &segment);
}

/* The rim, or the circle that it is at rest. */
static void draw_round(struct plane *plane, int at_rest, unsigned colour) {
    const int around = 24 * plane->strand->wisp->samples;
    double a[2] = {0, 0}, b[2];
    for (int k = 0; k <= around; k++, a[0] = b[0], a[1] = b[1]) {
        const double turn = (double)(k % around) / around, angle = 2 * M_PI * turn;
        const double r =
            at_rest ? plane->strand->wisp->radius : section_rim(plane->strand, plane->node, turn);
        b[0] = r * cos(angle);
        b[1] = r * sin(angle);
        if (k > 0)
            put(plane, LAYER_ENVELOPE, a, b, colour);
    }
}

static void draw_samples(struct plane *plane) {
    static const double node[2] = {0, 0};
    for (int j = 0; j < plane->strand->wisp->samples; j++) {
        double at[2];
        wisp_sample_way(plane->strand->wisp->samples, j, at);
        for (int k = 0; k < 2; k++)
            at[k] *= section_radius(plane->strand, plane->node, j);
        put(plane, LAYER_STYLE, node, at, arrow_colour);
        put(plane, LAYER_SAMPLES, at, at, sample_colour);
    }
}

static void draw_hairs(struct plane *plane, const struct hairs *hairs, struct hair_share share) {
    for (int i = 0; i < hairs->count; i++) {
        const double *place = hairs->place[i * hairs->nodes + plane->node];
        const double radius = plane->strand->wisp->radius;
        const double was[2] = {radius * place[0], radius * place[1]};
        double is[2];
        if (!hair_share_has(share, i))
            continue;
        hair_position(plane->strand, plane->node, place, is);
        put(plane, LAYER_HAIR, was, is, way_colour);
        put(plane, LAYER_NODES, is, is, hair_colour);
    }
}

void plane_draw(struct picture *picture, const struct drawing *drawing, int frame) {
    const struct frames *frames = drawing->frames;
    const struct plane_view *view = &drawing->plane;
    struct strand *strand =
        memory_needed(strand_create(&frames->wisps[view->wisp], frames->treatment));
    frames_load(frames, frame, view->wisp, strand);
    struct plane plane = {.picture = picture,
                          .strand = strand,
                          .node = view->node,
                          .middle = {picture->width / 2., picture->height / 2.},
                          .scale = 0.46 * fmin(picture->width, picture->height) / view->extent};
    draw_round(&plane, 1, rest_colour);
    draw_round(&plane, 0, rim_colour);
    draw_hairs(&plane, drawing->hairs[view->wisp], frames_share(frames, frame, view->wisp));
    draw_samples(&plane);
    strand_free(strand);
}
