/* What happens to wisps at a tick: they touch each other, bodies push them out, and samples are
 * kept off their nodes. */
#include "clock.h"
#include "interaction.h"
#include "wisp_model.h"

#include <stdlib.h>
#include <string.h>

static int interacts(const struct scene *scene) {
    return scene->interaction.interpenetration || scene->interaction.collision;
}

/* What happens to wisps happens to them one by one. */
static int create_strands(struct wisp_model *m) {
    const struct scene *scene = m->scene;
    int most = 0;
    if (scene->body_count == 0 && !interacts(scene) && !wisps_split(scene))
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
    m->strand_rows = calloc((size_t)(most * m->model.column_count), sizeof(double));
    return m->strands && m->strand_rows ? 0 : -1;
}

/* --- wisps with each other --- */

/* The order in which wisps touch is one of what they are, not of where they stand in the file:
 * nothing that happens between them, down to the order of sums, depends on the file. Children of a
 * subdivision stand one behind the other in their parent's place, the + child first.
 *
 * By root, direction, length and nodes; the rest is the same in all wisps of a scene. Wisps of
 * which all that is equal move alike, and may change places. */
static int compare_strands(const void *one, const void *other) {
    const struct wisp *a = (*(struct strand *const *)one)->wisp,
                      *b = (*(struct strand *const *)other)->wisp;
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
    const size_t wisps = (size_t)m->wisp_count;
    m->interaction = interaction_create(&m->scene->interaction);
    m->in_order = calloc((size_t)m->wisp_room, sizeof(struct strand *));
    if (!m->interaction || !m->in_order)
        return -1;
    memcpy(m->in_order, m->strands, wisps * sizeof(struct strand *));
    qsort(m->in_order, wisps, sizeof(struct strand *), compare_strands);
    return 0;
}

struct strand *wisp_open(const struct wisp_model *m, int i, int lane) {
    const struct part *part = &m->model.parts[i];
    struct strand *strand = m->strands[m->batches[i].wisp[lane]];
    const int stride = m->model.column_count - 2;
    struct placement head;
    head_placement(&m->scene->around.head, m->model.t, &head);
    m->kernel->prescribe(part->system.ctx, m->model.t);
    m->kernel->sample(part->system.ctx, lane, part->q, part->v, m->strand_rows, stride);
    strand_turn(strand, &head);
    strand_load(strand, m->strand_rows, stride);
    return strand;
}

void wisp_close(const struct wisp_model *m, int i, int lane) {
    const struct part *part = &m->model.parts[i];
    const struct batch *batch = &m->batches[i];
    const int stride = m->model.column_count - 2;
    strand_store(m->strands[batch->wisp[lane]], m->strand_rows, stride);
    for (int k = 0; k < m->kernel->lanes; k++)
        if (batch->wisp[k] == batch->wisp[lane])
            m->kernel->restore(part->system.ctx, k, m->strand_rows, stride, part->q, part->v);
}

static enum outcome interact(struct wisp_model *m, int *changed) {
    for (int i = 0; i < m->model.part_count; i++)
        account_before(&m->model.parts[i], m->model.t);
    const int contacts = interaction_tick(m->interaction, m->in_order, m->wisp_count);
    if (contacts < 0)
        return OUT_OF_MEMORY;
    /* they are of two wisps, and so of no part: the first one counts them */
    m->model.parts[0].system.counters.wisp_contacts += contacts;
    for (int i = 0; i < m->model.part_count; i++)
        for (int k = 0; k < m->batches[i].count; k++)
            if (m->strands[m->batches[i].wisp[k]]->changed) {
                wisp_close(m, i, k);
                changed[i] = 1;
            }
    for (int i = 0; i < m->model.part_count; i++)
        account_after(&m->model.parts[i], m->model.t, JUMP_WISP_CONTACT);
    return FINISHED;
}

/* Wisps that subdivision has made touch their twins only once they are separated from them. */
static enum outcome meet(struct wisp_model *m, int *changed) {
    enum outcome outcome = FINISHED;
    for (int i = 0; i < m->model.part_count; i++)
        for (int k = 0; k < m->batches[i].count; k++)
            wisp_open(m, i, k);
    for (int i = m->scene->wisp_count; i < m->wisp_count; i++) /* of a pair one is always here */
        subdivision_separate(&m->scene->subdivision, m->strands[i]);
    if (m->interaction)
        outcome = interact(m, changed);
    if (wisps_split(m->scene) && outcome == FINISHED)
        outcome = wisp_splits_tick(m, changed);
    return outcome;
}

