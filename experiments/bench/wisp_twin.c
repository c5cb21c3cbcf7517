#include "wisp_twin.h"

#include "wisp/body.h"

#include <math.h>
#include <string.h>

static inline double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double norm(const double a[3]) {
    return sqrt(dot(a, a));
}

static inline void cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* y += s x */
static inline void add(double y[3], double s, const double x[3]) {
    for (int k = 0; k < 3; k++)
        y[k] += s * x[k];
}

/* P x: x without its part along the unit vector n. */
static inline void across(const double x[3], const double n[3], double y[3]) {
    const double along = dot(x, n);
    for (int k = 0; k < 3; k++)
        y[k] = x[k] - along * n[k];
}

/* ---- Geometry and mass */

static void rest_position(const struct wisp_twin *twin, int node, double position[3]) {
    for (int k = 0; k < 3; k++)
        position[k] = twin->root[k] + node * twin->spacing * twin->direction[k];
}

static void set_masses(struct wisp_twin *twin, const struct wisp *wisp) {
    const int samples = twin->samples;
    const double share = samples > 0 ? wisp->mass_fraction : 0;
    const double omega = 2 * M_PI * wisp->frequency;
    for (int i = 2; i < twin->nodes; i++) {
        const double tributary = i == twin->nodes - 1 ? twin->spacing / 2 : twin->spacing;
        const double total = wisp->hair_count * wisp->hair_density * tributary;
        const double m = (1 - share) * total;
        twin->mass[i] = m;
        twin->inverse_mass[i] = 1 / m;
        twin->inverse_mass_along[i] = 1 / (m + share * total);
        twin->inverse_mass_across[i] = 1 / (m + share * total / 2);
        if (samples == 0)
            continue;
        const double mu = share * total / samples;
        const double k_e = mu * omega * omega, k_p = wisp->penalty_ratio * k_e;
        twin->sample_mass[i] = mu;
        twin->inverse_sample_mass[i] = 1 / mu;
        twin->envelope_constant[i] = k_e;
        twin->envelope_damping[i] = 2 * wisp->damping_ratio * omega * mu;
        twin->penalty_constant[i] = k_p;
        twin->penalty_damping[i] = 2 * sqrt(k_p * mu);
    }
}

/* ---- The state at hand: positions, velocities, segments */

static void unpack(const struct wisp_twin *twin, const double *x, wisp_twin_vectors nodes) {
    for (int i = 2; i < twin->nodes; i++, x += twin->unknowns)
        for (int k = 0; k < 3; k++)
            nodes[i][k] = x[k];
}

/* t_i and the length of segment i; -1 where there is no length. */
static int segment(struct wisp_twin *twin, int i) {
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = twin->position[i + 1][k] - twin->position[i][k];
    const double length = norm(d), inverse = 1 / length;
    twin->length[i] = length;
    twin->inverse_length[i] = inverse;
    for (int k = 0; k < 3; k++)
        twin->tangent[i][k] = inverse * d[k];
    return length == 0 ? -1 : 0;
}

/* The segments of free nodes: segment 0 is the head's. */
static int segments(struct wisp_twin *twin) {
    int status = 0;
    for (int i = 1; i < twin->nodes - 1; i++)
        status |= segment(twin, i);
    return status;
}

static int set_state(struct wisp_twin *twin, const double *q, const double *v) {
    unpack(twin, q, twin->position);
    unpack(twin, v, twin->velocity);
    return segments(twin);
}

/* ---- Forces on the skeleton (Plante 1999, section 4.1.1; gravity, air and wind besides) */

static void wind(const struct wisp_twin *twin, double t, double w[3]) {
    const struct wind *law = &twin->wind;
    double factor = 1;
    switch (law->kind) {
    case WIND_NONE:
        factor = 0;
        break;
    case WIND_STEADY:
        break;
    case WIND_GUST:
        if (t >= law->hold)
            factor = exp(-(t - law->hold) / law->decay);
        break;
    case WIND_IRREGULAR:
        for (int k = 0; k < law->terms; k++)
            factor += law->amplitude[k] * sin(twin->wind_angular_frequency[k] * t);
        break;
    }
    for (int k = 0; k < 3; k++)
        w[k] = factor * law->velocity[k];
}

/* Gravity, air and wind per mass, of a node or a sample with velocity v: g + gamma (w - v). */
static inline void outer(const struct wisp_twin *twin, const double w[3], const double v[3],
                         double acceleration[3]) {
    for (int k = 0; k < 3; k++)
        acceleration[k] = twin->gravity[k] + twin->drag_rate * (w[k] - v[k]);
}

/* The depth 1 - sigma of a point in a body, where sigma = sqrt(sum ((X - c)_k / R_k)^2), and the
 * gradient of sigma; 0 where it is outside, or at the centre, which has no gradient. */
static double depth_in(const struct wisp_twin *twin, const struct body *body, const double X[3],
                       double gradient[3]) {
    double from[3], square = 0;
    for (int k = 0; k < 3; k++) {
        from[k] = X[k] - (body->centre[k] + twin->t * body->velocity[k]);
        square += from[k] / body->radii[k] * (from[k] / body->radii[k]);
    }
    const double sigma = sqrt(square);
    if (sigma >= 1 || sigma < 1e-6)
        return 0;
    for (int k = 0; k < 3; k++)
        gradient[k] = from[k] / (body->radii[k] * body->radii[k]) / sigma;
    return 1 - sigma;
}

static inline double least_radius(const struct body *body) {
    return fmin(body->radii[0], fmin(body->radii[1], body->radii[2]));
}

