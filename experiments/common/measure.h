/* What experiments have in common: whom they compare, how far a run is from another, what it cost,
 * and the columns that say so. */
#ifndef WISPLAB_MEASURE_H
#define WISPLAB_MEASURE_H

#include "base/columns.h"
#include "base/files.h"
#include "plan.h"
#include "run/results.h"

/* Those that are compared are configurations of integrators/configurations.h, the plan's. */
int configuration_is_adaptive(const struct configuration *configuration);

/* The request for a run of the configuration: `setting` is its step, s, or its rtol, with
 * atol = setting * atol_ratio. It points into the configuration. */
struct run_request configuration_request(const struct configuration *configuration, double setting,
                                         double atol_ratio);

/* Unknowns of all wisps of a scene with a treatment. */
double scene_unknowns(const struct scene *scene, enum wisp_treatment treatment);

/* CPU time of one run in steps of that length, s, as the table of configurations predicts it on all
 * machines: wisps that are computed side by side cost one, and points at ticks of contact theirs.
 */
double estimated_cost(const struct scene *scene, enum wisp_treatment treatment,
                      const struct configuration *configuration, double step);

/* What a run took, whether or not it got to its end; NaN where it could not say. */
struct cost {
    enum outcome outcome;
    double evaluations, steps, failure_time;
    struct spread cpu; /* of one that failed: the one time that it took to get there */
    double counted;    /* what the table of costs makes of its steps, s; see cost_count */
};
struct cost run_cost(const struct run_files *run);

/* Columns that many tables have (base/columns.h): who was run on what, how the run ended, what it
 * took. */
#define CONFIGURATION_COLUMN(X, name, text) \
    X(name, "-", "configuration: a stepper with its solver and its options", "%s", text)
#define SCENE_COLUMN(X, text) X("scene", "-", "name of the scene", "%s", text)
#define TREATED_COLUMN(X, text) \
    X("treatment", "-", "how samples are kept on their lines", "%s", text)
#define NOTE_COLUMN(X, text) X("note", "-", "why there is no number", "%s", text)
#define METHOD_COLUMNS(X, configuration)                     \
    CONFIGURATION_COLUMN(X, "method", (configuration)->name) \
    X("stepper", "-", "stepper of the configuration", "%s", (configuration)->stepper)
#define STATUS_COLUMNS(X, cost)                                                \
    X("status", "-", "how the run ended", "%s", outcome_name((cost)->outcome)) \
    X("failure_time", "s", "simulated time at which the run failed", "%.17g", (cost)->failure_time)
#define CPU_COLUMNS(X, cost) SPREAD_COLUMNS(X, "cpu", "CPU time of a run", &(cost)->cpu)
#define SPREAD_COLUMNS(X, name, meaning, spread)                                           \
    X(name "_median", "s", meaning ", median of repeated runs", "%.17g", (spread)->median) \
    X(name "_least", "s", meaning ", least of repeated runs", "%.17g", (spread)->least)    \
    X(name "_greatest", "s", meaning ", greatest of repeated runs", "%.17g", (spread)->greatest)
#define EVALUATIONS_COLUMN(X, cost)                                              \
    X("force_evaluations", "1", "evaluations of the forces in the run", "%.17g", \
      (cost)->evaluations)
#define STEPS_COLUMN(X, cost) \
    X("steps", "1", "steps of the run, of all wisps", "%.17g", (cost)->steps)
#define COUNTED_COLUMN(X, cost)                                                                \
    X("counted", "s", "counted cost: the steps times what a step costs by the table of costs", \
      "%.17g", (cost)->counted)

/* Fills in `counted` of a run of the scene by that configuration. */
void cost_count(struct cost *cost, const struct scene *scene, enum wisp_treatment treatment,
                const struct configuration *configuration);

/* Whether a cost is known to be less than another: by what was counted 1.4 times, and no time that
 * was measured of the one reaches a time of the other. So a busy machine can take a verdict back
 * but makes none. 1.4 is more than a level of a step-size sequence (4/3; the others are 3/2): what
 * is a level cheaper by chance wins nothing. Else the two are tied. */
int cost_is_less(const struct cost *one, const struct cost *other);

/* The cost of a run that there was not. */
extern const struct cost no_cost;

/* Distance of one run of wisps from another, at all frames (the common start among them) or at the
 * last one; over the free nodes where nothing else is said. */
struct deviation {
    double rms, largest;     /* m */
    double relative;         /* rms over the length of the node's wisp */
    double end, end_largest; /* rms and largest at the last frame, m */
    double end_all;          /* rms at the last frame over the prescribed nodes too, m */
    double velocity;         /* rms, m/s */
    double radius;           /* rms of the samples' distances from their node, m; 0: none */
    double mescd;            /* -log10 of the largest error at the end over atol/rtol + |value| */
    double history_diverged; /* of the first frame at which the runs have not the same wisps, for
                      these split at other ticks, s; NaN: there is none */
};

/* The largest |a_i - b_i| / (floor + |b_i|) of n numbers, NaN where there is one. -log10 of it is
 * the scd of the Test Set for IVP Solvers with a floor of 0, and its mescd with atol/rtol. */
double mixed_error(const double *a, const double *b, int n, double floor);

/* Compares run and reference, runs of `scene`; samples, where both have the same ones.
 * The reference may go on for longer. `floor` is atol/rtol of the mescd. Where they part, frames
 * before that are compared, and what belongs to the last frame is NaN. Returns 0, or -1 with a
 * reason where their frames differ. */
