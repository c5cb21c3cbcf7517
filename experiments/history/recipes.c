/* The recipes of their times on the hair of `swing`: how far each is from its motion, for what
 * cost, and how that looks. */
#include "history.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double millimetre = 1e-3;
static const char what[] =
    "recipes of their times on the hair of swing. error: rms over free nodes and frames from the "
    "reference solution of swing, m; own: 1 at the rate that its authors chose, of today's the "
    "cheapest within 1 mm; cost: of the simulated second, CPU s; nan: of a run that failed there "
    "is no error, of another no time at which it did";

/* --- the runs --- */

static double rate_of(const struct era *era, int level) {
    return ldexp(era->coarsest, level);
}

/* With --quick every other level, among them the authors' own, and today's all. */
static int is_run(const struct plan *plan, const struct era *era, int level) {
    if (!plan->quick || era->own < 0)
        return 1;
    return (level - era->own) % 2 == 0 &&
           (era->longest_run == 0 || rate_of(era, level) <= era->longest_run);
}

static int plan_era(struct plan *plan, const struct era *era) {
    const struct scene *scene = plan_scene(plan, era->scene, NULL, 0);
    const struct run_request reference = {.stepper = "reference"};
    if (!scene || plan_add(plan, scene, &reference, era->name, "reference"))
        return -1;
    for (int level = 0; level < era->levels; level++) {
        const struct run_request request = {.stepper = era->stepper,
                                            .treatment = era->treatment,
                                            .linear = era->linear,
                                            .step = 1 / rate_of(era, level),
                                            .timings =
                                                plan->quick || rate_of(era, level) > 1e6 ? 1 : 3};
        if (is_run(plan, era, level) && plan_add(plan, scene, &request, era->name, "%d", level))
            return -1;
    }
    return 0;
}

int recipes_plan(struct plan *plan) {
    const char *const hinges[] = {"material={bending=\"hinge\";}"};
    const struct run_request reference = {.stepper = "reference"};
    for (int e = 0; e < ERAS; e++)
        if (plan_era(plan, &eras[e]))
            return -1;
    const struct scene *scene = plan_scene(plan, yardstick_scene, hinges, 1);
    return scene ? plan_add(plan, scene, &reference, "hinges", "reference") : -1;
}

/* --- reading them --- */

struct point {
    const struct labelled_case *one; /* NULL: it was not run */
    double error;                    /* m; NaN: it failed */
    struct cost cost;
};

enum { LEVELS_MOST = 32 }; /* more than any of the eras has */

struct result {
    const struct era *era;
    double apart; /* of the problem's own exact motion from swing's, m */
    struct point points[LEVELS_MOST];
    int own;        /* level; or -1: there is none within a millimetre */
    int first_near; /* the coarsest level within a millimetre, or -1 */
    int first_fine; /* the coarsest that did not fail, or -1 */
};

static int read_point(struct plan *plan, const struct era *era, int level,
                      const struct run_files *truth, struct point *point) {
    struct run_files run;
    *point = (struct point){find_case(plan, era->name, "%d", level), NAN, no_cost};
    if (!point->one)
        return 0;
    if (read_compared(plan, point->one, truth, &run, &point->error))
        return -1;
    point->cost = run_cost(&run);
    if (strcmp(era->scene, yardstick_scene) == 0) {
        const struct configuration usual =
            configuration_of(stepper_find(point->one->run.settings.method->name));
        cost_count(&point->cost, point->one->run.scene, WISP_GENERALISED, &usual);
    }
    run_free(&run);
    return 0;
}

static int read_result(struct plan *plan, const struct era *era, const struct run_files *truth,
                       struct result *result) {
    struct run_files reference;
    *result = (struct result){.era = era, .own = era->own, .first_near = -1, .first_fine = -1};
    int code = read_compared(plan, find_case(plan, era->name, "reference"), truth, &reference,
                             &result->apart);
    if (code)
        return code;
    run_free(&reference);
    for (int level = era->levels - 1; level >= 0 && !code; level--) {
        struct point *point = &result->points[level];
        code = read_point(plan, era, level, truth, point);
        if (point->one && !isnan(point->error))
            result->first_fine = level;
        if (point->one && point->error <= millimetre)
            result->first_near = level;
    }
    if (era->own < 0)
        result->own = result->first_near;
    return code;
}

