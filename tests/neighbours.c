/* Which wisps may touch: boxes that meet against brute force, boxes of wisps against all that is in
 * them, wisps laid open by the kernel against their rows, and ticks that leave out who is far. */
#include "wisp/neighbours.h"

#include "model/clock.h"
#include "model/problems.h"
#include "model/wisp_model.h"
#include "scene/scene_load.h"
#include "support.h"
#include "wisp/section.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- boxes that meet --- */

enum { BOXES_MAX = 400 };

static int overlap(const double a[6], const double b[6]) {
    for (int k = 0; k < 3; k++)
        if (a[3 + k] < b[k] || b[3 + k] < a[k])
            return 0;
    return 1;
}

static void make_box(double box[6], double spread, double side, unsigned *seed) {
    for (int k = 0; k < 3; k++) {
        box[k] = lab_between(seed, -spread, spread);
        box[3 + k] = box[k] + side * lab_between(seed, 0.2, 1);
    }
}

/* Returns how many meet another; `exactly`: none but those is called near. */
static int check_near(const double (*boxes)[6], int count, int exactly) {
    static unsigned char near[BOXES_MAX];
    struct neighbours *neighbours = neighbours_create(count);
    int met = 0;
    cr_assert(neighbours, "no memory");
    memset(near, 0, sizeof near);
    cr_assert_eq(neighbours_find(neighbours, boxes, count, near), 0);
    for (int i = 0; i < count; i++) {
        int meets = 0;
        for (int k = 0; k < count; k++)
            meets |= k != i && overlap(boxes[i], boxes[k]);
        met += meets;
        cr_assert(exactly ? near[i] == meets : near[i] >= meets, "box %d of %d: %d instead of %d",
                  i, count, near[i], meets);
    }
    neighbours_free(neighbours);
    return met;
}

Test(neighbours, are_those_that_brute_force_finds) {
    static double boxes[BOXES_MAX][6];
    unsigned seed = 3;
    int met = 0, all = 0;
    for (int round = 0; round < 60; round++) {
        const int count = round == 0 ? 1 : (int)lab_between(&seed, 2, BOXES_MAX);
        const double spread = pow(10, lab_between(&seed, -1, 3));
        for (int i = 0; i < count; i++)
            make_box(boxes[i], spread, 1, &seed);
        met += check_near((const double(*)[6])boxes, count, 1);
        all += count;
    }
    cr_assert(met > all / 5 && met < all * 4 / 5, "%d of %d meet: nothing is decided", met, all);
}

Test(neighbours, borders_that_touch_meet) {
    /* every second one touches the last but one; the rest are a bit short of it */
    static double boxes[BOXES_MAX][6];
    for (int i = 0; i < BOXES_MAX; i++) {
        const double size[3] = {1, 1, i % 2 ? 0.5 : 0.999};
        const double low[3] = {10 * (i % 4), 5 * (i % 4), i / 4 * (i % 2 ? 0.5 : 1)};
        for (int k = 0; k < 3; k++) {
            boxes[i][k] = low[k];
            boxes[i][3 + k] = low[k] + size[k];
        }
    }
    cr_assert_eq(check_near((const double(*)[6])boxes, BOXES_MAX, 1), BOXES_MAX / 2);
}

Test(neighbours, none_is_missed_beside_giants_and_what_is_no_number) {
    static double boxes[BOXES_MAX][6];
    unsigned seed = 5;
    for (int round = 0; round < 20; round++) {
        for (int i = 0; i < BOXES_MAX; i++)
            make_box(boxes[i], 100, i % 100 == round ? 1000 : 1, &seed);
        if (round % 3 == 1) {
            boxes[round][0] = -INFINITY;
            boxes[round][3] = INFINITY;
        }
        check_near((const double(*)[6])boxes, BOXES_MAX, 0);
        if (round % 3 == 2) { /* whose neighbours are nobody's business, but those of others are */
            const double box[6] = {NAN, NAN, NAN, NAN, NAN, NAN};
            unsigned char near[BOXES_MAX] = {0};
            struct neighbours *neighbours = neighbours_create(BOXES_MAX);
            cr_assert(neighbours, "no memory");
            make_box(boxes[round], 100, 1, &seed);
            memcpy(boxes[BOXES_MAX - 1], box, sizeof box);
            memcpy(boxes[50], boxes[300], sizeof box);
            cr_assert_eq(neighbours_find(neighbours, (const double(*)[6])boxes, BOXES_MAX, near),
                         0);
            cr_assert(near[50] && near[300]);
            neighbours_free(neighbours);
        }
    }
}

