/* A race's tables, from which its figures are drawn, and what it prints. */
#include "race.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double targets[] = {1e-2, 1e-3, 1e-4, 1e-5}; /* m: errors that someone may want */
enum { TARGETS = sizeof targets / sizeof *targets };

/* Why a number of the reference's row is not there; empty where all are. */
static const char *note_of(const struct field *field) {
    if (isnan(field->bound) || isnan(field->horizon))
        return "a reference run did not finish";
    if (!isnan(field->treatment_error))
        return "";
    return field->subject->scene->wisps[0].samples ? "the exact motion's run did not finish"
                                                   : "no envelope, and so no treatment's error";
}

/* Why a number is not there; empty where all are. */
static const char *note_of_point(const struct field *field, const struct point *p) {
    return !*p->note && isnan(field->evaluation)
               ? "no explicit method with fixed steps, and so no equivalents"
               : p->note;
}

#define TREATMENT_COLUMN(X) TREATED_COLUMN(X, race_treatment(field->treatment))

#define POINT_COLUMNS(X)                                                                           \
    CONFIGURATION_COLUMN(X, "method", p->entry->configuration->name)                               \
    TREATMENT_COLUMN(X)                                                                            \
    X("stepper", "-", "stepper of the configuration", "%s", p->entry->configuration->stepper)      \
    X("setting", "s or 1", "step, s, or rtol", "%.17g", p->setting)                                \
    X("status", "-", "how the run ended", "%s", p->status)                                         \
    X("failure_time", "s", "simulated time at which it failed", "%.17g", cost->failure_time)       \
    X("error", "m",                                                                                \
      "distance from the reference solution, rms over free nodes and frames: median of runs",      \
      "%.17g", d->rms)                                                                             \
    X("largest", "m", "the largest distance of a free node", "%.17g", d->largest)                  \
    X("relative", "1", "distance over the length of the node's wisp, rms", "%.17g", d->relative)   \
    X("end", "m", "distance at the last frame, rms", "%.17g", d->end)                              \
    X("velocity", "m/s", "difference of velocities, rms", "%.17g", d->velocity)                    \
    X("radius", "m", "difference of samples' distances from their node, rms", "%.17g", d->radius)  \
    X("mescd", "1", "-log10 of the largest mixed error at the end", "%.17g", d->mescd)             \
    CPU_COLUMNS(X, cost)                                                                           \
    EVALUATIONS_COLUMN(X, cost)                                                                    \
    STEPS_COLUMN(X, cost)                                                                          \
    X("reference_limited", "1", "1 where it is within ten times the reference's bound", "%d",      \
      p->reference_limited)                                                                        \
    X("front_cpu", "1", "1 where it is on the front of error and counted cost", "%d", p->front[0]) \
    X("front_evaluations", "1", "1 where it is on the front of error and evaluations", "%d",       \
      p->front[1])                                                                                 \
    X("error_least", "m", "least error of the runs", "%.17g", p->error_least)                      \
    X("error_greatest", "m", "greatest error of the runs", "%.17g", p->error_greatest)             \
    X("runs", "1", "number of runs", "%d", p->runs)                                                \
    X("failed", "1", "number of runs that failed", "%d", p->failed)                                \
    X("equivalents", "1", "CPU time over that of a force evaluation", "%.17g",                     \
      cost->cpu.median / field->evaluation)                                                        \
    X("strain", "1", "largest |L/l - 1| of a stretch segment at a frame", "%.17g",                 \
      p->extent.strain)                                                                            \
    X("penetration", "m", "largest depth of a node in a body at a frame", "%.17g",                 \
      p->extent.penetration)                                                                       \
    X("drift", "1", "largest energy that no work accounts for, over the largest kinetic energy",   \
      "%.17g", p->extent.drift)                                                                    \
    X("lanes", "1", "the most wisps that are computed side by side", "%d", p->lanes)               \
    X("threads", "1", "threads that share the wisps", "%d", p->threads)                            \
    X("run", "-", "folder of the median run in runs", "%s", p->run)                                \
    NOTE_COLUMN(X, note_of_point(field, p))

