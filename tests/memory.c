/* Memory that cannot be had: what is made says so, and leaves nothing behind.
 *
 * malloc and its kin are replaced in the whole test program, libraries included, and do what
 * glibc's do except for one call that is told to fail. Under sanitizers, which replace them too,
 * this file has no tests. */
#include "base/memory.h"

#include "base/text_table.h"
#include "fixture.h"
#include "model/clock.h"
#include "picture/picture.h"
#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <gsl/gsl_errno.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#ifndef SANITIZED

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *memory);

static long counted, failing, fail_after; /* calls; whether calls are counted; which fails, or 0 */
static long held;                         /* blocks got and not given back while counting */

static int refuse(void) {
    if (!failing)
        return 0;
    counted++;
    return fail_after > 0 && counted >= fail_after;
}

void *malloc(size_t size) {
    if (refuse())
        return NULL;
    held += failing;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    if (refuse())
        return NULL;
    held += failing;
    return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size) {
    if (refuse())
        return NULL;
    held += failing && !old;
    return __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    if (refuse())
        return NULL;
    held += failing;
    return __libc_memalign(alignment, size);
}

void free(void *memory) {
    held -= failing && memory;
    __libc_free(memory);
}

/* --- trials, each in a process of its own: a library that does not survive is found by name --- */

enum { MADE, NOT_MADE, LEAKED };

/* Runs `make` with the k-th and all later allocations failing; it returns MADE or NOT_MADE. A make
 * that frees all must leave as many blocks as before. */