/* --- wisps of a part --- */

static struct surroundings turned_head(unsigned *seed) {
    struct surroundings around = lab_surroundings(WIND_NONE, seed);
    around.head = (struct head_motion){.knots = 2,
                                       .time = {0, 0.2},
                                       .rotation = {{0}, {0.4, -0.3, 1}},
                                       .position = {{0}, {0.1, 0, 0.2}}};
    return around;
}

static void open_lanes(const struct lab_part *part, const double *q, const double *v,
                       struct strand *const *strands) {
    void *ctx = part->system.ctx;
    kernel_of(part->lanes)->prescribe(ctx, 0.1);
    kernel_of(part->lanes)->open(ctx, q, v, strands);
}

/* The same by way of the rows of a frame. */
static struct strand *strand_by_rows(const struct lab_part *part, int lane, const double *q,
                                     const double *v, const struct wisp *wisp,
                                     enum wisp_treatment treatment, const struct placement *head) {
    static double rows[LAB_NODES * (6 + 6 * SAMPLES_MAX)];
    const int stride = 6 + wisp->samples * (treatment == WISP_PENALTY ? 6 : 2);
    struct strand *strand = lab_strand(wisp, treatment);
    kernel_of(part->lanes)->sample(part->system.ctx, lane, q, v, rows, stride);
    strand_turn(strand, head);
    strand_load(strand, rows, stride);
    return strand;
}

static void check_close(const double *a, const double *b, int count, const char *what) {
    for (int i = 0; i < count; i++)
        cr_assert(fabs(a[i] - b[i]) <= 1e-12 * (1 + fabs(b[i])), "%s %d: %g, not %g", what, i, a[i],
                  b[i]);
}

static void check_open(const struct strand *a, const struct strand *b) {
    const int n = a->wisp->nodes, m = n * a->wisp->samples;
    check_close(a->p[0], b->p[0], 3 * n, "p");
    check_close(a->v[0], b->v[0], 3 * n, "v");
    check_close(a->axis_u[0], b->axis_u[0], 3 * n, "u");
    check_close(a->axis_v[0], b->axis_v[0], 3 * n, "v axis");
    check_close(a->axis_w[0], b->axis_w[0], 3 * n, "w");
    check_close(a->r, b->r, m, "r");
    check_close(a->rate, b->rate, m, "rate");
    check_close((const double *)a->e, (const double *)b->e, 3 * m, "e");
    check_close((const double *)a->ev, (const double *)b->ev, 3 * m, "e's velocity");
    cr_assert(!a->changed);
}

static int holds(const double box[6], const double x[3], double near) {
    for (int k = 0; k < 3; k++)
        if (!(x[k] >= box[k] + near && x[k] <= box[3 + k] - near))
            return 0;
    return 1;
}

/* All free nodes, samples and sections. Returns how many samples are near a border. */
static int check_held(const struct strand *s, const double box[6]) {
    int near = 0;
    for (int i = 2; i < s->wisp->nodes; i++) {
        cr_assert(holds(box, s->p[i], 0), "node %d", i);
        for (int j = 0; j < s->wisp->samples; j++) {
            cr_assert(holds(box, s->e[i * s->wisp->samples + j], 0), "sample %d of node %d", j, i);
            near += !holds(box, s->e[i * s->wisp->samples + j], 0.05 * s->wisp->radius);
        }
    }
    for (int i = 1; i + 1 < s->wisp->nodes && s->wisp->samples > 0; i++) {
        struct section section;
        section_make(&section, s, i);
        cr_assert(!section.usable || (holds(box, section.low, 0) && holds(box, section.high, 0)),
                  "section %d", i);
    }
    return near;
}

