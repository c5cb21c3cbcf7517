/* Solves with springs along their lines. With the unit vectors n of the springs held still, D and K
 * of stretch springs, or of these and of skip springs, are -N' c N and -N' k N, where row s of N
 * takes the velocities of a spring's ends to the rate of its length, n.(x_b - x_a). Then
 *
 *     (M + N' S N) x = M r - gamma N' k N g,   S = alpha c + beta k,
 *
 * and with tensions y = S N x + gamma k N g this is x = r - M^-1 N' y and (Woodbury's identity)
 *
 *     (N M^-1 N' + S^-1) y = N r + gamma S^-1 k N g:
 *
 * one number a spring, where two springs are coupled that have a free node in common. (For chains
 * that cannot be stretched, S^-1 = 0: Han & Harada 2013, doi:10.2312/PE.vriphys.vriphys13.097-105.)
 * Where S is 0, S^-1 is infinite and the tension 0. M^-1 is in tension.h. */
#include "room.h"
#include "tension.h"

/* The equation of one tension, after elimination: y = solution - sum_j lower[j - 1] y_(j before),
 * read backwards: what this tension takes from those before it. */
enum { BAND = 4 };
struct tension {
    lane lower[BAND]; /* row of L, the nearest first */
    lane solution;    /* of L D z = right side; then the tension */
};

/* What a spring's S is made of, as its equation wants it. */
struct softness {
    lane inverse; /* 1 / S */
    lane pull;    /* gamma k / S */
    mask pulled;  /* where that is not 0 */
};

SPECIALISED struct softness softness(lane k, lane c, lane alpha, lane beta, lane gamma) {
    const lane s = alpha * c + beta * k;
    const lane pull = lane_select(s > 0, gamma * k / s, lane_all(0));
    return (struct softness){1 / s, pull, pull != 0};
}

/* A spring's right side: n.r, and where there is a pull, S^-1 gamma k n.g too; `r` and `g` are what
 * its ends differ by. `pulls` is 0 where no lane has one: the bits are the same. */
SPECIALISED lane right_of(const struct softness *soft, int pulls, struct vec n, struct vec r,
                          struct vec g) {
    const lane right = dot(n, r);
    return pulls ? lane_select(soft->pulled, right + soft->pull * dot(n, g), right) : right;
}

/* --- stretch: a tridiagonal system --- */

SPECIALISED void solve_stretch(struct kernel_part *part, const struct part_equation *e, int coupled,
                               int pulls, double *x) {
    struct tension *row = (struct tension *)part->rows;
    const struct softness soft = softness(part->stretch_k, part->stretch_c, load(e->alpha, 0),
                                          load(e->beta, 0), load(e->gamma, 0));
    struct vec r = free_node(part, e->r, 1), g = r; /* of node i - 1 */
    struct rows rows = first_row();
    for (int i = 2; i < part->nodes; i++) {
        const struct vec ri = free_node(part, e->r, i), gi = free_node(part, e->g, i);
        const lane right = right_of(&soft, pulls, part->t[i - 1], sub(ri, r), sub(gi, g));
        next_row(part, &rows, i, coupled, soft.inverse, right, &row[i].lower[0], &row[i].solution);
        r = ri, g = gi;
    }
    lane above = lane_all(0), lower = above; /* of spring i + 1 */
    struct vec pull = {above, above, above}; /* that it has on node i */
    for (int i = part->nodes - 1; i >= 2; i--) {
        const lane y = row[i].solution - lower * above;
        move(part, i, coupled, add_scaled(pull, -y, part->t[i - 1]), e->r, x);
        pull = scale(y, part->t[i - 1]);
        above = y;
        lower = row[i].lower[0];
    }
}

/* --- axial: skip springs too --- */

/* Tensions in the order skip (i - 2, i), segment (i - 1, i), for i = 2, 3, ...: then a spring is
 * coupled with the four before it at most. */

/* The last four equations, the nearest first: rows of L, 1 / D, right sides. */
struct window {
    lane lower[BAND - 1][BAND - 1], pivot[BAND], right[BAND];
};

/* Eliminates those before from an equation that is coupled with `count` of them by `beside`. */
SPECIALISED void eliminate_row(struct window *w, int count, const lane *beside, lane diagonal,
                               lane right, struct tension *row) {
    lane u[BAND];
    EACH_DOWN (j, count - 1, 0) {
        u[j] = beside[j];
        EACH_DOWN (k, count - 1, j + 1)
            u[j] -= u[k] * w->lower[j][k - j - 1];
    }
    EACH_DOWN (j, count - 1, 0) { /* the nearest last, it waits for a division */
        row->lower[j] = u[j] * w->pivot[j];
        diagonal -= u[j] * row->lower[j];
        right -= row->lower[j] * w->right[j];
    }
    EACH_DOWN (j, BAND - 1, 1) {
        w->pivot[j] = w->pivot[j - 1];
        w->right[j] = w->right[j - 1];
    }
    EACH_DOWN (j, BAND - 2, 1)
        EACH (k, 0, BAND - 1)
            w->lower[j][k] = w->lower[j - 1][k];
    EACH (k, 0, BAND - 1)
        w->lower[0][k] = row->lower[k];
    w->pivot[0] = 1 / diagonal;
    w->right[0] = right;
    row->solution = right * w->pivot[0];
}

