/* Wisps against wisps: the tick against its rules done by brute
 * force, what physics asks of it, and what it must not depend on. */
#include "base/vector.h"
#include "interaction_oracle.h"
#include "scene/scene_load.h"
#include "wisp/section.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- clusters of wisps --- */

struct cluster {
    int count;
    struct wisp *wisp;
    struct strand **strand;
};

static const struct interaction_settings usual = {.rate = 90,
                                                  .threshold = 0.9,
                                                  .viscosity = 5,
                                                  .interpenetration = 1,
                                                  .collision = 1,
                                                  .reciprocal = 1};

/* Nodes on a line with turns, samples about R, all in motion except the head. */
static void set_state(struct strand *s, double turn, double speed, unsigned *seed) {
    const struct wisp *w = s->wisp;
    double along[3];
    memcpy(along, w->direction, sizeof along);
    for (int i = 0; i < w->nodes; i++) {
        if (i > 1)
            lab_turn(along, turn, seed);
        for (int k = 0; k < 3; k++) {
            s->p[i][k] = i ? s->p[i - 1][k] + along[k] * wisp_spacing(w) : w->root[k];
            s->v[i][k] = i > 1 ? speed * lab_between(seed, -1, 1) : 0;
        }
        for (int j = 0; j < w->samples; j++) {
            s->r[i * w->samples + j] = i > 1 ? w->radius * lab_between(seed, 0.3, 1.5) : w->radius;
            s->rate[i * w->samples + j] = i > 1 ? speed * lab_between(seed, -1, 1) : 0;
        }
    }
    for (int at = 0; at < w->nodes * w->samples && s->treatment == WISP_PENALTY; at++)
        for (int k = 0; k < 3; k++) {
            s->e[at][k] = s->p[at / w->samples][k] + w->radius * lab_between(seed, -1, 1);
            s->ev[at][k] = speed * lab_between(seed, -1, 1);
        }
    strand_refresh(s);
}

/* `count` wisps whose middles are within `spread` of each other, m. */
static void cluster_make(struct cluster *c, int count, int nodes, int samples, double spread,
                         enum wisp_treatment treatment, unsigned *seed) {
    *c = (struct cluster){.count = count,
                          .wisp = test_room((size_t)count * sizeof *c->wisp),
                          .strand = test_room((size_t)count * sizeof *c->strand)};
    for (int i = 0; i < count; i++) {
        struct wisp *w = &c->wisp[i];
        *w = lab_wisp(nodes, samples, BENDING_NONE, seed);
        w->length = (nodes - 1) * lab_between(seed, 0.02, 0.05);
        w->splits = i % 3;
        for (int k = 0; k < 3; k++)
            w->root[k] = w->root[k] * spread / 0.3 - w->direction[k] * w->length / 2;
        c->strand[i] = lab_strand(w, treatment);
        set_state(c->strand[i], 0.5, 1, seed);
    }
}

static struct strand *copy_of(const struct strand *s) {
    const size_t n = (size_t)s->wisp->nodes, m = n * (size_t)s->wisp->samples;
    struct strand *copy = lab_strand(s->wisp, s->treatment);
    memcpy(copy->p, s->p, n * sizeof *s->p);
    memcpy(copy->v, s->v, n * sizeof *s->v);
    memcpy(copy->r, s->r, m * sizeof *s->r);
    memcpy(copy->rate, s->rate, m * sizeof *s->rate);
    memcpy(copy->e, s->e, m * sizeof *s->e);
    memcpy(copy->ev, s->ev, m * sizeof *s->ev);
    strand_refresh(copy);
    return copy;
}

static void cluster_copy(struct cluster *to, const struct cluster *from) {
    cr_assert(from->count > 0, "no wisps");
    *to = (struct cluster){.count = from->count,
                           .strand = test_room((size_t)from->count * sizeof *to->strand)};
    for (int i = 0; i < from->count; i++)
        to->strand[i] = copy_of(from->strand[i]);
}

static struct interaction *make(const struct interaction_settings *settings) {
    struct interaction *it = interaction_create(settings);
    cr_assert(it, "no memory");
    return it;
}

static int find(struct interaction *it, const struct cluster *c) {
    const int count = interaction_find(it, c->strand, c->count);
    cr_assert(count >= 0, "no memory");
    return count;
}

/* --- detection: the grid finds what brute force finds --- */