/* Whether a point of the wisp is in one of its sections, of those that count (section 4.3.2 of the
 * thesis: not of nodes i - 1 to i + 2). */
static int touches_itself(const struct strand *s) {
    const int samples = s->wisp->samples;
    for (int i = 1; i + 1 < s->wisp->nodes && samples > 0; i++) {
        struct section section;
        section_make(&section, s, i);
        for (int k = 2; k < s->wisp->nodes; k++)
            for (int j = -1; j < samples && (k < i - 1 || k > i + 2); j++) {
                struct section_place place;
                if (section_contains(&section, j < 0 ? s->p[k] : s->e[k * samples + j], &place))
                    return 1;
            }
    }
    return 0;
}

struct tally {
    int near_border, touching, safe; /* samples; wisps that touch themselves, or are said not to */
};

/* Samples anywhere, also behind their nodes, where they may be between two clamps. */
static void draw_state(const struct wisp *wisp, enum wisp_treatment treatment, enum lab_state kind,
                       unsigned *seed, double *q, double *v) {
    const int unknowns = wisp_node_unknowns(wisp, treatment);
    lab_state(wisp, treatment, kind, 0, seed, q, v);
    for (int i = 0; i < (wisp->nodes - 2) * unknowns && treatment != WISP_PENALTY; i++)
        if (i % unknowns >= 3 && lab_between(seed, 0, 1) < 0.1)
            q[i] *= -1.5;
}

static void check_part(int lanes, int count, int samples, enum wisp_treatment treatment,
                       unsigned *seed, struct tally *tally) {
    static double q[LAB_SIZE], v[LAB_SIZE], Q[LAB_LANES * LAB_SIZE], V[LAB_LANES * LAB_SIZE];
    const int nodes = (int)lab_between(seed, 3, 12);
    const struct surroundings around = turned_head(seed);
    struct wisp wisps[LAB_LANES];
    struct strand *opened[LAB_LANES] = {NULL};
    struct lab_part part;
    struct placement head;
    double boxes[LAB_LANES][6];
    for (int k = 0; k < count; k++)
        wisps[k] = lab_wisp(nodes, samples, BENDING_SKIP, seed);
    lab_part_make(&part, lanes, wisps, count, &around, treatment);
    for (int k = 0; k < lanes; k++) {
        const enum lab_state kind = (enum lab_state)lab_between(seed, 0, STATES - 0.01);
        draw_state(&wisps[k < count ? k : 0], treatment, kind, seed, q, v);
        lab_place(&part, k, q, Q);
        lab_scatter(&part, k, v, V);
        if (k < count && k != 1) /* lane 1 stays closed */
            opened[k] = lab_strand(&wisps[k], treatment);
    }
    head_placement(&around.head, 0.1, &head);
    open_lanes(&part, Q, V, opened);
    const unsigned folded = kernel_of(lanes)->boxes(part.system.ctx, Q, boxes);
    for (int k = 0; k < count; k++) {
        struct strand *s = strand_by_rows(&part, k, Q, V, &wisps[k], treatment, &head);
        if (opened[k])
            check_open(opened[k], s);
        tally->near_border += check_held(s, boxes[k]);
        const int touches = touches_itself(s), may = folded >> k & 1;
        cr_assert(may || !touches, "a wisp that touches itself is missed");
        tally->touching += touches;
        tally->safe += samples > 0 && !may;
    }
}

