/* wisplab: a model of deformable hair wisps, for methods of your own.
 *
 * The model is that of É. Plante's thesis (Mouvements et interactions de la chevelure par mèches
 * déformables, Université de Montréal, 1999), as `wisplab run` integrates it; sections are the
 * thesis's. A scene poses a second-order system of n unknowns,
 *
 *     q' = v,   M(q) v' = f(t, q, v),        v' = a(t, q, v),
 *
 * that is smooth from stop to stop of a clock. At a stop wisps and bodies touch, which changes
 * (q, v) at once: a tick; or a prescribed motion has a kink. SI units throughout.
 *
 * Layout. q, v and a have n = wisplab_unknowns() numbers each: wisp after wisp, node after node
 * from node 2 on (nodes 0 and 1 belong to the head), of each node x y z and then its samples'
 * distances or, in the treatment `penalty`, positions. wisplab_unknown() says what each is.
 * Positions among the unknowns are from where the wisp's node 0 is at t = 0; wisplab_frame() has
 * them in space. Vectors that a function reads and writes must not overlap.
 *
 * Errors. Functions that can fail return an enum wisplab_code; wisplab_error() then has one line of
 * why. Nothing is printed, nothing ends the process, and after a failure the handle can be used on;
 * its state is as before where nothing else is said. (One exception is libconfig's, which ends the
 * process where it gets no memory to read a scene.)
 *
 * Threads. A handle is for one thread at a time, different handles for different threads: they
 * share nothing that changes. The stepper `reference` switches GSL's error handler off for the
 * process. The same calls give the same bits, whatever other handles do.
 *
 * Ownership. What a function fills belongs to the caller; texts that it returns belong to the
 * handle, and stay until wisplab_close. */
#ifndef WISPLAB_H
#define WISPLAB_H

#include <stddef.h>

#define WISPLAB_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* A scene brought to life, with a state (t, q, v) and a clock. */
typedef struct wisplab wisplab;

enum wisplab_code {
    WISPLAB_OK = 0,
    WISPLAB_REFUSED = 1, /* the request is wrong, or this model has no such thing */
    WISPLAB_FAILED = 2,  /* the model, a solver or a stepper failed at these numbers: a shorter
                            step might do */
    WISPLAB_NO_MEMORY = 3,
    WISPLAB_STOPPED = 4, /* the caller's own function ended a run */
};

/* The version of the library that runs, "0.2.0". */
WISPLAB_API const char *wisplab_version(void);

/* ---- Opening ------------------------------------------------------------------------------- */

/* Opens a scene: the name of a shipped one, as "swing", or a path to a .cfg file. `sets` are
 * changes as `wisplab run --set` takes them, "material.hair_count=500", ending with NULL, or NULL.
 * `treatment` says how samples are kept on their half-lines (section 4.2.1): "generalised",
 * "projection" or "penalty"; on the circle "free", "projection" or "generalised", on rosenblum and
 * anjyo "free"; NULL: "generalised" on wisps, else "free".
 *
 * *w is the handle for wisplab_close, in the scene's first state at its first time, or NULL with
 * one line of why in `error` (of `size` bytes; NULL: not wanted). */
WISPLAB_API int wisplab_open(wisplab **w, const char *scene, const char *const *sets,
                             const char *treatment, char *error, size_t size);

/* Opens the text of a scene file, which stands for the file `path`: that names the scene
 * where the text does not, and what is included or started from is in its folder. */
WISPLAB_API int wisplab_open_text(wisplab **w, const char *text, const char *path,
                                  const char *const *sets, const char *treatment, char *error,
                                  size_t size);

/* Frees a handle and all that it owns; NULL is no harm. */
WISPLAB_API void wisplab_close(wisplab *w);

/* Why the last call with this handle that failed did so; "" if none did. */
WISPLAB_API const char *wisplab_error(const wisplab *w);

/* ---- What there is ------------------------------------------------------------------------- */

WISPLAB_API const char *wisplab_scene(const wisplab *w);     /* its name */
WISPLAB_API const char *wisplab_treatment(const wisplab *w); /* its name */

/* n. A tick at which wisps split makes it larger: of q, v and frames, what was there stays where it
 * is, and the new wisps come behind it. */
WISPLAB_API int wisplab_unknowns(const wisplab *w);

/* Wisps, numbered from 0 (the circle's particle is wisp 0); and the nodes of all of them together,
 * each a row of wisplab_frame(). */
WISPLAB_API int wisplab_wisps(const wisplab *w);
WISPLAB_API int wisplab_nodes(const wisplab *w);

/* The wisp that this one split off from, or itself. */
WISPLAB_API int wisplab_parent(const wisplab *w, int wisp);

