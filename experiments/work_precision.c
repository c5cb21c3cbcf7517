/* What does accuracy cost? Every stepper on scenes of wisps, from steps that are too long for it to
 * steps that are shorter than anyone needs: integration error, against the tight solution of the
 * same treatment, over CPU time and force evaluations. How far a treatment is from the exact
 * constrained motion is another question (experiment treatments). */
#include "measure.h"
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const own_scenes[] = {"swing", "swing-envelope"};

/* Costs only bound the ladders: they were measured on the shipped scenes, and are good to a factor
 * of two. A part of four wisps costs what a part of one does. */
static const struct contestant contestants[] = {
    {.name = "euler", .stepper = "euler", .cost = 12e-9},
    {.name = "midpoint", .stepper = "midpoint", .cost = 24e-9},
    {.name = "rk4", .stepper = "rk4", .cost = 40e-9},
    {.name = "implicit-euler direct",
     .stepper = "implicit-euler",
     .linear = "direct",
     .cost = 80e-9},
    {.name = "implicit-euler direct newton",
     .stepper = "implicit-euler",
     .linear = "direct",
     .option = "newton.iterations=30",
     .cost = 400e-9},
    {.name = "implicit-euler cg", .stepper = "implicit-euler", .linear = "cg", .cost = 180e-9},
    {.name = "implicit-euler cg newton",
     .stepper = "implicit-euler",
     .linear = "cg",
     .option = "newton.iterations=30",
     .cost = 800e-9},
    {.name = "cvode", .stepper = "cvode", .finest = 1e-8},
    {.name = "cvode order 5", .stepper = "cvode", .option = "max_order=5", .finest = 1e-11},
    {.name = "cvode klu",
     .stepper = "cvode",
     .linear = "klu",
     .option = "jacobian=exact",
     .finest = 1e-8},
    {.name = "reference", .stepper = "reference", .finest = 1e-10},
};
enum { CONTESTANTS = sizeof contestants / sizeof *contestants, RUNGS_MAX = 48, TOLERANCES = 11 };

static const double targets[] = {1e-2, 1e-3, 1e-4, 1e-5}; /* m: errors that someone may want */
enum { TARGETS = sizeof targets / sizeof *targets };

/* --- the ladders --- */

/* The k-th step, or tolerance from 1e-1 to the finest. */
static double setting(const struct scene *scene, const struct contestant *contestant, int k) {
    return contestant_is_adaptive(contestant)
               ? pow(10, -1 + (log10(contestant->finest) + 1) * k / (TOLERANCES - 1))
               : ladder_step(scene, 2, k);
}

/* CPU time of one run at the k-th step, s, roughly. */
static double estimated_cost(const struct scene *scene, const struct contestant *contestant,
                             int treatment, int k) {
    double unknowns = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        unknowns += (scene->wisps[i].nodes - 2) *
                    wisp_node_unknowns(&scene->wisps[i], (enum wisp_treatment)treatment);
    const double parts = ceil(scene->wisp_count / 4.) / scene->wisp_count;
    return contestant->cost * unknowns * parts * scene->duration / setting(scene, contestant, k);
}

/* How many rungs the ladder has: the first ten, and until the method has six that linear theory
 * calls stable, unless a run would take more than 3 s; then as many as take 0.05 s at most. */
static int rungs(const struct scene *scene, const struct contestant *contestant, int treatment) {
    if (contestant_is_adaptive(contestant))
        return TOLERANCES;
    const struct mode mode = stiffest_mode(scene);
    const struct butcher_table *table = stepper_find(contestant->stepper)->table;
    int stable = 0, k = 0;
    for (; k < RUNGS_MAX; k++) {
        const int wanted = k < 10 || stable < 6;
        if (estimated_cost(scene, contestant, treatment, k) > (wanted ? 3 : 0.05))
            break;
        stable += table && is_stable(table, &mode, setting(scene, contestant, k));
    }
    return k;
}

/* --- the runs --- */

