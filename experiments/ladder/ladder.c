/* Where do the curves cross? What it costs each method to be a millimetre from the truth, along
 * stretch stiffness, for several kinds of hair: explicit methods pay for stability with steps that
 * shrink as 1/sqrt(stiffness), or where damping grows with it as its inverse; implicit ones for
 * accuracy and for solves, whatever the stiffness, as long as their matrix has what is stiff.
 *
 * In each cell, a kind of hair and a stiffness, each method gets the largest setting that reaches
 * the target: from coarse to fine until one does, then between it and the last that did not, by
 * halves. The runs that are next depend on those before; refine() names them, round by round. */
#include "ladder.h"

#include "model/model.h"
#include "model/problems.h"

#include <math.h>
#include <stdlib.h>

/* A stride leads to the next level of the first descent: an octave of steps, a decade of
 * tolerances. */
enum { STEPS_STRIDE = 16, TOLERANCES_STRIDE = 8 };

/* --- settings --- */

/* The step, s, which divides the time between frames, or the tolerance. */
static double setting_at(const struct scene *scene, const struct configuration *configuration,
                         int place) {
    if (configuration_is_adaptive(configuration))
        return pow(10, -1 - (double)place / TOLERANCES_STRIDE);
    return place_step(1 / scene->frame_rate, STEPS_STRIDE, place);
}

/* Whether a place is finer than is worth trying, and why in the search's note. */
static int is_beyond(struct search *s, const struct scene *scene) {
    const double setting = setting_at(scene, s->configuration, s->place.at), longest = 1;
    const double cost = estimated_cost(scene, WISP_GENERALISED, s->configuration, setting);
    const int adaptive = configuration_is_adaptive(s->configuration);
    const int beyond = adaptive ? setting < 0.99 * s->configuration->finest : cost > longest;
    if (beyond && adaptive)
        snprintf(s->note, sizeof s->note, "tolerances end at %g", s->configuration->finest);
    else if (beyond)
        snprintf(s->note, sizeof s->note, "a run of shorter steps would take more than %g s",
                 longest);
    return beyond;
}

/* Methods begin at the first octave that is less than four times too long by linear theory: it is
 * surely unstable, and longer ones are no news. Of rigid segments that theory knows nothing stiff.
 */
static int first_place(const struct scene *scene, const struct configuration *configuration) {
    int place = 0;
    if (!configuration_is_adaptive(configuration) && stiffest_mode(scene).frequency > 0)
        while (!seems_stable(configuration->method, scene,
                             setting_at(scene, configuration, place) / 4))
            place += STEPS_STRIDE;
    return place;
}

/* --- the plan --- */

static struct run_request request_at(const struct scene *scene,
                                     const struct configuration *configuration, double setting) {
    struct run_request request =
        configuration_request(configuration, setting, scene->run.atol / scene->run.rtol);
    request.treatment = wisp_problem.treatments[WISP_GENERALISED].name;
    return request;
}

