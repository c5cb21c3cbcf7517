/* What variants cost, beside the thesis's times. */
#include "hair_study.h"

#include <math.h>
#include <string.h>

/* Over the first row's: the median of the medians, and what the spreads allow at most. */
struct ratio {
    double value, least, most;
};

static struct ratio normalise(const struct spread *cpu, const struct spread *first, int is_first) {
    if (is_first)
        return (struct ratio){1, 1, 1};
    return (struct ratio){cpu->median / first->median, cpu->least / first->greatest,
                          cpu->greatest / first->least};
}

/* A variant's time in the thesis, s per frame; NaN: there is none. */
static double thesis_time(const struct hair_study *study, int i) {
    const double time = study->runs[i].variant->thesis;
    return study->is_own && time > 0 ? time : NAN;
}

/* The thesis's ratio, with what the rounding of its times allows: they are printed to 0.01 s. */
static struct ratio thesis_ratio_of(const struct hair_study *study, int i) {
    const double rounding = 0.005, time = thesis_time(study, i), first = thesis_time(study, 0);
    if (isnan(time) || isnan(first))
        return (struct ratio){NAN, NAN, NAN};
    if (i == 0)
        return (struct ratio){1, 1, 1};
    return (struct ratio){time / first, (time - rounding) / (first + rounding),
                          (time + rounding) / (first - rounding)};
}

static int is_as_in_thesis(const struct ratio *ours, const struct ratio *thesis) {
    return ours->least <= thesis->most && thesis->least <= ours->most;
}

/* What is to be said of our ratio beside the thesis's; NULL: it has none. */
static void compare(char *text, size_t size, const struct ratio *ours, const struct ratio *thesis) {
    if (!thesis || !(thesis->value > 0) || !isfinite(ours->value))
        snprintf(text, size, "nothing to compare with");
    else if (is_as_in_thesis(ours, thesis))
        snprintf(text, size, "as in the thesis, within the spread");
    else
        snprintf(text, size, "%.2f of the first row, in the thesis %.2f: %s by %.0f %%",
                 ours->value, thesis->value, ours->value > thesis->value ? "more" : "less",
                 100 * fabs(ours->value / thesis->value - 1));
}

#define COUNTER_COLUMN(X, name, meaning) \
    X(name, "1", meaning, "%.17g", run_number(&run->files, "counters." name))
#define VARIANT_COLUMNS(X)                                                                       \
    X("variant", "-", "name of the variant", "%s", run->variant->label)                          \
    STATUS_COLUMNS(X, &run->cost)                                                                \
    X("cpu_per_frame", "s", "CPU time of a frame, median of repeated runs", "%.17g", cpu.median) \
    X("least", "s", "least CPU time of repeated runs", "%.17g", cpu.least)                       \
    X("greatest", "s", "greatest CPU time of repeated runs", "%.17g", cpu.greatest)              \
    X("normalised", "1", "cpu_per_frame over the first row's", "%.17g", ratio.value)             \
    X("normalised_least", "1", "the least that the spreads allow", "%.17g", ratio.least)         \
    X("normalised_greatest", "1", "the greatest that the spreads allow", "%.17g", ratio.most)    \
    X("thesis_per_frame", "s", "CPU time in the thesis", "%.17g", thesis)                        \
    X("thesis_normalised", "1", "thesis_per_frame over the first row's", "%.17g", theirs.value)  \
    X("thesis_over_ours", "1", "thesis_per_frame over cpu_per_frame", "%.17g",                   \
      thesis / cpu.median)                                                                       \
    X("real_time", "1", "simulated over CPU time", "%.17g",                                      \
      hair_real_time(&cpu, run->timed->run.scene))                                               \
    COUNTER_COLUMN(X, "force_evaluations", "evaluations of a wisp's forces in the run")          \
    COUNTER_COLUMN(X, "wisp_contacts",                                                           \
                   "how often a node or sample was in a section of another wisp at a tick")      \
    COUNTER_COLUMN(X, "body_contacts", "how often a node or sample was in a body at a tick")     \
    COUNTER_COLUMN(X, "splits", "subdivisions of wisps")                                         \
    X("wisps_at_end", "1", "wisps at the last frame", "%.17g",                                   \
      frames > 0 ? (double)hair->frames[frames - 1].wisps : (double)NAN)                         \
    X("comparison", "-", "normalised beside the thesis's", "%s", words)

