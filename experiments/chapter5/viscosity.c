/* How does the viscosity of interpenetration hold wisps together? Two wisps that start in each
 * other and that gravity parts (section 5.3 of the thesis). */
#include "experiments/captions.h"
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

/* The first frame at which the wisps do not touch, or -1. */
static int parting(const struct hair_run *run) {
    for (int f = 0; f < run->hair.frame_count; f++)
        if (run->series[OVERLAP][f] == 0)
            return f;
    return -1;
}

/* The first frame from which on they touch to the end, or -1. */
static int staying(const struct hair_run *run) {
    int frame = run->hair.frame_count;
    while (frame > 0 && run->series[OVERLAP][frame - 1] > 0)
        frame--;
    return frame < run->hair.frame_count ? frame : -1;
}

/* Frames are numbered from 1, 30 a second. */
static double number_of(const struct hair_run *run, int frame) {
    return run->hair.frames[frame].t * 30 + 1;
}

static int apart_at(const struct hair_run *run, int number) {
    const int frame = hair_frame_at(&run->hair, (number - 1) / 30.);
    return frame >= 0 && run->series[OVERLAP][frame] == 0;
}

static void state_thin(struct hair_study *study, const struct hair_run *run) {
    const int parted = parting(run), stay = staying(run);
    const char *label = run->variant->label;
    hair_state(study, "overlap at the start", run->series[OVERLAP][0], "points",
               run->series[OVERLAP][0] > 0 ? HOLDS : HOLDS_NOT,
               "the wisps start in each other: %.0f points in sections", run->series[OVERLAP][0]);
    if (parted < 0) {
        hair_state(study, "parted", -1, "frame", HOLDS_NOT, "%s: the wisps never part", label);
        return;
    }
    hair_state(study, "parted", number_of(run, parted), "frame",
               number_of(run, parted) <= 20 && apart_at(run, 20) ? HOLDS : HOLDS_NOT,
               "%s: the wisps have parted at frame %.0f and are %s at frame 20 (the thesis: parted "
               "at 20)",
               label, number_of(run, parted), apart_at(run, 20) ? "apart" : "not apart");
    if (stay > parted)
        hair_state(study, "stay", number_of(run, stay), "frame",
                   number_of(run, stay) <= 56 ? HOLDS : HOLDS_NOT,
                   "%s: they swing back, and from frame %.0f on they stay together (the thesis: "
                   "shortly before 56)",
                   label, number_of(run, stay));
    else
        hair_state(study, "stay", -1, "frame", HOLDS_NOT, "%s: they are apart at the end", label);
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
    .needs = "contacts",
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
