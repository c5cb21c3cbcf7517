/* A race's runs read back: one point for each configuration and setting, and the Pareto fronts. */
#include "base/files.h"
#include "base/table.h"
#include "model/model.h"
#include "race.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int race_finished(const struct point *p) {
    return p->failed == 0 && isfinite(p->deviation.rms);
}

double race_cost(const struct point *p, int measure) {
    return measure == 0 ? p->cost.counted : p->cost.evaluations;
}

double race_error_at_most(const struct field *field, const struct point *p) {
    return p->error_greatest + (p->reference_limited ? field->bound : 0);
}

static struct point *new_point(struct field *field, const struct entry *entry, int k,
                               const char *status, const char *note) {
    struct point *p = &field->points[field->point_count++];
    const struct deviation none = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    *p = (struct point){.entry = entry,
                        .setting = race_setting(field, entry, k),
                        .status = status,
                        .failed = 1,
                        .run = "-",
                        .cost = no_cost,
                        .deviation = none,
                        .extent = {NAN, NAN, NAN},
                        .error_least = NAN,
                        .error_greatest = NAN};
    snprintf(p->note, sizeof p->note, "%s", note);
    return p;
}

/* --- the runs of one point --- */

struct outcome_of_run {
    enum outcome outcome;
    struct cost cost;
    struct deviation deviation;
    struct extent extent;
    const char *folder; /* in `runs`, of the plan */
    char reason[REASON_SIZE];
};

/* 0, or -1 with a reason. */
static int read_extent(const char *folder, struct extent *extent, char *reason) {
    struct table diagnoses;
    char path[PATH_SIZE];
    *extent = (struct extent){NAN, NAN, NAN};
    if (path_format(path, "%s/diagnostics.tsv", folder) || !file_exists(path))
        return 0; /* the run died before it had begun the table */
    if (table_read(&diagnoses, path, reason))
        return -1;
    extent->strain = measure_largest(&diagnoses, "strain");
    extent->penetration = measure_largest(&diagnoses, "penetration");
    extent->drift =
        measure_largest(&diagnoses, "residual") / measure_largest(&diagnoses, "kinetic");
    table_free(&diagnoses);
    return 0;
}

static int read_run(struct plan *plan, const struct field *field, const struct labelled_case *one,
                    const struct configuration *configuration, struct outcome_of_run *result) {
    const struct scene *scene = field->scene;
    struct run_files run;
    int code = 0;
    if (plan_read(plan, one, &run))
        return -1;
    const char *reason = json_string_value(json_object_get(run.json, "reason"));
    result->outcome = run.outcome;
    result->cost = run_cost(&run);
    cost_count(&result->cost, scene, (enum wisp_treatment)field->treatment, configuration);
    result->deviation.rms = result->deviation.history_diverged = NAN;
    result->folder = strrchr(one->run.folder, '/') + 1;
    snprintf(result->reason, REASON_SIZE, "%s", reason ? reason : "");
    if (run.outcome == FINISHED && field->has_reference)
        code =
            measure_deviation(scene, run.states, field->reference.states,
                              scene->run.atol / scene->run.rtol, &result->deviation, plan->reason);
    run_free(&run);
    return code ? code : read_extent(one->run.folder, &result->extent, plan->reason);
}

static int by_error(const void *a, const void *b) {
    const double x = ((const struct outcome_of_run *)a)->deviation.rms,
                 y = ((const struct outcome_of_run *)b)->deviation.rms;
    return (x > y) - (x < y);
}

/* The point of a set of runs, all finished: the one with the median error stands for it, the first
 * one for how far it went and, being timed, for its CPU time. */
static void summarise(struct point *p, struct outcome_of_run *runs, int count) {
    const struct spread cpu = runs[0].cost.cpu;
    p->extent = runs[0].extent;
    qsort(runs, (size_t)count, sizeof *runs, by_error);
    p->cost = runs[count / 2].cost;
    p->deviation = runs[count / 2].deviation;
    p->run = runs[count / 2].folder;
    p->error_least = runs[0].deviation.rms;
    p->error_greatest = runs[count - 1].deviation.rms;
    p->cost.cpu = cpu;
}

/* Nothing is dropped: a point of which some run failed is a failure, and says of how many. */
static void record_failure(struct point *p, const struct outcome_of_run *runs, int count) {
    int first = 0;
    while (runs[first].outcome == FINISHED)
        first++;
    p->cost = runs[first].cost;
    p->extent = runs[0].extent;
    p->run = runs[first].folder;
    p->status = outcome_name(runs[first].outcome);
    if (count == 1)
        snprintf(p->note, sizeof p->note, "%s", runs[first].reason);
    else
        snprintf(p->note, sizeof p->note, "%d of %d jittered runs: %.200s", p->failed, count,
                 runs[first].reason);
}

/* Wisps that split at other ticks than the reference's are on the chart as a failure: their error
 * is of fewer frames. */
static int record_divergence(struct point *p, const struct outcome_of_run *run) {
    p->cost = run->cost;
    p->status = "diverged history";
    p->run = run->folder;
    snprintf(p->note, sizeof p->note,
             "wisps split at other ticks than the reference's; compared before %.6g s",
             run->deviation.history_diverged);
    return 1;
}

