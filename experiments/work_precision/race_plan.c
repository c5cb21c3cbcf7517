/* The plan of a race: references, horizons, pilots; then ladders of steps and tolerances that fit
 * the budget. */
#include "base/files.h"
#include "model/model.h"
#include "model/problems.h"
#include "race.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- names --- */

const char *race_treatment(int treatment) {
    return wisp_problem.treatments[treatment].name;
}

void race_group(char group[128], const struct field *field) {
    snprintf(group, 128, "%s %s", field->subject->name, race_treatment(field->treatment));
}

static int adds(struct plan *plan, const struct field *field, const struct scene *scene,
                const struct run_request *request, const char *label) {
    char group[128];
    race_group(group, field);
    return plan_add(plan, scene, request, group, "%s", label);
}

static const struct labelled_case *found(const struct plan *plan, const struct field *field,
                                         const char *label) {
    char group[128];
    race_group(group, field);
    return find_case(plan, group, label);
}

/* --- scenes --- */

static int wants_treatment(const struct race *race, const struct scene *scene, int treatment) {
    int wanted = race->treatments == NULL;
    for (int i = 0; !wanted && race->treatments[i]; i++)
        wanted = strcmp(race->treatments[i], race_treatment(treatment)) == 0;
    /* without an envelope the treatments are the same equations */
    return scene->wisps[0].samples > 0 ? wanted : treatment == WISP_GENERALISED;
}

/* --- the first stage --- */

static struct run_request reference_request(const struct field *field) {
    return (struct run_request){.stepper = "reference",
                                .treatment = race_treatment(field->treatment)};
}

/* At the scene's own step, or a tolerance in the middle of the ladder. */
static double pilot_setting(const struct field *field, const struct configuration *contestant) {
    return contestant_is_adaptive(contestant) ? 1e-4 : field->whole->run.step;
}

static int plan_pilots(struct plan *plan, struct field *field) {
    const struct scene *scene = field->whole;
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct configuration *contestant = &plan->configurations[c];
        struct entry *entry = &field->entries[field->entry_count++];
        struct run_request request = contestant_request(
            contestant, pilot_setting(field, contestant), scene->run.atol / scene->run.rtol);
        char label[64];
        *entry = (struct entry){.contestant = contestant};
        request.treatment = race_treatment(field->treatment);
        snprintf(label, sizeof label, "pilot of %s", contestant->name);
        if (plan_takes(plan, scene, &request, entry->refused) &&
            adds(plan, field, scene, &request, label))
            return -1;
    }
    return 0;
}

/* `exact` is the scene whose penalty stands for the exact motion, or NULL. */
static int plan_field(struct plan *plan, struct field *field, const struct scene *exact) {
    struct run_request request = reference_request(field);
    if (adds(plan, field, field->whole, &request, "tight"))
        return -1;
    request.perturbation = HORIZON_PERTURBATION;
    request.draw = 1;
    if (field->touches && adds(plan, field, field->whole, &request, "tight, perturbed"))
        return -1;
    const struct run_request stiff = {.stepper = "reference", .treatment = "penalty"};
    if (exact && adds(plan, field, exact, &stiff, "exact"))
        return -1;
    return plan_pilots(plan, field);
}

static double budget(const struct plan *plan, const struct race *race) {
    return plan_budget(plan, plan->quick ? race->quick_seconds : race->seconds);
}

/* A fifth of the budget may go to references. */
static double affordable_duration(const struct plan *plan, const struct race *race,
                                  const struct scene *scene) {
    int runs = 0;
    for (int t = 0; wisp_problem.treatments[t].name; t++)
        runs += wants_treatment(race, scene, t) * (scene_has_contacts(scene) ? 2 : 1);
    const double cores = 2, share = budget(plan, race) / 5 / plan->subject_count * cores;
    return share / (reference_cost(scene) * runs);
}

static int plan_scenes(struct plan *plan, struct race_notes *notes) {
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        const double duration =
            fmin(subject->scene->duration, affordable_duration(plan, notes->race, subject->scene));
        const double rate = sparse_frame_rate(subject->scene, duration);
        const struct scene *scene = plan_cut_scene(plan, subject, rate, duration, NULL),
                           *exact = NULL;
        if (scene && scene->wisps[0].samples > 0)
            exact = plan_cut_scene(plan, subject, rate, duration,
                                   "envelope.penalty_ratio=" EXACT_RATIO ".0");
        if (!scene || (scene->wisps[0].samples > 0 && !exact))
            return -1;
        for (int t = 0; wisp_problem.treatments[t].name; t++) {
            struct field *field = &notes->fields[notes->field_count];
            if (!wants_treatment(notes->race, scene, t))
                continue;
            field->subject = subject;
            field->whole = field->scene = scene;
            field->treatment = t;
            field->touches = scene_has_contacts(scene);
            notes->field_count++;
            if (plan_field(plan, field, exact))
                return -1;
        }
    }
    return 0;
}

