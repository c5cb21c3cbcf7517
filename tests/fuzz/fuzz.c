#include "fuzz.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of libraries, and not ours: libconfig forgets what its scanner and parser hold of a scene with a
 * syntax error (1.5; mended in 1.7.3). */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
    return "leak:strbuf_append\nleak:libconfig_yyparse\nleak:libconfig_yylex\n";
}

static char folder[64];

static int remove_one(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status, (void)kind, (void)place;
    return remove(path);
}

static void remove_folder(void) {
    nftw(folder, remove_one, 4, FTW_DEPTH | FTW_PHYS);
}

const char *fuzz_file(const char *name, const uint8_t *data, size_t size) {
    static char path[128];
    if (!*folder) {
        snprintf(folder, sizeof folder, "%s/wisplab-fuzz-XXXXXX",
                 access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
        if (!mkdtemp(folder))
            abort();
        atexit(remove_folder);
    }
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file))
        abort();
    return path;
}

void fuzz_refusal(const char *reason) {
    const size_t length = strnlen(reason, REASON_SIZE);
    if (length > 0 && length < REASON_SIZE && !strchr(reason, '\n'))
        return;
    fprintf(stderr, "a refusal is not one line: '%.*s'\n", (int)length, reason);
    abort();
}
