#include "hair_frames.h"

#include "base/files.h"
#include "base/vector.h"
#include "wisp/ellipsoid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- reading --- */

/* The frame of most wisps has all of them that the run ever had. */
static int create_strands(struct hair *hair) {
    int frame = 0;
    while (frame < hair->frame_count && hair->frames[frame].wisps < hair->states->wisp_count)
        frame++;
    for (int w = 0; w < hair->states->wisp_count; w++) {
        const int ancestor = hair_ancestor(hair, w);
        if (ancestor >= hair->scene->wisp_count)
            return -1;
        hair->wisps[w] = hair->scene->wisps[ancestor];
        if (hair->wisps[w].nodes != hair_nodes(hair, frame, w))
            return -1;
        hair->strands[w] = strand_create(&hair->wisps[w], hair->treatment);
        if (!hair->strands[w])
            return -1;
    }
    hair->interaction = interaction_create(&hair->scene->interaction);
    return hair->interaction ? 0 : -1;
}

int hair_open(struct hair *hair, const struct scene *scene, const struct trajectory *states,
              enum wisp_treatment treatment, char *reason) {
    const size_t most = (size_t)states->wisp_count;
    *hair = (struct hair){.scene = scene,
                          .states = states,
                          .treatment = treatment,
                          .frame_count = states->frame_count,
                          .frames = states->frames};
    hair->wisps = calloc(most + 1, sizeof *hair->wisps);
    hair->strands = calloc(most + 1, sizeof *hair->strands);
    const int code = hair->wisps && hair->strands ? create_strands(hair) : -1;
    if (code)
        snprintf(reason, REASON_SIZE, "scene %s: no memory for its frames, or they are not of it",
                 scene->name);
    return code;
}

void hair_close(struct hair *hair) {
    for (int w = 0; hair->strands && w < hair->states->wisp_count; w++)
        strand_free(hair->strands[w]);
    if (hair->interaction)
        interaction_free(hair->interaction);
    free(hair->strands);
    free(hair->wisps);
    *hair = (struct hair){0};
}

int hair_nodes(const struct hair *hair, int frame, int wisp) {
    return trajectory_nodes(hair->states, frame, wisp);
}

const double *hair_node(const struct hair *hair, int frame, int wisp, int node) {
    return trajectory_row(hair->states, trajectory_wisp(hair->states, frame, wisp) + node) +
           STATE_X;
}

double square_distance(const double *a, const double *b) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return vector_dot(d, d);
}

int hair_ancestor(const struct hair *hair, int wisp) {
    const int *parent = hair->states->parent;
    while (parent[wisp] != wisp)
        wisp = parent[wisp];
    return wisp;
}

void hair_lay_open(struct hair *hair, int frame) {
    struct placement head;
    head_placement(&hair->scene->around.head, hair->frames[frame].t, &head);
    for (int w = 0; w < hair->frames[frame].wisps; w++) {
        strand_turn(hair->strands[w], &head);
        strand_load(hair->strands[w], hair_node(hair, frame, w, 0),
                    hair->states->table.column_count);
    }
}

int hair_frame_at(const struct hair *hair, double t) {
    int best = -1;
    for (int f = 0; f < hair->frame_count; f++)
        if (best < 0 || fabs(hair->frames[f].t - t) < fabs(hair->frames[best].t - t))
            best = f;
    const double rate = hair->scene->frame_rate;
    return best >= 0 && fabs(hair->frames[best].t - t) * rate <= 0.5 ? best : -1;
}

/* --- measures --- */

struct inclination hair_inclination(const struct hair *hair, int frame) {
    struct inclination inclination = {0, 0};
    const int wisps = hair->frames[frame].wisps;
    for (int w = 0; w < wisps; w++) {
        const double *root = hair_node(hair, frame, w, 1);
        const double *tip = hair_node(hair, frame, w, hair_nodes(hair, frame, w) - 1);
        const double line[3] = {tip[0] - root[0], tip[1] - root[1], tip[2] - root[2]};
        const double *gravity = hair->scene->around.gravity;
        double cross[3];
        vector_cross(line, gravity, cross);
        const double angle = atan2(vector_length(cross), vector_dot(line, gravity));
        inclination.mean += angle / wisps;
        inclination.largest = fmax(inclination.largest, angle);
    }
    return inclination;
}

