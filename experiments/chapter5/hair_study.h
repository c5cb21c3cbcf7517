/* What the experiments of the thesis's chapter 5 have in common. Each is a scene and a few variants
 * of it; its question is answered by series measured over the frames, and by sentences computed
 * from them. One of the variants is the control, in which what the figure is about is switched off,
 * and every claim is tried on it too. The frame around it is here: the runs, what they cost beside
 * the thesis's times, how every other stepper fares, and the pictures that the thesis prints. */
#ifndef WISPLAB_HAIR_STUDY_H
#define WISPLAB_HAIR_STUDY_H

#include "base/files.h"
#include "experiments/common/measure.h"
#include "experiments/common/statements.h"
#include "hair_frames.h"

/* The start of the shipped wind and shake is at rest under `generalised`. Under `projection` hair
 * has another shape at rest, and this is it, as a set. */
#define HAIR_START_PROJECTION "start=\"wind-start-projection.tsv\""

enum { HAIR_VARIANTS = 4, HAIR_SETS = 3, HAIR_SERIES = 3, HAIR_PICTURES = 12, HAIR_NEEDS = 2 };

struct hair_variant {
    const char *label;           /* NULL: there are no more */
    const char *sets[HAIR_SETS]; /* what it overrides in the scene; NULL: no more */
    double thesis;               /* CPU time in the thesis, s per frame; 0: none */
    int undrawn;                 /* whether no pictures of it are shown */
};

struct hair_study;
struct hair_run;

/* The static description of an experiment. */
struct hair_question {
    const char *scene; /* its name */
    const char
        *needs[HAIR_NEEDS]; /* groups of a scene in which the variants differ; NULL: no more */
    struct hair_variant variants[HAIR_VARIANTS];
    int main;                    /* the variant on which all steppers are tried */
    int control;                 /* the variant in which what the figure is about is switched off */
    const char *without;         /* that variant in words, as "without contact" */
    int pictures[HAIR_PICTURES]; /* frames shown, numbered from 1 at 30 a second; 0: no more */
    int columns;                 /* of the pictures */
    int large;                   /* another frame, shown large; 0: none */
    int width, height;           /* of a picture, pixels; 0: as usual */
    double film;       /* s: of so much there is a film, and a picture of all steppers at its end */
    const char *start; /* a set for the experiment's own scene; NULL: none */
    double quick;      /* how far steppers are tried with --quick, s; 0: 0.4 */
    double watch_rate; /* of the frames that are measured, Hz; 0: the scene's frames */
    struct column series[HAIR_SERIES]; /* no name: no more */

    /* Fills run->series[k][frame] for all frames of a run. Returns 0, or -1 where memory cannot be
     * had. */
    int (*measure)(const struct hair_study *study, struct hair_run *run);

    /* States what was found, by hair_state and hair_claim; called where every variant reached its
     * end. It is called twice, the first time with the control's run in place of every other. */
    void (*state)(struct hair_study *study);

    /* Writes tables of its own, and states what they show; NULL: there are none. Called where
     * every variant reached its end. Returns 0, or -1 with plan->reason. */
    int (*tables)(struct plan *plan, struct hair_study *study);
};

/* A variant's runs, read back. */
struct hair_run {
    const struct hair_variant *variant;
    const struct labelled_case *timed, *watched; /* watched: diagnosed, and at the watch rate;
                                                    of a large control the timed one */
    struct cost cost;                            /* of the timed one */
    int finished;
    struct run_files files; /* of the watched one */
    struct hair hair;       /* in files.states */
    double *series[HAIR_SERIES];
};

/* What the control makes of a claim. */
struct hair_trial {
    char key[192];
    enum claim_verdict verdict;
};

struct hair_study {
    const struct hair_question *question;
    const struct subject *subject;
    int is_own; /* whether the scene is the experiment's own: the thesis's times are of that */
    struct hair_run runs[HAIR_VARIANTS];
    int count;
    const struct labelled_case *rival; /* the cheapest of the steppers that are nearer to the
                                          solution and have less to compute, or NULL */
    struct statements *statements;     /* NULL: the control is tried */
    struct hair_trial *trials;         /* owned */
    int trial_count, out_of_memory;
};

