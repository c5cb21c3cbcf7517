/* Hair as Rosenblum, Carlson & Tripp had it in 1991 (doi:10.1002/vis.4340020409; the thesis's
 * section 3.1): particles, springs whose "damping" is by elongation and so only makes them softer,
 * and hinges that push a node towards the line of its neighbours. A hinge keeps the linear
 * momentum; it turns the hair where the segments are unequal, and there is no energy behind it. */
#include "base/vector.h"
#include "chains.h"
#include "problems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/param.h>

/* Half bandwidth of the matrix: a node is felt two nodes away. */
enum { REACH = 2, BAND = 3 * REACH + 2, ROOM = 3 * BAND + 1 };

typedef double block[3][3];

struct rosenblum {
    struct chain chain;
    double spacing, spring, hinge; /* m; N/m; N */
    double *mass;                  /* by free node, kg */
    double (*x)[3];                /* by node: positions from the root, or shares of a product */
    double (*f)[3];                /* by node: forces, N */
    block (*k)[2 * REACH + 1];     /* by free node: df/dq of nodes from two before to two after */
    double *band;                  /* of M - alpha D - beta K, by columns: see factor */
    int *pivot;
    double memory[];
};

/* --- forces --- */

static void positions(struct rosenblum *r, const double *q) {
    const int n = r->chain.wisp->nodes;
    for (int k = 0; k < 3; k++) {
        r->x[0][k] = 0;
        r->x[1][k] = r->spacing * r->chain.wisp->direction[k];
    }
    memcpy(r->x[2], q, (size_t)(n - 2) * sizeof *r->x);
}

static void difference(const double a[3], const double b[3], double d[3]) {
    for (int k = 0; k < 3; k++)
        d[k] = a[k] - b[k];
}

/* A node between its neighbours: c from one to the other, e along it; b, from the first to the
 * node, is alpha e + height m. */
struct corner {
    int straight, folded; /* its height or its base is too small for a direction: no force */
    double e[3], m[3];
    double base, alpha, height; /* of c, of b along it and across; m */
    double angle;               /* by which the hair turns here, rad */
};

static struct corner corner_at(const struct rosenblum *r, int i) {
    const double least = 1e-12; /* m */
    struct corner corner = {0};
    double b[3];
    difference(r->x[i], r->x[i - 1], b);
    difference(r->x[i + 1], r->x[i - 1], corner.e);
    corner.base = vector_length(corner.e);
    corner.folded = corner.base < least;
    if (corner.folded)
        return corner;
    for (int k = 0; k < 3; k++)
        corner.e[k] /= corner.base;
    corner.alpha = vector_dot(b, corner.e);
    vector_add(b, -corner.alpha, corner.e);
    corner.height = vector_length(b);
    corner.straight = corner.height < least;
    if (corner.straight)
        return corner;
    for (int k = 0; k < 3; k++)
        corner.m[k] = b[k] / corner.height;
    corner.angle =
        atan2(corner.height, corner.alpha) + atan2(corner.height, corner.base - corner.alpha);
    return corner;
}

static void add_springs(struct rosenblum *r) {
    for (int i = 1; i < r->chain.wisp->nodes - 1; i++) {
        double d[3];
        difference(r->x[i + 1], r->x[i], d);
        const double length = vector_length(d);
        const double pull = r->spring * (length - r->spacing) / length;
        vector_add(r->f[i], pull, d);
        vector_add(r->f[i + 1], -pull, d);
    }
}

static void add_hinges(struct rosenblum *r) {
    for (int i = 1; i < r->chain.wisp->nodes - 1; i++) {
        const struct corner corner = corner_at(r, i);
        const double push = r->hinge * corner.angle;
        vector_add(r->f[i - 1], push, corner.m);
        vector_add(r->f[i], -2 * push, corner.m);
        vector_add(r->f[i + 1], push, corner.m);
    }
}

