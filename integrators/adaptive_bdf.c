/* Semi-implicit BDF, see bdf.c, that chooses its steps: each lane its own, so that a wisp takes the
 * steps that it would take alone.
 *
 * Error. With the old states so long before the end, b_0 < b_1 < ..., and y the exact solution, the
 * formula of order k is off by beta b_0 ... b_(k-1) y^(k+1) / (k+1)!, where beta = 1 / sum_(j < k)
 * 1 / b_j; the polynomial through one more old state, extrapolated to the end, is off by
 * -b_0 ... b_k y^(k+1) / (k+1)!. So the end less what is extrapolated is their sum, of which
 * beta / (beta + b_k) is the step's error (Milne's device: Hairer, Norsett & Wanner, Solving ODEs
 * I, section III.7 for variable steps). What the one Newton iteration leaves is of that order, too,
 * and in the difference.
 *
 * It is measured by the rms of all positions and of all velocities of a wisp, each over
 * rtol times the rms of the state's (at the larger end) plus atol; the larger of the two counts.
 *
 * Steps. With D_n the step that would have had the error of `AIM` where the n-th was tried, the
 * next one is sqrt(h_n) (D_n D_(n-1))^(1/4). For steps that are as was proposed that is the filter
 * H211b with b = 4 (Soderlind 2003, doi:10.1145/641876.641877); one that was cut short by a stop
 * tells its D as well, and changes the proposal no more than another.
 *
 * Beginnings. As in bdf.c, two half steps of linear Euler, twice, less a whole one; the halves'
 * error, which is of order 1, is half less whole. */
#include "eights.h"
#include "semi_implicit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ORDER_MOST = 3 };
enum { MATRIX, ORDER };
static const struct option_spec options[] = {
    [MATRIX] = MATRIX_OPTION_SPEC,
    [ORDER] = {"order", "of the formula; 3 gains energy where nothing is damped", OPTION_COUNT,
               .initial = 2, .least = 2, .most = 3},
    {.name = NULL},
};

/* The error that is aimed at, over what is allowed. */
static const double AIM = 0.5;

/* What a step does with the states, the last one first; by lane, again and again to make eight. */
struct weights {
    eight sum[ORDER_MOST];       /* for the state that beta times the rates add to */
    eight ahead[ORDER_MOST];     /* to extrapolate to where the forces are asked for */
    eight guess[ORDER_MOST + 1]; /* and from one more, for the error */
    eight beta, square;          /* beta^2 */
    eight error;                 /* of end less guess */
};

struct state {
    double *q, *v;
};

struct adaptive_bdf {
    struct semi_implicit_stepper semi;
    struct system *system;
    int order, lanes;
    int padded; /* unknowns, and zeros that make them whole eights */
    double rtol, atol;

    /* by lane; in eights again and again */
    unsigned begin;         /* told to begin anew */
    int started[EIGHT];     /* has begun before */
    int wisp[EIGHT];        /* whose steps all this is of */
    int age[EIGHT];         /* old states before the last one, `order` at most */
    eight past[ORDER_MOST]; /* the step that led to the last state, the one before */
    double next[EIGHT];     /* the step that is proposed; 0: nothing is known */
    double wanted[EIGHT];   /* D of the last step */
    double opening[EIGHT];  /* D of the last beginning; 0: nothing is known */
    int rejected[EIGHT];    /* it was tried longer */
    eight used;             /* the step that is tried, */
    double end[EIGHT];      /* the time that it ends at, */
    int points[EIGHT];      /* and the old states that its error is estimated by */

    struct weights w;
    struct state last, old[ORDER_MOST]; /* the last state, the one before it, ... */
    struct state to;                    /* where the forces are asked for; then the end */
    struct state guess;                 /* another end */
    double *r, *r0, *change;
    IN_LINES double memory[];
};

enum { VECTORS = 9 }; /* of no old state */