int measure_deviation(const struct scene *scene, const struct trajectory *run,
                      const struct trajectory *reference, double floor, struct deviation *deviation,
                      char *reason);

/* Distance of a run's wisps from another's as curves, at equal shares of their arc length: their
 * numbers of nodes may differ. Over all frames and the wisps that are there from the start, in 32
 * points of each free hair, which begins at node 1; that one is not among them. */
struct curve_deviation {
    double rms, largest; /* m */
    double end;          /* rms at the last frame, m */
};

/* Compares run and reference, runs of `scene` or of one with as many wisps. Returns 0, or -1 with a
 * reason where their frames differ. */
int measure_curves(const struct scene *scene, const struct trajectory *run,
                   const struct trajectory *reference, struct curve_deviation *deviation,
                   char *reason);

/* The largest absolute value of a column of diagnoses; NaN where there is none. */
double measure_largest(const struct table *diagnoses, const char *column);

/* --- how long trajectories can be compared --- */

/* Whether ticks can part two trajectories that are close. */
int scene_has_contacts(const struct scene *scene);

/* CPU time that `reference` and what checks it take for a simulated second, s, roughly. */
double reference_cost(const struct scene *scene);

/* Two runs from starts that are this far apart, m, are within the other distance, m, up to the
 * separation horizon: what they do after it no longer depends on the method alone. */
#define HORIZON_PERTURBATION 1e-10
#define HORIZON_DISTANCE     1e-3

/* How long after the first frame, s, the last one is at which no node of two runs is farther from
 * the other one's than HORIZON_DISTANCE, but at least the second one. NaN where a run did not
 * finish. `owner`: of their states, or NULL. Returns 0, or -1 with a reason. */
int measure_horizon(struct trajectories *owner, const char *folder, const char *other_folder,
                    double *horizon, char *reason);

/* Writes a row for each frame of both runs. Returns 0, or -1 with a reason. */
#define SEPARATION_COLUMNS(X)                                                                     \
    SCENE_COLUMN(X, name)                                                                         \
    X("t", "s", "time of the frame", "%.17g", frames[i].t)                                        \
    X("separation", "m", "largest distance of a node of one run from that of the other", "%.17g", \
      frames[i].apart)
int measure_separation(struct trajectories *owner, const char *folder, const char *other_folder,
                       const char *name, FILE *stream, char *reason);

/* The slope of log error over log cost, of points added from coarse to fine. */
enum { SLOPE_POINTS = 48, SLOPE_FINEST = 3 };
struct slope {
    double x[SLOPE_POINTS], y[SLOPE_POINTS];
    int count;
};
void slope_add(struct slope *slope, double cost, double error);

/* By least squares: of a fixed-step method the finest three points, where it is nearest to its
 * order; of an adaptive one all, which only says how steep it is on the whole. */
struct fit {
    double slope;
    double spread; /* largest less least of the slopes from point to point */
    int points;    /* 0, and no numbers: there were fewer than three */
};
struct fit slope_fit(const struct slope *slope, const struct configuration *configuration);

/* Columns of a fit's row. */
#define FIT_COLUMNS(X, fixed, fit)                                                       \
    X("kind", "-", "fixed or adaptive: how the method steps", "%s",                      \
      (fixed) ? "fixed" : "adaptive")                                                    \
    X("slope", "1", "slope of log error over log cost", "%.3f", (fit)->slope)            \
    X("spread", "1", "how far slopes from point to point differ", "%.3f", (fit)->spread) \
    X("points", "1", "number of points of the fit", "%d", (fit)->points)

/* How a slope is found, for a table's first line. */
#define SLOPE_RULE                                                                                 \
    "by least squares: with fixed steps of the finest three points, else of all; spread: how far " \
    "slopes from point to point differ: with fixed steps figures give one digit and ≈ above 0.05"

/* The largest of the highest stretch frequencies of the scene's wisps, rad/s (a chain's is below
 * 2 sqrt(k/m), and comes near it), with its damping time over stiffness, s. */
struct mode {
    double frequency, damping_time;
};
struct mode stiffest_mode(const struct scene *scene);

/* Whether steps of h are stable on that mode by linear theory; of methods that
 * stepper_is_predictable. */
int is_stable(const struct stepper_method *method, const struct mode *mode, double h);

/* Whether a step is stable on the scene's stiffest mode; where theory says nothing, whether it is
 * no longer than usual. */
int seems_stable(const struct stepper_method *method, const struct scene *scene, double h);

/* A step at which people would run a method on a scene, s. The scene's own is for Runge-Kutta 4,
 * which at the default material has 4000 Hz where the method has its usual rate, and the same
 * ratios elsewhere. 0 where the method chooses its steps. */
double usual_step(const struct scene *scene, const struct stepper_method *method);

/* The length of the longest wisp, m. */
double longest_wisp(const struct scene *scene);

/* How often fixed steps are stopped on a scene's wisps, by ticks or frames, Hz: the rate of the
 * stops that come most often. */
double stop_rate(const struct scene *scene);

/* The k-th step of a ladder downwards, s, with that many levels to the octave: the time between
 * stops of the scene's clock, or 1/60 s where that is longer, over whole numbers, so that steps
 * divide it: 1, 2, 3, 4, 6, 8, 12, ... with 2 to the octave. */
double sequence_step(const struct scene *scene, int per_octave, int k);

#endif
