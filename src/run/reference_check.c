#include "reference_check.h"

#include "base/files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int keep_frame(void *ctx, const struct model *model, double t, const double *rows) {
    (void)t;
    struct kept_frames *kept = ctx;
    const size_t size = (size_t)(model->row_count * model->column_count);
    if (kept->used + 1 + size > kept->capacity) {
        const size_t capacity = 2 * (kept->used + 1 + size);
        double *grown = realloc(kept->numbers, capacity * sizeof *grown);
        if (!grown)
            return OUT_OF_MEMORY;
        kept->numbers = grown;
        kept->capacity = capacity;
    }
    kept->numbers[kept->used] = model->row_count;
    memcpy(kept->numbers + kept->used + 1, rows, size * sizeof *rows);
    kept->used += 1 + size;
    return 0;
}

void kept_frames_free(struct kept_frames *kept) {
    free(kept->numbers);
    *kept = (struct kept_frames){0};
}

/* How far the second run has come along the first. */
struct comparison {
    const struct kept_frames *kept;
    size_t compared;   /* numbers */
    double difference; /* m */
    double
        history_diverged; /* of the first frame with another number of wisps, s; NaN: none so far */
};

/* Both runs have the frames of the same clock: their number is the same. */
static int compare_frame(void *ctx, const struct model *model, double t, const double *rows) {
    struct comparison *c = ctx;
    const int columns = model->column_count;
    if (c->compared == c->kept->used)
        return MODEL_FAILED;
    const double *first = c->kept->numbers + c->compared + 1;
    if (first[-1] != model->row_count)
        c->history_diverged = t;
    if (!isnan(c->history_diverged)) /* which wisp would be which? */
        return 0;
    for (int i = 0; i < model->row_count; i++) {
        const double *a = first + i * columns + 2, *b = rows + i * columns + 2; /* x y z */
        c->difference = fmax(c->difference, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    c->compared += 1 + (size_t)(model->row_count * columns);
    return 0;
}

static json_t *no_bound(const char *method, const char *reason) {
    return json_pack("{s:s, s:n, s:s}", "stepper", method, "bound", "reason", reason);
}

json_t *cross_check(const struct scene *scene, const struct settings *settings,
                    const struct kept_frames *kept, const struct watch *watch) {
    struct settings second;
    struct run_result result;
    struct comparison comparison = {.kept = kept, .history_diverged = NAN};
    char reason[REASON_SIZE];
    const char *method = settings->method->checked_by->method;

    if (settings_cross_check(scene, settings, &second, reason))
        return no_bound(method, reason);
    const struct watch stop_only = {.stop = watch ? watch->stop : NULL};
    simulate(scene, &second, &(struct observer){compare_frame, &comparison}, &stop_only, &result);
    if (result.outcome != FINISHED)
        return no_bound(method, outcome_name(result.outcome));
    if (!isnan(comparison.history_diverged)) {
        snprintf(
            reason, sizeof reason,
            "wisps split at other ticks: at %.6g s their numbers differ; up to then the largest "
            "difference is %.3g m",
            comparison.history_diverged, comparison.difference);
        return no_bound(method, reason);
    }
    return json_pack("{s:o, s:f}", "settings", settings_to_json(scene, &second), "bound",
                     comparison.difference);
}
