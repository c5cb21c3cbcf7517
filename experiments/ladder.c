/* Where do the curves cross? What it costs each method to be a millimetre from the truth, along
 * stretch stiffness and damping: explicit methods pay for stability with steps that shrink as
 * 1/sqrt(stiffness), implicit ones for accuracy and for solves, whatever the stiffness.
 *
 * In each cell, a stiffness and a damping, each method gets the largest setting that reaches the
 * target: from coarse to fine until one does, then between it and the last that did not, by halves.
 * The runs that are next depend on those before; refine() names them, round by round. */
#include "base/files.h"
#include "experiments/common/search.h"
#include "experiments/common/statements.h"
#include "model/model.h"
#include "model/problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double target = 1e-3; /* m, rms over the free nodes and all frames */
static const double stiffnesses[] = {15, 90, 1500, 16800}; /* EA, N; the last is real hair's */
static const double dampings[] = {0.02, 0.1, 0.5};         /* of the highest stretch mode */
enum {
    STIFFNESSES = sizeof stiffnesses / sizeof *stiffnesses,
    DAMPINGS = sizeof dampings / sizeof *dampings,
    CELLS = STIFFNESSES * DAMPINGS,
};

/* A stride leads to the next rung of the first descent: an octave of steps, a decade of
 * tolerances. */
enum { STEPS_STRIDE = 16, TOLERANCES_STRIDE = 8, JITTERED = 9, JITTERED_QUICK = 3 };

/* What a search waits for: a run at a place, more that confirm it, the timing of the best. */
enum phase { TRYING, CONFIRMING, TIMING, DONE };

/* The search of one contestant in one cell. */
struct search {
    const struct configuration *contestant;
    int cell;
    enum phase phase;
    struct bracket place;
    double first_error;          /* of the first run of a place, while others confirm it */
    int first, count;            /* its runs in the plan */
    double missed_error, error;  /* there, m; of adaptive methods the worst of the jittered runs */
    enum outcome missed_outcome; /* of the run that missed */
    double missed_time;          /* of a failure: when, s */
    struct cost cost;            /* of the timed run */
    int refused;                 /* it cannot run here; the note says why */
    char note[REASON_SIZE];
};

/* The plan's memo. */
struct ladder {
    int count;
    struct search search[]; /* at most one for each cell and contestant */
};

static double damping_of(int cell) {
    return dampings[cell / STIFFNESSES];
}

static double stiffness_of(int cell) {
    return stiffnesses[cell % STIFFNESSES];
}

/* --quick leaves out real hair, which is the dearest, and all dampings but the middle one. */
static int is_in(const struct plan *plan, int cell) {
    return !plan->quick || (cell / STIFFNESSES == 1 && cell % STIFFNESSES < 3);
}

static void name_cell(char *name, size_t size, int cell) {
    snprintf(name, size, "EA %g N, zeta %g", stiffness_of(cell), damping_of(cell));
}

/* --- settings --- */

static int stride_of(const struct configuration *contestant) {
    return contestant_is_adaptive(contestant) ? TOLERANCES_STRIDE : STEPS_STRIDE;
}

/* How close the two sides of the bracket must come: 4 % of a step, a third of a tolerance; with
 * --quick a fifth and three quarters. */
static int resolution(const struct plan *plan, const struct configuration *contestant) {
    return !plan->quick ? 1 : contestant_is_adaptive(contestant) ? 2 : 4;
}

/* The step, s, which divides the time between frames, or the tolerance. */
static double setting_at(const struct scene *scene, const struct configuration *contestant,
                         int place) {
    if (contestant_is_adaptive(contestant))
        return pow(10, -1 - (double)place / TOLERANCES_STRIDE);
    return place_step(1 / scene->frame_rate, STEPS_STRIDE, place);
}

