/* The Jacobians of the kernel: against differences of the twin's accelerations, against each other,
 * and what the solvers make of them. */
#include "base/vector.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "wisp/body.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE_MOST = 10 * (3 + 3 * 8) }; /* of the dense matrices here */

typedef double matrix[SIZE_MOST][SIZE_MOST];

static const struct shape {
    int nodes, samples;
} shapes[] = {{3, 0}, {3, 4}, {4, 3}, {5, 5}, {6, 8}, {7, 0}, {8, 4}, {12, 0}, {12, 4}, {4, 16}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* m M + d D + k K of one lane, by products with unit vectors in all lanes. */
static void dense(struct lab_part *part, double m, double d, double k, int lane, matrix a) {
    static double x[LAB_LANES * LAB_SIZE], y[LAB_LANES * LAB_SIZE];
    memset(x, 0, sizeof x);
    for (int j = 0; j < part->size; j++) {
        for (int l = 0; l < part->lanes; l++)
            x[j * part->lanes + l] = 1;
        system_product(&part->system, m, d, k, x, y);
        for (int i = 0; i < part->size; i++)
            a[i][j] = y[i * part->lanes + lane];
        for (int l = 0; l < part->lanes; l++)
            x[j * part->lanes + l] = 0;
    }
}

/* M of the table in kernel/matrix.h, from the twin's numbers. */
static void mass_matrix(struct wisp_twin *twin, const double *q, matrix m) {
    static double u[LAB_NODES][3], v[LAB_NODES][3], w[LAB_NODES][3];
    const int n = wisp_twin_size(twin), per_sample = twin->treatment == WISP_PENALTY ? 3 : 1;
    const int coupled = twin->treatment == WISP_GENERALISED;
    wisp_twin_frames(twin, q, u, v, w);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            m[i][j] = 0;
    for (int i = 2; i < twin->nodes; i++) {
        const int at = (i - 2) * twin->unknowns;
        for (int k = 0; k < 3; k++)
            m[at + k][at + k] = twin->mass[i] + coupled * twin->samples * twin->sample_mass[i];
        for (int j = 0; j < twin->samples; j++)
            for (int c = 0; c < per_sample; c++) {
                const int s = at + 3 + j * per_sample + c;
                m[s][s] = twin->sample_mass[i];
                for (int k = 0; k < 3 && coupled; k++)
                    m[s][at + k] = m[at + k][s] =
                        twin->sample_mass[i] *
                        (twin->cosine[j] * u[i][k] + twin->sine[j] * v[i][k]);
            }
    }
}

/* Columns of the derivative of the acceleration with the frames held, by central differences of
 * fourth order. */
static void differences(struct wisp_twin *twin, const double *q, const double *v, int of_velocity,
                        double step, matrix j) {
    static const double weight[4] = {1. / 12, -8. / 12, 8. / 12, -1. / 12}, at[4] = {-2, -1, 1, 2};
    static double u[LAB_NODES][3], normal[LAB_NODES][3], w[LAB_NODES][3];
    static double x[LAB_SIZE], a[LAB_SIZE];
    const int n = wisp_twin_size(twin);
    wisp_twin_frames(twin, q, u, normal, w);
    memcpy(x, of_velocity ? v : q, (size_t)n * sizeof *x);
    for (int k = 0; k < n; k++) {
        const double centre = x[k];
        for (int i = 0; i < n; i++)
            j[i][k] = 0;
        for (int p = 0; p < 4; p++) {
            x[k] = centre + at[p] * step;
            wisp_twin_acceleration_frozen(twin, 0.3, of_velocity ? q : x, of_velocity ? x : v,
                                          (const double(*)[3])u, (const double(*)[3])normal,
                                          (const double(*)[3])w, a);
            for (int i = 0; i < n; i++)
                j[i][k] += weight[p] * a[i] / step;
        }
        x[k] = centre;
    }
}

/* |K - M J| in each row against the largest entry of |M| |J| there: what the entries are summed
 * from. */
static double worst_row(int n, matrix k, matrix m, matrix j) {
    double worst = 0;
    for (int i = 0; i < n; i++) {
        double most = 0, error = 0;
        for (int c = 0; c < n; c++) {
            double sum = 0, absolute = 0;
            for (int l = 0; l < n; l++) {
                sum += m[i][l] * j[l][c];
                absolute += fabs(m[i][l] * j[l][c]);
            }
            most = fmax(most, absolute);
            error = fmax(error, fabs(k[i][c] - sum));
        }
        worst = fmax(worst, error > 0 ? error / most : 0);
    }
    return worst;
}

enum { PUSHERS = 2 };

struct setting {
    struct lab_part part;
    struct wisp wisps[LAB_LANES];
    struct surroundings around;
    struct body bodies[PUSHERS];
    enum wisp_treatment treatment;
    double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE];
    double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE];
};

/* Whether bodies push in the settings to come, and in how many points they did. */
static int pushing;
static long pushed_points;

/* Whether a point's acceleration by a body is smooth around it: it is not near the surface, the
 * depth from which the damping is full or the centre, and no change of its velocity by 2 m/s makes
 * a normal part positive that is not, or the reverse. */
