/* How does the viscosity of interpenetration hold wisps together? Two wisps that start in each
 * other and that gravity parts (section 5.3 of the thesis). */
#include "captions.h"
#include "hair_study.h"

enum { OVERLAP };

static int measure(struct hair *hair, double *const *series) {
    for (int f = 0; f < hair->frame_count; f++) {
        series[OVERLAP][f] = hair_overlap(hair, f);
        if (series[OVERLAP][f] < 0)
            return -1;
    }
    return 0;
}

/* The first frame at which wisps that touched do not, or -1. */
static int parting(const struct hair_run *run) {
    for (int f = 1; f < run->hair.frame_count; f++)
        if (run->series[OVERLAP][f] == 0 && run->series[OVERLAP][f - 1] > 0)
            return f;
    return -1;
}

/* And the first one after it at which they touch again. */
static int meeting(const struct hair_run *run, int after) {
    for (int f = after; f < run->hair.frame_count; f++)
        if (run->series[OVERLAP][f] > 0)
            return f;
    return -1;
}

/* Frames are numbered from 1, 30 a second. */
static double number_of(const struct hair_run *run, int frame) {
    return run->hair.frames[frame].t * 30 + 1;
}

static void state_thin(struct hair_study *study, const struct hair_run *run) {
    const int parted = parting(run), met = parted > 0 ? meeting(run, parted) : -1;
    const int shown = hair_frame_at(&run->hair, 19 / 30.);
    const char *label = run->variant->label;
    hair_state(study, "overlap at the start", run->series[OVERLAP][0], "points",
               run->series[OVERLAP][0] > 0 ? HOLDS : HOLDS_NOT,
               "the wisps start in each other: %.0f points in sections", run->series[OVERLAP][0]);
    if (parted < 0) {
        hair_state(study, "parted", -1, "frame", HOLDS_NOT, "%s: the wisps never part", label);
        return;
    }
    hair_state(study, "parted", number_of(run, parted), "frame",
               number_of(run, parted) <= 20 ? HOLDS : HOLDS_NOT,
               "%s: the wisps have parted at frame %.0f (the thesis: by 20)", label,
               number_of(run, parted));
    if (shown >= 0)
        hair_state(study, "apart at frame 20", run->series[OVERLAP][shown], "points",
                   run->series[OVERLAP][shown] == 0 ? HOLDS : HOLDS_NOT,
                   "%s: the wisps are apart at frame 20, which the thesis shows: %.0f points in "
                   "sections",
                   label, run->series[OVERLAP][shown]);
    if (met < 0) {
        hair_state(study, "met again", -1, "frame", HOLDS_NOT, "%s: they do not come back", label);
        return;
    }
    int again = met;
    while (again < run->hair.frame_count && run->series[OVERLAP][again] > 0)
        again++;
    const int stays = again == run->hair.frame_count;
    hair_state(study, "met again", number_of(run, met), "frame", stays ? HOLDS : HOLDS_NOT,
               "%s: they come back at frame %.0f (the thesis: shortly before 56) and %s", label,
               number_of(run, met), stays ? "part no more" : "part again");
}

static void state_thick(struct hair_study *study, const struct hair_run *run) {
    const int parted = parting(run);
    if (parted < 0)
        hair_state(study, "stuck", run->hair.frame_count, "frames",
                   run->series[OVERLAP][0] > 0 ? HOLDS : HOLDS_NOT,
                   "%s: the wisps are in each other at all %d frames", run->variant->label,
                   run->hair.frame_count);
    else
        hair_state(study, "stuck", number_of(run, parted), "frame", HOLDS_NOT,
                   "%s: the wisps part at frame %.0f", run->variant->label, number_of(run, parted));
}

static void state(struct hair_study *study) {
    state_thin(study, &study->runs[0]);
    state_thick(study, &study->runs[1]);
}

static const struct hair_question question = {
    .scene = "viscosity",
    .variants = {{.label = "viscosity 0.5",
                  .sets = {"contacts.viscosity=0.5"},
                  .thesis = 0.85,
                  .pictures = {1, 10, 20, 56}},
                 {.label = "viscosity 50",
                  .sets = {"contacts.viscosity=50"},
                  .thesis = 0.84,
                  .pictures = {1, 10, 20, 56}}},
    .main = 0,
    .columns = 4,
    .series = {"overlap"},
    .measure = measure,
    .state = state,
};

static int viscosity_plan(struct plan *plan) {
    return hair_plan(plan, &question);
}

static int viscosity_tabulate(struct plan *plan, const char *folder) {
    return hair_tabulate(plan, folder, &question);
}

const struct experiment viscosity_experiment = {
    .name = "viscosity",
    .question = "thesis 5.3: how does viscosity hold wisps together?",
    .plan = viscosity_plan,
    .tabulate = viscosity_tabulate,
    .caption = caption_hair,
};
