/* How fast is it? A scene by the thesis's recipe and by the best method, both just as exact as
 * asked for; then, timed here and now by wisplab-bench, how much faster than real time that is,
 * what a step of each method costs, how cost grows with wisps, nodes, samples and threads, and what
 * others need for the same.
 *
 * The runs find the longest step, or the loosest tolerance, with which a method is exact enough;
 * they write states, and so their times are no one's speed. What they found is choices.tsv, which
 * the measurement reads. */
#include "experiments/common/bench.h"
#include "experiments/common/search.h"
#include "model/problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double targets[] = {1e-3, 5e-4}; /* m, rms over free nodes and frames */
enum { TARGETS = sizeof targets / sizeof *targets };

/* A method at one of its settings. */
struct attempt {
    const struct configuration *configuration;
    enum wisp_treatment treatment;
    double setting; /* step, s, or rtol */
    int is_recipe;
    int at; /* its run in the plan */
    struct verdict verdict;
    double cost; /* of the whole scene by the steps that it took and the table of costs, s */
};

/* The plan's memo. */
struct speed {
    const struct scene *whole, *compared; /* the scene; its first part, over which errors count */
    int reference[2]; /* of the recipe's treatment, of the others': runs in the plan */
    int count;
    struct attempt attempt[];
};

static const enum wisp_treatment usual = WISP_GENERALISED;

static enum wisp_treatment recipe_treatment(void) {
    int treatment = 0;
    while (strcmp(wisp_problem.treatments[treatment].name, thesis_recipe.treatment) != 0)
        treatment++;
    return (enum wisp_treatment)treatment;
}

/* --- the plan --- */

static int add_reference(struct plan *plan, struct speed *speed, enum wisp_treatment treatment) {
    const struct run_request reference = {.stepper = "reference",
                                          .treatment = wisp_problem.treatments[treatment].name};
    speed->reference[treatment == usual] = plan->case_count;
    return plan_add(plan, speed->compared, &reference, reference.treatment, "reference");
}

/* Adds a run, unless the method is not for this scene. */
static int add_attempt(struct plan *plan, struct speed *speed,
                       const struct configuration *configuration, enum wisp_treatment treatment,
                       double setting, int is_recipe) {
    const struct scene *scene = speed->compared;
    struct run_request request =
        configuration_request(configuration, setting, scene->run.atol / scene->run.rtol);
    char why[REASON_SIZE];
    request.treatment = wisp_problem.treatments[treatment].name;
    if (!plan_takes(plan, scene, &request, why)) {
        plan_refuse(plan, configuration->method, why);
        return 0;
    }
    speed->attempt[speed->count++] = (struct attempt){.configuration = configuration,
                                                      .treatment = treatment,
                                                      .setting = setting,
                                                      .is_recipe = is_recipe,
                                                      .at = plan->case_count,
                                                      .cost = NAN};
    return plan_add(plan, scene, &request, request.treatment, "%s%s, %s %.4g",
                    is_recipe ? "the recipe: " : "", configuration->name,
                    configuration_is_adaptive(configuration) ? "rtol" : "step", setting);
}

/* The thesis's rate, and two that are finer: 3/2 of it, and twice. */
static int add_recipe(struct plan *plan, struct speed *speed) {
    for (int c = 0; c < plan->configuration_count; c++)
        for (int k = 2; k <= 4 && strcmp(plan->configurations[c].name, thesis_recipe.stepper) == 0;
             k++)
            if (add_attempt(plan, speed, &plan->configurations[c], recipe_treatment(),
                            2 / (k * thesis_recipe.rate), 1))
                return -1;
    return 0;
}

/* From the longest step that seems stable on, which linear theory tells of explicit methods; of
 * others from the one between the stops that come most often. */
static int add_method(struct plan *plan, struct speed *speed,
                      const struct configuration *configuration) {
    const int levels = plan->quick ? 2 : 4;
    int first = 0;
    while (
        stepper_is_predictable(configuration->method) &&
        !seems_stable(configuration->method, speed->whole, sequence_step(speed->whole, 2, first)))
        first++;
    for (int k = first; k < first + levels; k++)
        if (add_attempt(plan, speed, configuration, usual, sequence_step(speed->whole, 2, k), 0))
            return -1;
    return 0;
}

