#include "picture.h"

#include "base/memory.h"
#include "base/vector.h"
#include "bodies.h"
#include "nodes.h"
#include "plane.h"
#include "shade.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* --- what all frames have in common --- */

void drawing_create(struct drawing *drawing, const struct frames *frames, unsigned views) {
    const struct scene *scene = frames->scene;
    *drawing = (struct drawing){.frames = frames, .views = views};
    drawing->hairs = memory_needed(calloc((size_t)scene->wisp_count, sizeof(struct hairs *)));
    for (int i = 0; i < scene->wisp_count && views & (VIEW_HAIR | VIEW_PLANE); i++)
        drawing->hairs[i] =
            memory_needed(hairs_create(&scene->wisps[i], scene->seed, scene->render.hairs));
}

void drawing_free(struct drawing *drawing) {
    for (int i = 0; drawing->hairs && i < drawing->frames->scene->wisp_count; i++)
        hairs_free(drawing->hairs[i]);
    free(drawing->hairs);
    drawing->hairs = NULL;
}

/* --- lines --- */

/* What a frame is drawn with. */
struct brush {
    struct picture *picture;
    const struct drawing *drawing;
    const struct render_settings *render;
    int frame;
    double light[3];
    const double *tint; /* of the hair's colour, red, green and blue */
    struct figure figure;
    struct strand *strand, *reference; /* of the wisp at hand */
    double (*controls)[3], (*points)[3];
    double *error; /* by node, m */
};

void picture_add(struct picture *picture, enum layer_kind kind, const struct segment *segment) {
    struct layer *layer = &picture->layer[kind];
    layer->segments =
        memory_for(layer->segments, layer->count + 1, &layer->room, sizeof *layer->segments);
    layer->segments[layer->count++] = *segment;
}

/* A point, and where in the picture it is. */
struct spot {
    double point[3], place[3];
    int seen;
};

static void look(const struct brush *brush, const double point[3], struct spot *spot) {
    const struct camera *camera = &brush->drawing->camera;
    memcpy(spot->point, point, sizeof spot->point);
    spot->seen = camera_project(camera, point, spot->place) &&
                 !figure_hides(&brush->figure, camera->eye, point);
}

/* Moves the one of two points that is not seen to where the line between them goes out of sight. */
static void cut(const struct brush *brush, struct spot *seen, struct spot *hidden) {
    double near[3], far[3];
    memcpy(near, seen->point, sizeof near);
    memcpy(far, hidden->point, sizeof far);
    *hidden = *seen;
    for (int i = 0; i < 6; i++) {
        struct spot middle;
        double point[3];
        for (int k = 0; k < 3; k++)
            point[k] = 0.5 * (near[k] + far[k]);
        look(brush, point, &middle);
        memcpy(middle.seen ? near : far, point, sizeof point);
        if (middle.seen)
            *hidden = middle;
    }
}

/* Whether a line may be seen in the picture; not if it goes as far out as that of a run which
 * diverged, or is nowhere. */
static int in_picture(const struct camera *camera, const double a[3], const double b[3]) {
    static const double far = 1e5; /* pixels */
    const double size[2] = {camera->width, camera->height};
    int in = 1;
    for (int k = 0; k < 2; k++)
        in &= fabs(a[k]) < far && fabs(b[k]) < far && fmax(a[k], b[k]) > 0 &&
              fmin(a[k], b[k]) < size[k];
    return in;
}

static void stroke(struct brush *brush, enum layer_kind kind, struct spot a, struct spot b,
                   unsigned colour, double error) {
    if (!a.seen && !b.seen)
        return;
    if (!a.seen)
        cut(brush, &b, &a);
    if (!b.seen)
        cut(brush, &a, &b);
    if (!in_picture(&brush->drawing->camera, a.place, b.place))
        return;
    const struct segment segment = {(float)a.place[0],
                                    (float)a.place[1],
                                    (float)(b.place[0] - a.place[0]),
                                    (float)(b.place[1] - a.place[1]),
                                    (float)(0.5 * (a.place[2] + b.place[2])),
                                    (float)error,
                                    colour};
    picture_add(brush->picture, kind, &segment);
}

static void line(struct brush *brush, enum layer_kind kind, const double a[3], const double b[3],
                 unsigned colour, double error) {
    struct spot from, to;
    look(brush, a, &from);
    look(brush, b, &to);
    stroke(brush, kind, from, to, colour, error);
}

/* --- hair --- */

