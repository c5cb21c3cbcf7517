/* Runs that hang, crash, leave or eat memory: each is a result with its kind and its time, and the
 * others go on. */
#include "base/table.h"
#include "run/results.h"
#include "run/runs.h"
#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__
#endif
#endif

/* --- a machine without room for another process, and what is signalled there --- */

static int forks_left = -1; /* -1: any number */
static int spread_signals;  /* to groups, which are noted and not sent */

pid_t fork(void) {
    pid_t (*real)(void);
    *(void **)&real = dlsym(RTLD_NEXT, "fork");
    if (forks_left == 0) {
        errno = EAGAIN;
        return -1;
    }
    forks_left -= forks_left > 0;
    return real();
}

int kill(pid_t pid, int signal) {
    if (forks_left < 0 || pid > 0)
        return (int)syscall(SYS_kill, pid, signal);
    spread_signals++;
    return 0;
}

enum { GOOD_STEPS = 10 };
static const double step_length = 0.5;

/* --- steppers that go wrong after ten steps --- */

struct bad {
    struct stepper base;
    int steps;
    void *eaten;
};

static struct stepper *bad_create(const struct stepper_settings *settings, struct system *system) {
    (void)settings, (void)system;
    return calloc(1, sizeof(struct bad));
}

static void bad_free(struct stepper *stepper) {
    free(stepper);
}

/* Whether it is time; until then the state just moves. */
static int good(struct stepper *stepper, double *q) {
    struct bad *bad = (struct bad *)stepper;
    q[0] += 1e-3;
    return ++bad->steps <= GOOD_STEPS;
}

static int hang(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    volatile int for_ever = 1;
    if (!good(stepper, q))
        while (for_ever)
            ;
    return 0;
}

static int dawdle(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    if (!good(stepper, q))
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    return 0;
}

static int crash(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    if (!good(stepper, q)) {
        signal(SIGSEGV, SIG_DFL); /* sanitizers catch it */
        raise(SIGSEGV);
    }
    return 0;
}

static int leave(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    if (!good(stepper, q))
        _exit(0); /* "fine", but there is no result */
    return 0;
}

/* Takes all memory there is, in blocks that get smaller, and keeps it. */
static void eat(struct bad *bad) {
    for (size_t size = 1 << 24; size >= 32; size /= 2)
        for (void **block; (block = malloc(size)) != NULL; bad->eaten = block)
            *block = bad->eaten;
}

static int eat_and_say_so(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    if (good(stepper, q))
        return 0;
    eat((struct bad *)stepper);
    return system_fail(stepper->system, -OUT_OF_MEMORY, "ate it all");
}

static int eat_and_die(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    if (good(stepper, q))
        return 0;
    eat((struct bad *)stepper);
    volatile double *more = malloc(1 << 24);
    more[0] = 1;
    return 0;
}

/* As if the user had ended the whole; and goes on until that comes back. */
static int call_off(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)t, (void)h, (void)v;
    if (!good(stepper, q)) {
        kill(getppid(), SIGINT);
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    return 0;
}

static int finish(struct stepper *stepper, double t, double h, double *q, double *v) {
    (void)stepper, (void)t, (void)h, (void)v;
    q[0] += 1e-3;
    return 0;
}

static const struct bad_method {
    struct stepper_method method;
    const char *status, *reason; /* what run.json must say */
    int memory;                  /* needs a limit of address space */
} methods[] = {
#define BAD(called, function)                                                 \
    {                                                                         \
        .name = called, .summary = "a test", .reference = "none", .order = 1, \
        .create = bad_create, .step = function, .free = bad_free              \
    }
    {BAD("hangs", hang), "out of time", "killed", 0},
    {BAD("dawdles", dawdle), "out of time", "stopped", 0},
    {BAD("crashes", crash), "crashed", "signal 11", 0},
    {BAD("leaves", leave), "crashed", "code 0", 0},
    {BAD("finishes", finish), "finished", "", 0},
    {BAD("eats", eat_and_say_so), "out of memory", "ate it all", 1},
    {BAD("eats-and-dies", eat_and_die), "crashed", "signal 11", 1},
};
enum { METHODS = sizeof methods / sizeof *methods };

