/* The tables and the answer of experiment needs. */
#include "base/files.h"
#include "experiments/common/statements.h"
#include "needs.h"

#include <math.h>
#include <string.h>

/* --- the tables --- */

/* An option of a model; - where the scene has no such thing, or another that is left out leaves it
 * without a meaning. */
static const char *chosen(const struct study *study, const struct choice *choice,
                          enum thing thing) {
    const int there = study->menu.count[thing] > 1 && !is_moot(&study->menu, choice, thing);
    return there ? study->menu.option[thing][choice->of[thing]].name : "-";
}

/* Lists a model's options: those that are the full model's, those that are not, or all. */
enum which { AS_IN_FULL = 1, OTHER = 2, ALL = 3 };
static void describe(const struct study *study, const struct choice *choice, enum which which,
                     char text[REASON_SIZE]) {
    int used = snprintf(text, REASON_SIZE, "%s", "");
    for (int thing = 0; thing < THINGS; thing++) {
        const char *name = chosen(study, choice, (enum thing)thing);
        if (strcmp(name, "-") != 0 &&
            (which &
             (needs_is_full(study, (enum thing)thing, choice->of[thing]) ? AS_IN_FULL : OTHER)))
            used +=
                snprintf(text + used, REASON_SIZE - (size_t)used, "%s%s", used ? ", " : "", name);
    }
    if (used == 0)
        snprintf(text, REASON_SIZE, "nothing");
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

static void write_variant(FILE *stream, const struct study *study, const char *thing,
                          const char *name, const struct variant *variant) {
    const double numbers[] = {variant->change.rms,        variant->change.largest,
                              variant->change.end,        variant->cost.cpu.median,
                              variant->cost.cpu.least,    variant->cost.cpu.greatest,
                              cost_ratio(study, variant), variant->step};
    fprintf(stream, "%s\t%s\t%s", study->subject->name, thing, name);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        fprintf(stream, "\t%.17g", numbers[i]);
    char options[REASON_SIZE];
    describe(study, &variant->choice, ALL, options);
    fprintf(stream, "\t%s\t%s\t%s\n", verdict_of(study, variant), options, variant->note);
}

static int write_needs(const struct plan *plan, const char *folder, char *reason) {
    const struct needs *needs = plan->memo;
    struct atomic_file file;
    char what[1024];
    snprintf(what, sizeof what,
             "what each thing buys: distance of the model in which it alone is this way from the "
             "full one (first row of a scene), m: rms over 32 points at equal shares of arc length "
             "of all wisps and all frames, largest, rms at the last frame; CPU time, s, of rk4 at "
             "%g of its longest step by linear theory (step, s): median, least, greatest of three "
             "runs (--quick: one), or where the full model's takes over 0.3 s that of one; "
             "cost_ratio: over the "
             "full model's; needed: it changes more than %g m, and more than perturbed starts "
             "do; chaos: more than that, but no more than perturbed starts; smallest model: all "
             "together that smallest.tsv says; nan: the run failed or there was none, see note",
             STABILITY_SHARE, NEEDS_TARGET);
    if (open_table(&file, folder, "needs", what, needs->study[0].subject->scene,
                   "scene\tthing\toption\tchange_rms\tchange_largest\tchange_end\tcpu_median"
                   "\tcpu_least\tcpu_greatest\tcost_ratio\tstep\tverdict\tmodel\tnote",
                   reason))
        return -1;
    for (int i = 0; i < needs->count; i++) {
        const struct study *study = &needs->study[i];
        write_variant(file.stream, study, "full", "full model", &study->full);
        for (int k = 0; k < study->singles; k++) {
            const struct variant *single = &study->single[k];
            write_variant(file.stream, study, thing_names[single->thing], single->name, single);
        }
        if (study->full.fate != CHANGED)
            continue;
        write_variant(file.stream, study, "together", study->own.name, &study->own);
        write_variant(file.stream, study, "together", "smallest model", &study->smallest);
    }
    return atomic_commit(&file, reason);
}

static void write_smallest(FILE *stream, const struct study *study) {
    const int answered = study->full.fate == CHANGED;
    const double numbers[] = {study->duration,
                              study->subject->scene->duration,
                              study->smallest.change.rms,
                              study->smallest.change.largest,
                              cost_ratio(study, &study->smallest),
                              study->own.change.rms,
                              cost_ratio(study, &study->own),
                              study->check[HALF_STEP],
                              study->check[SMALLEST_HALF_STEP],
                              study->check[PERTURBED],
                              study->check[SCATTERED],
                              study->horizon};
    fprintf(stream, "%s", study->subject->name);
    for (int thing = 0; thing < THINGS; thing++)
        fprintf(stream, "\t%s",
                answered ? chosen(study, &study->smallest.choice, (enum thing)thing) : "-");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        fprintf(stream, "\t%.17g", i < 2 || answered ? numbers[i] : NAN);
    fprintf(stream, "\t%d\t%s\n", study->tried, study->note);
}

static int write_answers(const struct plan *plan, const char *folder, char *reason) {
    const struct needs *needs = plan->memo;
    struct atomic_file file;
    char what[1024], columns[512];
    int used = snprintf(columns, sizeof columns, "scene");
    snprintf(what, sizeof what,
             "the smallest model within %g m of the full one, or within what perturbed starts "
             "make: found by leaving out all that alone is near enough, and taking back the worst "
             "until a run of the whole is; its change and cost_ratio, those of the scene as it is; "
             "rms change, m, by half the step in the full model (step_full) and the smallest, and "
             "in the full one by starts displaced by 1e-10 m (perturbed) and 1e-4 m (scattered); "
             "horizon: of the former's nodes, s; tried: combinations; nan: the run failed or there "
             "was none, see note",
             NEEDS_TARGET);
    for (int thing = 0; thing < THINGS; thing++)
        used += snprintf(columns + used, sizeof columns - (size_t)used, "\t%s", thing_names[thing]);
    snprintf(columns + used, sizeof columns - (size_t)used,
             "\tcompared\tduration\tchange_rms\tchange_largest\tcost_ratio\town_change_rms"
             "\town_cost_ratio\tstep_full\tstep_smallest\tperturbed\tscattered\thorizon\ttried"
             "\tnote");
    if (open_table(&file, folder, "smallest", what, needs->study[0].subject->scene, columns,
                   reason))
        return -1;
    for (int i = 0; i < needs->count; i++)
        write_smallest(file.stream, &needs->study[i]);
    return atomic_commit(&file, reason);
}

/* --- the answer --- */

/* A row on a study: its key is that of the study with a word. */
static struct statement row_of(const struct study *study, const char *word, char key[128]) {
    snprintf(key, 128, "%.70s, %s", study->subject->name, word);
    return (struct statement){
        .key = key, .figure = study->subject->name, .tables = "smallest needs", .unit = "mm"};
}

static void state_smallest(struct statements *statements, const struct study *study) {
    const char *scene = study->subject->name;
    const double change = 1e3 * study->smallest.change.rms;
    char key[128], needed[REASON_SIZE], enough[REASON_SIZE];
    struct statement row = row_of(study, "smallest model", key);
    row.answers = ANSWERS_NEEDS;
    describe(study, &study->smallest.choice, AS_IN_FULL, needed);
    describe(study, &study->smallest.choice, OTHER, enough);
    row.value = study->tried ? change : NAN;
    if (study->tried == 0)
        statements_add(statements, row,
                       "%s needs all of its full model: nothing less is within %g mm of it (%s).",
                       scene, 1e3 * NEEDS_TARGET, needed);
    else
        statements_add(statements, row,
                       "%s needs %s, and does with %s: %.2g mm (rms) from its full model, "
                       "for %.2g of its CPU time.",
                       scene, needed, enough, change, cost_ratio(study, &study->smallest));
    row = row_of(study, "as it is", key);
    row.answers = ANSWERS_NEEDS;
    row.value = 1e3 * study->own.change.rms;
    row.verdict =
        study->own.fate == CHANGED ? holds_if(needs_is_near(study, &study->own)) : NOT_REACHED;
    if (row.verdict == NOT_REACHED)
        statements_add(statements, row, "The scene %s as it is did not reach its end.", scene);
    else
        statements_add(statements, row,
                       "%s as it is is near its full model: %.2g mm (rms) from it, for %.2g of its "
                       "CPU time.",
                       scene, row.value, cost_ratio(study, &study->own));
}

/* How far the differences between models can be trusted. */
static void state_trust(struct statements *statements, const struct study *study) {
    const double error = fmax(study->check[HALF_STEP], study->check[SMALLEST_HALF_STEP]);
    const char *scene = study->subject->name;
    char key[128];
    struct statement row = row_of(study, "steps", key);
    row.value = 1e3 * error;
    /* Steps that make less than perturbed starts do perturb like a start. */
    row.verdict =
        isnan(error) ? NOT_REACHED : holds_if(error < fmax(0.1 * NEEDS_TARGET, needs_noise(study)));
    if (isnan(error))
        statements_add(statements, row, "What steps make of %s is not known: a run failed.", scene);
    else
        statements_add(statements, row,
                       "On %s these differences are the models' alone: steps make %.1g mm.", scene,
                       row.value);
    row = row_of(study, "starts", key);
    row.value = 1e3 * needs_noise(study);
    row.verdict = isnan(row.value) ? NOT_REACHED : holds_if(row.value <= 1e3 * NEEDS_TARGET);
    if (isnan(row.value))
        statements_add(statements, row, "What starts make of %s is not known: a run failed.",
                       scene);
    else
        statements_add(statements, row,
                       "On %s models can be told apart by %g mm: starts that differ by 1e-10 m "
                       "make %.1g mm, by 0.1 mm %.1g mm.",
                       scene, 1e3 * NEEDS_TARGET, 1e3 * study->check[PERTURBED],
                       1e3 * study->check[SCATTERED]);
}

static void state_study(struct statements *statements, const struct study *study) {
    const char *scene = study->subject->name;
    char key[128];
    struct statement row = row_of(study, "full model", key);
    row.unit = NULL;
    row.verdict = NOT_REACHED;
    if (study->full.fate != CHANGED) {
        row.answers = ANSWERS_NEEDS;
        statements_add(statements, row, "%s has no answer, for its full model's runs fail: %s.",
                       scene, study->note);
        return;
    }
    state_smallest(statements, study);
    state_trust(statements, study);
    if (study->note[0])
        statements_add(statements, row, "%s has no finer full model, for with %s.", scene,
                       study->note);
    if (study->duration < study->subject->scene->duration) {
        row = row_of(study, "cut", key);
        row.verdict = NOT_REACHED;
        row.value = study->duration;
        row.unit = "s";
        statements_add(statements, row, "The budget allows %s its first %.3g of %.3g s.", scene,
                       study->duration, study->subject->scene->duration);
    }
}

int needs_tabulate(struct plan *plan, const char *folder) {
    const struct needs *needs = plan->memo;
    struct statements statements;
    if (statements_open(&statements, folder, NULL, NULL, plan->reason))
        return -1;
    const int code =
        write_needs(plan, folder, plan->reason) || write_answers(plan, folder, plan->reason) ? -1
                                                                                             : 0;
    for (int i = 0; i < needs->count && !code; i++)
        state_study(&statements, &needs->study[i]);
    return statements_close(&statements, code, plan->reason);
}
