/* What several test files need: stepping by hand, runs in this process, the program as a user
 * starts it, and temporary folders. */
#ifndef WISPLAB_TESTS_SUPPORT_H
#define WISPLAB_TESTS_SUPPORT_H

#include "base/files.h"
#include "run/simulation.h"

#include <sys/types.h>

/* A name for each stepper with each option that makes it another method: the registry's steppers
 * with every choice of their options of kind OPTION_CHOICE, one at a time, and those in which
 * tests are interested. Calls `use` for each. */
struct variant {
    const struct stepper_method *method;
    const char *option; /* "key=value", or NULL */
    char name[96];
};
void each_variant(void (*use)(const struct variant *variant, void *ctx), void *ctx);

/* Settings for a variant on some system, with defaults, the direct solver and these tolerances;
 * they point into the variant. */
struct stepper_settings variant_settings(const struct variant *variant, double rtol, double atol);

/* From `from` to `to` in `steps` equal steps, or, of adaptive methods, in as many as it takes.
 * Returns the code of the step that failed, or 0. */
int integrate(struct stepper *stepper, double from, double to, int steps, double *q, double *v);

/* --- runs in this process --- */

/* Whether there can be such a run. That a problem is not for a method is no failure of a test: then
 * the method says so by its name. Stops the test where anything else is wrong. */
int is_taken(const struct scene *scene, const struct run_request *request);

/* The circle with this duration, every step a frame (frame_rate 0) or not. scene_free it. */
struct scene *circle_scene(double duration, double frame_rate);

/* Where a run on the circle ended. */
struct orbit {
    struct run_result result;
    double t, x, y, vx, vy;  /* of the last frame */
    double error, max_error; /* distance from the exact position: at the end, in all frames; m */
};

/* Runs; stops the test where the request is refused. */
void run_circle(const struct scene *scene, const struct run_request *request, struct orbit *orbit);

/* --- the program as a user starts it --- */

struct finished {
    int code; /* exit code; -signal where one ended it */
    char out[65536], err[65536];
};

/* The program of this build, and in the tests of README's walk the one with README's stepper. */
extern const char *const program_path;

/* How it is started: all zero is as usual. */
struct launch {
    const char *program; /* NULL: program_path */
    const char *folder;  /* to start in; NULL: this one */
    long file_limit;     /* bytes that a file may have; 0: no limit */
    int to_dev_full;     /* standard output is a full disk */
};

struct process {
    pid_t pid;
    int out, err;
};

struct process program_start(const struct launch *launch, const char *const *arguments);
void program_wait(const struct process *process, struct finished *finished);

/* Starts and waits; arguments end with NULL. */
#define PROGRAM(finished, launch, ...)                                       \
    do {                                                                     \
        const struct process process_ =                                      \
            program_start(launch, (const char *const[]){__VA_ARGS__, NULL}); \
        program_wait(&process_, finished);                                   \
    } while (0)

/* A gnuplot that does this, in the shell, or exits with 0 and draws nothing: for tests whose
 * subject is not the figures, since drawing takes longer than all the runs. */
void gnuplot_stub(const char *action);
void gnuplot_stub_quiet(void);
void gnuplot_stub_remove(void);

/* Number of lines in a text, the last of which need not end. */
int count_lines(const char *text);

/* --- temporary folders --- */

/* A new folder in $TMPDIR or /tmp, to be removed with all that is in it. */
void folder_make(char *path);
void folder_remove(const char *path);

/* Leaves the test, which needs something that is not on this machine: says what was not tried,
 * where ctest reads it (discover.cmake). */
_Noreturn void skip_test(const char *what);

/* Writes a text file into a folder; its path is put into `path`, which may be NULL. */
void file_write(const char *folder, const char *name, const char *text, char *path);

/* The whole of a file, for free, or NULL where it is not there. */
char *file_read(const char *path);

/* Calls `use` for every file below a folder. */
void each_file(const char *folder, void (*use)(const char *path, void *ctx), void *ctx);

/* How many files below a folder have a name that contains `part`. */
int count_files(const char *folder, const char *part);

/* --- what experiments found --- */

/* Reads folder/name.tsv; stops the test where it cannot be read. text_table_free it. */
struct text_table;
void table_must_be_read(struct text_table *table, const char *folder, const char *name);

/* Stops the test where a table does not say of every column what it is: before the line of their
 * names there must be as many lines "# name, unit: meaning", in their order. */
void columns_must_be_described(const char *path);

/* Checks an experiment's folder: its statements have one of the four verdicts, no empty cell, a key
 * of their own, a sentence that ends; every figure there has one; every table says what its
 * columns are, and every gap in one has a reason. */
void statements_must_be_whole(const char *folder);

/* How often a text has a part. */
int count_of(const char *text, const char *part);

/* --- tables --- */

struct text_table;

/* The first row that has the texts in its first columns (NULL: any), or -1. */
int text_table_find(const struct text_table *table, const char *first, const char *second);

#endif