/* Bodies that push by penalty: what they add to the acceleration of a node or sample at X with
 * velocity U (README.md: across the surface a spring and a damper that never pull, along
 * it friction, both growing from 0 within a twentieth of the body). */
static void bodies(const struct wisp_twin *twin, const double X[3], const double U[3],
                   double acceleration[3]) {
    for (int b = 0; b < twin->pushing_count; b++) {
        const struct body *body = &twin->pushing[b];
        const double omega = 2 * M_PI * body->frequency, least = least_radius(body);
        double gradient[3], n[3], u[3], slip[3];
        const double depth = depth_in(twin, body, X, gradient);
        if (depth == 0)
            continue;
        const double slope = norm(gradient), s = fmin(1, depth / 0.05);
        for (int k = 0; k < 3; k++) {
            n[k] = gradient[k] / slope;
            u[k] = U[k] - body->velocity[k];
        }
        across(u, n, slip);
        const double push = omega * omega * least * least * depth * slope -
                            2 * body->damping_ratio * omega * s * dot(u, n);
        add(acceleration, fmax(0, push), n);
        add(acceleration, -s * body->friction, slip);
    }
}

/* Its energy in them, by mass. */
static double energy_in_bodies(const struct wisp_twin *twin, const double X[3]) {
    double energy = 0;
    for (int b = 0; b < twin->pushing_count; b++) {
        const struct body *body = &twin->pushing[b];
        double gradient[3];
        const double depth = depth_in(twin, body, X, gradient);
        const double reach = 2 * M_PI * body->frequency * least_radius(body) * depth;
        energy += reach * reach / 2;
    }
    return energy;
}

/* Between nodes a and b in direction n: pulls a by [k (L - L0) + c (v_b - v_a).n] n, b back. */
static inline void spring_damper(struct wisp_twin *twin, int a, int b, const double n[3],
                                 double length, double rest, double k, double c) {
    const double *va = twin->velocity[a], *vb = twin->velocity[b];
    const double apart[3] = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
    const double pull = k * (length - rest) + c * dot(apart, n);
    add(twin->force[a], pull, n);
    add(twin->force[b], -pull, n);
}

static void stretch(struct wisp_twin *twin, double k, double c) {
    for (int i = 1; i < twin->nodes - 1; i++)
        spring_damper(twin, i, i + 1, twin->tangent[i], twin->length[i], twin->spacing, k, c);
}

/* n from node i to node i + 2, and the distance. */
static inline double skip_direction(const struct wisp_twin *twin, int i, double n[3]) {
    for (int k = 0; k < 3; k++)
        n[k] = twin->position[i + 2][k] - twin->position[i][k];
    const double length = norm(n), inverse = 1 / length;
    for (int k = 0; k < 3; k++)
        n[k] *= inverse;
    return length;
}

static int bend_skip(struct wisp_twin *twin, double k, double c) {
    int status = 0;
    for (int i = 0; i < twin->nodes - 2; i++) {
        double n[3];
        const double length = skip_direction(twin, i, n);
        if (length == 0)
            status = -1;
        spring_damper(twin, i, i + 2, n, length, 2 * twin->spacing, k, c);
    }
    return status;
}

/* Where the sine of the turning angle is not above this, the angle has no usable gradient. */
static const double straight = 1e-12;

/* The sine and cosine of the turning angle at node i. The sine from the vector product, since
 * sqrt(1 - cos^2) has no correct digit left below 1e-8. */
static inline double turning(const struct wisp_twin *twin, int i, double *cosine) {
    double product[3];
    cross(twin->tangent[i - 1], twin->tangent[i], product);
    *cosine = dot(twin->tangent[i - 1], twin->tangent[i]);
    return norm(product);
}

/* Gradients of the turning angle at node i with respect to nodes i - 1, i and i + 1. Turning t_i by
 * dt changes the angle by -(t_{i-1}.dt)/sin, moving p_{i+1} by dp changes t_i by P dp/L. */
static inline void angle_gradient(const struct wisp_twin *twin, int i, double sine, double cosine,
                                  double before[3], double here[3], double after[3]) {
    const double *t0 = twin->tangent[i - 1], *t1 = twin->tangent[i];
    const double s0 = twin->inverse_length[i - 1] / sine, s1 = twin->inverse_length[i] / sine;
    for (int k = 0; k < 3; k++) {
        before[k] = s0 * (t1[k] - cosine * t0[k]);
        after[k] = -s1 * (t0[k] - cosine * t1[k]);
        here[k] = -before[k] - after[k];
    }
}

/* Gradients of half the square of d(t_i - t_{i-1})/dt with respect to the velocities of nodes
 * i - 1, i and i + 1, with dt_i/dt = P (v_{i+1} - v_i)/L. */
static void straight_gradient(const struct wisp_twin *twin, int i, double before[3], double here[3],
                              double after[3]) {
    const double *v0 = twin->velocity[i - 1], *v1 = twin->velocity[i], *v2 = twin->velocity[i + 1];
    const double *t0 = twin->tangent[i - 1], *t1 = twin->tangent[i];
    const double s0 = twin->inverse_length[i - 1], s1 = twin->inverse_length[i];
    double d0[3], d1[3], rate0[3], rate1[3], rate[3];
    for (int k = 0; k < 3; k++) {
        d0[k] = s0 * (v1[k] - v0[k]);
        d1[k] = s1 * (v2[k] - v1[k]);
    }
    across(d0, t0, rate0);
    across(d1, t1, rate1);
    for (int k = 0; k < 3; k++)
        rate[k] = rate1[k] - rate0[k];
    across(rate, t0, before);
    across(rate, t1, after);
    for (int k = 0; k < 3; k++) {
        before[k] *= s0;
        after[k] *= s1;
        here[k] = -before[k] - after[k];
    }
}