/* Every section against every point, in (wisp, section, point) order. */
static int check_against_brute_force(const struct cluster *c, const char *what) {
    struct interaction *it = make(&usual);
    const int count = find(it, c);
    const struct contact *contact = interaction_contacts(it);
    int next = 0;
    for (int a = 0; a < c->count; a++) {
        for (int i = 1; i < c->wisp[a].nodes - 1; i++) {
            struct section section;
            struct section_place place;
            section_make(&section, c->strand[a], i);
            for (int b = 0; b < c->count; b++) {
                const struct strand *s = c->strand[b];
                const int samples = s->wisp->samples;
                for (int k = 2; k < s->wisp->nodes; k++) {
                    if (a == b && i >= k - 2 && i <= k + 1)
                        continue;
                    for (int j = -1; j < samples; j++) {
                        const double *x = j < 0 ? s->p[k] : s->e[k * samples + j];
                        if (!section_contains(&section, x, &place))
                            continue;
                        cr_assert(next < count, "%s: not all contacts are found", what);
                        const struct contact_place at = interaction_point(it, contact[next].point),
                                                   in = interaction_section(it,
                                                                            contact[next].section);
                        cr_assert(in.strand == a && in.node == i && at.strand == b &&
                                      at.node == k && at.sample == j,
                                  "%s: (%d, %d) has (%d, %d, %d), not (%d, %d) (%d, %d, %d)", what,
                                  a, i, b, k, j, in.strand, in.node, at.strand, at.node, at.sample);
                        next++;
                    }
                }
            }
        }
    }
    cr_assert_eq(next, count, "%s: %d contacts, not %d", what, count, next);
    interaction_free(it);
    return count;
}

Test(interaction, the_grid_finds_what_brute_force_finds) {
    static const double spreads[] = {0, 0.02, 0.1, 0.3};
    unsigned seed = 91;
    int contacts = 0;
    for (int repeat = 0; repeat < 24; repeat++) {
        struct cluster c;
        cluster_make(&c, 8 + repeat, 3 + repeat % 9, 3 + repeat % 6, spreads[repeat % 4],
                     (enum wisp_treatment)(repeat % TREATMENTS), &seed);
        contacts += check_against_brute_force(&c, "random cluster");
    }
    cr_assert_gt(contacts, 1000, "only %d contacts", contacts);
}

Test(interaction, crowds_coincident_wisps_and_outliers_are_found_too) {
    unsigned seed = 92;
    struct cluster c;
    cluster_make(&c, 1000, 4, 3, 0, WISP_GENERALISED, &seed);
    for (int i = 0; i < 1000; i++) {
        memset(c.wisp[i].root, 0, sizeof c.wisp[i].root);
        set_state(c.strand[i], 0.5, 1, &seed);
    }
    cr_assert_gt(check_against_brute_force(&c, "a thousand at one root"), 50);

    cluster_make(&c, 20, 8, 4, 0.1, WISP_GENERALISED, &seed);
    for (int i = 1; i < 20; i++) { /* the same wisp, twenty times */
        c.wisp[i] = c.wisp[0];
        c.strand[i] = copy_of(c.strand[0]);
    }
    cr_assert_gt(check_against_brute_force(&c, "coincident wisps"), 50);

    static const double far[] = {1, 1e3, 1e9, 1e15, 1e100, 1e300, -1e7, -1e200};
    cluster_make(&c, 24, 8, 4, 0.05, WISP_GENERALISED, &seed);
    for (int i = 0; i < 8; i++) {
        for (int n = 3; n < 8; n++) /* torn apart */
            c.strand[i]->p[n][i % 3] += far[i];
        if (i < 5) /* as wide as far */
            c.strand[23]->r[(3 + i) * 4 + i % 4] = fabs(far[i]);
        strand_refresh(c.strand[i]);
    }
    strand_refresh(c.strand[23]);
    cr_assert_gt(check_against_brute_force(&c, "outliers"), 50);
}

/* Where points are few and far between, cells of one box have numbers in common. */
Test(interaction, cells_that_share_a_number_are_looked_at_once) {
    unsigned seed = 98;
    int contacts = 0;
    for (int repeat = 0; repeat < 300; repeat++) {
        struct cluster c;
        cluster_make(&c, 4, 4, 3, 0.01, WISP_GENERALISED, &seed);
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < 3; j++)
                c.strand[3]->p[k][j] += 1e3;
        for (int at = 0; at < 4 * 3; at++) /* over many cells */
            c.strand[0]->r[at] *= 12;
        strand_refresh(c.strand[0]);
        strand_refresh(c.strand[3]);
        contacts += check_against_brute_force(&c, "few");
    }
    cr_assert_gt(contacts, 300, "only %d contacts", contacts);
}

/* The grid looks at coordinates in single precision, which there are millimetres apart. */
Test(interaction, far_from_the_origin_nothing_is_lost) {
    unsigned seed = 99;
    for (int repeat = 0; repeat < 8; repeat++) {
        const double away = repeat % 2 ? 1e4 : -3e5;
        struct cluster c;
        cluster_make(&c, 12, 6, 4, 0.02, WISP_GENERALISED, &seed);
        for (int i = 0; i < c.count; i++) {
            for (int k = 0; k < c.wisp[i].nodes; k++)
                c.strand[i]->p[k][repeat % 3] += away;
            strand_refresh(c.strand[i]);
        }
        cr_assert_gt(check_against_brute_force(&c, "far away"), 50);
    }
}

/* --- the tick, by the model's text --- */