static struct stepper *create(const struct stepper_settings *settings, struct system *system) {
    const int order = (int)option_value(&settings->options, &options[ORDER]);
    const size_t padded = ((size_t)system->size + EIGHT - 1) / EIGHT * EIGHT;
    const size_t numbers = (VECTORS + 2 * (size_t)order) * padded + EIGHT; /* see squares */
    struct adaptive_bdf *self =
        semi_implicit_stepper(settings, system, sizeof *self + numbers * sizeof(double));
    if (!self)
        return NULL;
    double *at = self->memory;
    double **const made[VECTORS] = {&self->last.q, &self->last.v,  &self->to.q,
                                    &self->to.v,   &self->guess.q, &self->guess.v,
                                    &self->r,      &self->r0,      &self->change};
    for (int i = 0; i < VECTORS; i++, at += padded)
        *made[i] = at;
    for (int j = 0; j < order; j++, at += 2 * padded)
        self->old[j] = (struct state){at, at + padded};
    self->order = order;
    self->lanes = system->lanes;
    self->padded = (int)padded;
    self->rtol = settings->rtol;
    self->atol = settings->atol;
    self->begin = ~0u;
    self->system = system;
    return &self->semi.base;
}

/* --- weights --- */

/* prod_(i != j) b_i / (b_i - b_j), with which `count` states extrapolate to the end; see bdf.c. */
static eight ahead_of(const eight *before, int count, int j) {
    eight ahead = all(j < count);
    for (int i = 0; i < count && j < count; i++)
        if (i != j)
            ahead *= before[i] / (before[i] - before[j]);
    return ahead;
}

/* beta of the formula through so many old states. */
static eight beta_of(const eight *before, int count) {
    eight c = all(0);
    for (int j = 0; j < count; j++)
        c += 1 / before[j];
    return 1 / c;
}

/* The weights of lanes of one age. */
static struct weights weights_of(const struct adaptive_bdf *self, int age) {
    const int order = self->order, points = age + 1;
    const int count = points < order ? points : order;
    struct weights w = {.beta = all(0)};
    eight before[ORDER_MOST + 1] = {self->used};
    for (int j = 1; j < points; j++)
        before[j] = before[j - 1] + self->past[j - 1];
    w.beta = beta_of(before, count);
    w.square = w.beta * w.beta;
    for (int j = 0; j < count; j++) {
        w.ahead[j] = ahead_of(before, count, j);
        w.sum[j] = w.ahead[j] * w.beta / before[j];
    }
    for (int j = 0; j < points; j++)
        w.guess[j] = ahead_of(before, points, j);
    const eight checked = points > count ? w.beta : beta_of(before, points - 1);
    w.error = checked / (checked + before[points - 1]);
    return w;
}

/* A lane's number, in all its places. */
static void put(const struct adaptive_bdf *self, eight *to, int k, double value) {
    for (; k < EIGHT; k += self->lanes)
        (*to)[k] = value;
}

/* All bits where a number is of one of these lanes. */
typedef long long mask __attribute__((vector_size(8 * EIGHT), aligned(8)));

static mask mask_of(const struct adaptive_bdf *self, unsigned lanes) {
    const mask bit = {1, 2, 4, 8, 16, 32, 64, 128};
    const unsigned again = self->lanes == 1 ? 0xff : self->lanes == 4 ? 0x11 : 1;
    const long long bits = again * (lanes & ~(~0u << self->lanes));
    return (bit & bits) != 0;
}

static inline eight chosen(mask these, eight yes, eight no) {
    return (eight)((these & (mask)yes) | (~these & (mask)no));
}

/* Takes what these lanes have of `from`. */
static void take_weights(struct adaptive_bdf *self, unsigned lanes, const struct weights *from) {
    enum { COUNT = sizeof *from / sizeof(eight) };
    const mask these = mask_of(self, lanes);
    eight *to = (eight *)&self->w;
    const eight *w = (const eight *)from;
    for (int i = 0; i < COUNT; i++)
        to[i] = chosen(these, w[i], to[i]);
}

