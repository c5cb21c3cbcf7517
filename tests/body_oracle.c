#include "body_oracle.h"

#include "base/vector.h"

#include <math.h>
#include <stddef.h>

long double twin_level(const double radii[3], const double x[3], const double d[3], long double s) {
    long double sum = -1;
    for (int k = 0; k < 3; k++) {
        const long double y = ((long double)x[k] + s * (d ? d[k] : 0)) / radii[k];
        sum += y * y;
    }
    return sum;
}

/* The one s between two values at which the level has different signs. */
static double bisect(const double radii[3], const double x[3], const double d[3], long double from,
                     long double to) {
    const int sign = twin_level(radii, x, d, from) < 0;
    for (int i = 0; i < 200; i++) {
        const long double middle = (from + to) / 2;
        *((twin_level(radii, x, d, middle) < 0) == sign ? &from : &to) = middle;
    }
    return (double)to;
}

double twin_exit(const double radii[3], const double x[3], const double d[3]) {
    long double to = 1e-3L;
    while (twin_level(radii, x, d, to) < 0)
        to *= 2;
    return bisect(radii, x, d, 0, to);
}

int twin_inside(const struct body *b, double t, const double p[3], double x[3]) {
    for (int k = 0; k < 3; k++)
        x[k] = p[k] - (b->centre[k] + t * b->velocity[k]);
    return twin_level(b->radii, x, NULL, 0) < 0;
}

static void twin_normal(const struct body *b, const double x[3], double n[3]) {
    for (int k = 0; k < 3; k++)
        n[k] = x[k] / (b->radii[k] * b->radii[k]);
    const double size = vector_length(n);
    for (int k = 0; k < 3; k++)
        n[k] /= size;
}

static void twin_node(struct strand *s, int i, const struct body *b, const double gravity[3],
                      double t, double dt) {
    double x[3], u[3], back[3], g[3], n[3], *v = s->v[i];
    if (!twin_inside(b, t, s->p[i], x))
        return;
    twin_normal(b, x, g);
    for (int k = 0; k < 3; k++) {
        u[k] = v[k] - b->velocity[k];
        back[k] = -u[k];
    }
    const double *ray = g;
    double way = twin_exit(b->radii, x, g);
    if (!b->moves && vector_dot(u, g) < 0 && twin_exit(b->radii, x, back) <= dt) {
        ray = back;
        way = twin_exit(b->radii, x, back);
    }
    for (int k = 0; k < 3; k++)
        x[k] += way * ray[k];
    twin_normal(b, x, n);
    const double across = vector_dot(u, n);
    const double speed =
        sqrt(fmax(0, across * across + 2 * way * vector_dot(gravity, ray))); /* at the surface */
    for (int k = 0; k < 3; k++) {
        if (across < 0)
            u[k] = exp(-b->friction * dt) * (u[k] - across * n[k]) + b->elasticity * speed * n[k];
        const double p = b->centre[k] + t * b->velocity[k] + x[k] + b->offset * n[k];
        for (int j = 0; j < s->wisp->samples; j++) {
            s->e[i * s->wisp->samples + j][k] += p - s->p[i][k];
            s->ev[i * s->wisp->samples + j][k] += b->velocity[k] + u[k] - v[k];
        }
        s->p[i][k] = p;
        v[k] = b->velocity[k] + u[k];
    }
}

static void twin_sample(struct strand *s, int i, int j, const struct body *b, double t) {
    const int at = i * s->wisp->samples + j;
    double a[3], x[3], from[3], end[3], u[3];
    strand_half_line(s, i, j, a);
    for (int k = 0; k < 3; k++) {
        end[k] = s->p[i][k] + s->r[at] * a[k];
        u[k] = b->velocity[k] - s->v[i][k];
    }
    twin_inside(b, t, s->p[i], from);
    if (s->r[at] <= 0 || !twin_inside(b, t, end, x))
        return;
    const double r = fmax(bisect(b->radii, from, a, 0, s->r[at]), 1e-3 * s->wisp->radius);
    const double rate = fmin(s->rate[at], vector_dot(u, a));
    for (int k = 0; k < 3; k++) {
        s->e[at][k] += (r - s->r[at]) * a[k];
        s->ev[at][k] += (rate - s->rate[at]) * a[k];
    }
    s->r[at] = r;
    s->rate[at] = rate;
}

int twin_contact(struct strand *s, const struct body *b, int count, const double gravity[3],
                 double t, double dt) {
    int left = 0;
    double x[3];
    for (int i = 2; i < s->wisp->nodes; i++)
        for (int pass = 0; pass < 4; pass++)
            for (int k = 0; k < count; k++)
                twin_node(s, i, &b[k], gravity, t, dt);
    strand_refresh(s);
    for (int i = 2; i < s->wisp->nodes; i++) {
        int inside = 0;
        for (int k = 0; k < count; k++)
            inside |= twin_inside(&b[k], t, s->p[i], x);
        left += inside;
        for (int k = 0; k < count && !inside; k++)
            for (int j = 0; j < s->wisp->samples; j++)
                twin_sample(s, i, j, &b[k], t);
    }
    return left;
}
