/* Does a gust lay hair over, and does it fall back? A hundred wisps on a figure of ellipsoids, in
 * wind for a second and then in still air (section 5.6 of the thesis). */
#include "base/vector.h"
#include "hair_study.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdlib.h>

enum { DOWNWIND, MEAN, LARGEST };

/* Fractions: of the largest displacement, less of which is left where the hair has fallen back; and
 * of the mean length, what counts as laid over. */
static const double left_over = 0.25, laid_over = 0.1;

/* The variants. */
enum { GUST, STILL };

/* Along the wind that the experiment's scene has: the control has none. */
static int measure(const struct hair_study *study, struct hair_run *run) {
    const double *wind = study->subject->scene->around.wind.velocity, speed = vector_length(wind);
    double along[3] = {0, 0, 0};
    if (speed > 0)
        vector_add(along, 1 / speed, wind);
    for (int f = 0; f < run->hair.frame_count; f++) {
        const struct inclination inclination = hair_inclination(&run->hair, f);
        run->series[DOWNWIND][f] = 100 * hair_tips_along(&run->hair, f, along);
        run->series[MEAN][f] = inclination.mean * 180 / M_PI;
        run->series[LARGEST][f] = inclination.largest * 180 / M_PI;
    }
    return 0;
}

static double mean_length(const struct scene *scene) {
    double sum = 0;
    for (int i = 0; i < scene->wisp_count; i++)
        sum += scene->wisps[i].length;
    return 100 * sum / scene->wisp_count;
}

/* How far the free nodes are from where they started, rms, m. */
static double moved(const struct hair *hair, int frame) {
    double squares = 0, count = 0;
    for (int w = 0; w < hair->frames[0].wisps; w++)
        for (int i = 2; i < hair_nodes(hair, frame, w); i++, count++)
            squares += square_distance(hair_node(hair, frame, w, i), hair_node(hair, 0, w, i));
    return sqrt(squares / count);
}

/* From a start that is not at rest the gust would not be all that moves the hair. */
static void state_rest(struct hair_study *study) {
    const struct hair *hair = &study->runs[STILL].hair;
    const double none = 1e3 * 0.1 * hair->scene->wisps[0].radius; /* is not seen */
    double most = 0;
    for (int f = 0; f < hair->frame_count; f++)
        most = fmax(most, 1e3 * moved(hair, f));
    hair_state(study, our_row(NULL, NULL, holds_if(most <= none), most, "mm", "at rest"),
               "In still air nodes move by at most %.2g mm (rms), and less than a tenth of a "
               "wisp's radius is not seen.",
               most);
}

/* --- who moves most --- */

/* The last frame in which the wind blows: with a gust, all but a twentieth of it is gone. */
static int last_windy(const struct wind *wind, const struct hair *hair) {
    int last = hair->frame_count - 1;
    while (wind->kind == WIND_GUST && last > 0 &&
           hair->frames[last].t > wind->hold + 3 * wind->decay)
        last--;
    return last;
}

/* How far the free nodes of a wisp are from where they started, rms over the frames to `last`, m.
 */
static double wisp_moved(const struct hair *hair, int wisp, int last) {
    double squares = 0, count = 0;
    for (int f = 0; f <= last; f++)
        for (int i = 2; i < hair_nodes(hair, f, wisp); i++, count++)
            squares += square_distance(hair_node(hair, f, wisp, i), hair_node(hair, 0, wisp, i));
    return sqrt(squares / count);
}

/* By wisp: how far downwind its root is, and how far it has moved. */
struct artefact {
    double near,
        far;     /* how far the thirds nearest to the wind and farthest from it move, mean, m */
    double rank; /* Spearman's rank correlation of moved with downwind */
};

/* Room: 6 numbers a wisp. */
static struct artefact find_artefact(const struct hair *hair, const struct wind *wind,
                                     double *room) {
    const int wisps = hair->frames[0].wisps, third = wisps / 3, last = last_windy(wind, hair);
    const size_t n = (size_t)wisps;
    double *downwind = room, *moves = room + n, *sorted = room + 2 * n, *by = room + 3 * n;
    struct artefact artefact = {0, 0, 0};
    for (int w = 0; w < wisps; w++) {
        downwind[w] = sorted[w] = vector_dot(hair_node(hair, 0, w, 0), wind->velocity);
        moves[w] = by[w] = wisp_moved(hair, w, last);
    }
    gsl_sort2(sorted, 1, by, 1, n);
    for (int i = 0; i < third; i++) {
        artefact.near += by[i] / third;
        artefact.far += by[wisps - 1 - i] / third;
    }
    artefact.rank = gsl_stats_spearman(downwind, 1, moves, 1, n, room + 4 * n);
    return artefact;
}

