#include "vtk.h"

#include "base/digits.h"
#include "base/files.h"
#include "base/memory.h"
#include "bodies.h"
#include "nodes.h"
#include "picture.h"
#include "polydata.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/param.h>

/* A frame with what all frames have in common. */
struct shown {
    const struct frames *frames;
    struct strand **strands; /* by wisp, where they are at the frame */
    struct drawing drawing;  /* its hairs */
    int frame;
    double (*controls)[3], (*points)[3]; /* of the longest hair */
};

/* Whose cell it is. */
static void add_owner(struct polydata *data, const struct shown *view, int wisp) {
    polydata_add_whole(&data->at_cells[0], wisp);
    polydata_add_whole(&data->at_cells[1], view->frames->parent[wisp]);
}

static void begin_wisps(struct polydata *data, const struct shown *view, enum polydata_kind kind) {
    polydata_begin(data, kind, frames_time(view->frames, view->frame));
    polydata_at_cells(data, "wisp");
    polydata_at_cells(data, "parent");
}

/* --- skeletons --- */

static void make_skeletons(struct polydata *data, const struct shown *view) {
    begin_wisps(data, view, POLYDATA_LINES);
    struct polydata_array *velocity = polydata_at_points(data, "velocity", 3),
                          *strain = polydata_at_points(data, "strain", 1),
                          *radius = polydata_at_points(data, "radius", 1);
    for (int wisp = 0; wisp < frames_wisps(view->frames, view->frame); wisp++) {
        const struct strand *strand = view->strands[wisp];
        for (int i = 0; i < strand->wisp->nodes; i++) {
            polydata_corner(data, polydata_points(data));
            polydata_add(&data->points, strand->p[i]);
            polydata_add(velocity, strand->v[i]);
            polydata_add(strain, (const double[]){node_strain(strand, i)});
            polydata_add(radius, (const double[]){node_radius(strand, i)});
        }
        polydata_end_cell(data);
        add_owner(data, view, wisp);
    }
}

/* --- envelopes --- */

/* From ring to ring; the first is of node 1, as in pictures. */
static void make_envelope(struct polydata *data, const struct shown *view, int wisp) {
    const struct strand *strand = view->strands[wisp];
    const int around = 6 * strand->wisp->samples, first = polydata_points(data);
    for (int i = 1; i < strand->wisp->nodes; i++)
        for (int k = 0; k < around; k++) {
            double point[3];
            node_rim(strand, i, (double)k / around, point);
            polydata_add(&data->points, point);
        }
    for (int i = 0; i + 2 < strand->wisp->nodes; i++)
        for (int k = 0; k < around; k++) {
            const int next = (k + 1) % around, ring = first + i * around;
            polydata_corner(data, ring + k);
            polydata_corner(data, ring + next);
            polydata_corner(data, ring + around + next);
            polydata_corner(data, ring + around + k);
            polydata_end_cell(data);
            add_owner(data, view, wisp);
        }
}

static void make_envelopes(struct polydata *data, const struct shown *view) {
    begin_wisps(data, view, POLYDATA_POLYGONS);
    for (int wisp = 0; wisp < frames_wisps(view->frames, view->frame); wisp++)
        make_envelope(data, view, wisp);
}

/* --- hairs --- */

static void make_hair(struct polydata *data, const struct shown *view, int wisp,
                      const struct hairs *hairs, int hair) {
    const double(*place)[2] =
        (const double(*)[2])(hairs->place + (size_t)hair * (size_t)hairs->nodes);
    double end;
    hair_controls(view->strands[wisp], place, view->controls);
    const int count =
        hair_curve((const double(*)[3])view->controls, hairs->nodes,
                   view->frames->scene->render.pieces, hairs->length[hair], view->points, &end);
    for (int i = 0; i < count; i++) {
        polydata_corner(data, polydata_points(data));
        polydata_add(&data->points, view->points[i]);
    }
    polydata_end_cell(data);
    add_owner(data, view, wisp);
    polydata_add_whole(&data->at_cells[2], hair);
}

static void make_hairs(struct polydata *data, const struct shown *view) {
    begin_wisps(data, view, POLYDATA_LINES);
    polydata_at_cells(data, "hair");
    for (int wisp = 0; wisp < frames_wisps(view->frames, view->frame); wisp++) {
        const struct hairs *hairs = view->drawing.hairs[frames_ancestor(view->frames, wisp)];
        const struct hair_share share = frames_share(view->frames, view->frame, wisp);
        for (int hair = 0; hair < hairs->count; hair++)
            if (hair_share_has(share, hair))
                make_hair(data, view, wisp, hairs, hair);
    }
}

/* --- bodies --- */

enum { ROUND = 48, UP = 24 }; /* faces of a body around its third axis, and along it */

static void add_body_point(struct polydata *data, const struct figure_body *body, int ring, int k) {
    const double down = M_PI * ring / UP, turn = 2 * M_PI * k / ROUND;
    const double on_sphere[3] = {sin(down) * cos(turn), sin(down) * sin(turn), cos(down)};
    double point[3];
    memcpy(point, body->motion.centre, sizeof point);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++)
            point[i] += body->radii[axis] * on_sphere[axis] * body->motion.axes[i][axis];
    polydata_add(&data->points, point);
}

