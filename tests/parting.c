/* The part of a style field that parts hair: what it adds to the accelerations and to the Jacobians
 * of the kernel. */
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <string.h>

enum { SIZE_MOST = 10 * (3 + 3 * 8) }; /* of the dense matrices here */

static const double t = 0.3; /* between the knots */

/* Some wisps are on both sides of the plane, within its width and far beyond it. */
static struct surroundings parted(unsigned *seed) {
    struct surroundings around = lab_surroundings(WIND_STEADY, seed);
    struct parting *parting = &around.style.parting;
    double n[3], length = 0;
    around.style.knots = 2;
    around.style.time[1] = 1;
    parting->width = lab_between(seed, 0.02, 0.2);
    for (int c = 0; c < 3; c++) {
        n[c] = lab_between(seed, -1, 1);
        length = hypot(length, n[c]);
        parting->origin[c] = lab_between(seed, -0.1, 0.1);
        for (int k = 0; k < 2; k++) {
            around.style.acceleration[k][c] = lab_between(seed, -20, 20);
            parting->acceleration[k][c] = lab_between(seed, -20, 20);
        }
    }
    for (int c = 0; c < 3; c++)
        parting->normal[c] = n[c] / length;
    return around;
}

/* MODEL's formula, by hand. */
static void field_at(const struct style *style, double at, const double p[3], double s[3]) {
    const struct parting *parting = &style->parting;
    double d = 0;
    for (int c = 0; c < 3; c++)
        d += (p[c] - parting->origin[c]) * parting->normal[c];
    for (int c = 0; c < 3; c++)
        s[c] = (1 - at) * style->acceleration[0][c] + at * style->acceleration[1][c] +
               tanh(d / parting->width) *
                   ((1 - at) * parting->acceleration[0][c] + at * parting->acceleration[1][c]);
}

Test(parting, the_field_has_two_sides) {
    unsigned seed = 1;
    for (int trial = 0; trial < 100; trial++) {
        const struct surroundings around = parted(&seed);
        double p[3], s[3], expected[3];
        for (int c = 0; c < 3; c++)
            p[c] = lab_between(&seed, -0.5, 0.5);
        field_at(&around.style, t, p, expected);
        style_at(&around.style, t, p, s);
        for (int c = 0; c < 3; c++)
            cr_assert_float_eq(s[c], expected[c], 1e-13);
    }
}

/* --- accelerations --- */

struct setting {
    struct lab_part part;
    struct surroundings around;
    enum wisp_treatment treatment;
    struct wisp wisps[LAB_LANES];
    double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE]; /* in space */
    double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], A[LAB_LANES * LAB_SIZE];
};

static void make(struct setting *s, int lanes, int nodes, int samples, int treatment,
                 unsigned seed) {
    s->around = parted(&seed);
    s->treatment = (enum wisp_treatment)treatment;
    for (int k = 0; k < LAB_LANES; k++) {
        s->wisps[k] = lab_wisp(nodes, samples, BENDING_SKIP, &seed);
        lab_state(&s->wisps[k], s->treatment, STATE_RANDOM, 0, &seed, s->q[k], s->v[k]);
    }
    lab_part_make(&s->part, lanes, s->wisps, lanes, &s->around, s->treatment);
    for (int k = 0; k < lanes; k++) {
        lab_place(&s->part, k, s->q[k], s->Q);
        lab_scatter(&s->part, k, s->v[k], s->V);
    }
}

static struct setting s, alone; /* too large for the stack */

/* A node's acceleration and its samples' do not know of the pull on others: they are those of the
 * twin, for which gravity has what the field is at this node. */
