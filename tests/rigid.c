/* Segments that are rigid: their accelerations against a dense solve, their lengths, the motion of
 * a double pendulum, the limit of stiff springs, energy, and what is refused. */
#include "base/vector.h"
#include "model/problems.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct wisp rigid_wisp(int nodes, int samples, enum bending law, unsigned *seed) {
    struct wisp wisp = lab_wisp(nodes, samples, law, seed);
    wisp.stretch = STRETCH_RIGID;
    wisp.stretch_stiffness = wisp.stretch_time = 0;
    return wisp;
}

/* --- accelerations --- */

static void check_part(int lanes, int nodes, int samples, enum bending law,
                       enum wisp_treatment treatment, unsigned *seed, double *worst) {
    const struct surroundings around =
        lab_surroundings((enum wind_kind)((nodes + samples) % WINDS), seed);
    const double t = lab_between(seed, 0, 1);
    struct wisp wisps[LAB_LANES];
    for (int k = 0; k < lanes; k++)
        wisps[k] = rigid_wisp(nodes, samples, law, seed);
    lab_check_with_twins(lanes, wisps, &around, treatment, t, seed, worst);
}

/* Also where lengths are not kept, and velocities stretch them. */
Test(rigid, accelerations_are_those_of_a_dense_solve) {
    static const int samples[] = {0, 3, 4, 7};
    double worst = 0;
    unsigned seed = 1;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int law = 0; law < LAWS; law++)
            for (int s = 0; s < 4; s++)
                for (int nodes = 3; nodes <= LAB_NODES; nodes += nodes < 12 ? 1 : 7)
                    for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
                        check_part(lanes, nodes, samples[s], (enum bending)law,
                                   (enum wisp_treatment)treatment, &seed, &worst);
    cr_log_info("largest difference: %.2g of the tolerance", worst);
}

/* Tensions are between nodes, along the segments: what they do to all nodes together is a pull of
 * the head along the first segment, without a moment about node 1. */
Test(rigid, tensions_keep_linear_and_angular_momentum) {
    static double q[LAB_SIZE], v[LAB_SIZE], with[LAB_SIZE], without[LAB_SIZE];
    unsigned seed = 5;
    for (int nodes = 3; nodes <= 20; nodes++) {
        struct wisp wisp = rigid_wisp(nodes, 0, BENDING_HINGE, &seed), loose = wisp;
        const struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
        struct lab_part part, free_part;
        double force[3] = {0}, moment[3] = {0}, terms = 0, first[3], along[3], turned[3];
        loose.stretch = STRETCH_SPRING;
        lab_state(&wisp, WISP_GENERALISED, STATE_RANDOM, 0, &seed, q, v);
        lab_part_make(&part, 1, &wisp, 1, &around, WISP_GENERALISED);
        lab_part_make(&free_part, 1, &loose, 1, &around, WISP_GENERALISED);
        for (int k = 0; k < 3; k++)
            first[k] = wisp_spacing(&wisp) * wisp.direction[k];
        double *at = q;
        for (int i = 2; i < nodes; i++, at += 3)
            for (int k = 0; k < 3; k++)
                at[k] -= wisp.root[k];
        cr_assert_eq(system_acceleration(&part.system, 0.1, q, v, with), 0);
        cr_assert_eq(system_acceleration(&free_part.system, 0.1, q, v, without), 0);
        for (int i = 2; i < nodes; i++) {
            double f[3], arm[3], turn[3];
            for (int k = 0; k < 3; k++) {
                const int u = 3 * (i - 2) + k;
                f[k] = wisp_node_mass(&wisp, i) * (with[u] - without[u]);
                arm[k] = q[u] - first[k];
            }
            vector_cross(arm, f, turn);
            vector_add(force, 1, f);
            vector_add(moment, 1 / wisp.length, turn);
            terms += vector_length(f);
        }
        for (int k = 0; k < 3; k++)
            along[k] = q[k] - first[k];
        vector_cross(along, force, turned);
        cr_assert(terms > 0, "no tensions");
        cr_assert_leq(vector_length(turned) / vector_length(along), 1e-12 * terms,
                      "%d nodes: the head is pulled across the first segment", nodes);
        cr_assert_leq(vector_length(moment), 1e-12 * terms, "%d nodes: a moment", nodes);
    }
}

