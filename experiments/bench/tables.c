/* Tables, and the answer in a few lines, from the samples alone. */
#include "base/files.h"
#include "experiments/common/measure.h"
#include "experiments/common/statements.h"
#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int batches[] = {4, 64, 256};
enum { BATCHES = 3, SHOWN_BATCH = 64 };

struct tables {
    const struct scene *scene;
    const struct samples *samples;
    const char *folder;
    struct statements *statements;
    char *reason;
};

static void put(FILE *stream, struct quartiles q) {
    fprintf(stream, "\t%.17g\t%.17g\t%.17g", q.median, q.lower, q.upper);
}

/* --- evaluations --- */

/* Of one set: times of the three, the floor, and ratios. */
struct evaluation {
    struct quartiles four, one, twin, floor, twin_over_four, one_over_four, four_over_floor;
};

static struct evaluation evaluation_of(const struct samples *samples, const struct wisp_set *set) {
    double floor[KERNEL_ROUNDS_MAX], ratio[KERNEL_ROUNDS_MAX];
    char subject[SUBJECT_SIZE];
    wisp_set_subject(set, subject);
    const struct series *four = series_find(samples, "evaluation", subject, "kernel 4");
    const struct series *one = series_find(samples, "evaluation", subject, "kernel 1");
    const struct series *twin = series_find(samples, "evaluation", subject, "twin");
    const int rounds = four ? floor_times(samples, set, floor) : 0;
    for (int i = 0; i < rounds; i++)
        ratio[i] = four->value[i] / floor[i];
    return (struct evaluation){
        series_quartiles(four),   series_quartiles(one),       series_quartiles(twin),
        quartiles(floor, rounds), ratio_quartiles(twin, four), ratio_quartiles(one, four),
        quartiles(ratio, rounds),
    };
}

static void print_evaluation(const struct wisp_set *set, const struct evaluation *e) {
    printf("  %-12s %-6s %3d %8.1f %8.1f %8.1f %8.1f %8.1f %8.1f   %.2f (%.2f to %.2f)\n",
           set->samples ? treatment_name(set->treatment) : "skeleton", bending_name(set->bending),
           set->samples, e->twin.median, e->one.median, e->four.median, e->floor.median,
           e->twin_over_four.median, e->one_over_four.median, e->four_over_floor.median,
           e->four_over_floor.lower, e->four_over_floor.upper);
}

static void write_evaluation(FILE *stream, const struct wisp_set *set, const struct evaluation *e) {
    fprintf(stream, "%s\t%s\t%d\t%d", set->samples ? treatment_name(set->treatment) : "skeleton",
            bending_name(set->bending), set->samples, set->wisps);
    put(stream, e->four);
    put(stream, e->one);
    put(stream, e->twin);
    put(stream, e->floor);
    put(stream, e->twin_over_four);
    put(stream, e->one_over_four);
    put(stream, e->four_over_floor);
    fputc('\n', stream);
}

#define TRIPLE(name) "\t" name "\t" name "_lower\t" name "_upper"

static int write_evaluations(const struct tables *tables) {
    struct atomic_file file;
    struct wisp_set sets[WISP_SETS_MAX];
    if (open_table(&file, tables->folder, "evaluation",
                   "ns per free node and evaluation of one wisp, median and quartiles over rounds; "
                   "ratios formed round by round",
                   tables->scene,
                   "treatment\tbending\tsamples\twisps" TRIPLE("kernel4") TRIPLE("kernel1")
                       TRIPLE("twin") TRIPLE("floor") TRIPLE("twin_over_kernel4")
                           TRIPLE("kernel1_over_kernel4") TRIPLE("kernel4_over_floor"),
                   tables->reason))
        return -1;
    printf("  evaluation, batch of %d: ns per free node\n  %-12s %-6s %3s %8s %8s %8s %8s %8s %8s"
           "   %s\n",
           SHOWN_BATCH, "treatment", "bend", "M", "twin", "1 lane", "4 lanes", "floor", "twin/4",
           "1/4", "4 lanes/floor (quartiles)");
    for (int b = 0; b < BATCHES; b++) {
        const int count = wisp_sets(batches[b], sets);
        for (int i = 0; i < count; i++) {
            const struct evaluation e = evaluation_of(tables->samples, &sets[i]);
            write_evaluation(file.stream, &sets[i], &e);
            if (batches[b] == SHOWN_BATCH)
                print_evaluation(&sets[i], &e);
        }
    }
    return atomic_commit(&file, tables->reason);
}

