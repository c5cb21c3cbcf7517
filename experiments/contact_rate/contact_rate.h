/* Experiment contact-rate: how much it matters how often contacts are looked at. What its files
 * share. */
#ifndef WISPLAB_CONTACT_RATE_H
#define WISPLAB_CONTACT_RATE_H

#include "experiments/common/measure.h"
#include "experiments/common/statements.h"
#include "pushing.h"

/* The rate that all others are compared with, Hz: the thesis's of everything but contacts. */
#define YARDSTICK_RATE 9000.0

/* Harm is what can be seen: a millimetre, rms over the free nodes and frames. */
#define HARM 1e-3

/* Whose ticks come more or less often. */
enum tick_kind { WISP_TICKS, BODY_TICKS, TICK_KINDS };

/* What wisps do to each other: any of these. */
enum { FRICTION = 1, COLLISION = 2, BOTH = FRICTION | COLLISION };
extern const char *const contact_names[BOTH + 1];

enum { RATES_MAX = 8, MEMBERS = 8, QUICK_MEMBERS = 4 };

/* How far apart runs are that began a little apart, m: over the free nodes and the frames after the
 * horizon; lower quartile, median, upper quartile of all pairs. */
struct spread_of_pairs {
    int pairs; /* 0: nobody looked, or nothing finished */
    double lower, median, upper;
};

/* A rate of a series, and what its runs have shown. */
struct rate_point {
    double rate;      /* Hz */
    int at;           /* its run in the plan */
    int first, count; /* its runs from other starts in the plan; count 0: there are none */
    enum outcome outcome;
    double failure_time;     /* s; NaN: none */
    double error, largest;   /* from the yardstick up to the horizon, rms and largest, m */
    double whole;            /* over all frames, rms, m */
    double history_diverged; /* of the first frame that has other wisps than the yardstick's, s;
                      NaN: none */
    double contacts, sections, stops, evaluations, cpu;
    struct spread_of_pairs after; /* from the yardstick's runs; at the yardstick, of these */
};

/* Runs that differ in one rate alone. */
struct series {
    enum tick_kind ticks;
    int contact;    /* 0 to BOTH */
    int reciprocal; /* whether both sides of a contact give way */
    char name[48];
    int rate_count;
    struct rate_point point[RATES_MAX]; /* ascending; the last is the yardstick */
    int again;      /* in the plan: the yardstick from a start 1e-10 m away, in half the step */
    double horizon; /* s; NaN: the yardstick did not finish */
    double doubt;   /* of the yardstick up to there: its rms distance from that run, m */
    double effect;  /* what contact does: the yardstick's distance from none up to there, m */
    struct fit order;
    int has_order;
};

/* Friction, collision and both, reciprocal and one-sided; none; bodies. */
enum { SERIES_MAX = 8 };

/* Who makes errors on a scene. */
enum source { INTEGRATOR, TREATMENT, OF_WISP_TICKS, OF_BODY_TICKS, SOURCES };
extern const char *const source_names[SOURCES];

/* An error up to the scene's span and over all frames, with how far what it is measured by is in
 * doubt over the same frames, m. */
struct source_error {
    double error, doubt;
    double whole, whole_doubt;
    char against[96];
};

enum { PENALTIES = 4 };

struct study {
    const struct subject *subject;
    const char *set;             /* what is otherwise than in the scene's file, or NULL */
    double duration, frame_rate; /* s; Hz */
    double step;                 /* of rk4, s */
    double work;                 /* free nodes times seconds, in steps of 1/9000 s */
    int own_contact;             /* what the scene has */
    int series_count;
    struct series series[SERIES_MAX];
    int has_sources;
    int euler, reference, reference_again, penalty[PENALTIES]; /* in the plan */
    double span; /* to which all sources are compared, s; NaN: a yardstick did not finish */
    struct source_error error[SOURCES];
};

/* The plan's memo. */
struct contact_rate {
    int members_planned;
    struct pushing pushing;
    int count;
    struct study study[];
};

/* Penalty ratios from which the exact constrained motion is taken. */
extern const double penalty_ratios[PENALTIES];

/* The scene's own step to the nearest that divides the time between the yardstick's ticks, s. */
double step_between_ticks(const struct scene *scene);

/* The frames after `from` up to `to`, s from the first one on: lent. */
struct trajectory frames_between(const struct trajectory *states, double from, double to);

/* The series of the scene as it is; NULL: its ticks do nothing. */
const struct series *own_series(const struct study *study, enum tick_kind ticks);

/* The series of that contact and sides; NULL: there is none. */
const struct series *series_of(const struct study *study, int contact, int reciprocal);

/* The point of a rate; NULL: there is none. */
const struct rate_point *point_at(const struct series *series, double rate);

/* Reads what the yardsticks' runs say of the horizon. Returns 0, or -1 with plan->reason. */
int read_horizon(struct plan *plan, struct series *series);

/* Reads all runs of a study. Returns 0, or -1 with plan->reason. */
int read_study(struct plan *plan, struct study *study);

/* Writes the tables and statements from the plan's runs. */
int contact_rate_tabulate(struct plan *plan);

/* All statements. */
void state_all(struct statements *statements, const struct contact_rate *all);

#endif
