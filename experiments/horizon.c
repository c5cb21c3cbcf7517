/* How long can trajectories be compared, and what is left to compare after that? Where wisps and
 * bodies touch, two runs from starts a tenth of a nanometre apart may part, by whatever method: up
 * to that separation horizon a method's error is its own. After it, only what many runs from
 * perturbed starts have in common says anything: their mean shape, energy and number of contacts.
 * The yardstick is how far two halves of the reference's own ensemble are from each other. */
#include "base/files.h"
#include "base/table.h"
#include "experiments/common/measure.h"
#include "experiments/common/statements.h"
#include "model/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const own_scenes[] = {"interactions", "sphere", "radii", "wind"};
static const double seconds = 240, quick_seconds = 20; /* of wall time, on two cores */
static const char treatment[] = "generalised";
static const double scatter = 1e-4; /* rms displacement of an ensemble's starts, m */
enum { MEMBERS = 16, QUICK_MEMBERS = 8 };

static int members(const struct plan *plan) {
    return plan->quick ? QUICK_MEMBERS : MEMBERS;
}

/* --- the runs --- */

/* Whether a method's ensemble is worth its time: by what --steppers names, or by its kind. */
static int is_worth_an_ensemble(const struct plan *plan, const struct stepper_method *method) {
    return plan->stepper_count > 0 || configuration_of(method).kind != CONFIGURATION_COSTLY;
}

/* Members at usual steps; those of the reference need not be its tightest. A stepper that refuses
 * the scene has no ensemble on it. */
static int plan_ensemble(struct plan *plan, const struct subject *subject,
                         const struct scene *scene, const struct stepper_method *method) {
    const int is_reference = method->checked_by != NULL;
    struct run_request request = {.stepper = method->name,
                                  .step = usual_step(scene, method),
                                  .rtol = is_reference ? 1e-9 : 0,
                                  .atol = is_reference ? 1e-11 : 0,
                                  .treatment = treatment,
                                  .perturbation = scatter,
                                  .diagnostics = 1};
    char reason[REASON_SIZE];
    for (int i = 0; plan_takes(plan, scene, &request, reason) && i < members(plan); i++) {
        request.draw = 2 + i;
        if (plan_add(plan, scene, &request, subject->name, "%s %d", method->name, i))
            return -1;
    }
    return 0;
}

static int plan_subject(struct plan *plan, const struct subject *subject) {
    const double budget = plan->quick ? quick_seconds : seconds, cores = 2;
    const double runs = 2 + 0.5 * members(plan); /* in units of the reference one */
    const double duration =
        fmin(subject->scene->duration,
             0.6 * budget * cores / plan->subject_count / runs / reference_cost(subject->scene));
    const struct scene *scene =
        plan_cut_scene(plan, subject, sparse_frame_rate(subject->scene, duration), duration, NULL);
    const struct run_request reference = {.stepper = "reference", .treatment = treatment},
                             perturbed = {.stepper = "reference",
                                          .treatment = treatment,
                                          .perturbation = HORIZON_PERTURBATION,
                                          .draw = 1};
    if (!scene || plan_add(plan, scene, &reference, subject->name, "reference") ||
        plan_add(plan, scene, &perturbed, subject->name, "reference, perturbed"))
        return -1;
    for (int m = 0; stepper_methods[m]; m++)
        if ((plan_wants(plan, stepper_methods[m]->name) || stepper_methods[m]->checked_by) &&
            is_worth_an_ensemble(plan, stepper_methods[m]) &&
            plan_ensemble(plan, subject, scene, stepper_methods[m]))
            return -1;
    return 0;
}

static int horizon_plan(struct plan *plan) {
    plan->run_seconds = 120;
    if (plan_subjects(plan, own_scenes, plan->quick ? 2 : 4))
        return -1;
    for (int i = 0; i < plan->subject_count; i++)
        if (plan_subject(plan, &plan->subjects[i]))
            return -1;
    return 0;
}