/* What the tick did to a cluster, against the twin's word on what it was. */
static double compare(const struct twin *t, const struct cluster *after) {
    double most = 0;
    for (int w = 0; w < after->count; w++) {
        const struct strand *s = t->strand[w], *now = after->strand[w];
        const int samples = s->wisp->samples;
        cr_assert_eq(memcmp(s->p, now->p, (size_t)s->wisp->nodes * sizeof *s->p), 0, "moved");
        for (int k = 0; k < s->wisp->nodes; k++) {
            const double *dv = k < 2 ? (double[3]){0, 0, 0} : t->dv[w * TWIN_NODES + k][0];
            for (int c = 0; c < 3; c++)
                cr_assert(fabs(now->v[k][c] - s->v[k][c] - dv[c]) < 1e-12, "node %d of %d: %g", k,
                          w, now->v[k][c] - s->v[k][c] - dv[c]);
            for (int j = 0; j < samples && k >= 2; j++) {
                const int at = k * samples + j;
                double a[3];
                strand_half_line(s, k, j, a);
                const double along = vector_dot(t->dv[w * TWIN_NODES + k][1 + j], a);
                cr_assert(fabs(now->rate[at] - s->rate[at] - along) < 1e-12, "sample %d", j);
                for (int c = 0; c < 3; c++)
                    cr_assert(fabs(now->ev[at][c] - s->ev[at][c] - dv[c] - along * a[c]) < 1e-12,
                              "sample %d of node %d", j, k);
                cr_assert(now->r[at] == s->r[at] && !memcmp(now->e[at], s->e[at], 3 * sizeof *a),
                          "a sample is moved");
                most = fmax(most, fabs(along));
            }
            most = fmax(most, sqrt(vector_dot(dv, dv)));
        }
    }
    return most;
}

Test(interaction, ticks_are_those_of_the_text) {
    unsigned seed = 93;
    int happened = 0;
    for (int repeat = 0; repeat < 96; repeat++) {
        const struct interaction_settings settings = {
            .rate = lab_between(&seed, 30, 300),
            .threshold = repeat % 5 * 0.25,
            .viscosity = lab_between(&seed, 0, 50),
            .interpenetration = repeat % 7 != 0,
            .collision = repeat % 4 != 0,
            .reciprocal = repeat % 2,
        };
        struct cluster before, after;
        struct twin twin;
        cluster_make(&before, 1 + repeat % 7, 4 + repeat % 9, 3 + repeat % 4, 0.01,
                     (enum wisp_treatment)(repeat / 2 % TREATMENTS), &seed);
        if (repeat % 3 == 0) /* so bent that it meets itself */
            for (int i = 0; i < before.count; i++)
                set_state(before.strand[i], 1.5, 1, &seed);
        for (int i = 0; i < before.count && repeat % 3 == 1; i++) { /* nearly parallel */
            memcpy(before.wisp[i].direction, before.wisp[0].direction, 3 * sizeof(double));
            memcpy(before.wisp[i].root, before.wisp[0].root, 3 * sizeof(double));
            set_state(before.strand[i], 0.03, 1, &seed);
        }
        cluster_copy(&after, &before);
        struct interaction *it = make(&settings);
        twin_tick(&twin, before.strand, before.count, &settings);
        cr_assert(interaction_tick(it, after.strand, after.count) >= 0, "no memory");
        const double most = compare(&twin, &after);
        happened += most > 1e-4;
        interaction_free(it);
    }
    cr_assert_gt(happened, 60, "something happens in %d ticks only", happened);
}

/* --- what physics asks --- */

/* Keeps the contacts of nodes, with `only_free` those whose section has two free ends. */
static int only_nodes(struct interaction *it, int count, int only_free) {
    struct contact *contact = interaction_contacts(it);
    int kept = 0;
    for (int c = 0; c < count; c++)
        if (interaction_point(it, contact[c].point).sample < 0 &&
            (!only_free || interaction_section(it, contact[c].section).node >= 2))
            contact[kept++] = contact[c];
    return kept;
}

struct motion {
    double momentum[3], energy, scale; /* scale: sum of m |v| */
};

static struct motion motion_of(const struct cluster *c) {
    struct motion sum = {{0}, 0, 0};
    for (int w = 0; w < c->count; w++) {
        const struct strand *s = c->strand[w];
        for (int k = 2; k < s->wisp->nodes; k++)
            for (int j = -1; j < s->wisp->samples; j++) {
                const double m = j < 0 ? wisp_node_mass(s->wisp, k) : wisp_sample_mass(s->wisp, k);
                const double *v = j < 0 ? s->v[k] : s->ev[k * s->wisp->samples + j];
                for (int d = 0; d < 3; d++)
                    sum.momentum[d] += m * v[d];
                sum.energy += m / 2 * vector_dot(v, v);
                sum.scale += m * sqrt(vector_dot(v, v));
            }
    }
    return sum;
}

/* Contacts of nodes, in one-sided code's words: what one gains the other loses; and of the energy
 * nothing is gained however many contacts a node has. Prescribed nodes are at rest here: they give
 * no energy. */