static int is_smooth(const struct body *body, const double p[3], const double v[3], int *inside) {
    double square = 0, z[3], u[3];
    for (int k = 0; k < 3; k++) {
        const double x = p[k] - (body->centre[k] + 0.3 * body->velocity[k]);
        square += x * x / (body->radii[k] * body->radii[k]);
        z[k] = x / (body->radii[k] * body->radii[k]);
        u[k] = v[k] - body->velocity[k];
    }
    const double sigma = sqrt(square),
                 least = fmin(body->radii[0], fmin(body->radii[1], body->radii[2]));
    const double length = vector_length(z), omega = 2 * M_PI * body->frequency;
    const double damping = 2 * body->damping_ratio * omega * fmin(1, (1 - sigma) / 0.05);
    const double normal = omega * omega * least * least * (1 - sigma) * length / sigma -
                          damping * vector_dot(u, z) / length;
    if (sigma > 1.002)
        return 1;
    *inside += 1;
    return sigma < 0.998 && fabs(sigma - 0.95) > 2e-3 && sigma > 0.1 &&
           fabs(normal) > 2.1 * damping;
}

/* Of all points of a lane, how many a body holds; -1 where it is not smooth. */
static int points_in(const struct setting *s, int lane, const struct body *body) {
    static struct wisp_twin twin;
    static double u[LAB_NODES][3], n[LAB_NODES][3], w[LAB_NODES][3];
    const struct wisp *wisp = &s->wisps[lane];
    const int unknowns = wisp_node_unknowns(wisp, s->treatment);
    int inside = 0;
    wisp_twin_init(&twin, wisp, &s->around, s->treatment);
    wisp_twin_frames(&twin, s->q[lane], u, n, w);
    for (int i = 2; i < wisp->nodes; i++) {
        const double *q = s->q[lane] + (i - 2) * unknowns, *v = s->v[lane] + (i - 2) * unknowns;
        if (!is_smooth(body, q, v, &inside))
            return -1;
        for (int j = 0; j < wisp->samples; j++) {
            double e[3], ev[3];
            for (int k = 0; k < 3; k++) {
                const double a = twin.cosine[j] * u[i][k] + twin.sine[j] * n[i][k];
                const int particle = s->treatment == WISP_PENALTY;
                e[k] = particle ? q[3 + 3 * j + k] : q[k] + q[3 + j] * a;
                ev[k] = particle ? v[3 + 3 * j + k] : v[k] + v[3 + j] * a;
            }
            if (!is_smooth(body, e, ev, &inside))
                return -1;
        }
    }
    return inside;
}

/* A body that holds something, with rounding everywhere of what it does; one that holds nothing
 * where none is found. */
static void make_pusher(const struct setting *s, int lanes, struct body *body, unsigned *seed) {
    for (int tries = 0; tries < 300; tries++) {
        const int unknowns = wisp_node_unknowns(s->wisps, s->treatment);
        const int node = (int)lab_between(seed, 2, s->wisps->nodes);
        const double *p = s->q[tries % lanes] + (node - 2) * unknowns;
        int held = 0, smooth = 1;
        *body = (struct body){.response = RESPONSE_PENALTY,
                              .friction = lab_between(seed, 0, 60),
                              .frequency = lab_between(seed, 30, 100),
                              .damping_ratio = lab_between(seed, 0, 0.05)};
        for (int k = 0; k < 3; k++) {
            body->radii[k] = lab_between(seed, 0.02, 0.15);
            body->velocity[k] = lab_between(seed, -0.3, 0.3);
            body->centre[k] = p[k] + lab_between(seed, -0.5, 0.5) * body->radii[k];
        }
        for (int k = 0; k < lanes && smooth; k++) {
            const int inside = points_in(s, k, body);
            smooth = inside >= 0;
            held += inside;
        }
        if (smooth && held > 0) {
            pushed_points += held;
            return;
        }
    }
    body->centre[0] = 1e3;
}

static void make_setting(struct setting *s, int lanes, const struct shape *shape, enum bending law,
                         enum wisp_treatment treatment, enum lab_state kind, unsigned *seed) {
    s->treatment = treatment;
    s->around = lab_surroundings(WIND_STEADY, seed);
    for (int k = 0; k < lanes; k++)
        s->wisps[k] = lab_wisp(shape->nodes, shape->samples, law, seed);
    for (int k = 0; k < lanes; k++)
        lab_state(&s->wisps[k], treatment, kind, 0, seed, s->q[k], s->v[k]);
    for (int b = 0; b < PUSHERS && pushing; b++)
        make_pusher(s, lanes, &s->bodies[b], seed);
    s->around.pushing = s->bodies;
    s->around.pushing_count = pushing ? PUSHERS : 0;
    lab_part_make(&s->part, lanes, s->wisps, lanes, &s->around, treatment);
    for (int k = 0; k < lanes; k++) {
        lab_place(&s->part, k, s->q[k], s->Q);
        lab_scatter(&s->part, k, s->v[k], s->V);
    }
}

static void linearise(struct setting *s, enum jacobian kind) {
    cr_assert_eq(system_linearise(&s->part.system, kind, 0.3, s->Q, s->V), 0, "%s",
                 s->part.system.reason);
}

static struct setting s; /* too large for the stack */
static matrix M, K, J, A, B;

/* Step h = 3e-5 of a spacing: rounding makes 1e-16/h of what a stretch spring gives to K; hinges
 * that are nearly straight or folded, here to about 0.01 rad, 1/sin of that, and their fifth
 * derivative (h/sin)^4. Second-order differences would leave (h/sin)^2. Velocities enter linearly:
 * a step of 1 m/s has no error but rounding, of forces that are 1e3 of what changes. */
static const double tolerance_q = 1e-7, tolerance_v = 1e-11;