/* --- members --- */

/* One run of an ensemble from the horizon on. */
struct member {
    enum outcome outcome;
    double failure_time;
    int rows;       /* of states, over those frames */
    double *number; /* see below; owned */
};

/* Its numbers: kinetic and potential energy, mean over those frames, J; contacts of wisps and
 * bodies, after the first of those frames; from POSITIONS on 3 for each row, m. */
enum { ENERGY, CONTACTS, POSITIONS };

/* Returns 0, or -1 where memory cannot be had. */
static int copy_positions(struct member *member, const struct trajectory *states, double from) {
    const int rows = states->table.row_count;
    int first = 0;
    while (first < rows && trajectory_row(states, first)[STATE_T] < from - 1e-9)
        first++;
    member->rows = rows - first;
    member->number = calloc(POSITIONS + 3 * (size_t)member->rows, sizeof(double));
    for (int i = 0; member->number && i < 3 * member->rows; i++)
        member->number[POSITIONS + i] = trajectory_row(states, first + i / 3)[STATE_X + i % 3];
    return member->number ? 0 : -1;
}

static void average_diagnoses(struct member *member, const struct table *diagnoses, double from) {
#define X(name, meaning) #name,
    static const char *const energies[] = {ENERGIES(X) NULL};
#undef X
    int frames = 0;
    for (int i = 0; i < diagnoses->row_count; i++) {
        const double t = table_value(diagnoses, i, 0);
        if (t < from - 1e-9)
            continue;
        for (int e = 0; energies[e]; e++)
            member->number[ENERGY] +=
                table_value(diagnoses, i, table_column(diagnoses, energies[e]));
        if (frames++ == 0)
            continue; /* what was counted up to the first frame is before it */
        member->number[CONTACTS] +=
            table_value(diagnoses, i, table_column(diagnoses, "wisp_contacts")) +
            table_value(diagnoses, i, table_column(diagnoses, "body_contacts"));
    }
    member->number[ENERGY] /= frames;
}

static int read_member(struct plan *plan, struct member *member, const struct labelled_case *one,
                       double from) {
    struct run_files run;
    struct table diagnoses;
    char path[PATH_SIZE];
    int code = 0;
    if (plan_read(plan, one, &run))
        return -1;
    *member =
        (struct member){.outcome = run.outcome, .failure_time = run_number(&run, "failure_time")};
    path_format(path, "%s/diagnostics.tsv", one->run.folder);
    if (run.outcome == FINISHED)
        code = copy_positions(member, run.states, from)
                   ? fail_with(plan->reason, "out of memory")
                   : table_read(&diagnoses, path, plan->reason);
    if (run.outcome == FINISHED && !code) {
        average_diagnoses(member, &diagnoses, from);
        table_free(&diagnoses);
    }
    run_free(&run);
    return code;
}

/* --- ensembles --- */

struct ensemble {
    struct member member[MEMBERS];
    int count, failed;
};

static void ensemble_free(struct ensemble *ensemble) {
    for (int i = 0; i < ensemble->count; i++)
        free(ensemble->member[i].number);
    ensemble->count = 0;
}

static int ensemble_read(struct plan *plan, const struct subject *subject, const char *stepper,
                         double from, struct ensemble *ensemble) {
    *ensemble = (struct ensemble){.count = 0};
    for (int i = 0; i < members(plan); i++) {
        const struct labelled_case *one = find_case(plan, subject->name, "%s %d", stepper, i);
        if (!one)
            continue;
        struct member *member = &ensemble->member[ensemble->count++];
        if (read_member(plan, member, one, from))
            return -1;
        ensemble->failed += member->outcome != FINISHED;
    }
    return 0;
}

/* Members from, from + by, from + 2 by, ...: all, or every second one. */
struct group {
    const struct ensemble *ensemble;
    int from, by;
};

