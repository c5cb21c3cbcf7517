/* What the forces of a wisp must obey: energies and their gradients, momentum, the frequencies of a
 * hanging chain, and the thesis's own procedure with positions in space. */
#include "base/vector.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_sf_bessel.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double distance(const double a[3], const double b[3]) {
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return sqrt(vector_dot(d, d));
}

/* --- forces of the skeleton --- */

typedef double positions[LAB_NODES][3];

/* All nodes, of a wisp without samples. */
static void place(const struct wisp *wisp, const double *q, positions p) {
    for (int i = 0; i < wisp->nodes; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = i < 2 ? wisp->root[k] + i * wisp_spacing(wisp) * wisp->direction[k]
                            : q[3 * (i - 2) + k];
}

/* The energies written down again, not taken from src/: of stretch springs from node 1 on, and of
 * the bending law. */
static double stretch_energy(const struct wisp *wisp, positions p) {
    const double l = wisp->length / (wisp->nodes - 1), k = wisp->stretch_stiffness / l;
    double energy = 0;
    for (int i = 1; i < wisp->nodes - 1; i++)
        energy += k / 2 * pow(distance(p[i], p[i + 1]) - l, 2);
    return energy;
}

static double bend_energy(const struct wisp *wisp, positions p) {
    const double l = wisp->length / (wisp->nodes - 1), angle = wisp->bending_angle;
    const double k = 16 * wisp->bending_stiffness / (l * l * l * angle * angle);
    double energy = 0;
    for (int i = 0; wisp->bending == BENDING_SKIP && i < wisp->nodes - 2; i++)
        energy += k / 2 * pow(distance(p[i], p[i + 2]) - 2 * l, 2);
    for (int i = 1; wisp->bending == BENDING_HINGE && i < wisp->nodes - 1; i++) {
        double a[3], b[3], axis[3];
        for (int c = 0; c < 3; c++) {
            a[c] = p[i][c] - p[i - 1][c];
            b[c] = p[i + 1][c] - p[i][c];
        }
        vector_cross(a, b, axis);
        energy += wisp->bending_stiffness / l / 2 *
                  pow(atan2(sqrt(vector_dot(axis, axis)), vector_dot(a, b)), 2);
    }
    return energy;
}

/* Central differences with a step of 1e-5 of a spacing: see wisp_jacobian.c; here the largest force
 * is the measure, and energies of 3 rad beside it make it 1e-8. */
Test(wisp_physics, spring_forces_are_minus_the_gradient_of_the_energy) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], f[LAB_NODES][3];
    static positions p;
    unsigned seed = 21;
    double worst = 0;
    for (int law = 0; law < LAWS; law++)
        for (int nodes = 3; nodes <= 20; nodes++)
            for (int kind = STATE_RANDOM; kind < STATES; kind++)
                for (int term = WISP_TWIN_STRETCH; term <= WISP_TWIN_BEND; term++) {
                    double (*energy)(const struct wisp *, positions) =
                        term == WISP_TWIN_STRETCH ? stretch_energy : bend_energy;
                    const struct wisp wisp = lab_wisp(nodes, 0, (enum bending)law, &seed);
                    const struct surroundings calm = {.gravity = {0}};
                    const double step = 1e-5 * wisp_spacing(&wisp);
                    double largest = 0;
                    wisp_twin_init(&twin, &wisp, &calm, WISP_PROJECTION);
                    lab_state(&wisp, WISP_PROJECTION, (enum lab_state)kind, 0, &seed, q, v);
                    wisp_twin_spring_forces(&twin, (enum wisp_twin_term)term, WISP_TWIN_ELASTIC, q,
                                            v, f[0]);
                    place(&wisp, q, p);
                    for (int i = 0; i < 3 * nodes; i++)
                        largest = fmax(largest, fabs(f[i / 3][i % 3]));
                    for (int i = 0; i < 3 * nodes; i++) {
                        double *x = &p[i / 3][i % 3];
                        const double centre = *x;
                        *x = centre + step;
                        const double more = energy(&wisp, p);
                        *x = centre - step;
                        const double less = energy(&wisp, p);
                        *x = centre;
                        cr_assert(lab_close(f[i / 3][i % 3], -(more - less) / (2 * step),
                                            1e-7 * largest, &worst),
                                  "bending %s, %d nodes, term %d, node %d: %g, differences %g",
                                  law_names[law], nodes, term, i / 3, f[i / 3][i % 3],
                                  -(more - less) / (2 * step));
                    }
                }
    cr_log_info("largest difference: %.2g of the tolerance", worst);
}