static void check_exact(int lanes, const struct shape *shape, enum bending law,
                        enum wisp_treatment treatment, enum lab_state kind, unsigned *seed,
                        double worst[2]) {
    static struct wisp_twin twin;
    make_setting(&s, lanes, shape, law, treatment, kind, seed);
    const int n = s.part.size;
    linearise(&s, JACOBIAN_EXACT);
    for (int lane = 0; lane < lanes; lane++) {
        wisp_twin_init(&twin, &s.wisps[lane], &s.around, treatment);
        dense(&s.part, 1, 0, 0, lane, A);
        mass_matrix(&twin, s.q[lane], M);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                /* a few roundings of one product, and the frames' along the wisp */
                cr_assert(fabs(M[i][j] - A[i][j]) <= 1e-13 * M[i][i], "M[%d][%d] is %g, not %g", i,
                          j, A[i][j], M[i][j]);
        for (int of_velocity = 0; of_velocity < 2; of_velocity++) {
            const double step = of_velocity ? 1 : 3e-5 * twin.spacing;
            dense(&s.part, 0, of_velocity, !of_velocity, lane, K);
            differences(&twin, s.q[lane], s.v[lane], of_velocity, step, J);
            const double error = worst_row(n, K, M, J);
            worst[of_velocity] = fmax(worst[of_velocity], error);
            cr_assert(error <= (of_velocity ? tolerance_v : tolerance_q),
                      "%s, bending %s, %d nodes, %d samples, state %d: d/d%c differs by %.1e",
                      treatment_names[treatment], law_names[law], shape->nodes, shape->samples,
                      (int)kind, of_velocity ? 'v' : 'q', error);
        }
    }
}

#define EACH_CASE(treatment, law, shape, kind)                       \
    for (int treatment = 0; treatment < TREATMENTS; treatment++)     \
        for (int law = 0; law < LAWS; law++)                         \
            for (int shape = 0; shape < SHAPES; shape++)             \
                for (int kind = STATE_RANDOM; kind < STATES; kind++) \
                    if (shapes[shape].nodes * (shapes[shape].samples + 1) <= 70)

Test(wisp_jacobian, exact_is_the_derivative_with_frames_held) {
    unsigned seed = 11;
    double worst[2] = {0, 0};
    EACH_CASE(treatment, law, shape, kind) {
        pushing = (shape + kind) % 2;
        for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
            check_exact(lanes, &shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                        (enum lab_state)kind, &seed, worst);
    }
    cr_assert_gt(pushed_points, 500, "bodies pushed only %ld points", pushed_points);
    cr_log_info("largest difference: %.2g in q, %.2g in v; %ld points pushed", worst[0], worst[1],
                pushed_points);
}

/* --- assembled --- */

/* Products and assembly write the same sums in different orders: below ten roundings of the
 * largest entry in a row (of the terms in the sum). */
static void compare_assembled(const struct shape *shape, enum bending law,
                              enum wisp_treatment treatment, enum jacobian kind) {
    static double values[SIZE_MOST * SIZE_MOST];
    static const double alphas[] = {0, 1e-3, 1, 0}, betas[] = {0, 1e-6, 1, 1};
    const struct sparse_matrix *p = s.part.pattern;
    const int n = s.part.size;
    cr_assert_eq(p->size, n, "pattern of %d unknowns", p->size);
    for (int c = 0; c < 4; c++) {
        system_assemble(&s.part.system, alphas[c], betas[c], values);
        dense(&s.part, 1, -alphas[c], -betas[c], 0, A);
        memset(B, 0, sizeof B);
        for (int j = 0; j < n; j++)
            for (int at = p->column_start[j]; at < p->column_start[j + 1]; at++) {
                cr_assert(at == p->column_start[j] || p->row[at] > p->row[at - 1],
                          "rows of column %d do not ascend", j);
                B[p->row[at]][j] = values[at];
            }
        for (int i = 0; i < n; i++) {
            double most = 0;
            for (int j = 0; j < n; j++)
                most = fmax(most, fabs(A[i][j]));
            for (int j = 0; j < n; j++)
                cr_assert(fabs(A[i][j] - B[i][j]) <= 1e-14 * most,
                          "%s, bending %s, %d nodes, %d samples, %s: entry %d, %d is %.17g, by "
                          "product %.17g",
                          treatment_names[treatment], law_names[law], shape->nodes, shape->samples,
                          jacobian_choices[kind], i, j, B[i][j], A[i][j]);
        }
    }
}

Test(wisp_jacobian, assembled_is_what_products_give) {
    unsigned seed = 12;
    EACH_CASE(treatment, law, shape, kind) {
        pushing = (shape + kind) % 2;
        make_setting(&s, 1, &shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                     (enum lab_state)kind, &seed);
        for (int jacobian = 0; jacobian < JACOBIAN_COUNT; jacobian++) {
            linearise(&s, (enum jacobian)jacobian);
            compare_assembled(&shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                              (enum jacobian)jacobian);
        }
    }
}

/* --- symmetric, definite --- */

/* From the mass matrix alone through the step sizes of a run to hardly any mass at all. */
static const double spd_alphas[] = {0, 1e-4, 1e-2, 1, 0, 10},
                    spd_betas[] = {0, 1e-8, 1e-4, 1, 1, 0};
enum { SPD_CASES = 6 };