/* Mean of a number over a group's members that finished. */
static double group_mean(const struct group *group, int index) {
    double sum = 0;
    int count = 0;
    for (int i = group->from; i < group->ensemble->count; i += group->by) {
        const struct member *member = &group->ensemble->member[i];
        if (member->outcome != FINISHED)
            continue;
        sum += member->number[index];
        count++;
    }
    return sum / count;
}

/* How far two groups' means are from each other: rms over nodes and frames, m; J; a number. */
struct distance {
    double shape, energy, contacts;
};

/* NaN in shape where frames have not the same rows in all members. */
static struct distance group_distance(const struct group *a, const struct group *b) {
    struct distance d;
    double square = 0;
    int rows = -1, same = 1;
    const struct group *const both[] = {a, b};
    for (int g = 0; g < 2; g++)
        for (int i = both[g]->from; i < both[g]->ensemble->count; i += both[g]->by) {
            const struct member *member = &both[g]->ensemble->member[i];
            if (member->outcome != FINISHED)
                continue;
            same = same && (rows < 0 || member->rows == rows);
            rows = member->rows;
        }
    for (int k = 0; same && k < 3 * rows; k++) {
        const double gap = group_mean(a, POSITIONS + k) - group_mean(b, POSITIONS + k);
        square += gap * gap;
    }
    d.shape = same && rows > 0 ? sqrt(square / rows) : NAN;
    d.energy = fabs(group_mean(a, ENERGY) - group_mean(b, ENERGY));
    d.contacts = fabs(group_mean(a, CONTACTS) - group_mean(b, CONTACTS));
    return d;
}

/* --- tables --- */

#define HORIZON_COLUMNS(X)                                                                 \
    SCENE_COLUMN(X, subject->name)                                                         \
    X("horizon", "s", "last frame at which starts 1e-10 m apart are within 1 mm", "%.17g", \
      horizon)                                                                             \
    X("compared", "s", "time that was run", "%.17g", duration)                             \
    X("duration", "s", "duration of the scene", "%.17g", subject->scene->duration)         \
    X("bound", "m", "bound of the reference solution", "%.17g",                            \
      run_number(&run, "cross_check.bound"))                                               \
    X("status", "-", "how the run of the reference solution ended", "%s", outcome_name(run.outcome))

#define ENSEMBLE_COLUMNS(X)                                                                        \
    X("stepper", "-", "name of the stepper", "%s", stepper)                                        \
    SCENE_COLUMN(X, subject->name)                                                                 \
    X("members", "1", "runs of the ensemble", "%d", ensemble->count)                               \
    X("failed", "1", "runs of the ensemble that failed", "%d", ensemble->failed)                   \
    X("failure_time", "s", "simulated time at which the first run failed", "%.17g",                \
      first_failure(ensemble))                                                                     \
    X("shape", "m", "distance of the mean shape from the reference's, rms over nodes and frames",  \
      "%.17g", d.shape)                                                                            \
    X("shape_yardstick", "m", "such a distance of two halves of the reference's ensemble",         \
      "%.17g", yardstick.shape)                                                                    \
    X("energy", "J", "distance of the mean energy from the reference's", "%.17g", d.energy)        \
    X("energy_yardstick", "J", "such a distance of the two halves", "%.17g", yardstick.energy)     \
    X("contacts", "1", "distance of the mean number of contacts from the reference's", "%.17g",    \
      d.contacts)                                                                                  \
    X("contacts_yardstick", "1", "such a distance of the two halves", "%.17g", yardstick.contacts) \
    X("contacts_mean", "1", "the mean number of contacts", "%.17g", group_mean(&all, CONTACTS))

