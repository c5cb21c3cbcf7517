/* What does a scene need? Each thing that is modelled is left out or made coarser, one at a time,
 * from a full model that is finer than the scene: how far does the hair go from there, and what is
 * saved? Then the cheapest of what is near enough is taken together, and where that is not near
 * enough the worst of it is taken back, until one run with all of it stays within a millimetre.
 *
 * Runge-Kutta 4 integrates every model at the same share of its own stability limit, the thesis's
 * recipe of the longest step that holds: what a model costs is what its stiffness makes it cost.
 * That the integrator has no part in the changes is seen from runs with half the step. At the end
 * methods race on the smallest model (needs_race.c). */
#include "needs.h"

#include "base/files.h"
#include "model/model.h"
#include "model/problems.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const own_scenes[] = {"swing-envelope", "radii", "interactions", "wind"};
static const double scatter = 1e-4;                  /* rms displacement of a perturbed start, m */
static const double seconds = 90, quick_seconds = 3; /* of wall time, on two cores */

/* --- its runs --- */

/* A run of the variant, with a share of its step. */
static int add_run(struct plan *plan, const struct study *study, const struct scene *scene,
                   const struct variant *variant, double share, double perturbation,
                   const char *label) {
    const double cost = model_seconds(scene);
    const int repeats = plan->quick ? 1 : 3;
    const int treatment = (int)value_of(&study->menu, &variant->choice, TREATMENT);
    const struct run_request request = {
        .stepper = "rk4",
        .treatment = wisp_problem.treatments[treatment].name,
        .step = share * variant->step,
        .perturbation = perturbation,
        .draw = perturbation > 0,
        .timings = share == 1 && perturbation == 0 && cost < 0.3 ? repeats : 0};
    return plan_add(plan, scene, &request, study->subject->name, "%s", label);
}

/* Adds the variant's run, or notes why there can be none. */
static int add_variant(struct plan *plan, struct study *study, struct variant *variant) {
    const struct scene *scene =
        choose_scene(plan, study->subject, study->duration, &study->menu, &variant->choice);
    variant->change = (struct curve_deviation){NAN, NAN, NAN};
    variant->cost = no_cost;
    variant->fate = scene ? RUN : REFUSED_SCENE;
    if (!scene) {
        snprintf(variant->note, sizeof variant->note, "%.300s", plan->reason);
        return errno == ENOMEM ? -1 : 0;
    }
    variant->at = plan->case_count;
    variant->step = recipe_step(scene);
    return add_run(plan, study, scene, variant, 1, 0, variant->name);
}

static int add_check(struct plan *plan, struct study *study, enum check check,
                     const struct variant *variant, double perturbation, const char *label) {
    study->check_case[check] = plan->case_count;
    return add_run(plan, study, plan->cases[variant->at].run.scene, variant,
                   perturbation > 0 ? 1 : 0.5, perturbation, label);
}

/* The scene as it is: what has a finer option in the full model is at the scene's own. */
static struct choice own_choice(const struct study *study) {
    const struct scene *own = study->subject->scene;
    const double values[THINGS] = {[NODES] = 1,
                                   [ENVELOPE] = own->wisps[0].samples,
                                   [BENDING] = own->wisps[0].bending,
                                   [STRETCHING] = own->wisps[0].stretch,
                                   [TREATMENT] = WISP_GENERALISED,
                                   [COLLISION_RATE] = own->collision_rate,
                                   [INTERACTION_RATE] = own->interaction.rate};
    struct choice choice = study->full.choice;
    for (int thing = 0; thing <= INTERACTION_RATE; thing++)
        for (int k = 0; k < study->menu.count[thing]; k++)
            if (study->menu.option[thing][k].value == values[thing])
                choice.of[thing] = k;
    return choice;
}

int needs_is_full(const struct study *study, enum thing thing, int option) {
    return study->full.choice.of[thing] == option;
}

static int add_single(struct plan *plan, struct study *study, enum thing thing, int option) {
    const struct option chosen = study->menu.option[thing][option];
    struct variant *single = &study->single[study->singles++];
    *single = (struct variant){.choice = study->full.choice, .thing = thing};
    single->choice.of[thing] = option;
    snprintf(single->name, sizeof single->name, "%s", chosen.name);
    return add_variant(plan, study, single);
}