Test(neighbours, parts_open_and_box_their_wisps_as_rows_do) {
    static const int samples[] = {0, 3, 4, 7};
    unsigned seed = 11;
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct tally tally = {0};
        for (int round = 0; round < 80; round++)
            for (int m = 0; m < 4; m++) {
                const int lanes = round % 2 ? 8 : 4;
                check_part(lanes, 1 + round % lanes, samples[m], (enum wisp_treatment)treatment,
                           &seed, &tally);
                check_part(1, 1, samples[m], (enum wisp_treatment)treatment, &seed, &tally);
            }
        cr_assert(tally.near_border > 0, "boxes are larger than need be");
        cr_assert(tally.touching > 10 && tally.safe > 10, "%s: %d touch themselves, %d cannot",
                  treatment_names[treatment], tally.touching, tally.safe);
    }
}

/* --- ticks --- */

/* A tick of a whole model against one of all its strands, near or far; some that are crooked touch
 * themselves. */
static void check_tick(enum wisp_treatment treatment, double spread, double crooked, unsigned *seed,
                       int *touched, int *far) {
    enum { WISPS = 30, NODES = 6 };
    struct wisp wisps[WISPS];
    struct strand *strands[WISPS];
    const struct surroundings around = turned_head(seed);
    const double interval = 0.1;
    int changed[WISPS] = {0};
    for (int i = 0; i < WISPS; i++) {
        wisps[i] = lab_wisp(NODES, 4, BENDING_SKIP, seed);
        wisps[i].length = 0.15;
        wisps[i].radius = 0.02;
        for (int k = 0; k < 3; k++)
            wisps[i].root[k] = lab_between(seed, -spread, spread);
    }
    struct scene *scene = lab_scene(wisps, WISPS, &around);
    scene->interaction = (struct interaction_settings){.rate = 90,
                                                       .threshold = 0.5,
                                                       .viscosity = 5,
                                                       .interpenetration = 1,
                                                       .collision = 1,
                                                       .reciprocal = 1};
    struct model *model = lab_model(scene, treatment, 4);
    model->t = interval;
    for (int i = 0; i < model->part_count; i++)
        for (int k = 0; k < model->parts[i].system.size; k++) {
            model->parts[i].q[k] += lab_between(seed, -crooked, crooked);
            model->parts[i].v[k] = lab_between(seed, -1, 1);
        }
    const size_t numbers = (size_t)(model->row_count * model->column_count);
    double *before = test_room(numbers * sizeof *before),
           *after = test_room(numbers * sizeof *after);
    wisp_problem.sample(model, before);
    struct placement head;
    head_placement(&around.head, interval, &head);
    for (int i = 0; i < WISPS; i++) {
        strands[i] = lab_strand(&scene->wisps[i], treatment);
        strand_turn(strands[i], &head);
        strand_load(strands[i], before + i * NODES * model->column_count + 2, model->column_count);
    }
    struct interaction *it = interaction_create(&scene->interaction);
    cr_assert(it, "no memory");
    const int contacts = interaction_tick(it, strands, WISPS);
    cr_assert_eq(wisp_problem.tick(model, NULL, STOP_INTERACTION, changed), FINISHED);
    cr_assert_eq(model->parts[0].system.counters.wisp_contacts, contacts);
    for (int i = 0; i < WISPS; i++)
        strand_store(strands[i], before + i * NODES * model->column_count + 2, model->column_count);
    wisp_problem.sample(model, after);
    for (int row = 0; row < model->row_count; row++) /* nodes 0 and 1 are the head's */
        if (row % NODES >= 2)
            check_close(after + row * model->column_count, before + row * model->column_count,
                        model->column_count, "column");
    for (int i = 0; i < WISPS; i++)
        *far += !((const struct wisp_model *)model)->near[i];
    *touched += contacts;
    interaction_free(it);
}

Test(neighbours, ticks_leave_out_wisps_that_are_far) {
    unsigned seed = 17;
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        int touched = 0, far = 0;
        for (int round = 0; round < 6; round++)
            check_tick((enum wisp_treatment)treatment, round % 2 ? 0.1 : 0.5,
                       round % 3 ? 0.002 : 0.02, &seed, &touched, &far);
        cr_assert(touched > 100 && far > 0, "%s: %d contacts, %d wisps left closed",
                  treatment_names[treatment], touched, far);
    }
}
