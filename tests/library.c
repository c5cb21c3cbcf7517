/* The library for other programs: by wisplab.h alone, what the program computes; from threads; and
 * installed, for C and for Python. */
#include "build_info.h"
#include "library/wisplab.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* --- a run, by the library and by the program --- */

/* Numbers one after the other. */
struct tape {
    double *number;
    size_t count;
};

static void put(struct tape *tape, const double *numbers, size_t count) {
    tape->number = realloc(tape->number, (tape->count + count) * sizeof *numbers);
    cr_assert(tape->number);
    memcpy(tape->number + tape->count, numbers, count * sizeof *numbers);
    tape->count += count;
}

static int same(const struct tape *a, const struct tape *b) {
    return a->count == b->count && memcmp(a->number, b->number, a->count * sizeof(double)) == 0;
}

struct filmed {
    struct tape tape;
    int columns;
};

static int keep(void *ctx, double t, const double *rows, int nodes) {
    struct filmed *filmed = ctx;
    put(&filmed->tape, &t, 1);
    put(&filmed->tape, rows, (size_t)(nodes * filmed->columns));
    return 0;
}

static int keep_frame(void *ctx, const struct model *model, double t, const double *rows) {
    return keep(ctx, t, rows, model->row_count);
}

static wisplab *open_scene(const char *name, const char *const *sets, const char *treatment) {
    char error[400];
    wisplab *w;
    cr_assert_eq(wisplab_open(&w, name, sets, treatment, error, sizeof error), WISPLAB_OK, "%s",
                 error);
    return w;
}

static double end_of(const wisplab *w) {
    double begin, end, rate;
    wisplab_times(w, &begin, &end, &rate);
    return end;
}

static long long counted(const wisplab *w, const char *name) {
    long long *counts = test_room((size_t)wisplab_counters() * sizeof *counts);
    int i = 0;
    wisplab_counts(w, counts);
    while (wisplab_counter_name(i) && strcmp(wisplab_counter_name(i), name) != 0)
        i++;
    cr_assert(wisplab_counter_name(i), "no counter %s", name);
    const long long count = counts[i];
    return count;
}

static const struct {
    const char *scene, *sets[3], *stepper;
    int splits;
} runs[] = {
    {"swing", {"duration=0.2"}, "rk4", 0},
    {"swing-envelope", {"duration=0.2"}, "bdf2", 0},
    {"circle", {"duration=2.0"}, "euler", 0},
    {"subdivision", {"duration=0.6"}, "cvode", 1},
    {"sphere", {"duration=1.3", "wisps.[0].grid=[1, 2]"}, "bdf", 0},
    {"swing", {"duration=0.1", "material={stretch=\"rigid\";}"}, "rk4", 0},
};
enum { RUNS = sizeof runs / sizeof *runs };

Test(library, a_run_has_the_bits_of_the_program) {
    for (int i = 0; i < RUNS; i++) {
        int sets = 0;
        while (runs[i].sets[sets])
            sets++;
        struct scene *scene = lab_load(runs[i].scene, runs[i].sets, sets);
        struct run_request request = {.stepper = runs[i].stepper};
        struct run_result result;
        struct filmed right = {.columns = 0}, found = right;
        wisplab *w = open_scene(runs[i].scene, runs[i].sets, NULL);
        request.treatment = wisplab_treatment(w);
        right.columns = found.columns = wisplab_columns(w);
        const struct settings settings = settings_of(scene, &request);
        const struct observer observer = {keep_frame, &right};
        simulate(scene, &settings, &observer, NULL, &result);
        const struct wisplab_method method = {
            .stepper = runs[i].stepper, .frame = keep, .context = &found};
        const int code = wisplab_run(w, &method, end_of(w));

        cr_assert_eq(result.outcome, FINISHED, "%s: %s", runs[i].scene, result.reason);
        cr_assert_eq(code, WISPLAB_OK, "%s: %s", runs[i].scene, wisplab_error(w));
        cr_assert(right.tape.count > 0 && same(&right.tape, &found.tape), "%s with %s",
                  runs[i].scene, runs[i].stepper);
        cr_assert_eq(counted(w, "force_evaluations"), result.counters.force_evaluations, "%s",
                     runs[i].scene);
        cr_assert_eq(counted(w, "splits") > 0, runs[i].splits, "%s", runs[i].scene);
        wisplab_close(w);
        free(right.tape.number);
        free(found.tape.number);
    }
}