static void write_variant(FILE *stream, const struct hair_study *study, int i) {
    const struct hair_run *run = &study->runs[i];
    const struct spread first = hair_cpu_per_frame(&study->runs[0]), cpu = hair_cpu_per_frame(run);
    const struct ratio ratio = normalise(&cpu, &first, i == 0);
    const double thesis = thesis_time(study, i);
    const struct ratio theirs = thesis_ratio_of(study, i);
    const struct hair *hair = &run->hair;
    const int frames = hair->frame_count;
    char words[128];
    compare(words, sizeof words, &ratio, study->count > 1 ? &theirs : NULL);
    WRITE_ROW(stream, VARIANT_COLUMNS);
}

/* Times are of one machine and its load: what they show is stated, and nothing is judged by them.
 */
static void state_variant(struct hair_study *study, int i) {
    const struct hair_run *run = &study->runs[i], *one = &study->runs[0];
    const struct spread first = hair_cpu_per_frame(one), cpu = hair_cpu_per_frame(run);
    const struct ratio ratio = normalise(&cpu, &first, i == 0);
    const struct ratio theirs = thesis_ratio_of(study, i);
    char then[64] = "";
    struct statement row =
        our_row("cost", "table", HOLDS, NAN, "1", "cost, %.60s", run->variant->label);
    if (run->cost.outcome != FINISHED || !isfinite(ratio.value)) {
        row.verdict = NOT_REACHED;
        hair_state(
            study, row, "What a frame of the run '%s' takes is not known: %s.", run->variant->label,
            outcome_name(run->cost.outcome != FINISHED ? run->cost.outcome : one->cost.outcome));
    } else if (i == 0) {
        row.value = 1e3 * cpu.median;
        row.unit = "ms";
        if (thesis_time(study, i) > 0)
            snprintf(then, sizeof then, ", and took %g s in the thesis", thesis_time(study, i));
        hair_state(
            study, row, "A frame of the run '%s' takes %.3g ms of CPU time (%.3g to %.3g)%s.",
            run->variant->label, 1e3 * cpu.median, 1e3 * cpu.least, 1e3 * cpu.greatest, then);
    } else {
        row.value = ratio.value;
        if (theirs.value > 0)
            snprintf(then, sizeof then, "; in the thesis it took %.2f times as long", theirs.value);
        hair_state(study, row,
                   "A frame of the run '%s' takes %.3g ms of CPU time, %.2f times (%.2f to %.2f) "
                   "as long as one of '%s'%s.",
                   run->variant->label, 1e3 * cpu.median, ratio.value, ratio.least, ratio.most,
                   one->variant->label, then);
    }
}

int hair_costs(struct plan *plan, struct hair_study *study) {
    FILE *stream =
        output_table(&plan->output, "table",
                     "CPU time, s per frame, of repeated runs, beside the thesis's (one processor, "
                     "MIPS R4400 at 200 MHz); normalised: over the first row's, with what the "
                     "spreads allow; real_time: simulated over CPU time; force_evaluations: of a "
                     "wisp's forces; wisp_contacts: how often a node or sample was in a section of "
                     "another wisp at a tick, body_contacts: in a body; nan: there is no number",
                     study->subject->scene, COLUMNS(VARIANT_COLUMNS));
    for (int i = 0; i < study->count && stream; i++) {
        write_variant(stream, study, i);
        state_variant(study, i);
    }
    return stream ? 0 : -1;
}
