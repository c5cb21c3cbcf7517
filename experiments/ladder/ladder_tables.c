/* The tables of the ladder: what each method reached in each cell, and where two change places. */
#include "ladder.h"

#include <math.h>

/* What keeps a method from coarser settings: where it is stability, they fail, or are finite and
 * wrong by orders of magnitude; an error that follows from the order grows by no more than the
 * fourth power of a step that is a few per cent longer. */
static const char *limit_of(const struct search *s) {
    if (s->place.reached < 0 || s->place.missed < 0)
        return "none";
    return s->missed_outcome != FINISHED || s->missed_error > 100 * s->error ? "failure"
                                                                             : "accuracy";
}

#define SEARCH_COLUMNS(X)                                                                          \
    X("stretch_stiffness", "N", "EA of a wisp", "%g", cell->stiffness)                             \
    X("zeta", "1", "damping of the highest stretch mode over critical", "%.17g", cell->damping)    \
    CONFIGURATION_COLUMN(X, "method", s->configuration->name)                                      \
    X("setting", "s or 1", "largest step, s, or rtol that reaches the target", "%.17g",            \
      ladder_setting(plan, s, s->place.reached))                                                   \
    X("missed_setting", "s or 1", "the next one tried, which does not", "%.17g",                   \
      ladder_setting(plan, s, s->place.missed))                                                    \
    X("error", "m", "error at setting, rms over free nodes and all frames", "%.17g", s->error)     \
    X("missed_error", "m", "error at missed_setting, rms over free nodes and all frames", "%.17g", \
      s->missed_error)                                                                             \
    CPU_COLUMNS(X, &s->cost)                                                                       \
    EVALUATIONS_COLUMN(X, &s->cost)                                                                \
    STEPS_COLUMN(X, &s->cost)                                                                      \
    X("status", "-", "reached, never or refused: what came of the search", "%s", status_of(s))     \
    X("limit", "-", "failure or accuracy: what keeps the method from coarser settings", "%s",      \
      limit_of(s))                                                                                 \
    X("missed_outcome", "-", "how the run at missed_setting ended", "%s",                          \
      s->place.missed >= 0 ? outcome_name(s->missed_outcome) : "none")                             \
    X("missed_time", "s", "simulated time at which that failed", "%.17g", s->missed_time)          \
    COUNTED_COLUMN(X, &s->cost)                                                                    \
    X("hair", "-", "the kind of hair", "%s", cell->hair->name)                                     \
    X("figure", "-", "in which it has a panel", "%s", cell->hair->figure)                          \
    NOTE_COLUMN(X, s->note)

static const char *status_of(const struct search *s) {
    return s->refused ? outcome_name(REFUSED) : s->place.reached >= 0 ? "reached" : "never";
}

const struct search *ladder_search(const struct ladder *ladder, int cell,
                                   const struct configuration *configuration) {
    for (int i = 0; i < ladder->count; i++)
        if (ladder->search[i].cell == cell && ladder->search[i].configuration == configuration)
            return &ladder->search[i];
    return NULL;
}

/* Rows of a method along the stiffness, of one kind of hair; blocks are separated by two blank
 * lines.
 */
static int write_ladder(struct plan *plan) {
    const struct ladder *ladder = plan->memo;
    char what[1000];
    snprintf(
        what, sizeof what,
        "the largest step, s, or rtol that reaches %g m rms over free nodes and all frames "
        "(setting), the next one tried that does not (missed: its error, outcome and time of "
        "failure), and what the first costs: CPU time, s, of repeated runs, force evaluations, "
        "steps; errors of adaptive methods: the worst of %d tolerances rtol(1 + j 1e-12), of which "
        "j = 0 is timed, but where a run is counted at more than 0.2 s of one, timed once, and the "
        "missed one is farther; counted: what the table of costs makes of the steps, s, by which "
        "methods are put in order; limit: failure where the missed one fails or is 100 times as "
        "wrong; "
        "zeta: damping of the highest stretch mode over critical; figure: in which the kind of "
        "hair has a panel; nan: there is no number, see status and note%s",
        LADDER_TARGET, plan->quick ? JITTERED_QUICK : JITTERED,
        plan->quick ? "; --quick: no real hair, the scene's damping, coarser brackets" : "");
    FILE *stream = output_table(&plan->output, "ladder", what, plan->subjects[0].scene,
                                COLUMNS(SEARCH_COLUMNS));
    if (!stream)
        return -1;
    for (int first = 0, next; first < ladder->cell_count; first = next) {
        for (next = first + 1; next < ladder->cell_count && ladder_goes_on(ladder, next);)
            next++;
        for (int c = 0; c < plan->configuration_count; c++) {
            for (int k = first; k < next; k++) {
                const struct cell *cell = &ladder->cell[k];
                const struct search *s = ladder_search(ladder, k, &plan->configurations[c]);
                if (s)
                    WRITE_ROW(stream, SEARCH_COLUMNS);
            }
            fprintf(stream, "\n\n");
        }
    }
    return 0;
}