static int acceleration(void *ctx, double t, const double *q, const double *v, double *a) {
    (void)t;
    struct rosenblum *r = ctx;
    const int n = r->chain.wisp->nodes;
    const double drag = r->chain.wisp->drag_rate, *gravity = r->chain.around->gravity;
    positions(r, q);
    memset(r->f, 0, (size_t)n * sizeof *r->f);
    add_springs(r);
    add_hinges(r);
    for (int i = 0; i < 3 * (n - 2); i++)
        a[i] = r->f[2 + i / 3][i % 3] / r->mass[i / 3] + gravity[i % 3] - drag * v[i];
    return 0;
}

/* --- Jacobians --- */

/* The force on node i depends on node j by s times `d`. Nodes at rest have no part in it. */
static void add_block(struct rosenblum *r, int i, int j, double s, block d) {
    if (i < 2 || j < 2)
        return;
    double(*to)[3] = r->k[i - 2][j - i + REACH];
    for (int a = 0; a < 3; a++)
        vector_add(to[a], s, d[a]);
}

static void linearise_springs(struct rosenblum *r) {
    for (int i = 1; i < r->chain.wisp->nodes - 1; i++) {
        double d[3];
        block k;
        difference(r->x[i + 1], r->x[i], d);
        const double length = vector_length(d), slack = r->spacing / length;
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                k[a][b] =
                    r->spring * ((a == b) * (1 - slack) + slack * d[a] * d[b] / (length * length));
        for (int side = 0; side < 2; side++) {
            add_block(r, i + side, i + side, -1, k);
            add_block(r, i + side, i + 1 - side, 1, k);
        }
    }
}

/* The hinge's force F = kappa phi m by b and c. With n = e x m, dm = n n'(db - alpha/|c| dc)/height
 * - e (m'dc)/|c|, and phi grows as b turns away from c and as the second segment, c - b, turns the
 * other way. A straight hair has the limit of this, in which every direction across e is an m. */
static void hinge_derivatives(const struct corner *corner, double hinge, block by_b, block by_c) {
    const double beta = corner->base - corner->alpha, share = corner->alpha / corner->base;
    const double first = corner->height * corner->height + corner->alpha * corner->alpha;
    const double second = corner->height * corner->height + beta * beta;
    double n[3];
    vector_cross(corner->e, corner->m, n);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            const double e = corner->e[b], m = corner->m[b];
            const double turn_b = (corner->alpha * m - corner->height * e) / first,
                         turn_c = -(corner->height * e + beta * m) / second;
            double across = corner->angle / corner->height * n[a] * n[b];
            if (corner->straight)
                across = (1 / corner->alpha + 1 / beta) * ((a == b) - corner->e[a] * e);
            by_b[a][b] = hinge * across;
            by_c[a][b] = -hinge * share * across;
            if (corner->straight)
                continue;
            by_b[a][b] += hinge * corner->m[a] * (turn_b - turn_c);
            by_c[a][b] +=
                hinge * (corner->m[a] * turn_c - corner->angle / corner->base * corner->e[a] * m);
        }
}

static void linearise_hinges(struct rosenblum *r) {
    for (int i = 1; i < r->chain.wisp->nodes - 1; i++) {
        const struct corner corner = corner_at(r, i);
        const int flat = corner.straight && !(corner.alpha > 0 && corner.alpha < corner.base);
        block by_b, by_c;
        if (corner.folded || flat)
            continue;
        hinge_derivatives(&corner, r->hinge, by_b, by_c);
        for (int side = -1; side <= 1; side++) {
            const double share = side == 0 ? -2 : 1;
            add_block(r, i + side, i - 1, -share, by_b);
            add_block(r, i + side, i - 1, -share, by_c);
            add_block(r, i + side, i, share, by_b);
            add_block(r, i + side, i + 1, share, by_c);
        }
    }
}

static int linearise(void *ctx, enum jacobian kind, double t, const double *q, const double *v) {
    (void)kind, (void)t, (void)v;
    struct rosenblum *r = ctx;
    positions(r, q);
    memset(r->k, 0, (size_t)(r->chain.wisp->nodes - 2) * sizeof *r->k);
    linearise_springs(r);
    linearise_hinges(r);
    return 0;
}