static void bend_hinge(struct wisp_twin *twin, double kappa, double c) {
    for (int i = 1; i < twin->nodes - 1; i++) {
        double before[3], here[3], after[3], cosine, moment;
        const double sine = turning(twin, i, &cosine);
        if (sine <= straight) {
            straight_gradient(twin, i, before, here, after);
            moment = c;
        } else {
            angle_gradient(twin, i, sine, cosine, before, here, after);
            const double rate = dot(before, twin->velocity[i - 1]) + dot(here, twin->velocity[i]) +
                                dot(after, twin->velocity[i + 1]);
            moment = kappa * atan2(sine, cosine) + c * rate;
        }
        add(twin->force[i - 1], -moment, before);
        add(twin->force[i], -moment, here);
        add(twin->force[i + 1], -moment, after);
    }
}

static int bend(struct wisp_twin *twin, double k, double c) {
    if (twin->bending == BENDING_SKIP)
        return bend_skip(twin, k, c);
    if (twin->bending == BENDING_HINGE)
        bend_hinge(twin, k, c);
    return 0;
}

/* All terms on free nodes; what springs put on nodes 0 and 1 is not used. */
static int skeleton_forces(struct wisp_twin *twin, const double w[3]) {
    memset(twin->force, 0, (size_t)twin->nodes * sizeof twin->force[0]);
    for (int i = 2; i < twin->nodes; i++) {
        double acceleration[3];
        outer(twin, w, twin->velocity[i], acceleration);
        bodies(twin, twin->position[i], twin->velocity[i], acceleration);
        add(twin->force[i], twin->mass[i], acceleration);
    }
    stretch(twin, twin->stretch_constant, twin->stretch_damping);
    return bend(twin, twin->bend_constant, twin->bend_damping);
}

/* ---- The envelope's frames (Plante 1999, section 4.1.2) */

/* The unit normal of the bisector plane of free node i, or at the end of the last segment's. */
static inline void plane_normal(const struct wisp_twin *twin, int i, const double previous[3],
                                double w[3]) {
    const double *before = twin->tangent[i - 1];
    if (i == twin->nodes - 1) {
        memcpy(w, before, 3 * sizeof *w);
        return;
    }
    const double *after = twin->tangent[i];
    const double sum[3] = {before[0] + after[0], before[1] + after[1], before[2] + after[2]};
    const double length = norm(sum);
    if (length <= 1e-9) {
        memcpy(w, previous, 3 * sizeof *w);
        return;
    }
    const double inverse = 1 / length;
    for (int k = 0; k < 3; k++)
        w[k] = inverse * sum[k];
}

/* u turned by the least rotation that takes w0 to w1. */
static inline void least_rotation(const double u0[3], const double w0[3], const double w1[3],
                                  double u1[3]) {
    const double denominator = 1 + dot(w0, w1);
    const double s = denominator <= 1e-9 ? 0 : dot(u0, w1) / denominator;
    for (int k = 0; k < 3; k++)
        u1[k] = u0[k] - s * (w0[k] + w1[k]);
}

static void frames(struct wisp_twin *twin) {
    for (int i = 2; i < twin->nodes; i++) {
        double *u = twin->frame_u[i], *v = twin->frame_v[i], *w = twin->frame_w[i];
        plane_normal(twin, i, twin->frame_w[i - 1], w);
        least_rotation(twin->frame_u[i - 1], twin->frame_w[i - 1], w, u);
        cross(w, u, v);
    }
}

/* Nodes 0 and 1: where they are, their segment and their frame. */
static void place_head(struct wisp_twin *twin) {
    for (int i = 0; i < 2; i++) {
        rest_position(twin, i, twin->position[i]);
        memset(twin->velocity[i], 0, sizeof twin->velocity[i]);
    }
    segment(twin, 0);
    const double *t0 = twin->tangent[0];
    const int axis = fabs(t0[1]) > 0.9 ? 0 : 1;
    const double h[3] = {axis == 0, axis == 1, 0};
    for (int i = 0; i < 2; i++) {
        double *u = twin->frame_u[i];
        across(h, t0, u);
        const double inverse = 1 / norm(u);
        for (int k = 0; k < 3; k++)
            u[k] *= inverse;
        memcpy(twin->frame_w[i], t0, sizeof twin->frame_w[i]);
        cross(t0, u, twin->frame_v[i]);
    }
}

/* a_ij, the direction of the half-line of sample j at node i. */
static inline void half_line(const struct wisp_twin *twin, int i, int j, double a[3]) {
    for (int k = 0; k < 3; k++)
        a[k] = twin->cosine[j] * twin->frame_u[i][k] + twin->sine[j] * twin->frame_v[i][k];
}

/* ---- The treatments, for one free node (Plante 1999, section 4.2.1, which takes `projection`; 6.1
 * for springs in place of constraints).
 * r and rate (e and e_rate) are the node's samples in q and v; the force of the skeleton is known;
 * the accelerations go to node and sample. */

/* s = k_e (R - r) - c_e r' */
static inline double envelope_spring(const struct wisp_twin *twin, int i, double r, double rate) {
    return twin->envelope_constant[i] * (twin->radius - r) - twin->envelope_damping[i] * rate;
}

/* What bodies do to a sample r a from its node, a moving with r' a from it. */
static void bodies_on_line(const struct wisp_twin *twin, int i, const double a[3], double r,
                           double rate, double acceleration[3]) {
    double X[3], U[3];
    for (int k = 0; k < 3; k++) {
        X[k] = twin->position[i][k] + r * a[k];
        U[k] = twin->velocity[i][k] + rate * a[k];
        acceleration[k] = 0;
    }
    bodies(twin, X, U, acceleration);
}