enum { GROWTH, HORIZONS, ENSEMBLES, TABLES };
static const struct table_form tables[TABLES] = {
    {"growth",
     "largest distance of a node between two reference runs whose starts are 1e-10 m apart, m",
     COLUMNS(SEPARATION_COLUMNS)},
    {"horizons",
     "separation horizon: the last frame at which that distance is below 1 mm, s; compared: what "
     "was run of the scene's duration, s; bound: of the reference run, m",
     COLUMNS(HORIZON_COLUMNS)},
    {"ensembles",
     "means of ensembles of runs whose starts are displaced by 1e-4 m (rms), from the horizon on, "
     "or over all frames where there is none: their distance from the reference's, in the shape "
     "(rms over nodes and frames, m), energy (J), number of contacts; yardstick: the same between "
     "two halves of the reference's ensemble. Two independent ensembles of one distribution are "
     "about 0.7 yardsticks apart; all ensembles have the same starts, and are nearer to each other "
     "where these still matter; nan: no run failed, or none was left to tell",
     COLUMNS(ENSEMBLE_COLUMNS)},
};

static double first_failure(const struct ensemble *ensemble) {
    double t = NAN;
    for (int i = 0; i < ensemble->count; i++)
        if (ensemble->member[i].outcome != FINISHED)
            t = fmin(isnan(t) ? INFINITY : t, ensemble->member[i].failure_time);
    return t;
}

static double in_yardsticks(double d, double yardstick) {
    return d == 0 ? 0 : d / yardstick;
}

/* Whether an ensemble's mean shape is within the yardstick of the reference's. */
static void state_ensemble(struct statements *statements, const struct subject *subject,
                           const char *stepper, const struct ensemble *ensemble,
                           const struct distance *d, const struct distance *yardstick) {
    struct statement row =
        our_row("ensembles", "ensembles", HOLDS, in_yardsticks(d->shape, yardstick->shape), "1",
                "%.70s, %.60s", subject->name, stepper);
    row.verdict = ensemble->failed || isnan(row.value) ? NOT_REACHED : holds_if(row.value <= 1);
    if (row.verdict == NOT_REACHED)
        statements_add(statements, row,
                       "On %s %s has no mean shape to compare: %d of %d runs fail.", subject->name,
                       stepper, ensemble->failed, ensemble->count);
    else
        statements_add(statements, row,
                       "On %s %s's mean shape is within a yardstick of the reference's: %.2g "
                       "yardsticks away, its energy %.2g, its contacts %.2g.",
                       subject->name, stepper, row.value,
                       in_yardsticks(d->energy, yardstick->energy),
                       in_yardsticks(d->contacts, yardstick->contacts));
}

static void write_ensemble(FILE *stream, struct statements *statements,
                           const struct subject *subject, const char *stepper,
                           const struct ensemble *ensemble, const struct ensemble *reference) {
    const struct group all = {ensemble, 0, 1}, theirs = {reference, 0, 1};
    const struct group half = {reference, 0, 2}, other_half = {reference, 1, 2};
    const struct distance yardstick = group_distance(&half, &other_half);
    const struct distance d = group_distance(&all, &theirs);
    WRITE_ROW(stream, ENSEMBLE_COLUMNS);
    if (ensemble == reference)
        return;
    state_ensemble(statements, subject, stepper, ensemble, &d, &yardstick);
}

static int tabulate_ensembles(struct plan *plan, const struct subject *subject, double from,
                              FILE *stream, struct ensemble *pair) {
    struct statements *statements = &plan->output.statements;
    struct ensemble *reference = &pair[0], *ensemble = &pair[1];
    int code = 0;
    for (int m = 0; stepper_methods[m]; m++)
        if (stepper_methods[m]->checked_by)
            code = ensemble_read(plan, subject, stepper_methods[m]->name, from, reference);
    for (int m = 0; stepper_methods[m] && !code; m++) {
        const char *name = stepper_methods[m]->name;
        if (stepper_methods[m]->checked_by) {
            write_ensemble(stream, statements, subject, name, reference, reference);
        } else if (plan_wants(plan, name)) {
            code = ensemble_read(plan, subject, name, from, ensemble);
            if (!code && ensemble->count > 0)
                write_ensemble(stream, statements, subject, name, ensemble, reference);
            ensemble_free(ensemble);
        }
    }
    ensemble_free(reference);
    return code;
}

