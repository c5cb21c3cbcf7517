#include "support.h"

#include "experiments/registry.h"
#include "fixture.h"
#include "model/circle.h"
#include "scene/scene_load.h"

#include <criterion/criterion.h>
#include <fcntl.h>
#include <ftw.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* --- what a test owns --- */

struct owned {
    void *what;
    void (*give_back)(void *what);
    struct owned *before;
};
static struct owned *last_owned;
static pid_t owner; /* a process that the test starts gives nothing back */

const void *test_mark(void) {
    return last_owned;
}

void test_gives_back(const void *mark) {
    while (last_owned && last_owned != mark) {
        struct owned *owned = last_owned;
        last_owned = owned->before;
        owned->give_back(owned->what);
        free(owned);
    }
}

static void give_all_back(void) {
    if (getpid() == owner)
        test_gives_back(NULL);
}

void test_owns(void *what, void (*give_back)(void *what)) {
    struct owned *owned = malloc(sizeof *owned);
    cr_assert(owned, "no memory");
    *owned = (struct owned){what, give_back, last_owned};
    if (!owner) {
        owner = getpid();
        atexit(give_all_back);
    }
    last_owned = owned;
}

static char *vprinted(const char *format, va_list arguments) {
    char *text;
    cr_assert(vasprintf(&text, format, arguments) >= 0, "no memory");
    test_owns(text, free);
    return text;
}

char *printed(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    char *text = vprinted(format, arguments);
    va_end(arguments);
    return text;
}

void *test_room(size_t bytes) {
    void *room = calloc(bytes > 0 ? bytes : 1, 1);
    cr_assert(room, "no memory");
    test_owns(room, free);
    return room;
}

/* --- variants --- */

/* Whether the fixtures are for it: they have neither an spd Jacobian nor forces of parts. */
static int fits_fixtures(const struct variant *variant) {
    static struct fixture fixture;
    const struct stepper_settings settings = variant_settings(variant, 1e-6, 1e-9);
    fixture_chain(&fixture, 3, 1, 1);
    return stepper_refuse(variant->method, &settings, &fixture.system) == 0;
}

static void use_variant(const struct stepper_method *method, const char *option,
                        void (*use)(const struct variant *variant, void *ctx), void *ctx) {
    struct variant variant = {.method = method, .option = option};
    snprintf(variant.name, sizeof variant.name, "%s%s%s", method->name, option ? " " : "",
             option ? option : "");
    if (!option || fits_fixtures(&variant))
        use(&variant, ctx);
}

int is_tried_elsewhere(const struct stepper_method *method) {
    cr_assert(!program_method || stepper_find(program_method), "no %s to try", program_method);
    return program_method && strcmp(method->name, program_method) != 0;
}

void each_variant(void (*use)(const struct variant *variant, void *ctx), void *ctx) {
    for (int i = 0; stepper_methods[i]; i++) {
        const struct stepper_method *method = stepper_methods[i];
        use_variant(method, NULL, use, ctx);
        for (const struct option_spec *spec = method->options; spec && spec->name; spec++) {
            char option[80];
            for (int c = 0; spec->kind == OPTION_CHOICE && spec->choices[c]; c++) {
                if (c == (int)spec->initial)
                    continue;
                snprintf(option, sizeof option, "%s=%s", spec->name, spec->choices[c]);
                use_variant(method, option, use, ctx);
            }
            if (strcmp(spec->name, "newton.iterations") == 0)
                use_variant(method, "newton.iterations=20", use, ctx);
        }
    }
}

struct stepper_settings variant_settings(const struct variant *variant, double rtol, double atol) {
    const int solves = (variant->method->capabilities & STEPPER_SOLVES) != 0;
    return (struct stepper_settings){.linear = solves ? linear_find("direct") : NULL,
                                     .rtol = rtol,
                                     .atol = atol,
                                     .options = {&variant->option, variant->option != NULL}};
}

