#include "frame_binary.h"

#include "base/npy.h"

#include <stdlib.h>
#include <string.h>

int frame_binary_begin(FILE *stream, const struct model *model) {
    const size_t columns = (size_t)model->column_count;
    const char **names = calloc(columns + 3, sizeof *names);
    if (!names)
        return -1;
    names[0] = "t";
    memcpy(names + 1, model->columns, columns * sizeof *names);
    names[columns + 1] = "parent";
    npy_begin(stream, names);
    free(names);
    return 0;
}

void frame_binary_write(FILE *stream, const struct model *model, double t, const double *rows) {
    const size_t columns = (size_t)model->column_count;
    for (int i = 0; i < model->row_count; i++, rows += columns) {
        const double parent = model->parent[(int)rows[0]];
        npy_put(stream, &t, 1);
        npy_put(stream, rows, columns);
        npy_put(stream, &parent, 1);
    }
}
