/* Semi-implicit BDF of order k: with the state at the last k times, the new one fulfils
 *
 *     v1 = v0 + beta a(t1, q1, v1),   q1 = q0 + beta v1,
 *
 * q0 and v0 being sums of the old ones. One Newton iteration from the extrapolated end: with v* the
 * velocities extrapolated through those k, and q* = q0 + beta v*,
 *
 *     (M - beta D - beta^2 K) dv = M (v0 - v* + beta a(t1, q*, v*)),   v1 = v* + dv.
 *
 * v* is off by h^k, and what is not in D and K makes h times that of it: the order is k whatever
 * they are. (Choi & Ko 2002 have this with all forces in K.) Steps may be unequal: sums and
 * extrapolation are those of the polynomial through the times as they are.
 *
 * A lane that begins anew has one state and order 1: linear Euler, for which q* = q0 = q, and the
 * pull beta K v* makes up for that. That costs order 2 nothing, for it is one step. Order 3 begins
 * with a step of order 2: two half steps of linear Euler, twice, less a whole one. Each lane has
 * its own number of old states, and what it does with them is its own. */
#include "semi_implicit.h"

static const struct option_spec options[] = {MATRIX_OPTION_SPEC, {0}};

enum { ORDER_MOST = 3 };

/* What a step does with the states, for each lane; the lanes of one weight side by side. */
struct weights {
    double *sum[ORDER_MOST], *ahead[ORDER_MOST]; /* of the last state, the one before, ... */
    double *beta, *square;                       /* beta^2 */
    double *drift, *pull; /* q* = q0 + drift v*; beta - drift, for the rest of q1 */
    double *gamma;        /* beta * pull */
};
enum { WEIGHTS = 2 * ORDER_MOST + 5 };

struct bdf {
    struct semi_implicit_stepper semi;
    struct system *system;
    int order;
    int lanes;
    unsigned begin;          /* lanes that were told to begin anew */
    int *age;                /* by lane: old states before the last one, order - 1 at most */
    double step[ORDER_MOST]; /* that led to the last state, the one before; the weights' own */
    int stale;               /* the weights are of other ages */
    int alike;               /* they are the same in all lanes */
    struct weights w;
    double *old_q[ORDER_MOST - 1], *old_v[ORDER_MOST - 1]; /* the one before the last, ... */
    double *q, *v;                                         /* q* and v* */
    double *r;                 /* the acceleration there, then right side */
    double *r0;                /* v0 - v* */
    double *change;            /* dv */
    double *half_q, *half_v;   /* of a beginning of order 2: half way, then half steps' end */
    double *whole_q, *whole_v; /* its end */
    IN_LINES double memory[];
};

static struct stepper *create(int order, const struct stepper_settings *settings,
                              struct system *system) {
    const size_t n = (size_t)system->size, lanes = (size_t)system->lanes;
    const size_t vectors = 5 + 2 * (size_t)(order - 1) + (order > 2 ? 4 : 0);
    const size_t numbers = vectors * n + WEIGHTS * lanes;
    const size_t bytes = sizeof(struct bdf) + numbers * sizeof(double) + lanes * sizeof(int);
    struct bdf *self = semi_implicit_stepper(settings, system, bytes);
    if (!self)
        return NULL;
    double *at = self->memory;
    double **const made[] = {&self->q, &self->v, &self->r, &self->r0, &self->change};
    double **const halves[] = {&self->half_q, &self->half_v, &self->whole_q, &self->whole_v};
    for (size_t i = 0; i < 5; i++, at += n)
        *made[i] = at;
    for (int j = 0; j < order - 1; j++, at += 2 * n)
        self->old_q[j] = at, self->old_v[j] = at + n;
    for (size_t i = 0; i < 4 && order > 2; i++, at += n)
        *halves[i] = at;
    for (int j = 0; j < ORDER_MOST; j++, at += 2 * lanes)
        self->w.sum[j] = at, self->w.ahead[j] = at + lanes;
    double **const rest[] = {&self->w.beta, &self->w.square, &self->w.drift, &self->w.pull,
                             &self->w.gamma};
    for (size_t i = 0; i < 5; i++, at += lanes)
        *rest[i] = at;
    self->age = (int *)at;
    self->order = order;
    self->lanes = system->lanes;
    self->stale = 1;
    self->system = system;
    return &self->semi.base;
}

