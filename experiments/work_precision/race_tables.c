/* A race's tables, from which its figures are drawn, and what it prints. */
#include "base/files.h"
#include "race.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double targets[] = {1e-2, 1e-3, 1e-4, 1e-5}; /* m: errors that someone may want */
enum { TARGETS = sizeof targets / sizeof *targets };

enum { POINTS, REFERENCES, SLOPES, FRONT, CHEAPEST, TABLES };

static const struct {
    const char *suffix, *what, *columns;
} table_kinds[TABLES] = {
    [POINTS] =
        {"",
         "integration error against the tight solution of the same treatment, over free "
         "nodes and all frames up to the separation horizon, the common start among them: error = "
         "rms, m, and of runs at jittered tolerances rtol (1 + j 1e-12) the median, the least and "
         "the greatest; of the median one: largest, m; relative = rms over length; end = rms at "
         "the end, m; velocity = rms, m/s; radius = rms of the samples' distance from their node, "
         "m; mescd at the end; CPU time, s: of repeated, or of the jittered runs, alone on the "
         "machine; equivalents: CPU time over that of a force evaluation in the longest run of the "
         "explicit method with fixed steps of highest order; setting: "
         "step, s, or rtol; limited: within ten times the reference's bound, and so on no front "
         "and "
         "in nobody's way; "
         "front: Pareto, by steps counted and the table of costs, and by force evaluations; "
         "strain, penetration (m): largest at "
         "any frame; drift: largest energy that no work accounts for, over the largest kinetic "
         "energy, with the works' own error of second order; nan: there is no number, see status "
         "and note; parted: wisps split at other ticks than the reference's, from where on nothing "
         "is compared",
         "method\ttreatment\tstepper\tsetting\tstatus\tfailure_time\terror\tlargest\trelative"
         "\tend\tvelocity\tradius\tmescd\tcpu_median\tcpu_least\tcpu_greatest"
         "\tforce_evaluations\tsteps\tlimited\tfront_cpu\tfront_evaluations\terror_least"
         "\terror_greatest\truns\tfailed\tequivalents\tstrain\tpenetration\tdrift\tnote"},
    [REFERENCES] = {"-reference",
                    "the tight solutions: bound = largest difference from the second opinion, m; "
                    "treatment_error = rms over free nodes and frames from the treatment penalty "
                    "with ratio " EXACT_RATIO ", which stands for the exact constrained motion, m; "
                    "horizon: up to when a perturbation of 1e-10 m stays below 1 mm, s; compared: "
                    "what of the scene's duration is compared, s",
                    "treatment\tbound\tforce_evaluations\tsteps\tstatus\ttreatment_error"
                    "\thorizon\tcompared\tduration\tnote"},
    [SLOPES] = {"-slopes",
                "slopes of log error over log steps, between a relative error of a hundredth and a "
                "hundred "
                "times the reference's bound, " SLOPE_RULE,
                "method\ttreatment\tkind\tslope\tspread\tpoints"},
    [FRONT] =
        {"-front",
         "Pareto fronts: what no other run beats in cost (steps counted and the table of costs, "
         "shown with its CPU time; or evaluations) and in error, as far as the reference can tell "
         "(limited ones left out)",
         "treatment\tmeasure\tcost\terror\tmethod\tsetting"},
    [CHEAPEST] =
        {"-cheapest",
         "the cheapest run with an error of at most target, m, by steps counted and the table of "
         "costs, with its CPU time, s, and the next method; to the error of a limited run the "
         "reference's bound is added; tied: the next one is not known to be dearer",
         "treatment\ttarget\tmethod\tsetting\terror\tcpu_median\tcpu_least\tcpu_greatest"
         "\tnext_method\tnext_setting\tnext_cpu_median\ttied\tnote"},
};

static void write_point(FILE *stream, const struct field *field, const struct point *p) {
    const struct deviation *d = &p->deviation;
    const struct cost *cost = &p->cost;
    fprintf(stream, "%s\t%s\t%s\t%.17g\t%s\t%.17g", p->entry->contestant->name,
            race_treatment(field->treatment), p->entry->contestant->stepper, p->setting, p->status,
            cost->failure_time);
    const double numbers[] = {
        d->rms,          d->largest,         d->relative,       d->end,
        d->velocity,     d->radius,          d->mescd,          cost->cpu.median,
        cost->cpu.least, cost->cpu.greatest, cost->evaluations, cost->steps};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        fprintf(stream, "\t%.17g", numbers[i]);
    fprintf(stream, "\t%d\t%d\t%d\t%.17g\t%.17g\t%d\t%d\t%.17g\t%.17g\t%.17g\t%.17g\t%s\n",
            p->limited, p->front[0], p->front[1], p->error_least, p->error_greatest, p->runs,
            p->failed, cost->cpu.median / field->evaluation, p->extent.strain,
            p->extent.penetration, p->extent.drift,
            !*p->note && isnan(field->evaluation)
                ? "no explicit method with fixed steps, and so no equivalents"
                : p->note);
}