/* Without an envelope the treatments are the same equations. */
static int has_treatment(const struct scene *scene, int treatment) {
    return scene->wisps[0].samples > 0 || treatment == WISP_GENERALISED;
}

static const char *treatment_name(int treatment) {
    return wisp_problem.treatments[treatment].name;
}

static void name_group(char *group, size_t size, const struct subject *subject, int treatment) {
    snprintf(group, size, "%s %s", subject->name, treatment_name(treatment));
}

static void name_run(char *label, size_t size, const struct scene *scene,
                     const struct contestant *contestant, int k) {
    snprintf(label, size, "%s, %s %g", contestant->name,
             contestant_is_adaptive(contestant) ? "rtol" : "step", setting(scene, contestant, k));
}

static struct run_request request_for(const struct plan *plan, const struct scene *scene,
                                      const struct contestant *contestant, int treatment, int k) {
    struct run_request request = contestant_request(contestant, setting(scene, contestant, k),
                                                    scene->run.atol / scene->run.rtol);
    request.treatment = treatment_name(treatment);
    const double cost = estimated_cost(scene, contestant, treatment, k);
    request.timings = plan->quick || (!contestant_is_adaptive(contestant) && cost > 0.2) ? 2 : 5;
    return request;
}

/* --quick runs every third rung. */
static int is_in(const struct plan *plan, int k) {
    return !plan->quick || k % 3 == 0;
}

/* A pair that is refused is no run; it gets a line in the table. */
static int plan_contestant(struct plan *plan, const struct subject *subject,
                           const struct contestant *contestant, int treatment) {
    const struct scene *scene = subject->scene;
    char group[96], label[64];
    name_group(group, sizeof group, subject, treatment);
    for (int k = 0; k < rungs(scene, contestant, treatment); k++) {
        const struct run_request request = request_for(plan, scene, contestant, treatment, k);
        struct settings settings;
        if (!is_in(plan, k) || settings_resolve(scene, &request, &settings, plan->reason))
            continue;
        name_run(label, sizeof label, scene, contestant, k);
        if (plan_add(plan, scene, &request, group, "%s", label))
            return -1;
    }
    return 0;
}

static int plan_subject(struct plan *plan, const struct subject *subject) {
    for (int t = 0; wisp_problem.treatments[t].name; t++) {
        char group[96];
        const struct run_request tight = {.stepper = "reference", .treatment = treatment_name(t)};
        name_group(group, sizeof group, subject, t);
        if (!has_treatment(subject->scene, t))
            continue;
        if (plan_add(plan, subject->scene, &tight, group, "tight"))
            return -1;
        for (int c = 0; c < CONTESTANTS; c++)
            if (plan_wants(plan, contestants[c].stepper) &&
                plan_contestant(plan, subject, &contestants[c], t))
                return -1;
    }
    return 0;
}

static int work_precision_plan(struct plan *plan) {
    plan->run_seconds = 20;
    if (plan_subjects(plan, own_scenes, plan->quick ? 1 : 2))
        return -1;
    for (int i = 0; i < plan->subject_count; i++)
        if (plan_subject(plan, &plan->subjects[i]))
            return -1;
    return 0;
}

/* --- reading the runs --- */

struct point {
    const struct contestant *contestant;
    double setting;
    const char *status; /* an outcome's name, "parted", "refused" or "left out" */
    struct cost cost;
    struct deviation deviation; /* NaN where the run did not finish */
    int limited;                /* closer to the reference than ten times its bound */
    int front[2];               /* not limited, and none is cheaper and better: by CPU time, by
                                   evaluations */
    char note[REASON_SIZE];
};

/* One panel: the runs of a scene with one treatment. */
struct field {
    const struct subject *subject;
    int treatment;
    int has_reference;
    double bound; /* of the reference, m; NaN: unknown */
    struct run_files reference;
    struct point points[CONTESTANTS * (RUNGS_MAX + 1)];
    int count;
};

static int is_finished(const struct point *p) {
    return p->cost.outcome == FINISHED && isfinite(p->deviation.rms) && isnan(p->deviation.parted);
}