static int add_singles(struct plan *plan, struct study *study) {
    for (int thing = 0; thing < THINGS; thing++)
        for (int k = 0; k < study->menu.count[thing]; k++)
            if (!needs_is_full(study, (enum thing)thing, k) &&
                add_single(plan, study, (enum thing)thing, k))
                return -1;
    return 0;
}

/* The full model comes first: nothing can be compared with one that fails. */
static int plan_study(struct plan *plan, struct study *study) {
    study->full.thing = THINGS;
    snprintf(study->full.name, sizeof study->full.name, "full model");
    if (add_variant(plan, study, &study->full))
        return -1;
    if (study->full.fate == REFUSED_SCENE)
        snprintf(plan->reason, REASON_SIZE, "%.300s", study->full.note);
    return study->full.fate == REFUSED_SCENE ? -1 : 0;
}

static int plan_rest(struct plan *plan, struct study *study) {
    study->phase = SINGLES;
    study->own = (struct variant){.thing = THINGS, .name = "the scene as it is"};
    study->own.choice = own_choice(study);
    if (add_check(plan, study, HALF_STEP, &study->full, 0, "full model, half the step") ||
        add_check(plan, study, PERTURBED, &study->full, HORIZON_PERTURBATION,
                  "full model, perturbed") ||
        add_check(plan, study, SCATTERED, &study->full, scatter, "full model, scattered") ||
        add_variant(plan, study, &study->own))
        return -1;
    return add_singles(plan, study);
}

/* --- how much of each scene there is time for --- */

/* CPU time of all runs of a study of this duration, s, roughly: most of them cost nearly as much as
 * the full model's, of which there are four more (two by half the step). */
static const double race_share = 3; /* of the race: the smallest model's runs cost little */
static double study_cost(struct plan *plan, const struct study *study, double duration) {
    const struct choice full = {{0}};
    const struct scene *scene = choose_scene(plan, study->subject, duration, &study->menu, &full);
    int singles = 0;
    for (int thing = 0; thing < THINGS; thing++)
        singles += study->menu.count[thing] - 1;
    return scene ? (race_share + 5 + 0.7 * singles) * model_seconds(scene) : NAN;
}

/* The cheapest study that has no duration yet. */
static struct study *cheapest_study(struct needs *needs) {
    struct study *cheapest = NULL;
    for (int i = 0; i < needs->count; i++) {
        struct study *study = &needs->study[i];
        if (study->duration == 0 && (!cheapest || study->need < cheapest->need))
            cheapest = study;
    }
    return cheapest;
}

/* What the cheaper scenes leave of the budget is the costlier ones'. */
static int share_budget(struct plan *plan, struct needs *needs) {
    const double cores = 2;
    double left = cores * (plan->quick ? quick_seconds : seconds);
    for (int i = 0; i < needs->count; i++) {
        struct study *study = &needs->study[i];
        study->need = study_cost(plan, study, study->subject->scene->duration);
        if (isnan(study->need))
            return -1;
    }
    for (int todo = needs->count; todo > 0; todo--) {
        struct study *study = cheapest_study(needs);
        const struct scene *own = study->subject->scene;
        const double part = fmin(1, left / todo / study->need);
        const double frames = fmax(1, floor(part * own->duration * own->frame_rate + 1e-9));
        study->duration = fmin(frames / own->frame_rate, own->duration);
        left -= study->need * study->duration / own->duration;
    }
    return 0;
}

static int needs_plan(struct plan *plan) {
    plan->run_seconds = 200;
    if (plan_has_no_steppers(plan, "models") ||
        plan_subjects(plan, own_scenes, plan->quick ? 2 : 4) ||
        plan_configurations(plan, CONFIGURATION_PLAIN, 0))
        return -1;
    const size_t studies = (size_t)plan->subject_count, methods = (size_t)plan->configuration_count;
    struct needs *needs = plan->memo = calloc(1, sizeof *needs + studies * sizeof *needs->study +
                                                     studies * methods * sizeof(struct contender));
    if (!needs)
        return fail_with(plan->reason, "out of memory");
    for (; needs->count < plan->subject_count; needs->count++) {
        struct study *study = &needs->study[needs->count];
        study->subject = &plan->subjects[needs->count];
        study->contender =
            (struct contender *)(needs->study + studies) + (size_t)needs->count * methods;
        make_menu(&study->menu, study->subject->scene, plan->quick);
    }
    if (share_budget(plan, needs))
        return -1;
    for (int i = 0; i < needs->count; i++)
        if (plan_study(plan, &needs->study[i]))
            return -1;
    return 0;
}

/* --- judging --- */

