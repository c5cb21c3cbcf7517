#include "files.h"

#include "build_info.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int path_format(char *path, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(path, PATH_SIZE, format, arguments);
    va_end(arguments);
    return length < 0 || length >= PATH_SIZE ? -1 : 0;
}

void plain_name(const char *text, char *name, size_t size) {
    snprintf(name, size, "%s", text);
    for (char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("._-", *c))
            *c = '_';
    if (name[0] == '.')
        name[0] = '_';
}

int file_exists(const char *path) {
    return access(path, R_OK) == 0;
}

int files_like(const char *folder, const char *pattern, glob_t *found) {
    char path[2 * PATH_SIZE];
    size_t used = 0;
    *found = (glob_t){0};
    for (; *folder && used + 2 < sizeof path; folder++) {
        if (strchr("*?[\\", *folder))
            path[used++] = '\\';
        path[used++] = *folder;
    }
    const int length = snprintf(path + used, sizeof path - used, "/%s", pattern);
    if (*folder || used + (size_t)length >= sizeof path)
        return 0;
    return glob(path, 0, NULL, found) == GLOB_NOSPACE ? -1 : 0;
}

char *file_text(const char *path) {
    FILE *file = fopen(path, "r");
    char *text = NULL;
    size_t size = 0;
    if (!file)
        return NULL;
    if (getdelim(&text, &size, '\0', file) < 0) {
        free(text);
        text = feof(file) ? calloc(1, 1) : NULL; /* an empty file, or no memory, or a folder */
    }
    const int error = errno;
    fclose(file);
    errno = error;
    return text;
}

int path_beside_program(const char *name, char *path) {
    char program[PATH_SIZE];
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length <= 0)
        return -1;
    program[length] = '\0';
    char *slash = strrchr(program, '/');
    if (slash)
        *slash = '\0';
    return path_format(path, "%s/%s", program, name);
}

const char *data_folder(void) {
    static char folder[PATH_SIZE];
    if (folder[0])
        return folder;
    if (path_beside_program("../share/wisplab", folder) || !file_exists(folder))
        path_format(folder, "%s", WISPLAB_SOURCE_DIR);
    return folder;
}

int make_folder(const char *path, char *reason) {
    enum { ROOM = 200 }; /* for what will stand in it */
    char partial[PATH_SIZE];
    if (path[0] == '\0' || path_format(partial, "%s", path) || strlen(path) + ROOM > PATH_SIZE) {
        snprintf(reason, REASON_SIZE, "%.60s...: the path of a folder must have 1 to %d letters",
                 path, PATH_SIZE - ROOM);
        return -1;
    }
    for (char *p = partial + 1;; p++) {
        if (*p != '/' && *p != '\0')
            continue;
        const char end = *p;
        *p = '\0';
        if (mkdir(partial, 0777) && errno != EEXIST) {
            snprintf(reason, REASON_SIZE, "%.150s: cannot make the folder: %s", partial,
                     strerror(errno));
            return -1;
        }
        *p = end;
        if (end == '\0')
            break;
    }
    struct stat status;
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode) && access(path, W_OK) == 0)
        return 0;
    snprintf(reason, REASON_SIZE, "%.150s: not a folder that can be written to", path);
    return -1;
}

static int fail(struct atomic_file *file, char *reason) {
    snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", file->path, strerror(errno));
    atomic_discard(file);
    return -1;
}

int atomic_open(struct atomic_file *file, const char *path, char *reason) {
    file->stream = NULL;
    path_format(file->path, "%s", path);
    snprintf(file->temporary, sizeof file->temporary, "%s.%ld.part", path, (long)getpid());
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) { /* a device would be renamed away */
        snprintf(reason, REASON_SIZE, "%.150s: cannot write: there is something, and no file",
                 path);
        file->temporary[0] = '\0';
        return -1;
    }
    file->stream = fopen(file->temporary, "w");
    return file->stream ? 0 : fail(file, reason);
}

int atomic_commit(struct atomic_file *file, char *reason) {
    const int bad = fflush(file->stream) || ferror(file->stream);
    if (bad)
        return fail(file, reason);
    const int unclosed = fclose(file->stream);
    file->stream = NULL;
    if (unclosed || rename(file->temporary, file->path))
        return fail(file, reason);
    return 0;
}

void atomic_discard(struct atomic_file *file) {
    if (!file->stream && file->temporary[0] == '\0')
        return;
    if (file->stream)
        fclose(file->stream);
    file->stream = NULL;
    unlink(file->temporary);
    file->temporary[0] = '\0';
}
