#include "strand.h"

#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- making one --- */

/* Behind arrays of three numbers is room for one more: whoever fills them four numbers at a time,
 * in their order, may do so to the end. */
enum { STRAND_SPARE = 1 };

struct strand *strand_create(const struct wisp *wisp, enum wisp_treatment treatment) {
    const size_t n = (size_t)wisp->nodes, samples = n * (size_t)wisp->samples;
    const size_t node_numbers = 3 * n + STRAND_SPARE, sample_numbers = 3 * samples + STRAND_SPARE;
    const size_t numbers =
        5 * node_numbers + 2 * sample_numbers + 2 * samples + 2 * (size_t)wisp->samples;
    struct strand *s = calloc(1, sizeof *s + numbers * sizeof(double));
    if (!s)
        return NULL;
    double *at = (double *)(s + 1);
    double(**const by_node[])[3] = {&s->p, &s->v, &s->axis_u, &s->axis_v, &s->axis_w};
    double(**const by_sample[])[3] = {&s->e, &s->ev};
    for (int i = 0; i < 5; i++, at += node_numbers)
        *by_node[i] = (double(*)[3])at;
    for (int i = 0; i < 2; i++, at += sample_numbers)
        *by_sample[i] = (double(*)[3])at;
    s->r = at;
    s->rate = at + samples;
    s->turn = (double(*)[2])(at + 2 * samples);
    for (int j = 0; j < wisp->samples; j++) {
        const double angle = 2 * M_PI * j / wisp->samples;
        s->turn[j][0] = cos(angle);
        s->turn[j][1] = sin(angle);
    }
    s->wisp = wisp;
    s->treatment = treatment;
    for (int k = 0; k < 3; k++)
        s->head[k][k] = 1;
    return s;
}

void strand_turn(struct strand *s, const struct placement *head) {
    memcpy(s->head, head->turn[0], sizeof s->head);
}

