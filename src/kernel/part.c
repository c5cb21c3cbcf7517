/* A part's numbers, its start, and its state as the rest of the program sees it. */
#include "part.h"

#include "frames.h"
#include "push.h"
#include "rigid.h"
#include "room.h"

/* --- the head --- */

/* Where a point of the head is, its velocity or its acceleration, by derivative. */
static struct vec placed(const struct placement *at, int derivative, struct vec rest) {
    lane y[3];
    for (int i = 0; i < 3; i++) {
        const double *row = at->turn[derivative][i];
        y[i] = at->position[derivative][i] + (row[0] * rest.x + row[1] * rest.y + row[2] * rest.z);
    }
    return (struct vec){y[0], y[1], y[2]};
}

/* A direction is only turned. */
static struct vec turned(const struct placement *at, int derivative, struct vec rest) {
    struct placement turn = *at;
    memset(turn.position, 0, sizeof turn.position);
    return placed(&turn, derivative, rest);
}

struct vec LANED(kernel_turning)(const struct kernel_part *part, struct vec rest) {
    return turned(&part->head, 1, rest);
}

/* Node i of the rest shape, and sample j of its ring, from the root, as the head rests. */
static struct vec rest_node(const struct kernel_part *part, int i) {
    return scale(lane_all(i) * part->spacing, part->rest_tangent);
}

static struct vec rest_sample(const struct kernel_part *part, int i, int j) {
    const struct frame frame = {part->rest_normal, cross(part->rest_tangent, part->rest_normal),
                                part->rest_tangent};
    return add_scaled(rest_node(part, i), part->radius, half_line(part, &frame, j, part->samples));
}

/* A point of the rest shape, given from the root, where the head has it: from the origin. The root
 * is P + Q x there, and P_0 + Q_0 x is the origin: only the differences of P and Q count. */
static struct vec from_origin(const struct kernel_part *part, struct vec rest) {
    return add(placed(&part->shift, 0, part->rest_root), turned(&part->head, 0, rest));
}

/* The velocity (derivative 1) or acceleration (2) of such a point. */
static struct vec rate_of(const struct kernel_part *part, int derivative, struct vec rest) {
    return placed(&part->head, derivative, add(part->rest_root, rest));
}

struct vec LANED(kernel_carried_acceleration)(const struct kernel_part *part, double t, int node) {
    const struct system *system = part->system;
    const struct head_motion *head = &part->surroundings->head;
    const struct vec rest = rest_node(part, node);
    const double inside = system->until > 0 ? (system->from + system->until) / 2 : t;
    if (head_interval(head, inside) == head_interval(head, t))
        return rate_of(part, 2, rest);
    struct placement at;
    head_placement_within(head, inside, t, &at);
    return placed(&at, 2, add(part->rest_root, rest));
}

static void place_head(struct kernel_part *part, double t) {
    part->head_time = t;
    head_placement(&part->surroundings->head, t, &part->head);
    for (int i = 0; i < 3; i++) {
        part->shift.position[0][i] = part->head.position[0][i] - part->start.position[0][i];
        for (int j = 0; j < 3; j++)
            part->shift.turn[0][i][j] = part->head.turn[0][i][j] - part->start.turn[0][i][j];
    }
    for (int i = 0; i < 2; i++) {
        part->p[i] = from_origin(part, rest_node(part, i));
        part->v[i] = rate_of(part, 1, rest_node(part, i));
    }
    part->tangent = turned(&part->head, 0, part->rest_tangent);
    part->normal = turned(&part->head, 0, part->rest_normal);
}

/* Each lane has the head where it is at a time of its own: nobody else can use that place. */
static void place_heads(struct kernel_part *part, const double *times) {
    struct vec *const of_head[] = {&part->p[0], &part->p[1],    &part->v[0],
                                   &part->v[1], &part->tangent, &part->normal};
    enum { COUNT = sizeof of_head / sizeof *of_head };
    struct vec placed[COUNT];
    for (int k = 0; k < LANES; k++) {
        place_head(part, times[k]);
        for (int i = 0; i < COUNT; i++) {
            double x[3];
            vec_get(x, *of_head[i], k);
            vec_set(&placed[i], k, x);
        }
    }
    for (int i = 0; i < COUNT; i++)
        *of_head[i] = placed[i];
    part->head_time = NAN;
}

void LANED(kernel_prescribe)(void *ctx, double t) {
    struct kernel_part *part = ctx;
    if (part->surroundings->head.knots == 0)
        return;
    if (part->system->times)
        place_heads(part, part->system->times);
    else if (t != part->head_time)
        place_head(part, t);
}

/* --- making one --- */