static int list_length(const char *const *list) {
    int count = 0;
    while (list[count])
        count++;
    return count;
}

int race_plan(struct plan *plan, const struct race *race) {
    const char *const *own = plan->quick ? race->quick_scenes : race->scenes;
    plan->run_seconds = 60;
    if (plan_configurations(plan, race->kinds, race->capabilities) ||
        plan_subjects(plan, own, list_length(own)))
        return -1;
    const size_t fields = 3 * (size_t)plan->subject_count,
                 entries = (size_t)plan->configuration_count;
    struct race_notes *notes = calloc(1, sizeof *notes + fields * sizeof *notes->fields +
                                             fields * entries * sizeof(struct entry));
    plan->memo = notes;
    if (!notes) {
        snprintf(plan->reason, REASON_SIZE, "out of memory");
        return -1;
    }
    notes->race = race;
    for (size_t f = 0; f < fields; f++) /* behind the fields */
        notes->fields[f].entries = (struct entry *)(notes->fields + fields) + f * entries;
    return plan_scenes(plan, notes);
}

/* --- what the first stage tells --- */

/* Reads how long trajectories may be compared, and cuts the field's scene to that. */
static int read_horizon(struct plan *plan, struct field *field) {
    const struct labelled_case *tight = found(plan, field, "tight"),
                               *perturbed = found(plan, field, "tight, perturbed");
    field->horizon = field->whole->duration;
    if (!perturbed)
        return 0;
    if (measure_horizon(tight->run.folder, perturbed->run.folder, &field->horizon, plan->reason))
        return -1;
    if (isnan(field->horizon) || field->horizon >= field->whole->duration)
        return 0;
    field->scene =
        plan_cut_scene(plan, field->subject, field->whole->frame_rate, field->horizon, NULL);
    return field->scene ? 0 : -1;
}

/* Whose pilot tells what a force evaluation costs, for it does little else: the explicit method
 * with fixed steps that has the highest order. NULL: there is none. */
static const struct entry *yardstick_of(const struct field *field) {
    const struct entry *best = NULL;
    for (int i = 0; i < field->entry_count; i++) {
        const struct entry *entry = &field->entries[i];
        const struct stepper_method *method = entry->contestant->method;
        if (!entry->refused[0] && !(method->capabilities & (STEPPER_ADAPTIVE | STEPPER_IMPLICIT)) &&
            (!best || method->order > best->contestant->method->order))
            best = entry;
    }
    return best;
}

static int read_pilot(struct plan *plan, struct field *field, struct entry *entry) {
    char label[64];
    struct run_files run;
    snprintf(label, sizeof label, "pilot of %s", entry->contestant->name);
    const struct labelled_case *pilot = found(plan, field, label);
    entry->cost = NAN;
    if (!pilot)
        return 0;
    if (run_read(&run, pilot->run.folder, plan->reason))
        return -1;
    const double time = run_number(&run, "simulated_time") - field->scene->begin,
                 cpu = run_number(&run, "cpu_seconds");
    if (time > 0 && cpu > 0) {
        entry->cost = cpu / time;
        if (entry == yardstick_of(field))
            field->evaluation = cpu / run_number(&run, "counters.force_evaluations");
    }
    run_free(&run);
    return 0;
}

/* --- ladders --- */

double race_setting(const struct field *field, const struct entry *entry, int k) {
    return contestant_is_adaptive(entry->contestant)
               ? pow(10, -1 + (log10(entry->contestant->finest) + 1) * k / (TOLERANCES - 1))
               : ladder_step(field->whole, 2, k);
}

int race_takes(const struct plan *plan, int k) {
    return !plan->quick || k % 3 == 0;
}

/* CPU time of one run at rung k, s: a fixed step costs what the pilot's did; an adaptive method of
 * order p takes steps like rtol^(-1/(p+1)). With what it takes to start a process. */
