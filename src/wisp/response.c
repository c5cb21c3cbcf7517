#include "response.h"

#include "points.h"

static inline lane absolute(lane x) {
    return lane_select(x < 0, -x, x);
}

static inline mask mask_if(int yes) {
    return lane_all(0) == (yes ? 0 : 1);
}

/* Hair passes through hair along both wisps' directions but not across both: where they close, the
 * part of u along the common normal goes; the rest is braked by friction. Nearly parallel wisps
 * have no normal worth the name. */
static inline struct vec interpenetrate(double rest, struct vec normal, mask closing,
                                        struct vec u) {
    const lane square = dot(normal, normal);
    const struct vec across = add_scaled(u, -dot(u, normal) / square, normal);
    const struct vec kept = vec_select(closing & (lane_sqrt(square) > 0.05), across, u);
    return sub(scale(lane_all(rest), kept), u);
}

/* Section 4.3.2 of the thesis but for one thing: the criterion does not divide by the length of the
 * normal, which is noise for nearly parallel wisps. */
unsigned respond(const struct answerer *answerer, const struct section_places *places,
                 const double *const v[SECTION_POINTS], const double *const w[SECTION_POINTS],
                 struct responses *responses) {
    const struct interaction_settings *settings = answerer->settings;
    const struct section *section = answerer->section;
    const struct vec q = {load(places->q[0], 0), load(places->q[1], 0), load(places->q[2], 0)};
    lane lambda = load(places->x, 0) / section->length;
    lambda = lane_select(lambda < 0, lane_all(0), lane_select(lambda > 1, lane_all(1), lambda));
    struct vec u = vec_of(v);
    u = add_scaled(u, -(1 - lambda), vec_all(answerer->v[0]));
    u = add_scaled(u, -lambda, vec_all(answerer->v[1]));
    const struct vec normal = cross(vec_all(section->t), vec_of(w));
    const lane speed = lane_sqrt(dot(u, u));
    const mask closing = dot(u, q) < 0;
    const mask through = (speed < 1e-9) | (absolute(dot(normal, u)) < settings->threshold * speed);
    const mask passes = through & mask_if(settings->interpenetration);
    const mask collides = ~through & closing & mask_if(settings->collision);
    const struct vec none = {lane_all(0), lane_all(0), lane_all(0)};
    const struct vec stopped = vec_select(collides, scale(lane_all(-1), u), none);
    const struct vec change =
        vec_select(passes, interpenetrate(answerer->rest, normal, closing, u), stopped);
    store(responses->lambda, 0, lambda);
    store(responses->change[0], 0, change.x);
    store(responses->change[1], 0, change.y);
    store(responses->change[2], 0, change.z);
    return mask_bits(passes | collides);
}