static struct kernel_part *allocate(int nodes) {
    const size_t n = (size_t)nodes;
    lane *room;
    struct kernel_part *part = room_of(sizeof *part, n * (5 + 3 + 3 + 3 + 9 + 3 + 1), &room);
    if (!part)
        return NULL;
    part->mass = room_take(&room, n);
    part->inverse_mass = room_take(&room, n);
    part->sample_mass = room_take(&room, n);
    part->inverse_across = room_take(&room, n);
    part->inverse_along = room_take(&room, n);
    part->t = room_take(&room, 3 * n);
    part->chord = room_take(&room, 3 * n);
    part->inverse_length = room_take(&room, n);
    part->force = room_take(&room, 3 * n);
    part->swing = room_take(&room, 3 * n);
    part->frames = room_take(&room, 9 * n);
    return part;
}

/* Wisp k's numbers into lane k. */
static void fill_lane(struct kernel_part *part, int k, const struct wisp *wisp) {
    const double l = wisp_spacing(wisp), omega = 2 * M_PI * wisp->frequency;
    const double stretch = wisp_stretch_constant(wisp), bend = wisp_bending_constant(wisp);
    double normal[3], origin[3];
    wisp_first_normal(wisp->direction, normal);
    vec_set(&part->rest_root, k, wisp->root);
    vec_set(&part->rest_tangent, k, wisp->direction);
    vec_set(&part->rest_normal, k, normal);
    placed_point(&part->start, 0, wisp->root, origin);
    vec_set(&part->origin, k, origin);
    lane_set(&part->spacing, k, l);
    lane_set(&part->skip_length, k, 2 * l);
    lane_set(&part->stretch_k, k, stretch);
    lane_set(&part->stretch_c, k, wisp->stretch_time * stretch);
    lane_set(&part->bend_k, k, bend);
    lane_set(&part->bend_c, k, wisp->bending_time * bend);
    lane_set(&part->drag, k, wisp->drag_rate);
    lane_set(&part->radius, k, wisp->radius);
    lane_set(&part->spring_k, k, omega * omega);
    lane_set(&part->spring_c, k, 2 * wisp->damping_ratio * omega);
    lane_set(&part->penalty_k, k, wisp->penalty_ratio * omega * omega);
    lane_set(&part->penalty_c, k, 2 * sqrt(wisp->penalty_ratio) * omega);
    for (int i = 2; i < wisp->nodes; i++) {
        const double own = wisp_node_mass(wisp, i), sample = wisp_sample_mass(wisp, i);
        lane_set(&part->mass[i], k, own);
        lane_set(&part->inverse_mass[i], k, 1 / own);
        lane_set(&part->sample_mass[i], k, sample);
        lane_set(&part->inverse_across[i], k, 1 / (own + 0.5 * wisp->samples * sample));
        lane_set(&part->inverse_along[i], k, 1 / (own + wisp->samples * sample));
    }
}

static void set_directions(struct kernel_part *part) {
    for (int j = 0; j < part->samples; j++) {
        double way[2];
        wisp_sample_way(part->samples, j, way);
        part->cosine[j] = way[0];
        part->sine[j] = way[1];
    }
}

void *LANED(kernel_create)(const struct wisp *const *wisps, const struct surroundings *around,
                           enum wisp_treatment treatment, struct system *system) {
    const struct wisp *first = wisps[0];
    struct kernel_part *part = allocate(first->nodes);
    if (!part)
        return NULL;
    part->nodes = first->nodes;
    part->samples = first->samples;
    part->node_unknowns = wisp_node_unknowns(first, treatment);
    part->treatment = treatment;
    part->bending = first->bending;
    part->surroundings = around;
    part->system = system;
    set_directions(part);
    head_placement(&around->head, 0, &part->start);
    for (int k = 0; k < LANES; k++)
        fill_lane(part, k, wisps[k]);
    place_head(part, 0);
    const int rigid = first->stretch == STRETCH_RIGID, pushed = around->pushing_count > 0;
    if (rigid)
        part->rigid =
            LANED(kernel_rigid_create)(part->nodes, (part->nodes - 2) * part->node_unknowns);
    if (pushed)
        part->push = LANED(kernel_push_create)(part);
    if ((rigid && !part->rigid) || (pushed && !part->push)) {
        LANED(kernel_free)(part);
        return NULL;
    }
    return part;
}

void LANED(kernel_fill)(void *ctx, int which, const struct wisp *wisp, double t) {
    struct kernel_part *part = ctx;
    fill_lane(ctx, which, wisp);
    place_head(ctx, t);
    if (part->push)
        part->push->time = NAN; /* the lane has another origin */
}

