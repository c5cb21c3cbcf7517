/* How does the viscosity of interpenetration hold wisps together? Two wisps that start in each
 * other and that gravity parts (section 5.3 of the thesis). */
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

/* The last of the thesis's frames at which the wisps are looked at: parted, and together again. */
enum { PARTED = 20, TOGETHER = 56 };

static int is_there(const struct hair_run *run, int number) {
    return hair_frame_at(&run->hair, (number - 1) / 30.) >= 0;
}

static int apart_at(const struct hair_run *run, int number) {
    const int frame = hair_frame_at(&run->hair, (number - 1) / 30.);
    return frame >= 0 && run->series[OVERLAP][frame] == 0;
}

static void state_parting(struct hair_study *study, const struct hair_run *run, int parted) {
    const char *label = run->variant->label;
    const int there = is_there(run, PARTED), apart = apart_at(run, PARTED);
    struct statement row = {
        .key = "parted", .by = THESIS, .verdict = there ? HOLDS_NOT : NOT_REACHED, .unit = "frame"};
    row.value = number_of(run, parted < 0 ? run->hair.frame_count - 1 : parted);
    if (parted < 0) {
        hair_state(study, row, "With %s the wisps have not parted by the last frame, %.0f.", label,
                   row.value);
    } else if (!there) {
        hair_state(study, row,
                   "With %s the wisps part at frame %.0f; frame %d, where the thesis has them "
                   "parted, was not computed.",
                   label, row.value, PARTED);
    } else {
        row.verdict = holds_if(row.value <= PARTED && apart);
        hair_state(study, row,
                   "With %s the wisps part at frame %.0f and are %s at frame %d (thesis: apart).",
                   label, row.value, apart ? "apart" : "not apart", PARTED);
    }
}

static void state_staying(struct hair_study *study, const struct hair_run *run, int parted) {
    const char *label = run->variant->label;
    const int stay = staying(run);
    struct statement row = {.key = "stay", .by = THESIS, .unit = "frame"};
    row.value = number_of(run, stay > parted ? stay : run->hair.frame_count - 1);
    row.verdict =
        !is_there(run, TOGETHER) ? NOT_REACHED : holds_if(stay > parted && row.value <= TOGETHER);
    if (row.verdict == NOT_REACHED)
        hair_state(study, row,
                   "Frame %d, before which the thesis has them together again with %s, was not "
                   "computed.",
                   TOGETHER, label);
    else if (stay > parted)
        hair_state(study, row,
                   "With %s they swing back and stay together from frame %.0f on (thesis: shortly "
                   "before %d).",
                   label, row.value, TOGETHER);
    else
        hair_state(study, row, "With %s they are apart at the last frame, %.0f.", label, row.value);
}

static void state_thin(struct hair_study *study, const struct hair_run *run) {
    const double points = run->series[OVERLAP][0];
    const int parted = parting(run);
    hair_state(study,
               (struct statement){.key = "overlap at the start",
                                  .by = THESIS,
                                  .verdict = holds_if(points > 0),
                                  .value = points,
                                  .unit = "1"},
               "The wisps start in each other: %.0f points are in sections of the other one.",
               points);
    state_parting(study, run, parted);
    if (parted >= 0)
        state_staying(study, run, parted);
}

static void state_thick(struct hair_study *study, const struct hair_run *run) {
    const char *label = run->variant->label;
    const int parted = parting(run);
    struct statement row = {.key = "stuck", .by = THESIS, .unit = "frame"};
    row.value = number_of(run, parted < 0 ? run->hair.frame_count - 1 : parted);
    row.verdict = parted >= 0 ? HOLDS_NOT : is_there(run, TOGETHER) ? HOLDS : NOT_REACHED;
    if (parted < 0)
        hair_state(study, row, "With %s the wisps are in each other up to the last frame, %.0f.",
                   label, row.value);
    else
        hair_state(study, row, "With %s the wisps part at frame %.0f.", label, row.value);
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
    .question = "how does viscosity hold wisps together?",
    .thesis = "section 5.3",
    .place = 9,
    .quick_seconds = 2,
    .full_seconds = 15,
    .answers = 1u << ANSWERS_CHOICE,
    .plan = viscosity_plan,
    .tabulate = viscosity_tabulate,
};
