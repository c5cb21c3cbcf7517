/* What the implicit integrators of SUNDIALS share: y' = g(t, y) with y = (q, v), the linear systems
 * of their Newton's method by our solvers, and what callbacks and failures mean. */
#ifndef WISPLAB_SUNDIALS_NEWTON_H
#define WISPLAB_SUNDIALS_NEWTON_H

#include "integrators/linear/sundials_support.h"
#include "stepper.h"

#include <sundials/sundials_matrix.h>

/* What callbacks have said in a step. */
struct verdict {
    int cause; /* the code of the last one */
    int fatal; /* the first one after which nothing will help, or 0 */
};

/* Takes the code of a callback; returns its sign, which is what SUNDIALS wants. */
int verdict_take(struct verdict *verdict, int code);

/* What a failed linear solve is to be called, from the sign of its code: SUNDIALS takes codes that
 * it does not know for success. */
int verdict_of_solve(int sign);

/* rate <- (v, v') at y; the sign of the code. */
int sundials_rate(struct system *system, struct verdict *verdict, double t, N_Vector y,
                  N_Vector y_rate);

struct sundials_newton {
    struct system *system;   /* not owned, like */
    struct verdict *verdict; /* where codes go */
    SUNLinearSolver solver;  /* for the integrator */
    SUNMatrix no_matrix;     /* it wants one to pass around; M, D and K are the system's */
    struct linear_solver *linear;
    enum jacobian kind;
    double gamma; /* of the last set-up */
    double *work; /* two right sides */
};

/* Opens for a system and the settings' linear solver; `jacobian` is the value of that option.
 * Returns 0, or -1 where memory cannot be had. To be closed in either case; what is all 0 may be
 * closed too. */
int sundials_newton_open(struct sundials_newton *newton, const struct stepper_settings *settings,
                         int jacobian, struct system *system, struct sundials *sundials,
                         struct verdict *verdict);
void sundials_newton_close(struct sundials_newton *newton);

/* For the integrator's function that prepares I - gamma J; the sign of the code. */
int sundials_newton_prepare(struct sundials_newton *newton, double t, N_Vector y,
                            sunbooleantype jacobian_holds, sunbooleantype *jacobian_is_new,
                            double gamma);

/* An integrator's own counts since it began anew, as the system's counters have them already. */
struct sundials_counts {
    long rejected, iterations;
};

/* Adds what they have become since. */
void sundials_count(struct system *system, struct sundials_counts *counted,
                    struct sundials_counts now);

/* What has failed where a callback did: what that said, or where it said nothing, `otherwise`. */
enum outcome verdict_outcome(const struct verdict *verdict, enum outcome otherwise);

/* Says what an integrator's message says, and what the last callback said if it did: the negative
 * of `outcome`, for it has tried smaller steps. */
int sundials_failed(struct system *system, const struct verdict *verdict, enum outcome outcome,
                    const char *name, const char *message);

/* Whether there is nothing between two times but rounding: SUNDIALS refuses to begin on an interval
 * of few of them, as lies between the ticks of two clocks that should coincide. Nothing moves in
 * it. */
int sundials_too_close(double t, double stop);

#endif
