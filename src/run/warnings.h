/* What a scene says that its run may not show: said once, and kept with the run. */
#ifndef WISPLAB_WARNINGS_H
#define WISPLAB_WARNINGS_H

#include "settings.h"

#include <jansson.h>

/* One line for each; none: an empty array. With settings, NULL for none, also of what they make of
 * the scene. New reference, NULL where memory cannot be had. */
json_t *scene_warnings(const struct scene *scene, const struct settings *settings);

#endif
