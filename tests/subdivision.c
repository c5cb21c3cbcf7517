/* Wisps that split at a tick: the rule against its text, and what a split leaves alone. */
#include "wisp/subdivision.h"

#include "base/vector.h"
#include "model/clock.h"
#include "scene/scene_load.h"
#include "wisp_support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- models in the midst of a run --- */

enum { WISPS_MAX = 16, ROWS = 12 * WISPS_MAX, COLUMNS = 8 + 6 * 8 };

static const struct subdivision usual = {.ratio = 0.5, .separation = 0.01, .limit = WISPS_MAX};

static const struct head_motion nodding = {.knots = 3,
                                           .time = {0, 0.1, 0.3},
                                           .position = {{0}, {0.02, 0.01, 0}, {0.05, 0, 0.03}},
                                           .rotation = {{0}, {0.4, -0.3, 1}, {0.5, 1.5, 0.2}}};

static const struct head_motion resting = {.knots = 0}; /* as the twin's head does */

struct flock {
    struct scene *scene;
    struct model *model;
    enum wisp_treatment treatment;
    struct strand *before[WISPS_MAX]; /* of the scene's wisps */
    int changed[WISPS_MAX];
    double rows[ROWS * COLUMNS]; /* of the model, by take_rows */
};

static void take_rows(struct flock *f) {
    cr_assert(f->model->row_count <= ROWS && f->model->column_count <= COLUMNS);
    f->model->problem->sample(f->model, f->rows);
}

/* First row of a wisp. */
static double *rows_of(struct flock *f, int wisp) {
    double *row = f->rows;
    while (row[0] != wisp)
        row += f->model->column_count;
    return row;
}

static void put_strand(struct flock *f, int wisp, const struct strand *strand) {
    strand_store(strand, rows_of(f, wisp) + 2, f->model->column_count);
}

/* The model's wisp as a strand; strand_free it. `like` has its numbers. */
static struct strand *strand_of(struct flock *f, int wisp, const struct wisp *like) {
    struct strand *strand = lab_strand(like, f->treatment);
    struct placement head;
    cr_assert(strand, "no memory");
    head_placement(&f->scene->around.head, f->model->t, &head);
    strand_turn(strand, &head);
    strand_load(strand, rows_of(f, wisp) + 2, f->model->column_count);
    return strand;
}

/* Anywhere near its rest shape, samples about R. */
static void shake(struct strand *s, unsigned *seed) {
    for (int i = 2; i < s->wisp->nodes; i++)
        for (int k = 0; k < 3; k++) {
            s->p[i][k] += 0.2 * wisp_spacing(s->wisp) * lab_between(seed, -1, 1);
            s->v[i][k] = lab_between(seed, -1, 1);
        }
    strand_refresh(s);
    for (int i = 2; i < s->wisp->nodes; i++)
        for (int j = 0; j < s->wisp->samples; j++)
            strand_set_sample(s, i, j, s->wisp->radius * lab_between(seed, 0.9, 1.1),
                              lab_between(seed, -0.1, 0.1));
}

/* Presses samples j and j + M/2 of a node to a share of R. */
static void press(struct strand *s, int node, int sample, double share) {
    const int samples = s->wisp->samples, other = (sample + samples / 2) % samples;
    strand_set_sample(s, node, sample, share * s->wisp->radius, 0);
    strand_set_sample(s, node, other, share * s->wisp->radius, 0);
}

/* `count` wisps of `nodes` or, every third one, a node less, near each other under a head that
 * moves, shaken by `seed`. flock_put what is done to `before`, flock_free it. */