static int in_child(int (*make)(const void *what), const void *what, long k) {
    const pid_t pid = fork();
    if (pid == 0) {
        if (!freopen("/dev/null", "w", stderr)) /* where SUNDIALS complains */
            _exit(76);
        counted = held = 0;
        fail_after = k;
        const int made = make(what);
        failing = 0;
        _exit(held > 0 ? LEAKED : made);
    }
    int status;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/* These use libraries that do not survive some of their own failed allocations: N_VClone of
 * SUNDIALS 6.4 and gsl_odeiv2_control_standard_new of GSL 2.7 write to what malloc gave without
 * looking. A death is allowed to them; to leak, or to give a wrong code, is not. */
static int may_die(const char *name) {
    static const char *const names[] = {"cvode", "arkode", "cg", "reference"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strncmp(name, names[i], strlen(names[i])) == 0)
            return 1;
    return 0;
}

/* ARKStepCreate of SUNDIALS 6.4 forgets the memory that it has where it cannot have the rest. */
static int may_leak(const char *name) {
    return strncmp(name, "arkode", strlen("arkode")) == 0;
}

/* Lets each allocation fail in turn until none is left to fail. */
static void try_all(const char *name, int (*make)(const void *what), const void *what) {
    long k = 1, refused = 0;
    int result = NOT_MADE;
    for (; k < 2000 && result != MADE; k++) {
        result = in_child(make, what, k);
        refused += result == NOT_MADE;
        cr_assert(result >= 0 || may_die(name),
                  "%s: dies of signal %d when allocation %ld and later ones fail", name, -result,
                  k);
        cr_assert(result <= LEAKED, "%s: wrong code (%d) when allocation %ld and later ones fail",
                  name, result, k);
        cr_assert(result != LEAKED || may_leak(name),
                  "%s: leaks when allocation %ld and later ones fail", name, k);
    }
    cr_assert_eq(result, MADE, "%s: is never made", name);
    cr_assert(refused > 0, "%s: allocates nothing, so nothing was tested", name);
}

static int make_stepper(const void *what) {
    static struct fixture fixture;
    const struct variant *variant = what;
    const struct stepper_settings settings = variant_settings(variant, 1e-6, 1e-9);
    fixture_chain(&fixture, 3, 1, 1);
    failing = 1;
    struct stepper *stepper = stepper_create(variant->method, &settings, &fixture.system);
    if (stepper)
        variant->method->free(stepper);
    failing = 0;
    return stepper ? MADE : NOT_MADE;
}

static void check_stepper(const struct variant *variant, void *ctx) {
    (void)ctx;
    try_all(variant->name, make_stepper, variant);
}

Test(memory, steppers_are_made_or_not) {
    each_variant(check_stepper, NULL);
}

static int make_linear(const void *what) {
    static struct fixture fixture;
    const struct linear_method *method = what;
    const struct options defaults = {0};
    double b[5] = {1}, x[5];
    fixture_chain(&fixture, 5, 1, 1);
    failing = 1;
    struct linear_solver *solver = linear_create(method, &fixture.system, &defaults);
    int code = 0;
    if (solver) {
        code = linear_factor(solver, 1, 1);
        if (!code)
            code = linear_solve(solver, b, x);
        method->free(solver);
    }
    failing = 0;
    if (code && -code != OUT_OF_MEMORY)
        _exit(77);
    return solver && !code ? MADE : NOT_MADE;
}

/* Factorising and solving allocate too: their failure is OUT_OF_MEMORY by name. */
Test(memory, linear_solvers_are_made_or_not) {
    for (int i = 0; linear_methods[i]; i++)
        try_all(linear_methods[i]->name, make_linear, linear_methods[i]);
}

static int make_model(const void *what) {
    const struct scene *scene = what;
    failing = 1;
    struct model *model = scene->problem->create(scene, 0, 4);
    if (model)
        scene->problem->free(model);
    failing = 0;
    return model ? MADE : NOT_MADE;
}

Test(memory, models_are_made_or_not) {
    struct scene *scene = circle_scene(1, 0);
    try_all(scene->name, make_model, scene);
}

static int read_text_table(const void *path) {
    struct text_table table;
    char reason[REASON_SIZE];
    failing = 1;
    const int made = text_table_read(&table, path, reason) == 0;
    if (made)
        text_table_free(&table);
    failing = 0;
    return made ? MADE : NOT_MADE;
}

/* Long enough for more than one piece of memory. */
Test(memory, tables_are_read_or_not) {
    char text[4096] = "a\tb\n";
    for (int i = 0; i < 200; i++)
        strcat(text, "1\tnumber two\n");
    const char *const folder = folder_make();
    try_all("table", read_text_table, file_write(folder, "table.tsv", text));
}

/* A start of another treatment is converted. */
Test(memory, models_start_from_a_state_or_are_not_made) {
    const char *start = "start=state.tsv";
    const char *const folder = folder_make();
    const char *const state = printed("%s/state.tsv", folder);
    const char *const scene_path = file_write(
        folder, "two.cfg",
        "duration = 0.01; gravity = [0.0, 0.0, 0.0]; frame_rate = 100.0; material = { };\n"
        "envelope = { }; wisps = ( { root = [0.0, 0.0, 0.0]; direction = [1.0, 0.0, 0.0];\n"
        "length = 0.3; nodes = 11; grid = [2, 1]; spacing = 0.1;\n"
        "across = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]); } );\n");
    WORKS("run", scene_path, "--treatment", "penalty", "--out", folder, "--save", state);
    struct scene *scene = lab_load(scene_path, &start, 1);
    try_all(scene->name, make_model, scene);
}

/* Wisps that touch: their ticks make room where they need it, and only then. */
static int tick_twice(const void *what) {
    const struct scene *scene = what;
    int changed[8] = {0}, made = 0;
    failing = 1;
    struct model *model = scene->problem->create(scene, 0, 4);
    if (model) {
        made = scene->problem->tick(model, NULL, STOP_INTERACTION, changed) == FINISHED;
        const long before = counted;
        if (made && (scene->problem->tick(model, NULL, STOP_INTERACTION, changed) != FINISHED ||
                     counted != before))
            _exit(80);
        scene->problem->free(model);
    }
    failing = 0;
    return made ? MADE : NOT_MADE;
}

Test(memory, ticks_of_wisps_make_room_once) {
    struct scene *scene = lab_load("viscosity", NULL, 0);
    try_all(scene->name, tick_twice, scene);
}

/* A wisp that is pressed flat: its child gets a lane of its parent's part, or a part. */
struct splitting {
    const struct scene *scene;
    int lanes;
};

static int split_once(const void *what) {
    const struct splitting *splitting = what;
    const struct problem *problem = splitting->scene->problem;
    static double rows[2 * 11 * 16];
    int changed[2] = {0}, made = 0;
    failing = 1;
    struct model *model = problem->create(splitting->scene, 0, splitting->lanes);
    if (model) {
        problem->sample(model, rows);
        rows[4 * model->column_count + 10] = rows[4 * model->column_count + 14] = 1e-3; /* r1, r3 */
        problem->restore(model, rows);
        made = problem->tick(model, NULL, STOP_INTERACTION, changed) == FINISHED;
        if (made && model->row_count != 2 * 11)
            _exit(80);
        problem->free(model);
    }
    failing = 0;
    return made ? MADE : NOT_MADE;
}

static struct scene *splitting_scene(int rigid) {
    const char *const sets[] = {"subdivision={ ratio = 0.99; }", "duration=0.17", "run.step=2e-4",
                                "material.stretch=rigid"};
    struct scene *scene = lab_load("swing-envelope", sets, rigid ? 4 : 3);
    return scene;
}

Test(memory, wisps_split_or_not) {
    for (int rigid = 0; rigid < 2; rigid++) {
        struct scene *scene = splitting_scene(rigid);
        for (int lanes = 1; lanes <= LANES_MOST; lanes = lanes < 4 ? 4 : 2 * lanes)
            try_all(scene->name, split_once, &(struct splitting){scene, lanes});
    }
}

/* A run in which a wisp splits, and its child gets a stepper. */
static int run_and_split(const void *what) {
    const struct run_request *request = what;
    char reason[REASON_SIZE];
    struct settings settings;
    struct run_result result;
    struct scene *scene = splitting_scene(0);
    if (settings_resolve(scene, request, &settings, reason))
        _exit(78);
    failing = 1;
    simulate(scene, &settings, NULL, NULL, &result);
    failing = 0;
    if (result.outcome == FINISHED && result.counters.splits != 1)
        _exit(80);
    if (result.outcome != FINISHED && (result.outcome != OUT_OF_MEMORY || !result.reason[0]))
        _exit(79);
    return result.outcome == FINISHED ? MADE : NOT_MADE;
}

Test(memory, runs_with_wisps_that_split_finish_or_are_out_of_memory) {
    static const struct run_request requests[] = {
        {.stepper = "rk4", .treatment = "penalty"},
        {.stepper = "implicit-euler", .treatment = "penalty", .linear = "klu"}};
    for (int i = 0; i < 2; i++)
        try_all(requests[i].stepper, run_and_split, &requests[i]);
}

/* --- steps --- */

/* How often a hundred steps of a method ask for memory, after a hundred in which they may make room
 * for themselves. */
static long asked_for_in_steps(const struct scene *scene, const struct run_request *request) {
    double t[LANES_MOST] = {0};
    int code = 0;
    const struct settings settings = settings_of(scene, request);
    struct model *model =
        scene->problem->create(scene, settings.treatment, settings_lanes(&settings));
    struct part *part = &model->parts[0];
    struct stepper *stepper = stepper_create(settings.method, &settings.stepper, &part->system);
    cr_assert(model && stepper, "no memory");
    for (int turn = 0; turn < 2; turn++) {
        counted = 0;
        failing = turn;
        for (int k = 0; k < 100 && !code; k++)
            code = settings.method->advance
                       ? settings.method->advance(stepper, t, turn ? 1 : 0.1, part->q, part->v)
                       : settings.method->step(stepper, 1e-4 * k, 1e-4, part->q, part->v);
        failing = 0;
    }
    cr_assert_eq(code, 0, "%s: %s", settings.method->name, part->system.reason);
    settings.method->free(stepper);
    scene->problem->free(model);
    return counted;
}

/* With the matrix and the iterations that methods have; solvers and integrators of libraries may do
 * as they like. */
Test(memory, steps_ask_for_none) {
    static const char *const options[] = {NULL,      "matrix=full",         "matrix=spd",
                                          "order=3", "newton.iterations=9", "newton.reuse=5"};
    struct scene *scene = splitting_scene(0);
    int tried = 0;
    for (int m = 0; stepper_methods[m]; m++) {
        const struct stepper_method *method = stepper_methods[m];
        if (strcmp(method->name, "cvode") == 0 || strcmp(method->name, "reference") == 0)
            continue;
        for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
            if (options[i] &&
                options_find(method->options, options[i], strcspn(options[i], "=")) < 0)
                continue;
            const struct run_request request = {
                .stepper = method->name,
                .treatment = "generalised",
                .linear = method->capabilities & STEPPER_SOLVES ? "direct" : NULL,
                .options = &options[i],
                .option_count = options[i] != NULL};
            const long count = asked_for_in_steps(scene, &request);
            cr_assert_eq(count, 0, "%s %s: %ld times", method->name, options[i] ? options[i] : "",
                         count);
            tried++;
        }
    }
    cr_assert_geq(tried, 15);
}

