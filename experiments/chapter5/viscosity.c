/* How does the viscosity of interpenetration hold wisps together? Two wisps that start in each
 * other and that gravity parts (section 5.3 of the thesis). */
#include "hair_study.h"

#include <math.h>

enum { OVERLAP };

static int measure(const struct hair_study *study, struct hair_run *run) {
    (void)study;
    for (int f = 0; f < run->hair.frame_count; f++) {
        run->series[OVERLAP][f] = hair_overlap(&run->hair, f);
        if (run->series[OVERLAP][f] < 0)
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

static double last_number(const struct hair_run *run) {
    return number_of(run, run->hair.frame_count - 1);
}

/* The last of the thesis's frames at which the wisps are looked at: parted, and together again. */
enum { PARTED = 20, TOGETHER = 56 };

/* The variants: of little and of much viscosity, and without contact. */
enum { THIN, THICK, FREE };

static int apart_at(const struct hair_run *run, int number) {
    const int frame = hair_frame_numbered(run, number);
    return frame >= 0 && run->series[OVERLAP][frame] == 0;
}

/* Wisps that do not start in each other have nothing to part from. */
static int starts_together(const struct hair_run *run) {
    return run->series[OVERLAP][0] > 0;
}

static void state_parting(struct hair_study *study, const struct hair_run *run) {
    const char *label = run->variant->label;
    const int parted = parting(run), apart = apart_at(run, PARTED);
    const double number = parted < 0 ? last_number(run) : number_of(run, parted);
    const struct statement row =
        thesis_row(NULL, NULL,
                   hair_frame_numbered(run, PARTED) < 0 || !starts_together(run)
                       ? NOT_REACHED
                       : holds_if(parted >= 0 && number <= PARTED && apart),
                   number, "frame", "parted");
    if (!starts_together(run))
        hair_claim(study, row,
                   "At low viscosity the wisps part: they do not start in each other, and cannot.");
    else if (parted < 0)
        hair_claim(
            study, row,
            "At low viscosity the wisps part: with %s they have not by the last frame, %.0f.",
            label, row.value);
    else if (row.verdict == NOT_REACHED)
        hair_claim(study, row,
                   "At low viscosity the wisps part: with %s they do at frame %.0f, but frame %d, "
                   "where the thesis has them parted, was not computed.",
                   label, row.value, PARTED);
    else
        hair_claim(
            study, row,
            "At low viscosity the wisps part: with %s, and %.0f points in the other at the start, "
            "they do at frame %.0f, and are %s at frame %d, where the thesis has them apart.",
            label, run->series[OVERLAP][0], row.value, apart ? "apart" : "not apart", PARTED);
}

static void state_staying(struct hair_study *study, const struct hair_run *run) {
    const char *label = run->variant->label;
    const int stay = staying(run), parted = parting(run);
    const double number = stay > parted ? number_of(run, stay) : last_number(run);
    const struct statement row = thesis_row(NULL, NULL,
                                            hair_frame_numbered(run, TOGETHER) < 0 || parted < 0
                                                ? NOT_REACHED
                                                : holds_if(stay > parted && number <= TOGETHER),
                                            number, "frame", "stay");
    if (parted < 0)
        hair_claim(
            study, row,
            "At low viscosity the wisps come back and stay together: with %s they do not part.",
            label);
    else if (row.verdict == NOT_REACHED)
        hair_claim(study, row,
                   "At low viscosity the wisps come back and stay together: frame %d, before which "
                   "the thesis has them together with %s, was not computed.",
                   TOGETHER, label);
    else if (stay > parted)
        hair_claim(study, row,
                   "At low viscosity the wisps come back and stay together: with %s they do from "
                   "frame %.0f on, in the thesis from shortly before %d.",
                   label, row.value, TOGETHER);
    else
        hair_claim(study, row,
                   "At low viscosity the wisps come back and stay together: with %s they are apart "
                   "at the last frame, %.0f.",
                   label, row.value);
}

static void state_sticking(struct hair_study *study, const struct hair_run *run) {
    const char *label = run->variant->label;
    const int parted = parting(run);
    const struct statement row =
        thesis_row(NULL, NULL,
                   hair_contacts(run) == 0                   ? NOT_REACHED
                   : parted >= 0                             ? HOLDS_NOT
                   : hair_frame_numbered(run, TOGETHER) >= 0 ? HOLDS
                                                             : NOT_REACHED,
                   parted < 0 ? last_number(run) : number_of(run, parted), "frame", "stuck");
    if (hair_contacts(run) == 0)
        hair_claim(study, row,
                   "At high viscosity the wisps stick together: with %s no contact acts.", label);
    else if (parted < 0)
        hair_claim(study, row,
                   "At high viscosity the wisps stick together: with %s they are in each other up "
                   "to the last frame, %.0f.",
                   label, row.value);
    else
        hair_claim(study, row,
                   "At high viscosity the wisps stick together: with %s they part at frame %.0f.",
                   label, row.value);
}

/* What the figure shows: the same two wisps, side by side and in each other. */
static void state_difference(struct hair_study *study, const struct hair_run *thin,
                             const struct hair_run *thick) {
    const int frame = hair_frame_numbered(thin, PARTED), other = hair_frame_numbered(thick, PARTED);
    struct statement row = thesis_row(NULL, NULL, NOT_REACHED, NAN, "1", "held together");
    if (frame < 0 || other < 0) {
        hair_claim(study, row,
                   "Viscosity holds wisps together: frame %d, at which the two are compared, was "
                   "not computed.",
                   PARTED);
        return;
    }
    const double few = thin->series[OVERLAP][frame], many = thick->series[OVERLAP][other];
    row.value = many - few;
    row.verdict = hair_contacts(thick) == 0 ? NOT_REACHED : holds_if(few == 0 && many > 0);
    hair_claim(study, row,
               "Viscosity holds wisps together: at frame %d %.0f points are in the other wisp with "
               "%s, and %.0f with %s.",
               PARTED, few, thin->variant->label, many, thick->variant->label);
}

static void state(struct hair_study *study) {
    state_parting(study, &study->runs[THIN]);
    state_staying(study, &study->runs[THIN]);
    state_sticking(study, &study->runs[THICK]);
    state_difference(study, &study->runs[THIN], &study->runs[THICK]);
}

static const struct hair_question question = {
    .scene = "viscosity",
    .needs = {"contacts"},
    .variants =
        {[THIN] = {.label = "viscosity 0.5", .sets = {"contacts.viscosity=0.5"}, .thesis = 0.85},
         [THICK] = {.label = "viscosity 50", .sets = {"contacts.viscosity=50"}, .thesis = 0.84},
         [FREE] = {.label = "no contact",
                   .sets = {"contacts.interpenetration=false", "contacts.collision=false"}}},
    .main = THIN,
    .control = FREE,
    .without = "without contact",
    .pictures = {1, 10, 20, 56},
    .large = 30,
    .columns = 4,
    .width = 260,
    .height = 330,
    .series = {{"overlap", "1",
                "how often a node or sample of a wisp is in a section of another one"}},
    .measure = measure,
    .state = state,
};

const struct experiment viscosity_experiment = {
    .name = "viscosity",
    .question = "how does viscosity hold wisps together?",
    .thesis = "section 5.3",
    .place = 9,
    .headline = "choice",
    .quick_seconds = 2,
    .full_seconds = 4,
    HAIR_EXPERIMENT(&question),
};