/* What an unknown is: "x", "y", "z" of a node; of its sample j "rj", the distance from the node
 * along the half-line, or "ejx", "ejy", "ejz"; "angle" on the circle, "theta" and "phi" in anjyo.
 */
struct wisplab_unknown {
    int wisp, node;
    const char *name;
    const char *unit; /* of q; v is in that per s, a per s^2 */
};

/* What q[i], v[i] and a[i] belong to, 0 <= i < n. WISPLAB_REFUSED, without a text, for another i.
 */
WISPLAB_API int wisplab_unknown(const wisplab *w, int i, struct wisplab_unknown *unknown);

/* When the scene begins and ends, s, and its frames per second (0: it does not say). */
WISPLAB_API void wisplab_times(const wisplab *w, double *begin, double *end, double *frame_rate);

/* ---- The state ----------------------------------------------------------------------------- */

/* The handle's state: time, s; q and v, n numbers each. Pointers may be NULL. */
WISPLAB_API void wisplab_state(const wisplab *w, double *t, double *q, double *v);

/* Makes (t, q, v) the handle's state; numbers that are not finite are refused. The next stop stays
 * as long as t is between the last one and the next one, else it is the first one after t. */
WISPLAB_API int wisplab_set_state(wisplab *w, double t, const double *q, const double *v);

/* ---- Forces and energy: at any state, whatever the handle's own is -------------------------- */

/* a <- a(t, q, v): sections 4.1 and 4.2. At a time at which a prescribed motion jumps it is that of
 * the smooth interval in which the handle is. */
WISPLAB_API int wisplab_acceleration(wisplab *w, double t, const double *q, const double *v,
                                     double *a);

/* rate <- da/dt where q and v stay: of wind, style and head. Refused where the model has no
 * Jacobians, and outside wisps. Counts as an acceleration too. */
WISPLAB_API int wisplab_time_rate(wisplab *w, double t, const double *q, const double *v,
                                  double *rate);

/* Puts (q, v) onto the constraint that is kept by putting the state back to it after each step:
 * rigid segments, and the circle's treatment `projection`. Elsewhere it does nothing. The state is
 * as before where it fails. */
WISPLAB_API int wisplab_project(wisplab *w, double t, double *q, double *v);

/* Where the energy is, J: wisplab_energies() numbers, which add up to all of it, of free nodes and
 * samples. Each has a name: "kinetic", "gravity", "stretch", "bending", "envelope", "bodies". Wisps
 * alone know theirs, elsewhere it is refused. */
WISPLAB_API int wisplab_energies(void);
WISPLAB_API const char *wisplab_energy_name(int i); /* NULL for another i */
WISPLAB_API int wisplab_energy(wisplab *w, double t, const double *q, const double *v,
                               double *energies);

/* ---- Matrices ------------------------------------------------------------------------------ */

/* M, D = df/dv and K = df/dq, of all terms, or with what makes them indefinite left out, so that
 * M - alpha D - beta K with alpha, beta >= 0 is symmetric and positive definite (Choi & Ko,
 * doi:10.1145/566654.566624; in `projection` with an envelope it is so once samples are
 * eliminated). Both hold the frames in which samples move (section 4.1.1): where there is an
 * envelope they leave out how these turn, and "exact" is what else there is. */
enum wisplab_jacobian { WISPLAB_EXACT, WISPLAB_SPD };

/* Computes M, D and K at (t, q, v), for the functions below, until the next call of this function,
 * of wisplab_mass_solve, wisplab_tick or wisplab_run. Rigid segments have none, and only wisps have
 * WISPLAB_SPD: refused. */
WISPLAB_API int wisplab_linearise(wisplab *w, enum wisplab_jacobian kind, double t, const double *q,
                                  const double *v);

/* y <- (m M + d D + k K) x. With m alone it is the mass matrix's product. */
WISPLAB_API int wisplab_product(wisplab *w, double m, double d, double k, const double *x,
                                double *y);

/* matrix <- m M + d D + k K, n n numbers, column by column (its transpose to who counts by rows).
 */
WISPLAB_API int wisplab_dense(wisplab *w, double m, double d, double k, double *matrix);

/* values <- m M + d D + k K without what is always zero, in compressed columns (CSC):
 * wisplab_entries() values, row indices (ascending in each column) and n + 1 column starts. The
 * pattern holds until n changes. Without Jacobians there are 0 entries, and the rest is refused. */
WISPLAB_API int wisplab_entries(const wisplab *w);
WISPLAB_API int wisplab_pattern(wisplab *w, int *column_start, int *row);
WISPLAB_API int wisplab_sparse(wisplab *w, double m, double d, double k, double *values);