/* A lane that does not try stays where it is, and has no forces. */
static void weigh(struct adaptive_bdf *self, unsigned lanes) {
    const struct weights none = {.sum = {all(1)}, .ahead = {all(1)}, .guess = {all(1)}};
    for (int age = 1; age <= self->order; age++) {
        unsigned those = 0;
        for (int k = 0; k < self->lanes; k++)
            those |= (unsigned)(self->age[k] == age) << k;
        if (!(those & lanes))
            continue;
        const struct weights w = weights_of(self, age);
        take_weights(self, those & lanes, &w);
        for (int k = 0; k < self->lanes; k++)
            if (those & lanes & 1u << k)
                self->points[k] = age + 1;
    }
    take_weights(self, ~lanes, &none);
}

/* --- the pieces of a step --- */

#define INLINED static inline __attribute__((always_inline))

/* sum_j weight_j x_j over `count` states. */
INLINED eight combined(const eight *weight, int count, const double *const *x, int i) {
    eight sum = weight[0] * load(x[0], i);
    for (int j = 1; j < count; j++)
        sum += weight[j] * load(x[j], i);
    return sum;
}

/* q*, v*, v0 - v* and the guess; `order` is a constant where this is inlined. */
INLINED void extrapolate(struct adaptive_bdf *self, int order) {
    const struct weights w = self->w;
    const double *const q[] = {self->last.q, self->old[0].q, self->old[1].q, self->old[2].q};
    const double *const v[] = {self->last.v, self->old[0].v, self->old[1].v, self->old[2].v};
    const struct state to = self->to, guess = self->guess;
    double *r0 = self->r0;
    for (int i = 0; i < self->padded; i += EIGHT) {
        const eight ahead = combined(w.ahead, order, v, i);
        store(r0, i, combined(w.sum, order, v, i) - ahead);
        store(guess.v, i, combined(w.guess, order + 1, v, i));
        store(to.v, i, ahead);
        store(to.q, i, combined(w.sum, order, q, i) + w.beta * ahead);
        store(guess.q, i, combined(w.guess, order + 1, q, i));
    }
}

/* v0 - v* + beta a */
static void right_side(struct adaptive_bdf *self) {
    const eight beta = self->w.beta;
    for (int i = 0; i < self->padded; i += EIGHT)
        store(self->r, i, load(self->r0, i) + beta * load(self->r, i));
}

/* From q* and v* to the end. */
static void add_change(struct adaptive_bdf *self) {
    const eight beta = self->w.beta;
    for (int i = 0; i < self->padded; i += EIGHT) {
        const eight change = load(self->change, i);
        store(self->to.q, i, load(self->to.q, i) + beta * change);
        store(self->to.v, i, load(self->to.v, i) + change);
    }
}

static void swap(struct state *a, struct state *b) {
    const struct state kept = *a;
    *a = *b;
    *b = kept;
}

/* Some lanes arrive: their states grow older by one, and the end is the last one. Where all do,
 * arrays change their places. */
static void arrive(struct adaptive_bdf *self, unsigned lanes) {
    struct state *const kept[] = {&self->to, &self->last, &self->old[0], &self->old[1],
                                  &self->old[2]};
    if (lanes == ~(~0u << self->lanes)) {
        for (int j = self->order + 1; j > 0; j--)
            swap(kept[j], kept[j - 1]);
        return;
    }
    const mask these = mask_of(self, lanes);
    for (int j = self->order + 1; j > 0; j--)
        for (int i = 0; i < self->padded; i += EIGHT) {
            store(kept[j]->q, i, chosen(these, load(kept[j - 1]->q, i), load(kept[j]->q, i)));
            store(kept[j]->v, i, chosen(these, load(kept[j - 1]->v, i), load(kept[j]->v, i)));
        }
}

/* --- errors --- */

/* Squares of end less guess, of the end and of the last state, summed by lane, each lane's in the
 * order of its unknowns whatever is beside it. */
struct squares {
    eight difference, end, last;
};

/* Eights overlap where there are fewer lanes, which are their first ones; the others mean nothing.
 */