/* --- the state and the clock --- */

struct state {
    int n;
    double t, *q, *v;
};

static struct state state_of_handle(const wisplab *w) {
    struct state s = {.n = wisplab_unknowns(w)};
    s.q = test_room((size_t)s.n * sizeof *s.q);
    s.v = test_room((size_t)s.n * sizeof *s.v);
    wisplab_state(w, &s.t, s.q, s.v);
    return s;
}

enum { STEPS = 100 }; /* from stop to stop: those of 9000 Hz */

/* A method of one's own: symplectic Euler, from the handle's state to the next stop. */
static void step_to(wisplab *w, double stop) {
    struct state s = state_of_handle(w);
    double *a = test_room((size_t)s.n * sizeof *a);
    const double from = s.t, h = (stop - from) / STEPS;
    for (int k = 0; k < STEPS; k++) {
        const double t = k ? from + k * h : from;
        cr_assert_eq(wisplab_acceleration(w, t, s.q, s.v, a), WISPLAB_OK, "%s", wisplab_error(w));
        for (int i = 0; i < s.n; i++) {
            s.v[i] += h * a[i];
            s.q[i] += h * s.v[i];
        }
    }
    cr_assert_eq(wisplab_set_state(w, stop, s.q, s.v), WISPLAB_OK);
}

/* By hand and by the program's stepper, told to take such steps, in two runs, are the same bits.
 * The scene has ticks of both kinds, no frames between them, and wisps that split. */
Test(library, stops_and_ticks_by_hand_are_those_of_a_run) {
    static const char *const sets[] = {"frame_rate=90", "contacts.collision_rate=90", NULL};
    wisplab *hand = open_scene("subdivision", sets, NULL),
            *run = open_scene("subdivision", sets, NULL);
    const struct wisplab_method method = {.stepper = "symplectic-euler", .step = 1. / 9000};
    const int n = wisplab_unknowns(hand);
    int stops = 0, changes = 0, changed;
    unsigned events;
    double at;
    for (wisplab_next_stop(hand, &at, &events); at < 0.4; wisplab_next_stop(hand, &at, &events)) {
        const int before = wisplab_unknowns(hand);
        cr_assert_eq(events, WISPLAB_COLLISION | WISPLAB_INTERACTION);
        cr_assert_eq(wisplab_tick(hand, NULL), WISPLAB_REFUSED, "the state is not there yet");
        step_to(hand, at);
        cr_assert_eq(wisplab_tick(hand, &changed), WISPLAB_OK, "%s", wisplab_error(hand));
        cr_assert(changed || wisplab_unknowns(hand) == before);
        changes += changed;
        stops++;
    }
    struct state mine = state_of_handle(hand);
    cr_assert_eq(wisplab_run(run, &method, 18. / 90), WISPLAB_OK, "%s", wisplab_error(run));
    cr_assert_eq(wisplab_run(run, &method, mine.t), WISPLAB_OK, "%s", wisplab_error(run));
    struct state theirs = state_of_handle(run);
    cr_assert(stops == 35 && changes > 0 && mine.n > n, "%d stops, %d changes, %d unknowns", stops,
              changes, mine.n);
    cr_assert(mine.n == theirs.n && mine.t == theirs.t);
    cr_assert_eq(memcmp(mine.q, theirs.q, (size_t)mine.n * sizeof *mine.q), 0);
    cr_assert_eq(memcmp(mine.v, theirs.v, (size_t)mine.n * sizeof *mine.v), 0);
    cr_assert_eq(wisplab_parent(hand, wisplab_wisps(hand) - 1) < 2, 1,
                 "its parent was there first");
    wisplab_close(hand);
    wisplab_close(run);
}

/* The next stop is the first one after the last, wherever the state is between them; a state
 * elsewhere is on a clock that begins there. */
