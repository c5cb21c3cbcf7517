#include "diagnostics.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>

static int copy(FILE *from, struct atomic_file *to) {
    char block[4096];
    for (size_t n; (n = fread(block, 1, sizeof block, from)) > 0;)
        fwrite(block, 1, n, to->stream);
    return ferror(from);
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
    if (!from || atomic_open(&file, target, reason)) {
        if (!from)
            snprintf(reason, REASON_SIZE, "%.150s: cannot be read: %s", source, strerror(errno));
        else
            fclose(from);
        return -1;
    }
    const int failed = copy(from, &file);
    fclose(from);
    if (!failed)
        return atomic_commit(&file, reason);
    atomic_discard(&file);
    snprintf(reason, REASON_SIZE, "%.150s: cannot be read to its end", source);
    return -1;
}
