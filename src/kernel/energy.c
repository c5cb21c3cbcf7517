/* Kinetic and potential energy of a part. In `penalty` without drag and damping it is conserved
 * with frozen frames; in the other treatments samples move as the treatment lets them, and what
 * crosses their lines is lost or added: it is the energy of the same positions and velocities. */
#include "frames.h"
#include "part.h"
#include "springs.h"

static lane square(struct vec a) {
    return dot(a, a);
}

/* Stretch and bending springs, without regard to velocities. */
static lane elastic_energy(const struct kernel_part *part, const double *q) {
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    struct vec pa = part->p[0], pb = part->p[1];
    struct reach before = first_segment(part);
    mask sound = lane_all(0) == 0;
    lane energy = lane_all(0);
    for (int i = 2; i < part->nodes; i++) {
        const struct vec p = vec_load(q, (i - 2) * part->node_unknowns);
        const struct reach segment = reach(pb, p, none, none, &sound);
        const lane stretch = segment.length - part->spacing;
        lane bend = lane_all(0);
        if (part->bending == BENDING_SKIP)
            bend = reach(pa, p, none, none, &sound).length - part->skip_length;
        if (part->bending == BENDING_HINGE)
            bend = turn_between(&before, &segment).angle;
        energy += 0.5 * part->stretch_k * stretch * stretch + 0.5 * part->bend_k * bend * bend;
        before = segment;
        pa = pb;
        pb = p;
    }
    return energy;
}

/* Position and velocity of sample j, and what its springs hold. */
static lane sample_energy(const struct kernel_part *part, int i, int j, const double *q,
                          const double *v, struct vec gravity) {
    const struct frame *frame = &part->frames[i];
    const struct vec line = half_line(part, frame, j, part->samples);
    const struct vec p = vec_load(q, 0), pv = vec_load(v, 0);
    struct vec e, ev;
    lane across = lane_all(0);
    if (part->treatment == WISP_PENALTY) {
        e = vec_load(q, 3 + 3 * j);
        ev = vec_load(v, 3 + 3 * j);
    } else {
        e = add_scaled(p, load(q, 3 + j), line);
        ev = add_scaled(pv, load(v, 3 + j), line);
    }
    const struct vec d = sub(e, p);
    const lane r = dot(d, line), gap = r - part->radius;
    if (part->treatment == WISP_PENALTY)
        across = part->penalty_k * square(add_scaled(d, -r, line));
    return part->sample_mass[i] *
           (0.5 * (square(ev) + part->spring_k * gap * gap + across) - dot(gravity, e));
}

double LANED(kernel_energy)(void *ctx, double t, const double *q, const double *v) {
    struct kernel_part *part = ctx;
    LANED(kernel_prescribe)(part, t);
    const double *g = part->surroundings->gravity;
    const struct vec gravity = {lane_all(g[0]), lane_all(g[1]), lane_all(g[2])};
    lane energy = elastic_energy(part, q);
    LANED(kernel_frames)(part, q);
    for (int i = 2; i < part->nodes; i++) {
        const double *qi = q + (i - 2) * part->node_unknowns * LANES;
        const double *vi = v + (i - 2) * part->node_unknowns * LANES;
        energy += part->mass[i] * (0.5 * square(vec_load(vi, 0)) - dot(gravity, vec_load(qi, 0)));
        for (int j = 0; j < part->samples; j++)
            energy += sample_energy(part, i, j, qi, vi, gravity);
    }
    double sum = 0;
    for (int k = 0; k < part->system->wisps; k++)
        sum += lane_get(energy, k);
    return sum;
}
