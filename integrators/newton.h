/* The loop in which implicit methods solve their equations: for the unknown v of
 *
 *     v = v0 + gamma a(t, q, v),   q = q0 + beta v,
 *
 * where a is a system's acceleration, and q0, v0, gamma, beta are what the method knows. Implicit
 * Euler has gamma = beta = h and the state before the step in q0 and v0; a BDF, or a stage of a
 * diagonally implicit Runge-Kutta method, h times its coefficient, and sums over earlier values.
 *
 * Newton's method, at an iterate (q, v) and for its change dv:
 *
 *     (M - gamma D - gamma beta K) dv = M (v0 - v + gamma a) + gamma K (q0 + beta v - q).
 *
 * Wisps side by side converge one by one: a lane that has converged keeps its iterate while the
 * others go on, and what it is measured by is its own, so that a wisp's bits do not depend on its
 * company. Whatever is decided here, now or with more options, must be decided by lane, or by
 * counts that are the same for all.
 *
 * With newton.reuse a lane keeps its Jacobians and factors from step to step: in that many steps,
 * until gamma or beta are others, until the lane is told to forget, or until an iteration shrinks
 * its change by less than to a quarter (Hairer & Wanner, Solving ODEs II, section IV.8). A single
 * iteration is then that of a W-method: its order does not depend on the matrix, its stability
 * does. (It does not pay on `swing`: at 1000 Hz steps of implicit Euler that share a matrix by five
 * take 0.82 of the time and have 2.7 times the error; by two, 1.0 and 1.4.) */
#ifndef WISPLAB_NEWTON_H
#define WISPLAB_NEWTON_H

#include "stepper.h"

/* The options of the loop: a method that uses it has them first in its list. */
enum { NEWTON_ITERATIONS, NEWTON_TOLERANCE, NEWTON_JACOBIAN, NEWTON_REUSE, NEWTON_OPTIONS };
#define NEWTON_OPTION_SPECS(usual_iterations)                                                  \
    [NEWTON_ITERATIONS] = {.name = "newton.iterations",                                        \
                           .help = "Newton iterations at most; 1 takes the linearised step "   \
                                   "unchecked",                                                \
                           .kind = OPTION_COUNT,                                               \
                           .initial = (usual_iterations),                                      \
                           .least = 1,                                                         \
                           .most = 100},                                                       \
    [NEWTON_TOLERANCE] = {.name = "newton.tolerance",                                          \
                          .help = "largest last change of a velocity, relative to 1 m/s + "    \
                                  "the largest speed",                                         \
                          .kind = OPTION_REAL,                                                 \
                          .initial = 1e-12,                                                    \
                          .least = 0,                                                          \
                          .most = 1},                                                          \
    [NEWTON_JACOBIAN] = {.name = "jacobian",                                                   \
                         .help = "exact, spd (symmetric positive definite), or auto: spd "     \
                                 "where there is one",                                         \
                         .kind = OPTION_CHOICE,                                                \
                         .initial = JACOBIAN_AUTO,                                             \
                         .choices = jacobian_choices},                                         \
    [NEWTON_REUSE] = {.name = "newton.reuse",                                                  \
                      .help = "steps for which a factorised matrix is kept at most; 0: it is " \
                              "made anew in every iteration",                                  \
                      .kind = OPTION_COUNT,                                                    \
                      .initial = 0,                                                            \
                      .least = 0,                                                              \
                      .most = 1000}

/* What is to be solved; q0 and v0 have a number for each unknown of the system. */
struct newton_equation {
    double t;           /* of the unknown state, s */
    double gamma, beta; /* s */
    const double *q0, *v0;
};

struct newton;

/* REFUSED with system->reason where the linear solver of the settings cannot serve, else 0. */
int newton_refuse(const struct stepper_settings *settings, struct system *system);

/* The loop for `system`, to be freed with newton_free (which takes NULL); NULL where memory cannot
 * be had. `options` is the method's list, which begins with those of the loop. */
struct newton *newton_create(const struct stepper_settings *settings,
                             const struct option_spec *options, struct system *system);
void newton_free(struct newton *newton);

/* Whether there is newton.reuse. Then what was made for lanes is to be forgotten where another
 * state comes than the one that the last step led to. */
int newton_reuses(const struct newton *newton);
void newton_forget(struct newton *newton, unsigned lanes);

/* Turns the first iterate (q, v) into the solution. The first iterate need not fulfil
 * q = q0 + beta v. Returns 0 or the code of a failure: the model's, the linear solver's, NOT_FINITE
 * where a lane's iterate is lost, SOLVER_STALLED where one has not converged; (q, v) is then
 * worthless, in all lanes. */
int newton_solve(struct newton *newton, const struct newton_equation *equation, double *q,
                 double *v);

#endif