static struct squares squares(const struct adaptive_bdf *self, const double *end,
                              const double *guess, const double *last) {
    struct squares s = {all(0), all(0), all(0)};
    for (int i = 0; i < self->system->size; i += self->lanes) {
        const eight x = load(end, i), y = load(last, i), difference = x - load(guess, i);
        s.difference += difference * difference;
        s.end += x * x;
        s.last += y * y;
    }
    return s;
}

static eight root(eight x) {
    for (int k = 0; k < EIGHT; k++)
        x[k] = sqrt(x[k]);
    return x;
}

/* The difference's size over what is allowed. What overflows gives NaN or infinity. */
static eight measured(const struct adaptive_bdf *self, const struct squares *s) {
    const double each = self->lanes / (double)self->system->size;
    eight larger = s->end;
    for (int k = 0; k < EIGHT; k++)
        larger[k] = s->last[k] > larger[k] ? s->last[k] : larger[k];
    return root(each * s->difference) / (self->rtol * root(each * larger) + self->atol);
}

/* --- steps --- */

/* The step that would have had the error that is aimed at, over the one that had `error`. */
static double wanted(double error, int points) {
    const double ratio = AIM / fmax(error, 1e-12);
    return points == 2 ? sqrt(ratio) : points == 3 ? cbrt(ratio) : sqrt(sqrt(ratio));
}

/* A lane's step was good: what is next. */
static void propose(struct adaptive_bdf *self, int k, double error) {
    const double used = self->used[k], now = used * wanted(error, self->points[k]);
    /* formulas of unequal steps stay stable where each is up to 2.41 or 1.53 times the last */
    const double growth = self->rejected[k] ? 1 : self->order == 2 ? 2 : 1.5;
    const double most = growth * (self->rejected[k] ? used : fmax(used, self->next[k]));
    const double before = self->age[k] ? self->wanted[k] : now;
    if (self->age[k] == 0)
        self->opening[k] = now;
    self->next[k] = fmin(most, sqrt(self->next[k] * sqrt(now * before)));
    self->wanted[k] = now;
    self->rejected[k] = 0;
    for (int j = ORDER_MOST - 1; j > 0; j--)
        put(self, &self->past[j], k, self->past[j - 1][k]);
    put(self, &self->past[0], k, used);
    self->age[k] += self->age[k] < self->order;
}

/* Between times that are nearer nothing moves (MODEL's clock has them as one), and what is tried at
 * less has failed. */
static double least_step(double t) {
    return 1e-12 * fmax(1, fabs(t));
}

/* The lane tries a shorter step next, if there is one. */
static int retry(struct adaptive_bdf *self, int k, double t, double ratio, int cause) {
    struct system *system = self->system;
    system->counters.rejected_steps += k < system->wisps;
    self->next[k] = self->wanted[k] = ratio * self->used[k];
    self->rejected[k] = 1;
    if (self->next[k] >= least_step(t))
        return 0;
    return cause ? -abs(cause)
                 : system_fail(system, -STEP_TOO_SMALL,
                               "bdf: stalled: from t = %.9g s no step of 1e-12 s or more meets the "
                               "tolerances",
                               t);
}

/* Whether the steps that lanes have tried are good; those that are arrive. */
static int judge(struct adaptive_bdf *self, unsigned lanes, double *t) {
    const struct squares in_q = squares(self, self->to.q, self->guess.q, self->last.q);
    const struct squares in_v = squares(self, self->to.v, self->guess.v, self->last.v);
    const eight of_q = measured(self, &in_q), of_v = measured(self, &in_v);
    unsigned arrived = 0;
    int code = 0;
    for (int k = 0; k < self->lanes && !code; k++) {
        const double error = self->w.error[k] * (of_q[k] > of_v[k] ? of_q[k] : of_v[k]);
        if (!(lanes >> k & 1))
            continue;
        if (!(of_q[k] < INFINITY && of_v[k] < INFINITY)) {
            const int cause = system_fail(self->system, NOT_FINITE,
                                          "bdf: a step from t = %.9g s is not finite", t[k]);
            code = retry(self, k, t[k], 0.25, cause);
        } else if (error > 1) {
            code = retry(self, k, t[k], fmin(0.9, fmax(0.2, wanted(error, self->points[k]))), 0);
        } else {
            propose(self, k, error);
            t[k] = self->end[k];
            arrived |= 1u << k;
        }
    }
    if (arrived)
        arrive(self, arrived);
    return code;
}