/* Forces between nodes: their sum and their moment about the origin vanish, prescribed nodes
 * included; elastic and damping parts each. To roundings of the sums of absolute values. */
Test(wisp_physics, springs_change_neither_momentum_nor_moment) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], f[LAB_NODES][3];
    static positions p;
    unsigned seed = 22;
    for (int law = 0; law < LAWS; law++)
        for (int nodes = 3; nodes <= LAB_NODES; nodes++)
            for (int kind = STATE_RANDOM; kind < STATES; kind++)
                for (int term = WISP_TWIN_STRETCH; term <= WISP_TWIN_BEND; term++)
                    for (unsigned parts = 1; parts <= 3; parts++) {
                        const struct wisp wisp = lab_wisp(nodes, 0, (enum bending)law, &seed);
                        const struct surroundings calm = {.gravity = {0}};
                        double force[3] = {0}, moment[3] = {0}, size = 0, arm_size = 0;
                        wisp_twin_init(&twin, &wisp, &calm, WISP_PROJECTION);
                        lab_state(&wisp, WISP_PROJECTION, (enum lab_state)kind, 0, &seed, q, v);
                        wisp_twin_spring_forces(&twin, (enum wisp_twin_term)term, parts, q, v,
                                                f[0]);
                        place(&wisp, q, p);
                        for (int i = 0; i < nodes; i++) {
                            double m[3];
                            vector_cross(p[i], f[i], m);
                            for (int k = 0; k < 3; k++) {
                                force[k] += f[i][k];
                                moment[k] += m[k];
                            }
                            size += sqrt(vector_dot(f[i], f[i]));
                            arm_size += sqrt(vector_dot(f[i], f[i]) * vector_dot(p[i], p[i]));
                        }
                        for (int k = 0; k < 3; k++)
                            cr_assert(fabs(force[k]) <= 1e-13 * size &&
                                          fabs(moment[k]) <= 1e-12 * arm_size,
                                      "bending %s, %d nodes: force %g of %g, moment %g of %g",
                                      law_names[law], nodes, force[k], size, moment[k], arm_size);
                    }
}

static double energy_of(const struct system *system, const double *q, const double *v) {
    struct energies energies;
    cr_assert_eq(system->ops->energies(system->ctx, 0, q, v, &energies), 0);
    return energies_sum(&energies);
}