int hair_overlap(struct hair *hair, int frame) {
    struct interaction *interaction = hair->interaction;
    if (hair->scene->wisps[0].samples == 0)
        return 0;
    hair_lay_open(hair, frame);
    const int found = interaction_find(interaction, hair->strands, hair->frames[frame].wisps);
    const struct contact *contacts = interaction_contacts(interaction);
    int count = 0;
    for (int i = 0; i < found; i++)
        count += interaction_section(interaction, contacts[i].section).strand !=
                 interaction_point(interaction, contacts[i].point).strand;
    return found < 0 ? -1 : count;
}

double hair_strain(const struct hair *hair, int frame) {
    double largest = 0;
    for (int w = 0; w < hair->frames[frame].wisps; w++) {
        const double rest = wisp_spacing(&hair->wisps[w]);
        for (int i = 1; i + 1 < hair_nodes(hair, frame, w); i++) {
            const double length = sqrt(
                square_distance(hair_node(hair, frame, w, i), hair_node(hair, frame, w, i + 1)));
            largest = fmax(largest, fabs(length / rest - 1));
        }
    }
    return largest;
}

/* From the body's centre along its axes. */
static void to_body(const struct body_motion *motion, const double p[3], double x[3]) {
    double from[3];
    for (int k = 0; k < 3; k++)
        from[k] = p[k] - motion->centre[k];
    body_to_axes(motion, from, x);
}

/* From a point to the surface along the normal of the shell through it; 0 outside. */
static double point_depth(const double radii[3], const double x[3]) {
    double normal[3];
    if (!ellipsoid_contains(radii, x))
        return 0;
    ellipsoid_normal(radii, x, normal);
    return ellipsoid_exit(radii, x, normal);
}

/* At the point of the line that is on the innermost shell: where sum ((x + s d)_k / R_k)^2 is
 * least. */
static double segment_depth(const double radii[3], const double from[3], const double to[3]) {
    double d[3], along = 0, square = 0, x[3];
    for (int k = 0; k < 3; k++) {
        d[k] = to[k] - from[k];
        along -= from[k] * d[k] / (radii[k] * radii[k]);
        square += d[k] * d[k] / (radii[k] * radii[k]);
    }
    const double s = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
    memcpy(x, from, sizeof x);
    vector_add(x, s, d);
    return point_depth(radii, x);
}

static void look_at_wisp(const struct strand *strand, const struct body_motion *motion,
                         const double radii[3], struct depth *depth) {
    const int samples = strand->wisp->samples;
    double before[3], x[3];
    to_body(motion, strand->p[1], before);
    for (int i = 2; i < strand->wisp->nodes; i++) {
        to_body(motion, strand->p[i], x);
        depth->points = fmax(depth->points, point_depth(radii, x));
        depth->segments = fmax(depth->segments, segment_depth(radii, before, x));
        memcpy(before, x, sizeof before);
        for (int j = 0; j < samples; j++) {
            to_body(motion, strand->e[i * samples + j], x);
            depth->points = fmax(depth->points, point_depth(radii, x));
        }
    }
}

struct depth hair_depth(struct hair *hair, int frame) {
    const double t = hair->frames[frame].t;
    struct depth depth = {0, 0};
    struct placement head;
    hair_lay_open(hair, frame);
    head_placement(&hair->scene->around.head, t, &head);
    for (int b = 0; b < hair->scene->body_count; b++) {
        const struct body *body = &hair->scene->bodies[b];
        const struct body_motion motion = body_motion(body, &head, t);
        for (int w = 0; w < hair->frames[frame].wisps; w++)
            look_at_wisp(hair->strands[w], &motion, body->radii, &depth);
    }
    return depth;
}