/* --- projection --- */

/* A state whose segments are off by up to `off` of their length, from the root. */
static void near_state(const struct wisp *wisp, enum wisp_treatment treatment, double off,
                       unsigned *seed, double *q, double *v) {
    const int unknowns = wisp_node_unknowns(wisp, treatment);
    const double l = wisp_spacing(wisp);
    double along[3] = {wisp->direction[0], wisp->direction[1], wisp->direction[2]};
    double p[3] = {l * along[0], l * along[1], l * along[2]};
    for (int i = 2; i < wisp->nodes; i++, q += unknowns, v += unknowns) {
        lab_turn(along, 0.4, seed);
        vector_add(p, l * (1 + lab_between(seed, -off, off)), along);
        memcpy(q, p, sizeof p);
        for (int u = 3; u < unknowns; u++)
            q[u] = treatment == WISP_PENALTY ? p[u % 3] + lab_between(seed, -0.02, 0.02)
                                             : lab_between(seed, 0.01, 0.03);
        for (int u = 0; u < unknowns; u++)
            v[u] = lab_between(seed, -1, 1);
    }
}

static void node_of(const struct wisp *wisp, int unknowns, const double *x, int i, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = i < 2 ? i * wisp_spacing(wisp) * wisp->direction[k] : x[(i - 2) * unknowns + k];
}

/* By how much segments are off, of their length; and the largest rate of one, nodes 0 and 1 being
 * at rest. */
static double off_length(const struct wisp *wisp, int unknowns, const double *q) {
    double most = 0, a[3], b[3];
    for (int i = 2; i < wisp->nodes; i++) {
        node_of(wisp, unknowns, q, i - 1, a);
        node_of(wisp, unknowns, q, i, b);
        vector_add(b, -1, a);
        most = fmax(most, fabs(vector_length(b) / wisp_spacing(wisp) - 1));
    }
    return most;
}

static double stretching(const struct wisp *wisp, int unknowns, const double *q, const double *v) {
    double most = 0, d[3], a[3], rate[3] = {0};
    for (int i = 2; i < wisp->nodes; i++) {
        node_of(wisp, unknowns, q, i - 1, a);
        node_of(wisp, unknowns, q, i, d);
        vector_add(d, -1, a);
        for (int k = 0; k < 3; k++)
            rate[k] = v[(i - 2) * unknowns + k] - (i > 2 ? v[(i - 3) * unknowns + k] : 0);
        most = fmax(most, fabs(vector_dot(d, rate)) / vector_length(d));
    }
    return most;
}

/* m x, or in `generalised` the mass along w and across it. */
static void mass_times(const struct wisp *wisp, int coupled, int i, const double w[3],
                       const double x[3], double y[3]) {
    const double own = wisp_node_mass(wisp, i);
    const double samples = coupled ? wisp->samples * wisp_sample_mass(wisp, i) : 0;
    for (int k = 0; k < 3; k++)
        y[k] = (own + samples / 2) * x[k] + samples / 2 * vector_dot(w, x) * w[k];
}

/* B times what a projection changed is of the form -y_i t_i + y_(i+1) t_(i+1) at every node, where
 * t are directions of the segments: what is left across them, of the largest. */