static const struct run_limits limits = {.seconds = 0.3, .bytes = 64 << 20};

static int skipped(const struct bad_method *bad) {
#ifdef __SANITIZE_ADDRESS__
    return bad->memory;
#else
    (void)bad;
    return 0;
#endif
}

static void make_case(struct run_case *run, const struct scene *scene, const char *root,
                      const struct bad_method *bad) {
    char reason[REASON_SIZE];
    const struct run_request request = {.stepper = "euler", .step = step_length};
    *run = (struct run_case){.scene = scene};
    cr_assert_eq(settings_resolve(scene, &request, &run->settings, reason), 0, "%s", reason);
    run->settings.method = &bad->method;
    run_folder(root, scene, &run->settings, run->folder);
}

/* run.json says what happened and when; the frames before are there, in complete lines. */
static void check_result(const struct run_case *run, const struct bad_method *bad) {
    struct run_files files;
    char reason[REASON_SIZE];
    const char *name = bad->method.name;
    cr_assert_eq(run_read(&files, run->folder, reason), 0, "%s: %s", name, reason);
    const char *status = json_string_value(json_object_get(files.json, "status"));
    const char *why = json_string_value(json_object_get(files.json, "reason"));
    cr_assert_str_eq(status, bad->status, "%s: status '%s' (%s)", name, status, why);
    cr_assert(strstr(why, bad->reason), "%s: reason '%s'", name, why);
    const double reached = run_number(&files, "simulated_time");
    const double least = GOOD_STEPS * step_length;
    const int all = strcmp(bad->status, "finished") == 0;
    cr_assert(all ? reached == 100 : reached >= least && reached < 100, "%s: reached %g s", name,
              reached);
    cr_assert(strcmp(name, "dawdles") == 0 || all || reached == least,
              "%s: reached %g s where it went wrong after %g", name, reached, least);
    cr_assert(files.states.row_count >= GOOD_STEPS + 1, "%s: %d rows are left", name,
              files.states.row_count);
    cr_assert_eq(table_value(&files.states, GOOD_STEPS, 0), least, "%s: row of another time", name);
    run_free(&files);
}

Test(children, each_kind_of_death_is_a_result) {
    char folder[PATH_SIZE], reason[REASON_SIZE];
    folder_make(folder);
    runs_catch_signals();
    struct scene *scene = circle_scene(100, 0);
    for (int i = 0; i < METHODS; i++) {
        struct run_case run;
        if (skipped(&methods[i]))
            continue;
        make_case(&run, scene, folder, &methods[i]);
        const enum outcome outcome = runs_do_one(&run, &limits, 0, reason);
        cr_assert_str_eq(outcome_name(outcome), methods[i].status, "%s: '%s' (%s)",
                         methods[i].method.name, outcome_name(outcome), reason);
        check_result(&run, &methods[i]);
        cr_assert_eq(count_files(run.folder, ".part"), 0, "%s: half a file is left",
                     methods[i].method.name);
    }
    scene_free(scene);
    folder_remove(folder);
}

/* The same in a pool: what dies holds up nobody. */
Test(children, a_pool_completes_around_its_dead) {
    char folder[PATH_SIZE], reason[REASON_SIZE] = "";
    struct run_case runs[METHODS + 2];
    const struct bad_method *kinds[METHODS + 2];
    int count = 0;
    folder_make(folder);
    runs_catch_signals();
    struct scene *scene = circle_scene(100, 0), *other = circle_scene(100, 0.5);
    for (int i = 0; i < METHODS; i++) {
        if (skipped(&methods[i]))
            continue;
        make_case(&runs[count], scene, folder, &methods[i]);
        kinds[count++] = &methods[i];
    }
    const int different = count;
    runs[count] = runs[0]; /* asked for twice: done once */
    kinds[count] = kinds[0];
    count++;
    const int ran = runs_do_all(runs, count, &limits, 2, 0, reason);
    cr_assert_eq(ran, different, "%d runs of %d different ones (%s)", ran, different, reason);
    for (int i = 0; i < count; i++)
        check_result(&runs[i], kinds[i]);
    cr_assert_eq(runs_do_all(runs, count, &limits, 2, 0, reason), 0, "failures are run again");
    scene_free(scene);
    scene_free(other);
    folder_remove(folder);
}