static void check_node(int lane, int node, const double *a, double *worst) {
    static struct wisp_twin twin;
    static double expected[LAB_SIZE], scale[LAB_SIZE];
    struct surroundings here = {.wind = s.around.wind};
    const int unknowns = wisp_node_unknowns(&s.wisps[lane], s.treatment),
              at = (node - 2) * unknowns;
    field_at(&s.around.style, t, s.q[lane] + at, here.gravity);
    for (int c = 0; c < 3; c++)
        here.gravity[c] += s.around.gravity[c];
    cr_assert_eq(wisp_twin_init(&twin, &s.wisps[lane], &here, s.treatment), 0);
    wisp_twin_acceleration(&twin, t, s.q[lane], s.v[lane], expected);
    wisp_twin_scale(&twin, t, s.q[lane], s.v[lane], scale);
    for (int u = at; u < at + unknowns; u++)
        cr_assert(lab_close(a[u], expected[u], 1e-11 * scale[u], worst),
                  "%s, node %d: unknown %d is %.17g, not %.17g", treatment_names[s.treatment], node,
                  u - at, a[u], expected[u]);
}

Test(parting, pulls_on_a_node_and_its_samples_where_the_node_is) {
    static const int samples[] = {0, 3, 4, 5};
    static double a[LAB_SIZE], one[LAB_SIZE];
    double worst = 0;
    for (unsigned seed = 0; seed < 60; seed++) {
        const int nodes = 3 + (int)seed % 9, treatment = (int)seed % TREATMENTS;
        make(&s, 4, nodes, samples[seed / 3 % 4], treatment, seed);
        cr_assert_eq(system_acceleration(&s.part.system, t, s.Q, s.V, s.A), 0);
        for (int k = 0; k < 4; k++) {
            lab_gather(&s.part, k, s.A, a);
            for (int i = 2; i < nodes; i++)
                check_node(k, i, a, &worst);
        }
        lab_gather(&s.part, 0, s.A, a); /* bits do not depend on the packing */
        make(&alone, 1, nodes, samples[seed / 3 % 4], treatment, seed);
        cr_assert_eq(system_acceleration(&alone.part.system, t, alone.Q, alone.V, alone.A), 0);
        lab_gather(&alone.part, 0, alone.A, one);
        cr_assert_eq(memcmp(a, one, (size_t)s.part.size * sizeof *a), 0, "seed %u", seed);
    }
    cr_log_info("largest difference: %.2g of the tolerance", worst);
}

/* --- Jacobians --- */

typedef double matrix[SIZE_MOST][SIZE_MOST];
static matrix with, without, K;

/* K of lane 0, by products; `values` as the part assembles it. */
static void stiffness(struct setting *of, enum jacobian kind, matrix k, matrix assembled) {
    static double x[LAB_LANES * LAB_SIZE], y[LAB_LANES * LAB_SIZE], values[SIZE_MOST * SIZE_MOST];
    struct lab_part *part = &of->part;
    const struct sparse_matrix *p = part->pattern;
    cr_assert_eq(system_linearise(&part->system, kind, t, of->Q, of->V), 0);
    memset(x, 0, sizeof x);
    for (int j = 0; j < part->size; j++) {
        x[j * part->lanes] = 1;
        system_product(&part->system, 0, 0, 1, x, y);
        for (int i = 0; i < part->size; i++)
            k[i][j] = y[i * part->lanes];
        x[j * part->lanes] = 0;
    }
    if (!assembled)
        return;
    system_assemble(&part->system, 0, 1, values); /* M - K */
    memset(assembled, 0, sizeof(matrix));
    for (int j = 0; j < part->size; j++)
        for (int at = p->column_start[j]; at < p->column_start[j + 1]; at++)
            assembled[p->row[at]][j] = values[at];
}

/* The field's derivative by the place of a node, by central differences. */
static void field_derivative(const double p[3], double D[3][3]) {
    const double h = 1e-6;
    for (int c = 0; c < 3; c++) {
        double at[3] = {p[0], p[1], p[2]}, above[3], below[3];
        at[c] = p[c] + h;
        field_at(&s.around.style, t, at, above);
        at[c] = p[c] - h;
        field_at(&s.around.style, t, at, below);
        for (int r = 0; r < 3; r++)
            D[r][c] = (above[r] - below[r]) / (2 * h);
    }
}