static const double *tip(const struct hair *hair, int frame, int wisp) {
    return hair_node(hair, frame, wisp, hair_nodes(hair, frame, wisp) - 1);
}

double hair_tips_along(const struct hair *hair, int frame, const double direction[3]) {
    double sum = 0;
    const int wisps = hair->frames[frame].wisps;
    for (int w = 0; w < wisps; w++) {
        const double *at = tip(hair, frame, w), *was = tip(hair, 0, hair_ancestor(hair, w));
        for (int k = 0; k < 3; k++)
            sum += (at[k] - was[k]) * direction[k];
    }
    return sum / wisps;
}

/* Angles add as a sine and a cosine: the turn of `from` into `to` about the axis, weighted by both
 * distances from it. */
static void add_turn(const double axis[3], const double from[3], const double to[3], double *sine,
                     double *cosine) {
    double cross[3];
    vector_cross(from, to, cross);
    *sine += vector_dot(cross, axis);
    *cosine += vector_dot(from, to) - vector_dot(from, axis) * vector_dot(to, axis);
}

/* The head's position at a time is where its point 0 is. */
static void from_head(const struct scene *scene, double t, const double p[3], double from[3]) {
    static const double origin[3] = {0, 0, 0};
    struct placement head;
    double position[3];
    head_placement(&scene->around.head, t, &head);
    placed_point(&head, 0, origin, position);
    for (int k = 0; k < 3; k++)
        from[k] = p[k] - position[k];
}

/* Least squares: sum |to - R from|^2 is least where sine / cosine is the tangent of R's angle. */
double hair_turn(const struct hair *hair, int frame, const double axis[3]) {
    double sine = 0, cosine = 0, from[3], to[3];
    for (int w = 0; w < hair->frames[frame].wisps; w++) {
        const double *was = tip(hair, 0, hair_ancestor(hair, w));
        from_head(hair->scene, hair->frames[0].t, was, from);
        from_head(hair->scene, hair->frames[frame].t, tip(hair, frame, w), to);
        add_turn(axis, from, to, &sine, &cosine);
    }
    return atan2(sine, cosine);
}

double hair_head_turn(const struct scene *scene, double t, const double axis[3]) {
    double sine = 0, cosine = 0;
    struct placement head;
    head_placement(&scene->around.head, t, &head);
    for (int k = 0; k < 3; k++) {
        double from[3] = {0, 0, 0}, to[3];
        from[k] = 1;
        placed_direction(&head, from, to);
        add_turn(axis, from, to, &sine, &cosine);
    }
    return atan2(sine, cosine);
}

static int same_layout(const struct hair *a, const struct hair *b, int frame) {
    const int there = frame < a->frame_count && frame < b->frame_count &&
                      a->frames[frame].wisps == b->frames[frame].wisps;
    for (int w = 0; there && w < a->frames[frame].wisps; w++)
        if (hair_nodes(a, frame, w) != hair_nodes(b, frame, w))
            return 0;
    return there;
}

double hair_distance(const struct hair *a, const struct hair *b, int frame) {
    double sum = 0;
    int nodes = 0;
    if (!same_layout(a, b, frame))
        return NAN;
    for (int w = 0; w < a->frames[frame].wisps; w++)
        for (int i = 2; i < hair_nodes(a, frame, w); i++, nodes++)
            sum += square_distance(hair_node(a, frame, w, i), hair_node(b, frame, w, i));
    return sqrt(sum / nodes);
}

int hair_same(const struct hair *a, const struct hair *b, int frame) {
    const int columns = a->states->table.column_count;
    if (!same_layout(a, b, frame) || columns != b->states->table.column_count)
        return 0;
    const int first = a->frames[frame].row, rows = trajectory_end(a->states, frame) - first;
    return memcmp(trajectory_row(a->states, first), trajectory_row(b->states, b->frames[frame].row),
                  (size_t)(rows * columns) * sizeof(double)) == 0;
}