/* The least eigenvalue over the largest, of a matrix scaled to a unit diagonal. */
static double least_eigenvalue(int n, matrix a, double *most) {
    gsl_matrix *m = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_vector *values = gsl_vector_alloc((size_t)n);
    gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc((size_t)n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            gsl_matrix_set(m, (size_t)i, (size_t)j, a[i][j] / sqrt(a[i][i] * a[j][j]));
    gsl_eigen_symm(m, values, work);
    double least, largest;
    gsl_vector_minmax(values, &least, &largest);
    gsl_eigen_symm_free(work);
    gsl_vector_free(values);
    gsl_matrix_free(m);
    *most = largest;
    return least;
}

/* Symmetric: each pair of entries from the same products of the same numbers, added in another
 * order: 1e-14 of the diagonals. Definite: eigenvalues have an error of n roundings of the largest
 * one, and the least here (of the scaled matrix, in which a mass counts at least 1e-9 of what the
 * stiffest spring adds) are far above that. */
static void check_spd(int n, matrix a, const char *what) {
    double most;
    for (int i = 0; i < n; i++) {
        cr_assert(a[i][i] > 0, "%s: diagonal entry %d is %g", what, i, a[i][i]);
        for (int j = 0; j < i; j++)
            cr_assert(fabs(a[i][j] - a[j][i]) <= 1e-14 * sqrt(a[i][i] * a[j][j]),
                      "%s: entries %d, %d are %.17g and %.17g", what, i, j, a[i][j], a[j][i]);
    }
    const double least = least_eigenvalue(n, a, &most);
    cr_assert(least > n * 2.3e-16 * most, "%s: eigenvalues from %.2e to %.2e", what, least, most);
}

/* Rows and columns of the nodes after the samples are eliminated; a sample's own block is diagonal
 * in `projection` and `generalised`. */
static int eliminate_samples(const struct wisp *wisp, enum wisp_treatment treatment, matrix a,
                             matrix nodes) {
    const int unknowns = wisp_node_unknowns(wisp, treatment), f = wisp->nodes - 2;
    for (int i = 0; i < 3 * f; i++)
        for (int j = 0; j < 3 * f; j++) {
            const int row = i / 3 * unknowns + i % 3, column = j / 3 * unknowns + j % 3;
            nodes[i][j] = a[row][column];
            for (int k = 3; k < unknowns && i / 3 == j / 3; k++) {
                const int sample = i / 3 * unknowns + k;
                nodes[i][j] -= a[row][sample] * a[sample][column] / a[sample][sample];
            }
        }
    return 3 * f;
}

Test(wisp_jacobian, spd_is_symmetric_and_positive_definite) {
    unsigned seed = 13;
    EACH_CASE(treatment, law, shape, kind) {
        const int eliminated = treatment == WISP_PROJECTION && shapes[shape].samples > 0;
        if (shapes[shape].samples > 5)
            continue; /* eigenvalues take long, and nothing is new */
        pushing = (shape + kind) % 2;
        make_setting(&s, 4, &shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                     (enum lab_state)kind, &seed);
        linearise(&s, JACOBIAN_SPD);
        for (int c = 0; c < SPD_CASES; c++) {
            const int lane = c % 4;
            int n = s.part.size;
            dense(&s.part, 1, -spd_alphas[c], -spd_betas[c], lane, A);
            if (eliminated)
                n = eliminate_samples(&s.wisps[lane], (enum wisp_treatment)treatment, A, B);
            const char *const what =
                printed("%s, bending %s, %d nodes, %d samples, state %d, %g, %g",
                        treatment_names[treatment], law_names[law], shapes[shape].nodes,
                        shapes[shape].samples, kind, spd_alphas[c], spd_betas[c]);
            check_spd(n, eliminated ? B : A, what);
        }
    }
}

/* What the model says of its matrices is so: `projection` with samples is not symmetric, and is
 * not declared to be; everything else is declared. */
Test(wisp_jacobian, matrices_are_what_they_are_declared_to_be) {
    unsigned seed = 14;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int samples = 0; samples <= 4; samples += 4) {
            const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
            const struct wisp wisp = lab_wisp(6, samples, BENDING_SKIP, &seed);
            struct scene *scene = lab_scene(&wisp, 1, &around);
            struct model *model = lab_model(scene, treatment, 1);
            const struct system *system = &model->parts[0].system;
            const int one_sided = treatment == WISP_PROJECTION && samples > 0;
            const unsigned both = MATRIX_SYMMETRIC | MATRIX_DEFINITE;
            cr_assert_eq(system->matrix[JACOBIAN_SPD] & both, one_sided ? 0 : both);
            cr_assert_eq(system->matrix[JACOBIAN_EXACT] & both, 0);
            cr_assert_eq(system->matrix_note != NULL, one_sided);
        }
    const struct shape shape = {6, 4};
    double most = 0;
    make_setting(&s, 1, &shape, BENDING_SKIP, WISP_PROJECTION, STATE_RANDOM, &seed);
    linearise(&s, JACOBIAN_SPD);
    dense(&s.part, 1, -1e-2, -1e-4, 0, A);
    for (int i = 0; i < s.part.size; i++)
        for (int j = 0; j < i; j++)
            most = fmax(most, fabs(A[i][j] - A[j][i]) / sqrt(A[i][i] * A[j][j]));
    cr_assert_gt(most, 0.01, "the matrix of projection is symmetric after all: %g", most);
}

/* --- solutions --- */

/* x with A x = b by GSL, and |A^-1| (|A| |x| + |b|): what an error of one part of A and b, entry
 * by entry, makes of x (Skeel 1979), free of the matrix's condition. */
static void solve_densely(int n, matrix a, const double *b, double *x, double *scale) {
    gsl_matrix *m = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_matrix *inverse = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_permutation *order = gsl_permutation_alloc((size_t)n);
    int sign;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            gsl_matrix_set(m, (size_t)i, (size_t)j, a[i][j]);
    gsl_linalg_LU_decomp(m, order, &sign);
    gsl_linalg_LU_invert(m, order, inverse);
    gsl_vector_const_view right = gsl_vector_const_view_array(b, (size_t)n);
    gsl_vector_view solution = gsl_vector_view_array(x, (size_t)n);
    gsl_linalg_LU_solve(m, order, &right.vector, &solution.vector);
    for (int i = 0; i < n; i++) {
        scale[i] = 0;
        for (int k = 0; k < n; k++) {
            double row = fabs(b[k]);
            for (int j = 0; j < n; j++)
                row += fabs(a[k][j] * x[j]);
            scale[i] += fabs(gsl_matrix_get(inverse, (size_t)i, (size_t)k)) * row;
        }
    }
    gsl_permutation_free(order);
    gsl_matrix_free(inverse);
    gsl_matrix_free(m);
}