static void flock_make(struct flock *f, int count, int nodes, int samples, int lanes, int treatment,
                       const struct head_motion *head, const struct subdivision *rule,
                       unsigned seed) {
    struct surroundings around = lab_surroundings(WIND_STEADY, &seed);
    struct wisp wisps[WISPS_MAX];
    around.head = *head;
    for (int i = 0; i < count; i++) {
        wisps[i] = lab_wisp(nodes - (i % 3 == 2), samples, BENDING_SKIP, &seed);
        for (int k = 0; k < 3; k++)
            wisps[i].root[k] *= 0.1;
    }
    *f = (struct flock){.treatment = (enum wisp_treatment)treatment};
    f->scene = lab_scene(wisps, count, &around);
    f->scene->subdivision = *rule;
    f->scene->interaction = (struct interaction_settings){.rate = 90};
    f->model = lab_model(f->scene, treatment, lanes);
    f->model->t = 0.17;
    take_rows(f);
    for (int i = 0; i < count; i++) {
        f->before[i] = strand_of(f, i, &f->scene->wisps[i]);
        shake(f->before[i], &seed);
    }
}

static void flock_put(struct flock *f) {
    for (int i = 0; i < f->scene->wisp_count; i++)
        put_strand(f, i, f->before[i]);
    f->model->problem->restore(f->model, f->rows);
}

/* A tick of wisps; returns how many wisps there are. */
static int flock_tick(struct flock *f) {
    int wisps = 0;
    memset(f->changed, 0, sizeof f->changed);
    cr_assert_eq(f->model->problem->tick(f->model, NULL, STOP_INTERACTION, f->changed), FINISHED);
    for (int i = 0; i < f->model->part_count; i++)
        wisps += f->model->parts[i].system.wisps;
    take_rows(f);
    return wisps;
}

/* --- which wisp splits, and where --- */

/* Least over largest diameter of a node, by looking at all pairs. */
static double ratio_at(const struct strand *s, int node) {
    const int m = s->wisp->samples;
    double ratio = 1;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            double d[2] = {0, 0};
            for (int side = 0; side < 2; side++)
                for (int end = 0; end < 2; end++) {
                    const int at = node * m + ((side ? j : i) + end * m / 2) % m;
                    d[side] += fmax(s->r[at], 1e-3 * s->wisp->radius);
                }
            ratio = fmin(ratio, d[0] / d[1]);
        }
    return ratio;
}

Test(subdivision, a_wisp_splits_below_the_ratio_at_its_flattest_node) {
    unsigned seed = 1;
    for (int trial = 0; trial < 200; trial++) {
        const int treatment = trial % TREATMENTS, samples = 4 + 2 * (trial % 3);
        struct flock f;
        struct flattening at;
        flock_make(&f, 1, 8, samples, 1, treatment, &nodding, &usual, (unsigned)trial);
        struct strand *s = f.before[0];
        press(s, 2 + trial % 6, trial % samples, lab_between(&seed, -0.3, 0.8)); /* behind it too */
        int flattest = 2;
        for (int i = 3; i < 8; i++)
            if (ratio_at(s, i) < ratio_at(s, flattest))
                flattest = i;
        const double ratio = ratio_at(s, flattest);
        struct subdivision rule = usual;
        rule.ratio = nextafter(ratio, 0);
        cr_assert(!subdivision_due(&rule, s, &at), "%g splits", ratio);
        rule.ratio = ratio;
        cr_assert(!subdivision_due(&rule, s, &at), "%g is not below itself", ratio);
        rule.ratio = nextafter(ratio, 1);
        cr_assert(subdivision_due(&rule, s, &at), "%g does not split", ratio);
        cr_assert(at.node == flattest && at.ratio == ratio, "node %d, %g", at.node, at.ratio);
    }
}

/* The first node of equally flat ones, and the first of equally long diameters. */
Test(subdivision, ties_go_to_the_first) {
    struct flock f;
    struct flattening at;
    flock_make(&f, 1, 8, 8, 1, WISP_GENERALISED, &nodding, &usual, 3);
    for (int i = 2; i < 8; i++)
        for (int j = 0; j < 8; j++)
            strand_set_sample(f.before[0], i, j, f.before[0]->wisp->radius, 0);
    for (int i = 4; i < 7; i++)
        press(f.before[0], i, 0, 0.25);
    cr_assert(subdivision_due(&usual, f.before[0], &at));
    cr_assert(at.node == 4 && at.longest == 1, "node %d, sample %d", at.node, at.longest);
    press(f.before[0], 6, 0, 0.125);
    press(f.before[0], 6, 3, 1.5);
    press(f.before[0], 6, 2, 1.5);
    cr_assert(subdivision_due(&usual, f.before[0], &at));
    cr_assert(at.node == 6 && at.longest == 2, "node %d, sample %d", at.node, at.longest);
}

