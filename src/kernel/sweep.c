/* Springs and hinges as the compliant constraints of extended position based dynamics (Macklin,
 * Mueller & Chentanez 2016, doi:10.1145/2994258.2994272). A spring-damper of length L between a and
 * b is C = L - L0 with a compliance 1 / k; a step of h from q that has come to x changes its
 * multiplier by their equation 26,
 *
 *     d = -(k h^2 C + lambda + c h n.(x - q)) / ((k h^2 + c h) N M^-1 N' + 1),
 *
 * here multiplied by k h^2, n.(x - q) being what the ends have come apart along the spring, and x
 * by M^-1 N' d. Where nothing moves any more lambda is -h^2 (k C + c n.(x - q) / h), h^2 times the
 * force at the end of the step: that is implicit Euler, but for the directions N of sweeps before.
 */
#include "springs.h"
#include "tension.h"

/* A spring from node a to node b > a. */
struct constraint {
    int a, b;
    lane rest, k, c;
};

/* How far node i is from where the step began: those that the head moves go as fast as they do at
 * its end. */
SPECIALISED struct vec way(const struct kernel_part *part, double h, const double *q,
                           const double *x, int i) {
    return i < 2 ? scale(lane_all(h), part->v[i])
                 : sub(free_node(part, x, i), free_node(part, q, i));
}

SPECIALISED void satisfy(struct kernel_part *part, const struct constraint *s, int coupled,
                         double h, const double *q, double *x, double *multiplier) {
    const struct vec d = sub(place_of(part, x, s->b), place_of(part, x, s->a));
    const lane length = lane_sqrt(dot(d, d)), stiff = h * h * s->k, damp = h * s->c;
    const struct vec n = scale(1 / length, d);
    const lane apart = dot(n, sub(way(part, h, q, x, s->b), way(part, h, q, x, s->a)));
    lane give = dot(n, moved(part, s->b, coupled, n));
    if (s->a > 1)
        give += dot(n, moved(part, s->a, coupled, n));
    const lane before = load(multiplier, 0);
    const lane change =
        -(stiff * (length - s->rest) + before + damp * apart) / ((stiff + damp) * give + 1);
    store(multiplier, 0, before + change);
    move(part, s->b, coupled, scale(change, n), x, x);
    if (s->a > 1)
        move(part, s->a, coupled, scale(-change, n), x, x);
}

/* The turning angle at node i - 1 is a constraint of compliance 1 / kappa. Where the wisp is
 * straight the angle's gradient has no direction, and the hinge does nothing. */
SPECIALISED void satisfy_hinge(struct kernel_part *part, int i, int coupled, double h,
                               const double *q, double *x, double *multiplier) {
    mask sound = lane_all(0) == 0;
    const struct vec pa = place_of(part, x, i - 2), pb = place_of(part, x, i - 1),
                     pc = place_of(part, x, i);
    const struct vec wa = way(part, h, q, x, i - 2), wb = way(part, h, q, x, i - 1),
                     wc = way(part, h, q, x, i);
    const struct reach a = reach(pa, pb, wa, wb, &sound), b = reach(pb, pc, wb, wc, &sound);
    const struct turn turn = turn_between(&a, &b);
    const mask turned = turn.sine > 1e-12;
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    const struct vec along_a = vec_select(turned, turn.along_a, none);
    const struct vec along_b = vec_select(turned, turn.along_b, none);
    const struct vec g[3] = {scale(lane_all(-1), along_a), sub(along_a, along_b), along_b};
    const lane stiff = h * h * part->bend_k, damp = h * part->bend_c;
    const lane apart = dot(along_a, a.velocity) + dot(along_b, b.velocity);
    lane give = lane_all(0);
    for (int k = i < 4 ? 4 - i : 0; k < 3; k++)
        give += dot(g[k], moved(part, i - 2 + k, coupled, g[k]));
    const lane before = load(multiplier, 0);
    const lane change = -(stiff * turn.angle + before + damp * apart) / ((stiff + damp) * give + 1);
    store(multiplier, 0, lane_select(turned, before + change, before));
    for (int k = i < 4 ? 4 - i : 0; k < 3; k++)
        move(part, i - 2 + k, coupled, scale(lane_select(turned, change, lane_all(0)), g[k]), x, x);
}

SPECIALISED void sweep(struct kernel_part *part, int coupled, double h, const double *q, double *x,
                       double *multipliers) {
    for (int i = 2; i < part->nodes; i++) {
        const struct constraint stretch = {i - 1, i, part->spacing, part->stretch_k,
                                           part->stretch_c};
        const struct constraint bend = {i - 2, i, part->skip_length, part->bend_k, part->bend_c};
        satisfy(part, &stretch, coupled, h, q, x, multipliers + 2 * i * LANES);
        if (part->bending == BENDING_SKIP)
            satisfy(part, &bend, coupled, h, q, x, multipliers + (2 * i + 1) * LANES);
        if (part->bending == BENDING_HINGE)
            satisfy_hinge(part, i, coupled, h, q, x, multipliers + (2 * i + 1) * LANES);
    }
}

void LANED(kernel_sweep_springs)(void *ctx, double t, double h, const double *q, double *x,
                                 double *multipliers) {
    struct kernel_part *part = ctx;
    LANED(kernel_prescribe)(part, t);
    if (is_coupled(part))
        sweep(part, 1, h, q, x, multipliers);
    else
        sweep(part, 0, h, q, x, multipliers);
}