static struct point *new_point(struct field *field, const struct contestant *contestant, int k,
                               const char *status) {
    struct point *p = &field->points[field->count++];
    const struct deviation none = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    const struct cost unknown = {REFUSED, NAN, NAN, NAN, {NAN, NAN, NAN}};
    *p = (struct point){.contestant = contestant,
                        .setting = setting(field->subject->scene, contestant, k),
                        .status = status,
                        .cost = unknown,
                        .deviation = none};
    return p;
}

static int read_point(struct plan *plan, struct field *field, const struct labelled_case *one,
                      struct point *p) {
    const struct scene *scene = field->subject->scene;
    struct run_files run;
    int code = 0;
    if (run_read(&run, one->run.folder, plan->reason))
        return -1;
    p->cost = run_cost(&run);
    p->status = outcome_name(run.outcome);
    const char *reason = json_string_value(json_object_get(run.json, "reason"));
    snprintf(p->note, sizeof p->note, "%s", reason ? reason : "");
    if (run.outcome == FINISHED && field->has_reference) {
        code = measure_deviation(scene, &run.states, &field->reference.states,
                                 scene->run.atol / scene->run.rtol, &p->deviation, plan->reason);
        p->limited = p->deviation.rms < 10 * field->bound;
        if (!isnan(p->deviation.parted)) {
            p->status = "parted"; /* on the chart as a failure: its error is of fewer frames */
            snprintf(p->note, sizeof p->note,
                     "wisps split at other ticks than the reference's; compared before %.6g s",
                     p->deviation.parted);
        }
    }
    run_free(&run);
    return code;
}

/* Why there is no run where there might have been one. */
static void note_absence(const struct plan *plan, struct field *field,
                         const struct contestant *contestant) {
    const struct scene *scene = field->subject->scene;
    const struct run_request request = request_for(plan, scene, contestant, field->treatment, 0);
    const int end = rungs(scene, contestant, field->treatment);
    struct settings settings;
    char reason[REASON_SIZE];
    if (settings_resolve(scene, &request, &settings, reason)) {
        struct point *p = new_point(field, contestant, 0, "refused");
        memcpy(p->note, reason, sizeof p->note);
    } else if (!contestant_is_adaptive(contestant)) {
        struct point *p = new_point(field, contestant, end, "left out");
        snprintf(p->note, sizeof p->note,
                 "this step and shorter ones: a run would take about %.2g s and is timed %d times",
                 estimated_cost(scene, contestant, field->treatment, end), request.timings);
    }
}

static int read_contestant(struct plan *plan, struct field *field,
                           const struct contestant *contestant) {
    const struct scene *scene = field->subject->scene;
    char group[96], label[64];
    name_group(group, sizeof group, field->subject, field->treatment);
    for (int k = 0; k < rungs(scene, contestant, field->treatment); k++) {
        name_run(label, sizeof label, scene, contestant, k);
        const struct labelled_case *one = find_case(plan, group, label);
        if (one && read_point(plan, field, one, new_point(field, contestant, k, "")))
            return -1;
    }
    note_absence(plan, field, contestant);
    return 0;
}

/* A reference that failed is said in one line; its runs keep their rows, without errors. */
static int read_reference(struct plan *plan, struct field *field) {
    char group[96];
    name_group(group, sizeof group, field->subject, field->treatment);
    if (run_read(&field->reference, find_case(plan, group, "tight")->run.folder, plan->reason))
        return -1;
    field->has_reference = field->reference.outcome == FINISHED;
    field->bound = run_number(&field->reference, "second_opinion.bound");
    if (!field->has_reference)
        printf("  %s: no reference (%s at t = %g s), hence no errors; try --fresh with a longer "
               "--time-limit\n",
               group, outcome_name(field->reference.outcome),
               run_number(&field->reference, "simulated_time"));
    return 0;
}

static double cost_of(const struct point *p, int measure) {
    return measure == 0 ? p->cost.cpu.median : p->cost.evaluations;
}

