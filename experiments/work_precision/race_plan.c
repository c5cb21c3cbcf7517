/* The plan of a race: references and horizons; searches for the largest stable steps; then the
 * settings of the charts. */
#include "base/files.h"
#include "model/model.h"
#include "model/problems.h"
#include "race.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- runs --- */

static struct run_request request_for(const struct plan *plan, const struct field *field,
                                      const struct entry *entry, int k, int j) {
    const struct scene *scene = field->scene;
    const double jitter = configuration_is_adaptive(entry->configuration) ? 1 + j * 1e-12 : 1;
    struct run_request request =
        configuration_request(entry->configuration, race_setting(field, entry, k) * jitter,
                              scene->run.atol / scene->run.rtol);
    request.treatment = race_treatment(field->treatment);
    request.timings = race_timings(plan, field, entry, k, j); /* these go without diagnoses */
    request.diagnostics = j == 0 && !race_is_expensive(field, entry, k);
    return request;
}

#define RUN_LABEL "%s, level %d.%d" /* configuration, level, jitter */

const struct labelled_case *race_case(const struct plan *plan, const struct field *field,
                                      const struct entry *entry, int k, int j) {
    return find_case(plan, field->group, RUN_LABEL, entry->configuration->name, k, j);
}

/* A search and a chart may want the same run. */
static int plan_run(struct plan *plan, const struct field *field, const struct entry *entry, int k,
                    int j) {
    const struct run_request request = request_for(plan, field, entry, k, j);
    return race_case(plan, field, entry, k, j)
               ? 0
               : plan_add(plan, field->scene, &request, field->group, RUN_LABEL,
                          entry->configuration->name, k, j);
}

/* What a search waits for: of a fixed step the run of the chart; of an adaptive method one more,
 * for nobody knows yet whether that is worth its time. */
#define PROBE_LABEL "%s, probe"

static const struct labelled_case *searched_case(const struct plan *plan, const struct field *field,
                                                 const struct entry *entry) {
    return configuration_is_adaptive(entry->configuration)
               ? find_case(plan, field->group, PROBE_LABEL, entry->configuration->name)
               : race_case(plan, field, entry, entry->place.at, 0);
}

