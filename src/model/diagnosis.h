/* What a run can be asked of besides its states (settings->diagnostics): where its energy is and
 * where it went, and extremes of its state. A diagnosis is made at each frame; between frames each
 * part keeps an account of the works done on it.
 *
 * Measuring takes time, so that a run's times are not comparable; its states have the same bits as
 * without. */
#ifndef WISPLAB_DIAGNOSIS_H
#define WISPLAB_DIAGNOSIS_H

#include "system/energy.h"

#include <stdio.h>

struct model;
struct part;
struct scene;

/* X(kind, name, meaning). Events of ticks that change the energy at one time, J. */
#define JUMPS(X)                                                            \
    X(WISP_CONTACT, "wisp_contact", "contact of wisps")                     \
    X(BODY_CONTACT, "body_contact", "bodies pushing nodes and samples out") \
    X(CLAMP, "clamp", "samples put back to 1e-3 R")

enum jump {
#define X(kind, name, meaning) JUMP_##kind,
    JUMPS(X)
#undef X
        JUMP_COUNT
};

/* The books of a part, since the start. */
struct account {
    struct powers work;      /* J */
    double jump[JUMP_COUNT]; /* J */

    /* of the last point of the smooth motion that was looked at */
    double t;            /* s */
    struct powers power; /* W */

    double energy; /* at a tick, before what comes next, J */
};

/* The smooth motion of a part with an account: where it begins, and where it is after each accepted
 * step, whose works are added. A state whose accelerations cannot be had makes them NaN. */
void account_begin(struct part *part, double t);
void account_step(struct part *part, double t);

/* At a tick at time t, for a part with or without an account: before an event, and after it, when
 * the energy's jump since the last of these calls is booked. */
void account_before(struct part *part, double t);
void account_after(struct part *part, double t, enum jump kind);

/* X(name, unit, meaning). Of the state at a frame; NaN where there is no envelope. */
#define EXTREMES(X)                                                             \
    X(strain, "1", "largest |L/l - 1| of a stretch segment")                    \
    X(penetration, "m",                                                         \
      "largest depth of a free node in a body, along the way by which contact " \
      "puts it out: the normal of the shell through it")                        \
    X(nodes_inside, "1", "free nodes that are in a body")                       \
    X(least_radius, "1", "least r/R of a free node's sample")                   \
    X(largest_radius, "1", "largest r/R of a free node's sample")               \
    X(speed, "m/s", "largest speed of a free node or sample")

struct extremes {
#define X(name, unit, meaning) double name;
    EXTREMES(X)
#undef X
};

struct diagnosis {
    double t; /* s */
    struct energies energy;
    struct powers work;      /* J, since the start */
    double jump[JUMP_COUNT]; /* J, since the start */
    double other;            /* J: jumps at ticks of no kind */
    double residual;         /* J: of the energy's change since the start, what none of these is */
    struct extremes extremes;
    double body_contacts, wisp_contacts; /* counters: since the frame before */
};

/* Sums over parts, in their order, J: the energy of the state, NaN where memory could not be had;
 * what accounts have booked of ticks. (A part that a tick has made has no account yet.) */
double model_energy(const struct model *model);
double model_jumps(const struct model *model);

/* Fills in all that a model with accounts knows by itself: `other` is 0, and `residual` the energy
 * less the works and jumps. `rows` are the frame's. Returns 0 or OUT_OF_MEMORY. */
int diagnose(const struct model *model, const double *rows, struct diagnosis *diagnosis);

/* The table: what its columns are (`#` lines), their names, a row. */
void diagnosis_write_head(FILE *stream);
void diagnosis_write_row(FILE *stream, const struct diagnosis *diagnosis);

#endif
