#include "files.h"

#include "build_info.h"
#include "hash.h"
#include "owner.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

int fail_with(char *reason, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, REASON_SIZE, format, arguments);
    va_end(arguments);
    return -1;
}

int fail_as(int code, char *reason, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, REASON_SIZE, format, arguments);
    va_end(arguments);
    return code;
}

int fail_at(char *reason, const char *path, int line, const char *what) {
    return line > 0 ? fail_with(reason, "%.150s:%d: %s", path, line, what)
                    : fail_with(reason, "%.150s: %s", path, what);
}

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

FILE *open_regular(const char *path) {
    const off_t most = 1 << 30;
    struct stat status;
    const int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* a pipe may be empty */
    if (descriptor < 0)
        return NULL;
    int error = fstat(descriptor, &status) ? errno : 0;
    if (!error && !(S_ISREG(status.st_mode) && status.st_size <= most))
        error = EINVAL;
    FILE *file = error ? NULL : fdopen(descriptor, "r");
    if (!file) {
        error = error ? error : errno;
        close(descriptor);
        errno = error;
    }
    return file;
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
    FILE *file = open_regular(path);
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

json_t *json_of_file(const char *path, json_error_t *error) {
    FILE *file = open_regular(path);
    if (!file) {
        *error = (json_error_t){.line = -1};
        snprintf(error->text, sizeof error->text, "cannot be opened: %s",
                 errno == EINVAL ? "it is no regular file of at most a gibibyte" : strerror(errno));
        return NULL;
    }
    json_t *json = json_loadf(file, 0, error);
    fclose(file);
    return json;
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

static char data_path[PATH_SIZE];
static const char *told_path;
static pthread_once_t data_found = PTHREAD_ONCE_INIT; /* for pictures are drawn side by side */

static void find_data(void) {
    const int none = told_path ? path_format(data_path, "%s", told_path)
                               : path_beside_program("../share/wisplab", data_path);
    if (none || !file_exists(data_path))
        path_format(data_path, "%s", WISPLAB_SOURCE_DIR);
}

const char *data_folder(void) {
    pthread_once(&data_found, find_data);
    return data_path;
}

void data_folder_is(const char *folder) {
    told_path = folder;
    data_folder();
}

int make_folder(const char *path, char *reason) {
    enum { ROOM = 200 }; /* for what will stand in it */
    char partial[PATH_SIZE];
    if (path[0] == '\0' || path_format(partial, "%s", path) || strlen(path) + ROOM > PATH_SIZE)
        return fail_with(reason, "%.60s...: the path of a folder must have 1 to %d letters", path,
                         PATH_SIZE - ROOM);
    for (char *p = partial + 1;; p++) {
        if (*p != '/' && *p != '\0')
            continue;
        const char end = *p;
        *p = '\0';
        if (mkdir(partial, 0777) && errno != EEXIST)
            return fail_with(reason, "%.150s: cannot make the folder: %s", partial,
                             strerror(errno));
        *p = end;
        if (end == '\0')
            break;
    }
    struct stat status;
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode) && access(path, W_OK) == 0)
        return 0;
    return fail_with(reason, "%.150s: not a folder that can be written to", path);
}

/* --- files that appear whole --- */

/* Temporary names: path.HOST-PID-RANDOM.part, with a hash for the host. */
static void short_host(char host[9]) {
    char hash[HASH_SIZE];
    hash_bytes(owner_host(), strlen(owner_host()), hash);
    snprintf(host, 9, "%.8s", hash);
}

static int fail(struct atomic_file *file, char *reason) {
    snprintf(reason, REASON_SIZE, "%.150s: cannot write: %s", file->path, strerror(errno));
    atomic_discard(file);
    return -1;
}

/* Whether nobody writes to a temporary file any more; `rest` is its name behind the path. `now` is
 * the file server's time, s: other hosts cannot be asked, and get an hour; 0: no end of time. */
static int is_leftover(const char *temporary, const char *rest, time_t now) {
    enum { HOUR = 3600 };
    struct owner writer = {.start = 0};
    struct stat status;
    char here[9], host[9];
    short_host(here);
    if (sscanf(rest, ".%8[0-9a-f]-%ld-", host, &writer.pid) == 2 && strcmp(host, here) == 0) {
        snprintf(writer.host, sizeof writer.host, "%s", owner_host());
        return owner_look(&writer) == OWNER_GONE;
    }
    return now > 0 && lstat(temporary, &status) == 0 && now - status.st_mtime > HOUR;
}

static int remove_one(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status, (void)kind, (void)place;
    remove(path);
    return 0;
}