/* Faces with their outside on the side from which their corners go round to the left. */
static void make_body(struct polydata *data, const struct figure_body *body, int number) {
    const int first = polydata_points(data);
    for (int ring = 0; ring <= UP; ring++)
        for (int k = 0; k < ROUND; k++)
            add_body_point(data, body, ring, k);
    for (int ring = 0; ring < UP; ring++)
        for (int k = 0; k < ROUND; k++) {
            const int next = (k + 1) % ROUND, upper = first + ring * ROUND, lower = upper + ROUND;
            if (ring > 0)
                polydata_corner(data, upper + next);
            polydata_corner(data, upper + k);
            polydata_corner(data, lower + k);
            if (ring < UP - 1)
                polydata_corner(data, lower + next);
            polydata_end_cell(data);
            polydata_add_whole(&data->at_cells[0], number);
        }
}

static void make_bodies(struct polydata *data, const struct shown *view) {
    const double t = frames_time(view->frames, view->frame);
    struct figure figure;
    figure_place(&figure, view->frames->scene, t);
    polydata_begin(data, POLYDATA_POLYGONS, t);
    polydata_at_cells(data, "body");
    for (int i = 0; i < figure.count; i++)
        make_body(data, &figure.body[i], i);
}

/* --- files --- */

enum thing { SKELETONS, ENVELOPES, HAIRS, BODIES, THINGS };
static const struct {
    const char *ending; /* of the files' names */
    void (*make)(struct polydata *data, const struct shown *view);
} things[THINGS] = {[SKELETONS] = {"", make_skeletons},
                    [ENVELOPES] = {"-envelopes", make_envelopes},
                    [HAIRS] = {"-hairs", make_hairs},
                    [BODIES] = {"-bodies", make_bodies}};

static int has(const struct frames *frames, enum thing thing) {
    return thing == SKELETONS ||
           (thing == BODIES ? frames->scene->body_count > 0 : frames->wisps[0].samples > 0);
}

static int write_frame(const struct shown *view, const char *folder, const char *name,
                       char *reason) {
    char path[PATH_SIZE];
    int code = 0;
    for (int wisp = 0; wisp < frames_wisps(view->frames, view->frame); wisp++)
        frames_load(view->frames, view->frame, wisp, view->strands[wisp]);
    for (enum thing thing = 0; thing < THINGS && !code; thing++) {
        struct polydata data;
        if (!has(view->frames, thing))
            continue;
        path_format(path, "%s/%s%s-%04d.vtp", folder, name, things[thing].ending, view->frame);
        things[thing].make(&data, view);
        code = polydata_write(&data, path, reason);
        polydata_free(&data);
    }
    return code;
}

static int write_collection(const struct frames *frames, const char *folder, const char *name,
                            const char *ending, char *reason) {
    char path[PATH_SIZE];
    struct atomic_file file;
    if (path_format(path, "%s/%s%s.pvd", folder, name, ending) || atomic_open(&file, path, reason))
        return 2;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
          "byte_order=\"LittleEndian\">\n<Collection>\n",
          file.stream);
    for (int frame = 1; frame <= frames->count; frame++)
        fprintf(file.stream,
                "<DataSet timestep=\"%s\" group=\"\" part=\"0\" file=\"%s%s-%04d.vtp\"/>\n",
                DIGITS(frames_time(frames, frame)), name, ending, frame);
    fputs("</Collection>\n</VTKFile>\n", file.stream);
    return atomic_commit(&file, reason) ? 2 : 0;
}

/* --- all of them --- */

static void open_view(struct shown *view, const struct frames *frames) {
    size_t nodes = 2;
    for (int i = 0; i < frames->wisp_count; i++)
        nodes = MAX(nodes, (size_t)frames->wisps[i].nodes);
    const size_t points = (nodes - 1) * (size_t)frames->scene->render.pieces + 1;
    *view = (struct shown){.frames = frames,
                           .strands = frames_strands(frames),
                           .controls = memory_needed(malloc(nodes * sizeof *view->controls)),
                           .points = memory_needed(malloc(points * sizeof *view->points))};
    drawing_create(&view->drawing, frames, has(frames, HAIRS) ? VIEW_HAIR : 0);
}

static void close_view(struct shown *view) {
    drawing_free(&view->drawing);
    frames_strands_free(view->frames, view->strands);
    free(view->controls);
    free(view->points);
}

int vtk_write(const struct frames *frames, const char *folder, const char *name, char *reason) {
    struct shown view;
    int code = 0;
    open_view(&view, frames);
    for (view.frame = 1; view.frame <= frames->count && !code; view.frame++)
        code = write_frame(&view, folder, name, reason);
    for (enum thing thing = 0; thing < THINGS && !code; thing++)
        if (has(frames, thing))
            code = write_collection(frames, folder, name, things[thing].ending, reason);
    close_view(&view);
    return code;
}
