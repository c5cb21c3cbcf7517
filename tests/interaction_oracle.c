#include "interaction_oracle.h"

#include "base/vector.h"
#include "support.h"
#include "wisp/section.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void twin_mean_velocity(const struct strand *s, int k, double v[3]) {
    const double m = wisp_node_mass(s->wisp, k), mu = wisp_sample_mass(s->wisp, k);
    memcpy(v, s->v[k], 3 * sizeof *v);
    for (int c = 0; c < 3 && k >= 2; c++) {
        double sum = m * v[c];
        for (int j = 0; j < s->wisp->samples; j++)
            sum += mu * s->ev[k * s->wisp->samples + j][c];
        v[c] = sum / (m + mu * s->wisp->samples);
    }
}

/* 1/m of a node with its samples, or of a sample; 0 where it is prescribed. */
static double inverse_mass(const struct strand *s, int k, int slot) {
    const double mu = wisp_sample_mass(s->wisp, k);
    return k < 2 ? 0 : slot ? 1 / mu : 1 / (wisp_node_mass(s->wisp, k) + mu * s->wisp->samples);
}

struct meeting {
    int a, i, b, k, slot;
    struct section_place place;
};

static int meets(const struct twin *t, struct meeting *m) {
    struct section section;
    const struct strand *s = t->strand[m->b];
    if (m->a == m->b && !(m->i < m->k - 2 || m->i > m->k + 1))
        return 0;
    section_make(&section, t->strand[m->a], m->i);
    return section_contains(
        &section, m->slot ? s->e[m->k * s->wisp->samples + m->slot - 1] : s->p[m->k], &m->place);
}

static double thickness(const struct strand *s, int i) {
    const struct wisp *w = s->wisp;
    double mean = 0;
    for (int k = i; k <= i + 1; k++)
        for (int j = 0; j < w->samples; j++)
            mean += pow(fmax(s->r[k * w->samples + j], 1e-3 * w->radius), 2) / (2 * w->samples);
    return fmin(4, w->radius * w->radius / mean) / pow(2, w->splits);
}

/* lambda and u' - u; returns 0 where there is no response. */
static int response(const struct twin *t, const struct meeting *m, double *lambda,
                    double change[3]) {
    const struct strand *A = t->strand[m->a], *B = t->strand[m->b];
    double axis[3], u[3], v0[3], v1[3], n[3], length = 0;
    const double *w = B->axis_w[m->k];
    for (int c = 0; c < 3; c++)
        axis[c] = A->p[m->i + 1][c] - A->p[m->i][c];
    length = sqrt(vector_dot(axis, axis));
    *lambda = m->place.x / length < 0 ? 0 : m->place.x / length > 1 ? 1 : m->place.x / length;
    twin_mean_velocity(A, m->i, v0);
    twin_mean_velocity(A, m->i + 1, v1);
    twin_mean_velocity(B, m->k, u);
    for (int c = 0; c < 3; c++) {
        axis[c] /= length;
        if (m->slot)
            u[c] = B->ev[m->k * B->wisp->samples + m->slot - 1][c];
        u[c] -= (1 - *lambda) * v0[c] + *lambda * v1[c];
    }
    for (int c = 0; c < 3; c++)
        n[c] = axis[(c + 1) % 3] * w[(c + 2) % 3] - axis[(c + 2) % 3] * w[(c + 1) % 3];
    const int closing = vector_dot(u, m->place.q) < 0;
    const double speed = sqrt(vector_dot(u, u)), sine = sqrt(vector_dot(n, n));
    const int through = speed < 1e-9 || fabs(vector_dot(n, u)) < t->set.threshold * speed;
    const double keep = exp(-t->set.viscosity * thickness(A, m->i) / t->set.rate);
    for (int c = 0; c < 3; c++)
        change[c] =
            !through
                ? -u[c]
                : keep * (u[c] -
                          (closing && sine > 0.05 ? vector_dot(u, n) / sine * n[c] / sine : 0)) -
                      u[c];
    return through ? t->set.interpenetration : closing && t->set.collision;
}

/* Whether a free node or sample of nodes i, i + 1 of A is in a section that node k of B bounds. */
static int mutual(const struct twin *t, const struct meeting *m) {
    for (int section = m->k - 1; section <= m->k && section < t->strand[m->b]->wisp->nodes - 1;
         section++)
        for (int node = m->i < 2 ? 2 : m->i; node <= m->i + 1; node++)
            for (int slot = 0; slot <= t->strand[m->a]->wisp->samples; slot++)
                if (meets(t, &(struct meeting){m->b, section, m->a, node, slot, {0, {0}}}))
                    return 1;
    return 0;
}

static void act(struct twin *t, const struct meeting *m, const double change[3], double lambda) {
    double *x = t->dv[m->b * TWIN_NODES + m->k][m->slot];
    double *ends[2] = {t->dv[m->a * TWIN_NODES + m->i][0], t->dv[m->a * TWIN_NODES + m->i + 1][0]};
    const double weight[2] = {1 - lambda, lambda};
    double sum = inverse_mass(t->strand[m->b], m->k, m->slot);
    const double of_point = sum;
    int most = t->shares[m->b * TWIN_NODES + m->k][m->slot];
    for (int e = 0; e < 2; e++) {
        sum += weight[e] * weight[e] * inverse_mass(t->strand[m->a], m->i + e, 0);
        if (m->i + e >= 2)
            most = (int)fmax(most, t->shares[m->a * TWIN_NODES + m->i + e][0]);
    }
    for (int c = 0; c < 3; c++) {
        if (!t->set.reciprocal) {
            x[c] +=
                change[c] / t->own[m->b * TWIN_NODES + m->k][m->slot] * (mutual(t, m) ? 0.5 : 1);
            continue;
        }
        const double impulse = change[c] / sum / most;
        x[c] += impulse * of_point;
        for (int e = 0; e < 2; e++)
            ends[e][c] -= weight[e] * impulse * inverse_mass(t->strand[m->a], m->i + e, 0);
    }
}

static void each_meeting(struct twin *t, int counting) {
    double lambda, change[3];
    struct meeting m;
    for (m.a = 0; m.a < t->count; m.a++)
        for (m.i = 1; m.i < t->strand[m.a]->wisp->nodes - 1; m.i++)
            for (m.b = 0; m.b < t->count; m.b++)
                for (m.k = 2; m.k < t->strand[m.b]->wisp->nodes; m.k++)
                    for (m.slot = 0; m.slot <= t->strand[m.b]->wisp->samples; m.slot++) {
                        if (!meets(t, &m) || !response(t, &m, &lambda, change))
                            continue;
                        if (!counting) {
                            act(t, &m, change, lambda);
                            continue;
                        }
                        t->own[m.b * TWIN_NODES + m.k][m.slot]++;
                        t->shares[m.b * TWIN_NODES + m.k][m.slot]++;
                        t->shares[m.a * TWIN_NODES + m.i][0]++;
                        t->shares[m.a * TWIN_NODES + m.i + 1][0]++;
                    }
}

void twin_tick(struct twin *t, struct strand *const *strand, int count,
               const struct interaction_settings *settings) {
    const size_t rows = (size_t)count * TWIN_NODES;
    *t = (struct twin){.strand = strand,
                       .count = count,
                       .set = *settings,
                       .dv = test_room(rows * sizeof *t->dv),
                       .shares = test_room(rows * sizeof *t->shares),
                       .own = test_room(rows * sizeof *t->own)};
    each_meeting(t, 1);
    each_meeting(t, 0);
}
