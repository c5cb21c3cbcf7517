/* An experiment answers one question: it names runs, and makes tables from their folders. Figures
 * are drawn from the tables by a gnuplot script of the same name. */
#ifndef WISPLAB_EXPERIMENT_H
#define WISPLAB_EXPERIMENT_H

#include "base/files.h"
#include "integrators/configurations.h"
#include "model/trajectory.h"
#include "output.h"
#include "run/results.h"
#include "run/runs.h"

/* A run and what the tables call it. */
struct labelled_case {
    struct run_case run;
    char group[128]; /* the table that it is for */
    char label[64];  /* its row or curve */
};

/* A scene under study, and what its tables, figures and runs are called: its name, made safe for
 * files, and with a number where another one has it. */
struct subject {
    const struct scene *scene;
    const char *source; /* what it was loaded by */
    char name[72];
};

/* What was asked for, and the runs that answer it. */
struct plan {
    const struct experiment *experiment;
    const char *out;    /* root folder of results */
    int quick;          /* a stated subset */
    int fresh;          /* what is there already does not count */
    double run_seconds; /* CPU time for a run where the user sets none; 0: the program's default */
    struct run_limits limits;          /* of what tabulate starts: run_experiment's */
    struct trajectories *trajectories; /* that the command has read; NULL: each reads its own */
    const char *const *scenes, *const *steppers; /* chosen by the user; none: the experiment's */
    int scene_count, stepper_count;
    const char *const *sets; /* changes of the user's to all scenes, "path=value" */
    int set_count;
    const char *const *states; /* trajectories of other programs, "name=file"; chosen by the user */
    int states_count;

    struct labelled_case *cases;
    int case_count, case_capacity;
    struct scene **loaded; /* owned */
    int loaded_count;
    unsigned long long
        *lost; /* owned; of each, which of the user's changes the experiment undoes */
    struct subject *subjects; /* owned; see plan_subjects */
    int subject_count;
    struct configuration *configurations; /* compared; owned; see plan_configurations */
    int configuration_count;
    char *taken; /* owned; of each stepper that the user chose, whether there can be a run of it */
    const struct stepper_method *refused; /* the first method that could not be taken, or NULL */
    char refusal[REASON_SIZE];            /* and why */
    void *memo;               /* the experiment's own, from round to round; freed with the plan */
    char reason[REASON_SIZE]; /* of a failure */
    struct output output;     /* what tabulate writes */
};

/* The parts of a report that experiments belong to. X(symbol, anchor, title, what it is about) */
#define CHAPTERS(X)                                                                              \
    X(CHAPTER_ACCURACY, "accuracy", "Speed against accuracy",                                    \
      "What an error costs, by method: the fewest seconds in which a motion is as near to the "  \
      "true one as was asked for.")                                                              \
    X(CHAPTER_STABILITY, "stable", "Stability, where methods fail",                              \
      "How long a step may be before a method goes wrong, and how that shows.")                  \
    X(CHAPTER_MODEL, "least", "No more model than a scene needs",                                \
      "What may be left out of the hair's model before its motion changes by a millimetre, and " \
      "what that saves.")                                                                        \
    X(CHAPTER_THESIS, "thesis", "The thesis, figure by figure",                                  \
      "What Plante's thesis of 1999 claims and shows, run again with its own recipe, explicit "  \
      "Euler with projection at 9000 Hz, and with the others.")

enum chapter {
#define X(symbol, anchor, title, about) symbol,
    CHAPTERS(X)
#undef X
        CHAPTER_COUNT
};

struct experiment {
    const char *name;
    const char *question;
    const char *thesis; /* where the thesis asks it, as "section 5.1"; NULL: it does not */

    /* Its place in a report: the chapter, and in that from 1 on what answers its question first,
     * and the costliest of the others last; 0: after all that have a place. */
    enum chapter chapter;
    int place;

    /* How the key of the statement ends that says most in one sentence; NULL: its first. */
    const char *headline;

    /* The wall time that its runs, tables and figures take on two cores, s, for the progress of a
     * report. */
    double quick_seconds; /* with --quick; 0: it is no part of that */
    double full_seconds;  /* 0: nobody knows, and a minute is assumed */
    unsigned answers;     /* 1 << enum question, of all questions that its statements answer */
    int takes_states;     /* it compares trajectories of other programs too: plan->states */

    const void *study; /* what the functions below are told, where experiments share them */

    /* Fills the plan with plan_add. Returns 0, or -1 with plan->reason. */
    int (*plan)(struct plan *plan);

    /* Called when the plan's runs are there, and again as long as it adds some: the runs that those
     * before call for, as in a search. From equal runs it must name equal ones, so that an
     * interrupted experiment goes on where it was. NULL where the plan is all. Returns 0, or -1
     * with plan->reason. */
    int (*refine)(struct plan *plan);

