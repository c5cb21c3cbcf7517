#include "base/vector.h"
#include "interaction_parts.h"
#include "response.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

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
    for (int i = 0; i < SHARES; i++) {
        free(it->share[i].contact);
        free(it->share[i].found.number);
    }
    free(it->first);
    free(it->volume);
    free(it->node);
    free(it->point);
    free(it->push);
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
        free(it->point);
        free(it->push);
        it->point = aligned_alloc(sizeof *it->point, (size_t)points * sizeof *it->point);
        it->push = malloc((size_t)points * sizeof *it->push);
        it->point_room = it->point && it->push ? points : 0;
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
    double own, each; /* part of the node and of a sample in all of it */
    double node_inverse_mass,
        sample_inverse_mass; /* 1 / mass: of the node with its samples; of a sample, 1/kg */
};

static struct weights weights_of(const struct wisp *wisp, int node) {
    const double own = wisp_node_mass(wisp, node), each = wisp_sample_mass(wisp, node);
    const double inverse_mass = 1 / (own + wisp->samples * each);
    return (struct weights){own * inverse_mass, each * inverse_mass, inverse_mass, 1 / each};
}

/* The points of node number `number`. */
static void add_points(struct interaction *it, int number, int index, int i,
                       const struct weights *weights) {
    const struct strand *strand = it->strand[index];
    const int samples = strand->wisp->samples;
    struct contact_point *point = &it->point[(size_t)number * (size_t)it->node_points];
    double v[3] = {0};
    for (int j = 0; j < samples; j++) {
        const int at = i * samples + j;
        point[1 + j] = (struct contact_point){
            .node = number, .sample = j, .inverse_mass = weights->sample_inverse_mass};
        memcpy(point[1 + j].x, strand->e[at], sizeof strand->e[at]);
        memcpy(point[1 + j].v, strand->ev[at], sizeof strand->ev[at]);
        vector_add(v, weights->each, strand->ev[at]);
    }
    vector_add(v, weights->own, strand->v[i]);
    *point = (struct contact_point){
        .node = number, .sample = -1, .inverse_mass = weights->node_inverse_mass};
    memcpy(point->x, strand->p[i], sizeof point->x);
    memcpy(point->v, v, sizeof point->v);
}

static void point_share(void *ctx, int index) {
    struct interaction *it = ctx;
    const struct share *share = &it->share[index];
    for (int s = share->from; s < share->to; s++) {
        const struct wisp *wisp = it->strand[s]->wisp;
        const int last = wisp->nodes - 1;
        const struct weights inner = weights_of(wisp, 2), end = weights_of(wisp, last);
        for (int i = 2; i <= last; i++)
            add_points(it, it->first[s] + i - 2, s, i, i < last ? &inner : &end);
    }
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
    for (int k = 0; k < 3 && section->usable; k++) {
        const double length = section->high[k] - section->low[k];
        side = length > side ? length : side;
    }
    return side < 8 * rest ? side : 8 * rest;
}

static const double nowhere[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};

/* Makes a box large enough for another. */
static void widen(double box[6], const double low[3], const double high[3]) {
    for (int k = 0; k < 3; k++) {
        box[k] = low[k] < box[k] ? low[k] : box[k];
        box[3 + k] = high[k] > box[3 + k] ? high[k] : box[3 + k];
    }
}

static int fill_grid(struct interaction *it) {
    struct grid_points points = {
        .x = it->point[0].x, .stride = POINT_NUMBERS, .count = it->point_count};
    memcpy(points.box, nowhere, sizeof nowhere);
    for (int i = 0; i < SHARES; i++) {
        points.cell += it->share[i].sides / it->volume_count;
        widen(points.box, it->share[i].box, it->share[i].box + 3);
    }
    return grid_fill(it->grid, &points, it->workers);
}

static void gather_share(void *ctx, int index) {
    struct interaction *it = ctx;
    struct share *share = &it->share[index];
    share->sides = 0;
    memcpy(share->box, nowhere, sizeof nowhere);
    for (int s = share->from; s < share->to; s++) {
        const struct wisp *wisp = it->strand[s]->wisp;
        for (int i = 1, number = it->first[s]; i < wisp->nodes - 1; i++, number++) {
            add_section(it, number, s, i);
            it->node[number] = (struct node){.strand = s, .index = i + 1};
            memcpy(it->node[number].direction, it->strand[s]->axis_w[i + 1],
                   sizeof it->node[number].direction);
            const struct section *section = &it->volume[number].section;
            share->sides += side_of(section);
            if (section->usable)
                widen(share->box, section->low, section->high);
        }
    }
}

int interaction_begin(struct interaction *it, struct strand *const *strands, int count) {
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
    return 0;
}

int interaction_first_node(const struct interaction *it, int strand) {
    return it->first[strand];
}

struct contact_point *interaction_points(struct interaction *it, int strand) {
    return &it->point[it->first[strand] * it->node_points];
}

const struct contact_push *interaction_pushes(const struct interaction *it, int strand) {
    return &it->push[it->first[strand] * it->node_points];
}

struct contact_place interaction_section(const struct interaction *it, int section) {
    const struct volume *volume = &it->volume[section];
    return (struct contact_place){volume->strand, volume->section.index, -1};
}

struct contact_place interaction_point(const struct interaction *it, int point) {
    const struct node *node = &it->node[it->point[point].node];
    return (struct contact_place){node->strand, node->index, it->point[point].sample};
}