void LANED(kernel_free)(void *ctx) {
    struct kernel_part *part = ctx;
    if (part) {
        LANED(kernel_matrix_free)(part->matrix);
        free(part->spare);
        free(part->rows);
        free(part->panels);
        free(part->rigid);
        free(part->push);
    }
    free(part);
}

/* --- states --- */

void LANED(kernel_rest)(void *ctx, double t, double *q, double *v) {
    struct kernel_part *part = ctx;
    place_head(part, t);
    memset(v, 0, (size_t)part->system->size * sizeof(double));
    for (int i = 2; i < part->nodes; i++) {
        double *qi = q + (i - 2) * part->node_unknowns * LANES;
        double *vi = v + (i - 2) * part->node_unknowns * LANES;
        vec_store(qi, 0, from_origin(part, rest_node(part, i)));
        vec_store(vi, 0, rate_of(part, 1, rest_node(part, i)));
        for (int j = 0; j < part->samples; j++) {
            if (part->treatment == WISP_PENALTY) {
                vec_store(qi, 3 + 3 * j, from_origin(part, rest_sample(part, i, j)));
                vec_store(vi, 3 + 3 * j, rate_of(part, 1, rest_sample(part, i, j)));
            } else {
                store(qi, 3 + j, part->radius);
            }
        }
    }
}

/* Row of a node that follows the head, with its ring of fixed samples. */
static void sample_prescribed(const struct kernel_part *part, int which, int i, double *row) {
    vec_get(row, in_space(part, part->p[i]), which);
    vec_get(row + 3, part->v[i], which);
    for (int j = 0; j < part->samples; j++) {
        if (part->treatment == WISP_PENALTY) {
            const struct vec rest = rest_sample(part, i, j);
            vec_get(row + 6 + 6 * j, in_space(part, from_origin(part, rest)), which);
            vec_get(row + 9 + 6 * j, rate_of(part, 1, rest), which);
        } else {
            row[6 + 2 * j] = lane_get(part->radius, which);
            row[6 + 2 * j + 1] = 0;
        }
    }
}

void LANED(kernel_sample_accelerations)(void *ctx, int which, const double *a, double *rows,
                                        int stride) {
    const struct kernel_part *part = ctx;
    for (int i = 0; i < 2; i++) {
        vec_get(rows + i * stride, rate_of(part, 2, rest_node(part, i)), which);
        for (int j = 0; j < part->samples; j++) {
            double *to = rows + i * stride + 3;
            if (part->treatment == WISP_PENALTY)
                vec_get(to + 3 * j, rate_of(part, 2, rest_sample(part, i, j)), which);
            else
                to[j] = 0;
        }
    }
    for (int i = 2; i < part->nodes; i++)
        for (int u = 0; u < part->node_unknowns; u++)
            rows[i * stride + u] = a[((i - 2) * part->node_unknowns + u) * LANES + which];
}

/* Where a row holds unknown u of a node. */
struct place_in_row {
    int column, rate_column;
    double from; /* what a position in space has more than the unknown; of distances 0, m */
};

static struct place_in_row place_in_row(const struct kernel_part *part, int which, int u) {
    const lane origin[3] = {part->origin.x, part->origin.y, part->origin.z};
    if (u >= 3 && part->treatment != WISP_PENALTY)
        return (struct place_in_row){6 + 2 * (u - 3), 7 + 2 * (u - 3), 0};
    const int column = 6 * (u / 3) + u % 3; /* the node's position and velocity, or a particle's */
    return (struct place_in_row){column, column + 3, lane_get(origin[u % 3], which)};
}

void LANED(kernel_sample)(void *ctx, int which, const double *q, const double *v, double *rows,
                          int stride) {
    const struct kernel_part *part = ctx;
    for (int i = 0; i < 2; i++)
        sample_prescribed(part, which, i, rows + i * stride);
    for (int i = 2; i < part->nodes; i++) {
        for (int u = 0; u < part->node_unknowns; u++) {
            const struct place_in_row place = place_in_row(part, which, u);
            const int at = ((i - 2) * part->node_unknowns + u) * LANES + which;
            rows[i * stride + place.column] = place.from + q[at];
            rows[i * stride + place.rate_column] = v[at];
        }
    }
}

void LANED(kernel_restore)(void *ctx, int which, const double *rows, int stride, double *q,
                           double *v) {
    const struct kernel_part *part = ctx;
    for (int i = 2; i < part->nodes; i++) {
        for (int u = 0; u < part->node_unknowns; u++) {
            const struct place_in_row place = place_in_row(part, which, u);
            const int at = ((i - 2) * part->node_unknowns + u) * LANES + which;
            q[at] = rows[i * stride + place.column] - place.from;
            v[at] = rows[i * stride + place.rate_column];
        }
    }
}