/* Factorises M - alpha D - beta K, for wisplab_solve until the next factor or linearisation: the
 * model's own direct solver, in time proportional to n. On wisps after WISPLAB_SPD alone. */
WISPLAB_API int wisplab_factor(wisplab *w, double alpha, double beta);

/* x <- the solution of (M - alpha D - beta K) x = b. */
WISPLAB_API int wisplab_solve(wisplab *w, const double *b, double *x);

/* x <- M(q)^-1 b: linearises anew, and factorises M alone. */
WISPLAB_API int wisplab_mass_solve(wisplab *w, double t, const double *q, const double *v,
                                   const double *b, double *x);

/* ---- Frames: a state as the program's states.tsv has it ------------------------------------- */

/* The columns of a frame, behind its time: "wisp", "node", "x", "y", "z" (m, in space), "vx", "vy",
 * "vz" (m/s), then "r0", "rd0", ... or "e0x", ... "e0vz", ...; NULL for another i. */
WISPLAB_API int wisplab_columns(const wisplab *w);
WISPLAB_API const char *wisplab_column(const wisplab *w, int i);

/* rows <- a frame: wisplab_nodes() rows of wisplab_columns() numbers, row by row; nodes 0 and 1 are
 * where the head has them at t. */
WISPLAB_API int wisplab_frame(wisplab *w, double t, const double *q, const double *v, double *rows);

/* Where all nodes are in space, m: x y z of each row of a frame; and where the tips are, x y z of
 * the last node of each wisp. */
WISPLAB_API int wisplab_positions(wisplab *w, double t, const double *q, const double *v,
                                  double *xyz);
WISPLAB_API int wisplab_tips(wisplab *w, double t, const double *q, const double *v, double *xyz);

/* ---- The clock ----------------------------------------------------------------------------- */

/* What falls on a stop, added up. */
enum wisplab_event {
    WISPLAB_COLLISION = 4,   /* bodies push hair out, samples are kept off their nodes: 4.2.2 */
    WISPLAB_INTERACTION = 8, /* wisps touch each other, and may split: 4.3, 4.4 */
    WISPLAB_KINK = 16,       /* a prescribed motion jumps: methods with a history begin anew */
};

/* The time of the next stop, s, and its events (may be NULL): beyond it nothing is smooth. Infinite
 * and 0 where there is none. The end of the scene and its frames are no stops. */
WISPLAB_API void wisplab_next_stop(const wisplab *w, double *t, unsigned *events);

/* Does to the handle's state what is due at the next stop, which must be its time (set it to where
 * the smooth motion has come to). *changed (may be NULL) becomes 1 where the state is another one
 * now, also in n. The clock goes on. WISPLAB_FAILED where rigid segments could not be kept. */
WISPLAB_API int wisplab_tick(wisplab *w, int *changed);

/* ---- The program's own methods -------------------------------------------------------------- */

/* What to run, as on the command line; NULL or 0 is not said. */
struct wisplab_method {
    const char *stepper;        /* as `wisplab list steppers` names them; not said: "rk4" */
    const char *linear;         /* a linear solver, of steppers that take one */
    double step;                /* s, of steppers with fixed steps; not said: the scene's */
    double rtol, atol;          /* of others: relative; absolute, m and m/s */
    const char *const *options; /* of the stepper and the solver, "key=value", ending with NULL */
    double strain_limit;        /* beyond which a run has diverged */
    int threads;                /* that share out the wisps; bits do not depend on them */

    /* Called with each frame, the first and the last state among them: its time, and rows as
     * wisplab_frame has them. Anything but 0 ends the run. May be NULL; must not use the handle. */
    int (*frame)(void *context, double t, const double *rows, int nodes);
    void *context;
};

/* Runs from the handle's state to time `to`, s, ticks included (also one that is due where it
 * begins): with the stops and frames of `wisplab run`, and so with its bits, from the scene's begin
 * to its end. The state is then that at `to`, or, after a failure or a stop, where the run came to.
 *
 * Wisps are computed one by one, as all functions here do: where a scene has a hundred of them,
 * `wisplab run` takes a quarter of the time, for the same bits. */
WISPLAB_API int wisplab_run(wisplab *w, const struct wisplab_method *method, double to);

/* ---- What was counted ----------------------------------------------------------------------- */

/* Since the handle was opened, of the calls above and of runs: "steps", "force_evaluations",
 * "linearisations", "jacobian_products", "factorisations" and others, as run.json has them; a call
 * counts once for each wisp. Columns of matrices count as products. */
WISPLAB_API int wisplab_counters(void);
WISPLAB_API const char *wisplab_counter_name(int i); /* NULL for another i */
WISPLAB_API void wisplab_counts(const wisplab *w, long long *counts);

#ifdef __cplusplus
}
#endif

#endif