/* What a parting adds to a row of K in Lagrange's equations, frames held: a mass times the field's
 * derivative, in the row of a sample on its half-line along that. */
static double expected_entry(const struct wisp_twin *twin, const double (*u)[3],
                             const double (*v)[3], int i, int row, double D[3][3], int column) {
    const double mu = twin->sample_mass[i];
    if (row < 3)
        return (twin->mass[i] + (s.treatment == WISP_GENERALISED ? twin->samples * mu : 0)) *
               D[row][column];
    if (s.treatment == WISP_PENALTY)
        return mu * D[row % 3][column];
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum +=
            mu * (twin->cosine[row - 3] * u[i][c] + twin->sine[row - 3] * v[i][c]) * D[c][column];
    return sum;
}

/* What is left where the field is taken away is all that it adds. Differences have (h/width)^2 and
 * rounding over h; that the rest, a spring's, is 1e4 as large costs four digits more. */
static void check_exact(double *worst) {
    static struct wisp_twin twin;
    static double u[LAB_NODES][3], v[LAB_NODES][3], w[LAB_NODES][3];
    const int unknowns = wisp_node_unknowns(&s.wisps[0], s.treatment);
    cr_assert_eq(wisp_twin_init(&twin, &s.wisps[0], &s.around, s.treatment), 0);
    wisp_twin_frames(&twin, s.q[0], u, v, w);
    for (int i = 0; i < s.part.size; i++)
        for (int j = 0; j < s.part.size; j++) {
            const int node = j / unknowns + 2;
            double D[3][3], expected = 0;
            field_derivative(s.q[0] + (node - 2) * unknowns, D);
            if (i / unknowns == j / unknowns && j % unknowns < 3)
                expected = expected_entry(&twin, (const double(*)[3])u, (const double(*)[3])v, node,
                                          i % unknowns, D, j % unknowns);
            const double most = 20 * 3 / s.around.style.parting.width * twin.mass[2];
            cr_assert(lab_close(with[i][j] - without[i][j], expected, 1e-6 * most, worst),
                      "%s: K[%d][%d] gains %.9g, not %.9g", treatment_names[s.treatment], i, j,
                      with[i][j] - without[i][j], expected);
        }
}

Test(parting, exact_jacobians_have_its_derivative_and_definite_ones_do_not) {
    static const int samples[] = {0, 3, 4, 8};
    static matrix assembled, plain;
    double worst = 0;
    for (unsigned seed = 0; seed < 24; seed++) {
        const int lanes = seed % 2 ? 1 : 4, nodes = 3 + (int)seed % 4;
        make(&s, lanes, nodes, samples[seed / 3 % 4], (int)seed % TREATMENTS, seed);
        struct lab_part part = s.part;
        const double width = s.around.style.parting.width;
        const size_t bytes = sizeof(matrix);
        stiffness(&s, JACOBIAN_EXACT, with, lanes == 1 ? assembled : NULL);
        s.around.style.parting.width = 0;
        stiffness(&s, JACOBIAN_EXACT, without, lanes == 1 ? plain : NULL);
        s.around.style.parting.width = width;
        check_exact(&worst);
        for (int i = 0; i < part.size && lanes == 1; i++)
            for (int j = 0; j < part.size; j++)
                cr_assert_float_eq(plain[i][j] - assembled[i][j], with[i][j] - without[i][j],
                                   1e-13 * fmax(1, fabs(with[i][i])), "entry %d, %d", i, j);
        stiffness(&s, JACOBIAN_SPD, with, NULL);
        s.around.style.parting.width = 0;
        stiffness(&s, JACOBIAN_SPD, K, NULL);
        cr_assert_eq(memcmp(with, K, bytes), 0, "a definite Jacobian has the parting");
    }
    cr_log_info("largest difference: %.2g of the tolerance", worst);
}