/* One entry of m M + d D + k K. */
static double entry(const struct rosenblum *r, double m, double d, double k, int i, int j) {
    const int apart = j / 3 - i / 3;
    if (abs(apart) > REACH)
        return 0;
    const double mass = r->mass[i / 3], drag = r->chain.wisp->drag_rate;
    return (i == j ? (m - d * drag) * mass : 0) + k * r->k[i / 3][apart + REACH][i % 3][j % 3];
}

static void product(void *ctx, double m, double d, double k, const double *x, double *y) {
    const struct rosenblum *r = ctx;
    const int n = r->chain.system->size;
    for (int i = 0; i < n; i++) {
        y[i] = 0;
        for (int j = MAX(0, i - BAND); j < MIN(n, i + BAND + 1); j++)
            y[i] += entry(r, m, d, k, i, j) * x[j];
    }
}

static void assemble(void *ctx, double alpha, double beta, double *values) {
    const struct rosenblum *r = ctx;
    const struct sparse_matrix *pattern = &r->chain.pattern;
    for (int j = 0; j < pattern->size; j++)
        for (int at = pattern->column_start[j]; at < pattern->column_start[j + 1]; at++)
            values[at] = entry(r, 1, -alpha, -beta, pattern->row[at], j);
}

/* --- the direct solver: a band with row exchanges (Golub & Van Loan, section 4.3.5) --- */

/* Entry (i, j), for |i - j| <= BAND, and above the diagonal twice as far. */
static double *at(const struct rosenblum *r, int i, int j) {
    return &r->band[(size_t)j * ROOM + (size_t)(2 * BAND + i - j)];
}

static void exchange(double *a, double *b) {
    const double kept = *a;
    *a = *b;
    *b = kept;
}

static int factor(void *ctx, double alpha, double beta) {
    struct rosenblum *r = ctx;
    const int n = r->chain.system->size;
    memset(r->band, 0, (size_t)n * ROOM * sizeof *r->band);
    for (int j = 0; j < n; j++)
        for (int i = MAX(0, j - BAND); i < MIN(n, j + BAND + 1); i++)
            *at(r, i, j) = entry(r, 1, -alpha, -beta, i, j);
    for (int j = 0; j < n; j++) {
        const int last = MIN(n - 1, j + BAND), end = MIN(n, j + 2 * BAND + 1);
        int largest = j;
        for (int i = j + 1; i <= last; i++)
            if (fabs(*at(r, i, j)) > fabs(*at(r, largest, j)))
                largest = i;
        r->pivot[j] = largest;
        if (*at(r, largest, j) == 0)
            return system_fail(r->chain.system, SOLVER_STALLED, "the matrix is singular");
        for (int c = j; c < end && largest != j; c++)
            exchange(at(r, j, c), at(r, largest, c));
        for (int i = j + 1; i <= last; i++) {
            *at(r, i, j) /= *at(r, j, j);
            for (int c = j + 1; c < end; c++)
                *at(r, i, c) -= *at(r, i, j) * *at(r, j, c);
        }
    }
    return 0;
}

static void solve(void *ctx, const double *b, double *x) {
    const struct rosenblum *r = ctx;
    const int n = r->chain.system->size;
    memcpy(x, b, (size_t)n * sizeof *x);
    for (int j = 0; j < n; j++) {
        exchange(&x[j], &x[r->pivot[j]]);
        for (int i = j + 1; i < MIN(n, j + BAND + 1); i++)
            x[i] -= *at(r, i, j) * x[j];
    }
    for (int j = n - 1; j >= 0; j--) {
        x[j] /= *at(r, j, j);
        for (int i = MAX(0, j - 2 * BAND); i < j; i++)
            x[i] -= *at(r, i, j) * x[j];
    }
}

static const struct system_ops ops = {.acceleration = acceleration,
                                      .linearise = linearise,
                                      .product = product,
                                      .factor = factor,
                                      .solve = solve,
                                      .assemble = assemble};

/* --- a wisp --- */