/* Marks the points that no other one beats in cost and in error. A limited one may beat another but
 * has no place itself: how good it is cannot be told from the reference. */
static void mark_front(struct field *field, int measure) {
    for (int i = 0; i < field->count; i++) {
        struct point *p = &field->points[i];
        p->front[measure] = is_finished(p) && !p->limited;
        for (int j = 0; j < field->count && p->front[measure]; j++) {
            const struct point *other = &field->points[j];
            const int as_good = is_finished(other) && j != i &&
                                cost_of(other, measure) <= cost_of(p, measure) &&
                                other->deviation.rms <= p->deviation.rms;
            const int better = cost_of(other, measure) < cost_of(p, measure) ||
                               other->deviation.rms < p->deviation.rms;
            if (as_good && (better || j < i))
                p->front[measure] = 0;
        }
    }
}

static int read_field(struct plan *plan, struct field *field) {
    if (read_reference(plan, field))
        return -1;
    for (int c = 0; c < CONTESTANTS; c++)
        if (plan_wants(plan, contestants[c].stepper) &&
            read_contestant(plan, field, &contestants[c]))
            return -1;
    mark_front(field, 0);
    mark_front(field, 1);
    return 0;
}

/* --- the tables --- */

enum { POINTS, REFERENCES, SLOPES, FRONT, CHEAPEST, TABLES };

static const struct {
    const char *suffix, *what, *columns;
} table_kinds[TABLES] = {
    [POINTS] =
        {"",
         "integration error against the tight solution of the same treatment, over free "
         "nodes and all frames, the common start among them: error = rms, m; largest, m; "
         "relative = rms over length; end = rms at the end, m; velocity = rms, m/s; "
         "radius = rms of the samples' distance from their node, m; mescd at the end; CPU "
         "time, s, of repeated runs; setting: step, s, or rtol; limited: within ten times "
         "the reference's bound, and so on no front; front: Pareto, by CPU time and by force "
         "evaluations; nan: there is no number, see status and note; parted: wisps split at other "
         "ticks than the reference's, from where on nothing is compared",
         "method\ttreatment\tstepper\tsetting\tstatus\tfailure_time\terror\tlargest\trelative"
         "\tend\tvelocity\tradius\tmescd\tcpu_median\tcpu_least\tcpu_greatest"
         "\tforce_evaluations\tsteps\tlimited\tfront_cpu\tfront_evaluations\tnote"},
    [REFERENCES] = {"-reference",
                    "the tight solutions: bound = largest difference from the second opinion, m",
                    "treatment\tbound\tforce_evaluations\tsteps\tstatus"},
    [SLOPES] = {"-slopes",
                "slopes of log error over log steps, between a relative error of a hundredth and a "
                "hundred "
                "times the reference's bound, " SLOPE_RULE,
                "method\ttreatment\tkind\tslope\tspread\tpoints"},
    [FRONT] =
        {"-front",
         "Pareto fronts: what no other run beats in cost and in error, as far as the reference can "
         "tell (limited ones left out)",
         "treatment\tmeasure\tcost\terror\tmethod\tsetting"},
    [CHEAPEST] =
        {"-cheapest",
         "the least CPU time, s, for an error of at most target, m, and the next method; to the "
         "error of a limited run the reference's bound is added",
         "treatment\ttarget\tmethod\tsetting\terror\tcpu_median\tcpu_least\tcpu_greatest"
         "\tnext_method\tnext_setting\tnext_cpu_median"},
};

static void write_point(FILE *stream, const struct field *field, const struct point *p) {
    const struct deviation *d = &p->deviation;
    const struct cost *cost = &p->cost;
    fprintf(stream, "%s\t%s\t%s\t%.17g\t%s\t%.17g", p->contestant->name,
            treatment_name(field->treatment), p->contestant->stepper, p->setting, p->status,
            cost->failure_time);
    const double numbers[] = {
        d->rms,          d->largest,         d->relative,       d->end,
        d->velocity,     d->radius,          d->mescd,          cost->cpu.median,
        cost->cpu.least, cost->cpu.greatest, cost->evaluations, cost->steps};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        fprintf(stream, "\t%.17g", numbers[i]);
    fprintf(stream, "\t%d\t%d\t%d\t%s\n", p->limited, p->front[0], p->front[1], p->note);
}

