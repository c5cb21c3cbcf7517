/* What the experiment `kernel` measures on, for the program that measures. */
#ifndef WISPLAB_KERNEL_EXPERIMENT_H
#define WISPLAB_KERNEL_EXPERIMENT_H

#include "model/scene.h"

/* The scene of that name or path with changes, whose first wisp has an envelope, for scene_free.
 * NULL with one line in `reason` (REASON_SIZE) where it cannot be read or has no such wisp. */
struct scene *kernel_scene(const char *name, const char *const *sets, int set_count, char *reason);

#endif