/* --- operations --- */

static void write_executed(FILE *stream, const struct samples *samples, const char *subject,
                           const char *lanes) {
    for (int k = 0; k < EXECUTED_KINDS; k++) {
        char name[32];
        snprintf(name, sizeof name, "%s %s", executed_names[k], lanes);
        fprintf(stream, "\t%g", note_find(samples, "executed", subject, name));
    }
}

/* The floor stands on the table of needed operations. Where the program does with fewer, the table
 * is wrong, or the program has found a way that the table does not know; then it is said. A tenth
 * of the additions is left for common parts that a compiler finds. */
static int doubtful(const struct samples *samples, const char *subject,
                    const struct operations *need) {
    const double roots = note_find(samples, "executed", subject, "square roots kernel 1");
    const double divisions = note_find(samples, "executed", subject, "divisions kernel 1");
    const double others = note_find(samples, "executed", subject, "additions kernel 1");
    const double library = note_find(samples, "executed", subject, "library kernel 1");
    const int angle = library > 0; /* atan2's operations are the library's */
    if (!(roots < need->square_roots - 1e-9 || divisions < need->divisions - angle - 1e-9 ||
          others < 0.9 * (need->others - 45 * angle)))
        return 0;
    printf("  %s: the program executes fewer operations than the floor is made of (%g, %g, %g; "
           "%g, %g, %g)\n",
           subject, roots, divisions, others, need->square_roots, need->divisions, need->others);
    return 1;
}

static int write_operations(const struct tables *tables) {
    struct atomic_file file;
    struct wisp_set sets[WISP_SETS_MAX];
    const int count = wisp_sets(SHOWN_BATCH, sets);
    int doubts = 0;
    if (open_table(&file, tables->folder, "operations",
                   "operations per free node and wisp: what the model needs, and what the kernel "
                   "executes with 4 lanes and with 1 (of the first three kinds, results per lane; "
                   "of the others, instructions; nan: not counted)",
                   tables->scene,
                   "treatment\tbending\tsamples\troots\tdivisions\tadditions\troots4\tdivisions4\t"
                   "additions4\tlogic4\tarranging4\tmoves4\tother4\tlibrary4\troots1\tdivisions1\t"
                   "additions1\tlogic1\tarranging1\tmoves1\tother1\tlibrary1",
                   tables->reason))
        return -1;
    for (int i = 0; i < count; i++) {
        const struct operations need = needed_operations(&sets[i]);
        char subject[SUBJECT_SIZE];
        wisp_set_subject(&sets[i], subject);
        fprintf(file.stream, "%s\t%s\t%d\t%g\t%g\t%g",
                sets[i].samples ? treatment_name(sets[i].treatment) : "skeleton",
                bending_name(sets[i].bending), sets[i].samples, need.square_roots, need.divisions,
                need.others);
        write_executed(file.stream, tables->samples, subject, "kernel 4");
        write_executed(file.stream, tables->samples, subject, "kernel 1");
        fputc('\n', file.stream);
        doubts += doubtful(tables->samples, subject, &need);
    }
    if (!doubts)
        printf("  the kernel executes at least the operations that the floor is made of\n");
    return atomic_commit(&file, tables->reason);
}

static int write_rates(const struct tables *tables) {
    static const char *const names[] = {"division", "square root", "add or multiply"};
    struct atomic_file file;
    if (open_table(&file, tables->folder, "rates",
                   "ns per operation on 4 doubles, independent of each other", tables->scene,
                   "operation" TRIPLE("ns"), tables->reason))
        return -1;
    printf("  the machine, per 4 doubles:");
    for (int i = 0; i < 3; i++) {
        const struct quartiles q =
            series_quartiles(series_find(tables->samples, "rate", "rates skip 64", names[i]));
        fputs(names[i], file.stream);
        put(file.stream, q);
        fputc('\n', file.stream);
        printf(" %s %.3g ns%s", names[i], q.median, i < 2 ? "," : "\n");
    }
    return atomic_commit(&file, tables->reason);
}