/* Rows of each contestant in the order of its settings; blocks are parted by two blank lines. */
static void write_points(FILE *stream, const struct field *field) {
    for (int i = 0; i < field->count; i++) {
        const int last =
            i + 1 == field->count || field->points[i + 1].contestant != field->points[i].contestant;
        write_point(stream, field, &field->points[i]);
        fprintf(stream, "%s", last ? "\n\n" : "");
    }
}

static void write_slope(FILE *stream, const struct field *field,
                        const struct contestant *contestant) {
    const double least = fmax(1e-13, 100 * field->bound);
    struct slope slope = {.count = 0};
    for (int i = 0; i < field->count; i++) {
        const struct point *p = &field->points[i];
        if (p->contestant != contestant || !is_finished(p) || p->deviation.relative > 0.01 ||
            p->deviation.rms < least)
            continue;
        slope_add(&slope, p->cost.steps, p->deviation.rms);
    }
    const struct fit fit = slope_fit(&slope, contestant);
    if (fit.points > 0)
        fprintf(stream, "%s\t%s\t%s\t%.3f\t%.3f\t%d\n", contestant->name,
                treatment_name(field->treatment),
                contestant_is_adaptive(contestant) ? "adaptive" : "fixed", fit.slope, fit.spread,
                fit.points);
}

/* The next point of a front: the cheapest that is dearer than `than`. */
static const struct point *next_on_front(const struct field *field, int measure, double than) {
    const struct point *best = NULL;
    for (int i = 0; i < field->count; i++) {
        const struct point *p = &field->points[i];
        if (p->front[measure] && cost_of(p, measure) > than &&
            (!best || cost_of(p, measure) < cost_of(best, measure)))
            best = p;
    }
    return best;
}

static void write_front(FILE *stream, const struct field *field) {
    for (int measure = 0; measure < 2; measure++) {
        const struct point *p = next_on_front(field, measure, -1);
        for (; p; p = next_on_front(field, measure, cost_of(p, measure)))
            fprintf(stream, "%s\t%s\t%.17g\t%.17g\t%s\t%.17g\n", treatment_name(field->treatment),
                    measure ? "evaluations" : "cpu", cost_of(p, measure), p->deviation.rms,
                    p->contestant->name, p->setting);
        fprintf(stream, "\n\n");
    }
}

/* The error of a run at most: a limited one's is known to within the reference's bound. */
static double error_at_most(const struct field *field, const struct point *p) {
    return p->deviation.rms + (p->limited ? field->bound : 0);
}

/* The cheapest run within the target, of another contestant than `besides`; or NULL. */
static const struct point *cheapest(const struct field *field, double target,
                                    const struct contestant *besides) {
    const struct point *best = NULL;
    for (int i = 0; i < field->count; i++) {
        const struct point *p = &field->points[i];
        if (is_finished(p) && error_at_most(field, p) <= target && p->contestant != besides &&
            (!best || p->cost.cpu.median < best->cost.cpu.median))
            best = p;
    }
    return best;
}

static void write_cheapest(FILE *stream, const struct field *field, double target) {
    const struct point *p = cheapest(field, target, NULL);
    const struct point *next = p ? cheapest(field, target, p->contestant) : NULL;
    fprintf(stream, "%s\t%g\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%.17g\t%.17g\n",
            treatment_name(field->treatment), target, p ? p->contestant->name : "none",
            p ? p->setting : NAN, p ? p->deviation.rms : NAN, p ? p->cost.cpu.median : NAN,
            p ? p->cost.cpu.least : NAN, p ? p->cost.cpu.greatest : NAN,
            next ? next->contestant->name : "none", next ? next->setting : NAN,
            next ? next->cost.cpu.median : NAN);
    printf("  %-15.15s %-12s %7g", field->subject->name, treatment_name(field->treatment),
           1e3 * target);
    if (!p) {
        printf("   none\n");
        return;
    }
    printf("   %-29s %4s %-10.3g %8.2f   ", p->contestant->name,
           contestant_is_adaptive(p->contestant) ? "rtol" : "h", p->setting,
           1e3 * p->cost.cpu.median);
    printf(next ? "%s %.2f\n" : "\n", next ? next->contestant->name : "",
           next ? 1e3 * next->cost.cpu.median : 0);
}