static double run_cost_at(const struct field *field, const struct entry *entry, int k) {
    const double setting = race_setting(field, entry, k),
                 pilot = pilot_setting(field, entry->contestant);
    const double power =
        contestant_is_adaptive(entry->contestant) ? 1. / (entry->contestant->order + 1) : 1;
    const double process = 0.012;
    return process + field->scene->duration * entry->cost * pow(pilot / setting, power);
}

static int timings_at(const struct field *field, const struct entry *entry, int k) {
    return contestant_is_adaptive(entry->contestant) ? 1
           : run_cost_at(field, entry, k) > 0.2      ? 2
                                                     : 5;
}

/* Rungs worth having: of an adaptive method all; of a fixed step the first ten, and until six are
 * stable by linear theory; and besides what takes next to no time. */
static int wanted_rungs(const struct field *field, const struct entry *entry) {
    if (isnan(entry->cost))
        return 0;
    if (contestant_is_adaptive(entry->contestant))
        return TOLERANCES;
    int stable = 0, k = 0;
    for (; k < RUNGS_MAX; k++) {
        if (k >= 10 && stable >= 6 && run_cost_at(field, entry, k) > 0.05)
            break;
        stable +=
            seems_stable(entry->contestant->method, field->whole, race_setting(field, entry, k));
    }
    return k;
}

/* Wall time of an entry's first `rungs`, s: timed runs have the machine to themselves. */
static double ladder_cost(const struct plan *plan, const struct field *field,
                          const struct entry *entry, int rungs, int jitters) {
    const int runs = contestant_is_adaptive(entry->contestant) ? jitters : 1;
    const double diagnosed = 1.6; /* times as long as one that is not */
    double sum = 0;
    for (int k = 0; k < rungs; k++)
        if (race_takes(plan, k))
            sum += runs * (diagnosed + timings_at(field, entry, k)) * run_cost_at(field, entry, k);
    return sum;
}

/* Runs of each tolerance where the budget allows all. */
static int most_jitters(const struct plan *plan) {
    return plan->quick ? 3 : JITTERS;
}

/* The longest ladder within a share of the budget; jittered runs become fewer before an adaptive
 * method's ladder does. */
static void fit_ladder(const struct plan *plan, const struct field *field, struct entry *entry,
                       double share) {
    const int jitters[] = {most_jitters(plan), 3, 1};
    const int adaptive = contestant_is_adaptive(entry->contestant);
    const int wanted = wanted_rungs(field, entry);
    for (int i = 0; i < 3; i++) {
        entry->jitters = adaptive ? jitters[i] : 1;
        entry->rungs = wanted;
        while (entry->rungs > 0 &&
               ladder_cost(plan, field, entry, entry->rungs, entry->jitters) > share)
            entry->rungs--;
        if (!adaptive || entry->rungs == wanted)
            break;
    }
    entry->shortened = entry->rungs < wanted;
    entry->thinned = adaptive && entry->jitters < most_jitters(plan);
    if (entry->shortened)
        snprintf(entry->cut, sizeof entry->cut,
                 "this and shorter ones: a run would take about %.2g s; the budget left %.2g s%s",
                 run_cost_at(field, entry, entry->rungs), share,
                 entry->thinned ? ", and fewer jittered runs" : "");
    else if (entry->thinned)
        snprintf(entry->cut, sizeof entry->cut, "%d jittered runs instead of %d, for the budget",
                 entry->jitters, most_jitters(plan));
}

/* --- the budget --- */

/* What one may take of `budget` when `left` want some of it, this one being the most modest. */
struct share {
    double need;
    int index;
};

static int by_need(const void *a, const void *b) {
    const struct share *x = a, *y = b;
    return x->need != y->need ? (x->need > y->need) - (x->need < y->need) : x->index - y->index;
}

/* Gives everyone an equal part of the budget; what the modest leave goes to the rest. */
static void share_out(double seconds, struct share *shares, int count) {
    qsort(shares, (size_t)count, sizeof *shares, by_need);
    for (int i = 0; i < count; i++) {
        const double part = fmax(0, seconds) / (count - i);
        shares[i].need = fmin(shares[i].need, part);
        seconds -= shares[i].need;
    }
}

static double entry_need(const struct plan *plan, const struct field *field,
                         const struct entry *entry) {
    return ladder_cost(plan, field, entry, wanted_rungs(field, entry), most_jitters(plan));
}