/* --- what lanes try --- */

/* A step of the formula. */
static int try_formula(struct adaptive_bdf *self, unsigned lanes, double *t) {
    struct system *system = self->system;
    static const double none[EIGHT] = {0};
    const struct part_equation e = {.alpha = (const double *)&self->w.beta,
                                    .beta = (const double *)&self->w.square,
                                    .gamma = none,
                                    .q = self->to.q,
                                    .r = self->r,
                                    .g = self->to.v};
    struct part_equation equation = e;
    weigh(self, lanes);
    if (self->order == 2)
        extrapolate(self, 2);
    else
        extrapolate(self, 3);
    int code = system_acceleration(system, self->end[0], self->to.q, self->to.v, self->r);
    if (code)
        return code;
    right_side(self);
    code =
        semi_implicit_solve(self->semi.matrix, self->end[0], self->to.v, &equation, self->change);
    if (code)
        return code;
    add_change(self);
    return judge(self, lanes, t);
}

/* A beginning. */
static int try_beginning(struct adaptive_bdf *self, unsigned lanes, double *t) {
    struct system *system = self->system;
    const struct state last = self->last, whole = self->guess, halves = self->to;
    double step[EIGHT], half[EIGHT], middle[EIGHT];
    for (int k = 0; k < self->lanes; k++) {
        step[k] = lanes >> k & 1 ? self->used[k] : 0;
        half[k] = step[k] / 2;
        middle[k] = t[k] + half[k];
        self->points[k] = 2;
        self->w.error[k] = 1;
    }
    int code = semi_implicit_euler_lanes(self->semi.matrix, self->end[0], step, last.q, last.v,
                                         whole.q, whole.v);
    system->times = middle;
    if (!code)
        code = semi_implicit_euler_lanes(self->semi.matrix, middle[0], half, last.q, last.v,
                                         halves.q, halves.v);
    system->times = self->end;
    if (!code)
        code = semi_implicit_euler_lanes(self->semi.matrix, self->end[0], half, halves.q, halves.v,
                                         halves.q, halves.v);
    if (code)
        return code;
    for (int i = 0; i < self->padded;
         i += EIGHT) { /* the end is off from the halves by their error */
        const eight q = load(halves.q, i), v = load(halves.v, i);
        store(halves.q, i, q + (q - load(whole.q, i)));
        store(halves.v, i, v + (v - load(whole.v, i)));
        store(whole.q, i, q);
        store(whole.v, i, v);
    }
    return judge(self, lanes, t);
}

typedef int attempt(struct adaptive_bdf *self, unsigned lanes, double *t);

/* Some lanes try something, the others wait where they are. Where the model fails, each tries it
 * alone, so that none is held back by another's failure. */
static int let_try(struct adaptive_bdf *self, attempt *try, unsigned lanes, double *t,
                   const double *ends) {
    struct system *system = self->system;
    if (!lanes)
        return 0;
    for (int k = 0; k < self->lanes; k++)
        self->end[k] = lanes >> k & 1 ? ends[k] : t[k];
    system->times = self->end;
    system->waiting = ~lanes;
    int code = try(self, lanes, t);
    system->times = NULL;
    system->waiting = 0;
    if (code <= 0)
        return code;
    if (!(lanes & (lanes - 1)))
        return retry(self, __builtin_ctz(lanes), t[__builtin_ctz(lanes)], 0.25, code);
    code = 0;
    for (int k = 0; k < self->lanes && !code; k++)
        if (lanes >> k & 1)
            code = let_try(self, try, 1u << k, t, ends);
    return code;
}

/* --- an accepted step --- */

