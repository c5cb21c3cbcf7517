#include "usd.h"

#include "base/digits.h"
#include "base/files.h"
#include "bodies.h"
#include "nodes.h"

static const double thin = 2e-3; /* of a wisp without an envelope, m: only to be seen */

struct layer_of_frames {
    const struct frames *frames;
    struct strand **strands; /* by wisp */
    FILE *file;
};

static void begin_samples(FILE *file, const char *attribute) {
    fprintf(file, "        %s.timeSamples = {\n", attribute);
}

static void end_samples(FILE *file) {
    fputs("        }\n", file);
}

/* --- wisps --- */

enum quantity { COUNTS, POINTS, WIDTHS };

static void write_node(FILE *file, const struct strand *strand, int node, enum quantity quantity) {
    const double *p = strand->p[node], radius = node_radius(strand, node);
    if (quantity == POINTS)
        fprintf(file, "(%s, %s, %s)", DIGITS(p[0]), DIGITS(p[1]), DIGITS(p[2]));
    else
        fputs(DIGITS(radius > 0 ? 2 * radius : thin), file);
}

/* A value for each wisp of a frame, or for each of its nodes. */
static void write_frame(const struct layer_of_frames *layer, int frame, enum quantity quantity) {
    fprintf(layer->file, "            %d: [", frame);
    for (int wisp = 0; wisp < frames_wisps(layer->frames, frame); wisp++) {
        const struct strand *strand = layer->strands[wisp];
        const int count = quantity == COUNTS ? 1 : strand->wisp->nodes;
        frames_load(layer->frames, frame, wisp, layer->strands[wisp]);
        for (int i = 0; i < count; i++) {
            fputs(wisp + i > 0 ? ", " : "", layer->file);
            if (quantity == COUNTS)
                fprintf(layer->file, "%d", strand->wisp->nodes);
            else
                write_node(layer->file, strand, i, quantity);
        }
    }
    fputs("],\n", layer->file);
}

static void write_wisps(const struct layer_of_frames *layer) {
    static const char *const attributes[] = {"int[] curveVertexCounts", "point3f[] points",
                                             "float[] widths"};
    fputs("    def BasisCurves \"wisps\"\n    {\n        uniform token type = \"linear\"\n",
          layer->file);
    for (enum quantity quantity = COUNTS; quantity <= WIDTHS; quantity++) {
        begin_samples(layer->file, attributes[quantity]);
        for (int frame = 1; frame <= layer->frames->count; frame++)
            write_frame(layer, frame, quantity);
        end_samples(layer->file);
    }
    const double *colour = layer->frames->scene->render.colour;
    fprintf(layer->file, "        color3f[] primvars:displayColor = [(%s, %s, %s)]\n    }\n",
            DIGITS(colour[0]), DIGITS(colour[1]), DIGITS(colour[2]));
}

/* --- bodies --- */

/* The matrix that makes the unit sphere the body: as USD has rows of vectors on its left, its rows
 * are what becomes of the axes, and of the origin. */
static void write_matrix(FILE *file, const struct figure_body *body) {
    const struct body_motion *motion = &body->motion;
    fputs("( ", file);
    for (int axis = 0; axis < 3; axis++)
        fprintf(file, "(%s, %s, %s, 0), ", DIGITS(body->radii[axis] * motion->axes[0][axis]),
                DIGITS(body->radii[axis] * motion->axes[1][axis]),
                DIGITS(body->radii[axis] * motion->axes[2][axis]));
    fprintf(file, "(%s, %s, %s, 1) )", DIGITS(motion->centre[0]), DIGITS(motion->centre[1]),
            DIGITS(motion->centre[2]));
}

static void write_body(const struct layer_of_frames *layer, int number) {
    fprintf(layer->file,
            "    def Sphere \"body_%d\"\n    {\n        double radius = 1\n"
            "        float3[] extent = [(-1, -1, -1), (1, 1, 1)]\n",
            number);
    begin_samples(layer->file, "matrix4d xformOp:transform");
    for (int frame = 1; frame <= layer->frames->count; frame++) {
        struct figure figure;
        figure_place(&figure, layer->frames->scene, frames_time(layer->frames, frame));
        fprintf(layer->file, "            %d: ", frame);
        write_matrix(layer->file, &figure.body[number]);
        fputs(",\n", layer->file);
    }
    end_samples(layer->file);
    fputs("        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }\n", layer->file);
}

/* --- the file --- */

static void write_layer(const struct layer_of_frames *layer) {
    const struct scene *scene = layer->frames->scene;
    fprintf(layer->file,
            "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    endTimeCode = %d\n"
            "    framesPerSecond = %s\n    metersPerUnit = 1\n    startTimeCode = 1\n"
            "    timeCodesPerSecond = %s\n    upAxis = \"%s\"\n)\n\ndef Xform \"scene\"\n{\n",
            layer->frames->count, DIGITS(scene->frame_rate), DIGITS(scene->frame_rate),
            scene->around.gravity[2] < 0 ? "Z" : "Y");
    write_wisps(layer);
    for (int i = 0; i < scene->body_count; i++)
        write_body(layer, i);
    fputs("}\n", layer->file);
}

int usd_write(const struct frames *frames, const char *folder, const char *name, char *reason) {
    char path[PATH_SIZE];
    struct atomic_file file;
    path_format(path, "%s/%s.usda", folder, name);
    if (atomic_open(&file, path, reason))
        return 2;
    const struct layer_of_frames layer = {frames, frames_strands(frames), file.stream};
    write_layer(&layer);
    frames_strands_free(frames, layer.strands);
    return atomic_commit(&file, reason) ? 2 : 0;
}