static double across_segments(const struct wisp *wisp, int coupled, int unknowns,
                              const double (*w)[3], const double *directions_of,
                              const double *change) {
    double beyond[3] = {0}, most = 0, worst = 0;
    for (int i = wisp->nodes - 1; i >= 2; i--) {
        double a[3], t[3], force[3];
        node_of(wisp, unknowns, directions_of, i - 1, a);
        node_of(wisp, unknowns, directions_of, i, t);
        vector_add(t, -1, a);
        const double length = vector_length(t);
        mass_times(wisp, coupled, i, w[i], change + (i - 2) * unknowns, force);
        vector_add(force, -1, beyond); /* = y_i t_i but for the sign */
        const double y = vector_dot(force, t) / length;
        most = fmax(most, vector_length(force));
        double left[3] = {force[0], force[1], force[2]};
        vector_add(left, -y / length, t);
        worst = fmax(worst, vector_length(left));
        for (int k = 0; k < 3; k++)
            beyond[k] = -y / length * t[k];
        /* node i - 1 has the opposite of what segment i does to node i */
    }
    return most > 0 ? worst / most : 0;
}

static void check_projection(int lanes, int nodes, int samples, enum wisp_treatment treatment,
                             unsigned *seed) {
    static double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE], q1[LAB_SIZE], v1[LAB_SIZE];
    static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], change[LAB_SIZE];
    static double u[WISP_TWIN_NODES_MAX][3], side[WISP_TWIN_NODES_MAX][3],
        w[WISP_TWIN_NODES_MAX][3];
    static struct wisp_twin twin;
    const struct surroundings around = lab_surroundings(WIND_NONE, seed);
    const int coupled = treatment == WISP_GENERALISED && samples > 0;
    struct wisp wisps[LAB_LANES];
    struct lab_part part;
    for (int k = 0; k < lanes; k++) {
        wisps[k] = rigid_wisp(nodes, samples, BENDING_SKIP, seed);
        memset(wisps[k].root, 0, sizeof wisps[k].root);
    }
    lab_part_make(&part, lanes, wisps, lanes, &around, treatment);
    const int unknowns = part.node_unknowns;
    for (int k = 0; k < lanes; k++) {
        near_state(&wisps[k], treatment, 0.02, seed, q[k], v[k]);
        lab_scatter(&part, k, q[k], Q);
        lab_scatter(&part, k, v[k], V);
    }
    cr_assert_eq(system_project(&part.system, 0.1, Q, V), 0, "%s", part.system.reason);
    for (int k = 0; k < lanes; k++) {
        const struct wisp *wisp = &wisps[k];
        lab_gather(&part, k, Q, q1);
        lab_gather(&part, k, V, v1);
        const double places = 4 * 2.3e-16 * wisp->length / wisp_spacing(wisp);
        cr_assert_leq(off_length(wisp, unknowns, q1), 1e-13 + places, "%d nodes: off by %.2e",
                      nodes, off_length(wisp, unknowns, q1));
        cr_assert_leq(stretching(wisp, unknowns, q1, v1), 2e-14, "%d nodes: stretched by %.2e",
                      nodes, stretching(wisp, unknowns, q1, v1));
        wisp_twin_init(&twin, wisp, &around, treatment);
        wisp_twin_frames(&twin, q[k], u, side, w);
        for (int i = 0; i < part.size; i++)
            change[i] = q1[i] - q[k][i];
        cr_assert_leq(across_segments(wisp, coupled, unknowns, (const double(*)[3])w, q[k], change),
                      1e-10, "%s, %d nodes, %d samples: places moved across the forces",
                      treatment_names[treatment], nodes, samples);
        for (int i = 0; i < part.size; i++) { /* r stays, particles go along */
            const int place = i % unknowns;
            const double expected = treatment == WISP_PENALTY ? change[i - place + place % 3] : 0;
            if (place >= 3)
                cr_assert_leq(fabs(change[i] - expected), 1e-16, "sample moved by %g, node %g",
                              change[i], expected);
        }
        wisp_twin_frames(&twin, q1, u, side, w);
        for (int i = 0; i < part.size; i++)
            change[i] = v1[i] - v[k][i];
        cr_assert_leq(across_segments(wisp, coupled, unknowns, (const double(*)[3])w, q1, change),
                      1e-10, "%s, %d nodes, %d samples: velocities changed across the forces",
                      treatment_names[treatment], nodes, samples);
        for (int i = 2; i < nodes; i++)
            for (int j = 0; j < unknowns - 3; j++) { /* a sample's own velocity on its line stays */
                const double *at = change + (i - 2) * unknowns;
                const double turn = 2 * M_PI * j / samples;
                const double along =
                    cos(turn) * vector_dot(u[i], at) + sin(turn) * vector_dot(side[i], at);
                cr_assert_leq(fabs(at[3 + j] + (coupled ? along : 0)), 1e-13, "%s: a sample's rate",
                              treatment_names[treatment]);
            }
        /* the energy of the velocities, at the same place, is a sum of squares in the metric of B
         */
        const double before = wisp_twin_energy(&twin, 0, q1, v[k]),
                     after = wisp_twin_energy(&twin, 0, q1, v1);
        cr_assert_lt(after, before, "%s: energy is gained", treatment_names[treatment]);
    }
}