static int add_run(struct plan *plan, struct search *s, int jitter, int timings) {
    const struct scene *scene = plan->subjects[s->cell].scene;
    const double setting = setting_at(scene, s->configuration, s->place.at) * (1 + 1e-12 * jitter);
    struct run_request request = request_at(scene, s->configuration, setting);
    request.timings = timings;
    s->count++;
    return plan_add(plan, scene, &request, plan->subjects[s->cell].name, "%s, %s %.4g, j = %d",
                    s->configuration->name,
                    configuration_is_adaptive(s->configuration) ? "rtol" : "step", setting, jitter);
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

/* Reads what the run that the search waited for first has cost. Returns 0, or -1 with plan->reason.
 */
static int read_counted(struct plan *plan, struct search *s) {
    if (read_cost(plan, s->first, &s->cost))
        return -1;
    cost_count(&s->cost, plan->subjects[s->cell].scene, WISP_GENERALISED, s->configuration);
    return 0;
}

/* A run that takes so long, s, is neither confirmed nor timed more than once. */
static int is_costly(const struct search *s) {
    return s->cost.counted > 0.2;
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
    s->place.at = s->place.reached;
    await(plan, s, TIMING);
    return add_run(plan, s, 0, is_costly(s) ? 1 : 3);
}

/* A configuration that is refused has a row that says so. */
static int begin_search(struct plan *plan, struct ladder *ladder, int cell,
                        const struct configuration *configuration) {
    const struct scene *scene = plan->subjects[cell].scene;
    const int first = first_place(scene, configuration);
    struct search *s = &ladder->search[ladder->count++];
    *s = (struct search){.configuration = configuration,
                         .cell = cell,
                         .place = bracket_begin(first, first),
                         .missed_error = NAN,
                         .error = NAN,
                         .missed_time = NAN,
                         .cost = no_cost};
    const struct run_request request =
        request_at(scene, configuration, setting_at(scene, configuration, first));
    s->refused = !plan_takes(plan, scene, &request, s->note);
    if (!s->refused && !is_beyond(s, scene))
        return try_place(plan, s);
    plan_refuse(plan, configuration->method, s->note);
    s->phase = DONE;
    return 0;
}

/* The reference solutions are the first runs of the plan, in the order of the cells. */
static int ladder_plan(struct plan *plan) {
    plan->run_seconds = 20;
    const unsigned kinds = CONFIGURATION_PLAIN | CONFIGURATION_ORDER | CONFIGURATION_MATRIX,
                   more = CONFIGURATION_ITERATED | CONFIGURATION_SOLVER |
                          CONFIGURATION_SOLVER_ITERATED | CONFIGURATION_COSTLY;
    if (plan_configurations(plan, plan->quick ? kinds : kinds | more, 0))
        return -1;
    const size_t searches = (size_t)(LADDER_CELLS * plan->configuration_count);
    struct ladder *ladder = plan->memo =
        calloc(1, sizeof *ladder + searches * sizeof *ladder->search);
    if (!ladder)
        return fail_with(plan->reason, "out of memory");
    if (ladder_cells(plan, ladder))
        return -1;
    for (int cell = 0; cell < ladder->cell_count; cell++) {
        const struct run_request reference = {.stepper = "reference"};
        const struct subject *subject = &plan->subjects[cell];
        if (plan_add(plan, subject->scene, &reference, subject->name, "reference"))
            return -1;
    }
    for (int cell = 0; cell < ladder->cell_count; cell++)
        for (int c = 0; c < plan->configuration_count; c++)
            if (begin_search(plan, ladder, cell, &plan->configurations[c]))
                return -1;
    return 0;
}

/* --- from round to round --- */

/* The next place after one has been judged, or the timing of the best. The two sides of the bracket
 * must come as close as 4 % of a step, a third of a tolerance; with --quick, and where runs are
 * costly, a fifth and three quarters. */
static int go_on(struct plan *plan, struct search *s, int reached) {
    const int adaptive = configuration_is_adaptive(s->configuration);
    const int more = bracket_take(&s->place, reached, adaptive ? TOLERANCES_STRIDE : STEPS_STRIDE,
                                  !plan->quick && !is_costly(s) ? 1
                                  : adaptive                    ? 2
                                                                : 4);
    if (s->place.reached < 0 && is_beyond(s, plan->subjects[s->cell].scene)) {
        s->phase = DONE;
        return 0;
    }
    if (s->place.missed < 0)
        snprintf(s->note, sizeof s->note, "the coarsest that was tried");
    return more ? try_place(plan, s) : time_place(plan, s);
}

static int step_search(struct plan *plan, struct search *s, const struct run_files *reference) {
    struct verdict verdict;
    if (s->phase == TIMING) {
        s->phase = DONE;
        return read_counted(plan, s);
    }
    if (judge_runs(plan, s->first, s->count, plan->subjects[s->cell].scene, reference, &verdict))
        return -1;
    if (s->phase == CONFIRMING && verdict.outcome == FINISHED)
        verdict.error = fmax(verdict.error, s->first_error);
    const int reached = verdict.outcome == FINISHED && verdict.error <= LADDER_TARGET;
    if (reached && s->phase == TRYING && read_counted(plan, s))
        return -1;
    if (reached && configuration_is_adaptive(s->configuration) && s->phase == TRYING &&
        !is_costly(s))
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

/* The searches of a cell, among those of all. */
struct searched {
    struct ladder *ladder;
    int cell;
};

static int is_done(const void *ctx, int i) {
    const struct searched *of = ctx;
    const struct search *s = &of->ladder->search[i];
    return s->cell != of->cell || s->phase == DONE;
}

/* Without a truth there is nothing to search for. */
static int go_on_with(struct plan *plan, void *ctx, int i, const struct run_files *reference) {
    struct search *s = &((struct searched *)ctx)->ladder->search[i];
    if (reference->outcome == FINISHED)
        return step_search(plan, s, reference);
    s->phase = DONE;
    snprintf(s->note, sizeof s->note, "no reference solution: %s",
             outcome_name(reference->outcome));
    return 0;
}

static int ladder_refine(struct plan *plan) {
    struct ladder *ladder = plan->memo;
    const int count = ladder->count;
    for (int cell = 0; cell < ladder->cell_count; cell++) {
        struct searched of = {ladder, cell};
        if (searches_go_on(plan, &(struct searches){cell, count, &of, is_done, go_on_with}))
            return -1;
    }
    return 0;
}

double ladder_setting(const struct plan *plan, const struct search *s, int place) {
    return place < 0 ? NAN : setting_at(plan->subjects[s->cell].scene, s->configuration, place);
}

static int ladder_tabulate(struct plan *plan) {
    if (plan_open_statements(plan, plan->subjects[0].scene,
                             plan->quick ? "--quick: coarser brackets" : NULL) ||
        ladder_write(plan))
        return -1;
    return ladder_state(&plan->output.statements, plan);
}

const struct experiment ladder_experiment = {
    .name = "ladder",
    .question = "which stepper is cheapest for a millimetre, by stiffness, bending and damping?",
    .chapter = CHAPTER_ACCURACY,
    .place = 6,
    .headline = "price, default",
    .quick_seconds = 16,
    .full_seconds = 230,
    .plan = ladder_plan,
    .refine = ladder_refine,
    .tabulate = ladder_tabulate,
};