/* --- the children's state --- */

/* Velocity of the head's point at x: by differences of where it is. */
static void velocity_of_head(const struct head_motion *head, double t, const double x[3],
                             double v[3]) {
    const double h = 1e-6;
    struct placement at, before, after;
    double rest[3] = {0}, from[3], to[3];
    head_placement(head, t, &at);
    head_placement(head, t - h, &before);
    head_placement(head, t + h, &after);
    for (int i = 0; i < 3; i++) /* the turn's inverse is its transpose */
        for (int k = 0; k < 3; k++)
            rest[k] += at.turn[0][i][k] * (x[i] - at.position[0][i]);
    placed_point(&before, 0, rest, from);
    placed_point(&after, 0, rest, to);
    for (int k = 0; k < 3; k++)
        v[k] = (to[k] - from[k]) / (2 * h);
}

/* V+ and V- by angles: V turned towards and away from the part of D across it. */
static void turned(const double v[3], const double d[3], double ratio, double children[2][3]) {
    const double speed = vector_length(v), angle = atan2(1 - ratio, ratio);
    double across[3];
    for (int k = 0; k < 3; k++)
        across[k] = d[k] - vector_dot(d, v) / (speed * speed) * v[k];
    const double width = vector_length(across);
    for (int k = 0; k < 3; k++)
        for (int side = 0; side < 2; side++)
            children[side][k] =
                cos(angle) * v[k] + (side ? -1 : 1) * sin(angle) * speed / width * across[k];
}