/* Names the methods without ensembles. */
static void state_left_out(struct statements *statements, const struct plan *plan) {
    char names[160] = "";
    for (int m = 0; stepper_methods[m]; m++) {
        const size_t used = strlen(names);
        if (!is_worth_an_ensemble(plan, stepper_methods[m]))
            snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "",
                     stepper_methods[m]->name);
    }
    if (names[0])
        statements_add(statements,
                       our_row("ensembles", "ensembles", NOT_REACHED, NAN, NULL, "left out"),
                       "There are no ensembles by %s, which would take longer than those of all "
                       "others together; --steppers asks for them.",
                       names);
}

static void state_horizon(struct statements *statements, const struct subject *subject,
                          double horizon, double compared) {
    char cut[64] = "";
    const struct statement row =
        our_row("horizon", "growth horizons", isnan(horizon) ? NOT_REACHED : HOLDS, horizon, "s",
                "%.70s, horizon", subject->name);
    if (!isnan(horizon)) {
        const double duration = subject->scene->duration;
        if (compared < duration)
            snprintf(cut, sizeof cut, "; its budget allows %.3g of %.3g s", compared, duration);
        statements_add(statements, row,
                       "On %s a start that is 1e-10 m away stays within 1 mm %s %.3g s%s.",
                       subject->name, horizon < compared ? "for" : "to the end,", horizon, cut);
        return;
    }
    statements_add(statements, row, "On %s a reference run failed, and the horizon is not known.",
                   subject->name);
    statements_add(statements,
                   our_row("ensembles", "ensembles", NOT_REACHED, NAN, NULL, "%.70s, ensembles",
                           subject->name),
                   "On %s there is no horizon from which to compare ensembles.", subject->name);
}

/* Returns 0, or -1 with plan->reason. */
static int tabulate_subject(struct plan *plan, const struct subject *subject, FILE *const *streams,
                            struct ensemble *pair) {
    const struct labelled_case *reference = find_case(plan, subject->name, "reference"),
                               *other = find_case(plan, subject->name, "reference, perturbed");
    const double duration = reference->run.scene->duration;
    struct run_files run;
    double horizon;
    if (measure_horizon(plan->trajectories, reference->run.folder, other->run.folder, &horizon,
                        plan->reason) ||
        run_read(&run, reference->run.folder, plan->reason))
        return -1;
    WRITE_ROW(streams[HORIZONS], HORIZON_COLUMNS);
    run_free(&run);
    state_horizon(&plan->output.statements, subject, horizon, duration);
    if (isnan(horizon))
        return 0;
    if (measure_separation(plan->trajectories, reference->run.folder, other->run.folder,
                           subject->name, streams[GROWTH], plan->reason))
        return -1;
    return tabulate_ensembles(plan, subject, horizon < duration ? horizon : 0, streams[ENSEMBLES],
                              pair);
}

static int horizon_tabulate(struct plan *plan) {
    FILE *streams[TABLES];
    if (plan_open_statements(plan, NULL,
                             plan->quick ? "--quick: two scenes, half the members" : NULL) ||
        output_tables(&plan->output, streams, tables, TABLES, "", NULL))
        return -1;
    struct ensemble *pair = calloc(2, sizeof *pair);
    int code = pair ? 0 : fail_with(plan->reason, "out of memory");
    for (int i = 0; i < plan->subject_count && !code; i++)
        code = tabulate_subject(plan, &plan->subjects[i], streams, pair);
    free(pair);
    state_left_out(&plan->output.statements, plan);
    return code;
}

const struct experiment horizon_experiment = {
    .name = "horizon",
    .question = "how long can trajectories be compared where wisps touch, and what after that?",
    .chapter = CHAPTER_STABILITY,
    .place = 15,
    .full_seconds = 130,
    .plan = horizon_plan,
    .tabulate = horizon_tabulate,
};
