/* The tables and the answer of experiment needs. */
#include "needs.h"

#include <math.h>
#include <string.h>

/* --- the tables --- */

/* An option of a model; - where the scene has no such thing, or another that is left out leaves it
 * without a meaning. */
static const char *chosen(const struct study *study, const struct choice *choice,
                          enum thing thing) {
    const int there = study->menu.count[thing] > 1 && applies(&study->menu, choice, thing);
    return there ? study->menu.option[thing][choice->of[thing]].name : "-";
}

/* Which options of a model: those that are the full model's, those that are not, or all. */
enum which { AS_IN_FULL = 1, OTHER = 2, ALL = 3 };

static int is_listed(const struct study *study, const struct choice *choice, enum which which,
                     int thing) {
    const int as_in_full = needs_is_full(study, (enum thing)thing, choice->of[thing]);
    return strcmp(chosen(study, choice, (enum thing)thing), "-") != 0 &&
           which & (as_in_full ? AS_IN_FULL : OTHER);
}

/* Lists them, with a comma or `last` before the last one. */
static void describe(const struct study *study, const struct choice *choice, enum which which,
                     const char *last, char text[REASON_SIZE]) {
    int left = 0;
    size_t used = 0;
    for (int thing = 0; thing < THINGS; thing++)
        left += is_listed(study, choice, which, thing);
    snprintf(text, REASON_SIZE, "%s", left ? "" : "nothing");
    for (int thing = 0; thing < THINGS && used < REASON_SIZE; thing++)
        if (is_listed(study, choice, which, thing))
            used += (size_t)snprintf(text + used, REASON_SIZE - used, "%s%s",
                                     used == 0     ? ""
                                     : --left == 1 ? last
                                                   : ", ",
                                     chosen(study, choice, (enum thing)thing));
}

static const char *verdict_of(const struct study *study, const struct variant *variant) {
    if (variant->fate == REFUSED_SCENE)
        return "impossible";
    if (variant->fate != CHANGED)
        return "failed";
    if (!needs_is_near(study, variant))
        return "needed";
    return variant->change.rms > NEEDS_TARGET ? "chaos" : "not needed";
}

static double cost_ratio(const struct study *study, const struct variant *variant) {
    return variant->fate == CHANGED ? variant->cost.cpu.median / study->full.cost.cpu.median : NAN;
}

#define VARIANT_COLUMNS(X)                                                                        \
    SCENE_COLUMN(X, study->subject->name)                                                         \
    X("thing", "-", "thing that is otherwise than in the full model", "%s", thing)                \
    X("option", "-", "how that thing is", "%s", name)                                             \
    X("change_rms", "m", "distance from the full model, rms over curves and frames", "%.17g",     \
      variant->change.rms)                                                                        \
    X("change_largest", "m", "the largest distance", "%.17g", variant->change.largest)            \
    X("change_end", "m", "distance at the last frame, rms", "%.17g", variant->change.end)         \
    CPU_COLUMNS(X, &variant->cost)                                                                \
    X("cost_ratio", "1", "cpu_median over the full model's", "%.17g", cost_ratio(study, variant)) \
    X("step", "s", "step of rk4", "%.17g", variant->step)                                         \
    X("verdict", "-", "whether the thing is needed", "%s", verdict_of(study, variant))            \
    X("model", "-", "the whole model", "%s", options)                                             \
    NOTE_COLUMN(X, variant->note)

static void write_variant(FILE *stream, const struct study *study, const char *thing,
                          const char *name, const struct variant *variant) {
    char options[REASON_SIZE];
    describe(study, &variant->choice, ALL, ", ", options);
    WRITE_ROW(stream, VARIANT_COLUMNS);
}