static struct chain *rosenblum_create(const struct scene *scene, const struct wisp *wisp) {
    (void)scene;
    const size_t n = (size_t)wisp->nodes, free_nodes = n - 2, block_numbers = (2 * REACH + 1) * 9;
    const size_t numbers = free_nodes * (1 + block_numbers + 3 * ROOM) + 2 * 3 * n;
    struct rosenblum *r =
        calloc(1, sizeof *r + numbers * sizeof(double) + 3 * free_nodes * sizeof(int));
    if (!r)
        return NULL;
    r->spacing = wisp_spacing(wisp);
    r->spring = wisp->stretch_stiffness / r->spacing;
    r->hinge = wisp->bending_stiffness / (r->spacing * r->spacing);
    r->mass = r->memory;
    r->x = (double(*)[3])(r->mass + free_nodes);
    r->f = r->x + n;
    r->k = (block(*)[2 * REACH + 1])(r->f + n);
    r->band = (double *)(r->k + free_nodes);
    r->pivot = (int *)(r->band + 3 * free_nodes * ROOM);
    for (int i = 2; i < wisp->nodes; i++)
        r->mass[i - 2] = wisp_node_mass(wisp, i);
    return &r->chain;
}

static void start(const struct chain *chain, double *q, double *v) {
    const struct wisp *wisp = chain->wisp;
    for (int i = 0; i < 3 * (wisp->nodes - 2); i++) {
        q[i] = (2 + i / 3) * wisp_spacing(wisp) * wisp->direction[i % 3];
        v[i] = 0;
    }
}

static void points(const struct chain *chain, int derivative, const double *q, const double *v,
                   const double *a) {
    const struct wisp *wisp = chain->wisp;
    const double *x = derivative == 0 ? q : derivative == 1 ? v : a;
    for (int i = 0; i < wisp->nodes; i++)
        for (int k = 0; k < 3; k++) {
            const double rest = i * wisp_spacing(wisp) * wisp->direction[k] * (derivative == 0);
            chain->point[i][k] =
                (i < 2 ? rest : x[3 * (i - 2) + k]) + (derivative == 0 ? wisp->root[k] : 0);
        }
}

static void take(const struct chain *chain, const double *rows, int stride, double *q, double *v) {
    for (int i = 0; i < 3 * (chain->wisp->nodes - 2); i++) {
        const double *row = rows + (2 + i / 3) * stride;
        q[i] = row[i % 3] - chain->wisp->root[i % 3];
        v[i] = row[3 + i % 3];
    }
}

static const struct chain_law law = {
    .problem = &rosenblum_problem,
    .ops = &ops,
    .name = "Rosenblum's hair",
    .matrix = MATRIX_AVAILABLE | MATRIX_FACTORABLE,
    .matrix_note = "its hinges have no energy; use --linear direct",
    .node_unknowns = 3,
    .unknowns = (const char *const[]){"x", "y", "z"},
    .unit = "m",
    .reach = REACH,
    .create = rosenblum_create,
    .start = start,
    .points = points,
    .take = take,
};

/* --- the problem --- */

static struct model *create(const struct scene *scene, int treatment, int lanes) {
    (void)treatment, (void)lanes;
    return chains_create(scene, &law);
}

static double strain(const struct model *model, int i, double t, double limit, int *wisp) {
    (void)t;
    struct rosenblum *r = model->parts[i].system.ctx;
    double most = 0;
    positions(r, model->parts[i].q);
    for (int k = 1; k < r->chain.wisp->nodes - 1; k++) {
        double d[3];
        difference(r->x[k + 1], r->x[k], d);
        most = fmax(most, fabs(vector_length(d) / r->spacing - 1));
    }
    *wisp = i;
    return most > limit ? most : 0;
}

/* As of the thesis's wisps. */
static double strain_limit(const struct scene *scene) {
    return wisp_problem.strain_limit(scene);
}

static int terms(const struct scene *scene, const char **names, int most) {
    const char *const all[] = {"gravity", scene->wisps[0].drag_rate > 0 ? "air" : NULL, "stretch",
                               "bending (Rosenblum's hinges)"};
    int count = 0;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i] && count < most)
            names[count++] = all[i];
    return count;
}

const struct problem rosenblum_problem = {
    .name = "rosenblum",
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
    .strain = strain,
    .strain_limit = strain_limit,
};