    /* Writes plan->output from the run folders: tables, and statements of what was found, with a
     * row at least of each figure; who has called it ends them. Returns 0, or -1 with plan->reason,
     * or 1 with one where the runs left nothing to state. */
    int (*tabulate)(struct plan *plan);
};

/* Its question as a title, with where the thesis asks it. */
void experiment_title(const struct experiment *experiment, char title[256]);

/* Whether an experiment has its own scenes, and as they are: what it knows of them holds. */
static inline int plan_is_own(const struct plan *plan) {
    return plan->scene_count == 0 && plan->set_count == 0;
}

/* For an experiment of scenes that nobody else can choose: 0, or -1 with plan->reason where the
 * user wants other ones. */
int plan_has_no_scenes(struct plan *plan);

/* Loads a scene with the user's changes and then those overrides, and names the former in its name;
 * it belongs to the plan. NULL with plan->reason on failure. */
const struct scene *plan_scene(struct plan *plan, const char *name, const char *const *sets,
                               int set_count);

/* A scene without its envelope, at a frame rate in Hz. */
const struct scene *plan_scene_bare(struct plan *plan, const char *name, double frame_rate);

/* A scene with overrides and other numbers of nodes and samples: see scene_set_detail. */
const struct scene *plan_scene_detail(struct plan *plan, const char *name, const char *const *sets,
                                      int set_count, double factor, int samples);

/* Makes all bodies of the scene that was loaded last push by penalty, Hz: see scene_push_bodies.
 * Returns the scene, or NULL where that is NULL. */
const struct scene *plan_push_bodies(struct plan *plan, const struct scene *scene,
                                     double frequency);

/* Makes the user's scenes, or else the experiment's own, the plan's subjects. They must be scenes
 * of wisps, and get 30 frames a second where they have none: runs are compared at the same times.
 * Returns 0, or -1 with plan->reason. */
int plan_subjects(struct plan *plan, const char *const *own, int own_count);

/* The free nodes of all wisps of a scene. */
int free_nodes(const struct scene *scene);

/* The frame rate at which a run of that duration writes no more numbers than are of use, a whole
 * fraction of the scene's, Hz. */
double sparse_frame_rate(const struct scene *scene, double duration);

/* A subject's scene over its first seconds, a whole number of frames; `set` is a further override
 * or NULL. NULL with plan->reason. */
const struct scene *plan_cut_scene(struct plan *plan, const struct subject *subject, double rate,
                                   double duration, const char *set);

/* Whether the user's choice of steppers leaves this one in. */
int plan_wants(const struct plan *plan, const char *stepper);

/* Makes those configurations the plan's that configurations_choose gives and that are of steppers
 * which the user's choice leaves in. Returns 0, or -1 with plan->reason: also where the user asks
 * for a stepper that has none among them. */
int plan_configurations(struct plan *plan, unsigned kinds, unsigned capabilities);

/* Whether there can be such a run; else why not, in `reason` (REASON_SIZE). A problem that is not
 * for a method is no failure of the experiment, unless the user asked for the method: plan_check.
 */
int plan_takes(struct plan *plan, const struct scene *scene, const struct run_request *request,
               char *reason);

/* For an experiment that compares something else: 0, or -1 with plan->reason where the user asks
 * for steppers. */
int plan_has_no_steppers(struct plan *plan, const char *compared);

/* Notes why a method is not taken. */
void plan_refuse(struct plan *plan, const struct stepper_method *method, const char *why);

/* After the experiment's plan(): 0, or -1 with plan->reason where a stepper that the user asked for
 * has no run, and by plan_takes will have none, or a change that he asked for is in none. */
int plan_check(struct plan *plan);

/* Adds a run, labelled (printf). Returns 0, or -1 with plan->reason. */
int plan_add(struct plan *plan, const struct scene *scene, const struct run_request *request,
             const char *group, const char *label, ...) __attribute__((format(printf, 5, 6)));

/* Lets cases from `first` on stretch twice as far as the reference of their scene did, where that
 * is more than the scene allows. waiting[i - first] is whether such a reference's run is not there
 * yet. Returns 0, or -1 with plan->reason. */
int plan_allow_strain(struct plan *plan, int first, char *waiting);

/* The first case of a group with that label (printf), or NULL. */
const struct labelled_case *find_case(const struct plan *plan, const char *group, const char *label,
                                      ...) __attribute__((format(printf, 3, 4)));

/* Reads the run of a case with its states: see run_read_states. Returns 0, or -1 with plan->reason.
 */
int plan_read(struct plan *plan, const struct labelled_case *one, struct run_files *run);

/* output_statements, and where the user has changed the scenes a row that says so. */
int plan_open_statements(struct plan *plan, const struct scene *scene, const char *cut);

void plan_free(struct plan *plan);

#endif