/* --- goals --- */

/* Goals of this experiment: a ratio and its bound. */
static void write_goal(FILE *stream, const struct tables *tables, const char *what,
                       struct quartiles q, const char *sense, double bound) {
    const int met = *sense == '<' ? q.median <= bound : q.median >= bound;
    fprintf(stream, "%s\t%s\t%g\t%.17g\t%.17g\t%.17g\t%s\n", what, sense, bound, q.median, q.lower,
            q.upper, met ? "met" : "not met");
    const struct statement row = {.key = what,
                                  .tables = "goals",
                                  .verdict = isnan(q.median) ? NOT_REACHED : holds_if(met),
                                  .value = q.median,
                                  .unit = "1"};
    if (isnan(q.median))
        statements_add(tables->statements, row, "The ratio '%s' was not measured.", what);
    else
        statements_add(tables->statements, row,
                       "The ratio '%s' is at %s %g: it is %.3g (%.3g to %.3g).", what,
                       *sense == '<' ? "most" : "least", bound, q.median, q.lower, q.upper);
}

/* --- solvers --- */

static const struct solver_row {
    const char *method;
    int lanes;
    double h;
} solver_rows[] = {
    {"direct", 4, 1e-3}, {"direct", 1, 1e-3}, {"klu", 1, 1e-3}, {"cholmod", 1, 1e-3},
    {"cg", 1, 1e-4},     {"cg", 1, 1e-3},     {"cg", 1, 1e-2},
};
enum { SOLVER_ROWS = sizeof solver_rows / sizeof *solver_rows };

/* (a + b) / c round by round; b may be NULL. */
static struct quartiles sum_over(const struct series *a, const struct series *b,
                                 const struct series *c) {
    double ratio[KERNEL_ROUNDS_MAX];
    if (!a || !c)
        return quartiles(NULL, 0);
    for (int i = 0; i < a->count; i++)
        ratio[i] = (a->value[i] + (b ? b->value[i] : 0)) / c->value[i];
    return quartiles(ratio, a->count);
}

static const struct series *solver_series(const struct samples *samples, const char *subject,
                                          const char *what, const struct solver_row *row) {
    char name[32];
    snprintf(name, sizeof name, "%s %s %d %g", what, row->method, row->lanes, row->h);
    return series_find(samples, "solver", subject, name);
}

static const struct series *stage_series(const struct samples *samples, const char *subject,
                                         const char *what, int lanes) {
    char name[32];
    snprintf(name, sizeof name, "%s %d", what, lanes);
    return series_find(samples, "solver", subject, name);
}

static void write_solver(FILE *stream, const struct samples *samples, const struct wisp_set *set,
                         const struct solver_row *row) {
    char subject[SUBJECT_SIZE], skeleton[SUBJECT_SIZE], name[32];
    const struct wisp_set bare = {set->treatment, set->bending, 0, 200};
    wisp_set_subject(set, subject);
    wisp_set_subject(&bare, skeleton);
    const struct series *evaluation = stage_series(samples, skeleton, "evaluation", 4);
    const struct series *linearise = stage_series(samples, subject, "linearise", row->lanes);
    const struct series *factor = solver_series(samples, subject, "factor", row);
    const struct series *solve = solver_series(samples, subject, "solve", row);
    const int sparse = strcmp(row->method, "klu") == 0 || strcmp(row->method, "cholmod") == 0;
    const struct series *assemble = sparse ? stage_series(samples, subject, "assemble", 1) : NULL;
    snprintf(name, sizeof name, "solve %s %d %g", row->method, row->lanes, row->h);
    const double iterations = note_find(samples, "iterations", subject, name);
    fprintf(stream, "%s\t%d\t%d\t%s\t%d\t%g\t%g", set->samples ? "generalised" : "skeleton",
            set->samples, set->wisps, row->method, row->lanes, row->h, iterations);
    put(stream, series_quartiles(linearise));
    put(stream, series_quartiles(factor));
    put(stream, series_quartiles(solve));
    const struct quartiles both = sum_over(factor, solve, evaluation);
    put(stream, sum_over(linearise, NULL, evaluation));
    put(stream, sum_over(factor, NULL, evaluation));
    put(stream, sum_over(solve, NULL, evaluation));
    put(stream, both);
    put(stream, series_quartiles(assemble));
    fputc('\n', stream);
    printf("  %-11s %5d  %-8s %d %6g %10.0f %9.0f %9.0f %9.0f %11.1f\n",
           set->samples ? "generalised" : "skeleton", set->wisps, row->method, row->lanes, row->h,
           iterations, series_quartiles(linearise).median, series_quartiles(factor).median,
           series_quartiles(solve).median, both.median);
}