double needs_noise(const struct study *study) {
    return fmax(study->check[PERTURBED], study->check[SCATTERED]);
}

int needs_is_near(const struct study *study, const struct variant *variant) {
    return variant->fate == CHANGED &&
           variant->change.rms <= fmax(NEEDS_TARGET, needs_noise(study));
}

static int compare_to(struct plan *plan, const struct study *study, int at,
                      const struct run_files *reference, struct curve_deviation *change,
                      struct cost *cost, char *note) {
    struct run_files run;
    *change = (struct curve_deviation){NAN, NAN, NAN};
    if (plan_read(plan, &plan->cases[at], &run))
        return -1;
    const struct run_case *one = &plan->cases[at].run;
    const struct configuration recipe = configuration_of(one->settings.method);
    *cost = run_cost(&run);
    cost_count(cost, one->scene, (enum wisp_treatment)one->settings.treatment, &recipe);
    int code = 0;
    if (run.outcome == FINISHED)
        code = measure_curves(study->subject->scene, run.states, reference->states, change,
                              plan->reason);
    else
        snprintf(note, REASON_SIZE, "%s at t = %.3g s", outcome_name(run.outcome),
                 cost->failure_time);
    run_free(&run);
    return code;
}

static int judge(struct plan *plan, const struct study *study, const struct run_files *full,
                 struct variant *variant) {
    if (variant->fate != RUN)
        return 0;
    const int code =
        compare_to(plan, study, variant->at, full, &variant->change, &variant->cost, variant->note);
    variant->fate = variant->cost.outcome == FINISHED ? CHANGED : FAILED;
    return code;
}

static int judge_check(struct plan *plan, struct study *study, const struct run_files *reference,
                       enum check check) {
    struct curve_deviation change;
    struct cost cost;
    char note[REASON_SIZE];
    const int code =
        compare_to(plan, study, study->check_case[check], reference, &change, &cost, note);
    study->check[check] = change.rms;
    return code;
}

static int judge_singles(struct plan *plan, struct study *study, const struct run_files *full) {
    for (int check = HALF_STEP; check <= SCATTERED; check++)
        if (judge_check(plan, study, full, (enum check)check))
            return -1;
    if (measure_horizon(plan->trajectories, plan->cases[study->full.at].run.folder,
                        plan->cases[study->check_case[PERTURBED]].run.folder, &study->horizon,
                        plan->reason) ||
        judge(plan, study, full, &study->own))
        return -1;
    for (int i = 0; i < study->singles; i++)
        if (judge(plan, study, full, &study->single[i]))
            return -1;
    return 0;
}

/* --- the search for the smallest model --- */

static const struct variant *single_of(const struct study *study, enum thing thing, int option) {
    for (int i = 0; i < study->singles; i++)
        if (study->single[i].thing == thing && study->single[i].choice.of[thing] == option)
            return &study->single[i];
    return &study->full;
}

static double change_of(const struct study *study, enum thing thing, int option) {
    return needs_is_full(study, thing, option) ? 0 : single_of(study, thing, option)->change.rms;
}

/* The cheapest option of a thing that alone is near enough, and nearer than `limit`; the full
 * model's where none of them saves anything. By steps counted and the table of costs, so that a
 * busy machine finds the same model. */
static int cheapest_option(const struct study *study, enum thing thing, double limit) {
    int best = study->full.choice.of[thing];
    for (int k = 0; k < study->menu.count[thing]; k++) {
        const struct variant *single = single_of(study, thing, k);
        if (needs_is_near(study, single) && single->change.rms < limit &&
            single->cost.counted < single_of(study, thing, best)->cost.counted)
            best = k;
    }
    return best;
}

/* The thing whose option changes most by itself, among those that mean something; THINGS: all are
 * the full model's. */
static enum thing worst_thing(const struct study *study) {
    const struct choice *choice = &study->smallest.choice;
    enum thing worst = THINGS;
    for (int thing = 0; thing < THINGS; thing++)
        if (!needs_is_full(study, (enum thing)thing, choice->of[thing]) &&
            applies(&study->menu, choice, (enum thing)thing) &&
            (worst == THINGS || change_of(study, (enum thing)thing, choice->of[thing]) >
                                    change_of(study, worst, choice->of[worst])))
            worst = (enum thing)thing;
    return worst;
}