/* By decades from a tolerance that is far too loose for a millimetre. */
static int add_adaptive(struct plan *plan, struct speed *speed,
                        const struct configuration *configuration) {
    double rtol = 1e-2;
    for (int k = 0; k < (plan->quick ? 2 : 4); k++, rtol /= 10)
        if (add_attempt(plan, speed, configuration, usual, rtol, 0))
            return -1;
    return 0;
}

static int plan_scenes(struct plan *plan, struct speed *speed) {
    static const char *const own[] = {"wind"};
    if (plan_subjects(plan, own, 1))
        return -1;
    if (plan->subject_count > 1)
        return fail_with(plan->reason, "experiment speed is of one scene, not of %d",
                         plan->subject_count);
    const struct subject *subject = &plan->subjects[0];
    const double duration = fmin(subject->scene->duration, plan->quick ? 0.4 : 1);
    speed->whole = subject->scene;
    speed->compared =
        plan_cut_scene(plan, subject, sparse_frame_rate(subject->scene, duration), duration, NULL);
    return speed->compared ? 0 : -1;
}

static int speed_plan(struct plan *plan) {
    enum { MOST = 5 }; /* attempts of a configuration */
    if (plan_configurations(plan, CONFIGURATION_PLAIN, 0))
        return -1;
    struct speed *speed = plan->memo = calloc(
        1, sizeof *speed + (size_t)(plan->configuration_count + 1) * MOST * sizeof *speed->attempt);
    if (!speed)
        return fail_with(plan->reason, "out of memory");
    plan->run_seconds = 300;
    if (plan_scenes(plan, speed) || add_reference(plan, speed, recipe_treatment()) ||
        add_reference(plan, speed, usual) || add_recipe(plan, speed))
        return -1;
    for (int c = 0; c < plan->configuration_count; c++)
        if ((configuration_is_adaptive(&plan->configurations[c]) ? add_adaptive : add_method)(
                plan, speed, &plan->configurations[c]))
            return -1;
    return 0;
}

/* --- the choice --- */

/* As if it went on as it began. */
static int count_cost(struct plan *plan, const struct speed *speed, struct attempt *a) {
    struct cost cost;
    if (read_cost(plan, a->at, &cost))
        return -1;
    cost_count(&cost, speed->compared, a->treatment, a->configuration);
    a->cost = cost.counted * speed->whole->duration / speed->compared->duration;
    return 0;
}

static int judge(struct plan *plan, struct speed *speed) {
    for (int own = 0; own < 2; own++) {
        struct run_files reference;
        if (plan_read(plan, &plan->cases[speed->reference[own]], &reference))
            return -1;
        int code = 0;
        for (int i = 0; i < speed->count && !code; i++) {
            struct attempt *a = &speed->attempt[i];
            if ((a->treatment == usual) != own)
                continue;
            a->verdict = (struct verdict){NAN, reference.outcome, NAN};
            if (reference.outcome == FINISHED)
                code = judge_runs(plan, a->at, 1, speed->compared, &reference, &a->verdict) ||
                       count_cost(plan, speed, a);
        }
        run_free(&reference);
        if (code)
            return -1;
    }
    return 0;
}

/* The cheapest within a target, by the table of costs; or NULL. */
static const struct attempt *chosen(const struct speed *speed, double target, int recipe) {
    const struct attempt *best = NULL;
    for (int i = 0; i < speed->count; i++) {
        const struct attempt *a = &speed->attempt[i];
        if (a->is_recipe == recipe && a->verdict.outcome == FINISHED &&
            a->verdict.error <= target && (!best || a->cost < best->cost))
            best = a;
    }
    return best;
}

/* Seconds of a stage over those of all stages of a run. */
static double share(const struct run_files *run, const char *stage) {
    const double all = run_number(run, "seconds.advance") + run_number(run, "seconds.ticks") +
                       run_number(run, "seconds.frames");
    return run_number(run, stage) / all;
}