/* --- which points are in which sections --- */

/* The velocity of an end of a section: of a node the mean with its samples. */
static const double *end_velocity(const struct interaction *it, int section, int end) {
    const struct section *s = &it->volume[section].section;
    const int i = s->index + end, point = end_point(it, section, end);
    return point < 0 ? s->strand->v[i] : it->point[point].v;
}

/* Up to SECTION_POINTS points, by number, against a section; the last one again where there are
 * fewer. */
static void add_contacts(const struct interaction *it, struct share *share, int section,
                         const struct answerer *answerer, const int *number, int count) {
    const struct strand *twin = answerer->section->strand->twin;
    const double *x[SECTION_POINTS], *v[SECTION_POINTS], *w[SECTION_POINTS];
    struct section_places places;
    struct responses responses;
    for (int k = 0; k < SECTION_POINTS; k++) {
        const struct contact_point *point = &it->point[number[k < count ? k : count - 1]];
        x[k] = point->x;
        v[k] = point->v;
        w[k] = it->node[point->node].direction;
    }
    unsigned in = section_find(answerer->section, x, &places) & ((1u << count) - 1);
    for (int k = 0; k < count && twin; k++)
        if (it->strand[it->node[it->point[number[k]].node].strand] == twin)
            in &= ~(1u << k);
    if (!in)
        return;
    const unsigned corrected = respond(answerer, &places, v, w, &responses);
    for (int k = 0; k < count; k++) { /* written and kept or not: nobody could guess a branch */
        struct contact *contact = &share->contact[share->count];
        *contact = (struct contact){
            .section = section,
            .point = number[k],
            .corrected = (int)(corrected >> k & 1),
            .lambda = responses.lambda[k],
            .change = {responses.change[0][k], responses.change[1][k], responses.change[2][k]}};
        share->count += (int)(in >> k & 1);
    }
}

/* Points too near along their own wisp: of nodes i - 1 <= k <= i + 2; from, to before. */
static void own_points(const struct interaction *it, int section, int own[2]) {
    const struct volume *volume = &it->volume[section];
    const int first = it->first[volume->strand], i = volume->section.index,
              last = it->strand[volume->strand]->wisp->nodes - 1;
    own[0] = (first + (i > 3 ? i - 3 : 0)) * it->node_points;
    own[1] = (first + (i < last - 2 ? i + 1 : last - 1)) * it->node_points;
}

/* Points near a section, which are looked at later: one does not wait for the other. */
static int look_near(struct interaction *it, struct share *share, int section) {
    struct volume *volume = &it->volume[section];
    struct grid_search search;
    volume->found = share->found.count;
    if (!volume->section.usable)
        return 0;
    section_search(&volume->section, &search);
    own_points(it, section, search.except);
    if (grid_find(it->grid, &search, &share->found))
        return -1;
    for (int i = volume->found; i < share->found.count; i++)
        __builtin_prefetch(&it->point[share->found.number[i]]);
    return 0;
}

/* Appends the contacts of one section, by point, among the points near it, to before `end`. */
static int find_in_section(struct interaction *it, struct share *share, int section, int end) {
    struct volume *volume = &it->volume[section];
    const int *number = share->found.number;
    volume->first_contact = share->count;
    if (volume->found == end)
        return 0;
    if (make_contact_room(&share->contact, &share->room,
                          (size_t)share->count + (size_t)(end - volume->found) + SECTION_POINTS))
        return -1;
    const struct answerer answerer = {
        &it->settings,
        &volume->section,
        {end_velocity(it, section, 0), end_velocity(it, section, 1)},
        exp(-it->settings.viscosity * volume->density / it->settings.rate)};
    for (int i = volume->found; i < end; i += SECTION_POINTS)
        add_contacts(it, share, section, &answerer, number + i,
                     end - i < SECTION_POINTS ? end - i : SECTION_POINTS);
    return 0;
}

static int find_in_strand(struct interaction *it, struct share *share, int strand) {
    const int from = it->first[strand], to = from + it->strand[strand]->wisp->nodes - 2;
    share->found.count = 0;
    for (int i = from; i < to; i++)
        if (look_near(it, share, i))
            return -1;
    for (int i = from; i < to; i++)
        if (find_in_section(it, share, i,
                            i + 1 < to ? it->volume[i + 1].found : share->found.count))
            return -1;
    return 0;
}

static void find_share(void *ctx, int index) {
    struct interaction *it = ctx;
    struct share *share = &it->share[index];
    share->count = share->failed = 0;
    for (int s = share->from; s < share->to && !share->failed; s++)
        share->failed = find_in_strand(it, share, s);
}

/* Sections of a share's strands: from, and to before. */
static int first_volume(const struct interaction *it, int strand, int strands) {
    return strand < strands ? it->first[strand] : it->volume_count;
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

int interaction_search(struct interaction *it) {
    size_t contacts = 0;
    if (it->volume_count == 0)
        return 0;
    workers_run(it->workers, gather_share, it, SHARES);
    if (fill_grid(it))
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

int interaction_find(struct interaction *it, struct strand *const *strands, int count) {
    if (interaction_begin(it, strands, count))
        return -1;
    workers_run(it->workers, point_share, it, SHARES);
    return interaction_search(it);
}

struct contact *interaction_contacts(struct interaction *it) {
    return it->contact;
}

int interaction_sections(const struct interaction *it) {
    return it->volume_count;
}