static int write_solvers(const struct tables *tables) {
    struct atomic_file file;
    if (open_table(&file, tables->folder, "solvers",
                   "ns per wisp of 12 nodes with skip springs; factor of klu and cholmod with the "
                   "assembly of their matrix; multiples: over one evaluation of a wisp's skeleton "
                   "among 200 with 4 lanes; nan: the solver has no such stage",
                   tables->scene,
                   "system\tsamples\twisps\tsolver\tlanes\tstep\titerations" TRIPLE("linearise")
                       TRIPLE("factor") TRIPLE("solve") TRIPLE("linearise_evaluations")
                           TRIPLE("factor_evaluations") TRIPLE("solve_evaluations")
                               TRIPLE("factor_solve_evaluations") TRIPLE("assemble"),
                   tables->reason))
        return -1;
    printf("  linear solvers, ns per wisp; factor + solve in skeleton evaluations (4 lanes)\n"
           "  %-11s %5s  %-8s %s %6s %10s %9s %9s %9s %11s\n",
           "system", "wisps", "solver", "L", "step", "iterations", "linearise", "factor", "solve",
           "evaluations");
    for (int samples = 0; samples <= 4; samples += 4)
        for (int wisps = 1; wisps <= 200; wisps += 199)
            for (int i = 0; i < SOLVER_ROWS; i++) {
                const struct wisp_set set = {WISP_GENERALISED, BENDING_SKIP, samples, wisps};
                write_solver(file.stream, tables->samples, &set, &solver_rows[i]);
            }
    return atomic_commit(&file, tables->reason);
}

/* --- seam and CVODE --- */

static void write_pair(FILE *stream, const struct samples *samples, const char *group,
                       const char *subject, const char *name, const char *than) {
    const struct series *a = series_find(samples, group, subject, name);
    const struct series *b = series_find(samples, group, subject, than);
    fprintf(stream, "%s\t%s\t%s\t%s\t%g\t%g", group, subject, name, than,
            note_find(samples, "cvode steps", subject, name),
            note_find(samples, "cvode steps", subject, than));
    put(stream, series_quartiles(a));
    put(stream, series_quartiles(b));
    put(stream, ratio_quartiles(a, b));
    fputc('\n', stream);
    if (strcmp(group, "cvode") == 0)
        printf("  cvode, %s, %s: %.0f steps of %.2f us, ours %.0f of %.2f us: %.2f times a step\n",
               subject, name, note_find(samples, "cvode steps", subject, name),
               1e-3 * series_quartiles(a).median, note_find(samples, "cvode steps", subject, than),
               1e-3 * series_quartiles(b).median, ratio_quartiles(a, b).median);
}

