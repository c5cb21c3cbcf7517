#include "pack.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

/* A file of another process, and how far it was read. */
struct pack_file {
    char *path;
    long long offset; /* of the first byte behind the last complete line */
    int lines;        /* before that */
};

static int fail(const char *path, const char *what, char *reason) {
    return fail_with(reason, "%.150s: %s: %s", path, what, strerror(errno));
}

int pack_open(struct pack *pack, const char *folder) {
    *pack = (struct pack){.file = -1};
    return path_format(pack->folder, "%s", folder);
}

/* --- what others have written --- */

/* Cuts a line into its parts, where it is one. */
static int cut_line(char *line, char **key, char **cells) {
    char hash[HASH_SIZE];
    char *first = strchr(line, '\t'), *second = first ? strchr(first + 1, '\t') : NULL;
    if (!second)
        return -1;
    *first = '\0';
    hash_bytes(first + 1, strlen(first + 1), hash);
    *second = '\0';
    *key = first + 1;
    *cells = second + 1;
    return strcmp(hash, line);
}

static struct pack_file *file_of(struct pack *pack, const char *path) {
    for (int i = 0; i < pack->seen_count; i++)
        if (strcmp(pack->seen[i].path, path) == 0)
            return &pack->seen[i];
    struct pack_file *seen =
        realloc(pack->seen, ((size_t)pack->seen_count + 1) * sizeof *pack->seen);
    if (!seen)
        return NULL;
    pack->seen = seen;
    seen[pack->seen_count] = (struct pack_file){.path = strdup(path)};
    return seen[pack->seen_count].path ? &seen[pack->seen_count++] : NULL;
}

/* The complete lines of a file from where it was left. It is opened anew at each look: that is when
 * a file server says what there is by now. */
static int read_on(struct pack *pack, struct pack_file *file,
                   void (*take)(void *ctx, const char *key, const char *cells), void *ctx,
                   char *reason) {
    char *line = NULL;
    size_t size = 0;
    FILE *stream = fopen(file->path, "re");
    if (!stream)
        return errno == ENOENT ? 0 : fail(file->path, "cannot be read", reason);
    int code = fseeko(stream, file->offset, SEEK_SET);
    for (ssize_t length; !code && (length = getline(&line, &size, stream)) > 0;) {
        char *key, *cells;
        if (line[length - 1] != '\n')
            break;
        line[length - 1] = '\0';
        file->offset += length;
        file->lines++;
        if (cut_line(line, &key, &cells) == 0)
            take(ctx, key, cells);
        else if (pack->damaged++ == 0)
            snprintf(pack->first_damaged, sizeof pack->first_damaged, "%s:%d", file->path,
                     file->lines);
    }
    if (code || ferror(stream))
        code = fail(file->path, "cannot be read", reason);
    free(line);
    fclose(stream);
    return code;
}

int pack_look(struct pack *pack, void (*take)(void *ctx, const char *key, const char *cells),
              void *ctx, char *reason) {
    glob_t found;
    if (files_like(pack->folder, "packed-*.tsv", &found))
        return fail_with(reason, "out of memory");
    int code = 0;
    for (size_t i = 0; i < found.gl_pathc && !code; i++) {
        if (strcmp(found.gl_pathv[i], pack->own) == 0)
            continue;
        struct pack_file *file = file_of(pack, found.gl_pathv[i]);
        if (!file)
            snprintf(reason, REASON_SIZE, "out of memory");
        code = file ? read_on(pack, file, take, ctx, reason) : -1;
    }
    globfree(&found);
    return code;
}

/* --- what this process writes --- */

static int create(struct pack *pack, char *reason) {
    unsigned random[2] = {0};
    errno = ENAMETOOLONG;
    if (getrandom(random, sizeof random, 0) > 0 &&
        path_format(pack->own, "%s/packed-%08x%08x.tsv", pack->folder, random[0], random[1]) == 0)
        pack->file =
            open(pack->own, O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666);
    return pack->file < 0 ? fail(pack->folder, "cannot be written to", reason) : 0;
}

int pack_append(struct pack *pack, const char *key, const char *cells, char *reason) {
    char hash[HASH_SIZE], *line;
    if (pack->file < 0 && create(pack, reason))
        return -1;
    const int length = asprintf(&line, "%*s\t%s\t%s\n", HASH_SIZE - 1, "", key, cells);
    if (length < 0)
        return fail_with(reason, "out of memory");
    hash_bytes(line + HASH_SIZE, (size_t)length - HASH_SIZE - 1, hash);
    memcpy(line, hash, HASH_SIZE - 1);
    errno = ENOSPC; /* where less is written than was given */
    const int bad = write(pack->file, line, (size_t)length) != length;
    free(line);
    return bad ? fail(pack->own, "cannot be written to", reason) : 0;
}

int pack_settle(struct pack *pack, char *reason) {
    return pack->file >= 0 && fsync(pack->file) ? fail(pack->own, "cannot be written to", reason)
                                                : 0;
}

void pack_close(struct pack *pack) {
    for (int i = 0; i < pack->seen_count; i++)
        free(pack->seen[i].path);
    free(pack->seen);
    if (pack->file >= 0)
        close(pack->file);
    *pack = (struct pack){.file = -1};
}