/* Kernel: the energies above; of the twin with samples, and their sum over lanes. */
Test(wisp_physics, energy_of_the_kernel) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE];
    static positions p;
    static const int samples[] = {0, 3, 4, 8};
    unsigned seed = 23;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int nodes = 3; nodes <= 20; nodes++)
                for (int kind = 0; kind < STATES; kind++)
                    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes)) {
                        const int count = 1 + nodes % lanes;
                        const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
                        struct wisp wisps[LAB_LANES];
                        struct lab_part part;
                        double expected = 0, size = 0;
                        for (int k = 0; k < count; k++)
                            wisps[k] = lab_wisp(nodes, samples[(nodes + kind) % 4],
                                                (enum bending)law, &seed);
                        lab_part_make(&part, lanes, wisps, count, &around,
                                      (enum wisp_treatment)treatment);
                        for (int k = lanes - 1; k >= 0; k--) {
                            const struct wisp *wisp = &wisps[k < count ? k : 0];
                            lab_state(wisp, (enum wisp_treatment)treatment, (enum lab_state)kind, 0,
                                      &seed, q, v);
                            lab_place(&part, k, q, Q);
                            lab_scatter(&part, k, v, V);
                            if (k >= count)
                                continue;
                            wisp_twin_init(&twin, wisp, &around, (enum wisp_treatment)treatment);
                            expected += wisp_twin_energy(&twin, 0, q, v) +
                                        lab_root_potential(wisp, &around); /* 0 there */
                            memset(twin.gravity, 0, sizeof twin.gravity);
                            size += wisp_twin_energy(&twin, 0, q, v) +
                                    9.81 * wisp->hair_count * wisp->hair_density * wisp->length;
                            if (wisp->samples == 0) {
                                memset(v, 0, sizeof v);
                                place(wisp, q, p);
                                const double own = stretch_energy(wisp, p) + bend_energy(wisp, p);
                                cr_assert(fabs(wisp_twin_energy(&twin, 0, q, v) - own) <=
                                              1e-13 * (size + own),
                                          "the twin's energy");
                            }
                        }
                        /* all terms are positive but the work of gravity, below m g times 1 m */
                        const double got = energy_of(&part.system, Q, V);
                        cr_assert(fabs(got - expected) <= 1e-13 * size,
                                  "%s, bending %s, %d nodes, %d of %d lanes: %.17g, twin %.17g",
                                  treatment_names[treatment], law_names[law], nodes, count, lanes,
                                  got, expected);
                    }
}

/* With frames held and everything at rest, M a = -dE/dq in `penalty` and `generalised`, where E has
 * gravity and the samples in it; M by the kernel's product. In `projection` it is not so. */
static double frozen_gradient_error(enum wisp_treatment treatment, int nodes, int samples,
                                    enum bending law, enum lab_state kind, unsigned *seed) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], a[LAB_SIZE], force[LAB_SIZE], Q[LAB_SIZE];
    static double u[LAB_NODES][3], normal[LAB_NODES][3], w[LAB_NODES][3];
    const struct surroundings around = lab_surroundings(WIND_NONE, seed);
    const struct wisp wisp = lab_wisp(nodes, samples, law, seed);
    const double step = 1e-5 * wisp_spacing(&wisp);
    struct lab_part part;
    double worst = 0, largest = 0;
    lab_part_make(&part, 1, &wisp, 1, &around, treatment);
    lab_state(&wisp, treatment, kind, 1, seed, q, v);
    wisp_twin_init(&twin, &wisp, &around, treatment);
    wisp_twin_frames(&twin, q, u, normal, w);
    lab_place(&part, 0, q, Q);
    cr_assert_eq(system_linearise(&part.system, JACOBIAN_SPD, 0, Q, v), 0, "%s",
                 part.system.reason);
    twin.drag_rate = 0; /* drag is 0 at rest, wind apart */
    cr_assert_eq(wisp_twin_acceleration(&twin, 0, q, v, a), 0, "the twin fails");
    system_product(&part.system, 1, 0, 0, a, force);
    for (int i = 0; i < part.size; i++)
        largest = fmax(largest, fabs(force[i]));
    for (int i = 0; i < part.size; i++) {
        const double centre = q[i];
        double energy[2];
        for (int side = 0; side < 2; side++) {
            q[i] = centre + (side ? step : -step);
            energy[side] =
                wisp_twin_energy_frozen(&twin, 0, q, v, (const double(*)[3])u,
                                        (const double(*)[3])normal, (const double(*)[3])w);
        }
        q[i] = centre;
        worst = fmax(worst, fabs(force[i] + (energy[1] - energy[0]) / (2 * step)));
    }
    return worst / largest;
}

