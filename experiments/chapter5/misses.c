#include "misses.h"

#include "base/vector.h"
#include "hair_frames.h"
#include "wisp/section.h"

#include <gsl/gsl_qrng.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>

enum { POINTS = 4096 };

struct brute {
    double unit[POINTS][3];  /* in the unit cube, */
    double place[POINTS][3]; /* and in the box at hand */
};
_Static_assert((int)POINTS % (int)SECTION_POINTS == 0, "nothing is left over");

struct brute *brute_create(void) {
    struct brute *brute = malloc(sizeof *brute);
    gsl_qrng *even = gsl_qrng_alloc(gsl_qrng_sobol, 3);
    for (int i = 0; i < POINTS && brute && even; i++)
        gsl_qrng_get(even, brute->unit[i]);
    if (even)
        gsl_qrng_free(even);
    else
        free(brute);
    return even ? brute : NULL;
}

void brute_free(struct brute *brute) {
    free(brute);
}

/* --- one pair --- */

static int cross(struct brute *brute, const struct section *a, const struct section *b) {
    if (!a->usable || !b->usable)
        return 0;
    for (int k = 0; k < 3; k++) {
        const double low = fmax(a->low[k], b->low[k]), high = fmin(a->high[k], b->high[k]);
        if (low >= high)
            return 0;
        for (int i = 0; i < POINTS; i++)
            brute->place[i][k] = low + brute->unit[i][k] * (high - low);
    }
    for (int i = 0; i < POINTS; i += SECTION_POINTS) {
        const double *points[SECTION_POINTS];
        struct section_places where;
        for (int k = 0; k < SECTION_POINTS; k++)
            points[k] = brute->place[i + k];
        if (section_find(a, points, &where) & section_find(b, points, &where))
            return 1;
    }
    return 0;
}

/* Whether a free node at an end of `a`, or one of its samples, is in b. */
static int shows(const struct section *a, const struct section *b) {
    const struct strand *strand = a->strand;
    const int samples = strand->wisp->samples;
    struct section_place place;
    for (int i = a->index < 2 ? 2 : a->index; i <= a->index + 1; i++) {
        if (section_contains(b, strand->p[i], &place))
            return 1;
        for (int j = 0; j < samples; j++)
            if (section_contains(b, strand->e[i * samples + j], &place))
                return 1;
    }
    return 0;
}

static void look_at(struct brute *brute, const struct section *a, const struct section *b,
                    struct misses *misses) {
    if (!cross(brute, a, b))
        return;
    misses->crossings++;
    misses->missed += !shows(a, b) && !shows(b, a);
}

/* --- sections that lie any way --- */

enum { NODES = 4, MIDDLE = 2, SAMPLES = 4 }; /* the section from node 2 on has two free ends */

/* A straight wisp of radius 1 whose section has its middle there. */
static void lay(struct wisp *wisp, struct strand *strand, const double middle[3],
                struct section *section) {
    for (int i = 0; i < NODES; i++)
        for (int k = 0; k < 3; k++)
            strand->p[i][k] =
                middle[k] + (i - MIDDLE - 0.5) * wisp_spacing(wisp) * wisp->direction[k];
    for (int i = 0; i < NODES * SAMPLES; i++)
        strand->r[i] = wisp->radius;
    strand_refresh(strand);
    section_make(section, strand, MIDDLE);
}

/* Lines that are farther apart than two radii: then nothing crosses, and brute force is spared. */
static int lines_are_apart(const double middle[3], const double a[3], const double b[3]) {
    double normal[3];
    vector_cross(a, b, normal);
    return fabs(vector_dot(middle, normal)) > 2 * vector_length(normal);
}

int random_misses(struct brute *brute, double slenderness, int crossings, struct misses *misses) {
    static const double origin[3] = {0, 0, 0};
    const struct wisp model = {.nodes = NODES,
                               .samples = SAMPLES,
                               .length = 2 * slenderness * (NODES - 1),
                               .radius = 1,
                               .direction = {1, 0, 0}};
    struct wisp wisps[2] = {model, model};
    struct strand *strands[2] = {strand_create(&wisps[0], WISP_GENERALISED),
                                 strand_create(&wisps[1], WISP_GENERALISED)};
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    const int code = strands[0] && strands[1] && random ? 0 : -1;
    const double reach = slenderness + 1 + hypot(slenderness, 1); /* of middles that may cross */
    struct section a, b;
    if (!code)
        lay(&wisps[0], strands[0], origin, &a);
    *misses = (struct misses){0, 0};
    while (!code && misses->crossings < crossings) {
        double middle[3], *way = wisps[1].direction;
        gsl_ran_dir_3d(random, &way[0], &way[1], &way[2]);
        for (int k = 0; k < 3; k++)
            middle[k] = gsl_ran_flat(random, -reach, reach);
        if (lines_are_apart(middle, model.direction, way))
            continue;
        lay(&wisps[1], strands[1], middle, &b);
        look_at(brute, &a, &b, misses);
    }
    strand_free(strands[0]);
    strand_free(strands[1]);
    if (random)
        gsl_rng_free(random);
    return code;
}

/* --- those of a run --- */

/* Whether any free node or sample of a wisp is in any section of the other. */
static int wisp_shows(const struct strand *a, const struct strand *b) {
    struct section section, ends;
    for (int j = 1; j + 1 < b->wisp->nodes; j++) {
        section_make(&section, b, j);
        for (int i = 1; i + 1 < a->wisp->nodes; i++) {
            section_make(&ends, a, i);
            if (shows(&ends, &section))
                return 1;
        }
    }
    return 0;
}

/* Whether boxes around their nodes and samples, and what is between these, are apart. */
static int far_apart(const struct strand *a, const struct strand *b) {
    const struct strand *const both[2] = {a, b};
    double low[2][3], high[2][3];
    for (int s = 0; s < 2; s++)
        for (int k = 0; k < 3; k++) {
            double most = 0;
            low[s][k] = INFINITY, high[s][k] = -INFINITY;
            for (int i = 1; i < both[s]->wisp->nodes; i++) {
                low[s][k] = fmin(low[s][k], both[s]->p[i][k]);
                high[s][k] = fmax(high[s][k], both[s]->p[i][k]);
                for (int j = 0; j < both[s]->wisp->samples; j++)
                    most = fmax(most, section_radius(both[s], i, j));
            }
            low[s][k] -= most;
            high[s][k] += most;
        }
    for (int k = 0; k < 3; k++)
        if (low[0][k] > high[1][k] || low[1][k] > high[0][k])
            return 1;
    return 0;
}

static void look_at_wisps(struct brute *brute, const struct strand *a, const struct strand *b,
                          struct misses *sections, struct misses *wisps) {
    const int before = sections->crossings;
    struct section first, second;
    if (far_apart(a, b))
        return;
    for (int i = 1; i + 1 < a->wisp->nodes; i++) {
        section_make(&first, a, i);
        for (int j = 1; j + 1 < b->wisp->nodes; j++) {
            section_make(&second, b, j);
            look_at(brute, &first, &second, sections);
        }
    }
    if (sections->crossings == before)
        return;
    wisps->crossings++;
    wisps->missed += !wisp_shows(a, b) && !wisp_shows(b, a);
}

void hair_misses(struct brute *brute, struct hair *hair, int frame, struct misses *sections,
                 struct misses *wisps) {
    const int count = hair->frames[frame].wisps;
    hair_lay_open(hair, frame);
    for (int a = 0; a < count; a++)
        for (int b = a + 1; b < count; b++)
            look_at_wisps(brute, hair->strands[a], hair->strands[b], sections, wisps);
}