static void remove_leftovers(const char *path, time_t now) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    char folder[PATH_SIZE], pattern[PATH_SIZE];
    glob_t found;
    path_format(folder, "%.*s", slash ? (int)(slash - path) : 1, slash ? path : ".");
    if (strpbrk(name, "*?[\\") || path_format(pattern, "%s.*.part", name))
        return;
    files_like(folder, pattern, &found);
    for (size_t i = 0; i < found.gl_pathc; i++)
        if (is_leftover(found.gl_pathv[i], strrchr(found.gl_pathv[i], '/') + 1 + strlen(name), now))
            nftw(found.gl_pathv[i], remove_one, 8, FTW_DEPTH | FTW_PHYS);
    globfree(&found);
}

void atomic_remove_leftovers(const char *path) {
    remove_leftovers(path, 0);
}

/* A name that nobody else has, and cannot foresee. */
static int temporary_name(const char *path, char *name, size_t size) {
    unsigned random = 0;
    char host[9];
    short_host(host);
    if (getrandom(&random, sizeof random, 0) < 0)
        return -1;
    const int length =
        snprintf(name, size, "%s.%s-%ld-%08x.part", path, host, (long)getpid(), random);
    errno = ENAMETOOLONG;
    return length < 0 || (size_t)length >= size ? -1 : 0;
}

int temporary_folder(const char *folder, char *path, char *reason) {
    char name[PATH_SIZE];
    struct stat status;
    if (make_folder(folder, reason))
        return -1;
    if (path_format(name, "%s/.drawing", folder) || temporary_name(name, path, PATH_SIZE) ||
        mkdir(path, 0777))
        return fail_with(reason, "%.150s: cannot make a folder there: %s", folder, strerror(errno));
    if (stat(path, &status) == 0)
        remove_leftovers(name, status.st_mtime);
    return 0;
}

int atomic_open(struct atomic_file *file, const char *path, char *reason) {
    file->stream = NULL;
    file->temporary[0] = '\0';
    path_format(file->path, "%s", path);
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) { /* a device would be renamed away */
        return fail_with(reason, "%.150s: cannot write: there is something, and no file", path);
    }
    if (temporary_name(path, file->temporary, sizeof file->temporary))
        return fail(file, reason);
    const int descriptor =
        open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        file->temporary[0] = '\0'; /* what is there is not ours */
        return fail(file, reason);
    }
    if (fstat(descriptor, &status) == 0)
        remove_leftovers(path, status.st_mtime);
    file->stream = fdopen(descriptor, "w");
    if (file->stream)
        return 0;
    close(descriptor);
    return fail(file, reason);
}

/* Puts on the disk that a name was given. A folder that may not be read keeps it as it may. */
static void sync_folder_of(const char *path) {
    char folder[PATH_SIZE];
    const char *slash = strrchr(path, '/');
    path_format(folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
    const int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        fsync(descriptor);
        close(descriptor);
    }
}

/* Puts a file's contents on the disk, where the file system knows such a thing. */
static int sync_file(int descriptor) {
    return fsync(descriptor) && errno != EINVAL ? -1 : 0;
}

static int put(const char *from, const char *to) {
    if (rename(from, to))
        return -1;
    sync_folder_of(to);
    return 0;
}

int atomic_close(struct atomic_file *file, int on_disk, char *reason) {
    const int bad = fflush(file->stream) || ferror(file->stream) ||
                    (on_disk && sync_file(fileno(file->stream)));
    if (bad)
        return fail(file, reason);
    const int unclosed = fclose(file->stream);
    file->stream = NULL;
    return unclosed ? fail(file, reason) : 0;
}

/* Returns how many of the files have their names; if not all, errno is of the first that has not.
 */
static int rename_some(const struct atomic_file *files, int count) {
    int named = 0;
    while (named < count &&
           (!*files[named].temporary || rename(files[named].temporary, files[named].path) == 0))
        named++;
    return named;
}

int atomic_name(struct atomic_file *files, int count, char *reason) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    const int named = rename_some(files, count), error = errno;
    for (int i = 0; i < named && named < count; i++)
        if (*files[i].temporary)
            unlink(files[i].path);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (named == count) {
        sync_folder_of(files[count - 1].path);
        return 0;
    }
    errno = error;
    fail(&files[named], reason);
    for (int i = named; i < count; i++)
        atomic_discard(&files[i]);
    return -1;
}

int atomic_commit(struct atomic_file *file, char *reason) {
    return atomic_close(file, 1, reason) || atomic_name(file, 1, reason) ? -1 : 0;
}

int file_put(const char *from, const char *to) {
    const int descriptor = open(from, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0)
        return -1;
    const int bad = sync_file(descriptor), error = errno;
    close(descriptor);
    errno = error;
    return bad ? -1 : put(from, to);
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