static void projection(const struct wisp_twin *twin, int i, const double w[3], const double *r,
                       const double *rate, double *node, double *sample) {
    double force[3] = {twin->force[i][0], twin->force[i][1], twin->force[i][2]}, push[3];
    outer(twin, w, twin->velocity[i], push);
    for (int j = 0; j < twin->samples; j++) {
        double a[3], body[3];
        half_line(twin, i, j, a);
        bodies_on_line(twin, i, a, r[j], rate[j], body);
        const double s = envelope_spring(twin, i, r[j], rate[j]);
        /* F.a/mu: the drag of r' a is all along a */
        const double push_along = dot(push, a) - twin->drag_rate * rate[j] + dot(body, a);
        sample[j] = s * twin->inverse_sample_mass[i] + push_along;
        add(force, -s, a);
    }
    for (int k = 0; k < 3; k++)
        node[k] = force[k] * twin->inverse_mass[i];
}

static void penalty(const struct wisp_twin *twin, int i, const double w[3], const double *e,
                    const double *e_rate, double *node, double *sample) {
    const double *p = twin->position[i], *v = twin->velocity[i];
    const double k_p = twin->penalty_constant[i], c_p = twin->penalty_damping[i];
    double force[3] = {twin->force[i][0], twin->force[i][1], twin->force[i][2]};
    for (int j = 0; j < twin->samples; j++, e += 3, e_rate += 3, sample += 3) {
        const double d[3] = {e[0] - p[0], e[1] - p[1], e[2] - p[2]};
        const double d_rate[3] = {e_rate[0] - v[0], e_rate[1] - v[1], e_rate[2] - v[2]};
        double a[3], off[3], off_rate[3], push[3];
        half_line(twin, i, j, a);
        const double s = envelope_spring(twin, i, dot(d, a), dot(d_rate, a));
        across(d, a, off);
        across(d_rate, a, off_rate);
        outer(twin, w, e_rate, push);
        bodies(twin, e, e_rate, push);
        for (int k = 0; k < 3; k++) {
            const double springs = s * a[k] - k_p * off[k] - c_p * off_rate[k];
            sample[k] = springs * twin->inverse_sample_mass[i] + push[k];
            force[k] -= springs;
        }
    }
    for (int k = 0; k < 3; k++)
        node[k] = force[k] * twin->inverse_mass[i];
}

static void generalised(const struct wisp_twin *twin, int i, const double w[3], const double *r,
                        const double *rate, double *node, double *sample) {
    double force[3] = {twin->force[i][0], twin->force[i][1], twin->force[i][2]};
    double push[3], along[SAMPLES_MAX][3];
    outer(twin, w, twin->velocity[i], push);
    for (int j = 0; j < twin->samples; j++) {
        double *a = along[j], push_across[3], body[3];
        half_line(twin, i, j, a);
        bodies_on_line(twin, i, a, r[j], rate[j], body);
        add(body, 1, push);
        const double s = envelope_spring(twin, i, r[j], rate[j]);
        /* P F: the drag of r' a has no part in it */
        across(body, a, push_across);
        add(force, -s, a);
        add(force, twin->sample_mass[i], push_across);
        sample[j] = s * twin->inverse_sample_mass[i] + dot(body, a) - twin->drag_rate * rate[j];
    }
    /* The matrix m I + mu sum P has w as an eigenvector, and all that is across it. */
    const double *normal = twin->frame_w[i];
    const double across_w = twin->inverse_mass_across[i];
    const double along_w = (twin->inverse_mass_along[i] - across_w) * dot(force, normal);
    for (int k = 0; k < 3; k++)
        node[k] = across_w * force[k] + along_w * normal[k];
    for (int j = 0; j < twin->samples; j++)
        sample[j] -= dot(node, along[j]);
}

static void accelerations(const struct wisp_twin *twin, const double w[3], const double *q,
                          const double *v, double *a) {
    for (int i = 2; i < twin->nodes; i++) {
        switch (twin->treatment) {
        case WISP_PROJECTION:
            projection(twin, i, w, q + 3, v + 3, a, a + 3);
            break;
        case WISP_PENALTY:
            penalty(twin, i, w, q + 3, v + 3, a, a + 3);
            break;
        case WISP_GENERALISED:
            generalised(twin, i, w, q + 3, v + 3, a, a + 3);
            break;
        }
        q += twin->unknowns, v += twin->unknowns, a += twin->unknowns;
    }
}

/* ---- Rigid segments: all accelerations and all tensions from one dense system */

enum { DENSE_MAX = 4 * WISP_TWIN_NODES_MAX };

/* Solves A x = b, n equations, x in b's place, by elimination with the largest pivot. */
static int solve_dense(int n, double (*A)[DENSE_MAX], double *b) {
    for (int c = 0; c < n; c++) {
        int best = c;
        for (int r = c + 1; r < n; r++)
            if (fabs(A[r][c]) > fabs(A[best][c]))
                best = r;
        if (!(fabs(A[best][c]) > 0))
            return -1;
        for (int k = 0; k < n && best != c; k++) {
            const double kept = A[c][k];
            A[c][k] = A[best][k];
            A[best][k] = kept;
        }
        const double kept = b[c];
        b[c] = b[best];
        b[best] = kept;
        for (int r = c + 1; r < n; r++) {
            const double factor = A[r][c] / A[c][c];
            for (int k = c; k < n; k++)
                A[r][k] -= factor * A[c][k];
            b[r] -= factor * b[c];
        }
    }
    for (int c = n - 1; c >= 0; c--) {
        for (int k = c + 1; k < n; k++)
            b[c] -= A[c][k] * b[k];
        b[c] /= A[c][c];
    }
    return 0;
}

