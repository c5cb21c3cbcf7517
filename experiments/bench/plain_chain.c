#include "plain_chain.h"

#include <math.h>
#include <string.h>

void chain_init(struct chain *chain, const struct wisp *wisp,
                const struct surroundings *surroundings) {
    *chain = (struct chain){.nodes = wisp->nodes,
                            .size = 3 * (wisp->nodes - 2),
                            .spacing = wisp_spacing(wisp),
                            .drag_rate = wisp->drag_rate,
                            .stretch = wisp_stretch_constant(wisp),
                            .bend = wisp_bending_constant(wisp)};
    chain->stretch_damping = wisp->stretch_time * chain->stretch;
    chain->bend_damping = wisp->bending_time * chain->bend;
    memcpy(chain->gravity, surroundings->gravity, sizeof chain->gravity);
    for (int i = 0; i < wisp->nodes; i++)
        for (int c = 0; c < 3; c++) {
            const double x = wisp->root[c] + i * chain->spacing * wisp->direction[c];
            if (i < 2)
                chain->head[i][c] = x;
            else
                chain->q[3 * (i - 2) + c] = x;
        }
    for (int i = 2; i < wisp->nodes; i++)
        chain->inverse_mass[i] = 1 / wisp_node_mass(wisp, i);
}

/* Pulls a by [k (L - L0) + c (v_b - v_a).n] n, and b back. */
static inline void spring(const double *pa, const double *pb, const double *va, const double *vb,
                          double rest, double k, double c, double *fa, double *fb) {
    const double x = pb[0] - pa[0], y = pb[1] - pa[1], z = pb[2] - pa[2];
    const double length = sqrt(x * x + y * y + z * z), inverse = 1 / length;
    const double apart =
        ((vb[0] - va[0]) * x + (vb[1] - va[1]) * y + (vb[2] - va[2]) * z) * inverse;
    const double pull = (k * (length - rest) + c * apart) * inverse;
    fa[0] += pull * x, fa[1] += pull * y, fa[2] += pull * z;
    fb[0] -= pull * x, fb[1] -= pull * y, fb[2] -= pull * z;
}

void chain_acceleration(const struct chain *chain, const double *q, const double *v, double *a) {
    double p[CHAIN_NODES_MAX][3], u[CHAIN_NODES_MAX][3], f[CHAIN_NODES_MAX][3];
    const int n = chain->nodes;
    const size_t bytes = (size_t)chain->size * sizeof(double);
    memcpy(p, chain->head, sizeof chain->head);
    memset(u, 0, 2 * sizeof *u);
    memcpy(p[2], q, bytes);
    memcpy(u[2], v, bytes);
    memset(f, 0, (size_t)n * sizeof *f);
    for (int i = 1; i < n - 1; i++)
        spring(p[i], p[i + 1], u[i], u[i + 1], chain->spacing, chain->stretch,
               chain->stretch_damping, f[i], f[i + 1]);
    for (int i = 0; i < n - 2; i++)
        spring(p[i], p[i + 2], u[i], u[i + 2], 2 * chain->spacing, chain->bend, chain->bend_damping,
               f[i], f[i + 2]);
    for (int i = 2; i < n; i++)
        for (int c = 0; c < 3; c++)
            a[3 * (i - 2) + c] =
                chain->gravity[c] - chain->drag_rate * u[i][c] + chain->inverse_mass[i] * f[i][c];
}

void chain_euler(const struct chain *chain, double h, double *q, double *v) {
    double a[CHAIN_SIZE_MAX];
    chain_acceleration(chain, q, v, a);
    for (int i = 0; i < chain->size; i++) {
        q[i] += h * v[i];
        v[i] += h * a[i];
    }
}

void chain_rk4(const struct chain *chain, double h, double *q, double *v) {
    double q2[CHAIN_SIZE_MAX], v2[CHAIN_SIZE_MAX], v3[CHAIN_SIZE_MAX], v4[CHAIN_SIZE_MAX];
    double a1[CHAIN_SIZE_MAX], a2[CHAIN_SIZE_MAX], a3[CHAIN_SIZE_MAX], a4[CHAIN_SIZE_MAX];
    const int n = chain->size;
    chain_acceleration(chain, q, v, a1);
    for (int i = 0; i < n; i++) {
        q2[i] = q[i] + h / 2 * v[i];
        v2[i] = v[i] + h / 2 * a1[i];
    }
    chain_acceleration(chain, q2, v2, a2);
    for (int i = 0; i < n; i++) {
        q2[i] = q[i] + h / 2 * v2[i];
        v3[i] = v[i] + h / 2 * a2[i];
    }
    chain_acceleration(chain, q2, v3, a3);
    for (int i = 0; i < n; i++) {
        q2[i] = q[i] + h * v3[i];
        v4[i] = v[i] + h * a3[i];
    }
    chain_acceleration(chain, q2, v4, a4);
    for (int i = 0; i < n; i++) {
        q[i] += h / 6 * (v[i] + 2 * (v2[i] + v3[i]) + v4[i]);
        v[i] += h / 6 * (a1[i] + 2 * (a2[i] + a3[i]) + a4[i]);
    }
}