/* Rows of each contestant in the order of its settings; blocks are parted by two blank lines. */
static void write_points(FILE *stream, const struct field *field) {
    for (int i = 0; i < field->point_count; i++) {
        const int last =
            i + 1 == field->point_count || field->points[i + 1].entry != field->points[i].entry;
        write_point(stream, field, &field->points[i]);
        fprintf(stream, "%s", last ? "\n\n" : "");
    }
}

static void write_slope(FILE *stream, const struct field *field,
                        const struct configuration *contestant) {
    const double least = fmax(1e-13, 100 * field->bound);
    struct slope slope = {.count = 0};
    for (int i = 0; i < field->point_count; i++) {
        const struct point *p = &field->points[i];
        if (p->entry->contestant != contestant || !race_finished(p) ||
            p->deviation.relative > 0.01 || p->deviation.rms < least)
            continue; /* out of the asymptotic range, or of what the reference can tell */
        slope_add(&slope, p->cost.steps, p->deviation.rms);
    }
    const struct fit fit = slope_fit(&slope, contestant);
    if (fit.points > 0)
        fprintf(stream, "%s\t%s\t%s\t%.3f\t%.3f\t%d\n", contestant->name,
                race_treatment(field->treatment),
                contestant_is_adaptive(contestant) ? "adaptive" : "fixed", fit.slope, fit.spread,
                fit.points);
}

/* The next point of a front: the cheapest that is dearer than `than`. */
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
            fprintf(stream, "%s\t%s\t%.17g\t%.17g\t%s\t%.17g\n", race_treatment(field->treatment),
                    measure ? "evaluations" : "cpu",
                    measure ? p->cost.evaluations : p->cost.cpu.median, p->deviation.rms,
                    p->entry->contestant->name, p->setting);
        fprintf(stream, "\n\n");
    }
}

static void write_cheapest(FILE *stream, const struct field *field, double target) {
    const struct point *p = race_cheapest(field, target, NULL);
    const struct point *next = p ? race_cheapest(field, target, p->entry->contestant) : NULL;
    fprintf(stream, "%s\t%g\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%.17g\t%.17g\t%d\t%s\n",
            race_treatment(field->treatment), target, p ? p->entry->contestant->name : "none",
            p ? p->setting : NAN, p ? p->deviation.rms : NAN, p ? p->cost.cpu.median : NAN,
            p ? p->cost.cpu.least : NAN, p ? p->cost.cpu.greatest : NAN,
            next ? next->entry->contestant->name : "none", next ? next->setting : NAN,
            next ? next->cost.cpu.median : NAN, next && !cost_is_less(&p->cost, &next->cost),
            next ? ""
            : p  ? "no other method is within the target"
                 : "no run is within the target");
}

/* Why a number of the reference's row is not there; empty where all are. */
static const char *note_of(const struct field *field) {
    if (isnan(field->bound) || isnan(field->horizon))
        return "a tight run did not finish";
    if (!isnan(field->treatment_error))
        return "";
    return field->subject->scene->wisps[0].samples ? "the exact motion's run did not finish"
                                                   : "no envelope, and so no treatment's error";
}

static void write_field(const struct atomic_file *files, const struct field *field) {
    write_points(files[POINTS].stream, field);
    for (int i = 0; i < field->entry_count; i++)
        write_slope(files[SLOPES].stream, field, field->entries[i].contestant);
    write_front(files[FRONT].stream, field);
    fprintf(files[REFERENCES].stream,
            "%s\t%.17g\t%.17g\t%.17g\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%s\n",
            race_treatment(field->treatment), field->bound,
            run_number(&field->reference, "counters.force_evaluations"),
            run_number(&field->reference, "counters.steps"), outcome_name(field->reference.outcome),
            field->treatment_error, field->horizon, field->scene->duration,
            field->subject->scene->duration, note_of(field));
    for (int i = 0; i < TARGETS && field->has_reference; i++)
        write_cheapest(files[CHEAPEST].stream, field, targets[i]);
}