Test(wisp_physics, forces_are_minus_the_gradient_with_frames_held) {
    static const int samples[] = {3, 4, 5, 8, 16};
    unsigned seed = 24;
    double worst = 0, projection = 0;
    for (int law = 0; law < LAWS; law++)
        for (int nodes = 3; nodes <= 14; nodes++)
            for (int kind = STATE_RANDOM; kind < STATES; kind++) {
                const int m = samples[nodes % 5];
                const enum bending bending = (enum bending)law;
                const enum lab_state state = (enum lab_state)kind;
                worst = fmax(worst,
                             frozen_gradient_error(WISP_PENALTY, nodes, m, bending, state, &seed));
                worst = fmax(worst, frozen_gradient_error(WISP_GENERALISED, nodes, m, bending,
                                                          state, &seed));
                projection = fmax(projection, frozen_gradient_error(WISP_PROJECTION, nodes, m,
                                                                    bending, state, &seed));
            }
    cr_log_info("largest difference: %.2g; in projection %.2g", worst, projection);
    cr_assert_leq(worst, 1e-7, "the gradient differs by %g", worst);
    cr_assert_geq(projection, 1e-4, "projection loses nothing: %g", projection);
}

/* In `penalty` and `generalised` all that happens between a node and its samples stays in the wisp:
 * the rate of momentum is gravity and air on every mass, and what springs put on nodes 0 and 1. */
Test(wisp_physics, samples_do_not_change_momentum) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], a[LAB_SIZE], f[LAB_NODES][3], Q[LAB_SIZE];
    static double u[LAB_NODES][3], normal[LAB_NODES][3], w[LAB_NODES][3];
    static const int samples[] = {3, 4, 5, 8, 16};
    unsigned seed = 25;
    double lost = 0;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int nodes = 3; nodes <= 30; nodes++) {
                const struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
                const struct wisp wisp =
                    lab_wisp(nodes, samples[nodes % 5], (enum bending)law, &seed);
                struct lab_part part;
                double rate[3] = {0}, size = 0;
                lab_part_make(&part, 1, &wisp, 1, &around, (enum wisp_treatment)treatment);
                lab_state(&wisp, (enum wisp_treatment)treatment, STATE_RANDOM, 0, &seed, q, v);
                lab_place(&part, 0, q, Q);
                cr_assert_eq(system_acceleration(&part.system, 0.3, Q, v, a), 0);
                wisp_twin_init(&twin, &wisp, &around, (enum wisp_treatment)treatment);
                wisp_twin_frames(&twin, q, u, normal, w);
                for (int term = WISP_TWIN_STRETCH; term <= WISP_TWIN_BEND; term++) {
                    wisp_twin_spring_forces(&twin, (enum wisp_twin_term)term, 3, q, v, f[0]);
                    for (int k = 0; k < 3; k++) {
                        rate[k] += f[0][k] + f[1][k];
                        for (int i = 0; i < nodes; i++)
                            size += fabs(f[i][k]);
                    }
                }
                for (int i = 2; i < nodes; i++) {
                    const double m = wisp_node_mass(&wisp, i), mu = wisp_sample_mass(&wisp, i);
                    const int unknowns = wisp_node_unknowns(&wisp, (enum wisp_treatment)treatment);
                    const int at = (i - 2) * unknowns;
                    for (int j = -1; j < wisp.samples; j++) {
                        const double mass = j < 0 ? m : mu;
                        for (int k = 0; k < 3; k++) {
                            double velocity = v[at + k], acceleration = a[at + k];
                            const double line =
                                j < 0 ? 0 : twin.cosine[j] * u[i][k] + twin.sine[j] * normal[i][k];
                            if (j >= 0 && treatment == WISP_PENALTY) {
                                velocity = v[at + 3 + 3 * j + k];
                                acceleration = a[at + 3 + 3 * j + k];
                            } else if (j >= 0) {
                                velocity += v[at + 3 + j] * line;
                                acceleration += a[at + 3 + j] * line;
                            }
                            const double outer =
                                around.gravity[k] +
                                wisp.drag_rate * (around.wind.velocity[k] - velocity);
                            rate[k] += mass * (acceleration - outer);
                            size += mass * (fabs(acceleration) + fabs(outer));
                        }
                    }
                }
                for (int k = 0; k < 3; k++) {
                    if (treatment == WISP_PROJECTION)
                        lost = fmax(lost, fabs(rate[k]) / size);
                    else
                        /* roundings of the accelerations: see lab_check_with_twin */
                        cr_assert(fabs(rate[k]) <= 1e-13 * size,
                                  "%s, bending %s, %d nodes: %g of %g appears from nothing",
                                  treatment_names[treatment], law_names[law], nodes, rate[k], size);
                }
            }
    cr_assert_geq(lost, 1e-5, "projection loses nothing across its lines: %g", lost);
}