/* The thesis blames a wind that no wisp keeps from the next. What is not seen does not count: in
 * still air someone trembles most, too. */
static void state_artefact(struct hair_study *study) {
    const struct hair *hair = &study->runs[GUST].hair;
    const struct wind *wind = &study->subject->scene->around.wind;
    const int wisps = hair->frames[0].wisps;
    const double seen = 0.1 * hair->scene->wisps[0].radius;
    struct statement row = thesis_row(NULL, NULL, NOT_REACHED, 0, "1", "farthest move most");
    if (wisps < 6) {
        hair_claim(study, row,
                   "The wisps that are farthest from the wind move most: it cannot be told of %d.",
                   wisps);
        return;
    }
    double *room = malloc(6 * (size_t)wisps * sizeof *room);
    study->out_of_memory |= !room;
    if (!room)
        return;
    const struct artefact artefact = find_artefact(hair, wind, room);
    free(room);
    row.value = artefact.rank;
    row.verdict = holds_if(artefact.far > 1.1 * artefact.near && artefact.far > seen &&
                           artefact.rank > 2 / sqrt(wisps - 1));
    hair_claim(
        study, row,
        "The wisps that are farthest from the wind move most, for none keeps it from the next: "
        "while it blows the farthest third is %.1f cm (rms) from where it was and the nearest "
        "third %.1f cm; the rank correlation is %.2f, and by chance it is below %.2f.",
        100 * artefact.far, 100 * artefact.near, artefact.rank, 2 / sqrt(wisps - 1));
}

static void state(struct hair_study *study) {
    const struct hair_run *run = &study->runs[GUST];
    state_rest(study);
    state_artefact(study);
    const struct wind *wind = &study->subject->scene->around.wind;
    const int frame = hair_largest(run, DOWNWIND), last = run->hair.frame_count - 1;
    const double most = run->series[DOWNWIND][frame], end = run->series[DOWNWIND][last];
    const double length = mean_length(run->hair.scene), t = run->hair.frames[frame].t,
                 until = run->hair.frames[last].t, gust = wind->hold + 3 * wind->decay;
    const int lies = most > laid_over * length;
    const int over = until >= gust && lies;
    hair_claim(study,
               thesis_row(NULL, NULL, lies || until >= gust ? holds_if(lies) : NOT_REACHED, most,
                          "cm", "laid over"),
               "The gust lays the hair over: at %.2f s its tips are %.1f cm downwind in the mean, "
               "and a tenth of its length is %.1f cm.",
               t, most, laid_over * length);
    hair_claim(study,
               our_row(NULL, NULL, over ? holds_if(t <= gust) : NOT_REACHED, t, "s", "in the gust"),
               "The tips are farthest at %.2f s, while the wind blows: for %.1f s, and then it "
               "decays in %.3f s.",
               t, wind->hold, wind->decay);
    hair_claim(study,
               thesis_row(NULL, NULL, over ? holds_if(end < left_over * most) : NOT_REACHED, end,
                          "cm", "fallen back"),
               "The hair falls back: at %.2f s its tips are %.1f cm from where they were, %.0f %% "
               "of the most; below %.0f %% it has fallen back.",
               until, end, most > 0 ? 100 * end / most : 0, 100 * left_over);
}

static const struct hair_question question = {
    .scene = "wind",
    .needs = {"wind"},
    .variants = {[GUST] = {.label = "gust", .thesis = 235},
                 [STILL] = {.label = "still air",
                            .sets = {"wind.velocity=[0.0, 0.0, 0.0]"},
                            .undrawn = 1}},
    .main = GUST,
    .control = STILL,
    .without = "in still air",
    .pictures = {46, 56, 66, 71, 86, 121}, /* what is before is in the film */
    .large = 36,
    .columns = 2,
    .quick = 1, /* of the film */
    .film = 1,
    .series = {{"downwind", "cm", "mean displacement of the tips along the wind"},
               {"mean_inclination", "deg", "mean inclination of the wisps against the vertical"},
               {"largest_inclination", "deg",
                "largest inclination of a wisp against the vertical"}},
    .start = HAIR_START_PROJECTION,
    .measure = measure,
    .state = state,
};

const struct experiment wind_experiment = {
    .name = "wind",
    .question = "does a gust lay hair over, and does it fall back?",
    .thesis = "section 5.6",
    .place = 12,
    .headline = "choice",
    .quick_seconds = 15,
    .full_seconds = 25,
    HAIR_EXPERIMENT(&question),
};
