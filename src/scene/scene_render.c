#include "scene_render.h"

#include "base/vector.h"
#include "setting_read.h"

#include <math.h>

static void read_view(struct config_reader *reader, config_setting_t *group,
                      struct render_settings *render) {
    double apart[3];
    render->has_eye = setting_numbers(reader, group, "render", "eye", render->eye) > 0;
    render->has_target = setting_numbers(reader, group, "render", "target", render->target) > 0;
    for (int k = 0; k < 3; k++)
        apart[k] = render->eye[k] - render->target[k];
    if (render->has_eye && !render->has_target)
        config_fail(reader, config_setting_get_member(group, "eye"),
                    "eye: needs a target = [x, y, z] to look at");
    if (render->has_eye && !(vector_length(apart) > RENDER_NEAREST))
        config_fail(reader, config_setting_get_member(group, "eye"),
                    "eye: must not be where the target is");
}

static void read_light(struct config_reader *reader, config_setting_t *group,
                       struct render_settings *render) {
    if (setting_numbers(reader, group, "render", "light", render->light) == 0)
        return;
    const double length = vector_length(render->light);
    if (!(length > 0) || isinf(length))
        config_fail(reader, config_setting_get_member(group, "light"),
                    "light: has no length, or too great a one");
    for (int k = 0; k < 3; k++)
        render->light[k] /= length;
}

/* In a segment of one wisp: more takes minutes and is black. */
static const double most_lines = 1e6;

void render_read(struct config_reader *reader, config_setting_t *top,
                 struct render_settings *render) {
    config_setting_t *group = setting_group(reader, top, "", "render");
    settings_read(reader, group, "render", render);
    if (!group || reader->failed)
        return;
    read_view(reader, group, render);
    read_light(reader, group, render);
    if (1.0 * render->hairs * render->pieces > most_lines)
        config_fail(reader, group, "render: %d hairs of %d pieces: must be at most %g in all",
                    render->hairs, render->pieces, most_lines);
}