/* --- energy along a run --- */

static int note_energy(void *ctx, const struct model *model, double t, const double *rows) {
    (void)t, (void)rows;
    double **next = ctx;
    const struct part *part = &model->parts[0];
    *(*next)++ = energy_of(&part->system, part->q, part->v);
    return 0;
}

/* Springs, damping and drag in still air only take energy away. The integration error of the
 * reference, 1e-10 relative, is far below what is lost between two frames while it swings. */
Test(wisp_physics, energy_of_the_swing_never_grows) {
    enum { FRAMES = 301 };
    static double energy[FRAMES + 1];
    double *next = energy;
    struct scene *scene = LAB_LOAD("swing", "frame_rate=300.0");
    run_finished(scene, &(struct run_request){.stepper = "reference"}, note_energy, &next);
    cr_assert_eq(next - energy, FRAMES);
    const double first = fabs(energy[0] - energy[FRAMES - 1]);
    for (int f = 1; f < FRAMES; f++)
        cr_assert(energy[f] <= energy[f - 1] + 1e-12 * first, "frame %d: %.17g after %.17g", f,
                  energy[f], energy[f - 1]);
    cr_assert_gt(first, 1e-4, "nothing swings: %g", first);
}

/* --- a hanging chain --- */

/* Squares of the lowest angular frequencies of a wisp that hangs still, across it, by the kernel's
 * linearisation: M w^2 x = -K x for displacements along x, which no other mixes with here. */
static void chain_frequencies(int nodes, int count, double *squares) {
    static double q[LAB_SIZE], v[LAB_SIZE], x[LAB_SIZE], y[LAB_SIZE];
    const struct surroundings around = {.gravity = {0, -9.81, 0}};
    unsigned seed = 26;
    struct wisp wisp = lab_wisp(nodes, 0, BENDING_NONE, &seed);
    memcpy(wisp.root, (double[3]){0}, sizeof wisp.root);
    memcpy(wisp.direction, (double[3]){0, -1, 0}, sizeof wisp.direction);
    wisp.length = 0.3;
    wisp.drag_rate = 0;
    wisp.stretch_stiffness = 1e8; /* stretched by 1e-10 of its length: nothing at these digits */
    struct lab_part part;
    lab_part_make(&part, 1, &wisp, 1, &around, WISP_PROJECTION);

    /* at equilibrium each segment carries what hangs below it */
    double at = wisp_spacing(&wisp), weight = 0;
    memset(q, 0, sizeof q);
    memset(v, 0, sizeof v);
    for (int i = 2; i < nodes; i++)
        weight += 9.81 * wisp_node_mass(&wisp, i);
    for (int i = 2; i < nodes; i++) {
        at += wisp_spacing(&wisp) + weight / wisp_stretch_constant(&wisp);
        weight -= 9.81 * wisp_node_mass(&wisp, i);
        q[3 * (i - 2) + 1] = -at;
    }
    cr_assert_eq(system_linearise(&part.system, JACOBIAN_EXACT, 0, q, v), 0, "%s",
                 part.system.reason);

    const size_t n = (size_t)nodes - 2;
    gsl_matrix *M = gsl_matrix_alloc(n, n), *K = gsl_matrix_alloc(n, n);
    gsl_vector *values = gsl_vector_alloc(n);
    gsl_eigen_gensymm_workspace *work = gsl_eigen_gensymm_alloc(n);
    for (size_t j = 0; j < n; j++) {
        memset(x, 0, sizeof x);
        x[3 * j] = 1;
        system_product(&part.system, 1, 0, 0, x, y);
        for (size_t i = 0; i < n; i++)
            gsl_matrix_set(M, i, j, y[3 * i]);
        system_product(&part.system, 0, 0, -1, x, y);
        for (size_t i = 0; i < n; i++)
            gsl_matrix_set(K, i, j, y[3 * i]);
    }
    gsl_eigen_gensymm(K, M, values, work);
    gsl_sort_vector(values);
    for (int k = 0; k < count; k++)
        squares[k] = gsl_vector_get(values, (size_t)k);
    gsl_eigen_gensymm_free(work);
    gsl_vector_free(values);
    gsl_matrix_free(K);
    gsl_matrix_free(M);
}

