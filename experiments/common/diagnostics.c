#include "diagnostics.h"

#include "base/files.h"
#include "base/table.h"
#include "measure.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/* Returns the number of rows, the columns' names among them, or -1. */
static int copy(FILE *from, struct atomic_file *to) {
    int rows = 0, begins = 1;
    for (int c; (c = fgetc(from)) != EOF; begins = c == '\n') {
        rows += begins && c != '#';
        fputc(c, to->stream);
    }
    return ferror(from) ? -1 : rows;
}

/* Copies a file. Returns 1, or 0 where it is not there or has no second row, or -1 with a reason.
 */
static int copy_table(const char *source, const char *target, char *reason) {
    struct atomic_file file;
    FILE *from = fopen(source, "r");
    if (!from && errno == ENOENT) /* the run died before it began the table */
        return 0;
    if (!from || atomic_open(&file, target, reason)) {
        if (!from)
            snprintf(reason, REASON_SIZE, "%.150s: cannot be read: %s", source, strerror(errno));
        else
            fclose(from);
        return -1;
    }
    const int rows = copy(from, &file);
    fclose(from);
    if (rows > 2)
        return atomic_commit(&file, reason) ? -1 : 1;
    atomic_discard(&file);
    if (rows >= 0) /* the run failed before there was a second frame: there is nothing to draw */
        return 0;
    return fail_with(reason, "%.150s: cannot be read to its end", source);
}

/* What is left over of the energy's change is the integrator's error, but for the works' own. */
static int state_residual(const char *path, const char *variant, const char *figure,
                          struct statements *statements, char *reason) {
    struct table table;
    if (table_read(&table, path, reason))
        return -1;
    const double residual = measure_largest(&table, "residual"),
                 kinetic = measure_largest(&table, "kinetic");
    statements_add(statements, our_row(figure, figure, HOLDS, residual, "J", "%s", figure),
                   "In the run '%s' at most %.2g J of energy are left unaccounted for, and the "
                   "largest kinetic energy is %.2g J.",
                   variant, residual, kinetic);
    table_free(&table);
    return 0;
}

int keep_diagnostics(const struct run_case *run, const char *folder, const char *variant,
                     struct statements *statements, char *reason) {
    char source[PATH_SIZE], target[PATH_SIZE], figure[80];
    snprintf(figure, sizeof figure, "diagnostics-%.60s", variant);
    for (char *c = figure; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("._", *c))
            *c = '-';
    if (path_format(source, "%s/diagnostics.tsv", run->folder) ||
        path_format(target, "%s/%s.tsv", folder, figure))
        return fail_with(reason, "%.150s: the path is too long", folder);
    const int kept = copy_table(source, target, reason);
    return kept > 0 ? state_residual(target, variant, figure, statements, reason) : kept;
}