static int write_steppers(const struct tables *tables) {
    const struct samples *s = tables->samples;
    struct atomic_file file;
    if (open_table(
            &file, tables->folder, "steppers",
            "ns per step and wisp, and their ratio round by round; seam: rk4 of the "
            "registry against one by hand; cvode: as it comes against ours; digits: ns a "
            "number as text; stops: a step with the clamp after it, and nine of ten without; "
            "nan: steps are as long, and not counted",
            tables->scene,
            "group\tsubject\tname\tthan\tsteps\tsteps_than" TRIPLE("ns") TRIPLE("ns_than")
                TRIPLE("ratio"),
            tables->reason))
        return -1;
    write_pair(file.stream, s, "seam", "skeleton skip 0 64", "stepper", "by hand");
    write_pair(file.stream, s, "seam", "generalised skip 4 64", "stepper", "by hand");
    static const char *const rtol[] = {"rtol 0.0001", "rtol 1e-06"};
    for (int i = 0; i < 2; i++) {
        write_pair(file.stream, s, "cvode", rtol[i], "stock", "ours");
        write_pair(file.stream, s, "cvode", rtol[i], "stock, our settings", "ours");
    }
    write_pair(file.stream, s, "digits", "a number", "printf", "shortest");
    write_pair(file.stream, s, "stops", "linear-euler", "every step", "every tenth");
    return atomic_commit(&file, tables->reason);
}

/* --- contacts and threads --- */

static const struct series *contact_series(const struct samples *s, const struct mat *mat,
                                           int wisps, const char *name) {
    char subject[SUBJECT_SIZE];
    mat_subject(mat, wisps, subject);
    return series_find(s, "contact", subject, name);
}

static void write_contact(FILE *stream, const struct samples *s, const struct mat *mat, int wisps) {
    char subject[SUBJECT_SIZE];
    mat_subject(mat, wisps, subject);
    const struct series *tick = contact_series(s, mat, wisps, "tick");
    const struct series *evaluation = contact_series(s, mat, wisps, "evaluation");
    const struct quartiles ratio = ratio_quartiles(tick, evaluation);
    const struct quartiles growth =
        ratio_quartiles(tick, contact_series(s, mat, mat_sizes[0], "tick"));
    const double contacts = note_find(s, "contacts", subject, "per point");
    fprintf(stream, "%s\t%d\t%g", mat->name, wisps, contacts);
    put(stream, series_quartiles(tick));
    put(stream, series_quartiles(evaluation));
    put(stream, ratio);
    put(stream, growth);
    fputc('\n', stream);
    printf("  %-16s %6d %9.2f %8.1f %8.1f   %.2f (%.2f to %.2f)   %.2f\n", mat->name, wisps,
           contacts, series_quartiles(tick).median, series_quartiles(evaluation).median,
           ratio.median, ratio.lower, ratio.upper, growth.median);
}

static int write_contacts(const struct tables *tables) {
    struct atomic_file file;
    if (open_table(&file, tables->folder, "contacts",
                   "wisp contact on mats of equal density, ns per point and tick, laying open and "
                   "putting back included; its ratio to an evaluation of one free node in the same "
                   "model (4 lanes), and to the smallest mat's; all round by round",
                   tables->scene,
                   "mat\twisps\tcontacts_per_point" TRIPLE("tick") TRIPLE("evaluation")
                       TRIPLE("tick_over_evaluation") TRIPLE("growth"),
                   tables->reason))
        return -1;
    printf("  contact, ns per point and tick\n  %-16s %6s %9s %8s %8s   %s\n", "mat", "wisps",
           "contacts", "tick", "eval", "tick/evaluation (quartiles), growth");
    for (int m = 0; m < MATS; m++)
        for (int i = 0; i < MAT_SIZES; i++)
            write_contact(file.stream, tables->samples, &mats[m], mat_sizes[i]);
    return atomic_commit(&file, tables->reason);
}

static const char *const threaded[] = {"registers", "euler 9000 Hz", "rk4 4000 Hz"};

/* Gain of the second thread, by round; returns the number of rounds. */
static int gains(const struct samples *s, const char *subject, double *gain) {
    const struct series *one = series_find(s, "threads", subject, "1 thread");
    const struct series *two = series_find(s, "threads", subject, "2 threads");
    for (int i = 0; one && two && i < one->count; i++)
        gain[i] = one->value[i] / two->value[i];
    return one && two ? one->count : 0;
}

static struct quartiles gain_over_registers(const struct samples *s, const char *subject) {
    double gain[KERNEL_ROUNDS_MAX], registers[KERNEL_ROUNDS_MAX];
    const int rounds = gains(s, subject, gain);
    gains(s, threaded[0], registers);
    for (int i = 0; i < rounds; i++)
        gain[i] /= registers[i];
    return quartiles(gain, rounds);
}

