/* What a race found, in sentences: on each scene, and over all scenes. */
#include "model/model.h"
#include "race.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char *name_of(const struct point *p) {
    return p->entry->configuration->name;
}

static const double targets[RACE_TARGETS] = {1e-2, 1e-3, 1e-4};

/* Stands for a winner where there are several. */
static const char nobody_alone[] = "several (tied)";

/* "h = 0.0001" or "rtol 0.001". */
static const char *setting_name(const struct point *p) {
    return configuration_is_adaptive(p->entry->configuration) ? "rtol" : "h =";
}

static int has_envelope(const struct field *field) {
    return field->subject->scene->wisps[0].samples > 0;
}

static enum question if_asked(const struct race_answers *answers, enum question question) {
    return answers->asked & 1u << question ? question : ANSWERS_NONE;
}

/* A row on a scene: its key is the scene's with a word (printf). */
__attribute__((format(printf, 5, 6))) static struct statement row_of(const struct field *field,
                                                                     enum claim_verdict verdict,
                                                                     double value, const char *unit,
                                                                     const char *word, ...) {
    const char *scene = field->subject->name;
    char tables[192], text[96];
    va_list arguments;
    va_start(arguments, word);
    vsnprintf(text, sizeof text, word, arguments);
    va_end(arguments);
    snprintf(tables, sizeof tables, "%s %s-reference", scene, scene);
    return our_row(scene, tables, verdict, value, unit, "%.70s, %.70s", scene, text);
}

/* A row of the thesis's choice. */
static struct statement choice_row(const struct field *field, enum claim_verdict verdict,
                                   double value, const char *key) {
    struct statement row = row_of(field, verdict, value, "1", "%s", key);
    row.answers = ANSWERS_CHOICE;
    row.by = THESIS;
    return row;
}

/* --- what one would choose --- */

/* What of a target is left to the method: its error and that of the treatment add at most, and bare
 * wisps have none. */
static double left_of(const struct field *field, double target) {
    const double off = field->treatment_error;
    return target - (off > 0 ? off : 0);
}

/* The cheapest run on a scene whose error is at most `target` together with that of its treatment.
 * Of another configuration than `besides`; or NULL. */
static const struct point *cheapest_of(const struct field *fields, int count, double target,
                                       const struct point *besides, const struct field **in) {
    const struct point *best = NULL;
    for (int f = 0; f < count; f++) {
        const struct point *p = race_cheapest(&fields[f], left_of(&fields[f], target),
                                              besides ? besides->entry->configuration : NULL);
        if (!p || (best && p->cost.counted >= best->cost.counted))
            continue;
        best = p;
        *in = &fields[f];
    }
    return best;
}

/* Other configurations within the target whose costs are not known to be higher. These and the best
 * are counted in `among`. */
static void list_tied(const struct field *fields, int count, double target,
                      const struct point *best, int *among, char text[512]) {
    struct rival rivals[RIVALS_MOST];
    int tied = 0;
    for (int i = 0; i < fields->entry_count && tied < RIVALS_MOST; i++) {
        const struct configuration *configuration = fields->entries[i].configuration;
        const struct point *own = NULL;
        for (int f = 0; f < count && configuration != best->entry->configuration; f++) {
            const struct point *p =
                race_cheapest_of(&fields[f], left_of(&fields[f], target), configuration);
            if (p && (!own || p->cost.counted < own->cost.counted))
                own = p;
        }
        const int is_tied = own && !cost_is_less(&best->cost, &own->cost);
        among[i] += is_tied || configuration == best->entry->configuration;
        if (is_tied)
            rivals[tied++] = (struct rival){name_of(own), own->cost.counted, own->cost.cpu.median};
    }
    list_rivals(text, rivals, tied);
}

