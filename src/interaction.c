#include "interaction.h"

#include "grid.h"
#include "section.h"
#include "vector.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* A section with what its responses need to know. */
struct volume {
    struct section section;
    int strand;
    int end[2];      /* points that are its nodes; -1: prescribed */
    const double *v; /* of node i where it is prescribed, m/s */
    double density;  /* chi */
    int own[2];      /* points too near along its own wisp, i - 1 <= k <= i + 2: from, to before */
    int first_contact; /* first of its contacts, which end where the next one's begin */
};

/* A free node, standing for itself and its samples, or a sample. */
struct point {
    double v[3];         /* V of a node: the mean with its samples; else its own; m/s */
    double direction[3]; /* w of its node; a copy beside v, for points are met in any order */
    double mass;         /* of a node with its samples', kg */
    double dv[3];        /* what corrections add up to, m/s */
    int shares;          /* corrections in which it takes part */
    int section[2];      /* those that its node bounds; -1: none */
    struct contact_place place;
};

struct interaction {
    struct interaction_settings settings;
    struct grid *grid;
    int volume_count, point_count, contact_count;
    int volume_room, point_room, contact_room;
    struct volume *volume;
    struct point *point;
    double (*x)[3]; /* by point, m */
    int *found;     /* room for what grid_find finds */
    struct contact *contact;
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
    free(it->volume);
    free(it->point);
    free(it->x);
    free(it->found);
    free(it->contact);
    free(it);
}

/* Room for `count` points and fewer sections, contents lost. */
static int make_room(struct interaction *it, int volumes, int points) {
    if (volumes > it->volume_room) {
        free(it->volume);
        it->volume = malloc((size_t)volumes * sizeof *it->volume);
        it->volume_room = it->volume ? volumes : 0;
    }
    if (points > it->point_room) {
        free(it->point);
        free(it->x);
        free(it->found);
        it->point = malloc((size_t)points * sizeof *it->point);
        it->x = malloc((size_t)points * sizeof *it->x);
        it->found = malloc(((size_t)points + 1) * sizeof *it->found);
        it->point_room = it->point && it->x && it->found ? points : 0;
    }
    return volumes > it->volume_room || points > it->point_room ? -1 : 0;
}

/* Room for `more` contacts after those there are. */
static int make_contact_room(struct interaction *it, int more) {
    const size_t need = (size_t)it->contact_count + (size_t)more;
    if (need <= (size_t)it->contact_room)
        return 0;
    const size_t room = need + need / 2;
    if (room > INT_MAX)
        return -1;
    struct contact *grown = realloc(it->contact, room * sizeof *grown);
    if (!grown)
        return -1;
    it->contact = grown;
    it->contact_room = (int)room;
    return 0;
}

/* --- points and sections of all strands --- */

/* A free node and its samples. The mean velocity of the node is that of its mass and theirs. */
static void add_node(struct interaction *it, const struct strand *strand, int index, int node) {
    const int last = node == strand->wisp->nodes - 1;
    const int before = it->volume_count - (strand->wisp->nodes - 2) + node - 2;
    const int samples = strand->wisp->samples;
    const double own = wisp_node_mass(strand->wisp, node),
                 each = wisp_sample_mass(strand->wisp, node);
    struct point *mean = &it->point[it->point_count];
    *mean = (struct point){.place = {index, node, -1},
                           .section = {before, last ? -1 : before + 1},
                           .mass = own + samples * each};
    memcpy(mean->direction, strand->axis_w[node], sizeof mean->direction);
    memcpy(it->x[it->point_count++], strand->p[node], sizeof *it->x);
    for (int j = 0; j < samples; j++) {
        const int at = node * samples + j;
        struct point *point = &it->point[it->point_count];
        *point = *mean;
        point->place.sample = j;
        point->mass = each;
        memcpy(point->v, strand->ev[at], sizeof point->v);
        memcpy(it->x[it->point_count++], strand->e[at], sizeof *it->x);
        vector_add(mean->v, each / mean->mass, strand->ev[at]);
    }
    vector_add(mean->v, own / mean->mass, strand->v[node]);
}

/* `points`: number of the strand's first point. */
static void add_sections(struct interaction *it, const struct strand *strand, int index,
                         int points) {
    const struct wisp *wisp = strand->wisp;
    const double share = ldexp(1, -wisp->splits), rest = wisp->radius * wisp->radius;
    const int each = 1 + wisp->samples, last = wisp->nodes - 1;
    for (int i = 1; i < last; i++) {
        struct volume *volume = &it->volume[it->volume_count++];
        section_make(&volume->section, strand, i);
        volume->strand = index;
        volume->v = strand->v[i];
        volume->density = fmin(4, rest / volume->section.mean_r2) * share;
        for (int end = 0; end < 2; end++)
            volume->end[end] = i + end < 2 ? -1 : points + (i + end - 2) * each;
        volume->own[0] = points + (i > 3 ? i - 3 : 0) * each;
        volume->own[1] = points + (i < last - 2 ? i + 1 : last - 1) * each;
    }
}