/* Whether a place is finer than is worth trying, and why in the search's note. */
static int is_beyond(struct search *s, const struct scene *scene) {
    const double setting = setting_at(scene, s->contestant, s->place.at), longest = 1.5;
    const double cost = estimated_cost(scene, WISP_GENERALISED, s->contestant, setting);
    const int adaptive = contestant_is_adaptive(s->contestant);
    const int beyond = adaptive ? setting < 0.99 * s->contestant->finest : cost > longest;
    if (beyond && adaptive)
        snprintf(s->note, sizeof s->note, "tolerances end at %g", s->contestant->finest);
    else if (beyond)
        snprintf(s->note, sizeof s->note, "a run of shorter steps would take more than %g s",
                 longest);
    return beyond;
}

/* Methods begin at the first octave that is less than four times too long by linear theory: it is
 * surely unstable, and longer ones are no news. */
static int first_place(const struct scene *scene, const struct configuration *contestant) {
    int place = 0;
    if (!contestant_is_adaptive(contestant))
        while (!seems_stable(contestant->method, scene, setting_at(scene, contestant, place) / 4))
            place += STEPS_STRIDE;
    return place;
}

/* --- the plan --- */

static struct run_request request_at(const struct scene *scene,
                                     const struct configuration *contestant, double setting) {
    struct run_request request =
        contestant_request(contestant, setting, scene->run.atol / scene->run.rtol);
    request.treatment = wisp_problem.treatments[WISP_GENERALISED].name;
    return request;
}

static int add_run(struct plan *plan, struct search *s, int jitter, int timings) {
    const struct scene *scene = plan->subjects[s->cell].scene;
    const double setting = setting_at(scene, s->contestant, s->place.at) * (1 + 1e-12 * jitter);
    struct run_request request = request_at(scene, s->contestant, setting);
    char cell[64];
    name_cell(cell, sizeof cell, s->cell);
    request.timings = timings;
    s->count++;
    return plan_add(plan, scene, &request, cell, "%s, %s %.4g, j = %d", s->contestant->name,
                    contestant_is_adaptive(s->contestant) ? "rtol" : "step", setting, jitter);
}

/* From here on the search waits for runs that are added next to each other. */
static void await(const struct plan *plan, struct search *s, enum phase phase) {
    s->phase = phase;
    s->first = plan->case_count;
    s->count = 0;
}

static int try_place(struct plan *plan, struct search *s) {
    await(plan, s, TRYING);
    return add_run(plan, s, 0, 0);
}

/* A tolerance that reached the target, again with ones that differ in the twelfth digit: where not
 * all do the tolerance does not, for one adaptive run is a draw from a distribution. */
static int confirm_place(struct plan *plan, struct search *s, double first_error) {
    s->first_error = first_error;
    await(plan, s, CONFIRMING);
    for (int jitter = 1; jitter < (plan->quick ? JITTERED_QUICK : JITTERED); jitter++)
        if (add_run(plan, s, jitter, 0))
            return -1;
    return 0;
}

static int time_place(struct plan *plan, struct search *s) {
    const struct scene *scene = plan->subjects[s->cell].scene;
    const double setting = setting_at(scene, s->contestant, s->place.reached);
    const double cost = estimated_cost(scene, WISP_GENERALISED, s->contestant, setting);
    s->place.at = s->place.reached;
    await(plan, s, TIMING);
    return add_run(plan, s, 0, plan->quick || cost > 0.25 ? 3 : 5);
}

/* The scene of a cell: the one asked for, with another stiffness and damping. */
static int plan_cell(struct plan *plan, const struct subject *subject, int cell,
                     struct subject *to) {
    char rate[64], stiffness[64], damping[64];
    const char *const sets[] = {rate, stiffness, damping};
    snprintf(rate, sizeof rate, "frame_rate=%.17e", subject->scene->frame_rate);
    snprintf(stiffness, sizeof stiffness, "material.stretch_stiffness=%.17e", stiffness_of(cell));
    const struct scene *scene = plan_scene(plan, subject->source, sets, 2);
    if (!scene)
        return -1;
    /* On a mode of frequency w a damper of tau times the spring is zeta = tau w / 2 of critical. */
    snprintf(damping, sizeof damping, "material.stretch_time=%.17e",
             2 * damping_of(cell) / stiffest_mode(scene).frequency);
    scene = plan_scene(plan, subject->source, sets, 3);
    if (!scene)
        return -1;
    *to = (struct subject){.scene = scene, .source = subject->source};
    name_cell(to->name, sizeof to->name, cell);
    return 0;
}