Test(interaction, reciprocal_contacts_of_nodes_keep_momentum_and_add_no_energy) {
    unsigned seed = 94;
    int most = 0;
    double lost = 0;
    for (int repeat = 0; repeat < 200; repeat++) {
        struct interaction_settings settings = usual;
        settings.threshold = repeat % 3 * 0.45;
        settings.viscosity = repeat % 2 * 200;
        struct cluster c;
        cluster_make(&c, 2 + repeat % 40, 8, 4, 0.02 + repeat % 5 * 0.01, WISP_GENERALISED, &seed);
        for (int i = 0; i < c.count && repeat % 2; i++) { /* a light one in a heavy crowd */
            c.wisp[i].hair_count *= i ? 1e3 : 1;
            for (int k = 2; k < 8; k++)
                for (int d = 0; d < 3; d++)
                    c.strand[i]->v[k][d] = i && d == 0;
            memset(c.strand[i]->rate, 0, 32 * sizeof(double));
            strand_refresh(c.strand[i]);
        }
        struct interaction *it = make(&settings);
        const int free_ends = repeat % 4 > 0, count = only_nodes(it, find(it, &c), free_ends);
        const struct motion before = motion_of(&c);
        interaction_apply(it, c.strand, interaction_contacts(it), count);
        const struct motion after = motion_of(&c);
        for (int d = 0; d < 3 && free_ends; d++)
            cr_assert(fabs(after.momentum[d] - before.momentum[d]) < 1e-14 * before.scale,
                      "momentum changes by %g of %g", after.momentum[d] - before.momentum[d],
                      before.scale);
        cr_assert(after.energy <= before.energy * (1 + 1e-14), "energy grows by %g",
                  after.energy / before.energy - 1);
        most = count > most ? count : most;
        lost = fmax(lost, 1 - after.energy / before.energy);
        interaction_free(it);
    }
    cr_assert(most > 300 && lost > 0.05, "%d contacts at most, %g of the energy lost", most, lost);
}

/* Parallel wisps side by side, held where they are: only their velocities change. */
static void parallel(struct cluster *c, int count, unsigned *seed) {
    cluster_make(c, count, 8, 4, 0.02, WISP_GENERALISED, seed);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            c->wisp[i].direction[k] = k == 0;
            c->wisp[i].root[k] = lab_between(seed, -0.01, 0.01);
        }
        set_state(c->strand[i], 0, 1, seed);
    }
}

static void rub(struct cluster *c, double rate, double seconds) {
    struct interaction_settings settings = usual;
    settings.rate = rate;
    settings.viscosity = 20;
    settings.threshold = 1;
    struct interaction *it = make(&settings);
    for (int k = 0; k < (int)lround(seconds * rate); k++)
        cr_assert(interaction_tick(it, c->strand, c->count) > 0, "no contact");
    interaction_free(it);
}

static double velocity_distance(const struct cluster *a, const struct cluster *b) {
    double most = 0;
    for (int w = 0; w < a->count; w++)
        for (int k = 2; k < a->strand[w]->wisp->nodes; k++)
            for (int d = 0; d < 3; d++)
                most = fmax(most, fabs(a->strand[w]->v[k][d] - b->strand[w]->v[k][d]));
    return most;
}

/* What friction does in a time does not depend on the rate of ticks, to first order: the
 * difference between a rate and twice the rate halves when both double. */
Test(interaction, friction_hardly_depends_on_the_rate) {
    unsigned seed = 95;
    struct cluster start, c[4];
    double difference[3];
    parallel(&start, 6, &seed);
    for (int i = 0; i < 4; i++) {
        cluster_copy(&c[i], &start);
        rub(&c[i], 200 << i, 0.1);
        if (i)
            difference[i - 1] = velocity_distance(&c[i], &c[i - 1]);
    }
    cr_assert_gt(velocity_distance(&c[3], &start), 0.3, "there is no friction");
    for (int i = 0; i < 2; i++)
        cr_assert(fabs(difference[i] / difference[i + 1] - 2) < 0.2, "differences %g and %g",
                  difference[i], difference[i + 1]);
}

/* One contact between two wisps, of which the second has the point, with nothing else in touch. */
static int single_contact(struct cluster *c, struct interaction *it, int of_a_node,
                          unsigned *seed) {
    for (int tries = 0; tries < 30000; tries++) {
        cluster_make(c, 2, 6, 4, 0.06, WISP_GENERALISED, seed);
        if (find(it, c) == 1 && interaction_contacts(it)->corrected &&
            interaction_point(it, interaction_contacts(it)->point).strand == 1 &&
            interaction_section(it, interaction_contacts(it)->section).strand == 0 &&
            (interaction_point(it, interaction_contacts(it)->point).sample < 0) == of_a_node)
            return 1;
    }
    return 0;
}