#define REFERENCE_COLUMNS(X)                                                                     \
    TREATMENT_COLUMN(X)                                                                          \
    X("bound", "m", "largest difference from a second, unlike method", "%.17g", field->bound)    \
    X("force_evaluations", "1", "evaluations of the forces in the run", "%.17g",                 \
      run_number(&field->reference, "counters.force_evaluations"))                               \
    X("steps", "1", "steps of the run, of all wisps", "%.17g",                                   \
      run_number(&field->reference, "counters.steps"))                                           \
    X("status", "-", "how the run ended", "%s", outcome_name(field->reference.outcome))          \
    X("treatment_error", "m", "distance from the exact constrained motion, rms", "%.17g",        \
      field->treatment_error)                                                                    \
    X("horizon", "s", "time until starts 1e-10 m apart are 1 mm apart", "%.17g", field->horizon) \
    X("compared", "s", "time of the scene that is compared", "%.17g", field->scene->duration)    \
    X("duration", "s", "duration of the scene", "%.17g", field->subject->scene->duration)        \
    NOTE_COLUMN(X, note_of(field))

#define SLOPE_COLUMNS(X)                                   \
    CONFIGURATION_COLUMN(X, "method", configuration->name) \
    TREATMENT_COLUMN(X)                                    \
    FIT_COLUMNS(X, !configuration_is_adaptive(configuration), &fit)

#define FRONT_COLUMNS(X)                                                                     \
    TREATMENT_COLUMN(X)                                                                      \
    X("measure", "-", "cpu or evaluations: the cost", "%s", measure ? "evaluations" : "cpu") \
    X("cost", "s or 1", "CPU time, s, or evaluations", "%.17g",                              \
      measure ? p->cost.evaluations : p->cost.cpu.median)                                    \
    X("error", "m", "distance from the reference solution, rms over free nodes and frames",  \
      "%.17g", p->deviation.rms)                                                             \
    CONFIGURATION_COLUMN(X, "method", p->entry->configuration->name)                         \
    X("setting", "s or 1", "step, s, or rtol", "%.17g", p->setting)

#define CHEAPEST_COLUMNS(X)                                                                       \
    TREATMENT_COLUMN(X)                                                                           \
    X("target", "m", "the error that is allowed", "%g", target)                                   \
    X("method", "-", "configuration whose run is the cheapest", "%s",                             \
      p ? p->entry->configuration->name : "none")                                                 \
    X("setting", "s or 1", "step, s, or rtol of that run", "%.17g", p ? p->setting : (double)NAN) \
    X("error", "m", "error of that run", "%.17g", p ? p->deviation.rms : (double)NAN)             \
    CPU_COLUMNS(X, p ? &p->cost : &no_cost)                                                       \
    X("next_method", "-", "the next cheapest configuration", "%s",                                \
      next ? next->entry->configuration->name : "none")                                           \
    X("next_setting", "s or 1", "step, s, or rtol of the next one", "%.17g",                      \
      next ? next->setting : (double)NAN)                                                         \
    X("next_cpu_median", "s", "CPU time of the next one, median of repeated runs", "%.17g",       \
      next ? next->cost.cpu.median : (double)NAN)                                                 \
    X("tied", "1", "1 where the next one is not known to be more expensive", "%d",                \
      next && !cost_is_less(&p->cost, &next->cost))                                               \
    X("note", "-", "why there is no number", "%s",                                                \
      next ? ""                                                                                   \
      : p  ? "no other method is within the target"                                               \
           : "no run is within the target")

enum { POINTS, REFERENCES, SLOPES, FRONT, CHEAPEST, TABLES };

