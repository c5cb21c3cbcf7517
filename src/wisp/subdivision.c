#include "subdivision.h"

#include "base/vector.h"
#include "section.h"

#include <stddef.h>

/* The mean over all nodes; those of the head, which twins share, are among them. */
static double mean_distance(const struct strand *a, const struct strand *b) {
    double sum = 0;
    for (int i = 0; i < a->wisp->nodes; i++) {
        double d[3] = {b->p[i][0] - a->p[i][0], b->p[i][1] - a->p[i][1], b->p[i][2] - a->p[i][2]};
        sum += vector_length(d);
    }
    return sum / a->wisp->nodes;
}

/* Once separated is for ever: twins that meet again are two wisps like any others. So one link says
 * both who may not touch and who may not split, and that of a wisp that split is gone already.
 * Asked anew at each tick, a pair that hovers about the distance would touch and not touch in
 * turns. */
void subdivision_separate(const struct subdivision *rule, struct strand *strand) {
    struct strand *twin = strand->twin;
    if (twin && mean_distance(strand, twin) > rule->separation)
        strand->twin = twin->twin = NULL;
}

static struct flattening flatness(const struct strand *strand, int node) {
    const int half = strand->wisp->samples / 2;
    struct flattening flat = {.node = node};
    double least = INFINITY, largest = 0;
    for (int j = 0; j < half; j++) {
        const double diameter =
            section_radius(strand, node, j) + section_radius(strand, node, j + half);
        least = fmin(least, diameter);
        if (diameter > largest) {
            largest = diameter;
            flat.longest = j;
        }
    }
    flat.ratio = least / largest;
    return flat;
}

int subdivision_due(const struct subdivision *rule, const struct strand *strand,
                    struct flattening *at) {
    *at = (struct flattening){.ratio = INFINITY};
    for (int i = 2; i < strand->wisp->nodes; i++) {
        const struct flattening flat = flatness(strand, i);
        if (flat.ratio < at->ratio)
            *at = flat;
    }
    return !strand->twin && at->ratio < rule->ratio;
}

/* The constants of all springs go with these, of those in the envelope with the mass. */
struct wisp subdivision_child(const struct wisp *parent) {
    struct wisp child = *parent;
    child.splits++;
    child.hair_count /= 2;
    child.stretch_stiffness /= 2;
    child.bending_stiffness /= 2;
    return child;
}

/* The velocity of the point of the moving head that is at x. */
static void head_velocity(const struct placement *head, const double x[3], double velocity[3]) {
    double rest[3] = {0};
    for (int i = 0; i < 3; i++)
        vector_add(rest, x[i] - head->position[0][i], head->turn[0][i]);
    placed_point(head, 1, rest, velocity);
}

/* The rule turns a velocity and keeps its size (the thesis: a component of half the mass keeps the
 * speed): along it by the ratio, along the longest diameter by what is missing from 1. Where there
 * is no velocity to turn, or it is along that diameter, a little of it must do. */
void subdivision_turn(struct strand *strand, const struct flattening *at,
                      const struct placement *head, int side) {
    const double still[3] = {0};
    double longest[3], v[3], unit[3], across[3], dv[3] = {0};
    strand_half_line(strand, at->node, at->longest, longest);
    head_velocity(head, strand->p[at->node], v);
    for (int k = 0; k < 3; k++)
        v[k] = strand->v[at->node][k] - v[k];
    const double speed = vector_length(v);
    for (int k = 0; k < 3; k++) {
        unit[k] = speed < 1e-9 ? 0 : v[k] / speed;
        across[k] = longest[k];
    }
    vector_add(across, -vector_dot(longest, unit), unit);
    const double width = vector_length(across);
    if (speed < 1e-9 || width < 1e-9) {
        vector_add(dv, side * 1e-3, longest);
    } else {
        double way[3] = {0};
        vector_add(way, at->ratio, unit);
        vector_add(way, side * (1 - at->ratio) / width, across);
        vector_add(dv, speed / vector_length(way), way);
        vector_add(dv, -1, v);
    }
    strand_move_node(strand, at->node, still, dv);
}
