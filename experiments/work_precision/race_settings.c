/* Which settings a race's charts have, by costs that are known before anything is run.
 *
 * A method with fixed steps has those from two levels beyond its largest stable step to six below
 * it. The costliest of these, of the usual methods on a scene, is how deep the scene's charts are:
 * all methods have every level that is predicted to cost no more, so that what is left out cannot
 * have been the cheapest within an error that some run has reached. */
#include "model/problems.h"
#include "race.h"

#include <math.h>
#include <string.h>

const char *race_treatment(int treatment) {
    return wisp_problem.treatments[treatment].name;
}

double race_setting(const struct field *field, const struct entry *entry, int k) {
    return configuration_is_adaptive(entry->configuration)
               ? pow(10, -1 + (log10(entry->configuration->finest) + 1) * k / (TOLERANCES - 1))
               : sequence_step(field->whole, 2, k);
}

/* --- predicted costs --- */

static const double process_cost = 0.012; /* to start one, s */

/* No run that is predicted to take longer is tried, s. */
static double costliest(const struct plan *plan) {
    return plan->quick ? 0.5 : 1;
}

/* The cost of steps that long, one after the other in all wisps. */
static double steps_cost(const struct field *field, const struct configuration *configuration,
                         double step) {
    return process_cost +
           estimated_cost(field->scene, (enum wisp_treatment)field->treatment, configuration, step);
}

/* An adaptive method of order p takes steps like rtol^(-1/(p+1)). */
double race_predicted(const struct field *field, const struct entry *entry, int k) {
    const struct configuration *configuration = entry->configuration;
    const double setting = race_setting(field, entry, k);
    if (!configuration_is_adaptive(configuration))
        return steps_cost(field, configuration, setting);
    const double pace = entry->pace * pow(race_setting(field, entry, LEVEL_PROBED) / setting,
                                          1. / (configuration->order + 1));
    return steps_cost(field, configuration, field->scene->wisp_count / pace);
}

/* A run that takes so long, s, is done once, without diagnoses, and that is its time. */
static const double expensive = 0.1;

int race_is_expensive(const struct field *field, const struct entry *entry, int k) {
    return race_predicted(field, entry, k) > expensive;
}

int race_jitters(const struct plan *plan, const struct field *field, const struct entry *entry,
                 int k) {
    return !configuration_is_adaptive(entry->configuration) || race_is_expensive(field, entry, k)
               ? 1
           : plan->quick ? 3
                         : JITTERS;
}

int race_timings(const struct plan *plan, const struct field *field, const struct entry *entry,
                 int k, int j) {
    return j > 0 ? 0 : race_is_expensive(field, entry, k) ? 1 : plan->quick ? 2 : 3;
}

/* --- the largest stable step --- */

static int first_seen_stable(const struct field *field, const struct entry *entry) {
    int k = 0;
    while (k < LEVELS_MAX - 1 &&
           !seems_stable(entry->configuration->method, field->whole, race_setting(field, entry, k)))
        k++;
    return k;
}

static int is_too_expensive(const struct plan *plan, const struct field *field,
                            const struct entry *entry, int k) {
    return k >= LEVELS_MAX || race_predicted(field, entry, k) > costliest(plan);
}

void race_search(const struct plan *plan, const struct field *field, struct entry *entry) {
    const int adaptive = configuration_is_adaptive(entry->configuration);
    entry->pace = NAN;
    entry->place = bracket_begin(adaptive ? LEVEL_PROBED : first_seen_stable(field, entry), 0);
    entry->searching = adaptive || !is_too_expensive(plan, field, entry, entry->place.at);
}

/* An octave at a time, then the level between. Where a limit has ended the run, shorter steps are
 * of no use. */
void race_search_on(const struct plan *plan, const struct field *field, struct entry *entry,
                    enum outcome outcome) {
    const int octave = 2;
    const int cut_off = outcome == OUT_OF_TIME || outcome == OUT_OF_MEMORY;
    if (cut_off)
        entry->stopped = outcome_name(outcome);
    entry->searching = !configuration_is_adaptive(entry->configuration) &&
                       bracket_take(&entry->place, outcome == FINISHED, octave, 1) && !cut_off &&
                       !is_too_expensive(plan, field, entry, entry->place.at);
}

/* --- the charts --- */

/* The finest level, up to `last`, that is predicted to cost no more than `cap`, s; or -1. */
static int finest_within(const struct field *field, const struct entry *entry, int last,
                         double cap) {
    int k = last;
    while (k >= 0 && !(race_predicted(field, entry, k) <= cap * (1 + 1e-9)))
        k--;
    return k;
}

/* Whether a method has a say in how deep the charts are: its steps are of fixed length, and they
 * do not cost many times those of others. */
static int decides_depth(const struct configuration *configuration) {
    return !configuration_is_adaptive(configuration) && configuration->kind != CONFIGURATION_COSTLY;
}

/* The predicted cost of the sixth level below the largest stable one; 0 where there is none. */
static double needed(const struct plan *plan, const struct field *field,
                     const struct entry *entry) {
    if (entry->refused[0] || !decides_depth(entry->configuration) || entry->place.reached < 0)
        return 0;
    const int below = (int)fmin(entry->place.reached + LEVELS_BELOW, LEVELS_MAX - 1);
    return race_predicted(field, entry, finest_within(field, entry, below, costliest(plan)));
}

