#include "vtk.h"

#include "base/digits.h"
#include "base/files.h"
#include "base/vector.h"

#include <stdlib.h>

/* --- what is at a node --- */

/* Of the segment from node i to the next; those of the head do not stretch. */
static double segment_strain(const struct strand *strand, int i) {
    double d[3] = {strand->p[i + 1][0], strand->p[i + 1][1], strand->p[i + 1][2]};
    vector_add(d, -1, strand->p[i]);
    return vector_length(d) / wisp_spacing(strand->wisp) - 1;
}

static double node_strain(const struct strand *strand, int i) {
    const int last = strand->wisp->nodes - 1;
    const double before = i > 0 ? segment_strain(strand, i - 1) : 0,
                 after = i < last ? segment_strain(strand, i) : 0;
    return i == 0 ? after : i == last ? before : 0.5 * (before + after);
}

static double node_radius(const struct strand *strand, int i) {
    const int samples = strand->wisp->samples;
    double sum = 0;
    for (int j = 0; j < samples; j++)
        sum += strand->r[i * samples + j];
    return samples > 0 ? sum / samples : 0;
}

/* --- one file --- */

enum quantity { POINTS, VELOCITY, STRAIN, RADIUS };

static void write_node(FILE *file, const struct strand *strand, int i, enum quantity quantity) {
    const double *vector = quantity == POINTS ? strand->p[i] : strand->v[i];
    if (quantity == POINTS || quantity == VELOCITY)
        fprintf(file, "%s %s %s\n", DIGITS(vector[0]), DIGITS(vector[1]), DIGITS(vector[2]));
    else
        fprintf(file, "%s\n",
                DIGITS(quantity == STRAIN ? node_strain(strand, i) : node_radius(strand, i)));
}

static void write_nodes(FILE *file, struct strand *const *strands, int count,
                        enum quantity quantity, const char *name, int components) {
    fprintf(file,
            "<DataArray type=\"Float64\" Name=\"%s\" NumberOfComponents=\"%d\" "
            "format=\"ascii\">\n",
            name, components);
    for (int wisp = 0; wisp < count; wisp++)
        for (int i = 0; i < strands[wisp]->wisp->nodes; i++)
            write_node(file, strands[wisp], i, quantity);
    fputs("</DataArray>\n", file);
}

/* The points of line after line are numbered through. */
static void write_lines(FILE *file, struct strand *const *strands, const int *parent, int count,
                        int points) {
    static const char *const begin = "<DataArray type=\"Int32\" Name=\"%s\" format=\"ascii\">\n";
    fputs("<Lines>\n", file);
    fprintf(file, begin, "connectivity");
    for (int i = 0; i < points; i++)
        fprintf(file, "%d\n", i);
    fputs("</DataArray>\n", file);
    fprintf(file, begin, "offsets");
    for (int wisp = 0, end = 0; wisp < count; wisp++)
        fprintf(file, "%d\n", end += strands[wisp]->wisp->nodes);
    fputs("</DataArray>\n</Lines>\n<CellData Scalars=\"wisp\">\n", file);
    fprintf(file, begin, "wisp");
    for (int wisp = 0; wisp < count; wisp++)
        fprintf(file, "%d\n", wisp);
    fputs("</DataArray>\n", file);
    fprintf(file, begin, "parent");
    for (int wisp = 0; wisp < count; wisp++)
        fprintf(file, "%d\n", parent[wisp]);
    fputs("</DataArray>\n</CellData>\n", file);
}

static void write_document(FILE *file, struct strand *const *strands, const int *parent, int count,
                           double t) {
    int points = 0;
    for (int wisp = 0; wisp < count; wisp++)
        points += strands[wisp]->wisp->nodes;
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\">\n<PolyData>\n<FieldData>\n<DataArray type=\"Float64\" "
            "Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">%s</DataArray>\n"
            "</FieldData>\n<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfLines=\"%d\" "
            "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
            DIGITS(t), points, count);
    write_nodes(file, strands, count, POINTS, "position", 3);
    fputs("</Points>\n<PointData Vectors=\"velocity\" Scalars=\"strain\">\n", file);
    write_nodes(file, strands, count, VELOCITY, "velocity", 3);
    write_nodes(file, strands, count, STRAIN, "strain", 1);
    write_nodes(file, strands, count, RADIUS, "radius", 1);
    fputs("</PointData>\n", file);
    write_lines(file, strands, parent, count, points);
    fputs("</Piece>\n</PolyData>\n</VTKFile>\n", file);
}

static int write_frame(const struct frames *frames, int frame, struct strand *const *strands,
                       const char *folder, const char *name, char *reason) {
    char path[PATH_SIZE];
    struct atomic_file file;
    const int count = frames_wisps(frames, frame);
    if (path_format(path, "%s/%s-%04d.vtp", folder, name, frame) ||
        atomic_open(&file, path, reason))
        return 2;
    for (int wisp = 0; wisp < count; wisp++)
        frames_load(frames, frame, wisp, strands[wisp]);
    write_document(file.stream, strands, frames->parent, count, frames_time(frames, frame));
    return atomic_commit(&file, reason) ? 2 : 0;
}

/* --- all of them --- */

static int write_collection(const struct frames *frames, const char *folder, const char *name,
                            char *reason) {
    char path[PATH_SIZE];
    struct atomic_file file;
    if (path_format(path, "%s/%s.pvd", folder, name) || atomic_open(&file, path, reason))
        return 2;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
          "byte_order=\"LittleEndian\">\n<Collection>\n",
          file.stream);
    for (int frame = 1; frame <= frames->count; frame++)
        fprintf(file.stream,
                "<DataSet timestep=\"%s\" group=\"\" part=\"0\" file=\"%s-%04d.vtp\"/>\n",
                DIGITS(frames_time(frames, frame)), name, frame);
    fputs("</Collection>\n</VTKFile>\n", file.stream);
    return atomic_commit(&file, reason) ? 2 : 0;
}

int vtk_write(const struct frames *frames, const char *folder, const char *name, char *reason) {
    struct strand **strands = calloc((size_t)frames->wisp_count, sizeof *strands);
    int code = strands ? 0 : 2;
    snprintf(reason, REASON_SIZE, "out of memory");
    for (int i = 0; i < frames->wisp_count && !code; i++) {
        strands[i] = strand_create(&frames->wisps[i], frames->treatment);
        code = strands[i] ? 0 : 2;
    }
    for (int frame = 1; frame <= frames->count && !code; frame++)
        code = write_frame(frames, frame, strands, folder, name, reason);
    if (!code)
        code = write_collection(frames, folder, name, reason);
    for (int i = 0; strands && i < frames->wisp_count; i++)
        strand_free(strands[i]);
    free(strands);
    return code;
}