static void state_target(struct statements *statements, const struct field *fields, int count,
                         int target, struct race_answers *answers) {
    const struct field *in = NULL, *next_in = NULL;
    const double error = targets[target], mm = 1e3 * error;
    const struct point *best = cheapest_of(fields, count, error, NULL, &in);
    const struct point *next = best ? cheapest_of(fields, count, error, best, &next_in) : NULL;
    const char *scene = fields->subject->name,
               *with = has_envelope(fields) ? " (with its treatment's error)" : "";
    char tied[512] = "", runner_up[128] = "";
    struct statement row = row_of(fields, best ? HOLDS : NOT_REACHED,
                                  best ? 1e3 * best->cost.cpu.median : NAN, "ms", "%g mm", mm);
    row.answers = if_asked(answers, ANSWERS_TARGETS);
    if (best)
        list_tied(fields, count, error, best,
                  answers->among + target * answers->configuration_count, tied);
    answers->cheapest[answers->subjects * RACE_TARGETS + target] = !best     ? NULL
                                                                   : tied[0] ? nobody_alone
                                                                             : name_of(best);
    if (next)
        snprintf(runner_up, sizeof runner_up, "; %s is next with %.3g ms", name_of(next),
                 1e3 * next->cost.cpu.median);
    if (!best)
        statements_add(statements, row, "No run on %s is within %g mm%s.", scene, mm, with);
    else if (tied[0])
        statements_add(statements, row,
                       "Within %g mm on %s%s the cheapest are %s (%.3g ms of CPU time)%s, too "
                       "close to tell apart.",
                       mm, scene, with, name_of(best), row.value, tied);
    else
        statements_add(statements, row,
                       "Within %g mm on %s%s the cheapest is %s with %s, which takes %.3g ms of "
                       "CPU time at %s %.3g%s%s.",
                       mm, scene, with, name_of(best), race_treatment(in->treatment), row.value,
                       setting_name(best), best->setting,
                       configuration_is_adaptive(best->entry->configuration) ? "" : " s",
                       runner_up);
}

/* --- was the thesis's choice right? --- */

/* The field of the thesis's treatment; without an envelope there is none, and any will do. */
static const struct field *thesis_field(const struct field *fields, int count) {
    for (int f = 0; f < count; f++)
        if (fields[f].treatment == WISP_PROJECTION || !has_envelope(&fields[f]))
            return &fields[f];
    return NULL;
}

/* The run of explicit Euler at the thesis's rate, or at the next one above that was tried: below it
 * may be unstable where the thesis's is not. NULL where there is none near; `asked`: whether there
 * are runs of it at all. */
static const struct point *thesis_run(const struct field *field, int *asked) {
    const struct point *nearest = NULL;
    *asked = 0;
    for (int i = 0; field && i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        const double times = 1 / (p->setting * thesis_recipe.rate);
        if (strcmp(name_of(p), thesis_recipe.stepper) != 0 || p->runs == 0)
            continue;
        *asked = 1;
        if (times > 0.95 && times < 1.5 && (!nearest || p->setting > nearest->setting))
            nearest = p;
    }
    return nearest;
}

static void tally_add(struct race_tally *tally, int holds) {
    tally->holds += holds;
    tally->of++;
}

static void state_method(struct statements *statements, const struct field *field,
                         const struct point *own, struct race_answers *answers) {
    const char *scene = field->subject->name;
    static const char key[] = "choice of method";
    char choice[512];
    snprintf(choice, sizeof choice, "On %s explicit Euler%s at %.0f Hz is the right method", scene,
             has_envelope(field) ? " with projection" : "", 1 / own->setting);
    if (!race_finished(own)) {
        tally_add(&answers->method, 0);
        statements_add(statements, choice_row(field, HOLDS_NOT, NAN, key), "%s: it ends '%s'.",
                       choice, own->status);
        return;
    }
    const double ms = 1e3 * own->cost.cpu.median, mm = 1e3 * own->deviation.rms;
    const struct point *best = race_cheapest(field, race_error_at_most(field, own), NULL);
    const int right = !cost_is_less(&best->cost, &own->cost);
    const struct statement row =
        choice_row(field, holds_if(right), ms / (1e3 * best->cost.cpu.median), key);
    tally_add(&answers->method, right);
    if (right)
        statements_add(statements, row,
                       "%s: no run is as accurate (%.2g mm) and clearly cheaper (%.3g ms).", choice,
                       mm, ms);
    else
        statements_add(statements, row,
                       "%s: %s errs no more (%.2g mm) and takes %.3g ms against %.3g ms.", choice,
                       name_of(best), mm, 1e3 * best->cost.cpu.median, ms);
}

static void state_treatment(struct statements *statements, const struct field *field,
                            const struct point *own, struct race_answers *answers) {
    const char *scene = field->subject->name;
    static const char key[] = "choice of treatment";
    const double off = field->treatment_error, error = own->deviation.rms;
    if (isnan(off) || !race_finished(own)) {
        statements_add(
            statements, choice_row(field, NOT_REACHED, NAN, key),
            "On %s projection itself errs no more than the method: what it errs is not known.",
            scene);
        return;
    }
    tally_add(&answers->treatment, off <= error);
    statements_add(statements, choice_row(field, holds_if(off <= error), off / error, key),
                   "On %s projection itself errs no more than the method: it is %.2g mm from the "
                   "exact constrained motion, %.2g times the method's error.",
                   scene, 1e3 * off, off / error);
}