/* u_0 across the tangent, by the axes of the head: as if at rest, from a tangent turned back. */
static void first_normal(const struct strand *s, const double tangent[3], double normal[3]) {
    double rest[3] = {0}, u[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            rest[k] += s->head[i][k] * tangent[i];
    wisp_first_normal(rest, u);
    for (int i = 0; i < 3; i++)
        normal[i] = vector_dot(s->head[i], u);
}

void strand_free(struct strand *strand) {
    free(strand);
}

/* --- frames (section 4.1.2 of the thesis, as in kernel/frames.h) --- */

static void tangent(const struct strand *s, int segment, double t[3]) {
    for (int k = 0; k < 3; k++)
        t[k] = s->p[segment + 1][k] - s->p[segment][k];
    vector_normalise(t);
}

/* w_i from the tangents before and after node i. */
static void plane_normal(struct strand *s, int i, const double before[3], const double after[3]) {
    double sum[3] = {before[0] + after[0], before[1] + after[1], before[2] + after[2]};
    if (sqrt(vector_dot(sum, sum)) > 1e-9)
        vector_normalise(sum);
    else
        memcpy(sum, s->axis_w[i - 1], sizeof sum);
    memcpy(s->axis_w[i], sum, sizeof sum);
}

/* u_i from u_(i-1) by the least rotation from w_(i-1) to w_i. */
static void carry(struct strand *s, int i) {
    const double *w = s->axis_w[i], *w_before = s->axis_w[i - 1], *u_before = s->axis_u[i - 1];
    const double denominator = 1 + vector_dot(w_before, w);
    memcpy(s->axis_u[i], u_before, 3 * sizeof(double));
    if (denominator > 1e-9) {
        const double factor = -vector_dot(u_before, w) / denominator;
        vector_add(s->axis_u[i], factor, w_before);
        vector_add(s->axis_u[i], factor, w);
    }
    vector_cross(w, s->axis_u[i], s->axis_v[i]);
}

static void refresh_frames(struct strand *s) {
    double before[3], after[3];
    const int last = s->wisp->nodes - 1;
    tangent(s, 0, before);
    for (int i = 0; i < 2; i++) {
        memcpy(s->axis_w[i], before, sizeof before);
        first_normal(s, before, s->axis_u[i]);
        vector_cross(s->axis_w[i], s->axis_u[i], s->axis_v[i]);
    }
    tangent(s, 1, before);
    for (int i = 2; i <= last; i++) {
        if (i < last) {
            tangent(s, i, after);
            plane_normal(s, i, before, after);
        } else {
            memcpy(s->axis_w[i], before, sizeof before);
        }
        carry(s, i);
        memcpy(before, after, sizeof before);
    }
}

void strand_half_line(const struct strand *s, int node, int sample, double a[3]) {
    const double *turn = s->turn[sample];
    for (int k = 0; k < 3; k++)
        a[k] = turn[0] * s->axis_u[node][k] + turn[1] * s->axis_v[node][k];
}

/* --- samples --- */

/* Prescribed rings are given by (r, rate) whatever the treatment. */
static void refresh_sample(struct strand *s, int node, int sample) {
    const int at = node * s->wisp->samples + sample;
    double a[3];
    strand_half_line(s, node, sample, a);
    if (s->treatment == WISP_PENALTY && node >= 2) {
        s->r[at] = s->rate[at] = 0;
        for (int k = 0; k < 3; k++) {
            s->r[at] += (s->e[at][k] - s->p[node][k]) * a[k];
            s->rate[at] += (s->ev[at][k] - s->v[node][k]) * a[k];
        }
        return;
    }
    for (int k = 0; k < 3; k++) {
        s->e[at][k] = s->p[node][k] + s->r[at] * a[k];
        s->ev[at][k] = s->v[node][k] + s->rate[at] * a[k];
    }
}

void strand_refresh(struct strand *s) {
    refresh_frames(s);
    for (int i = 0; i < s->wisp->nodes; i++)
        for (int j = 0; j < s->wisp->samples; j++)
            refresh_sample(s, i, j);
}

void strand_move_node(struct strand *s, int node, const double dp[3], const double dv[3]) {
    vector_add(s->p[node], 1, dp);
    vector_add(s->v[node], 1, dv);
    for (int j = 0; j < s->wisp->samples; j++) {
        const int at = node * s->wisp->samples + j;
        vector_add(s->e[at], 1, dp);
        vector_add(s->ev[at], 1, dv);
    }
    s->changed = 1;
}

void strand_set_sample(struct strand *s, int node, int sample, double r, double rate) {
    const int at = node * s->wisp->samples + sample;
    double a[3];
    strand_half_line(s, node, sample, a);
    vector_add(s->e[at], r - s->r[at], a);
    vector_add(s->ev[at], rate - s->rate[at], a);
    s->r[at] = r;
    s->rate[at] = rate;
    s->changed = 1;
}

/* --- rows of a frame --- */

void strand_load(struct strand *s, const double *rows, int stride) {
    const int samples = s->wisp->samples, particles = s->treatment == WISP_PENALTY;
    for (int i = 0; i < s->wisp->nodes; i++) {
        const double *row = rows + i * stride;
        memcpy(s->p[i], row, sizeof s->p[i]);
        memcpy(s->v[i], row + 3, sizeof s->v[i]);
        for (int j = 0; j < samples; j++) {
            const int at = i * samples + j;
            if (particles) {
                memcpy(s->e[at], row + 6 + 6 * j, sizeof s->e[at]);
                memcpy(s->ev[at], row + 9 + 6 * j, sizeof s->ev[at]);
                s->r[at] = s->wisp->radius; /* of the prescribed rings */
                s->rate[at] = 0;
            } else {
                s->r[at] = row[6 + 2 * j];
                s->rate[at] = row[7 + 2 * j];
            }
        }
    }
    strand_refresh(s);
    s->changed = 0;
}

void strand_store(const struct strand *s, double *rows, int stride) {
    const int samples = s->wisp->samples, particles = s->treatment == WISP_PENALTY;
    for (int i = 0; i < s->wisp->nodes; i++) {
        double *row = rows + i * stride;
        memcpy(row, s->p[i], sizeof s->p[i]);
        memcpy(row + 3, s->v[i], sizeof s->v[i]);
        for (int j = 0; j < samples; j++) {
            const int at = i * samples + j;
            if (particles) {
                memcpy(row + 6 + 6 * j, s->e[at], sizeof s->e[at]);
                memcpy(row + 9 + 6 * j, s->ev[at], sizeof s->ev[at]);
            } else {
                row[6 + 2 * j] = s->r[at];
                row[7 + 2 * j] = s->rate[at];
            }
        }
    }
}