static unsigned pack(const double colour[3]) {
    unsigned packed = 0;
    for (int k = 0; k < 3; k++)
        packed = packed << 8 | (unsigned)(255 * fmin(1, fmax(0, colour[k])) + 0.5);
    return packed;
}

/* Hair is no two alike, and darker within the wisp, where light has to find its way. */
static double tone_of(int hair, const double place[2]) {
    const double golden = 0.6180339887498949; /* its multiples are spread evenly over [0, 1) */
    return (0.85 + 0.3 * fmod(hair * golden, 1)) * (0.75 + 0.5 * hypot(place[0], place[1]));
}

static unsigned hair_colour(const struct brush *brush, const struct spot *a, const struct spot *b,
                            double tone) {
    static const double gloss = 24, around = 0.25, sheen[3] = {0.42, 0.37, 0.30};
    double tangent[3], eye[3], colour[3];
    for (int k = 0; k < 3; k++) {
        tangent[k] = b->point[k] - a->point[k];
        eye[k] = brush->drawing->camera.eye[k] - a->point[k];
    }
    vector_normalise(tangent);
    vector_normalise(eye);
    const struct shine shine = shade_hair(tangent, brush->light, eye, gloss);
    for (int k = 0; k < 3; k++)
        colour[k] = tone * (brush->tint[k] * brush->render->colour[k] *
                                (around + (1 - around) * shine.diffuse) +
                            sheen[k] * shine.specular);
    return pack(colour);
}

/* The distance from the reference at a place along the wisp, nodes counted from 0. */
static double error_at(const struct brush *brush, double node) {
    const int nodes = brush->strand->wisp->nodes, i = (int)fmin(node, nodes - 2);
    return brush->error[i] + (node - i) * (brush->error[i + 1] - brush->error[i]);
}

static void draw_hair(struct brush *brush, const struct hairs *hairs, int hair) {
    const double(*place)[2] =
        (const double(*)[2])(hairs->place + (size_t)hair * (size_t)hairs->nodes);
    const int pieces = brush->render->pieces;
    const double tone = tone_of(hair, place[0]);
    double end;
    hair_controls(brush->strand, place, brush->controls);
    const int count = hair_curve((const double(*)[3])brush->controls, hairs->nodes, pieces,
                                 hairs->length[hair], brush->points, &end);
    struct spot before, now;
    look(brush, brush->points[0], &before);
    for (int i = 1; i < count; i++, before = now) {
        look(brush, brush->points[i], &now);
        stroke(brush, LAYER_HAIR, before, now, hair_colour(brush, &before, &now, tone),
               error_at(brush, fmin(end, (i - 0.5) / pieces)));
    }
}

/* What a wisp split off from another is of a second tone, so that twins are told apart. */
static void draw_hairs(struct brush *brush, int wisp) {
    static const double plain[3] = {1, 1, 1}, second[3] = {0.45, 0.95, 2.1};
    const struct frames *frames = brush->drawing->frames;
    brush->tint = wisp < frames->scene->wisp_count ? plain : second;
    const struct hairs *hairs = brush->drawing->hairs[frames_ancestor(frames, wisp)];
    const struct hair_share share = frames_share(frames, brush->frame, wisp);
    for (int i = 0; i < hairs->count; i++)
        if (hair_share_has(share, i))
            draw_hair(brush, hairs, i);
}

/* --- skeleton and envelope (figure 4.1) --- */

static const unsigned skeleton_colour = 0xE3A92B, cross_colour = 0x3C3C3C,
                      outline_colour = 0x6C88A8;
static const unsigned axis_colour[3] = {0xC03A2B, 0x2E8B57, 0x2C6FBB}; /* u, v, w */

static void draw_skeleton(struct brush *brush) {
    const struct strand *strand = brush->strand;
    for (int i = 0; i < strand->wisp->nodes; i++) {
        const double *p = strand->p[i];
        if (i > 0)
            line(brush, LAYER_SKELETON, strand->p[i - 1], p, skeleton_colour,
                 error_at(brush, i - 0.5));
        line(brush, LAYER_NODES, p, p, cross_colour, brush->error[i]);
    }
}