static int gather(struct interaction *it, struct strand *const *strands, int count) {
    size_t volumes = 0, points = 0;
    for (int s = 0; s < count; s++) {
        const size_t free_nodes = (size_t)strands[s]->wisp->nodes - 2;
        volumes += free_nodes;
        points += free_nodes * (size_t)(1 + strands[s]->wisp->samples);
    }
    it->volume_count = it->point_count = it->contact_count = 0;
    if (points > INT_MAX || make_room(it, (int)volumes, (int)points))
        return -1;
    for (int s = 0; s < count; s++) {
        add_sections(it, strands[s], s, it->point_count);
        for (int i = 2; i < strands[s]->wisp->nodes; i++)
            add_node(it, strands[s], s, i);
    }
    return 0;
}

struct contact_place interaction_section(const struct interaction *it, int section) {
    const struct volume *volume = &it->volume[section];
    return (struct contact_place){volume->strand, volume->section.index, -1};
}

struct contact_place interaction_point(const struct interaction *it, int point) {
    return it->point[point].place;
}

/* --- what a contact asks for --- */

/* u: of the point against the section at lambda. */
static void relative_velocity(const struct interaction *it, const struct contact *contact,
                              double u[3]) {
    const struct volume *volume = &it->volume[contact->section];
    const double weight[2] = {1 - contact->lambda, contact->lambda};
    memcpy(u, it->point[contact->point].v, 3 * sizeof *u);
    for (int end = 0; end < 2; end++)
        vector_add(u, -weight[end],
                   volume->end[end] < 0 ? volume->v : it->point[volume->end[end]].v);
}

/* Hair passes through hair along both wisps' directions but not across both: where they close, the
 * part of u along the common normal goes; the rest is braked by friction. */
static void interpenetrate(const struct interaction *it, const struct volume *volume,
                           const double normal[3], int closing, const double u[3],
                           struct contact *contact) {
    const double square = vector_dot(normal, normal);
    const double rest =
        exp(-it->settings.viscosity * volume->density / it->settings.rate); /* e^(-nu chi dt) */
    double kept[3] = {u[0], u[1], u[2]};
    if (closing && sqrt(square) > 0.05) /* nearly parallel wisps have no normal worth the name */
        vector_add(kept, -vector_dot(u, normal) / square, normal);
    for (int k = 0; k < 3; k++)
        contact->change[k] = rest * kept[k] - u[k];
    contact->corrected = 1;
}

/* Section 4.3.2 of the thesis but for one thing: the criterion does not divide by the length of the
 * normal, which is noise for nearly parallel wisps. */
static void respond(const struct interaction *it, struct contact *contact,
                    const struct section_place *place) {
    const struct volume *volume = &it->volume[contact->section];
    const struct section *section = &volume->section;
    double u[3], normal[3];
    contact->lambda = fmin(1, fmax(0, place->x / section->length));
    relative_velocity(it, contact, u);
    vector_cross(section->t, it->point[contact->point].direction, normal);
    const double speed = vector_length(u);
    const int closing = vector_dot(u, place->q) < 0;
    if (speed < 1e-9 || fabs(vector_dot(normal, u)) < it->settings.threshold * speed) {
        if (it->settings.interpenetration)
            interpenetrate(it, volume, normal, closing, u, contact);
    } else if (closing && it->settings.collision) {
        for (int k = 0; k < 3; k++)
            contact->change[k] = -u[k];
        contact->corrected = 1;
    }
}

/* --- which points are in which sections --- */

/* A cell is as large as a section's box in the mean (half as large: slower by a third). One that
 * has flown apart must not make all cells large: none counts for more than eight at rest. */
static double cell_side(const struct interaction *it, struct strand *const *strands) {
    double sum = 0;
    for (int i = 0; i < it->volume_count; i++) {
        const struct section *section = &it->volume[i].section;
        const struct wisp *wisp = strands[it->volume[i].strand]->wisp;
        const double rest = wisp_spacing(wisp) + 2 * wisp->radius;
        double side = section->usable ? 0 : rest;
        for (int k = 0; k < 3 && section->usable; k++)
            side = fmax(side, section->high[k] - section->low[k]);
        sum += fmin(side, 8 * rest);
    }
    return sum / it->volume_count;
}

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

/* Appends the contacts of one section, by point. */
static int find_in_section(struct interaction *it, struct strand *const *strands, int section) {
    struct volume *volume = &it->volume[section];
    const struct strand *twin = strands[volume->strand]->twin;
    struct section_place place;
    int near = 0;
    volume->first_contact = it->contact_count;
    if (volume->section.usable)
        near = grid_find(it->grid, volume->section.low, volume->section.high, it->found);
    if (make_contact_room(it, near))
        return -1;
    for (int i = 0; i < near; i++) {
        const int point = it->found[i];
        if ((point >= volume->own[0] && point < volume->own[1]) ||
            (twin && strands[it->point[point].place.strand] == twin) ||
            !section_contains(&volume->section, it->x[point], &place))
            continue;
        struct contact *contact = &it->contact[it->contact_count++];
        *contact = (struct contact){.section = section, .point = point};
        respond(it, contact, &place);
    }
    if (it->contact_count > volume->first_contact)
        sort(it->contact + volume->first_contact, it->contact_count - volume->first_contact);
    return 0;
}