static int write_needs(struct plan *plan) {
    const struct needs *needs = plan->memo;
    char what[1024];
    snprintf(
        what, sizeof what,
        "what each thing buys: distance of the model in which it alone is this way from the full "
        "one (first row of a scene), m: rms over 32 points at equal shares of arc length of all "
        "wisps and all frames, largest, rms at the last frame; CPU time, s, of rk4 at %g of its "
        "longest step by linear theory (step, s): median, least, greatest of three runs (--quick: "
        "one), or where the full model's takes over 0.3 s that of one; cost_ratio: over the full "
        "model's; needed: it changes more than %g m, and more than perturbed starts do; chaos: "
        "more than that, but no more than perturbed starts; smallest model: all together that "
        "smallest.tsv says; nan: the run failed or there was none, see note",
        STABILITY_SHARE, NEEDS_TARGET);
    FILE *stream = output_table(&plan->output, "needs", what, plan->subjects[0].scene,
                                COLUMNS(VARIANT_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < needs->count; i++) {
        const struct study *study = &needs->study[i];
        write_variant(stream, study, "full", "full model", &study->full);
        for (int k = 0; k < study->singles; k++) {
            const struct variant *single = &study->single[k];
            write_variant(stream, study, thing_names[single->thing], single->name, single);
        }
        if (study->full.fate != CHANGED)
            continue;
        write_variant(stream, study, "together", study->own.name, &study->own);
        write_variant(stream, study, "together", "smallest model", &study->smallest);
    }
    return 0;
}

/* What there is only of a scene whose full model could be run. */
static double answer(const struct study *study, double number) {
    return study->full.fate == CHANGED ? number : (double)NAN;
}

static const char *option_of(const struct study *study, enum thing thing) {
    return study->full.fate == CHANGED ? chosen(study, &study->smallest.choice, thing) : "-";
}

#define THING_COLUMN(X, symbol, name, meaning) X(name, "-", meaning, "%s", option_of(study, symbol))
#define ANSWER_COLUMN(X, name, unit, meaning, number) \
    X(name, unit, meaning, "%.17g", answer(study, number))
#define SMALLEST_COLUMNS(X)                                                                        \
    SCENE_COLUMN(X, study->subject->name)                                                          \
    EACH_THING(THING_COLUMN, X)                                                                    \
    X("compared", "s", "time that was run", "%.17g", study->duration)                              \
    X("duration", "s", "duration of the scene", "%.17g", study->subject->scene->duration)          \
    ANSWER_COLUMN(X, "change_rms", "m",                                                            \
                  "distance from the full model, rms over curves and frames",                      \
                  study->smallest.change.rms)                                                      \
    ANSWER_COLUMN(X, "change_largest", "m", "the largest distance",                                \
                  study->smallest.change.largest)                                                  \
    ANSWER_COLUMN(X, "cost_ratio", "1", "CPU time over the full model's",                          \
                  cost_ratio(study, &study->smallest))                                             \
    ANSWER_COLUMN(X, "own_change_rms", "m", "distance of the scene as it is, rms",                 \
                  study->own.change.rms)                                                           \
    ANSWER_COLUMN(X, "own_cost_ratio", "1",                                                        \
                  "CPU time of the scene as it is over the full model's",                          \
                  cost_ratio(study, &study->own))                                                  \
    ANSWER_COLUMN(X, "step_full", "m", "what half the step changes in the full model, rms",        \
                  study->check[HALF_STEP])                                                         \
    ANSWER_COLUMN(X, "step_smallest", "m",                                                         \
                  "what half the step changes in the smallest model, rms",                         \
                  study->check[SMALLEST_HALF_STEP])                                                \
    ANSWER_COLUMN(X, "perturbed", "m", "what a start 1e-10 m away changes in the full model, rms", \
                  study->check[PERTURBED])                                                         \
    ANSWER_COLUMN(X, "scattered", "m", "what a start 1e-4 m away changes in the full model, rms",  \
                  study->check[SCATTERED])                                                         \
    ANSWER_COLUMN(X, "horizon", "s", "time until starts 1e-10 m apart are 1 mm apart",             \
                  study->horizon)                                                                  \
    X("tried", "1", "combinations that were tried", "%d", study->tried)                            \
    NOTE_COLUMN(X, study->note)

static int write_answers(struct plan *plan) {
    const struct needs *needs = plan->memo;
    char what[1024];
    snprintf(
        what, sizeof what,
        "the smallest model within %g m of the full one, or within what perturbed starts make: "
        "found by leaving out all that alone is near enough, and taking back the worst until a run "
        "of the whole is; its change and cost_ratio, those of the scene as it is; rms change, m, "
        "by half the step in the full model (step_full) and the smallest, and in the full one by "
        "starts displaced by 1e-10 m (perturbed) and 1e-4 m (scattered); horizon: of the former's "
        "nodes, s; tried: combinations; nan: the run failed or there was none, see note",
        NEEDS_TARGET);
    FILE *stream = output_table(&plan->output, "smallest", what, plan->subjects[0].scene,
                                COLUMNS(SMALLEST_COLUMNS));
    for (int i = 0; i < needs->count && stream; i++) {
        const struct study *study = &needs->study[i];
        WRITE_ROW(stream, SMALLEST_COLUMNS);
    }
    return stream ? 0 : -1;
}

#define CONTENDER_COLUMNS(X)                                                                   \
    SCENE_COLUMN(X, study->subject->name)                                                      \
    METHOD_COLUMNS(X, one->method)                                                             \
    X("setting", "s or 1", "step, s, or rtol", "%.17g", one->setting)                          \
    X("error", "m", "distance from rk4 at half the step, rms over curves and frames", "%.17g", \
      one->error)                                                                              \
    X("reached", "1", "1 where it is near enough", "%d", one->reached)                         \
    COUNTED_COLUMN(X, &one->cost)                                                              \
    X("cost_ratio", "1", "counted over that of rk4 at its longest step", "%.17g",              \
      one->cost.counted / study->smallest.cost.counted)                                        \
    X("best", "1", "1 for the cheapest that is near enough", "%d", one == needs_winner(study))

static int write_methods(struct plan *plan) {
    const struct needs *needs = plan->memo;
    FILE *stream = output_table(
        &plan->output, "methods",
        "methods on each scene's smallest model (smallest.tsv), from long steps to the first that "
        "is near enough, or to where another that is would be cheaper; setting: step, s, or rtol "
        "of methods that choose their steps; error: from rk4 at half of the step that the model is "
        "judged with, rms over curves and frames, m; reached: whether it is within 1e-3 m, or what "
        "perturbed starts do; counted: what the table of costs makes of its steps, s; cost_ratio: "
        "over that of rk4 at its longest step; nan: it failed or was not run",
        plan->subjects[0].scene, COLUMNS(CONTENDER_COLUMNS));
    for (int i = 0; i < needs->count && stream; i++) {
        const struct study *study = &needs->study[i];
        for (int k = 0; k < study->contenders; k++) {
            const struct contender *one = &study->contender[k];
            WRITE_ROW(stream, CONTENDER_COLUMNS);
        }
    }
    return stream ? 0 : -1;
}

/* --- the answer --- */

/* A row on a study: its key is that of the study with a word. */
static struct statement row_of(const struct study *study, enum claim_verdict verdict, double value,
                               const char *unit, const char *word) {
    return our_row(study->subject->name, "smallest needs", verdict, value, unit, "%.70s, %s",
                   study->subject->name, word);
}

static void state_smallest(struct statements *statements, const struct study *study) {
    const char *scene = study->subject->name;
    const double change = 1e3 * study->smallest.change.rms;
    char needed[REASON_SIZE], enough[REASON_SIZE];
    struct statement row =
        row_of(study, HOLDS, study->tried ? change : NAN, "mm", "smallest model");
    row.answers = ANSWERS_NEEDS;
    describe(study, &study->smallest.choice, AS_IN_FULL, " and ", needed);
    describe(study, &study->smallest.choice, OTHER, " and ", enough);
    if (study->tried == 0)
        statements_add(
            statements, row,
            "%s needs all of its full model, for nothing less is within %g mm of it (%s).", scene,
            1e3 * NEEDS_TARGET, needed);
    else
        statements_add(statements, row,
                       "%s needs %s; with %s it stays within %.2g mm (rms) of its full model, for "
                       "%.2g %% of its CPU time.",
                       scene, needed, enough, change, 100 * cost_ratio(study, &study->smallest));
    row = row_of(study,
                 study->own.fate == CHANGED ? holds_if(needs_is_near(study, &study->own))
                                            : NOT_REACHED,
                 1e3 * study->own.change.rms, "mm", "as it is");
    row.answers = ANSWERS_NEEDS;
    if (row.verdict == NOT_REACHED)
        statements_add(statements, row, "As it is, %s did not reach its end.", scene);
    else
        statements_add(statements, row,
                       "As its file has it, %s is %.2g mm (rms) from its full model, for %.2g %% "
                       "of its CPU time.",
                       scene, row.value, 100 * cost_ratio(study, &study->own));
}

static void state_method(struct statements *statements, const struct study *study) {
    const struct contender *winner = needs_winner(study);
    const char *scene = study->subject->name;
    char setting[64];
    struct statement row =
        our_row(scene, "smallest methods", winner ? HOLDS : NOT_REACHED,
                winner ? winner->cost.counted / study->smallest.cost.counted : NAN, "1",
                "%.70s, method", scene);
    row.answers = ANSWERS_NEEDS;
    if (!winner) {
        statements_add(
            statements, row,
            "No method computes the smallest model of %s for less than rk4 at its longest step.",
            scene);
        return;
    }
    if (configuration_is_adaptive(winner->method))
        snprintf(setting, sizeof setting, "rtol %.2g", winner->setting);
    else
        snprintf(setting, sizeof setting, "steps of %.2g ms", 1e3 * winner->setting);
    statements_add(statements, row,
                   "The cheapest method for the smallest model of %s is %s with %s, %.2g mm (rms) "
                   "from its motion for %.2g times the cost of rk4 at its longest step.",
                   scene, winner->method->name, setting, 1e3 * winner->error, row.value);
}

/* How far the differences between models can be trusted. */
static void state_trust(struct statements *statements, const struct study *study) {
    const double error = fmax(study->check[HALF_STEP], study->check[SMALLEST_HALF_STEP]);
    const char *scene = study->subject->name;
    const double noise = needs_noise(study);
    /* Steps that make less than perturbed starts do perturb like a start. */
    struct statement row = row_of(
        study, isnan(error) ? NOT_REACHED : holds_if(error < fmax(0.1 * NEEDS_TARGET, noise)),
        1e3 * error, "mm", "steps");
    if (isnan(error))
        statements_add(statements, row, "What steps make of %s is not known: a run failed.", scene);
    else
        statements_add(statements, row,
                       "On %s steps make %.1g mm of these differences, and the models the rest.",
                       scene, row.value);
    row = row_of(study, isnan(noise) ? NOT_REACHED : holds_if(noise <= NEEDS_TARGET), 1e3 * noise,
                 "mm", "starts");
    if (isnan(noise))
        statements_add(statements, row, "What starts make of %s is not known: a run failed.",
                       scene);
    else
        statements_add(statements, row,
                       "On %s starts that differ by 1e-10 m make %.1g mm, and by 0.1 mm %.1g mm, "
                       "against the %g mm by which models are told apart.",
                       scene, 1e3 * study->check[PERTURBED], 1e3 * study->check[SCATTERED],
                       1e3 * NEEDS_TARGET);
}

static void state_study(struct statements *statements, const struct study *study) {
    const char *scene = study->subject->name;
    struct statement row = row_of(study, NOT_REACHED, NAN, NULL, "full model");
    if (study->full.fate != CHANGED) {
        row.answers = ANSWERS_NEEDS;
        statements_add(statements, row, "%s has no answer, for its full model's runs fail (%s).",
                       scene, study->note);
        return;
    }
    state_smallest(statements, study);
    state_method(statements, study);
    state_trust(statements, study);
    if (study->note[0])
        statements_add(statements, row, "%s has no finer full model, for with %s.", scene,
                       study->note);
    if (study->duration < study->subject->scene->duration)
        statements_add(statements, row_of(study, NOT_REACHED, study->duration, "s", "cut"),
                       "The budget allows %s its first %.3g of %.3g s.", scene, study->duration,
                       study->subject->scene->duration);
}

/* --- over all scenes --- */

static int has_smallest(const struct study *study) {
    return study->full.fate == CHANGED && study->tried > 0;
}

/* How many scenes do with less than their full model, and for what. */
static void state_savings(struct statements *statements, const struct needs *needs) {
    double least = INFINITY, most = 0;
    int less = 0, all = 0;
    for (int i = 0; i < needs->count; i++) {
        const struct study *study = &needs->study[i];
        const double ratio = has_smallest(study) ? cost_ratio(study, &study->smallest) : NAN;
        less += has_smallest(study);
        all += study->full.fate == CHANGED && study->tried == 0;
        least = fmin(least, ratio);
        most = fmax(most, ratio);
    }
    struct statement row = our_row(NULL, "smallest", less ? HOLDS : NOT_REACHED, less, "1",
                                   "all scenes, smallest models");
    row.answers = ANSWERS_NEEDS;
    char rest[64] = "";
    if (all)
        snprintf(rest, sizeof rest, "; %d %s all of it", all, all == 1 ? "needs" : "need");
    if (less)
        statements_add(statements, row,
                       "%d of %d scenes stay within %g mm of their full model with less, for %.2g "
                       "to %.2g %% of its CPU time%s.",
                       less, needs->count, 1e3 * NEEDS_TARGET, 100 * least, 100 * most, rest);
    else
        statements_add(statements, row, "No scene stays within %g mm of its full model with less.",
                       1e3 * NEEDS_TARGET);
}

/* What may be simpler, on how many scenes: not counted are those that do not have it. */
static void state_simpler(struct statements *statements, const struct needs *needs) {
    char text[REASON_SIZE] = "";
    int simpler = 0;
    for (int thing = 0; thing < THINGS; thing++) {
        int on = 0, of = 0;
        for (int i = 0; i < needs->count; i++) {
            const struct study *study = &needs->study[i];
            const struct choice *choice = &study->smallest.choice;
            if (study->full.fate != CHANGED || study->menu.count[thing] < 2)
                continue;
            of++;
            on += has_smallest(study) && is_listed(study, choice, OTHER, thing);
        }
        simpler += on > 0;
        if (on > 0)
            list_add(text, sizeof text, "%s on %d of %d", thing_names[thing], on, of);
    }
    struct statement row = our_row(NULL, "smallest", simpler ? HOLDS : NOT_REACHED, simpler, "1",
                                   "all scenes, what may be simpler");
    row.answers = ANSWERS_NEEDS;
    if (simpler)
        statements_add(statements, row,
                       "What may be simpler there, of the scenes that have it: %s.", text);
}

int needs_tabulate(struct plan *plan) {
    const struct needs *needs = plan->memo;
    if (plan_open_statements(plan, NULL, NULL) || write_needs(plan) || write_answers(plan) ||
        write_methods(plan))
        return -1;
    for (int i = 0; i < needs->count; i++)
        state_study(&plan->output.statements, &needs->study[i]);
    if (needs->count > 1) {
        state_savings(&plan->output.statements, needs);
        state_simpler(&plan->output.statements, needs);
    }
    return 0;
}
