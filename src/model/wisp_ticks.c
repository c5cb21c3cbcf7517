/* What happens to wisps at a tick: they touch each other, bodies push them out, and samples are
 * kept off their nodes. */
#include "clock.h"
#include "kernel/kernel.h"
#include "wisp/interaction.h"
#include "wisp/neighbours.h"
#include "wisp_model.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Parts are shared out to threads in tasks, each with a place of its own to lay wisps open. */
enum { TASKS_MOST = 32 };

static int interacts(const struct scene *scene) {
    return scene->interaction.interpenetration || scene->interaction.collision;
}

/* What happens to wisps happens to them one by one. */
static int create_strands(struct wisp_model *m) {
    const struct scene *scene = m->scene;
    int most = 0;
    if (scene_tick_bodies(scene) == 0 && !interacts(scene) && !wisps_split(scene))
        return 0;
    m->strands = calloc((size_t)m->wisp_room + 1, sizeof(struct strand *));
    for (int i = 0; m->strands && i < m->wisp_count; i++) {
        most = m->wisps[i].nodes > most ? m->wisps[i].nodes : most;
        m->strands[i] = strand_create(&m->wisps[i], m->treatment);
        if (!m->strands[i])
            return -1;
    }
    m->model.parts_to_come = m->wisp_room - m->wisp_count;
    m->model.rows_to_come = m->model.parts_to_come * most;
    m->strand_row_room = (size_t)(most * m->model.column_count);
    m->strand_rows = calloc(TASKS_MOST * m->strand_row_room, sizeof(double));
    return m->strands && m->strand_rows ? 0 : -1;
}

/* --- wisps with each other --- */

/* Number of a root's cell along a curve that stays among neighbours (Morton's: the bits of x, y and
 * z in turn): wisps that may touch are near each other in memory. */
static uint64_t place_on_curve(const double root[3]) {
    const double cell = 0.05; /* m */
    uint64_t number = 0;
    for (int k = 0; k < 3; k++) {
        const double x = floor(root[k] / cell) + (1 << 20), most = (1 << 21) - 1;
        const uint64_t along = (uint64_t)(x > most ? most : x > 0 ? x : 0);
        for (int bit = 0; bit < 21; bit++)
            number |= (along >> bit & 1) << (3 * bit + k);
    }
    return number;
}

/* The order in which wisps touch is one of what they are, not of where they stand in the file:
 * nothing that happens between them, down to the order of sums, depends on the file. Children of a
 * subdivision stand one behind the other in their parent's place, the + child first.
 *
 * By place, root, direction, length and nodes; the rest is the same in all wisps of a scene. Wisps
 * of which all that is equal move alike, and may change places. */
static int compare_strands(const void *one, const void *other) {
    const struct wisp *a = (*(struct strand *const *)one)->wisp,
                      *b = (*(struct strand *const *)other)->wisp;
    const uint64_t place_a = place_on_curve(a->root), place_b = place_on_curve(b->root);
    if (place_a != place_b)
        return place_a < place_b ? -1 : 1;
    const double of_a[] = {a->root[0],      a->root[1],      a->root[2], a->direction[0],
                           a->direction[1], a->direction[2], a->length,  a->nodes};
    const double of_b[] = {b->root[0],      b->root[1],      b->root[2], b->direction[0],
                           b->direction[1], b->direction[2], b->length,  b->nodes};
    for (size_t k = 0; k < sizeof of_a / sizeof *of_a; k++)
        if (of_a[k] != of_b[k])
            return of_a[k] < of_b[k] ? -1 : 1;
    return 0;
}

static int create_touch(struct wisp_model *m) {
    const size_t wisps = (size_t)m->wisp_count, room = (size_t)m->wisp_room;
    m->interaction = interaction_create(&m->scene->interaction);
    m->neighbours = neighbours_create(m->wisp_room);
    m->in_order = calloc(room, sizeof(struct strand *));
    m->touching = calloc(room, sizeof(struct strand *));
    m->place = calloc(room, sizeof *m->place);
    m->boxes = calloc(room, sizeof *m->boxes);
    m->near = calloc(room, sizeof *m->near);
    if (!m->interaction || !m->neighbours || !m->in_order || !m->touching || !m->place ||
        !m->boxes || !m->near)
        return -1;
    memcpy(m->in_order, m->strands, wisps * sizeof(struct strand *));
    qsort(m->in_order, wisps, sizeof(struct strand *), compare_strands);
    return 0;
}

