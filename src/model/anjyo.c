/* Hair as Anjyo, Usami & Kurihara had it in 1992 (doi:10.1145/142920.134021; the thesis's section
 * 3.3): segments that keep their length, each by two angles of its own,
 *
 *     s = l (sin theta sin phi, cos theta, sin theta cos phi),
 *
 * which the force on it turns as if nothing hung on its end: no force goes from the tip to the
 * root. The source's recurrence, theta <- 2 theta - theta_before + dt^2 theta'', is symplectic
 * Euler. */
#include "base/vector.h"
#include "chains.h"
#include "problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Unknowns of segment i = 2 ... n-1 are theta and phi at 2 (i - 2). */
struct anjyo {
    struct chain chain;
    double spacing; /* m */
    double mass;    /* of a segment, kg */
    double *c;      /* by free segment: 1/(kg m^2) */
    double (*k)[3]; /* by free segment: by theta, by phi, and by the other one's angle */
    double (*inverse)[3];
    double memory[];
};

/* The unit vectors of an orientation: along the segment, and along which theta and phi move it (the
 * latter by sin theta). */
struct axes {
    double s[3], e_theta[3], e_phi[3];
    double sin_theta, cos_theta, radial[3]; /* along which e_phi moves, backwards */
};

static struct axes axes_of(double theta, double phi) {
    const double st = sin(theta), ct = cos(theta), sp = sin(phi), cp = cos(phi);
    return (struct axes){
        {st * sp, ct, st * cp}, {ct * sp, -st, ct * cp}, {cp, 0, -sp}, st, ct, {sp, 0, cp}};
}

/* m (g + gamma w) */
static void force_at(const struct anjyo *self, double t, double f[3]) {
    const struct surroundings *around = self->chain.around;
    wind_velocity(&around->wind, t, f);
    for (int k = 0; k < 3; k++)
        f[k] = self->mass * (around->gravity[k] + self->chain.wisp->drag_rate * f[k]);
}

static int acceleration(void *ctx, double t, const double *q, const double *v, double *a) {
    (void)v;
    const struct anjyo *self = ctx;
    const double half = self->spacing / 2;
    double f[3];
    force_at(self, t, f);
    for (int i = 0; i < self->chain.wisp->nodes - 2; i++) {
        const struct axes axes = axes_of(q[2 * i], q[2 * i + 1]);
        a[2 * i] = self->c[i] * half * vector_dot(f, axes.e_theta);
        a[2 * i + 1] = self->c[i] * half * axes.sin_theta * vector_dot(f, axes.e_phi);
    }
    return 0;
}

/* They are those of c (l/2) f.s/l: symmetric. */
static int linearise(void *ctx, enum jacobian kind, double t, const double *q, const double *v) {
    (void)kind, (void)v;
    struct anjyo *self = ctx;
    double f[3];
    force_at(self, t, f);
    for (int i = 0; i < self->chain.wisp->nodes - 2; i++) {
        const struct axes axes = axes_of(q[2 * i], q[2 * i + 1]);
        const double strength = self->c[i] * self->spacing / 2;
        self->k[i][0] = -strength * vector_dot(f, axes.s);
        self->k[i][1] = -strength * axes.sin_theta * vector_dot(f, axes.radial);
        self->k[i][2] = strength * axes.cos_theta * vector_dot(f, axes.e_phi);
    }
    return 0;
}

static void product(void *ctx, double m, double d, double k, const double *x, double *y) {
    (void)d;
    const struct anjyo *self = ctx;
    for (int i = 0; i < self->chain.wisp->nodes - 2; i++)
        for (int a = 0; a < 2; a++)
            y[2 * i + a] =
                (m + k * self->k[i][a]) * x[2 * i + a] + k * self->k[i][2] * x[2 * i + 1 - a];
}

static void assemble(void *ctx, double alpha, double beta, double *values) {
    (void)alpha;
    const struct anjyo *self = ctx;
    for (int i = 0; i < self->chain.wisp->nodes - 2; i++) {
        const double *k = self->k[i], other = -beta * k[2];
        memcpy(values + 4 * i, (double[]){1 - beta * k[0], other, other, 1 - beta * k[1]},
               4 * sizeof *values);
    }
}

static int factor(void *ctx, double alpha, double beta) {
    (void)alpha;
    struct anjyo *self = ctx;
    for (int i = 0; i < self->chain.wisp->nodes - 2; i++) {
        const double a = 1 - beta * self->k[i][0], b = 1 - beta * self->k[i][1],
                     c = -beta * self->k[i][2], determinant = a * b - c * c;
        if (determinant == 0)
            return system_fail(self->chain.system, SOLVER_STALLED, "the 2x2 matrix is singular");
        self->inverse[i][0] = b / determinant;
        self->inverse[i][1] = a / determinant;
        self->inverse[i][2] = -c / determinant;
    }
    return 0;
}

static void solve(void *ctx, const double *b, double *x) {
    const struct anjyo *self = ctx;
    for (int i = 0; i < self->chain.wisp->nodes - 2; i++)
        for (int a = 0; a < 2; a++)
            x[2 * i + a] =
                self->inverse[i][a] * b[2 * i + a] + self->inverse[i][2] * b[2 * i + 1 - a];
}

