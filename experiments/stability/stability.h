/* Inside experiment stability: what its files share. */
#ifndef WISPLAB_STABILITY_H
#define WISPLAB_STABILITY_H

#include "experiments/common/search.h"
#include "experiments/common/statements.h"

#include <complex.h>

/* --- stability_small.c: the real steppers on linear systems of one or two unknowns --- */

/* M = 1, and D and K row by row. It must stay where it is while a stepper has it. */
struct small_system {
    struct system system;
    int n; /* 1 or 2 */
    double d[4], k[4];
    double matrix[4]; /* of the last factor */
    struct sparse_matrix pattern;
    int column_start[3], row[4];
};

/* u' = z u, as two real equations that ride on v. */
void small_dahlquist(struct small_system *small, double complex z);

/* q'' = -q - 2 zeta q': time is counted in 1 / omega. */
void small_oscillator(struct small_system *small, double zeta);

/* By what a step of h multiplies (q, v) in the long run: of fixed steps the spectral radius of the
 * step as it is done, or where a method has a history the growth over a train of them; of adaptive
 * ones the growth over times of h. INFINITY where a step fails or
 * is not finite; NaN where the method refuses the system. Per step of h = 1 on u' = z u it is
 * |R(z)| of a Runge-Kutta method. */
double measured_growth(const struct stepper_method *method, double tolerance,
                       struct small_system *small, double h);

/* An undamped oscillator let go: what the method's own damping is, of critical (negative: it
 * grows), and by how much its frequency is off, relative; NaN where it fails or turns by nearly
 * half a turn in a step. By the eigenvalue of the step as it is done, and where a method has a
 * history or chooses its steps, by least squares over a train of them from q = 1. */
struct ring_down {
    double damping, frequency_shift;
    double steps_per_period;
};
struct ring_down measured_ring_down(const struct stepper_method *method, double tolerance,
                                    double h);

/* The ring-down by linear theory, of a method that stepper_is_predictable. */
struct ring_down predicted_ring_down(const struct stepper_method *method, double h);

/* --- stability_modes.c: linear theory of a wisp --- */

/* A motion exp(rate t) of a system, 1/s, and the other rate of its mode: the mode is an oscillator
 * q'' = (rate + partner) q' - rate partner q, swinging where they are conjugate, creeping where
 * they are real. */
struct mode_rate {
    double complex rate, partner;
};

/* The eigenvalues of (q, v)' = (v, M^-1 (K q + D v)), where a system of one lane is linearised at
 * (t, q, v): 2 * size rates for the caller to free, NULL where memory cannot be had or the model
 * fails. Dense: the work is the cube of the size. */
struct mode_rate *system_modes(struct system *system, double t, const double *q, const double *v);

/* The longest step before the first that is not stable on all modes: its amplification is 1 at
 * most, or as much as the mode itself grows. Growth below a millionth per step does not count: runs
 * have no millions of steps. INFINITY where there is none; 0 where no step is. The method is one
 * that stepper_is_predictable. */
double stable_step(const struct stepper_method *method, const struct mode_rate *modes, int count);

/* The modes of the scene's wisps at its start, of those alike once, for the caller to free. NULL
 * where a wisp has too many unknowns for dense eigenvalues, or memory cannot be had. */
struct mode_rate *scene_modes(const struct scene *scene, enum wisp_treatment treatment, int *count);

/* --- stability_maps.c --- */

/* Writes the tables regions, oscillator and damping, measured here and now, and states how near
 * they are to theory. 0, or -1 with plan->reason. */
int stability_maps(struct plan *plan);

/* --- stability_limits.c, stability_tables.c: the searches, stages of struct experiment --- */

int limits_plan(struct plan *plan);
int limits_refine(struct plan *plan);
int limits_tabulate(struct plan *plan);

#endif