static struct stepper *create_2(const struct stepper_settings *settings, struct system *system) {
    return create(2, settings, system);
}

static struct stepper *create_3(const struct stepper_settings *settings, struct system *system) {
    return create(3, settings, system);
}

/* A system without parts has one matrix for all its lanes, and they begin together. */
static int reset(struct stepper *stepper, unsigned lanes) {
    struct bdf *self = (struct bdf *)stepper;
    self->begin |= stepper->system->force_parts ? lanes : ~0u;
    return 0;
}

/* --- weights --- */

/* With the old states so long before the end, b_0 < b_1 < ..., and l_j the polynomials that are 1
 * at one of them: the derivative at the end is c y1 + sum_j l_j'(0) y_j, where c = sum 1 / b_j and
 * l_j'(0) = -ahead_j / b_j, ahead_j = prod_(i != j) b_i / (b_i - b_j), with which the old states
 * extrapolate to the end. */
static void weigh_lane(struct bdf *self, int lane, double h) {
    const int count = self->age[lane] + 1 < self->order ? self->age[lane] + 1 : self->order;
    double before[ORDER_MOST] = {h}, c = 0;
    for (int j = 1; j < count; j++)
        before[j] = before[j - 1] + self->step[j - 1];
    for (int j = 0; j < count; j++)
        c += 1 / before[j];
    for (int j = 0; j < ORDER_MOST; j++) {
        double ahead = j < count;
        for (int i = 0; i < count && j < count; i++)
            if (i != j)
                ahead *= before[i] / (before[i] - before[j]);
        self->w.ahead[j][lane] = ahead;
        self->w.sum[j][lane] = j < count ? ahead / (before[j] * c) : 0;
    }
    const double beta = 1 / c;
    self->w.beta[lane] = beta;
    self->w.square[lane] = beta * beta;
    self->w.drift[lane] = count > 1 ? beta : 0;
    self->w.pull[lane] = count > 1 ? 0 : beta;
    self->w.gamma[lane] = beta * self->w.pull[lane];
}

static void weigh(struct bdf *self, double h) {
    if (!self->stale && self->step[0] == h && self->step[1] == h)
        return;
    for (int k = 0; k < self->lanes; k++)
        weigh_lane(self, k, h);
    self->alike = 1;
    for (int k = 1; k < self->lanes; k++)
        self->alike &= self->age[k] == self->age[0];
    /* they hold for the next step too where nothing of this changes */
    self->stale = self->step[0] != h || self->step[1] != h;
    for (int k = 0; k < self->lanes; k++)
        self->stale |= self->age[k] < self->order - 1;
}

/* --- the pieces of a step --- */

/* Loops over the unknowns of a lane, or with its weights over all (stride 1) where the lanes' are
 * the same: with a stride that is a constant and few vectors in a loop they are vectorised. */
#define INLINED static inline __attribute__((always_inline))

/* v* and v0 - v*. */
INLINED void extrapolate_velocities(struct bdf *self, int order, int lane, int stride,
                                    const double *v) {
    const struct weights *w = &self->w;
    const int n = self->system->size;
    const double *v1 = self->old_v[0], *v2 = self->old_v[1];
    double *to_v = self->v, *to_r = self->r0;
    const double s0 = w->sum[0][lane], s1 = w->sum[1][lane], s2 = w->sum[2][lane];
    const double a0 = w->ahead[0][lane], a1 = w->ahead[1][lane], a2 = w->ahead[2][lane];
    for (int i = lane; i < n; i += stride) {
        double v0 = s0 * v[i] + s1 * v1[i];
        double ahead = a0 * v[i] + a1 * v1[i];
        if (order > 2) {
            v0 += s2 * v2[i];
            ahead += a2 * v2[i];
        }
        to_v[i] = ahead;
        to_r[i] = v0 - ahead;
    }
}