static void write_field(const struct atomic_file *files, const struct field *field) {
    write_points(files[POINTS].stream, field);
    for (int c = 0; c < CONTESTANTS; c++)
        write_slope(files[SLOPES].stream, field, &contestants[c]);
    write_front(files[FRONT].stream, field);
    fprintf(
        files[REFERENCES].stream, "%s\t%.17g\t%.17g\t%.17g\t%s\n", treatment_name(field->treatment),
        field->bound, run_number(&field->reference, "counters.force_evaluations"),
        run_number(&field->reference, "counters.steps"), outcome_name(field->reference.outcome));
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

/* Returns the number of treatments that have a reference, or -1. */
static int tabulate_subject(struct plan *plan, const struct subject *subject, const char *folder,
                            struct field *field) {
    struct atomic_file files[TABLES];
    int code = open_tables(files, subject, folder, plan->reason), there = 0;
    if (code)
        return -1;
    for (int t = 0; wisp_problem.treatments[t].name && !code; t++) {
        if (!has_treatment(subject->scene, t))
            continue;
        memset(field, 0, sizeof *field);
        field->subject = subject;
        field->treatment = t;
        code = read_field(plan, field);
        if (!code)
            write_field(files, field);
        there += field->has_reference;
        run_free(&field->reference);
    }
    return close_tables(files, code, plan->reason) ? -1 : there;
}

static double longest_wisp(const struct scene *scene) {
    double length = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        length = fmax(length, scene->wisps[i].length);
    return length;
}

/* The figures' list: scenes with at least one reference. */
static int tabulate_all(struct plan *plan, const char *folder, FILE *list, struct field *field) {
    int drawn = 0;
    printf("  %-15s %-12s %7s   %-29s %4s %-10s %8s   %s\n", "scene", "treatment", "mm",
           "cheapest method", "", "setting", "CPU ms", "next, CPU ms");
    for (int i = 0; i < plan->subject_count; i++) {
        const struct subject *subject = &plan->subjects[i];
        const int there = tabulate_subject(plan, subject, folder, field);
        if (there < 0)
            return -1;
        drawn += there > 0;
        if (there > 0)
            fprintf(list, "%s\t%s\t%d\t%.17g\n", subject->name, subject->scene->name,
                    subject->scene->wisps[0].samples, longest_wisp(subject->scene));
    }
    if (drawn > 0)
        return 0;
    snprintf(plan->reason, REASON_SIZE,
             "no reference run reached its end, so there is nothing to measure errors against");
    return 1;
}

static int work_precision_tabulate(struct plan *plan, const char *folder) {
    struct atomic_file list;
    if (open_table(&list, folder, "scenes",
                   plan->quick ? "scenes drawn; --quick: every third step or tolerance, and of the "
                                 "shipped scenes only the first"
                               : "scenes drawn",
                   NULL, "file\tname\tsamples\tlength", plan->reason))
        return -1;
    struct field *field = malloc(sizeof *field); /* too large for the stack */
    if (!field)
        snprintf(plan->reason, REASON_SIZE, "out of memory");
    const int code = field ? tabulate_all(plan, folder, list.stream, field) : -1;
    free(field);
    if (!code)
        return atomic_commit(&list, plan->reason);
    atomic_discard(&list);
    return code;
}

const struct experiment work_precision_experiment = {
    .name = "work-precision",
    .question = "what does accuracy cost, by stepper, treatment and scene?",
    .plan = work_precision_plan,
    .tabulate = work_precision_tabulate,
};
