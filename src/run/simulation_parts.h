/* What the files of one run share: simulation.c is its flow, advance.c takes all parts from stop to
 * stop, frame_energy.c diagnoses frames. */
#ifndef WISPLAB_SIMULATION_PARTS_H
#define WISPLAB_SIMULATION_PARTS_H

#include "model/clock.h"
#include "simulation.h"

struct workers;

/* What a thread says of a part it has advanced. */
struct progress_of_part {
    double reached;     /* s */
    int code;           /* of the step that failed, or 0 */
    int finite;         /* whether the state is */
    double evaluations; /* up to the last stop */
    struct step_range steps;
    double strain; /* the largest after any step */
    struct profile profile;
    struct account account; /* where diagnoses are asked for */
};

struct simulation {
    const struct scene *scene;
    const struct settings *settings;
    const struct observer *observer;
    const struct watch *watch;
    struct run_result *result;
    struct model *model;
    struct stepper **steppers; /* one for each part */
    int stepper_count;
    double *rows; /* a frame */
    int *changed; /* by part: lanes whose state a tick changed, bit k for lane k */
    struct progress_of_part *progress;
    struct workers *workers;
    struct clock clock;
    double t;
    double evaluations_left; /* at the last stop, of what the watch allows; infinite without */

    /* where diagnoses are asked for */
    struct diagnosis diagnosis;          /* of the last frame */
    double first_energy;                 /* J */
    double most_energy;                  /* the largest that was stored at a frame, J */
    double other_jumps;                  /* at ticks, of no kind that parts have accounts of, J */
    double body_contacts, wisp_contacts; /* up to the last frame */
};

/* Ends the run with an outcome, FINISHED aside, and why. */
void end_run(struct simulation *sim, enum outcome outcome, const char *reason);

static inline int is_running(const struct simulation *sim) {
    return sim->result->outcome == FINISHED;
}

/* --- advance.c --- */

/* Adds the steps of a part to those of all. */
void add_steps(struct step_range *all, const struct step_range *part);

/* Counts what is left of the evaluations that all parts share. */
void count_evaluations(struct simulation *sim);

/* Whether parts tick by themselves at a stop with these events. */
int parts_tick_alone(const struct simulation *sim, unsigned events);

/* Advances every part smoothly to the stop at `to`, or by one step of the only part where every
 * accepted step is a frame; with `alone` parts also tick there. Parts do not see each other:
 * threads share them out. Ends the run where a part failed, a limit was met, or a state is not
 * finite. */
void advance_parts(struct simulation *sim, double to, int alone);

/* --- frame_energy.c --- */

/* Makes the frame's diagnosis, which the model then has. */
void make_diagnosis(struct simulation *sim);

/* Ends a run whose residual no error of steps explains. */
void check_energy(struct simulation *sim);

#endif