/* A tick, as its tasks see it. */
struct tick {
    struct wisp_model *m;
    int *changed; /* by part: its lanes, bit k for lane k */
    int tasks;
    void (*do_part)(const struct tick *tick, int part);
    double *rows; /* of the task; NULL where no wisps are laid open */
    struct placement head;
};

static void do_task(void *ctx, int index) {
    struct tick tick = *(const struct tick *)ctx;
    const long long parts = tick.m->model.part_count;
    const int to = (int)(parts * (index + 1) / tick.tasks);
    if (tick.m->strand_rows)
        tick.rows = tick.m->strand_rows + (size_t)index * tick.m->strand_row_room;
    for (int i = (int)(parts * index / tick.tasks); i < to; i++)
        tick.do_part(&tick, i);
}

static void do_parts(struct tick *tick, struct workers *workers,
                     void (*do_part)(const struct tick *, int)) {
    const int parts = tick->m->model.part_count;
    tick->do_part = do_part;
    tick->tasks = parts < TASKS_MOST ? parts : TASKS_MOST;
    workers_run(workers, do_task, tick, tick->tasks);
}

/* Lays wisps of a part open, those of the lanes whose bits are set. */
static void open_strands(const struct tick *tick, int i, unsigned lanes) {
    const struct wisp_model *m = tick->m;
    const struct part *part = &m->model.parts[i];
    struct strand *strands[LANES_MOST] = {NULL};
    for (int k = 0; k < m->batches[i].count; k++) {
        if (!(lanes >> k & 1))
            continue;
        strands[k] = m->strands[m->batches[i].wisp[k]];
        strand_turn(strands[k], &tick->head);
    }
    m->kernel->open(part->system.ctx, part->q, part->v, strands);
}

static void close_strand(const struct tick *tick, int i, int lane) {
    wisp_close(tick->m, i, lane, tick->rows);
    tick->changed[i] |= 1 << lane;
}

/* Puts a part's first nodes where the head has them, and boxes around wisps that may touch. */
static void look_at_part(const struct tick *tick, int i) {
    const struct wisp_model *m = tick->m;
    const struct part *part = &m->model.parts[i];
    double boxes[LANES_MOST][6];
    m->kernel->prescribe(part->system.ctx, m->model.t);
    if (!m->near)
        return;
    const unsigned folded = m->kernel->boxes(part->system.ctx, part->q, boxes);
    for (int k = 0; k < m->batches[i].count; k++) {
        const int wisp = m->batches[i].wisp[k];
        memcpy(m->boxes[wisp], boxes[k], sizeof boxes[k]);
        m->near[wisp] = folded >> k & 1;
    }
}

/* Lanes of a part that may touch; without interactions, all of them. */
static unsigned near_lanes(const struct wisp_model *m, int i) {
    unsigned lanes = 0;
    for (int k = 0; k < m->batches[i].count; k++)
        if (!m->near || m->near[m->batches[i].wisp[k]])
            lanes |= 1u << k;
    return lanes;
}

static void open_part(const struct tick *tick, int i) {
    open_strands(tick, i, near_lanes(tick->m, i));
}

static void close_strands(const struct tick *tick, int i) {
    const struct wisp_model *m = tick->m;
    const unsigned lanes = near_lanes(m, i);
    for (int k = 0; k < m->batches[i].count; k++)
        if (lanes >> k & 1 && m->strands[m->batches[i].wisp[k]]->changed)
            close_strand(tick, i, k);
}

/* Where no strand need be open: the kernel writes the points that touch, and takes back what is
 * asked of them. Padding lanes get what the wisp gets that they repeat. */