static int plan_cells(struct plan *plan) {
    static const char *const own[] = {"swing"};
    if (plan_subjects(plan, own, 1))
        return -1;
    if (plan->subject_count > 1) {
        snprintf(plan->reason, REASON_SIZE, "experiment ladder is of one scene, not of %d",
                 plan->subject_count);
        return -1;
    }
    const struct subject base = plan->subjects[0];
    struct subject *cells = calloc(CELLS, sizeof *cells);
    if (!cells) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        return -1;
    }
    free(plan->subjects);
    plan->subjects = cells;
    plan->subject_count = CELLS;
    for (int cell = 0; cell < CELLS; cell++)
        if (plan_cell(plan, &base, cell, &cells[cell]))
            return -1;
    return 0;
}

/* A contestant that is refused has a row that says so. */
static int begin_search(struct plan *plan, struct ladder *ladder, int cell,
                        const struct configuration *contestant) {
    const struct scene *scene = plan->subjects[cell].scene;
    const int first = first_place(scene, contestant);
    struct search *s = &ladder->search[ladder->count++];
    *s = (struct search){.contestant = contestant,
                         .cell = cell,
                         .place = bracket_begin(first, first),
                         .missed_error = NAN,
                         .error = NAN,
                         .missed_time = NAN,
                         .cost = no_cost};
    const struct run_request request =
        request_at(scene, contestant, setting_at(scene, contestant, first));
    s->refused = !plan_takes(plan, scene, &request, s->note);
    if (!s->refused && !is_beyond(s, scene))
        return try_place(plan, s);
    plan_refuse(plan, contestant->method, s->note);
    s->phase = DONE;
    return 0;
}

/* The tight solutions are the first runs of the plan, in the order of the cells. */
static int ladder_plan(struct plan *plan) {
    plan->run_seconds = 20;
    if (plan_configurations(plan,
                            CONFIGURATION_PLAIN | CONFIGURATION_ITERATED | CONFIGURATION_SOLVER |
                                CONFIGURATION_SOLVER_ITERATED | CONFIGURATION_ORDER,
                            0))
        return -1;
    const size_t searches = (size_t)(CELLS * plan->configuration_count);
    struct ladder *ladder = plan->memo =
        calloc(1, sizeof *ladder + searches * sizeof *ladder->search);
    if (!ladder) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        return -1;
    }
    if (plan_cells(plan))
        return -1;
    for (int cell = 0; cell < CELLS; cell++) {
        const struct run_request tight = {.stepper = "reference"};
        if (is_in(plan, cell) &&
            plan_add(plan, plan->subjects[cell].scene, &tight, plan->subjects[cell].name, "tight"))
            return -1;
    }
    for (int cell = 0; cell < CELLS; cell++)
        for (int c = 0; c < plan->configuration_count && is_in(plan, cell); c++)
            if (begin_search(plan, ladder, cell, &plan->configurations[c]))
                return -1;
    return 0;
}

/* --- from round to round --- */

/* The next place after one has been judged, or the timing of the best. */
static int go_on(struct plan *plan, struct search *s, int reached) {
    const int more =
        bracket_take(&s->place, reached, stride_of(s->contestant), resolution(plan, s->contestant));
    if (s->place.reached < 0 && is_beyond(s, plan->subjects[s->cell].scene)) {
        s->phase = DONE;
        return 0;
    }
    if (s->place.missed < 0)
        snprintf(s->note, sizeof s->note, "the coarsest that was tried");
    return more ? try_place(plan, s) : time_place(plan, s);
}

