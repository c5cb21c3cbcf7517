#include "interaction.h"

#include "base/vector.h"
#include "grid.h"
#include "section.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* A section with what its responses need to know. */
struct volume {
    struct section section;
    int strand;
    double density;    /* chi */
    int first_contact; /* first of its contacts, which end where the next one's begin */
};

/* A free node with its samples. Sections and free nodes of a wisp are equal in number: node i + 1
 * has the number of section (i, i + 1), which it ends. Points are numbered node by node, each
 * before its samples. */
struct node {
    double v[3];                 /* V: the mean of its own velocity and its samples', m/s */
    double direction[3];         /* w */
    double yield[2];             /* 1 / mass: of all of it, of one sample, 1/kg */
    const double (*sample_v)[3]; /* its samples', m/s */
    int strand, index;
};

/* Some wisps after each other: a task for a thread. */
struct share {
    int from, to; /* strands, to before */
    int count, room;
    struct contact *contact; /* of their sections */
    int failed;              /* no memory for those */
    double sides;            /* of their sections, see cell_side, m */
};
enum { SHARES = 32 };

struct interaction {
    struct interaction_settings settings;
    struct workers *workers;
    struct grid *grid;
    int volume_count, point_count, contact_count;
    int strand_room, volume_room, point_room, contact_room;
    struct strand *const *strand; /* of the tick */
    int node_points;              /* of a node: 1 and its samples */
    int *first;                   /* by strand: number of its first section and first free node */
    struct volume *volume;        /* by section */
    struct node *node;            /* by section */
    double (*x)[3];               /* by point, m */
    double (*dv)[3];              /* by point: what corrections add up to, m/s */
    int *shares;                  /* by point: corrections in which it takes part */
    struct contact *contact;
    struct share share[SHARES];
};

/* --- memory that only grows --- */

struct interaction *interaction_create(const struct interaction_settings *settings) {
    struct interaction *it = calloc(1, sizeof *it);
    if (!it)
        return NULL;
    it->settings = *settings;
    it->grid = grid_create();
    if (it->grid)
        return it;
    interaction_free(it);
    return NULL;
}

void interaction_free(struct interaction *it) {
    if (!it)
        return;
    grid_free(it->grid);
    for (int i = 0; i < SHARES; i++)
        free(it->share[i].contact);
    free(it->first);
    free(it->volume);
    free(it->node);
    free(it->x);
    free(it->dv);
    free(it->shares);
    free(it->contact);
    free(it);
}

void interaction_share(struct interaction *it, struct workers *workers) {
    it->workers = workers;
}

/* Room for that many, contents lost. */
static int make_room(struct interaction *it, int strands, int volumes, int points) {
    if (strands > it->strand_room) {
        free(it->first);
        it->first = malloc((size_t)strands * sizeof *it->first);
        it->strand_room = it->first ? strands : 0;
    }
    if (volumes > it->volume_room) {
        free(it->volume);
        free(it->node);
        it->volume = malloc((size_t)volumes * sizeof *it->volume);
        it->node = malloc((size_t)volumes * sizeof *it->node);
        it->volume_room = it->volume && it->node ? volumes : 0;
    }
    if (points > it->point_room) {
        free(it->x);
        free(it->dv);
        free(it->shares);
        it->x = malloc((size_t)points * sizeof *it->x);
        it->dv = malloc((size_t)points * sizeof *it->dv);
        it->shares = malloc((size_t)points * sizeof *it->shares);
        it->point_room = it->x && it->dv && it->shares ? points : 0;
    }
    return strands > it->strand_room || volumes > it->volume_room || points > it->point_room ? -1
                                                                                             : 0;
}

/* Room for `need` contacts and half as many again, which are kept. */
static int make_contact_room(struct contact **contact, int *room, size_t need) {
    if (need <= (size_t)*room)
        return 0;
    const size_t more = need + need / 2;
    struct contact *grown = more > INT_MAX ? NULL : realloc(*contact, more * sizeof *grown);
    if (!grown)
        return -1;
    *contact = grown;
    *room = (int)more;
    return 0;
}

/* --- points and sections of all strands --- */

/* Masses of a node, the same for all of a wisp but the last. */
struct weights {
    double own, each;              /* part of the node and of a sample in all of it */
    double node_yield, each_yield; /* 1 / mass: of the node with its samples; of a sample, 1/kg */
};