Test(library, the_clock_follows_the_state) {
    wisplab *w = open_scene("sphere", NULL, NULL);
    struct state s = state_of_handle(w);
    static const struct {
        double at, next; /* of 300 Hz */
    } moves[] = {{0, 1}, {0.5, 1}, {1, 1}, {7.5, 8}, {8, 8}, {2.5, 3}, {2.75, 3}, {2, 3}};
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++) {
        double at;
        cr_assert_eq(wisplab_set_state(w, moves[i].at / 300, s.q, s.v), WISPLAB_OK);
        wisplab_next_stop(w, &at, NULL);
        cr_assert_eq(at, moves[i].next / 300, "set to %g: the next stop is %g", moves[i].at,
                     300 * at);
    }
    cr_assert_eq(wisplab_set_state(w, NAN, s.q, s.v), WISPLAB_REFUSED);
    wisplab_close(w);
    w = open_scene("swing", NULL, NULL);
    double at;
    unsigned events;
    wisplab_next_stop(w, &at, &events);
    cr_assert(isinf(at) && events == 0, "swing has no stops");
    wisplab_close(w);
}

/* At a knot of the head's motion its acceleration jumps, and so does the rate at which forces
 * change: at the end of an interval it is that of the time before, and behind the tick that of the
 * time after. */
Test(library, at_a_kink_the_side_is_that_of_the_clock) {
    wisplab *w = open_scene("shake", NULL, NULL);
    struct state s = state_of_handle(w);
    const size_t bytes = (size_t)s.n * sizeof *s.q;
    double *before = test_room(bytes), *at_end = test_room(bytes), *behind = test_room(bytes), at;
    unsigned events;
    while (wisplab_next_stop(w, &at, &events), at < end_of(w) && !(events & WISPLAB_KINK))
        cr_assert_eq(wisplab_set_state(w, at + 1e-6, s.q, s.v), WISPLAB_OK);
    cr_assert(events & WISPLAB_KINK, "the head has knots");
    cr_assert_eq(wisplab_set_state(w, at, s.q, s.v), WISPLAB_OK);
    cr_assert_eq(wisplab_time_rate(w, at - 1e-9, s.q, s.v, before), WISPLAB_OK);
    cr_assert_eq(wisplab_time_rate(w, at, s.q, s.v, at_end), WISPLAB_OK);
    cr_assert_eq(wisplab_tick(w, NULL), WISPLAB_OK, "%s", wisplab_error(w));
    cr_assert_eq(wisplab_time_rate(w, at, s.q, s.v, behind), WISPLAB_OK);
    double jump = 0, change = 0;
    for (int i = 0; i < s.n; i++) {
        jump = fmax(jump, fabs(behind[i] - at_end[i]));
        change = fmax(change, fabs(at_end[i] - before[i]));
    }
    cr_assert(jump > 0 && change < 1e-4 * jump, "it jumps by %g, and changes by %g", jump, change);
    wisplab_close(w);
}

/* --- each unknown --- */

/* What an unknown is called is the column of a frame that changes with it. */
Test(library, unknowns_are_named_by_their_columns) {
    static const struct {
        const char *scene, *treatment;
    } cases[] = {{"swing-envelope", "penalty"},
                 {"swing-envelope", "generalised"},
                 {"interactions", "projection"},
                 {"circle", "free"},
                 {"rosenblum", NULL}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        wisplab *w = open_scene(cases[c].scene, NULL, cases[c].treatment);
        struct state s = state_of_handle(w);
        const int columns = wisplab_columns(w), nodes = wisplab_nodes(w);
        const size_t count = (size_t)(columns * nodes);
        double *rest = test_room(count * sizeof *rest), *moved = test_room(count * sizeof *moved);
        cr_assert_eq(wisplab_frame(w, s.t, s.q, s.v, rest), WISPLAB_OK);
        for (int i = 0; i < s.n; i++) {
            struct wisplab_unknown what;
            int changed = -1, others = 0;
            const double rest_q = s.q[i];
            s.q[i] += 0.125;
            cr_assert_eq(wisplab_frame(w, s.t, s.q, s.v, moved), WISPLAB_OK);
            s.q[i] = rest_q;
            for (size_t k = 0; k < count; k++)
                if (moved[k] != rest[k]) {
                    others += changed >= 0;
                    changed = (int)k;
                }
            cr_assert(changed >= 0 && others == 0, "%s, %s: unknown %d is in %d columns",
                      cases[c].scene, wisplab_treatment(w), i, others + (changed >= 0));
            const double *row = rest + changed / columns * columns;
            cr_assert_eq(wisplab_unknown(w, i, &what), WISPLAB_OK);
            cr_assert_str_eq(what.name, wisplab_column(w, changed % columns));
            cr_assert(what.wisp == (int)row[0] && what.node == (int)row[1], "%s: unknown %d",
                      cases[c].scene, i);
        }
        double *xyz = test_room(3 * (size_t)nodes * sizeof *xyz), tip[3];
        cr_assert_eq(wisplab_positions(w, s.t, s.q, s.v, xyz), WISPLAB_OK);
        if (wisplab_wisps(w) == 1) {
            cr_assert_eq(wisplab_tips(w, s.t, s.q, s.v, tip), WISPLAB_OK);
            cr_assert_eq(memcmp(tip, xyz + 3 * (nodes - 1), sizeof tip), 0);
        }
        cr_assert_eq(memcmp(xyz, rest + 2, 3 * sizeof *xyz), 0);
        wisplab_close(w);
    }
}

