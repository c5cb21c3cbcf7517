/* What the files of wisplab-bench share: candidates that are timed in turn, the raw
 * samples they leave, and statistics of those. */
#ifndef WISPLAB_KERNEL_MEASURE_H
#define WISPLAB_KERNEL_MEASURE_H

#include "base/columns.h"
#include "experiments/common/output.h"
#include "model/model.h"
#include "model/scene.h"
#include "wisp_twin.h"

#include <stdio.h>

enum { KERNEL_NODES = 12, KERNEL_ROUNDS_MAX = 4000 };

/* --- wisps to measure on (wisps.c) --- */

struct wisp_set {
    enum wisp_treatment treatment;
    enum bending bending;
    int samples, wisps;
};

/* Who they are, for tables: "generalised skip 4 256". */
enum { SUBJECT_SIZE = 48 };
void wisp_set_subject(const struct wisp_set *set, char subject[SUBJECT_SIZE]);
const char *bending_name(enum bending bending);

/* The machine's rates are measured again beside every bending law and batch: "rates skip 256". */
void rates_subject(const struct wisp_set *set, char subject[SUBJECT_SIZE]);
const char *treatment_name(enum wisp_treatment treatment);

/* The kernel's evaluations that are measured: treatments x bending laws x samples; without samples
 * all treatments are one. Writes them for `wisps` wisps; returns how many there are. */
enum { WISP_SETS_MAX = 32 };
int wisp_sets(int wisps, struct wisp_set sets[WISP_SETS_MAX]);

/* The set in parts of at most `lanes`, bent and in motion; and the same as plain twins. The program
 * ends with the measurement, and their memory with it: nothing here is ever freed. */
struct model *moving_model(const struct scene *scene, const struct wisp_set *set, int lanes);
struct model *resting_model(const struct scene *scene, const struct wisp_set *set, int lanes);

struct twins {
    int count, size; /* wisps; doubles in q of one */
    struct wisp_twin *twin;
    double *q, *v, *a;
};
struct twins *moving_twins(const struct scene *scene, const struct wisp_set *set);

/* Zeros on a boundary of 64 bytes; the measurement ends where they cannot be had. */
void *zeros(size_t bytes);

/* Ends the program with a line on standard error: exit code 3, an integration failed; and 2, the
 * machine did. */