/* A heavy section gives nothing back, so it does not matter whether it could. */
Test(interaction, both_rules_agree_where_only_the_section_is_heavy) {
    struct interaction_settings one_sided = usual;
    one_sided.reciprocal = 0;
    unsigned seed = 96;
    for (int repeat = 0; repeat < 20; repeat++) {
        struct interaction *both = make(&usual), *one = make(&one_sided);
        struct cluster c, d;
        cr_assert(single_contact(&c, both, repeat % 2, &seed), "no single contact");
        const struct contact contact = *interaction_contacts(both);
        const struct contact_place at = interaction_point(both, contact.point);
        c.wisp[0].hair_count *= 1e12;
        cluster_copy(&d, &c);
        interaction_tick(both, c.strand, 2);
        interaction_tick(one, d.strand, 2);
        cr_assert_lt(velocity_distance(&c, &d), 1e-10, "they differ");
        for (int k = 0; k < 3 && at.sample < 0; k++) { /* u' is reached: all of the change */
            struct strand *fresh = c.strand[1];
            double was[3], is[3];
            twin_mean_velocity(fresh, at.node, is);
            twin_mean_velocity(d.strand[1], at.node, was);
            cr_assert(fabs(is[k] - was[k]) < 1e-10, "means differ");
        }
        cr_assert(c.strand[1]->changed && d.strand[1]->changed && !d.strand[0]->changed,
                  "who has changed");
        interaction_free(both);
        interaction_free(one);
    }
}

/* A single contact of a node with friction alone decays by exactly exp(-nu chi t), whatever the
 * rate: here over one tick. */
Test(interaction, one_contact_reaches_what_it_asks_for) {
    unsigned seed = 97;
    struct interaction *it = make(&usual);
    for (int repeat = 0; repeat < 10; repeat++) {
        struct cluster c;
        cr_assert(single_contact(&c, it, 1, &seed), "no single contact");
        const struct contact contact = *interaction_contacts(it);
        const struct contact_place at = interaction_point(it, contact.point),
                                   in = interaction_section(it, contact.section);
        double u[2][3], v[3];
        for (int after = 0; after < 2; after++) {
            twin_mean_velocity(c.strand[1], at.node, u[after]);
            for (int e = 0; e < 2; e++) {
                twin_mean_velocity(c.strand[0], in.node + e, v);
                for (int d = 0; d < 3; d++)
                    u[after][d] -= (e ? contact.lambda : 1 - contact.lambda) * v[d];
            }
            if (!after)
                interaction_apply(it, c.strand, &contact, 1);
        }
        for (int d = 0; d < 3; d++)
            cr_assert(fabs(u[1][d] - u[0][d] - contact.change[d]) < 1e-14, "u becomes %g, not %g",
                      u[1][d], u[0][d] + contact.change[d]);
    }
    interaction_free(it);
}

/* --- what does nothing, and what must not break --- */

static int any_changed(const struct cluster *c) {
    int changed = 0;
    for (int i = 0; i < c->count; i++)
        changed |= c->strand[i]->changed;
    return changed;
}

/* The criterion comes first: a meeting of one kind is not treated as the other because its own
 * response is off. */
Test(interaction, a_response_that_is_off_does_nothing) {
    unsigned seed = 98;
    for (int which = 0; which < 4; which++) {
        struct interaction_settings settings = usual;
        struct cluster c, before;
        settings.interpenetration = which & 1;
        settings.collision = which >> 1 & 1;
        /* all meetings of unlike directions are collisions at 0, none at 2 */
        settings.threshold = settings.collision ? 2 : 0;
        if (which == 3)
            continue;
        cluster_make(&c, 16, 8, 4, 0.01, WISP_GENERALISED, &seed);
        cluster_copy(&before, &c);
        struct interaction *it = make(&settings);
        cr_assert(interaction_tick(it, c.strand, c.count) > 50, "too few contacts");
        cr_assert_not(any_changed(&c), "which %d: something changes", which);
        for (int i = 0; i < c.count; i++)
            cr_assert_eq(memcmp(c.strand[i]->v, before.strand[i]->v, 8 * sizeof *c.strand[i]->v),
                         0);
        interaction_free(it);
    }
}

static void check_finite(const struct cluster *c, const char *what) {
    for (int w = 0; w < c->count; w++)
        for (int k = 0; k < c->strand[w]->wisp->nodes; k++) {
            const struct strand *s = c->strand[w];
            for (int d = 0; d < 3; d++)
                cr_assert(isfinite(s->v[k][d]) && isfinite(s->p[k][d]), "%s: node %d", what, k);
            for (int j = 0; j < s->wisp->samples; j++)
                cr_assert(isfinite(s->rate[k * s->wisp->samples + j]) &&
                              isfinite(s->ev[k * s->wisp->samples + j][0]),
                          "%s: sample", what);
        }
}