int interaction_find(struct interaction *it, struct strand *const *strands, int count) {
    if (gather(it, strands, count))
        return -1;
    if (it->volume_count == 0)
        return 0;
    if (grid_fill(it->grid, cell_side(it, strands), (const double(*)[3])it->x, it->point_count))
        return -1;
    for (int section = 0; section < it->volume_count; section++)
        if (find_in_section(it, strands, section))
            return -1;
    return it->contact_count;
}

struct contact *interaction_contacts(struct interaction *it) {
    return it->contact;
}

/* --- what all contacts do together --- */

/* c of every point. One-sided, a section's nodes take no part. */
static void count_shares(struct interaction *it, const struct contact *contacts, int count) {
    for (int i = 0; i < it->point_count; i++)
        it->point[i].shares = 0;
    for (int c = 0; c < count; c++) {
        const struct volume *volume = &it->volume[contacts[c].section];
        if (!contacts[c].corrected)
            continue;
        it->point[contacts[c].point].shares++;
        for (int end = 0; end < 2 && it->settings.reciprocal; end++)
            if (volume->end[end] >= 0)
                it->point[volume->end[end]].shares++;
    }
}

/* An impulse on the point and its opposite on the section's nodes. It is what would bring u to u'
 * if it were alone, divided by the number of those that do so to the same node or sample: then
 * energy cannot grow (it is convex, and each node's velocity ends up between what single contacts
 * ask of it and what it was). */
static void push_both(struct interaction *it, const struct contact *contact) {
    const struct volume *volume = &it->volume[contact->section];
    const double weight[2] = {1 - contact->lambda, contact->lambda};
    struct point *point = &it->point[contact->point];
    double yield = 1 / point->mass; /* change of u by a unit of impulse, 1/kg */
    int shares = point->shares;
    for (int end = 0; end < 2; end++) {
        if (volume->end[end] < 0)
            continue;
        const struct point *node = &it->point[volume->end[end]];
        yield += weight[end] * weight[end] / node->mass;
        shares = node->shares > shares ? node->shares : shares;
    }
    const double impulse = 1 / (yield * shares); /* kg */
    vector_add(point->dv, impulse / point->mass, contact->change);
    for (int end = 0; end < 2; end++) {
        if (volume->end[end] < 0)
            continue;
        struct point *node = &it->point[volume->end[end]];
        vector_add(node->dv, -weight[end] * impulse / node->mass, contact->change);
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
    const struct volume *volume = &it->volume[contact->section];
    const struct point *point = &it->point[contact->point];
    const int from = volume->end[0] < 0 ? volume->end[1] : volume->end[0];
    const int to = volume->end[1] + volume->section.strand->wisp->samples;
    for (int side = 0; side < 2; side++)
        if (point->section[side] >= 0 && any_in_section(it, point->section[side], from, to))
            return 1;
    return 0;
}

/* As in the thesis: the point alone gives way, by all of the change, or by half of it where the
 * section's turn comes as a point of its own. */
static void push_point(struct interaction *it, const struct contact *contact) {
    struct point *point = &it->point[contact->point];
    const double part = is_mutual(it, contact) ? 0.5 : 1;
    vector_add(point->dv, part / point->shares, contact->change);
}

/* Of a sample's change only the part along its half-line; the rest is lost. */
static void change_velocity(struct strand *strand, const struct point *point) {
    const int node = point->place.node, sample = point->place.sample;
    const double still[3] = {0, 0, 0};
    double a[3];
    if (vector_dot(point->dv, point->dv) == 0)
        return;
    if (sample < 0) {
        strand_move_node(strand, node, still, point->dv);
        return;
    }
    const int at = node * strand->wisp->samples + sample;
    strand_half_line(strand, node, sample, a);
    strand_set_sample(strand, node, sample, strand->r[at],
                      strand->rate[at] + vector_dot(point->dv, a));
}

void interaction_apply(struct interaction *it, struct strand *const *strands,
                       const struct contact *contacts, int count) {
    count_shares(it, contacts, count);
    for (int i = 0; i < it->point_count; i++)
        memset(it->point[i].dv, 0, sizeof it->point[i].dv);
    for (int c = 0; c < count; c++) {
        if (!contacts[c].corrected)
            continue;
        if (it->settings.reciprocal)
            push_both(it, &contacts[c]);
        else
            push_point(it, &contacts[c]);
    }
    for (int i = 0; i < it->point_count; i++)
        change_velocity(strands[it->point[i].place.strand], &it->point[i]);
}

int interaction_tick(struct interaction *it, struct strand *const *strands, int count) {
    const int contacts = interaction_find(it, strands, count);
    if (contacts > 0)
        interaction_apply(it, strands, it->contact, contacts);
    return contacts;
}