static struct weights weights_of(const struct wisp *wisp, int node) {
    const double own = wisp_node_mass(wisp, node), each = wisp_sample_mass(wisp, node);
    const double yield = 1 / (own + wisp->samples * each);
    return (struct weights){own * yield, each * yield, yield, 1 / each};
}

/* Node number `number` and its points. */
static void add_node(struct interaction *it, int number, int index, int i,
                     const struct weights *weights) {
    const struct strand *strand = it->strand[index];
    const int samples = strand->wisp->samples;
    double(*x)[3] = &it->x[(size_t)number * (size_t)it->node_points];
    struct node *node = &it->node[number];
    *node = (struct node){.yield = {weights->node_yield, weights->each_yield},
                          .sample_v = (const double(*)[3]) & strand->ev[i * samples],
                          .strand = index,
                          .index = i};
    memcpy(node->direction, strand->axis_w[i], sizeof node->direction);
    memcpy(*x++, strand->p[i], sizeof *x);
    memcpy(x, strand->e[i * samples], (size_t)samples * sizeof *x);
    for (int j = 0; j < samples; j++)
        vector_add(node->v, weights->each, strand->ev[i * samples + j]);
    vector_add(node->v, weights->own, strand->v[i]);
}

static void add_section(struct interaction *it, int number, int index, int i) {
    const struct strand *strand = it->strand[index];
    const struct wisp *wisp = strand->wisp;
    const double share = wisp->splits ? ldexp(1, -wisp->splits) : 1,
                 rest = wisp->radius * wisp->radius;
    struct volume *volume = &it->volume[number];
    section_make(&volume->section, strand, i);
    volume->strand = index;
    volume->density = fmin(4, rest / volume->section.mean_r2) * share;
}

/* A cell is as large as a section's box in the mean (0.7: no difference; 0.5: up to a third slower
 * where wisps hardly touch; 0.35: half as slow again and more). One that has flown apart
 * must not make all cells large: none counts for more than eight at rest. */
static double side_of(const struct section *section) {
    const struct wisp *wisp = section->strand->wisp;
    const double rest = wisp_spacing(wisp) + 2 * wisp->radius;
    double side = section->usable ? 0 : rest;
    for (int k = 0; k < 3 && section->usable; k++)
        side = fmax(side, section->high[k] - section->low[k]);
    return fmin(side, 8 * rest);
}

static double cell_side(const struct interaction *it) {
    double sum = 0;
    for (int i = 0; i < SHARES; i++)
        sum += it->share[i].sides;
    return sum / it->volume_count;
}

static void gather_share(void *ctx, int index) {
    struct interaction *it = ctx;
    struct share *share = &it->share[index];
    share->sides = 0;
    for (int s = share->from; s < share->to; s++) {
        const struct wisp *wisp = it->strand[s]->wisp;
        const int last = wisp->nodes - 1;
        const struct weights inner = weights_of(wisp, 2), end = weights_of(wisp, last);
        for (int i = 1, number = it->first[s]; i < last; i++, number++) {
            add_section(it, number, s, i);
            add_node(it, number, s, i + 1, i + 1 < last ? &inner : &end);
            share->sides += side_of(&it->volume[number].section);
        }
    }
}

static int gather(struct interaction *it, struct strand *const *strands, int count) {
    size_t nodes = 0;
    for (int s = 0; s < count; s++)
        nodes += (size_t)strands[s]->wisp->nodes - 2;
    it->node_points = count > 0 ? 1 + strands[0]->wisp->samples : 1;
    it->volume_count = it->point_count = it->contact_count = 0;
    if (nodes > (size_t)(INT_MAX / it->node_points) ||
        make_room(it, count, (int)nodes, (int)nodes * it->node_points))
        return -1;
    it->strand = strands;
    for (int s = 0; s < count; s++) {
        it->first[s] = it->volume_count;
        it->volume_count += strands[s]->wisp->nodes - 2;
    }
    it->point_count = it->volume_count * it->node_points;
    for (int i = 0; i < SHARES; i++) {
        it->share[i].from = (int)((long long)count * i / SHARES);
        it->share[i].to = (int)((long long)count * (i + 1) / SHARES);
    }
    workers_run(it->workers, gather_share, it, SHARES);
    return 0;
}

