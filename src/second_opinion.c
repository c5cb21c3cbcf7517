#include "second_opinion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int keep_frame(void *ctx, const struct model *model, double t, const double *rows) {
    (void)t;
    struct kept_frames *kept = ctx;
    kept->frame_size = (size_t)(model->row_count * model->column_count);
    if (kept->used + kept->frame_size > kept->capacity) {
        const size_t capacity = 2 * (kept->used + kept->frame_size);
        double *grown = realloc(kept->rows, capacity * sizeof *grown);
        if (!grown)
            return OUT_OF_MEMORY;
        kept->rows = grown;
        kept->capacity = capacity;
    }
    memcpy(kept->rows + kept->used, rows, kept->frame_size * sizeof *rows);
    kept->used += kept->frame_size;
    return 0;
}

void kept_frames_free(struct kept_frames *kept) {
    free(kept->rows);
    *kept = (struct kept_frames){0};
}

/* How far the second run has come along the first. */
struct comparison {
    const struct kept_frames *kept;
    size_t compared;   /* numbers */
    double difference; /* m */
};

/* Both runs have the frames of the same clock: their number is the same. */
static int compare_frame(void *ctx, const struct model *model, double t, const double *rows) {
    (void)t;
    struct comparison *c = ctx;
    const int columns = model->column_count;
    const double *first = c->kept->rows + c->compared;
    if (c->compared + c->kept->frame_size > c->kept->used)
        return MODEL_FAILED;
    for (int i = 0; i < model->row_count; i++) {
        const double *a = first + i * columns + 2, *b = rows + i * columns + 2; /* x y z */
        c->difference = fmax(c->difference, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    c->compared += c->kept->frame_size;
    return 0;
}

json_t *second_opinion(const struct scene *scene, const struct settings *settings,
                       const struct kept_frames *kept, const struct watch *watch) {
    struct settings second;
    struct run_result result;
    struct comparison comparison = {.kept = kept};
    char reason[REASON_SIZE];
    const char *method = settings->method->checked_by->method;

    if (settings_second_opinion(scene, settings, &second, reason))
        return json_pack("{s:s, s:n, s:s}", "stepper", method, "bound", "reason", reason);
    const struct watch stop_only = {.stop = watch ? watch->stop : NULL};
    simulate(scene, &second, &(struct observer){compare_frame, &comparison}, &stop_only, &result);
    if (result.outcome != FINISHED)
        return json_pack("{s:s, s:n, s:s}", "stepper", method, "bound", "reason",
                         outcome_name(result.outcome));
    return json_pack("{s:o, s:f}", "settings", settings_to_json(scene, &second), "bound",
                     comparison.difference);
}