/* Adds a statement (printf) to figure `series` where the row names none: of what was measured, and
 * of the control itself. */
void hair_state(struct hair_study *study, struct statement row, const char *sentence, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds a claim. One that holds, and of the control too, tells nothing, and says so. */
void hair_claim(struct hair_study *study, struct statement row, const char *sentence, ...)
    __attribute__((format(printf, 3, 4)));

/* --- measures of runs --- */

/* Frames that a run computed, as the thesis counts them. */
double hair_frames(const struct cost *cost, const struct scene *scene);

/* CPU time per frame, s, of a run of that cost, up to its failure; and of a variant's timed one.
 * NaN where there are no frames. */
struct spread hair_per_frame(const struct cost *cost, const struct scene *scene);
struct spread hair_cpu_per_frame(const struct hair_run *run);

/* What a run has to compute for a frame, in evaluations of a wisp's forces: a count, by which costs
 * are judged, for times depend on a machine and its load. A linear solution counts as one and a
 * factorisation, with the derivatives that it takes, as five. */
double hair_work_per_frame(const struct run_files *files, const struct cost *cost,
                           const struct scene *scene);

/* Simulated over CPU time, of a CPU time per frame. */
double hair_real_time(const struct spread *cpu, const struct scene *scene);

/* How often a point was found in a section of another wisp, in all, and at the ticks from one frame
 * to the next in the mean. */
double hair_contacts(const struct hair_run *run);
double hair_contacts_per_frame(const struct hair_run *run);

/* Frame `number` of those that the thesis counts from 1, 30 a second, or -1 where the run ends
 * before it. */
int hair_frame_numbered(const struct hair_run *run, int number);

/* The frame of the largest value of a series, and that value's. */
int hair_largest(const struct hair_run *run, int series);

/* plan and tabulate of a struct experiment whose `study` is a struct hair_question. */
int hair_plan(struct plan *plan);
int hair_tabulate(struct plan *plan);

/* What such experiments have in common. */
#define HAIR_EXPERIMENT(question)                                                    \
    .chapter = CHAPTER_THESIS, .answers = 1u << ANSWERS_CHOICE, .study = (question), \
    .plan = hair_plan, .tabulate = hair_tabulate

/* --- its parts --- */

/* The request of a run whose time is to be known: it is repeated, more often the shorter the scene.
 */
struct run_request hair_timed_request(const struct plan *plan, const struct scene *scene,
                                      const struct stepper_method *method);

/* Whether a method has a row in the table of steppers: those that cost too much for all but charts
 * of cost have none, unless the user names them. */
int hair_takes(const struct plan *plan, const struct stepper_method *method);

/* The tables of what variants cost, and of how every stepper fares on the main one, with what they
 * show. Return 0, or -1 with a reason. */
int hair_costs(struct plan *plan, struct hair_study *study);
int hair_steppers(struct plan *plan, struct hair_study *study);

/* The pictures, a row for each variant, seen by the scene's camera, as hair.png: drawn here,
 * for they are made of whole runs. Returns 0, or -1 with a reason. */
int hair_strip(struct plan *plan, const struct hair_study *study);

/* A film of the main variant, beside it by the rival if there is one: the sheet film.png,
 * whose frames, below each other, are the rows of film.tsv. Returns 0, or -1 with a reason. */
int hair_film(struct plan *plan, struct hair_study *study);

/* A stepper's run, and how far it is from the reference's at a frame. */
struct hair_error {
    const struct labelled_case *run;
    double distance; /* rms over free nodes, m */
};

/* A picture of each at the frame, in order, as errors.png; colour is the distance. Returns
 * 0, or -1 with a reason. */
int hair_errors(struct plan *plan, const struct hair_study *study, const struct hair_error *errors,
                int count, const struct labelled_case *reference, int frame);

/* "euler, 9000 Hz", "cvode, rtol 0.0001" */
enum { HAIR_NAME = 96 };
void hair_name(char name[HAIR_NAME], const struct settings *settings);

#endif