/* Entry of a node's mass: m, or m along w and across it with the samples that go along. */
static double mass_entry(const struct wisp_twin *twin, int i, int r, int c) {
    if (twin->samples == 0 || twin->treatment != WISP_GENERALISED)
        return r == c ? twin->mass[i] : 0;
    const double *w = twin->frame_w[i], across_w = 1 / twin->inverse_mass_across[i];
    return (r == c ? across_w : 0) + (1 / twin->inverse_mass_along[i] - across_w) * w[r] * w[c];
}

/* Changes accelerations without tensions by b_i = B_i^-1 (tension_i t_i - tension_(i-1) t_(i-1))
 * such that t_i.(a_(i+1) - a_i) is what keeps the length of a segment that turns; node 1 rests. In
 * `generalised` a sample's rate on its line loses what its node gains along it. */
static int add_tensions(const struct wisp_twin *twin, double *a) {
    static double A[DENSE_MAX][DENSE_MAX], x[DENSE_MAX];
    const int free = twin->nodes - 2, places = 3 * free, n = places + free;
    memset(A, 0, sizeof A);
    memset(x, 0, sizeof x);
    for (int i = 0; i < free; i++) /* the equation of node i + 2 */
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++)
                A[3 * i + r][3 * i + c] = mass_entry(twin, i + 2, r, c);
            A[3 * i + r][places + i] = twin->tangent[i + 1][r];
            if (i + 1 < free)
                A[3 * i + r][places + i + 1] = -twin->tangent[i + 2][r];
        }
    for (int i = 0; i < free; i++) { /* of the segment that ends there */
        const double *t = twin->tangent[i + 1], *here = a + i * twin->unknowns;
        const double *va = twin->velocity[i + 1], *vb = twin->velocity[i + 2];
        const double apart[3] = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
        double turning[3];
        across(apart, t, turning);
        x[places + i] = -dot(turning, turning) * twin->inverse_length[i + 1] - dot(t, here);
        if (i > 0)
            x[places + i] += dot(t, here - twin->unknowns);
        for (int k = 0; k < 3; k++) {
            A[places + i][3 * i + k] = t[k];
            if (i > 0)
                A[places + i][3 * (i - 1) + k] = -t[k];
        }
    }
    if (solve_dense(n, A, x) != 0)
        return -1;
    for (int i = 0; i < free; i++, a += twin->unknowns) {
        add(a, 1, &x[3 * i]);
        for (int j = 0; j < twin->samples && twin->treatment == WISP_GENERALISED; j++) {
            double line[3];
            half_line(twin, i + 2, j, line);
            a[3 + j] -= dot(line, &x[3 * i]);
        }
    }
    return 0;
}

/* ---- Energy */

static double stretch_energy(const struct wisp_twin *twin) {
    double energy = 0;
    for (int i = 1; i < twin->nodes - 1; i++) {
        const double longer = twin->length[i] - twin->spacing;
        energy += twin->stretch_constant / 2 * longer * longer;
    }
    return energy;
}

static double bend_energy(const struct wisp_twin *twin) {
    double energy = 0;
    for (int i = 0; twin->bending == BENDING_SKIP && i < twin->nodes - 2; i++) {
        double n[3];
        const double longer = skip_direction(twin, i, n) - 2 * twin->spacing;
        energy += twin->bend_constant / 2 * longer * longer;
    }
    for (int i = 1; twin->bending == BENDING_HINGE && i < twin->nodes - 1; i++) {
        double cosine;
        const double sine = turning(twin, i, &cosine), angle = atan2(sine, cosine);
        energy += twin->bend_constant / 2 * angle * angle;
    }
    return energy;
}

/* Kinetic and gravitational. */
static double mass_energy(const struct wisp_twin *twin, double mass, const double position[3],
                          const double velocity[3]) {
    return mass * (dot(velocity, velocity) / 2 - dot(twin->gravity, position) +
                   energy_in_bodies(twin, position));
}

