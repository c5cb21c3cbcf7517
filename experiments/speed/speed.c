/* How fast is it? A scene by the thesis's recipe and by the best method, both just as exact as
 * asked for; then, timed here and now by wisplab-bench, how much faster than real time that is,
 * what a step of each method costs, how cost grows with wisps, nodes, samples and threads, and what
 * others need for the same.
 *
 * The runs find the longest step with which a method is exact enough; they write states, and so
 * their times are no one's speed. What they found is choices.tsv, which the measurement reads. */
#include "experiments/common/bench.h"
#include "experiments/common/search.h"
#include "model/problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double targets[] = {1e-3, 5e-4}; /* m, rms over free nodes and frames */
enum { TARGETS = sizeof targets / sizeof *targets };

/* A method at one of its steps. */
struct attempt {
    const struct configuration *configuration;
    enum wisp_treatment treatment;
    double step; /* s */
    int is_recipe;
    int at; /* its run in the plan */
    struct verdict verdict;
    double cost; /* of the whole scene by the table of costs, s */
};

/* The plan's memo. */
struct speed {
    const struct scene *whole, *compared; /* the scene; its first part, over which errors count */
    int tight[2]; /* of the recipe's treatment, of the others': runs in the plan */
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

static int add_tight(struct plan *plan, struct speed *speed, enum wisp_treatment treatment) {
    const struct run_request tight = {.stepper = "reference",
                                      .treatment = wisp_problem.treatments[treatment].name};
    speed->tight[treatment == usual] = plan->case_count;
    return plan_add(plan, speed->compared, &tight, tight.treatment, "tight");
}

/* Adds a run, unless the method is not for this scene. */
static int add_attempt(struct plan *plan, struct speed *speed,
                       const struct configuration *configuration, enum wisp_treatment treatment,
                       double step, int is_recipe) {
    struct attempt *attempt = &speed->attempt[speed->count];
    struct run_request request = contestant_request(configuration, step, 0);
    char why[REASON_SIZE];
    request.treatment = wisp_problem.treatments[treatment].name;
    if (!plan_takes(plan, speed->compared, &request, why)) {
        plan_refuse(plan, configuration->method, why);
        return 0;
    }
    *attempt =
        (struct attempt){.configuration = configuration,
                         .treatment = treatment,
                         .step = step,
                         .is_recipe = is_recipe,
                         .at = plan->case_count,
                         .cost = estimated_cost(speed->whole, treatment, configuration, step)};
    speed->count++;
    return plan_add(plan, speed->compared, &request, request.treatment, "%s%s, step %.4g",
                    is_recipe ? "the recipe: " : "", configuration->name, step);
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
    const int rungs = plan->quick ? 2 : 4;
    int first = 0;
    while (stepper_is_predictable(configuration->method) &&
           !seems_stable(configuration->method, speed->whole, ladder_step(speed->whole, 2, first)))
        first++;
    for (int k = first; k < first + rungs; k++)
        if (add_attempt(plan, speed, configuration, usual, ladder_step(speed->whole, 2, k), 0))
            return -1;
    return 0;
}

static int plan_scenes(struct plan *plan, struct speed *speed) {
    static const char *const own[] = {"wind"};
    if (plan_subjects(plan, own, 1))
        return -1;
    if (plan->subject_count > 1) {
        snprintf(plan->reason, REASON_SIZE, "experiment speed is of one scene, not of %d",
                 plan->subject_count);
        return -1;
    }
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
    if (!speed) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        return -1;
    }
    plan->run_seconds = 300;
    if (plan_scenes(plan, speed) || add_tight(plan, speed, recipe_treatment()) ||
        add_tight(plan, speed, usual) || add_recipe(plan, speed))
        return -1;
    for (int c = 0; c < plan->configuration_count; c++)
        if (!contestant_is_adaptive(&plan->configurations[c]) &&
            add_method(plan, speed, &plan->configurations[c]))
            return -1;
    return 0;
}

/* --- the choice --- */