Test(rigid, projection_moves_by_forces_along_segments_to_the_lengths) {
    static const int samples[] = {0, 3, 4, 7};
    unsigned seed = 2;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int s = 0; s < 4; s++)
            for (int nodes = 3; nodes <= LAB_NODES; nodes += nodes < 12 ? 1 : 7)
                for (int lanes = 1; lanes <= LAB_LANES; lanes = lab_wider(lanes))
                    check_projection(lanes, nodes, samples[s], (enum wisp_treatment)treatment,
                                     &seed);
}

/* Forces along the segments as they were cannot put back what is far off: then those along the
 * segments as they have become do. */
Test(rigid, what_is_far_off_is_put_back_too) {
    static double q[LAB_SIZE], v[LAB_SIZE];
    unsigned seed = 6;
    for (int treatment = 0; treatment < TREATMENTS; treatment++)
        for (int k = 0; k < 100; k++) {
            const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
            struct wisp wisp = rigid_wisp(9, 4, BENDING_SKIP, &seed);
            struct lab_part part;
            memset(wisp.root, 0, sizeof wisp.root);
            near_state(&wisp, (enum wisp_treatment)treatment, 0.9, &seed, q, v);
            lab_part_make(&part, 1, &wisp, 1, &around, (enum wisp_treatment)treatment);
            cr_assert_eq(system_project(&part.system, 0.1, q, v), 0, "%s", part.system.reason);
            const double off = off_length(&wisp, part.node_unknowns, q);
            cr_assert_leq(off, 1.2e-13, "off by %.2e", off);
        }
}

/* A wisp's numbers have the same bits whoever is beside it, also if that one needs more iterations
 * or none, or is not asked for, or cannot be put back. */