/* --- the clock --- */

/* A tick's bodies. */
struct bodies {
    const struct body *body;
    int count;
    double interval; /* since the last tick, s */
    struct body_motion motion[BODIES_MAX];
    double boxes[6 * BODIES_MAX], hull[6]; /* around each, around all */
};

static void place_bodies(const struct scene *scene, double t, struct bodies *bodies) {
    struct placement head;
    head_placement(&scene->around.head, t, &head);
    bodies->body = scene->bodies;
    bodies->count = scene->body_count;
    bodies->interval = 1 / scene->collision_rate;
    for (int i = 0; i < bodies->count; i++) {
        double *box = bodies->boxes + 6 * i, *hull = bodies->hull;
        bodies->motion[i] = body_motion(&bodies->body[i], &head, t);
        body_box(&bodies->body[i], &bodies->motion[i], box);
        for (int k = 0; k < 3; k++) {
            hull[k] = i == 0 || box[k] < hull[k] ? box[k] : hull[k];
            hull[3 + k] = i == 0 || box[3 + k] > hull[3 + k] ? box[3 + k] : hull[3 + k];
        }
    }
}

/* Body contact (section 4.2.2 of the thesis) for the wisps of a part that are near a body. Returns
 * whether any changed. */
static int push_out(const struct wisp_model *m, int i, const struct bodies *bodies, unsigned near) {
    struct counters *counters = &m->model.parts[i].system.counters;
    struct body_report report = {0, 0, 0};
    int changed = 0;
    for (int k = 0; k < m->batches[i].count; k++) {
        if (!(near >> k & 1))
            continue;
        struct strand *strand = wisp_open(m, i, k);
        body_contact(strand, bodies->body, bodies->motion, bodies->count, bodies->interval,
                     &report);
        if (strand->changed)
            wisp_close(m, i, k);
        changed |= strand->changed;
    }
    counters->body_contacts += report.nodes + report.samples;
    counters->nodes_left_inside += report.inside;
    return changed;
}

/* Part by part: body contact, then the clamp. Most parts are far from every body and have nothing
 * to clamp: one look says so. */
static void collide(struct wisp_model *m, int *changed) {
    const int envelope = m->scene->wisps[0].samples > 0;
    struct bodies bodies;
    place_bodies(m->scene, m->model.t, &bodies);
    for (int i = 0; i < m->model.part_count; i++) {
        struct part *part = &m->model.parts[i];
        void *ctx = part->system.ctx;
        unsigned near = 0;
        int clamp = envelope;
        m->kernel->prescribe(ctx, m->model.t);
        if (bodies.count > 0)
            near = m->kernel->near(ctx, part->q, bodies.hull, bodies.boxes, bodies.count, &clamp);
        account_before(part, m->model.t);
        if (near)
            changed[i] |= push_out(m, i, &bodies, near);
        account_after(part, m->model.t, JUMP_BODY_CONTACT);
        if (clamp || (near && envelope))
            changed[i] |= m->kernel->clamp(ctx, part->q, part->v);
        account_after(part, m->model.t, JUMP_CLAMP);
    }
}

/* At one time wisps touch first and split, then bodies push them out and samples are kept off their
 * nodes. */
enum outcome wisps_tick(struct model *model, unsigned events, int *changed) {
    struct wisp_model *m = (struct wisp_model *)model;
    enum outcome outcome = FINISHED;
    if (events & STOP_INTERACTION && m->model.interaction_rate > 0)
        outcome = meet(m, changed);
    if (events & STOP_COLLISION && outcome == FINISHED)
        collide(m, changed);
    return outcome;
}

/* --- memory --- */

int wisp_ticks_create(struct wisp_model *m) {
    if (m->scene->wisps[0].samples > 0 || m->scene->body_count > 0)
        m->model.collision_rate = m->scene->collision_rate;
    if (interacts(m->scene) || wisps_split(m->scene))
        m->model.interaction_rate = m->scene->interaction.rate;
    return create_strands(m) || (interacts(m->scene) && create_touch(m)) ? -1 : 0;
}

void wisp_ticks_free(struct wisp_model *m) {
    interaction_free(m->interaction);
    free(m->in_order);
    for (int i = 0; m->strands && m->strands[i]; i++)
        strand_free(m->strands[i]);
    free(m->strands);
    free(m->strand_rows);
}