/* Elimination without pivots of a symmetric definite matrix is backward stable, and the samples'
 * elimination before it is that of a diagonal: errors of n roundings of the scale above, 1e-13 for
 * these sizes; 1e-12 leaves ten. Conjugate gradients are told to stop at 1e-14 of |b|. */
static const double solver_tolerance = 1e-12;

static int linear_fits(const struct linear_method *method, const struct wisp *wisp,
                       enum wisp_treatment treatment) {
    const int one_sided = treatment == WISP_PROJECTION && wisp->samples > 0;
    return !one_sided || !(method->needs & MATRIX_SYMMETRIC);
}

static void check_solver(const struct linear_method *method, double alpha, double beta,
                         const double *b, const double *expected, const double *scale,
                         const char *what) {
    static double x[LAB_SIZE];
    static const char *const tight[] = {"cg.tolerance=1e-14"};
    const struct options options = {tight, 1};
    const int iterates = options_find(method->options, "cg.tolerance", strlen("cg.tolerance")) >= 0;
    struct linear_solver *solver = linear_create(method, &s.part.system, &options);
    cr_assert(solver, "no memory for %s", method->name);
    cr_assert_eq(linear_factor(solver, alpha, beta), 0, "%s, %s: %s", what, method->name,
                 s.part.system.reason);
    cr_assert_eq(linear_solve(solver, b, x), 0, "%s, %s: %s", what, method->name,
                 s.part.system.reason);
    double most = 0;
    for (int i = 0; i < s.part.size; i++)
        most = fmax(most, scale[i]);
    for (int i = 0; i < s.part.size; i++) {
        const double of = iterates ? most : scale[i]; /* of |b| as a whole */
        cr_assert(fabs(x[i] - expected[i]) <= solver_tolerance * of,
                  "%s, %s: x[%d] is %.17g, densely %.17g, scale %.1e", what, method->name, i, x[i],
                  expected[i], of);
    }
    method->free(solver);
}

Test(wisp_jacobian, all_linear_solvers_solve_as_dense_elimination_does) {
    static const double alphas[] = {0, 1e-4, 1e-2}, betas[] = {0, 1e-8, 1e-4};
    static double b[LAB_SIZE], x[LAB_SIZE], scale[LAB_SIZE];
    unsigned seed = 15;
    int solved = 0;
    EACH_CASE(treatment, law, shape, kind) {
        if (shapes[shape].samples > 5)
            continue;
        pushing = (shape + kind) % 2;
        make_setting(&s, 1, &shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                     (enum lab_state)kind, &seed);
        linearise(&s, JACOBIAN_SPD);
        for (int c = 0; c < 3; c++) {
            const char *const what =
                printed("%s, bending %s, %d nodes, %d samples, state %d, alpha %g",
                        treatment_names[treatment], law_names[law], shapes[shape].nodes,
                        shapes[shape].samples, kind, alphas[c]);
            for (int i = 0; i < s.part.size; i++)
                b[i] = lab_between(&seed, -1, 1);
            dense(&s.part, 1, -alphas[c], -betas[c], 0, A);
            solve_densely(s.part.size, A, b, x, scale);
            for (int m = 0; linear_methods[m]; m++)
                if (linear_fits(linear_methods[m], s.wisps, (enum wisp_treatment)treatment)) {
                    check_solver(linear_methods[m], alphas[c], betas[c], b, x, scale, what);
                    solved++;
                }
        }
    }
    cr_assert_gt(solved, 500, "only %d systems", solved);
}

/* The direct solver of a part's lanes, each with its own wisp. */
Test(wisp_jacobian, direct_solves_each_lane) {
    static double b[LAB_LANES][LAB_SIZE], x[LAB_SIZE], got[LAB_SIZE], scale[LAB_SIZE];
    static double right[LAB_LANES * LAB_SIZE], left[LAB_LANES * LAB_SIZE];
    unsigned seed = 16;
    EACH_CASE(treatment, law, shape, kind) {
        if (shapes[shape].samples > 5 || shapes[shape].nodes > 8)
            continue;
        pushing = (shape + kind) % 2;
        const int lanes = seed % 2 ? 8 : 4;
        make_setting(&s, lanes, &shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                     (enum lab_state)kind, &seed);
        linearise(&s, JACOBIAN_SPD);
        cr_assert_eq(system_factor(&s.part.system, 1e-3, 1e-6), 0, "%s", s.part.system.reason);
        for (int lane = 0; lane < lanes; lane++) {
            for (int i = 0; i < s.part.size; i++)
                b[lane][i] = lab_between(&seed, -1, 1);
            lab_scatter(&s.part, lane, b[lane], right);
        }
        system_solve(&s.part.system, right, left);
        for (int lane = 0; lane < lanes; lane++) {
            dense(&s.part, 1, -1e-3, -1e-6, lane, A);
            solve_densely(s.part.size, A, b[lane], x, scale);
            lab_gather(&s.part, lane, left, got);
            for (int i = 0; i < s.part.size; i++)
                cr_assert(fabs(got[i] - x[i]) <= solver_tolerance * scale[i],
                          "%s: lane %d, x[%d] is %.17g, densely %.17g", treatment_names[treatment],
                          lane, i, got[i], x[i]);
        }
    }
}

/* --- what is prepared holds --- */

/* What products, the assembled matrix and the direct solver make of the last linearisation, the
 * last of them also with the factors that were there before. */