static int judge(struct plan *plan, struct speed *speed) {
    for (int own = 0; own < 2; own++) {
        struct run_files tight;
        if (run_read_states(&tight, plan->cases[speed->tight[own]].run.folder, plan->trajectories,
                            plan->reason))
            return -1;
        int code = 0;
        for (int i = 0; i < speed->count && !code; i++) {
            struct attempt *a = &speed->attempt[i];
            if ((a->treatment == usual) != own)
                continue;
            a->verdict = (struct verdict){NAN, tight.outcome, NAN};
            if (tight.outcome == FINISHED)
                code = judge_runs(plan, a->at, 1, speed->compared, &tight, &a->verdict);
        }
        run_free(&tight);
        if (code)
            return -1;
    }
    return 0;
}

static int is_within(const struct attempt *a, double target) {
    return a->verdict.outcome == FINISHED && a->verdict.error <= target;
}

/* The cheapest within a target, by the table of costs; or NULL. */
static const struct attempt *chosen(const struct speed *speed, double target, int recipe) {
    const struct attempt *best = NULL;
    for (int i = 0; i < speed->count; i++) {
        const struct attempt *a = &speed->attempt[i];
        if (a->is_recipe == recipe && is_within(a, target) && (!best || a->cost < best->cost))
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

static int write_attempts(struct plan *plan, const struct speed *speed, const char *folder) {
    struct atomic_file file;
    char what[400];
    snprintf(what, sizeof what,
             "errors over the first %g s, rms over free nodes and frames, m, against the tight "
             "solution of the treatment; counted: the whole scene by the table of costs, s; shares "
             "of the run's wall time: steps, ticks, frames as text; nan: see status",
             speed->compared->duration);
    if (open_table(&file, folder, "attempts", what, speed->whole,
                   "method\ttreatment\trecipe\tstep\terror\tcounted\tsteps_share\tticks_share"
                   "\tframes_share\tstatus",
                   plan->reason))
        return -1;
    int code = 0;
    for (int i = 0; i < speed->count && !code; i++) {
        const struct attempt *a = &speed->attempt[i];
        struct run_files run;
        code = run_read(&run, plan->cases[a->at].run.folder, plan->reason);
        if (code)
            break;
        fprintf(file.stream, "%s\t%s\t%d\t%.17g\t%.17g\t%.17g\t%.3g\t%.3g\t%.3g\t%s\n",
                a->configuration->name, wisp_problem.treatments[a->treatment].name, a->is_recipe,
                a->step, a->verdict.error, a->cost, share(&run, "seconds.advance"),
                share(&run, "seconds.ticks"), share(&run, "seconds.frames"),
                outcome_name(a->verdict.outcome));
        run_free(&run);
    }
    if (code) {
        atomic_discard(&file);
        return -1;
    }
    return atomic_commit(&file, plan->reason);
}

static int write_choices(struct plan *plan, const struct speed *speed, const char *folder) {
    struct atomic_file file;
    if (open_table(&file, folder, "choices",
                   "the longest step, s, of the thesis's recipe and of the cheapest method that is "
                   "within the target, m; error: what it then is",
                   speed->whole, "target\twho\tmethod\ttreatment\tstep\terror", plan->reason))
        return -1;
    for (int t = 0; t < TARGETS; t++)
        for (int recipe = 1; recipe >= 0; recipe--) {
            const struct attempt *a = chosen(speed, targets[t], recipe);
            if (a)
                fprintf(file.stream, "%g\t%s\t%s\t%s\t%.17g\t%.17g\n", targets[t],
                        recipe ? "recipe" : "best", a->configuration->name,
                        wisp_problem.treatments[a->treatment].name, a->step, a->verdict.error);
        }
    return atomic_commit(&file, plan->reason);
}

static int speed_tabulate(struct plan *plan, const char *folder) {
    struct speed *speed = plan->memo;
    if (judge(plan, speed) || write_attempts(plan, speed, folder) ||
        write_choices(plan, speed, folder))
        return -1;
    return bench_run(plan, "speed", plan->subjects[0].source, folder);
}

const struct experiment speed_experiment = {
    .name = "speed",
    .question = "how fast are the thesis's recipe and the best method, and how near to others?",
    .thesis = "section 5.6",
    .place = 18,
    .full_seconds = 150,
    .plan = speed_plan,
    .tabulate = speed_tabulate,
};