struct contact_place interaction_section(const struct interaction *it, int section) {
    const struct volume *volume = &it->volume[section];
    return (struct contact_place){volume->strand, volume->section.index, -1};
}

struct contact_place interaction_point(const struct interaction *it, int point) {
    const struct node *node = &it->node[point / it->node_points];
    return (struct contact_place){node->strand, node->index, point % it->node_points - 1};
}

/* The node that begins or ends a section, as a point; -1: prescribed. */
static int end_point(const struct interaction *it, int section, int end) {
    const int prescribed = it->volume[section].section.index + end < 2;
    return prescribed ? -1 : (section - 1 + end) * it->node_points;
}

/* --- what a contact asks for --- */

/* Of a node the mean with its samples. */
static const double *velocity(const struct interaction *it, int point) {
    const struct node *node = &it->node[point / it->node_points];
    const int sample = point % it->node_points - 1;
    return sample < 0 ? node->v : node->sample_v[sample];
}

/* u: of the point against the section at lambda. */
static void relative_velocity(const struct interaction *it, const struct contact *contact,
                              double u[3]) {
    const struct volume *volume = &it->volume[contact->section];
    const double weight[2] = {1 - contact->lambda, contact->lambda};
    memcpy(u, velocity(it, contact->point), 3 * sizeof *u);
    for (int end = 0; end < 2; end++) {
        const int i = volume->section.index + end;
        vector_add(u, -weight[end],
                   i < 2 ? volume->section.strand->v[i] : it->node[contact->section - 1 + end].v);
    }
}

/* Hair passes through hair along both wisps' directions but not across both: where they close, the
 * part of u along the common normal goes; the rest is braked by friction. */
static void interpenetrate(double rest, const double normal[3], int closing, const double u[3],
                           struct contact *contact) {
    const double square = vector_dot(normal, normal);
    double kept[3] = {u[0], u[1], u[2]};
    if (closing && sqrt(square) > 0.05) /* nearly parallel wisps have no normal worth the name */
        vector_add(kept, -vector_dot(u, normal) / square, normal);
    for (int k = 0; k < 3; k++)
        contact->change[k] = rest * kept[k] - u[k];
    contact->corrected = 1;
}

/* `rest` is e^(-nu chi dt). Section 4.3.2 of the thesis but for one thing: the criterion does not
 * divide by the length of the normal, which is noise for nearly parallel wisps. */
static void respond(const struct interaction *it, struct contact *contact,
                    const struct section_place *place, double rest) {
    const struct section *section = &it->volume[contact->section].section;
    const double lambda = place->x / section->length;
    double u[3], normal[3];
    contact->lambda = lambda < 0 ? 0 : lambda > 1 ? 1 : lambda;
    relative_velocity(it, contact, u);
    vector_cross(section->t, it->node[contact->point / it->node_points].direction, normal);
    const double speed = vector_length(u);
    const int closing = vector_dot(u, place->q) < 0;
    if (speed < 1e-9 || fabs(vector_dot(normal, u)) < it->settings.threshold * speed) {
        if (it->settings.interpenetration)
            interpenetrate(rest, normal, closing, u, contact);
    } else if (closing && it->settings.collision) {
        for (int k = 0; k < 3; k++)
            contact->change[k] = -u[k];
        contact->corrected = 1;
    }
}

/* --- which points are in which sections --- */

/* Sorts by point: insertion at shrinking distances (Shell; Knuth's), for qsort may allocate. */
static void sort(struct contact *contact, int count) {
    int gap = 1;
    while (gap < count / 3)
        gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3) {
        for (int i = gap; i < count; i++) {
            const struct contact moving = contact[i];
            int to = i;
            for (; to >= gap && contact[to - gap].point > moving.point; to -= gap)
                contact[to] = contact[to - gap];
            contact[to] = moving;
        }
    }
}