/* --- tables --- */

#define ERA_COLUMNS(X, era)                                           \
    X("method", "-", "the recipe: who and when", "%s", (era)->name)   \
    X("scene", "-", "the problem that it solves", "%s", (era)->scene) \
    X("stepper", "-", "stepper of the recipe", "%s", (era)->stepper)

#define POINT_COLUMNS(X)                                                                        \
    ERA_COLUMNS(X, result->era)                                                                 \
    X("rate", "Hz", "steps in a second", "%.17g", rate_of(result->era, level))                  \
    X("own", "1", "1 at the rate that its authors chose", "%d", level == result->own)           \
    STATUS_COLUMNS(X, &p->cost)                                                                 \
    X("error", "m",                                                                             \
      "distance from the reference solution of swing, rms over free nodes and frames", "%.17g", \
      p->error)                                                                                 \
    X("evaluations", "1", "evaluations of the forces in the run", "%.17g", p->cost.evaluations) \
    STEPS_COLUMN(X, &p->cost)                                                                   \
    CPU_COLUMNS(X, &p->cost)

static void write_points(FILE *stream, const struct result *result) {
    for (int level = 0; level < result->era->levels; level++) {
        const struct point *p = &result->points[level];
        if (p->one)
            WRITE_ROW(stream, POINT_COLUMNS);
    }
}

/* The frames that a film shows, of 30 a second. */
static const int film[] = {0, 3, 5, 7, 9, 12, 16, 22, 30};
enum { FILM = sizeof film / sizeof *film };

#define FILM_COLUMNS(X)                                            \
    X("method", "-", "the recipe: who and when", "%s", name)       \
    X("panel", "1", "number of the panel", "%d", k)                \
    X("t", "s", "time", "%.17g", x[STATE_T])                       \
    X("node", "1", "number of the node", "%d", (int)x[STATE_NODE]) \
    X("x", "m", "position", "%.17g", x[STATE_X])                   \
    X("y", "m", "position", "%.17g", x[STATE_X + 1])

static void write_film(FILE *stream, const char *name, const struct trajectory *states) {
    for (int k = 0; k < FILM && film[k] < states->frame_count; k++)
        for (int row = states->frames[film[k]].row; row < trajectory_end(states, film[k]); row++) {
            const double *x = trajectory_row(states, row);
            WRITE_ROW(stream, FILM_COLUMNS);
        }
}

static int write_films(struct plan *plan, const struct result *results,
                       const struct run_files *truth) {
    FILE *stream =
        output_table(&plan->output, "film",
                     "frames of the hair of swing by each recipe as its authors ran it, and by the "
                     "reference solution (exact); a run that failed has frames up to then; m",
                     NULL, COLUMNS(FILM_COLUMNS));
    if (!stream)
        return -1;
    write_film(stream, "exact", truth->states);
    for (int e = 0; e < ERAS; e++) {
        struct run_files run;
        if (results[e].own < 0)
            continue;
        if (plan_read(plan, results[e].points[results[e].own].one, &run))
            return -1;
        write_film(stream, eras[e].name, run.states);
        run_free(&run);
    }
    return 0;
}

/* A rate of the recipe's, Hz; NaN: there is none. */
static double rate_or_none(const struct result *r, int level) {
    return level < 0 ? (double)NAN : rate_of(r->era, level);
}