/* q*, after v*. */
INLINED void extrapolate_positions(struct bdf *self, int order, int lane, int stride,
                                   const double *q) {
    const struct weights *w = &self->w;
    const int n = self->system->size;
    const double *q1 = self->old_q[0], *q2 = self->old_q[1], *ahead = self->v;
    double *to_q = self->q;
    const double s0 = w->sum[0][lane], s1 = w->sum[1][lane], s2 = w->sum[2][lane];
    const double drift = w->drift[lane];
    for (int i = lane; i < n; i += stride) {
        double q0 = s0 * q[i] + s1 * q1[i];
        if (order > 2)
            q0 += s2 * q2[i];
        to_q[i] = q0 + drift * ahead[i];
    }
}

INLINED void extrapolate(struct bdf *self, int order, int lane, int stride, const double *q,
                         const double *v) {
    extrapolate_velocities(self, order, lane, stride, v);
    extrapolate_positions(self, order, lane, stride, q);
}

/* v0 - v* + beta a */
INLINED void right_side(struct bdf *self, int lane, int stride) {
    const int n = self->system->size;
    const double beta = self->w.beta[lane], *r0 = self->r0;
    double *r = self->r;
    for (int i = lane; i < n; i += stride)
        r[i] = r0[i] + beta * r[i];
}

/* The state becomes an old one, and the end the state: q1 = q* + beta dv, and where q* had no v* in
 * it, beta v* too. */
INLINED void arrive(struct bdf *self, int lane, int stride, double *q, double *v) {
    const int n = self->system->size;
    const double beta = self->w.beta[lane], pull = self->w.pull[lane];
    const double *change = self->change, *end_q = self->q, *end_v = self->v;
    double *last_q = self->old_q[0], *last_v = self->old_v[0];
    for (int i = lane; i < n; i += stride) {
        last_q[i] = q[i];
        q[i] = end_q[i] + beta * change[i] + pull * end_v[i];
    }
    for (int i = lane; i < n; i += stride) {
        last_v[i] = v[i];
        v[i] = end_v[i] + change[i];
    }
}

#define EACH_LANE(self, call_all, call_lane)        \
    do {                                            \
        if ((self)->alike)                          \
            call_all;                               \
        else                                        \
            for (int k = 0; k < (self)->lanes; k++) \
                call_lane;                          \
    } while (0)

/* dv, and all that it is added to. */
static int differentiate(struct bdf *self, double t, double h, const double *q, const double *v) {
    struct system *system = self->system;
    struct part_equation equation = {.alpha = self->w.beta,
                                     .beta = self->w.square,
                                     .gamma = self->w.gamma,
                                     .q = self->q,
                                     .r = self->r,
                                     .g = self->v};
    if (self->order == 2)
        EACH_LANE(self, extrapolate(self, 2, 0, 1, q, v),
                  extrapolate(self, 2, k, self->lanes, q, v));
    else
        EACH_LANE(self, extrapolate(self, 3, 0, 1, q, v),
                  extrapolate(self, 3, k, self->lanes, q, v));
    const int code = system_acceleration(system, t + h, self->q, self->v, self->r);
    if (code)
        return code;
    EACH_LANE(self, right_side(self, 0, 1), right_side(self, k, self->lanes));
    return semi_implicit_solve(self->semi.matrix, t + h, self->v, &equation, self->change);
}

/* --- a beginning of order 2 --- */

/* Lanes that have no old state. */
static unsigned beginners(const struct bdf *self) {
    unsigned lanes = 0;
    for (int k = 0; k < self->lanes; k++)
        lanes |= (unsigned)(self->age[k] == 0) << k;
    return lanes;
}

/* The ends of a whole step and of two halves of linear Euler. */
static int begin_twice(struct bdf *self, double t, double h, const double *q, const double *v) {
    int code = semi_implicit_euler(self->semi.matrix, t, h, q, v, self->whole_q, self->whole_v);
    if (!code)
        code = semi_implicit_euler(self->semi.matrix, t, h / 2, q, v, self->half_q, self->half_v);
    if (!code)
        code = semi_implicit_euler(self->semi.matrix, t + h / 2, h / 2, self->half_q, self->half_v,
                                   self->half_q, self->half_v);
    return code;
}