/* Daniel Bernoulli 1732: w_k = j_0k / 2 sqrt(g / L). The model's chain hangs from node 1, so L is
 * that of n - 2 segments; each segment carries what hangs below its middle, and the last node has
 * half a segment: central differences, of second order, with frequencies that are too low. The next
 * term is about (j_0k / segments)^2 of the first: the order is within 0.1 for the first three modes
 * from 20 segments on (it was 1.994, 2.001, 1.942). A mass rule without the half, or a chain that
 * hangs from node 0, has errors of first order. */
Test(wisp_physics, a_hanging_chain_has_the_frequencies_of_bessel) {
    enum { MODES = 3 };
    static const int segments[] = {20, 38};
    double error[2][MODES];
    for (int s = 0; s < 2; s++) {
        double squares[MODES];
        const int nodes = segments[s] + 2;
        chain_frequencies(nodes, MODES, squares);
        const double length = 0.3 * segments[s] / (nodes - 1);
        for (int k = 0; k < MODES; k++) {
            const double exact = gsl_sf_bessel_zero_J0((unsigned)k + 1) / 2 * sqrt(9.81 / length);
            error[s][k] = sqrt(squares[k]) / exact - 1;
        }
    }
    for (int k = 0; k < MODES; k++) {
        const double ratio = (double)segments[1] / segments[0];
        const double order = log(error[0][k] / error[1][k]) / log(ratio);
        const double limit = (error[1][k] * ratio * ratio - error[0][k]) / (ratio * ratio - 1);
        cr_log_info("mode %d: errors %.3e, %.3e, order %.3f, in the limit %.1e", k + 1, error[0][k],
                    error[1][k], order, limit);
        cr_assert(error[1][k] < 0, "mode %d: too high by %g", k + 1, error[1][k]);
        cr_assert(fabs(order - 2) <= 0.1, "mode %d: order %.3f", k + 1, order);
    }
    /* the first mode, its first error extrapolated away: what is left is of the next order, the
     * square of the first error times about 6 */
    const double squared = pow((double)segments[1] / segments[0], 2);
    const double limit = (error[1][0] * squared - error[0][0]) / (squared - 1);
    cr_assert_lt(fabs(limit), 10 * error[0][0] * error[0][0], "in the limit %g is left", limit);
}

/* --- the thesis's procedure --- */

/* One wisp of the thesis: samples as points in space that move along lines fixed in space, then are
 * put onto the new lines with the distance and rate they have (section 4.2.1). Forces are
 * added up here, spring by spring, not by the twin. */
struct literal {
    const struct wisp *wisp;
    struct surroundings around;
    struct wisp_twin bones;                                             /* the skeleton alone */
    double p[LAB_NODES * 3], v[LAB_NODES * 3];                          /* free nodes */
    double e[LAB_NODES][SAMPLES_MAX][3], ev[LAB_NODES][SAMPLES_MAX][3]; /* points; along the line */
    double line[LAB_NODES][SAMPLES_MAX][3];
};