/* --- matrices --- */

/* Products are of the dense matrix, the sparse one has the same entries and no others are there,
 * and what is solved gives its right side back. Of two wisps nothing couples one with the other. */
Test(library, matrices_in_all_forms_are_one) {
    wisplab *w = open_scene("interactions", NULL, "penalty");
    struct state s = state_of_handle(w);
    const int entries = wisplab_entries(w);
    const size_t n = (size_t)s.n;
    double *x = test_room(n * sizeof *x), *y = test_room(n * sizeof *y),
           *b = test_room(n * sizeof *b);
    double *dense = test_room(n * n * sizeof *dense),
           *values = test_room((size_t)entries * sizeof *values);
    int *start = test_room((n + 1) * sizeof *start),
        *row = test_room((size_t)entries * sizeof *row);
    for (int i = 0; i < s.n; i++) {
        x[i] = sin(7 * i + 1);
        s.q[i] += 1e-3 * cos(11 * i);
    }
    cr_assert_eq(wisplab_pattern(w, start, row), WISPLAB_OK);
    cr_assert_eq(wisplab_linearise(w, WISPLAB_SPD, 0.1, s.q, s.v), WISPLAB_OK);
    cr_assert_eq(wisplab_dense(w, 1, -1e-3, -1e-6, dense), WISPLAB_OK);
    cr_assert_eq(wisplab_sparse(w, 1, -1e-3, -1e-6, values), WISPLAB_OK);
    cr_assert_eq(wisplab_product(w, 1, -1e-3, -1e-6, x, b), WISPLAB_OK);
    cr_assert_eq(wisplab_factor(w, 1e-3, 1e-6), WISPLAB_OK);
    cr_assert_eq(wisplab_solve(w, b, y), WISPLAB_OK);
    double most = 0, sum, scale;
    for (size_t i = 0; i < n; i++) {
        sum = 0, scale = 0;
        for (size_t j = 0; j < n; j++) {
            sum += dense[j * n + i] * x[j];
            scale += fabs(dense[j * n + i] * x[j]);
            cr_assert(dense[j * n + i] == 0 || i / (n / 2) == j / (n / 2), "wisps are coupled");
        }
        cr_assert(fabs(sum - b[i]) <= 1e-13 * scale, "row %zu of the product is %g off", i,
                  sum - b[i]);
        most = fmax(most, fabs(y[i] - x[i]));
    }
    cr_assert(most < 1e-6, "the solution is %g off", most);
    for (size_t j = 0; j < n; j++)
        for (int k = start[j]; k < start[j + 1]; k++) {
            double *entry = &dense[j * n + (size_t)row[k]];
            cr_assert(*entry == values[k] && (k == start[j] || row[k] > row[k - 1]));
            *entry = 0;
        }
    for (size_t i = 0; i < n * n; i++)
        cr_assert_eq(dense[i], 0, "an entry is not in the pattern");
    cr_assert_eq(start[n], entries);
    cr_assert_eq(wisplab_mass_solve(w, 0.1, s.q, s.v, x, y), WISPLAB_OK);
    cr_assert_eq(wisplab_product(w, 1, 0, 0, y, b), WISPLAB_OK);
    for (size_t i = 0; i < n; i++)
        cr_assert_float_eq(b[i], x[i], 1e-12, "M M^-1 x is %g off", b[i] - x[i]);
    wisplab_close(w);
}

/* --- what is refused --- */

