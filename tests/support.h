/* What several test files need: stepping by hand, scenes and runs in this process, the program as a
 * user starts it, and temporary folders.
 *
 * A test owns what it takes: scenes, folders, texts, tables, frames and what the program printed
 * are given back when it ends, also where it fails. */
#ifndef WISPLAB_TESTS_SUPPORT_H
#define WISPLAB_TESTS_SUPPORT_H

#include "base/files.h"
#include "run/simulation.h"

#include <sys/types.h>

/* Whether a sanitizer stands in for the C library's allocator, and catches signals. */
#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define SANITIZED
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
#define SANITIZED
#endif

/* Calls give_back(what) when this test ends, the last first. */
void test_owns(void *what, void (*give_back)(void *what));
struct scene *test_owns_scene(struct scene *scene);

/* What a test has by now, and an earlier end for what it has taken since: for what is done so often
 * that all of it would fill the memory. */
const void *test_mark(void);
void test_gives_back(const void *mark);

/* Memory of so many bytes, all 0. */
void *test_room(size_t bytes);

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

/* The settings of a run, which point into the request; stops the test where it is refused. */
struct settings settings_of(const struct scene *scene, const struct run_request *request);

/* A shipped scene, or a file, with overrides; stops the test where it cannot be read. */
struct scene *lab_load(const char *name, const char *const *sets, int set_count);
#define LAB_LOAD(name, ...)                                      \
    lab_load(name, (const char *const[]){NULL, __VA_ARGS__} + 1, \
             (int)(sizeof((const char *const[]){NULL, __VA_ARGS__}) / sizeof(char *)) - 1)

/* Stops the test where such a scene can be read, or where what is said of it is not one line with
 * all these parts, up to `most` or to NULL. */
void lab_refuse(const char *name, const char *const *sets, int set_count, const char *const *says,
                int most);

/* The same with one override and all the parts that follow. */
#define LAB_REFUSE(name, set, ...) \
    lab_refuse(name, (const char *const[]){set}, 1, WORDS(__VA_ARGS__), 9)

/* The circle with this duration, every step a frame (frame_rate 0) or not. */
struct scene *circle_scene(double duration, double frame_rate);

/* Runs, shows every frame to `see` (may be NULL); stops the test unless the run finishes. */
struct run_result run_finished(const struct scene *scene, const struct run_request *request,
                               int (*see)(void *ctx, const struct model *model, double t,
                                          const double *rows),
                               void *ctx);

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
    char *out, *err;
};

/* The program of this build, and in the tests of README's walk the one with README's stepper. */
extern const char *const program_path;

/* The stepper that is README's there; else NULL. */
extern const char *const program_method;

/* Whether a loop over all methods that takes long leaves this one to the tests of the program
 * without README's stepper. */
int is_tried_elsewhere(const struct stepper_method *method);

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
struct finished *program_wait(const struct process *process);

/* Stops the test unless the program ended so: with another code than 0, one line on standard error
 * that is the program's and contains `says`. */
void must_have_failed(const struct finished *finished, int code, const char *says);

/* Starts and waits; arguments end with NULL. Where a test says what comes of it, it stops where
 * something else does: exit code 0, or a failure as above. */
struct finished *program_done(const struct launch *launch, const char *const *arguments);
struct finished *program_must(const struct launch *launch, int code, const char *says,
                              const char *const *arguments);
#define WORDS(...)             ((const char *const[]){__VA_ARGS__, NULL})
#define PROGRAM(launch, ...)   program_done(launch, WORDS(__VA_ARGS__))
#define WORKS(...)             program_must(NULL, 0, NULL, WORDS(__VA_ARGS__))
#define FAILS(code, says, ...) program_must(NULL, code, says, WORDS(__VA_ARGS__))

/* A command (printf) of the shell: `out` has what it says on either stream. */
struct finished *shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
#define SHELL(...)                                                       \
    do {                                                                 \
        const struct finished *said_ = shell(__VA_ARGS__);               \
        cr_assert_eq(said_->code, 0, "%d: %s", said_->code, said_->out); \
    } while (0)

/* "circle: 62 runs, 40 of them new": how many runs an experiment or a sweep has, of which new ones;
 * `runs` may be NULL. */
int new_runs(const struct finished *finished, int *runs);

void wait_for(double seconds);

/* A gnuplot that does this, in the shell, or exits with 0 and draws nothing: for tests whose
 * subject is not the figures, since drawing takes longer than all the runs. */
void gnuplot_stub(const char *action);
void gnuplot_stub_quiet(void);

/* The real one again. */
void gnuplot_unstub(void);

/* Stops the test unless a text has all these parts, up to `most` or to NULL. */
void must_contain(const char *text, const char *const *parts, int most);

/* Number of lines in a text, the last of which need not end. */
int count_lines(const char *text);

/* --- temporary folders --- */

/* A new folder in $TMPDIR or /tmp. */
char *folder_make(void);

/* Removes a folder with all that is in it before the test ends. */
void folder_remove(const char *path);

/* Leaves the test, which needs something that is not on this machine: says what was not tried,
 * where ctest reads it (discover.cmake). */
_Noreturn void skip_test(const char *what);

/* A text, a path above all (printf). */
char *printed(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Writes a text file into a folder; returns its path. */
const char *file_write(const char *folder, const char *name, const char *text);

/* The whole of a file, or NULL where it is not there. */
char *file_read(const char *path);

/* The same of a file in a folder, which must be there. */
char *file_of(const char *folder, const char *name);

/* Calls `use` for every file below a folder. */
void each_file(const char *folder, void (*use)(const char *path, void *ctx), void *ctx);

/* How many files below a folder have a name that contains `part`. */
int count_files(const char *folder, const char *part);

/* --- what experiments found --- */

/* Reads folder/name.tsv; stops the test where it cannot be read. */
struct text_table;
void table_must_be_read(struct text_table *table, const char *folder, const char *name);

/* The same of the statements in a folder, none of which may have an empty cell. */
void statements_must_be_read(struct text_table *rows, const char *folder);

/* The row that begins with a name, which must be there. */
int the_row(const struct text_table *table, const char *name);

/* Stops the test unless a statement has this verdict and this sentence (NULL: any). */
void must_state(const struct text_table *rows, const char *key, const char *verdict,
                const char *sentence);

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