int ladder_has_cost(const struct search *s) {
    return s && s->phase == DONE && s->place.reached >= 0 && s->cost.cpu.median > 0;
}

double ladder_crossing(const double stiffness[2], const double a[2], const double b[2]) {
    const double gap = log(a[0] / b[0]), next_gap = log(a[1] / b[1]);
    if (!(gap * next_gap < 0))
        return NAN;
    const double share = gap / (gap - next_gap);
    return stiffness[0] * pow(stiffness[1] / stiffness[0], share);
}

int ladder_is_apart(const struct search *a, const struct search *b) {
    return cost_is_less(&a->cost, &b->cost) || cost_is_less(&b->cost, &a->cost);
}

#define CROSSING_COLUMNS(X)                                                  \
    X("hair", "-", "the kind of hair", "%s", ladder->cell[cell].hair->name)  \
    X("cheaper_below", "-", "the method that is cheaper at below", "%s",     \
      (first ? one : other)->name)                                           \
    X("cheaper_above", "-", "the method that is cheaper at above", "%s",     \
      (first ? other : one)->name)                                           \
    X("below", "N", "the softer of the two stiffnesses", "%g", stiffness[0]) \
    X("above", "N", "the stiffer one", "%g", stiffness[1])                   \
    X("crossing", "N", "where both cost the same", "%.17g", at)              \
    X("clear", "1", "1 where the two are tied at neither end", "%d",         \
      ladder_is_apart(a[0], b[0]) && ladder_is_apart(a[1], b[1]))

/* From this cell to the next. */
static void write_crossing(FILE *stream, const struct ladder *ladder, int cell,
                           const struct configuration *one, const struct configuration *other) {
    const struct search *a[2], *b[2];
    double cost_a[2], cost_b[2], stiffness[2];
    for (int k = 0; k < 2; k++) {
        stiffness[k] = ladder->cell[cell + k].stiffness;
        a[k] = ladder_search(ladder, cell + k, one);
        b[k] = ladder_search(ladder, cell + k, other);
        if (!ladder_has_cost(a[k]) || !ladder_has_cost(b[k]))
            return;
        cost_a[k] = a[k]->cost.counted;
        cost_b[k] = b[k]->cost.counted;
    }
    const int first = cost_a[0] < cost_b[0];
    const double at = ladder_crossing(stiffness, cost_a, cost_b);
    if (!isnan(at))
        WRITE_ROW(stream, CROSSING_COLUMNS);
}

static int write_crossings(struct plan *plan) {
    const struct ladder *ladder = plan->memo;
    FILE *stream =
        output_table(&plan->output, "crossings",
                     "pairs of methods of which one is cheaper for the target of ladder at a "
                     "stiffness, N, and the other at the next, by steps counted and the table of "
                     "costs; crossing: where lines through both, in logarithms, meet; clear: at "
                     "neither end are the two tied (within 1.4 times, or repeated times overlap)",
                     plan->subjects[0].scene, COLUMNS(CROSSING_COLUMNS));
    if (!stream)
        return -1;
    for (int cell = 0; cell + 1 < ladder->cell_count; cell++)
        for (int a = 0; a < plan->configuration_count && ladder_goes_on(ladder, cell + 1); a++)
            for (int b = a + 1; b < plan->configuration_count; b++)
                write_crossing(stream, ladder, cell, &plan->configurations[a],
                               &plan->configurations[b]);
    return 0;
}

int ladder_write(struct plan *plan) {
    return write_ladder(plan) || write_crossings(plan) ? -1 : 0;
}
