/* Tables, and the answer in a few lines, from the samples alone. */
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
    struct output *output;
};

#define QUARTILES(X, name, unit, meaning, q) QUARTILE_COLUMNS(X, name, unit, meaning, "%.17g", q)
#define SET_COLUMNS(X, set)                                                                    \
    X("treatment", "-", "how samples are kept on their lines; skeleton: there are none", "%s", \
      (set)->samples ? treatment_name((set)->treatment) : "skeleton")                          \
    X("bending", "-", "law of bending", "%s", bending_name((set)->bending))                    \
    X("samples", "1", "samples of the envelope around a node", "%d", (set)->samples)

/* --- evaluations --- */

/* What was measured of one set: times, the floors for 4 and for 8 lanes, and ratios. */
struct evaluation {
    struct quartiles four, one, twin, floor, twin_over_four, one_over_four, four_over_floor;
    struct quartiles eight, floor_of_eight, eight_over_floor;
};

/* The floor for so many lanes, and the kernel's times over it. */
static void find_floor(const struct samples *samples, const struct wisp_set *set,
                       const struct series *kernel, int lanes, struct quartiles *floor,
                       struct quartiles *over) {
    double least[KERNEL_ROUNDS_MAX], ratio[KERNEL_ROUNDS_MAX];
    const int rounds = kernel ? floor_times(samples, set, lanes, least) : 0;
    for (int i = 0; i < rounds; i++)
        ratio[i] = kernel->value[i] / least[i];
    *floor = quartiles(least, rounds);
    *over = quartiles(ratio, rounds);
}

static struct evaluation evaluation_of(const struct samples *samples, const struct wisp_set *set) {
    char subject[SUBJECT_SIZE];
    wisp_set_subject(set, subject);
    const struct series *four = series_find(samples, "evaluation", subject, "kernel 4");
    const struct series *one = series_find(samples, "evaluation", subject, "kernel 1");
    const struct series *twin = series_find(samples, "evaluation", subject, "twin");
    const struct series *eight = series_find(samples, "evaluation", subject, "kernel 8");
    struct evaluation e = {.four = series_quartiles(four),
                           .one = series_quartiles(one),
                           .twin = series_quartiles(twin),
                           .twin_over_four = ratio_quartiles(twin, four),
                           .one_over_four = ratio_quartiles(one, four),
                           .eight = series_quartiles(eight)};
    find_floor(samples, set, four, 4, &e.floor, &e.four_over_floor);
    find_floor(samples, set, eight, 8, &e.floor_of_eight, &e.eight_over_floor);
    return e;
}

static void print_evaluation(const struct wisp_set *set, const struct evaluation *e) {
    printf("  %-12s %-6s %3d %8.1f %8.1f %8.1f %8.1f %8.1f %8.1f   %.2f (%.2f to %.2f)"
           " %8.1f   %.2f (%.2f to %.2f)\n",
           set->samples ? treatment_name(set->treatment) : "skeleton", bending_name(set->bending),
           set->samples, e->twin.median, e->one.median, e->four.median, e->floor.median,
           e->twin_over_four.median, e->one_over_four.median, e->four_over_floor.median,
           e->four_over_floor.lower, e->four_over_floor.upper, e->eight.median,
           e->eight_over_floor.median, e->eight_over_floor.lower, e->eight_over_floor.upper);
}

#define NS(X, name, who, q)         QUARTILES(X, name, "ns", "time of a free node's evaluation by " who, q)
#define OVER(X, name, who, than, q) QUARTILES(X, name, "1", who " over " than, q)
#define EVALUATION_COLUMNS(X)                                                                     \
    SET_COLUMNS(X, set)                                                                           \
    X("wisps", "1", "number of wisps", "%d", set->wisps)                                          \
    NS(X, "kernel4", "the kernel on 4 lanes", e->four)                                            \
    NS(X, "kernel1", "the kernel on 1 lane", e->one)                                              \
    NS(X, "twin", "a plain program", e->twin)                                                     \
    NS(X, "floor", "the needed operations on 4 lanes at the machine's rates", e->floor)           \
    OVER(X, "twin_over_kernel4", "twin", "kernel4", e->twin_over_four)                            \
    OVER(X, "kernel1_over_kernel4", "kernel1", "kernel4", e->one_over_four)                       \
    OVER(X, "kernel4_over_floor", "kernel4", "floor", e->four_over_floor)                         \
    NS(X, "kernel8", "the kernel on 8 lanes", e->eight)                                           \
    NS(X, "floor8", "the needed operations on 8 lanes at the machine's rates", e->floor_of_eight) \
    OVER(X, "kernel8_over_floor8", "kernel8", "floor8", e->eight_over_floor)