static double largest_difference(const double *a, const double *b, int count) {
    double most = 0;
    for (int i = 0; i < count; i++)
        most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

/* A child's strand is its parent's but for the velocity of one node, which samples follow. */
static void check_child(const struct strand *parent, const struct strand *child, int node,
                        const double dv[3]) {
    const int m = parent->wisp->samples;
    for (int i = 0; i < parent->wisp->nodes; i++) {
        const double none[3] = {0}, *expected = i == node ? dv : none;
        double v[3];
        cr_assert_leq(largest_difference(child->p[i], parent->p[i], 3), 1e-15, "node %d jumps", i);
        for (int k = 0; k < 3; k++)
            v[k] = child->v[i][k] - parent->v[i][k];
        /* differences of 1e-6 s in the head's velocity, of 1 m/s: rounding / 1e-6 */
        cr_assert_leq(largest_difference(v, expected, 3), i == node ? 1e-8 : 0, "node %d", i);
        for (int j = 0; j < m; j++) {
            const int at = i * m + j;
            double ev[3];
            for (int k = 0; k < 3; k++)
                ev[k] = child->ev[at][k] - parent->ev[at][k];
            cr_assert_leq(fabs(child->r[at] - parent->r[at]), 1e-15, "r of node %d", i);
            cr_assert_leq(fabs(child->rate[at] - parent->rate[at]), 1e-14, "its rate");
            cr_assert_leq(largest_difference(child->e[at], parent->e[at], 3), 1e-15);
            cr_assert_leq(largest_difference(ev, v, 3), 1e-14, "a sample does not follow");
        }
    }
}

Test(subdivision, children_go_the_ways_of_the_text) {
    for (int trial = 0; trial < 120; trial++) {
        const int treatment = trial % TREATMENTS, samples = 4 + 2 * (trial % 3);
        static const int widths[] = {1, 4, 8, 4};
        const int lanes = widths[trial % 4], count = 1 + trial % 5, which = trial % count;
        struct flock f;
        struct flattening at;
        double head[3], v[3], d[3], child[2][3], dv[2][3];
        flock_make(&f, count, 9, samples, lanes, treatment, &nodding, &usual, (unsigned)trial);
        struct strand *parent = f.before[which];
        press(parent, 2 + trial % 6, trial % samples, 0.1 + 0.03 * (trial % 10));
        flock_put(&f);
        cr_assert(subdivision_due(&usual, parent, &at));
        cr_assert_eq(flock_tick(&f), count + 1, "wisps");

        velocity_of_head(&nodding, f.model->t, parent->p[at.node], head);
        for (int k = 0; k < 3; k++)
            v[k] = parent->v[at.node][k] - head[k];
        strand_half_line(parent, at.node, at.longest, d);
        turned(v, d, at.ratio, child);
        for (int side = 0; side < 2; side++)
            for (int k = 0; k < 3; k++)
                dv[side][k] = child[side][k] - v[k];
        struct strand *plus = strand_of(&f, which, parent->wisp),
                      *minus = strand_of(&f, count, parent->wisp);
        check_child(parent, plus, at.node, dv[0]);
        check_child(parent, minus, at.node, dv[1]);
        for (int i = 0; i < count; i++) { /* nobody else is touched */
            struct strand *other = strand_of(&f, i, f.before[i]->wisp);
            cr_assert(i == which || memcmp(other->v[0], f.before[i]->v[0],
                                           sizeof other->v[0] * (size_t)other->wisp->nodes) == 0);
        }
    }
}

/* Without a velocity, or with one along the diameter, children go apart at 1 mm/s. */
Test(subdivision, velocities_with_no_way_to_turn) {
    const struct placement rest = {.turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    static const double speeds[] = {0, 0.9e-9, 1.1e-9, -1, 3, 1};
    static const double asides[] = {0, 0, 0.5, 0, 2e-9, 2e-9}; /* over the speed */
    static const int little[] = {1, 1, 0, 1, 0, 0};
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        struct flock f;
        struct flattening at;
        flock_make(&f, 1, 6, 4, 1, treatment, &nodding, &usual, 7);
        struct strand *s = f.before[0];
        press(s, 3, 1, 0.2);
        cr_assert(subdivision_due(&usual, s, &at) && at.node == 3);
        for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++)
            for (int side = -1; side <= 1; side += 2) {
                double d[3], w[3], v[3], dv[3];
                strand_half_line(s, 3, at.longest, d);
                strand_half_line(s, 3, 1 - at.longest % 2, w); /* across d */
                for (int k = 0; k < 3; k++)
                    s->v[3][k] = v[k] = speeds[i] * (d[k] + asides[i] * w[k]);
                subdivision_turn(s, &at, &rest, side);
                for (int k = 0; k < 3; k++) {
                    dv[k] = s->v[3][k] - v[k];
                    cr_assert(isfinite(dv[k]), "speed %g", speeds[i]);
                }
                double by[3];
                for (int k = 0; k < 3; k++)
                    by[k] = side * 1e-3 * d[k];
                if (little[i])
                    cr_assert_leq(largest_difference(dv, by, 3), 1e-15, "speed %g", speeds[i]);
                else
                    cr_assert_leq(fabs(vector_length(s->v[3]) - vector_length(v)),
                                  1e-14 * vector_length(v), "speed %g is not kept", speeds[i]);
            }
    }
}

/* At rest with respect to a head that turns is no velocity. */
Test(subdivision, velocities_are_those_against_the_head) {
    struct flock f;
    struct flattening at;
    struct placement head;
    double v[3], d[3];
    flock_make(&f, 1, 6, 4, 1, WISP_GENERALISED, &nodding, &usual, 7);
    struct strand *s = f.before[0];
    press(s, 3, 1, 0.2);
    cr_assert(subdivision_due(&usual, s, &at));
    head_placement(&nodding, 0.17, &head);
    velocity_of_head(&nodding, 0.17, s->p[3], v);
    memcpy(s->v[3], v, sizeof v);
    subdivision_turn(s, &at, &head, 1); /* keeps what is left by the differences, some 1e-10 */
    strand_half_line(s, 3, at.longest, d);
    for (int k = 0; k < 3; k++)
        cr_assert_leq(fabs(s->v[3][k] - v[k] - 1e-3 * d[k]), 1e-8, "%g", s->v[3][k] - v[k]);
}

/* --- the children's numbers --- */

