#include "cells.h"

#include "base/digits.h"
#include "base/visible.h"

#include <math.h>

/* X(name, unit, meaning, value) in the order of the columns, first `status` and last `reason`. */
#define REACHED(X)                                                 \
    X(failure_time, "s", "simulated time at which the run failed", \
      result->outcome == FINISHED ? (double)NAN : result->time)    \
    X(simulated_time, "s", "simulated time that it reached", result->time)
#define ERRORS(X)                                                                                  \
    X(error_rms, "m", "rms distance of free nodes from the reference's at the frames", error->rms) \
    X(error_largest, "m", "the largest such distance", error->largest)                             \
    X(error_end, "m", "rms distance at the last frame", error->end)                                \
    X(reference_bound, "m", "the largest distance of the reference from what checks it",           \
      error->bound)
#define COUNTS(X)                                    \
    X(frames, "1", "frames reached", result->frames) \
    X(wisps, "1", "wisps at the end", result->wisps)
#define TAKEN(X)                                                                  \
    X(largest_strain, "1", "of a segment after any step", result->largest_strain) \
    X(step_least, "s", "shortest step taken",                                     \
      result->steps.largest > 0 ? result->steps.least : (double)NAN)              \
    X(step_largest, "s", "longest step taken",                                    \
      result->steps.largest > 0 ? result->steps.largest : (double)NAN)            \
    X(cpu_seconds, "s", "CPU time from the first step to the last, of one run", result->cpu_seconds)

static void put(FILE *stream, double x) {
    fprintf(stream, "\t%s", DIGITS(x));
}

int cells_write(char cells[CELLS_SIZE], const struct run_result *result, const char *why,
                int counted, const struct sweep_error *error) {
    char reason[REASON_SIZE];
    FILE *stream = fmemopen(cells, CELLS_SIZE, "w");
    if (!stream)
        return -1;
    fputs(outcome_name(result->outcome), stream);
#define X(name, unit, meaning, value) put(stream, value);
    REACHED(X)
    if (error) {
        ERRORS(X)
    }
#undef X
#define X(name, unit, meaning, value) put(stream, counted ? (double)(value) : (double)NAN);
    COUNTS(X)
#define Y(field, definition) X(field, "1", definition, result->counters.field)
    COUNTERS(Y)
#undef Y
    TAKEN(X)
#undef X
    visible_text(*result->reason ? result->reason : why, reason, sizeof reason);
    fprintf(stream, "\t%s", reason);
    return fclose(stream) ? -1 : 0;
}

static void describe(FILE *stream, const char *name, const char *unit, const char *meaning) {
    fprintf(stream, "# %s, %s: %s\n", name, unit, meaning); /* as base/columns.h has it */
}

void cells_describe(FILE *stream, int errors) {
#define X(name, unit, meaning, value) describe(stream, #name, unit, meaning);
    describe(stream, "status", "-", "how the run ended");
    REACHED(X)
    if (errors) {
        ERRORS(X)
    }
    COUNTS(X)
#define Y(field, definition) describe(stream, #field, "1", definition);
    COUNTERS(Y)
#undef Y
    TAKEN(X)
    describe(stream, "reason", "-", "why it failed, or why a cell is empty");
#undef X
}

void cells_name(FILE *stream, int errors) {
#define X(name, unit, meaning, value) fputs("\t" #name, stream);
    fputs("\tstatus", stream);
    REACHED(X)
    if (errors) {
        ERRORS(X)
    }
    COUNTS(X)
#define Y(field, definition) fputs("\t" #field, stream);
    COUNTERS(Y)
#undef Y
    TAKEN(X)
    fputs("\treason", stream);
#undef X
}