static int plan_searched(struct plan *plan, const struct field *field, const struct entry *entry) {
    struct run_request request = request_for(plan, field, entry, entry->place.at, 0);
    if (!configuration_is_adaptive(entry->configuration))
        return plan_run(plan, field, entry, entry->place.at, 0);
    request.timings = request.diagnostics = 0;
    return plan_add(plan, field->scene, &request, field->group, PROBE_LABEL,
                    entry->configuration->name);
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

/* One for each configuration, also where it is refused. */
static void add_entries(struct plan *plan, struct field *field) {
    for (int c = 0; c < plan->configuration_count; c++) {
        struct entry *entry = &field->entries[field->entry_count++];
        *entry = (struct entry){.configuration = &plan->configurations[c], .last = -1};
        const struct run_request request = request_for(plan, field, entry, 0, 0);
        plan_takes(plan, field->scene, &request, entry->refused);
    }
}

/* `exact` is the scene whose penalty stands for the exact motion, or NULL. */
static int plan_field(struct plan *plan, struct field *field, const struct scene *exact) {
    struct run_request request = {.stepper = "reference",
                                  .treatment = race_treatment(field->treatment)};
    if (plan_add(plan, field->whole, &request, field->group, "reference"))
        return -1;
    request.perturbation = HORIZON_PERTURBATION;
    request.draw = 1;
    if (field->touches &&
        plan_add(plan, field->whole, &request, field->group, "reference, perturbed"))
        return -1;
    const struct run_request stiff = {.stepper = "reference", .treatment = "penalty"};
    add_entries(plan, field);
    return exact ? plan_add(plan, exact, &stiff, field->group, "exact") : 0;
}

static int plan_scenes(struct plan *plan, struct race_notes *notes) {
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        int treatments[FIELDS_MAX], count = 0;
        for (int t = 0; wisp_problem.treatments[t].name; t++)
            if (wants_treatment(notes->race, subject->scene, t))
                treatments[count++] = t;
        char left_out[64];
        const double duration =
            race_afford(plan, notes->race, subject->scene, treatments, &count, left_out);
        const double rate = sparse_frame_rate(subject->scene, duration);
        const struct scene *scene = plan_cut_scene(plan, subject, rate, duration, NULL),
                           *exact = NULL;
        if (scene && scene->wisps[0].samples > 0)
            exact = plan_cut_scene(plan, subject, rate, duration,
                                   "envelope.penalty_ratio=" EXACT_RATIO ".0");
        if (!scene || (scene->wisps[0].samples > 0 && !exact))
            return -1;
        for (int t = 0; t < count; t++) {
            struct field *field = &notes->fields[notes->field_count];
            field->subject = subject;
            field->whole = field->scene = scene;
            field->treatment = treatments[t];
            snprintf(field->group, sizeof field->group, "%s %s", subject->name,
                     race_treatment(treatments[t]));
            snprintf(field->left_out, sizeof field->left_out, "%s", left_out);
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

int race_plan(struct plan *plan) {
    const struct race *race = plan->experiment->study;
    const char *const *own = plan->quick ? race->quick_scenes : race->scenes;
    plan->run_seconds = 60;
    const unsigned kinds =
        plan->quick ? race->kinds & ~(unsigned)CONFIGURATION_COSTLY : race->kinds;
    if (plan_configurations(plan, kinds, race->capabilities) ||
        plan_subjects(plan, own, list_length(own)))
        return -1;
    const size_t fields = FIELDS_MAX * (size_t)plan->subject_count,
                 entries = (size_t)plan->configuration_count;
    struct race_notes *notes = calloc(1, sizeof *notes + fields * sizeof *notes->fields +
                                             fields * entries * sizeof(struct entry) +
                                             (size_t)plan->states_count * sizeof(struct foreign));
    plan->memo = notes;
    if (!notes)
        return fail_with(plan->reason, "out of memory");
    notes->race = race;
    for (size_t f = 0; f < fields; f++) /* behind the fields */
        notes->fields[f].entries = (struct entry *)(notes->fields + fields) + f * entries;
    notes->foreign =
        (struct foreign *)((struct entry *)(notes->fields + fields) + fields * entries);
    return plan_scenes(plan, notes) || race_foreign_plan(plan, notes) ? -1 : 0;
}

/* --- what the first stage tells --- */

/* Reads how long trajectories may be compared, and cuts the field's scene to that. */
static int read_horizon(struct plan *plan, struct field *field) {
    const struct labelled_case *reference = find_case(plan, field->group, "reference"),
                               *perturbed = find_case(plan, field->group, "reference, perturbed");
    field->horizon = field->whole->duration;
    if (!perturbed)
        return 0;
    if (measure_horizon(plan->trajectories, reference->run.folder, perturbed->run.folder,
                        &field->horizon, plan->reason))
        return -1;
    if (isnan(field->horizon) || field->horizon >= field->whole->duration)
        return 0;
    field->scene =
        plan_cut_scene(plan, field->subject, field->whole->frame_rate, field->horizon, NULL);
    return field->scene ? 0 : -1;
}

/* --- searches --- */

static int begin_searches(struct plan *plan, struct field *field) {
    for (int i = 0; i < field->entry_count; i++) {
        struct entry *entry = &field->entries[i];
        if (entry->refused[0])
            continue;
        race_search(plan, field, entry);
        if (entry->searching && plan_searched(plan, field, entry))
            return -1;
    }
    return 0;
}

/* What the awaited run has shown. */
static int read_search(struct plan *plan, const struct field *field, struct entry *entry) {
    const struct labelled_case *one = searched_case(plan, field, entry);
    struct run_files run;
    if (run_read(&run, one->run.folder, plan->reason))
        return -1;
    const double time = run_number(&run, "simulated_time") - field->scene->begin;
    if (configuration_is_adaptive(entry->configuration) && time > 0)
        entry->pace =
            (run_number(&run, "counters.steps") + run_number(&run, "counters.rejected_steps")) /
            time;
    race_search_on(plan, field, entry, run.outcome);
    run_free(&run);
    return 0;
}

/* Returns how many searches go on, or -1. */
static int go_on_searching(struct plan *plan, struct field *field) {
    int unfinished = 0;
    for (int i = 0; i < field->entry_count; i++) {
        struct entry *entry = &field->entries[i];
        if (!entry->searching)
            continue;
        if (read_search(plan, field, entry) ||
            (entry->searching && plan_searched(plan, field, entry)))
            return -1;
        unfinished += entry->searching;
    }
    return unfinished;
}

/* --- charts --- */

static int plan_entry(struct plan *plan, const struct field *field, const struct entry *entry) {
    for (int k = entry->first; k <= entry->last; k++)
        for (int j = 0; race_takes(plan, entry, k) && j < race_jitters(plan, field, entry, k); j++)
            if (plan_run(plan, field, entry, k, j))
                return -1;
    return 0;
}

/* The fields of a scene follow each other. */
static int plan_charts(struct plan *plan, struct race_notes *notes) {
    for (int f = 0, next; f < notes->field_count; f = next) {
        for (next = f;
             next < notes->field_count && notes->fields[next].subject == notes->fields[f].subject;)
            next++;
        race_fit(plan, &notes->fields[f], next - f);
    }
    for (int f = 0; f < notes->field_count; f++)
        for (int i = 0; i < notes->fields[f].entry_count; i++)
            if (plan_entry(plan, &notes->fields[f], &notes->fields[f].entries[i]))
                return -1;
    return 0;
}

/* --- from round to round --- */

static int refine_references(struct plan *plan, struct race_notes *notes) {
    for (int f = 0; f < notes->field_count; f++)
        if (read_horizon(plan, &notes->fields[f]) || begin_searches(plan, &notes->fields[f]))
            return -1;
    return 0;
}

static int refine_searches(struct plan *plan, struct race_notes *notes, int *unfinished) {
    *unfinished = 0;
    for (int f = 0; f < notes->field_count; f++) {
        const int more = go_on_searching(plan, &notes->fields[f]);
        if (more < 0)
            return -1;
        *unfinished += more;
    }
    return 0;
}

/* The next stage is planned when the one before has no run to wait for. */
int race_refine(struct plan *plan) {
    struct race_notes *notes = plan->memo;
    const int before = plan->case_count;
    int code = 0, unfinished = 1;
    if (notes->stage == RACE_REFERENCES) {
        code = refine_references(plan, notes);
        notes->stage = RACE_SEARCHES;
        unfinished = plan->case_count > before;
    } else if (notes->stage == RACE_SEARCHES) {
        code = refine_searches(plan, notes, &unfinished);
    }
    if (code || unfinished || notes->stage == RACE_CHARTS)
        return code;
    notes->stage = RACE_CHARTS;
    return plan_charts(plan, notes);
}