static void write_evaluation(FILE *stream, const struct wisp_set *set, const struct evaluation *e) {
    WRITE_ROW(stream, EVALUATION_COLUMNS);
}

static int write_evaluations(const struct tables *tables) {
    struct wisp_set sets[WISP_SETS_MAX];
    FILE *stream = output_table(
        tables->output, "evaluation",
        "ns per free node and evaluation of one wisp, median and quartiles over rounds; "
        "ratios formed round by round",
        tables->scene, COLUMNS(EVALUATION_COLUMNS));
    if (!stream)
        return -1;
    printf("  evaluation, batch of %d: ns per free node\n  %-12s %-6s %3s %8s %8s %8s %8s %8s %8s"
           "   %-20s %8s   %s\n",
           SHOWN_BATCH, "treatment", "bend", "M", "twin", "1 lane", "4 lanes", "floor", "twin/4",
           "1/4", "4 lanes/floor", "8 lanes", "8 lanes/floor");
    for (int b = 0; b < BATCHES; b++) {
        const int count = wisp_sets(batches[b], sets);
        for (int i = 0; i < count; i++) {
            const struct evaluation e = evaluation_of(tables->samples, &sets[i]);
            write_evaluation(stream, &sets[i], &e);
            if (batches[b] == SHOWN_BATCH)
                print_evaluation(&sets[i], &e);
        }
    }
    return 0;
}

/* --- operations --- */

static double executed(const struct samples *samples, const char *subject, const char *what,
                       const char *lanes) {
    char name[40];
    snprintf(name, sizeof name, "%s kernel %s", what, lanes);
    return note_find(samples, "executed", subject, name);
}

#define EXECUTED(X, name, what, lanes)                             \
    X(name lanes, "1", what ", executed with lanes: " lanes, "%g", \
      executed(samples, subject, what, lanes))
#define EXECUTED_COLUMNS(X, lanes)               \
    EXECUTED(X, "roots", "square roots", lanes)  \
    EXECUTED(X, "divisions", "divisions", lanes) \
    EXECUTED(X, "additions", "additions", lanes) \
    EXECUTED(X, "logic", "logic", lanes)         \
    EXECUTED(X, "arranging", "arranging", lanes) \
    EXECUTED(X, "moves", "moves", lanes)         \
    EXECUTED(X, "other", "other", lanes)         \
    EXECUTED(X, "library", "library", lanes)
#define OPERATION_COLUMNS(X)                                                              \
    SET_COLUMNS(X, &sets[i])                                                              \
    X("roots", "1", "square roots that the model needs", "%g", need.square_roots)         \
    X("divisions", "1", "divisions that the model needs", "%g", need.divisions)           \
    X("additions", "1", "additions and products that the model needs", "%g", need.others) \
    EXECUTED_COLUMNS(X, "4")                                                              \
    EXECUTED_COLUMNS(X, "1")                                                              \
    EXECUTED_COLUMNS(X, "8")

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
    printf("  %s: the program executes fewer operations than the floor is made of (%g, %g, %g; %g, "
           "%g, %g)\n",
           subject, roots, divisions, others, need->square_roots, need->divisions, need->others);
    return 1;
}