/* Runs the choice of study->smallest, or ends where it is the full model or what is known. */
static int try_smallest(struct plan *plan, struct study *study) {
    if (worst_thing(study) == THINGS) {
        study->smallest = study->full;
        study->check[SMALLEST_HALF_STEP] = study->check[HALF_STEP];
        study->race_yardstick = study->check_case[HALF_STEP];
        return needs_begin_race(plan, study);
    }
    study->phase = COMBINING;
    study->tried++;
    snprintf(study->smallest.name, sizeof study->smallest.name, "smallest model, try %d",
             study->tried);
    return add_variant(plan, study, &study->smallest);
}

/* A chain of fewer nodes may hold where a finer one fails: bodies put nodes out by as much, and
 * that is a larger part of a shorter segment. */
static int settle_full(struct plan *plan, struct study *study) {
    struct variant *full = &study->full;
    const struct option nodes = study->menu.option[NODES][full->choice.of[NODES]];
    struct run_files run;
    if (plan_read(plan, &plan->cases[full->at], &run))
        return -1;
    const int code = judge(plan, study, &run, full);
    run_free(&run);
    if (code)
        return -1;
    if (full->fate == CHANGED)
        return plan_rest(plan, study);
    const size_t used = strlen(study->note);
    char why[61];
    snprintf(why, sizeof why, "%.60s", full->note);
    snprintf(study->note + used, sizeof study->note - used, "%s%s: %s", used ? "; " : "",
             nodes.name, why);
    if (full->choice.of[NODES] + 1 == study->menu.count[NODES]) {
        study->phase = DONE;
        return 0;
    }
    full->choice.of[NODES]++;
    full->note[0] = '\0';
    return add_variant(plan, study, full);
}

static int begin_search(struct plan *plan, struct study *study) {
    study->smallest = (struct variant){.thing = THINGS};
    for (int thing = 0; thing < THINGS; thing++)
        study->smallest.choice.of[thing] = cheapest_option(study, (enum thing)thing, INFINITY);
    return try_smallest(plan, study);
}

/* Near enough and cheaper than without, or one step back. A combination that the scene refuses goes
 * back too, at once. */
static int go_on(struct plan *plan, struct study *study) {
    do {
        if (needs_is_near(study, &study->smallest)) {
            study->phase = CHECKING;
            return add_check(plan, study, SMALLEST_HALF_STEP, &study->smallest, 0,
                             "smallest model, half the step");
        }
        const enum thing worst = worst_thing(study);
        int *option = &study->smallest.choice.of[worst];
        *option = cheapest_option(study, worst, change_of(study, worst, *option));
        if (try_smallest(plan, study))
            return -1;
    } while (study->phase == COMBINING && study->smallest.fate == REFUSED_SCENE);
    return 0;
}

static int check_smallest(struct plan *plan, struct study *study) {
    struct run_files smallest;
    if (plan_read(plan, &plan->cases[study->smallest.at], &smallest))
        return -1;
    const int code = judge_check(plan, study, &smallest, SMALLEST_HALF_STEP);
    run_free(&smallest);
    study->race_yardstick = study->check_case[SMALLEST_HALF_STEP];
    return code ? -1 : needs_begin_race(plan, study);
}

static int refine_study(struct plan *plan, struct study *study) {
    struct run_files full;
    if (study->phase == DONE)
        return 0;
    if (study->phase == FULL)
        return settle_full(plan, study);
    if (study->phase == CHECKING)
        return check_smallest(plan, study);
    if (study->phase == RACING)
        return needs_go_on_racing(plan, study);
    if (plan_read(plan, &plan->cases[study->full.at], &full))
        return -1;
    const int code = study->phase == SINGLES ? judge_singles(plan, study, &full)
                                             : judge(plan, study, &full, &study->smallest);
    run_free(&full);
    if (code)
        return -1;
    return study->phase == SINGLES ? begin_search(plan, study) : go_on(plan, study);
}

static int needs_refine(struct plan *plan) {
    struct needs *needs = plan->memo;
    for (int i = 0; i < needs->count; i++)
        if (refine_study(plan, &needs->study[i]))
            return -1;
    return 0;
}

const struct experiment needs_experiment = {
    .name = "needs",
    .question = "what must be modelled in a scene, and what does leaving out the rest save?",
    .chapter = CHAPTER_MODEL,
    .place = 3,
    .headline = "smallest model",
    .quick_seconds = 5,
    .full_seconds = 60,
    .answers = 1u << ANSWERS_NEEDS,
    .plan = needs_plan,
    .refine = needs_refine,
    .tabulate = needs_tabulate,
};