static int step_search(struct plan *plan, struct search *s, const struct run_files *tight) {
    struct verdict verdict;
    if (s->phase == TIMING) {
        s->phase = DONE;
        if (read_cost(plan, s->first, &s->cost))
            return -1;
        cost_count(&s->cost, plan->subjects[s->cell].scene, WISP_GENERALISED, s->contestant);
        return 0;
    }
    if (judge_runs(plan, s->first, s->count, plan->subjects[s->cell].scene, tight, &verdict))
        return -1;
    if (s->phase == CONFIRMING && verdict.outcome == FINISHED)
        verdict.error = fmax(verdict.error, s->first_error);
    const int reached = verdict.outcome == FINISHED && verdict.error <= target;
    if (reached && contestant_is_adaptive(s->contestant) && s->phase == TRYING)
        return confirm_place(plan, s, verdict.error);
    if (reached) {
        s->error = verdict.error;
    } else {
        s->missed_error = verdict.error;
        s->missed_outcome = verdict.outcome;
        s->missed_time = verdict.failure_time;
    }
    return go_on(plan, s, reached);
}

/* The searches of a cell; without a truth there is nothing to search for. */
static int refine_cell(struct plan *plan, int cell, const struct run_files *tight) {
    struct ladder *ladder = plan->memo;
    for (int i = 0; i < ladder->count; i++) {
        struct search *s = &ladder->search[i];
        if (s->cell != cell || s->phase == DONE)
            continue;
        if (tight->outcome != FINISHED) {
            s->phase = DONE;
            snprintf(s->note, sizeof s->note, "no tight solution: %s",
                     outcome_name(tight->outcome));
        } else if (step_search(plan, s, tight)) {
            return -1;
        }
    }
    return 0;
}

static int ladder_refine(struct plan *plan) {
    for (int cell = 0, tight_case = 0; cell < CELLS; cell++) {
        struct run_files tight;
        if (!is_in(plan, cell))
            continue;
        if (run_read_states(&tight, plan->cases[tight_case++].run.folder, plan->trajectories,
                            plan->reason))
            return -1;
        const int code = refine_cell(plan, cell, &tight);
        run_free(&tight);
        if (code)
            return -1;
    }
    return 0;
}

/* --- the tables --- */

static double place_setting(const struct plan *plan, const struct search *s, int place) {
    return place < 0 ? NAN : setting_at(plan->subjects[s->cell].scene, s->contestant, place);
}

/* What keeps a method from coarser settings: where it is stability, they fail, or are finite and
 * wrong by orders of magnitude; an error that follows from the order grows by no more than the
 * fourth power of a step that is a few per cent longer. */
static const char *limit_of(const struct search *s) {
    if (s->place.reached < 0 || s->place.missed < 0)
        return "none";
    return s->missed_outcome != FINISHED || s->missed_error > 100 * s->error ? "failure"
                                                                             : "accuracy";
}

static void write_search(FILE *stream, const struct plan *plan, const struct search *s) {
    const double numbers[] = {place_setting(plan, s, s->place.reached),
                              place_setting(plan, s, s->place.missed),
                              s->error,
                              s->missed_error,
                              s->cost.cpu.median,
                              s->cost.cpu.least,
                              s->cost.cpu.greatest,
                              s->cost.evaluations,
                              s->cost.steps};
    fprintf(stream, "%g\t%g\t%s", stiffness_of(s->cell), damping_of(s->cell), s->contestant->name);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        fprintf(stream, "\t%.17g", numbers[i]);
    fprintf(stream, "\t%s\t%s\t%s\t%.17g\t%.17g\t%s\n",
            s->refused              ? outcome_name(REFUSED)
            : s->place.reached >= 0 ? "reached"
                                    : "never",
            limit_of(s), s->place.missed >= 0 ? outcome_name(s->missed_outcome) : "none",
            s->missed_time, s->cost.counted, s->note);
}