/* Whole and halves have errors e h^2 + ..., of which 2 (1/2) e - e is nothing. */
static void arrive_twice(struct bdf *self, int lane, double *q, double *v) {
    for (int i = lane; i < self->system->size; i += self->lanes) {
        self->old_q[0][i] = q[i];
        self->old_v[0][i] = v[i];
        q[i] = 2 * self->half_q[i] - self->whole_q[i];
        v[i] = 2 * self->half_v[i] - self->whole_v[i];
    }
}

/* --- a step --- */

/* Lanes that begin anew: whatever stood in their old states, the last one stands there now. */
static void begin_anew(struct bdf *self, const double *q, const double *v) {
    struct system *system = self->system;
    for (int k = 0; k < self->lanes; k++) {
        if (!(self->begin >> k & 1))
            continue;
        system->counters.restarts += k < system->wisps;
        self->age[k] = 0;
        for (int j = 0; j < self->order - 1; j++)
            for (int i = k; i < system->size; i += self->lanes) {
                self->old_q[j][i] = q[i];
                self->old_v[j][i] = v[i];
            }
    }
    self->begin = 0;
    self->stale = 1;
}

/* Old states grow older by one: the place of the oldest is free. */
static void grow_older(struct bdf *self, double h) {
    double *const q = self->old_q[self->order - 2], *const v = self->old_v[self->order - 2];
    for (int j = self->order - 2; j > 0; j--) {
        self->old_q[j] = self->old_q[j - 1];
        self->old_v[j] = self->old_v[j - 1];
    }
    self->old_q[0] = q;
    self->old_v[0] = v;
    for (int k = 0; k < self->lanes; k++)
        self->age[k] += self->age[k] < self->order - 1;
    self->step[1] = self->step[0];
    self->step[0] = h;
}

static int step(struct stepper *stepper, double t, double h, double *q, double *v) {
    struct bdf *self = (struct bdf *)stepper;
    struct system *system = stepper->system;
    const unsigned all = ~(~0u << self->lanes);
    int code = 0;
    if (self->begin)
        begin_anew(self, q, v);
    weigh(self, h);
    const unsigned fresh = self->stale && self->order > 2 ? beginners(self) : 0;
    system->waiting = fresh;
    if (fresh != all)
        code = differentiate(self, t, h, q, v);
    system->waiting = ~fresh;
    if (fresh && !code)
        code = begin_twice(self, t, h, q, v);
    system->waiting = 0;
    if (code)
        return code;
    grow_older(self, h);
    if (!fresh)
        EACH_LANE(self, arrive(self, 0, 1, q, v), arrive(self, k, self->lanes, q, v));
    for (int k = 0; k < self->lanes && fresh; k++)
        if (fresh >> k & 1)
            arrive_twice(self, k, q, v);
        else
            arrive(self, k, self->lanes, q, v);
    return 0;
}

const struct stepper_method bdf2 = {
    .name = "bdf2",
    .summary = "semi-implicit BDF of order 2: one evaluation and one solve a step",
    .reference =
        "Choi & Ko 2002, doi:10.1145/566654.566624; Hairer, Norsett & Wanner, Solving ODEs "
        "I, section III.5",
    .order = 2,
    .capabilities = STEPPER_IMPLICIT | STEPPER_MULTISTEP,
    .options = options,
    .usual_rate = 180, /* 1 mm on `swing` */
    .refuse = semi_implicit_refuse,
    .create = create_2,
    .step = step,
    .reset = reset,
    .caution = semi_implicit_stepper_caution,
    .free = semi_implicit_stepper_free,
};

const struct stepper_method bdf3 = {
    .name = "bdf3",
    .summary = "semi-implicit BDF of order 3: one evaluation and one solve a step",
    .reference = "Hairer, Norsett & Wanner, Solving ODEs I, section III.5; Choi & Ko 2002, "
                 "doi:10.1145/566654.566624",
    .order = 3,
    .capabilities = STEPPER_IMPLICIT | STEPPER_MULTISTEP,
    .options = options,
    .usual_rate = 300, /* 1 mm on `swing` */
    .refuse = semi_implicit_refuse,
    .create = create_3,
    .step = step,
    .reset = reset,
    .caution = semi_implicit_stepper_caution,
    .free = semi_implicit_stepper_free,
};