int integrate(struct stepper *stepper, double from, double to, int steps, double *q, double *v) {
    const struct stepper_method *method = stepper->method;
    double t[LANES_MOST];
    int code = 0;
    for (int k = 0; k < LANES_MOST; k++)
        t[k] = from;
    if (method->advance)
        while (t[0] < to && !code)
            code = method->advance(stepper, t, to, q, v);
    else
        for (int k = 0; k < steps && !code; k++)
            code = method->step(stepper, from + (to - from) * k / steps, (to - from) / steps, q, v);
    return code;
}

/* --- runs in this process --- */

static void give_scene_back(void *scene) {
    scene_free(scene);
}

struct scene *test_owns_scene(struct scene *scene) {
    test_owns(scene, give_scene_back);
    return scene;
}

struct scene *lab_load(const char *name, const char *const *sets, int set_count) {
    char reason[REASON_SIZE];
    struct scene *scene = scene_load(name, sets, set_count, reason);
    cr_assert(scene, "%s", reason);
    return test_owns_scene(scene);
}

void lab_refuse(const char *name, const char *const *sets, int set_count, const char *const *says,
                int most) {
    char reason[REASON_SIZE] = "";
    cr_assert_null(scene_load(name, sets, set_count, reason), "%s is taken: %s", name,
                   set_count > 0 ? sets[set_count - 1] : "as it is");
    cr_assert(!strchr(reason, '\n'), "'%s'", reason);
    must_contain(reason, says, most);
}

struct scene *circle_scene(double duration, double frame_rate) {
    char sets[2][64];
    const char *const given[] = {sets[0], sets[1]};
    snprintf(sets[0], sizeof sets[0], "duration=%.17e", duration);
    snprintf(sets[1], sizeof sets[1], "frame_rate=%.17e", frame_rate);
    return lab_load("circle", given, frame_rate > 0 ? 2 : 1);
}

struct settings settings_of(const struct scene *scene, const struct run_request *request) {
    struct settings settings;
    char reason[REASON_SIZE];
    cr_assert_eq(settings_resolve(scene, request, &settings, reason), 0, "refused: %s", reason);
    return settings;
}

struct run_result run_finished(const struct scene *scene, const struct run_request *request,
                               int (*see)(void *ctx, const struct model *model, double t,
                                          const double *rows),
                               void *ctx) {
    const struct settings settings = settings_of(scene, request);
    struct run_result result;
    simulate(scene, &settings, see ? &(struct observer){see, ctx} : NULL, NULL, &result);
    cr_assert_eq(result.outcome, FINISHED, "%s, %s: %s", scene->name, settings.method->name,
                 result.reason);
    return result;
}

static int keep_last(void *ctx, const struct model *model, double t, const double *rows) {
    (void)model;
    struct orbit *orbit = ctx;
    double exact[2];
    circle_exact(t, exact);
    orbit->t = t;
    orbit->x = rows[2];
    orbit->y = rows[3];
    orbit->vx = rows[5];
    orbit->vy = rows[6];
    orbit->error = hypot(rows[2] - exact[0], rows[3] - exact[1]);
    orbit->max_error = fmax(orbit->max_error, orbit->error);
    return 0;
}

int is_taken(const struct scene *scene, const struct run_request *request) {
    struct settings settings;
    char reason[REASON_SIZE];
    if (settings_resolve(scene, request, &settings, reason) == 0)
        return 1;
    const struct stepper_method *method = stepper_find(request->stepper);
    cr_assert(method && strncmp(reason, method->name, strlen(method->name)) == 0 &&
                  (method->refuse || !(method->capabilities & STEPPER_PROJECTS)),
              "refused: %s", reason);
    return 0;
}

void run_circle(const struct scene *scene, const struct run_request *request, struct orbit *orbit) {
    const struct settings settings = settings_of(scene, request);
    *orbit = (struct orbit){.max_error = 0};
    simulate(scene, &settings, &(struct observer){keep_last, orbit}, NULL, &orbit->result);
}

/* --- the program --- */

/* Tests are as if on a host of their own: whose runs are timed, and alone there, need not wait for
 * those of others on this machine, nor others for its. */