#define OWN_COLUMNS(X)                                                                             \
    ERA_COLUMNS(X, r->era)                                                                         \
    X("rate", "Hz", "steps in a second", "%.17g", rate_or_none(r, r->own))                         \
    STATUS_COLUMNS(X, &own->cost)                                                                  \
    X("error", "m",                                                                                \
      "distance from the reference solution of swing, rms over free nodes and frames", "%.17g",    \
      own->error)                                                                                  \
    X("cpu_median", "s", "CPU time of a run, median of repeated runs", "%.17g",                    \
      own->cost.cpu.median)                                                                        \
    X("apart", "m", "distance of its problem's own exact motion from that of swing, rms", "%.17g", \
      r->apart)                                                                                    \
    X("stable_rate", "Hz", "least rate at which it is stable", "%.17g",                            \
      rate_or_none(r, r->first_fine))                                                              \
    X("millimetre_rate", "Hz", "least rate that is within 1 mm", "%.17g",                          \
      rate_or_none(r, r->first_near))                                                              \
    X("note", "-", "why there is no number", "%s",                                                 \
      r->first_fine < 0   ? "no rate that was tried is stable"                                     \
      : r->first_near < 0 ? "no rate that was tried is within 1 mm"                                \
                          : "")

static int write_eras(struct plan *plan, const struct result *results) {
    FILE *stream =
        output_table(&plan->output, "eras",
                     "each recipe as its authors ran it. apart: rms distance of its problem's own "
                     "exact motion from that of swing, m (0: it is that problem); rates: the least "
                     "stable one and the least within 1 mm, Hz; nan: of rates none reached that, "
                     "of times it did not fail, of errors it did",
                     NULL, COLUMNS(OWN_COLUMNS));
    for (int e = 0; e < ERAS && stream; e++) {
        const struct result *r = &results[e];
        const struct point none = {NULL, NAN, no_cost};
        const struct point *own = r->own < 0 ? &none : &r->points[r->own];
        WRITE_ROW(stream, OWN_COLUMNS);
    }
    return stream ? 0 : -1;
}

/* --- sentences --- */

/* A rate as one says it. */
static const char *hertz(double rate, char text[32]) {
    snprintf(text, 32, rate < 1e5 ? "%.5g Hz" : "%.3g MHz", rate < 1e5 ? rate : rate / 1e6);
    return text;
}

/* What the recipe as its authors ran it does. */
static void say_own(const struct result *r, char text[160]) {
    const struct point *own = &r->points[r->own];
    char rate[32];
    hertz(rate_of(r->era, r->own), rate);
    if (isnan(own->error))
        snprintf(text, 160, "fails at %s after %.2g s", rate, own->cost.failure_time);
    else
        snprintf(text, 160, "is %.3g mm from the motion of swing at %s", 1e3 * own->error, rate);
}

/* What the rates tell of what it takes to be near. */
static void say_near(const struct result *r, const struct plan *plan, char text[200]) {
    char rate[32];
    if (r->first_near >= 0)
        snprintf(text, 200, "it needs %s for 1 mm", hertz(rate_of(r->era, r->first_near), rate));
    else if (r->first_fine >= 0)
        snprintf(text, 200,
                 "no rate brings it nearer, for its own exact motion, which it has from %s on, is "
                 "%.3g mm away",
                 hertz(rate_of(r->era, r->first_fine), rate), 1e3 * r->apart);
    else
        snprintf(text, 200,
                 "it does so at every rate up to %s%s; its own exact motion is %.3g mm from that "
                 "of swing",
                 hertz(plan->quick && r->era->longest_run > 0 ? r->era->longest_run
                                                              : rate_of(r->era, r->era->levels - 1),
                       rate),
                 plan->quick ? " that --quick tries" : "", 1e3 * r->apart);
}

static void state_era(struct statements *statements, const struct plan *plan,
                      const struct result *r) {
    struct statement row =
        our_row("recipes", "recipes eras", NOT_REACHED, NAN, "mm", "%s", r->era->name);
    char own[160], near[200];
    if (r->own < 0) {
        statements_add(statements, row, "No rate of %s comes within 1 mm of the motion of swing.",
                       r->era->stepper);
        return;
    }
    row.value = 1e3 * r->points[r->own].error;
    row.verdict = HOLDS;
    say_own(r, own);
    say_near(r, plan, near);
    if (r->era->own < 0)
        snprintf(near, sizeof near, "it takes %.3g evaluations",
                 r->points[r->own].cost.evaluations);
    statements_add(statements, row, "The recipe of %s (%s) %s, and %s.", r->era->name,
                   r->era->stepper, own, near);
}

