#include "columns.h"

void columns_write(FILE *stream, const struct column *columns) {
    for (const struct column *c = columns; c->name; c++)
        fprintf(stream, "# %s, %s: %s\n", c->name, c->unit, c->meaning);
    for (const struct column *c = columns; c->name; c++)
        fprintf(stream, "%s%s", c == columns ? "" : "\t", c->name);
    fputc('\n', stream);
}