struct prepared {
    double product[LAB_LANES * LAB_SIZE], solution[LAB_LANES * LAB_SIZE];
    double kept[LAB_LANES * LAB_SIZE], assembled[SIZE_MOST * SIZE_MOST];
};

static void use_prepared(struct prepared *made) {
    struct system *system = &s.part.system;
    memset(made, 0, sizeof *made);
    system_solve(system, s.V, made->kept);
    system_product(system, 1, -1e-3, -1e-6, s.V, made->product);
    if (s.part.lanes == 1)
        system_assemble(system, 1e-3, 1e-6, made->assembled);
    cr_assert_eq(system_factor(system, 1e-3, 1e-6), 0, "%s", system->reason);
    system_solve(system, s.V, made->solution);
}

/* All that can be asked of a part between a linearisation and its use, at another state. */
static void ask_other_things(unsigned *seed) {
    static double q[LAB_LANES * LAB_SIZE], v[LAB_LANES * LAB_SIZE], a[LAB_LANES * LAB_SIZE];
    static double x[LAB_LANES * LAB_SIZE];
    struct system *system = &s.part.system;
    struct energies energies;
    struct powers powers;
    for (int k = 0; k < s.part.lanes; k++) {
        lab_state(&s.wisps[k], s.treatment, STATE_RANDOM, 0, seed, s.q[k], s.v[k]);
        lab_scatter(&s.part, k, s.q[k], q);
        lab_scatter(&s.part, k, s.v[k], v);
    }
    cr_assert_eq(system_acceleration(system, 0.4, q, v, a), 0, "%s", system->reason);
    for (int part = 0; part < FORCE_PARTS; part++) {
        const double h[LAB_LANES] = {1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3};
        const struct part_equation e = {(enum force_part)part, h, h, h, q, v, a};
        cr_assert_eq(system_solve_part(system, &e, x), 0, "%s", system->reason);
    }
    cr_assert_eq(system->ops->energies(system->ctx, 0.5, q, v, &energies), 0, "%s", system->reason);
    cr_assert_eq(system->ops->powers(system->ctx, 0.6, q, v, &powers), 0, "%s", system->reason);
    kernel_of(s.part.lanes)->clamp(system->ctx, q, v);
}

/* To the bit, whatever is asked in between; two-stage methods live on it (tests/ros2.c). */
Test(wisp_jacobian, what_was_linearised_holds_until_the_next_time) {
    static struct prepared before, after;
    unsigned seed = 18;
    EACH_CASE(treatment, law, shape, kind)
    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
        pushing = (shape + kind) % 2;
        make_setting(&s, lanes, &shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                     (enum lab_state)kind, &seed);
        linearise(&s, JACOBIAN_SPD);
        cr_assert_eq(system_factor(&s.part.system, 1e-3, 1e-6), 0, "%s", s.part.system.reason);
        use_prepared(&before);
        ask_other_things(&seed);
        use_prepared(&after);
        cr_assert(memcmp(&before, &after, sizeof before) == 0,
                  "%s, bending %s, %d nodes, %d samples, %d lanes: other bits after an "
                  "evaluation",
                  treatment_names[treatment], law_names[law], shapes[shape].nodes,
                  shapes[shape].samples, lanes);
    }
}

/* With a negative beta springs push apart what they hold together: the factorisation says so, also
 * where it is one lane of several, whichever. */
Test(wisp_jacobian, a_matrix_that_is_not_definite_is_refused) {
    const struct shape shape = {6, 4};
    unsigned seed = 17;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
            for (int stiff = -1; stiff < lanes; stiff++) {
                make_setting(&s, lanes, &shape, BENDING_SKIP, (enum wisp_treatment)treatment,
                             STATE_RANDOM, &seed);
                for (int k = 0; k < lanes; k++) /* at 1e-9 s^2: 1e-5 and 1e4 of a mass of 1e-4 kg */
                    s.wisps[k].stretch_stiffness = k == stiff ? 1e8 : 0.1;
                lab_part_make(&s.part, lanes, s.wisps, lanes, &s.around,
                              (enum wisp_treatment)treatment);
                linearise(&s, JACOBIAN_SPD);
                struct system *system = &s.part.system;
                system->reason[0] = '\0';
                const int code = system_factor(system, 0, -1e-9);
                if (stiff < 0)
                    cr_assert_eq(code, 0, "%s: %s", treatment_names[treatment], system->reason);
                else
                    cr_assert(abs(code) == SOLVER_STALLED && strstr(system->reason, "definite"),
                              "%s, lane %d of %d: code %d, '%s'", treatment_names[treatment], stiff,
                              lanes, code, system->reason);
            }
}

/* --- a part of the forces --- */