/* Today's against the thesis's at a millimetre, by what is counted. */
static void state_gain(struct statements *statements, const struct result *then,
                       const struct result *now) {
    struct statement row =
        our_row("recipes", "recipes", NOT_REACHED, NAN, "1", "today against 1999");
    if (then->first_near < 0 || now->first_near < 0) {
        statements_add(statements, row,
                       "Not both recipes come within 1 mm of the motion of swing.");
        return;
    }
    const struct point *a = &then->points[then->first_near], *b = &now->points[now->first_near];
    row.value = a->cost.counted / b->cost.counted;
    row.verdict = holds_if(cost_is_less(&b->cost, &a->cost));
    statements_add(statements, row,
                   "For 1 mm today's recipe takes %.0f steps where the thesis's takes %.0f, and by "
                   "what is counted it is %.2g times cheaper.",
                   b->cost.steps, a->cost.steps, row.value);
}

/* Rosenblum's hinges bend hair at any angle, skip springs only what is bent. */
static int state_bending(struct plan *plan, struct statements *statements, double apart) {
    struct run_files hinges, theirs;
    double with_hinges;
    int code = read_reference(plan, find_case(plan, "hinges", "reference"), &hinges);
    if (code)
        return code;
    code = read_compared(plan, find_case(plan, eras[0].name, "reference"), &hinges, &theirs,
                         &with_hinges);
    run_free(&hinges);
    if (code)
        return code;
    run_free(&theirs);
    statements_add(statements,
                   our_row("recipes", "eras", holds_if(with_hinges < 0.2 * apart),
                           1e3 * with_hinges, "mm", "law of bending"),
                   "Rosenblum's own motion is %.3g mm from that of swing, which has skip springs, "
                   "and %.2g mm from swing's with hinges, which are its own law of bending.",
                   1e3 * apart, 1e3 * with_hinges);
    return 0;
}

static void state_film(struct statements *statements, const struct result *results) {
    int good = 0;
    char list[200] = "";
    for (int e = 0; e < ERAS; e++) {
        if (results[e].own < 0 || !(results[e].points[results[e].own].error <= 0.01))
            continue;
        list_add(list, sizeof list, "%s", eras[e].name);
        good++;
    }
    statements_add(
        statements, our_row("film", "film eras", HOLDS, good, "1", "film"),
        "Of %d recipes as their authors ran them %d stay within 1 cm of the motion of swing (%s).",
        ERAS, good, good ? list : "none");
}

/* --- all --- */

static int tabulate(struct plan *plan, struct result *results, const struct run_files *truth) {
    struct statements *statements = &plan->output.statements;
    int code = 0;
    for (int e = 0; e < ERAS && !code; e++)
        code = read_result(plan, &eras[e], truth, &results[e]);
    if (code)
        return code;
    FILE *stream = output_table(&plan->output, "recipes", what, NULL, COLUMNS(POINT_COLUMNS));
    for (int e = 0; e < ERAS && stream; e++)
        write_points(stream, &results[e]);
    if (!stream || write_eras(plan, results) || write_films(plan, results, truth))
        return -1;
    for (int e = 0; e < ERAS; e++)
        state_era(statements, plan, &results[e]);
    state_gain(statements, &results[ERAS - 2], &results[ERAS - 1]);
    state_film(statements, results);
    return state_bending(plan, statements, results[0].apart);
}

int recipes_tabulate(struct plan *plan) {
    struct run_files truth;
    struct result *results = calloc(ERAS, sizeof *results);
    if (!results)
        return fail_with(plan->reason, "out of memory");
    int code = read_reference(plan, find_case(plan, eras[ERAS - 1].name, "reference"), &truth);
    if (!code) {
        code = tabulate(plan, results, &truth);
        run_free(&truth);
    }
    free(results);
    return code;
}