/* Lengths, directions, velocities and radii of zero, and wisps one in another. */
Test(interaction, degenerate_states_stay_finite) {
    static const char *const names[] = {"no lengths",       "at rest",        "folded back",
                                        "samples at nodes", "all at a point", "far too fast",
                                        "one in another",   "tiny lengths"};
    unsigned seed = 99;
    for (int kind = 0; kind < 8; kind++)
        for (int repeat = 0; repeat < 12; repeat++) {
            struct interaction_settings settings = usual;
            settings.reciprocal = repeat & 1;
            settings.threshold = repeat % 3 * 0.5;
            struct cluster c;
            cluster_make(&c, 6, 8, 4, 0.02, (enum wisp_treatment)(repeat % 3), &seed);
            for (int w = 0; w < 6; w++) {
                struct strand *s = c.strand[w];
                for (int k = 2; k < 8; k++)
                    for (int d = 0; d < 3; d++) {
                        if (kind == 0 && k % 2)
                            s->p[k][d] = s->p[k - 1][d];
                        if (kind == 2)
                            s->p[k][d] = s->p[k % 2][d] * (1 + 1e-15 * k);
                        if (kind == 4)
                            s->p[k][d] = s->p[1][d];
                        if (kind == 6)
                            s->p[k][d] = c.strand[0]->p[k][d];
                        if (kind == 7)
                            s->p[k][d] = s->p[1][d] + 1e-170 * k * d;
                        s->v[k][d] *= kind == 1 ? 0 : kind == 5 ? 1e150 : 1;
                    }
                for (int i = 0; i < 32; i++) {
                    s->rate[i] *= kind == 1 ? 0 : 1;
                    s->r[i] *= kind == 3 ? -(i % 2) : 1;
                }
                for (int i = 0; i < 32 && kind == 3; i++)
                    memcpy(s->e[i], s->p[i / 4], sizeof s->e[i]);
                strand_refresh(s);
            }
            struct interaction *it = make(&settings);
            cr_assert(interaction_tick(it, c.strand, c.count) >= 0, "no memory");
            check_finite(&c, names[kind]);
            interaction_free(it);
        }
}

/* --- what results do not depend on --- */

/* Renumbering wisps renumbers contacts, and changes nothing in any of them by a bit: not where it
 * is, not what it asks for. Sums are in the order of wisps: they agree to rounding, and by bits
 * where no node or sample takes part in more than two corrections. */
Test(interaction, contacts_do_not_depend_on_the_order_of_wisps) {
    unsigned seed = 100;
    struct cluster c, d;
    enum { COUNT = 12 };
    cluster_make(&c, COUNT, 8, 4, 0.03, WISP_GENERALISED, &seed);
    cluster_copy(&d, &c);
    for (int i = 0; i < COUNT / 2; i++) {
        struct strand *keep = d.strand[i];
        d.strand[i] = d.strand[COUNT - 1 - i];
        d.strand[COUNT - 1 - i] = keep;
    }
    struct interaction *one = make(&usual), *other = make(&usual);
    const int count = find(one, &c);
    cr_assert(count == find(other, &d) && count > 100, "%d contacts", count);
    for (int i = 0; i < count; i++) {
        const struct contact *a = &interaction_contacts(one)[i];
        const struct contact_place at = interaction_point(one, a->point),
                                   in = interaction_section(one, a->section);
        int found = 0;
        for (int k = 0; k < count && !found; k++) {
            const struct contact *b = &interaction_contacts(other)[k];
            const struct contact_place at_b = interaction_point(other, b->point),
                                       in_b = interaction_section(other, b->section);
            found = at.strand == COUNT - 1 - at_b.strand && in.strand == COUNT - 1 - in_b.strand &&
                    at.node == at_b.node && at.sample == at_b.sample && in.node == in_b.node;
            cr_assert(!found || (a->lambda == b->lambda && a->corrected == b->corrected &&
                                 !memcmp(a->change, b->change, sizeof a->change)),
                      "a contact depends on the order");
        }
        cr_assert(found, "a contact is lost");
    }
    interaction_apply(one, c.strand, interaction_contacts(one), count);
    interaction_apply(other, d.strand, interaction_contacts(other), count);
    for (int i = 0; i < COUNT; i++)
        for (int k = 2; k < 8; k++)
            for (int x = 0; x < 3; x++)
                cr_assert(fabs(c.strand[i]->v[k][x] - d.strand[COUNT - 1 - i]->v[k][x]) < 1e-14);
    interaction_free(one);
    interaction_free(other);
}

/* A bundle of wisps that gravity pulls through each other. */
#define BUNDLE(order)                                                                    \
    "duration=0.25", "frame_rate=20.0", "run.step=2e-4", "material={ }", "envelope={ }", \
        "contacts={ threshold = 0.5; }", "wisps=(" order ")"

/* Whole runs are the same by bits in any order of the file, for any number of threads. */
Test(interaction, runs_do_not_depend_on_threads_or_on_the_file) {
    static const int to_other[] = {4, 2, 0, 3, 1}; /* A B C D E in the second file */
    struct scene *scene =
        LAB_LOAD("interactions", BUNDLE(WISP_A "," WISP_B "," WISP_C "," WISP_D "," WISP_E));
    struct scene *other =
        LAB_LOAD("interactions", BUNDLE(WISP_C "," WISP_E "," WISP_B "," WISP_D "," WISP_A));
    static const char *const steppers[] = {"rk4", "cvode"};
    for (int m = 0; m < 2; m++) {
        struct lab_run first, run;
        struct run_request request = {.stepper = steppers[m], .threads = 1};
        lab_finish(scene, &request, &first);
        for (int threads = 1; threads <= 3; threads++) {
            request.threads = threads;
            lab_run(scene, &request, &run);
            cr_assert_eq(memcmp(first.row, run.row,
                                (size_t)(run.frames * run.rows * run.columns) * sizeof *run.row),
                         0, "%s: %d threads matter", steppers[m], threads);
        }
        lab_run(other, &request, &run);
        for (int f = 0; f < run.frames; f++)
            for (int i = 0; i < run.rows; i++) {
                const double *x = first.row + (f * run.rows + i) * run.columns, *y = NULL;
                for (int k = 0; k < run.rows && !y; k++) {
                    const double *row = run.row + (f * run.rows + k) * run.columns;
                    if (row[0] == to_other[(int)x[0]] && row[1] == x[1])
                        y = row;
                }
                cr_assert(y && memcmp(x + 2, y + 2, (size_t)(run.columns - 2) * sizeof *x) == 0,
                          "%s: wisp %g depends on its place in the file", steppers[m], x[0]);
            }
    }
}