static void state_choice(struct statements *statements, const struct field *fields, int field_count,
                         struct race_answers *answers) {
    const struct field *field = thesis_field(fields, field_count);
    int asked;
    const struct point *own = thesis_run(field, &asked);
    if (own) {
        state_method(statements, field, own, answers);
        if (has_envelope(field))
            state_treatment(statements, field, own, answers);
        return;
    }
    statements_add(statements, choice_row(fields, asked ? NOT_REACHED : NOT_ASKED, NAN, "choice"),
                   "On %s explicit Euler%s at 9000 Hz is the right method: it %s.",
                   fields->subject->name, has_envelope(fields) ? " with projection" : "",
                   asked ? "has no run near that rate" : "was not asked for");
}

/* --- where does each method fail? --- */

/* What became of a configuration's settings on a scene, under all treatments. */
struct record {
    int runs, failures;
    char kinds[160];        /* of the failures */
    double safe;            /* none fails from this setting on; NaN: the finest fails, somewhere */
    char note[REASON_SIZE]; /* of what was refused or left out */
};

/* Settings of a configuration follow each other from coarse to fine. */
static void add_field(struct record *record, const struct field *field, const void *configuration) {
    double safe = NAN;
    int runs = 0;
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        if (p->entry->configuration != configuration)
            continue;
        if (p->runs == 0) {
            snprintf(record->note, sizeof record->note, "%s", p->note);
            continue;
        }
        runs++;
        record->failures += p->failed > 0;
        safe = p->failed ? NAN : isnan(safe) ? p->setting : safe;
        if (p->failed && !strstr(record->kinds, p->status))
            list_add(record->kinds, sizeof record->kinds, "%s", p->status);
    }
    if (runs > 0 && (record->runs == 0 || isnan(safe) || safe < record->safe))
        record->safe = safe;
    record->runs += runs;
}

static void state_record(struct statements *statements, const struct field *fields,
                         const struct entry *entry, const struct record *record,
                         const struct race_answers *answers) {
    const char *scene = fields->subject->name, *name = entry->configuration->name;
    const int adaptive = configuration_is_adaptive(entry->configuration);
    char from[64] = "the finest among them";
    struct statement row =
        row_of(fields, record->runs ? HOLDS : NOT_REACHED,
               record->runs ? (double)record->failures : NAN, "1", "failures of %.70s", name);
    row.answers = if_asked(answers, ANSWERS_FAILURES);
    if (record->runs == 0) {
        statements_add(statements, row, "On %s %s has no run (%s).", scene, name, record->note);
        return;
    }
    if (!isnan(record->safe))
        snprintf(from, sizeof from, "and at none from %s %.3g%s on",
                 adaptive ? "rtol" : "h =", adaptive ? record->safe : 1e3 * record->safe,
                 adaptive ? "" : " ms");
    statements_add(statements, row, "On %s %s fails at %d of %d settings (%s), %s.", scene, name,
                   record->failures, record->runs, record->kinds, from);
}

/* Whether the first fields have the configuration of an entry. */
static int was_seen(const struct field *fields, int field_count, const struct entry *entry) {
    for (int f = 0; f < field_count; f++)
        for (int i = 0; i < fields[f].entry_count; i++)
            if (fields[f].entries[i].configuration == entry->configuration)
                return 1;
    return 0;
}

/* Says of every configuration that fails how it does, and in one sentence which never do. */
static void state_failures(struct statements *statements, const struct field *fields, int count,
                           const struct race_answers *answers) {
    char never[512] = "";
    for (int f = 0; f < count; f++)
        for (int i = 0; i < fields[f].entry_count; i++) {
            const struct entry *entry = &fields[f].entries[i];
            struct record record = {.safe = NAN};
            if (was_seen(fields, f, entry))
                continue;
            for (int k = f; k < count; k++)
                add_field(&record, &fields[k], entry->configuration);
            if (record.failures > 0 || record.runs == 0)
                state_record(statements, fields, entry, &record, answers);
            else
                list_add(never, sizeof never, "%s", entry->configuration->name);
        }
    struct statement row = row_of(fields, HOLDS, NAN, NULL, "no failures");
    row.answers = if_asked(answers, ANSWERS_FAILURES);
    if (never[0])
        statements_add(statements, row, "On %s these methods never fail: %s.",
                       fields->subject->name, never);
}

/* --- what there is --- */