static void turn_lines(struct literal *l) {
    static double u[LAB_NODES][3], v[LAB_NODES][3], w[LAB_NODES][3];
    const int samples = l->wisp->samples;
    wisp_twin_frames(&l->bones, l->p, u, v, w);
    for (int i = 2; i < l->wisp->nodes; i++)
        for (int j = 0; j < samples; j++)
            for (int k = 0; k < 3; k++)
                l->line[i][j][k] =
                    cos(2 * M_PI * j / samples) * u[i][k] + sin(2 * M_PI * j / samples) * v[i][k];
}

static void literal_start(struct literal *l, const struct wisp *wisp,
                          const struct surroundings *around) {
    struct wisp bare = *wisp;
    l->wisp = wisp;
    l->around = *around;
    bare.samples = 0;
    wisp_twin_init(&l->bones, &bare, around, WISP_PROJECTION);
    wisp_twin_rest(&l->bones, l->p, l->v);
    turn_lines(l);
    for (int i = 2; i < wisp->nodes; i++)
        for (int j = 0; j < wisp->samples; j++)
            for (int k = 0; k < 3; k++) {
                l->e[i][j][k] = l->p[3 * (i - 2) + k] + wisp->radius * l->line[i][j][k];
                l->ev[i][j][k] = 0;
            }
}

static void literal_step(struct literal *l, double h) {
    static double f[2][LAB_NODES][3], change[LAB_NODES][3];
    const struct wisp *wisp = l->wisp;
    const double omega = 2 * M_PI * wisp->frequency;
    for (int term = 0; term < 2; term++)
        wisp_twin_spring_forces(&l->bones, (enum wisp_twin_term)term, 3, l->p, l->v, f[term][0]);
    for (int i = 2; i < wisp->nodes; i++) {
        const double *p = &l->p[3 * (i - 2)], *v = &l->v[3 * (i - 2)];
        const double m = wisp_node_mass(wisp, i), mu = wisp_sample_mass(wisp, i);
        const double k_e = mu * omega * omega, c_e = 2 * wisp->damping_ratio * omega * mu;
        double force[3];
        for (int k = 0; k < 3; k++)
            force[k] =
                f[0][i][k] + f[1][i][k] +
                m * (l->around.gravity[k] + wisp->drag_rate * (l->around.wind.velocity[k] - v[k]));
        for (int j = 0; j < wisp->samples; j++) {
            const double *a = l->line[i][j];
            double *e = l->e[i][j], *ev = l->ev[i][j], outer[3];
            const double d[3] = {e[0] - p[0], e[1] - p[1], e[2] - p[2]};
            const double s = k_e * (wisp->radius - vector_dot(d, a)) - c_e * vector_dot(ev, a);
            for (int k = 0; k < 3; k++)
                outer[k] = mu * (l->around.gravity[k] +
                                 wisp->drag_rate * (l->around.wind.velocity[k] - v[k] - ev[k]));
            const double along = (s + vector_dot(outer, a)) / mu;
            for (int k = 0; k < 3; k++) {
                force[k] -= s * a[k];
                e[k] += h * ev[k]; /* along the old line, from where the node was */
                ev[k] += h * along * a[k];
            }
        }
        for (int k = 0; k < 3; k++)
            change[i][k] = force[k] / m;
    }
    for (int i = 2; i < wisp->nodes; i++) { /* distance and rate, measured on the old line */
        const double *p = &l->p[3 * (i - 2)];
        for (int j = 0; j < wisp->samples; j++) {
            double *e = l->e[i][j], *ev = l->ev[i][j];
            const double d[3] = {e[0] - p[0], e[1] - p[1], e[2] - p[2]};
            e[0] = vector_dot(d, l->line[i][j]);
            ev[0] = vector_dot(ev, l->line[i][j]);
        }
    }
    for (int i = 2; i < wisp->nodes; i++)
        for (int k = 0; k < 3; k++) {
            l->p[3 * (i - 2) + k] += h * l->v[3 * (i - 2) + k];
            l->v[3 * (i - 2) + k] += h * change[i][k];
        }
    turn_lines(l);
    for (int i = 2; i < wisp->nodes; i++)
        for (int j = 0; j < wisp->samples; j++) {
            const double r = l->e[i][j][0], rate = l->ev[i][j][0];
            for (int k = 0; k < 3; k++) {
                l->e[i][j][k] = l->p[3 * (i - 2) + k] + r * l->line[i][j][k];
                l->ev[i][j][k] = rate * l->line[i][j][k];
            }
        }
}