/* Their names follow the subject's. */
static const struct table_form table_kinds[TABLES] = {
    [POINTS] =
        {"",
         "integration error against the reference solution of the same treatment, over free nodes "
         "and all frames up to the separation horizon, the common start among them: error = rms, "
         "m, and of runs at jittered tolerances rtol (1 + j 1e-12) the median, the least and the "
         "greatest; of the median one: largest, m; relative = rms over length; end = rms at the "
         "end, m; velocity = rms, m/s; radius = rms of the samples' distance from their node, m; "
         "mescd at the end; CPU time, s: of repeated, or of three jittered runs, alone on the "
         "machine; equivalents: CPU time over that of a force evaluation in the longest run of the "
         "explicit method with fixed steps of highest order; setting: step, s, or rtol; "
         "reference_limited: within ten times the reference's bound, and so on no front and in "
         "nobody's way; front: Pareto, by steps counted and the table of costs, and by force "
         "evaluations; strain, penetration (m): largest at any frame; drift: largest energy that "
         "no work accounts for, over the largest kinetic energy, with the works' own error of "
         "second order; lanes: the most wisps that are computed side by side; threads: that share "
         "the scene's wisps; run: the folder of the median one in runs, or -; nan: there is no "
         "number, see status and note; diverged history: wisps split at other ticks than the "
         "reference's, from where on nothing is compared",
         COLUMNS(POINT_COLUMNS)},
    [REFERENCES] =
        {"-reference",
         "the reference solutions: bound = largest difference from the cross-check, m; "
         "treatment_error = rms over free nodes and frames from the treatment penalty with "
         "ratio " EXACT_RATIO
         ", which stands for the exact constrained motion, m; horizon: up to when a perturbation "
         "of 1e-10 m stays below 1 mm, s; compared: what of the scene's duration is compared, s",
         COLUMNS(REFERENCE_COLUMNS)},
    [SLOPES] = {"-slopes",
                "slopes of log error over log steps, between a relative error of a hundredth and a "
                "hundred times the reference's bound, " SLOPE_RULE,
                COLUMNS(SLOPE_COLUMNS)},
    [FRONT] = {"-front",
               "Pareto fronts: what no other run beats in cost (steps counted and the table of "
               "costs, shown with its CPU time; or evaluations) and in error, as far as the "
               "reference can tell (reference-limited ones left out)",
               COLUMNS(FRONT_COLUMNS)},
    [CHEAPEST] =
        {"-cheapest",
         "the cheapest run with an error of at most target, m, by steps counted and the table of "
         "costs, with its CPU time, s, and the next method; to the error of a reference-limited "
         "run the reference's bound is added; tied: the next one is not known to be costlier",
         COLUMNS(CHEAPEST_COLUMNS)},
};

static void write_point(FILE *stream, const struct field *field, const struct point *p) {
    const struct deviation *d = &p->deviation;
    const struct cost *cost = &p->cost;
    WRITE_ROW(stream, POINT_COLUMNS);
}

/* Rows of each configuration in the order of its settings; blocks are separated by two blank lines.
 */
static void write_points(FILE *stream, const struct field *field) {
    for (int i = 0; i < field->point_count; i++) {
        const int last =
            i + 1 == field->point_count || field->points[i + 1].entry != field->points[i].entry;
        write_point(stream, field, &field->points[i]);
        fprintf(stream, "%s", last ? "\n\n" : "");
    }
}

static void write_slope(FILE *stream, const struct field *field,
                        const struct configuration *configuration) {
    const double least = fmax(1e-13, 100 * field->bound);
    struct slope slope = {.count = 0};
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        if (p->entry->configuration != configuration || !race_finished(p) ||
            p->deviation.relative > 0.01 || p->deviation.rms < least)
            continue; /* out of the asymptotic range, or of what the reference can tell */
        slope_add(&slope, p->cost.steps, p->deviation.rms);
    }
    const struct fit fit = slope_fit(&slope, configuration);
    if (fit.points > 0)
        WRITE_ROW(stream, SLOPE_COLUMNS);
}

/* The next point of a front: the cheapest that is costlier than `than`. */
static const struct point *next_on_front(const struct field *field, int measure, double than) {
    const struct point *best = NULL;
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        if (p->front[measure] && race_cost(p, measure) > than &&
            (!best || race_cost(p, measure) < race_cost(best, measure)))
            best = p;
    }
    return best;
}

static void write_front(FILE *stream, const struct field *field) {
    for (int measure = 0; measure < 2; measure++) {
        const struct point *p = next_on_front(field, measure, -1);
        for (; p; p = next_on_front(field, measure, race_cost(p, measure)))
            WRITE_ROW(stream, FRONT_COLUMNS);
        fprintf(stream, "\n\n");
    }
}

static void write_field(FILE *const *streams, const struct field *field) {
    write_points(streams[POINTS], field);
    for (int i = 0; i < field->entry_count; i++)
        write_slope(streams[SLOPES], field, field->entries[i].configuration);
    write_front(streams[FRONT], field);
    WRITE_ROW(streams[REFERENCES], REFERENCE_COLUMNS);
    for (int i = 0; i < TARGETS && field->has_reference; i++) {
        const double target = targets[i];
        const struct point *p = race_cheapest(field, target, NULL);
        const struct point *next = p ? race_cheapest(field, target, p->entry->configuration) : NULL;
        WRITE_ROW(streams[CHEAPEST], CHEAPEST_COLUMNS);
    }
}

/* What is kept from field to field. The fields of a subject follow each other; each keeps its
 * points until all are stated. */
struct told {
    struct race_answers answers;
    struct point *points; /* of FIELDS_MAX fields, `most` each */
    int most;
};