/* All of a sample: x and rate are its r and r', or its e and e'. */
static double sample_energy(const struct wisp_twin *twin, int i, int j, const double *x,
                            const double *rate) {
    const double mu = twin->sample_mass[i], k_e = twin->envelope_constant[i];
    const double *p = twin->position[i];
    double a[3];
    half_line(twin, i, j, a);
    if (twin->treatment == WISP_PENALTY) {
        const double d[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
        const double longer = dot(d, a) - twin->radius;
        double off[3];
        across(d, a, off);
        return mass_energy(twin, mu, x, rate) + k_e / 2 * longer * longer +
               twin->penalty_constant[i] / 2 * dot(off, off);
    }
    double position[3] = {p[0], p[1], p[2]};
    double velocity[3] = {twin->velocity[i][0], twin->velocity[i][1], twin->velocity[i][2]};
    add(position, x[0], a);
    add(velocity, rate[0], a);
    const double longer = x[0] - twin->radius;
    return mass_energy(twin, mu, position, velocity) + k_e / 2 * longer * longer;
}

static double energy_of_state(const struct wisp_twin *twin, const double *q, const double *v) {
    const int coordinates = twin->treatment == WISP_PENALTY ? 3 : 1;
    double energy = stretch_energy(twin) + bend_energy(twin);
    for (int i = 2; i < twin->nodes; i++) {
        energy += mass_energy(twin, twin->mass[i], twin->position[i], twin->velocity[i]);
        for (int j = 0; j < twin->samples; j++)
            energy += sample_energy(twin, i, j, q + 3 + coordinates * j, v + 3 + coordinates * j);
        q += twin->unknowns, v += twin->unknowns;
    }
    return energy;
}

/* ---- Scale: the terms above, each by its absolute value.
 * Where a quantity x that is multiplied by y carries an error of eps X, the scale of the product is
 * X |y| + |x| Y. `force` holds scales here. */

static double sum_of(const double x[3]) {
    return x[0] + x[1] + x[2];
}

static double absolute_dot(const double a[3], const double b[3]) {
    return fabs(a[0] * b[0]) + fabs(a[1] * b[1]) + fabs(a[2] * b[2]);
}

static void wind_scale(const struct wisp_twin *twin, double w[3]) {
    double factor = twin->wind.kind == WIND_NONE ? 0 : 1;
    for (int k = 0; twin->wind.kind == WIND_IRREGULAR && k < twin->wind.terms; k++)
        factor += fabs(twin->wind.amplitude[k]);
    for (int k = 0; k < 3; k++)
        w[k] = factor * fabs(twin->wind.velocity[k]);
}

static void outer_scale(const struct wisp_twin *twin, const double w_scale[3], const double v[3],
                        double scale[3]) {
    for (int k = 0; k < 3; k++)
        scale[k] = fabs(twin->gravity[k]) + twin->drag_rate * (w_scale[k] + fabs(v[k]));
}

/* The depth's own error is that of sigma, which is about 1; the normal's is as a frame's. */
static void bodies_scale(const struct wisp_twin *twin, const double X[3], const double U[3],
                         double scale[3]) {
    for (int b = 0; b < twin->pushing_count; b++) {
        const struct body *body = &twin->pushing[b];
        const double omega = 2 * M_PI * body->frequency, least = least_radius(body);
        double gradient[3], u = 0;
        const double depth = depth_in(twin, body, X, gradient);
        for (int k = 0; k < 3; k++)
            u += fabs(U[k]) + fabs(body->velocity[k]);
        if (depth == 0)
            continue;
        const double damper = 2 * body->damping_ratio * omega + body->friction;
        /* s is depth / 0.05, and the gradient's direction is that of X - c, near the centre noise
         */
        const double all = omega * omega * least * least * norm(gradient) + 20 * damper * u;
        for (int k = 0; k < 3; k++)
            scale[k] += all / (1 - depth);
    }
}

static void spring_damper_scale(struct wisp_twin *twin, int a, int b, const double n[3],
                                double length, double rest, double k, double c) {
    const double pull = k * (length + rest) + c * (absolute_dot(twin->velocity[a], n) +
                                                   absolute_dot(twin->velocity[b], n));
    for (int m = 0; m < 3; m++) {
        twin->force[a][m] += pull * fabs(n[m]);
        twin->force[b][m] += pull * fabs(n[m]);
    }
}

/* The gradients g of the angle are differences of nearly equal vectors where the wisp is nearly
 * straight: their scale G is about 1/sin times larger than they are. The angle's own error is about
 * that of the tangents. */
static void bend_hinge_scale(struct wisp_twin *twin) {
    const double kappa = twin->bend_constant, c = twin->bend_damping;
    for (int i = 1; i < twin->nodes - 1; i++) {
        double cosine, g[3][3], scale[3][3], moment, moment_scale;
        const double sine = turning(twin, i, &cosine);
        if (sine <= straight) {
            const double s0 = twin->inverse_length[i - 1], s1 = twin->inverse_length[i];
            double v[3];
            for (int k = 0; k < 3; k++)
                v[k] = fabs(twin->velocity[i - 1][k]) * s0 +
                       fabs(twin->velocity[i][k]) * (s0 + s1) + fabs(twin->velocity[i + 1][k]) * s1;
            for (int k = 0; k < 3; k++) {
                scale[0][k] = s0 * sum_of(v);
                scale[2][k] = s1 * sum_of(v);
                scale[1][k] = scale[0][k] + scale[2][k];
            }
            memset(g, 0, sizeof g);
            moment = c;
            moment_scale = c;
        } else {
            angle_gradient(twin, i, sine, cosine, g[0], g[1], g[2]);
            const double *t0 = twin->tangent[i - 1], *t1 = twin->tangent[i];
            for (int k = 0; k < 3; k++) {
                const double both = (fabs(t0[k]) + fabs(t1[k])) / sine;
                scale[0][k] = both * twin->inverse_length[i - 1];
                scale[2][k] = both * twin->inverse_length[i];
                scale[1][k] = scale[0][k] + scale[2][k];
            }
            const double angle = atan2(sine, cosine);
            double rate = 0, rate_scale = 0;
            for (int m = 0; m < 3; m++) {
                rate += dot(g[m], twin->velocity[i - 1 + m]);
                rate_scale += absolute_dot(scale[m], twin->velocity[i - 1 + m]);
            }
            moment = kappa * angle + c * fabs(rate);
            moment_scale = kappa * (1 + angle) + c * rate_scale;
        }
        for (int m = 0; m < 3; m++)
            for (int k = 0; k < 3; k++)
                twin->force[i - 1 + m][k] += moment * scale[m][k] + moment_scale * fabs(g[m][k]);
    }
}

static void skeleton_scale(struct wisp_twin *twin, const double w_scale[3]) {
    memset(twin->force, 0, sizeof twin->force);
    for (int i = 2; i < twin->nodes; i++) {
        double push[3];
        outer_scale(twin, w_scale, twin->velocity[i], push);
        bodies_scale(twin, twin->position[i], twin->velocity[i], push);
        add(twin->force[i], twin->mass[i], push);
    }
    for (int i = 1; i < twin->nodes - 1; i++)
        spring_damper_scale(twin, i, i + 1, twin->tangent[i], twin->length[i], twin->spacing,
                            twin->stretch_constant, twin->stretch_damping);
    for (int i = 0; twin->bending == BENDING_SKIP && i < twin->nodes - 2; i++) {
        double n[3];
        const double length = skip_direction(twin, i, n);
        spring_damper_scale(twin, i, i + 2, n, length, 2 * twin->spacing, twin->bend_constant,
                            twin->bend_damping);
    }
    if (twin->bending == BENDING_HINGE)
        bend_hinge_scale(twin);
}

static double envelope_spring_scale(const struct wisp_twin *twin, int i, double r, double rate) {
    return twin->envelope_constant[i] * (twin->radius + r) + twin->envelope_damping[i] * rate;
}

/* `projection` and `generalised`. */
static void half_line_scale(const struct wisp_twin *twin, int i, const double w_scale[3],
                            const double *r, const double *rate, double *node, double *sample) {
    const int coupled = twin->treatment == WISP_GENERALISED;
    double force[3] = {twin->force[i][0], twin->force[i][1], twin->force[i][2]};
    for (int j = 0; j < twin->samples; j++) {
        double a[3], X[3], U[3], push[3];
        half_line(twin, i, j, a);
        for (int k = 0; k < 3; k++) {
            X[k] = twin->position[i][k] + r[j] * a[k];
            U[k] = twin->velocity[i][k] + rate[j] * a[k];
        }
        outer_scale(twin, w_scale, twin->velocity[i], push);
        bodies_scale(twin, X, U, push);
        const double s = envelope_spring_scale(twin, i, fabs(r[j]), fabs(rate[j]));
        sample[j] =
            s * twin->inverse_sample_mass[i] + sum_of(push) + twin->drag_rate * fabs(rate[j]);
        for (int k = 0; k < 3; k++)
            force[k] += s + coupled * twin->sample_mass[i] * (push[k] + sum_of(push));
    }
    const double inverse = coupled ? twin->inverse_mass_across[i] : twin->inverse_mass[i];
    const double extra = coupled ? inverse - twin->inverse_mass_along[i] : 0;
    for (int k = 0; k < 3; k++)
        node[k] = inverse * force[k] + extra * sum_of(force);
    for (int j = 0; coupled && j < twin->samples; j++)
        sample[j] += sum_of(node);
}

static void penalty_scale(const struct wisp_twin *twin, int i, const double w_scale[3],
                          const double *e, const double *e_rate, double *node, double *sample) {
    const double *p = twin->position[i], *v = twin->velocity[i];
    const double k_p = twin->penalty_constant[i], c_p = twin->penalty_damping[i];
    double force[3] = {twin->force[i][0], twin->force[i][1], twin->force[i][2]};
    for (int j = 0; j < twin->samples; j++, e += 3, e_rate += 3, sample += 3) {
        double d[3], d_rate[3], push[3];
        for (int k = 0; k < 3; k++) {
            d[k] = fabs(e[k] - p[k]); /* exact but for the last digit */
            d_rate[k] = fabs(e_rate[k]) + fabs(v[k]);
        }
        const double s = envelope_spring_scale(twin, i, sum_of(d), sum_of(d_rate));
        outer_scale(twin, w_scale, e_rate, push);
        bodies_scale(twin, e, e_rate, push);
        for (int k = 0; k < 3; k++) {
            const double springs =
                s + k_p * (d[k] + sum_of(d)) + c_p * (d_rate[k] + sum_of(d_rate));
            sample[k] = springs * twin->inverse_sample_mass[i] + push[k];
            force[k] += springs;
        }
    }
    for (int k = 0; k < 3; k++)
        node[k] = force[k] * twin->inverse_mass[i];
}

/* ---- The interface */

static int is_wisp(const struct wisp *wisp) {
    return wisp->nodes >= 3 && wisp->nodes <= WISP_TWIN_NODES_MAX && wisp->length > 0 &&
           (wisp->samples == 0 || (wisp->samples >= 3 && wisp->samples <= SAMPLES_MAX &&
                                   wisp->mass_fraction > 0 && wisp->mass_fraction < 1)) &&
           wisp->hair_count > 0 && wisp->hair_density > 0 && norm(wisp->direction) > 0;
}

int wisp_twin_init(struct wisp_twin *twin, const struct wisp *wisp,
                   const struct surroundings *surroundings, enum wisp_treatment treatment) {
    memset(twin, 0, sizeof *twin);
    if (!is_wisp(wisp))
        return -1;
    const double l = wisp->length / (wisp->nodes - 1), theta = wisp->bending_angle;
    twin->nodes = wisp->nodes;
    twin->samples = wisp->samples;
    twin->treatment = treatment;
    twin->unknowns = 3 + (treatment == WISP_PENALTY ? 3 : 1) * wisp->samples;
    memcpy(twin->root, wisp->root, sizeof twin->root);
    memcpy(twin->direction, wisp->direction, sizeof twin->direction);
    twin->spacing = l;

    memcpy(twin->gravity, surroundings->gravity, sizeof twin->gravity);
    twin->drag_rate = wisp->drag_rate;
    twin->pushing = surroundings->pushing;
    twin->pushing_count = surroundings->pushing_count;
    twin->wind = surroundings->wind;
    for (int k = 0; k < WIND_TERMS_MAX; k++)
        twin->wind_angular_frequency[k] = 2 * M_PI * surroundings->wind.frequency[k];

    twin->stretch_constant = wisp->stretch_stiffness / l;
    twin->stretch_damping = wisp->stretch_time * twin->stretch_constant;
    twin->stretch = wisp->stretch;
    twin->bending = wisp->bending;
    if (wisp->bending == BENDING_SKIP)
        twin->bend_constant = 16 * wisp->bending_stiffness / (l * l * l * theta * theta);
    else if (wisp->bending == BENDING_HINGE)
        twin->bend_constant = wisp->bending_stiffness / l;
    twin->bend_damping = wisp->bending_time * twin->bend_constant;

    twin->radius = wisp->radius;
    for (int j = 0; j < wisp->samples; j++) {
        twin->cosine[j] = cos(2 * M_PI * j / wisp->samples);
        twin->sine[j] = sin(2 * M_PI * j / wisp->samples);
    }
    set_masses(twin, wisp);
    place_head(twin);
    return 0;
}

int wisp_twin_size(const struct wisp_twin *twin) {
    return (twin->nodes - 2) * twin->unknowns;
}

/* On a straight wisp the frame is the same everywhere: node 1's. */
void wisp_twin_rest(const struct wisp_twin *twin, double *q, double *v) {
    memset(v, 0, (size_t)wisp_twin_size(twin) * sizeof *v);
    for (int i = 2; i < twin->nodes; i++, q += twin->unknowns) {
        rest_position(twin, i, q);
        for (int j = 0; j < twin->samples; j++) {
            if (twin->treatment != WISP_PENALTY) {
                q[3 + j] = twin->radius;
                continue;
            }
            double *e = q + 3 + 3 * j, a[3];
            half_line(twin, 1, j, a);
            memcpy(e, q, 3 * sizeof *e);
            add(e, twin->radius, a);
        }
    }
}

int wisp_twin_acceleration(struct wisp_twin *twin, double t, const double *q, const double *v,
                           double *a) {
    double w[3];
    twin->t = t;
    wind(twin, t, w);
    if (set_state(twin, q, v) != 0 || skeleton_forces(twin, w) != 0)
        return -1;
    if (twin->samples > 0)
        frames(twin);
    accelerations(twin, w, q, v, a);
    return twin->stretch == STRETCH_RIGID ? add_tensions(twin, a) : 0;
}

/* Rows 0 and 1 stay the head's: no force depends on them. */
static void set_frames(struct wisp_twin *twin, const double (*u)[3], const double (*v)[3],
                       const double (*w)[3]) {
    for (int i = 2; i < twin->nodes; i++)
        for (int k = 0; k < 3; k++) {
            twin->frame_u[i][k] = u[i][k];
            twin->frame_v[i][k] = v[i][k];
            twin->frame_w[i][k] = w[i][k];
        }
}

int wisp_twin_acceleration_frozen(struct wisp_twin *twin, double t, const double *q,
                                  const double *v, const double (*u)[3],
                                  const double (*v_normal)[3], const double (*w)[3], double *a) {
    double air[3];
    twin->t = t;
    wind(twin, t, air);
    if (set_state(twin, q, v) != 0 || skeleton_forces(twin, air) != 0)
        return -1;
    set_frames(twin, u, v_normal, w);
    accelerations(twin, air, q, v, a);
    return 0;
}

void wisp_twin_frames(struct wisp_twin *twin, const double *q, double (*u)[3], double (*v)[3],
                      double (*w)[3]) {
    const size_t bytes = (size_t)twin->nodes * sizeof *u;
    unpack(twin, q, twin->position);
    segments(twin);
    frames(twin);
    memcpy(u, twin->frame_u, bytes);
    memcpy(v, twin->frame_v, bytes);
    memcpy(w, twin->frame_w, bytes);
}

double wisp_twin_energy(struct wisp_twin *twin, double t, const double *q, const double *v) {
    twin->t = t;
    set_state(twin, q, v);
    frames(twin);
    return energy_of_state(twin, q, v);
}

double wisp_twin_energy_frozen(struct wisp_twin *twin, double t, const double *q, const double *v,
                               const double (*u)[3], const double (*v_normal)[3],
                               const double (*w)[3]) {
    twin->t = t;
    set_state(twin, q, v);
    set_frames(twin, u, v_normal, w);
    return energy_of_state(twin, q, v);
}

void wisp_twin_scale(struct wisp_twin *twin, double t, const double *q, const double *v,
                     double *scale) {
    double w_scale[3];
    twin->t = t;
    wind_scale(twin, w_scale);
    set_state(twin, q, v);
    skeleton_scale(twin, w_scale);
    for (int i = 2; i < twin->nodes; i++) {
        if (twin->treatment == WISP_PENALTY)
            penalty_scale(twin, i, w_scale, q + 3, v + 3, scale, scale + 3);
        else
            half_line_scale(twin, i, w_scale, q + 3, v + 3, scale, scale + 3);
        q += twin->unknowns, v += twin->unknowns, scale += twin->unknowns;
    }
}

int wisp_twin_spring_forces(struct wisp_twin *twin, enum wisp_twin_term term, unsigned parts,
                            const double *q, const double *v, double *f) {
    const double elastic = (parts & WISP_TWIN_ELASTIC) != 0,
                 damping = (parts & WISP_TWIN_DAMPING) != 0;
    const size_t bytes = (size_t)twin->nodes * sizeof twin->force[0];
    int status = set_state(twin, q, v);
    memset(twin->force, 0, bytes);
    if (term == WISP_TWIN_STRETCH)
        stretch(twin, elastic * twin->stretch_constant, damping * twin->stretch_damping);
    else
        status |= bend(twin, elastic * twin->bend_constant, damping * twin->bend_damping);
    memcpy(f, twin->force, bytes);
    return status;
}
