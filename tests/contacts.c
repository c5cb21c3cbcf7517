/* Wisps that touch without being laid open: the kernel writes their points and takes back what
 * contacts ask for, to the same bits as by way of strands and rows of a frame. */
#include "wisp/interaction.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <stdlib.h>
#include <string.h>

enum { NODES_MOST = 9, ROW_MOST = 6 + 6 * SAMPLES_MAX };

/* A part of wisps that grow where the first one does, and its state twice: as it becomes by way of
 * strands, and without. */
struct twice {
    int lanes, count, nodes, samples;
    enum wisp_treatment treatment;
    struct wisp wisps[LAB_LANES];
    struct surroundings around;
    struct lab_part part;
    struct strand *strand[LAB_LANES];
    double q[2][LAB_LANES * LAB_SIZE], v[2][LAB_LANES * LAB_SIZE];
};

/* Padding lanes have the first wisp's state too. */
static void draw(struct twice *t, unsigned *seed) {
    static double q[LAB_LANES][LAB_SIZE], v[LAB_LANES][LAB_SIZE];
    t->around = lab_surroundings(WIND_NONE, seed);
    t->around.head = (struct head_motion){.knots = 2,
                                          .time = {0, 0.2},
                                          .rotation = {{0}, {0.4, -0.3, 1}},
                                          .position = {{0}, {0.1, 0, 0.2}}};
    for (int k = 0; k < t->count; k++) {
        t->wisps[k] = lab_wisp(t->nodes, t->samples, BENDING_SKIP, seed);
        memcpy(t->wisps[k].root, t->wisps[0].root, sizeof t->wisps[k].root);
        memcpy(t->wisps[k].direction, t->wisps[0].direction, sizeof t->wisps[k].direction);
    }
    lab_part_make(&t->part, t->lanes, t->wisps, t->count, &t->around, t->treatment);
    for (int k = 0; k < t->lanes; k++) {
        const int wisp = k < t->count ? k : 0;
        if (k == wisp)
            lab_state(&t->wisps[wisp], t->treatment, STATE_RANDOM, 0, seed, q[wisp], v[wisp]);
        lab_place(&t->part, k, q[wisp], t->q[0]);
        lab_scatter(&t->part, k, v[wisp], t->v[0]);
    }
    for (int i = 0; i < t->part.system.size;
         i++) /* places that are not those of a number in space */
        t->q[0][i] *= 1 + 1e-9;
    memcpy(t->q[1], t->q[0], sizeof t->q[0]);
    memcpy(t->v[1], t->v[0], sizeof t->v[0]);
    kernel_of(t->lanes)->prescribe(t->part.system.ctx, 0.1);
}

/* Returns the number of contacts. */
static int tick_by_strands(struct twice *t, struct interaction *it) {
    static double rows[NODES_MOST * ROW_MOST];
    const struct kernel *kernel = kernel_of(t->lanes);
    const int stride = 6 + t->samples * (t->treatment == WISP_PENALTY ? 6 : 2);
    struct strand *opened[LAB_LANES] = {NULL};
    memcpy(opened, t->strand, (size_t)t->count * sizeof *opened);
    kernel->open(t->part.system.ctx, t->q[0], t->v[0], opened);
    const int contacts = interaction_tick(it, t->strand, t->count);
    for (int k = 0; k < t->lanes; k++) {
        const struct strand *strand = t->strand[k < t->count ? k : 0];
        strand_store(strand, rows, stride);
        if (strand->changed)
            kernel->restore(t->part.system.ctx, k, rows, stride, t->q[0], t->v[0]);
    }
    return contacts;
}

static int tick_without(struct twice *t, struct interaction *it) {
    const struct kernel *kernel = kernel_of(t->lanes);
    struct contact_wisp wisps[LAB_LANES] = {{.strand = NULL}};
    unsigned expected = 0;
    cr_assert_eq(interaction_begin(it, t->strand, t->count), 0);
    for (int k = 0; k < t->lanes; k++) {
        const int wisp = k < t->count ? k : 0;
        wisps[k].push = interaction_pushes(it, wisp);
        expected |= (unsigned)t->strand[wisp]->changed << k; /* by the first way */
        if (k == wisp) {
            wisps[k].strand = t->strand[k];
            wisps[k].point = interaction_points(it, k);
            wisps[k].first_node = interaction_first_node(it, k);
        }
    }
    kernel->contact_points(t->part.system.ctx, t->q[1], t->v[1], wisps);
    const int contacts = interaction_search(it);
    interaction_add_up(it);
    const unsigned changed = kernel->push(t->part.system.ctx, t->q[1], t->v[1], wisps,
                                          (const double(*)[2])t->strand[0]->turn);
    cr_assert_eq(changed & ((1u << t->lanes) - 1), expected, "lanes that changed: %x, not %x",
                 changed, expected);
    return contacts;
}

static void check_same(const struct contact *a, const struct contact *b) {
    cr_assert(a->section == b->section && a->point == b->point && a->corrected == b->corrected);
    cr_assert_eq(memcmp(&a->lambda, &b->lambda, sizeof a->lambda), 0);
    cr_assert_eq(memcmp(a->change, b->change, sizeof a->change), 0);
}

/* Returns the number of contacts. */
static int check(struct twice *t, int reciprocal, unsigned *seed) {
    const struct interaction_settings settings = {.rate = 90,
                                                  .threshold = 0.5,
                                                  .viscosity = 5,
                                                  .interpenetration = 1,
                                                  .collision = 1,
                                                  .reciprocal = reciprocal};
    struct interaction *one = interaction_create(&settings), *other = interaction_create(&settings);
    cr_assert(one && other, "no memory");
    draw(t, seed);
    const size_t bytes = (size_t)t->part.system.size * sizeof(double);
    for (int k = 0; k < t->count; k++)
        t->strand[k] = lab_strand(&t->wisps[k], t->treatment);
    const int contacts = tick_by_strands(t, one);
    cr_assert_eq(tick_without(t, other), contacts);
    for (int i = 0; i < contacts; i++)
        check_same(&interaction_contacts(one)[i], &interaction_contacts(other)[i]);
    cr_assert_eq(memcmp(t->q[0], t->q[1], bytes), 0, "%s: q", treatment_names[t->treatment]);
    cr_assert_eq(memcmp(t->v[0], t->v[1], bytes), 0, "%s: v", treatment_names[t->treatment]);
    interaction_free(one);
    interaction_free(other);
    return contacts;
}

Test(contacts, is_what_happens_to_strands_to_the_last_bit) {
    static const int samples[] = {3, 4, 6};
    static struct twice t;
    unsigned seed = 31;
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        int contacts = 0;
        for (int round = 0; round < 240; round++) {
            t = (struct twice){.lanes = round % 4 ? 4 << round / 4 % 2 : 1,
                               .count = round % 4 ? 1 + round % 4 : 1,
                               .nodes = 5 + round % 5,
                               .samples = samples[round % 3],
                               .treatment = (enum wisp_treatment)treatment};
            contacts += check(&t, round % 8 < 4, &seed);
        }
        cr_assert_gt(contacts, 50, "%s: %d contacts", treatment_names[treatment], contacts);
    }
}
