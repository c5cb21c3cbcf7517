/* Wisps of a part that touch others: their points, and what contacts ask of these. */
#include "frames.h"
#include "padded.h"
#include "part.h"
#include "wisp/contact.h"
#include "wisp/strand.h"

/* --- points --- */

/* What sections are made of. */
static void put_axes(const struct kernel_part *part, int i, const struct contact_wisp *wisps) {
    const struct frame *frame = &part->frames[i];
    const struct padded u = pad(frame->u), v = pad(frame->v), w = pad(frame->w);
    for (int k = 0; k < LANES; k++) {
        if (!wisps[k].strand)
            continue;
        put(wisps[k].strand->axis_u[i], &u, k);
        put(wisps[k].strand->axis_v[i], &v, k);
        put(wisps[k].strand->axis_w[i], &w, k);
    }
}

/* Nodes 0 and 1, no points: sections begin at the second. */
static void put_fixed(const struct kernel_part *part, int i, const struct contact_wisp *wisps) {
    const struct padded p = pad(in_space(part, part->p[i])), v = pad(part->v[i]);
    for (int k = 0; k < LANES; k++) {
        if (!wisps[k].strand)
            continue;
        put(wisps[k].strand->p[i], &p, k);
        put(wisps[k].strand->v[i], &v, k);
        for (int j = 0; j < part->samples; j++)
            wisps[k].strand->r[i * part->samples + j] = lane_get(part->radius, k);
    }
}

/* Point j of node i in all lanes: a sample, or -1, the node. */
static inline void put_point(const struct kernel_part *part, int i, int j, struct vec x,
                             struct vec v, lane inverse_mass, const struct contact_wisp *wisps) {
    const int at = (i - 2) * (1 + part->samples) + 1 + j;
    const struct padded place = pad(x), velocity = pad(v);
    for (int k = 0; k < LANES; k++) {
        if (!wisps[k].strand)
            continue;
        struct contact_point *point = &wisps[k].point[at];
        put(point->x, &place, k);
        point->node = wisps[k].first_node + i - 2;
        point->sample = j;
        put(point->v, &velocity, k);
        point->inverse_mass = lane_get(inverse_mass, k);
    }
}

SPECIALISED void put_free(const struct kernel_part *part, int i, const double *qi, const double *vi,
                          int samples, const struct contact_wisp *wisps) {
    const lane own = part->mass[i], each = part->sample_mass[i];
    const lane inverse_mass = 1 / (own + samples * each);
    const struct vec p = in_space(part, vec_load(qi, 0)), v = vec_load(vi, 0);
    struct vec mean = {lane_all(0), lane_all(0), lane_all(0)};
    for (int j = 0; j < samples; j++) {
        const struct vec line = half_line(part, &part->frames[i], j, samples);
        struct vec e, ev;
        lane r;
        if (part->treatment == WISP_PENALTY) {
            e = in_space(part, vec_load(qi, 3 + 3 * j));
            ev = vec_load(vi, 3 + 3 * j);
            r = dot(sub(vec_load(qi, 3 + 3 * j), vec_load(qi, 0)), line);
        } else {
            r = load(qi, 3 + j);
            e = add_scaled(p, r, line);
            ev = add_scaled(v, load(vi, 3 + j), line);
        }
        put_point(part, i, j, e, ev, 1 / each, wisps);
        mean = add_scaled(mean, each * inverse_mass, ev);
        for (int k = 0; k < LANES; k++)
            if (wisps[k].strand)
                wisps[k].strand->r[i * samples + j] = lane_get(r, k);
    }
    put_point(part, i, -1, p, add_scaled(mean, own * inverse_mass, v), inverse_mass, wisps);
    const struct padded place = pad(p);
    for (int k = 0; k < LANES; k++)
        if (wisps[k].strand)
            put(wisps[k].strand->p[i], &place, k);
}

void LANED(kernel_contact_points)(void *ctx, const double *q, const double *v,
                                  const struct contact_wisp *wisps) {
    struct kernel_part *part = ctx;
    LANED(kernel_frames)(part, q, part->frames);
    for (int i = 0; i < 2; i++)
        put_fixed(part, i, wisps);
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns * LANES;
        if (part->samples == 4)
            put_free(part, i, q + at, v + at, 4, wisps);
        else
            put_free(part, i, q + at, v + at, part->samples, wisps);
    }
    for (int i = 0; i < part->nodes; i++)
        put_axes(part, i, wisps);
}

/* --- pushes --- */

static inline struct vec push_of(const struct contact_wisp *wisps, int at) {
    static const double none[3] = {0, 0, 0};
    struct vec dv = {lane_all(0), lane_all(0), lane_all(0)};
    for (int k = 0; k < LANES; k++) {
        vec_set(&dv, k, wisps[k].push ? wisps[k].push[at].dv : none);
    }
    return dv;
}

static inline mask moves(struct vec dv) {
    return dot(dv, dv) != 0;
}

/* A sample takes of its change only the part along its half-line; the rest is lost. */
static mask push_node(const struct kernel_part *part, int i, double *vi,
                      const struct contact_wisp *wisps, const double (*turn)[2]) {
    const struct frame *f = &part->frames[i];
    const int first = (i - 2) * (1 + part->samples);
    const struct vec v = vec_load(vi, 0), node_dv = push_of(wisps, first);
    const mask carried = moves(node_dv);
    mask changed = carried;
    for (int j = 0; j < part->samples; j++) {
        const struct vec dv = push_of(wisps, first + 1 + j);
        const struct vec line =
            add_scaled(scale(lane_all(turn[j][0]), f->u), lane_all(turn[j][1]), f->v);
        const mask moved = moves(dv);
        changed |= moved;
        if (part->treatment == WISP_PENALTY) {
            struct vec ev = vec_load(vi, 3 + 3 * j);
            const lane rate = dot(sub(ev, v), half_line(part, f, j, part->samples));
            const lane more = rate + dot(dv, line) - rate;
            ev = vec_select(carried, add(ev, node_dv), ev);
            vec_store(vi, 3 + 3 * j, vec_select(moved, add_scaled(ev, more, line), ev));
        } else {
            const lane rate = load(vi, 3 + j);
            store(vi, 3 + j, lane_select(moved, rate + dot(dv, line), rate));
        }
    }
    vec_store(vi, 0, vec_select(carried, add(v, node_dv), v));
    return changed;
}

/* Places of these lanes as they come back from space, in which contacts see them. */
static void settle(const struct kernel_part *part, double *qi, mask lanes) {
    const int places = part->treatment == WISP_PENALTY ? 1 + part->samples : 1;
    for (int j = 0; j < places; j++) {
        const struct vec place = vec_load(qi, 3 * j);
        vec_store(qi, 3 * j, vec_select(lanes, sub(in_space(part, place), part->origin), place));
    }
}

unsigned LANED(kernel_push)(void *ctx, double *q, double *v, const struct contact_wisp *wisps,
                            const double (*turn)[2]) {
    const struct kernel_part *part = ctx;
    const int next = part->node_unknowns * LANES;
    mask changed = lane_all(0) != 0;
    for (int i = 2; i < part->nodes; i++)
        changed |= push_node(part, i, v + (i - 2) * next, wisps, turn);
    for (int i = 2; i < part->nodes && !mask_none(changed); i++)
        settle(part, q + (i - 2) * next, changed);
    return mask_bits(changed);
}