static void state_points(struct statements *statements, const struct field *fields, int count) {
    const struct point *best = NULL;
    int finished = 0, failed = 0, none = 0;
    for (int f = 0; f < count; f++)
        for (int i = 0; i < fields[f].point_count; i++) {
            const struct point *p = &fields[f].points[i];
            finished += p->runs > 0 && !p->failed;
            failed += p->runs > 0 && p->failed;
            none += p->runs == 0;
            if (race_finished(p) && (!best || p->deviation.rms < best->deviation.rms))
                best = p;
        }
    statements_add(statements,
                   row_of(fields, finished ? HOLDS : NOT_REACHED, finished, "1", "settings"),
                   "On %s %d settings finish, %d fail, and %d are refused or left out.",
                   fields->subject->name, finished, failed, none);
    if (best)
        statements_add(statements,
                       row_of(fields, HOLDS, 1e3 * best->deviation.rms, "mm", "smallest error"),
                       "The smallest error on %s is that of %s, %.2g mm.", fields->subject->name,
                       name_of(best), 1e3 * best->deviation.rms);
}

void race_state_reference(struct statements *statements, const struct field *field) {
    const char *scene = field->subject->name, *treatment = race_treatment(field->treatment);
    struct statement row =
        row_of(field, HOLDS, field->scene->duration, "s", "%.40s, reference", treatment);
    if (!field->has_reference) {
        row.verdict = NOT_REACHED;
        row.value = run_number(&field->reference, "simulated_time");
        statements_add(statements, row,
                       "%s with %s has no reference, and so no errors: it ended '%s' at %.3g s.",
                       scene, treatment, outcome_name(field->reference.outcome), row.value);
    } else if (field->scene->duration < field->whole->duration) {
        statements_add(statements, row,
                       "%s with %s is compared up to its separation horizon, %.3g s.", scene,
                       treatment, row.value);
    }
}

void race_state_foreign(struct statements *statements, const struct field *field,
                        const struct point *p, int number) {
    const struct point *best = race_cheapest(field, p->deviation.rms, NULL);
    const double evaluations = p->cost.evaluations, cpu = p->cost.cpu.median;
    char cost[120], ours[160] = "no run of wisplab's own errs as little";
    struct statement row = row_of(field, HOLDS, NAN, NULL, "%.16s, %.39s %d",
                                  race_treatment(field->treatment), name_of(p), number);
    if (!isnan(evaluations) && !isnan(cpu))
        snprintf(cost, sizeof cost, "with %.0f evaluations in %.3g s", evaluations, cpu);
    else if (!isnan(evaluations))
        snprintf(cost, sizeof cost, "with %.0f evaluations", evaluations);
    else if (!isnan(cpu))
        snprintf(cost, sizeof cost, "in %.3g s", cpu);
    else
        snprintf(cost, sizeof cost, "at a cost that it does not say");
    if (best) {
        row.value = isnan(cpu) ? evaluations / best->cost.evaluations : cpu / best->cost.cpu.median;
        row.unit = isnan(row.value) ? NULL : "1";
        snprintf(ours, sizeof ours, "%s errs no more with %.0f evaluations in %.3g s",
                 name_of(best), best->cost.evaluations, best->cost.cpu.median);
    }
    statements_add(statements, row,
                   "On %s the trajectory %s of another program errs %.2g mm %s; %s.",
                   field->subject->name, name_of(p), 1e3 * p->deviation.rms, cost, ours);
}

/* What was left out, and whether it could have won: it is predicted to cost more than anything that
 * was run, but where no run has reached a target whoever reaches it wins. */
static void state_cuts(struct statements *statements, const struct field *fields, int count,
                       const struct race_answers *answers) {
    const double whole = fields->subject->scene->duration;
    const char *const *cheapest = answers->cheapest + answers->subjects * RACE_TARGETS;
    char open[128] = "";
    int cut = 0;
    for (int f = 0; f < count; f++)
        for (int i = 0; i < fields[f].entry_count; i++)
            cut += fields[f].entries[i].left_out[0] != '\0';
    for (int i = 0; i < RACE_TARGETS; i++)
        if (!cheapest[i])
            snprintf(open + strlen(open), sizeof open - strlen(open), "%s%g mm",
                     open[0] ? " or " : "; they could have been within ", 1e3 * targets[i]);
    if (fields->whole->duration < whole)
        statements_add(statements, row_of(fields, NOT_REACHED, NAN, NULL, "cut"),
                       "Of %s the first %.3g of %.3g s are compared.", fields->subject->name,
                       fields->whole->duration, whole);
    if (fields->left_out[0])
        statements_add(statements, row_of(fields, NOT_REACHED, NAN, NULL, "treatments left out"),
                       "On %s nothing is run with %s, which is predicted to take too long.",
                       fields->subject->name, fields->left_out);
    if (cut)
        statements_add(statements, row_of(fields, NOT_REACHED, cut, "1", "left out"),
                       "On %s the settings of %d method%s end where runs are predicted to cost "
                       "more than any that was made, and could not have been the cheapest within "
                       "an error that was reached%s.",
                       fields->subject->name, cut, cut == 1 ? "" : "s", open);
}