__attribute__((constructor)) static void name_host(void) {
    char name[40];
    snprintf(name, sizeof name, "tests-%ld", (long)getpid());
    setenv("WISPLAB_HOST", name, 0);
}

struct process program_start(const struct launch *launch, const char *const *arguments) {
    const char *argv[32] = {launch && launch->program ? launch->program : program_path};
    for (int i = 0; arguments[i]; i++)
        argv[i + 1] = arguments[i];
    struct process process = {.out = memfd_create("out", MFD_CLOEXEC),
                              .err = memfd_create("err", MFD_CLOEXEC)};
    cr_assert(process.out >= 0 && process.err >= 0, "no memory for the output");
    process.pid = fork();
    if (process.pid == 0) {
        int out = process.out;
        prctl(PR_SET_PDEATHSIG, SIGKILL); /* a test that fails leaves nothing that goes on */
        if (launch && launch->folder && chdir(launch->folder))
            _exit(99);
        if (launch && launch->to_dev_full)
            out = open("/dev/full", O_WRONLY);
        dup2(open("/dev/null", O_RDONLY), 0);
        dup2(out, 1);
        dup2(process.err, 2);
        if (launch && launch->file_limit) {
            const rlim_t limit = (rlim_t)launch->file_limit;
            setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, limit});
        }
        execv(argv[0], (char *const *)argv);
        _exit(99);
    }
    cr_assert(process.pid > 0, "no process");
    return process;
}

static char *read_all(int file) {
    struct stat status;
    cr_assert_eq(fstat(file, &status), 0);
    char *text = calloc((size_t)status.st_size + 1, 1);
    cr_assert(text && pread(file, text, (size_t)status.st_size, 0) == status.st_size,
              "the output is lost");
    test_owns(text, free);
    close(file);
    return text;
}

struct finished *program_wait(const struct process *process) {
    struct finished *finished = malloc(sizeof *finished);
    int status;
    cr_assert(finished, "no memory for the output");
    test_owns(finished, free);
    cr_assert(waitpid(process->pid, &status, 0) == process->pid, "lost the program");
    finished->code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    finished->out = read_all(process->out);
    finished->err = read_all(process->err);
    return finished;
}

struct finished *program_done(const struct launch *launch, const char *const *arguments) {
    const struct process process = program_start(launch, arguments);
    return program_wait(&process);
}

void must_have_failed(const struct finished *finished, int code, const char *says) {
    cr_assert_eq(finished->code, code, "exit code %d: %s", finished->code, finished->err);
    cr_assert(count_lines(finished->err) == 1 && (strncmp(finished->err, "wisplab: ", 9) == 0 ||
                                                  strncmp(finished->err, "bench: ", 7) == 0),
              "not one line on standard error:\n%s", finished->err);
    cr_assert(strstr(finished->err, says), "does not say '%s' but %s", says, finished->err);
}

struct finished *program_must(const struct launch *launch, int code, const char *says,
                              const char *const *arguments) {
    struct finished *f = program_done(launch, arguments);
    char what[PATH_SIZE] = "wisplab";
    for (size_t i = 0, used = strlen(what); arguments[i] && used < sizeof what; i++)
        used += (size_t)snprintf(what + used, sizeof what - used, " %s", arguments[i]);
    cr_assert_eq(f->code, code, "%s: exit code %d: %s%s", what, f->code, f->out, f->err);
    if (code != 0)
        must_have_failed(f, code, says);
    return f;
}

struct finished *shell(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const char *const command = vprinted(format, arguments);
    va_end(arguments);
    return PROGRAM(&(struct launch){.program = "/bin/sh"}, "-c", printed("exec 2>&1\n%s", command));
}

int new_runs(const struct finished *finished, int *runs) {
    int all, new;
    for (const char *at = finished->out; (at = strstr(at, ": ")) != NULL; at++)
        if (sscanf(at, ": %d runs, %d of them new", &all, &new) == 2) {
            if (runs)
                *runs = all;
            return new;
        }
    cr_assert_fail("exit code %d, no count of runs in '%s', '%s'", finished->code, finished->out,
                   finished->err);
    return -1;
}

