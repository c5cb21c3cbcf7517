/* One run: a scene advanced by a stepper from its start to its end or its failure. */
#ifndef WISPLAB_SIMULATION_H
#define WISPLAB_SIMULATION_H

#include "base/files.h"
#include "settings.h"

#include <signal.h>

/* How a run ended and what it took. */
struct run_result {
    enum outcome outcome;
    char reason[REASON_SIZE]; /* one line; empty where finished */
    double time;              /* simulated time reached, s; of a failure: where it showed */
    int frames;
    int wisps; /* at the end; a particle counts as one */
    struct counters counters;
    struct step_range steps;
    double largest_strain; /* of a segment after any step; where there are none, 0 */
    double cpu_seconds;    /* of the process, from the first step to the last, diagnoses included */
    double frame_cpu_seconds; /* of those: for frames that an observer was shown */
    double advance_seconds, tick_seconds, frame_seconds; /* wall time of the stages; ticks for
                                                            which parts need not meet are among
                                                            the advance */
    struct profile profile;                              /* of settings->profile, else zeros */
};

/* Receives each frame: the model's rows, row_count (which may grow from frame to frame) times
 * column_count numbers. Returns 0, or the
 * outcome with which the run must end. */
struct observer {
    int (*frame)(void *ctx, const struct model *model, double t, const double *rows);
    void *ctx;
};

/* How the outside and a run see each other while it goes on. */
struct watch {
    const volatile sig_atomic_t *stop; /* an enum outcome to end with, 0: go on; may be NULL */
    _Atomic double *reached;           /* simulated time, s, kept up to date; may be NULL */
    double evaluations; /* that the run may take, by counters.force_evaluations, 0: any number. It
                           ends at the first step beyond them of a part, and where all parts
                           together are beyond them at a stop: at the same place with any number of
                           threads, and out of time */
    double cpu_seconds; /* of this process: a run that took more is out of time, however it ended;
                           `stop` is to end it before. 0: any */
};

/* Runs the whole of a scene; never fails otherwise than by result->outcome. `observer` may be NULL.
 */
void simulate(const struct scene *scene, const struct settings *settings,
              const struct observer *observer, const struct watch *watch,
              struct run_result *result);

/* Runs a model of the scene that is there, from its time and state on, after the ticks of that
 * time, up to `to`; where it came to is its state afterwards. The counters of the result are the
 * model's, since it was made. */
void simulate_model(struct model *model, const struct scene *scene, const struct settings *settings,
                    double to, const struct observer *observer, const struct watch *watch,
                    struct run_result *result);

#endif
