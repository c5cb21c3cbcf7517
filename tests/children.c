/* Runs that hang, crash, leave or eat memory: each is a result with its kind and its time, and the
 * others go on. Runs that are killed are none. */
#include "run/results.h"
#include "run/runs.h"
#include "run/seal.h"
#include "scene/scene_load.h"
#include "support.h"

#include <criterion/criterion.h>
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

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

/* A step of a method, of whose arguments these two are used. */
#define UNUSED __attribute__((unused))
#define STEP(name)                                                                        \
    static int name(struct stepper *stepper, UNUSED double t, UNUSED double h, double *q, \
                    UNUSED double *v)

/* Whether it is time; until then the state just moves. */
static int good(struct stepper *stepper, double *q) {
    struct bad *bad = (struct bad *)stepper;
    q[0] += 1e-3;
    return ++bad->steps <= GOOD_STEPS;
}

STEP(hang) {
    volatile int for_ever = 1;
    if (!good(stepper, q))
        while (for_ever)
            ;
    return 0;
}

/* Takes 10 ms of CPU time for each step. */
STEP(toil) {
    const clock_t start = clock();
    if (!good(stepper, q))
        while (clock() - start < CLOCKS_PER_SEC / 100)
            ;
    return 0;
}

/* Does nothing for longer than the limit of CPU time, and goes on. */
STEP(nap) {
    const struct bad *bad = (struct bad *)stepper;
    if (!good(stepper, q) && bad->steps <= 2 * GOOD_STEPS)
        wait_for(0.05);
    return 0;
}

STEP(dawdle) {
    if (!good(stepper, q))
        wait_for(0.02);
    return 0;
}

STEP(crash) {
    if (!good(stepper, q)) {
        signal(SIGSEGV, SIG_DFL); /* sanitizers catch it */
        raise(SIGSEGV);
    }
    return 0;
}

STEP(abort_itself) {
    if (!good(stepper, q))
        abort();
    return 0;
}

#ifndef SANITIZED /* which reports these its own way */
STEP(read_nowhere) {
    double *volatile nowhere = NULL;
    if (!good(stepper, q))
        q[0] = *nowhere;
    return 0;
}

/* Ever deeper, until there is no room on the stack, not for a handler either. */
static int deeper(volatile int *from) {
    volatile int here = *from + 1;
    return here > 0 ? deeper(&here) + here : 0;
}

STEP(sink) {
    volatile int start = 0;
    return good(stepper, q) ? 0 : deeper(&start);
}
#endif