static int write_threads(const struct tables *tables) {
    struct atomic_file file;
    if (open_table(&file, tables->folder, "threads",
                   "gain of a second thread (wall time of one over that of two), on arithmetic in "
                   "registers and on a mat of 100 touching wisps; and over that of registers",
                   tables->scene, "work" TRIPLE("gain") TRIPLE("over_registers"), tables->reason))
        return -1;
    for (int i = 0; i < 3; i++) {
        double gain[KERNEL_ROUNDS_MAX];
        const struct quartiles q = quartiles(gain, gains(tables->samples, threaded[i], gain));
        fputs(threaded[i], file.stream);
        put(file.stream, q);
        put(file.stream, gain_over_registers(tables->samples, threaded[i]));
        fputc('\n', file.stream);
        printf("  second thread, %s: %.2f (%.2f to %.2f) times as fast\n", threaded[i], q.median,
               q.lower, q.upper);
    }
    return atomic_commit(&file, tables->reason);
}

static void write_contact_goals(FILE *stream, const struct tables *tables) {
    const struct samples *s = tables->samples;
    char what[80];
    for (int m = 0; m < MATS; m++) {
        for (int i = 0; i < MAT_SIZES; i++) {
            snprintf(what, sizeof what, "contact of a point over evaluation, %s, %d", mats[m].name,
                     mat_sizes[i]);
            write_goal(stream, tables, what,
                       ratio_quartiles(contact_series(s, &mats[m], mat_sizes[i], "tick"),
                                       contact_series(s, &mats[m], mat_sizes[i], "evaluation")),
                       "<=", 4);
        }
        snprintf(what, sizeof what, "contact of a point, 10000 wisps over 100, %s", mats[m].name);
        write_goal(stream, tables, what,
                   ratio_quartiles(contact_series(s, &mats[m], mat_sizes[2], "tick"),
                                   contact_series(s, &mats[m], mat_sizes[0], "tick")),
                   "<=", 1.5);
    }
    for (int i = 1; i < 3; i++) {
        snprintf(what, sizeof what, "gain of a second thread over that on registers, %s",
                 threaded[i]);
        write_goal(stream, tables, what, gain_over_registers(s, threaded[i]), ">=", 0.9);
    }
}

static int write_goals(const struct tables *tables) {
    const struct samples *s = tables->samples;
    struct atomic_file file;
    if (open_table(&file, tables->folder, "goals", "ratios that have a bound to keep",
                   tables->scene, "what\tsense\tbound" TRIPLE("ratio") "\tresult", tables->reason))
        return -1;
    const struct solver_row *direct = &solver_rows[0];
    const char *bare = "skeleton skip 0 200";
    write_goal(
        file.stream, tables, "factor + solve of 200 wisps over skeleton evaluation (4 lanes)",
        sum_over(solver_series(s, bare, "factor", direct), solver_series(s, bare, "solve", direct),
                 stage_series(s, bare, "evaluation", 4)),
        "<=", 3);
    static const char *const seams[] = {"skeleton skip 0 64", "generalised skip 4 64"};
    for (int i = 0; i < 2; i++) {
        char what[80];
        snprintf(what, sizeof what, "rk4 through the seam over rk4 by hand, %s",
                 i ? "generalised" : "skeleton");
        write_goal(file.stream, tables, what,
                   ratio_quartiles(series_find(s, "seam", seams[i], "stepper"),
                                   series_find(s, "seam", seams[i], "by hand")),
                   "<=", 1.05);
    }
    static const char *const rtol[] = {"rtol 0.0001", "rtol 1e-06"};
    for (int i = 0; i < 2; i++) {
        char what[80];
        snprintf(what, sizeof what, "a step of stock CVODE over one of ours, %s", rtol[i]);
        write_goal(file.stream, tables, what,
                   ratio_quartiles(series_find(s, "cvode", rtol[i], "stock"),
                                   series_find(s, "cvode", rtol[i], "ours")),
                   ">=", 3);
    }
    write_contact_goals(file.stream, tables);
    return atomic_commit(&file, tables->reason);
}