mask LANED(kernel_frames)(struct kernel_part *part, const double *q, struct frame *frames) {
    mask sound = lane_all(0) == 0;
    struct vec before = part->p[1];
    part->t[0] = part->tangent;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec p = vec_load(q, (i - 2) * part->node_unknowns), d = sub(p, before);
        const lane square = dot(d, d);
        sound &= square > 0;
        part->t[i - 1] = scale(1 / lane_sqrt(square), d);
        before = p;
    }
    plane_normals(part, frames);
    for (int i = 2; i < part->nodes; i++)
        carry_frame(part, frames, i);
    return sound;
}

double LANED(kernel_strain)(void *ctx, int which, const double *q) {
    const struct kernel_part *part = ctx;
    struct vec before = part->p[1];
    double most = 0;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec p = vec_load(q, (i - 2) * part->node_unknowns), d = sub(p, before);
        const lane strain = lane_sqrt(dot(d, d)) / part->spacing - 1;
        most = fmax(most, fabs(lane_get(strain, which)));
        before = p;
    }
    return most;
}

unsigned LANED(kernel_strained)(void *ctx, double t, const double *q, double limit) {
    struct kernel_part *part = ctx;
    LANED(kernel_prescribe)(part, t);
    const lane longest = (1 + limit) * part->spacing;
    const lane shortest = (limit < 1 ? 1 - limit : 0) * part->spacing;
    const lane most = longest * longest, least = shortest * shortest;
    lane high = lane_all(0), low = most; /* of squares so far; NaN is neither */
    struct vec before = part->p[1];
    for (int i = 2; i < part->nodes; i++) {
        const struct vec p = vec_load(q, (i - 2) * part->node_unknowns), d = sub(p, before);
        const lane square = dot(d, d);
        high = lane_max(square, high);
        low = lane_min(square, low);
        before = p;
    }
    return mask_bits((high > most) | (low < least));
}

/* --- the clamp --- */

/* Distance and rate of a sample on its half-line: unknowns themselves, or of a free particle. */
static unsigned clamp_distances(const struct kernel_part *part, double *q, double *v) {
    unsigned changed = 0;
    for (int i = 2; i < part->nodes; i++) {
        const int at = (i - 2) * part->node_unknowns;
        for (int j = at + 3; j < at + part->node_unknowns; j++) {
            const lane least = LEAST_DISTANCE * part->radius, r = load(q, j), rate = load(v, j);
            const mask inside = r <= AT_LEAST_DISTANCE * part->radius;
            const mask inwards = inside & (rate < 0);
            const mask moves = inside & ((r != least) | inwards);
            if (mask_none(moves))
                continue;
            store(q, j, lane_select(inside, least, r));
            store(v, j, lane_select(inwards, lane_all(0), rate));
            changed |= mask_bits(moves);
        }
    }
    return changed;
}

static unsigned clamp_particles(struct kernel_part *part, double *q, double *v) {
    unsigned changed = 0;
    LANED(kernel_frames)(part, q, part->frames);
    for (int i = 2; i < part->nodes; i++) {
        double *qi = q + (i - 2) * part->node_unknowns * LANES;
        double *vi = v + (i - 2) * part->node_unknowns * LANES;
        for (int j = 0; j < part->samples; j++) {
            const struct vec line = half_line(part, &part->frames[i], j, part->samples);
            const struct vec e = vec_load(qi, 3 + 3 * j), ev = vec_load(vi, 3 + 3 * j);
            const lane least = LEAST_DISTANCE * part->radius;
            const lane r = dot(sub(e, vec_load(qi, 0)), line);
            const lane rate = dot(sub(ev, vec_load(vi, 0)), line);
            const mask inside = r <= AT_LEAST_DISTANCE * part->radius;
            const mask inwards = inside & (rate < 0);
            const mask moves = inside & ((r < (1 - 1e-9) * least) | inwards);
            if (mask_none(moves))
                continue;
            vec_store(qi, 3 + 3 * j, vec_select(inside, add_scaled(e, least - r, line), e));
            vec_store(vi, 3 + 3 * j, vec_select(inwards, add_scaled(ev, -rate, line), ev));
            changed |= mask_bits(moves);
        }
    }
    return changed;
}

unsigned LANED(kernel_clamp)(void *ctx, double *q, double *v) {
    struct kernel_part *part = ctx;
    return part->treatment == WISP_PENALTY ? clamp_particles(part, q, v)
                                           : clamp_distances(part, q, v);
}