/* Samples on their half-lines, those along u and v in the colours of these; and w, half as long. */
static void draw_crosses(struct brush *brush) {
    const struct strand *strand = brush->strand;
    const int samples = strand->wisp->samples;
    for (int i = 0; i < strand->wisp->nodes && samples > 0; i++) {
        double end[3];
        for (int j = 0; j < samples && i >= 2; j++) {
            const unsigned colour = j == 0                   ? axis_colour[0]
                                    : j == 1 && samples == 4 ? axis_colour[1]
                                                             : cross_colour;
            line(brush, LAYER_ENVELOPE, strand->p[i], strand->e[i * samples + j], colour,
                 brush->error[i]);
        }
        memcpy(end, strand->p[i], sizeof end);
        vector_add(end, 0.5 * strand->wisp->radius, strand->axis_w[i]);
        line(brush, LAYER_ENVELOPE, strand->p[i], end, axis_colour[2], brush->error[i]);
    }
}

static void draw_envelope(struct brush *brush) {
    const struct strand *strand = brush->strand;
    const int samples = strand->wisp->samples, around = 12 * samples;
    for (int i = 1; i < strand->wisp->nodes && samples > 0; i++) {
        double a[3], b[3];
        node_rim(strand, i, 0, a);
        for (int k = 1; k <= around; k++, memcpy(a, b, sizeof a)) {
            node_rim(strand, i, (double)(k % around) / around, b);
            line(brush, LAYER_ENVELOPE, a, b, outline_colour, brush->error[i]);
        }
        for (int j = 0; j < samples && i > 1; j++) {
            node_rim(strand, i - 1, (double)j / samples, a);
            node_rim(strand, i, (double)j / samples, b);
            line(brush, LAYER_ENVELOPE, a, b, outline_colour, error_at(brush, i - 0.5));
        }
    }
}

/* --- the style field (figures 4.10 and 4.11) --- */

/* What no acceleration of the field is above, m/s^2. */
static double strongest(const struct style *style) {
    double most = 0;
    for (int k = 0; k < style->knots; k++)
        most = fmax(most, vector_length(style->acceleration[k]) +
                              vector_length(style->parting.acceleration[k]));
    return most;
}

/* Arrows all over the picture, each of the field where it is, at the depth of the hair. They are
 * seen from afar, so that a uniform field has parallel arrows of one length. */
static void draw_style(struct brush *brush) {
    enum { ACROSS = 9, UPWARDS = 7 };
    const struct frames *frames = brush->drawing->frames;
    const struct camera *camera = &brush->drawing->camera;
    const struct style *style = &frames->scene->around.style;
    double root[3];
    if (!camera_project(camera, frames->scene->wisps[0].root, root))
        return;
    const double reach =
        0.8 * fmin(camera->width / ACROSS, camera->height / UPWARDS) / strongest(style);
    for (int i = 0; i < ACROSS * UPWARDS; i++) {
        const double x = (i % ACROSS + 0.5) * camera->width / ACROSS,
                     y = (i / ACROSS + 0.5) * camera->height / UPWARDS;
        double ray[3], at[3], field[3];
        camera_ray(camera, x, y, ray);
        memcpy(at, camera->eye, sizeof at);
        vector_add(at, root[2], ray);
        style_at(style, frames_time(frames, brush->frame), at, field);
        const double dx = reach * vector_dot(field, camera->right),
                     dy = reach * vector_dot(field, camera->up);
        if (hypot(dx, dy) > 1) /* pixel; else there is no direction to be seen */
            picture_add(brush->picture, LAYER_STYLE,
                        &(struct segment){(float)(x - dx / 2), (float)(y - dy / 2), (float)dx,
                                          (float)dy, (float)root[2], 0, 0x9FB8D6});
    }
}

/* --- a frame --- */

/* Makes room for the wisp at hand. */
static void take_wisp(struct brush *brush, int wisp) {
    const struct drawing *drawing = brush->drawing;
    const struct frames *frames = drawing->frames, *reference = drawing->reference;
    const struct wisp *numbers = &frames->wisps[wisp];
    const size_t nodes = (size_t)numbers->nodes, pieces = (size_t)brush->render->pieces;
    brush->strand = memory_needed(strand_create(numbers, frames->treatment));
    brush->controls = memory_needed(malloc(nodes * sizeof *brush->controls));
    brush->points = memory_needed(malloc(((nodes - 1) * pieces + 1) * sizeof *brush->points));
    brush->error = memory_needed(calloc(nodes, sizeof *brush->error));
    frames_load(frames, brush->frame, wisp, brush->strand);
    if (!reference)
        return;
    brush->reference = memory_needed(strand_create(numbers, reference->treatment));
    frames_load(reference, brush->frame, wisp, brush->reference);
    for (size_t i = 0; i < nodes; i++) {
        double d[3];
        memcpy(d, brush->strand->p[i], sizeof d);
        vector_add(d, -1, brush->reference->p[i]);
        brush->error[i] = vector_length(d);
    }
}