Test(library, what_is_wrong_is_refused_with_a_text) {
    static const struct {
        const char *text, *says;
    } texts[] = {{"problem = \"circle\"; duration = 1.0;\nseed = true;\n", "folder/a.cfg:2"},
                 {"problem = \"circle\"; duration = -1.0;\n", "folder/a.cfg:1: duration"},
                 {"problem = \"circle\"; duration = 1.0;\n@include \"b.inc\"\n", "folder/a.cfg:2"},
                 {"", "duration"}};
    char error[400];
    wisplab *w;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cr_assert_eq(
            wisplab_open_text(&w, texts[i].text, "folder/a.cfg", NULL, NULL, error, sizeof error),
            WISPLAB_REFUSED);
        cr_assert(!w && strstr(error, texts[i].says), "'%s' is not about %s", error, texts[i].says);
    }
    cr_assert_eq(wisplab_open(&w, "swing", NULL, "none", error, 10), WISPLAB_REFUSED);
    cr_assert_eq(strlen(error), 9, "what does not fit is cut off");
    cr_assert_eq(wisplab_open(&w, "nowhere", NULL, NULL, NULL, 0), WISPLAB_REFUSED);

    static const char *const none[] = {"a=1", NULL}, *const four[] = {"lanes=4", NULL};
    static const struct {
        struct wisplab_method method;
        double to;
        const char *says;
    } methods[] = {{{.stepper = "none"}, 1, "none"},
                   {{.stepper = "rk4", .rtol = 1}, 1, "rtol"},
                   {{.stepper = "rk4", .linear = "klu"}, 1, "linear"},
                   {{.stepper = "rk4", .options = none}, 1, "option"},
                   {{.stepper = "cvode", .options = four}, 1, "lanes"},
                   {{.stepper = "rk4"}, 0, "beyond"},
                   {{.stepper = "rk4", .step = 1e-300}, 1, "1e15 steps"}};
    w = open_scene("swing", NULL, NULL);
    struct state s = state_of_handle(w);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        cr_assert_eq(wisplab_run(w, &methods[i].method, methods[i].to), WISPLAB_REFUSED, "%zu", i);
        cr_assert(strstr(wisplab_error(w), methods[i].says), "%zu: %s", i, wisplab_error(w));
    }
    struct state after = state_of_handle(w);
    cr_assert(after.t == s.t && memcmp(after.q, s.q, (size_t)s.n * sizeof *s.q) == 0);
    const struct wisplab_method wild = {.stepper = "euler", .step = 0.05};
    cr_assert_eq(wisplab_run(w, &wild, 1), WISPLAB_FAILED);
    cr_assert(strstr(wisplab_error(w), "diverged") || strstr(wisplab_error(w), "not finite"), "%s",
              wisplab_error(w));
    cr_assert_eq(wisplab_product(w, 1, 0, 0, s.q, s.v), WISPLAB_REFUSED, "nothing is linearised");
    wisplab_close(w);
}

/* --- threads --- */

struct job {
    const char *scene, *stepper;
    double to;
    struct state end;
};

static void *work(void *ctx) {
    struct job *job = ctx;
    char error[400];
    wisplab *w;
    if (wisplab_open(&w, job->scene, NULL, NULL, error, sizeof error))
        return NULL;
    const struct wisplab_method method = {.stepper = job->stepper};
    if (!wisplab_run(w, &method, job->to))
        job->end = state_of_handle(w);
    wisplab_close(w);
    return NULL;
}

/* Two handles at once, of unlike scenes and of the same one, have the bits of one after the other.
 */
Test(library, handles_in_two_threads_do_not_see_each_other) {
    static const struct job pairs[][2] = {
        {{"subdivision", "cvode", 0.5, {0}}, {"subdivision", "rk4", 0.4, {0}}},
        {{"swing-envelope", "implicit-euler", 0.5, {0}}, {"swing", "reference", 0.2, {0}}},
        {{"interactions", "bdf", 0.4, {0}}, {"interactions", "bdf", 0.4, {0}}}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        struct job together[2], alone[2];
        pthread_t thread[2];
        memcpy(together, pairs[i], sizeof together);
        memcpy(alone, pairs[i], sizeof alone);
        for (int k = 0; k < 2; k++)
            cr_assert_eq(pthread_create(&thread[k], NULL, work, &together[k]), 0);
        for (int k = 0; k < 2; k++)
            pthread_join(thread[k], NULL);
        for (int k = 0; k < 2; k++) {
            work(&alone[k]);
            const struct state *a = &alone[k].end, *b = &together[k].end;
            cr_assert(a->n > 0 && a->n == b->n && a->t == b->t, "pair %zu", i);
            cr_assert_eq(memcmp(a->q, b->q, (size_t)a->n * sizeof *a->q), 0, "pair %zu", i);
            cr_assert_eq(memcmp(a->v, b->v, (size_t)a->n * sizeof *a->v), 0, "pair %zu", i);
        }
    }
}

