/* What a subdivision does to the problem of wisps: its list of wisps, its parts and its frames. */
#include "wisp_model.h"

#include <string.h>

/* Where a wisp is. */
struct seat {
    int part, lane;
};

static struct seat find_seat(const struct wisp_model *m, int wisp) {
    for (int i = 0; i < m->model.part_count; i++)
        for (int k = 0; k < m->batches[i].count; k++)
            if (m->batches[i].wisp[k] == wisp)
                return (struct seat){i, k};
    return (struct seat){-1, -1};
}

/* Puts a wisp's new numbers and its strand into its lane, and the padding that repeats it. */
static void settle(const struct wisp_model *m, int wisp, int *changed) {
    const struct seat seat = find_seat(m, wisp);
    const struct batch *batch = &m->batches[seat.part];
    for (int k = 0; k < m->kernel->lanes; k++)
        if (batch->wisp[k] == wisp)
            m->kernel->fill(m->model.parts[seat.part].system.ctx, k, &m->wisps[wisp], m->model.t);
    wisp_close(m, seat.part, seat.lane, m->strand_rows);
    changed[seat.part] |= 1 << seat.lane;
}

/* A wisp at the end of the list with the parent's state, in a lane of its own; the parent's strand
 * is open. Returns its strand, or NULL where memory cannot be had. */
static struct strand *add_wisp(struct wisp_model *m, int parent, const struct placement *head) {
    const int wisp = m->wisp_count, stride = m->model.column_count - 2;
    m->wisps[wisp] = m->wisps[parent];
    m->parent[wisp] = parent;
    struct strand *strand = strand_create(&m->wisps[wisp], m->treatment);
    if (!strand)
        return NULL;
    m->strands[wisp] = strand;
    strand_store(m->strands[parent], m->strand_rows, stride);
    strand_turn(strand, head);
    strand_load(strand, m->strand_rows, stride);

    const int part = wisp_take_lane(m, wisp);
    if (m->batches[part].count == 1 && wisp_part_create(m, part))
        return NULL;
    m->model.parts[part].system.wisps = m->batches[part].count;
    wisp_take_rows(m, wisp);
    m->wisp_count++;
    return strand;
}

/* The strand's place in the order of contacts is behind its twin's. */
static void put_behind(struct wisp_model *m, struct strand *strand) {
    int i = m->wisp_count - 1;
    for (; m->in_order[i - 1] != strand->twin; i--)
        m->in_order[i] = m->in_order[i - 1];
    m->in_order[i] = strand;
}

static enum outcome split(struct wisp_model *m, int wisp, const struct flattening *at,
                          int *changed) {
    struct placement head;
    head_placement(&m->scene->around.head, m->model.t, &head);
    m->wisps[wisp] = subdivision_child(&m->wisps[wisp]);
    struct strand *plus = m->strands[wisp], *minus = add_wisp(m, wisp, &head);
    if (!minus)
        return OUT_OF_MEMORY;
    plus->twin = minus;
    minus->twin = plus;
    if (m->in_order)
        put_behind(m, minus);
    subdivision_turn(plus, at, &head, 1);
    subdivision_turn(minus, at, &head, -1);
    settle(m, wisp, changed);
    settle(m, m->wisp_count - 1, changed);
    m->model.parts[find_seat(m, wisp).part].system.counters.splits++;
    return FINISHED;
}

enum outcome wisp_splits_tick(struct wisp_model *m, int *changed) {
    const int count = m->wisp_count;
    enum outcome outcome = FINISHED;
    for (int i = 0; i < count && m->wisp_count < m->wisp_room && outcome == FINISHED; i++) {
        struct flattening at;
        if (subdivision_due(&m->scene->subdivision, m->strands[i], &at))
            outcome = split(m, i, &at, changed);
    }
    return outcome;
}