/* Rows of a method along the stiffness, of one damping; blocks are parted by two blank lines. */
static int write_ladder(const struct plan *plan, const char *folder, char *reason) {
    const struct ladder *ladder = plan->memo;
    struct atomic_file file;
    char what[768];
    snprintf(
        what, sizeof what,
        "the largest step, s, or rtol that reaches %g m rms over free nodes and all frames "
        "(setting), the next one tried that does not (missed: its error, outcome and time of "
        "failure), and what the first costs: CPU time, s, of repeated runs, force "
        "evaluations, steps; errors of adaptive methods: the worst of %d tolerances "
        "rtol(1 + j 1e-12), of which j = 0 is timed; counted: what the table of costs makes of "
        "the steps, s, by which methods are put in order; limit: failure where the missed one "
        "fails or is 100 times as wrong; nan: there is no number, see status and note%s",
        target, plan->quick ? JITTERED_QUICK : JITTERED,
        plan->quick ? "; --quick: one damping, no real hair, coarser brackets" : "");
    if (open_table(&file, folder, "ladder", what, plan->subjects[0].scene,
                   "stretch_stiffness\tzeta\tmethod\tsetting\tmissed_setting\terror\tmissed_error"
                   "\tcpu_median\tcpu_least\tcpu_greatest\tforce_evaluations\tsteps\tstatus\tlimit"
                   "\tmissed_outcome\tmissed_time\tcounted\tnote",
                   reason))
        return -1;
    for (int d = 0; d < DAMPINGS; d++)
        for (int c = 0; c < plan->configuration_count; c++) {
            for (int i = 0; i < ladder->count; i++)
                if (ladder->search[i].contestant == &plan->configurations[c] &&
                    ladder->search[i].cell / STIFFNESSES == d)
                    write_search(file.stream, plan, &ladder->search[i]);
            fprintf(file.stream, "\n\n");
        }
    return atomic_commit(&file, reason);
}

static const struct search *search_of(const struct ladder *ladder, int cell,
                                      const struct configuration *contestant) {
    for (int i = 0; i < ladder->count; i++)
        if (ladder->search[i].cell == cell && ladder->search[i].contestant == contestant)
            return &ladder->search[i];
    return NULL;
}

static int has_cost(const struct search *s) {
    return s && s->phase == DONE && s->cost.cpu.median > 0;
}

/* Where two costs that are straight lines in logarithms are equal, between two stiffnesses of which
 * `low` is the first; NaN where they keep their order. */
static double crossing(int low, const double a[2], const double b[2]) {
    const double gap = log(a[0] / b[0]), next_gap = log(a[1] / b[1]);
    if (!(gap * next_gap < 0))
        return NAN;
    const double share = gap / (gap - next_gap);
    return stiffnesses[low] * pow(stiffnesses[low + 1] / stiffnesses[low], share);
}

static int is_apart(const struct search *a, const struct search *b) {
    return cost_is_less(&a->cost, &b->cost) || cost_is_less(&b->cost, &a->cost);
}

static void write_crossing(FILE *stream, const struct ladder *ladder, int cell,
                           const struct configuration *one, const struct configuration *other) {
    const struct search *a[2], *b[2];
    double cost_a[2], cost_b[2];
    for (int k = 0; k < 2; k++) {
        a[k] = search_of(ladder, cell + k, one);
        b[k] = search_of(ladder, cell + k, other);
        if (!has_cost(a[k]) || !has_cost(b[k]))
            return;
        cost_a[k] = a[k]->cost.counted;
        cost_b[k] = b[k]->cost.counted;
    }
    const int low = cell % STIFFNESSES, first = cost_a[0] < cost_b[0];
    const double at = crossing(low, cost_a, cost_b);
    if (!isnan(at))
        fprintf(stream, "%g\t%s\t%s\t%g\t%g\t%.17g\t%d\n", damping_of(cell),
                (first ? one : other)->name, (first ? other : one)->name, stiffnesses[low],
                stiffnesses[low + 1], at, is_apart(a[0], b[0]) && is_apart(a[1], b[1]));
}

static int write_crossings(const struct plan *plan, const char *folder, char *reason) {
    struct atomic_file file;
    if (open_table(
            &file, folder, "crossings",
            "pairs of methods of which one is cheaper for the target of ladder at a stiffness, N, "
            "and the other at the next, by steps counted and the table of costs; crossing: where "
            "lines through both, in logarithms, meet; clear: at neither end are the two tied "
            "(within "
            "1.4 times, or repeated times overlap)",
            plan->subjects[0].scene,
            "zeta\tcheaper_below\tcheaper_above\tbelow\tabove\tcrossing\tclear", reason))
        return -1;
    for (int cell = 0; cell < CELLS; cell++)
        for (int a = 0; a < plan->configuration_count && cell % STIFFNESSES < STIFFNESSES - 1; a++)
            for (int b = a + 1; b < plan->configuration_count; b++)
                write_crossing(file.stream, plan->memo, cell, &plan->configurations[a],
                               &plan->configurations[b]);
    return atomic_commit(&file, reason);
}