static int lanes_that_touch(const struct wisp_model *m, int i,
                            struct contact_wisp wisps[LANES_MOST]) {
    int any = 0;
    for (int k = 0; k < m->kernel->lanes; k++) {
        const int wisp = m->batches[i].wisp[k], place = m->place[wisp];
        wisps[k] = (struct contact_wisp){.strand = NULL};
        if (!m->near[wisp])
            continue;
        any = 1;
        wisps[k].push = interaction_pushes(m->interaction, place);
        if (k < m->batches[i].count) {
            wisps[k].strand = m->strands[wisp];
            wisps[k].point = interaction_points(m->interaction, place);
            wisps[k].first_node = interaction_first_node(m->interaction, place);
        }
    }
    return any;
}

static void touch_part(const struct tick *tick, int i) {
    const struct part *part = &tick->m->model.parts[i];
    struct contact_wisp wisps[LANES_MOST];
    if (lanes_that_touch(tick->m, i, wisps))
        tick->m->kernel->contact_points(part->system.ctx, part->q, part->v, wisps);
}

static void push_lanes(const struct tick *tick, int i) {
    const struct wisp_model *m = tick->m;
    const struct part *part = &m->model.parts[i];
    struct contact_wisp wisps[LANES_MOST];
    if (!lanes_that_touch(m, i, wisps))
        return;
    const unsigned changed = m->kernel->push(part->system.ctx, part->q, part->v, wisps,
                                             (const double(*)[2])m->strands[0]->turn);
    tick->changed[i] |= (int)(changed & ((1u << m->batches[i].count) - 1));
}

/* Strands are open while wisps touch where some may split. */
static void close_part(const struct tick *tick, int i) {
    struct part *part = &tick->m->model.parts[i];
    account_before(part, tick->m->model.t);
    if (wisps_split(tick->m->scene))
        close_strands(tick, i);
    else
        push_lanes(tick, i);
    account_after(part, tick->m->model.t, JUMP_WISP_CONTACT);
}

/* Which wisps may touch another or themselves. All of them are open where some may split. -1 where
 * memory cannot be had. */
static int find_near(struct wisp_model *m) {
    if (!wisps_split(m->scene))
        return neighbours_find(m->neighbours, (const double(*)[6])m->boxes, m->wisp_count, m->near);
    memset(m->near, 1, (size_t)m->wisp_count);
    return 0;
}

/* In `touching`, in order; returns how many. */
static int list_touching(struct wisp_model *m) {
    int count = 0;
    for (int i = 0; i < m->wisp_count; i++) {
        const int wisp = (int)(m->in_order[i]->wisp - m->wisps);
        if (m->near[wisp]) {
            m->place[wisp] = count;
            m->touching[count++] = m->in_order[i];
        }
    }
    return count;
}

/* All contacts, and what they ask for: as changes of strands that are open, or of points alone.
 * Returns how many, or -1 where memory cannot be had. */
static int find_contacts(struct tick *tick, struct workers *workers) {
    struct wisp_model *m = tick->m;
    struct interaction *it = m->interaction;
    const int count = list_touching(m);
    interaction_share(it, workers);
    if (wisps_split(m->scene))
        return interaction_tick(it, m->touching, count);
    if (interaction_begin(it, m->touching, count))
        return -1;
    do_parts(tick, workers, touch_part);
    const int contacts = interaction_search(it);
    if (contacts >= 0)
        interaction_add_up(it);
    return contacts;
}

static enum outcome interact(struct tick *tick, struct workers *workers) {
    const struct wisp_model *m = tick->m;
    const int contacts = find_contacts(tick, workers);
    if (contacts < 0)
        return OUT_OF_MEMORY;
    /* they are of two wisps, and so of no part: the first one counts them */
    struct counters *counters = &m->model.parts[0].system.counters;
    counters->wisp_contacts += contacts;
    counters->sections_tested += interaction_sections(m->interaction);
    do_parts(tick, workers, close_part);
    return FINISHED;
}

/* Wisps that subdivision has made touch their twins only once they are separated from them. */
static void open_and_separate(struct tick *tick, struct workers *workers) {
    const struct wisp_model *m = tick->m;
    do_parts(tick, workers, open_part);
    for (int i = m->scene->wisp_count; i < m->wisp_count; i++) /* of a pair one is always here */
        subdivision_separate(&m->scene->subdivision, m->strands[i]);
}

