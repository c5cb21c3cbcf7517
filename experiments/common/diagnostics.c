#include "diagnostics.h"

#include "base/files.h"

#include <ctype.h>
#include <errno.h>
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

int keep_diagnostics(const struct run_case *run, const char *folder, const char *variant,
                     char *reason) {
    char source[PATH_SIZE], target[PATH_SIZE], safe[64];
    struct atomic_file file;
    snprintf(safe, sizeof safe, "%s", variant);
    for (char *c = safe; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("._", *c))
            *c = '-';
    if (path_format(source, "%s/diagnostics.tsv", run->folder) ||
        path_format(target, "%s/diagnostics-%s.tsv", folder, safe)) {
        snprintf(reason, REASON_SIZE, "%.150s: the path is too long", folder);
        return -1;
    }
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
        return atomic_commit(&file, reason);
    atomic_discard(&file);
    if (rows >= 0) /* the run failed before there was a second frame: there is nothing to draw */
        return 0;
    snprintf(reason, REASON_SIZE, "%.150s: cannot be read to its end", source);
    return -1;
}