static void leave(void) {
    _exit(NOT_MADE);
}

/* Hairs and a picture of them: it is drawn, or the process has its last word and ends. */
static int draw_picture(const void *what) {
    struct drawing drawing;
    struct picture picture = {0};
    const double upwards[3] = {0, 1, 0}, most[4] = {0, 0, 0, 0.4};
    const struct frames *frames = what;
    gsl_set_error_handler_off(); /* as main does: its generators' allocations fail by return */
    memory_last_word = leave;
    failing = 1;
    drawing_create(&drawing, frames, VIEW_HAIR | VIEW_SKELETON);
    drawing.reference = frames;
    drawing.camera = camera_make(&frames->scene->render, upwards, 64, 48);
    camera_fit(&drawing.camera, &frames->scene->render, most);
    picture_draw(&picture, &drawing, 1);
    picture_free(&picture);
    drawing_free(&drawing);
    failing = 0;
    return MADE;
}

Test(memory, pictures_are_drawn_or_not) {
    char reason[REASON_SIZE];
    struct frames frames;
    const char *const folder = folder_make();
    WORKS("run", "sphere", "--set",
          "wisps=({root=[0,0,0];direction=[0,-1,0];"
          "length=0.3;nodes=3;})",
          "--duration", "0.01", "--out", folder);
    cr_assert_eq(frames_open(&frames, printed("%s/states.tsv", folder), NULL, NULL, 0, reason), 0,
                 "%s", reason);
    try_all("picture", draw_picture, &frames);
    frames_close(&frames);
}