void wait_for(double seconds) {
    nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * seconds)}, NULL);
}

static const char *real_path; /* PATH where a stub is in front of it */

void gnuplot_unstub(void) {
    if (real_path)
        setenv("PATH", real_path, 1);
    real_path = NULL;
}

void gnuplot_stub(const char *action) {
    gnuplot_unstub();
    const char *const folder = folder_make(), *const path = getenv("PATH");
    const char *const stub = file_write(folder, "gnuplot", printed("#!/bin/sh\n%s\n", action));
    cr_assert(chmod(stub, 0755) == 0 && path, "no %s", stub);
    real_path = printed("%s", path);
    setenv("PATH", printed("%s:%s", folder, path), 1);
}

void gnuplot_stub_quiet(void) {
    /* the variables are given as a shell has them too */
    gnuplot_stub("eval \"$3\"; echo . >\"$out/quiet.$format\"");
}

void must_contain(const char *text, const char *const *parts, int most) {
    for (int i = 0; i < most && parts[i]; i++)
        cr_assert(strstr(text, parts[i]), "does not say '%s' but '%s'", parts[i], text);
}

int count_lines(const char *text) {
    int lines = 0;
    for (const char *p = text; *p; p++)
        lines += *p == '\n' || p[1] == '\0';
    return lines;
}

/* --- folders --- */

static int remove_one(const char *path, const struct stat *status, int type, struct FTW *ftw) {
    (void)status, (void)type, (void)ftw;
    return remove(path);
}

_Noreturn void skip_test(const char *what) {
    fprintf(stderr, "not tried here: %s\n", what);
    fflush(NULL);
    cr_skip_test("%s", what);
    abort();
}