#define SETTING_COLUMNS(X)                                              \
    X("method", "-", "the configuration", "%s", a->configuration->name) \
    TREATED_COLUMN(X, wisp_problem.treatments[a->treatment].name)

#define ATTEMPT_COLUMNS(X)                                                                  \
    SETTING_COLUMNS(X)                                                                      \
    X("recipe", "1", "1 for the thesis's recipe", "%d", a->is_recipe)                       \
    X("setting", "s or 1", "step, s, or rtol", "%.17g", a->setting)                         \
    X("error", "m", "distance from the reference solution, rms over free nodes and frames", \
      "%.17g", a->verdict.error)                                                            \
    X("counted", "s", "counted cost of the whole scene", "%.17g", a->cost)                  \
    X("steps_share", "1", "share of steps in the run's wall time", "%.3g",                  \
      share(&run, "seconds.advance"))                                                       \
    X("ticks_share", "1", "share of ticks in the run's wall time", "%.3g",                  \
      share(&run, "seconds.ticks"))                                                         \
    X("frames_share", "1", "share of frames as text in the run's wall time", "%.3g",        \
      share(&run, "seconds.frames"))                                                        \
    X("status", "-", "how the run ended", "%s", outcome_name(a->verdict.outcome))

static int write_attempts(struct plan *plan, const struct speed *speed) {
    char what[400];
    snprintf(what, sizeof what,
             "errors over the first %g s, rms over free nodes and frames, m, against the reference "
             "solution of the treatment; setting: step, s, or rtol; counted: the whole scene by "
             "the steps and the table of costs, s; shares of the run's wall time: steps, ticks, "
             "frames as text; nan: see status",
             speed->compared->duration);
    FILE *stream =
        output_table(&plan->output, "attempts", what, speed->whole, COLUMNS(ATTEMPT_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < speed->count; i++) {
        const struct attempt *a = &speed->attempt[i];
        struct run_files run;
        if (run_read(&run, plan->cases[a->at].run.folder, plan->reason))
            return -1;
        WRITE_ROW(stream, ATTEMPT_COLUMNS);
        run_free(&run);
    }
    return 0;
}

#define CHOICE_COLUMNS(X)                                                                         \
    X("target", "m", "the error that is allowed", "%g", targets[t])                               \
    X("who", "-", "recipe: the thesis's; best: the cheapest", "%s", recipe ? "recipe" : "best")   \
    SETTING_COLUMNS(X)                                                                            \
    X("setting", "s or 1", "longest step, s, or loosest rtol that is within the target", "%.17g", \
      a->setting)                                                                                 \
    X("error", "m", "error of that run", "%.17g", a->verdict.error)

static int write_choices(struct plan *plan, const struct speed *speed) {
    FILE *stream =
        output_table(&plan->output, "choices",
                     "the setting (longest step, s, or loosest rtol) of the thesis's recipe and of "
                     "the cheapest method that is within the target, m; error: what it then is",
                     speed->whole, COLUMNS(CHOICE_COLUMNS));
    for (int t = 0; t < TARGETS && stream; t++)
        for (int recipe = 1; recipe >= 0; recipe--) {
            const struct attempt *a = chosen(speed, targets[t], recipe);
            if (a)
                WRITE_ROW(stream, CHOICE_COLUMNS);
        }
    return stream ? 0 : -1;
}

/* The measurement reads what was chosen. */
static int speed_tabulate(struct plan *plan) {
    struct speed *speed = plan->memo;
    if (judge(plan, speed) || write_attempts(plan, speed) || write_choices(plan, speed) ||
        output_close(&plan->output, 0))
        return -1;
    return bench_run(plan, "speed", plan->subjects[0].source);
}

const struct experiment speed_experiment = {
    .name = "speed",
    .question = "how fast are the thesis's recipe and the best method, and how near to others?",
    .thesis = "section 5.6",
    .chapter = CHAPTER_ACCURACY,
    .place = 18,
    .headline = "over the recipe, 1 mm",
    .full_seconds = 120,
    .plan = speed_plan,
    .tabulate = speed_tabulate,
};