/* --- the answer --- */

enum { ALL, EXPLICIT, IMPLICIT };
static int is_of(const struct search *s, int kind) {
    const struct stepper_method *method = s->contestant->method;
    return kind == ALL || ((method->capabilities & STEPPER_IMPLICIT) != 0) == (kind == IMPLICIT);
}

static int was_asked(const struct ladder *ladder, int kind) {
    for (int i = 0; i < ladder->count; i++)
        if (is_of(&ladder->search[i], kind))
            return 1;
    return 0;
}

/* The cheapest search of a cell, of all, of explicit methods or of implicit ones, besides one; or
 * NULL. */
static const struct search *cheapest(const struct ladder *ladder, int cell, int kind,
                                     const struct search *besides) {
    const struct search *best = NULL;
    for (int i = 0; i < ladder->count; i++) {
        const struct search *s = &ladder->search[i];
        if (s->cell == cell && is_of(s, kind) && s != besides && has_cost(s) &&
            (!best || s->cost.counted < best->cost.counted))
            best = s;
    }
    return best;
}

static double least_cost(const struct ladder *ladder, int cell, int kind) {
    const struct search *s = cheapest(ladder, cell, kind, NULL);
    return s ? s->cost.counted : NAN;
}

/* Where the cheapest explicit and the cheapest implicit method of a damping change places: one
 * crossing, or none because one kind is ahead everywhere. */
static void state_order(struct statements *statements, const struct ladder *ladder, int damping) {
    int explicit_first = 0, implicit_first = 0, tied = 0;
    char key[64];
    struct statement row = {
        .key = key, .figure = "ladder", .tables = "ladder crossings", .unit = "N"};
    for (int k = 0; k < STIFFNESSES; k++) {
        const int cell = damping * STIFFNESSES + k, next = k + 1 < STIFFNESSES ? cell + 1 : cell;
        const double explicits[2] = {least_cost(ladder, cell, EXPLICIT),
                                     least_cost(ladder, next, EXPLICIT)},
                     implicits[2] = {least_cost(ladder, cell, IMPLICIT),
                                     least_cost(ladder, next, IMPLICIT)};
        const struct search *one = cheapest(ladder, cell, EXPLICIT, NULL),
                            *other = cheapest(ladder, cell, IMPLICIT, NULL);
        if (one && other) {
            explicit_first += cost_is_less(&one->cost, &other->cost);
            implicit_first += cost_is_less(&other->cost, &one->cost);
            tied += !is_apart(one, other);
        }
        row.value = next > cell ? crossing(k, explicits, implicits) : NAN;
        snprintf(key, sizeof key, "order, zeta %g, %d", dampings[damping], k);
        if (!isnan(row.value))
            statements_add(statements, row,
                           "At damping %g the best explicit and the best implicit method cost the "
                           "same at EA = %.2g N.",
                           dampings[damping], row.value);
    }
    if (explicit_first > 0 && implicit_first > 0)
        return;
    snprintf(key, sizeof key, "order, zeta %g", dampings[damping]);
    row.unit = NULL;
    row.verdict = explicit_first + implicit_first + tied > 0                   ? HOLDS
                  : was_asked(ladder, EXPLICIT) && was_asked(ladder, IMPLICIT) ? NOT_REACHED
                                                                               : NOT_ASKED;
    if (row.verdict == HOLDS && explicit_first + implicit_first == 0)
        statements_add(statements, row,
                       "At damping %g explicit and implicit methods are tied at every stiffness "
                       "tried.",
                       dampings[damping]);
    else if (row.verdict == HOLDS)
        statements_add(statements, row,
                       "At damping %g %s methods are cheaper at every stiffness tried%s.",
                       dampings[damping], explicit_first ? "explicit" : "implicit",
                       tied ? " at which the two are not tied" : "");
    else
        statements_add(statements, row,
                       "At damping %g explicit and implicit methods cannot be compared: %s.",
                       dampings[damping],
                       row.verdict == NOT_ASKED ? "one kind was left out"
                                                : "at no stiffness both reach a millimetre");
}

