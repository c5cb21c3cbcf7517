/* What steppers by the integrators of SUNDIALS share: y' = g(t, y) with y = (q, v), the linear
 * systems of their Newton's method by our solvers, and what callbacks and failures mean. */
#ifndef WISPLAB_SUNDIALS_STEPPER_H
#define WISPLAB_SUNDIALS_STEPPER_H

#include "integrators/linear/sundials_support.h"
#include "stepper.h"

#include <sundials/sundials_matrix.h>

/* What callbacks have said in a step. */
struct verdict {
    int cause; /* the code of the last one */
    int fatal; /* the first one after which nothing will help, or 0 */
};

/* An integrator's own counts since it began anew, as the system's counters have them already. */
struct sundials_counts {
    long rejected, iterations;
};

/* The linear systems of Newton's method. */
struct sundials_newton {
    struct linear_solver *linear; /* NULL: there are none */
    enum jacobian kind;
    double gamma; /* of the last set-up */
    double *work; /* two right sides */
};

/* What such a stepper begins with. */
struct sundials_stepper {
    struct stepper base;
    struct system *system; /* not owned */
    struct sundials sundials;
    N_Vector y;             /* (q, v) */
    struct verdict verdict; /* of the last step's callbacks */
    SUNLinearSolver solver; /* for the integrator; NULL: it has none */
    SUNMatrix no_matrix;    /* it wants one to pass around; M, D and K are the system's */
    struct sundials_newton newton;
    int started, restart; /* whether it ran before; whether the next step begins anew */
    struct sundials_counts counted;
};

/* One of `bytes` of zeroed memory; NULL where memory cannot be had. Freed after the integrator,
 * which uses what is in it. */
void *sundials_create(struct system *system, size_t bytes);
void sundials_free(struct sundials_stepper *stepper);

/* For the table of such a method. */
int sundials_reset(struct stepper *stepper, unsigned lanes);

/* --- callbacks; all have the stepper --- */

/* Takes the code of a callback; returns its sign, which is what SUNDIALS wants. */
int verdict_take(struct verdict *verdict, int code);

/* What a failed linear solve is to be called, from the sign of its code: SUNDIALS takes codes that
 * it does not know for success. */
int verdict_of_solve(int sign);

/* rate <- (v, v') at y; the sign of the code. */
int sundials_rate(sunrealtype t, N_Vector y, N_Vector y_rate, void *stepper);

/* Makes a linear solver for the integrator, of these functions, whose content is the stepper.
 * Returns 0, or -1 where memory cannot be had. */
int sundials_make_solver(struct sundials_stepper *stepper, int (*setup)(SUNLinearSolver, SUNMatrix),
                         int (*solve)(SUNLinearSolver, SUNMatrix, N_Vector, N_Vector, sunrealtype));

/* Makes that of Newton's method, by the settings' linear solver; `jacobian` is the value of that
 * option. The same. */
int sundials_use_newton(struct sundials_stepper *stepper, const struct stepper_settings *settings,
                        int jacobian);

/* For the integrator's function that prepares I - gamma J; the sign of the code. */
int sundials_prepare_newton(struct sundials_stepper *stepper, double t, N_Vector y,
                            sunbooleantype jacobian_holds, sunbooleantype *jacobian_is_new,
                            double gamma);

/* --- a step --- */

/* Whether all lanes are at the stop at once, for a stepper that begins anew: there is nothing
 * between the two times but rounding. SUNDIALS refuses to begin on an interval of few of them, as
 * lies between the ticks of two clocks that should coincide. Nothing moves in it. */
int sundials_skip(const struct sundials_stepper *stepper, double *t, double stop);

/* Takes the state from which the integrator is to begin anew. */
void sundials_begin(struct sundials_stepper *stepper, const double *q, const double *v);

/* Adds what the integrator's counts have become since. */
void sundials_count(struct sundials_stepper *stepper, struct sundials_counts now);

/* What has failed where a callback did: what that said, or where it said nothing, `otherwise`. */
enum outcome verdict_outcome(const struct verdict *verdict, enum outcome otherwise);

/* The end of a step: takes the state that was reached. Where the integrator has failed, with a flag
 * below 0, it says what its message says, and what the last callback said if it did: the negative
 * of `outcome`, for it has tried smaller steps. */
int sundials_arrive(struct sundials_stepper *stepper, int flag, enum outcome outcome,
                    double reached, double *t, double stop, double *q, double *v);

#endif
