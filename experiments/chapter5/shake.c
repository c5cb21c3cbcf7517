/* Does hair lag behind the head that it is on, and does it come to rest with it? A head that is
 * turned briskly left and right. */
#include "base/vector.h"
#include "hair_study.h"

#include <math.h>
#include <string.h>

enum { HEAD, HAIR, BEHIND };

static const double left_over = 0.1; /* of the largest angle between them, once it has returned */

/* The axis of the head's largest turn between knots; the y axis where it does not turn. */
static void turning_axis(const struct head_motion *head, double axis[3]) {
    double largest = 0;
    memcpy(axis, (const double[3]){0, 1, 0}, 3 * sizeof *axis);
    for (int i = 0; i < head->knots; i++) {
        const double size = vector_length(head->rotation[i]);
        if (size <= largest)
            continue;
        largest = size;
        for (int k = 0; k < 3; k++)
            axis[k] = head->rotation[i][k] / size;
    }
}

/* The variants. */
enum { SHAKEN, HELD };

static int measure(const struct hair_study *study, struct hair_run *run) {
    struct hair *hair = &run->hair;
    double axis[3];
    turning_axis(&study->subject->scene->around.head, axis);
    const double start = hair_head_turn(hair->scene, 0, axis);
    for (int f = 0; f < hair->frame_count; f++) {
        const double head = hair_head_turn(hair->scene, hair->frames[f].t, axis) - start;
        const double turn = hair_turn(hair, f, axis);
        run->series[HEAD][f] = head * 180 / M_PI;
        run->series[HAIR][f] = turn * 180 / M_PI;
        run->series[BEHIND][f] = fabs(turn - head) * 180 / M_PI;
    }
    return 0;
}

/* Correlation of the hair's angle with the head's some time before. */
static double correlation(const struct hair_run *run, double lag) {
    const struct hair *hair = &run->hair;
    double axis[3], products = 0, squares = 0, hair_squares = 0;
    turning_axis(&hair->scene->around.head, axis);
    const double start = hair_head_turn(hair->scene, 0, axis);
    for (int f = 0; f < hair->frame_count; f++) {
        const double t = hair->frames[f].t - lag;
        const double head = hair_head_turn(hair->scene, fmax(t, 0), axis) - start;
        products += head * run->series[HAIR][f];
        squares += head * head;
        hair_squares += run->series[HAIR][f] * run->series[HAIR][f];
    }
    return squares > 0 && hair_squares > 0 ? products / sqrt(squares * hair_squares) : 0;
}

/* The lag of the largest correlation, within a second before and after, in steps of a 300th. */
static double lag_of(const struct hair_run *run) {
    int best = 0;
    double most = -INFINITY;
    for (int k = -300; k <= 300; k++) {
        const double here = correlation(run, k / 300.);
        if (here > most) {
            most = here;
            best = k;
        }
    }
    return best / 300.;
}

/* About a head that does not turn nothing is to be said. */
static int head_turns(const struct hair_run *run) {
    double most = 0;
    for (int f = 0; f < run->hair.frame_count; f++)
        most = fmax(most, fabs(run->series[HEAD][f]));
    return most > 1;
}

static void state(struct hair_study *study) {
    const struct hair_run *run = &study->runs[SHAKEN];
    const int frame = hair_largest(run, BEHIND), last = run->hair.frame_count - 1;
    const double lag = lag_of(run), most = run->series[BEHIND][frame],
                 end = run->series[BEHIND][last];
    const int turns = head_turns(run);
    hair_claim(study, our_row(NULL, NULL, turns ? holds_if(lag > 0) : NOT_REACHED, lag, "s", "lag"),
               turns ? "The hair lags the head by %.3f s: that much earlier the head's turn fits "
                       "the hair's best (correlation %.2f)."
                     : "The head does not turn, and nothing lags it (%.3f s, correlation %.2f).",
               lag, correlation(run, lag));
    hair_state(study, (struct statement){.key = "behind", .value = most, .unit = "deg"},
               "Hair and head are at most %.1f degrees apart, at %.2f s.", most,
               run->hair.frames[frame].t);
    hair_claim(study,
               our_row(NULL, NULL,
                       turns ? holds_if(most > 0 && end < left_over * most) : NOT_REACHED, end,
                       "deg", "returned"),
               "At %.2f s hair and head are %.1f degrees apart, %.0f %% of the most; below %.0f %% "
               "the hair has returned.",
               run->hair.frames[last].t, end, most > 0 ? 100 * end / most : 0, 100 * left_over);
}

static const struct hair_question question = {
    .scene = "shake",
    .variants = {[SHAKEN] = {.label = "shake"},
                 [HELD] = {.label = "head at rest",
                           .sets = {"head={ times = [0.0]; positions = ([0.0, 0.0, 0.0]); "
                                    "rotations = ([0.0, 0.0, 0.0]); }"},
                           .undrawn = 1}},
    .main = SHAKEN,
    .control = HELD,
    .without = "with the head at rest",
    .pictures = {1, 7, 13, 19, 25, 31, 46, 91},
    .large = 16,
    .columns = 4,
    .quick = 0.1,
    .series = {{"head", "deg", "how far the head has turned"},
               {"hair", "deg", "how far the hair has turned about the same axis, by its tips"},
               {"behind", "deg", "difference between the turns of head and hair"}},
    .start = HAIR_START_PROJECTION,
    .measure = measure,
    .state = state,
};

const struct experiment shake_experiment = {
    .name = "shake",
    .question = "does hair lag behind the head, and does it return?",
    .place = 13,
    .headline = "choice",
    .quick_seconds = 12,
    .full_seconds = 30,
    HAIR_EXPERIMENT(&question),
};