static int read_point(struct plan *plan, struct field *field, const struct entry *entry, int k) {
    struct outcome_of_run runs[JITTERS];
    struct point *p =
        new_point(field, entry, k, outcome_name(FINISHED),
                  race_is_expensive(field, entry, k) ? "not diagnosed, for its cost" : "");
    const struct settings *settings = &race_case(plan, field, entry, k, 0)->run.settings;
    const int count = race_jitters(plan, field, entry, k);
    p->lanes = settings_lanes(settings);
    p->threads = settings->threads;
    p->runs = count;
    p->failed = 0;
    for (int j = 0; j < count; j++) {
        if (read_run(plan, field, race_case(plan, field, entry, k, j), entry->configuration,
                     &runs[j]))
            return -1;
        p->failed += runs[j].outcome != FINISHED;
    }
    int diverged = 0;
    for (int j = 0; j < count && !p->failed && !diverged; j++)
        if (!isnan(runs[j].deviation.history_diverged))
            diverged = record_divergence(p, &runs[j]);
    if (p->failed)
        record_failure(p, runs, count);
    else if (diverged)
        p->failed = count;
    else
        summarise(p, runs, count);
    p->reference_limited = p->deviation.rms < 10 * field->bound;
    return 0;
}

/* A configuration that is refused, or of which something is left out, gets a line that says so. Of
 * the steps of a search that found no stable one, the chart has those that were tried. */
static int read_entry(struct plan *plan, struct field *field, const struct entry *entry) {
    if (entry->refused[0]) {
        new_point(field, entry, 0, outcome_name(REFUSED), entry->refused);
        return 0;
    }
    for (int k = entry->first; k <= entry->last; k++)
        if (race_case(plan, field, entry, k, 0) && read_point(plan, field, entry, k))
            return -1;
    if (entry->left_out[0])
        new_point(field, entry, entry->last + 1, "left out", entry->left_out);
    return 0;
}

/* What a force evaluation costs, by who does little else: the explicit method with fixed steps that
 * has the highest order, in its longest run. */
static void read_evaluation(struct field *field) {
    const struct point *best = NULL;
    field->evaluation = NAN;
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        const struct stepper_method *method = p->entry->configuration->method;
        if (race_finished(p) && !(method->capabilities & (STEPPER_ADAPTIVE | STEPPER_IMPLICIT)) &&
            (!best || method->order > best->entry->configuration->method->order ||
             (method->order == best->entry->configuration->method->order &&
              p->cost.evaluations > best->cost.evaluations)))
            best = p;
    }
    if (best)
        field->evaluation = best->cost.cpu.median / best->cost.evaluations;
}

/* Where a reference failed its runs keep their rows, without errors. */
static int read_reference(struct plan *plan, struct field *field) {
    if (plan_read(plan, find_case(plan, field->group, "reference"), &field->reference))
        return -1;
    field->has_reference = field->reference.outcome == FINISHED;
    field->bound = run_number(&field->reference, "cross_check.bound");
    return 0;
}

/* --- fronts --- */

/* Marks the points that no other one beats in cost and in error. Limited ones are left out: how
 * good they are cannot be told from the reference, and so not whom they beat. */
static void mark_front(struct field *field, int measure) {
    for (int i = 0; i < field->point_count; i++) {
        struct point *p = &field->points[i];
        p->front[measure] = race_finished(p) && !p->reference_limited;
        for (int j = 0; j < field->point_count && p->front[measure]; j++) {
            const struct point *other = &field->points[j];
            const int as_good = race_finished(other) && !other->reference_limited && j != i &&
                                race_cost(other, measure) <= race_cost(p, measure) &&
                                other->deviation.rms <= p->deviation.rms;
            const int better = race_cost(other, measure) < race_cost(p, measure) ||
                               other->deviation.rms < p->deviation.rms;
            if (as_good && (better || j < i))
                p->front[measure] = 0;
        }
    }
}

void race_mark_fronts(struct field *field) {
    mark_front(field, 0);
    mark_front(field, 1);
}

static int is_cheaper(const struct field *field, double target, const struct point *p,
                      const struct point *than) {
    return race_finished(p) && race_error_at_most(field, p) <= target &&
           (!than || p->cost.counted < than->cost.counted);
}

const struct point *race_cheapest(const struct field *field, double target,
                                  const struct configuration *besides) {
    const struct point *best = NULL;
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        if (p->entry->configuration != besides && is_cheaper(field, target, p, best))
            best = p;
    }
    return best;
}

const struct point *race_cheapest_of(const struct field *field, double target,
                                     const struct configuration *configuration) {
    const struct point *best = NULL;
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        if (p->entry->configuration == configuration && is_cheaper(field, target, p, best))
            best = p;
    }
    return best;
}

/* How far the treatment itself is from the exact constrained motion, whoever integrates it. */
static int read_treatment_error(struct plan *plan, struct field *field) {
    struct run_files exact;
    struct deviation deviation;
    int code = 0;
    const struct labelled_case *one = find_case(plan, field->group, "exact");
    field->treatment_error = NAN;
    if (!one || !field->has_reference)
        return 0;
    if (plan_read(plan, one, &exact))
        return -1;
    if (exact.outcome == FINISHED) {
        code = measure_deviation(field->whole, field->reference.states, exact.states, 1, &deviation,
                                 plan->reason);
        field->treatment_error = deviation.rms;
    }
    run_free(&exact);
    return code;
}

int race_read(struct plan *plan, struct field *field) {
    field->point_count = 0;
    if (read_reference(plan, field) || read_treatment_error(plan, field))
        return -1;
    for (int i = 0; i < field->entry_count; i++)
        if (read_entry(plan, field, &field->entries[i]))
            return -1;
    read_evaluation(field);
    race_mark_fronts(field);
    return 0;
}