static void fit_fixed(const struct field *field, struct entry *entry, double cap) {
    const int reached = entry->place.reached;
    if (reached < 0) {
        /* What was tried is in the chart, as failures. */
        entry->first = 0;
        entry->last = entry->place.missed;
        if (entry->stopped)
            snprintf(entry->left_out, sizeof entry->left_out,
                     "this and shorter steps: longer ones were %s already", entry->stopped);
        else
            snprintf(entry->left_out, sizeof entry->left_out,
                     "no step is stable of which a run is predicted to take less than %.2g s", cap);
        return;
    }
    entry->first = reached > LEVELS_BEYOND ? reached - LEVELS_BEYOND : 0;
    entry->last = finest_within(field, entry, LEVELS_MAX - 1, cap);
    if (entry->last < LEVELS_MAX - 1)
        snprintf(entry->left_out, sizeof entry->left_out,
                 "this and shorter steps: a run is predicted to take more than %.2g s", cap);
}

static void fit_adaptive(const struct field *field, struct entry *entry, double cap) {
    entry->first = 0;
    entry->last = finest_within(field, entry, TOLERANCES - 1, cap);
    if (isnan(entry->pace)) {
        entry->first = entry->last = LEVEL_PROBED;
        snprintf(entry->left_out, sizeof entry->left_out,
                 "other tolerances: with this one no step succeeded");
    } else if (entry->last < TOLERANCES - 1) {
        snprintf(entry->left_out, sizeof entry->left_out,
                 "this and tighter ones: a run is predicted to take more than %.2g s", cap);
    }
}

void race_fit(const struct plan *plan, struct field *fields, int field_count) {
    double cap = plan->quick ? 0.03 : 0.1; /* what costs no more is in every chart, s */
    for (int f = 0; f < field_count; f++)
        for (int i = 0; i < fields[f].entry_count; i++)
            cap = fmax(cap, needed(plan, &fields[f], &fields[f].entries[i]));
    for (int f = 0; f < field_count; f++)
        for (int i = 0; i < fields[f].entry_count; i++) {
            struct entry *entry = &fields[f].entries[i];
            if (entry->refused[0])
                continue;
            if (configuration_is_adaptive(entry->configuration))
                fit_adaptive(&fields[f], entry, cap);
            else
                fit_fixed(&fields[f], entry, cap);
        }
}

int race_takes(const struct plan *plan, const struct entry *entry, int k) {
    return !plan->quick || !configuration_is_adaptive(entry->configuration) || k % 2 == 0;
}

/* --- how long a scene is run --- */

static int would_run(struct plan *plan, const struct field *field, const struct entry *entry) {
    struct run_request request = configuration_request(
        entry->configuration, race_setting(field, entry, 0), field->scene->run.atol);
    char reason[REASON_SIZE];
    request.treatment = race_treatment(field->treatment);
    return plan_takes(plan, field->scene, &request, reason);
}

/* What the charts of one treatment will cost for a simulated second, by linear theory: the levels
 * of one method together cost 3.4 times the costliest of them, and what is not expensive is run
 * with diagnoses, which takes 1.6 times as long, and twice for its time. */
static double charts_cost(struct plan *plan, const struct scene *scene, int treatment) {
    const double together = 3.4, below = exp2(LEVELS_BELOW / 2.);
    struct field field = {.whole = scene, .scene = scene, .treatment = treatment};
    double cap = 0;
    int count = 0;
    for (int c = 0; c < plan->configuration_count; c++) {
        const struct entry entry = {.configuration = &plan->configurations[c]};
        if (!would_run(plan, &field, &entry))
            continue;
        count++;
        if (!decides_depth(entry.configuration))
            continue;
        const double step = race_setting(&field, &entry, first_seen_stable(&field, &entry));
        cap = fmax(cap, steps_cost(&field, entry.configuration, step / below));
    }
    cap = fmin(cap, costliest(plan));
    const double cheap = fmin(cap, expensive);
    return together * (3.6 * cheap + (cap - cheap)) * count / scene->duration;
}

/* The cost of one treatment, with its references, per simulated second. */
static double treatment_cost(struct plan *plan, const struct scene *scene, int treatment) {
    return charts_cost(plan, scene, treatment) +
           reference_cost(scene) * (scene_has_contacts(scene) ? 2 : 1);
}

/* Takes the costliest of the treatments out, of equal ones the last. Returns which it was. */
static int drop_costliest(struct plan *plan, const struct scene *scene, int *treatments,
                          int count) {
    int costliest_at = 0;
    double most = 0;
    for (int i = 0; i < count; i++) {
        const double cost = treatment_cost(plan, scene, treatments[i]);
        if (cost >= most) {
            most = cost;
            costliest_at = i;
        }
    }
    const int dropped = treatments[costliest_at];
    for (int i = costliest_at; i + 1 < count; i++)
        treatments[i] = treatments[i + 1];
    return dropped;
}

double race_afford(struct plan *plan, const struct race *race, const struct scene *scene,
                   int *treatments, int *count, char left_out[64]) {
    const double budget = (plan->quick ? race->quick_seconds : race->seconds) / plan->subject_count;
    const double least = fmin(scene->duration, plan->quick ? 0.1 : 1);
    for (left_out[0] = '\0';;) {
        double cost = 0;
        for (int i = 0; i < *count; i++)
            cost += treatment_cost(plan, scene, treatments[i]);
        if (*count == 1 || cost * least <= budget)
            return fmin(scene->duration, fmax(least, budget / cost));
        const size_t used = strlen(left_out);
        snprintf(left_out + used, 64 - used, "%s%s", used ? " and " : "",
                 race_treatment(drop_costliest(plan, scene, treatments, *count)));
        --*count;
    }
}
