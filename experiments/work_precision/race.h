/* Charts of error against cost: configurations on scenes of wisps, from steps that are too long for
 * them to steps that are shorter than anyone needs. What experiments work-precision and solvers
 * share; they differ in their configurations.
 *
 * First the reference solution of each scene and treatment, and how long a trajectory means
 * anything there (the separation horizon); then, round by round, the largest step at which each
 * method with fixed steps is stable, and what one tolerance costs each adaptive one; then the
 * charts. What is run follows from costs that are predicted, of steps counted and the table of
 * configurations (race_settings.c): no clock has a say, so that the same command gives the same
 * rows on any machine, whatever else that does. */
#ifndef WISPLAB_RACE_H
#define WISPLAB_RACE_H

#include "base/files.h"
#include "base/hash.h"
#include "experiments/common/search.h"
#include "experiments/common/statements.h"

/* A chart shows at most so many steps beyond the largest stable one, and so many below it. */
enum { LEVELS_BEYOND = 2, LEVELS_BELOW = 6, LEVELS_MAX = 48, TOLERANCES = 11, JITTERS = 9 };

/* Treatments of a scene at most. */
enum { FIELDS_MAX = 3 };

struct race {
    const char *const *scenes, *const *quick_scenes; /* own ones; NULL-terminated */
    unsigned kinds, capabilities;                    /* of configurations: configurations_choose */
    const char *const *treatments;                   /* NULL-terminated; NULL: all */
    double seconds, quick_seconds; /* predicted, of one core: by them scenes are cut */
};

/* One configuration in a field: the settings at which it runs. */
struct entry {
    const struct configuration *configuration; /* one of the plan's */
    int searching;                             /* a run of its at place.at is awaited */
    struct bracket place; /* of a fixed step, in levels: the largest stable one is place.reached */
    const char *stopped;  /* what limit ended the search; NULL: none */
    double pace;          /* of an adaptive one: steps tried per simulated second, in all wisps, at
                             LEVEL_PROBED; NaN: unknown */
    int first, last;      /* levels of the chart; where last < first there is none */
    char left_out[200];   /* which levels the chart has not, and why; empty: it has all */
    char refused[REASON_SIZE]; /* why it cannot take part; empty: it can */
};

/* Largest at any frame: strain; depth of a node in a body, m; and |energy since the start that no
 * work accounts for|, J, over the largest kinetic energy. NaN: unknown. */
struct extent {
    double strain, penetration, drift;
};

/* What came of one configuration at one setting. */
struct point {
    const struct entry *entry;
    double setting;
    const char *status; /* an outcome's name, "diverged history", "refused", "left out" */
    int lanes, threads; /* the most wisps side by side; that share the scene's wisps; 0: no run */
    const char *run;    /* folder in `runs` of the one that stands for all, of the plan; or "-" */
    int runs, failed;   /* of jittered tolerances; 1 of a fixed step */
    struct cost cost;   /* of the run with the median error; CPU time of the timed one */
    struct deviation deviation;         /* of the same run; NaN where a run did not finish */
    struct extent extent;               /* of the first run */
    double error_least, error_greatest; /* rms over the jittered runs, m */
    int reference_limited;              /* closer to the reference than ten times its bound */
    int front[2]; /* not reference-limited, and none is cheaper and better: by either race_cost */
    char note[REASON_SIZE];
};

/* One panel: a scene with one treatment. */
struct field {
    const struct subject *subject;
    char group[128];                   /* of its runs in the plan */
    const struct scene *whole, *scene; /* of the reference; cut to the horizon */
    int treatment;
    char left_out[64]; /* other treatments of the scene that are too expensive; empty: none */
    int touches;       /* whether ticks can part trajectories: they are compared with a horizon */
    double horizon;    /* s; the duration where nothing parts within it; NaN: unknown */
    int has_reference;
    double bound;      /* of the reference, m; NaN: unknown */
    double evaluation; /* CPU s of one force evaluation, by the finest run of the explicit method
                          with fixed steps that has the highest order; NaN: unknown */
    struct entry *entries; /* one for each of the plan's configurations; in the notes */
    int entry_count;
    struct run_files reference; /* while points are read */
    struct point *points;       /* likewise; of who reads them */
    int point_count;
    double treatment_error; /* m; NaN: unknown */
};

/* A trajectory of another program, in the field that it is compared in. */
struct foreign {
    char name[40];                    /* of its curve */
    const char *file;                 /* the user's */
    char hash[HASH_SIZE];             /* of the file */
    const struct field *field;        /* one of the notes' */
    double evaluations, cpu, setting; /* what it took, the latter s; NaN: not said */
};

/* The penalty ratio that stands for the exact constrained motion: samples are then held 30 times
 * more stiffly than by their own springs, which still is softer than stretching. */
#define EXACT_RATIO "3000"

/* Everything that a plan of such an experiment keeps from stage to stage: plan->memo. */
struct race_notes {
    const struct race *race;
    enum { RACE_REFERENCES, RACE_SEARCHES, RACE_CHARTS } stage; /* whose runs are planned */
    int foreign_count;
    struct foreign *foreign; /* behind the entries, curve by curve */
    int field_count;
    struct field fields[];
};