void folder_remove(const char *path) {
    nftw(path, remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

static void give_folder_back(void *path) {
    folder_remove(path);
    free(path);
}

char *folder_make(void) {
    const char *parent = getenv("TMPDIR");
    char *path = malloc(PATH_SIZE);
    cr_assert(path, "no memory");
    path_format(path, "%s/wisplab-test-XXXXXX", parent && *parent ? parent : "/tmp");
    cr_assert(mkdtemp(path), "no temporary folder");
    test_owns(path, give_folder_back);
    return path;
}

const char *file_write(const char *folder, const char *name, const char *text) {
    const char *const path = printed("%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    cr_assert(file, "%s cannot be written", path);
    fputs(text, file);
    fclose(file);
    return path;
}

char *file_read(const char *path) {
    FILE *file = fopen(path, "r");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    const long size = ftell(file);
    rewind(file);
    char *text = malloc((size_t)size + 1);
    cr_assert(text, "no memory");
    test_owns(text, free);
    text[fread(text, 1, (size_t)size, file)] = '\0';
    fclose(file);
    return text;
}

char *file_of(const char *folder, const char *name) {
    char *text = file_read(printed("%s/%s", folder, name));
    cr_assert(text, "there is no %s/%s", folder, name);
    return text;
}

static struct {
    void (*use)(const char *path, void *ctx);
    void *ctx;
} walk;

static int walk_one(const char *path, const struct stat *status, int type, struct FTW *ftw) {
    (void)status, (void)ftw;
    if (type == FTW_F)
        walk.use(path, walk.ctx);
    return 0;
}

void each_file(const char *folder, void (*use)(const char *path, void *ctx), void *ctx) {
    walk.use = use;
    walk.ctx = ctx;
    nftw(folder, walk_one, 8, FTW_PHYS);
}

struct matches {
    const char *part;
    int count;
};

static void match(const char *path, void *ctx) {
    struct matches *matches = ctx;
    const char *slash = strrchr(path, '/');
    matches->count += strstr(slash ? slash + 1 : path, matches->part) != NULL;
}

int count_files(const char *folder, const char *part) {
    struct matches matches = {.part = part};
    each_file(folder, match, &matches);
    return matches.count;
}

/* --- what experiments found --- */

static void row_must_be_whole(const struct text_table *rows, int row) {
    static const char *const verdicts[] = {"holds", "does not hold", "tells nothing", "not reached",
                                           "not asked"};
    const char *key = text_table_cell(rows, row, "key"),
               *verdict = text_table_cell(rows, row, "verdict"),
               *sentence = text_table_cell(rows, row, "statement"),
               *by = text_table_cell(rows, row, "by");
    int known = 0;
    for (size_t i = 0; i < sizeof verdicts / sizeof *verdicts; i++)
        known |= strcmp(verdicts[i], verdict) == 0;
    cr_assert(known, "%s: a verdict '%s'", key, verdict);
    cr_assert_eq(text_table_find(rows, key, NULL), row, "two rows are called %s", key);
    for (int i = 0; i < rows->column_count; i++)
        cr_assert(!text_cell_is_empty(rows->cell[row * rows->column_count + i]),
                  "%s: nothing in column %s", key, rows->name[i]);
    cr_assert(strlen(sentence) > 10 && sentence[strlen(sentence) - 1] == '.', "%s: '%s'", key,
              sentence);
    cr_assert(!strstr(sentence, "nan") && !strstr(sentence, "inf "), "%s: '%s'", key, sentence);
    cr_assert(strcmp(by, "ours") == 0 || strcmp(by, "thesis") == 0, "%s: by '%s'", key, by);
    cr_assert_eq(strcmp(text_table_cell(rows, row, "value"), "-") == 0,
                 strcmp(text_table_cell(rows, row, "unit"), "-") == 0, "%s: a unit alone", key);
}

/* An experiment says which questions of the report its rows may answer. */
static void question_must_be_known(const struct text_table *rows, int row, const char *name) {
    const struct experiment *experiment = experiment_find(name);
    const char *question = text_table_cell(rows, row, "question");
    int known = strcmp(question, "-") == 0 || !experiment;
    for (int q = ANSWERS_NONE + 1; q < QUESTION_COUNT; q++)
        known |= experiment && experiment->answers & 1u << q &&
                 strcmp(question, question_word((enum question)q)) == 0;
    cr_assert(known, "%s: question %s is not one that %s answers",
              text_table_cell(rows, row, "key"), question, name);
}

/* "results/circle/radius.svg" -> "radius" must be the figure of a row. */
static void figure_must_have_row(const char *path, const struct text_table *rows) {
    const char *name = strrchr(path, '/') + 1;
    const size_t length = strlen(name) - 4;
    int found = strncmp(name, "quiet.", 6) == 0; /* the stub's */
    for (int row = 0; row < rows->row_count; row++) {
        const char *figure = text_table_cell(rows, row, "figure");
        found |= strlen(figure) == length && strncmp(figure, name, length) == 0;
    }
    cr_assert(found, "no statement is of figure %s", path);
}

static void give_table_back(void *table) {
    text_table_free(table);
    free(table);
}

static void test_owns_table(const struct text_table *table) {
    struct text_table *own = malloc(sizeof *own);
    cr_assert(own, "no memory");
    *own = *table;
    test_owns(own, give_table_back);
}

void table_must_be_read(struct text_table *table, const char *folder, const char *name) {
    char reason[REASON_SIZE];
    cr_assert_eq(text_table_read(table, printed("%s/%s.tsv", folder, name), reason), 0, "%s",
                 reason);
    test_owns_table(table);
}

void statements_must_be_read(struct text_table *rows, const char *folder) {
    char reason[REASON_SIZE];
    cr_assert_eq(statements_read(rows, folder, reason), 0, "%s", reason);
    test_owns_table(rows);
}

int the_row(const struct text_table *table, const char *name) {
    const int row = text_table_find(table, name, NULL);
    cr_assert(row >= 0, "no row %s", name);
    return row;
}

void must_state(const struct text_table *rows, const char *key, const char *verdict,
                const char *sentence) {
    const int row = the_row(rows, key);
    const char *stated = text_table_cell(rows, row, "statement");
    cr_assert_str_eq(text_table_cell(rows, row, "verdict"), verdict, "%s: not %s: %s", key, verdict,
                     stated);
    cr_assert(!sentence || strcmp(stated, sentence) == 0, "%s: '%s' is not '%s'", key, stated,
              sentence);
}

/* Cuts the first line off a text. */
static char *cut_line(char **text) {
    char *line = *text, *end = line ? strchr(line, '\n') : NULL;
    if (end)
        *end = '\0';
    *text = end ? end + 1 : NULL;
    return line;
}

/* Whether a line is "# name, unit: meaning", with something in each. */
static int describes(const char *line, const char *name) {
    const size_t length = strlen(name);
    if (strncmp(line, "# ", 2) != 0 || strncmp(line + 2, name, length) != 0 ||
        strncmp(line + 2 + length, ", ", 2) != 0)
        return 0;
    const char *unit = line + 2 + length + 2, *colon = strstr(unit, ": ");
    return colon && colon > unit && strlen(colon) > 3;
}

void columns_must_be_described(const char *path) {
    enum { COLUMNS_MOST = 200 };
    char *text = file_read(path), *left = text, *before[COLUMNS_MOST], *line;
    int count = 0;
    cr_assert(text, "%s: cannot be read", path);
    while ((line = cut_line(&left)) != NULL && line[0] == '#' && count < COLUMNS_MOST)
        before[count++] = line;
    cr_assert(line && line[0] != '#', "%s: no column names", path);
    int columns = 1;
    for (const char *at = line; (at = strchr(at, '\t')) != NULL; at++)
        columns++;
    cr_assert_geq(count, columns, "%s: %d lines before %d columns", path, count, columns);
    for (char **said = before + count - columns, *name; (name = strsep(&line, "\t")) != NULL;
         said++)
        cr_assert(describes(*said, name), "%s: nothing says what column %s is, but '%s'", path,
                  name, *said);
}

/* Columns and gaps, the latter as the report demands of every table. */
static void tables_must_be_whole(const char *folder) {
    glob_t found;
    char reason[REASON_SIZE];
    cr_assert_eq(files_like(folder, "*.tsv", &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        struct text_table table;
        const char *name = strrchr(found.gl_pathv[i], '/') + 1;
        columns_must_be_described(found.gl_pathv[i]);
        if (strcmp(name, "samples.tsv") == 0)
            continue; /* of measurements: rows of any length */
        cr_assert_eq(text_table_read(&table, found.gl_pathv[i], reason), 0, "%s", reason);
        cr_assert_eq(text_table_check(&table, found.gl_pathv[i], reason), 0, "%s", reason);
        text_table_free(&table);
    }
    globfree(&found);
}

void statements_must_be_whole(const char *folder) {
    static const char *const kinds[] = {"*.svg", "*.png"};
    struct text_table rows;
    statements_must_be_read(&rows, folder);
    cr_assert_gt(rows.row_count, 0, "%s: nothing is stated", folder);
    for (int row = 0; row < rows.row_count; row++) {
        row_must_be_whole(&rows, row);
        question_must_be_known(&rows, row, strrchr(folder, '/') + 1);
    }
    for (int k = 0; k < 2; k++) {
        glob_t found;
        cr_assert_eq(files_like(folder, kinds[k], &found), 0);
        for (size_t i = 0; i < found.gl_pathc; i++)
            figure_must_have_row(found.gl_pathv[i], &rows);
        globfree(&found);
    }
    tables_must_be_whole(folder);
}

int count_of(const char *text, const char *part) {
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at += strlen(part))
        count++;
    return count;
}

/* --- tables --- */

int text_table_find(const struct text_table *table, const char *first, const char *second) {
    for (int i = 0; i < table->row_count; i++) {
        char **row = table->cell + i * table->column_count;
        if ((!first || strcmp(row[0], first) == 0) &&
            (!second || (table->column_count > 1 && strcmp(row[1], second) == 0)))
            return i;
    }
    return -1;
}