static double field_need(const struct plan *plan, const struct field *field) {
    double sum = 0;
    for (int i = 0; i < field->entry_count; i++)
        sum += entry_need(plan, field, &field->entries[i]);
    return sum;
}

/* `shares` has room for all entries. */
static void fit_field(const struct plan *plan, struct field *field, double seconds,
                      struct share *shares) {
    for (int i = 0; i < field->entry_count; i++)
        shares[i] = (struct share){entry_need(plan, field, &field->entries[i]), i};
    share_out(seconds, shares, field->entry_count);
    for (int i = 0; i < field->entry_count; i++)
        if (!field->entries[shares[i].index].refused[0])
            fit_ladder(plan, field, &field->entries[shares[i].index], shares[i].need * (1 + 1e-9));
}

/* CPU time of the runs there are, s. */
static int time_spent(struct plan *plan, double *seconds) {
    *seconds = 0;
    for (int i = 0; i < plan->case_count; i++) {
        struct run_files run;
        if (run_read(&run, plan->cases[i].run.folder, plan->reason))
            return -1;
        *seconds += run_number(&run, "cpu_seconds");
        run_free(&run);
    }
    return 0;
}

/* --- the second stage --- */

static struct run_request request_for(const struct field *field, const struct entry *entry, int k,
                                      int j) {
    const struct scene *scene = field->scene;
    const double jitter = contestant_is_adaptive(entry->contestant) ? 1 + j * 1e-12 : 1;
    struct run_request request =
        contestant_request(entry->contestant, race_setting(field, entry, k) * jitter,
                           scene->run.atol / scene->run.rtol);
    request.treatment = race_treatment(field->treatment);
    request.timings = timings_at(field, entry, k); /* these go without diagnoses */
    request.diagnostics = 1;
    return request;
}

static void name_run(char label[64], const struct entry *entry, int k, int j) {
    snprintf(label, 64, "%s, rung %d.%d", entry->contestant->name, k, j);
}

const struct labelled_case *race_case(const struct plan *plan, const struct field *field,
                                      const struct entry *entry, int k, int j) {
    char label[64];
    name_run(label, entry, k, j);
    return found(plan, field, label);
}

static int plan_entry(struct plan *plan, const struct field *field, const struct entry *entry) {
    for (int k = 0; k < entry->rungs; k++)
        for (int j = 0; j < entry->jitters && race_takes(plan, k); j++) {
            const struct run_request request = request_for(field, entry, k, j);
            char label[64];
            name_run(label, entry, k, j);
            if (adds(plan, field, field->scene, &request, label))
                return -1;
        }
    return 0;
}

/* What a field's references and pilots tell. */
static int read_first_stage(struct plan *plan, struct field *field) {
    field->evaluation = NAN;
    if (read_horizon(plan, field))
        return -1;
    for (int i = 0; i < field->entry_count; i++)
        if (read_pilot(plan, field, &field->entries[i]))
            return -1;
    return 0;
}

/* A fifth of the budget is for tables, figures and what estimates are wrong by. */
static int fit_fields(struct plan *plan, struct race_notes *notes) {
    const int fields = notes->field_count;
    struct share *shares = calloc((size_t)(fields + plan->configuration_count) + 1, sizeof *shares);
    double spent;
    if (!shares)
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    if (!shares || time_spent(plan, &spent)) {
        free(shares);
        return -1;
    }
    for (int f = 0; f < notes->field_count; f++)
        shares[f] = (struct share){field_need(plan, &notes->fields[f]), f};
    share_out(0.8 * budget(plan, notes->race) - spent / 2, shares, notes->field_count);
    for (int i = 0; i < notes->field_count; i++)
        fit_field(plan, &notes->fields[shares[i].index], shares[i].need * (1 + 1e-9),
                  shares + fields);
    free(shares);
    return 0;
}

int race_refine(struct plan *plan) {
    struct race_notes *notes = plan->memo;
    if (notes->laddered)
        return 0;
    notes->laddered = 1;
    for (int f = 0; f < notes->field_count; f++)
        if (read_first_stage(plan, &notes->fields[f]))
            return -1;
    if (fit_fields(plan, notes))
        return -1;
    for (int f = 0; f < notes->field_count; f++)
        for (int i = 0; i < notes->fields[f].entry_count; i++)
            if (plan_entry(plan, &notes->fields[f], &notes->fields[f].entries[i]))
                return -1;
    return 0;
}