static void leave_wisp(struct brush *brush) {
    strand_free(brush->strand);
    strand_free(brush->reference);
    free(brush->controls);
    free(brush->points);
    free(brush->error);
}

static void draw_wisp(struct brush *brush, int wisp) {
    const unsigned views = brush->drawing->views;
    take_wisp(brush, wisp);
    if (views & VIEW_HAIR)
        draw_hairs(brush, wisp);
    if (views & VIEW_ENVELOPE)
        draw_envelope(brush);
    if (views & VIEW_SKELETON) {
        draw_crosses(brush);
        draw_skeleton(brush);
    }
    leave_wisp(brush);
}

static void paint_bodies(struct brush *brush) {
    struct picture *picture = brush->picture;
    if (brush->figure.count == 0)
        return;
    picture->bodies = memory_needed(malloc(4 * (size_t)picture->width * (size_t)picture->height));
    if (!figure_paint(&brush->figure, &brush->drawing->camera, brush->light, picture->bodies)) {
        free(picture->bodies);
        picture->bodies = NULL;
    }
}

void picture_draw(struct picture *picture, const struct drawing *drawing, int frame) {
    const struct scene *scene = drawing->frames->scene;
    struct brush brush = {
        .picture = picture, .drawing = drawing, .render = &scene->render, .frame = frame};
    *picture = (struct picture){.width = (int)drawing->camera.width,
                                .height = (int)drawing->camera.height};
    if (drawing->views & VIEW_PLANE) {
        plane_draw(picture, drawing, frame);
        return;
    }
    camera_light(&drawing->camera, &scene->render, brush.light);
    figure_place(&brush.figure, scene, frames_time(drawing->frames, frame));
    paint_bodies(&brush);
    if (drawing->views & VIEW_STYLE)
        draw_style(&brush);
    for (int i = 0; i < frames_wisps(drawing->frames, frame); i++)
        draw_wisp(&brush, i);
    for (int i = 0; i < LAYER_COUNT; i++)
        layer_sort(&picture->layer[i]);
}

void picture_free(struct picture *picture) {
    free(picture->bodies);
    for (int i = 0; i < LAYER_COUNT; i++)
        free(picture->layer[i].segments);
    *picture = (struct picture){0};
}

/* --- order --- */

/* A segment's place by its depth: the furthest have the least keys. The bits of floats that are not
 * negative are in their order, those of others in the opposite one. */
struct place_in_layer {
    uint32_t key, index;
};

static uint32_t key_of(float depth) {
    uint32_t bits;
    memcpy(&bits, &depth, sizeof bits);
    return bits & 0x80000000u ? bits : ~(bits | 0x80000000u);
}

enum { DIGIT = 11, DIGITS_OF_KEY = 3, RADIX = 1 << DIGIT };

/* By one digit of the keys, equals in the order that they have. */
static void sort_by_digit(const struct place_in_layer *from, struct place_in_layer *to,
                          size_t count, int digit) {
    size_t start[RADIX + 1] = {0};
    const int shift = digit * DIGIT;
    for (size_t i = 0; i < count; i++)
        start[(from[i].key >> shift & (RADIX - 1)) + 1]++;
    for (int k = 0; k < RADIX; k++)
        start[k + 1] += start[k];
    for (size_t i = 0; i < count; i++)
        to[start[from[i].key >> shift & (RADIX - 1)]++] = from[i];
}

/* By digits, from the last to the first: a third of the time that qsort takes for 800 000 hairs'
 * segments, whose order has to be found anew in each frame. */
void layer_sort(struct layer *layer) {
    const size_t count = layer->count, room = count > 0 ? count : 1;
    struct place_in_layer *places = memory_needed(calloc(2 * room, sizeof *places)),
                          *other = places + room;
    struct segment *sorted = memory_needed(malloc(room * sizeof *sorted));
    for (size_t i = 0; i < count; i++)
        places[i] = (struct place_in_layer){key_of(layer->segments[i].depth), (uint32_t)i};
    for (int digit = 0; digit < DIGITS_OF_KEY; digit++)
        sort_by_digit(digit % 2 ? other : places, digit % 2 ? places : other, count, digit);
    for (size_t i = 0; i < count; i++)
        sorted[i] = layer->segments[other[i].index];
    free(places);
    free(layer->segments);
    layer->segments = sorted;
    layer->room = room;
}
