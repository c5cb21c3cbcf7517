#include "polydata.h"

#include "base/digits.h"
#include "base/files.h"
#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void polydata_begin(struct polydata *data, enum polydata_kind kind, double time) {
    *data = (struct polydata){.kind = kind,
                              .time = time,
                              .points = {.name = "position", .components = 3},
                              .corners = {.name = "connectivity", .components = 1, .is_whole = 1},
                              .ends = {.name = "offsets", .components = 1, .is_whole = 1}};
}

void polydata_free(struct polydata *data) {
    free(data->points.value);
    free(data->corners.value);
    free(data->ends.value);
    for (int i = 0; i < POLYDATA_ARRAYS; i++) {
        free(data->at_points[i].value);
        free(data->at_cells[i].value);
    }
    *data = (struct polydata){.time = 0};
}

static struct polydata_array *take(struct polydata_array *arrays, const char *name, int components,
                                   int is_whole) {
    while (arrays->name)
        arrays++;
    *arrays = (struct polydata_array){.name = name, .components = components, .is_whole = is_whole};
    return arrays;
}

struct polydata_array *polydata_at_points(struct polydata *data, const char *name, int components) {
    return take(data->at_points, name, components, 0);
}

struct polydata_array *polydata_at_cells(struct polydata *data, const char *name) {
    return take(data->at_cells, name, 1, 1);
}

void polydata_add(struct polydata_array *array, const double *value) {
    const size_t count = (size_t)array->components;
    array->value =
        memory_for(array->value, array->count + count, &array->room, sizeof *array->value);
    memcpy(array->value + array->count, value, count * sizeof *value);
    array->count += count;
}

void polydata_add_whole(struct polydata_array *array, int value) {
    polydata_add(array, (const double[]){value});
}

int polydata_points(const struct polydata *data) {
    return (int)(data->points.count / 3);
}

void polydata_corner(struct polydata *data, int point) {
    polydata_add_whole(&data->corners, point);
}

void polydata_end_cell(struct polydata *data) {
    polydata_add_whole(&data->ends, (int)data->corners.count);
}

/* --- the file --- */

static uint64_t bytes_of(const struct polydata_array *array) {
    return array->count * (array->is_whole ? sizeof(int32_t) : sizeof(double));
}

/* Says what the array is, and that its numbers begin `at` bytes behind the document. */
static void declare(FILE *file, const struct polydata_array *array, uint64_t *at) {
    fprintf(file,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
            "offset=\"%llu\"/>\n",
            array->is_whole ? "Int32" : "Float64", array->name, array->components,
            (unsigned long long)*at);
    *at += sizeof(uint64_t) + bytes_of(array);
}

static void declare_all(FILE *file, const char *what, const struct polydata_array *arrays,
                        uint64_t *at) {
    fprintf(file, "<%s>\n", what);
    for (int i = 0; i < POLYDATA_ARRAYS && arrays[i].name; i++)
        declare(file, &arrays[i], at);
    fprintf(file, "</%s>\n", what);
}

/* Their length in bytes, and the numbers. */
static void append(FILE *file, const struct polydata_array *array) {
    const uint64_t bytes = bytes_of(array);
    fwrite(&bytes, sizeof bytes, 1, file);
    if (!array->is_whole && array->count > 0)
        fwrite(array->value, sizeof *array->value, array->count, file);
    for (size_t i = 0; array->is_whole && i < array->count; i++) {
        const int32_t whole = (int32_t)array->value[i];
        fwrite(&whole, sizeof whole, 1, file);
    }
}

static void write_document(FILE *file, const struct polydata *data) {
    const char *cells = data->kind == POLYDATA_LINES ? "Lines" : "Polys";
    uint64_t at = 0;
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n"
            "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
            "format=\"ascii\">%s</DataArray>\n</FieldData>\n"
            "<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfLines=\"%zu\" "
            "NumberOfStrips=\"0\" NumberOfPolys=\"%zu\">\n<Points>\n",
            DIGITS(data->time), polydata_points(data),
            data->kind == POLYDATA_LINES ? data->ends.count : 0,
            data->kind == POLYDATA_POLYGONS ? data->ends.count : 0);
    declare(file, &data->points, &at);
    fputs("</Points>\n", file);
    declare_all(file, "PointData", data->at_points, &at);
    declare_all(file, "CellData", data->at_cells, &at);
    fprintf(file, "<%s>\n", cells);
    declare(file, &data->corners, &at);
    declare(file, &data->ends, &at);
    fprintf(file, "</%s>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", cells);
}

int polydata_write(const struct polydata *data, const char *path, char *reason) {
    struct atomic_file file;
    if (atomic_open(&file, path, reason))
        return 2;
    write_document(file.stream, data);
    append(file.stream, &data->points);
    for (int i = 0; i < POLYDATA_ARRAYS && data->at_points[i].name; i++)
        append(file.stream, &data->at_points[i]);
    for (int i = 0; i < POLYDATA_ARRAYS && data->at_cells[i].name; i++)
        append(file.stream, &data->at_cells[i]);
    append(file.stream, &data->corners);
    append(file.stream, &data->ends);
    fputs("\n</AppendedData>\n</VTKFile>\n", file.stream);
    return atomic_commit(&file, reason) ? 2 : 0;
}