static enum outcome meet(struct tick *tick, struct workers *workers) {
    struct wisp_model *m = tick->m;
    enum outcome outcome = FINISHED;
    do_parts(tick, workers, look_at_part);
    if (m->interaction && find_near(m))
        return OUT_OF_MEMORY;
    if (wisps_split(m->scene))
        open_and_separate(tick, workers);
    if (m->interaction)
        outcome = interact(tick, workers);
    if (wisps_split(m->scene) && outcome == FINISHED)
        outcome = wisp_splits_tick(m, tick->changed);
    return outcome;
}

/* --- the clock --- */

/* The bodies as they are at a tick. */
struct bodies {
    const struct body *body;
    int count;
    int rest; /* they never move: where they were put once they stay */
    int placed;
    double interval; /* since the last tick, s */
    struct body_motion motion[BODIES_MAX];
    double boxes[6 * BODIES_MAX], hull[6]; /* around each, around all */
    struct obstacle obstacle[BODIES_MAX];  /* the same for the kernel */
};

static int create_bodies(struct wisp_model *m) {
    const struct scene *scene = m->scene;
    m->bodies = calloc(1, sizeof *m->bodies);
    if (!m->bodies)
        return -1;
    m->bodies->body = scene->bodies;
    m->bodies->count = scene_tick_bodies(scene);
    m->bodies->interval = 1 / scene->collision_rate;
    m->bodies->rest = scene->around.head.knots <= 1;
    for (int i = 0; i < scene_tick_bodies(scene); i++)
        for (int k = 0; k < 3; k++)
            m->bodies->rest &= scene->bodies[i].velocity[k] == 0;
    return 0;
}

static void place_bodies(const struct tick *tick, struct bodies *bodies) {
    if (bodies->rest && bodies->placed)
        return;
    for (int i = 0; i < bodies->count; i++) {
        double *box = bodies->boxes + 6 * i, *hull = bodies->hull;
        bodies->motion[i] = body_motion(&bodies->body[i], &tick->head, tick->m->model.t);
        body_box(&bodies->body[i], &bodies->motion[i], box);
        bodies->obstacle[i] = body_obstacle(&bodies->body[i], &bodies->motion[i]);
        for (int k = 0; k < 3; k++) {
            hull[k] = i == 0 || box[k] < hull[k] ? box[k] : hull[k];
            hull[3 + k] = i == 0 || box[3 + k] > hull[3 + k] ? box[3 + k] : hull[3 + k];
        }
    }
    bodies->placed = 1;
}

/* Body contact (section 4.2.2 of the thesis) for the wisps of a part that are near a body. Hair on
 * a body has samples inside it at every tick and a node now and then: the kernel pulls samples out,
 * four wisps at a time, and only a wisp with a node inside is laid open. Returns whether either
 * changed any: then the clamp must look. */
static int push_out(const struct tick *tick, int i, unsigned near) {
    const struct wisp_model *m = tick->m;
    const struct bodies *bodies = m->bodies;
    struct part *part = &m->model.parts[i];
    int pulled, touched;
    unsigned pulled_lanes;
    near &= m->kernel->pull(part->system.ctx, part->q, part->v, bodies->obstacle, bodies->boxes,
                            bodies->count, (1u << m->batches[i].count) - 1, &pulled, &pulled_lanes);
    touched = pulled > 0;
    if (touched) /* no more is written than must be: threads share these lines of memory */
        tick->changed[i] |= (int)pulled_lanes;
    struct counters *counters = &part->system.counters;
    struct body_report report = {0, pulled, 0};
    near &= (1u << m->batches[i].count) - 1;
    if (near)
        open_strands(tick, i, near);
    for (int k = 0; k < m->batches[i].count; k++) {
        if (!(near >> k & 1))
            continue;
        struct strand *strand = m->strands[m->batches[i].wisp[k]];
        body_contact(strand, bodies->body, bodies->motion, bodies->count, m->scene->around.gravity,
                     bodies->interval, &report);
        if (strand->changed)
            close_strand(tick, i, k);
        touched |= strand->changed;
    }
    counters->body_contacts += report.nodes + report.samples;
    counters->nodes_left_inside += report.inside;
    return touched;
}

/* Segments that contacts have stretched, where they are rigid: once a tick, after the last of them.
 * The energy that this changes is of no kind that parts have accounts of. */