/* Every treatment interacts, in parts of one wisp and of four; without responses a run is the one
 * without contacts, to the last bit. */
Test(interaction, contacts_matter_and_cost_nothing_where_they_are_off) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        const struct run_request request = {.stepper = "rk4",
                                            .treatment = treatment_names[treatment]};
        struct scene *scenes[] = {
            LAB_LOAD("interactions", BUNDLE(WISP_A "," WISP_B "," WISP_D)),
            LAB_LOAD("interactions", BUNDLE(WISP_A "," WISP_B "," WISP_D),
                     "contacts={ interpenetration = false; collision = false; }"),
            LAB_LOAD("swing-envelope", "duration=0.25", "frame_rate=20.0", "run.step=2e-4",
                     "wisps=(" WISP_A "," WISP_B "," WISP_D ")"),
        };
        struct lab_run run[3];
        for (int i = 0; i < 3; i++) {
            lab_finish(scenes[i], &request, &run[i]);
        }
        cr_assert_gt(lab_distance(&run[0], &run[1], 0, 2).largest, 1e-3, "%s: no interaction",
                     request.treatment);
        cr_assert_eq(
            memcmp(run[1].row, run[2].row,
                   (size_t)(run[1].frames * run[1].rows * run[1].columns) * sizeof *run[1].row),
            0, "%s: contacts that are off matter", request.treatment);
        cr_assert_eq(run[1].result.counters.steps, run[2].result.counters.steps, "or cost");
        for (int i = 0; i < 3; i++) {
        }
    }
}

/* --- the shipped scenes --- */

/* Two sound methods agree for as long as the motion itself can be told: until a push of 1e-10 m on
 * one root has become 1e-8 m. */
Test(interaction, slow_two_methods_agree_as_long_as_the_motion_is_told) {
    static const char pushed[] =
        "wisps=({ root = [0.0, 0.0, 0.0]; direction = [1.0, 0.345, -0.074]; length = 0.30;"
        "nodes = 11; }, { root = [0.0850000001, 0.065, 0.035]; direction = [0.007, 1.057, -1.0];"
        "length = 0.30; nodes = 11; })";
    struct scene *scene = LAB_LOAD("interactions", "duration=1.5"),
                 *other = LAB_LOAD("interactions", "duration=1.5", pushed);
    const struct run_request tight = {.stepper = "cvode", .rtol = 3e-10, .atol = 3e-12};
    const struct run_request fine = {.stepper = "rk4", .step = 5e-5};
    struct lab_run a, b, c;
    lab_run(scene, &tight, &a);
    lab_run(scene, &fine, &b);
    lab_run(other, &tight, &c);
    int told = 0;
    while (told < a.frames) {
        struct lab_run upto[2] = {a, c};
        upto[0].frames = upto[1].frames = told + 1;
        if (lab_distance(&upto[0], &upto[1], told, 2).largest > 1e-8)
            break;
        told++;
    }
    a.frames = b.frames = told;
    cr_assert_gt(told, 20, "the motion can be told for %d frames only", told);
    const struct lab_distance distance = lab_distance(&a, &b, 0, 2);
    cr_assert_lt(distance.largest, 1e-8, "%g m in %d frames", distance.largest, told);
    a.frames = b.frames = c.frames;
}

/* Nearest distance of two wisps' segments, and whether they cross: where a pair's nearest points
 * are inside both and their common normal points the other way than a frame before. */
struct crossing {
    double least; /* m, of all frames */
    int crossed;
};

static void see_pair(struct crossing *c, double *side, const double *p, const double *p1,
                     const double *q, const double *q1) {
    double d[3], e[3], r[3], n[3], apart[3];
    for (int k = 0; k < 3; k++) {
        d[k] = p1[k] - p[k];
        e[k] = q1[k] - q[k];
        r[k] = p[k] - q[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = d[(k + 1) % 3] * e[(k + 2) % 3] - d[(k + 2) % 3] * e[(k + 1) % 3];
    const double sine2 = vector_dot(n, n), dd = vector_dot(d, d), ee = vector_dot(e, e),
                 de = vector_dot(d, e);
    const double s = (de * vector_dot(e, r) - ee * vector_dot(d, r)) / sine2,
                 t = (dd * vector_dot(e, r) - de * vector_dot(d, r)) / sine2;
    const double before = *side;
    *side = 0;
    if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1))
        return;
    for (int k = 0; k < 3; k++)
        apart[k] = r[k] + s * d[k] - t * e[k];
    c->least = fmin(c->least, sqrt(vector_dot(apart, apart)));
    *side = vector_dot(n, r) > 0 ? 1 : -1;
    c->crossed += *side * before < 0 && vector_dot(apart, apart) < 0.02 * 0.02;
}

