/* The bound on a reference: an unlike method over the same frames, and their difference. */
#ifndef WISPLAB_SECOND_OPINION_H
#define WISPLAB_SECOND_OPINION_H

#include "simulation.h"

/* The frames of the first run, kept while it goes on: of each the number of its rows, then these.
 */
struct kept_frames {
    double *numbers;
    size_t used, capacity;
};

/* A struct observer's frame function; ctx is a struct kept_frames, all zero before the first. */
int keep_frame(void *ctx, const struct model *model, double t, const double *rows);
void kept_frames_free(struct kept_frames *kept);

/* Runs the method that checks settings->method over the frames kept. New reference: its settings
 * and the bound, the largest distance of a node at a frame, m; or null and the reason, which can
 * be that from some frame on they have not the same number of wisps. */
json_t *cross_check(const struct scene *scene, const struct settings *settings,
                    const struct kept_frames *kept, const struct watch *watch);

#endif
