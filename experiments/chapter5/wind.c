/* Does a gust lay hair over, and does it fall back? A hundred wisps on a figure of ellipsoids, in
 * wind for a second and then in still air (section 5.6 of the thesis). */
#include "base/vector.h"
#include "hair_study.h"

#include <math.h>

enum { DOWNWIND, MEAN, LARGEST };

/* Of the largest displacement: less is left where the hair has fallen back. And of the mean length:
 * what counts as laid over. */
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
        for (int i = 2; i < hair_nodes(hair, frame, w); i++, count++) {
            double apart[3] = {0, 0, 0};
            vector_add(apart, 1, hair_node(hair, frame, w, i));
            vector_add(apart, -1, hair_node(hair, 0, w, i));
            squares += vector_dot(apart, apart);
        }
    return sqrt(squares / count);
}

/* Of a start that is not at rest the gust would not be all that moves the hair. */
static void state_rest(struct hair_study *study) {
    const struct hair *hair = &study->runs[STILL].hair;
    const double none = 1e3 * 0.1 * hair->scene->wisps[0].radius; /* is not seen */
    double most = 0;
    for (int f = 0; f < hair->frame_count; f++)
        most = fmax(most, 1e3 * moved(hair, f));
    hair_state(
        study,
        (struct statement){
            .key = "at rest", .verdict = holds_if(most <= none), .value = most, .unit = "mm"},
        "It starts at rest: in still air nodes move by at most %.2g mm (rms; less than a "
        "tenth of a wisp's radius is not seen).",
        most);
}

static void state(struct hair_study *study) {
    const struct hair_run *run = &study->runs[GUST];
    state_rest(study);
    const struct wind *wind = &study->subject->scene->around.wind;
    const int frame = hair_largest(run, DOWNWIND), last = run->hair.frame_count - 1;
    const double most = run->series[DOWNWIND][frame], end = run->series[DOWNWIND][last];
    const double length = mean_length(run->hair.scene), t = run->hair.frames[frame].t,
                 until = run->hair.frames[last].t, gust = wind->hold + 3 * wind->decay;
    const int lies = most > laid_over * length;
    struct statement row = {.key = "laid over", .by = THESIS, .value = most, .unit = "cm"};
    row.verdict = lies || until >= gust ? holds_if(lies) : NOT_REACHED;
    hair_claim(study, row,
               "The gust lays the hair over: its tips move downwind by %.1f cm in the mean, at "
               "%.2f s (a tenth of its length is %.1f cm).",
               most, t, laid_over * length);
    row = (struct statement){.key = "in the gust", .value = t, .unit = "s"};
    row.verdict = until < gust || !lies ? NOT_REACHED : holds_if(t <= gust);
    hair_claim(study, row,
               "That is at %.2f s, while the wind blows (%.1f s, then a decay of %.3f s).", t,
               wind->hold, wind->decay);
    row = (struct statement){.key = "fallen back", .by = THESIS, .value = end, .unit = "cm"};
    row.verdict = until < gust || !lies ? NOT_REACHED : holds_if(end < left_over * most);
    hair_claim(study, row,
               "The hair falls back: at %.2f s %.1f cm are left, %.0f %% (less than %.0f %% is "
               "fallen back).",
               until, end, most > 0 ? 100 * end / most : 0, 100 * left_over);
}

static const struct hair_question question = {
    .scene = "wind",
    .needs = {"wind"},
    .variants = {[GUST] = {.label = "gust",
                           .thesis = 235,
                           .pictures = {1, 6, 10, 16, 21, 26, 36, 46, 56, 66, 86, 121}},
                 [STILL] = {.label = "still air",
                            .sets = {"wind.velocity=[0.0, 0.0, 0.0]"},
                            .pictures = {1, 26, 121}}},
    .main = GUST,
    .control = STILL,
    .without = "in still air",
    .columns = 3,
    .elevation = 8,
    .quick = 0.1,
    .series = {"downwind", "mean_inclination", "largest_inclination"},
    .start = HAIR_START_PROJECTION,
    .measure = measure,
    .state = state,
};

static int wind_plan(struct plan *plan) {
    return hair_plan(plan, &question);
}

static int wind_tabulate(struct plan *plan, const char *folder) {
    return hair_tabulate(plan, folder, &question);
}

const struct experiment wind_experiment = {
    .name = "wind",
    .question = "does a gust lay hair over, and does it fall back?",
    .thesis = "section 5.6",
    .place = 12,
    .quick_seconds = 10,
    .full_seconds = 60,
    .answers = 1u << ANSWERS_CHOICE,
    .plan = wind_plan,
    .tabulate = wind_tabulate,
};