static struct crossing crossing_of(const struct lab_run *run) {
    enum { SEGMENTS = 10 };
    static double side[SEGMENTS][SEGMENTS];
    struct crossing c = {.least = INFINITY};
    memset(side, 0, sizeof side);
    for (int f = 0; f < run->frames; f++) {
        const double *row = run->row + f * run->rows * run->columns + 2;
        for (int i = 0; i < SEGMENTS; i++)
            for (int j = 0; j < SEGMENTS; j++)
                see_pair(&c, &side[i][j], row + i * run->columns, row + (i + 1) * run->columns,
                         row + (SEGMENTS + 1 + j) * run->columns,
                         row + (SEGMENTS + 2 + j) * run->columns);
    }
    return c;
}

/* What the comment in experiments/interactions.cfg promises. */
Test(interaction, slow_the_scene_interactions_shows_what_it_says) {
    static const char *const sets[][3] = {
        {"contacts.interpenetration=false", "contacts.collision=false", "contacts.threshold=0.44"},
        {"contacts.interpenetration=true", "contacts.collision=false", "contacts.threshold=0.44"},
        {"contacts.interpenetration=true", "contacts.collision=false", "contacts.threshold=1.0"},
        {"contacts.interpenetration=false", "contacts.collision=true", "contacts.threshold=0.44"},
        {"contacts.interpenetration=true", "contacts.collision=true", "contacts.threshold=0.44"},
    };
    static const struct {
        int least_crossed, most_crossed;
        double least, most; /* distance, m */
    } expected[] = {{1, 1, 0, 2e-2},
                    {1, 1, 0, 2e-2},
                    {0, 0, 2e-3, 3e-2},
                    {0, 0, 2e-3, 3e-2},
                    {0, 0, 2e-3, 3e-2}};
    const struct run_request request = {.stepper = "rk4", .step = 2e-4, .treatment = "projection"};
    for (int i = 0; i < 5; i++) {
        struct scene *scene =
            LAB_LOAD("interactions", sets[i][0], sets[i][1], sets[i][2], "frame_rate=300.0");
        struct lab_run run;
        lab_run(scene, &request, &run);
        const struct crossing c = crossing_of(&run);
        cr_assert(c.crossed >= expected[i].least_crossed && c.crossed <= expected[i].most_crossed,
                  "%s, %s: crosses %d times", sets[i][0], sets[i][1], c.crossed);
        cr_assert(c.least >= expected[i].least && c.least <= expected[i].most, "%s, %s: %g m apart",
                  sets[i][0], sets[i][1], c.least);
    }
}

/* Contacts at a frame: 0 where the wisps have parted. */
static int contacts_at(const struct lab_run *run, int frame, const struct scene *scene) {
    struct cluster c = {.count = scene->wisp_count,
                        .strand = test_room((size_t)scene->wisp_count * sizeof *c.strand)};
    struct interaction *it = make(&usual);
    const double *row = run->row + frame * run->rows * run->columns + 2;
    for (int w = 0; w < c.count; w++) {
        c.strand[w] = lab_strand(&scene->wisps[w], WISP_GENERALISED);
        strand_load(c.strand[w], row, run->columns);
        row += scene->wisps[w].nodes * run->columns;
    }
    const int contacts = find(it, &c);
    interaction_free(it);
    return contacts;
}

/* And that in experiments/viscosity.cfg. */
Test(interaction, slow_the_scene_viscosity_shows_what_it_says) {
    const struct run_request request = {.stepper = "rk4", .step = 2e-4};
    for (int thick = 0; thick < 2; thick++) {
        struct scene *scene =
            LAB_LOAD("viscosity", thick ? "contacts.viscosity=50" : "contacts.viscosity=0.5");
        struct lab_run run;
        int parted = 0, back = 0; /* first frame without contact and the one after the last such
                                     one, numbered from 1 */
        lab_run(scene, &request, &run);
        cr_assert_eq(run.frames, 91, "%d frames", run.frames);
        cr_assert_gt(contacts_at(&run, 0, scene), 5, "they start apart");
        for (int f = 0; f < run.frames; f++)
            if (!contacts_at(&run, f, scene)) {
                parted = parted ? parted : f + 1;
                back = f + 2;
            }
        cr_assert(thick ? parted == 0 : parted > 11 && parted < 17, "they part at frame %d",
                  parted);
        cr_assert_eq(contacts_at(&run, 19, scene) > 0, thick, "at frame 20");
        cr_assert(thick ? back == 0 : back > 21 && back < 57, "they stay from frame %d on", back);
    }
}