/* (m M + d D + k K) x of a part of one wisp, at its state. */
static void times(struct flock *f, int part, double m, double d, double k, const double *x,
                  double *y) {
    struct part *p = &f->model->parts[part];
    cr_assert_eq(system_linearise(&p->system, JACOBIAN_SPD, f->model->t, p->q, p->v), 0);
    system_product(&p->system, m, d, k, x, y);
}

/* Mass, damping and stiffness of every spring, those in the envelope among them, are half of the
 * parent's to the last bit: halves are exact. Mass and hairs are conserved. (The matrices of this
 * kind depend on positions alone.) */
Test(subdivision, children_have_half_of_everything) {
    static double x[LAB_SIZE], before[3][LAB_SIZE], y[LAB_SIZE];
    for (int trial = 0; trial < 12; trial++) {
        unsigned seed = (unsigned)trial;
        struct flock f;
        flock_make(&f, 1, 8, 4 + trial % 2 * 2, 1, trial % TREATMENTS, &nodding, &usual, seed);
        press(f.before[0], 4, 1, 0.2);
        flock_put(&f);
        const int size = f.model->parts[0].system.size;
        for (int i = 0; i < size; i++)
            x[i] = lab_between(&seed, -1, 1);
        for (int k = 0; k < 3; k++)
            times(&f, 0, k == 0, k == 1, k == 2, x, before[k]);
        cr_assert_eq(flock_tick(&f), 2);
        for (int child = 0; child < 2; child++)
            for (int k = 0; k < 3; k++) {
                times(&f, child, k == 0, k == 1, k == 2, x, y);
                for (int i = 0; i < size; i++)
                    cr_assert_eq(2 * y[i], before[k][i], "child %d, matrix %d: %g of %g", child, k,
                                 y[i], before[k][i]);
            }
        const struct wisp *parent = f.scene->wisps, child = subdivision_child(parent);
        cr_assert(child.hair_count == parent->hair_count / 2 && child.splits == 1 &&
                  child.radius == parent->radius && child.mass_fraction == parent->mass_fraction);
        cr_assert_eq(2 * wisp_node_mass(&child, 3), wisp_node_mass(parent, 3));
    }
}

/* The scalar twin of a wisp with half the numbers moves as the children do, in any packing. */
Test(subdivision, children_move_as_the_twin_of_half_a_wisp) {
    static struct wisp_twin twin;
    static double q[LAB_SIZE], v[LAB_SIZE], a[LAB_SIZE], scale[LAB_SIZE], rates[ROWS * COLUMNS];
    static double accelerations[WISPS_MAX][4 * LAB_SIZE];
    double *by_part[WISPS_MAX];
    for (int trial = 0; trial < 18; trial++) {
        static const int widths[] = {1, 4, 8};
        const int treatment = trial % TREATMENTS, lanes = widths[trial / 3 % 3];
        const int count = 1 + trial % 5, which = trial % count;
        struct flock f;
        flock_make(&f, count, 8, 4, lanes, treatment, &resting, &usual, (unsigned)trial);
        press(f.before[which], 4, 1, 0.2);
        flock_put(&f);
        cr_assert_eq(flock_tick(&f), count + 1);
        for (int i = 0; i < f.model->part_count; i++) {
            struct part *part = &f.model->parts[i];
            by_part[i] = accelerations[i];
            cr_assert_eq(system_acceleration(&part->system, 0.17, part->q, part->v, by_part[i]), 0);
        }
        f.model->problem->sample_accelerations(f.model, by_part, rates);
        struct wisp half = subdivision_child(&f.scene->wisps[which]);
        for (int child = 0; child < 2; child++) {
            const int wisp = child ? count : which;
            const int per = treatment == WISP_PENALTY ? 3 : 1, unknowns = 3 + 4 * per;
            const double *row = rows_of(&f, wisp);
            const double *rate =
                rates + (row - f.rows) / f.model->column_count * f.model->rate_column_count;
            struct strand *s = strand_of(&f, wisp, &half);
            for (int i = 2; i < half.nodes; i++)
                for (int u = 0; u < unknowns; u++) {
                    const int at = (i - 2) * unknowns + u, e = i * 4 + (u - 3) / per;
                    q[at] = u < 3 ? s->p[i][u] : per == 3 ? s->e[e][u % 3] : s->r[e];
                    v[at] = u < 3 ? s->v[i][u] : per == 3 ? s->ev[e][u % 3] : s->rate[e];
                }
            cr_assert_eq(wisp_twin_init(&twin, &half, &f.scene->around, f.treatment), 0);
            cr_assert_eq(wisp_twin_acceleration(&twin, 0.17, q, v, a), 0);
            wisp_twin_scale(&twin, 0.17, q, v, scale);
            for (int at = 0; at < (half.nodes - 2) * unknowns; at++)
                cr_assert(
                    lab_close(
                        rate[(2 + at / unknowns) * f.model->rate_column_count + 2 + at % unknowns],
                        a[at], 1e-13 * scale[at], NULL),
                    "wisp %d, unknown %d", wisp, at);
        }
    }
}