/* Appends some contacts of a section. */
static int add_contacts(const struct interaction *it, struct share *share, int section,
                        const int *slot, int count) {
    const struct volume *volume = &it->volume[section];
    const struct strand *twin = volume->section.strand->twin;
    const struct grid_slots slots = grid_slots(it->grid);
    struct section_place places[GRID_BATCH];
    int found[GRID_BATCH];
    count = section_find(&volume->section, &slots, slot, count, found, places);
    if (count == 0)
        return 0;
    const double rest = exp(-it->settings.viscosity * volume->density / it->settings.rate);
    for (int i = 0; i < count; i++) /* their points come in while the first is at work, */
        __builtin_prefetch(&it->node[grid_point(&slots, found[i]) / it->node_points]);
    for (int i = 0; i < count; i++) /* and then their velocities */
        __builtin_prefetch(velocity(it, grid_point(&slots, found[i])));
    if (make_contact_room(&share->contact, &share->room, (size_t)share->count + (size_t)count))
        return -1;
    for (int i = 0; i < count; i++) {
        const int point = grid_point(&slots, found[i]);
        if (twin && it->strand[it->node[point / it->node_points].strand] == twin)
            continue;
        struct contact *contact = &share->contact[share->count++];
        *contact = (struct contact){.section = section, .point = point};
        respond(it, contact, &places[i], rest);
    }
    return 0;
}

/* Points too near along their own wisp: of nodes i - 1 <= k <= i + 2; from, to before. */
static void own_points(const struct interaction *it, int section, int own[2]) {
    const struct volume *volume = &it->volume[section];
    const int first = it->first[volume->strand], i = volume->section.index,
              last = it->strand[volume->strand]->wisp->nodes - 1;
    own[0] = (first + (i > 3 ? i - 3 : 0)) * it->node_points;
    own[1] = (first + (i < last - 2 ? i + 1 : last - 1)) * it->node_points;
}

/* Appends the contacts of one section, by point. */
static int find_in_section(struct interaction *it, struct share *share, int section) {
    struct volume *volume = &it->volume[section];
    struct grid_search search;
    int slot[GRID_BATCH], own[2];
    volume->first_contact = share->count;
    if (!volume->section.usable)
        return 0;
    own_points(it, section, own);
    grid_begin(it->grid, volume->section.low, volume->section.high, own, &search);
    for (int count; (count = grid_next(it->grid, &search, slot)) > 0;)
        if (add_contacts(it, share, section, slot, count))
            return -1;
    if (share->count > volume->first_contact)
        sort(share->contact + volume->first_contact, share->count - volume->first_contact);
    return 0;
}

/* Sections of a share's strands: from, and to before. */
static int first_volume(const struct interaction *it, int strand, int strands) {
    return strand < strands ? it->first[strand] : it->volume_count;
}

static void find_share(void *ctx, int index) {
    struct interaction *it = ctx;
    struct share *share = &it->share[index];
    const int strands = it->share[SHARES - 1].to, to = first_volume(it, share->to, strands);
    share->count = share->failed = 0;
    for (int i = first_volume(it, share->from, strands); i < to && !share->failed; i++)
        share->failed = find_in_section(it, share, i);
}

/* Puts a share's contacts behind those of the shares before it. */
static void collect_share(void *ctx, int index) {
    struct interaction *it = ctx;
    const struct share *share = &it->share[index];
    const int strands = it->share[SHARES - 1].to, to = first_volume(it, share->to, strands);
    int before = 0;
    for (int i = 0; i < index; i++)
        before += it->share[i].count;
    for (int i = first_volume(it, share->from, strands); i < to; i++)
        it->volume[i].first_contact += before;
    if (share->count > 0)
        memcpy(it->contact + before, share->contact, (size_t)share->count * sizeof *it->contact);
}

int interaction_find(struct interaction *it, struct strand *const *strands, int count) {
    size_t contacts = 0;
    if (gather(it, strands, count))
        return -1;
    if (it->volume_count == 0)
        return 0;
    if (grid_fill(it->grid, cell_side(it), (const double(*)[3])it->x, it->point_count, it->workers))
        return -1;
    workers_run(it->workers, find_share, it, SHARES);
    for (int i = 0; i < SHARES; i++) {
        contacts += (size_t)it->share[i].count;
        if (it->share[i].failed)
            return -1;
    }
    if (make_contact_room(&it->contact, &it->contact_room, contacts))
        return -1;
    it->contact_count = (int)contacts;
    workers_run(it->workers, collect_share, it, SHARES);
    return it->contact_count;
}