void give_up(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
void out_of_memory(void) __attribute__((noreturn));

/* --- the contest (contest.c) --- */

/* `run` does its work once: `units` of whatever is counted (node evaluations, wisps, steps). */
struct candidate {
    char group[16], subject[SUBJECT_SIZE], name[32];
    void (*run)(void *ctx);
    void *ctx;
    double units;
    int repeats;      /* of `run` in one sample */
    int wall;         /* by wall time, for work on several threads; else by CPU time */
    int warms_itself; /* takes so long that what it finds in the cache matters little */
};

struct contest {
    struct candidate *all;
    int count, capacity;
    FILE *notes; /* single numbers that are not times, as lines of the samples' file */
};

void contest_add(struct contest *contest, const char *group, const char *subject, const char *name,
                 double units, void (*run)(void *), void *ctx);
void contest_add_wall(struct contest *contest, const char *group, const char *subject,
                      const char *name, double units, void (*run)(void *), void *ctx);
void contest_note(struct contest *contest, const char *group, const char *subject, const char *name,
                  double value);

/* Times all of them in turn, round after round, for about `seconds` but at least 3 rounds; writes
 * `group`, `subject`, `candidate` and then ns per unit, a number for each round. */
void contest_run(struct contest *contest, double seconds, FILE *stream);

/* Entries, by subject of the experiment. */
void enter_evaluations(struct contest *contest, const struct scene *scene);
void enter_rates(struct contest *contest, const char *subject);
void enter_solvers(struct contest *contest, const struct scene *scene);
void enter_steppers(struct contest *contest, const struct scene *scene);
void enter_contacts(struct contest *contest, const struct scene *scene);
void enter_small_costs(struct contest *contest, const struct scene *scene);

/* --- CVODE as it comes, with its own vectors and KLU (steppers.c) --- */

/* On a part of 1 wisp without envelope, from its state on. `frequency`: for how many steps a
 * factorised system and a Jacobian are kept; 0: CVODE's own. The measurement ends where it cannot
 * be had. */
struct stock;
struct stock *stock_create(struct part *part, double rtol, double atol, long frequency);
void stock_free(struct stock *stock);

/* From the start to `end`, s, by `frames` stops; the q of each goes to positions + f size, f from 1
 * on, where that is not NULL. */
void stock_run(struct stock *stock, double end, int frames, double *positions);

/* --- wisps that touch (contacts.c) --- */

/* Hanging wisps, roots about `spacing` apart. */
struct mat {
    const char *name;
    double spacing; /* m */
};
enum { MATS = 2, MAT_SIZES = 3 };
extern const struct mat mats[MATS];
extern const int mat_sizes[MAT_SIZES]; /* wisps */
void mat_subject(const struct mat *mat, int wisps, char subject[SUBJECT_SIZE]);

/* --- samples read back --- */

struct series {
    char *line; /* owned, cut at its tabs */
    const char *group, *subject, *name;
    double *value; /* by round */
    int count;
};

struct samples {
    struct series *series;
    int count;
};

/* Whether the file holds samples with just this heading: then they are read. */
int samples_read(struct samples *samples, const char *path, const char *heading);
void samples_free(struct samples *samples);

/* NULL where there is none. */
const struct series *series_find(const struct samples *samples, const char *group,
                                 const char *subject, const char *name);
/* A note; NaN where there is none. */
double note_find(const struct samples *samples, const char *group, const char *subject,
                 const char *name);

struct quartiles {
    double median, lower, upper;
};

/* Three columns of a table (base/columns.h). */
#define QUARTILE_COLUMNS(X, name, unit, meaning, format, q)               \
    X(name, unit, meaning ", median of the rounds", format, (q).median)   \
    X(name "_lower", unit, meaning ", lower quartile", format, (q).lower) \
    X(name "_upper", unit, meaning ", upper quartile", format, (q).upper)

/* Quartiles of the series; of `a` over `b` formed round by round; NaN where one is NULL. */
struct quartiles series_quartiles(const struct series *a);
struct quartiles ratio_quartiles(const struct series *a, const struct series *b);
struct quartiles quartiles(const double *value, int count);

/* --- the arithmetic of an evaluation (floor.c, trace.c) --- */

/* Per free node and wisp. */
struct operations {
    double square_roots, divisions, others; /* others: additions and multiplications */
};

/* What the model needs, by the table in floor.c. */
struct operations needed_operations(const struct wisp_set *set);

/* The time of that at the machine's rates on vectors of 4 or of 8 numbers, ns per free node of one
 * wisp among so many, by round; returns the number of rounds. */
int floor_times(const struct samples *samples, const struct wisp_set *set, int lanes,
                double *floor);

/* What one evaluation of a part executes, by stepping through it: one count for each kind. */
enum executed {
    EXECUTED_SQUARE_ROOTS,
    EXECUTED_DIVISIONS,
    EXECUTED_ARITHMETIC, /* additions, subtractions, multiplications */
    EXECUTED_LOGIC,      /* comparisons, masks, signs */
    EXECUTED_ARRANGING,  /* numbers moved from lane to lane */
    EXECUTED_MOVES,      /* loads, stores and copies of floating-point registers */
    EXECUTED_OTHER,      /* addresses, branches, calls */
    EXECUTED_LIBRARY,    /* instructions of any kind outside of the program: atan2 */
    EXECUTED_KINDS
};
extern const char *const executed_names[EXECUTED_KINDS];

/* Numbers: how many results a lane gets, a vector instruction counting its width over `lanes`; for
 * the rows of no arithmetic, instructions. Returns 0, or -1 where this machine does not let us. */
int trace_evaluation(struct system *system, const double *q, const double *v, double *a,
                     double executed[EXECUTED_KINDS]);

/* --- tables (tables.c) --- */

/* Writes all tables of the samples, and what they say. Returns 0, or -1 with output->reason. */
int write_tables(const struct scene *scene, const struct samples *samples, struct output *output);

#endif