/* A whole run: finished, or "out of memory" with a reason. */
static int do_run(const void *what) {
    const struct variant *variant = what;
    char reason[REASON_SIZE];
    struct settings settings;
    struct run_result result;
    struct scene *scene = circle_scene(4, 0);
    const struct run_request request = {.stepper = variant->method->name,
                                        .options = &variant->option,
                                        .option_count = variant->option != NULL};
    if (settings_resolve(scene, &request, &settings, reason))
        _exit(78);
    failing = 1;
    simulate(scene, &settings, NULL, NULL, &result);
    failing = 0;
    if (result.outcome != FINISHED && (result.outcome != OUT_OF_MEMORY || !result.reason[0]))
        _exit(79);
    return result.outcome == FINISHED ? MADE : NOT_MADE;
}

static void check_run(const struct variant *variant, void *ctx) {
    (void)ctx;
    try_all(variant->name, do_run, variant);
}

Test(memory, runs_finish_or_are_out_of_memory) {
    each_variant(check_run, NULL);
}

static int see_frame(void *ctx, const struct model *model, double t, const double *rows) {
    (void)ctx, (void)t, (void)rows;
    return model->diagnosis ? 0 : CRASHED;
}

static int do_diagnosed_run(const void *what) {
    const struct scene *scene = what;
    char reason[REASON_SIZE];
    struct settings settings;
    struct run_result result;
    if (settings_resolve(scene, &(struct run_request){.diagnostics = 1}, &settings, reason))
        _exit(78);
    failing = 1;
    simulate(scene, &settings, &(struct observer){see_frame, NULL}, NULL, &result);
    failing = 0;
    if (result.outcome != FINISHED && (result.outcome != OUT_OF_MEMORY || !result.reason[0]))
        _exit(79);
    return result.outcome == FINISHED ? MADE : NOT_MADE;
}

/* Diagnoses take memory at every frame, for two wisps here. */
Test(memory, diagnosed_runs_finish_or_are_out_of_memory) {
    static const char *const sets[] = {"duration=0.004", "frame_rate=1000"};
    struct scene *scene = lab_load("viscosity", sets, 2);
    try_all(scene->name, do_diagnosed_run, scene);
}

#endif