/* Opens the tables of a subject. Returns 0, or -1 with a reason and none of them open. */
static int open_tables(struct atomic_file *files, const struct subject *subject, const char *folder,
                       char *reason) {
    for (int i = 0; i < TABLES; i++) {
        char name[128];
        snprintf(name, sizeof name, "%s%s", subject->name, table_kinds[i].suffix);
        if (open_table(&files[i], folder, name, table_kinds[i].what, subject->scene,
                       table_kinds[i].columns, reason)) {
            while (i-- > 0)
                atomic_discard(&files[i]);
            return -1;
        }
    }
    return 0;
}

static int close_tables(struct atomic_file *files, int code, char *reason) {
    for (int i = 0; i < TABLES; i++) {
        if (code)
            atomic_discard(&files[i]);
        else
            code = atomic_commit(&files[i], reason);
    }
    return code;
}

/* Tables and statements. The fields of a subject follow each other; each keeps its points until all
 * are stated. */
struct output {
    const char *folder;
    FILE *list; /* the figures' */
    struct statements statements;
    struct race_answers answers;
    struct point *points; /* of FIELDS_MAX fields, `most` each */
    int most;
};

static int write_one(struct plan *plan, struct field *field, const struct atomic_file *files,
                     struct output *output) {
    const int code = race_read(plan, field);
    if (!code) {
        write_field(files, field);
        race_state_reference(&output->statements, field);
    }
    run_free(&field->reference);
    return code;
}

/* Returns the number of the subject's fields that have a reference, or -1. */
static int tabulate_subject(struct plan *plan, const struct subject *subject,
                            struct output *output) {
    struct race_notes *notes = plan->memo;
    struct atomic_file files[TABLES];
    int code = open_tables(files, subject, output->folder, plan->reason);
    int first = 0, count = 0, there = 0;
    if (code)
        return -1;
    while (first < notes->field_count && notes->fields[first].subject != subject)
        first++;
    struct field *fields = notes->fields + first;
    for (; first + count < notes->field_count && fields[count].subject == subject && !code;
         count++) {
        fields[count].points = output->points + count * output->most;
        code = write_one(plan, &fields[count], files, output);
        there += fields[count].has_reference;
    }
    if (!code && there > 0)
        race_state_subject(&output->statements, fields, count, &output->answers);
    return close_tables(files, code, plan->reason) ? -1 : there;
}

static double longest_wisp(const struct scene *scene) {
    double length = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        length = fmax(length, scene->wisps[i].length);
    return length;
}

/* The figures' list: scenes with at least one reference. */
static int tabulate_all(struct plan *plan, struct output *output) {
    int drawn = 0;
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        const int there = tabulate_subject(plan, subject, output);
        if (there < 0)
            return -1;
        drawn += there > 0;
        if (there > 0)
            fprintf(output->list, "%s\t%s\t%d\t%.17g\t%d\n", subject->name, subject->scene->name,
                    subject->scene->wisps[0].samples, longest_wisp(subject->scene),
                    subject->scene->wisp_count);
    }
    race_state_all(&output->statements, &output->answers);
    if (drawn > 0)
        return 0;
    snprintf(plan->reason, REASON_SIZE,
             "no reference run reached its end, so there is nothing to measure errors against");
    return 1;
}

static int write_all(struct plan *plan, struct output *output) {
    static const char drawn[] =
        "scenes drawn; --quick: every other tolerance, three jittered runs, and of the shipped "
        "scenes only some";
    const char *cut = plan->quick ? strstr(drawn, "--quick") : NULL;
    struct atomic_file list;
    if (open_table(&list, output->folder, "scenes", plan->quick ? drawn : "scenes drawn", NULL,
                   "file\tname\tsamples\tlength\twisps", plan->reason))
        return -1;
    if (statements_open(&output->statements, output->folder, NULL, cut, plan->reason)) {
        atomic_discard(&list);
        return -1;
    }
    output->list = list.stream;
    const int code =
        statements_close(&output->statements, tabulate_all(plan, output), plan->reason);
    if (!code)
        return atomic_commit(&list, plan->reason);
    atomic_discard(&list);
    return code;
}

int race_tabulate(struct plan *plan, const char *folder) {
    const int most = plan->configuration_count * (RUNGS_MAX + 1) + 1;
    struct output output = {
        .folder = folder,
        .answers = {.asked = plan->experiment->answers,
                    .cheapest = calloc((size_t)plan->subject_count * RACE_TARGETS + 1,
                                       sizeof *output.answers.cheapest)},
        .points = calloc((size_t)(FIELDS_MAX * most), sizeof *output.points),
        .most = most};
    int code = -1;
    if (output.answers.cheapest && output.points)
        code = write_all(plan, &output);
    else
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    free(output.answers.cheapest);
    free(output.points);
    return code;
}