/* --- installed --- */

/* Sanitizers have to be in the whole program. */
static void skip_with_sanitizers(void) {
    if (*WISPLAB_SANITIZERS)
        skip_test("other people's programs, which have no sanitizer in them");
}

Test(library, others_compile_against_the_installed_one) {
    static const char *const ways[] = {
        "cc -std=c99 -Wall -Wextra -Wpedantic -Werror -o program program.c "
        "-Wl,-rpath,%1$s/lib $(PKG_CONFIG_PATH=%1$s/lib/pkgconfig pkg-config --cflags --libs "
        "wisplab) -lm",
        WISPLAB_CMAKE " -S . -B build -D CMAKE_PREFIX_PATH=%1$s && " WISPLAB_CMAKE
                      " --build build && mv build/program ."};
    skip_with_sanitizers();
    const char *const folder = folder_make(), *const built = folder_make(),
                      *const prefix = printed("%s/moved", built);
    SHELL("%s --install %s --prefix %s/first && mv %s/first %s", WISPLAB_CMAKE, WISPLAB_BUILD_DIR,
          built, built, prefix);
    SHELL("cp %s/library/program.c %s/library/CMakeLists.txt %s", WISPLAB_TESTS_DIR,
          WISPLAB_TESTS_DIR, folder);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        SHELL("cd %s && rm -f program && (%s)", folder, printed(ways[i], prefix));
        cr_assert_str_eq(
            shell("cd %s && ./program %s/share/wisplab/experiments/swing.cfg", folder, prefix)->out,
            "all is well\n");
    }
    SHELL("c++ -x c++ -fsyntax-only -Wall -Wextra -Wpedantic -Werror %s/include/wisplab.h", prefix);
}

/* Others see what the header names, and nothing else. */
Test(library, the_header_names_what_can_be_seen) {
    const char *const seen =
        shell("nm -D --defined-only %s/libwisplab.so | awk '$2 == \"T\" { print $3 }' | "
              "grep -v '^_' | sort",
              WISPLAB_BUILD_DIR)
            ->out;
    const char *const named = shell("sed -nE 's/^WISPLAB_API [^(]*(wisplab_[a-z_]+)[(].*/\\1/p' "
                                    "%s/../src/library/wisplab.h | sort",
                                    WISPLAB_TESTS_DIR)
                                  ->out;
    cr_assert(count_lines(named) > 30);
    cr_assert_str_eq(seen, named);
}

/* --- Python --- */

static void python(const char *test) {
    skip_with_sanitizers();
    const struct finished *f =
        shell("cd %s && WISPLAB_LIBRARY=%s/libwisplab.so PYTHONDONTWRITEBYTECODE=1 timeout 100 "
              "/usr/bin/python3 %s/library/scipy_methods.py %s",
              folder_make(), WISPLAB_BUILD_DIR, WISPLAB_TESTS_DIR, test);
    if (f->code == 127 || f->code == 77)
        skip_test("SciPy's methods, without Debian's python3-scipy");
    cr_assert_eq(f->code, 0, "%s", f->out);
}

Test(library, scipy_integrates_swing) {
    python("smooth");
}

Test(library, scipy_integrates_from_tick_to_tick) {
    python("contacts");
}

Test(library, matrices_are_numpys_and_scipys) {
    python("matrices");
}

/* README's pieces of Python, each as it stands. */
Test(library, readmes_python_runs) {
    python("readme");
}

Test(library, what_python_writes_is_a_file_of_states) {
    python("trajectories");
}

/* What C would crash at, or take for something else. */
Test(library, texts_that_are_none_are_exceptions_in_python) {
    python("wrong_texts");
}

Test(library, numbers_that_are_none_are_exceptions_in_python) {
    python("wrong_numbers");
}

Test(library, a_scene_that_is_closed_or_at_work_is_an_exception_in_python) {
    python("closed");
}

Test(library, python_writes_no_file_that_is_refused) {
    python("written");
}