static void project_part(const struct tick *tick, int i) {
    struct wisp_model *m = tick->m;
    if (!tick->changed[i] || m->wisps[0].stretch != STRETCH_RIGID)
        return;
    m->batches[i].trouble = wisp_part_project(m, i, (unsigned)tick->changed[i]);
    account_before(&m->model.parts[i], m->model.t);
}

/* Whether all parts could be put back; else of the first that could not why. */
static enum outcome look_for_trouble(struct wisp_model *m) {
    for (int i = 0; i < m->model.part_count; i++) {
        if (!m->batches[i].trouble)
            continue;
        m->model.trouble = m->model.parts[i].system.reason;
        return (enum outcome)m->batches[i].trouble;
    }
    return FINISHED;
}

/* Body contact, then the clamp. Most parts are far from every body and have nothing to clamp: one
 * look says so. */
static void collide_part(const struct tick *tick, int i) {
    const struct wisp_model *m = tick->m;
    const struct bodies *bodies = m->bodies;
    struct part *part = &m->model.parts[i];
    const int envelope = m->scene->wisps[0].samples > 0;
    void *ctx = part->system.ctx;
    unsigned near = 0;
    int clamp = envelope;
    m->kernel->prescribe(ctx, m->model.t);
    if (bodies->count > 0)
        near = m->kernel->near(ctx, part->q, bodies->hull, bodies->boxes, bodies->count, &clamp);
    account_before(part, m->model.t);
    if (near && push_out(tick, i, near))
        clamp = envelope;
    account_after(part, m->model.t, JUMP_BODY_CONTACT);
    project_part(tick, i);
    const unsigned clamped = clamp ? m->kernel->clamp(ctx, part->q, part->v) : 0;
    if (clamped)
        tick->changed[i] |= (int)clamped;
    account_after(part, m->model.t, JUMP_CLAMP);
}

/* Without bodies it is the clamp alone. */
unsigned wisps_tick_part(struct model *model, int i, double t) {
    const struct wisp_model *m = (const struct wisp_model *)model;
    struct part *part = &model->parts[i];
    m->kernel->prescribe(part->system.ctx, t);
    return m->kernel->clamp(part->system.ctx, part->q, part->v);
}

/* At one time wisps touch first and split, then bodies push them out and samples are kept off their
 * nodes. */
enum outcome wisps_tick(struct model *model, struct workers *workers, unsigned events,
                        int *changed) {
    struct tick tick = {.m = (struct wisp_model *)model, .changed = changed};
    enum outcome outcome = FINISHED;
    if (events & (STOP_INTERACTION | STOP_COLLISION))
        head_placement(&tick.m->scene->around.head, model->t, &tick.head);
    if (events & STOP_INTERACTION && tick.m->model.interaction_rate > 0)
        outcome = meet(&tick, workers);
    if (events & STOP_COLLISION && outcome == FINISHED) {
        place_bodies(&tick, tick.m->bodies);
        do_parts(&tick, workers, collide_part);
    } else if (events & STOP_INTERACTION && outcome == FINISHED) {
        do_parts(&tick, workers, project_part);
    }
    return outcome == FINISHED ? look_for_trouble(tick.m) : outcome;
}

/* --- memory --- */

int wisp_ticks_create(struct wisp_model *m) {
    if (m->scene->wisps[0].samples > 0 || scene_tick_bodies(m->scene) > 0)
        m->model.collision_rate = m->scene->collision_rate;
    m->model.ticks_alone = scene_tick_bodies(m->scene) == 0;
    if (interacts(m->scene) || wisps_split(m->scene))
        m->model.interaction_rate = m->scene->interaction.rate;
    return create_bodies(m) || create_strands(m) || (interacts(m->scene) && create_touch(m)) ? -1
                                                                                             : 0;
}

void wisp_ticks_free(struct wisp_model *m) {
    free(m->bodies);
    interaction_free(m->interaction);
    neighbours_free(m->neighbours);
    free(m->in_order);
    free(m->touching);
    free(m->place);
    free(m->boxes);
    free(m->near);
    for (int i = 0; m->strands && m->strands[i]; i++)
        strand_free(m->strands[i]);
    free(m->strands);
    free(m->strand_rows);
}