/* A process that cannot be had is no process -1: nobody else is signalled when the user ends it. */
Test(children, a_fork_that_fails_harms_nobody) {
    static const struct bad_method calls_off = {BAD("calls-off", call_off), "interrupted", "", 0};
    char folder[PATH_SIZE], reason[REASON_SIZE] = "";
    struct run_case runs[2];
    folder_make(folder);
    runs_catch_signals();
    struct scene *scene = circle_scene(100, 0);
    make_case(&runs[0], scene, folder, &calls_off);
    make_case(&runs[1], scene, folder, &methods[0]);
    forks_left = 0;
    cr_assert_eq(runs_do_one(&runs[1], &limits, 0, reason), OUTPUT_FAILED);
    cr_assert(strstr(reason, "cannot start a process"), "%s", reason);
    for (int room = 0; room <= 1; room++) {
        forks_left = room;
        const int ran = runs_do_all(runs, 2, &limits, 2, 0, reason);
        cr_assert_eq(ran, -OUTPUT_FAILED, "%d: %s", ran, reason);
        cr_assert(strstr(reason, "cannot start a process"), "%s", reason);
        cr_assert_eq(runs_interrupted(), room, "the user has ended it or not");
        cr_assert_eq(spread_signals, 0, "%d signals to more than one process", spread_signals);
    }
    scene_free(scene);
    folder_remove(folder);
}

/* What is another run has another folder: every setting counts. */
Test(children, every_setting_is_in_the_name_of_the_folder) {
    const char *const iterations = "newton.iterations=9";
    const struct {
        struct run_request request;
        double duration;
    } cases[] = {
        {{.stepper = "euler", .step = 0.5}, 10},
        {{.stepper = "euler", .step = 0.25}, 10},
        {{.stepper = "euler", .step = 0.5}, 20},
        {{.stepper = "rk4", .step = 0.5}, 10},
        {{.stepper = "euler", .treatment = "projection", .step = 0.5}, 10},
        {{.stepper = "euler", .step = 0.5, .timings = 3}, 10},
        {{.stepper = "implicit-euler", .step = 0.5}, 10},
        {{.stepper = "implicit-euler", .linear = "klu", .step = 0.5}, 10},
        {{.stepper = "implicit-euler", .step = 0.5, .options = &iterations, .option_count = 1}, 10},
        {{.stepper = "cvode", .rtol = 1e-5}, 10},
        {{.stepper = "cvode", .rtol = 1.0000000000000002e-5}, 10},
        {{.stepper = "cvode", .rtol = 1e-5, .atol = 1e-5}, 10},
    };
    enum { CASES = sizeof cases / sizeof *cases };
    char folders[CASES][PATH_SIZE], reason[REASON_SIZE];
    for (int i = 0; i < CASES; i++) {
        struct settings settings;
        struct scene *scene = circle_scene(cases[i].duration, 0.5);
        cr_assert_eq(settings_resolve(scene, &cases[i].request, &settings, reason), 0, "%s",
                     reason);
        run_folder("r", scene, &settings, folders[i]);
        const char *hash = strrchr(folders[i], '-');
        cr_assert(hash && strlen(hash) == 17, "%s ends in no hash", folders[i]);
        for (int k = 0; k < i; k++)
            cr_assert(strcmp(strrchr(folders[k], '-'), hash) != 0, "cases %d and %d are one: %s", k,
                      i, folders[i]);
        char again[PATH_SIZE];
        run_folder("r", scene, &settings, again);
        cr_assert_str_eq(again, folders[i], "the name changes");
        scene_free(scene);
    }
}