/* The methods of a cell that are not known to be dearer than the cheapest: " and rk4 (0.5 ms)". */
static void list_tied(const struct ladder *ladder, const struct search *best, char text[512]) {
    text[0] = '\0';
    for (int i = 0; i < ladder->count; i++) {
        const struct search *s = &ladder->search[i];
        const size_t used = strlen(text);
        if (s != best && s->cell == best->cell && has_cost(s) && !is_apart(best, s))
            snprintf(text + used, 512 - used, " and %s (%.3g ms)", s->contestant->name,
                     1e3 * s->cost.cpu.median);
    }
}

/* The cheapest method of a cell, with those that it is tied with, or the next. */
static void state_cell(struct statements *statements, const struct plan *plan, int cell) {
    const struct search *best = cheapest(plan->memo, cell, ALL, NULL);
    const struct search *next = best ? cheapest(plan->memo, cell, ALL, best) : NULL;
    char key[64], tied[512] = "", runner_up[128] = "";
    name_cell(key, sizeof key, cell);
    struct statement row = {.key = key, .figure = "ladder", .tables = "ladder", .unit = "ms"};
    row.value = best ? 1e3 * best->cost.cpu.median : NAN;
    row.verdict = best ? HOLDS : NOT_REACHED;
    if (best)
        list_tied(plan->memo, best, tied);
    if (next)
        snprintf(runner_up, sizeof runner_up, "; next is %s, %.3g ms", next->contestant->name,
                 1e3 * next->cost.cpu.median);
    if (tied[0])
        statements_add(statements, row,
                       "At EA = %g N and damping %g a millimetre is cheapest with %s (%.3g ms)%s, "
                       "whose costs are too close to part them.",
                       stiffness_of(cell), damping_of(cell), best->contestant->name, row.value,
                       tied);
    else if (best)
        statements_add(statements, row,
                       "At EA = %g N and damping %g a millimetre is cheapest with %s at %s %.3g: "
                       "%.3g ms%s.",
                       stiffness_of(cell), damping_of(cell), best->contestant->name,
                       contestant_is_adaptive(best->contestant) ? "rtol" : "h =",
                       place_setting(plan, best, best->place.reached), row.value, runner_up);
    else
        statements_add(statements, row,
                       "At EA = %g N and damping %g no method reaches a millimetre.",
                       stiffness_of(cell), damping_of(cell));
}

static void state_answer(struct statements *statements, const struct plan *plan) {
    for (int cell = 0; cell < CELLS; cell++)
        if (is_in(plan, cell))
            state_cell(statements, plan, cell);
    for (int damping = 0; damping < DAMPINGS; damping++)
        if (is_in(plan, damping * STIFFNESSES))
            state_order(statements, plan->memo, damping);
    if (plan->quick)
        statements_add(
            statements,
            (struct statement){.key = "left out", .figure = "ladder", .verdict = NOT_REACHED},
            "Real hair (16800 N) and the dampings 0.02 and 0.5 are left out of --quick.");
}

static int ladder_tabulate(struct plan *plan, const char *folder) {
    struct statements statements;
    if (statements_open(&statements, folder, plan->subjects[0].scene,
                        plan->quick ? "--quick: coarser brackets" : NULL, plan->reason))
        return -1;
    const int code =
        write_ladder(plan, folder, plan->reason) || write_crossings(plan, folder, plan->reason) ? -1
                                                                                                : 0;
    if (!code)
        state_answer(&statements, plan);
    return statements_close(&statements, code, plan->reason);
}

const struct experiment ladder_experiment = {
    .name = "ladder",
    .question = "which stepper is cheapest for a millimetre, by stiffness and damping?",
    .place = 6,
    .quick_seconds = 8,
    .full_seconds = 130,
    .plan = ladder_plan,
    .refine = ladder_refine,
    .tabulate = ladder_tabulate,
};