/* --- what a split leaves alone --- */

static double energy(const struct flock *f) {
    double sum = 0;
    for (int i = 0; i < f->model->part_count; i++) {
        const struct part *part = &f->model->parts[i];
        struct energies energies;
        cr_assert_eq(
            part->system.ops->energies(part->system.ctx, f->model->t, part->q, part->v, &energies),
            0);
        sum += energies_sum(&energies);
    }
    return sum;
}

/* The same wisps in parts of one, and of four or eight: the same bits, the same energy; and parts
 * whose wisps are left alone are not written to. */
Test(subdivision, packing_does_not_matter_and_other_parts_stay) {
    for (int trial = 0; trial < 60; trial++) {
        const int count = 1 + trial % 7;
        struct flock f[2];
        for (int i = 0; i < 2; i++) {
            const int lanes = i == 0 ? 1 : trial % 2 ? 8 : 4;
            flock_make(&f[i], count, 8, 4, lanes, trial % TREATMENTS, &nodding, &usual,
                       (unsigned)trial);
            for (int k = 0; k < count; k += 1 + trial % 3)
                press(f[i].before[k], 2 + k % 5, 1, 0.3);
            flock_put(&f[i]);
            cr_assert_eq(flock_tick(&f[i]), count + (count + trial % 3) / (1 + trial % 3));
        }
        cr_assert(f[0].model->row_count == f[1].model->row_count &&
                      memcmp(f[0].rows, f[1].rows,
                             (size_t)(f[0].model->row_count * f[0].model->column_count) *
                                 sizeof *f[0].rows) == 0,
                  "packing matters");
        const double whole = energy(&f[0]);
        cr_assert_leq(fabs(energy(&f[1]) - whole), 1e-12 * fabs(whole), "energy of wider parts");
        for (int i = 0; i < count; i++) /* part i of one lane is wisp i */
            cr_assert_eq(f[0].changed[i], i % (1 + trial % 3) == 0, "wisp %d", i);
    }
}

/* The limit is for the first wisps in the list; children do not split at the tick of their birth.
 */
Test(subdivision, the_limit_goes_by_index) {
    struct subdivision rule = usual;
    for (rule.limit = 6; rule.limit <= 12; rule.limit++) {
        struct flock f;
        flock_make(&f, 5, 8, 4, 4, WISP_GENERALISED, &nodding, &rule, 5);
        for (int i = 0; i < 5; i++)
            if (i != 1)
                press(f.before[i], 4, 1, 0.3);
        flock_put(&f);
        const int expected = rule.limit < 9 ? rule.limit : 9;
        cr_assert_eq(flock_tick(&f), expected, "limit %d", rule.limit);
        static const int parents[] = {0, 2, 3, 4};
        for (int i = 5; i < expected; i++) { /* the - child has its parent's root */
            const double *child = rows_of(&f, i), *parent = rows_of(&f, parents[i - 5]);
            cr_assert(memcmp(child + 2, parent + 2, 3 * sizeof *child) == 0, "child %d", i);
            cr_assert_eq(f.model->parent[i], parents[i - 5], "child %d is of %d", i,
                         f.model->parent[i]);
        }
    }
}