Test(rigid, bits_are_those_of_a_wisp_alone) {
    static double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE], one_q[LAB_SIZE], one_v[LAB_SIZE];
    static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], q1[LAB_SIZE], v1[LAB_SIZE];
    static double A[LAB_LANES * LAB_SIZE];
    static const double off[LAB_LANES] = {1.5, 0, 1e-9, 1e-3, 0, 1e-6, 0.5, 0.1};
    unsigned seed = 3;
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
        struct wisp wisps[LAB_LANES];
        struct lab_part part, alone;
        for (int k = 0; k < LAB_LANES; k++) {
            wisps[k] = rigid_wisp(9, 4, BENDING_SKIP, &seed);
            near_state(&wisps[k], (enum wisp_treatment)treatment, off[k], &seed, q[k], v[k]);
        }
        lab_part_make(&part, LAB_LANES, wisps, LAB_LANES, &around, (enum wisp_treatment)treatment);
        for (unsigned some = 0; some < 32; some++) {
            const unsigned asked = 83 * some % (1u << LAB_LANES);
            for (int k = 0; k < LAB_LANES; k++) {
                lab_scatter(&part, k, q[k], Q);
                lab_scatter(&part, k, v[k], V);
            }
            cr_assert_eq(kernel_8.project_lanes(part.system.ctx, 0, Q, V, asked), 0, "%s",
                         part.system.reason);
            for (int k = 0; k < LAB_LANES; k++) {
                lab_part_make(&alone, 1, &wisps[k], 1, &around, (enum wisp_treatment)treatment);
                memcpy(one_q, q[k], sizeof one_q);
                memcpy(one_v, v[k], sizeof one_v);
                if (asked >> k & 1)
                    cr_assert_eq(system_project(&alone.system, 0, one_q, one_v), 0);
                lab_gather(&part, k, Q, q1);
                lab_gather(&part, k, V, v1);
                for (int i = 0; i < part.size; i++)
                    cr_assert(q1[i] == one_q[i] && v1[i] == one_v[i],
                              "%s, lanes %x: wisp %d, unknown %d: %.17g %.17g alone %.17g %.17g",
                              treatment_names[treatment], asked, k, i, q1[i], v1[i], one_q[i],
                              one_v[i]);
            }
        }
        for (int k = 0; k < LAB_LANES; k++) { /* and of accelerations */
            lab_scatter(&part, k, q[k], Q);
            lab_scatter(&part, k, v[k], V);
        }
        cr_assert_eq(system_acceleration(&part.system, 0, Q, V, A), 0);
        for (int k = 0; k < LAB_LANES; k++) {
            lab_part_make(&alone, 1, &wisps[k], 1, &around, (enum wisp_treatment)treatment);
            cr_assert_eq(system_acceleration(&alone.system, 0, q[k], v[k], one_v), 0);
            lab_gather(&part, k, A, v1);
            cr_assert_eq(memcmp(one_v, v1, (size_t)part.size * sizeof *v1), 0, "%s: wisp %d",
                         treatment_names[treatment], k);
        }
    }
}

/* Where it fails the state stays, and the reason names the wisp. */
Test(rigid, what_is_too_far_is_left_as_it_is) {
    static double Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE], q[LAB_SIZE], v[LAB_SIZE];
    static double kept[LAB_LANES * LAB_SIZE];
    const int numbers[LAB_LANES] = {7, 8, 9, 10, 11, 12, 13, 14};
    unsigned seed = 4;
    const struct surroundings around = lab_surroundings(WIND_NONE, &seed);
    struct wisp wisps[LAB_LANES];
    struct lab_part part;
    for (int k = 0; k < LAB_LANES; k++)
        wisps[k] = rigid_wisp(9, 4, BENDING_SKIP, &seed);
    lab_part_make(&part, LAB_LANES, wisps, LAB_LANES, &around, WISP_GENERALISED);
    part.system.numbers = numbers;
    for (int k = 0; k < LAB_LANES; k++) {
        near_state(&wisps[k], WISP_GENERALISED, 1e-3, &seed, q, v);
        if (k == 2)
            for (int i = 0; i < part.size; i++) /* beyond all reach */
                q[i] *= 30;
        lab_scatter(&part, k, q, Q);
        lab_scatter(&part, k, v, V);
    }
    memcpy(kept, Q, sizeof kept);
    cr_assert_eq(system_project(&part.system, 0, Q, V), SOLVER_STALLED);
    cr_assert(strstr(part.system.reason, "wisp 9"), "%s", part.system.reason);
    cr_assert_eq(memcmp(kept, Q, sizeof kept), 0, "the state has changed");
    cr_assert_eq(kernel_8.project_lanes(part.system.ctx, 0, Q, V, 3), 0, "others are put back");
    memcpy(Q, kept, sizeof kept);
    Q[3 * LAB_LANES] = NAN;
    cr_assert_eq(system_project(&part.system, 0, Q, V), NOT_FINITE);
}
