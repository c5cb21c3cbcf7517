/* Files: where the program's data are, and results that appear whole or not at all. */
#ifndef WISPLAB_FILES_H
#define WISPLAB_FILES_H

#include <glob.h>
#include <jansson.h>
#include <stdio.h>

enum { PATH_SIZE = 1024, REASON_SIZE = 400 };

/* Writes why something failed (printf) into `reason` (REASON_SIZE); returns -1, or `code`. */
int fail_with(char *reason, const char *format, ...) __attribute__((format(printf, 2, 3)));
int fail_as(int code, char *reason, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* As fail_with, of a file: its path, the line where that is not 0, what is wrong. */
int fail_at(char *reason, const char *path, int line, const char *what);

/* Joins parts into `path` (PATH_SIZE); returns 0, or -1 where it does not fit. */
int path_format(char *path, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A text as part of a file's name: what is no letter, digit, dot, hyphen or underscore is replaced
 * by an underscore, and so is a dot in front. */
void plain_name(const char *text, char *name, size_t size);

/* A path from the folder of the program that runs, into `path` (PATH_SIZE). Returns 0, or -1 where
 * the system does not say where that is. */
int path_beside_program(const char *name, char *path);

/* The folder that holds `experiments` and `plots`: beside an installed program, or the source. */
const char *data_folder(void);

/* Says where that is in a program that is not ours, whose place tells nothing: `folder` if it is
 * there, or the source. To be said once, before the first call of data_folder. */
void data_folder_is(const char *folder);

/* Makes a folder and its parents. Returns 0, or -1 with one line in `reason` (REASON_SIZE). */
int make_folder(const char *path, char *reason);

/* A file that is written under a temporary name in its folder, which nobody else can foresee or
 * have put there, and gets its own when it is complete and on the disk: after a crash of the
 * program or of the machine there is the whole file or none. */
struct atomic_file {
    FILE *stream; /* to write to; errors are found by commit */
    char path[PATH_SIZE], temporary[PATH_SIZE + 64];
};

/* Opens, and removes temporary files of that name whose writers are gone; those of other hosts,
 * which cannot be asked, when they have not been written to for an hour. Returns 0, or -1 with one
 * line in `reason`. */
int atomic_open(struct atomic_file *file, const char *path, char *reason);

/* Closes and renames; returns 0, or -1 with one line in `reason` and nothing left behind. */
int atomic_commit(struct atomic_file *file, char *reason);

/* The two halves of it, for files of one folder that belong together. Closes a file, which is
 * complete then, and on the disk if so asked, but has no name yet; the same returns. */
int atomic_close(struct atomic_file *file, int on_disk, char *reason);

/* Gives closed files their names, in this order: no time passes between them, and no signal comes
 * but SIGKILL. Where one cannot have its name, none has, and nothing is left behind. One that was
 * not opened, or has its name, is no harm. */
int atomic_name(struct atomic_file *files, int count, char *reason);

/* Closes and removes; harmless after commit. */
void atomic_discard(struct atomic_file *file);

/* Removes temporary files of that name whose writers were on this host and are gone. */
void atomic_remove_leftovers(const char *path);

/* Makes a folder for what a tool draws, inside another one, into `path` (PATH_SIZE), and removes
 * such folders whose makers are gone. Returns 0, or -1 with one line in `reason`. */
int temporary_folder(const char *folder, char *path, char *reason);

/* Gives a complete file its name, as atomic_commit does. Returns 0, or -1 with errno. */
int file_put(const char *from, const char *to);

/* Whether a path can be read. */
int file_exists(const char *path);

/* Opens a file that is to be read whole: a regular one of at most a gibibyte, for of others nobody
 * knows where they end. NULL with errno, which is EINVAL where it is not such a file. */
FILE *open_regular(const char *path);

/* The files of a folder, whatever letters its path has, whose names are like a pattern for glob, in
 * the order of their names. globfree it. Returns 0, also where there are none, or -1 where there is
 * no memory. */
int files_like(const char *folder, const char *pattern, glob_t *found);

/* The whole of a file, which open_regular takes, up to a zero byte, for free; NULL, with errno,
 * where it cannot be had. */
char *file_text(const char *path);

/* The JSON in a file. New reference, or NULL with what is wrong. */
json_t *json_of_file(const char *path, json_error_t *error);

#endif