/* Moves the tip of a strand aside so that the mean distance of all its nodes grows by `distance`.
 */
static void move_tip(struct strand *s, double distance) {
    const double by[3] = {0, 0, distance * s->wisp->nodes}, none[3] = {0};
    strand_move_node(s, s->wisp->nodes - 1, by, none);
}

/* At the distance they are twins still, and farther apart no longer; and coming back changes that
 * no more. (Powers of two, so that the distance is met.) */
Test(subdivision, twins_are_separated_farther_than_the_separation) {
    static const double separation[] = {0.0078125, 0.0625};
    const struct wisp wisp = {.direction = {1, 0, 0}, .length = 0.25, .nodes = 4};
    for (int i = 0; i < 2; i++) {
        const struct subdivision rule = {.ratio = 0.5, .separation = separation[i], .limit = 2};
        struct strand *a = lab_strand(&wisp, WISP_GENERALISED),
                      *b = lab_strand(&wisp, WISP_GENERALISED);
        cr_assert(a && b, "no memory");
        a->twin = b;
        b->twin = a;
        memset(a->p, 0, 4 * sizeof *a->p);
        memset(b->p, 0, 4 * sizeof *b->p);
        b->p[3][2] = 4 * separation[i];
        subdivision_separate(&rule, a);
        cr_assert(a->twin == b && b->twin == a, "separated at the distance");
        b->p[3][2] *= 1 + 1e-15;
        subdivision_separate(&rule, a);
        cr_assert(!a->twin && !b->twin, "not separated beyond it");
        b->p[3][2] = 0;
        subdivision_separate(&rule, a);
        cr_assert(!a->twin && !b->twin, "twins again");
    }
}

/* Twins, though in each other and still flat, do nothing until they are apart; then they touch and
 * may split; and once apart is for ever. */
Test(subdivision, twins_neither_split_nor_touch_until_they_are_separated) {
    for (int treatment = 0; treatment < TREATMENTS; treatment++) {
        static const struct interaction_settings both = {.rate = 90,
                                                         .threshold = 0.9,
                                                         .viscosity = 5,
                                                         .interpenetration = 1,
                                                         .collision = 1,
                                                         .reciprocal = 1};
        struct subdivision rule = usual;
        struct flock f;
        flock_make(&f, 1, 8, 4, 4, treatment, &nodding, &rule, 3);
        f.scene->interaction = both;
        f.model = lab_model(f.scene, treatment, 4);
        f.model->t = 0.17;
        take_rows(&f);
        press(f.before[0], 4, 1, 0.3);
        flock_put(&f);
        cr_assert_eq(flock_tick(&f), 2);
        cr_assert_eq(flock_tick(&f), 2, "a twin splits");
        for (int i = 0; i < f.model->part_count; i++)
            cr_assert(!f.changed[i], "twins touch");

        const struct wisp half = subdivision_child(f.scene->wisps);
        struct strand *minus = strand_of(&f, 1, &half), *plus = strand_of(&f, 0, &half);
        move_tip(minus, 0.999 * rule.separation);
        put_strand(&f, 1, minus);
        f.model->problem->restore(f.model, f.rows);
        cr_assert_eq(flock_tick(&f), 2, "a twin splits before it is separated");
        for (int i = 0; i < f.model->part_count; i++)
            cr_assert(!f.changed[i], "twins touch before they are separated");

        press(plus, 4, 1, 1); /* no longer flat: they only touch */
        press(minus, 4, 1, 1);
        move_tip(minus, 0.002 * rule.separation);
        put_strand(&f, 0, plus);
        put_strand(&f, 1, minus);
        f.model->problem->restore(f.model, f.rows);
        cr_assert_eq(flock_tick(&f), 2);
        cr_assert(f.changed[0], "separated twins do not touch");

        move_tip(minus, -rule.separation); /* together again, and flat */
        press(plus, 4, 1, 0.3);
        put_strand(&f, 0, plus);
        put_strand(&f, 1, minus);
        f.model->problem->restore(f.model, f.rows);
        cr_assert_eq(flock_tick(&f), 3, "once separated is for ever");
    }
}
