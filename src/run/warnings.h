/* What a scene says that its run may not show: said once, and kept with the run. */
#ifndef WISPLAB_WARNINGS_H
#define WISPLAB_WARNINGS_H

#include "model/scene.h"

#include <jansson.h>

/* One line for each; none: an empty array. New reference, NULL where memory cannot be had. */
json_t *scene_warnings(const struct scene *scene);

#endif