/* --- statements --- */

/* What some numbers range over; what is NaN does not count. */
struct range {
    double least, most;
};
static const struct range no_range = {INFINITY, -INFINITY};

static void widen(struct range *range, double value) {
    range->least = fmin(range->least, value);
    range->most = fmax(range->most, value);
}

static void state_range(const struct tables *tables, const char *key, const char *figure,
                        const struct range *range, const char *before, const char *after) {
    const int there = range->least <= range->most;
    struct statement row = {.key = key, .figure = figure, .tables = figure};
    row.verdict = there ? HOLDS : NOT_REACHED;
    if (there)
        statements_add(tables->statements, row, "%s %.4g to %.4g %s.", before, range->least,
                       range->most, after);
    else
        statements_add(tables->statements, row, "%s ... %s: it was not measured.", before, after);
}

static void state_evaluations(const struct tables *tables) {
    struct range times = no_range, twins = no_range, needed = no_range, executed = no_range;
    struct wisp_set sets[WISP_SETS_MAX];
    const int count = wisp_sets(SHOWN_BATCH, sets);
    for (int i = 0; i < count; i++) {
        const struct evaluation e = evaluation_of(tables->samples, &sets[i]);
        char subject[SUBJECT_SIZE];
        wisp_set_subject(&sets[i], subject);
        widen(&times, e.four.median);
        widen(&twins, e.twin_over_four.median);
        widen(&needed, needed_operations(&sets[i]).others);
        widen(&executed, note_find(tables->samples, "executed", subject, "additions kernel 4"));
    }
    state_range(tables, "evaluation", "evaluation", &times,
                "A free node's evaluation in four lanes takes", "ns");
    state_range(tables, "twin", "evaluation", &twins, "A plain program takes",
                "times as long as four lanes");
    state_range(tables, "needed", "operations", &needed, "The model needs",
                "additions and products a node");
    state_range(tables, "executed", "operations", &executed, "Four lanes execute",
                "additions and products a node");
}

static void state_solvers(const struct tables *tables) {
    const struct samples *s = tables->samples;
    struct range factors = no_range, solves = no_range;
    const struct series *evaluation = stage_series(s, "skeleton skip 0 200", "evaluation", 4);
    for (int samples = 0; samples <= 4; samples += 4)
        for (int wisps = 1; wisps <= 200; wisps += 199)
            for (int i = 0; i < SOLVER_ROWS; i++) {
                const struct wisp_set set = {WISP_GENERALISED, BENDING_SKIP, samples, wisps};
                char subject[SUBJECT_SIZE];
                wisp_set_subject(&set, subject);
                widen(&factors, sum_over(solver_series(s, subject, "factor", &solver_rows[i]), NULL,
                                         evaluation)
                                    .median);
                widen(&solves, sum_over(solver_series(s, subject, "solve", &solver_rows[i]), NULL,
                                        evaluation)
                                   .median);
            }
    state_range(tables, "factor", "solvers", &factors, "Factorising takes",
                "evaluations of the wisp's skeleton");
    state_range(tables, "solve", "solvers", &solves, "Solving takes",
                "evaluations of the wisp's skeleton");
}

int write_tables(const struct scene *scene, const struct samples *samples, const char *folder,
                 char *reason) {
    struct statements statements;
    const struct tables tables = {scene, samples, folder, &statements, reason};
    const struct series *first = series_find(samples, "rate", "rates skip 64", "division");
    printf("  %d rounds\n", first ? first->count : 0);
    if (statements_open(&statements, folder, scene, NULL, reason))
        return -1;
    const int code = write_rates(&tables) || write_evaluations(&tables) ||
                             write_operations(&tables) || write_solvers(&tables) ||
                             write_steppers(&tables) || write_contacts(&tables) ||
                             write_threads(&tables) || write_goals(&tables)
                         ? -1
                         : 0;
    if (!code) {
        state_evaluations(&tables);
        state_solvers(&tables);
    }
    return statements_close(&statements, code, reason);
}
