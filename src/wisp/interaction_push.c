/* What all contacts of a tick do together. */
#include "base/vector.h"
#include "interaction_parts.h"

#include <string.h>

/* All contacts, for points from number `from` to before `to`: threads add up what is theirs, each
 * in the order of contacts. */
struct pushing {
    struct interaction *it;
    const struct contact *contact;
    int count;
    int ranges;
};
struct range {
    int from, to;
};

static struct range range_of(const struct pushing *pushing, int index) {
    const long long nodes = pushing->it->volume_count;
    const int points = pushing->it->node_points;
    return (struct range){(int)(nodes * index / pushing->ranges) * points,
                          (int)(nodes * (index + 1) / pushing->ranges) * points};
}

static inline int in_range(struct range range, int point) {
    return point >= range.from && point < range.to;
}

/* Which contact's point should come in while this one is at work. */
static inline int ahead(const struct pushing *pushing, int contact) {
    enum { AHEAD = 16 };
    const int last = pushing->count - 1;
    return pushing->contact[contact + AHEAD < last ? contact + AHEAD : last].point;
}

/* c of every point. One-sided, a section's nodes take no part. */
static void count_shares(void *ctx, int index) {
    const struct pushing *pushing = ctx;
    struct interaction *it = pushing->it;
    const struct range range = range_of(pushing, index);
    if (range.to > range.from) /* no points, and there may be no memory for them */
        memset(it->push + range.from, 0, (size_t)(range.to - range.from) * sizeof *it->push);
    for (int c = 0; c < pushing->count; c++) {
        const struct contact *contact = &pushing->contact[c];
        __builtin_prefetch(&it->push[ahead(pushing, c)], 1);
        if (!contact->corrected)
            continue;
        if (in_range(range, contact->point))
            it->push[contact->point].shares++;
        for (int end = 0; end < 2 && it->settings.reciprocal; end++) {
            const int node = end_point(it, contact->section, end);
            if (in_range(range, node))
                it->push[node].shares++;
        }
    }
}

/* An impulse on the point and its opposite on the section's nodes. It is what would bring u to u'
 * if it were alone, divided by the number of those that do so to the same node or sample: then
 * energy cannot grow (it is convex, and each node's velocity ends up between what single contacts
 * ask of it and what it was). */
static void push_both(struct interaction *it, const struct contact *contact, struct range range) {
    const double weight[2] = {1 - contact->lambda, contact->lambda};
    const int node[2] = {end_point(it, contact->section, 0), end_point(it, contact->section, 1)};
    const int pushed = in_range(range, contact->point);
    if (!pushed && !in_range(range, node[0]) && !in_range(range, node[1]))
        return;
    const double own_inverse_mass = it->point[contact->point].inverse_mass;
    double effective = own_inverse_mass; /* change of u by a unit of impulse, 1/kg */
    int shares = it->push[contact->point].shares;
    for (int end = 0; end < 2; end++) {
        if (node[end] < 0)
            continue;
        effective += weight[end] * weight[end] * it->point[node[end]].inverse_mass;
        shares = it->push[node[end]].shares > shares ? it->push[node[end]].shares : shares;
    }
    const double impulse = 1 / (effective * shares); /* kg */
    if (pushed)
        vector_add(it->push[contact->point].dv, impulse * own_inverse_mass, contact->change);
    for (int end = 0; end < 2; end++)
        if (in_range(range, node[end]))
            vector_add(it->push[node[end]].dv,
                       -weight[end] * impulse * it->point[node[end]].inverse_mass, contact->change);
}

/* First of a section's contacts; of the number past the last section, the end of all. */
static int first_contact(const struct interaction *it, int section) {
    return section < it->volume_count ? it->volume[section].first_contact : it->contact_count;
}

/* Whether a point numbered `from` to `to` is in a section: its contacts are sorted by point. */
static int any_in_section(const struct interaction *it, int section, int from, int to) {
    const int end = first_contact(it, section + 1);
    int low = first_contact(it, section), high = end;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (it->contact[middle].point < from)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && it->contact[low].point <= to;
}

/* Whether a free node or sample of an end of the section is in a section that the point's node
 * bounds. */
static int is_mutual(const struct interaction *it, const struct contact *contact) {
    const int section = contact->section, begin = end_point(it, section, 0),
              end = end_point(it, section, 1), to = end + it->node_points - 1;
    const int from = begin < 0 ? end : begin;
    const int before = it->point[contact->point].node; /* it ends that, and begins the next */
    const struct node *node = &it->node[before];
    const int last = node->index == it->strand[node->strand]->wisp->nodes - 1;
    return any_in_section(it, before, from, to) ||
           (!last && any_in_section(it, before + 1, from, to));
}

/* As in the thesis: the point alone gives way, by all of the change, or by half of it where the
 * section's turn comes as a point of its own. */
static void push_point(struct interaction *it, const struct contact *contact) {
    const double part = is_mutual(it, contact) ? 0.5 : 1;
    vector_add(it->push[contact->point].dv, part / it->push[contact->point].shares,
               contact->change);
}

static void push_range(void *ctx, int index) {
    const struct pushing *pushing = ctx;
    struct interaction *it = pushing->it;
    const struct range range = range_of(pushing, index);
    for (int c = 0; c < pushing->count; c++) {
        const struct contact *contact = &pushing->contact[c];
        __builtin_prefetch(&it->push[ahead(pushing, c)], 1);
        __builtin_prefetch(&it->point[ahead(pushing, c)]);
        if (!contact->corrected)
            continue;
        if (it->settings.reciprocal)
            push_both(it, contact, range);
        else if (in_range(range, contact->point))
            push_point(it, contact);
    }
}

/* What contacts ask of every point, into it->push. */
static void add_up(struct interaction *it, const struct contact *contacts, int count) {
    struct pushing pushing = {it, contacts, count, workers_threads(it->workers)};
    workers_run(it->workers, count_shares, &pushing, pushing.ranges);
    workers_run(it->workers, push_range, &pushing, pushing.ranges);
}

/* A sample takes of its change only the part along its half-line; the rest is lost. */
static void change_sample(struct strand *strand, int node, int sample, const double dv[3]) {
    const int at = node * strand->wisp->samples + sample;
    double a[3];
    strand_half_line(strand, node, sample, a);
    strand_set_sample(strand, node, sample, strand->r[at], strand->rate[at] + vector_dot(dv, a));
}

static void change_share(void *ctx, int index) {
    static const double still[3] = {0, 0, 0};
    struct interaction *it = ctx;
    const struct share *share = &it->share[index];
    for (int s = share->from; s < share->to; s++) {
        const struct contact_push *push = &it->push[it->first[s] * it->node_points];
        for (int i = 2; i < it->strand[s]->wisp->nodes; i++)
            for (int j = -1; j < it->node_points - 1; j++, push++) {
                if (vector_dot(push->dv, push->dv) == 0)
                    continue;
                if (j < 0)
                    strand_move_node(it->strand[s], i, still, push->dv);
                else
                    change_sample(it->strand[s], i, j, push->dv);
            }
    }
}

void interaction_add_up(struct interaction *it) {
    add_up(it, it->contact, it->contact_count);
}

void interaction_apply(struct interaction *it, struct strand *const *strands,
                       const struct contact *contacts, int count) {
    it->strand = strands;
    add_up(it, contacts, count);
    workers_run(it->workers, change_share, it, SHARES);
}

int interaction_tick(struct interaction *it, struct strand *const *strands, int count) {
    const int contacts = interaction_find(it, strands, count);
    if (contacts > 0)
        interaction_apply(it, strands, it->contact, contacts);
    return contacts;
}
