/* Inside experiment contact-rate: bodies that push by penalty in place of ticks, the one contact
 * whose stiffness a stepper feels. How deep hair comes and how far it is from where ticks put it,
 * by the frequency of the penalty; and how long steps may be. */
#ifndef WISPLAB_CONTACT_RATE_PUSHING_H
#define WISPLAB_CONTACT_RATE_PUSHING_H

#include "experiments/common/measure.h"
#include "experiments/common/search.h"
#include "experiments/common/statements.h"

/* By what bodies act: ticks at the scene's own rate, or penalty at one of these frequencies. */
enum { TICKS, FREQUENCIES = 5, RESPONSES = 1 + FREQUENCIES };
extern const double frequency_of[RESPONSES]; /* Hz; 0: ticks */

/* A scene's runs by Runge-Kutta 4 with the same steps, and how far they are from that with ticks at
 * 9000 Hz. */
struct pushed_run {
    int at; /* in the plan; -1: it was left out */
    enum outcome outcome;
    double depth;          /* of a free node in a body at most, m */
    double error, largest; /* up to the horizon, rms and largest, m */
    double whole;          /* over all frames, rms, m */
    double evaluations, counted;
};

struct pushed {
    struct subject subject;
    const char *set; /* what is otherwise than in the scene's file, or NULL */
    double begin, duration, frame_rate, step; /* s, s, Hz, s */
    int reference, again;  /* in the plan: ticks at 9000 Hz; and displaced, half the step */
    double horizon, doubt; /* s; m */
    struct pushed_run run[RESPONSES];
};

/* The search for a method's longest step on the probe: one wisp that swings onto a ball. */
struct push_trial {
    const struct configuration *method;
    struct bracket place; /* reached: of the longest step, or -1 */
    int run;              /* its last case in the plan */
    int done;
    double error; /* of the longest step, m */
    char note[128];
};

enum { HAIRS = 2 };
extern const char *const hair_names[HAIRS];

struct probe {
    const struct scene *scene;
    int hair;        /* 0: springs, 1: rigid segments */
    int response;    /* index of frequency_of */
    int reference;   /* in the plan */
    char name[64];   /* of its runs */
    int trial_count; /* at most the plan's configurations */
    struct push_trial *trials;
};

struct pushing {
    int pushed_count, probe_count;
    struct pushed *pushed; /* of subjects that have bodies */
    struct probe probe[HAIRS * RESPONSES];
};

/* How much room it needs, bytes; the plan's configurations are chosen. */
size_t pushing_size(const struct plan *plan);

/* Adds the runs; `room` is of that size and zero. The user's scenes have no probe. Returns 0, or -1
 * with plan->reason. */
int pushing_plan(struct plan *plan, struct pushing *pushing, void *room);

/* The next runs of the searches. Returns 0, or -1 with plan->reason. */
int pushing_refine(struct plan *plan, struct pushing *pushing);

/* The longest step of a trial, s; NaN: none was found. */
double trial_step(const struct probe *probe, const struct push_trial *trial);

/* The trial of that method on that hair and response, or NULL. */
const struct push_trial *trial_of(const struct pushing *pushing, int hair, int response,
                                  const char *method, const struct probe **probe);

/* Reads what runs have shown. Returns 0, or -1 with plan->reason. */
int pushing_read(struct plan *plan, struct pushing *pushing);

/* Writes the tables penalty and penalty-steps. Returns 0, or -1 with plan->reason. */
int pushing_tabulate(struct plan *plan, const struct pushing *pushing);

void pushing_state(struct statements *statements, const struct pushing *pushing);

#endif