static const struct system_ops ops = {.acceleration = acceleration,
                                      .linearise = linearise,
                                      .product = product,
                                      .factor = factor,
                                      .solve = solve,
                                      .assemble = assemble};

/* --- a wisp --- */

static struct chain *anjyo_create(const struct scene *scene, const struct wisp *wisp) {
    const size_t count = (size_t)wisp->nodes - 2;
    struct anjyo *self = calloc(1, sizeof *self + count * (1 + 3 + 3) * sizeof(double));
    if (!self)
        return NULL;
    self->spacing = wisp_spacing(wisp);
    self->mass = wisp->hair_count * wisp->hair_density * self->spacing;
    self->c = self->memory;
    self->k = (double(*)[3])(self->c + count);
    self->inverse = self->k + count;
    for (int i = 2; i < wisp->nodes; i++)
        self->c[i - 2] = scene->anjyo_constant * i; /* as the source's, but for its time step */
    return &self->chain;
}

static void angles_of(const double s[3], double q[2]) {
    q[0] = atan2(hypot(s[0], s[2]), s[1]);
    q[1] = atan2(s[0], s[2]);
}

static void start(const struct chain *chain, double *q, double *v) {
    for (int i = 0; i < chain->wisp->nodes - 2; i++) {
        angles_of(chain->wisp->direction, q + 2 * i);
        v[2 * i] = v[2 * i + 1] = 0;
    }
}

/* Where a segment goes, how fast it turns, and how that changes: the second derivative of s has
 * what the angles' own gives, and what comes of the axes' turning. */
static void segment(const double *q, const double *v, const double *a, int derivative,
                    double x[3]) {
    const struct axes axes = axes_of(q[0], q[1]);
    const double along_phi = derivative == 1
                                 ? axes.sin_theta * v[1]
                                 : axes.sin_theta * a[1] + 2 * axes.cos_theta * v[0] * v[1];
    memset(x, 0, 3 * sizeof *x);
    if (derivative == 0) {
        vector_add(x, 1, axes.s);
        return;
    }
    vector_add(x, derivative == 1 ? v[0] : a[0], axes.e_theta);
    vector_add(x, along_phi, axes.e_phi);
    if (derivative == 2) {
        vector_add(x, -v[0] * v[0], axes.s);
        vector_add(x, -axes.sin_theta * v[1] * v[1], axes.radial);
    }
}

static void points(const struct chain *chain, int derivative, const double *q, const double *v,
                   const double *a) {
    static const double none[2] = {0, 0};
    const struct wisp *wisp = chain->wisp;
    double(*point)[3] = chain->point;
    const double spacing = wisp_spacing(wisp);
    for (int k = 0; k < 3; k++) {
        point[0][k] = derivative == 0 ? wisp->root[k] : 0;
        point[1][k] = point[0][k] + (derivative == 0 ? spacing * wisp->direction[k] : 0);
    }
    for (int i = 2; i < wisp->nodes; i++) {
        double x[3];
        segment(q + 2 * (i - 2), v + 2 * (i - 2), a ? a + 2 * (i - 2) : none, derivative, x);
        memcpy(point[i], point[i - 1], sizeof point[i]);
        vector_add(point[i], spacing, x);
    }
}

static void take(const struct chain *chain, const double *rows, int stride, double *q, double *v) {
    const double spacing = wisp_spacing(chain->wisp);
    for (int i = 2; i < chain->wisp->nodes; i++) {
        const double *row = rows + i * stride, *before = row - stride;
        double s[3], slip[3];
        for (int k = 0; k < 3; k++) {
            s[k] = row[k] - before[k];
            slip[k] = row[3 + k] - before[3 + k];
        }
        double *angle = q + 2 * (i - 2), *rate = v + 2 * (i - 2);
        angles_of(s, angle);
        const struct axes axes = axes_of(angle[0], angle[1]);
        rate[0] = vector_dot(slip, axes.e_theta) / spacing;
        rate[1] = vector_dot(slip, axes.e_phi) / (spacing * axes.sin_theta);
    }
}

static const struct chain_law law = {
    .problem = &anjyo_problem,
    .ops = &ops,
    .name = "Anjyo's hair",
    .matrix = MATRIX_AVAILABLE | MATRIX_FACTORABLE | MATRIX_SYMMETRIC,
    .node_unknowns = 2,
    .unknowns = (const char *const[]){"theta", "phi"},
    .unit = "rad",
    .reach = 0,
    .create = anjyo_create,
    .start = start,
    .points = points,
    .take = take,
};

/* --- the problem --- */

static struct model *create(const struct scene *scene, int treatment, int lanes) {
    (void)treatment, (void)lanes;
    return chains_create(scene, &law);
}

static int terms(const struct scene *scene, const char **names, int most) {
    const int windy = scene->around.wind.kind != WIND_NONE && scene->wisps[0].drag_rate > 0;
    names[0] = "gravity";
    if (windy && most > 1)
        names[1] = "wind";
    return windy && most > 1 ? 2 : 1;
}

const struct problem anjyo_problem = {
    .name = "anjyo",
    .treatments = chain_treatments,
    .default_treatment = first_treatment,
    .default_linear = direct_solver,
    .create = create,
    .free = chains_free,
    .sample = chains_sample,
    .restore = chains_restore,
    .sample_accelerations = chains_sample_accelerations,
    .unknown = chains_unknown,
    .terms = terms,
};