void race_state_subject(struct statements *statements, const struct field *fields, int field_count,
                        struct race_answers *answers) {
    for (int i = 0; i < RACE_TARGETS; i++)
        state_target(statements, fields, field_count, i, answers);
    if (answers->asked & 1u << ANSWERS_CHOICE)
        state_choice(statements, fields, field_count, answers);
    state_failures(statements, fields, field_count, answers);
    state_points(statements, fields, field_count);
    state_cuts(statements, fields, field_count, answers);
    answers->subjects++;
}

/* --- over all scenes --- */

/* "bdf2 and bdf3": those that are among the cheapest within a target on the most scenes. Returns on
 * how many, and in `first` who is named first. */
static int list_winners(const struct race_answers *answers, int target, char text[512],
                        const char **first) {
    const int *among = answers->among + target * answers->configuration_count;
    int most = 1, count = 0, named = 0;
    for (int i = 0; i < answers->configuration_count; i++)
        most = among[i] > most ? among[i] : most;
    for (int i = 0; i < answers->configuration_count; i++)
        count += among[i] == most;
    text[0] = '\0';
    for (int i = 0; i < answers->configuration_count; i++) {
        const char *name = answers->configurations[i].name;
        const size_t used = strlen(text);
        if (among[i] != most)
            continue;
        snprintf(text + used, 512 - used, "%s%s",
                 named == 0           ? ""
                 : named + 1 == count ? " and "
                                      : ", ",
                 name);
        *first = named++ == 0 ? name : *first;
    }
    return count ? most : 0;
}

static void state_winners(struct statements *statements, const struct race_answers *answers,
                          int target) {
    const double mm = 1e3 * targets[target];
    const char *winner = NULL;
    char winners[512], more[80] = "", none[64] = "";
    const int on = list_winners(answers, target, winners, &winner);
    int alone = 0, without = 0;
    struct statement row =
        our_row(NULL, "scenes", on ? HOLDS : NOT_REACHED, NAN, NULL, "%g mm", mm);
    row.answers = ANSWERS_TARGETS;
    for (int i = 0; i < answers->subjects && on; i++) {
        const char *name = answers->cheapest[i * RACE_TARGETS + target];
        without += name == NULL;
        alone += name && strcmp(name, winner) == 0;
    }
    const int several = strcmp(winners, winner ? winner : "") != 0;
    if (alone && !several && alone < on)
        snprintf(more, sizeof more, ", on %d alone", alone);
    if (without)
        snprintf(none, sizeof none, "; on %d no run is that near", without);
    if (!on)
        statements_add(statements, row, "No run on any scene is within %g mm.", mm);
    else
        statements_add(statements, row, "Within %g mm %s %s %s on %d of %d scenes%s%s.", mm,
                       winners, several ? "are" : "is",
                       alone == on && !several ? "the cheapest" : "among the cheapest", on,
                       answers->subjects, more, none);
}

/* A claim that would hold on every scene, and what is the case where it does not. */
static void state_tally(struct statements *statements, const char *key, const char *claim,
                        const struct race_tally *tally, const char *instead) {
    struct statement row = thesis_row(NULL, "scenes", holds_if(tally->holds == tally->of),
                                      tally->holds, "1", "%s", key);
    row.answers = ANSWERS_CHOICE;
    statements_add(statements, row, "%s: of %d scenes tried, %s on %d.", claim, tally->of, instead,
                   tally->of - tally->holds);
}

void race_state_all(struct statements *statements, const struct race_answers *answers) {
    if (answers->asked & 1u << ANSWERS_TARGETS)
        for (int i = 0; i < RACE_TARGETS; i++)
            state_winners(statements, answers, i);
    if (answers->method.of > 0)
        state_tally(
            statements, "choice of the method",
            "No method is as accurate as explicit Euler with projection at 9000 Hz and cheaper",
            &answers->method, "one is");
    if (answers->treatment.of > 0)
        state_tally(statements, "choice of the treatment",
                    "Projection errs less than the method that it goes with", &answers->treatment,
                    "it errs more");
}