/* x = A^-1 b with A destroyed, in more digits than those that are tested. */
static void solve_finely(int n, long double a[SIZE_MOST][SIZE_MOST], long double *b) {
    for (int c = 0; c < n; c++) {
        int pivot = c;
        for (int i = c + 1; i < n; i++)
            pivot = fabsl(a[i][c]) > fabsl(a[pivot][c]) ? i : pivot;
        for (int j = 0; j < n; j++) {
            const long double kept = a[c][j];
            a[c][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        const long double kept = b[c];
        b[c] = b[pivot];
        b[pivot] = kept;
        for (int i = c + 1; i < n; i++) {
            const long double factor = a[i][c] / a[c][c];
            for (int j = c; j < n && factor != 0; j++)
                a[i][j] -= factor * a[c][j];
            b[i] -= factor * b[c];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++)
            b[i] -= a[i][j] * b[j];
        b[i] /= a[i][i];
    }
}

/* Position of a node of a wisp at rest in the state q, in long double. */
static void place_of(const struct wisp *wisp, const double *q, int unknowns, int i,
                     long double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = i < 2 ? wisp->root[k] + i * wisp_spacing(wisp) * (long double)wisp->direction[k]
                     : q[(i - 2) * unknowns + k];
}

struct step_of_part {
    enum force_part part;
    double alpha, beta, gamma;
};

/* A += along nn' + across (1 - nn') on the nodes a and b of a spring, b += gamma K g likewise. */
static void add_spring(const struct wisp *wisp, const double *q, const double *g, int unknowns,
                       int a, int b, double rest, double k, double c, const struct step_of_part *by,
                       int axial, int transverse, long double A_[SIZE_MOST][SIZE_MOST],
                       long double *right) {
    long double pa[3], pb[3], n[3], length = 0, rate = 0;
    place_of(wisp, q, unknowns, a, pa);
    place_of(wisp, q, unknowns, b, pb);
    for (int i = 0; i < 3; i++)
        length += (pb[i] - pa[i]) * (pb[i] - pa[i]);
    length = sqrtl(length);
    const long double side = transverse * k * fmaxl(0, 1 - rest / length);
    const long double along = by->beta * (axial * k) + by->alpha * (axial * c);
    const int row[2] = {(a - 2) * unknowns, (b - 2) * unknowns};
    long double d[3];
    for (int i = 0; i < 3; i++) {
        n[i] = (pb[i] - pa[i]) / length;
        d[i] = g[row[1] + i] - (a < 2 ? 0 : g[row[0] + i]);
        rate += n[i] * d[i];
    }
    for (int x = 0; x < 2; x++)
        for (int i = 0; i < 3 && (x || a >= 2); i++) {
            const int sign_x = x ? 1 : -1;
            right[row[x] + i] -=
                sign_x * by->gamma * (axial * k * n[i] * rate + side * (d[i] - n[i] * rate));
            for (int y = 0; y < 2; y++)
                for (int j = 0; j < 3 && (y || a >= 2); j++)
                    A_[row[x] + i][row[y] + j] +=
                        sign_x * (y ? 1 : -1) *
                        (along * n[i] * n[j] + by->beta * side * ((i == j) - n[i] * n[j]));
        }
}

/* M - alpha D - beta K and M r + gamma K g of a lane, for the parts with springs along their lines
 * from the springs' unit vectors; with all forces from the products of JACOBIAN_SPD, less the
 * springs' transverse stiffness. */
static void part_matrix(int lane, const struct step_of_part *by, const double *r, const double *g,
                        long double a[SIZE_MOST][SIZE_MOST], long double *right) {
    const struct wisp *w = &s.wisps[lane];
    const int n = s.part.size, unknowns = s.part.node_unknowns, full = by->part >= FORCES_FULL;
    const double l = wisp_spacing(w), k = wisp_stretch_constant(w), b = wisp_bending_constant(w);
    dense(&s.part, 1, 0, 0, lane, M);
    dense(&s.part, 1, full ? -by->alpha : 0, full ? -by->beta : 0, lane, A);
    dense(&s.part, 0, 0, full ? by->gamma : 0, lane, B);
    for (int i = 0; i < n; i++) {
        right[i] = 0;
        for (int j = 0; j < n; j++) {
            a[i][j] = A[i][j];
            right[i] += (long double)M[i][j] * r[j] + (long double)B[i][j] * g[j];
        }
    }
    const struct step_of_part less = {by->part, 0, -by->beta, -by->gamma};
    for (int i = 2; i < w->nodes; i++) {
        const int skips = w->bending == BENDING_SKIP;
        if (!full) {
            add_spring(w, s.q[lane], g, unknowns, i - 1, i, l, k, w->stretch_time * k, by, 1, 0, a,
                       right);
            if (skips && by->part == FORCES_AXIAL)
                add_spring(w, s.q[lane], g, unknowns, i - 2, i, 2 * l, b, w->bending_time * b, by,
                           1, 0, a, right);
        } else if (by->part == FORCES_FULL) {
            add_spring(w, s.q[lane], g, unknowns, i - 1, i, l, k, 0, &less, 0, 1, a, right);
            if (skips)
                add_spring(w, s.q[lane], g, unknowns, i - 2, i, 2 * l, b, 0, &less, 0, 1, a, right);
        }
    }
}

/* One lane's solution against a dense one. Tensions are as exact as they are well-conditioned, and
 * what they do to x is exact whatever the stiffness: 1e-12 of the largest number, in more digits.
 * With all forces elimination is backward stable, see above. */
static void check_part_solution(int lane, const struct step_of_part *by, const double *r,
                                const double *g, const double *x, const char *what) {
    static long double a[SIZE_MOST][SIZE_MOST], fine[SIZE_MOST];
    static double right[SIZE_MOST], expected[SIZE_MOST], scale[SIZE_MOST];
    const int n = s.part.size;
    double most = 0;
    part_matrix(lane, by, r, g, a, fine);
    if (by->part >= FORCES_FULL) {
        for (int i = 0; i < n; i++) {
            right[i] = (double)fine[i];
            for (int j = 0; j < n; j++)
                A[i][j] = (double)a[i][j];
        }
        solve_densely(n, A, right, expected, scale);
    } else {
        solve_finely(n, a, fine);
        for (int i = 0; i < n; i++) {
            expected[i] = (double)fine[i];
            most = fmax(most, fmax(fabs(r[i]), fabs(expected[i])));
        }
        for (int i = 0; i < n; i++)
            scale[i] = most;
    }
    for (int i = 0; i < n; i++)
        cr_assert(fabs(x[i] - expected[i]) <= solver_tolerance * scale[i],
                  "%s, part %d, lane %d, step %g: x[%d] is %.17g, not %.17g", what, (int)by->part,
                  lane, by->alpha, i, x[i], expected[i]);
}

/* With a step of its own for each lane: from one that springs hardly feel to one for which they are
 * rods. */
static void check_part(enum force_part part, int lanes, const char *what, unsigned *seed) {
    static const double steps[] = {1e-6, 1e-3, 0.03, 1e-4};
    static double r[LAB_LANES][LAB_SIZE], g[LAB_LANES][LAB_SIZE], x[LAB_SIZE];
    static double R[LAB_LANES * LAB_SIZE], G[LAB_LANES * LAB_SIZE], X[LAB_LANES * LAB_SIZE];
    double alpha[LAB_LANES], beta[LAB_LANES], gamma[LAB_LANES];
    const int first = (int)lab_between(seed, 0, 4);
    for (int k = 0; k < lanes; k++) {
        const double h = steps[(first + k) % 4];
        alpha[k] = h, beta[k] = h * h * 0.7, gamma[k] = (int)part % 2 == k % 2 ? 0 : h * h;
        for (int i = 0; i < s.part.size; i++) {
            r[k][i] = lab_between(seed, -1, 1);
            g[k][i] = lab_between(seed, -1, 1);
        }
        lab_scatter(&s.part, k, r[k], R);
        lab_scatter(&s.part, k, g[k], G);
    }
    struct system *system = &s.part.system;
    const struct part_equation e = {part, alpha, beta, gamma, s.Q, R, G};
    cr_assert_eq(system_acceleration(system, 0.3, s.Q, s.V, X), 0, "%s", system->reason);
    cr_assert_eq(system_solve_part(system, &e, X), 0, "%s: %s", what, system->reason);
    linearise(&s, JACOBIAN_SPD); /* for M, and what is dense here */
    for (int k = 0; k < lanes; k++) {
        const struct step_of_part by = {part, alpha[k], beta[k], gamma[k]};
        lab_gather(&s.part, k, X, x);
        check_part_solution(k, &by, r[k], g[k], x, what);
    }
}

static void check_parts(const struct shape *shape, enum bending law, enum wisp_treatment treatment,
                        enum lab_state kind, int lanes, unsigned *seed) {
    const char *const what = printed("%s, bending %s, %d nodes, %d samples, state %d, %d lanes",
                                     treatment_names[treatment], law_names[law], shape->nodes,
                                     shape->samples, (int)kind, lanes);
    make_setting(&s, lanes, shape, law, treatment, kind, seed);
    for (int part = 0; part < FORCE_PARTS; part++)
        check_part((enum force_part)part, lanes, what, seed);
}

Test(wisp_jacobian, parts_of_the_forces_are_solved_as_dense_elimination_does) {
    unsigned seed = 19;
    EACH_CASE(treatment, law, shape, kind)
    for (int lanes = 1; lanes <= LAB_LANES && shapes[shape].samples <= 5;
         lanes = lab_wider(lanes)) {
        pushing = (shape + kind) % 2;
        check_parts(&shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                    (enum lab_state)kind, lanes, &seed);
        if (kind == STATE_RANDOM) /* straight, where hinges have no angle */
            check_parts(&shapes[shape], (enum bending)law, (enum wisp_treatment)treatment,
                        STATE_REST, lanes, &seed);
    }
}

/* Where no spring is stretched, air and the samples' springs are off, and bending is what a part
 * has of it, springs along their lines are all there is: then a part's solution is `direct`'s. */
Test(wisp_jacobian, parts_are_all_forces_where_there_are_no_others) {
    static double X[LAB_LANES * LAB_SIZE], direct[LAB_LANES * LAB_SIZE], b[LAB_LANES * LAB_SIZE];
    const double h = 1e-3, gamma[LAB_LANES] = {0};
    double alpha[LAB_LANES], beta[LAB_LANES];
    unsigned seed = 20;
    for (int k = 0; k < LAB_LANES; k++)
        alpha[k] = h, beta[k] = h * h;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int shape = 0; shape < SHAPES; shape++)
                for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                    make_setting(&s, lanes, &shapes[shape], (enum bending)law,
                                 (enum wisp_treatment)treatment, STATE_REST, &seed);
                    for (int k = 0; k < lanes; k++) {
                        s.wisps[k].drag_rate = s.wisps[k].frequency = 0;
                        if (law == BENDING_HINGE)
                            s.wisps[k].bending_stiffness = 0;
                    }
                    struct system *system = &s.part.system;
                    lab_part_make(&s.part, lanes, s.wisps, lanes, &s.around,
                                  (enum wisp_treatment)treatment);
                    linearise(&s, JACOBIAN_SPD);
                    system_product(system, 1, 0, 0, s.V, b);
                    cr_assert_eq(system_factor(system, h, h * h), 0, "%s", system->reason);
                    system_solve(system, b, direct);
                    const struct part_equation e = {
                        law == BENDING_SKIP ? FORCES_AXIAL : FORCES_STRETCH,
                        alpha,
                        beta,
                        gamma,
                        s.Q,
                        s.V,
                        s.V};
                    cr_assert_eq(system_acceleration(system, 0.3, s.Q, s.V, X), 0, "%s",
                                 system->reason);
                    cr_assert_eq(system_solve_part(system, &e, X), 0, "%s", system->reason);
                    for (int i = 0; i < system->size; i++) /* velocities are of 1 m/s */
                        cr_assert(fabs(X[i] - direct[i]) <= 1e-11,
                                  "%s, bending %s, shape %d: x[%d] is %.17g, directly %.17g",
                                  treatment_names[treatment], law_names[law], shape, i, X[i],
                                  direct[i]);
                }
}