STEP(leave) {
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

STEP(eat_and_say_so) {
    if (good(stepper, q))
        return 0;
    eat((struct bad *)stepper);
    return system_fail(stepper->system, -OUT_OF_MEMORY, "ate it all");
}

STEP(eat_and_die) {
    if (good(stepper, q))
        return 0;
    eat((struct bad *)stepper);
    volatile double *more = malloc(1 << 24);
    more[0] = 1;
    return 0;
}

/* As if the user had ended the whole; and goes on until that comes back. */
STEP(call_off) {
    if (!good(stepper, q)) {
        kill(getppid(), SIGINT);
        wait_for(0.02);
    }
    return 0;
}

static const char *lost_folder;

/* Is shot from outside, by another process, as often as is left; then it goes on. */
static struct { atomic_int left, signal; } * shots; /* shared by all processes */

STEP(get_shot) {
    if (good(stepper, q) || shots->left == 0)
        return 0;
    shots->left--;
    const pid_t other = fork();
    if (other == 0) {
        kill(getppid(), shots->signal);
        _exit(0);
    }
    waitpid(other, NULL, 0);
    wait_for(0.2);
    return 0;
}

/* Takes a millisecond of CPU time for each step, and counts the steps of all processes. */
static atomic_int *worked; /* shared by them */

STEP(work) {
    const clock_t start = clock();
    (void)stepper, (void)q;
    ++*worked;
    while (clock() - start < CLOCKS_PER_SEC / 1000)
        ;
    return 0;
}

STEP(finish) {
    (void)stepper;
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
    {BAD("hangs", hang), "out of time", "did not answer", 0},
    {BAD("toils", toil), "out of time", "limit of CPU time", 0},
    {BAD("naps", nap), "finished", "", 0},
    {BAD("crashes", crash), "crashed", "signal 11", 0},
    {BAD("aborts", abort_itself), "crashed", "signal 6", 0},
#ifndef SANITIZED
    {BAD("reads-nowhere", read_nowhere), "crashed", "signal 11", 0},
    {BAD("sinks", sink), "crashed", "signal 11", 0},
#endif
    {BAD("leaves", leave), "crashed", "code 0", 0},
    {BAD("finishes", finish), "finished", "", 0},
    {BAD("eats", eat_and_say_so), "out of memory", "ate it all", 1},
    {BAD("eats-and-dies", eat_and_die), "crashed", "signal 11", 1},
};
enum { METHODS = sizeof methods / sizeof *methods };

static const struct run_limits limits = {.seconds = 0.3, .bytes = 64 << 20};

static int skipped(const struct bad_method *bad) {
#ifdef SANITIZED
    return bad->memory;
#else
    (void)bad;
    return 0;
#endif
}

static const char *folder;
static const struct scene *scene;
static char reason[REASON_SIZE];

static void set_up(void) {
    folder = folder_make();
    scene = circle_scene(100, 0);
    runs_catch_signals();
    shots = mmap(NULL, sizeof *shots, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    cr_assert(shots != MAP_FAILED);
}

static void make_case(struct run_case *run, const struct bad_method *bad) {
    const struct run_request request = {.stepper = "euler", .step = step_length};
    *run = (struct run_case){.scene = scene};
    run->settings = settings_of(scene, &request);
    run->settings.method = &bad->method;
    run_folder(folder, scene, &run->settings, run->folder);
}

/* run.json says what happened and when; the frames before are there, in complete lines. */
static void check_result(const struct run_case *run, const struct bad_method *bad) {
    struct run_files files;
    const char *name = bad->method.name;
    cr_assert_eq(run_read_states(&files, run->folder, NULL, reason), 0, "%s: %s", name, reason);
    const char *status = json_string_value(json_object_get(files.json, "status"));
    const char *why = json_string_value(json_object_get(files.json, "reason"));
    cr_assert_str_eq(status, bad->status, "%s: status '%s' (%s)", name, status, why);
    cr_assert(strstr(why, bad->reason), "%s: reason '%s'", name, why);
    const double reached = run_number(&files, "simulated_time");
    const double least = GOOD_STEPS * step_length;
    const int all = strcmp(bad->status, "finished") == 0;
    cr_assert(all ? reached == 100 : reached >= least && reached < 100, "%s: reached %g s", name,
              reached);
    cr_assert(strcmp(name, "toils") == 0 || all || reached == least,
              "%s: reached %g s where it went wrong after %g", name, reached, least);
    const int rows = files.states->table.row_count;
    cr_assert(rows >= GOOD_STEPS + 1, "%s: %d rows are left", name, rows);
    cr_assert_eq(trajectory_row(files.states, GOOD_STEPS)[STATE_T], least,
                 "%s: row of another time", name);
    run_free(&files);
}

Test(children, each_kind_of_death_is_a_result, .init = set_up) {
    for (int i = 0; i < METHODS; i++) {
        struct run_case run;
        if (skipped(&methods[i]))
            continue;
        make_case(&run, &methods[i]);
        const enum outcome outcome = runs_do_one(&run, &limits, 0, reason);
        cr_assert_str_eq(outcome_name(outcome), methods[i].status, "%s: '%s' (%s)",
                         methods[i].method.name, outcome_name(outcome), reason);
        check_result(&run, &methods[i]);
        cr_assert_eq(count_files(run.folder, ".part"), 0, "%s: half a file is left",
                     methods[i].method.name);
    }
}

/* The same in a pool: what dies holds up nobody. */
Test(children, a_pool_completes_around_its_dead, .init = set_up) {
    struct run_case runs[METHODS + 2];
    const struct bad_method *kinds[METHODS + 2];
    int count = 0;
    for (int i = 0; i < METHODS; i++) {
        if (skipped(&methods[i]))
            continue;
        make_case(&runs[count], &methods[i]);
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
}

/* --- what is no result --- */

static const struct bad_method dawdles = {BAD("dawdles", dawdle), "", "", 0},
                               is_shot = {BAD("is-shot", get_shot), "finished", "", 0};

/* Nothing is left in the folder of a run that was killed, so that the next call does it. */
static void check_nothing(const struct run_case *run) {
    cr_assert_eq(run_is_complete(run->folder), 0, "a run that was killed is a result");
    cr_assert_eq(count_files(run->folder, ""), 0, "something is left of it");
}

/* The clock on the wall tells how busy the machine is, nothing about a method. */
Test(children, the_watchdog_leaves_no_result, .init = set_up) {
    static const struct run_limits watched = {.seconds = 0.3, .wall_seconds = 0.4};
    struct run_case runs[2];
    scene = circle_scene(1000, 0);
    make_case(&runs[0], &dawdles);
    make_case(&runs[1], &is_shot);
    cr_assert_eq(runs_do_one(&runs[0], &watched, 0, reason), OUTPUT_FAILED);
    cr_assert(strstr(reason, "watchdog"), "%s", reason);
    check_nothing(&runs[0]);
    const int ran = runs_do_all(runs, 2, &watched, 2, 0, reason);
    cr_assert_eq(ran, 1, "%d runs (%s)", ran, reason);
    check_nothing(&runs[0]);
    cr_assert(run_is_complete(runs[1].folder));
}

/* Whatever signal it is, a method that did not raise it itself is not to blame. */
Test(children, who_is_killed_from_outside_is_run_again, .init = set_up) {
#ifdef SANITIZED /* which takes the other ones for its own */
    static const int signals[] = {SIGKILL, SIGTERM, SIGINT, SIGHUP};
#else
    static const int signals[] = {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGSEGV, SIGFPE, SIGABRT};
#endif
    enum { SIGNALS = sizeof signals / sizeof *signals };
    struct run_case run;
    make_case(&run, &is_shot);
    for (int i = 0; i < SIGNALS; i++) {
        shots->signal = signals[i];
        shots->left = 1;
        enum outcome outcome = runs_do_one(&run, &limits, 0, reason);
        cr_assert_eq(outcome, FINISHED, "signal %d: %s (%s)", signals[i], outcome_name(outcome),
                     reason);
        check_result(&run, &is_shot);
        run_remove(run.folder);
        shots->left = 1;
        const int ran = runs_do_all(&run, 1, &limits, 1, 0, reason);
        cr_assert_eq(ran, 1, "signal %d: %d runs (%s)", signals[i], ran, reason);
        check_result(&run, &is_shot);
        cr_assert_eq(shots->left, 0);
        run_remove(run.folder);
    }
}

/* One that is killed again and again is left out; the others are there, and so is it when it is
 * left alone. */
Test(children, who_is_killed_twice_is_left_out, .init = set_up) {
    struct run_case runs[3];
    make_case(&runs[0], &is_shot);
    make_case(&runs[1], &methods[2]);
    runs[2] = runs[0]; /* asked for twice */
    shots->signal = SIGKILL;
    shots->left = 5;
    const int ran = runs_do_all(runs, 3, &limits, 2, 0, reason);
    cr_assert_eq(ran, 1, "%d runs (%s)", ran, reason);
    cr_assert_eq(shots->left, 3, "%d shots are left", shots->left);
    check_nothing(&runs[0]);
    check_result(&runs[1], &methods[2]);
    cr_assert_eq(runs_do_one(&runs[0], &limits, 0, reason), OUTPUT_FAILED);
    cr_assert(strstr(reason, "from outside") && strstr(reason, "signal 9"), "%s", reason);
    cr_assert_eq(shots->left, 1);
    check_nothing(&runs[0]);
    shots->left = 0;
    cr_assert_eq(runs_do_all(runs, 3, &limits, 2, 0, reason), 1, "%s", reason);
    check_result(&runs[0], &is_shot);
}

/* --- locks --- */

/* As if another host had taken the folder, for this one stood still, and done the run. */
STEP(lose) {
    if (good(stepper, q))
        return 0;
    file_write(lost_folder, ".lock", "elsewhere 1 1 1\n");
    json_t *done = json_pack("{s:s}", "status", "finished");
    seal_add(done, json_object());
    json_dump_file(done, printed("%s/run.json", lost_folder), 0);
    for (;;)
        pause();
}

Test(children, slow_a_run_whose_lock_is_lost_is_left_to_others, .init = set_up) {
    static const struct bad_method loses = {BAD("loses", lose), "", "", 0};
    struct run_case run;
    make_case(&run, &loses);
    lost_folder = printed("%s", run.folder);
    cr_assert_eq(runs_do_all(&run, 1, &limits, 1, 0, reason), 1, "%s", reason);
    char *text = file_read(printed("%s/run.json", run.folder));
    cr_assert(text && !strstr(text, "counters"), "it has been written: %s", text ? text : "gone");
    cr_assert_eq(count_files(run.folder, ".lock"), 1, "the other's lock is gone");
    cr_assert_eq(count_files(run.folder, ".part"), 0);
}

/* --- limits that are counted --- */

/* A run that took more than its limit of CPU time is out of time, whether or not anybody has seen
 * it before the end. */
Test(children, a_limit_of_cpu_time_holds_to_the_end) {
    struct run_result result;
    scene = circle_scene(10, 0.5);
    const struct settings settings = settings_of(scene, &(struct run_request){.step = 0.5});
    simulate(scene, &settings, NULL, &(struct watch){.cpu_seconds = 1e-9}, &result);
    cr_assert_eq(result.outcome, OUT_OF_TIME);
    cr_assert_eq(result.time, 10);
    simulate(scene, &settings, NULL, &(struct watch){.cpu_seconds = 1e9}, &result);
    cr_assert_eq(result.outcome, FINISHED);
}

/* A run ends where it has taken more evaluations than it may, whatever stops it has. */
Test(children, a_limit_of_evaluations_is_counted) {
    const struct run_request request = {.stepper = "rk4", .step = 0.5};
    const struct {
        double frame_rate, limit, time;
    } cases[] = {
        {0, 100, 13},   {0.1, 100, 13}, {0.1, 103, 13}, {0.1, 104, 13.5},
        {0.1, 400, 50}, {0.1, 399, 50}, {0, 399, 50},   {0, 0, 50},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct run_case run;
        struct run_files files;
        folder = folder_make();
        scene = circle_scene(50, cases[i].frame_rate);
        run = (struct run_case){.scene = scene};
        run.settings = settings_of(scene, &request);
        path_format(run.folder, "%s", folder);
        const enum outcome outcome =
            runs_do_one(&run, &(struct run_limits){.evaluations = cases[i].limit}, 0, reason);
        const int within = cases[i].limit == 0 || cases[i].limit == 400;
        cr_assert_eq(outcome, within ? FINISHED : OUT_OF_TIME, "case %d: %s", (int)i,
                     outcome_name(outcome));
        cr_assert_eq(run_read(&files, folder, reason), 0, "%s", reason);
        const double reached = run_number(&files, "simulated_time");
        cr_assert_eq(reached, cases[i].time, "case %d: reached %g s", (int)i, reached);
        cr_assert_eq(run_number(&files, "counters.force_evaluations"), 8 * cases[i].time);
        run_free(&files);
    }
}

/* The same frames, end and counters for any number of threads. */
Test(children, a_limit_of_evaluations_knows_no_threads) {
    char *states[2];
    double evaluations[2], reached[2];
    const char *const sets[] = {"duration=0.2"};
    scene = lab_load("wind", sets, 1);
    for (int i = 0; i < 2; i++) {
        const struct run_request request = {.stepper = "cvode", .threads = 1 + 2 * i};
        struct run_case run = {.scene = scene};
        struct run_files files;
        folder = folder_make();
        path_format(run.folder, "%s", folder);
        run.settings = settings_of(scene, &request);
        cr_assert_eq(runs_do_one(&run, &(struct run_limits){.evaluations = 50000}, 0, reason),
                     OUT_OF_TIME);
        cr_assert_eq(run_read(&files, folder, reason), 0, "%s", reason);
        evaluations[i] = run_number(&files, "counters.force_evaluations");
        reached[i] = run_number(&files, "simulated_time");
        run_free(&files);
        states[i] = file_read(printed("%s/states.tsv", folder));
    }
    cr_assert(evaluations[0] > 50000 && evaluations[0] < 100000, "%g evaluations", evaluations[0]);
    cr_assert_eq(evaluations[0], evaluations[1]);
    cr_assert_eq(reached[0], reached[1]);
    cr_assert(states[0] && states[1] && strcmp(states[0], states[1]) == 0);
}

/* --- a machine without room --- */

/* A process that cannot be had is no process -1: nobody else is signalled when the user ends it. */
Test(children, a_fork_that_fails_harms_nobody, .init = set_up) {
    static const struct bad_method calls_off = {BAD("calls-off", call_off), "interrupted", "", 0};
    struct run_case runs[2];
    make_case(&runs[0], &calls_off);
    make_case(&runs[1], &methods[0]);
    forks_left = 0;
    cr_assert_eq(runs_do_one(&runs[1], &limits, 0, reason), OUTPUT_FAILED);
    cr_assert(strstr(reason, "cannot start a process"), "%s", reason);
    for (int room = 0; room <= 1; room++) {
        forks_left = room;
        const int ran = runs_do_all(runs, 2, &limits, 2, 0, reason);
        cr_assert_eq(ran, -OUTPUT_FAILED, "%d: %s", ran, reason);
        cr_assert(strstr(reason, "cannot start a process"), "%s", reason);
        cr_assert_eq(runs_interrupted(), room, "the user has ended it or not");
        cr_assert(!run_is_complete(runs[0].folder), "what was called off is no result");
        cr_assert_eq(spread_signals, 0, "%d signals to more than one process", spread_signals);
    }
}

/* A long run need not be repeated for its first time. */
Test(children, a_long_run_is_the_first_of_its_own_times, .init = set_up) {
    static const struct bad_method works = {BAD("works", work), "finished", "", 0};
    static const struct {
        double duration;
        int timings, runs;
    } cases[] = {{100, 1, 1}, {100, 3, 3}, {20, 1, 2}};
    worked = mmap(NULL, sizeof *worked, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    cr_assert(worked != MAP_FAILED);
    for (int i = 0; i < 3; i++) {
        struct run_files files;
        struct run_case run;
        scene = circle_scene(cases[i].duration, 0);
        make_case(&run, &works);
        run.settings.timings = cases[i].timings;
        *worked = 0;
        cr_assert_eq(runs_do_one(&run, &(struct run_limits){0}, 0, reason), FINISHED, "%s", reason);
        const int steps = (int)(cases[i].duration / step_length);
        cr_expect_eq(*worked, cases[i].runs * steps, "case %d: %d steps, of %d a run", i, *worked,
                     steps);
        cr_assert_eq(run_read(&files, run.folder, reason), 0, "%s", reason);
        const json_t *times = json_object_get(files.json, "cpu_seconds_repeated");
        cr_assert_eq(json_array_size(times), (size_t)cases[i].timings);
        run_free(&files);
    }
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
    char folders[CASES][PATH_SIZE];
    for (int i = 0; i < CASES; i++) {
        scene = circle_scene(cases[i].duration, 0.5);
        const struct settings settings = settings_of(scene, &cases[i].request);
        run_folder("r", scene, &settings, folders[i]);
        const char *hash = strrchr(folders[i], '-');
        cr_assert(hash && strlen(hash) == 17, "%s ends in no hash", folders[i]);
        for (int k = 0; k < i; k++)
            cr_assert(strcmp(strrchr(folders[k], '-'), hash) != 0, "cases %d and %d are one: %s", k,
                      i, folders[i]);
        char again[PATH_SIZE];
        run_folder("r", scene, &settings, again);
        cr_assert_str_eq(again, folders[i], "the name changes");
    }
}