/* Lanes that begin anew. What a wisp has shown of beginnings holds for it, but not for another:
 * lanes are given to those that others split into. */
static void begin_anew(struct adaptive_bdf *self) {
    struct system *system = self->system;
    for (int k = 0; k < self->lanes; k++) {
        if (!(self->begin >> k & 1))
            continue;
        const int wisp = system->numbers ? system->numbers[k] : 0;
        if (wisp == self->wisp[k] && self->started[k])
            system->counters.restarts += k < system->wisps;
        else
            self->opening[k] = 0;
        self->wisp[k] = wisp;
        self->started[k] = 1;
        self->age[k] = self->rejected[k] = 0;
        self->next[k] = self->opening[k];
        for (int j = 0; j < self->order; j++)
            for (int i = k; i < system->size; i += self->lanes) {
                self->old[j].q[i] = self->last.q[i];
                self->old[j].v[i] = self->last.v[i];
            }
    }
    self->begin = 0;
}

/* What a lane tries next, and the time that it ends at: of equal steps to the stop, which is met to
 * the bit, the longest that are not longer than was proposed. The first step that a wisp ever tries
 * is a thousandth of the way; if that is wrong, it is soon put right. */
static double choose_step(struct adaptive_bdf *self, int k, double t, double stop) {
    const double left = stop - t;
    if (!(self->next[k] > 0))
        self->next[k] = fmax(1e-3 * left, least_step(t));
    const double steps = ceil(left / self->next[k] - 1e-9);
    put(self, &self->used, k, steps > 1 ? left / steps : left);
    return steps > 1 ? t + self->used[k] : stop;
}

/* Each lane before the stop tries a step. */
static int try_all(struct adaptive_bdf *self, double *t, double stop) {
    unsigned beginners = 0, others = 0;
    double ends[EIGHT];
    for (int k = 0; k < self->lanes; k++) {
        if (stop - t[k] < least_step(stop))
            t[k] = stop;
        if (t[k] >= stop)
            continue;
        ends[k] = choose_step(self, k, t[k], stop);
        *(self->age[k] ? &others : &beginners) |= 1u << k;
    }
    const int code = let_try(self, try_beginning, beginners, t, ends);
    return code ? code : let_try(self, try_formula, others, t, ends);
}

static int advance(struct stepper *stepper, double *t, double stop, double *q, double *v) {
    struct adaptive_bdf *self = (struct adaptive_bdf *)stepper;
    const size_t bytes = (size_t)stepper->system->size * sizeof(double);
    double before[EIGHT];
    int code = 0, arrived = 0;
    memcpy(before, t, (size_t)self->lanes * sizeof *t);
    memcpy(self->last.q, q, bytes);
    memcpy(self->last.v, v, bytes);
    if (self->begin)
        begin_anew(self);
    while (!arrived && !code) {
        code = try_all(self, t, stop);
        for (int k = 0; k < self->lanes; k++)
            arrived |= t[k] > before[k];
    }
    if (arrived) {
        memcpy(q, self->last.q, bytes);
        memcpy(v, self->last.v, bytes);
    }
    return code;
}

static int reset(struct stepper *stepper, unsigned lanes) {
    struct adaptive_bdf *self = (struct adaptive_bdf *)stepper;
    self->begin |= stepper->system->force_parts ? lanes : ~0u;
    return 0;
}

const struct stepper_method bdf = {
    .name = "bdf",
    .summary = "semi-implicit BDF of order 2 or 3 with error control, a step for each wisp",
    .reference = "Hairer, Norsett & Wanner, Solving ODEs I, sections III.5 and III.7; Soderlind "
                 "2003, doi:10.1145/641876.641877",
    .order = 2,
    .capabilities = STEPPER_IMPLICIT | STEPPER_ADAPTIVE | STEPPER_MULTISTEP,
    .options = options,
    .lanes = LANES_MOST,
    .refuse = semi_implicit_refuse,
    .create = create,
    .advance = advance,
    .reset = reset,
    .caution = semi_implicit_stepper_caution,
    .free = semi_implicit_stepper_free,
};