/* Trajectories of other programs, after our own points. */
static int write_foreign(struct plan *plan, const struct field *field, FILE *stream) {
    const struct race_notes *notes = plan->memo;
    int number = 0;
    for (int i = 0; i < notes->foreign_count; i++) {
        const struct foreign *foreign = &notes->foreign[i];
        const struct configuration called = {.name = foreign->name, .stepper = "-"};
        const struct entry entry = {.configuration = &called};
        struct point point;
        if (foreign->field != field)
            continue;
        if (race_foreign_read(plan, foreign, &entry, &point))
            return -1;
        write_point(stream, field, &point);
        race_state_foreign(&plan->output.statements, field, &point, ++number);
        if (i + 1 == notes->foreign_count || strcmp(foreign[1].name, foreign->name) != 0)
            fprintf(stream, "\n\n");
    }
    return 0;
}

static int write_one(struct plan *plan, struct field *field, FILE *const *streams) {
    int code = race_read(plan, field);
    if (!code) {
        write_field(streams, field);
        race_state_reference(&plan->output.statements, field);
        if (field->has_reference)
            code = write_foreign(plan, field, streams[POINTS]);
    }
    run_free(&field->reference);
    return code;
}

/* Returns the number of the subject's fields that have a reference, or -1. */
static int tabulate_subject(struct plan *plan, const struct subject *subject, struct told *told) {
    struct race_notes *notes = plan->memo;
    FILE *streams[TABLES];
    int first = 0, count = 0, there = 0;
    if (output_tables(&plan->output, streams, table_kinds, TABLES, subject->name, subject->scene))
        return -1;
    while (first < notes->field_count && notes->fields[first].subject != subject)
        first++;
    struct field *fields = notes->fields + first;
    for (; first + count < notes->field_count && fields[count].subject == subject; count++) {
        fields[count].points = told->points + count * told->most;
        if (write_one(plan, &fields[count], streams))
            return -1;
        there += fields[count].has_reference;
    }
    if (there > 0)
        race_state_subject(&plan->output.statements, fields, count, &told->answers);
    return there;
}

#define LIST_COLUMNS(X)                                                                   \
    X("file", "-", "name of the scene's tables and figures", "%s", subject->name)         \
    X("name", "-", "name of the scene", "%s", subject->scene->name)                       \
    X("samples", "1", "samples around a node of its first wisp", "%d",                    \
      subject->scene->wisps[0].samples)                                                   \
    X("length", "m", "length of its longest wisp", "%.17g", longest_wisp(subject->scene)) \
    X("wisps", "1", "number of wisps", "%d", subject->scene->wisp_count)

/* With the figures' list: scenes with at least one reference. */
static int tabulate_all(struct plan *plan, struct told *told) {
    static const char drawn[] = "scenes drawn; --quick: every other tolerance, three jittered "
                                "runs, and of the shipped scenes only some";
    int count = 0;
    if (plan_open_statements(plan, NULL, plan->quick ? strstr(drawn, "--quick") : NULL))
        return -1;
    FILE *list = output_table(&plan->output, "scenes", plan->quick ? drawn : "scenes drawn", NULL,
                              COLUMNS(LIST_COLUMNS));
    if (!list)
        return -1;
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        const int there = tabulate_subject(plan, subject, told);
        if (there < 0)
            return -1;
        count += there > 0;
        if (there > 0)
            WRITE_ROW(list, LIST_COLUMNS);
    }
    race_state_all(&plan->output.statements, &told->answers);
    if (count > 0)
        return 0;
    snprintf(plan->reason, REASON_SIZE,
             "no reference run reached its end, so there is nothing to measure errors against");
    return 1;
}

int race_tabulate(struct plan *plan) {
    const int most = plan->configuration_count * (LEVELS_MAX + 1) + 1;
    struct told told = {
        .answers = {.asked = plan->experiment->answers,
                    .cheapest = calloc((size_t)plan->subject_count * RACE_TARGETS + 1,
                                       sizeof *told.answers.cheapest),
                    .configurations = plan->configurations,
                    .configuration_count = plan->configuration_count,
                    .among = calloc((size_t)plan->configuration_count * RACE_TARGETS + 1,
                                    sizeof *told.answers.among)},
        .points = calloc((size_t)(FIELDS_MAX * most), sizeof *told.points),
        .most = most};
    const int code = told.answers.cheapest && told.answers.among && told.points
                         ? tabulate_all(plan, &told)
                         : fail_with(plan->reason, "out of memory");
    free(told.answers.cheapest);
    free(told.answers.among);
    free(told.points);
    return code;
}