/* What the springs that end at a node do to it: for the next ones, which begin there. */
struct arrivals {
    struct vec by_segment, by_skip; /* accelerations of the node by unit tensions */
    struct vec r, g;                /* of the node itself */
};

SPECIALISED void axial_down(struct kernel_part *part, const struct part_equation *e, int coupled,
                            int pulls) {
    struct tension *row = (struct tension *)part->rows;
    const lane alpha = load(e->alpha, 0), beta = load(e->beta, 0), gamma = load(e->gamma, 0);
    const struct softness stretch = softness(part->stretch_k, part->stretch_c, alpha, beta, gamma);
    const struct softness bend = softness(part->bend_k, part->bend_c, alpha, beta, gamma);
    const lane zero = lane_all(0);
    const struct vec none = {zero, zero, zero};
    struct arrivals two = {none, none, none, none}, one = two; /* at nodes i - 2 and i - 1 */
    struct window w;
    EACH (j, 0, BAND)
        w.pivot[j] = w.right[j] = zero;
    EACH (j, 0, BAND - 1)
        EACH (k, 0, BAND - 1)
            w.lower[j][k] = zero;
    for (int i = 2; i < part->nodes; i++) {
        const struct vec c = part->chord[i], n = part->t[i - 1];
        const struct arrivals here = {moved(part, i, coupled, n), moved(part, i, coupled, c),
                                      free_node(part, e->r, i), free_node(part, e->g, i)};
        lane on_skip = bend.inverse + dot(c, here.by_skip), skip_beside[BAND] = {zero};
        if (i > 3) {
            const struct vec back = moved(part, i - 2, coupled, c);
            on_skip += dot(c, back);
            skip_beside[0] = dot(part->t[i - 2], back);
            skip_beside[2] = -dot(c, two.by_segment);
            skip_beside[3] = -dot(c, two.by_skip);
        }
        eliminate_row(&w, BAND, skip_beside, on_skip,
                      right_of(&bend, pulls, c, sub(here.r, two.r), sub(here.g, two.g)),
                      &row[2 * i]);
        lane on_segment = stretch.inverse + dot(n, here.by_segment);
        if (i > 2)
            on_segment += dot(n, moved(part, i - 1, coupled, n));
        const lane segment_beside[BAND - 1] = {dot(n, here.by_skip), -dot(n, one.by_segment),
                                               -dot(n, one.by_skip)};
        eliminate_row(&w, BAND - 1, segment_beside, on_segment,
                      right_of(&stretch, pulls, n, sub(here.r, one.r), sub(here.g, one.g)),
                      &row[2 * i + 1]);
        two = one;
        one = here;
    }
}

/* A tension, less what those behind it take from it: `taken` of this one and of the next three. */
SPECIALISED lane take(const struct tension *row, int count, lane *taken) {
    const lane y = row->solution - taken[0];
    EACH (j, 0, BAND - 1)
        taken[j] = taken[j + 1] + row->lower[j] * y;
    taken[BAND - 1] = count == BAND ? row->lower[BAND - 1] * y : lane_all(0);
    return y;
}

SPECIALISED void axial_up(struct kernel_part *part, const struct part_equation *e, int coupled,
                          double *x) {
    const struct tension *row = (const struct tension *)part->rows;
    const lane zero = lane_all(0);
    const struct vec none = {zero, zero, zero};
    struct vec here = none, before = none; /* pulls on nodes i and i - 1 of springs that begin */
    lane taken[BAND] = {zero, zero, zero, zero};
    for (int i = part->nodes - 1; i >= 2; i--) {
        const struct vec segment = scale(take(&row[2 * i + 1], BAND - 1, taken), part->t[i - 1]);
        const struct vec skip = scale(take(&row[2 * i], BAND, taken), part->chord[i]);
        move(part, i, coupled, sub(here, add(segment, skip)), e->r, x);
        here = add(before, segment);
        before = skip;
    }
}

/* --- which --- */

/* `coupled` and `pulls` are constants where these are inlined. */
SPECIALISED void solve_axial(struct kernel_part *part, const struct part_equation *e, int coupled,
                             int pulls, double *x) {
    axial_down(part, e, coupled, pulls);
    axial_up(part, e, coupled, x);
}

int LANED(kernel_solve_part)(void *ctx, const struct part_equation *e, double *x) {
    struct kernel_part *part = ctx;
    if (e->part >= FORCES_FULL)
        return LANED(kernel_solve_full)(part, e, x);
    const size_t rows = 2 * (size_t)part->nodes * sizeof(struct tension) / sizeof(lane);
    if (!part->rows && !room_of(0, rows, &part->rows))
        return system_fail(part->system, -OUT_OF_MEMORY, "no memory for the springs' tensions");
    const int axial = e->part == FORCES_AXIAL && part->bending == BENDING_SKIP;
    const int coupled = is_coupled(part), pulls = !mask_none(load(e->gamma, 0) != 0);
    if (axial && coupled)
        pulls ? solve_axial(part, e, 1, 1, x) : solve_axial(part, e, 1, 0, x);
    else if (axial)
        pulls ? solve_axial(part, e, 0, 1, x) : solve_axial(part, e, 0, 0, x);
    else if (coupled)
        pulls ? solve_stretch(part, e, 1, 1, x) : solve_stretch(part, e, 1, 0, x);
    else
        pulls ? solve_stretch(part, e, 0, 1, x) : solve_stretch(part, e, 0, 0, x);
    return 0;
}