struct contact *interaction_contacts(struct interaction *it) {
    return it->contact;
}

int interaction_sections(const struct interaction *it) {
    return it->volume_count;
}

/* --- what all contacts do together --- */

/* c of every point. One-sided, a section's nodes take no part. */
static void count_shares(struct interaction *it, const struct contact *contacts, int count) {
    memset(it->shares, 0, (size_t)it->point_count * sizeof *it->shares);
    for (int c = 0; c < count; c++) {
        if (!contacts[c].corrected)
            continue;
        it->shares[contacts[c].point]++;
        for (int end = 0; end < 2 && it->settings.reciprocal; end++) {
            const int node = end_point(it, contacts[c].section, end);
            if (node >= 0)
                it->shares[node]++;
        }
    }
}

/* 1 / mass of what moves with a point, 1/kg. */
static double yield_of(const struct interaction *it, int point) {
    return it->node[point / it->node_points].yield[point % it->node_points > 0];
}

/* An impulse on the point and its opposite on the section's nodes. It is what would bring u to u'
 * if it were alone, divided by the number of those that do so to the same node or sample: then
 * energy cannot grow (it is convex, and each node's velocity ends up between what single contacts
 * ask of it and what it was). */
static void push_both(struct interaction *it, const struct contact *contact) {
    const double weight[2] = {1 - contact->lambda, contact->lambda};
    const double own_yield = yield_of(it, contact->point);
    double yield = own_yield; /* change of u by a unit of impulse, 1/kg */
    int shares = it->shares[contact->point];
    for (int end = 0; end < 2; end++) {
        const int node = end_point(it, contact->section, end);
        if (node < 0)
            continue;
        yield += weight[end] * weight[end] * yield_of(it, node);
        shares = it->shares[node] > shares ? it->shares[node] : shares;
    }
    const double impulse = 1 / (yield * shares); /* kg */
    vector_add(it->dv[contact->point], impulse * own_yield, contact->change);
    for (int end = 0; end < 2; end++) {
        const int node = end_point(it, contact->section, end);
        if (node >= 0)
            vector_add(it->dv[node], -weight[end] * impulse * yield_of(it, node), contact->change);
    }
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
    const int before =
        contact->point / it->node_points; /* the node ends that, and begins the next */
    const struct node *node = &it->node[before];
    const int last = node->index == it->strand[node->strand]->wisp->nodes - 1;
    return any_in_section(it, before, from, to) ||
           (!last && any_in_section(it, before + 1, from, to));
}

/* As in the thesis: the point alone gives way, by all of the change, or by half of it where the
 * section's turn comes as a point of its own. */
static void push_point(struct interaction *it, const struct contact *contact) {
    const double part = is_mutual(it, contact) ? 0.5 : 1;
    vector_add(it->dv[contact->point], part / it->shares[contact->point], contact->change);
}

/* Of a sample's change only the part along its half-line; the rest is lost. */
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
        const double(*dv)[3] = (const double(*)[3]) & it->dv[it->first[s] * it->node_points];
        for (int i = 2; i < it->strand[s]->wisp->nodes; i++)
            for (int j = -1; j < it->node_points - 1; j++, dv++) {
                if (vector_dot(*dv, *dv) == 0)
                    continue;
                if (j < 0)
                    strand_move_node(it->strand[s], i, still, *dv);
                else
                    change_sample(it->strand[s], i, j, *dv);
            }
    }
}

void interaction_apply(struct interaction *it, struct strand *const *strands,
                       const struct contact *contacts, int count) {
    it->strand = strands;
    count_shares(it, contacts, count);
    memset(it->dv, 0, (size_t)it->point_count * sizeof *it->dv);
    for (int c = 0; c < count; c++) {
        if (!contacts[c].corrected)
            continue;
        if (it->settings.reciprocal)
            push_both(it, &contacts[c]);
        else
            push_point(it, &contacts[c]);
    }
    workers_run(it->workers, change_share, it, SHARES);
}

int interaction_tick(struct interaction *it, struct strand *const *strands, int count) {
    const int contacts = interaction_find(it, strands, count);
    if (contacts > 0)
        interaction_apply(it, strands, it->contact, contacts);
    return contacts;
}