/* The errors of the report's question, m. */
enum { RACE_TARGETS = 3 };

/* On how many scenes a claim holds. */
struct race_tally {
    int holds, of;
};

/* What the statements on single scenes add up to. */
struct race_answers {
    unsigned asked;        /* the experiment's `answers` */
    int subjects;          /* scenes stated so far */
    const char **cheapest; /* of each scene and target: a configuration's name; NULL: none */
    const struct configuration *configurations; /* the plan's */
    int configuration_count;
    int *among; /* of each target and configuration: on how many scenes no other is known to be
                   cheaper */
    struct race_tally method, treatment; /* the thesis's choice, as either */
};

/* The stages of a struct experiment whose `study` is a struct race. */
int race_plan(struct plan *plan);
int race_refine(struct plan *plan);
int race_tabulate(struct plan *plan);

/* Between the files of a race, each of which stands on those before it. */

/* --- race_settings.c --- */

const char *race_treatment(int treatment);

/* The setting of level k: a step, s, of a sequence_step; or a relative tolerance. */
double race_setting(const struct field *field, const struct entry *entry, int k);

/* Whether the ladder of an entry has level k: --quick takes every other tolerance. */
int race_takes(const struct plan *plan, const struct entry *entry, int k);

/* The tolerance by which an adaptive method tells its pace. */
enum { LEVEL_PROBED = 4 };

/* CPU time of one run, s, as it would be on the machine of the table of costs; NaN: unknown. */
double race_predicted(const struct field *field, const struct entry *entry, int k);

/* Whether a run is so expensive that it is done once, without diagnoses. */
int race_is_expensive(const struct field *field, const struct entry *entry, int k);

/* How many runs a level has, at tolerances that differ in the twelfth digit. */
int race_jitters(const struct plan *plan, const struct field *field, const struct entry *entry,
                 int k);

/* How many CPU times there are of the j-th jittered run; 0: it is not timed, and need not be alone
 * on the machine, as all but the first. */
int race_timings(const struct plan *plan, const struct field *field, const struct entry *entry,
                 int k, int j);

/* Begins the search for the largest stable step of a fixed one, at what linear theory says; or for
 * the pace of an adaptive one. */
void race_search(const struct plan *plan, const struct field *field, struct entry *entry);

/* Goes on from how the run at place.at ended; ends the search where no step is left to try. */
void race_search_on(const struct plan *plan, const struct field *field, struct entry *entry,
                    enum outcome outcome);

/* When all searches of a scene's fields have ended: which levels their charts have. */
void race_fit(const struct plan *plan, struct field *fields, int field_count);

/* How long of a scene the race may take by predicted costs, s: what the budget allows, but a second
 * at least (with --quick a tenth of one). Where that is too expensive, treatments are taken out,
 * the costliest first, down to one; `left_out` names them. */
double race_afford(struct plan *plan, const struct race *race, const struct scene *scene,
                   int *treatments, int *count, char left_out[64]);

/* --- race_plan.c --- */

/* The run of entry at level k with the j-th jittered tolerance; NULL: there is none. */
const struct labelled_case *race_case(const struct plan *plan, const struct field *field,
                                      const struct entry *entry, int k, int j);

/* --- race_points.c --- */

/* Reads a field's runs into its points. 0, or -1 with plan->reason. */
int race_read(struct plan *plan, struct field *field);

/* The error of a point at most: an adaptive one counts with the worst of its runs, and a limited
 * one is known to within the reference's bound, m. */
double race_error_at_most(const struct field *field, const struct point *p);
int race_finished(const struct point *p);

/* Marks the points on the Pareto fronts. */
void race_mark_fronts(struct field *field);

/* By which runs are put in order: 0: what the table of costs makes of its steps, s; 1: evaluations.
 */
double race_cost(const struct point *p, int measure);

/* The cheapest run within the target, m, of another configuration than `besides`; or NULL. */
const struct point *race_cheapest(const struct field *field, double target,
                                  const struct configuration *besides);

/* The cheapest run of one configuration within the target, m; or NULL. */
const struct point *race_cheapest_of(const struct field *field, double target,
                                     const struct configuration *configuration);

/* --- race_foreign.c --- */

/* Reads and checks the files of plan->states. 0, or -1 with plan->reason. */
int race_foreign_plan(struct plan *plan, struct race_notes *notes);

/* The point of one while its field's reference is there; `entry` says what it is called. 0, or -1
 * with plan->reason. */
int race_foreign_read(struct plan *plan, const struct foreign *foreign, const struct entry *entry,
                      struct point *point);

/* --- race_statements.c --- */

/* States that a field, just read, has no reference, or is not compared to the end. */
void race_state_reference(struct statements *statements, const struct field *field);

/* States what a foreign trajectory, of several the `number`-th, is beside the field's runs. */
void race_state_foreign(struct statements *statements, const struct field *field,
                        const struct point *point, int number);

/* States what the fields of one scene show, with their points, and adds it to the answers. */
void race_state_subject(struct statements *statements, const struct field *fields, int field_count,
                        struct race_answers *answers);

/* States what is true over all scenes. */
void race_state_all(struct statements *statements, const struct race_answers *answers);

#endif