/* 1000 steps of damped motion: each adds a few roundings of positions (0.3 m, 1e-17) and of
 * accelerations times h (1e4 m/s^2 times 5e-5 s), which damped springs pass on but do not let grow:
 * at worst they add up, 1e-13 m and 1e-11 m/s. Measured: 4e-15 and 2e-13. */
Test(wisp_physics, explicit_euler_with_projection_is_the_thesis_procedure) {
    static struct literal literal;
    static double q[LAB_SIZE], v[LAB_SIZE];
    static const int samples[] = {3, 4, 8};
    const struct stepper_settings settings = {.rtol = 0};
    double worst_p = 0, worst_v = 0, moved = 0;
    unsigned seed = 27;
    for (int law = 0; law < LAWS; law++)
        for (int m = 0; m < 3; m++) {
            struct wisp wisp = lab_wisp(8, samples[m], (enum bending)law, &seed);
            const struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
            memset(wisp.root, 0, sizeof wisp.root); /* from which the unknowns are */
            wisp.length = 0.3; /* at the default stiffness Euler is stable to 1e-4 s */
            wisp.hair_count = 1000;
            wisp.stretch_stiffness = 90;
            wisp.stretch_time = 1.2e-4;
            struct lab_part part;
            lab_part_make(&part, 1, &wisp, 1, &around, WISP_PROJECTION);
            kernel_1.rest(part.system.ctx, 0, q, v);
            struct stepper *stepper =
                stepper_create(stepper_find("euler"), &settings, &part.system);
            cr_assert(stepper, "no memory");
            literal_start(&literal, &wisp, &around);
            const double start = q[part.size - 1 - samples[m]];
            for (int k = 0; k < 1000; k++) {
                cr_assert_eq(stepper->method->step(stepper, k * 5e-5, 5e-5, q, v), 0);
                literal_step(&literal, 5e-5);
            }
            moved = fmax(moved, fabs(q[part.size - 1 - samples[m]] - start));
            for (int i = 2; i < wisp.nodes; i++) {
                const int at = (i - 2) * (3 + samples[m]);
                for (int k = 0; k < 3; k++) {
                    worst_p = fmax(worst_p, fabs(q[at + k] - literal.p[3 * (i - 2) + k]));
                    worst_v = fmax(worst_v, fabs(v[at + k] - literal.v[3 * (i - 2) + k]));
                }
                for (int j = 0; j < samples[m]; j++) {
                    const double *a = literal.line[i][j], *e = literal.e[i][j];
                    const double *p = &literal.p[3 * (i - 2)];
                    const double d[3] = {e[0] - p[0], e[1] - p[1], e[2] - p[2]};
                    worst_p = fmax(worst_p, fabs(q[at + 3 + j] - vector_dot(d, a)));
                    worst_v = fmax(worst_v, fabs(v[at + 3 + j] - vector_dot(literal.ev[i][j], a)));
                }
            }
            stepper->method->free(stepper);
        }
    cr_log_info("differences %.1e m, %.1e m/s; moved %.2g m", worst_p, worst_v, moved);
    cr_assert(worst_p <= 1e-13 && worst_v <= 1e-11, "differences %.1e m, %.1e m/s", worst_p,
              worst_v);
    cr_assert_gt(moved, 0.01, "nothing moves: %g m", moved);
}