static int write_operations(const struct tables *tables) {
    struct wisp_set sets[WISP_SETS_MAX];
    const struct samples *samples = tables->samples;
    const int count = wisp_sets(SHOWN_BATCH, sets);
    int doubts = 0;
    FILE *stream = output_table(
        tables->output, "operations",
        "operations per free node and wisp: what the model needs, and what the kernel "
        "executes with 4 lanes, 1 and 8 (of the first three kinds, results per lane; of "
        "the others, instructions; nan: not counted)",
        tables->scene, COLUMNS(OPERATION_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < count; i++) {
        const struct operations need = needed_operations(&sets[i]);
        char subject[SUBJECT_SIZE];
        wisp_set_subject(&sets[i], subject);
        WRITE_ROW(stream, OPERATION_COLUMNS);
        doubts += doubtful(samples, subject, &need);
    }
    if (!doubts)
        printf("  the kernel executes at least the operations that the floor is made of\n");
    return 0;
}

#define RATE_COLUMNS(X)                                           \
    X("operation", "-", "what is done", "%s", names[i])           \
    X("doubles", "1", "on how many numbers at once", "%d", lanes) \
    QUARTILES(X, "ns", "ns", "time of it", q)

static int write_rates(const struct tables *tables) {
    static const char *const names[] = {"division", "square root", "add or multiply"};
    FILE *stream = output_table(tables->output, "rates",
                                "ns per operation on 4 and on 8 doubles, independent of each other",
                                tables->scene, COLUMNS(RATE_COLUMNS));
    if (!stream)
        return -1;
    for (int lanes = 4; lanes <= 8; lanes += 4) {
        printf("  the machine, per %d doubles:", lanes);
        for (int i = 0; i < 3; i++) {
            char name[32];
            snprintf(name, sizeof name, "%s %d", names[i], lanes);
            const struct quartiles q =
                series_quartiles(series_find(tables->samples, "rate", "rates skip 64", name));
            WRITE_ROW(stream, RATE_COLUMNS);
            printf(" %s %.3g ns%s", names[i], q.median, i < 2 ? "," : "\n");
        }
    }
    return 0;
}

/* --- goals --- */

#define GOAL_COLUMNS(X)                                                     \
    X("what", "-", "the ratio", "%s", what)                                 \
    X("sense", "-", "relation that it must have to the bound", "%s", sense) \
    X("bound", "1", "bound of the ratio", "%g", bound)                      \
    QUARTILES(X, "ratio", "1", "the ratio as measured", q)                  \
    X("result", "-", "whether it is met", "%s", met ? "met" : "not met")

/* Goals of this experiment: a ratio and its bound. */
static void write_goal(FILE *stream, const struct tables *tables, const char *what,
                       struct quartiles q, const char *sense, double bound) {
    const int met = *sense == '<' ? q.median <= bound : q.median >= bound;
    WRITE_ROW(stream, GOAL_COLUMNS);
    const struct statement row = our_row(
        NULL, "goals", isnan(q.median) ? NOT_REACHED : holds_if(met), q.median, "1", "%s", what);
    if (isnan(q.median))
        statements_add(&tables->output->statements, row, "The ratio '%s' was not measured.", what);
    else
        statements_add(&tables->output->statements, row,
                       "The ratio '%s' is %.3g (%.3g to %.3g); its goal, at %s %g, is %s.", what,
                       q.median, q.lower, q.upper, *sense == '<' ? "most" : "least", bound,
                       met ? "met" : "missed");
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

#define STAGE(X, name, who, q) QUARTILES(X, name, "ns", "time of a wisp, to " who, q)
#define STAGE_OVER(X, name, who, q) \
    QUARTILES(X, name, "1", "time to " who " over that of an evaluation of a wisp's skeleton", q)
#define SOLVER_COLUMNS(X)                                                                      \
    X("system", "-", "skeleton or generalised: without or with an envelope", "%s",             \
      set->samples ? "generalised" : "skeleton")                                               \
    X("samples", "1", "samples of the envelope around a node", "%d", set->samples)             \
    X("wisps", "1", "number of wisps", "%d", set->wisps)                                       \
    X("solver", "-", "name of the linear solver", "%s", row->method)                           \
    X("lanes", "1", "wisps side by side", "%d", row->lanes)                                    \
    X("step", "s", "length of the step that is solved for", "%g", row->h)                      \
    X("iterations", "1", "iterations of a solve", "%g", iterations)                            \
    STAGE(X, "linearise", "linearise", series_quartiles(linearise))                            \
    STAGE(X, "factor", "factorise", series_quartiles(factor))                                  \
    STAGE(X, "solve", "solve", series_quartiles(solve))                                        \
    STAGE_OVER(X, "linearise_evaluations", "linearise", sum_over(linearise, NULL, evaluation)) \
    STAGE_OVER(X, "factor_evaluations", "factorise", sum_over(factor, NULL, evaluation))       \
    STAGE_OVER(X, "solve_evaluations", "solve", sum_over(solve, NULL, evaluation))             \
    STAGE_OVER(X, "factor_solve_evaluations", "factorise and solve", both)                     \
    STAGE(X, "assemble", "assemble the matrix", series_quartiles(assemble))

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
    const struct quartiles both = sum_over(factor, solve, evaluation);
    WRITE_ROW(stream, SOLVER_COLUMNS);
    printf("  %-11s %5d  %-8s %d %6g %10.0f %9.0f %9.0f %9.0f %11.1f\n",
           set->samples ? "generalised" : "skeleton", set->wisps, row->method, row->lanes, row->h,
           iterations, series_quartiles(linearise).median, series_quartiles(factor).median,
           series_quartiles(solve).median, both.median);
}

static int write_solvers(const struct tables *tables) {
    FILE *stream = output_table(
        tables->output, "solvers",
        "ns per wisp of 12 nodes with skip springs; factor of klu and cholmod with the "
        "assembly of their matrix; multiples: over one evaluation of a wisp's skeleton "
        "among 200 with 4 lanes; nan: the solver has no such stage",
        tables->scene, COLUMNS(SOLVER_COLUMNS));
    if (!stream)
        return -1;
    printf("  linear solvers, ns per wisp; factor + solve in skeleton evaluations (4 lanes)\n"
           "  %-11s %5s  %-8s %s %6s %10s %9s %9s %9s %11s\n",
           "system", "wisps", "solver", "L", "step", "iterations", "linearise", "factor", "solve",
           "evaluations");
    for (int samples = 0; samples <= 4; samples += 4)
        for (int wisps = 1; wisps <= 200; wisps += 199)
            for (int i = 0; i < SOLVER_ROWS; i++) {
                const struct wisp_set set = {WISP_GENERALISED, BENDING_SKIP, samples, wisps};
                write_solver(stream, tables->samples, &set, &solver_rows[i]);
            }
    return 0;
}

/* --- seam and CVODE --- */

#define PAIR_COLUMNS(X)                                                                         \
    X("group", "-", "what is compared", "%s", group)                                            \
    X("subject", "-", "subject of the comparison", "%s", subject)                               \
    X("name", "-", "name of the one", "%s", name)                                               \
    X("than", "-", "name of the other", "%s", than)                                             \
    X("steps", "1", "steps of the one", "%g", note_find(samples, "cvode steps", subject, name)) \
    X("steps_than", "1", "steps of the other", "%g",                                            \
      note_find(samples, "cvode steps", subject, than))                                         \
    QUARTILES(X, "ns", "ns", "time of a step and wisp, of the one", series_quartiles(a))        \
    QUARTILES(X, "ns_than", "ns", "time of a step and wisp, of the other", series_quartiles(b)) \
    QUARTILES(X, "ratio", "1", "ratio of the one over the other", ratio_quartiles(a, b))

static void write_pair(FILE *stream, const struct samples *samples, const char *group,
                       const char *subject, const char *name, const char *than) {
    const struct series *a = series_find(samples, group, subject, name);
    const struct series *b = series_find(samples, group, subject, than);
    WRITE_ROW(stream, PAIR_COLUMNS);
    if (strcmp(group, "cvode") == 0)
        printf("  cvode, %s, %s: %.0f steps of %.2f us, ours %.0f of %.2f us: %.2f times a step\n",
               subject, name, note_find(samples, "cvode steps", subject, name),
               1e-3 * series_quartiles(a).median, note_find(samples, "cvode steps", subject, than),
               1e-3 * series_quartiles(b).median, ratio_quartiles(a, b).median);
}

static int write_steppers(const struct tables *tables) {
    const struct samples *s = tables->samples;
    FILE *stream =
        output_table(tables->output, "steppers",
                     "ns per step and wisp, and their ratio round by round; seam: rk4 of the "
                     "registry against one by hand; cvode: as it comes against ours; digits: ns a "
                     "number as text; stops: a step with the clamp after it, and nine of ten "
                     "without; nan: steps are as long, and not counted",
                     tables->scene, COLUMNS(PAIR_COLUMNS));
    if (!stream)
        return -1;
    write_pair(stream, s, "seam", "skeleton skip 0 64", "stepper", "by hand");
    write_pair(stream, s, "seam", "generalised skip 4 64", "stepper", "by hand");
    static const char *const rtol[] = {"rtol 0.0001", "rtol 1e-06"};
    for (int i = 0; i < 2; i++) {
        write_pair(stream, s, "cvode", rtol[i], "stock", "ours");
        write_pair(stream, s, "cvode", rtol[i], "stock, our settings", "ours");
    }
    write_pair(stream, s, "digits", "a number", "printf", "shortest");
    write_pair(stream, s, "stops", "linear-euler", "every step", "every tenth");
    return 0;
}

/* --- contacts and threads --- */

static const struct series *contact_series(const struct samples *s, const struct mat *mat,
                                           int wisps, const char *name) {
    char subject[SUBJECT_SIZE];
    mat_subject(mat, wisps, subject);
    return series_find(s, "contact", subject, name);
}

#define CONTACT_COLUMNS(X)                                                           \
    X("mat", "-", "name of the mat", "%s", mat->name)                                \
    X("wisps", "1", "number of wisps", "%d", wisps)                                  \
    X("contacts_per_point", "1", "contacts of a point, in the mean", "%g", contacts) \
    QUARTILES(X, "tick", "ns", "time of a point and tick", series_quartiles(tick))   \
    QUARTILES(X, "evaluation", "ns", "time of a free node and evaluation",           \
              series_quartiles(evaluation))                                          \
    QUARTILES(X, "tick_over_evaluation", "1", "tick over evaluation", ratio)         \
    QUARTILES(X, "growth", "1", "tick over that of the smallest mat", growth)

static void write_contact(FILE *stream, const struct samples *s, const struct mat *mat, int wisps) {
    char subject[SUBJECT_SIZE];
    mat_subject(mat, wisps, subject);
    const struct series *tick = contact_series(s, mat, wisps, "tick");
    const struct series *evaluation = contact_series(s, mat, wisps, "evaluation");
    const struct quartiles ratio = ratio_quartiles(tick, evaluation);
    const struct quartiles growth =
        ratio_quartiles(tick, contact_series(s, mat, mat_sizes[0], "tick"));
    const double contacts = note_find(s, "contacts", subject, "per point");
    WRITE_ROW(stream, CONTACT_COLUMNS);
    printf("  %-16s %6d %9.2f %8.1f %8.1f   %.2f (%.2f to %.2f)   %.2f\n", mat->name, wisps,
           contacts, series_quartiles(tick).median, series_quartiles(evaluation).median,
           ratio.median, ratio.lower, ratio.upper, growth.median);
}

static int write_contacts(const struct tables *tables) {
    FILE *stream = output_table(
        tables->output, "contacts",
        "wisp contact on mats of equal density, ns per point and tick, laying open and "
        "putting back included; its ratio to an evaluation of one free node in the same "
        "model (4 lanes), and to the smallest mat's; all round by round",
        tables->scene, COLUMNS(CONTACT_COLUMNS));
    if (!stream)
        return -1;
    printf("  contact, ns per point and tick\n  %-16s %6s %9s %8s %8s   %s\n", "mat", "wisps",
           "contacts", "tick", "eval", "tick/evaluation (quartiles), growth");
    for (int m = 0; m < MATS; m++)
        for (int i = 0; i < MAT_SIZES; i++)
            write_contact(stream, tables->samples, &mats[m], mat_sizes[i]);
    return 0;
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

#define THREAD_COLUMNS(X)                                                    \
    X("work", "-", "what is done", "%s", threaded[i])                        \
    QUARTILES(X, "gain", "1", "wall time of one thread over that of two", q) \
    QUARTILES(X, "over_registers", "1", "gain over that on registers",       \
              gain_over_registers(tables->samples, threaded[i]))

static int write_threads(const struct tables *tables) {
    FILE *stream = output_table(
        tables->output, "threads",
        "gain of a second thread (wall time of one over that of two), on arithmetic in "
        "registers and on a mat of 100 touching wisps; and over that of registers",
        tables->scene, COLUMNS(THREAD_COLUMNS));
    if (!stream)
        return -1;
    for (int i = 0; i < 3; i++) {
        double gain[KERNEL_ROUNDS_MAX];
        const struct quartiles q = quartiles(gain, gains(tables->samples, threaded[i], gain));
        WRITE_ROW(stream, THREAD_COLUMNS);
        printf("  second thread, %s: %.2f (%.2f to %.2f) times as fast\n", threaded[i], q.median,
               q.lower, q.upper);
    }
    return 0;
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
    FILE *stream = output_table(tables->output, "goals", "ratios that have a bound to keep",
                                tables->scene, COLUMNS(GOAL_COLUMNS));
    if (!stream)
        return -1;
    const struct solver_row *direct = &solver_rows[0];
    const char *bare = "skeleton skip 0 200";
    write_goal(stream, tables, "factor + solve of 200 wisps over skeleton evaluation (4 lanes)",
               sum_over(solver_series(s, bare, "factor", direct),
                        solver_series(s, bare, "solve", direct),
                        stage_series(s, bare, "evaluation", 4)),
               "<=", 3);
    static const char *const seams[] = {"skeleton skip 0 64", "generalised skip 4 64"};
    for (int i = 0; i < 2; i++) {
        char what[80];
        snprintf(what, sizeof what, "rk4 through the seam over rk4 by hand, %s",
                 i ? "generalised" : "skeleton");
        write_goal(stream, tables, what,
                   ratio_quartiles(series_find(s, "seam", seams[i], "stepper"),
                                   series_find(s, "seam", seams[i], "by hand")),
                   "<=", 1.05);
    }
    static const char *const rtol[] = {"rtol 0.0001", "rtol 1e-06"};
    for (int i = 0; i < 2; i++) {
        char what[80];
        snprintf(what, sizeof what, "a step of stock CVODE over one of ours, %s", rtol[i]);
        write_goal(stream, tables, what,
                   ratio_quartiles(series_find(s, "cvode", rtol[i], "stock"),
                                   series_find(s, "cvode", rtol[i], "ours")),
                   ">=", 3);
    }
    write_contact_goals(stream, tables);
    return 0;
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
    const struct statement row =
        our_row(figure, figure, there ? HOLDS : NOT_REACHED, NAN, NULL, "%s", key);
    if (there)
        statements_add(&tables->output->statements, row, "%s %.4g to %.4g %s.", before,
                       range->least, range->most, after);
    else
        statements_add(&tables->output->statements, row, "%s ... %s: it was not measured.", before,
                       after);
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

int write_tables(const struct scene *scene, const struct samples *samples, struct output *output) {
    const struct tables tables = {scene, samples, output};
    const struct series *first = series_find(samples, "rate", "rates skip 64", "division 4");
    printf("  %d rounds\n", first ? first->count : 0);
    if (write_rates(&tables) || write_evaluations(&tables) || write_operations(&tables) ||
        write_solvers(&tables) || write_steppers(&tables) || write_contacts(&tables) ||
        write_threads(&tables) || write_goals(&tables))
        return -1;
    state_evaluations(&tables);
    state_solvers(&tables);
    return 0;
}
